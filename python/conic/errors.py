"""What goes wrong, by the library's statuses. Every message is conic's one line: what is wrong, and where."""

from __future__ import annotations

__all__ = ["Error", "ArgumentError", "InputError", "OutOfMemoryError", "OutputError", "UnsupportedError", "Cancelled",
           "ConicWarning"]


class Error(Exception):
    """Anything that conic refuses or fails at."""

    status = 0


class ArgumentError(Error, ValueError):
    """What was asked for has no meaning: an unknown option, a value out of range, arrays that do not fit together."""

    status = 10


class InputError(Error, ValueError):
    """An input cannot be used: missing, unreadable, malformed, or with nothing in it to draw."""

    status = 20


class OutOfMemoryError(Error, MemoryError):
    """An allocation failed."""

    status = 30


class OutputError(Error):
    """Writing failed: disk full, no permission, network."""

    status = 31


class UnsupportedError(Error):
    """What was asked for is not in this build or not on this machine."""

    status = 32


class Cancelled(Error):
    """The progress callback asked to stop."""

    status = 40


class ConicWarning(UserWarning):
    """The picture is there, and its user may want to know."""


_BY_STATUS = {kind.status: kind for kind in (ArgumentError, InputError, OutOfMemoryError, OutputError, UnsupportedError,
                                             Cancelled)}


def error_of(status: int, message: str) -> Error:
    """The exception for a status."""
    return _BY_STATUS.get(status, Error)(message)
