"""`map.py CONIC HAS_ZSTD`: maps that conic draws, read by a TIFF reader of the tests' own. Prints what is not as it should
be, and exits 1."""
import json
import os
import random
import struct
import subprocess
import sys
import tempfile
import zlib

n_wrong = 0
NODATA = -9999.0


def expect(is_good, what):
    global n_wrong
    if not is_good:
        n_wrong += 1
        print("BAD", what, flush=True)


def conic(*words):
    done = subprocess.run([sys.argv[1], *words], capture_output=True, text=True, check=False)
    expect(done.returncode == 0 and not done.stderr, f"{words}: {done.returncode} {done.stderr}")


def read_tiff(path):
    """Its tags, and its rows of pixels: (R, G, B, A), or heights."""
    with open(path, "rb") as file:
        data = file.read()
    expect(data[:4] == b"II*\0", f"{path}: is no TIFF")
    at, = struct.unpack_from("<I", data, 4)
    tags, forms = {}, {2: "s", 3: "H", 4: "I", 12: "d"}
    expect(at % 2 == 0, f"{path}: its directory is at an odd byte")
    for i in range(struct.unpack_from("<H", data, at)[0]):
        tag, kind, count = struct.unpack_from("<HHI", data, at + 2 + 12 * i)
        form = f"<{count}{forms[kind]}"
        place = at + 10 + 12 * i
        if struct.calcsize(form) > 4:
            place, = struct.unpack_from("<I", data, place)
        expect(not tags or tag > max(tags), f"{path}: tag {tag} is out of order")
        tags[tag] = struct.unpack_from(form, data, place)
    width, height, edge = tags[256][0], tags[257][0], tags[322][0]
    across, is_height = -(-width // edge), tags[277][0] == 1
    rows = [[None] * width for _ in range(height)]
    for i, (offset, size) in enumerate(zip(tags[324], tags[325])):
        tile = data[offset:offset + size]
        tile = zlib.decompress(tile) if tags[259][0] == 8 else tile
        for y in range(i // across * edge, min(i // across * edge + edge, height)):
            first = i % across * edge
            line = tile[(y - i // across * edge) * edge * 4:][:edge * 4]
            if is_height:
                pixels = list(struct.unpack(f"<{edge}f", line))
            else:
                pixels, last = [], (0, 0, 0, 0)
                for pixel in struct.iter_unpack("<4B", line):
                    last = tuple((a + b) % 256 for a, b in zip(last, pixel)) if tags[317][0] == 2 else pixel
                    pixels.append(last)
            rows[y][first:first + edge] = pixels[:width - first]
    return tags, rows


def corner_of(tags, path):
    """The picture's upper left corner, of which the world file says the same."""
    pixel, corner = tags[33550][0], tags[33922][3:5]
    with open(path, encoding="ascii") as file:
        lines = [float(line) for line in file]
    wanted = [pixel, 0.0, 0.0, -pixel, corner[0] + pixel / 2, corner[1] - pixel / 2]
    expect(lines == wanted, f"{path}: {lines}, not {wanted}")
    return pixel, corner


def check_places():
    """Points each in a pixel of their own are where they are, and nothing is elsewhere."""
    chance = random.Random(1)
    points = [(635500 + 3.5 * i + 0.5 * chance.uniform(0.02, 0.98), 4980100 + 14 * k + 0.5 * chance.uniform(0.02, 0.98),
               chance.uniform(-40, 90)) for i in range(150) for k in range(8)]
    with open("points.csv", "w", encoding="ascii") as file:
        file.write("x,y,z\n" + "".join(f"{x:.4f},{y:.4f},{z:.3f}\n" for x, y, z in points))
    conic("render", "points.csv", "--camera", "top:0.5:26910", "--method", "point", "--aov", "rgba,Z",
          "-o", "p.tif")
    tags, rows = read_tiff("p.tif")
    height_tags, heights = read_tiff("p.Z.tif")
    pixel, corner = corner_of(tags, "p.tfw")
    wanted = {(int((x - corner[0]) // pixel), int((corner[1] - y) // pixel)): z for x, y, z in points}
    got = {(x, y) for y, row in enumerate(rows) for x, value in enumerate(row) if value[3]}
    expect(len(wanted) == 1200 and got == set(wanted), f"{len(got ^ set(wanted))} pixels are not the points'")
    off = max(abs(heights[y][x] - z) for (x, y), z in wanted.items())
    expect(off < 0.002, f"heights are off by {off}")
    expect(heights[1][1] == NODATA and height_tags[42113] == (b"-9999\0",), "where nothing is, is no -9999")
    expect(tags[34735] == (1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 26910), f"keys {tags[34735]}")


def crop(whole, part, path):
    """Whether a picture is, to the bit, a part of another: of both, tags, rows and world file."""
    (tags, rows), (part_tags, part_rows) = whole, part
    pixel, corner = corner_of(tags, "whole.tfw")
    _, begin = corner_of(part_tags, path)
    x, y = round((begin[0] - corner[0]) / pixel), round((corner[1] - begin[1]) / pixel)
    return [row[x:x + len(part_rows[0])] for row in rows[y:y + len(part_rows)]] == part_rows


def write_slope(path, shift):
    chance = random.Random(2)
    with open(path, "w", encoding="ascii") as file:
        file.write("x,y,z,red,green,blue\n")
        for i in range(90):
            for k in range(60):
                x, y = i + chance.random(), k + chance.random()
                place = f"{500000 + x + shift:.3f},{4000000 + y - shift:.3f},{0.5 * x - 0.25 * y:.4f}"
                file.write(f"{place},{9 + 2 * i},{4 * k},77\n")


def check_seams():
    """What lies half a block farther on, and so is parted elsewhere, looks the same to within what is rounded."""
    pictures = []
    for shift in (0, 32):
        write_slope("shifted.csv", shift)
        conic("render", "shifted.csv", "--camera", "top:0.25", "--shade", "phong", "-o", "shifted.tif")
        pictures.append(read_tiff("shifted.tif")[1])
    off = [max(abs(a - b) for a, b in zip(*pixels)) for rows in zip(*pictures) for pixels in zip(*rows)]
    expect(len(off) > 80000 and max(off) <= 2, f"seams show: {max(off)} codes")


def check_windows(has_zstd):
    """A slope of splats: heights lie on it, and what is drawn of a part of it is a part of what is drawn of it."""
    write_slope("slope.csv", 0)
    conic("layer", "slope.csv", "-o", "slope.lpc") if has_zstd else None
    box = ["--box", "500020,4000010,500063.5,4000044"]
    for name in ["slope.csv", "slope.lpc"][:1 + has_zstd]:
        draw = ["render", name, "--camera", "top:0.25", "--aov", "rgba,Z"]
        small = ["--memory", "1", "--threads", "3"] if name.endswith("lpc") else ["--tile", "16", "--threads", "3"]
        conic(*draw, "-o", "whole.tif")
        conic(*draw, *box, *small, "-o", "part.tif", "-o", "part.png", "--json", "part.json")
        for kind in ("", ".Z"):
            whole, part = read_tiff(f"whole{kind}.tif"), read_tiff(f"part{kind}.tif")
            expect(len(part[1]) == 136 and len(part[1][0]) == 174, f"{name}: a part of {len(part[1])} rows")
            expect(crop(whole, part, f"part{kind}.tfw"), f"{name}: a part is another picture")
        tags, heights = part
        _, corner = corner_of(tags, "part.Z.tfw")
        east, north = corner[0] + 0.125 - 500000, corner[1] - 0.125 - 4000000
        off = max(abs(z - 0.5 * (east + 0.25 * x) + 0.25 * (north - 0.25 * y))
                  for y, row in enumerate(heights) for x, z in enumerate(row))
        expect(off < (0.5 if name.endswith("lpc") else 0.1), f"{name}: heights are off the slope by {off}")
        with open("part.json", encoding="utf-8") as file:
            told = json.load(file)
        expect(told["top"]["width"] == 174 and told["top"]["corner"] == list(corner), f"{name}: {told['top']}")


def check_mesh():
    """Triangles that make a steep slope: every pixel is on it, and a part is a part."""
    with open("mesh.ply", "w", encoding="ascii") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex 153\nproperty double x\nproperty double y\nproperty double z\n"
                   "element face 128\nproperty list uchar int vertex_indices\nend_header\n")
        for i in range(153):
            x, y = i % 17 * 5, i // 17 * 5 + 100
            file.write(f"{600000 + x} {y} {2.5 * x + 5 * y}\n")
        for i in range(128):
            first = i // 16 * 17 + i % 16
            file.write(f"4 {first} {first + 1} {first + 18} {first + 17}\n")
    draw = ["render", "mesh.ply", "--camera", "top:0.25", "--samples", "1", "--aov", "Z"]
    conic(*draw, "-o", "whole.tif")
    conic(*draw, "--box", "600010.5,103,600060,130", "-o", "part.tif")
    whole, part = read_tiff("whole.tif"), read_tiff("part.tif")
    expect(crop(whole, part, "part.tfw"), "a part of a mesh is another picture")
    _, corner = corner_of(whole[0], "whole.tfw")
    east, north = corner[0] + 0.125 - 600000, corner[1] - 0.125
    off = max(abs(whole[1][y][x] - 2.5 * (east + 0.25 * x) - 5 * (north - 0.25 * y))
              for y in range(1, 159) for x in range(1, 319))
    expect(len(whole[1]) == 161 and off < 0.05, f"heights are off the mesh by {off}")


def record(number, body):
    return struct.pack("<H16sHH32s", 0, b"LASF_Projection", number, len(body), b"") + body


def check_references():
    """What records of a LAS say of the world stands in the GeoTIFF."""
    text = (b'COMPD_CS["a [b", PROJCS["WGS 84 / UTM zone 10N",GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]],'
            b'AUTHORITY["EPSG","32610"]],VERT_CS["c",AUTHORITY["EPSG","5703"]]]\0')
    keys = struct.pack("<16H", 1, 1, 0, 3, 1024, 0, 1, 1, 2062, 34736, 1, 0, 3072, 0, 1, 26910)
    broken = struct.pack("<8H", 1, 1, 0, 1, 2062, 34736, 2, 0)
    kept = (1, 1, 0, 4, 1024, 0, 1, 1, 1025, 0, 1, 1, 2062, 34736, 1, 0, 3072, 0, 1, 26910)
    made = (1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32610)
    only = (1, 1, 0, 1, 1025, 0, 1, 1)
    numbers = record(34736, struct.pack("<d", 2.5))
    for name, records, wanted in (("keys", [record(34735, keys), numbers], kept), ("text", [record(2112, text)], made),
                                  ("broken", [record(34735, broken), numbers], only), ("none", [], only)):
        body = b"".join(records)
        head = bytearray(227)
        head[:4], head[24], head[25] = b"LASF", 1, 2
        struct.pack_into("<HII", head, 94, 227, 227 + len(body), len(records))
        struct.pack_into("<BHI", head, 104, 0, 20, 9)
        struct.pack_into("<3d3d", head, 131, 0.01, 0.01, 0.01, 500000, 4000000, 0)
        points = b"".join(struct.pack("<3i8x", 100 * (i % 3), 100 * (i // 3), 0) for i in range(9))
        with open("one.las", "wb") as file:
            file.write(bytes(head) + body + points)
        conic("render", "one.las", "--camera", "top:0.1", "-o", "one.tif")
        tags, rows = read_tiff("one.tif")
        expect(tags[34735] == wanted, f"{name}: keys {tags[34735]}")
        expect(tags.get(34736) == ((2.5,) if name == "keys" else None), f"{name}: numbers {tags.get(34736)}")
        expect(rows[10][10][3] == 255, f"{name}: the middle is empty")


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        check_places()
        check_windows(int(sys.argv[2]))
        check_seams()
        check_mesh()
        check_references()
    return n_wrong > 0


sys.exit(main())
