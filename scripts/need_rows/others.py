"""What others draw of the same at the same error: meshoptimizer, the levels of COPC and Potree, QSplat."""

import ctypes
import ctypes.util
import math
import os

from need_rows.surfaces import grid_of_points, grid_of_triangles, minus
from paper_rows.tools import Absent

PLACES = 1000


def spread(things, n=PLACES):
    return things[::max(1, len(things) // n)]


class Look:
    """A picture's camera, from its statistics."""

    def __init__(self, statistics):
        self.camera = camera = statistics["camera"]
        self.width, self.height = camera["width"], camera["height"]
        self.fx, self.fy, self.cx, self.cy = (camera[key] for key in ("fx", "fy", "cx", "cy"))
        self.rows = camera["world_to_camera"]

    def seen(self, p):
        return tuple(row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3] for row in self.rows[:3])

    def place(self, x, y, z):
        """Of a pixel's middle, at a depth."""
        q = minus(((x - self.cx) / self.fx * z, (y - self.cy) / self.fy * z, z), [row[3] for row in self.rows[:3]])
        return tuple(sum(self.rows[k][axis] * q[k] for k in range(3)) for axis in range(3))

    def pixels(self, p, length):
        """How many a length takes at a place, at most."""
        seen = self.seen(p)
        return length * self.fx * math.hypot(*seen) / (seen[2] * seen[2])

    def nearest(self, points):
        return min(self.seen(p)[2] for p in points)


def load_meshoptimizer():
    name = os.environ.get("MESHOPTIMIZER") or ctypes.util.find_library("meshoptimizer")
    if not name:
        raise Absent("meshoptimizer is not there: MESHOPTIMIZER names its library")
    library = ctypes.CDLL(name)
    library.meshopt_simplify.restype = ctypes.c_size_t
    library.meshopt_simplify.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,
                                         ctypes.c_size_t, ctypes.c_size_t, ctypes.c_size_t, ctypes.c_float,
                                         ctypes.c_uint, ctypes.c_void_p]
    library.meshopt_simplifyScale.restype = ctypes.c_float
    library.meshopt_simplifyScale.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_size_t]
    return library


def meshoptimizer(mesh, grid, look, error_px):
    """Triangles of the whole mesh, simplified until the error is reached where it is nearest; stated, measured px."""
    library, (points, faces) = load_meshoptimizer(), mesh
    positions = (ctypes.c_float * (3 * len(points)))(*(x for p in points for x in p))
    corners = (ctypes.c_uint * (3 * len(faces)))(*(i for face in faces for i in face))
    kept, reached = (ctypes.c_uint * len(corners))(), ctypes.c_float()
    length = error_px * look.nearest(points) / look.fx
    scale = library.meshopt_simplifyScale(positions, len(points), 12)
    n = library.meshopt_simplify(kept, corners, len(corners), positions, len(points), 12, 0, length / scale, 0,
                                 ctypes.byref(reached))
    simple = [tuple(kept[i:i + 3]) for i in range(0, n, 3)]
    near = grid_of_triangles(points, simple)
    middles = [tuple(sum(points[i][axis] for i in face) / 3.0 for axis in range(3)) for face in spread(simple)]
    most = max(max(look.pixels(p, grid.distance(p)) for p in middles),
               max(look.pixels(p, near.distance(p)) for p in spread(points)))
    return n // 3, reached.value * scale * error_px / length, most


def covering(points, drawn, look):
    """How far a point is from the nearest that is drawn, at most, in pixels."""
    near = grid_of_points(drawn)
    return max(look.pixels(p, near.distance(p)) for p in spread(points))


def cube_of(points):
    low = [min(p[k] for p in points) for k in range(3)]
    return low, max(max(p[k] for p in points) - low[k] for k in range(3)) * (1.0 + 1e-9) or 1.0


def levels_of(points):
    """As writers of COPC have it: a node keeps one point in each of its 128³ cells, and hands on the others."""
    low, side = cube_of(points)
    nodes, left, depth = [], points, 0
    while left:
        n, taken, rest = 128 << depth, set(), []
        for p in left:
            cell = tuple(int((p[k] - low[k]) / side * n) for k in range(3))
            if cell in taken and depth < 20:
                rest.append(p)
            else:
                taken.add(cell)
                nodes.append((depth, p))
        left, depth = rest, depth + 1
    return low, side, nodes


def levels(built, points, look, error_px):
    """Points of the nodes whose parents' spacing is seen under more than the error, and what they leave uncovered."""
    low, side, nodes = built
    wanted = {}

    def is_wanted(depth, cell):
        if depth == 0:
            return True
        key = depth, cell
        if key not in wanted:
            above, size = tuple(k >> 1 for k in cell), side / (1 << (depth - 1))
            corners = [tuple(low[k] + (above[k] + (i >> k & 1)) * size for k in range(3)) for i in range(8)]
            depth_px = max(1e-9, look.nearest(corners))
            wanted[key] = is_wanted(depth - 1, above) and size / 128 * look.fx / depth_px > error_px
        return wanted[key]

    drawn = [p for depth, p in nodes
             if is_wanted(depth, tuple(int((p[k] - low[k]) / side * (1 << depth)) for k in range(3)))]
    return len(drawn), covering(points, drawn, look)


def qsplat(discs, look, sizes, error_px):
    """Spheres in a tree that halves boxes, down to the first that is seen under no more than the error: how many, for
    pictures of each size."""
    counts, stack = dict.fromkeys(sizes, 0), [(discs, sizes)]
    while stack:
        some, left = stack.pop()
        columns = [[d[0][k] for d in some] for k in range(3)]
        low, high = list(map(min, columns)), list(map(max, columns))
        middle = tuple(0.5 * (low[k] + high[k]) for k in range(3))
        radius = math.dist(low, high) / 2.0
        if len(some) < 4096:
            radius = max(math.dist(d[0], middle) + max(math.hypot(*d[1]), math.hypot(*d[2])) for d in some)
        depth = look.seen(middle)[2] - radius
        seen = 2.0 * radius * look.fx / look.width / depth if depth > 0.0 else math.inf
        for size in left:
            counts[size] += len(some) == 1 or seen * size <= error_px
        left = [size for size in left if len(some) > 1 and seen * size > error_px]
        if not left:
            continue
        axis = max(range(3), key=lambda k: high[k] - low[k])
        halves = [[d for d in some if (d[0][axis] <= middle[axis]) == is_low] for is_low in (True, False)]
        if not halves[1]:
            halves = [some[:len(some) // 2], some[len(some) // 2:]]
        stack += [(half, left) for half in halves]
    return counts
