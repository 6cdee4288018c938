"""What drawing from Python takes more than the library itself does: prints the medians of pictures that are drawn in
turns by C's ways and by conic.render. The same arrays, the same camera, the same bits. C draws arrays as any source is
drawn (conic_lend, conic_source_open, conic_shot_draw), or by conic_render_samples alone, which trusts them: a source
looks at each number whether it is finite. Both keep their renderer and their image. Run by hand:
CONIC_LIBRARY=…/libconic-hosted.so PYTHONPATH=python python3 tests/python/overhead.py [SPLATS]

Times are the process's, of all its threads: what else the machine does hardly counts."""

import ctypes
import gc
import os
import sys
import time

import numpy

import conic
from conic import _layouts as layouts
from conic._library import library

ROUNDS = int(os.environ.get("CONIC_ROUNDS", "15"))


class RenderOptions(ctypes.Structure):
    """As conic_render_options: large enough, and filled by the library."""
    _fields_ = [("size", ctypes.c_size_t), ("method", ctypes.c_int), ("rest", ctypes.c_char * 4096)]


class Library:
    """The pictures of a C program."""

    def __init__(self, threads):
        options = layouts.ContextOptions()
        library.conic_context_options_init_sized(ctypes.byref(options), ctypes.c_size_t(ctypes.sizeof(options)))
        options.threads = threads
        self.context, self.renderer = ctypes.c_void_p(), ctypes.c_void_p()
        assert library.conic_context_create(ctypes.byref(options), ctypes.byref(self.context)) == 0
        assert library.conic_renderer_create(self.context, ctypes.byref(self.renderer)) == 0
        self.options = RenderOptions()
        library.conic_render_options_init_sized(ctypes.byref(self.options), ctypes.c_size_t(1024))
        self.options.method = 0  # conic

    def draw(self, splats, camera, image):
        status = library.conic_render_samples(self.context, self.renderer, ctypes.byref(splats._struct),
                                              ctypes.byref(camera._struct), ctypes.byref(self.options), 1,
                                              ctypes.byref(image), None)
        assert status == 0

    def draw_shot(self, splats, shot, image):
        name, source = b"memory:splats:1", ctypes.c_void_p()
        names = (ctypes.c_char_p * 1)(name)
        status = (library.conic_lend(self.context, name, ctypes.byref(splats._struct)) or
                  library.conic_source_open(self.context, names, ctypes.c_size_t(1), None, ctypes.byref(source)) or
                  library.conic_shot_draw(source, self.renderer, ctypes.byref(shot), ctypes.byref(image), None))
        assert status == 0
        library.conic_source_close(source)
        library.conic_take_back_loans(self.context)


def times_of_turns(draws):
    """The times of each in milliseconds, a row a turn."""
    times = [[] for _ in draws]
    for _ in range(ROUNDS):
        for i, draw in enumerate(draws):
            begun = time.process_time()
            draw()
            times[i].append(time.process_time() - begun)
    return 1e3 * numpy.array(times).T


def compare(name, splats, size, threads):
    camera = conic.render(splats, size=size, plain=True).camera
    arrays = {"rgba": numpy.empty((size[1], size[0], 4), "f4"), "Z": numpy.empty((size[1], size[0]), "f4")}
    image = conic.Picture(arrays).image()
    c = Library(threads)

    def draw():
        return conic.render(splats, camera, plain=True, method="conic", samples=1, threads=threads)

    of_c = layouts.Shot()
    library.conic_shot_init_sized(ctypes.byref(of_c), ctypes.c_size_t(ctypes.sizeof(of_c)))
    of_c.camera, of_c.render.method = camera._struct, 0
    shot = draw().shot
    draws = [lambda: c.draw_shot(splats, of_c, image), lambda: c.draw(splats, camera, image), draw,
             lambda: conic.render(splats, shot, threads=threads)]
    for call in draws[:2]:
        arrays["rgba"][:] = 0
        call()
        assert conic.Picture(arrays).hash() == draw().hash()
    gc.collect()
    times = times_of_turns(draws)
    took = numpy.median(times, axis=0)
    by_shot, alone = (numpy.median(times / times[:, i:i + 1], axis=0) for i in (0, 1))  # within a turn: rates change
    print(f"{name:22} {threads} threads   C: a shot {took[0]:8.3f} ms, the splats alone {took[1]:8.3f}   "
          f"Python {took[2]:8.3f}: {by_shot[2]:6.3f} and {alone[2]:6.3f}   by a shot {took[3]:8.3f}: "
          f"{by_shot[3]:6.3f} and {alone[3]:6.3f}", flush=True)


def columns_of(splats):
    return [numpy.ascontiguousarray(getattr(splats, name)) for name in ("position", "tangent_u", "tangent_v", "color")]


def main():
    library.conic_render_samples.argtypes = [ctypes.c_void_p] * 5 + [ctypes.c_int] + [ctypes.c_void_p] * 2
    library.conic_lend.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    library.conic_source_open.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t] + [ctypes.c_void_p] * 2
    library.conic_shot_draw.argtypes = [ctypes.c_void_p] * 5
    library.conic_source_close.argtypes = library.conic_take_back_loans.argtypes = [ctypes.c_void_p]
    n = int(float(sys.argv[1])) if len(sys.argv) > 1 else 1000000
    rows = columns_of(conic.make("sphere", n=n).splats())
    columns = [tuple(numpy.ascontiguousarray(part) for part in array.T) for array in rows]
    together = numpy.concatenate([*rows, numpy.zeros((n, 4), "f4")], axis=1)
    for threads in (1, 2):
        for name, arrays in (("an array a component", columns), ("(N, 3) rows", rows),
                             ("columns of (N, 16)", [together[:, 3 * i:3 * i + 3] for i in range(4)])):
            compare(name, conic.Splats(*arrays), (1024, 1024), threads)
    compare("300 splats, 64 x 48", conic.Splats(*[array[::max(1, n // 300)] for array in rows]), (64, 48), 1)


if __name__ == "__main__":
    main()
