"""The shared library: found, loaded, and its commands run."""

from __future__ import annotations

import _thread
import atexit
import contextlib
import ctypes
import itertools
import logging
import os
import signal
import struct
import sys
import threading
import time
import warnings
from pathlib import Path
from typing import Any, Callable, Iterator, List, Optional, Sequence, Tuple

from . import _layouts as layouts
from ._shelf import Shelf
from .errors import ArgumentError, Cancelled, ConicWarning, Error, error_of

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
        ("conic_image_read", ctypes.c_int, [pointer, ctypes.c_char_p, pointer]),
        ("conic_image_release", None, [pointer, pointer]),
        ("conic_gaussians_read", ctypes.c_int, [pointer, ctypes.c_char_p, pointer, pointer]),
        ("conic_gaussians_release", None, [pointer, pointer]),
        ("conic_gaussians_read_model", ctypes.c_int, [pointer, ctypes.c_char_p, pointer, pointer]),
        ("conic_model_release", None, [pointer, pointer]),
        ("conic_shot_init_sized", None, [pointer, size]),
        ("conic_source_options_init_sized", None, [pointer, size]),
        ("conic_layers_access_init_sized", None, [pointer, size]),
        ("conic_patches_options_init_sized", None, [pointer, size]),
        ("conic_coloring_options_init_sized", None, [pointer, size]),
        ("conic_gaussian_options_init_sized", None, [pointer, size]),
        ("conic_shot_file_init_sized", None, [pointer, size]),
        ("conic_shot_file_print", ctypes.c_int, [pointer, pointer, ctypes.c_int, ctypes.POINTER(pointer)]),
        ("conic_shot_text_release", None, [pointer, pointer]),
        ("conic_shot_file_write", ctypes.c_int, [pointer, pointer, ctypes.c_char_p]),
        ("conic_shot_file_key", ctypes.c_int, [pointer, pointer, ctypes.c_char_p]),
        ("conic_shot_file_parse", ctypes.c_int, [pointer, ctypes.c_char_p, ctypes.c_char_p, size, pointer]),
        ("conic_shot_file_read", ctypes.c_int, [pointer, ctypes.c_char_p, pointer]),
        ("conic_shot_file_destroy", None, [pointer, pointer]),
        ("conic_shot_field_at", ctypes.c_int, [size, pointer]),
        ("cli_host_look", ctypes.c_int, [pointer, pointer]),
        ("cli_host_program", ctypes.c_int, [ctypes.c_int, pointer]),
        ("cli_host_run", ctypes.c_int, [pointer, ctypes.c_int, pointer]),
        ("cli_host_draw", ctypes.c_int, [pointer, ctypes.c_int, pointer, pointer, pointer, ctypes.c_char_p,
                                         ctypes.c_char_p, ctypes.c_int, pointer, pointer]),
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


def words_of(function: str) -> Tuple[str, ...]:
    """The words of an enumeration, by the library's function that names its numbers."""
    call = getattr(library, function)
    call.restype, call.argtypes = ctypes.c_char_p, [ctypes.c_int]
    found: List[str] = []
    while name := call(len(found)):
        found.append(name.decode())
    return tuple(found)


TONES = words_of("conic_tone_name")


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


@contextlib.contextmanager
def delaying_interrupts() -> Iterator[None]:
    """For what Python calls when nobody needs an object any more: whatever a signal's handler raises there is dropped.
    Ctrl-C comes again when it is over."""
    is_main = not sys.is_finalizing() and threading.current_thread() is threading.main_thread()
    handler = signal.getsignal(signal.SIGINT) if is_main else None
    if not callable(handler):
        yield
        return
    came: List[int] = []
    signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
        if came:
            threading.Timer(0.01, _interrupt_main).start()


def _interrupt_main() -> None:
    if hasattr(signal, "pthread_kill"):  # which wakes it, too
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
    else:
        _thread.interrupt_main()


# --- what is kept from run to run ---


class Kept:
    """A context, a renderer and a few opened sources, with which one run works at a time.

    Others wait for it, but nobody waits for Python code that a run has called: from within that, and beside it where it
    takes long, runs get a spare."""

    _PATIENCE = 0.5  # seconds that called code may take before others no longer wait

    def __init__(self) -> None:
        self._begin()

    def _begin(self) -> None:
        self._process = os.getpid()
        self._lock = threading.Lock()
        self._pointer: Optional[int] = None
        self._owner: Optional[int] = None
        self._called_since: Optional[float] = None
        self._goes = False
        self._spare: Optional[Kept] = None

    @contextlib.contextmanager
    def held(self) -> Iterator["Kept"]:
        """What a run of this thread may use: this, or a spare."""
        if self._process != os.getpid():  # after a fork the context's threads, and those that held it, are gone
            self._begin()
        if not self._acquire():
            if self._spare is None:
                self._spare = Kept()
            with self._spare.held() as spare:
                yield spare
            return
        try:
            self._owner = threading.get_ident()
            yield self
        finally:
            self._owner = self._called_since = None
            if self._goes:
                self._destroy()
            self._lock.release()

    def _acquire(self) -> bool:
        me = threading.get_ident()
        while self._owner != me:
            if self._lock.acquire(timeout=0.05):
                return True
            since = self._called_since
            if since is not None and time.monotonic() - since > self._PATIENCE:
                return False
        return False

    @contextlib.contextmanager
    def calling(self) -> Iterator[None]:
        """While code is called that is not this package's."""
        before, self._called_since = self._called_since, time.monotonic()
        try:
            yield
        finally:
            self._called_since = before

    def pointer(self) -> Optional[int]:
        if self._pointer is None:
            self._pointer = library.cli_kept_create()
        return self._pointer

    def _destroy(self) -> None:
        pointer, self._pointer, self._goes = self._pointer, None, False
        if pointer is not None and self._process == os.getpid():
            library.cli_kept_destroy(pointer)

    def drop(self) -> None:
        """Forgets all, or does so when the run that uses it ends."""
        spare = self._spare
        if self._process != os.getpid():
            self._begin()
        elif self._lock.acquire(blocking=False):
            self._destroy()
            self._lock.release()
        else:
            self._goes = True
        if spare is not None:
            spare.drop()

    def __del__(self) -> None:
        if getattr(self, "_pointer", None) is not None:
            with delaying_interrupts():
                self._destroy()


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


class _Ending:
    """The interpreter's end, which must not come while the library is to call it back: runs of other threads that
    nobody waits for are stopped. So are those of threads for which a main thread waits that Ctrl-C has ended."""

    PATIENCE = 10.0

    def __init__(self) -> None:
        self._is_here = False
        self._runs = 0
        self._lock = threading.Lock()
        atexit.register(self._come)

    @contextlib.contextmanager
    def awaits(self) -> Iterator[None]:
        with self._lock:
            self._runs += 1
        try:
            yield
        finally:
            with self._lock:
                self._runs -= 1

    def _come(self) -> None:
        self._is_here = True
        until = time.monotonic() + self.PATIENCE
        while self._runs and time.monotonic() < until:
            time.sleep(0.005)

    def stops_others(self) -> bool:
        last = getattr(sys, "last_type", None)
        is_killed = last is not None and issubclass(last, KeyboardInterrupt)
        return self._is_here or (is_killed and not threading.main_thread().is_alive())


_ending = _Ending()


class _Watch:
    """Progress of a run, and Ctrl-C: the run is asked to stop, and what the signal's handler raises is raised when it
    has. A run in another thread ends with a main thread that Ctrl-C has ended."""

    SECONDS = 0.05  # from one look to the next, where nobody wants to hear of progress

    def __init__(self, progress: Any) -> None:
        self.tell = _progress_of(progress)
        self._kept: Optional[Kept] = None
        self._failure: Optional[BaseException] = None
        self._handler: Any = None
        self._is_main = threading.current_thread() is threading.main_thread()

    @contextlib.contextmanager
    def over(self, kept: Optional[Kept]) -> Iterator[None]:
        self._kept = kept
        handler = signal.getsignal(signal.SIGINT) if self._is_main else None
        if callable(handler):
            self._handler = handler
            signal.signal(signal.SIGINT, self._interrupt)
        try:
            yield
        finally:
            if self._handler is not None:
                signal.signal(signal.SIGINT, self._handler)
            if isinstance(self.tell, _Bar):
                self.tell.close()

    def _interrupt(self, number: int, frame: Any) -> None:
        try:
            self._handler(number, frame)
        except BaseException as failure:  # pylint: disable=broad-except
            self._failure = self._failure or failure

    def progress(self, _cookie: Any, task: bytes, fraction: float) -> int:
        try:
            if not self._is_main and _ending.stops_others():
                return 1
            if self.tell and self._failure is None:
                with self._kept.calling() if self._kept else contextlib.nullcontext():
                    if self.tell(task.decode(), fraction) is True:
                        return 1
        except BaseException as failure:  # pylint: disable=broad-except
            self._failure = self._failure or failure
        return int(self._failure is not None)

    def settle(self) -> None:
        """Raises what stopped the run, if anything did."""
        if self._failure is not None:
            raise self._failure


# --- running ---


class Frames:
    """Takes the pictures of a run: arrays of NumPy, into which they are drawn."""

    def __init__(self, make: Callable[..., Any]) -> None:
        self.pictures: List[Any] = []
        self.failure: Optional[BaseException] = None
        self._make = make
        self._shelf = shelf_of_thread()
        self._arrays: dict[str, Any] = {}

    def arrays_for(self, width: int, height: int, planes: int, places: Any) -> dict[str, Any]:
        """Arrays for planes, which are bits, and where they lie."""
        found: dict[str, Any] = {}
        for plane in PLANES:
            if not planes >> plane.number & 1:
                continue
            shape = (height, width) if plane.channels == 1 else (height, width, plane.channels)
            array = self._shelf.take(plane.name, shape, plane.dtype)
            places[plane.number] = array.ctypes.data
            found[plane.name] = array
        return found

    def lay_out(self, _cookie: Any, width: int, height: int, planes: int, places: Any) -> int:
        try:
            self._arrays = {}
            self._arrays = self.arrays_for(width, height, planes, places)
            return 0
        except BaseException as failure:  # pylint: disable=broad-except
            self.failure = failure
            return 1

    def take(self, _cookie: Any, drawn: Any) -> None:
        try:
            self.pictures.append(self._make(self._arrays, drawn.contents))
        except BaseException as failure:  # pylint: disable=broad-except
            self.failure = failure
        self._arrays = {}


Pairs = Sequence[Tuple[str, Any]]


def text_bytes(text: Any) -> bytes:
    """A path or a word as the library takes it: its strings end at a NUL."""
    encoded = os.fsencode(text)
    if b"\0" in encoded:
        raise ArgumentError(f"{str(text)[:80]!r}: a text has a NUL character")
    return encoded


def _values_of(pairs: Pairs) -> Any:
    """Options and what they are given, as the library takes them."""
    values = (layouts.Value * max(1, len(pairs)))()
    for value, (name, given) in zip(values, pairs):
        value.name = text_bytes(name)
        if given is True:
            value.type = layouts.VALUE_SET
        elif isinstance(given, int) and -1 << 63 <= given < 1 << 63:
            value.type, value.whole = layouts.VALUE_WHOLE, given
        elif isinstance(given, (float, tuple)):
            numbers = given if isinstance(given, tuple) else (given,)
            value.type, value.n_numbers = layouts.VALUE_NUMBERS, len(numbers)
            value.numbers[:len(numbers)] = numbers
        else:
            value.type, value.text = layouts.VALUE_TEXT, text_bytes(str(given))
    return values


_NUMBER = struct.Struct("=d")
_COUNT = struct.Struct("=Q")


def read_facts(said: bytes) -> dict[str, Any]:
    """The records that a run has told: cli/host.h says how they lie."""
    whole: dict[str, Any] = {}
    open_ones: List[Any] = [whole]
    at = 0
    while at < len(said):
        kind = said[at:at + 1]
        if kind == b"e":
            open_ones.pop()
            at += 1
            continue
        end = said.index(0, at)
        key, at = said[at + 1:end].decode(), end + 1
        value: Any
        if kind in b"oa":
            value = {} if kind == b"o" else []
        elif kind == b"t":
            end = said.index(0, at)
            value, at = said[at:end].decode(errors="replace"), end + 1
        elif kind == b"n":
            value, at = _NUMBER.unpack_from(said, at)[0], at + 8
        elif kind == b"c":
            value, at = _COUNT.unpack_from(said, at)[0], at + 8
        elif kind == b"b":
            value, at = said[at] != 0, at + 1
        else:
            value = None
        if isinstance(open_ones[-1], list):
            open_ones[-1].append(value)
        else:
            open_ones[-1][key] = value
        if kind in b"oa":
            open_ones.append(value)
    return whole


def _host(call: Callable[[Any], int], ear: "_Ear", progress: Any, loans: Sequence[Tuple[str, ctypes.Structure]],
          kept: Optional[Kept], keeps_source: bool, frames: Optional[Frames], pairs: Pairs) -> Tuple[int, bytes]:
    """Calls what takes a host; its exit code, 0 or 1, and the records of its facts. The GIL is released meanwhile."""
    watch = _Watch(progress)
    host = layouts.Host()
    host.progress = layouts.ProgressFunction(watch.progress)
    host.progress_seconds = 0.0 if watch.tell else watch.SECONDS
    host.say = layouts.LogFunction(ear.hear)
    if frames is not None:
        host.lay_out = layouts.LayOutFunction(frames.lay_out)
        host.take = layouts.TakeFunction(frames.take)
    lent = (layouts.Loan * max(1, len(loans)))(
        *[layouts.Loan(name.encode(), ctypes.addressof(what)) for name, what in loans])
    host.loans, host.n_loans = lent, len(loans)
    host.values, host.n_values = _values_of(pairs), len(pairs)
    host.keeps_source = int(keeps_source)
    with _ending.awaits(), kept.held() if kept else contextlib.nullcontext() as held:
        host.kept = held.pointer() if held else None
        with watch.over(held):
            exit_code = call(ctypes.byref(host))
            told = ctypes.string_at(host.facts, host.n_facts_bytes) if host.facts else b""
            status = host.status
            library.cli_host_release(ctypes.byref(host))
    watch.settle()
    if frames is not None and frames.failure is not None:
        raise frames.failure
    ear.warn()
    if exit_code not in (0, 1):
        raise ear.failure(status or Cancelled.status)
    return exit_code, told


def run(arguments: Sequence[str], pairs: Pairs = (), *, loans: Sequence[Tuple[str, ctypes.Structure]] = (),
        progress: Any = None, frames: Optional[Frames] = None, kept: Optional[Kept] = None, keeps_source: bool = False,
        files: Sequence[str] = ()) -> Tuple[int, bytes]:
    """Runs a command of the program on inputs, with options by name."""
    encoded = [text_bytes(argument) for argument in arguments]
    argv = (ctypes.c_char_p * (len(encoded) + 1))(*encoded, None)
    return _host(lambda host: library.cli_host_run(host, len(encoded), argv), _Ear([name for name, _ in loans], files),
                 progress, loans, kept, keeps_source, frames, pairs)


def draw(inputs: Sequence[str], shot: Any, reading: Any, image: Any, *, sky: Optional[str] = None,
         motion: Optional[str] = None, threads: Optional[int] = None,
         loans: Sequence[Tuple[str, ctypes.Structure]] = (), progress: Any = None, kept: Optional[Kept] = None,
         keeps_source: bool = False) -> Any:
    """Draws a shot into an image's planes; what came of it."""
    encoded = [text_bytes(name) for name in inputs]
    names = (ctypes.c_char_p * (len(encoded) + 1))(*encoded, None)
    outcome = layouts.Outcome()
    paths = [None if path is None else text_bytes(path) for path in (sky, motion)]
    _host(lambda host: library.cli_host_draw(host, len(encoded), names, ctypes.byref(reading), ctypes.byref(shot),
                                             *paths, int(threads or 0), ctypes.byref(image), ctypes.byref(outcome)),
          _Ear([name for name, _ in loans]), progress, loans, kept, keeps_source, None, ())
    return outcome


def look(file: Any) -> bytes:
    """The text of a shot, with what its inputs hold."""
    _, told = _host(lambda host: library.cli_host_look(host, ctypes.byref(file)), _Ear(), None, (), None, False, None,
                    ())
    return read_facts(told)["shot"].encode()
