"""command_options.py CONIC FOLDER: every option of the commands beside conic render, on inputs of several kinds, changes
what is written or said, or is refused. One that leaves all as it is, in silence, is wrong.

The options, and which of them decide no bit, come from conic help --format json: an option that has no case here is
wrong, too. The options of conic render that other commands share are tried by option_effects.py. Ends with 1 where
anything is wrong."""

import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

conic, folder = sys.argv[1], pathlib.Path(sys.argv[2])
os.chdir(folder)
# A value of each option that is none by default.
CASES = {
    "make": {"-o": "more.ply", "-n": "77", "--seed": "5", "--jitter": "0.3", "--noise": "0.2", "--far": "5,0,0", "--degree": "1",
             "--ascii": None},
    "prepare": {"--timeout": "3", "--deadline": "9", "--allow-outside": None, "-o": "more.ply", "--in-place": None, "-k": "6", "--ellipse": "bounding", "--features": "20", "--count": "30",
                "--seed": "4", "--columns": "y,x,z", "--colors": "linear", "--where": "x > 0.2", "--plain": None, "--bake": "ao",
                "--directions": "9", "--color-by": "height", "--ramp": "heat", "--up": "x"},
    "octree": {"--allow-outside": None, "-o": "more.cot", "--quantize": None, "--cutoff": "2", "-k": "6", "--columns": "y,x,z", "--colors": "linear", "--where": "x > 0.2",
               "--color-by": "height", "--ramp": "heat", "--up": "x"},
    "layer": {"--timeout": "3", "--deadline": "9", "--allow-outside": None, "-o": "more.lpc", "--cloud-size": "64", "--memory": "32", "--quantum": "0.1", "--cutoff": "2", "-k": "6",
              "--payload": "full", "--keep": "all", "--append": None, "--resumable": None, "--resume": "out.lpc",
              "--where": "x > 0.2", "--columns": "y,x,z", "--colors": "linear", "--color-by": "height", "--ramp": "heat", "--up": "x"},
    "merge": {"--timeout": "3", "--deadline": "9", "-o": "more.lpc", "--memory": "32", "--resumable": None, "--resume": "out.lpc"},
    "cut": {"--timeout": "3", "--deadline": "9", "--allow-outside": None, "-o": "more.ply", "--box": "0,0,1,1", "--polygon": "polygon.txt", "--where": "x > 0.2", "--keep": "none",
            "--error": "1", "--memory": "32", "--cutoff": "2", "--columns": "y,x,z", "--colors": "linear"},
    "mls": {"--allow-outside": None, "-o": "more.ply", "--in-place": None, "--type": "apss", "--plane": "fast", "--degree": "1", "--weight": "flat",
            "--h": "2x", "-k": "12", "--neglect": "1.5", "--cluster": "0.7", "--sharp": None, "--count": "90",
            "--max-error": "0.02", "--keep": "contribution", "--spacing": "1x", "--hole": "1x", "--memory": "32", "--isa": "scalar",
            "--columns": "y,x,z", "--colors": "linear"},
    "hybrid": {"--allow-outside": None, "--colors": "linear", "-o": "more.chy", "--phase1": "1", "--phase2": "-2", "--largest": "0.001", "--density": "4",
               "--most-error": "0", "--sampling": "box", "--texture": "texture.png", "--max-texture": "3", "--smooth": None,
               "--crease": "0", "--cutoff": "2", "--memory": "256", "--single": None, "--color-by": "height",
               "--ramp": "heat", "--up": "x"},
    "diff": {"--heatmap": "map.png", "--heatmap-of": "flip", "--max-abs": "9", "--min-psnr": "1", "--min-ssim": "-1",
             "--max-flip": "1", "--display": "both", "--reduce": None, "--match": "order", "--subset": None,
             "--csv": "table.csv"},
    "info": {"--allow-outside": None, "--check": None, "--cameras": None, "--size": "30x30"},
    "verify": {"--against": "exact", "--image": "picture.exr", "--pixels": "50", "--sample": "1", "--accumulate": "2",
               "--aperture": "0.2", "--focus": "1", "--shutter": "0:0.5", "--motion": "motion.json", "--turntable": "4",
               "--frames": "2", "--transparency": None},
    "judge": {"--picture": "other.exr", "--floats": "own", "--max-wrong": "9", "--pixels": "50", "--map": "map.png",
              "--report": "r.html", "--transfer": "linear", "--codes": "down", "--clipped": None, "--straight": None,
              "--no-diagnosis": None, "--allow-vague": None, "--time": None, "--suite": "suite", "--pictures": "suite/expected", "--level": "1",
              "--junit": "j.xml", "--gradients": "g.ply", "--weights": "picture.exr", "--raw": None,
              "--intermediates": "i.npz"},
    "project": {"-o": "more.npz", "--floats": "strict"},
    "explain": {"--pixel": "3,4", "--splat": "3", "--dump-projection": "d.csv", "--sample": "1", "--aperture": "0.2",
                "--focus": "1", "--shutter": "0:0.5", "--motion": "motion.json", "--turntable": "4", "--frames": "2"},
    "gradient": {"-o": "more.ply", "--weights": "other.exr", "--raw": None, "--floats": "fast", "--no-doubts": None},
    "conformance": {"--khr": None, "--profile": "exact", "--level": "1", "--floats": "strict"},
    "chart": {"-o": "more", "--quick": None, "--over": "samples", "--time": "1", "--beside": "x=1:picture.exr",
              "--truth": "2", "--pixels": "5", "--accumulate": "2"},
    "bench": {"--allow-outside": None, "--scenes": "sphere-1k", "--methods": "ray", "--profiles": "exact", "--isa": "scalar", "--threads": "1",
              "--simulate-threads": "2", "--command": "make sphere -n 9 -o s.ply", "--size": "40x40", "--camera": "camera.json", "--view": "0", "--cull": "back",
              "--device": "opencl", "--allow-inexact": None, "--error": "4", "--turntable": "2", "--repeat": "3",
              "--quick": None, "--compare": "none.json", "--publish": "p.json", "--curve": None, "--machine": None,
              "--kernels": None, "--floor": None},
    "csg": {"--timeout": "3", "--deadline": "9", "--allow-outside": None, "-o": "more.ply", "--union": None, "--intersection": None, "--difference": None, "-k": "6", "--cutoff": "2",
            "--columns": "y,x,z", "--colors": "linear"},
    "devices": {},
    "contact": {"-o": "more.png", "--size": "20", "--columns": "1"},
    "sheet": {"-o": "more.png", "--plan": None, "--facade": "40", "--section": "0,0.2:1,0.7:0.1", "--beyond": "0.1",
              "--scale": "1:30", "--dpi": "60", "--gsd": "0.1", "--paper": "A5", "--title": "a title", "--grid": "0.3",
              "--unit": "ft", "--north": "20", "--memory": "64", "--ao": "4", "--shadow": None},
    "convert": {"--allow-outside": None, "-o": "more.spz", "--to": "splat", "--sh-degree": "0", "--frame": "luf", "--from-frame": "luf",
                "--keep-order": None, "--sh-bits": "3", "--measure": "1", "--spz-version": "3"},
}
# What each command is tried on: its words without the option.
STAGES = [
    "make plane -o out.ply -n 50", "make terrain -o out.ply -n 50", "make gaussians -o out.ply -n 50",
    "make sphere -o out.ply -n 50 --jitter 0.2",
    "prepare splats.ply -o out.ply", "prepare raw.xyz -o out.ply", "prepare mesh.obj -o out.ply",
    "prepare raw.xyz -o out.ply --color-by height", "prepare raw.xyz -o out.ply --color-by rgb",
    "octree splats.ply -o out.cot", "octree raw.xyz -o out.cot",
    "layer splats.ply -o out.lpc", "layer raw.xyz -o out.lpc", "layer raw.xyz -o out.lpc --color-by height",
    "merge a.lpc a.lpc -o out.lpc",
    "cut splats.ply -o out.ply", "cut raw.xyz -o out.lpc", "cut a.lpc -o out.ply",
    "mls project raw.xyz -o out.ply", "mls project splats.ply -o out.ply --h 0.4", "mls thin raw.xyz -o out.ply --h 3x",
    "mls project raw.xyz -o out.ply --h 0.9", "mls densify small.xyz -o out.ply", "mls project raw.xyz -o out.ply --type apss",
    "csg ball.ply egg.ply --union -o out.ply", "hybrid fine.obj -o out.chy", "hybrid raw.xyz -o out.chy",
    "diff picture.exr other.exr", "diff picture.exr picture.exr", "diff pictures others",
    "info splats.ply", "info picture.exr", "info camera.json", "info g.spz", "info mesh.obj",
    "verify splats.ply --size 16x16", "verify g.spz --size 16x16", "verify splats.ply --size 16x16 --accumulate 2",
    "judge splats.ply --picture picture.exr --size 20x20", "judge splats.ply --picture picture.png --size 20x20",
    "judge g.spz --picture gaussians.exr --size 20x20",
    "explain splats.ply --size 20x20 --pixel 9,9", "explain g.spz --size 20x20 --pixel 9,9",
    "gradient g.spz --size 20x20 --profile gsplat-1.6 --weights picture.exr -o out.ply",
    "project g.spz --size 20x20 --profile gsplat-1.6 -o out.npz",
    "sheet splats.ply --section 0,0.3:1,0.4 -o out.png --dpi 40", "sheet mesh.obj --plan --facade 0 -o out.tif --dpi 40",
    "sheet g.spz -o out.pdf --dpi 40", "sheet raw.xyz --scale 1:20 -o out.png --dpi 40",
    "contact mesh.obj texture.png g.spz -o out.png --size 24",
    "convert g.ply -o out.spz", "convert g.spz -o out.ply", "convert g.spz -o out.splat",
]
# Of the commands whose outcome is a measurement: what is refused.
REFUSED = [
    "chart -o out --quick --over samples", "chart -o out --quick --beside x=1:picture.exr", "chart -o out --shade none",
    "chart -o out --truth 2", "chart -o out --camera camera.json", "chart splats.ply -o out --view 0",
    "chart -o out --size 20x20", "chart -o out --pixels 5", "chart splats.ply -o out --only methods",
    "chart splats.ply -o out --mesh mesh.obj", "chart -o out --time 1", "chart g.spz -o out --time 1",
    "chart g.spz -o out --samples 2", "chart splats.ply -o out --pixels 5", "chart -o out --accumulate 2", "bench --quick --camera camera.json", "bench splats.ply --view 0",
    "bench --quick --cull back", "bench --quick --allow-inexact", "bench --quick --error 4",
    "bench --curve --scenes plane", "bench --turntable 2 --repeat 2", "bench --kernels --machine",
    "judge splats.ply --picture picture.exr --level 1", "judge splats.ply --picture picture.exr --raw",
]
# What may rightly come to the same: (stage, option) with the reason.
SAME = {
    ("sheet g.spz -o out.pdf --dpi 40", "--plan"): "a plan is what a sheet has of itself",
    ("sheet raw.xyz --scale 1:20 -o out.png --dpi 40", "--plan"): "a plan is what a sheet has of itself",
    ("prepare mesh.obj -o out.ply", "--features"): "what is off the mesh is sharp anyway",
    ("mls project raw.xyz -o out.ply", "--cluster"): "no cells are so small",
    ("mls project raw.xyz -o out.ply --type apss", "--cluster"): "no cells are so small",
    ("hybrid raw.xyz -o out.chy", "--phase2"): "noise becomes no triangles",
    ("hybrid raw.xyz -o out.chy", "--density"): "noise becomes no triangles",
    ("hybrid raw.xyz -o out.chy", "--most-error"): "noise becomes no triangles",
    ("diff picture.exr other.exr", "--reduce"): "they have one size",
    ("diff picture.exr picture.exr", "--reduce"): "they have one size",
    ("diff pictures others", "--reduce"): "they have one size",
    ("diff pictures others", "--subset"): "none is missing",
    ("diff picture.exr picture.exr", "--max-abs"): "a limit that is kept",
    ("diff picture.exr picture.exr", "--min-psnr"): "a limit that is kept",
    ("diff picture.exr picture.exr", "--min-ssim"): "a limit that is kept",
    ("diff picture.exr picture.exr", "--max-flip"): "a limit that is kept",
    ("diff picture.exr picture.exr", "--display"): "they are identical",
    ("judge splats.ply --picture picture.exr --size 20x20", "--max-wrong"): "a limit that is kept",
    ("judge splats.ply --picture picture.exr --size 20x20", "--allow-vague"): "a limit that is kept",
    ("judge splats.ply --picture picture.png --size 20x20", "--max-wrong"): "a limit that is kept",
    ("judge splats.ply --picture picture.png --size 20x20", "--allow-vague"): "a limit that is kept",
    ("judge g.spz --picture gaussians.exr --size 20x20", "--max-wrong"): "a limit that is kept",
    ("judge g.spz --picture gaussians.exr --size 20x20", "--allow-vague"): "a limit that is kept",
    ("gradient g.spz --size 20x20 --profile gsplat-1.6 --weights picture.exr -o out.ply", "--floats"):
        "no decision is so near",
    ("info camera.json", "--cameras"): "it holds nothing else",
    ("convert g.spz -o out.splat", "--to"): "what the name says",
    ("convert g.spz -o out.splat", "--sh-degree"): "the format has none",
    ("layer splats.ply -o out.lpc", "--cutoff"): "what is given by its radius keeps it",
    ("layer raw.xyz -o out.lpc", "--cutoff"): "what is estimated covers the same",
    ("layer raw.xyz -o out.lpc --color-by height", "--cutoff"): "what is estimated covers the same",
    ("cut raw.xyz -o out.lpc", "--cutoff"): "what is estimated covers the same",
    ("cut splats.ply -o out.ply", "--keep"): "there are no values",
    ("cut raw.xyz -o out.lpc", "--keep"): "there are no values",
    ("cut a.lpc -o out.ply", "--keep"): "there are no values",
}


def fail(message):
    print("FAILED:", message)
    fail.count += 1


fail.count = 0


def run(*arguments, **more):
    return subprocess.run([conic, *arguments], stdin=subprocess.DEVNULL, capture_output=True, timeout=120, **more)


def need(*arguments):
    done = run(*arguments)
    if done.returncode > 1:
        sys.exit(f"FAILED: conic {' '.join(arguments)}: {done.stderr.decode()}")


def write_grid(name, n):
    lines = [f"v {i / n} {0.3 * (i % 2) / n + 0.3 * (i > n / 2)} {j / n}" for j in range(n + 1) for i in range(n + 1)]
    lines += [f"f {a} {a + n + 1} {a + n + 2} {a + 1}" for j in range(n) for i in range(n) for a in [j * (n + 1) + i + 1]]
    pathlib.Path(name).write_text("\n".join(lines) + "\n")


def make_inputs():
    need("make", "terrain", "-n", "300", "-o", "splats.ply")
    need("make", "sphere", "-n", "300", "--noise", "0.1", "-o", "raw.ply", "--ascii")
    lines = pathlib.Path("raw.ply").read_text().split("end_header\n")[1].splitlines()
    rows = [" ".join(line.split()[:3]) + f" {10 * i % 255} {3 * i % 255} 99" for i, line in enumerate(lines)]
    rows += [f"{3 + 0.7 * i} {i % 2} {0.3 * i * i} 200 200 200" for i in range(4)]  # which lie on no surface
    pathlib.Path("raw.xyz").write_text("\n".join(rows) + "\n")
    pathlib.Path("small.xyz").write_text("\n".join(rows[::3]) + "\n")
    for name, n in (("mesh.obj", 6), ("fine.obj", 30)):
        write_grid(name, n)
    need("layer", "raw.xyz", "-o", "a.lpc", "--cloud-size", "64")
    need("make", "sphere", "-n", "300", "-o", "ball.ply")
    need("make", "torus", "-n", "300", "-o", "egg.ply")
    need("make", "gaussians", "-n", "40", "-o", "g.ply")
    need("convert", "g.ply", "-o", "g.spz")
    pathlib.Path("polygon.txt").write_text("0 0\n1 0\n1 1\n0 1\n")
    pathlib.Path("camera.json").write_text(json.dumps({
        "width": 20, "height": 20, "fx": 20, "fy": 20, "cx": 9, "cy": 10,
        "world_to_camera": [[1, 0, 0, 0], [0, -1, 0, 0.2], [0, 0, -1, 3], [0, 0, 0, 1]]}))
    pathlib.Path("motion.json").write_text(json.dumps(
        {"frames": {"0": [[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]], "1": [[[1, 0, 0, 0.4], [0, 1, 0, 0], [0, 0, 1, 0]]]}}))
    size = ["--size", "20x20", "--samples", "1"]
    for each in ("pictures", "others"):
        os.makedirs(each)
        need("render", "splats.ply", *size, "-o", f"{each}/a.exr", "--azimuth", "5" if each == "others" else "30")
    need("render", "splats.ply", *size, "-o", "picture.exr", "-o", "picture.png", "-o", "texture.png")
    need("render", "splats.ply", *size, "-o", "other.exr", "--exposure", "1")
    need("render", "g.spz", *size, "-o", "gaussians.exr")


inputs = []


def outcome(words):
    """What a command comes to: its exit code, what it says, and its files by content."""
    out = folder / "out"
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir()
    for name in inputs:
        os.symlink(folder / name, out / name)
    done = run(*words, "--threads", "1", cwd=out)
    files = {str(p.relative_to(out)): hashlib.sha1(p.read_bytes()).hexdigest()
             for p in sorted(out.rglob("*")) if p.is_file() and not p.is_symlink()}
    # Milliseconds differ from run to run.
    said = re.sub(rb'"(render|oracle|read|open|judge|explain|diagnose|show|total|other)": [0-9.e+-]+', b"", done.stdout)
    said = re.sub(rb"\(\d+ ms\)", b"", said)
    return done.returncode, done.stderr, files, said


def main():
    table = json.loads(run("help", "--format", "json").stdout)
    commands = {c["name"]: c for c in table["commands"]}
    shared = {o["name"] for o in commands["render"]["options"]}
    make_inputs()
    inputs.extend(p.name for p in folder.iterdir())
    own = {}
    for name, command in commands.items():
        if name in ("render", "help"):
            continue
        drawing = {o["name"] for o in command["options"]} >= {"--shade", "--method", "--tile"}
        own[name] = {o["name"]: o for o in command["options"] if o["group"] != "options of every command" and
                     not (drawing and o["name"] in shared and o["name"] not in CASES.get(name, {}))}
        for option in sorted(set(own[name]) ^ set(CASES.get(name, {}))):
            fail(f"{name} {option}: an option without a case here, or a case without an option")
    n_pairs = n_silent = 0
    used = set()
    for stage in STAGES:
        words = stage.split()
        command = words[0]
        base = outcome(words)
        if base[0] > 1:
            fail(f"{stage}: {base[1].decode()}")
            continue
        for name, option in own[command].items():
            if name in words or option["is_work"]:
                continue
            value = CASES[command].get(name)
            n_pairs += 1
            got = outcome(words + [name] + ([value] if value else []))
            same = got[0] == base[0] and got[1:] == base[1:]
            if got[0] not in (0, 1, 2, 3):
                fail(f"{stage} {name}: exit code {got[0]}: {got[1].decode()}")
            reason = SAME.get((stage, name))
            used.update([(stage, name)] if same and reason else [])
            if same and not reason:
                n_silent += 1
                fail(f"{stage} {name} {value or ''}: all is the same, and nothing is said")
    for line in REFUSED:
        got = outcome(line.split())
        if got[0] != 2 or not got[1].startswith(b"conic: error: " + line.split()[0].encode()):
            fail(f"{line}: exit code {got[0]}, where it is wrong usage: {got[1].decode()}")
    for stage, name in sorted(set(SAME) - used):
        fail(f"{stage} {name}: may come to the same, but does not")
    print(f"{n_pairs} pairs, {n_silent} silent")


main()
sys.exit(1 if fail.count else 0)
