"""Pictures: planes of pixels by name, with what drawing them took."""

from __future__ import annotations

import ctypes
import dataclasses
import os
import struct
import zlib
from typing import Any, Dict, List, Optional

import numpy

from . import _layouts as layouts
from ._camera import Camera, PathLike
from ._library import PLANE_BY_NAME, TONES, context, library, text_bytes
from .errors import ArgumentError


class Hashes(Dict[str, str]):
    """The planes' hashes by name, 16 hexadecimal digits each, as the program's JSON has them. Each is found when it
    is asked for first, since that takes as long as drawing a small picture."""

    def __init__(self, picture: "Picture") -> None:
        super().__init__(dict.fromkeys(picture.planes, ""))
        # Not the picture itself, which holds these: its memory would stay until Python looks for cycles.
        self._drawn = Picture({name: picture[name] for name in picture.planes})

    def __getitem__(self, name: str) -> str:
        found = super().__getitem__(name)
        if not found:
            found = self._drawn.hash(name)
            self[name] = found
        return found

    def _found(self) -> Dict[str, str]:
        return {name: self[name] for name in self}

    def get(self, name: str, default: Any = None) -> Any:
        return self[name] if name in self else default

    def items(self) -> Any:
        return self._found().items()

    def values(self) -> Any:
        return self._found().values()

    def __eq__(self, other: object) -> bool:
        return self._found() == (other._found() if isinstance(other, Hashes) else other)

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __repr__(self) -> str:
        return repr(self._found())


class Picture(Dict[str, Any]):
    """What :func:`conic.render` returns: arrays by the names of planes ("rgba": (H, W, 4), "Z": (H, W), …), and
    "statistics". It shows itself in a notebook."""

    def __init__(self, planes: Dict[str, numpy.ndarray], image: Optional[layouts.Image] = None,
                 camera: Optional[Camera] = None) -> None:
        super().__init__(planes)
        self.camera = camera  #: from which it was drawn
        self._told: Any = None  # makes the statistics
        self._sketch: Any = None  # makes the shot
        self._shot: Any = None
        self._header = layouts.Image()
        if image is not None:
            self._header.n_attributes = image.n_attributes
            self._header.attributes = image.attributes
            self._header.is_display = image.is_display

    def __reduce__(self) -> Any:
        self._tell()
        return _picture_again, (dict(self), bytes(self._header), self.camera, self.shot)

    # "statistics" are made when somebody asks for them.

    def _tell(self) -> None:
        told, self._told = self._told, None
        if told is not None:
            super().__setitem__("statistics", {**told(), "hash": Hashes(self)})

    def __missing__(self, key: str) -> Any:
        if key != "statistics" or self._told is None:
            raise KeyError(key)
        self._tell()
        return self[key]

    def __contains__(self, key: object) -> bool:
        return super().__contains__(key) or (key == "statistics" and self._told is not None)

    def __iter__(self) -> Any:
        self._tell()
        return super().__iter__()

    def __len__(self) -> int:
        return super().__len__() + (self._told is not None)

    def get(self, key: str, default: Any = None) -> Any:
        return self[key] if key in self else default

    def keys(self) -> Any:
        self._tell()
        return super().keys()

    def items(self) -> Any:
        self._tell()
        return super().items()

    def values(self) -> Any:
        self._tell()
        return super().values()

    @property
    def shot(self) -> Any:
        """The :class:`conic.Shot` that it was drawn by; None of pictures that were not drawn here."""
        if self._sketch is not None:
            self._shot, self._sketch = self._sketch.shot(), None
        return self._shot

    @property
    def planes(self) -> List[str]:
        """The names of the planes that there are."""
        return [name for name in super().keys() if name != "statistics"]

    @property
    def statistics(self) -> Dict[str, Any]:
        """What the program's --json says of the run."""
        return self["statistics"]

    @property
    def is_display(self) -> bool:
        """Whether rgba are display values, as Gaussian scenes have them, and not linear."""
        return bool(self._header.is_display)

    def image(self) -> layouts.Image:
        """The planes as the library takes them; they stay this picture's."""
        made = layouts.Image.from_buffer_copy(self._header)
        kept = []
        for name in self.planes:
            plane = PLANE_BY_NAME[name]
            array = numpy.ascontiguousarray(self[name], dtype=plane.dtype)
            wanted = array.shape[:2] + (() if plane.channels == 1 else (plane.channels,))
            if array.shape != wanted or (made.width and array.shape[:2] != (made.height, made.width)):
                raise ArgumentError(f"picture: the plane {name} has the shape {array.shape}")
            made.height, made.width = array.shape[:2]
            made.planes[plane.number] = array.ctypes.data
            kept.append(array)
        made._kept = kept  # alive as long as the struct
        return made

    def hash(self, plane: str = "rgba") -> str:
        """The plane's hash, as the program's --json says it."""
        alone = Picture({plane: self[plane]})
        image = alone.image()
        return f"{library.conic_image_hash(ctypes.byref(image), PLANE_BY_NAME[plane].number):016x}"

    def save(self, path: PathLike, *, tone: str = "srgb", shot: bool = False) -> None:
        """Writes .exr (all planes), .png, .pfm …, as the ending says; without a background, as they are. `tone`, of
        what has 8 or 16 bits: "srgb", "filmic", "aces" or "agx". With `shot`, an .exr, .png or .tif says how the
        picture was drawn, as the program's do, and `conic render --again` draws it again; the inputs are read for
        that."""
        image, options = self.image(), layouts.ImageOptions()
        library.conic_image_options_init_sized(ctypes.byref(options), ctypes.sizeof(options))
        if tone not in TONES:
            raise ArgumentError(f"tone: {tone} is none of {', '.join(TONES)}")
        options.tone = TONES.index(tone)
        if shot:
            if self.shot is None:
                raise ArgumentError("shot: nobody knows how the picture was drawn")
            is_exr = os.fsdecode(path).lower().endswith(".exr")
            writing = dataclasses.replace(self.shot.writing, tone="srgb" if is_exr or self.is_display else tone,
                                          compression="zip", is_half=False, is_bare=not is_exr, has_legend=False,
                                          has_mattes=False, matte_by=None)
            image.shot = dataclasses.replace(self.shot, writing=writing).text()
        with context() as (made, check):
            check(library.conic_image_write_as(made, text_bytes(path), ctypes.byref(image), ctypes.byref(options)))

    def to_uint8(self, *, backdrop: bool = True) -> numpy.ndarray:
        """(H, W, 3) sRGB codes to look at: over the greys that the program's PNG has behind, or over black."""
        rgba = self["rgba"].astype(numpy.float32)
        color, alpha = rgba[..., :3], rgba[..., 3:]
        if self.is_display:
            return _codes(color)
        if backdrop:
            top, bottom = numpy.array([0.08, 0.088, 0.1], "f4"), numpy.array([0.022, 0.023, 0.025], "f4")
            part = ((numpy.arange(rgba.shape[0], dtype=numpy.float32) + 0.5) / rgba.shape[0])[:, None, None]
            color = color + (top + (bottom - top) * part) * (1.0 - alpha)
        linear = numpy.clip(numpy.nan_to_num(color), 0.0, 1.0)
        return _codes(numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear**(1 / 2.4) - 0.055))

    def _repr_png_(self) -> Optional[bytes]:
        return encode_png(self.to_uint8()) if "rgba" in self else None

    def __repr__(self) -> str:
        shapes = ", ".join(f"{name} {self[name].shape}" for name in self.planes)
        return f"<conic.Picture {shapes}>"


def _picture_again(planes: Dict[str, Any], header: bytes, camera: Optional[Camera], shot: Any) -> Picture:
    """A picture that was pickled."""
    made = Picture(planes, layouts.Image.from_buffer_copy(header), camera)
    made._shot = shot
    return made


def _codes(values: numpy.ndarray) -> numpy.ndarray:
    return (numpy.clip(numpy.nan_to_num(values), 0.0, 1.0) * 255.0 + 0.5).astype(numpy.uint8)


def encode_png(codes: numpy.ndarray) -> bytes:
    """A PNG of (H, W, 3 or 4) bytes."""
    height, width, channels = codes.shape
    rows = numpy.zeros((height, 1 + width * channels), numpy.uint8)
    rows[:, 1:] = codes.reshape(height, -1)

    def chunk(name: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    header = struct.pack(">IIBBBBB", width, height, 8, {3: 2, 4: 6}[channels], 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) +
            chunk(b"IEND", b""))
