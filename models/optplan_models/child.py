"""Functions at work in a child process, which streams what it finds and can be ended at once.

HiGHS may notice a cancel only after many seconds, and what it finds must not be lost then.
"""

from __future__ import annotations

import contextlib
import pickle
import queue
import struct
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any

WORKER = Path(__file__).with_name("worker.py")
POLL = 0.03
"""Seconds between two looks at a cancel."""
GRACE = 2.0
"""Seconds past its time limit that a child gets to report its last bound."""


class ChildError(Exception):
    """The child process failed; says how."""


class Child:
    """A child process as a context: whatever happens inside, it is dead afterwards.

    Parameters
    ----------
    function : "module:function"; called in the child as function(send, *arguments), it streams send(*message)
    arguments : anything that can be pickled

    Raises
    ------
    ChildError : on entering, when the process cannot be started
    """

    def __init__(self, function: str, *arguments: Any) -> None:
        self._task = (sys.path, function, arguments)
        self._inbox: queue.SimpleQueue[tuple[Any, ...]] = queue.SimpleQueue()

    def __enter__(self) -> Child:
        if not sys.executable:
            raise ChildError("there is no Python interpreter to start the solver's process with")
        # -P: the worker's neighbours are no top-level modules
        command = [sys.executable, "-P", str(WORKER)]
        self._errors = tempfile.TemporaryFile()
        try:
            self.process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors, bufsize=-1
            )
        except OSError as error:
            self._errors.close()
            raise ChildError(f"the solver's process cannot be started ({error})") from error
        # both pipes are served by threads, so that neither a slow nor a dead child blocks this one
        self._threads = [threading.Thread(target=f, daemon=True) for f in (self._write, self._read)]
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()
        for thread in self._threads:
            thread.join()
        for pipe in (self.process.stdin, self.process.stdout, self._errors):
            assert pipe is not None
            with contextlib.suppress(OSError):  # flushing what the dead child did not read
                pipe.close()

    def receive(self, seconds: float = POLL) -> tuple[Any, ...] | None:
        """The next message, ("end",) when the child has ended, or None when there is nothing for so long."""
        try:
            return self._inbox.get(timeout=seconds)
        except queue.Empty:
            return None

    def obituary(self) -> str:
        """How the child ended."""
        code = self.process.wait()
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        return f"exit code {code}" + (f": {lines[-1]}" if lines else "")

    def _write(self) -> None:
        assert self.process.stdin is not None
        with contextlib.suppress(OSError):  # the child is dead; the reader says so
            for part in self._task:
                pickle.dump(part, self.process.stdin, protocol=5)
            self.process.stdin.flush()

    def _read(self) -> None:
        assert self.process.stdout is not None
        out = self.process.stdout
        # a child that dies may cut off a frame in the middle
        with contextlib.suppress(OSError, EOFError, ValueError, pickle.UnpicklingError):
            while len(head := out.read(8)) == 8:
                body = out.read(struct.unpack("<Q", head)[0])
                self._inbox.put(pickle.loads(body))
        self._inbox.put(("end",))
