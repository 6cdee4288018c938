"""3DGUT's cameras by numpy, in double: what `3dgut-2025` is to show through lenses, fisheyes and rolling shutters.

gut_cameras.py CONIC: makes scenes and cameras here, and holds conic's means, radii and pictures against its own.
"""

import json
import subprocess
import sys

import numpy as np

WIDTH, HEIGHT, TILE = 96, 64, 8
SPREAD = 0.1 * 0.1 * 3.0


def scene(path, count, seed, largest):
    r = np.random.default_rng(seed)
    names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2"]
    names += ["rot_0", "rot_1", "rot_2", "rot_3"]
    place = r.uniform(-1, 1, (count, 3)) * [3, 2, 3]
    size = np.log(r.uniform(0.02, largest, (count, 3)))
    rows = np.concatenate([place, r.normal(size=(count, 3)), r.uniform(-3, 4, (count, 1)), size,
                           r.normal(size=(count, 4))], 1).astype("<f4")
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n"
    head += "".join(f"property float {name}\n" for name in names) + "end_header\n"
    with open(path, "wb") as file:
        file.write(head.encode() + rows.tobytes())
    rows = rows.astype(float)
    turn = rows[:, 10:] / np.linalg.norm(rows[:, 10:], axis=1, keepdims=True)
    scales = np.exp(rows[:, 7:10]).astype(np.float32).astype(float)
    opacity = (1 / (1 + np.exp(-rows[:, 6]))).astype(np.float32).astype(float)
    color = np.maximum(0.5 + 0.28209479177387814 * rows[:, 3:6], 0)
    return rows[:, :3], rotation(turn), scales, opacity, color


def rotation(q):
    w, x, y, z = np.moveaxis(np.asarray(q), -1, 0)
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def camera(name, **more):
    made = {"width": WIDTH, "height": HEIGHT, "fx": 42.0, "fy": 43.0, "cx": 47.25, "cy": 33.5,
            "world_to_camera": [[1, 0, 0, 0.1], [0, 1, 0, -0.05], [0, 0, 1, 3.5], [0, 0, 0, 1]], **more}
    with open(name + ".json", "w") as file:
        json.dump(made, file)
    return made


class Lens:
    """What a camera makes of places in its space, and which directions its pixels see."""

    def __init__(self, c):
        d = list(c.get("distortion", [])) + [0.0] * 8
        self.c, self.is_fisheye = c, c.get("kind") == "fisheye"
        self.k, self.p = np.array(d[:4] + [0, 0]), np.zeros(2)
        if c.get("lens") == "opencv":
            self.k, self.p = np.array([d[0], d[1], d[4], d[5], d[6], d[7]]), np.array(d[2:4])
        self.focal, self.center = np.array([c["fx"], c["fy"]]), np.array([c["cx"], c["cy"]])
        if self.is_fisheye:
            across = max(c["cx"], WIDTH - c["cx"]), max(c["cy"], HEIGHT - c["cy"])
            self.most = min(np.hypot(*across) / min(self.focal), self.fold())
            self.guess = self.most / max(0.5 * WIDTH / c["fx"], 0.5 * HEIGHT / c["fy"])

    def radius(self, a):
        k, s = self.k, a * a
        return a * (1 + s * (k[0] + s * (k[1] + s * (k[2] + s * k[3]))))

    def slope(self, a):
        k, s = self.k, a * a
        return 1 + s * (3 * k[0] + s * (5 * k[1] + s * (7 * k[2] + s * 9 * k[3])))

    def fold(self):
        k, a = self.k, 1.57
        if k[3] == 0:
            roots = np.roots([7 * k[2], 5 * k[1], 3 * k[0], 1])
            real = [r.real for r in roots if abs(r.imag) < 1e-9 and r.real > 0]
            return np.sqrt(min(real)) if real else np.inf
        for _ in range(20):
            s = a * a
            step = self.slope(a) / (a * (6 * k[0] + s * (20 * k[1] + s * (42 * k[2] + s * 72 * k[3]))))
            a -= step
            if abs(step) < 1e-6:
                return a if a > 0 else np.inf
        return np.inf

    def bend(self, a):
        k, p = self.k, self.p
        s = (a * a).sum(-1)
        bottom = 1 + s * (k[3] + s * (k[4] + s * k[5]))
        growth = (1 + s * (k[0] + s * (k[1] + s * k[2]))) / bottom
        x, y = a[..., 0], a[..., 1]
        added = np.stack([2 * p[0] * x * y + p[1] * (s + 2 * x * x), p[0] * (s + 2 * y * y) + 2 * p[1] * x * y], -1)
        return growth, growth[..., None] * a + added

    def show(self, at):
        """Places on the screen, and whether they are seen; behind the eye they are at 0, 0."""
        with np.errstate(all="ignore"):
            if self.is_fisheye:
                across = np.hypot(at[..., 0], at[..., 1])
                angle = np.arctan2(across, at[..., 2])
                normal = (self.radius(np.minimum(angle, self.most)) / across)[..., None] * at[..., :2]
                seen = angle < self.most
            else:
                growth, normal = self.bend(at[..., :2] / at[..., 2:])
                seen = growth > 0.8
        before = at[..., 2] > 0
        place = np.where(before[..., None], self.focal * normal + self.center, 0.0)
        margin = 0.1 * np.array([WIDTH, HEIGHT])
        seen = seen & (place >= -margin).all(-1) & (place < [WIDTH, HEIGHT] + margin).all(-1)
        return place, seen & before

    def rays(self, pixels):
        wanted = (pixels - self.center) / self.focal
        if self.is_fisheye:
            radius = np.hypot(wanted[:, 0], wanted[:, 1])
            angle, done = self.guess * radius, np.zeros(len(radius), bool)
            for _ in range(20):
                step = np.where(done, 0, (self.radius(angle) - radius) / self.slope(angle))
                angle, done = angle - step, done | (abs(step) < 1e-6)
            part = np.sin(angle) / np.maximum(radius, 1e-300)
            direction = np.stack([part * wanted[:, 0], part * wanted[:, 1], np.cos(angle)], -1)
            return direction, done & (angle >= 0) & (angle < self.most)
        at, done, lost = wanted.copy(), np.zeros(len(wanted), bool), np.zeros(len(wanted), bool)
        for _ in range(5):  # the derivatives by differences, which are good to 1e-9
            growth, now = self.bend(at)
            h = 1e-5
            by = [(self.bend(at + d)[1] - self.bend(at - d)[1]) / (2 * h) for d in (np.array([h, 0]), np.array([0, h]))]
            area = by[0][:, 0] * by[1][:, 1] - by[0][:, 1] * by[1][:, 0]
            lost |= ~done & ((growth <= 0) | (abs(area) < 1e-6))
            out = now - wanted
            step = np.stack([by[1][:, 1] * out[:, 0] - by[1][:, 0] * out[:, 1],
                             by[0][:, 0] * out[:, 1] - by[0][:, 1] * out[:, 0]], -1) / area[:, None]
            at = np.where((done | lost)[:, None], at, at - step)
            done |= ~lost & (abs(step) < 1e-6).all(1)
        return np.concatenate([at, np.ones((len(at), 1))], 1), done


def pose_at(c, time):
    """World to camera, at shares of the exposure from its begin to its end: quaternions by slerp."""
    begin = np.array(c["world_to_camera"], float)[:3]
    time = np.asarray(time, float)
    if "shutter" not in c:
        return np.broadcast_to(begin, time.shape + (3, 4))
    end = np.array(c["world_to_camera_end"], float)[:3]
    p, q = c["turns"]
    q = q if p @ q > 0 else -q
    whole = np.arccos(min(p @ q, 1.0))
    a = time[..., None]
    turn = (np.sin((1 - a) * whole) * p + np.sin(a * whole) * q) / np.sin(whole)
    return np.concatenate([rotation(turn), ((1 - a) * begin[:, 3] + a * end[:, 3])[..., None]], -1)


def time_at(c, place):
    way = c.get("shutter")
    n, at = (WIDTH, place[..., 0]) if way in ("left-to-right", "right-to-left") else (HEIGHT, place[..., 1])
    if way in ("top-to-bottom", "left-to-right"):
        return np.floor(at) / (n - 1)
    return (n - np.ceil(at)) / (n - 1) if way else np.zeros(place.shape[:-1])


def show_world(c, lens, world):
    def show(time):
        pose = pose_at(c, time)
        return lens.show(np.einsum("...ij,...j->...i", pose[..., :3], world) + pose[..., 3])

    place, seen = show(np.zeros(world.shape[:-1]))
    if "shutter" not in c:
        return place, seen
    last, seen_last = show(np.ones(world.shape[:-1]))
    place = np.where(seen[..., None], place, last)
    valid = seen | seen_last
    for _ in range(10):
        now, seen = show(time_at(c, place))
        place = np.where(valid[..., None], now, place)
    return place, valid & seen


def rolling(name, way, turn=(0.03, -0.05, 0.02), shift=(0.25, -0.1, 0.3), **more):
    p, q = np.array([1.0, 0.05, -0.02, 0.04]), None
    p /= np.linalg.norm(p)
    q = p + np.concatenate([[0.0], turn])
    q /= np.linalg.norm(q)
    poses = []
    for turned, moved in ((p, np.zeros(3)), (q, np.array(shift))):
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = rotation(turned), np.array([0.1, -0.05, 3.5]) + moved
        poses.append(pose.tolist())
    made = camera(name, world_to_camera=poses[0], shutter=way, world_to_camera_end=poses[1], **more)
    return {**made, "turns": (p, q)}


def project(c, lens, means, turns, scales, opacity):
    """Means and radii on the screen, depths, and who is left out."""
    steps = np.sqrt(SPREAD) * np.moveaxis(turns * scales[:, None, :], 1, 2)
    points = np.concatenate([means[:, None], means[:, None] + steps, means[:, None] - steps], 1)
    place, seen = show_world(c, lens, points)
    weights = np.array([1 - 3 / SPREAD] + [0.5 / SPREAD] * 6)
    middle = np.einsum("k,nka->na", weights, place)
    weights[0] += 1 - 0.01 + 2
    apart = place - middle[:, None]
    v = np.einsum("k,nka,nkb->nab", weights, apart, apart)
    bare = np.linalg.det(v)
    v += 0.3 * np.eye(2)
    wide, v00, v11 = np.linalg.det(v), v[:, 0, 0], v[:, 1, 1]
    with np.errstate(all="ignore"):
        seen_opacity = opacity * np.sqrt(np.maximum(bare / wide, 2.5e-5))
        half = 0.5 * (v00 + v11)
        longest = half + np.sqrt(np.maximum(0.01, half * half - wide))
        extent = np.minimum(3.33, np.sqrt(2 * np.log(seen_opacity * 255)))
        radii = np.ceil(extent[:, None] * np.sqrt(np.minimum(np.stack([v00, v11], 1), longest[:, None])))
        pose = pose_at(c, 0.5)
        depth = means @ pose[2, :3] + pose[2, 3]
        shown = seen.any(1) & (depth >= 0.01) & (wide > 0) & (v00 >= 0) & (v11 >= 0) & (seen_opacity >= 1 / 255)
        shown &= ((middle + radii > 0) & (middle - radii < [WIDTH, HEIGHT])).all(1)
    return middle, radii, depth, shown


def draw(c, lens, means, turns, scales, opacity, color):
    rows, columns = np.divmod(np.arange(WIDTH * HEIGHT), WIDTH)
    pixels = np.stack([columns + 0.5, rows + 0.5], 1)
    direction, there = lens.rays(pixels)
    pose = pose_at(c, time_at(c, pixels))
    origin = -np.einsum("nji,nj->ni", pose[..., :3], pose[..., 3])
    direction = np.einsum("nji,nj->ni", pose[..., :3], direction)
    middle, radii, depth, shown = project(c, lens, means, turns, scales, opacity)
    light, rgb, going = np.ones(len(pixels)), np.zeros((len(pixels), 3)), there.copy()
    for i in sorted(np.where(shown)[0], key=lambda i: np.float32(depth[i])):
        first = np.floor((middle[i] - radii[i]) / TILE) * TILE
        behind = np.ceil((middle[i] + radii[i]) / TILE) * TILE
        at = np.where(going & (pixels >= first).all(1) & (pixels < behind).all(1))[0]
        into = turns[i].T / scales[i][:, None]
        g, m = direction[at] @ into.T, (means[i] - origin[at]) @ into.T
        q = (np.cross(g, m) ** 2).sum(1) / (g * g).sum(1)
        alpha = np.minimum(np.float32(0.99), opacity[i] * np.exp(-0.5 * q))
        alpha = np.where(((g * m).sum(1) > 0) & (alpha >= np.float32(1 / 255)), alpha, 0)
        after = light[at] * (1 - alpha)
        going[at] &= (alpha == 0) | (after > 1e-4)
        alpha = np.where(going[at], alpha, 0)
        rgb[at] += (alpha * light[at])[:, None] * color[i]
        light[at] *= 1 - alpha
    return rgb.reshape(HEIGHT, WIDTH, 3)


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline() == b"PF\n"
        width, height = map(int, file.readline().split())
        kind = "<f4" if float(file.readline()) < 0 else ">f4"
        return np.frombuffer(file.read(), kind).reshape(height, width, 3)[::-1]


def check(program, path, things, name, c):
    lens = Lens(c)
    run = [program, "project", path, "--profile", "3dgut-2025", "--camera", name + ".json"]
    subprocess.run([*run, "-o", "p.npz", "--quiet"], check=True)
    found = np.load("p.npz")
    middle, radii, depth, shown = project(c, lens, *things[:4])
    known = np.isfinite(found["means2d_high"] - found["means2d_low"]).all(1)  # to the oracle, whatever floats do
    where = shown & (found["depths"] != 0) & known
    off = abs(found["means2d"] - middle)[where].max()
    n_other = int(((shown != (found["depths"] != 0)) & known).sum() + (found["radii"] != radii)[where].any(1).sum())
    run[1] = "render"
    subprocess.run([*run, "-o", "p.pfm", "--quiet"], check=True)
    apart = abs(read_pfm("p.pfm") - draw(c, lens, *things)).max(2)
    n_off = int((apart > 1e-5).sum())
    print(f"{path} {name}: {where.sum()} of {len(shown)} shown, means {off:.2g} px off, {n_other} others; "
          f"{n_off} pixels are more than 1e-5 off, the median {np.median(apart):.2g}")
    return where.sum() > len(shown) / 5 and off < 1e-6 and n_other == 0 and n_off <= 2


def main():
    program = sys.argv[1]
    cameras = {
        "fisheye": camera("fisheye", kind="fisheye"),
        "turned": camera("turned", kind="fisheye", lens="radial", distortion=[0.05, -0.03, 0.004, 0], fx=28, fy=29),
        "fourth": camera("fourth", kind="fisheye", lens="radial", distortion=[0.05, -0.02, 0.01, -0.01], fx=30, fy=31),
        "barrel": camera("barrel", kind="fisheye", lens="radial", distortion=[-0.06, 0, 0, 0]),  # corners see nothing
        # Two folds, at 1.30 and at 1.595: steps from 1.57 find the second.
        "folded": camera("folded", kind="fisheye", lens="radial", distortion=[-0.3274, 0.0501, -0.0027, 0.0005]),
        "radial": camera("radial", lens="radial", distortion=[-0.2, 0.03, 0.01]),
        "opencv": camera("opencv", lens="opencv", distortion=[-0.25, 0.1, 0.004, -0.01, 0.01, 0.02, 0.01, 0.001]),
        "down": rolling("down", "top-to-bottom"),
        "right": rolling("right", "left-to-right", kind="fisheye"),
        "up": rolling("up", "bottom-to-top", lens="radial", distortion=[-0.1, 0.02]),
        "left": rolling("left", "right-to-left", kind="fisheye", lens="radial", distortion=[0.02, -0.01, 0, -0.001]),
        "strong": camera("strong", lens="opencv", distortion=[-0.4, 0.09, 0, 0, 0, 0, 0, 0], fx=36, fy=36),
    }
    is_right = True
    for path, count, seed, largest in (("small.ply", 400, 1, 0.2), ("large.ply", 150, 2, 0.9)):
        things = scene(path, count, seed, largest)
        for name, c in cameras.items():
            is_right &= check(program, path, things, name, c)
    return 0 if is_right else 1


sys.exit(main())
