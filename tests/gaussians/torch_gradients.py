"""Derivatives by gsplat's own code for torch and its automatic differentiation, in double, beside conic's, for
torch.sh and docs/notes/gradient-measured.md.

torch_gradients.py CONIC GSPLAT DATA [SIDE]: of random200.npz, and of a crop of SIDE pixels (40) of biker, by the gsplat
in the folder GSPLAT. CONIC is the program. torch_pictures.py says what of gsplat is used, and what stands for the rest.
"""

import json
import os
import subprocess
import sys

import numpy as np
import torch

import torch_pictures as pictures

BOUND = 1e-9  # of the largest number of a kind, and of each number
LEAST_SHARE = 1 / 20  # of what the judge allows floats, that floats of some scene use: else it allows too much
LEAST = 1.0 / 255.0
greatest_shares = {}


def eye_of(view):
    """As profiles have it: -R^T t rounded to float; by automatic differentiation, the inverse's."""
    inverse = torch.inverse(view)[:3, 3]
    rounded = (-view[:3, :3].T @ view[:3, 3]).float().to(view.dtype)
    return inverse + (rounded - inverse).detach()


def pairs_of(means2d, radii, form, opacities, depths, side, most):
    """The pairs that are composited, pixel by pixel in the order of depth."""
    order = torch.sort(depths.float(), stable=True)[1]
    order = order[(radii[order] > 0).all(1)]  # beyond these α is below its least
    ids, pixels = [], []
    for y in range(side):
        x = torch.arange(side)
        dx = (x + 0.5)[:, None] - means2d[order, 0]
        dy = y + 0.5 - means2d[order, 1]
        sigma = 0.5 * (form[order, 0] * dx ** 2 + form[order, 2] * dy ** 2) + form[order, 1] * dx * dy
        alpha = torch.where(sigma >= 0, (opacities[order] * torch.exp(-sigma)).clamp(max=most), torch.zeros_like(sigma))
        covered = alpha >= LEAST
        after = torch.cumprod(1.0 - torch.where(covered, alpha, torch.zeros_like(alpha)), 1)
        at, which = (covered & (torch.cumsum(covered & (after <= 1e-4), 1) == 0)).nonzero(as_tuple=True)
        ids.append(order[which])
        pixels.append(y * side + at)
    return torch.cat(ids), torch.cat(pixels)


def differentiate(gsplat, scene, camera, kind, weights, precision=torch.float64):
    """dL/d(…) as conic names them."""
    _, three, _ = gsplat
    side = camera["side"]
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = camera["rotation"], camera["translation"]
    leaves = {"K": np.array([[camera["f"][0], 0, camera["c"][0]], [0, camera["f"][1], camera["c"][1]], [0, 0, 1]]),
              "view": view, **scene}
    leaves = {name: torch.from_numpy(np.ascontiguousarray(value).astype(np.float64)).to(precision).requires_grad_()
              for name, value in leaves.items()}
    degree = int(round(leaves["sh"].shape[1] ** 0.5)) - 1
    colors = torch.clamp_min(
        three._spherical_harmonics(degree, leaves["mean"] - eye_of(leaves["view"]), leaves["sh"]) + 0.5, 0.0)
    covars, _ = three._quat_scale_to_covar_preci(leaves["rotation"], leaves["scale"], compute_preci=False)
    radii, means2d, depths, form, compensation = three._fully_fused_projection(
        leaves["mean"], covars, leaves["view"][None], leaves["K"][None], side, side, calc_compensations=kind == "aa")
    opacities = leaves["opacity"] * compensation[0] if kind == "aa" else leaves["opacity"]
    most = 0.999 if gsplat[0].startswith("1.5") else 0.99
    with torch.no_grad():
        ids, pixels = pairs_of(means2d[0], radii[0], form[0], opacities, depths[0], side, most)
    values = torch.cat((colors, depths[0][:, None]), 1)
    sums, alphas = three.accumulate(means2d, form, opacities[None], values[None], ids, pixels, torch.zeros_like(ids),
                                    side, side)
    sums, alphas = sums[0], alphas[0, ..., 0]
    is_there = alphas.detach() > 0
    z = torch.where(is_there, sums[..., 3] / torch.where(is_there, alphas, torch.ones_like(alphas)),
                    torch.zeros_like(alphas))
    W = torch.from_numpy(weights).to(precision)
    loss = (W[..., :3] * sums[..., :3]).sum() + (W[..., 3] * alphas).sum() + (W[..., 4] * z).sum()
    means2d.retain_grad()
    loss.backward()
    made = {name: leaf.grad.numpy() for name, leaf in leaves.items()}
    made["place"] = means2d.grad[0].numpy()
    return loss.item(), made, len(ids)


def read_gradient(path):
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + 11
    types = {"double": "<f8", "uint": "<u4"}
    lines = [line.split() for line in data[:end].decode().splitlines() if line.startswith("property")]
    table = np.frombuffer(data, [(name, types[kind]) for _, kind, name in lines], offset=end)
    def columns(start):
        return np.stack([table[name] for _, _, name in lines if name.startswith(start)], 1)
    dc, rest = columns("f_dc"), [name for _, _, name in lines if name.startswith("f_rest")]
    sh = dc[:, None]
    if rest:
        sh = np.concatenate((sh, columns("f_rest").reshape(len(table), 3, -1).transpose(0, 2, 1)), 1)
    return {"mean": np.stack([table[axis] for axis in "xyz"], 1), "sh": sh, "opacity": table["opacity"],
            "scale": columns("scale"), "rotation": columns("rot"), "place": columns("place")}


def by_conic(conic, path, camera, profile, weights, raw):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = camera["rotation"], camera["translation"]
    with open("camera.json", "w") as file:
        json.dump({"width": camera["side"], "height": camera["side"], "fx": camera["f"][0], "fy": camera["f"][1],
                   "cx": camera["c"][0], "cy": camera["c"][1], "world_to_camera": matrix.tolist()}, file)
    np.save("weights.npy", weights)
    words = ["gradient", path, "--profile", profile, "--camera", "camera.json", "--weights", "weights.npy",
             "-o", "gradient.ply", "--json", "gradient.json", "--no-doubts"]
    pictures.conic_run(conic, *words, *(["--raw"] if raw else []))
    made = read_gradient("gradient.ply")
    with open("gradient.json") as file:
        told = json.load(file)
    made["view"] = np.array(told["camera"]["world_to_camera"])
    made["K"] = np.array([told["camera"][name] for name in ("fx", "fy", "cx", "cy")])
    return told["loss"], made


def compare(name, conic, gsplat, scene, path, camera):
    """Returns how many kinds of numbers differ by more than the bound."""
    series = "1.5" if gsplat[0].startswith("1.5") else "1.6"
    weights = np.random.default_rng(5).standard_normal((camera["side"], camera["side"], 5))
    n_wrong = 0
    for kind in ("", "aa"):
        profile = f"gsplat-{series}" + ("-aa" if kind else "")
        loss, theirs, n_pairs = differentiate(gsplat, scene, camera, kind, weights)
        own_loss, own = by_conic(conic, path, camera, profile, weights, False)
        theirs["K"] = theirs["K"][[0, 1, 0, 1], [0, 1, 2, 2]]
        theirs["view"][3] = 0.0  # which the inverse has, and no picture
        apart = {"loss": abs(loss - own_loss) / abs(loss)}
        for what in ("mean", "scale", "rotation", "opacity", "sh", "place", "view", "K"):
            greatest = abs(theirs[what]).max()
            apart[what] = (abs(own[what] - theirs[what]) / (1e-3 * greatest + abs(theirs[what]))).max()
        raw = by_conic(conic, path, camera, profile, weights, True)[1]
        o = scene["opacity"].astype(np.float64)
        for what, chain in (("scale", scene["scale"].astype(np.float64)), ("opacity", o * (1 - o))):
            expected = theirs[what] * chain
            apart["raw " + what] = (abs(raw[what] - expected) / (1e-3 * abs(expected).max() + abs(expected))).max()
        over = {what: value for what, value in apart.items() if not value <= BOUND}
        n_wrong += len(over)
        n_wrong += judge_floats(conic, gsplat, scene, path, camera, kind, profile, weights)
        print(f"{name}, {camera['side']}², {profile}, {n_pairs} pairs: " +
              ", ".join(f"{what} {value:.1e}" for what, value in apart.items()) + (f"; WRONG: {over}" if over else ""))
    return n_wrong


def judge_floats(conic, gsplat, scene, path, camera, kind, profile, weights):
    """The same in floats, as conic judge --gradients has it; how often that calls it wrong, or a mistake in it right."""
    made = differentiate(gsplat, scene, camera, kind, weights, torch.float32)[1]
    made = {name: made[key] for name, key in (("means", "mean"), ("scales", "scale"), ("quats", "rotation"),
                                              ("opacities", "opacity"), ("sh", "sh"))}
    np.savez("floats.npz", **made)
    words = [conic, "judge", path, "--profile", profile, "--camera", "camera.json", "--weights", "weights.npy"]
    right = subprocess.run([*words, "--gradients", "floats.npz", "--json", "judged.json"], capture_output=True, text=True)
    print(right.stdout + right.stderr, end="")
    with open("judged.json") as file:
        shares = {name: about["share_of_bound"] for name, about in json.load(file)["kinds"].items()}
    for name, share in shares.items():
        greatest_shares[name] = max(share, greatest_shares.get(name, 0.0))
    print("  shares " + ", ".join(f"{name} {share:.3f}" for name, share in shares.items()))
    for key in made:
        i = np.unravel_index(abs(made[key]).argmax(), made[key].shape)
        made[key][i] *= 1.01
    np.savez("wrong.npz", **made)
    wrong = subprocess.run([*words, "--gradients", "wrong.npz", "--json", "wrong.json"], capture_output=True)
    with open("wrong.json") as file:
        found = [about["wrong"] for about in json.load(file)["kinds"].values()]
    print(f"  one number of a kind off by 1 %: wrong Gaussians {found}")
    return int(right.returncode != 0) + int(wrong.returncode != 1)


def main():
    conic, folder, data = (os.path.abspath(word) for word in sys.argv[1:4])
    side = int(sys.argv[4]) if len(sys.argv) > 4 else 40
    gsplat = pictures.load(folder)
    print(f"gsplat {gsplat[0]}, relative differences")

    r = np.load(data + "/random200.npz")
    stored = {"mean": r["means"], "sh": r["sh"], "logit": np.log(r["opac"] / (1 - r["opac"])).astype(np.float32),
              "log_scale": np.log(r["scales"]).astype(np.float32), "rotation": r["quats"]}
    pictures.write_ply("random.ply", stored)
    camera = {"rotation": r["viewmat"][:3, :3].astype(np.float64), "translation": r["viewmat"][:3, 3].astype(np.float64),
              "f": tuple(r["K"][:2]), "c": tuple(r["K"][2:]), "side": 64}
    n_wrong = compare("random200", conic, gsplat, activated(stored, conic, "random.ply"), "random.ply", camera)

    pictures.conic_run(conic, "convert", data + "/biker.spz", "-o", "biker.ply")
    stored = pictures.read_ply("biker.ply")
    shown = json.loads(pictures.conic_run(conic, "render", "biker.ply", "--size", "512x512", "-o", "b.pfm", "--json",
                                          "-"))["camera"]
    whole = np.array(shown["world_to_camera"])
    camera = {"rotation": whole[:3, :3], "translation": whole[:3, 3], "f": (shown["fx"], shown["fy"]),
              "c": (shown["cx"] - 208, shown["cy"] - 180), "side": side}
    n_wrong += compare("biker", conic, gsplat, activated(stored, conic, "biker.ply"), "biker.ply", camera)
    too_wide = [name for name, share in greatest_shares.items() if share < LEAST_SHARE]
    if too_wide:
        print(f"floats may be off by more than 20 times as much as they ever are: {too_wide}")
    return 1 if n_wrong or too_wide else 0


def activated(stored, conic, path):
    """The floats that conic makes of what a file stores."""
    scale = np.exp(stored["log_scale"].astype(np.float64)).astype(np.float32)
    opacity = (1.0 / (1.0 + np.exp(-stored["logit"].astype(np.float64)))).astype(np.float32)
    return {"mean": stored["mean"], "sh": stored["sh"], "rotation": stored["rotation"], "scale": scale,
            "opacity": opacity}


if __name__ == "__main__":
    sys.exit(main())
