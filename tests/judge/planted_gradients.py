"""Gradients of a renderer written once more in NumPy, as gsplat's CUDA sources go backwards, with mistakes planted in
it, held against conic judge --gradients.

planted_gradients.py CONIC [N [SIDE]]: scenes of N Gaussians (60) in SIDE pixels (32). The right gradient, in float32 and
with sums in two orders, must be right; each mistake must be wrong, and named, or not named wrongly.
"""

import json
import subprocess
import sys

import numpy as np

BACKGROUND = (0.25, 0.5, 0.125)
MOST, LEAST, STOP = 0.99, 1.0 / 255.0, 1e-4
ALL = ("mean", "scale", "rotation", "opacity", "sh", "place")

# By fault: the kinds that it changes, and the name; no name: where that cannot be told.
FAULTS = {
    "quaternion-not-normalised": ("rotation",), "quaternion-length": ("rotation",), "quaternion-xyzw": ("rotation",),
    "scale-log": ("scale",), "opacity-logit": ("opacity",), "sh-direction": ("mean",), "jacobian": ("mean",),
    "place": ("mean",), "conic-cross-half": ("mean", "scale", "rotation"),
    "conic-cross-twice": ("mean", "scale", "rotation"), "camera-space": ("mean",), "bgr": ("sh",),
    "absgrad": ("place",), "place-ndc": ("place",), "sign": ("opacity",), "twice": ("mean", "scale"), "half": ("sh",),
    "zero": ("sh",), "compensation": ("mean", "scale", "rotation"), "stop-ignored": (), "background-ignored": (), "alpha-ignored": (), "clamp-passed": (),
}
# Where quaternions have length 1, and where T does not end.
UNSEEN = (("quaternion-length", 2), ("stop-ignored", 1))


def make_scene(n, seed):
    """Of odd seeds quaternions have any length; of even ones Gaussians are large and hide each other."""
    r = np.random.default_rng(seed)
    is_dense = seed % 2 == 0
    q = r.standard_normal((n, 4)) * 0.7
    return {"mean": (r.uniform(-1, 1, (n, 3)) * (1.2, 1.2, 1.0)).astype(np.float32),
            "log_scale": (r.uniform(-3.2, -1.2, (n, 3)) + 0.9 * is_dense).astype(np.float32),
            "rotation": (q / np.linalg.norm(q, axis=1, keepdims=True) if is_dense else q).astype(np.float32),
            "logit": r.uniform(-2 + 4 * is_dense, 7, n).astype(np.float32),
            "sh": r.normal(0, 0.35, (n, 4, 3)).astype(np.float32)}


def write_ply(path, s):
    names = ["x", "y", "z", *(f"f_dc_{k}" for k in range(3)), *(f"f_rest_{k}" for k in range(9)), "opacity",
             *(f"scale_{k}" for k in range(3)), *(f"rot_{k}" for k in range(4))]
    rest = s["sh"][:, 1:].transpose(0, 2, 1).reshape(len(s["sh"]), 9)
    table = np.concatenate((s["mean"], s["sh"][:, 0], rest, s["logit"][:, None], s["log_scale"], s["rotation"]), 1)
    with open(path, "wb") as file:
        file.write(("ply\nformat binary_little_endian 1.0\n" + f"element vertex {len(table)}\n" +
                    "".join(f"property float {name}\n" for name in names) + "end_header\n").encode())
        file.write(table.astype("<f4").tobytes())


def project(s, camera, t):
    """The set-up in numbers of type t."""
    v, f, c, side = camera["view"].astype(t), t(camera["f"]), t(camera["c"]), camera["side"]
    p = {"mean_c": s["mean"].astype(t) @ v[:3, :3].T + v[:3, 3], "view": v, "f": f}
    q = s["rotation"].astype(t)
    p["length"] = np.sqrt((q * q).sum(1, keepdims=True))
    w, x, y, z = p["q"] = (q / p["length"]).T
    p["turn"] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                          2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                          2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1).reshape(-1, 3, 3)
    p["scale"] = np.exp(s["log_scale"].astype(np.float64)).astype(np.float32).astype(t)
    p["opacity"] = (1 / (1 + np.exp(-s["logit"].astype(np.float64)))).astype(np.float32).astype(t)
    p["M"] = p["turn"] * p["scale"][:, None, :]
    p["cov_c"] = v[:3, :3] @ (p["M"] @ p["M"].transpose(0, 2, 1)) @ v[:3, :3].T
    x, y, z = p["mean_c"].T
    p["z"] = z
    low, high = -(c / f + t(0.15) * side / f), (side - c) / f + t(0.15) * side / f  # 0.3 of half the picture
    p["slope"] = np.stack([np.clip(x / z, low, high), np.clip(y / z, low, high)], 1)
    p["inside"] = np.stack([(x / z >= low) & (x / z <= high), (y / z >= low) & (y / z <= high)], 1)
    J = np.zeros((len(z), 2, 3), t)
    for k in range(2):
        J[:, k, k], J[:, k, 2] = f / z, -f / z * p["slope"][:, k]
    p["J"] = J
    cov = J @ p["cov_c"] @ J.transpose(0, 2, 1)
    a, b, d = cov[:, 0, 0] + t(0.3), cov[:, 0, 1], cov[:, 1, 1] + t(0.3)
    p["share"] = np.ones_like(a)
    if camera.get("aa"):
        p["share"] = np.sqrt(np.maximum(t(2.5e-5), (cov[:, 0, 0] * cov[:, 1, 1] - b * b) / (a * d - b * b)))
    p["conic"] = np.stack([d, -b, a], 1) / (a * d - b * b)[:, None]
    p["place"] = np.stack([f * x / z + c, f * y / z + c], 1)
    eye = -(camera["view"][:3, :3].T @ camera["view"][:3, 3])
    direction = s["mean"].astype(t) - eye.astype(t)
    p["far"] = np.sqrt((direction * direction).sum(1, keepdims=True))
    p["direction"] = d = direction / p["far"]
    p["basis"] = np.stack([np.full(len(z), 0.28209479177387814), -0.4886025119029199 * d[:, 1],
                           0.4886025119029199 * d[:, 2], -0.4886025119029199 * d[:, 0]], 1).astype(t)
    p["sum"] = np.einsum("nk,nkc->nc", p["basis"], s["sh"].astype(t)) + t(0.5)
    p["color"] = np.maximum(p["sum"], 0)
    return p


def add_up(values, order):
    """Over pixels, one by one."""
    return np.cumsum(values[order], 0, dtype=values.dtype)[-1]


def composite_back(p, camera, weights, t, fault, order):
    """From the pixels back to the centre, the conic, the opacity and the colour."""
    side, n = camera["side"], len(p["z"])
    y, x = (at.astype(t) + t(0.5) for at in np.divmod(np.arange(side * side), side))
    W = weights.reshape(-1, 4).astype(t)
    ranks = np.argsort(p["z"].astype(np.float32), kind="stable")
    alphas, held, steps = np.zeros((n, side * side), t), np.zeros((n, side * side), bool), {}
    T, done = np.ones(side * side, t), np.zeros(side * side, bool)
    for i in ranks:
        dx, dy = p["place"][i, 0] - x, p["place"][i, 1] - y
        a, b, c = p["conic"][i]
        sigma = t(0.5) * (a * dx * dx + c * dy * dy) + b * dx * dy
        seen = np.exp(-sigma)
        alpha = np.minimum(p["opacity"][i] * seen, t(MOST))
        covers = (sigma >= 0) & (alpha >= t(LEAST)) & ~done
        rest = T * (1 - alpha)
        ends = covers & (rest <= t(STOP)) & (fault != "stop-ignored")
        done |= ends
        covers &= ~ends
        alphas[i] = np.where(covers, alpha, 0)
        held[i] = p["opacity"][i] * seen > t(MOST)
        steps[i] = dx, dy, seen
        T = np.where(covers, rest, T)
    by = {"place": np.zeros((n, 2), t), "conic": np.zeros((n, 3), t), "opacity": np.zeros(n, t),
          "color": np.zeros((n, 3), t), "abs": np.zeros((n, 2), t)}
    background = np.array(BACKGROUND if fault != "background-ignored" else (0, 0, 0), t)
    at_end = T * ((0 if fault == "alpha-ignored" else W[:, 3]) - W[:, :3] @ background)
    behind = np.zeros((side * side, 3), t)
    for i in ranks[::-1]:
        alpha, (dx, dy, seen) = alphas[i], steps[i]
        covers = alpha > 0
        ratio = 1 / (1 - alpha)
        T = np.where(covers, T * ratio, T)
        by["color"][i] = add_up((alpha * T)[:, None] * W[:, :3], order)
        by_alpha = ((p["color"][i] * T[:, None] - behind * ratio[:, None]) * W[:, :3]).sum(1) + at_end * ratio
        behind += p["color"][i] * (alpha * T)[:, None]
        by_alpha = np.where(covers & (~held[i] | (fault == "clamp-passed")), by_alpha, 0)
        by_sigma = -p["opacity"][i] * seen * by_alpha
        a, b, c = p["conic"][i]
        place = np.stack([by_sigma * (a * dx + b * dy), by_sigma * (b * dx + c * dy)], 1)
        by["place"][i], by["abs"][i] = add_up(place, order), add_up(abs(place), order)
        by["conic"][i] = add_up(np.stack([t(0.5) * by_sigma * dx * dx, by_sigma * dx * dy,
                                          t(0.5) * by_sigma * dy * dy], 1), order)
        by["opacity"][i] = add_up(seen * by_alpha, order)
    return by


def quaternion_back(p, V, fault):
    w, x, y, z = p["q"]
    free = 2 * np.stack([
        x * (V[:, 2, 1] - V[:, 1, 2]) + y * (V[:, 0, 2] - V[:, 2, 0]) + z * (V[:, 1, 0] - V[:, 0, 1]),
        -2 * x * (V[:, 1, 1] + V[:, 2, 2]) + y * (V[:, 1, 0] + V[:, 0, 1]) + z * (V[:, 2, 0] + V[:, 0, 2]) +
        w * (V[:, 2, 1] - V[:, 1, 2]),
        x * (V[:, 1, 0] + V[:, 0, 1]) - 2 * y * (V[:, 0, 0] + V[:, 2, 2]) + z * (V[:, 2, 1] + V[:, 1, 2]) +
        w * (V[:, 0, 2] - V[:, 2, 0]),
        x * (V[:, 2, 0] + V[:, 0, 2]) + y * (V[:, 2, 1] + V[:, 1, 2]) - 2 * z * (V[:, 0, 0] + V[:, 1, 1]) +
        w * (V[:, 1, 0] - V[:, 0, 1])], 1)
    q = p["q"].T
    if fault == "quaternion-not-normalised":
        return free
    turned = free - (free * q).sum(1, keepdims=True) * q
    turned = turned if fault == "quaternion-length" else turned / p["length"]
    return turned[:, [1, 2, 3, 0]] if fault == "quaternion-xyzw" else turned


def differentiate(s, camera, weights, t=np.float32, fault="", order=None, raw=False):
    p = project(s, camera, t)
    own, share = p["opacity"], p["share"]
    p["opacity"] = own * share
    by = composite_back(p, camera, weights, t, fault, order if order is not None else np.arange(camera["side"] ** 2))
    cross = {"conic-cross-half": t(0.25), "conic-cross-twice": t(1.0)}.get(fault, t(0.5)) * by["conic"][:, 1]
    V = np.stack([by["conic"][:, 0], cross, cross, by["conic"][:, 2]], 1).reshape(-1, 2, 2)
    X = p["conic"][:, [0, 1, 1, 2]].reshape(-1, 2, 2)
    V, J, f, z = -X @ V @ X, p["J"], p["f"], p["z"]
    if camera.get("aa") and fault != "compensation":
        by_ratio = np.where(share * share > t(2.51e-5), by["opacity"] * own * t(0.5) / share, 0)
        det = X[:, 0, 0] * X[:, 1, 1] - X[:, 0, 1] * X[:, 0, 1]
        V = V + by_ratio[:, None, None] * ((1 - share * share)[:, None, None] * X - (t(0.3) * det)[:, None, None] *
                                           np.eye(2, dtype=t))
    by_cov = J.transpose(0, 2, 1) @ V @ J
    by_J = 2 * V @ J @ p["cov_c"]
    if fault == "jacobian":
        by_J = by_J * 0
    mean = np.zeros_like(p["mean_c"])
    for k in range(2):
        slope, inside = p["slope"][:, k], p["inside"][:, k]
        by_slope = -f / z * by_J[:, k, 2]
        by_ratio = (0 if fault == "place" else by["place"][:, k] * f) + np.where(inside, by_slope, 0)
        mean[:, k] += by_ratio / z
        mean[:, 2] += -f / (z * z) * (by_J[:, k, k] - slope * by_J[:, k, 2]) - by_ratio * p["mean_c"][:, k] / (z * z)
    R = p["view"][:3, :3]
    if fault != "camera-space":
        mean = mean @ R
    by_color = np.where(p["sum"] >= 0, by["color"], 0)
    sh = p["basis"][:, :, None] * by_color[:, None, :]
    along = np.einsum("nkc,nc->nk", s["sh"].astype(t), by_color) * t(0.4886025119029199)
    by_direction = np.stack([-along[:, 3], -along[:, 1], along[:, 2]], 1)
    d = p["direction"]
    by_direction = (by_direction - (by_direction * d).sum(1, keepdims=True) * d) / p["far"]
    if fault != "sh-direction":
        mean = mean + (by_direction @ R.T if fault == "camera-space" else by_direction)
    by_M = 2 * (R.T @ by_cov @ R) @ p["M"]
    made = {"mean": mean, "scale": (p["turn"] * by_M).sum(1), "opacity": by["opacity"] * share, "sh": sh,
            "rotation": quaternion_back(p, by_M * p["scale"][:, None, :], fault), "place": by["place"]}
    o = own
    if raw != (fault == "scale-log"):
        made["scale"] = made["scale"] * p["scale"]
    if raw != (fault == "opacity-logit"):
        made["opacity"] = made["opacity"] * (o * (1 - o))
    plain = {"sign": -1, "twice": 2, "half": 0.5, "zero": 0}
    for kind in FAULTS.get(fault, ()) if fault in plain else ():
        made[kind] = made[kind] * t(plain[fault])
    if fault == "bgr":
        made["sh"] = made["sh"][:, :, ::-1]
    if fault == "absgrad":
        made["place"] = by["abs"]
    if fault == "place-ndc":
        made["place"] = made["place"] * t(camera["side"] / 2)
    return made


class Judge:
    def __init__(self, conic, camera, weights):
        with open("camera.json", "w") as file:
            json.dump({"width": camera["side"], "height": camera["side"], "fx": camera["f"], "fy": camera["f"],
                       "cx": camera["c"], "cy": camera["c"], "world_to_camera": camera["view"].tolist()}, file)
        np.save("weights.npy", weights)
        self.words = [conic, "judge", "scene.ply", "--profile", "gsplat-1.6-aa" if camera.get("aa") else "gsplat-1.6", "--camera", "camera.json", "--weights",
                      "weights.npy", "--background", ",".join(map(str, BACKGROUND)), "--json", "judged.json"]

    def __call__(self, made, raw=False):
        names = {"mean": "means", "scale": "scales", "rotation": "quats", "opacity": "opacities", "sh": "sh",
                 "place": "means2d"}
        np.savez("theirs.npz", **{names[kind]: values for kind, values in made.items()})
        done = subprocess.run([*self.words, "--gradients", "theirs.npz", *(["--raw"] if raw else [])],
                              capture_output=True, text=True)
        if done.returncode not in (0, 1):
            sys.exit(done.stdout + done.stderr)
        with open("judged.json") as file:
            return json.load(file)


def told_of(judged):
    """By kind that is wrong: the name, or what is nearest in brackets."""
    told = {}
    for m in judged["mistakes"]:
        told[m["kind"]] = "-" if "name" not in m else m["name"] if m["named"] else f"({m['name']})"
    return told


def judge_others(judge, made):
    """What has no name: some Gaussians alone, numbers off by chance, and two mistakes in one kind; how many fail."""
    r = np.random.default_rng(0)
    some = dict(made, scale=made["scale"].copy())
    ids = np.sort(np.argsort(-abs(made["scale"]).sum(1))[:3])
    some["scale"][ids] *= 2
    judged = judge(some)
    about = judged["mistakes"][0]
    found = [i for first, last in about["runs"] for i in range(first, last + 1)]
    print(f"of Gaussians {ids.tolist()} alone: {found}, {about}")
    n_failed = int(found != ids.tolist() or about["named"] or about["name"] != "twice")
    for what, factors in (("chance", r.uniform(0.8, 1.2, made["mean"].shape)), ("two", np.array((-2.0, -2.0, 1.0)))):
        told = told_of(judge(dict(made, mean=made["mean"] * factors)))
        print(f"means off by {what}: {told}")
        n_failed += set(told) != {"mean"} or told["mean"][0] not in "-("
    return n_failed


def main():
    n, side = (int(sys.argv[k]) if len(sys.argv) > k else default for k, default in ((2, 60), (3, 32)))
    n_failed = 0
    for seed in (1, 2, 3):
        r = np.random.default_rng(seed)
        turn, _ = np.linalg.qr(r.standard_normal((3, 3)) * 0.3 + np.eye(3))
        turn *= np.sign(np.diag(turn))
        view = np.eye(4)
        view[:3, :3], view[:3, 3] = turn, (0.1, -0.2, 4.0)
        camera = {"side": side, "f": 1.1 * side, "c": 0.5 * side + 0.25, "view": view, "aa": seed == 3}
        weights = r.standard_normal((side, side, 4))
        scene = make_scene(n, seed)
        write_ply("scene.ply", scene)
        judge = Judge(sys.argv[1], camera, weights)
        for what, arguments in (("double", {"t": np.float64}), ("floats", {}), ("raw", {"raw": True}),
                                ("shuffled", {"order": r.permutation(side * side)})):
            judged = judge(differentiate(scene, camera, weights, **arguments), arguments.get("raw", False))
            shares = ", ".join(f"{kind} {about['share_of_bound']:.4f}" for kind, about in judged["kinds"].items())
            print(f"right, {what}: {judged['gaussians']}; shares {shares}")
            n_failed += judged["verdict"] != "right"
        n_failed += judge_others(judge, differentiate(scene, camera, weights))
        for fault, kinds in FAULTS.items() if seed < 3 else [("compensation", FAULTS["compensation"])]:
            if fault == "compensation" and seed < 3:
                continue
            raw = fault in ("scale-log", "opacity-logit") and seed == 2
            told = told_of(judge(differentiate(scene, camera, weights, fault=fault, raw=raw), raw))
            is_named = bool(told) and all(name == fault for name in told.values())
            is_only = not kinds or set(told) <= set(kinds)
            print(f"{fault:26} {'named' if is_named and is_only else 'UNNAMED'} {told}")
            wrongly = [name for name in told.values() if name not in (fault, "-") and name[0] != "("]
            n_failed += bool(wrongly) or not is_only or not (is_named or (fault, seed) in UNSEEN)
    return int(n_failed > 0)


if __name__ == "__main__":
    sys.exit(main())
