"""option_effects.py CONIC FOLDER: every option of conic render, of every kind of source and at every stage of a
picture, changes what is written, or something is said. A pair that draws the same in silence is wrong.

The options, and which of them decide no bit of a picture, come from conic help --format json: an option that has no case
here is wrong, too. Ends with 1 where anything is."""

import hashlib
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import zlib

conic, folder = sys.argv[1], pathlib.Path(sys.argv[2])
os.chdir(folder)
SIZE = ["--size", "48x48"]
# A value of each option that is none by default, in all that it can be asked for; with what else it takes to see it.
CASES = {
    "-o": [["-o", "more.pfm"]],
    "--exr": [["--exr", "half"], ["--exr", "none"]],
    "--tone": [["--tone", "agx"]],
    "--deep": [["--deep", "d.exr", "--samples", "1"]],
    "--show": [["--show", "overdraw:over.pfm"], ["--show", "overdraw-confetti:over.pfm"],
               ["--show", "clusters:clusters.pfm"], ["--show", "boxes:boxes.pfm"], ["--show", "boxes@2:boxes.pfm"], ["--show", "boxes@99:boxes.pfm"],
               ["--show", "legend:legend.pfm"], ["--show", "legend"]],
    "--turntable": [["--turntable", "2"]],
    "--path": [["--path", "keys.json", "--fps", "2"], ["--path", "keys.json", "--view", "0"]],
    "--fps": [["--fps", "2"]],
    "--film": [["--film", "10:20"]],
    "--frames": [["--frames", "2"]],
    "--resumable": [["--resumable"]],
    "--resume": [["--resume", "p.pfm"]],
    "--stereo": [["--stereo", "0.1"], ["--stereo", "0.1:2"], ["--stereo", "0:2"]],
    "--accumulate": [["--accumulate", "2"]],
    "--time": [["--time", "100"]],
    "--noise": [["--noise", "100"]],
    "--preview": [["--preview", "100"]],
    "--aperture": [["--aperture", "0.3"], ["--aperture", "0.3:5"], ["--aperture", "0:5"]],
    "--focus": [["--focus", "1"]],
    "--shutter": [["--shutter", "0:0.5"]],
    "--motion": [["--motion", "motion.json"]],
    "--box": [["--box", "0,0,1,1"]],
    "--progressive": [["--progressive", "levels"]],
    "--deadline": [["--deadline", "1000"]],
    "--tolerate": [["--tolerate"]],
    "--memory": [["--memory", "20"]],
    "--occlusion": [["--occlusion", "on"]],
    "--timeout": [["--timeout", "1"]],
    "--ao": [["--ao", "16"]],
    "--shadow": [["--shadow"]],
    "--transparency": [["--transparency"]],
    "--matte-by": [["--matte-by", "label", "--aov", "rgba,cryptomatte", "-o", "p.exr"], ["--matte-by", "label"]],
    "--catcher": [["--catcher", "INPUT", "--shadow", "--samples", "1"]],
    "--holdout": [["--holdout", "INPUT", "--samples", "1"]],
    "--place": [["--place", "INPUT=0.8,0,0.6,0,0,1,0,0,-0.6,0,0.8,0"]],
    "--repeat": [["--repeat", "2", "--samples", "2"]],
    "--size": [["--size", "32x40"]],
    "--camera": [["--camera", "camera.json"], ["--camera", "top:0.1:32632"]],
    "--view": [["--view", "0"], ["--view", "all"]],
    "--azimuth": [["--azimuth", "77"]],
    "--elevation": [["--elevation", "60"]],
    "--fov": [["--fov", "80"]],
    "--zoom": [["--zoom", "2"]],
    "--projection": [["--projection", word] for word in ("orthographic", "fisheye", "panorama", "cube")],
    "--eye": [["--eye", "1,2,3"]],
    "--up": [["--up", "x"]],
    "--as": [["--as", word] for word in ("points", "mesh", "hybrid")],
    "--texture": [["--texture", "texture.png"]],
    "--max-texture": [["--max-texture", "1"]],
    "--allow-outside": [["--allow-outside"]],
    "--crease": [["--crease", "0"], ["--crease", "90"], ["--crease", "all"]],
    "--color-by": [["--color-by", word] for word in ("height", "intensity", "nonsense", "normal")],
    "--ramp": [["--ramp", "heat"], ["--ramp", "0,1"], ["--ramp", "grey:0,1"]],
    "--where": [["--where", "x > 0.2"], ["--where", "intensity > 20"]],
    "--error": [["--error", "20"], ["--error", "8:50"], ["--error", "0:50"]],
    "--budget": [["--budget", "50"]],
    "--cache": [["--cache", "kept"]],
    "--only": [["--only", "triangles"], ["--only", "surfels"]],
    "--method": [["--method", word] for word in ("affine", "point", "patch", "patch:2", "patch:2:3x", "conic:2")],
    "--profile": [["--profile", word] for word in ("surface", "gsplat-1.6", "inria-2023:ignore-center",
                                                   "exact:ignore-center")],
    "--quality": [["--quality", "final"], ["--quality", "draft"]],
    "--kernel": [["--kernel", "box"]],
    "--cutoff": [["--cutoff", "3"]],
    "--prefilter": [["--prefilter", "9"]],
    "--epsilon": [["--epsilon", "10"]],
    "--passes": [["--passes", "1"]],
    "--samples": [["--samples", "3"]],
    "--cull": [["--cull", "back"]],
    "--near": [["--near", "100"]],
    "--shade": [["--shade", "lambert"], ["--shade", "none"], ["--shade", "edl"], ["--shade", "phong+edl:2"],
                ["--shade", "lambert:2"]],
    "--light": [["--light", "1,0,0"], ["--light", "none"], ["--light", "lamp:1,1,1"]],
    "--sky": [["--sky", "1,0,0"]],
    "--reflect": [["--reflect", "0.5", "--sky", "texture.png", "--ao", "2"], ["--reflect", "0.5"]],
    "--background": [["--background", "1,0,0"], ["--background", "1,0,0:0,1,0"]],
    "--exposure": [["--exposure", "2"], ["--exposure", "auto"]],
    "--aov": [["--aov", "rgba,Z," + plane] for plane in ("N", "albedo", "weight", "count", "id", "P", "cluster", "T", "medianZ",
                                             "inverseZ", "last", "doubt", "ao", "shadow", "samples", "variance",
                                             "cryptomatte")],
    "-k": [["-k", "6"]],
    "--columns": [["--columns", "y,x,z"]],
    "--colors": [["--colors", "linear"]],
    "--tile": [["--tile", "8"]],
    "--device": [["--device", "cpu"], ["--device", "cpu:inexact"]],
    "--plain": [["--plain"]],
    "--isa": [["--isa", "scalar"]],
    "--threads": [["--threads", "1"]],
    "--json": [["--json", "statistics.json"]],
    "--save-shot": [["--save-shot", "p.shot.txt"]],
    "--no-shot": [["--no-shot"]],
    "--again": [["--again", "none.exr"]],
    "--quiet": [["--quiet"]],
    "--verbose": [["--verbose"]],
    "--help": [["--help"]],
}
# What may rightly draw the same: (source, what comes before, the option) with the reason.
SAME = {
    ("mesh", "--as mesh"): "what it is drawn as anyway",
    ("textured", "--as mesh"): "what it is drawn as anyway",
    ("textured", "--only triangles"): "they all are",
    ("splats", "--view 0"): "the only one",
    ("splats", "--method patch"): "no patch is larger than a pixel",
    ("octree", "--method patch"): "no patch is larger than a pixel",
    ("splats", "--background 1,0,0"): "all of it is covered",
    ("levels", "--background 1,0,0"): "all of it is covered",
}
# At each stage: what comes before the option, and of which sources, among which the options are dealt out.
STAGES = {
    "default": ([], None),
    "png": (["-o", "p.png"], ["splats", "gaussians"]),
    "exr": (["-o", "p.exr"], ["splats"]),
    "stdout": (["-o", "-"], ["splats"]),
    "one pass": (["--passes", "1"], ["splats"]),
    "unlit": (["--shade", "none"], ["splats", "mesh"]),
    "points": (["--method", "point"], ["splats"]),
    "discs": (["--method", "disc"], ["splats"]),
    "patches": (["--method", "patch"], ["raw"]),
    "accumulated": (["--accumulate", "2"], ["splats", "gaussians"]),
    "lens": (["--accumulate", "2", "--aperture", "0.3"], ["mesh"]),
    "gathered": (["--projection", "fisheye", "--fov", "120"], ["splats"]),
    "panorama": (["--projection", "panorama", "--size", "48x24"], ["splats"]),
    "parallel": (["--projection", "orthographic"], ["mesh"]),
    "camera": (["--camera", "camera.json"], ["splats", "gaussians", "mesh"]),
    "cube": (["--projection", "cube", "--size", "16x96"], ["splats"]),
    "turntable": (["--turntable", "2"], ["splats"]),
    "standing": (["--eye", "0,0.3,3"], ["splats"]),
    "map": (["--camera", "top:0.05", "-o", "p.tif"], ["splats", "levels"]),
    "coloured": (["--color-by", "height"], ["splats", "mesh"]),
    "error": (["--error", "4"], ["octree", "levels"]),
    "budget": (["--budget", "80"], ["octree"]),
    "own light": (["--light", "1,0,0"], ["splats"]),
    "surfels": (["--only", "surfels"], ["hybrid"]),
    "surface": (["--profile", "surface"], ["gaussians"]),
    "profile": (["--profile", "inria-2023"], ["gaussians"]),
    "as points": (["--as", "points"], ["mesh"]),
    "as hybrid": (["--as", "hybrid"], ["textured"]),
    "shadows": (["--ao", "8", "--shadow"], ["splats"]),
    "settled": (["--samples", "1", "--method", "affine"], ["splats"]),
}


def fail(message):
    print("FAILED:", message)
    fail.count += 1


fail.count = 0


def run(*arguments, **more):
    return subprocess.run([conic, *arguments], stdin=subprocess.DEVNULL, capture_output=True, timeout=120, **more)


def need(*arguments):
    done = run(*arguments)
    if done.returncode:
        sys.exit(f"FAILED: conic {' '.join(arguments)}: {done.stderr.decode()}")


# --- sources: open, uneven surfaces, so that what is behind, within and at the edges counts ---


def height(x, y):
    return 0.4 * (1 - x * x - y * y) + (0.3 if x > 0.5 else 0.0)


def write_png(path, width, height_, pixel):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in pixel(x, y)) for y in range(height_))
    header = struct.pack(">IIBBBBB", width, height_, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) +
                     chunk(b"IEND", b""))


def write_grid(path, n, is_textured):
    lines = ["mtllib grid.mtl", "usemtl grid"] if is_textured else []
    at = [(2 * i / n - 1, 2 * j / n - 1) for j in range(n + 1) for i in range(n + 1)]
    lines += [f"v {x} {height(x, y)} {y}" for x, y in at]
    lines += [f"vt {0.5 + 0.5 * x} {0.5 + 0.5 * y}" for x, y in at if is_textured]
    for j in range(n):
        for i in range(n):
            a = j * (n + 1) + i + 1
            corners = (a, a + n + 1, a + n + 2, a + 1)
            lines.append("f " + " ".join(f"{c}/{c}" if is_textured else str(c) for c in corners))
    path.write_text("\n".join(lines) + "\n")


def write_las(path, n):
    records = b""
    for k in range(n * n):
        x, y = 2 * (k % n) / n - 1, 2 * (k // n) / n - 1
        place = [round(1000 * v) for v in (x, y, height(x, y))]
        records += struct.pack("<iiiHBBbBHdHHH", *place, k % 97, 9, 2 + k % 3, 0, 0, 0, 0.01 * k,
                               65280 * (k % n) // n, 32768, 65280 * (k // n) // n)
    header = struct.pack("<4sHHIHH8sBB32s32sHHHIIBHI5I", b"LASF", 0, 0, 0, 0, 0, b"", 1, 2, b"", b"", 1, 2026, 227, 227,
                         0, 3, 34, n * n, n * n, 0, 0, 0, 0)
    header += struct.pack("<12d", 1e-3, 1e-3, 1e-3, 0, 0, 0, 1, -1, 1, -1, 1, -1)
    path.write_bytes(header + records)


def make_sources():
    need("make", "terrain", "-n", "400", "-o", "splats.ply")
    write_las(pathlib.Path("raw.las"), 26)
    write_grid(pathlib.Path("mesh.obj"), 12, False)
    write_grid(pathlib.Path("textured.obj"), 8, True)
    pathlib.Path("grid.mtl").write_text("newmtl grid\nKd 1 1 1\nmap_Kd grid.png\n")
    write_png(pathlib.Path("grid.png"), 16, 16, lambda x, y: (16 * x, 255 if (x + y) % 2 else 40, 16 * y))
    write_png(pathlib.Path("texture.png"), 16, 16, lambda x, y: (255, 16 * y, 16 * x))
    need("octree", "splats.ply", "-o", "octree.cot")
    need("layer", "raw.las", "-o", "levels.lpc", "--cloud-size", "64")
    write_grid(pathlib.Path("fine.obj"), 40, True)
    need("hybrid", "fine.obj", "-o", "hybrid.chy")
    need("make", "gaussians", "-n", "300", "-o", "g.ply")
    need("convert", "g.ply", "-o", "gaussians.spz")
    pathlib.Path("camera.json").write_text(json.dumps({
        "width": 48, "height": 48, "fx": 50, "fy": 50, "cx": 20, "cy": 25,
        "world_to_camera": [[1, 0, 0, 0], [0, -1, 0, 0.2], [0, 0, -1, 3], [0, 0, 0, 1]]}))
    pathlib.Path("keys.json").write_text(json.dumps({"keys": [
        {"time": 0, "place": [0, 1, 3], "target": [0, 0, 0]}, {"time": 1, "place": [3, 1, 0]}]}))
    pathlib.Path("motion.json").write_text(json.dumps([
        {"input": 0, "frame": 0, "matrix": [[1, 0, 0, 0.4], [0, 1, 0, 0], [0, 0, 1, 0]]}]))
    return {"splats": "splats.ply", "raw": "raw.las", "mesh": "mesh.obj", "textured": "textured.obj",
            "octree": "octree.cot", "levels": "levels.lpc", "hybrid": "hybrid.chy", "gaussians": "gaussians.spz"}


def outcome(source, arguments):
    """What a picture comes to: its exit code, what it says, and its files by content."""
    out = folder / "out"
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir()
    words = [word.replace("INPUT", source) for word in arguments]
    if "-o" not in words:
        words = ["-o", "p.pfm"] + words
    words = [str(folder / w) if w.endswith((".json", "texture.png")) and w != "statistics.json" else w for w in words]
    if "--size" not in words and not any(w.startswith("top") for w in words):
        words += SIZE
    # What a picture says of how it was made would be another whatever it shows; the option is tried the other way round.
    words = [w for w in words if w != "--no-shot"] if "--no-shot" in words else words + ["--no-shot"]
    if "--threads" not in words:
        words += ["--threads", "1"]
    done = run("render", str(folder / source), *words, cwd=out)
    files = {str(p.relative_to(out)): hashlib.sha1(p.read_bytes()).hexdigest()
             for p in sorted(out.rglob("*")) if p.is_file()}
    said = b"\n".join(line for line in done.stderr.splitlines() if not line.startswith(b"conic: up: "))
    return done.returncode, said, files, hashlib.sha1(done.stdout).hexdigest()


def main():
    table = json.loads(run("help", "--format", "json").stdout)
    options = next(c for c in table["commands"] if c["name"] == "render")["options"]
    for name in sorted({o["name"] for o in options} ^ set(CASES)):
        fail(f"{name}: an option without a case here, or a case without an option")
    works = {o["name"] for o in options if o["is_work"]}
    sources = make_sources()
    n_pairs = n_silent = 0
    used = set()
    for stage, (before, kinds) in STAGES.items():
        for number, kind in enumerate(kinds or sources):
            base = outcome(sources[kind], before)
            if base[0]:
                fail(f"{kind}, {stage}: {base[1].decode()}")
                continue
            for option in options:
                if kinds and zlib.crc32(option["name"].encode()) % len(kinds) != number:
                    continue  # another of the stage's sources has it
                if option["name"] in before or (kinds and option["name"] in works):
                    continue
                cases = CASES.get(option["name"], [])
                # At a stage, what an option's words share; each of them is tried of every source where nothing is before.
                for case in cases if kinds is None else cases[:1]:
                    n_pairs += 1
                    words = before + case
                    got = outcome(sources[kind], words)
                    same = got[0] == 0 and got[1] == base[1] and got[2:] == base[2:]
                    if got[0] not in (0, 2, 3):
                        fail(f"{kind}, {stage}: {' '.join(case)}: exit code {got[0]}: {got[1].decode()}")
                    reason = SAME.get((kind, " ".join(case)))
                    used.update([(kind, " ".join(case))] if same and reason else [])
                    if same and option["name"] not in works and not reason:
                        n_silent += 1
                        fail(f"{kind}, {stage}: {' '.join(case)}: the same picture, and nothing is said")
    for kind, case in sorted(set(SAME) - used):
        fail(f"{kind}: {case}: may draw the same, but does not")
    print(f"{n_pairs} pairs, {n_silent} silent")


main()
sys.exit(1 if fail.count else 0)
