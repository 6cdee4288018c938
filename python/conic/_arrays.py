"""Arrays of whatever library, as NumPy sees them: without copies where that can be."""

from __future__ import annotations

from typing import Any, List, Optional, Sequence, Tuple

import numpy

from .errors import ArgumentError


def as_numpy(array: Any, name: str) -> numpy.ndarray:
    """A view of an array of NumPy, torch, jax, … through `__array_interface__` or DLPack; a copy of a GPU's."""
    if isinstance(array, numpy.ma.MaskedArray):
        raise ArgumentError(f"{name}: the array has a mask; hand over its .filled(numpy.nan)")
    if isinstance(array, numpy.ndarray):
        return numpy.asarray(array)
    if hasattr(array, "detach"):  # torch: what gradients go through is not handed out otherwise
        array = array.detach()
    device = str(getattr(array, "device", "cpu")).lower()
    if device.startswith(("cuda", "<cuda", "mps", "xpu", "xla")):  # of torch; of CuPy; of jax
        for copy in ("cpu", "get"):
            if hasattr(array, copy):
                return as_numpy(getattr(array, copy)(), name)
        if not hasattr(array, "__array__"):
            raise ArgumentError(f"{name}: the array is on {device}, and has no .cpu() that copies it")
    if not hasattr(array, "__array_interface__") and not hasattr(array, "__array__") and hasattr(array, "__dlpack__"):
        return numpy.from_dlpack(array)
    try:
        return numpy.asarray(array)
    except ValueError:
        raise ArgumentError(f"{name}: its rows are not equally long") from None
    except (TypeError, RuntimeError, BufferError) as failure:
        raise ArgumentError(f"{name}: {str(failure).splitlines()[0]}") from None


def as_floats(array: Any, name: str) -> numpy.ndarray:
    """The same as float32; no copy where it is that already."""
    found = as_numpy(array, name)
    if found.dtype.kind not in "fiub":
        raise ArgumentError(f"{name}: numbers are needed, not {found.dtype}")
    if name == "color" and found.dtype == numpy.uint8:
        raise ArgumentError("color: linear floats from 0 to 1 are needed, not bytes; of sRGB's, "
                            "((c / 255 + 0.055) / 1.055)**2.4 makes them")
    return found.astype(numpy.float32, copy=False)


def _is_steppable(column: numpy.ndarray) -> bool:
    step = column.strides[0]
    return column.size < 2 or (step > 0 and step % 4 == 0)


def _is_components(array: Any, n: int) -> bool:
    """Whether it is a sequence of n arrays, one for each component; n rows of n numbers are rows."""
    if not isinstance(array, (tuple, list)) or len(array) != n or any(numpy.ndim(part) != 1 for part in array):
        return False
    return any(len(part) != n for part in array)


def columns_of(array: Any, n: int, count: Optional[int], name: str) -> Tuple[List[numpy.ndarray], int]:
    """The n components of an array of (count, n) numbers, and the bytes from one number to the next.

    A sequence of n arrays is taken as the components themselves. Copied is only what cannot be stepped through: what
    is no float32, or runs backwards, or whose components are not equally far apart."""
    if n > 1 and _is_components(array, n):
        columns = [as_floats(part, name) for part in array]
    else:
        whole = as_floats(array, name)
        if n == 1 and whole.ndim == 2 and whole.shape[1] == 1:
            whole = whole[:, 0]
        if whole.ndim != (1 if n == 1 else 2) or (n > 1 and whole.shape[1] != n):
            wanted = "(N,)" if n == 1 else f"(N, {n})"
            raise ArgumentError(f"{name}: its shape is {whole.shape}, and {wanted} is needed")
        columns = [whole] if n == 1 else [whole[:, i] for i in range(n)]
    if any(column.ndim != 1 or len(column) != len(columns[0]) for column in columns):
        raise ArgumentError(f"{name}: its components are not equally long")
    if count is not None and len(columns[0]) != count:
        raise ArgumentError(f"{name}: it has {len(columns[0])} rows, and {count} are needed")
    if not all(_is_steppable(column) for column in columns) or len({column.strides[0] for column in columns}) > 1:
        columns = [numpy.ascontiguousarray(column) for column in columns]
    return columns, columns[0].strides[0] if len(columns[0]) > 1 else 4


def side_by_side(array: Any, n: int, count: Optional[int], name: str) -> List[numpy.ndarray]:
    """The same where conic needs a component's numbers side by side: copied unless they are."""
    columns, _ = columns_of(array, n, count, name)
    return [numpy.ascontiguousarray(column) for column in columns]


def split_origin(position: Any, name: str) -> Tuple[Any, Sequence[float]]:
    """Positions of doubles that floats cannot hold, as floats from the first finite one; others as they are."""
    if _is_components(position, 3):
        parts = [as_numpy(part, name) for part in position]
        lengths = {len(part) for part in parts}
        if len(lengths) > 1 or not any(part.dtype == numpy.float64 for part in parts):
            return position, (0.0, 0.0, 0.0)
        position = numpy.stack(parts, axis=1)
    whole = as_numpy(position, name)
    if whole.dtype != numpy.float64 or whole.ndim != 2:
        return whole, (0.0, 0.0, 0.0)
    with numpy.errstate(over="ignore", invalid="ignore"):
        if numpy.array_equal(whole.astype(numpy.float32).astype(numpy.float64), whole, equal_nan=True):
            return whole, (0.0, 0.0, 0.0)
        finite = numpy.flatnonzero(numpy.isfinite(whole).all(axis=1))
        origin = whole[finite[0]] if len(finite) else numpy.zeros(3)
        return (whole - origin).astype(numpy.float32), tuple(float(part) for part in origin)


def add_origin(origin: Any, first: Sequence[float]) -> List[float]:
    """What is added to positions that are counted from the first one, whose origin is another."""
    place = as_numpy(origin, "origin")
    if place.shape != (3,) or place.dtype.kind not in "fiu":
        raise ArgumentError("origin: three numbers are needed")
    return [float(a) + float(b) for a, b in zip(place, first)]
