"""Plants faults in examples/conformance/numpy-renderer.py and counts what conic judge says of each.

    python3 planted_faults.py SOURCE CONIC [SCENES [FAULT …]]
    python3 planted_faults.py SOURCE CONIC suite [CASE,… [FAULT …]]

A fault is a change of the renderer's text, or of its finished picture. For each: what may be said of it, by name or by
the kind of place; "" means that nothing need be said. A name besides these is a wrong name, and that is an error; of
faults that are asked for by name, so is silence where something may be said.

With "suite" each fault is drawn into the cases of a conformance suite, and one by which no case is wrong is an error."""

import json
import os
import subprocess
import sys
import tempfile
import types

import numpy as np

def listed(sigmas, length="np.ceil(np.sqrt(np.linalg.eigvalsh(covariance[i])[-1]) * %g)"):
    """Gaussians only in the tiles that a box of so many standard deviations meets."""
    length = length % sigmas if "%" in length else f"{sigmas} * {length}"
    return [("is_seen = (q >= 0)", f"r = {length}\n"
             "        at = np.stack((X, Y)) // 16 - np.floor((center[i] - r) / 16)[:, None, None]\n"
             "        n = np.ceil((center[i] + r) / 16) - np.floor((center[i] - r) / 16)\n"
             "        is_seen = ((at >= 0) & (at < n[:, None, None])).all(0) & (q >= 0)")]


# name: (what may be said first, [(text, other text) …])
IN_TEXT = {
    "dilation-0": ("dilation-0", [("+ 0.3 * np.eye(2)", "")]),
    "dilation-1": ("dilation-1", [("+ 0.3 * np.eye(2)", "+ 1.0 * np.eye(2)")]),
    "dilation-half": ("dilation-0.5", [("+ 0.3 * np.eye(2)", "+ 0.5 * np.eye(2)")]),
    "alpha-squared-weight": ("alpha-twice", [("weight = np.where(is_seen, alpha * T, F(0))",
                                   "weight = np.where(is_seen, alpha * alpha * T, F(0))")]),
    "weight-after": ("transmittance-after", [("weight = np.where(is_seen, alpha * T, F(0))",
                                              "weight = np.where(is_seen, alpha * after, F(0))")]),
    "last-batch": ("last-batch", [("        if z[i] < 0.01:", "        if z[i] < 0.01 or i >= len(z) // 64 * 64:")]),
    "lists-1-sigma": ("extent-1-sigma", listed(1)),
    "lists-2-sigma": ("extent-2-sigma", listed(2)),
    "lists-2-sigma-box": ("extent-2-sigma", listed(2, "np.sqrt(np.diag(covariance[i]))")),
    "ends-2-sigma": ("extent-2-sigma", [("is_seen = (q >= 0)", "is_seen = (q >= 0) & (q <= 2)")]),
    "focal-exchanged": ("focal-exchanged", [("(\"width\", \"height\", \"fx\", \"fy\", \"cx\", \"cy\"))",
                                             "(\"width\", \"height\", \"fy\", \"fx\", \"cx\", \"cy\"))")]),
    "background-twice": ("background-twice", [("rgb += T[..., None] *", "rgb += 2 * T[..., None] *")]),
    "background-whole": ("background-twice", [("rgb += T[..., None] *", "rgb +=")]),
    "background-forgotten": ("background-black", [("rgb += T[..., None] *", "rgb += 0 *")]),
    "background-right": ("", []),
    "no-half": ("sh-offset", [(".sum(1) + 0.5)", ".sum(1))")]),
    "sh-direction": ("sh-direction", [("directions = means + R.T @ t", "directions = -(means + R.T @ t)")]),
    "sh-not-normalised": ("sh-direction", [("directions / np.linalg.norm(directions, axis=1, keepdims=True)",
                                            "directions")]),
    "sh-camera-frame": ("sh-direction", [("directions = means + R.T @ t", "directions = means @ R.T + t")]),
    "sh-eye-is-t": ("sh-direction", [("directions = means + R.T @ t", "directions = means - t")]),
    "sh-sign-y": ("sh-sign", [("basis += [SH[1] * y,", "basis += [-SH[1] * y,")]),
    "sh-sign-xz": ("sh-sign", [("-1.0925484305920792 * x * z", "1.0925484305920792 * x * z")]),
    "half-depth-key": ("order-coarse", [("np.argsort(z.astype(F)", "np.argsort(z.astype(np.float16)")]),
    "file-order": ("order-file", [("np.argsort(z.astype(F), kind=\"stable\")", "range(len(z))")]),
    "back-to-front": ("order-reversed", [("np.argsort(z.astype(F), kind=\"stable\")",
                                          "np.argsort(z.astype(F), kind=\"stable\")[::-1]")]),
    "by-distance": ("order-distance", [("np.argsort(z.astype(F)", "np.argsort(np.linalg.norm(p, axis=1).astype(F)")]),
    "degree-0": ("sh-degree-0", [("    if degree > 0:", "    if degree > 0:\n        x, y, z = 0 * x, 0 * y, 0 * z"),
                                 ("0.31539156525252005 * (3 * z * z - 1)", "0 * z")]),
    "exp2": ("exp2", [("np.exp(-q)", "np.exp2(-q)")]),
    "q-not-halved": ("falloff-not-halved", [("q = F(0.5) * (conic", "q = F(1.0) * (conic"), ("+ conic[i, 0, 1]", "+ F(2) * conic[i, 0, 1]")]),
    "cross-half": ("cross-term", [("+ conic[i, 0, 1] * dx * dy", "+ F(0.5) * conic[i, 0, 1] * dx * dy")]),
    "cross-sign": ("cross-term", [("+ conic[i, 0, 1] * dx * dy", "- conic[i, 0, 1] * dx * dy")]),
    "alpha-min-0": ("alpha-min-0 extent-exact", [("(alpha >= F(1 / 255))", "(alpha >= F(0))")]),
    "alpha-max-1": ("alpha-max-1 alpha-max-0.999", [("np.exp(-q), F(0.99))", "np.exp(-q), F(1.0))")]),
    "negative-colours": ("colours-not-clamped", [("return np.maximum(np.stack(channels, 1), 0.0)",
                                                  "return np.stack(channels, 1)")]),
    "colours-to-1": ("colours-clamped", [("return np.maximum(np.stack(channels, 1), 0.0)",
                                          "return np.clip(np.stack(channels, 1), 0.0, 1.0)")]),
    "z-not-over-a": ("z-not-divided plane", [("depth = np.where(alpha > 0, depth / np.where(alpha > 0, alpha, 1), 0)",
                                              "pass")]),
    "quaternion-xyzw": ("quaternion-xyzw", [("w, x, y, z = (q /", "x, y, z, w = (q /")]),
    "quaternion-conjugate": ("quaternion-conjugate", [("w, x, y, z = (q /", "w, x, y, z = np.array([1,-1,-1,-1])[:,None] * (q /")]),
    "scale-swapped": ("scale-order", [("ply[f\"scale_{k}\"] for k in range(3)", "ply[f\"scale_{k}\"] for k in (1, 0, 2)")]),
    "scale-half": ("scale-factor", [("covariance = M @", "M = M * 0.5\n    covariance = M @")]),
    "no-world-rotation": ("view-rotation", [("M = J.reshape(-1, 2, 3) @ R @", "M = J.reshape(-1, 2, 3) @")]),
    "jacobian-sign": ("jacobian-sign", [("-fx * slope_x", "fx * slope_x"), ("-fy * slope_y", "fy * slope_y")]),
    "no-jacobian-z": ("", [("-fx * slope_x", "0 * slope_x"), ("-fy * slope_y", "0 * slope_y")]),
    "flipped-cy": ("centre-flipped centre-ignored", [("(\"width\", \"height\", \"fx\", \"fy\", \"cx\", \"cy\"))",
                                      "(\"width\", \"height\", \"fx\", \"fy\", \"cx\", \"cy\"))\n    cy = height - cy")]),
    "focal-1.02": ("focal-length", [("(\"width\", \"height\", \"fx\", \"fy\", \"cx\", \"cy\"))",
                         "(\"width\", \"height\", \"fx\", \"fy\", \"cx\", \"cy\"))\n    fx = fy = 1.02 * fx")]),
    "half-pixel": ("half-pixel", [("np.arange(width, dtype=F) + F(0.5)", "np.arange(width, dtype=F)"),
                                  ("np.arange(height, dtype=F) + F(0.5)", "np.arange(height, dtype=F)")]),
    "half-accumulation": ("", [("rgb += weight[..., None] * colors[i]",
                                "rgb = (rgb + weight[..., None] * colors[i]).astype(np.float16).astype(F)")]),
    "batches-dropped": ("", [("z.astype(F), kind=\"stable\")", "z.astype(F), kind=\"stable\")[:64]")]),
    "one-dropped": ("", [("z.astype(F), kind=\"stable\")", "z.astype(F), kind=\"stable\")[np.arange(len(z)) != 70]")]),
    "opacity-linear": ("opacity-linear", [("(1.0 / (1.0 + np.exp(-ply[\"opacity\"])))", "np.clip(ply[\"opacity\"], 0, 1)")]),
    "over-16-tiles-dropped": ("", [("        if z[i] < 0.01:", "        r = 3.33 * np.sqrt(np.diag(covariance[i]))\n"
                                   "        tiles = [-(-width // 16), -(-height // 16)]\n"
                                   "        across = np.clip(np.ceil((center[i] + r) / 16), 0, tiles) - np.clip("
                                   "np.floor((center[i] - r) / 16), 0, tiles)\n"
                                   "        if z[i] < 0.01 or across.prod() > 16:")]),
    "clamped-about-middle": ("", [("-(cx + 0.15 * width) / fx, (width - cx + 0.15 * width) / fx",
                                   "-0.65 * width / fx, 0.65 * width / fx"),
                                  ("-(cy + 0.15 * height) / fy, (height - cy + 0.15 * height) / fy",
                                   "-0.65 * height / fy, 0.65 * height / fy")]),
    "not-clamped": ("", [("np.clip(x / z_safe,", "np.maximum(np.minimum(x / z_safe, 1e9), -1e9) + 0 * np.clip(x,"),
                         ("np.clip(y / z_safe,", "np.maximum(np.minimum(y / z_safe, 1e9), -1e9) + 0 * np.clip(y,")]),
    "compensated": ("gsplat-1.6-aa gsplat-1.5-aa", [("opacities = (1.0", "opacities0 = (1.0"), ("conic = np.linalg.inv", "opacities = (opacities0 * np.sqrt(np.maximum(0, np.linalg.det(covariance - 0.3 * np.eye(2)) / np.linalg.det(covariance)))).astype(F)\n    conic = np.linalg.inv")]),
}


def at_tile(rgba, size, value=0.0):
    h, w = rgba.shape[:2]
    weight = rgba[..., 3]
    sums = {(y, x): weight[y * size:(y + 1) * size, x * size:(x + 1) * size].sum()
            for y in range(h // size) for x in range(w // size)}
    y, x = max(sums, key=sums.get)
    rgba[y * size:(y + 1) * size, x * size:(x + 1) * size] = value


def edit(change):
    def f(rgba, depth):
        change(rgba, depth)
        return rgba, depth
    return f


def last_row(rgba, _):
    rgba[-16:] = 0


def every_third(rgba, _):
    rgba[::3] = 0


def nan_at(rgba, _):
    rgba[20, 30, 1] = np.nan
    rgba[21, 30, 1] = np.inf


def checkers(rgba, _):
    rgba[::2, ::2] = 0
    rgba[1::2, 1::2] = 0


def tiles_from_100(rgba, depth):
    y, x = np.mgrid[:rgba.shape[0], :rgba.shape[1]]
    beyond = y // 16 * -(-rgba.shape[1] // 16) + x // 16 >= 100
    rgba[beyond] = depth[beyond] = 0


def srgb(x):
    x = np.maximum(x, 0)
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


# name: (what may be said, change of (rgba, depth))
IN_PICTURE = {
    "black-tile-16": ("tile", edit(lambda p, z: at_tile(p, 16))),
    "black-tile-8": ("tile", edit(lambda p, z: at_tile(p, 8))),
    "garbage-tile-16": ("tile", edit(lambda p, z: at_tile(p, 16, 0.37))),
    "last-row-of-tiles": ("row border half", edit(last_row)),
    "tiles-from-100-dropped": ("", edit(tiles_from_100)),
    "last-column": ("border column", edit(lambda p, z: p.__setitem__((slice(None), slice(-1, None)), 0.0))),
    "lower-half": ("half", edit(lambda p, z: p.__setitem__(slice(p.shape[0] // 2, None), 0.0))),
    "every-third": ("every", edit(every_third)),
    "every-fifth-column": ("every", edit(lambda p, z: p.__setitem__((slice(None), slice(2, None, 5)), 0.0))),
    "nan": ("nan", edit(nan_at)),
    "checkers": ("checkerboard", edit(checkers)),
    "bgr": ("bgr", lambda p, z: (p[..., [2, 1, 0, 3]], z)),
    "shift-1px": ("shifted", lambda p, z: (np.roll(p, 1, 1), np.roll(z, 1, 1))),
    "shift-up": ("shifted", lambda p, z: (np.roll(p, -1, 0), np.roll(z, -1, 0))),
    "alpha-1": ("plane", edit(lambda p, z: p.__setitem__((Ellipsis, 3), 1.0))),
    "green-only": ("channel", edit(lambda p, z: p.__setitem__((Ellipsis, 1), 0.9 * p[..., 1]))),
    "depth-only": ("plane", edit(lambda p, z: z.__imul__(1.01))),
    "clipped": ("clipped colours-clamped", edit(lambda p, z: np.clip(p, 0, 1, out=p))),
    "mirrored-x": ("mirrored-x", lambda p, z: (p[:, ::-1], z[:, ::-1])),
    "mirrored-y": ("mirrored-y", lambda p, z: (p[::-1], z[::-1])),
    "srgb-decoded": ("srgb-decoded", edit(lambda p, z: p.__setitem__((Ellipsis, slice(3)), srgb(p[..., :3])))),
    "over-white": ("background-white", edit(lambda p, z: p.__setitem__(
        (Ellipsis, slice(3)), p[..., :3] + (1 - p[..., 3:])))),
    "premultiplied": ("premultiplied", edit(lambda p, z: p.__setitem__(
        (Ellipsis, slice(3)), p[..., :3] * p[..., 3:]))),
    "gain-1.1": ("", edit(lambda p, z: p.__setitem__((Ellipsis, slice(3)), 1.1 * p[..., :3]))),
    "previous-frame": ("", None),
    "right": ("", lambda p, z: (p, z)),
}


def make_scene(conic, path, seed):
    """A made scene of bright colours: some are above 1, and some negative."""
    subprocess.run([conic, "make", "gaussians", "-n", "150", "--seed", str(seed), "-o", path, "--quiet"], check=True)
    data = open(path, "rb").read()
    end = data.index(b"end_header\n") + 11
    names = [line.split()[2] for line in data[:end].decode().splitlines() if line.startswith("property")]
    table = np.frombuffer(data, "<f4", offset=end).reshape(-1, len(names)).copy()
    for column, name in enumerate(names):
        table[:, column] *= 1.8 if name.startswith("f_") else 1.0
    open(path, "wb").write(data[:end] + table.tobytes())


def renderer(source, changes):
    text = open(source + "/examples/conformance/numpy-renderer.py").read()
    for old, new in changes:
        if old not in text:
            sys.exit(f"the renderer has no {old!r} any more")
        text = text.replace(old, new)
    module = types.ModuleType("renderer")
    exec(compile(text, "renderer", "exec"), module.__dict__)
    return module


def look(i, turn=0.0):
    a, b = 0.3 + 1.1 * i + turn, 0.2 - 0.1 * i
    back = np.array([np.sin(a) * np.cos(b), np.sin(b), np.cos(a) * np.cos(b)])
    forward, up = -back, np.array([0.0, 1.0, 0.0])
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    R = np.stack([right, np.cross(forward, right), forward])
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = R, -R @ (back * (3.4 + 0.3 * i))
    return {"width": 64 + 16 * (i % 2), "height": 48, "fx": 55.0 + 3 * i, "fy": 54.0 + 3 * i, "cx": 32.0 + 2.5 * i,
            "cy": 24.0 - 1.7 * i, "world_to_camera": view.tolist()}


def judged(conic, work, camera, background, rgba, depth):
    np.savez(work + "/p.npz", rgba=rgba.astype(np.float32), Z=depth.astype(np.float32))
    json.dump(camera, open(work + "/c.json", "w"))
    got = subprocess.run([conic, "judge", work + "/s.ply", "--camera", work + "/c.json", "--profile", "gsplat-1.6",
                          *(["--background", ",".join(map(str, background))] if any(background) else []), "--picture", work + "/p.npz", "--json", "-"], capture_output=True, text=True)
    if got.returncode not in (0, 1):
        sys.exit(got.stderr)
    return json.loads(got.stdout)


def is_wrong(suite, case, scene, rgba, depth):
    """As the suite's README has it."""
    _, _, _, least, most = np.load(f"{suite}/{case['npy']}")
    step = scene.get("step", 1)
    values = np.concatenate((rgba, depth[..., None]), 2)[step // 2::step, step // 2::step]
    wrong = ~((values >= least) & (values <= most))
    if any(scene["background"]):
        wrong[..., 3] &= values[..., 3] != 1
    return wrong.any()


def turned(camera):
    a = 0.02
    turn = np.array([[np.cos(a), 0, np.sin(a), 0], [0, 1, 0, 0], [-np.sin(a), 0, np.cos(a), 0], [0, 0, 0, 1]])
    return {**camera, "world_to_camera": (turn @ np.array(camera["world_to_camera"])).tolist()}


def fails(source, suite, cases, scenes, how):
    """The first case that is wrong with a fault; None."""
    module = renderer(source, how if isinstance(how, list) else [])
    for case in cases:
        scene = scenes[case["scene"]]
        camera = json.load(open(f"{suite}/{scene['camera']['conic']}"))
        ply = module.read_ply(f"{suite}/{scene['files']['ply']}")
        rgba, depth = module.draw(ply, turned(camera) if how is None else camera, scene["background"])
        try:
            rgba, depth = how(rgba, depth) if callable(how) else (rgba, depth)
        except (IndexError, ValueError):  # the picture is too small for it
            continue
        if is_wrong(suite, case, scene, rgba, depth):
            return case["name"]
    return None


def in_suite(source, conic, names="", *only):
    n_unseen = 0
    with tempfile.TemporaryDirectory() as suite, np.errstate(all="ignore"):
        subprocess.run([conic, "conformance", suite, "--profile", "gsplat-1.6", "--quiet"], check=True)
        manifest = json.load(open(suite + "/manifest.json"))
        scenes = {scene["name"]: scene for scene in manifest["scenes"]}
        cases = [case for case in manifest["cases"] if not names or case["scene"] in names.split(",")]
        cases.sort(key=lambda case: scenes[case["scene"]]["width"] * scenes[case["scene"]]["height"] *
                   scenes[case["scene"]]["records"])
        for name, (_, how) in {**IN_TEXT, **IN_PICTURE}.items():
            if not only or name in only:
                found = fails(source, suite, cases, scenes, how)
                n_unseen += (found is None) != (name == "right")
                print(f"{name:24} {found}", flush=True)
    return n_unseen > 0


def main(source, conic, scenes="5", *only):
    if scenes == "suite":
        return in_suite(source, conic, *only)
    n_silent = 0
    counts = {"rightly": 0, "wrong": 0, "none": 0, "unseen": 0}
    seconds = 0.0
    with tempfile.TemporaryDirectory() as work, np.errstate(all="ignore"):
        for name, (may, how) in {**IN_TEXT, **IN_PICTURE}.items():
            if only and name not in only:
                continue
            tally = []
            for i in range(int(scenes)):
                make_scene(conic, work + "/s.ply", i + 1)
                camera = look(i)
                background = [0.3, 0.6, 0.1] if name.startswith("background-") else [0, 0, 0]
                module = renderer(source, how if isinstance(how, list) else [])
                ply = module.read_ply(work + "/s.ply")
                rgba, depth = module.draw(ply, look(i, 0.02) if how is None else camera, background)
                if callable(how):
                    rgba, depth = how(rgba, depth)
                if any(background):
                    rgba[..., 3] = 1
                found = judged(conic, work, camera, background, rgba, depth)
                seconds += found["seconds"]["total"]
                said = [d["name"] for d in found["diagnosis"]]
                said += [d["kind"] for d in found.get("where", [])]
                if found["verdict"] != "wrong":
                    kind = "unseen"
                elif any(word in may.split() for word in said[:1]) or any(
                        d["kind"] in may.split() for d in found.get("where", [])):
                    kind = "rightly"
                elif found["diagnosis"]:
                    kind = "wrong"
                else:
                    kind = "none"
                counts[kind] += 1
                n_silent += bool(only and may and kind != "rightly")
                near = [d["name"] for d in found.get("nearest", [])]
                tally.append(kind + (f"({'+'.join(said[:2])})" if said else f"[{'+'.join(near)}]" if near else ""))
            print(f"{name:22} {' '.join(tally)}", flush=True)
    print(" ".join(f"{kind} {n}" for kind, n in counts.items()), f"in {seconds:.1f} s")
    return counts["wrong"] > 0 or n_silent > 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
