"""The program's commands as functions. Options have the program's names, with _ for -; None is the program's default.

`size=(640, 480)`, `eye=(1, 2, 3)`, `light=["studio", "camera:1,1,2"]`, `smooth=True`, `epsilon="2x"`: numbers, words,
sequences of numbers, and True for what is a flag; where a word is Python's own, with a _ behind it (`as_="mesh"`)."""

from __future__ import annotations

import copy
import ctypes
import inspect
import keyword
import os
import re
import tempfile
from typing import Any, Dict, List, Optional, Sequence, Set, Tuple, Union

import numpy

from . import _layouts as layouts
from ._arrays import as_numpy
from ._camera import Camera, PathLike
from ._library import Frames, Kept, draw, kept_of_thread, read_facts, run
from ._picture import Picture, encode_png
from ._scene import AnyScene, Scene, Splats, _InMemory
from ._shot import Shot, Sketch, structs_of
from .errors import ArgumentError

Loans = List[Tuple[str, ctypes.Structure]]
AnyCamera = Union[Camera, PathLike]
Options = Any
_REPEATED = {"light", "o"}


_DEEPEST = 8  # lists within lists: one that contains itself has no end


def _value(name: str, value: Any, depth: int = 0) -> Any:
    """A whole number, a number, a tuple of numbers, or a word."""
    if depth > _DEEPEST:
        raise ArgumentError(f"{name}: it is nested too deeply")
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, (bool, int, numpy.integer, numpy.bool_)):
        return int(value)
    if isinstance(value, (float, numpy.floating)):
        return float(value)
    parts = as_numpy(value, name).tolist() if not isinstance(value, (list, tuple)) else value
    if not isinstance(parts, (list, tuple)):  # of an array without dimensions
        return _value(name, parts, depth + 1)
    found = [_value(name, part, depth + 1) for part in parts]
    if 0 < len(found) <= layouts.MOST_NUMBERS and all(isinstance(part, (int, float)) for part in found):
        return tuple(float(part) for part in found)
    return ",".join(",".join(map(str, part)) if isinstance(part, tuple) else str(part) for part in found)


def _whole(array: Any, name: str) -> numpy.ndarray:
    """Without leading dimensions of length 1, as renderers of batches have them."""
    found = as_numpy(array, name)
    while found.ndim > 2 and found.shape[0] == 1:
        found = found[0]
    return found


def _pixels(array: Any, channels: Tuple[int, ...]) -> numpy.ndarray:
    found = _whole(array, "picture")
    if found.ndim != 3 or found.shape[2] not in channels:
        raise ArgumentError(f"picture: its shape is {found.shape}, and (H, W, {' or '.join(map(str, channels))}) is "
                            "needed")
    return found


class _Call:
    """The arguments of a run, and what it is lent."""

    def __init__(self, command: str) -> None:
        self.command = command
        self.values: List[Tuple[str, Any]] = []
        self.inputs: List[str] = []
        self.loans: Loans = []
        self.scene: Optional[Scene] = None
        self._folder: Optional[tempfile.TemporaryDirectory] = None
        self._files: List[str] = []  # in it
        self._given: Dict[str, Any] = {}  # by the options' names

    def lend(self, kind: str, struct: ctypes.Structure) -> str:
        name = f"memory:{kind}:{len(self.loans) + 1}"
        self.loans.append((name, struct))
        return name

    def add(self, name: str, value: Any) -> None:
        """An option; nothing for None and False."""
        name = {"output": "o", "planes": "aov"}.get(name, name).rstrip("_").replace("_", "-")
        if value is None or value is False:
            return
        self._given[name] = value
        is_list = name in _REPEATED and isinstance(value, (list, tuple)) and not all(
            isinstance(part, (int, float)) for part in value)
        for part in value if is_list else [value]:
            given = True if part is True else _value(name, part)
            if name == "o" and given == "-":
                raise ArgumentError("output: pictures are returned; - is for a shell")
            self.values.append((name, given))

    def options(self, options: Dict[str, Any]) -> None:
        for name, value in options.items():
            if name in ("json", "quiet", "verbose", "help"):
                raise ArgumentError(f"{name}: that is for a shell; statistics are returned")
            self.add(name, value)

    def input(self, scene: Any, depth: int = 0) -> None:
        """A scene, or several of them as one."""
        if depth > _DEEPEST:
            raise ArgumentError("the scenes are nested too deeply")
        if isinstance(scene, Scene):
            self.scene = scene
            self.inputs += scene.paths
        elif isinstance(scene, _InMemory):
            self.inputs.append(self.lend(scene._kind, scene._struct))
        elif isinstance(scene, (str, os.PathLike)):
            self.inputs.append(os.fspath(scene))
        elif isinstance(scene, (list, tuple)) and scene:
            for part in scene:
                self.input(part, depth + 1)
        elif hasattr(scene, "__array__") or hasattr(scene, "__dlpack__"):  # bare positions
            self.input(Splats(scene), depth + 1)
        else:
            raise ArgumentError("a scene is a path, or of conic.open, Splats, Mesh or Gaussians, or an array (N, 3) of "
                                f"points; not {type(scene)}")

    def camera(self, camera: Optional[AnyCamera]) -> None:
        if isinstance(camera, Camera):
            self.values.append(("camera", self.lend("camera", camera._struct)))
        elif isinstance(camera, (str, os.PathLike)):
            self.values.append(("camera", os.fspath(camera)))
        elif camera is not None:
            raise ArgumentError(f"camera: a Camera or a file of cameras is needed, not {type(camera)}")

    def picture(self, picture: Any, *, is_display: bool = False) -> str:
        """The name of a picture: of a file, or of arrays, which are lent; bytes go through a PNG."""
        if isinstance(picture, (str, os.PathLike)):
            return os.fspath(picture)
        if isinstance(picture, dict):
            picture = picture if isinstance(picture, Picture) else Picture(
                {name: as_numpy(plane, name) for name, plane in picture.items() if name != "statistics"})
            return self.lend("image", picture.image())
        pixels = _pixels(picture, (3, 4))
        if pixels.dtype == numpy.uint8:
            path = self.temporary("png")
            with open(path, "wb") as file:
                file.write(encode_png(numpy.ascontiguousarray(pixels)))
            return path
        rgba = numpy.ones(pixels.shape[:2] + (4,), numpy.float32)
        rgba[..., :pixels.shape[2]] = pixels
        image = Picture({"rgba": rgba}).image()
        image.lacks_alpha, image.is_display = int(pixels.shape[2] == 3), int(is_display)
        return self.lend("image", image)

    def evidence(self, picture: Any, channels: Tuple[int, ...] = (3, 4)) -> str:
        """The same of a picture that is judged: codes stay codes, and nothing is added to what there is."""
        if isinstance(picture, (str, os.PathLike, Picture)):
            return self.picture(picture)
        if isinstance(picture, dict):
            planes = {name: _whole(plane, name) for name, plane in picture.items() if name != "statistics"}
            if not planes:
                raise ArgumentError("picture: the dict is empty")
            path = self.temporary("npz")
            numpy.savez(path, **planes)  # type: ignore[arg-type]
            return path
        pixels = numpy.ascontiguousarray(_pixels(picture, channels))
        path = self.temporary("npy")
        numpy.save(path, pixels)
        return path

    def temporary(self, ending: str) -> str:
        self._folder = self._folder or tempfile.TemporaryDirectory(prefix="conic-")
        self._files.append(os.path.join(self._folder.name, f"picture{len(self._files)}.{ending}"))
        return self._files[-1]

    def keeper(self) -> Tuple[Optional[Kept], bool]:
        """Who keeps what the run opens, and whether sources are among that: those of a scene are."""
        if self.scene is not None and len(self.inputs) == len(self.scene.paths):
            return self.scene._kept, True
        return kept_of_thread(), False

    def run(self, *, progress: Any = None, frames: Optional[Frames] = None, keeps: bool = False,
            threads: Optional[int] = None, then: Any = None) -> Tuple[int, bytes]:
        if threads:
            self.values.append(("threads", int(threads)))
        kept, keeps_source = self.keeper() if keeps else (None, False)
        try:
            told = run([self.command, "--", *self.inputs], self.values, loans=self.loans, progress=progress,
                       frames=frames, kept=kept, keeps_source=keeps_source, files=self._files)
            if then:  # while the temporary files are there
                then()
            return told
        except ArgumentError as failure:
            raise ArgumentError(self._in_python(str(failure))) from None
        finally:
            if self._folder:
                self._folder.cleanup()

    def _in_python(self, message: str) -> str:
        """A shell's words of options as Python's: `size=(64,) is not understood` for `--size: "64" is not …`."""
        def option(found: "re.Match[str]") -> str:
            name = found[1]
            given = f"={self._given[name]!r}" if found[2] and name in self._given else ""
            name = {"o": "output", "aov": "planes"}.get(name, name).replace("-", "_")
            return (name + "_" if keyword.iskeyword(name) else name) + given
        return re.sub(r'(?<![\w-])--?([a-z][a-z0-9-]*)(: "[^"]*"(?= is not understood))?', option,
                      message).replace("WxH: ", "(W, H): ")

    def ask(self, **how: Any) -> Dict[str, Any]:
        """The answer of a command that has one."""
        return read_facts(self.run(**how)[1])


def _draw(scene: AnyScene, shot: Shot, progress: Any, threads: Optional[int]) -> Picture:
    """A shot, by conic_shot_draw."""
    if shot.map.is_wanted:
        raise ArgumentError("shot: it is a map, which only `conic render` draws")
    call = _Call("render")
    call.input(scene)
    made, reading, alive = structs_of(shot)
    frames = Frames(lambda arrays, _: arrays)
    image = layouts.Image()
    image.width, image.height = made.camera.width, made.camera.height
    arrays = frames.arrays_for(image.width, image.height, made.planes, image.planes)
    kept, keeps_source = call.keeper()
    outcome = draw(call.inputs, made, reading, image, sky=shot.light.sky, motion=shot.motion, threads=threads,
                   loans=call.loans, progress=progress, kept=kept, keeps_source=keeps_source)
    del alive
    picture = Picture(arrays, image, shot.camera)
    picture._shot = copy.deepcopy(shot)
    picture._told = lambda: _statistics_of(outcome)
    return picture


def _statistics_of(outcome: layouts.Outcome) -> Dict[str, Any]:
    """By the names that the program's JSON has."""
    s = outcome.statistics
    said: Dict[str, Any] = {name: getattr(s, name) for name in (
        "splats_in", "splats_culled", "splats_skipped", "splats_drawn", "splats_fallback", "fragments",
        "pixels_covered")}
    if s.triangles_in:
        said.update({name: getattr(s, name) for name in ("triangles_in", "triangles_culled", "triangles_skipped",
                                                         "triangles_drawn", "triangle_fragments")})
    said.update(overdraw=s.fragments / s.pixels_covered if s.pixels_covered else 0.0, isa=(s.isa or b"").decode(),
                threads=s.threads, tile=s.tile, epsilon_mode="fixed" if s.epsilon_is_fixed else "auto",
                epsilon=s.epsilon, near=s.near_z)
    if outcome.samples.end_sample:
        said["accumulated"] = {"samples": outcome.samples.end_sample}
        if outcome.noise >= 0.0:
            said["accumulated"]["noise"] = outcome.noise
        if outcome.focus_depth > 0.0:
            said["accumulated"]["focus"] = outcome.focus_depth
    said["ms"] = {name: getattr(s.ms, name) for name, _ in layouts.Milliseconds._fields_ if name != "reserved"}
    said["ms"]["light"] = outcome.light_ms
    return said


def render(scene: AnyScene, camera: Union[None, AnyCamera, Shot] = None, *, planes: Optional[Sequence[str]] = None,
           output: Union[None, PathLike, Sequence[PathLike]] = None, progress: Any = None,
           threads: Optional[int] = None, view: Union[None, int, str] = None, size: Optional[Sequence[int]] = None,
           profile: Optional[str] = None, method: Optional[str] = None, quality: Optional[str] = None,
           samples: Optional[int] = None, as_: Optional[str] = None, shade: Optional[str] = None,
           background: Any = None, exposure: Any = None, azimuth: Optional[float] = None,
           elevation: Optional[float] = None, turntable: Optional[int] = None, in_memory: bool = True,
           **options: Options) -> Any:
    """Draws a scene; with the same options, the bits are those of `conic render`.

    `scene`: what :func:`open` gives, :class:`Splats`, :class:`Mesh`, :class:`Gaussians`, a path, an array (N, 3) of
    points, or a list of these.
    `camera`: a :class:`Camera`, or a file of cameras, of which `view` names one; without, all of the scene is framed.
    `planes`: of "rgba", "Z", "N", "albedo", "weight", "count", "id", "P", of Gaussian scenes "T", "medianZ",
    "inverseZ", "last", "doubt"; "ao", "shadow"; "motion", "bound" (rgba and Z). `profile`: how a Gaussian scene is composited. `output`:
    files to write, besides. `progress`: True, a function of a task's name and the share of it that is done, or a tqdm
    bar. All other options of `conic help render` are taken by their names.

    Without `in_memory`, pictures go to `output` alone, and an .exr that is larger than half of `memory` is drawn and
    written strip by strip.

    A :class:`Shot` in the place of the camera is drawn as it is, and takes no options but `progress` and `threads`.

    Returns a :class:`Picture`: a dict of arrays by plane, (H, W, 4) for rgba and (H, W) for Z, and "statistics"; for
    `view="all"`, `turntable=N` and `stereo=E` a list of them."""
    given = dict(output=output, view=view, size=size, profile=profile, method=method, quality=quality, samples=samples,
                 as_=as_, shade=shade, background=background, exposure=exposure, azimuth=azimuth, elevation=elevation,
                 turntable=turntable, **options)
    if isinstance(camera, Shot):
        others = [name for name, value in {"planes": planes, **given}.items() if value is not None]
        if others:
            raise ArgumentError(f"{others[0]}: a shot says it already; dataclasses.replace makes another shot")
        return _draw(scene, camera, progress, threads)
    call = _Call("render")
    call.input(scene)
    call.camera(camera)
    call.options(given)
    asked = None if planes is None else planes if isinstance(planes, str) else ",".join(planes)
    if asked is not None:
        call.add("aov", asked)
    wanted = None if asked is None or "all" in asked.split(",") else set(asked.split(","))
    frames = Frames(lambda arrays, drawn: _taken(arrays, drawn, wanted, call.inputs))
    if not in_memory and output is None:
        raise ArgumentError("in_memory: without it, output has to name a file")
    _, told = call.run(progress=progress, frames=frames if in_memory else None, keeps=True, threads=threads)
    for picture in frames.pictures:
        picture._told = lambda: read_facts(told)
    is_many = view == "all" or turntable is not None or bool(options.get("stereo"))
    return frames.pictures if is_many else frames.pictures[0] if frames.pictures else _empty(told)


def turntable(scene: AnyScene, n: int = 36, camera: Optional[AnyCamera] = None, **options: Options) -> List[Picture]:
    """Draws `n` pictures around a scene, evenly apart: :func:`render` with `turntable=n`, whose other options are taken
    by their names, such as `size=(640, 480)`. Returns a list of :class:`Picture`, (H, W, 4) and (H, W) as there."""
    return list(render(scene, camera, turntable=n, **options))


def _empty(told: bytes) -> Picture:
    """Of a run that drew into files alone, as maps are."""
    picture = Picture({})
    picture._told = lambda: read_facts(told)
    return picture


def _taken(arrays: Dict[str, numpy.ndarray], drawn: layouts.Drawn, wanted: Optional[Set[str]],
           inputs: Sequence[str]) -> Picture:
    """A picture of what was drawn, without the planes that were drawn for others."""
    arrays = {name: array for name, array in arrays.items() if wanted is None or name in wanted}
    picture = Picture(arrays, drawn.image.contents,
                      Camera(drawn.camera.contents, drawn.view.decode(errors="replace")))
    picture._sketch = Sketch(drawn, list(arrays), inputs)
    return picture


def verify(scene: AnyScene, camera: Optional[AnyCamera] = None, *, image: Any = None, progress: Any = None,
           threads: Optional[int] = None, **options: Options) -> Dict[str, Any]:
    """Holds a picture against the double-precision oracle: conic's own, or `image`, a file or arrays, of whatever
    renderer. `against="exact"` asks whether the method is right, and not only its arithmetic. See "pass"."""
    call = _Call("verify")
    call.input(scene)
    call.camera(camera)
    if image is not None:
        call.add("image", call.picture(image, is_display=True))
    call.options(options)
    return call.ask(keeps=True, progress=progress, threads=threads)


def judge(scene: AnyScene, camera: AnyCamera, picture: Any, *, progress: Any = None, threads: Optional[int] = None,
          **options: Options) -> Dict[str, Any]:
    """Whether another renderer's picture is what its profile, or its method, makes of the scene.

    `picture`: a file, an array (H, W, 3 or 4) of floats or bytes, or a dict of planes. `report` and `map` name files
    to write, `max_wrong` how many pixels may be wrong (0). The answer has "verdict" ("right" or "wrong"), "pixels"
    by class, and a "diagnosis"."""
    call = _Call("judge")
    call.input(scene)
    call.camera(camera)
    call.add("picture", call.evidence(picture))
    call.options(options)
    return call.ask(keeps=True, progress=progress, threads=threads)


def project(scene: AnyScene, camera: AnyCamera, *, progress: Any = None, threads: Optional[int] = None,
            **options: Options) -> Dict[str, numpy.ndarray]:
    """What a profile makes of each Gaussian before it is composited, by gsplat's names: "radii", "means2d", "depths",
    "conics", "opacities", "colors", "isect_ids", "flatten_ids" …, and what floats may make of them: "means2d_low",
    "means2d_high" …"""
    call = _Call("project")
    call.input(scene)
    call.camera(camera)
    path = call.temporary("npz")
    call.add("o", path)
    call.options(options)
    arrays: Dict[str, numpy.ndarray] = {}
    call.run(keeps=True, progress=progress, threads=threads, then=lambda: arrays.update(numpy.load(path)))
    return arrays


def judge_intermediates(scene: AnyScene, camera: AnyCamera, arrays: Dict[str, Any], *, progress: Any = None,
                        threads: Optional[int] = None, **options: Options) -> Dict[str, Any]:
    """Whether another renderer's intermediates are what its profile makes of the scene: gsplat's `meta`, as it is, or
    any of its arrays by their names; with "render_colors" and "render_alphas" its picture, too. Arrays on a GPU are
    moved. The answer has "verdict", "stage" (the first that is wrong), and "arrays"."""
    call = _Call("judge")
    call.input(scene)
    call.camera(camera)
    path = call.temporary("npz")
    found = {name: as_numpy(array.cpu() if hasattr(array, "cpu") else array, name)
             for name, array in arrays.items() if hasattr(array, "shape") and len(array.shape)}
    numpy.savez(path, **found)  # type: ignore[arg-type]
    call.add("intermediates", path)
    call.options(options)
    return call.ask(keeps=True, progress=progress, threads=threads)


def explain(scene: AnyScene, camera: Optional[AnyCamera] = None, pixel: Optional[Sequence[int]] = None, *,
            progress: Any = None, threads: Optional[int] = None, **options: Options) -> Dict[str, Any]:
    """Why a pixel (x, y) is as it is: everything that contributes to it; or where `splat=I` lies."""
    call = _Call("explain")
    call.input(scene)
    call.camera(camera)
    call.options({**options, "pixel": pixel})
    return call.ask(keeps=True, progress=progress, threads=threads)


def diff(a: Any, b: Any, *, progress: Any = None, threads: Optional[int] = None, **options: Options) -> Dict[str, Any]:
    """How two pictures differ: files, folders, arrays or :class:`Picture`. "identical", "max_abs", "psnr", "ssim",
    "flip" …; where limits are given, "pass"."""
    call = _Call("diff")
    call.inputs = [call.picture(a), call.picture(b)]
    call.options(options)
    return call.ask(progress=progress, threads=threads)


def info(path: PathLike, *, check: bool = False, **options: Options) -> Dict[str, Any]:
    """What a file holds; with `check`, also what of it cannot be drawn."""
    call = _Call("info")
    call.input(path)
    call.options({"check": check, **options})
    return call.ask()


def devices() -> Dict[str, Any]:
    """The OpenCL devices of this machine, for `device=` of :func:`render`."""
    return _Call("devices").ask()


def conformance(folder: PathLike, *, progress: Any = None, threads: Optional[int] = None,
                **options: Options) -> Dict[str, Any]:
    """Writes a suite of cases by which any Gaussian renderer can be judged."""
    call = _Call("conformance")
    call.inputs = [os.fspath(folder)]
    call.options(options)
    return call.ask(progress=progress, threads=threads)


def command(name: str, *arguments: str, progress: Any = None, **options: Options) -> Dict[str, Any]:
    """Any command of the program with its arguments as the shell has them, as one for which there is no function."""
    call = _Call(name)
    call.inputs = [os.fspath(argument) for argument in arguments]
    call.options(options)
    return call.ask(progress=progress)


# --- what makes files ---


def _build(call: _Call, output: Optional[PathLike], ending: str, options: Dict[str, Any], progress: Any,
           threads: Optional[int]) -> Scene:
    """Without an output the file is temporary, and goes with the scene."""
    if options.get("in_place") and call.loans:
        raise ArgumentError("in_place: arrays are not changed; the scene that is returned has others")
    folder = None if output is not None or options.get("in_place") else tempfile.mkdtemp(prefix="conic-")
    path = os.path.join(folder, f"scene.{ending}") if folder else output
    scene = Scene([path] if path is not None else call.inputs[-1:], folder=folder)  # which removes it after a failure
    call.add("o", path)
    call.options(options)
    scene.statistics = call.ask(progress=progress, threads=threads)
    return scene


def make(name: str, output: Optional[PathLike] = None, *, progress: Any = None, threads: Optional[int] = None,
         **options: Options) -> Scene:
    """Samples an analytic scene ("sphere", "knot", "terrain" … "gaussians") into `n` splats."""
    call = _Call("make")
    call.inputs = [name]
    return _build(call, output, "ply", options, progress, threads)


def prepare(scene: AnyScene, output: Optional[PathLike] = None, *, progress: Any = None,
            threads: Optional[int] = None, **options: Options) -> Scene:
    """Points or a mesh become splats: normals, sizes, thinning (`count`), sharp edges (`features`)."""
    call = _Call("prepare")
    call.input(scene)
    return _build(call, output, "ply", options, progress, threads)


def octree(scene: AnyScene, output: Optional[PathLike] = None, *, progress: Any = None,
           threads: Optional[int] = None, **options: Options) -> Scene:
    """Builds an octree (.cot), of which `error=` and `budget=` of :func:`render` choose."""
    call = _Call("octree")
    call.input(scene)
    return _build(call, output, "cot", options, progress, threads)


def layers(scene: AnyScene, output: Optional[PathLike] = None, *, progress: Any = None,
           threads: Optional[int] = None, **options: Options) -> Scene:
    """Builds a layered point cloud (.lpc) of one or more files, out of core."""
    call = _Call("layer")
    call.input(scene)
    return _build(call, output, "lpc", options, progress, threads)


def mls(what: str, scene: AnyScene, output: Optional[PathLike] = None, *, progress: Any = None,
        threads: Optional[int] = None, **options: Options) -> Scene:
    """Cleans ("project"), thins ("thin") or densifies ("densify") points by the surface that they mean."""
    call = _Call("mls")
    call.inputs = [what]
    call.input(scene)
    return _build(call, output, "ply", options, progress, threads)


def csg(scene: AnyScene, other: AnyScene, output: Optional[PathLike] = None, *, progress: Any = None,
        threads: Optional[int] = None, **options: Options) -> Scene:
    """Joins two solids (`union=True`), intersects them (`intersection`), or takes one from the other (`difference`)."""
    call = _Call("csg")
    call.input(scene)
    call.input(other)
    return _build(call, output, "ply", options, progress, threads)


def hybrid(mesh: AnyScene, output: Optional[PathLike] = None, *, progress: Any = None,
           threads: Optional[int] = None, **options: Options) -> Scene:
    """Builds a hybrid model (.chy) of a mesh or of points: triangles where it is flat, surfels where it is detailed."""
    call = _Call("hybrid")
    call.input(mesh)
    return _build(call, output, "chy", options, progress, threads)


def convert(scene: AnyScene, output: PathLike, *, progress: Any = None, threads: Optional[int] = None,
            **options: Options) -> Scene:
    """Writes a Gaussian scene in another format, which the output's ending says."""
    call = _Call("convert")
    call.input(scene)
    return _build(call, output, "ply", options, progress, threads)


def gradient(scene: AnyScene, camera: AnyCamera, weights: Any, output: Optional[PathLike] = None, *,
             progress: Any = None, threads: Optional[int] = None, **options: Options) -> Scene:
    """How the sum of a picture's pixels times `weights`, a file or an array (H, W, 3 or 4), changes with every number
    of a Gaussian scene, in double precision: a PLY of what the gradients are."""
    call = _Call("gradient")
    call.input(scene)
    call.camera(camera)
    call.add("weights", call.evidence(weights, (3, 4, 5)))
    return _build(call, output, "ply", options, progress, threads)


# --- signatures ---


def _tell_signatures(path: str) -> None:
    """Gives the functions the signatures and the descriptions of their options that _commands.pyi has, which is made of
    the program's table: help(), and who completes what is typed, look at the functions."""
    kinds = inspect.Parameter
    with open(path, encoding="utf-8") as file:
        parts = file.read().split("\ndef ")[1:]
    for part in parts:
        name, rest = part.split("(", 1)
        head, tail = rest.split("\n) -> ", 1)
        function, names = globals()[name], re.findall(r"^    (\w+):", head, re.MULTILINE)
        if function.__kwdefaults__ is None or not names or "**" in head:
            continue
        known = inspect.signature(function).parameters
        function.__signature__ = inspect.Signature(
            [known[key] if key in known else kinds(key, kinds.KEYWORD_ONLY, default=None) for key in names])
        function.__doc__ = tail.split('"""', 2)[1]


if os.path.exists(_SIGNATURES := os.path.splitext(__file__)[0] + ".pyi"):
    _tell_signatures(_SIGNATURES)
