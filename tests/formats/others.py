"""Files that other libraries write, and what they read of them, beside what conic reads: others.py CONIC FOLDER."""

import importlib
import json
import pathlib
import subprocess
import sys

import numpy

conic, folder = sys.argv[1], pathlib.Path(sys.argv[2])
failures = 0
random = numpy.random.default_rng(7)
places = numpy.round(random.uniform(-50, 50, (500, 3)), 3)
codes = random.integers(1, 256, (500, 3))
times = 189446023.0587 + 0.0054 * numpy.arange(500)


def check(name, is_so, what):
    global failures
    if not is_so:
        print(f"FAILED: {name}: {what}")
        failures += 1


def info(path):
    """What conic info says of it."""
    subprocess.run([conic, "info", str(path), "--check", "--json", str(folder / "info.json"), "-q"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return json.loads((folder / "info.json").read_text())


def table(path):
    """Places, and linear colours or None, as conic cut writes them."""
    subprocess.run([conic, "cut", str(path), "-o", str(folder / "cut.ply"), "--keep", "none", "-q"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    data = (folder / "cut.ply").read_bytes()
    end = data.index(b"end_header\n") + 11
    types = {"float": "<f4", "double": "<f8", "uchar": "u1"}
    fields = [line.split()[1:] for line in data[:end].decode().splitlines() if line.startswith("property")]
    rows = numpy.frombuffer(data[end:], [(name, types[kind]) for kind, name in fields])
    colors = numpy.stack([rows[c] for c in ("red", "green", "blue")], 1) if "red" in rows.dtype.names else None
    return numpy.stack([rows[axis] for axis in "xyz"], 1).astype(float), colors


def same_points(name, path, bound=1e-5, has_colors=True):
    found, colors = table(path)
    check(name, found.shape == places.shape and numpy.abs(found - places).max() <= bound, "places")
    if colors is not None and colors.dtype != numpy.uint8:  # linear
        colors = 255 * numpy.where(colors > 0.0031308, 1.055 * colors.astype(float)**(1 / 2.4) - 0.055, 12.92 * colors)
    if has_colors:
        check(name, colors is not None and numpy.abs(colors.astype(float) - codes).max() < 1e-3, "colours")


def with_laspy(laspy):
    for form in (2, 3, 5, 7, 8):
        header = laspy.LasHeader(point_format=form, version="1.4" if form > 5 else "1.3")
        header.scales, header.offsets = [0.001] * 3, [0, 0, 0]
        for scale in (1, 256, 257):
            las = laspy.LasData(header)
            las.x, las.y, las.z = places.T
            las.red, las.green, las.blue = (codes * scale).T
            if form != 2:
                las.gps_time = times
            las.write(str(folder / "a.las"))
            same_points(f"laspy {form} x{scale}", folder / "a.las", 1e-9 + 1e-5)
            said = {value["name"]: value for value in info(folder / "a.las")["values"]}
            if form != 2:
                check(f"laspy {form}", said["gps_time"]["minimum"] == times[0] and
                      said["gps_time"]["maximum"] == times[-1], "times")


def with_pye57(pye57):
    e57 = pye57.E57(str(folder / "a.e57"), mode="w")
    e57.write_scan_raw({**{f"cartesian{a}": places[:, i] for i, a in enumerate("XYZ")},
                        **{f"color{c}": codes[:, i].astype(numpy.uint8) for i, c in enumerate(("Red", "Green", "Blue"))}})
    e57.close()
    same_points("pye57", folder / "a.e57")


def with_plyfile(plyfile):
    for kind, white in (("u1", 255), ("u2", 255), ("u2", 65535), ("f4", 1), ("f8", 1), ("f4", 255), ("i4", 255)):
        for text, order in ((True, "="), (False, "<"), (False, ">")):
            values = codes * (white / 255.0)
            rows = numpy.empty(500, [(axis, "f8") for axis in "xyz"] + [(c, kind) for c in ("red", "green", "blue")])
            for i in range(3):
                rows["xyz"[i]], rows[("red", "green", "blue")[i]] = places[:, i], values[:, i]
            plyfile.PlyData([plyfile.PlyElement.describe(rows, "vertex")], text=text, byte_order=order).write(
                str(folder / "a.ply"))
            same_points(f"plyfile {kind}/{white} {order}", folder / "a.ply")


def with_trimesh(trimesh):
    box = trimesh.creation.icosphere(subdivisions=2)
    box.visual.vertex_colors = random.integers(0, 256, (len(box.vertices), 4))
    for ending in ("ply", "obj", "off", "stl", "glb", "stl_ascii"):
        path = folder / f"a.{ending[:3]}"
        box.export(str(path), file_type=ending)
        said = info(path)
        check(f"trimesh {ending}", said["triangles"] == len(box.faces) and said["points"] == len(box.vertices), said)
        check(f"trimesh {ending}", numpy.allclose([said["bounds"]["min"], said["bounds"]["max"]], box.bounds, atol=1e-6),
              "bounds")


missing = []
for module, compare in (("laspy", with_laspy), ("pye57", with_pye57), ("plyfile", with_plyfile), ("trimesh", with_trimesh)):
    try:
        library = importlib.import_module(module)
    except ImportError:
        missing.append(module)
        continue
    compare(library)
if missing:
    print("skipped: not installed: " + ", ".join(missing))
sys.exit(1 if failures else 77 if len(missing) == 4 else 0)
