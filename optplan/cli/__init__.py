"""The command line."""

from __future__ import annotations

import sys


def main() -> None:
    """Entry point of `optplan`: 0 planned and verified, 1 no valid plan or a failed check, 2 bad input."""
    from optplan.cli.commands import app
    from optplan.domain.errors import OptplanError

    try:
        app()
    except OptplanError as error:
        # names of files and elements may hold anything, line breaks and half characters too
        line = "".join(c if c.isprintable() else repr(c)[1:-1] for c in str(error))
        print(f"error: {line}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        sys.exit(130)
    except BrokenPipeError:
        # the reader of our output has gone: nothing left to say, not even on exit
        sys.stdout = sys.stderr
        sys.exit(0)
