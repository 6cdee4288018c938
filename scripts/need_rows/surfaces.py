"""Surfaces in boxes of a grid, and how far places are from them: of triangles, of discs, of points."""

import array
import math
import struct


def minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def off_segment(p, a, b):
    way, from_a = minus(b, a), minus(p, a)
    along = dot(from_a, way) / (dot(way, way) or 1.0)
    along = min(max(along, 0.0), 1.0)
    return math.dist(from_a, (along * way[0], along * way[1], along * way[2]))


def off_triangle(p, a, b, c):
    u, v, w = minus(b, a), minus(c, a), minus(p, a)
    uu, uv, vv, wu, wv = dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v)
    area2 = uu * vv - uv * uv
    if area2 > 0.0:
        x, y = (vv * wu - uv * wv) / area2, (uu * wv - uv * wu) / area2
        if x >= 0.0 and y >= 0.0 and x + y <= 1.0:
            return math.dist(w, (x * u[0] + y * v[0], x * u[1] + y * v[1], x * u[2] + y * v[2]))
    return min(off_segment(p, a, b), off_segment(p, b, c), off_segment(p, c, a))


def off_disc(p, disc):
    """Nearly: the nearest place is sought towards the middle. A dot is a ball."""
    center, u, v, is_dot = disc
    d = minus(p, center)
    uu, vv = dot(u, u), dot(v, v)
    if is_dot:
        return max(0.0, math.hypot(*d) - 2.0 * math.sqrt(max(uu, vv)))  # it leans until it is twice as long
    x, y = dot(d, u) / (uu or 1.0), dot(d, v) / (vv or 1.0)
    out = max(1.0, math.hypot(x, y))
    x, y = x / out, y / out
    return math.dist(d, (x * u[0] + y * v[0], x * u[1] + y * v[1], x * u[2] + y * v[2]))


class Grid:
    """Things in the cells that their boxes meet. `off` gives how far a place is from a thing."""

    def __init__(self, boxes, off, n_cells):
        self.off = off
        low = [min(box[0][k] for box in boxes) for k in range(3)]
        high = [max(box[1][k] for box in boxes) for k in range(3)]
        self.low = low
        self.size = max(high[k] - low[k] for k in range(3)) / max(4.0, n_cells ** 0.5 / 2.0) or 1.0
        self.cells = {}
        for i, (begin, end) in enumerate(boxes):
            first, last = self.cell(begin), self.cell(end)
            for x in range(first[0], last[0] + 1):
                for y in range(first[1], last[1] + 1):
                    for z in range(first[2], last[2] + 1):
                        self.cells.setdefault((x, y, z), []).append(i)

    def cell(self, p):
        return tuple(math.floor((p[k] - self.low[k]) / self.size) for k in range(3))

    def distance(self, p):
        """To the nearest: shell by shell, until no farther shell can be nearer."""
        own, least, seen, shell = self.cell(p), math.inf, set(), 0
        while least > (shell - 1) * self.size and shell < 200:
            for x in range(-shell, shell + 1):
                for y in range(-shell, shell + 1):
                    is_side = abs(x) == shell or abs(y) == shell
                    for z in range(-shell, shell + 1) if is_side else (-shell, shell) if shell else (0,):
                        for i in self.cells.get((own[0] + x, own[1] + y, own[2] + z), ()):
                            if i not in seen:
                                seen.add(i)
                                least = min(least, self.off(p, i))
            shell += 1
        return least


def box_of(*points):
    return tuple(tuple(pick(p[k] for p in points) for k in range(3)) for pick in (min, max))


def grid_of_triangles(points, faces):
    boxes = [box_of(*(points[i] for i in face)) for face in faces]
    return Grid(boxes, lambda p, i: off_triangle(p, *(points[k] for k in faces[i])), len(faces))


def grid_of_discs(discs):
    boxes = []
    for center, u, v, _ in discs:
        reach = [math.sqrt(u[k] * u[k] + v[k] * v[k]) for k in range(3)]
        boxes.append((minus(center, reach), tuple(center[k] + reach[k] for k in range(3))))
    return Grid(boxes, lambda p, i: off_disc(p, discs[i]), len(discs))


def grid_of_points(points):
    return Grid([(p, p) for p in points], lambda p, i: math.dist(p, points[i]), len(points))


def read_obj(path):
    points, faces = [], []
    with open(path, encoding="utf-8") as source:
        for line in source:
            words = line.split()
            if words[:1] == ["v"]:
                points.append(tuple(map(float, words[1:4])))
            elif words[:1] == ["f"]:
                corners = [int(word.split("/")[0]) for word in words[1:]]
                corners = [i - 1 if i > 0 else len(points) + i for i in corners]
                faces += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    return points, faces


TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
         "int8": "b", "uint8": "B", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}


def triangles_of_strips(corners):
    """A strip begins anew after -1; every other triangle is the other way round."""
    faces, begin = [], 0
    for i, corner in enumerate(corners):
        if corner < 0:
            begin = i + 1
        elif i >= begin + 2:
            a, b = corners[i - 2:i]
            faces.append((a, b, corner) if (i - begin) % 2 == 0 else (b, a, corner))
    return faces


def read_ply(path):
    """The rows of a binary PLY's vertices, by names of columns, and its triangles."""
    with open(path, "rb") as source:
        head = [line.decode().split() for line in iter(source.readline, b"end_header\n")]
        body = source.read()
    elements = [[words[1], int(words[2]), []] for words in head if words[0] == "element"]
    i = -1
    for words in head:
        i += words[0] == "element"
        if words[0] == "property":
            elements[i][2].append(words[1:])
    order = ">" if ["format", "binary_big_endian", "1.0"] in head else "<"
    names, rows, faces, at = [], [], [], 0
    for name, n, columns in elements:
        if name == "vertex":
            numbers = [column for column in columns if column[0] != "list"]
            lists = columns[len(numbers):]  # behind the others, where there are any
            names = [column[-1] for column in numbers]
            row = struct.Struct(order + "".join(TYPES[column[0]] for column in numbers))
            for _ in range(n):
                rows.append(row.unpack_from(body, at))
                at += row.size
                for column in lists:
                    k = struct.unpack_from(order + TYPES[column[1]], body, at)[0]
                    at += struct.calcsize(TYPES[column[1]]) + k * struct.calcsize(TYPES[column[2]])
        elif name in ("face", "tristrips"):
            count, corner = struct.Struct(order + TYPES[columns[0][1]]), TYPES[columns[0][2]]
            for _ in range(n):
                k = count.unpack_from(body, at)[0]
                corners = struct.unpack_from(order + str(k) + corner, body, at + count.size)
                at += count.size + struct.calcsize(str(k) + corner)
                if name == "face":
                    faces += [(corners[0], corners[j], corners[j + 1]) for j in range(1, k - 1)]
                else:
                    faces += triangles_of_strips(corners)
    return names, rows, faces


def read_mesh(path):
    if path.endswith(".obj"):
        return read_obj(path)
    names, rows, faces = read_ply(path)
    x, y, z = (names.index(axis) for axis in "xyz")
    return [(row[x], row[y], row[z]) for row in rows], faces


def read_discs(path, cutoff=1.5):
    """The outlines of splats that conic prepare has made."""
    names, rows, _ = read_ply(path)
    at = [names.index(axis) for axis in ("x", "y", "z", "tu_x", "tu_y", "tu_z", "tv_x", "tv_y", "tv_z")]
    is_dot = names.index("dot") if "dot" in names else None
    discs = []
    for row in rows:
        n = [row[k] for k in at]
        if not all(map(math.isfinite, n)):
            continue
        discs.append((tuple(n[:3]), tuple(cutoff * x for x in n[3:6]), tuple(cutoff * x for x in n[6:]),
                      bool(is_dot is not None and row[is_dot])))
    return discs


def read_plane(path):
    """The numbers of a PFM of one plane, the highest row first, and its width."""
    with open(path, "rb") as source:
        source.readline()
        width, height = map(int, source.readline().split())
        scale = float(source.readline())
        numbers = array.array("f", source.read())
    if scale > 0.0:
        numbers.byteswap()
    flipped = array.array("f")
    for row in range(height - 1, -1, -1):
        flipped.extend(numbers[row * width:(row + 1) * width])
    return flipped, width
