"""A picture as one value: every number that decides it, by the names of the members of conic_shot
(include/conic/shot.h), and how its scene is read, by those of conic_source_options (include/conic/source.h)."""

from __future__ import annotations

import ctypes
import dataclasses
import math
import os
from dataclasses import dataclass, field
from typing import Any, Callable, ClassVar, Dict, List, Optional, Sequence, Tuple

from . import _layouts as layouts
from ._camera import Camera, PathLike
from ._library import PLANE_BY_NAME, PLANES, TONES, context, library, look, text_bytes, words_of
from .errors import ArgumentError

Triple = Tuple[float, float, float]

_ISAS = words_of("conic_isa_name")


class _Struct:
    """What maps to a struct of the library's, member by member."""

    _layout: ClassVar[Any]
    _words: ClassVar[Dict[str, Sequence[str]]] = {}  # of members that are numbers of an enumeration
    _lists: ClassVar[Dict[str, Tuple[str, Callable[[], Any]]]] = {}  # arrays: where their length is, and what they hold

    def _put(self, struct: Any, alive: List[Any]) -> None:
        """Fills a struct of the library's defaults; what it points to is kept in `alive`."""
        for member in dataclasses.fields(self):  # type: ignore[arg-type]
            if member.metadata.get("apart"):
                continue
            name = member.metadata.get("member", member.name)
            try:
                self._put_member(struct, name, getattr(self, member.name), alive)
            except (TypeError, ValueError, IndexError, ctypes.ArgumentError) as failure:
                raise ArgumentError(f"shot: {type(self).__name__}.{member.name}: {getattr(self, member.name)!r} is not "
                                    f"understood ({failure})") from None

    def _put_member(self, struct: Any, name: str, value: Any, alive: List[Any]) -> None:
        if name in self._words:
            setattr(struct, name, list(self._words[name]).index(value))
        elif name in self._lists:
            places = getattr(struct, name)
            setattr(struct, self._lists[name][0], len(value))
            for i, part in enumerate(value):
                part._put(places[i], alive)
        elif isinstance(value, _Struct):
            value._put(getattr(struct, name), alive)
        elif isinstance(value, Camera):
            setattr(struct, name, value._struct)
        elif isinstance(value, (list, tuple)):
            _put_numbers(getattr(struct, name), value)
        elif isinstance(value, str):
            setattr(struct, name, text_bytes(value))
        elif isinstance(value, bool) or value is None:
            setattr(struct, name, int(value) if value is not None else None)
        else:
            setattr(struct, name, value)

    @classmethod
    def _of(cls, struct: Any) -> Any:
        found: Dict[str, Any] = {}
        for member in dataclasses.fields(cls):  # type: ignore[arg-type]
            if not member.metadata.get("apart"):
                found[member.name] = cls._member_of(struct, member)
        return cls(**found)

    @classmethod
    def _member_of(cls, struct: Any, member: Any) -> Any:
        name = member.metadata.get("member", member.name)
        value = getattr(struct, name)
        if name in cls._words:
            return cls._words[name][value]
        if name in cls._lists:
            length, kind = cls._lists[name]
            return tuple(kind()._of(value[i]) for i in range(getattr(struct, length)))
        if isinstance(value, layouts.Camera):
            return Camera(value)
        if isinstance(value, ctypes.Structure):
            return member.default_factory()._of(value)
        if isinstance(value, bytes):
            return os.fsdecode(value)
        if member.type == "bool":
            return bool(value)
        return _numbers_of(value) if hasattr(value, "__len__") else value


def _numbers_of(values: Any) -> Any:
    return tuple(_numbers_of(value) if hasattr(value, "__len__") else value for value in values)


def _put_numbers(places: Any, values: Sequence[Any]) -> None:
    if len(places) != len(values):
        raise ValueError(f"{len(places)} numbers are needed")
    for i, value in enumerate(values):
        if hasattr(value, "__len__"):
            _put_numbers(places[i], value)
        else:
            places[i] = value


_Rows = Tuple[Triple, Triple]
_BLACK: Triple = (0.0, 0.0, 0.0)


@dataclass
class Way(_Struct):
    """Where the camera goes while the shutter is open."""

    _layout: ClassVar[Any] = layouts.CameraWay
    _words: ClassVar[Dict[str, Sequence[str]]] = {"kind": ("still", "orbit", "cameras")}
    kind: str = "still"
    frames_a_turn: float = 0.0
    center: Triple = _BLACK
    up: Triple = _BLACK
    cameras: Tuple[Camera, ...] = field(default=(), metadata={"apart": True})
    place: float = 0.0

    def _put(self, struct: Any, alive: List[Any]) -> None:
        super()._put(struct, alive)
        cameras = (layouts.Camera * max(1, len(self.cameras)))(*[camera._struct for camera in self.cameras])
        alive.append(cameras)
        struct.cameras, struct.n_cameras = cameras, len(self.cameras)

    @classmethod
    def _of(cls, struct: Any) -> "Way":
        made = super()._of(struct)
        made.cameras = tuple(Camera(struct.cameras[i]) for i in range(struct.n_cameras))
        return made


@dataclass
class Eye(_Struct):
    """One of two eyes."""

    _layout: ClassVar[Any] = layouts.StereoEye
    shift: float = 0.0
    convergence: float = 0.0
    center: Triple = _BLACK
    finds_convergence: bool = False


@dataclass
class Kernel(_Struct):
    """How a splat fades from its centre to its edge."""

    _layout: ClassVar[Any] = layouts.Kernel
    _words: ClassVar[Dict[str, Sequence[str]]] = {"type": words_of("conic_kernel_type_name")}
    type: str = "gauss"
    cutoff: float = 1.5
    a: float = 4.0
    b: float = 1.5
    n: int = 5


@dataclass
class Light(_Struct):
    """A light without a place."""

    _layout: ClassVar[Any] = layouts.Light
    _words: ClassVar[Dict[str, Sequence[str]]] = {"frame": ("world", "camera", "head")}
    frame: str = "world"
    color: Triple = (1.0, 1.0, 1.0)
    direction: Triple = _BLACK


@dataclass
class Lighting(_Struct):
    """Lights without a place, and light from all around."""

    _layout: ClassVar[Any] = layouts.Lighting
    _lists: ClassVar[Dict[str, Tuple[str, Callable[[], Any]]]] = {"lights": ("n_lights", lambda: Light)}
    is_given: bool = False
    lights: Tuple[Light, ...] = ()
    sky: Triple = _BLACK
    ground: Triple = _BLACK
    up: Triple = _BLACK


@dataclass
class Render(_Struct):
    """How splats and triangles are drawn: conic_render_options."""

    _layout: ClassVar[Any] = layouts.RenderOptions
    _words: ClassVar[Dict[str, Sequence[str]]] = {"method": words_of("conic_method_name"),
                                                  "shading": words_of("conic_shading_name"), "isa": _ISAS}
    method: str = "auto"
    kernel: Kernel = field(default_factory=Kernel)
    prefilter: float = 1.0
    epsilon: float = -1.0
    passes: int = 3
    cull_back: bool = False
    near_z: float = 0.0
    splat_length: float = 0.0
    shading: str = "phong"
    has_light: bool = False
    light: Triple = _BLACK
    has_background: bool = False
    background: Triple = _BLACK
    exposure: float = 0.0
    tile: int = 64
    isa: str = "auto"
    lighting: Lighting = field(default_factory=Lighting)


@dataclass
class View(_Struct):
    """How much is drawn: conic_source_view."""

    _layout: ClassVar[Any] = layouts.SourceView
    _words: ClassVar[Dict[str, Sequence[str]]] = {"occlusion": ("auto", "on", "off"),
                                                  "transparency": ("none", "layers", "chance")}
    error_px: float = 0.0
    budget: int = 0
    only_kind: int = -1
    samples: int = 1
    most_levels: int = 0
    occlusion: str = "auto"
    may_be_coarser: bool = False
    seconds: float = 0.0
    tolerates_damage: bool = False
    color_error: float = 2.0
    transparency: str = "none"
    chance: float = 0.0
    is_alone: bool = False


@dataclass
class Compositing(_Struct):
    """How Gaussian scenes are composited: conic_gaussian_options."""

    _layout: ClassVar[Any] = layouts.GaussianOptions
    _words: ClassVar[Dict[str, Sequence[str]]] = {"profile": words_of("conic_gaussian_profile_name"), "isa": _ISAS}
    profile: str = "exact"
    background: Triple = _BLACK
    isa: str = "auto"
    ignores_center: int = 0
    prefilter: float = 0.0


@dataclass
class Lamp(_Struct):
    """A light that stands in the scene."""

    _layout: ClassVar[Any] = layouts.Lamp
    _words: ClassVar[Dict[str, Sequence[str]]] = {"kind": ("sphere", "disc", "rectangle")}
    kind: str = "sphere"
    color: Triple = (1.0, 1.0, 1.0)
    position: Triple = _BLACK
    radius: float = 0.0
    axes: _Rows = (_BLACK, _BLACK)


@dataclass
class HiddenLight(_Struct):
    """Light that may be hidden, and lamps: conic_shot_light."""

    _layout: ClassVar[Any] = layouts.ShotLight
    _lists: ClassVar[Dict[str, Tuple[str, Callable[[], Any]]]] = {"lamps": ("n_lamps", lambda: Lamp)}
    n_directions: int = 0
    has_shadows: bool = False
    lamps: Tuple[Lamp, ...] = ()
    sun_radius_deg: Tuple[float, ...] = (0.0,) * layouts.MAX_LIGHTS
    sky: Optional[str] = field(default=None, metadata={"apart": True})  #: the file of a picture of all directions
    reflectance: float = 0.0
    dome_stops: float = 0.0


@dataclass
class Aperture(_Struct):
    """A lens."""

    _layout: ClassVar[Any] = layouts.Aperture
    diameter: float = 0.0
    focus: float = 0.0
    n_blades: int = 0


@dataclass
class Surface(_Struct):
    """The polynomials of `method="patch"`: conic_surface_options."""

    _layout: ClassVar[Any] = layouts.Surface
    _words: ClassVar[Dict[str, Sequence[str]]] = {"type": ("mls", "apss"), "plane": ("full", "fast"),
                                                  "weight": ("gauss", "compact", "flat"), "isa": _ISAS}
    type: str = "mls"
    plane: str = "full"
    weight: str = "gauss"
    degree: int = 3
    h: float = 0.0
    neglect: float = 2.0
    n_local: int = 32
    cluster: float = 0.0
    isa: str = "auto"
    is_sharp: int = 0


@dataclass
class Patches(_Struct):
    """How points become patches."""

    _layout: ClassVar[Any] = layouts.Patches
    surface: Surface = field(default_factory=Surface)
    cutoff: float = 1.5
    step_px: float = 2.0


@dataclass
class Coloring(_Struct):
    """What colours are made of."""

    _layout: ClassVar[Any] = layouts.Coloring
    by: Optional[str] = "rgb"
    ramp: Optional[str] = None
    has_range: bool = False
    minimum: float = 0.0
    maximum: float = 0.0
    up: Triple = _BLACK


@dataclass
class Access(_Struct):
    """Memory and patience of what is read in parts; they decide no bit."""

    _layout: ClassVar[Any] = layouts.Access
    memory_bytes: int = 512 << 20
    connect_seconds: float = 10.0
    stall_seconds: float = 15.0
    n_retries: int = 4
    pause_seconds: float = 0.2
    n_connections: int = 4
    seconds: float = 0.0


@dataclass
class Reading(_Struct):
    """How the scene's files become what is drawn: conic_source_options."""

    _layout: ClassVar[Any] = layouts.Reading
    _words: ClassVar[Dict[str, Sequence[str]]] = {"as": ("points", "mesh", "hybrid", "patches", "auto"),
                                                 "colors_are": ("file", "display", "linear")}
    as_: str = field(default="auto", metadata={"member": "as"})
    is_whole: bool = False
    cutoff: float = 1.5
    n_neighbours: int = 20
    texture_path: Optional[str] = None
    is_smooth: bool = False
    access: Optional[Access] = field(default=None, metadata={"apart": True})
    patches: Optional[Patches] = field(default=None, metadata={"apart": True})
    h_in_spacings: bool = False
    projects_degrees: bool = True
    finds_dots: bool = True
    coloring: Optional[Coloring] = field(default=None, metadata={"apart": True})
    columns: Optional[str] = None
    crease_deg: float = 30.0
    gaussians: bool = field(default=True, metadata={"apart": True})  #: they are composited, and no splats like others
    where: Optional[str] = None
    keeps_alpha: bool = False
    cache: Optional[str] = None
    colors_are: str = "file"
    place: Optional[str] = None
    most_raw: int = 0

    def _put(self, struct: Any, alive: List[Any]) -> None:
        super()._put(struct, alive)
        for name, value in (("access", self.access), ("patches", self.patches), ("coloring", self.coloring)):
            if value is not None:
                made = _made(value, alive)
                setattr(struct, name, ctypes.pointer(made))
        if self.gaussians:
            struct.gaussians = ctypes.pointer(_made(Compositing(), alive))

    @classmethod
    def _of(cls, struct: Any) -> "Reading":
        made = super()._of(struct)
        made.access = Access._of(struct.access.contents) if struct.access else None
        made.patches = Patches._of(struct.patches.contents) if struct.patches and made.as_ == "patches" else None
        made.coloring = Coloring._of(struct.coloring.contents) if struct.coloring else None
        made.gaussians = bool(struct.gaussians)
        return made


@dataclass
class Input(_Struct):
    """A file that a picture is made of."""

    _layout: ClassVar[Any] = layouts.ShotInput
    _words: ClassVar[Dict[str, Sequence[str]]] = {"role": ("scene", "texture", "sky", "motion", "part")}
    name: str
    role: str = "scene"
    is_sampled: bool = False
    n_bytes: int = 0
    sha256: str = ""  #: empty: not looked at yet, or of a URL


@dataclass
class Map(_Struct):
    """A map: `camera="top"` of the program."""

    _layout: ClassVar[Any] = layouts.ShotMap
    is_wanted: bool = False
    epsg: int = 0
    pixel: float = 0.0
    minimum: Triple = (-math.inf, -math.inf, -math.inf)
    maximum: Triple = (math.inf, math.inf, math.inf)


@dataclass
class Writing(_Struct):
    """How the program makes files of the picture."""

    _layout: ClassVar[Any] = layouts.ShotWriting
    _words: ClassVar[Dict[str, Sequence[str]]] = {"tone": TONES, "compression": words_of("conic_compression_name")}
    tone: str = "srgb"
    compression: str = "zip"
    is_half: bool = False
    is_bare: bool = False
    has_legend: bool = False
    has_mattes: bool = False
    matte_by: Optional[str] = None


@dataclass
class Shot(_Struct):
    """A picture as one value: every number that decides a bit of it. :func:`conic.render` draws it, with the same bits
    each time; `Picture.shot` is the one that a picture was drawn by, with all numbers that were found for it.

        shot = conic.render(scene, size=(640, 480)).shot
        brighter = dataclasses.replace(shot, render=dataclasses.replace(shot.render, exposure=1.0))
        conic.render(scene, brighter)

    `shot.save("x.shot.json")` and `Shot.open("x.shot.json")` are the files of `conic render --save-shot`; pictures that
    carry a shot can be opened, too. The members are conic_shot's: include/conic/shot.h says what they mean. `reading`
    says how the scene is read."""

    _layout: ClassVar[Any] = layouts.Shot
    _words: ClassVar[Dict[str, Sequence[str]]] = {"focus_kind": ("middle", "depth", "pixel")}
    camera: Camera
    way: Way = field(default_factory=Way)
    eye: Eye = field(default_factory=Eye)
    planes: Tuple[str, ...] = field(default=("rgba", "Z"), metadata={"apart": True})
    render: Render = field(default_factory=Render)
    view: View = field(default_factory=View)
    gaussians: Compositing = field(default_factory=Compositing)
    light: HiddenLight = field(default_factory=HiddenLight)
    has_backdrop: bool = False
    backdrop_top: Triple = _BLACK
    backdrop_bottom: Triple = _BLACK
    n_samples: int = 0
    noise: float = 0.0
    aperture: Aperture = field(default_factory=Aperture)
    focus_kind: str = "middle"
    is_shutter_open: bool = False
    focus_pixel: Tuple[float, float] = (0.0, 0.0)
    shutter: Tuple[float, float] = (0.0, 0.0)
    frame: float = 0.0
    catchers: int = 0
    holdouts: int = 0
    motion: Optional[str] = field(default=None, metadata={"apart": True})  #: the file of the inputs' motion
    reading: Reading = field(default_factory=Reading, metadata={"apart": True})
    map: Map = field(default_factory=Map, metadata={"apart": True})
    writing: Writing = field(default_factory=Writing, metadata={"apart": True})
    inputs: Tuple[Input, ...] = field(default=(), metadata={"apart": True})  #: those of the scene, by their names; more

    def _put(self, struct: Any, alive: List[Any]) -> None:
        if not isinstance(self.camera, Camera):
            raise ArgumentError(f"shot: a Camera is needed, not {type(self.camera)}")
        super()._put(struct, alive)
        struct.planes = 0
        for name in self.planes:
            if name not in PLANE_BY_NAME:
                raise ArgumentError(f"shot: there is no plane {name}")
            struct.planes |= 1 << PLANE_BY_NAME[name].number

    @classmethod
    def _of(cls, struct: Any) -> "Shot":
        made = super()._of(struct)
        made.planes = tuple(plane.name for plane in PLANES if struct.planes >> plane.number & 1)
        return made

    # --- files ---

    def _named(self) -> Tuple[Tuple[str, str], ...]:
        """The inputs that are named, and what each is."""
        besides = (("texture", self.reading.texture_path), ("sky", self.light.sky), ("motion", self.motion))
        return (*(("scene", known.name) for known in self.inputs if known.role == "scene"),
                *((role, name) for role, name in besides if name))

    def _file(self, alive: List[Any]) -> layouts.ShotFile:
        """The struct of the file; its inputs that are known already have what they hold."""
        file = layouts.ShotFile()
        library.conic_shot_file_init_sized(ctypes.byref(file), ctypes.sizeof(file))
        file.shot, file.reading = _made(self, alive), _made(self.reading, alive)
        self.map._put(file.map, alive)
        self.writing._put(file.writing, alive)
        known = self.inputs if self._is_looked_at() else [Input(name, role) for role, name in self._named()]
        inputs = (layouts.ShotInput * max(1, len(known)))()
        for place, given in zip(inputs, known):
            given._put(place, alive)
        alive.append(inputs)
        file.inputs, file.n_inputs = inputs, len(known)
        return file

    def _is_looked_at(self) -> bool:
        named = [known for known in self.inputs if known.role != "part"]
        return tuple((known.role, known.name) for known in named) == self._named() and all(
            known.sha256 or "://" in known.name or known.name == "-" for known in named)

    @classmethod
    def _of_file(cls, file: layouts.ShotFile) -> "Shot":
        made = cls._of(file.shot)
        made.reading, made.map, made.writing = Reading._of(file.reading), Map._of(file.map), Writing._of(file.writing)
        made.inputs = tuple(Input._of(file.inputs[i]) for i in range(file.n_inputs))
        return made._with_besides()

    def _with_besides(self) -> "Shot":
        """With texture, sky and motion as the inputs name them."""
        names = {known.role: known.name for known in self.inputs}
        self.reading.texture_path, self.light.sky, self.motion = (
            names.get(role) for role in ("texture", "sky", "motion"))
        return self

    @classmethod
    def _parsed(cls, read: Callable[[int, Any], int]) -> "Shot":
        file = ctypes.POINTER(layouts.ShotFile)()
        with context() as (made, check):
            check(read(made, ctypes.byref(file)))
            try:
                return cls._of_file(file.contents)
            finally:
                library.conic_shot_file_destroy(made, file)

    @classmethod
    def open(cls, path: PathLike) -> "Shot":
        """The shot of a file, or of a picture that carries one: an EXR, a PNG or a TIFF. `inputs` says what it was
        drawn from; the scene that is drawn is the one that :func:`conic.render` is given."""
        made = cls._parsed(lambda context, file: library.conic_shot_file_read(context, text_bytes(path), file))
        for known in made.inputs:  # pictures name them without their folders
            beside = os.path.join(os.path.dirname(os.fspath(path)), known.name)
            if known.role != "part" and not os.path.exists(known.name) and os.path.exists(beside):
                known.name = beside
        return made._with_besides()

    def complete(self) -> "Shot":
        """The same with all inputs, also those that others lead to, and what they hold. Those that are not known yet
        are read. What decides no bit is as it is by default."""
        alive: List[Any] = []
        if not self._named() or self._is_looked_at():
            return self
        text = look(self._file(alive))
        return self._parsed(lambda made, file: library.conic_shot_file_parse(made, b"shot", text, len(text), file))

    def save(self, path: PathLike) -> None:
        """Writes what `conic render` draws again, as `--save-shot` does; reads the inputs for it, as `complete`. A shot
        of arrays has none: it can be opened, and drawn of arrays."""
        alive: List[Any] = []
        file = self.complete()._file(alive)
        with context() as (made, check):
            check(library.conic_shot_file_write(made, ctypes.byref(file), text_bytes(path)))

    def key(self) -> str:
        """The program's "shot_key": however a picture was asked for, it has one. Reads the inputs, as `complete`."""
        alive: List[Any] = []
        file, key = self.complete()._file(alive), ctypes.create_string_buffer(65)
        with context() as (made, check):
            check(library.conic_shot_file_key(made, ctypes.byref(file), key))
        return key.value.decode()

    def text(self) -> bytes:
        """What pictures carry: inputs are without their folders."""
        alive: List[Any] = []
        file, text = self.complete()._file(alive), ctypes.c_void_p()
        with context() as (made, check):
            check(library.conic_shot_file_print(made, ctypes.byref(file), _IN_PICTURE, ctypes.byref(text)))
            try:
                return ctypes.string_at(text.value or 0)
            finally:
                library.conic_shot_text_release(made, text)


_IN_PICTURE = 1

_INIT = {layouts.Shot: "conic_shot_init_sized", layouts.Reading: "conic_source_options_init_sized",
         layouts.Access: "conic_layers_access_init_sized", layouts.Patches: "conic_patches_options_init_sized",
         layouts.Coloring: "conic_coloring_options_init_sized",
         layouts.GaussianOptions: "conic_gaussian_options_init_sized"}


def _made(value: _Struct, alive: List[Any]) -> Any:
    """A struct of the library's defaults, and what the value says."""
    made = value._layout()
    getattr(library, _INIT[value._layout])(ctypes.byref(made), ctypes.sizeof(made))
    value._put(made, alive)
    alive.append(made)
    return made


def structs_of(shot: Shot) -> Tuple[Any, Any, List[Any]]:
    """The shot and how it is read as structs, and what has to live as long."""
    alive: List[Any] = []
    return _made(shot, alive), _made(shot.reading, alive), alive


class Sketch:
    """A shot as it was drawn, copied out of a run; a :class:`Shot` is made of it when somebody asks."""

    def __init__(self, drawn: layouts.Drawn, planes: Sequence[str], inputs: Sequence[str]) -> None:
        self._shot = layouts.Shot.from_buffer_copy(drawn.shot.contents)
        self._reading = layouts.Reading.from_buffer_copy(drawn.opening.contents)
        self._writing = layouts.ShotWriting.from_buffer_copy(drawn.writing.contents)
        self._planes = tuple(planes)
        self._inputs = inputs
        self._sky = drawn.sky_path and os.fsdecode(drawn.sky_path)
        self._motion = drawn.motion_path and os.fsdecode(drawn.motion_path)
        way = self._shot.way
        self._cameras = (layouts.Camera * max(1, way.n_cameras))()
        if way.n_cameras:
            ctypes.memmove(self._cameras, way.cameras, ctypes.sizeof(self._cameras))
        way.cameras = self._cameras
        self._parts = []  # what the options of reading point to: the run's
        for name in ("access", "patches", "coloring"):
            if place := getattr(self._reading, name):
                part = type(place.contents).from_buffer_copy(place.contents)
                self._parts.append(part)
                setattr(self._reading, name, ctypes.pointer(part))
        for part, names in ((self._reading, ("texture_path", "columns", "where")), (self._writing, ("matte_by",)),
                            *((part, ("by", "ramp")) for part in self._parts if isinstance(part, layouts.Coloring))):
            for name in names:  # likewise
                setattr(part, name, getattr(part, name))

    def shot(self) -> Shot:
        made = Shot._of(self._shot)
        made.planes, made.reading = self._planes, Reading._of(self._reading)
        made.light.sky, made.motion, made.writing = self._sky, self._motion, Writing._of(self._writing)
        made.inputs = tuple(Input(name) for name in self._inputs if not name.startswith("memory:"))
        return made
