"""`python -m optplan` is `optplan`."""

from optplan.cli import main

if __name__ == "__main__":
    main()
