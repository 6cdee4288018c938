"""every_source.py CONIC COPC: in the working folder, makes a source of every kind, draws each with every option that may
not move the camera, the light or the range of colours, and asks each for every plane and every further file. Ends with
1 where something is another, is drawn empty, or is missing without exit code 2 and its name."""
import json
import os
import pathlib
import struct
import subprocess
import sys

import hierarchies_make

conic, copc = sys.argv[1:]
WORK = ["--memory 20", "--tile 16", "--tolerate", "--progressive levels", "--occlusion on", "--occlusion off",
        "--deadline 1000", "--where x>-1e9"]
BASES = ["", "--exposure auto", "--color-by height"]
PLANES = ("rgba Z N albedo weight count id P cluster T medianZ inverseZ last doubt ao shadow samples variance "
          "motion bound cryptomatte").split()
GAUSSIAN = {"T", "medianZ", "inverseZ", "last", "doubt"}
SURFACE = {"albedo", "weight", "ao", "shadow", "cryptomatte"}
FILES = {"--show overdraw:f.pfm": "--show", "--show legend:f.pfm": "legend", "--show boxes:f.pfm": "--show boxes",
         "--show clusters:f.pfm": "--show clusters", "--deep f.exr": "--deep",
         "--save-shot f.txt": "--save-shot", "--progressive f": "--progressive"}
failures = 0


def expect(condition, message):
    global failures
    failures += not condition
    if not condition:
        print("FAILED:", message)


def run(*words):
    done = subprocess.run([conic, *words], stdin=subprocess.DEVNULL, capture_output=True, timeout=300, check=False)
    return done.returncode, done.stderr.decode()


def draw(words):
    """Draws a small picture; its exit code, what is said, and what it says of itself."""
    for name in ("p.pfm", "p.json"):
        pathlib.Path(name).unlink(missing_ok=True)
    code, said = run("render", *words, "--size", "40x40", "-o", "p.pfm", "--json", "p.json")
    return code, said, json.loads(pathlib.Path("p.json").read_text()) if code == 0 else {}


def make_sources():
    hierarchies_make.make(".", 1500)
    n = 12
    at = [(2 * i / n - 1, 2 * j / n - 1) for j in range(n + 1) for i in range(n + 1)]
    lines = [f"v {x} {0.4 * (1 - x * x - y * y) + (0.3 if x > 0.5 else 0)} {y}" for x, y in at]
    corners = [j * (n + 1) + i + 1 for j in range(n) for i in range(n)]
    lines += [f"f {a} {a + n + 1} {a + n + 2} {a + 1}" for a in corners]
    pathlib.Path("mesh.obj").write_text("\n".join(lines) + "\n")
    for command in ("make terrain -n 400 -o splats.ply", "make gaussians -n 300 -o g.ply", "convert g.ply -o g.spz",
                    "layer splats.ply -o levels.lpc --cloud-size 64", "octree splats.ply -o tree.cot",
                    "hybrid mesh.obj -o hybrid.chy"):
        code, said = run(*command.split())
        expect(code == 0, f"{command}: {said}")
    sources = {"PLY": "splats.ply", "LAS": "plain.las", "EPT": "ept", "Potree": "potree", ".lpc": "levels.lpc",
               ".cot": "tree.cot", ".cot by --error": "tree.cot --error 4", ".chy": "hybrid.chy", "mesh": "mesh.obj",
               "hybrid": "mesh.obj --as hybrid", "vertices": "mesh.obj --as points", "Gaussians": "g.spz",
               "splats of Gaussians": "g.spz --profile surface"}
    return {**sources, **({"COPC": copc} if os.path.exists(copc) else {})}


def framing(told):
    return {key: told.get(key) for key in ("camera", "near", "up", "lights", "sky", "ground", "background", "coloring",
                                           "exposure", "tone")}


def close(a, b):
    """The same but for how positions are rounded from the first input's origin."""
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(close(a[key], b[key]) for key in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(map(close, a, b))
    return abs(a - b) <= 1e-6 * max(1, abs(a)) if isinstance(a, float) and isinstance(b, float) else a == b


def stays(kind, words):
    """Options of work, of which at least those of any source must be taken, leave the picture as it is."""
    n = 0
    for base in BASES:
        code, said, first = draw(words + base.split())
        if code:
            expect(code in (2, 3), f"{kind}, {base}: {said}")
            continue
        for option in WORK:
            code, said, told = draw(words + base.split() + option.split())
            expect(code in (0, 2, 3), f"{kind}, {base}, {option}: {code}: {said}")
            if code == 0:
                n += 1
                expect(framing(told) == framing(first), f"{kind}, {base}: {option} changes what is framed or lit")
                expect(told["hash"] == first["hash"], f"{kind}, {base}: {option} changes the picture")
    expect(n > 0, f"{kind}: nothing was compared")
    return n


def planes(kind, words):
    is_composited, n = kind == "Gaussians", 0
    for plane in PLANES:
        has = ("--error" in words if plane == "bound" else
               plane in GAUSSIAN if plane in GAUSSIAN | SURFACE - {"cryptomatte"} and is_composited else
               plane not in GAUSSIAN | {"samples", "variance"} | (set() if "hybrid" in kind or kind == ".chy" else {"cluster"}))
        out = "p.exr" if plane in ("id", "motion", "cryptomatte") else "p.pfm"
        if plane == "cryptomatte" and (kind in (".lpc", "EPT", "Potree", "COPC")):
            has = False
        code, said = run("render", *words, "--size", "40x40", "--zoom", "0.7", "--aov", plane, "-o", out)
        expect(code == (0 if has else 2), f"{kind}, --aov {plane}: exit code {code}: {said}")
        if code:
            expect(said.startswith("conic: error: render: ") and plane in said, f"{kind}, --aov {plane}: {said}")
        elif out == "p.pfm":
            data = pathlib.Path(out).read_bytes().split(b"\n", 3)[3]
            values = struct.unpack(f"<{len(data) // 4}f", data)
            expect(min(values) < max(values), f"{kind}, --aov {plane}: it is empty")
        n += 1
    return n


def files(kind, words):
    for option, name in FILES.items():
        target = pathlib.Path(option.split()[1].split(":")[-1])
        if target.is_dir():
            for entry in target.iterdir():
                entry.unlink()
            target.rmdir()
        target.unlink(missing_ok=True)
        code, said, _ = draw(words + option.split())
        expect(code in (0, 2, 4), f"{kind}, {option}: exit code {code}: {said}")
        expect((code == 0) == target.exists(), f"{kind}, {option}: exit code {code}, and the file is {target.exists()}")
        expect(code == 0 or name in said, f"{kind}, {option}: {said}")


def same_light():
    """What is drawn more coarsely has the colours, and so the light, of all of it."""
    for source in ("tree.cot", "levels.lpc", "hybrid.chy"):
        told = [framing(draw([source] + more)[2]) for more in ([], ["--error", "4"])]
        expect(told[0]["lights"] and told[0] == told[1], f"{source}: --error changes what is framed or lit: {told}")


def orders():
    """Several inputs in another order are the same scene."""
    pathlib.Path("raw.csv").write_text("x,y,z,intensity\n" + "".join(
        f"{i * 37 % 81 / 40},{i // 9 / 9},{0.1 * (i % 5)},{i % 50}\n" for i in range(81)))
    for pair in ("splats.ply raw.csv", "mesh.obj splats.ply", "splats.ply levels.lpc", "tree.cot mesh.obj", "plain.las ept"):
        for base in BASES:
            told = [draw(words + base.split()) for words in (pair.split(), pair.split()[::-1])]
            expect(told[0][0] == told[1][0] and close(framing(told[0][2]), framing(told[1][2])),
                   f"{pair}, {base}: the order changes what is framed or lit: {told[0][1]} {told[1][1]}")


n_compared = n_planes = 0
for source_kind, source in make_sources().items():
    n_compared += stays(source_kind, source.split())
    n_planes += planes(source_kind, source.split())
    files(source_kind, source.split())
same_light()
orders()
print(f"{n_compared} pictures with options of work, {n_planes} pairs of sources and planes")
sys.exit(failures > 0)
