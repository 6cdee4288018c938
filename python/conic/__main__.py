"""The program: `conic`, where a wheel is installed, or `python -m conic`."""

from __future__ import annotations

import ctypes
import os
import signal
import sys

from ._library import library


def main() -> int:
    """Runs the program with this process's arguments, and returns its exit code."""
    for name in ("SIGINT", "SIGPIPE"):  # it handles its own
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_DFL)
    words = [os.fsencode(word) for word in ["conic", *sys.argv[1:]]]
    sys.stdout.flush()
    return int(library.cli_host_program(len(words), (ctypes.c_char_p * (len(words) + 1))(*words, None)))


if __name__ == "__main__":
    sys.exit(main())
