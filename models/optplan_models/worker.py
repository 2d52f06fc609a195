"""The child's side of `optplan_models.child`. Runs as a file, so it imports nothing of this package.

In: three pickles on standard input, which then stays open (when it closes, the parent is gone and so is the child):
where to import from, the function as "module:function", its arguments.
Out: frames on standard output, each a length of 8 bytes and a pickled tuple: what the function sends.
"""

from __future__ import annotations

import importlib
import os
import pickle
import struct
import sys
import threading
import traceback
from typing import Any, BinaryIO


def send(out: BinaryIO, *message: Any) -> None:
    """Write one frame."""
    body = pickle.dumps(message, protocol=5)
    out.write(struct.pack("<Q", len(body)) + body)
    out.flush()


def leave_with_parent() -> None:
    """End the process when standard input closes."""
    while os.read(0, 4096):
        pass
    os._exit(1)


def main() -> None:
    """Read what to do, do it."""
    # whatever libraries print must not get between the frames
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    try:
        sys.path[:] = pickle.load(sys.stdin.buffer)
        module, name = pickle.load(sys.stdin.buffer).split(":")
        arguments = pickle.load(sys.stdin.buffer)
        threading.Thread(target=leave_with_parent, daemon=True).start()
        getattr(importlib.import_module(module), name)(lambda *message: send(out, *message), *arguments)
        out.close()
    except Exception:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)
    # leave without waiting for the thread, which waits for the parent
    os._exit(0)


if __name__ == "__main__":
    main()
