"""A renderer of Gaussian scenes by the rules of gsplat 1.6, in plain numpy: what a conformance suite asks for.

    conic conformance suite
    python3 numpy-renderer.py suite pictures [LEVEL]
    conic judge --suite suite --pictures pictures --profile gsplat-1.6 --level 2

It draws every Gaussian over the whole picture, so it is slow; levels 1 and 2, which it draws by default, take a second.
Read it from the top: the steps are those that any renderer has, and the comments say what is easily got wrong.
"""

import json
import os
import sys

import numpy as np

F = np.float32  # as on a GPU
SH = [0.28209479177387814, -0.4886025119029199, 0.4886025119029199, -0.4886025119029199]


def read_ply(path):
    data = open(path, "rb").read()
    end = data.index(b"end_header\n") + 11
    names = [line.split()[2] for line in data[:end].decode().splitlines() if line.startswith("property")]
    table = np.frombuffer(data, "<f4", offset=end).reshape(-1, len(names))
    table = table[np.isfinite(table).all(1)]  # what is not finite is left out
    return {name: table[:, i].astype(np.float64) for i, name in enumerate(names)}


def harmonics(degree, d):
    """The real harmonics of 3DGS, in its order and with its signs."""
    x, y, z = d.T
    basis = [np.full(len(d), SH[0])]
    if degree > 0:
        basis += [SH[1] * y, SH[2] * z, SH[3] * x]
    if degree > 1:
        basis += [1.0925484305920792 * x * y, -1.0925484305920792 * y * z,
                  0.31539156525252005 * (3 * z * z - 1), -1.0925484305920792 * x * z,
                  0.5462742152960396 * (x * x - y * y)]
    if degree > 2:
        basis += [-0.5900435899266435 * y * (3 * x * x - y * y), 2.890611442640554 * x * y * z,
                  -0.4570457994644658 * y * (5 * z * z - 1), 0.3731763325901154 * z * (5 * z * z - 3),
                  -0.4570457994644658 * x * (5 * z * z - 1), 1.445305721320277 * z * (x * x - y * y),
                  -0.5900435899266435 * x * (x * x - 3 * y * y)]
    return np.stack(basis, 1)


def colors_of(ply, directions):
    n_rest = sum(name.startswith("f_rest_") for name in ply) // 3
    degree = int(round((n_rest + 1) ** 0.5)) - 1
    basis = harmonics(degree, directions)
    channels = []
    for c in range(3):  # f_rest has one channel after the other
        rest = [ply[f"f_rest_{c * n_rest + k}"] for k in range(n_rest)]
        channels.append((basis * np.stack([ply[f"f_dc_{c}"]] + rest, 1)).sum(1) + 0.5)
    return np.maximum(np.stack(channels, 1), 0.0)  # before compositing


def rotations(q):
    w, x, y, z = (q / np.linalg.norm(q, axis=1, keepdims=True)).T  # w comes first, and the length is any
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                     2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1).reshape(-1, 3, 3)


def draw(ply, camera, background):
    width, height, fx, fy, cx, cy = (camera[key] for key in ("width", "height", "fx", "fy", "cx", "cy"))
    view = np.array(camera["world_to_camera"])
    R, t = view[:3, :3], view[:3, 3]
    sound = sum(abs(ply[f"rot_{k}"]) for k in range(4)) > 0
    ply = {name: values[sound] for name, values in ply.items()}
    means = np.stack([ply[c] for c in "xyz"], 1)
    scales = np.exp(np.stack([ply[f"scale_{k}"] for k in range(3)], 1)).astype(F)  # the file has logarithms
    opacities = (1.0 / (1.0 + np.exp(-ply["opacity"]))).astype(F)  # and logits
    quaternions = np.stack([ply[f"rot_{k}"] for k in range(4)], 1)
    directions = means + R.T @ t  # from the eye, which is -R'·t
    colors = colors_of(ply, directions / np.linalg.norm(directions, axis=1, keepdims=True)).astype(F)

    p = means @ R.T + t
    x, y, z = p.T
    z_safe = np.where(z > 0, z, 1)
    # The Jacobian is taken at a slope that is clamped to the picture and 0.15 of its size around.
    slope_x = np.clip(x / z_safe, -(cx + 0.15 * width) / fx, (width - cx + 0.15 * width) / fx)
    slope_y = np.clip(y / z_safe, -(cy + 0.15 * height) / fy, (height - cy + 0.15 * height) / fy)
    zero = np.zeros_like(z)
    J = np.stack([fx / z_safe, zero, -fx * slope_x / z_safe, zero, fy / z_safe, -fy * slope_y / z_safe], 1)
    M = J.reshape(-1, 2, 3) @ R @ (rotations(quaternions) * scales[:, None, :])
    covariance = M @ M.transpose(0, 2, 1) + 0.3 * np.eye(2)  # px²
    conic = np.linalg.inv(covariance).astype(F)
    center = np.stack([fx * x / z_safe + cx, fy * y / z_safe + cy], 1).astype(F)

    X, Y = np.meshgrid(np.arange(width, dtype=F) + F(0.5), np.arange(height, dtype=F) + F(0.5))  # pixels' centres
    rgb, depth = np.zeros((height, width, 3), F), np.zeros((height, width), F)
    T, is_done = np.ones((height, width), F), np.zeros((height, width), bool)
    for i in np.argsort(z.astype(F), kind="stable"):  # from the front to the back; of equal ones, as in the file
        if z[i] < 0.01:
            continue
        dx, dy = X - center[i, 0], Y - center[i, 1]
        q = F(0.5) * (conic[i, 0, 0] * dx * dx + conic[i, 1, 1] * dy * dy) + conic[i, 0, 1] * dx * dy
        alpha = np.minimum(opacities[i] * np.exp(-q), F(0.99))
        is_seen = (q >= 0) & (alpha >= F(1 / 255)) & ~is_done
        after = T * (1 - alpha)
        is_done |= is_seen & (after <= F(1e-4))  # this one is left out, and all behind it
        is_seen &= ~is_done
        weight = np.where(is_seen, alpha * T, F(0))
        rgb += weight[..., None] * colors[i]
        depth += weight * F(z[i])
        T = np.where(is_seen, after, T)
    alpha = 1 - T
    depth = np.where(alpha > 0, depth / np.where(alpha > 0, alpha, 1), 0)
    rgb += T[..., None] * np.array(background, F)
    return np.concatenate((rgb, alpha[..., None]), 2), depth


def main(suite, pictures, most_level="2"):
    os.makedirs(pictures, exist_ok=True)
    manifest = json.load(open(suite + "/manifest.json"))
    scenes = {scene["name"]: scene for scene in manifest["scenes"]}
    for case in manifest["cases"]:
        if case["profile"] != "gsplat-1.6" or case["level"] > int(most_level):
            continue
        scene = scenes[case["scene"]]
        with np.errstate(over="ignore"):
            rgba, depth = draw(read_ply(f"{suite}/{scene['files']['ply']}"),
                               json.load(open(f"{suite}/{scene['camera']['conic']}")), scene["background"])
        np.save(f"{pictures}/{case['name']}.npy", rgba.astype(F))
        np.save(f"{pictures}/{case['name']}.Z.npy", depth.astype(F))


if __name__ == "__main__":
    main(*sys.argv[1:])
