"""Files of Gaussians, decoded from what their formats are said to be and compared with each other, for convert.sh.

decode_scenes.py write NPZ PLY: the scene of an archive as 3DGS would write it.
decode_scenes.py compare A B BOUNDS: two files hold the same scene in the frame of the first, within POSITION, LOG_SCALE,
ROTATION (a quaternion's chord), OPACITY, COLOR and HARMONICS; a bound of '-' is not looked at.
"""

import gzip
import json
import struct
import sys

import numpy as np

SH = 0.28209479177387814


def bits(value, shift, n):
    return ((value >> shift) & ((1 << n) - 1)) / ((1 << n) - 1.0)


def read_ply_parts(data):
    end = data.index(b"end_header\n") + 11
    types = {"float": "<f4", "uint": "<u4", "uchar": "u1", "double": "<f8"}
    elements = []
    for line in data[:end].decode().splitlines():
        words = line.split()
        if words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            elements[-1][2].append((words[2], types[words[1]]))
    parts = {}
    for name, count, fields in elements:
        parts[name] = np.frombuffer(data, np.dtype(fields), count, end)
        end += parts[name].nbytes
    return parts


def columns(part, names):
    return np.stack([part[name].astype(float) for name in names], 1)


def rest(part, scale=lambda x: x):
    n = sum(name.startswith("f_rest_") for name in part.dtype.names)
    if n == 0:
        return np.zeros((len(part), 0, 3))
    return scale(columns(part, [f"f_rest_{i}" for i in range(n)])).reshape(-1, 3, n // 3).transpose(0, 2, 1)


def smallest_three(dropped, others):
    q = np.zeros((len(dropped), 4))
    largest = np.sqrt(np.maximum(0, 1 - (others ** 2).sum(1)))
    for k in range(4):
        rows = dropped == k
        q[rows] = np.insert(others[rows], k, largest[rows], axis=1)
    return q


def read_ply(data):
    parts = read_ply_parts(data)
    v = parts["vertex"]
    if "chunk" not in parts:
        return (columns(v, "xyz"), columns(v, ["scale_0", "scale_1", "scale_2"]),
                columns(v, ["rot_0", "rot_1", "rot_2", "rot_3"]), 1 / (1 + np.exp(-v["opacity"].astype(float))),
                columns(v, ["f_dc_0", "f_dc_1", "f_dc_2"]), rest(v))
    chunk = parts["chunk"][np.arange(len(v)) // 256]

    def lerp(low, high, share):
        return columns(chunk, low) * (1 - share) + columns(chunk, high) * share

    def three(packed):
        return np.stack([bits(packed, 21, 11), bits(packed, 11, 10), bits(packed, 0, 11)], 1)

    p, r, s, c = (v["packed_" + name] for name in ("position", "rotation", "scale", "color"))
    color = lerp(["min_r", "min_g", "min_b"], ["max_r", "max_g", "max_b"],
                 np.stack([bits(c, shift, 8) for shift in (24, 16, 8)], 1))
    q = smallest_three(r >> 30, np.stack([(bits(r, shift, 10) - 0.5) * 2 ** 0.5 for shift in (20, 10, 0)], 1))
    sh = rest(parts["sh"], lambda x: (np.where(x == 0, 0, np.where(x == 255, 1, (x + 0.5) / 256)) - 0.5) * 8) \
        if "sh" in parts else np.zeros((len(v), 0, 3))
    return (lerp(["min_x", "min_y", "min_z"], ["max_x", "max_y", "max_z"], three(p)),
            lerp(["min_scale_x", "min_scale_y", "min_scale_z"], ["max_scale_x", "max_scale_y", "max_scale_z"], three(s)),
            q, bits(c, 0, 8), (color - 0.5) / SH, sh)


def read_splat(data):
    rows = np.frombuffer(data, np.dtype([("p", "<f4", 3), ("s", "<f4", 3), ("c", "u1", 4), ("q", "u1", 4)]))
    return (rows["p"].astype(float), np.log(rows["s"].astype(float)), (rows["q"].astype(float) - 128) / 128,
            rows["c"][:, 3] / 255.0, (rows["c"][:, :3] / 255.0 - 0.5) / SH, np.zeros((len(rows), 0, 3)))


def read_spz(data):
    """Version 3, turned from right, up, back to right, down, forward."""
    data = gzip.decompress(data)
    _, version, n, degree, fraction, _, _ = struct.unpack("<4sIIBBBB", data[:16])
    assert version == 3
    k = (degree + 1) ** 2 - 1
    p, a, c, s, r, h = np.split(np.frombuffer(data, "u1", offset=16), np.cumsum([9 * n, n, 3 * n, 3 * n, 4 * n]))
    p = p.reshape(n, 3, 3).astype(np.int32) @ np.array([1, 256, 65536], np.int32)
    p = np.where(p & 0x800000, p - (1 << 24), p) / 2.0 ** fraction
    r = r.view("<u4")
    parts = np.stack([((r >> shift) & 511) / 511.0 * np.where(r >> shift & 512, -1, 1) for shift in (20, 10, 0)], 1)
    q = smallest_three(r >> 30, parts * 0.5 ** 0.5)[:, [3, 0, 1, 2]]
    sh = (h.reshape(n, k, 3) - 128.0) / 128
    signs = [-1, -1, 1, -1, 1, 1, -1, 1, -1, 1, -1, -1, 1, -1, 1][:k]  # of y and z in each harmonic
    return (p * [1, -1, -1], s.reshape(n, 3) / 16.0 - 10, q * [1, 1, -1, -1], a / 255.0,
            (c.reshape(n, 3) / 255.0 - 0.5) / 0.15, sh * np.array(signs).reshape(-1, 1))


def read_glb(data):
    """Turned from left, up, forward to right, down, forward."""
    n_json = struct.unpack("<I", data[12:16])[0]
    scene = json.loads(data[20:20 + n_json])
    attributes = scene["meshes"][0]["primitives"][0]["attributes"]

    def read(name):
        accessor = scene["accessors"][attributes[name]]
        view = scene["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        return np.frombuffer(data, "<f4", accessor["count"] * width, 28 + n_json + view["byteOffset"]).reshape(-1, width)

    prefix = "KHR_gaussian_splatting:"
    sh = [read(f"{prefix}SH_DEGREE_{d}_COEF_{i}") for d in range(4) for i in range(2 * d + 1)
          if f"{prefix}SH_DEGREE_{d}_COEF_{i}" in attributes]
    signs = [-1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1][:len(sh) - 1]
    return (read("POSITION") * [-1.0, -1, 1], np.log(read(prefix + "SCALE").astype(float)),
            read(prefix + "ROTATION")[:, [3, 0, 1, 2]] * [1.0, -1, -1, 1], read(prefix + "OPACITY")[:, 0], sh[0],
            np.stack(sh[1:], 1) * np.array(signs).reshape(-1, 1) if len(sh) > 1 else np.zeros((len(sh[0]), 0, 3)))


def read_scene(path):
    data = open(path, "rb").read()
    for ending, read in ((".ply", read_ply), (".splat", read_splat), (".spz", read_spz), (".glb", read_glb)):
        if path.endswith(ending):
            return read(data)
    raise ValueError(path)


def compare(first, second, bounds):
    a, b = read_scene(first), read_scene(second)
    qa, qb = (s[2] / np.linalg.norm(s[2], axis=1, keepdims=True) for s in (a, b))
    chord = np.minimum(np.abs(qa - qb).max(1), np.abs(qa + qb).max(1)).max()
    found = [np.abs(x - y).max() if x.size and x.shape == y.shape else 0 for x, y in zip(a, b)]
    found[2] = chord
    names = ("position", "log_scale", "rotation", "opacity", "color", "harmonics")
    wrong = [f"{name} {value:.3g} > {bound}" for name, value, bound in zip(names, found, bounds)
             if bound != "-" and not value <= float(bound)]
    if wrong:
        print(f"{first} and {second}: {', '.join(wrong)}")
    return 1 if wrong else 0


def write(archive, path):
    d = np.load(archive)
    n, k = d["sh"].shape[:2]
    o = d["opac"].astype(float)
    names = "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2".split() + [f"f_rest_{i}" for i in range(3 * k - 3)]
    names += "opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split()
    values = np.concatenate([d["means"], np.zeros((n, 3)), d["sh"][:, 0],
                             d["sh"][:, 1:].transpose(0, 2, 1).reshape(n, -1), np.log(o / (1 - o))[:, None],
                             np.log(d["scales"].astype(float)), d["quats"]], 1).astype("<f4")
    header = "".join(f"property float {name}\n" for name in names)
    with open(path, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {n}\n{header}end_header\n".encode())
        file.write(values.tobytes())
    return 0


if sys.argv[1] == "write":
    sys.exit(write(*sys.argv[2:]))
sys.exit(compare(sys.argv[2], sys.argv[3], sys.argv[4:]))
