"""Draws a conformance suite by a function of yours, and judges it. Needs conic's package for Python.

    python3 runner.py mine:draw [--profile gsplat-1.6] [--level 2] [--junit report.xml]

`draw(scene, camera, background)` of mine.py returns an array (height, width, 3 or 4), or a pair of it and depths
(height, width). `scene` has means, quats (w, x, y, z), scales, opacities and sh as arrays, all activated; `camera` has
width, height, K and viewmat (world to camera); `background` is R, G, B. Tensors may be returned, too. Without a
function, conic draws, and all is right. The exit code is that of `conic judge --suite`.
"""

import argparse
import importlib
import os
import subprocess
import sys
import tempfile

import numpy as np

import conic


def by_conic(profile):
    def draw(scene, camera, background):
        behind = {"background": background} if any(background) else {}
        picture = conic.render(scene, camera, profile=profile, plain=True, planes=("rgba", "Z"), **behind)
        return picture["rgba"], picture["Z"]
    return draw


def array_of(values):
    return np.asarray(values.detach().cpu() if hasattr(values, "detach") else values, np.float32)


def draw_suite(suite, pictures, profile, draw):
    os.makedirs(pictures, exist_ok=True)
    with open(os.path.join(suite, "cases.tsv"), encoding="utf-8") as file:
        cases = [line.rstrip("\n").split("\t") for line in file]
    for name, scene, camera, its_profile, background in cases:
        if its_profile != profile:
            continue
        drawn = draw(conic.open(os.path.join(suite, scene)).gaussians(),
                     conic.Camera.from_file(os.path.join(suite, camera)), tuple(map(float, background.split(","))))
        rgba, *rest = drawn if isinstance(drawn, tuple) else (drawn,)
        planes = {"rgba": array_of(rgba), **{"Z": array_of(depth) for depth in rest}}
        np.savez(os.path.join(pictures, name + ".npz"), **planes)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("function", nargs="?", metavar="MODULE:FUNCTION")
    parser.add_argument("--profile", default="gsplat-1.6")
    parser.add_argument("--level", type=int, default=2)
    parser.add_argument("--junit", metavar="FILE")
    parser.add_argument("--keep", metavar="FOLDER", help="where the suite and the pictures stay")
    given = parser.parse_args()
    draw = by_conic(given.profile)
    if given.function:
        sys.path.insert(0, os.getcwd())
        module, _, function = given.function.partition(":")
        draw = getattr(importlib.import_module(module), function or "draw")
    with tempfile.TemporaryDirectory() as temporary:
        work = given.keep or temporary
        suite, pictures = os.path.join(work, "suite"), os.path.join(work, "pictures")
        chosen = {"profile": given.profile, "level": given.level}
        conic.conformance(suite, **chosen)
        draw_suite(suite, pictures, given.profile, draw)
        words = ["--suite", suite, "--pictures", pictures, "--profile", given.profile, "--level", str(given.level)]
        words += ["--junit", given.junit] if given.junit else []
        return subprocess.run([sys.executable, "-m", "conic", "judge", *words], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
