"""Draws a conformance suite by gsplat's own code for torch, on the CPU.

    conic conformance suite
    python3 run-gsplat.py suite pictures [GSPLAT [float32|float64]]
    conic judge --suite suite --pictures pictures --profile gsplat-1.6,gsplat-1.6-aa,2dgs-gsplat

GSPLAT is the folder that holds the package, as `pip download --no-deps gsplat` and unzip leave it; without it, the
installed one is taken. gsplat's code projects, evaluates harmonics and sums up. Which Gaussians a pixel sums, and
where it stops, is decided by CUDA in gsplat, and by `find_pairs` here; the sums along rays, which are nerfacc's, by
`accumulate_along_rays`. Only numpy and torch are needed.
"""

import importlib
import json
import os
import sys
import types

import numpy as np
import torch

LEAST_ALPHA, LEAST_T, TILE = 1.0 / 255.0, 1e-4, 16


def accumulate_along_rays(weights, values=None, ray_indices=None, n_rays=None):
    values = weights[:, None] if values is None else weights[:, None] * values
    return torch.zeros(n_rays, values.shape[1], dtype=weights.dtype).index_add_(0, ray_indices, values)


def render_weight_from_alpha(alphas, ray_indices=None, n_rays=None):
    """w = alpha * T; the pairs of a ray stand together, from the front to the back."""
    counts = torch.bincount(ray_indices, minlength=n_rays)
    place = torch.arange(len(alphas)) - (torch.cumsum(counts, 0) - counts)[ray_indices]
    rest = torch.ones(n_rays, int(counts.max()) + 1 if len(alphas) else 1, dtype=alphas.dtype)
    rest[ray_indices, place + 1] = 1.0 - alphas
    transmittance = torch.cumprod(rest, 1)[ray_indices, place]
    return alphas * transmittance, transmittance


def load_gsplat(folder):
    """gsplat without what needs CUDA."""
    for name, path in (("gsplat", "/gsplat"), ("gsplat.cuda", "/gsplat/cuda")):
        sys.modules[name] = types.ModuleType(name)
        sys.modules[name].__path__ = [folder + path]
    wrapper = sys.modules["gsplat.cuda._wrapper"] = types.ModuleType("gsplat.cuda._wrapper")
    wrapper.CameraModel = wrapper.RollingShutterType = str
    nerfacc = sys.modules["nerfacc"] = types.ModuleType("nerfacc")
    nerfacc.accumulate_along_rays, nerfacc.render_weight_from_alpha = accumulate_along_rays, render_weight_from_alpha
    version = importlib.import_module("gsplat.version").__version__
    series = "1.5" if version.startswith("1.5") else "1.6"
    profiles = {f"gsplat-{series}": "", f"gsplat-{series}-aa": "aa"}
    if series == "1.6":
        profiles["2dgs-gsplat"] = "2d"
    names = ("gsplat.cuda._torch_impl", "gsplat.cuda._torch_impl_2dgs")
    return (*(importlib.import_module(name) for name in names), profiles, 0.999 if series == "1.5" else 0.99)


def read_scene(path):
    """A .ply of 3DGS, activated, without the records that cannot be drawn."""
    data = open(path, "rb").read()
    end = data.index(b"end_header\n") + 11
    names = [line.split()[2] for line in data[:end].decode().splitlines() if line.startswith("property")]
    table = np.frombuffer(data, "<f4", offset=end).reshape(-1, len(names)).astype(np.float64)
    columns = dict(zip(names, table.T))
    def stack(start):
        n = sum(name.startswith(start) for name in names)
        return np.stack([columns[f"{start}{i}"] for i in range(n)], 1) if n else np.empty((len(table), 0))
    rest = stack("f_rest_").reshape(len(table), 3, -1).transpose(0, 2, 1)  # channel by channel
    with np.errstate(over="ignore"):
        scene = {"means": np.stack([columns[c] for c in "xyz"], 1), "quats": stack("rot_"),
                 "scales": np.exp(stack("scale_")), "opacities": 1.0 / (1.0 + np.exp(-columns["opacity"])),
                 "sh": np.concatenate((stack("f_dc_")[:, None], rest), 1)}
    scene = {name: values.astype(np.float32) for name, values in scene.items()}
    sound = (scene["quats"] != 0).any(1)
    for values in scene.values():
        sound &= np.isfinite(values.reshape(len(table), -1)).all(1)
    return {name: values[sound] for name, values in scene.items()}


def find_pairs(means2d, radii, depths, alpha_at, width, height):
    """What each pixel composites: Gaussians and pixels, by pixel, from the front to the back."""
    order = torch.sort(depths.float(), stable=True)[1]
    order = order[(radii[order] > 0).all(1)]
    low, high = torch.floor((means2d[order] - radii[order]) / TILE), torch.ceil((means2d[order] + radii[order]) / TILE)
    ids, pixels = [torch.empty(0, dtype=torch.long)], [torch.empty(0, dtype=torch.long)]
    for tile_y in range((height + TILE - 1) // TILE):
        for tile_x in range((width + TILE - 1) // TILE):
            tile = torch.tensor([tile_x, tile_y])
            here = order[((low <= tile) & (tile < high)).all(1)]
            y, x = torch.meshgrid(torch.arange(TILE * tile_y, min(TILE * (tile_y + 1), height)),
                                  torch.arange(TILE * tile_x, min(TILE * (tile_x + 1), width)), indexing="ij")
            x, y = x.reshape(-1), y.reshape(-1)
            alpha = alpha_at(here, x + 0.5, y + 0.5)  # by pixel and Gaussian
            covered = alpha >= LEAST_ALPHA
            after = torch.cumprod(1.0 - torch.where(covered, alpha, torch.zeros_like(alpha)), 1)
            kept = covered & (torch.cumsum(covered & (after <= LEAST_T), 1) == 0)
            at, which = kept.nonzero(as_tuple=True)
            ids.append(here[which])
            pixels.append((y * width + x)[at])
    pixels, by_pixel = torch.sort(torch.cat(pixels), stable=True)
    return torch.cat(ids)[by_pixel], pixels


def draw(gsplat, scene, camera, kind, background, dtype):
    three, two, _, most_alpha = gsplat
    width, height = camera["width"], camera["height"]
    def tensor(values):
        return torch.from_numpy(np.array(values, np.float64)).to(dtype)
    K = tensor([[camera["fx"], 0, camera["cx"]], [0, camera["fy"], camera["cy"]], [0, 0, 1]])[None]
    view = tensor(camera["world_to_camera"])[None]
    means, quats, scales, opacities, sh = (tensor(scene[name]) for name in
                                           ("means", "quats", "scales", "opacities", "sh"))
    eye = torch.inverse(view)[0, :3, 3]
    degree = int(round(sh.shape[1] ** 0.5)) - 1
    colors = torch.clamp_min(three._spherical_harmonics(degree, means - eye, sh) + 0.5, 0.0)
    if kind == "2d":
        scales = torch.cat((scales, torch.ones_like(scales[:, :1])), 1)
        radii, means2d, depths, form, normals = two._fully_fused_projection_2dgs(means, quats, scales, view, K, width,
                                                                                height)
    else:
        covariances, _ = three._quat_scale_to_covar_preci(quats, scales, compute_preci=False)
        radii, means2d, depths, form, compensation = three._fully_fused_projection(
            means, covariances, view, K, width, height, calc_compensations=kind == "aa")
        opacities = opacities * compensation[0] if kind == "aa" else opacities
    means2d, depths, radii, form = means2d[0], depths[0], radii[0], form[0]

    def of_ellipses(here, x, y):
        dx, dy = x[:, None] - means2d[here, 0], y[:, None] - means2d[here, 1]
        sigma = 0.5 * (form[here, 0] * dx ** 2 + form[here, 2] * dy ** 2) + form[here, 1] * dx * dy
        return torch.where(sigma >= 0, (opacities[here] * torch.exp(-sigma)).clamp(max=most_alpha), 0 * sigma)

    def of_discs(here, x, y):
        x, y = x[:, None, None].to(dtype), y[:, None, None].to(dtype)
        cross = torch.cross(-form[here, 0] + form[here, 2] * x, -form[here, 1] + form[here, 2] * y, dim=-1)
        ray = (cross[..., 0] / cross[..., 2]) ** 2 + (cross[..., 1] / cross[..., 2]) ** 2
        around = 2.0 * ((x[..., 0] - means2d[here, 0]) ** 2 + (y[..., 0] - means2d[here, 1]) ** 2)
        alpha = (opacities[here] * torch.exp(-0.5 * torch.minimum(ray, around))).clamp(max=most_alpha)
        return torch.where(cross[..., 2] != 0, alpha, torch.zeros_like(alpha))

    ids, pixels = find_pairs(means2d, radii, depths, of_discs if kind == "2d" else of_ellipses, width, height)
    values = torch.cat((colors, depths[:, None]), 1)  # depths are summed as a fourth colour
    if kind == "2d":
        sums, alphas, _ = two.accumulate_2dgs(means2d[None], form[None], opacities[None], values[None], normals, ids,
                                              pixels, torch.zeros_like(ids), width, height)
    else:
        sums, alphas = three.accumulate(means2d[None], form[None], opacities[None], values[None], ids, pixels,
                                        torch.zeros_like(ids), width, height)
    rgb = sums[0, ..., :3] + (1.0 - alphas[0]) * tensor(background)
    depth = torch.where(alphas[0, ..., 0] > 0, sums[0, ..., 3] / alphas[0, ..., 0], torch.zeros_like(sums[0, ..., 3]))
    return torch.cat((rgb, alphas[0]), 2).float().numpy(), depth.float().numpy()


def main(suite, pictures, folder=None, precision="float32"):
    if folder is None:
        folder = os.path.dirname(importlib.util.find_spec("gsplat").submodule_search_locations[0])
    gsplat = load_gsplat(folder)
    os.makedirs(pictures, exist_ok=True)
    for line in open(suite + "/cases.tsv"):
        name, scene, camera, profile, background = line.rstrip("\n").split("\t")
        if profile not in gsplat[2]:
            continue
        rgba, depth = draw(gsplat, read_scene(f"{suite}/{scene}"), json.load(open(f"{suite}/{camera}")),
                           gsplat[2][profile], [float(word) for word in background.split(",")],
                           getattr(torch, precision))
        np.save(f"{pictures}/{name}.npy", rgba)
        np.save(f"{pictures}/{name}.Z.npy", depth)


if __name__ == "__main__":
    main(*sys.argv[1:])
