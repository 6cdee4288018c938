"""Arrays of pictures that nobody looks at any more, for the next picture.

New memory comes from the system as zeros, a page at a time, and for a picture of a million pixels that takes a quarter
of the time that drawing it does."""

from __future__ import annotations

import sys
from typing import Dict, List, Tuple

import numpy


class Shelf:
    """The arrays of a thread's last two pictures. One is used again when nothing but the shelf refers to it."""

    _MAX_PICTURES = 2  # while one is drawn, its caller still has the one before
    _MAX_BYTES = 64 << 20

    def __init__(self) -> None:
        self._arrays: Dict[str, List[numpy.ndarray]] = {}

    @staticmethod
    def _holders(arrays: List[numpy.ndarray], i: int) -> int:
        return sys.getrefcount(arrays[i]) if hasattr(sys, "getrefcount") else 0

    def take(self, name: str, shape: Tuple[int, ...], dtype: str) -> numpy.ndarray:
        """An array with anything in it."""
        arrays = self._arrays.setdefault(name, [])
        alone = self._holders([numpy.empty(0)], 0)
        for i in range(len(arrays)):  # pylint: disable=consider-using-enumerate
            if arrays[i].shape == shape and arrays[i].dtype == dtype and self._holders(arrays, i) == alone:
                return arrays[i].view()
        made = numpy.empty(shape, dtype)
        if made.nbytes <= self._MAX_BYTES:
            self._arrays[name] = [*arrays, made][-self._MAX_PICTURES:]
        return made.view()

    def clear(self) -> None:
        """Lets go of them all."""
        self._arrays = {}
