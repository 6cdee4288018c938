"""Cameras: x right, y down, z forward, as COLMAP, OpenCV and gsplat have them; pixel centres at + 0.5."""

from __future__ import annotations

import ctypes
import json
import math
import os
from typing import Any, Dict, List, Optional, Sequence, Union

import numpy

from . import _layouts as layouts
from ._arrays import as_numpy
from ._library import context, library, text_bytes
from .errors import ArgumentError

PathLike = Union[str, "os.PathLike[str]"]


def _whole(value: Any, name: str) -> int:
    if isinstance(value, (bool, str)) or not 1 <= value <= 65535 or value != int(value):
        raise ArgumentError(f"camera: {name}: {value} is no whole number from 1 to 65535")
    return int(value)


class Camera:
    """Where a picture is taken from, and how.

    Made by :meth:`look_at`, :meth:`from_K`, :meth:`from_file` or :meth:`from_colmap`."""

    def __init__(self, struct: layouts.Camera, name: str = "") -> None:
        self._struct = layouts.Camera.from_buffer_copy(struct)
        self.name = name  #: of the view, as its file has it

    @classmethod
    def from_K(cls, viewmat: Any, K: Any, width: int, height: int) -> "Camera":  # pylint: disable=invalid-name
        """A pinhole of a view matrix (world to camera, 4 × 4 or 3 × 4) and intrinsics (3 × 3), as gsplat takes them.

        Leading dimensions of length 1 are fine."""
        view = numpy.asarray(as_numpy(viewmat, "viewmat"), dtype=numpy.float64)
        inner = numpy.asarray(as_numpy(K, "K"), dtype=numpy.float64)
        view, inner = (matrix[(0,) * (matrix.ndim - 2)] if set(matrix.shape[:-2]) <= {1} else matrix
                       for matrix in (view, inner))
        if view.shape not in ((4, 4), (3, 4)) or inner.shape != (3, 3):
            raise ArgumentError(f"camera: viewmat is {view.shape} and K {inner.shape}; 4 × 4 and 3 × 3 are needed")
        if inner[0, 1] != 0.0 or inner[1, 0] != 0.0:
            raise ArgumentError("camera: K has a skew, which no camera of conic's has")
        struct = layouts.Camera()
        struct.width, struct.height = _whole(width, "width"), _whole(height, "height")
        struct.fx, struct.fy, struct.cx, struct.cy = inner[0, 0], inner[1, 1], inner[0, 2], inner[1, 2]
        for row in range(3):
            struct.cam_from_world[row][:] = view[row].tolist()
        return cls(struct)

    @classmethod
    def look_at(cls, eye: Sequence[float], target: Sequence[float] = (0.0, 0.0, 0.0),
                up: Sequence[float] = (0.0, 1.0, 0.0), *, fov: float = 40.0, width: int = 1024,
                height: int = 1024) -> "Camera":
        """A pinhole at `eye` that has `target` in its middle; `fov` degrees across the shorter side."""
        if not 0.0 < fov < 180.0:
            raise ArgumentError(f"camera: a field of view of {fov} degrees cannot be")
        place, aim, above = (as_numpy(v, name) for v, name in ((eye, "eye"), (target, "target"), (up, "up")))
        if any(v.shape != (3,) or v.dtype.kind not in "fiu" for v in (place, aim, above)):
            raise ArgumentError("camera: eye, target and up are three numbers each")
        place, aim, above = (v.astype(numpy.float64) for v in (place, aim, above))
        forward = aim - place
        right = numpy.cross(forward, above)
        if not numpy.linalg.norm(right) > 0.0:
            raise ArgumentError("camera: up must not point along the view, nor the eye be at the target")
        forward, right = forward / numpy.linalg.norm(forward), right / numpy.linalg.norm(right)
        rotation = numpy.stack([right, numpy.cross(forward, right), forward])
        view = numpy.concatenate([rotation, -(rotation @ place)[:, None]], axis=1)
        focal = 0.5 * min(width, height) / math.tan(math.radians(0.5 * fov))
        return cls.from_K(view, [[focal, 0, 0.5 * width], [0, focal, 0.5 * height], [0, 0, 1]], width, height)

    @classmethod
    def from_file(cls, path: PathLike, view: Optional[Union[int, str]] = None, *,
                  size: Optional[Sequence[int]] = None) -> "Camera":
        """A camera of a file or folder, of any kind that `conic render --camera` takes. `view` is a number from 0 or
        the name of an image; files of one camera need none. `size` (width, height) scales it."""
        found = list_cameras(path, size=size, view=None if view is None else str(view))
        if len(found) != 1:
            names = ", ".join(camera.name for camera in found[:3] if camera.name)
            raise ArgumentError(f"{os.fspath(path)}: it has {len(found)} views{': ' + names + ' …' if names else ''}; "
                                "give view=, too")
        return found[0]

    @classmethod
    def from_colmap(cls, path: PathLike, view: Optional[Union[int, str]] = None, *,
                    size: Optional[Sequence[int]] = None) -> "Camera":
        """The camera of an image of a COLMAP model: its folder, or one above with sparse/0."""
        return cls.from_file(path, view, size=size)

    # --- what it is ---

    @property
    def width(self) -> int:
        return int(self._struct.width)

    @property
    def height(self) -> int:
        return int(self._struct.height)

    @property
    def viewmat(self) -> numpy.ndarray:
        """World to camera, 4 × 4."""
        matrix = numpy.eye(4)
        matrix[:3] = numpy.ctypeslib.as_array(self._struct.cam_from_world)
        return matrix

    @property
    def K(self) -> numpy.ndarray:  # pylint: disable=invalid-name
        """The intrinsics, 3 × 3."""
        s = self._struct
        return numpy.array([[s.fx, 0.0, s.cx], [0.0, s.fy, s.cy], [0.0, 0.0, 1.0]])

    @property
    def position(self) -> numpy.ndarray:
        """Where it stands in the world."""
        matrix = self.viewmat
        return -matrix[:3, :3].T @ matrix[:3, 3]

    @property
    def kind(self) -> str:
        """"perspective", "fisheye", "orthographic", "equirectangular" or "cube"."""
        return library.conic_camera_kind_name(self._struct.kind).decode()

    @property
    def lens(self) -> str:
        """"none", "radial", "opencv", "thin-prism", "fov", "division" or "eucm"."""
        return library.conic_lens_name(self._struct.lens).decode()

    def resized(self, width: int, height: int) -> "Camera":
        """The same view in another size; each axis grows by itself."""
        made = Camera(self._struct, self.name)
        s = made._struct
        s.width, s.height = _whole(width, "width"), _whole(height, "height")
        across, down = s.width / self.width, s.height / self.height
        s.fx, s.cx, s.fy, s.cy = s.fx * across, s.cx * across, s.fy * down, s.cy * down
        return made

    def as_dict(self) -> Dict[str, Any]:
        """As conic's JSON has it."""
        s = self._struct
        said: Dict[str, Any] = {"width": self.width, "height": self.height, "fx": s.fx, "fy": s.fy, "cx": s.cx,
                                "cy": s.cy}
        if self.kind != "perspective":
            said["kind"] = self.kind
        if self.lens != "none":
            said["lens"], said["distortion"] = self.lens, list(s.distortion)
        said["world_to_camera"] = self.viewmat.tolist()
        return said

    def save(self, path: PathLike) -> None:
        """Writes conic's JSON, which `conic render --camera` takes."""
        with open(path, "w", encoding="utf-8") as file:
            json.dump(self.as_dict(), file, indent=2)
            file.write("\n")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Camera) and bytes(self._struct) == bytes(other._struct)

    def __hash__(self) -> int:
        return hash(bytes(self._struct))

    def __repr__(self) -> str:
        place = ", ".join(f"{part:.6g}" for part in self.position)
        return f"<conic.Camera {self.width} x {self.height} at ({place}){' ' + self.name if self.name else ''}>"


def list_cameras(path: PathLike, *, size: Optional[Sequence[int]] = None, view: Optional[str] = None) -> List[Camera]:
    """All cameras of a file or folder, in its order; or the one that `view` names."""
    options = layouts.CamerasOptions(ctypes.sizeof(layouts.CamerasOptions), *(size or (0, 0)))
    read = layouts.Cameras()
    with context() as (made, check):
        check(library.conic_cameras_read(made, text_bytes(path), ctypes.byref(options), ctypes.byref(read)))
        try:
            chosen = range(read.count)
            if view is not None:
                index = ctypes.c_size_t()
                check(library.conic_cameras_find(made, ctypes.byref(read), text_bytes(view), ctypes.byref(index)))
                chosen = range(index.value, index.value + 1)
            return [Camera(read.cameras[i], (read.names[i] or b"").decode(errors="replace")) for i in chosen]
        finally:
            library.conic_cameras_release(made, ctypes.byref(read))
