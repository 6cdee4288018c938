"""The shared library: found, loaded, and its commands run."""

from __future__ import annotations

import contextlib
import ctypes
import itertools
import json
import logging
import os
import signal
import threading
import warnings
from pathlib import Path
from typing import Any, Callable, Iterator, List, Optional, Sequence, Tuple

from . import _layouts as layouts
from ._shelf import Shelf
from .errors import Cancelled, ConicWarning, Error, error_of

_LOG_ERROR, _LOG_WARNING = 0, 1
_log = logging.getLogger("conic")


def _find() -> str:
    """The library of the wheel; or, for who works on conic, the one that CONIC_LIBRARY names."""
    named = os.environ.get("CONIC_LIBRARY")
    beside = Path(__file__).parent / "library" / f"libconic-hosted.{'dll' if os.name == 'nt' else 'so'}"
    return named or str(beside)


def _load() -> ctypes.CDLL:
    path = _find()
    try:
        library = ctypes.CDLL(path)
    except OSError as failure:
        raise ImportError(f"conic: cannot load {path}: {failure}") from None
    pointer, size = ctypes.c_void_p, ctypes.c_size_t
    for name, result, arguments in (
        ("conic_version", ctypes.c_char_p, []),
        ("conic_feature_at", ctypes.POINTER(layouts.Feature), [ctypes.c_int]),
        ("conic_plane_describe", ctypes.POINTER(layouts.PlaneDescription), [ctypes.c_int]),
        ("conic_camera_kind_name", ctypes.c_char_p, [ctypes.c_int]),
        ("conic_lens_name", ctypes.c_char_p, [ctypes.c_int]),
        ("conic_context_options_init_sized", None, [pointer, size]),
        ("conic_context_create", ctypes.c_int, [pointer, pointer]),
        ("conic_context_destroy", None, [pointer]),
        ("conic_cameras_read", ctypes.c_int, [pointer, ctypes.c_char_p, pointer, pointer]),
        ("conic_cameras_find", ctypes.c_int, [pointer, pointer, ctypes.c_char_p, ctypes.POINTER(size)]),
        ("conic_cameras_release", None, [pointer, pointer]),
        ("conic_image_hash", ctypes.c_uint64, [pointer, ctypes.c_int]),
        ("conic_image_options_init_sized", None, [pointer, size]),
        ("conic_image_write_as", ctypes.c_int, [pointer, ctypes.c_char_p, pointer, pointer]),
        ("conic_tone_name", ctypes.c_char_p, [ctypes.c_int]),
        ("conic_image_read", ctypes.c_int, [pointer, ctypes.c_char_p, pointer]),
        ("conic_image_release", None, [pointer, pointer]),
        ("conic_gaussians_read", ctypes.c_int, [pointer, ctypes.c_char_p, pointer, pointer]),
        ("conic_gaussians_release", None, [pointer, pointer]),
        ("conic_gaussians_read_model", ctypes.c_int, [pointer, ctypes.c_char_p, pointer, pointer]),
        ("conic_model_release", None, [pointer, pointer]),
        ("cli_host_run", ctypes.c_int, [pointer, ctypes.c_int, pointer]),
        ("cli_host_release", None, [pointer]),
        ("cli_kept_create", pointer, []),
        ("cli_kept_destroy", None, [pointer]),
    ):
        function = getattr(library, name)
        function.restype = result
        function.argtypes = arguments
    return library


library = _load()


class Plane:
    """One plane of a picture: its name, and how its numbers lie."""

    def __init__(self, number: int, description: layouts.PlaneDescription) -> None:
        self.number = number
        self.name = description.name.decode()
        self.channels = int(description.n_channels)
        self.dtype = "uint32" if description.is_uint else "float32"


def _list_planes() -> List[Plane]:
    found: List[Plane] = []
    while True:
        description = library.conic_plane_describe(len(found))
        if not description:
            return found
        found.append(Plane(len(found), description.contents))


PLANES = _list_planes()
PLANE_BY_NAME = {plane.name: plane for plane in PLANES}


def _list_tones() -> List[str]:
    found: List[str] = []
    while name := library.conic_tone_name(len(found)):
        found.append(name.decode())
    return found


TONES = _list_tones()


def version() -> str:
    """The library's version."""
    return library.conic_version().decode()


def features() -> dict[str, bool]:
    """The libraries that conic can use, and whether it does here."""
    found: dict[str, bool] = {}
    for i in itertools.count():
        feature = library.conic_feature_at(i)
        if not feature:
            return found
        found[feature.contents.name.decode()] = bool(feature.contents.available)
    return found


# --- messages ---


_CLASSES = {"splats": "Splats", "triangles": "Mesh", "gaussians": "Gaussians", "image": "Picture", "camera": "Camera"}


class _Ear:
    """What a call says: the first error, and warnings. Arrays have the names of their classes in it."""

    def __init__(self, lent: Sequence[str] = (), files: Sequence[str] = ()) -> None:
        self._names = {name: "conic." + _CLASSES[name.split(":")[1]] for name in sorted(lent, key=len, reverse=True)}
        self._names.update(dict.fromkeys(files, "picture"))  # which are temporary
        self.error: Optional[str] = None
        self.warnings: List[str] = []

    def hear(self, _cookie: Any, level: int, line: bytes) -> None:
        text = line.decode(errors="replace")
        for name, spoken in self._names.items():
            if name in text:
                text = text.replace(name, spoken).replace(" (at byte 0)", "")
        if level == _LOG_ERROR:
            if self.error is None:
                self.error = text
        elif level == _LOG_WARNING:
            self.warnings.append(text)
        else:
            _log.info("%s", text)

    def warn(self) -> None:
        for text in self.warnings:
            warnings.warn(text, ConicWarning, stacklevel=_frames_to_caller())
        self.warnings.clear()

    def failure(self, status: int) -> Error:
        return error_of(status, self.error or "conic failed without a word")


def _frames_to_caller() -> int:
    """How far up the stack the code outside of this package is."""
    import sys

    here, depth = os.path.dirname(__file__), 1
    frame = sys._getframe(1)
    while frame.f_back and os.path.dirname(frame.f_code.co_filename) == here:
        frame, depth = frame.f_back, depth + 1
    return depth


@contextlib.contextmanager
def context() -> Iterator[Tuple[int, Callable[[int], None]]]:
    """A context for single calls of the library, and what raises their failures."""
    ear = _Ear()
    options = layouts.ContextOptions()
    library.conic_context_options_init_sized(ctypes.byref(options), ctypes.sizeof(options))
    options.threads = 1
    options.log = layouts.LogFunction(ear.hear)
    made = ctypes.c_void_p()
    status = library.conic_context_create(ctypes.byref(options), ctypes.byref(made))
    if status:
        raise error_of(status, "no context can be made")

    def check(answer: int) -> None:
        if answer:
            raise ear.failure(answer)

    try:
        yield made.value or 0, check
    finally:
        library.conic_context_destroy(made)
    ear.warn()


# --- what is kept from run to run ---


class Kept:
    """A context, a renderer and an opened source. One run at a time, which the lock sees to."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self._process = os.getpid()
        self._pointer: Optional[int] = None

    def pointer(self) -> Optional[int]:
        if self._process != os.getpid():  # after a fork the context's threads are gone
            self._process, self._pointer = os.getpid(), None
        if self._pointer is None:
            self._pointer = library.cli_kept_create()
        return self._pointer

    def drop(self) -> None:
        with self.lock:
            if self._pointer is not None and self._process == os.getpid():
                library.cli_kept_destroy(self._pointer)
            self._pointer = None

    def __del__(self) -> None:
        if getattr(self, "_pointer", None) is not None and self._process == os.getpid():
            library.cli_kept_destroy(self._pointer)
            self._pointer = None


class _PerThread(threading.local):
    def __init__(self) -> None:
        self.kept = Kept()
        self.shelf = Shelf()


_per_thread = _PerThread()


def kept_of_thread() -> Kept:
    """What this thread keeps between runs on arrays: a context's threads, and the memory of frames."""
    return _per_thread.kept


def shelf_of_thread() -> Shelf:
    """The arrays of this thread's earlier pictures."""
    return _per_thread.shelf


def release() -> None:
    """Gives back the memory that this thread keeps between pictures."""
    _per_thread.kept.drop()
    _per_thread.shelf.clear()


# --- progress ---


class _Bar:
    """A tqdm bar, or whatever is used as one, that shows the share of a task that is done."""

    def __init__(self, bar: Any, is_own: bool) -> None:
        self._bar, self._is_own, self._done = bar, is_own, 0.0
        if not is_own and getattr(bar, "total", 1) is None:
            bar.total = 1.0

    def __call__(self, task: str, fraction: float) -> None:
        if hasattr(self._bar, "set_description"):
            self._bar.set_description(task, refresh=False)
        total = getattr(self._bar, "total", None) or 1.0
        self._bar.update((fraction - self._done) * total)
        self._done = fraction

    def close(self) -> None:
        if self._is_own:
            self._bar.close()


def _progress_of(progress: Any) -> Optional[Callable[[str, float], Any]]:
    """A callable of a task and the share of it that is done; of True, tqdm, or one of its bars."""
    if progress is None or progress is False:
        return None
    if progress is True:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            return None
        progress = tqdm
    if isinstance(progress, type) and hasattr(progress, "update"):
        return _Bar(progress(total=1.0, bar_format="{desc} {percentage:3.0f}%|{bar}| {elapsed}"), True)
    if hasattr(progress, "update"):
        return _Bar(progress, False)
    if not callable(progress):
        raise TypeError("progress: True, a function of a task and a fraction, or a tqdm bar")
    return progress


class _Watch:
    """Progress of a run, and Ctrl-C: the run is asked to stop, and the exception raised when it has."""

    def __init__(self, progress: Any) -> None:
        self._tell = _progress_of(progress)
        self._is_interrupted = False
        self._failure: Optional[BaseException] = None
        self._handler: Any = None

    def __enter__(self) -> "_Watch":
        if (threading.current_thread() is threading.main_thread()
                and signal.getsignal(signal.SIGINT) is signal.default_int_handler):
            self._handler = signal.signal(signal.SIGINT, self._interrupt)
        return self

    def __exit__(self, *_: Any) -> None:
        if self._handler is not None:
            signal.signal(signal.SIGINT, self._handler)
        close = getattr(self._tell, "close", None)
        if close and isinstance(self._tell, _Bar):
            close()

    def _interrupt(self, _number: int, _frame: Any) -> None:
        self._is_interrupted = True

    def progress(self, _cookie: Any, task: bytes, fraction: float) -> int:
        try:
            if self._tell and not self._is_interrupted and self._tell(task.decode(), fraction) is True:
                return 1
        except BaseException as failure:  # pylint: disable=broad-except
            self._failure = failure
        return int(self._is_interrupted or self._failure is not None)

    def settle(self) -> None:
        """Raises what stopped the run, if anything did."""
        if self._failure is not None:
            raise self._failure
        if self._is_interrupted:
            raise KeyboardInterrupt


# --- running ---


class Frames:
    """Takes the pictures of a run: arrays of NumPy, into which they are drawn."""

    def __init__(self, make: Callable[..., Any]) -> None:
        self.pictures: List[Any] = []
        self.failure: Optional[BaseException] = None
        self._make = make
        self._shelf = shelf_of_thread()
        self._arrays: dict[str, Any] = {}

    def lay_out(self, _cookie: Any, width: int, height: int, planes: int, places: Any) -> int:
        try:
            self._arrays = {}
            for plane in PLANES:
                if not planes >> plane.number & 1:
                    continue
                shape = (height, width) if plane.channels == 1 else (height, width, plane.channels)
                array = self._shelf.take(plane.name, shape, plane.dtype)
                places[plane.number] = array.ctypes.data
                self._arrays[plane.name] = array
            return 0
        except BaseException as failure:  # pylint: disable=broad-except
            self.failure = failure
            return 1

    def take(self, _cookie: Any, i_frame: int, view: bytes, image: Any, camera: Any) -> None:
        try:
            self.pictures.append(self._make(self._arrays, view.decode(errors="replace"), image.contents,
                                            camera.contents))
        except BaseException as failure:  # pylint: disable=broad-except
            self.failure = failure
        self._arrays = {}


def run(arguments: Sequence[str], *, loans: Sequence[Tuple[str, ctypes.Structure]] = (), progress: Any = None,
        frames: Optional[Frames] = None, kept: Optional[Kept] = None,
        keeps_source: bool = False, files: Sequence[str] = ()) -> Tuple[int, dict[str, Any]]:
    """Runs a command of the program; its exit code (0 or 1), and its JSON. The GIL is released meanwhile."""
    ear, watch = _Ear([name for name, _ in loans], files), _Watch(progress)
    host = layouts.Host()
    host.progress = layouts.ProgressFunction(watch.progress)
    host.say = layouts.LogFunction(ear.hear)
    if frames is not None:
        host.lay_out = layouts.LayOutFunction(frames.lay_out)
        host.take = layouts.TakeFunction(frames.take)
    lent = (layouts.Loan * max(1, len(loans)))(
        *[layouts.Loan(name.encode(), ctypes.addressof(what)) for name, what in loans])
    host.loans, host.n_loans = lent, len(loans)
    host.keeps_source = int(keeps_source)
    encoded = [os.fsencode(argument) for argument in arguments]
    argv = (ctypes.c_char_p * (len(encoded) + 1))(*encoded, None)
    with (kept.lock if kept else contextlib.nullcontext()):
        host.kept = kept.pointer() if kept else None
        with watch:
            exit_code = library.cli_host_run(ctypes.byref(host), len(encoded), argv)
            told = ctypes.string_at(host.json, host.json_bytes) if host.json else b"{}"
            status = host.status
            library.cli_host_release(ctypes.byref(host))
    watch.settle()
    if frames is not None and frames.failure is not None:
        raise frames.failure
    ear.warn()
    if exit_code not in (0, 1):
        raise ear.failure(status or Cancelled.status)
    return exit_code, json.loads(told or b"{}")
