"""Reads .lpc files by docs/reference/format-lpc.md alone, and finds in them every sample that they were made of, once."""

import ctypes
import ctypes.util
import struct
import subprocess
import sys

import numpy as np

FOLDED = {3: 1, 4: 2, 5: 2, 6: 1}  # bytes of the numbers of sizes, axes, opacities and dots
VALUES = ["u1", "i1", "<u2", "<i2", "<u4", "<i4", "<f4", "<f8"]


def fail(what):
    sys.exit("FAILED: " + what)


class Zstd:
    def __init__(self):
        name = ctypes.util.find_library("zstd")
        if not name:
            print("skipped: no libzstd")
            sys.exit(77)
        self.library = ctypes.CDLL(name)
        self.library.ZSTD_decompress.restype = ctypes.c_size_t
        self.library.ZSTD_decompress.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t]

    def unpack(self, frame, room):
        out = ctypes.create_string_buffer(room + 1)
        n = self.library.ZSTD_decompress(out, room + 1, frame, len(frame))
        if n > room:
            fail("a frame is longer than its stream")
        return out.raw[:n]


def join_keys(classes, bits, first):
    whole, at, key, keys = int.from_bytes(bits, "little"), 0, first, []
    for c in classes:
        if c:
            key += 1 << (c - 1) | (whole >> at) & ((1 << (c - 1)) - 1)
            at += c - 1
        keys.append(key)
    if (at + 7) // 8 != len(bits):
        fail("bits are left")
    return keys


def unfold(streams, w):
    z = sum(np.frombuffer(s, "u1").astype(object) << 8 * k for k, s in enumerate(streams))
    d = np.array([x // 2 if x % 2 == 0 else -(x + 1) // 2 for x in z], object)
    return np.array(np.cumsum(d) % (1 << 8 * w), dtype=np.uint64)


def normals_of(x, y, half):
    x, y = x.astype("f8") / half - 1, y.astype("f8") / half - 1
    z = 1 - abs(x) - abs(y)
    fx, fy = (1 - abs(y)) * np.where(x < 0, -1, 1), (1 - abs(x)) * np.where(y < 0, -1, 1)
    n = np.stack([np.where(z < 0, fx, x), np.where(z < 0, fy, y), z], 1)
    return n / np.linalg.norm(n, axis=1)[:, None]


def directions(code, bits):
    t = code.astype("f8") * 4 / 2**bits
    y = np.where(t <= 1, t, np.where(t <= 3, 2 - t, t - 4))
    x = np.where((t <= 1) | (t >= 3), 1 - abs(y), abs(y) - 1)
    return np.stack([x, y], 1) / np.hypot(x, y)[:, None]


def float_of_bits(bits):
    return bits.astype("<u4").view("<f4").astype("f8")


def axes_of(codes, attribute):
    length = [float_of_bits((codes[k].astype("i8") + int(attribute["offset"])) << 11) for k in range(2)]
    n = normals_of(codes[2], codes[3], 32767)
    s = np.where(n[:, 2] >= 0, 1.0, -1.0)
    k = -1 / (s + n[:, 2])
    a = np.stack([1 + s * n[:, 0] ** 2 * k, s * n[:, 0] * n[:, 1] * k, -s * n[:, 0]], 1)
    b = np.stack([n[:, 0] * n[:, 1] * k, s + n[:, 1] ** 2 * k, -n[:, 1]], 1)
    turn = directions(codes[4], 16)
    u = turn[:, :1] * a + turn[:, 1:] * b
    return u * length[0][:, None], np.cross(n, u) * length[1][:, None]


def decode_attribute(attribute, streams, n):
    kind = attribute["kind"]
    arrays = [np.frombuffer(s, "u1") for s in streams]
    if kind == 1:
        codes = [np.cumsum(a, dtype="u8") % 256 for a in arrays]
        return {"normal": normals_of(codes[0], codes[1], 127)}
    if kind == 2:
        green = np.cumsum(arrays[0], dtype="u8")
        red, blue = [(np.cumsum(a, dtype="u8") + green) % 256 for a in arrays[1:]]
        return {"color": np.stack([red, green % 256, blue], 1)}
    if kind == 3:
        shift = 23 - attribute["type"]
        return {"size": float_of_bits((unfold(streams, 1).astype("i8") + int(attribute["offset"])) << shift)}
    if kind == 4:
        u, v = axes_of([unfold(streams[2 * k : 2 * k + 2], 2) for k in range(5)], attribute)
        return {"u": u, "v": v}
    if kind == 5:
        return {"opacity": unfold(streams, 2) / 65535.0}
    if kind == 6:
        return {"dot": unfold(streams, 1)}
    if kind == 7:
        count = np.where(arrays[0] < 2, arrays[0], 2)
        turns = directions(unfold(streams[1:4], 3), 24) if count.sum() else np.zeros((0, 2))
        offsets = 16.0 * unfold(streams[4:7], 3) / (2**24 - 1) - 8 if count.sum() else np.zeros(0)
        if len(turns) != count.sum():
            fail("clip lines are not as many as they should be")
        first = np.concatenate([[0], np.cumsum(count)[:-1]]).astype("i8")
        lines = [(arrays[0][i], turns[first[i] : first[i] + count[i]], offsets[first[i] : first[i] + count[i]])
                 for i in range(n)]
        return {"lines": lines}
    w = len(streams)
    bits = unfold(streams, w)
    if attribute["type"] >= 6:
        sign = np.uint64(1 << (8 * w - 1))
        mask = np.uint64((1 << 8 * w) - 1)
        bits = np.where(bits & sign, bits ^ sign, ~bits & mask)
    values = bits.astype("<u%d" % w).view(VALUES[attribute["type"]])
    return {attribute["name"]: values * attribute["scale"] + attribute["offset"]}


def read_stand_ins(data, at, entry, table, zstd, node):
    """Those of an entry, whose bytes begin at `at`: within its place, and no larger than it says. Returns their end."""
    size, = struct.unpack_from("<I", data, entry + 112)
    error, most = struct.unpack_from("<2f", data, entry + 116)
    n, cone = struct.unpack_from("<2H", data, entry + 124)
    quantum, = struct.unpack_from("<d", data, 64)
    bits = struct.unpack("<I", struct.pack("<f", quantum))[0]
    kept = [{"kind": 0, "streams": 2}, {"kind": 1, "streams": 2}, {"kind": 2, "streams": 3},
            {"kind": 3, "streams": 1, "type": 3, "offset": max((bits >> 20) - 64, 0)}, {"kind": 6, "streams": 1}]
    have = {a["kind"] for a in table} | {1, 3}
    kept = [a for a in kept if a["kind"] in have]
    if 5 in have:
        if size or n:
            fail("samples with opacities have stand-ins")
        return at
    sizes = struct.unpack_from("<%dI" % sum(a["streams"] for a in kept), data, at)
    here, k = at + 4 * len(sizes), 0
    for attribute in kept:
        streams = []
        for packed in sizes[k : k + attribute["streams"]]:
            piece = data[here : here + (packed & 0x7FFFFFFF)]
            streams.append(zstd.unpack(piece, 8 * n + 16) if packed >> 31 else piece)
            here += len(piece)
        k += attribute["streams"]
        if attribute["kind"] == 0:
            keys = join_keys(streams[0], streams[1], node["first"])
            if len(keys) != n or sorted(keys) != keys or not (n and keys[-1] <= node["last"]):
                fail("stand-ins lie outside of their place")
        else:
            values = decode_attribute(dict({"name": "size"}, **attribute), streams, n)
            if attribute["kind"] == 3 and not np.max(list(values.values())[0]) <= most:
                fail("a stand-in is larger than the greatest")
    if here != at + size or not (0 < n <= node["drawn"] and error > 0 and cone <= 65534):
        fail("stand-ins are not as their entry says")
    return here


def read(path, zstd):
    data = open(path, "rb").read()
    if data[:8] != b"CONICLP\n" or struct.unpack_from("<I", data, 8)[0] != 3:
        fail("no .lpc of version 3")
    n_samples, n_clouds, levels, bits = struct.unpack_from("<QIII", data, 16)
    origin = np.array(struct.unpack_from("<3d", data, 40))
    quantum, = struct.unpack_from("<d", data, 64)
    n_attributes, = struct.unpack_from("<I", data, 192)
    table, at = [], 256
    for _ in range(n_attributes):
        kind, streams, type_, flags = struct.unpack_from("<4H", data, at + 40)
        scale, offset, low, high, p2, p98, error = struct.unpack_from("<7d", data, at + 48)
        table.append({"name": data[at : at + 40].split(b"\0")[0].decode(), "kind": kind, "streams": streams,
                      "type": type_, "scale": scale, "offset": offset, "low": low, "high": high, "error": error,
                      "bytes": struct.unpack_from("<Q", data, at + 104)[0]})
        at += 112
    sums, parts, total, nodes = [0] * n_attributes, {}, 0, []
    standing = at + 128 * n_clouds
    for c in range(n_clouds):
        entry = at + 128 * c
        key, offset, _, n_place = struct.unpack_from("<4Q", data, entry)
        n_bytes, n = struct.unpack_from("<2I", data, entry + 32)
        parent, child, n_drawn = struct.unpack_from("<3I", data, entry + 40)
        depth, = struct.unpack_from("<H", data, entry + 54)
        spacing, covering, most, error = struct.unpack_from("<4f", data, entry + 56)
        growth, reach = (0, covering) if child else (1, 0)
        nodes.append({"first": key, "last": key + (1 << (3 * bits - depth)) - 1, "parent": parent, "child": child,
                      "samples": n_place, "drawn": n_drawn, "spacing": spacing, "covering": covering, "most": most,
                      "growth": growth, "reach": reach, "error": error})
        standing = read_stand_ins(data, standing, entry, table, zstd, nodes[-1])
        n_streams = sum(a["streams"] for a in table)
        sizes = struct.unpack_from("<%dI" % n_streams, data, offset)
        here, k, cloud = offset + 4 * n_streams, 0, {}
        for i, attribute in enumerate(table):
            streams = []
            for size in sizes[k : k + attribute["streams"]]:
                piece = data[here : here + (size & 0x7FFFFFFF)]
                streams.append(zstd.unpack(piece, 8 * n + 16) if size >> 31 else piece)
                here += len(piece)
                sums[i] += len(piece) + 4
            k += attribute["streams"]
            if i == 0:
                keys = join_keys(streams[0], streams[1], key)
                steps = [[sum((q >> (3 * b + 2 - a) & 1) << b for b in range(bits)) for a in range(3)] for q in keys]
                cloud["position"] = origin + (np.array(steps, "f8").reshape(-1, 3) + 0.5) * quantum
            else:
                cloud.update(decode_attribute(attribute, streams, n))
        if here != offset + n_bytes or len(keys) != n or sorted(keys) != keys:
            fail("a cloud is not as long as it says")
        total += n
        cloud["key"], cloud["cloud"] = keys, [c] * n
        for name, values in cloud.items():
            parts.setdefault(name, []).extend(values)
    if total != n_samples or sums != [a["bytes"] for a in table]:
        fail("samples or bytes are not as many as the header says")
    samples = {name: values if name == "lines" else np.array(values) for name, values in parts.items()}
    return {"quantum": quantum, "table": {a["name"]: a for a in table}, "samples": samples, "nodes": nodes}


def check_nodes(file, outline):
    """What the index says of each node, held against all samples of its place by brute force."""
    s, nodes = file["samples"], file["nodes"]
    keys = np.array([int(q) for q in s["key"]], object)
    for i, node in enumerate(nodes):
        above, k = set(), i
        while k not in above:
            above.add(k)
            k = nodes[k]["parent"]
        place = (keys >= node["first"]) & (keys <= node["last"])
        drawn = place & np.isin(s["cloud"], list(above))
        if place.sum() != node["samples"] or drawn.sum() != node["drawn"]:
            fail("node %d holds or draws another number of samples" % i)
        p, t, own = s["position"][place], s["position"][drawn], outline[drawn]
        away = np.linalg.norm(p[:, None] - t[None], axis=2).min(1).max()
        slack = 1e-3 * node["covering"] + 1e-4 * node["spacing"]
        if not away <= node["covering"] <= away + slack:
            fail("node %d: covering radius %g, by brute force %g" % (i, node["covering"], away))
        outlines = np.minimum(np.maximum(own, node["reach"] + node["growth"] * own), node["most"])
        wanted = np.maximum(own, away) if node["child"] else own
        expect("node %d: outlines" % i, outlines, wanted, slack)
        if node["child"] and not np.max(outlines - own) <= node["error"]:
            fail("node %d: an outline reaches farther out than the error" % i)
        if node["child"] and len(t) > 1:  # chosen samples keep apart: a Poisson disc set
            between = np.linalg.norm(t[:, None] - t[None], axis=2) + 1e9 * np.eye(len(t))
            if not 0.5 * node["spacing"] < between.min():
                fail("node %d: two samples are %g apart, the spacing is %g" % (i, between.min(), node["spacing"]))


def write_ply(path, n):
    """Discs about a sphere, all different, with everything that a splat can have and two values; `number` names it."""
    r = np.random.default_rng(7)
    p = r.normal(size=(n, 3))
    p /= np.linalg.norm(p, axis=1)[:, None]
    other = np.cross(p, np.roll(p, 1, axis=1))
    u = other / np.linalg.norm(other, axis=1)[:, None]
    v = np.cross(p, u)
    a = {"p": p.astype("f4"), "u": (u * r.uniform(0.02, 0.2, (n, 1))).astype("f4"),
         "v": (v * r.uniform(0.02, 0.2, (n, 1))).astype("f4"), "color": r.integers(0, 256, (n, 3)),
         "opacity": r.integers(0, 65536, n) / 65535.0, "dot": r.integers(0, 2, n), "number": np.arange(n),
         "time": 3e8 + r.uniform(0, 1, n), "depth": r.normal(size=n).astype("f4"),
         "lines": [[r.normal(size=2).tolist() + [r.uniform(-2, 2)] for _ in range(i % 3)] for i in range(n)]}
    names = ["x", "y", "z"] + ["t%s_%s" % (t, c) for t in "uv" for c in "xyz"]
    head = ["ply", "format binary_little_endian 1.0", "element vertex %d" % n] + ["property float " + s for s in names]
    head += ["property uchar " + s for s in ("red", "green", "blue")] + ["property float opacity", "property uchar dot"]
    head += ["property ushort number", "property double time", "property float depth"]
    head += ["property list uchar float clip_and", "end_header", ""]
    with open(path, "wb") as out:
        out.write("\n".join(head).encode())
        for i in range(n):
            out.write(struct.pack("<9f3BfBHdf", *a["p"][i], *a["u"][i], *a["v"][i], *a["color"][i].tolist(),
                                  a["opacity"][i], a["dot"][i], i, a["time"][i], a["depth"][i]))
            flat = [x for line in a["lines"][i] for x in line]
            out.write(struct.pack("<B%df" % len(flat), len(flat), *flat))
    return a


def share_left(lines, cutoff):
    """Of each disc, the share that lines which must all keep a place leave."""
    x, y = np.meshgrid(np.linspace(-cutoff, cutoff, 41), np.linspace(-cutoff, cutoff, 41))
    disc = x * x + y * y <= cutoff * cutoff
    kept = [np.all([a * x + b * y + c >= 0 for a, b, c in some] + [disc], 0).sum() for some in lines]
    return np.array(kept) / disc.sum()


def expect(what, found, wanted, most):
    worst = np.abs(np.asarray(found, "f8") - np.asarray(wanted, "f8")).max()
    if not worst <= most:
        fail("%s: off by %g, more than %g" % (what, worst, most))


def main():
    conic, work = sys.argv[1:]
    zstd = Zstd()
    made = write_ply(work + "/in.ply", 700)
    for payload in ("plain", "full"):
        subprocess.run([conic, "layer", work + "/in.ply", "-o", work + "/out.lpc", "--cloud-size", "64", "--payload",
                        payload, "--keep", "number,time,depth", "--quiet"], check=True)
        file = read(work + "/out.lpc", zstd)
        s = file["samples"]
        if sorted(s["number"].astype(int).tolist()) != list(range(700)):
            fail(payload + ": a sample is not there once")
        i = s["number"].astype(int)
        expect(payload + " position", s["position"], made["p"][i], file["quantum"] * 0.5 + 1e-6)
        expect(payload + " colour", s["color"], made["color"][i], 0)
        expect(payload + " time", s["time"], made["time"][i], 0)
        expect(payload + " depth", s["depth"], made["depth"][i], 0)
        expect(payload + " dot", s["dot"], made["dot"][i], 0)
        lengths = [np.linalg.norm(made[c], axis=1)[i] for c in "uv"]
        if payload == "plain":
            longer = np.maximum(*lengths)
            shorter = np.where(made["dot"][i], longer, np.minimum(*lengths))
            drawn = longer * shorter * share_left(made["lines"], 1.5)[i]
            outline = 1.5 * (2 * longer + np.sqrt(drawn)) / 3
            expect("size", s["size"] / outline, 1, file["table"]["size"]["error"] + 0.04)
            check_nodes(file, s["size"])
            continue
        for k, c in enumerate("uv"):
            expect("axis", (s[c] - made[c][i]) / lengths[k][:, None], 0, 2e-4)
        expect("opacity", s["opacity"], made["opacity"][i], 1e-5)
        for k, (kind, directions_, offsets) in zip(i, s["lines"]):
            lines = np.array(made["lines"][k]).reshape(-1, 3)
            if kind != len(lines):
                fail("clip lines are not as many")
            norm = np.hypot(lines[:, 0], lines[:, 1])[:, None]
            if len(lines):
                expect("clip line", directions_, lines[:, :2] / norm, 1e-5)
                expect("clip offset", offsets, np.clip(lines[:, 2] / norm[:, 0], -8, 8), 1e-5)


main()
