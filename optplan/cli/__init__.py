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
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        sys.exit(130)
    except BrokenPipeError:
        # the reader of our output has gone: nothing left to say, not even on exit
        sys.stdout = sys.stderr
        sys.exit(0)
