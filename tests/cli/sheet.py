"""sheet.py MAKE SCENE.obj WIDTH HEIGHT SIZE X Y: squares of that size in the corners of a box of WIDTH x HEIGHT whose
lower left corner is X, Y. sheet.py EDGES SHEET.tif REPORT.json PIXELS: of the first panel, the squares' edges are where
the report says that they are, to a pixel, and so far apart."""

import json
import struct
import sys
import zlib


def make(path, width, height, size, x, y):
    with open(path, "w", encoding="ascii") as out:
        for i, (a, b) in enumerate([(0, 0), (width - size, 0), (0, height - size), (width - size, height - size)]):
            for right, up in ((0, 0), (size, 0), (size, size), (0, size)):
                out.write(f"v {x + a + right:.3f} {y + b + up:.3f} 0 0.1 0.1 0.1\n")
            out.write("f " + " ".join(str(4 * i + k) for k in (1, 2, 3, 4)) + "\n")


class Sheet:
    """The tiles of a TIFF, of which rows and columns are unpacked where they are asked for."""

    def __init__(self, path):
        self.bytes = open(path, "rb").read()
        tags, at = {}, struct.unpack_from("<I", self.bytes, 4)[0]
        for i in range(struct.unpack_from("<H", self.bytes, at)[0]):
            tag, kind, count = struct.unpack_from("<HHI", self.bytes, at + 2 + 12 * i)
            code = {3: "H", 4: "I"}.get(kind)
            place = at + 10 + 12 * i
            if code and count * struct.calcsize(code) > 4:
                place = struct.unpack_from("<I", self.bytes, place)[0]
            tags[tag] = struct.unpack_from(f"<{count}{code}", self.bytes, place) if code else None
        self.width, self.height = tags[256][0], tags[257][0]
        self.offsets, self.lengths = tags[324], tags[325]
        self.across = (self.width + 255) // 256
        self.tiles = {}

    def tile_row(self, tile, row):
        """Red of a tile's row: differences are summed up."""
        if tile not in self.tiles:
            self.tiles[tile] = zlib.decompress(self.bytes[self.offsets[tile]:self.offsets[tile] + self.lengths[tile]])
        sum_, reds = 0, []
        for step in self.tiles[tile][1024 * row:1024 * row + 1024:4]:
            sum_ = (sum_ + step) & 255
            reds.append(sum_)
        return reds

    def row(self, y, x0, x1):
        tiles = range(x0 // 256, (x1 + 255) // 256)
        reds = [red for t in tiles for red in self.tile_row(y // 256 * self.across + t, y % 256)]
        return reds[x0 % 256:x0 % 256 + x1 - x0]

    def column(self, x, y0, y1):
        return [self.tile_row(y // 256 * self.across + x // 256, y % 256)[x % 256] for y in range(y0, y1)]


def edges_of(reds):
    """Where paper ends and begins."""
    dark = [i for i, red in enumerate(reds) if red < 245]
    breaks = [i for i in range(1, len(dark)) if dark[i] != dark[i - 1] + 1]
    runs = zip([0] + breaks, breaks + [len(dark)])
    return [edge for begin, end in runs for edge in (dark[begin], dark[end - 1] + 1)]


def check(path, report_path, pixels):
    report, sheet = json.load(open(report_path, encoding="utf-8")), Sheet(path)
    panel = report["panels"][0]
    assert (sheet.width, sheet.height) == (report["width"], report["height"])
    x0, y0, x1, y1 = panel["x"], panel["y"], panel["x"] + panel["width"], panel["y"] + panel["height"]
    inset = 18 + int(pixels / 3)  # the frame, free paper, and on into the square, beside the grid's crosses
    for name, reds in [("above", sheet.row(y0 + inset, x0, x1)), ("below", sheet.row(y1 - inset, x0, x1)),
                       ("left", sheet.column(x0 + inset, y0, y1)), ("right", sheet.column(x1 - inset, y0, y1))]:
        edges = edges_of(reds)
        assert len(edges) == 4, f"{name}: {edges}"
        for first, last in ((edges[0], edges[1]), (edges[2], edges[3])):
            assert abs(last - first - pixels) <= 1, f"{name}: an edge of {last - first} pixels, not {pixels}"
        whole = (len(reds) - 2 * edges[0]) if name in ("above", "below") else None
        assert whole is None or abs(edges[3] - edges[0] - whole) <= 1, f"{name}: from {edges[0]} to {edges[3]}"
    world = report["gsd"] * (edges_of(sheet.row(y0 + inset, x0, x1))[3]) + panel["left"]
    print(f"{world:.3f}")


if sys.argv[1] == "make":
    make(sys.argv[2], *map(float, sys.argv[3:8]))
else:
    check(sys.argv[2], sys.argv[3], float(sys.argv[4]))
