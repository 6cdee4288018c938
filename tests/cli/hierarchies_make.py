"""Hierarchies of points for tests, written by rules of their own: `hierarchies_make.py FOLDER [POINTS]` makes a LAS of a
dented sphere in map coordinates, and of the same octree potree/, brotli/ (where Python has brotli) and ept/."""
import json
import math
import os
import random
import struct
import sys

SCALE, CENTER, RADIUS = 0.001, (636000.5, 851000.25, 500.0), 50.0
EDGE = 128.0
LOW = [c - EDGE / 2 for c in CENTER]
GRID, MOST, LEVELS, STEP = 8, 100, 5, 2  # cells along a node, points of a leaf, levels, levels of a page


def files_of(folder):
    """The bytes of all files below a folder, by their names from there."""
    found = {}
    for base, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(base, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, folder)] = file.read()
    return found


def points_of(n):
    chance = random.Random(7)
    for _ in range(n):
        z, turn = chance.uniform(-1, 1), chance.uniform(0, 2 * math.pi)
        across = math.sqrt(1 - z * z)
        d = (across * math.cos(turn), across * math.sin(turn), z)
        r = RADIUS * (1 + 0.1 * math.sin(5 * turn) * across)
        steps = tuple(round((CENTER[k] + r * d[k] - CENTER[k]) / SCALE) for k in range(3))
        color = tuple(int(65535 * (0.5 + 0.5 * d[k])) for k in range(3))
        yield steps, color


def cell(point, level):
    return tuple(int((CENTER[k] + point[0][k] * SCALE - LOW[k]) / EDGE * 2 ** level) for k in range(3))


def grow(points, level, place, nodes):
    """nodes[level, place]: what stays of the points in this node; the rest goes to its children."""
    if len(points) <= MOST or level == LEVELS - 1:
        nodes[level, place] = points
        return
    taken, rest = {}, {}
    for point in points:
        at = cell(point, level + GRID.bit_length() - 1)
        if at in taken:
            rest.setdefault(cell(point, level + 1), []).append(point)
        else:
            taken[at] = point
    nodes[level, place] = list(taken.values())
    for child in sorted(rest):
        grow(rest[child], level + 1, child, nodes)


def octant(place):
    return (place[0] & 1) << 2 | (place[1] & 1) << 1 | place[2] & 1


def children(nodes, level, place):
    found = [key for key in nodes if key[0] == level + 1 and tuple(c >> 1 for c in key[1]) == place]
    return sorted(found, key=lambda key: octant(key[1]))


def put(path, data):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(data)


def intensity(point):
    return point[1][0] >> 4


def spread(value, n):
    return sum((value >> i & 1) << 3 * i for i in range(n))


def morton(values, shift, n):
    return sum(spread((value & 0xffffffff) >> shift & (1 << n) - 1, n) << k for k, value in enumerate(values))


def plain_record(point):
    return struct.pack("<3iHB3H", *point[0], intensity(point), 2, *point[1])


def planes(points):
    return (b"".join(struct.pack("<QQ", morton(p[0], 16, 16), morton(p[0], 0, 16)) for p in points) +
            b"".join(struct.pack("<H", intensity(p)) for p in points) + b"\2" * len(points) +
            b"".join(struct.pack("<Q", morton(p[1], 0, 16)) for p in points))


def write_potree(folder, nodes, n_points, pack):
    octree, places = b"x" * 70000, {}
    for key in sorted(nodes, reverse=True):  # the root last, so that it is not in the first answer of a server
        data = pack(planes(nodes[key])) if pack else b"".join(map(plain_record, nodes[key]))
        places[key] = (len(octree), len(data))
        octree += data
    pages = {}

    def make_page(root):
        queue, page = [root], []
        for key in queue:
            below = children(nodes, *key)
            if key != root and (key[0] - root[0]) % STEP == 0 and below:
                page.append((2, 0, key))
                make_page(key)
                continue
            page.append((0 if below else 1, sum(1 << octant(c[1]) for c in below), key))
            queue += below
        pages[root] = page

    make_page((0, (0, 0, 0)))
    order = sorted(pages)
    offsets, at = {}, 0
    for root in order:
        offsets[root] = at
        at += 22 * len(pages[root])
    hierarchy = b""
    for root in order:
        for kind, mask, key in pages[root]:
            where = (offsets[key], 22 * len(pages[key])) if kind == 2 else places[key]
            hierarchy += struct.pack("<BBIQQ", kind, mask, len(nodes[key]), *where)

    def attribute(name, kind, n, size, low=(0,), high=(1,)):
        return {"name": name, "description": "", "size": n * size, "numElements": n, "elementSize": size, "type": kind,
                "min": list(low), "max": list(high)}

    everything = [p for node in nodes.values() for p in node]
    box = [[CENTER[k] + f(p[0][k] for p in everything) * SCALE for k in range(3)] for f in (min, max)]
    metadata = {"version": "2.0", "name": "dented", "points": n_points, "projection": "",
                "hierarchy": {"firstChunkSize": 22 * len(pages[(0, (0, 0, 0))]), "stepSize": STEP, "depth": LEVELS},
                "offset": CENTER, "scale": [SCALE] * 3, "spacing": EDGE / GRID,
                "boundingBox": {"min": LOW, "max": [v + EDGE for v in LOW]},
                "encoding": "BROTLI" if pack else "DEFAULT",
                "attributes": [attribute("position", "int32", 3, 4, *box), attribute("intensity", "uint16", 1, 2),
                               attribute("classification", "uint8", 1, 1), attribute("rgb", "uint16", 3, 2)]}
    put(os.path.join(folder, "metadata.json"), json.dumps(metadata).encode())
    put(os.path.join(folder, "hierarchy.bin"), hierarchy)
    put(os.path.join(folder, "octree.bin"), octree)


def write_ept(folder, nodes, n_points):
    def name(key):
        return "-".join(map(str, (key[0],) + key[1]))

    def page(root):
        found, queue = {}, [root]
        for key in queue:
            below = children(nodes, *key)
            if key != root and (key[0] - root[0]) % STEP == 0 and below:
                found[name(key)] = -1
                page(key)
                continue
            found[name(key)] = len(nodes[key])
            queue += below
        put(os.path.join(folder, "ept-hierarchy", name(root) + ".json"), json.dumps(found).encode())

    page((0, (0, 0, 0)))
    for key, points in nodes.items():
        put(os.path.join(folder, "ept-data", name(key) + ".bin"), b"".join(map(plain_record, points)))
    schema = [{"name": "XYZ"[k], "type": "signed", "size": 4, "scale": SCALE, "offset": CENTER[k]} for k in range(3)]
    schema += [{"name": "Intensity", "type": "unsigned", "size": 2},
               {"name": "Classification", "type": "unsigned", "size": 1}]
    schema += [{"name": color, "type": "unsigned", "size": 2} for color in ("Red", "Green", "Blue")]
    head = {"bounds": LOW + [v + EDGE for v in LOW], "dataType": "binary", "hierarchyType": "json", "points": n_points,
            "schema": schema, "span": GRID, "version": "1.0.0"}
    everything = [p for node in nodes.values() for p in node]
    head["boundsConforming"] = [CENTER[k] + f(p[0][k] for p in everything) * SCALE for f in (min, max) for k in range(3)]
    put(os.path.join(folder, "ept.json"), json.dumps(head).encode())


def write_las(path, points):
    head = bytearray(227)
    struct.pack_into("<4s", head, 0, b"LASF")
    struct.pack_into("<BB", head, 24, 1, 2)
    struct.pack_into("<HIIBHI", head, 94, 227, 227, 0, 2, 26, len(points))
    struct.pack_into("<6d", head, 131, SCALE, SCALE, SCALE, *CENTER)
    body = b"".join(struct.pack("<3iHBBbBH3H", *p[0], intensity(p), 9, 2, 0, 0, 0, *p[1]) for p in points)
    put(path, bytes(head) + body)


def make(folder, n=12000):
    nodes, points = {}, list(points_of(n))
    grow(points, 0, (0, 0, 0), nodes)
    write_las(os.path.join(folder, "plain.las"), points)
    write_potree(os.path.join(folder, "potree"), nodes, n, None)
    write_ept(os.path.join(folder, "ept"), nodes, n)
    try:
        import brotli
    except ImportError:
        return
    write_potree(os.path.join(folder, "brotli"), nodes, n, brotli.compress)


if __name__ == "__main__":
    make(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 12000)
