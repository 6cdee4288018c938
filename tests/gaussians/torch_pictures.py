"""Pictures by gsplat's own code for torch, beside conic's, for torch.sh and for docs/notes/gaussians-measured.md.

torch_pictures.py CONIC GSPLAT DATA [SIDE [FULL]]: crops of SIDE pixels (40) of biker and of a scene of garden.npz, by
the gsplat in the folder GSPLAT; with FULL, more crops, and pictures in float, too. CONIC is the program.

gsplat's code projects, evaluates harmonics, and sums up. In its releases the list of the pairs of a Gaussian and a pixel
that are composited comes from CUDA, and the sums along rays from nerfacc; `pairs` and `nerfacc` below stand for these.
Numbers of Gaussians and cameras are floats, as conic reads them; what follows is double, but for pictures in float.
"""

import importlib
import json
import os
import subprocess
import sys
import types

import numpy as np
import torch

LEAST = 1.0 / 255.0
STOP = 1e-4
BOUND = 1e-5  # of the colours
NEAR_DECISION = 5e-6  # a share of 1/255 or of STOP: what roundings to float may do to an opacity
NEAR_DEPTH = 2.4e-7  # two ulps
precision = torch.float64


# --- gsplat, without the parts that need CUDA ---

def package(name, folder):
    made = types.ModuleType(name)
    made.__path__ = [folder]
    sys.modules[name] = made


def sum_along(weights, values, ray_indices, n_rays):
    values = weights[:, None] if values is None else weights[:, None] * values
    return torch.zeros(n_rays, values.shape[1], dtype=weights.dtype).index_add_(0, ray_indices, values)


def weights_of(alphas, ray_indices, n_rays):
    """w = α·Π(1 − α) over those before; the pairs of a ray stand together."""
    counts = torch.bincount(ray_indices, minlength=n_rays)
    place = torch.arange(len(alphas)) - (torch.cumsum(counts, 0) - counts)[ray_indices]
    rest = torch.ones(n_rays, int(counts.max()) + 1, dtype=alphas.dtype)
    rest[ray_indices, place + 1] = 1.0 - alphas
    before = torch.cumprod(rest, 1)[ray_indices, place]
    return alphas * before, before


def load(folder):
    package("gsplat", folder + "/gsplat")
    package("gsplat.cuda", folder + "/gsplat/cuda")
    wrapper = types.ModuleType("gsplat.cuda._wrapper")
    wrapper.CameraModel = wrapper.RollingShutterType = str
    sys.modules["gsplat.cuda._wrapper"] = wrapper
    nerfacc = types.ModuleType("nerfacc")
    nerfacc.accumulate_along_rays = sum_along
    nerfacc.render_weight_from_alpha = weights_of
    sys.modules["nerfacc"] = nerfacc
    version = importlib.import_module("gsplat.version").__version__
    names = ("gsplat.cuda._torch_impl", "gsplat.cuda._torch_impl_2dgs")
    return (version, *(importlib.import_module(name) for name in names))


# --- scenes: columns of floats as they stand in a .ply ---

def write_ply(path, scene):
    n_rest = scene["sh"].shape[1] - 1
    names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"] + [f"f_rest_{i}" for i in range(3 * n_rest)]
    names += ["opacity"] + [f"scale_{i}" for i in range(scene["log_scale"].shape[1])] + [f"rot_{i}" for i in range(4)]
    rest = scene["sh"][:, 1:].transpose(0, 2, 1).reshape(len(scene["mean"]), -1)
    table = np.concatenate((scene["mean"], scene["sh"][:, 0], rest, scene["logit"][:, None], scene["log_scale"],
                            scene["rotation"]), 1).astype("<f4")
    header = "".join(f"property float {name}\n" for name in names)
    with open(path, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(table)}\n{header}end_header\n".encode())
        file.write(table.tobytes())


def read_ply(path):
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + 11
    names = [line.split()[2] for line in data[:end].decode().splitlines() if line.startswith("property")]
    table = np.frombuffer(data, "<f4", offset=end).reshape(-1, len(names))
    def columns(start):
        return table[:, [i for i, name in enumerate(names) if name.startswith(start)]]
    return {"mean": table[:, :3], "sh": columns("f_dc")[:, None], "logit": columns("opacity")[:, 0],
            "log_scale": columns("scale"), "rotation": columns("rot")}


def spacing(points):
    """The mean distance of the three nearest, as trainers begin."""
    made = np.empty(len(points))
    points = torch.from_numpy(points.astype(np.float64))
    for begin in range(0, len(points), 512):
        nearest = torch.cdist(points[begin:begin + 512], points).topk(4, largest=False)[0]
        made[begin:begin + 512] = nearest[:, 1:].mean(1).numpy()
    return np.maximum(made, 1e-5)


def scene_of_points(points, colors, index):
    """Long, lean Gaussians of degree 3 in all directions; `index` is that of each point in the file."""
    golden = (index[:, None] * np.array([0.6180339887, 0.7548776662, 0.5698402910, 0.8191725134])) % 1.0
    sh = 0.15 * np.sin(np.arange(48)[None] * 1.7 + index[:, None] * 0.37).reshape(-1, 16, 3)
    sh[:, 0] = (colors / 255.0 - 0.5) / 0.28209479177387814
    opacity = 0.02 + 0.97 * golden[:, 0]
    return {"mean": points, "sh": sh.astype(np.float32), "logit": np.log(opacity / (1 - opacity)).astype(np.float32),
            "log_scale": np.log(spacing(points)[:, None] * np.array([1.6, 0.8, 0.3])).astype(np.float32),
            "rotation": (2.0 * golden - 1.0).astype(np.float32)}


def in_view(points, camera, margin):
    seen = points.astype(np.float64) @ camera["rotation"].T + camera["translation"]
    with np.errstate(divide="ignore", invalid="ignore"):
        x = camera["f"][0] * seen[:, 0] / seen[:, 2] + camera["c"][0]
        y = camera["f"][1] * seen[:, 1] / seen[:, 2] + camera["c"][1]
    return (seen[:, 2] > 0.05) & (abs(x - camera["side"] / 2) < camera["side"] / 2 + margin) & (
        abs(y - camera["side"] / 2) < camera["side"] / 2 + margin)


# --- a picture by gsplat ---

def tensor(values):
    return torch.from_numpy(np.ascontiguousarray(values).astype(np.float64)).to(precision)


def pairs(means2d, radii, depths, alpha_at, side):
    """Which are composited, pixel by pixel in the order of depth, and how near each pixel's decisions were."""
    order = torch.sort(depths.float(), stable=True)[1]
    order = order[(radii[order] > 0).all(1)]
    low = torch.floor((means2d[order] - radii[order]) / 16).clamp(min=0)
    high = torch.ceil((means2d[order] + radii[order]) / 16)
    ids, pixels, doubts = [], [], torch.full((side * side, 3), 9.0, dtype=precision)
    for tile_y in range((side + 15) // 16):
        for tile_x in range((side + 15) // 16):
            tile = torch.tensor([tile_x, tile_y])
            here = order[((low <= tile) & (tile < high)).all(1)]
            y, x = torch.meshgrid(torch.arange(16) + 16 * tile_y, torch.arange(16) + 16 * tile_x, indexing="ij")
            within = ((x < side) & (y < side)).reshape(-1)
            x, y = x.reshape(-1)[within], y.reshape(-1)[within]
            alpha = alpha_at(here, x, y)  # by pixel and Gaussian, 0 where the kernel skips
            covered = alpha >= LEAST
            after = torch.cumprod(1.0 - torch.where(covered, alpha, torch.zeros_like(alpha)), 1)
            ended = torch.cumsum(covered & (after <= STOP), 1)
            kept = covered & (ended == 0)
            at, which = kept.nonzero(as_tuple=True)
            ids.append(here[which])
            pixels.append((y * side + x)[at])
            # Doubts reach to the pair that ends it.
            met = (ended == 0) | ((ended == 1) & covered)
            far = torch.full_like(alpha, 9.0)
            apart = torch.stack((torch.where(met, abs(alpha / LEAST - 1.0), far).min(1)[0],
                                 torch.where(met & covered, abs(after / STOP - 1.0), far).min(1)[0]), 1) if len(
                here) else torch.full((len(x), 2), 9.0, dtype=precision)
            doubts[y * side + x, :2] = apart
            for i in range(len(x)):
                z = depths[here[met[i] & covered[i]]]
                if len(z) > 1:
                    doubts[y[i] * side + x[i], 2] = ((z[1:] - z[:-1]) / z[1:]).abs().min()
    pixels, by_pixel = torch.sort(torch.cat(pixels), stable=True)
    return torch.cat(ids)[by_pixel], pixels, doubts


def draw_by_gsplat(gsplat, scene, camera, kind):
    _, three, two = gsplat
    side = camera["side"]
    K = tensor([[camera["f"][0], 0, camera["c"][0]], [0, camera["f"][1], camera["c"][1]], [0, 0, 1]])[None]
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = camera["rotation"], camera["translation"]
    view = tensor(view)[None]
    means, quats = tensor(scene["mean"]), tensor(scene["rotation"])
    scales = tensor(np.exp(scene["log_scale"].astype(np.float64)).astype(np.float32))
    opacities = tensor((1.0 / (1.0 + np.exp(-scene["logit"].astype(np.float64)))).astype(np.float32))
    eye = torch.inverse(view)[0, :3, 3].float().to(precision)  # as its tensors of floats hold it
    degree = int(round(scene["sh"].shape[1] ** 0.5)) - 1
    colors = torch.clamp_min(three._spherical_harmonics(degree, means - eye, tensor(scene["sh"])) + 0.5, 0.0)
    most = 0.999 if gsplat[0].startswith("1.5") else 0.99
    if kind == "discs":
        scales = torch.cat((scales, torch.ones_like(scales[:, :1])), 1)
        radii, means2d, depths, M, normals = two._fully_fused_projection_2dgs(means, quats, scales, view, K, side, side)
    else:
        covars, _ = three._quat_scale_to_covar_preci(quats, scales, compute_preci=False)
        radii, means2d, depths, form, compensation = three._fully_fused_projection(
            means, covars, view, K, side, side, calc_compensations=kind == "aa")
        if kind == "aa":
            opacities = opacities * compensation[0]
        means2d, depths, radii, form = means2d[0], depths[0], radii[0], form[0]

    def of_ellipses(here, x, y):
        dx, dy = ((x + 0.5)[:, None] - means2d[here, 0], (y + 0.5)[:, None] - means2d[here, 1])
        sigma = 0.5 * (form[here, 0] * dx ** 2 + form[here, 2] * dy ** 2) + form[here, 1] * dx * dy
        return torch.where(sigma >= 0, (opacities[here] * torch.exp(-sigma)).clamp(max=most), torch.zeros_like(sigma))

    def of_discs(here, x, y):
        x, y = x[:, None, None] + 0.5, y[:, None, None] + 0.5
        cross = torch.cross(-M[here, 0] + M[here, 2] * x, -M[here, 1] + M[here, 2] * y, dim=-1)
        ray = (cross[..., 0] / cross[..., 2]) ** 2 + (cross[..., 1] / cross[..., 2]) ** 2
        dot = 2.0 * ((x[..., 0] - means2d[here, 0]) ** 2 + (y[..., 0] - means2d[here, 1]) ** 2)
        alpha = (opacities[here] * torch.exp(-0.5 * torch.minimum(ray, dot))).clamp(max=most)
        return torch.where(cross[..., 2] != 0, alpha, torch.zeros_like(alpha))

    if kind == "discs":
        means2d, depths, radii, M = means2d[0], depths[0], radii[0], M[0]
        ids, pixels, doubts = pairs(means2d, radii, depths, of_discs, side)
        rgb, alphas, _ = two.accumulate_2dgs(means2d[None], M[None], opacities[None], colors[None], normals,
                                             ids, pixels, torch.zeros_like(ids), side, side)
    else:
        ids, pixels, doubts = pairs(means2d, radii, depths, of_ellipses, side)
        rgb, alphas = three.accumulate(means2d[None], form[None], opacities[None], colors[None], ids, pixels,
                                       torch.zeros_like(ids), side, side)
    return rgb[0].numpy(), alphas[0, ..., 0].numpy(), doubts.numpy(), len(ids)


# --- conic ---

def conic_run(conic, *words):
    return subprocess.run([conic, *words], check=True, capture_output=True, stdin=subprocess.DEVNULL).stdout


def read_pfm(path):
    with open(path, "rb") as file:
        kind, size = file.readline().strip(), [int(word) for word in file.readline().split()]
        order = "<" if float(file.readline()) < 0 else ">"
        data = np.frombuffer(file.read(), order + "f4")
    return data.reshape(size[1], size[0], -1)[::-1] if kind == b"PF" else data.reshape(size[1], size[0])[::-1]


def draw_by_conic(conic, path, camera, profile):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = camera["rotation"], camera["translation"]
    with open("camera.json", "w") as file:
        json.dump({"width": camera["side"], "height": camera["side"], "fx": camera["f"][0], "fy": camera["f"][1],
                   "cx": camera["c"][0], "cy": camera["c"][1], "world_to_camera": matrix.tolist()}, file)
    conic_run(conic, "render", path, "--profile", profile, "--camera", "camera.json", "--plain", "--aov",
              "rgba,T", "-o", "a.pfm")
    return read_pfm("a.pfm"), 1.0 - read_pfm("a.T.pfm").reshape(camera["side"], camera["side"])


# --- the comparison ---

def compare(conic, gsplat, name, scene, path, camera, is_full):
    """Returns how many pixels differ without a reason."""
    series = "1.5" if gsplat[0].startswith("1.5") else "1.6"
    kinds = {"": f"gsplat-{series}", "aa": f"gsplat-{series}-aa"}
    if scene["log_scale"].shape[1] == 2:
        kinds = {"discs": "2dgs-gsplat"} if series == "1.6" else {}
    n_wrong = 0
    for kind, profile in kinds.items():
        rgb, alpha, doubts, n_pairs = draw_by_gsplat(gsplat, scene, camera, kind)
        own, own_alpha = draw_by_conic(conic, path, camera, profile)
        apart = np.maximum(abs(own - rgb).max(2), abs(own_alpha - alpha)).reshape(-1)
        reasons = doubts < np.array([NEAR_DECISION, NEAR_DECISION, NEAR_DEPTH])
        over = apart > BOUND
        calm = apart[~reasons.any(1)].max()
        print(f"{name}, {camera['side']}², {profile}: {n_pairs} pairs; {over.sum()} of {len(apart)} pixels over "
              f"{BOUND}; without a near decision at most {calm:.2g}, with one {apart.max():.2g}")
        for i in np.nonzero(over)[0][:20]:
            words = [word for word, holds in zip(("1/255", "1e-4", "order"), reasons[i]) if holds]
            print(f"  ({i % camera['side']}, {i // camera['side']}) by {apart[i]:.2g}: {', '.join(words) or 'WRONG'}; "
                  f"α within {doubts[i, 0]:.2g} of 1/255, T within {doubts[i, 1]:.2g} of 1e-4, depths {doubts[i, 2]:.2g}")
        n_wrong += int((over & ~reasons.any(1)).sum())
        if is_full:
            say_float(gsplat, scene, camera, kind, own, rgb)
    return n_wrong


def say_float(gsplat, scene, camera, kind, own, in_double):
    global precision
    precision = torch.float32
    rgb = draw_by_gsplat(gsplat, scene, camera, kind)[0]
    precision = torch.float64
    for name, other in (("conic", own), ("its double", in_double)):
        apart = abs(rgb - other).max(2)
        print(f"  in float it differs from {name} by {apart.max():.2g}, in {(apart > BOUND).sum()} pixels by more than "
              f"{BOUND}")


def crop(camera, x, y, side):
    return {**camera, "side": side, "c": (camera["c"][0] - x, camera["c"][1] - y)}


def main():
    conic, folder, data = (os.path.abspath(word) for word in sys.argv[1:4])
    side = int(sys.argv[4]) if len(sys.argv) > 4 else 40
    is_full = len(sys.argv) > 5
    gsplat = load(folder)
    torch.set_grad_enabled(False)
    n_wrong = 0
    print(f"gsplat {gsplat[0]}")

    conic_run(conic, "convert", data + "/biker.spz", "-o", "biker.ply")
    scene = read_ply("biker.ply")
    shown = json.loads(conic_run(conic, "render", "biker.ply", "--size", "512x512", "-o", "b.pfm", "--json", "-"))
    shown = shown["camera"]
    whole = np.array(shown["world_to_camera"])
    camera = {"rotation": whole[:3, :3].astype(np.float32).astype(np.float64), "f": (shown["fx"], shown["fy"]),
              "translation": whole[:3, 3].astype(np.float32).astype(np.float64), "c": (shown["cx"], shown["cy"])}
    for x, y in [(208, 180), (256, 300), (150, 150), (200, 330)][:4 if is_full else 1]:
        n_wrong += compare(conic, gsplat, "biker", scene, "biker.ply", crop(camera, x, y, side), is_full)

    garden = np.load(data + "/garden.npz")
    index = np.arange(len(garden["means3d"]))
    cameras = [{"rotation": view[:3, :3].astype(np.float64), "translation": view[:3, 3].astype(np.float64),
                "f": (float(K[0, 0]), float(K[1, 1])), "c": (float(K[0, 2]), float(K[1, 2]))}
               for view, K in zip(garden["viewmats"], garden["Ks"])]
    for i_camera, camera in enumerate(cameras):
        for x, y in [(290, 220), (80, 300), (420, 60)][:3 if is_full else 1]:
            cropped = crop(camera, x, y, side)
            chosen = index[in_view(garden["means3d"], cropped, 40 if is_full else 8)]
            made = scene_of_points(garden["means3d"][chosen], garden["colors"][chosen], chosen)
            for n_scales in (3, 2):
                scene = {**made, "log_scale": made["log_scale"][:, :n_scales]}
                write_ply("garden.ply", scene)
                n_wrong += compare(conic, gsplat, f"garden, camera {i_camera}", scene, "garden.ply", cropped, is_full)
    return 1 if n_wrong else 0


if __name__ == "__main__":
    sys.exit(main())
