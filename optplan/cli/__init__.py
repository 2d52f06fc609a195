"""The command line."""

from __future__ import annotations

import io
import sys


def main() -> None:
    """Entry point of `optplan`: 0 planned and verified, 1 no valid plan or a failed check, 2 bad input."""
    from typer import TyperException

    from optplan.cli.commands import app
    from optplan.domain.errors import OptplanError

    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # names of files may hold what the terminal cannot show
    try:
        sys.exit(app(sys.argv[1:] or ["--help"], standalone_mode=False))
    except OptplanError as error:
        _complain(str(error))
    except TyperException as error:
        _complain(error.format_message())
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        sys.exit(130)
    except BrokenPipeError:
        # the reader of our output has gone: nothing left to say, not even on exit
        sys.stdout = sys.stderr
        sys.exit(0)
    except OSError as error:
        sys.stdout = sys.stderr  # what could not be written is not tried again on exit
        _complain(f"the output cannot be written: {error.strerror or error}")


def _complain(text: str) -> None:
    """One line on stderr, whatever the names of files and elements hold, and exit code 2."""
    print("error: " + "".join(c if c.isprintable() else repr(c)[1:-1] for c in text), file=sys.stderr)
    sys.exit(2)
