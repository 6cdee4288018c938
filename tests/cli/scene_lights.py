"""Makes a floor and 12 photographs' cameras around it, and compares what they see at 20 places."""
import array
import json
import math
import os
import re
import sys

N_VIEWS, SIZE, FOCAL = 12, 120, 150.0
PLACES = [(0.9 * math.cos(i), 0.0, 0.9 * math.sin(2.3 * i)) for i in range(20)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def view(i):
    """The rows right, down and forward, and the eye: all around, above, and rolled."""
    eye = [4 * math.cos(0.7 * i), 3 + math.sin(i), 4 * math.sin(0.7 * i)]
    forward = unit([-x for x in eye])
    flat = unit(cross(forward, [0, 1, 0]))
    upright = cross(forward, flat)
    c, s = math.cos(1.1 * i), math.sin(1.1 * i)
    right = [c * a + s * b for a, b in zip(flat, upright)]
    return [right, cross(forward, right), forward], eye


def make(folder):
    with open(os.path.join(folder, "floor.ply"), "w") as out:
        out.write("ply\nformat ascii 1.0\nelement vertex 6561\n")
        for name in ("x", "y", "z", "nx", "ny", "nz", "radius"):
            out.write(f"property float {name}\n")
        out.write("end_header\n")
        for i in range(81):
            for j in range(81):
                out.write(f"{0.05 * (i - 40)} 0 {0.05 * (j - 40)} 0 1 0 0.06\n")
    frames = []
    for i in range(N_VIEWS):
        rows, eye = view(i)
        frames.append({"file_path": f"{i:02}.png", "transform_matrix": [
            [rows[0][k], -rows[1][k], -rows[2][k], eye[k]] for k in range(3)] + [[0, 0, 0, 1]]})
    with open(os.path.join(folder, "transforms.json"), "w") as out:
        json.dump({"w": SIZE, "h": SIZE, "fl_x": FOCAL, "fl_y": FOCAL, "cx": SIZE / 2, "cy": SIZE / 2,
                   "frames": frames}, out)


def read_red(path):
    data = open(path, "rb").read()
    head = re.match(rb"PF\n(\d+) (\d+)\n-[\d.]+\n", data)
    values = array.array("f", data[head.end():])

    def between(x, y):
        """At a place between four pixels' centres."""
        i, j = int(x - 0.5), int(y - 0.5)
        s, t = x - 0.5 - i, y - 0.5 - j
        of = [values[3 * ((SIZE - 1 - j - k // 2) * SIZE + i + k % 2)] for k in range(4)]
        return (1 - t) * ((1 - s) * of[0] + s * of[1]) + t * ((1 - s) * of[2] + s * of[3])

    return between


def compare(folder):
    """Prints the greatest ratio between what two views see at one place, and how much places differ."""
    seen = [[] for _ in PLACES]
    for i in range(N_VIEWS):
        rows, eye = view(i)
        red = read_red(os.path.join(folder, f"{i:02}.pfm"))
        for place, values in zip(PLACES, seen):
            x, y, z = (sum(r * (p - e) for r, p, e in zip(row, place, eye)) for row in rows)
            values.append(red(FOCAL * x / z + SIZE / 2, FOCAL * y / z + SIZE / 2))
    ratio = max(max(values) / max(min(values), 1e-9) for values in seen)
    print(f"{ratio:.4f} {max(map(max, seen)) / min(map(min, seen)):.4f}")


if sys.argv[1] == "make":
    make(sys.argv[2])
else:
    compare(sys.argv[2])
