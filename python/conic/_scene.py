"""What is drawn: files, and arrays."""

from __future__ import annotations

import ctypes
import os
import shutil
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy

from . import _layouts as layouts
from ._arrays import add_origin, as_floats, as_numpy, columns_of, side_by_side, split_origin
from ._camera import PathLike
from ._library import Kept, context, delaying_interrupts, library, read_facts, run, text_bytes
from .errors import ArgumentError


class _InMemory:
    """Arrays that the library reads where they are."""

    _kind = ""
    _struct: ctypes.Structure

    def __init__(self) -> None:
        self._arrays: List[numpy.ndarray] = []

    def _keep(self, columns: List[numpy.ndarray]) -> List[int]:
        self._arrays += columns
        return [column.ctypes.data for column in columns]

    def _lend(self, struct: ctypes.Structure, name: str, found: Tuple[List[numpy.ndarray], int]) -> int:
        """Puts columns and their stride into the struct, and returns their length."""
        columns, stride = found
        places = self._keep(columns)
        if len(columns) == 1:
            setattr(struct, name, places[0])
        else:
            getattr(struct, name)[:] = places
        setattr(struct.strides, name, 0 if stride == 4 else stride)
        return len(columns[0])


class Splats(_InMemory):
    """Ellipses in space, or raw points where there are no axes.

    `position` (N, 3); `tangent_u` and `tangent_v` (N, 3), orthogonal, one standard deviation long, in world units;
    `color` (N, 3), linear; `normal` (N, 3), looked at where there are no axes; `opacity`, `dot` and `scalar` (N,);
    `sight` (N, 3), from a point towards the scanner that saw it, which guessed normals turn to.
    Any array library's float32 arrays are read where they are, with their strides, or (N,) arrays for each component;
    only other types, and arrays that run backwards, are copied. Positions of doubles that floats cannot hold are kept
    from the first one. `origin` is added to all positions."""

    _kind = "splats"

    def __init__(self, position: Any, tangent_u: Any = None, tangent_v: Any = None, color: Any = None, *,
                 normal: Any = None, opacity: Any = None, dot: Any = None, scalar: Any = None, sight: Any = None,
                 origin: Sequence[float] = (0.0, 0.0, 0.0)) -> None:
        super().__init__()
        if (tangent_u is None) != (tangent_v is None):
            raise ArgumentError("splats: tangent_u and tangent_v go together")
        struct = layouts.Splats()
        position, first = split_origin(position, "position")
        struct.origin[:] = add_origin(origin, first)
        count: Optional[int] = None
        for name, array, n in (("position", position, 3), ("tangent_u", tangent_u, 3), ("tangent_v", tangent_v, 3),
                               ("color", color, 3), ("normal", normal, 3), ("opacity", opacity, 1), ("dot", dot, 1),
                               ("scalar", scalar, 1), ("sight", sight, 3)):
            if array is None:
                continue
            count = self._lend(struct, name, columns_of(array, n, count, name))
        struct.count = count or 0
        self._struct = struct

    def __len__(self) -> int:
        return int(self._struct.count)

    def __getattr__(self, name: str) -> Any:
        """`position`, `color` … as (N, 3) or (N,) arrays, or None."""
        if name.startswith("_") or name not in [field[0] for field in layouts.Strides._fields_]:
            raise AttributeError(name)
        member = getattr(self._struct, name)
        places = [member] if name in ("opacity", "dot", "scalar") else list(member)
        if not places[0]:
            return None
        found = [next(a for a in self._arrays if a.ctypes.data == place) for place in places]
        return found[0] if len(found) == 1 else numpy.stack(found, axis=1)

    @property
    def origin(self) -> numpy.ndarray:
        """What is added to all positions."""
        return numpy.array(self._struct.origin)

    def __repr__(self) -> str:
        return f"<conic.Splats {len(self)}{'' if self._struct.tangent_u[0] else ' points'}>"


class Mesh(_InMemory):
    """Triangles.

    `vertices` (N, 3); `faces` (M, 3) indices; `color` (N, 3), linear; `normal` (N, 3); `texture_coordinate` (N, 2),
    (0, 0) being the lower left corner of the picture that `texture=` of :func:`conic.render` lays on them."""

    _kind = "triangles"

    def __init__(self, vertices: Any, faces: Any, color: Any = None, *, normal: Any = None,
                 texture_coordinate: Any = None, scalar: Any = None,
                 origin: Sequence[float] = (0.0, 0.0, 0.0)) -> None:
        super().__init__()
        struct = layouts.Triangles()
        vertices, first = split_origin(vertices, "vertices")
        struct.origin[:] = add_origin(origin, first)
        count: Optional[int] = None
        for name, array, n in (("position", vertices, 3), ("color", color, 3), ("normal", normal, 3),
                               ("texture_coordinate", texture_coordinate, 2), ("scalar", scalar, 1)):
            if array is None:
                continue
            count = self._lend(struct, name,
                               columns_of(array, n, count, "vertices" if name == "position" else name))
        corners = as_numpy(faces, "faces")
        if corners.size == 0:
            corners = numpy.zeros((0, 3), numpy.uint32)
        if corners.ndim != 2 or corners.shape[1] != 3 or corners.dtype.kind not in "iu":
            raise ArgumentError(f"faces: whole numbers of the shape (M, 3) are needed, not {corners.dtype} "
                                f"{corners.shape}")
        if corners.size and not 0 <= corners.min() <= corners.max() < (count or 0):
            raise ArgumentError(f"faces: an index is not from 0 to {(count or 0) - 1}, the last vertex")
        corners = numpy.ascontiguousarray(corners, numpy.uint32)
        self._arrays.append(corners)
        struct.count, struct.n_vertices, struct.corners = len(corners), count or 0, corners.ctypes.data
        struct.n_normals = (count or 0) if normal is not None else 0
        struct.n_texture_coordinates = (count or 0) if texture_coordinate is not None else 0
        self._struct = struct

    def __len__(self) -> int:
        return int(self._struct.count)

    def __repr__(self) -> str:
        return f"<conic.Mesh {len(self)} triangles, {self._struct.n_vertices} vertices>"


_AXES = {"r": "x", "l": "x", "u": "y", "d": "y", "f": "z", "b": "z"}


class Gaussians(_InMemory):
    """A Gaussian scene, by the numbers that renderers take: activated, and not as training keeps them.

    `means` (N, 3); `quats` (N, 4), w, x, y, z of any length; `scales` (N, 3), or (N, 2) of 2D Gaussians, standard
    deviations; `opacities` (N,), 0 to 1; `sh` (N, K, 3), the harmonics of all degrees, K = 1, 4, 9, 16 or 25. The
    colour is max(0, ½ + Σ sh·Y). The library needs each component's numbers side by side, so that all but `sh`, and
    components that are handed over as N-arrays of their own, is copied. `frame` says where x, y and z point ("rdf":
    right, down, forward); `up` is the direction up, where it is another than the frame's."""

    _kind = "gaussians"

    def __init__(self, means: Any, quats: Any, scales: Any, opacities: Any, sh: Any, *, frame: str = "rdf",
                 antialiased: bool = False, linear: bool = False,
                 origin: Sequence[float] = (0.0, 0.0, 0.0), up: Sequence[float] = (0.0, 0.0, 0.0)) -> None:
        super().__init__()
        struct = layouts.Gaussians()
        struct.up[:] = [float(value) for value in up]
        means, first = split_origin(means, "means")
        struct.origin[:] = add_origin(origin, first)
        position = side_by_side(means, 3, None, "means")
        count = len(position[0])
        n_scales = len(scales) if isinstance(scales, tuple) else (0, *numpy.shape(scales))[-1]
        if n_scales not in (2, 3):
            raise ArgumentError(f"scales: its shape is {numpy.shape(scales)}, and (N, 3) or (N, 2) is needed")
        struct.position[:] = self._keep(position)
        struct.rotation[:] = self._keep(side_by_side(quats, 4, count, "quats"))
        struct.scale[:] = (self._keep(side_by_side(scales, n_scales, count, "scales")) + [None])[:3]
        struct.opacity = self._keep(side_by_side(opacities, 1, count, "opacities"))[0]
        harmonics = as_floats(sh, "sh")
        if harmonics.ndim == 2 and harmonics.shape[1] % 3 == 0:
            harmonics = harmonics.reshape(len(harmonics), harmonics.shape[1] // 3, 3)
        degree = {1: 0, 4: 1, 9: 2, 16: 3, 25: 4}.get(harmonics.shape[1] if harmonics.ndim == 3 else 0)
        if degree is None or harmonics.shape[0] != count or harmonics.shape[2] != 3:
            raise ArgumentError(f"sh: its shape is {numpy.shape(sh)}, and ({count}, K, 3) with K = 1, 4, 9, 16 or 25 "
                                "is needed")
        struct.sh = self._keep([numpy.ascontiguousarray(harmonics)])[0]
        struct.count, struct.sh_degree = count, degree
        if not isinstance(frame, str) or sorted(_AXES.get(letter, "") for letter in frame) != ["x", "y", "z"]:
            raise ArgumentError(f"frame: {frame!r} is not understood; three letters say where x, y and z point: "
                                "r or l, u or d, f or b")
        struct.frame = text_bytes(frame)
        struct.is_antialiased, struct.is_linear = int(antialiased), int(linear)
        self._struct = struct

    def __len__(self) -> int:
        return int(self._struct.count)

    @property
    def sh_degree(self) -> int:
        return int(self._struct.sh_degree)

    def _columns(self, places: Sequence[Any]) -> numpy.ndarray:
        found = [next(a for a in self._arrays if a.ctypes.data == place) for place in places if place]
        return numpy.stack(found, axis=1)

    @property
    def means(self) -> numpy.ndarray:
        """(N, 3), from the origin."""
        return self._columns(self._struct.position)

    @property
    def quats(self) -> numpy.ndarray:
        return self._columns(self._struct.rotation)

    @property
    def scales(self) -> numpy.ndarray:
        return self._columns(self._struct.scale)

    @property
    def opacities(self) -> numpy.ndarray:
        return self._columns([self._struct.opacity])[:, 0]

    @property
    def sh(self) -> numpy.ndarray:
        """(N, K, 3)."""
        return next(a for a in self._arrays if a.ctypes.data == self._struct.sh)

    @property
    def origin(self) -> numpy.ndarray:
        return numpy.array(self._struct.origin)

    @property
    def frame(self) -> str:
        return self._struct.frame.decode()

    def __repr__(self) -> str:
        return f"<conic.Gaussians {len(self)}, degree {self.sh_degree}>"


class Scene:
    """Files of any kind that conic draws, as one scene: see :func:`conic.open`.

    What was read for a picture stays for the next ones, whatever these show of it. Other ways of reading are read by
    themselves: `as_`, `method="patch"`, `profile="surface"`, `plain`, `color_by` and `ramp`, `where`, `columns`, `k`,
    `texture`, `smooth`, `crease`, `transparency`; of hierarchies `error` or `budget`, and `memory`; and `cutoff` of
    what has no axes of its own. The four ways that were drawn last stay."""

    def __init__(self, paths: Sequence[PathLike], *, folder: Optional[str] = None) -> None:
        self.paths = [os.fspath(path) for path in paths]
        self.statistics: Dict[str, Any] = {}  #: of the command that made it, if one did
        self._kept = Kept()
        self._folder = folder  # goes with the scene

    @property
    def path(self) -> str:
        """The first file."""
        return self.paths[0]

    def info(self, *, check: bool = False) -> Dict[str, Any]:
        """What `conic info` says of the file; with `check`, also what in it cannot be drawn."""
        return read_facts(run(["info", "--", self.path], [("check", True)] if check else [])[1])

    def gaussians(self) -> Gaussians:
        """The Gaussians of the file, as arrays."""
        read = layouts.Gaussians()
        with context() as (made, check):
            check(library.conic_gaussians_read(made, text_bytes(self.path), None, ctypes.byref(read)))
            try:
                n_scales = 3 if read.scale[2] else 2
                return Gaussians(
                    _copies(read.position, read.count), _copies(read.rotation, read.count),
                    _copies(list(read.scale)[:n_scales], read.count),
                    _copy(read.opacity, read.count),
                    _copy(read.sh, read.count * (read.sh_degree + 1)**2 * 3).reshape(read.count, -1, 3),
                    frame=read.frame.decode(), antialiased=bool(read.is_antialiased), linear=bool(read.is_linear),
                    origin=list(read.origin), up=list(read.up))
            finally:
                library.conic_gaussians_release(made, ctypes.byref(read))

    def splats(self) -> Splats:
        """The points or splats of the file, as arrays; of a mesh its vertices. Clip lines are left out."""
        read = layouts.Model()
        with context() as (made, check):
            check(library.conic_gaussians_read_model(made, text_bytes(self.path), None, ctypes.byref(read)))
            try:
                points, arrays = read.points, {}
                for name in [field[0] for field in layouts.Strides._fields_]:
                    member = getattr(points, name)
                    places = [member] if name in ("opacity", "dot", "scalar") else list(member)
                    if places[0]:
                        arrays[name] = (_copies(places, points.count) if len(places) > 1 else
                                        _copy(places[0], points.count))
                return Splats(origin=list(points.origin), **arrays)
            finally:
                library.conic_model_release(made, ctypes.byref(read))

    def close(self) -> None:
        """Forgets what was read; drawing reads it again. A temporary file goes."""
        self._kept.drop()
        if self._folder:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._folder = None

    def __enter__(self) -> "Scene":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __del__(self) -> None:
        folder = getattr(self, "_folder", None)
        if folder:
            with delaying_interrupts():
                shutil.rmtree(folder, ignore_errors=True)

    def __repr__(self) -> str:
        return f"<conic.Scene {', '.join(self.paths)}>"


def _copy(place: Any, count: int) -> numpy.ndarray:
    if not count:
        return numpy.zeros(0, numpy.float32)
    return numpy.ctypeslib.as_array((ctypes.c_float * count).from_address(place)).copy()


def _copies(places: Sequence[Any], count: int) -> Any:
    """Components; but rows where as many components as rows would be taken for rows."""
    found = tuple(_copy(place, count) for place in places)
    return numpy.stack(found, axis=1) if count == len(found) else found


AnyScene = Union[PathLike, Scene, Splats, Mesh, Gaussians, Sequence[Any]]


def open(*paths: PathLike) -> Scene:  # pylint: disable=redefined-builtin
    """A scene of one file, or of several together: splats, points, meshes, Gaussian scenes, octrees, layered clouds
    (also by their URL), hybrid models. Nothing is read yet but what says whether the files are there."""
    if not paths:
        raise ArgumentError("open: no file is named")
    for path in paths:
        text = os.fspath(path)
        if "://" not in text and not os.path.exists(text):
            from .errors import InputError
            raise InputError(f"{text}: cannot read: No such file or directory")
    return Scene(paths)
