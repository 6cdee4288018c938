#!/usr/bin/env python3
"""A scene with the numbers that a program draws: many round what a file holds before anything is drawn.

  stored.py PROGRAM SCENE.ply|SCENE.splat CAMERA.json OUT.glb [ORDER.json]

PROGRAM is one of the functions below; CAMERA is conic's, since colours are often rounded after their harmonics are
summed up, which depends on the eye. OUT has harmonics of degree 0, so that `conic judge OUT --profile …` tells rules
of drawing from rules of storing. ORDER is a list of the Gaussians from the back to the front, as the program sorted
them: OUT has them from the front, so that the judge can tell that they were drawn in the order of the
file. Each function names the lines that it repeats.
"""
import json
import pathlib
import struct
import sys

import numpy as np

F = np.float32
C0 = F(0.28209479177387814)


def read(path):
    """Means, linear scales, quaternions w x y z as they are, linear opacities (in double), harmonics (by Gaussian, number, channel)."""
    if str(path).endswith(".splat"):
        data = np.fromfile(path, [("mean", "<f4", 3), ("scale", "<f4", 3), ("rgba", "u1", 4), ("rotation", "u1", 4)])
        rgba = data["rgba"] / F(255)
        return {"mean": data["mean"], "scale": data["scale"], "opacity": rgba[:, 3],
                "rotation": (data["rotation"].astype(F) - 128) / 128, "sh": ((rgba[:, :3] - F(0.5)) / C0)[:, None]}
    data = pathlib.Path(path).read_bytes()
    end = data.index(b"end_header\n") + 11
    names = [line.split()[2] for line in data[:end].decode().splitlines() if line.startswith("property")]
    table = np.frombuffer(data, "<f4", offset=end).reshape(-1, len(names)).T
    columns = dict(zip(names, table))
    n_rest = sum(name.startswith("f_rest_") for name in names) // 3
    sh = np.stack([columns[f"f_dc_{c}"] for c in range(3)] + [columns[f"f_rest_{k}"] for k in range(3 * n_rest)], 1)
    sh = np.concatenate((sh[:, None, :3], sh[:, 3:].reshape(len(sh), 3, n_rest).transpose(0, 2, 1)), 1)
    return {"mean": np.stack([columns[c] for c in "xyz"], 1), "sh": sh,
            "scale": np.exp(np.stack([columns[f"scale_{k}"] for k in range(3)], 1).astype(float)).astype(F),
            "rotation": np.stack([columns[f"rot_{k}"] for k in range(4)], 1),
            "opacity": 1 / (1 + np.exp(-columns["opacity"].astype(float)))}


def write(path, scene):
    """KHR_gaussian_splatting: all numbers are floats as they are."""
    keep = scene["opacity"] > 0
    color = (scene["color"] - F(0.5)) / C0
    arrays = [("POSITION", scene["mean"]), ("KHR_gaussian_splatting:ROTATION", scene["rotation"][:, [1, 2, 3, 0]]),
              ("KHR_gaussian_splatting:SCALE", scene["scale"]),
              ("KHR_gaussian_splatting:OPACITY", scene["opacity"][:, None]),
              ("KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", color)]
    views, accessors, names, blob = [], [], {}, b""
    for name, values in arrays:
        values = np.ascontiguousarray(values[keep], "<f4")
        names[name] = len(views)
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": values.nbytes})
        kind = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}[values.shape[1]]
        accessors.append({"bufferView": len(accessors), "componentType": 5126, "count": len(values), "type": kind,
                          "min": values.min(0).tolist(), "max": values.max(0).tolist()})
        blob += values.tobytes()
    splats = {"kernel": "ellipse", "colorSpace": "srgb_rec709_display"}
    text = json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_gaussian_splatting"], "scene": 0,
        "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "buffers": [{"byteLength": len(blob)}],
        "bufferViews": views, "accessors": accessors,
        "meshes": [{"primitives": [{"mode": 0, "attributes": names,
                                    "extensions": {"KHR_gaussian_splatting": splats}}]}]}).encode()
    text += b" " * (-len(text) % 4)
    pathlib.Path(path).write_bytes(
        struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(blob), len(text), 0x4E4F534A) + text
        + struct.pack("<II", len(blob), 0x004E4942) + blob)


def directions(scene, eye):
    d = (scene["mean"] - eye.astype(F)).astype(F)
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def harmonics(sh, d):
    """What degrees 1 to 3 add, in the usual order."""
    x, y, z = d.T.astype(float)
    xx, yy, zz = x * x, y * y, z * z
    bases = [-0.4886025119029199 * y, 0.4886025119029199 * z, -0.4886025119029199 * x,
             1.0925484305920792 * x * y, -1.0925484305920792 * y * z, 0.31539156525252005 * (2 * zz - xx - yy),
             -1.0925484305920792 * x * z, 0.5462742152960396 * (xx - yy),
             -0.5900435899266435 * y * (3 * xx - yy), 2.890611442640554 * x * y * z,
             -0.4570457994644658 * y * (4 * zz - xx - yy), 0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy),
             -0.4570457994644658 * x * (4 * zz - xx - yy), 1.445305721320277 * z * (xx - yy),
             -0.5900435899266435 * x * (xx - 3 * yy)]
    return sum((sh[:, k].astype(float) * bases[k][:, None] for k in range(sh.shape[1])), np.zeros((len(sh), 3))).astype(F)


def half(x, bits=11):
    """To 16 bits; 10 bits: cut off towards zero (what is beyond 16 bits is left alone: no scene here has it)."""
    if bits == 11:
        return np.asarray(x, F).astype(np.float16).astype(F)
    cut = (np.asarray(x, F).view(np.uint32) & np.uint32(0xFFFFE000)).view(F)
    return np.where(np.abs(x) < 2.0 ** -14, np.trunc(np.asarray(x, float) * 2.0 ** 24) / 2.0 ** 24, cut).astype(F)


def unit(q):
    q = (q / np.linalg.norm(q, axis=1, keepdims=True)).astype(F)
    return np.where(q[:, :1] < 0, -q, q)


def matrices(q):
    w, x, y, z = q.T.astype(float)
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                     2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1).reshape(-1, 3, 3)


def covariances(scene, rotation):
    rows = matrices(rotation) * scene["scale"][:, None, :].astype(float)
    return rows @ rows.transpose(0, 2, 1)


def of_covariances(scene, sigma):
    """Scales and quaternions of rounded covariances."""
    values, axes = np.linalg.eigh(sigma)
    axes[np.linalg.det(axes) < 0, :, 0] *= -1
    w = np.sqrt(np.maximum(0, 1 + axes[:, 0, 0] + axes[:, 1, 1] + axes[:, 2, 2])) / 2
    q = np.empty((len(sigma), 4))
    for i, (m, s) in enumerate(zip(axes, w)):
        if s > 0.1:
            q[i] = s, (m[2, 1] - m[1, 2]) / (4 * s), (m[0, 2] - m[2, 0]) / (4 * s), (m[1, 0] - m[0, 1]) / (4 * s)
        else:
            k = int(np.argmax(np.diag(m)))
            a, b = (k + 1) % 3, (k + 2) % 3
            r = np.sqrt(1 + m[k, k] - m[a, a] - m[b, b]) / 2
            q[i, 0], q[i, 1 + k] = (m[b, a] - m[a, b]) / (4 * r), r
            q[i, 1 + a], q[i, 1 + b] = (m[a, k] + m[k, a]) / (4 * r), (m[b, k] + m[k, b]) / (4 * r)
    scene.update(scale=np.sqrt(np.maximum(values, 0)).astype(F), rotation=unit(q))


def dilate(scene, sigma, camera, h):
    """Covariances that are seen larger by h px²: the least ones that are, by the Jacobian at the mean. Gives where the means
    are (1 is the picture's border) and the covariances that are seen."""
    view = np.array(camera["world_to_camera"], float)
    x, y, z = (scene["mean"].astype(float) @ view[:3, :3].T + view[:3, 3]).T
    rows = np.zeros((len(z), 2, 3))
    rows[:, 0, 0], rows[:, 0, 2] = camera["fx"] / z, -camera["fx"] * x / z ** 2
    rows[:, 1, 1], rows[:, 1, 2] = camera["fy"] / z, -camera["fy"] * y / z ** 2
    back = np.linalg.pinv(rows @ view[:3, :3])
    of_covariances(scene, sigma + h * back @ back.transpose(0, 2, 1))
    two = rows @ view[:3, :3] @ sigma @ (rows @ view[:3, :3]).transpose(0, 2, 1) + h * np.eye(2)
    return np.maximum(np.abs(2 * camera["fx"] / camera["width"] * x), np.abs(2 * camera["fy"] / camera["height"] * y)) / z, two


def splat(scene, eye, camera):
    """antimatter15/splat, main.js:382-414: quaternions as they are; four times the covariance cut off to 16 bits."""
    sigma = half(4 * covariances(scene, scene["rotation"]), 10) / 4.0
    of_covariances(scene, np.tril(sigma) + np.tril(sigma, -1).transpose(0, 2, 1))
    scene["color"] = scene["sh"][:, 0] * C0 + F(0.5)


def gs3d(scene, eye, camera):
    """GaussianSplats3D, INRIAV1PlyParser.js:130-152: colours and opacities of 8 bits, cut off;
    harmonics up to degree 2, cut off to 16 bits (SplatMesh.js:1065); SplatMesh.js:942-945: the
    last Gaussian of a scene keeps the first of its six covariances and loses the others."""
    sigma = covariances(scene, unit(scene["rotation"]))[-1]
    scene["scale"][-1] = np.sqrt(sigma[0, 0]), 0, 0
    scene["rotation"] = unit(scene["rotation"])
    scene["rotation"][-1] = 1, 0, 0, 0
    color = np.floor(np.clip((scene["sh"][:, 0].astype(float) * 0.28209479177387814 + 0.5) * 255, 0, 255)).astype(F) / F(255)
    rest = half(scene["sh"][:, 1:9], 10)
    scene["color"] = np.clip(color + harmonics(rest, directions(scene, eye)), 0, 1) if rest.shape[1] else color
    scene["opacity"] = np.floor(np.clip(scene["opacity"] * 255, 0, 255)).astype(F) / F(255)


def playcanvas(scene, eye, camera):
    """PlayCanvas 2.22, gsplat-resource.js:92-260 (halfs; harmonics of 11, 10, 11 bits of the largest of them), then
    glsl/chunks/gsplat/frag/formats/containerCompactWrite.js (gsplat-params.js:61: the default): colours of 11, 11 and 10
    bits in 0 to 4, ln s of 8 bits in −12 to 9, opacities of 8, quaternions of 11, 11 and 10 about half the angle."""
    color = half(scene["sh"][:, 0].astype(float) * 0.28209479177387814 + 0.5)
    rest = scene["sh"][:, 1:].astype(float)
    if rest.shape[1]:
        flat = rest.reshape(len(rest), -1)
        most = np.maximum(flat[:, 0], np.abs(flat[:, 1:]).max(1))  # the first is taken with its sign (:207)
        steps = np.array([2047, 1023, 2047])
        with np.errstate(divide="ignore", invalid="ignore"):
            codes = np.clip(np.floor((rest / most[:, None, None] * 0.5 + 0.5) * steps + 0.5), 0, steps)
        rest = np.where(most[:, None, None] == 0, 0, (codes / steps * 2 - 1) * F(1) * most.astype(F)[:, None, None])
        color = color + harmonics(rest.astype(F), directions(scene, eye))
    most = np.array([2047, 2047, 1023]) / 4.0
    scene["color"] = (np.floor(np.clip(color, 0, 4) * most + 0.5) / most).astype(F)
    q = half(unit(scene["rotation"]))[:, 1:].astype(float)
    w = np.sqrt(np.maximum(0, 1 - (q * q).sum(1)))
    steps = np.array([2047, 2047, 1023])
    p = np.floor(np.clip((q / np.sqrt(1 + w)[:, None] * 0.5 + 0.5) * steps + 0.5, 0, steps)) / steps * 2 - 1
    d = (p * p).sum(1)
    scene["rotation"] = np.column_stack((1 - d, np.sqrt(np.maximum(0, 2 - d))[:, None] * p)).astype(F)
    scale = half(scene["scale"]).astype(float)
    with np.errstate(divide="ignore"):
        codes = np.floor(np.clip((np.log(scale) + 12) * 255 / 21 + 0.5, 1, 255))
    scene["scale"] = np.where(scale < 1e-10, 0, np.exp(codes * 21 / 255 - 12)).astype(F)
    scene["opacity"] = (np.floor(np.clip(half(scene["opacity"]), 0, 1).astype(float) * 255 + 0.5) / 255).astype(F)


def spark(scene, eye, camera):
    """Spark 2 with ext splats, splat_encode.rs:127-136 and splatDefines.glsl: halfs of opacity, colour and ln s;
    quaternions of an axis of 10 and 10 bits on an octahedron and an angle of 12."""
    color = half(scene["sh"][:, 0] * C0 + F(0.5))
    rest = scene["sh"][:, 1:].astype(float)
    with np.errstate(divide="ignore"):  # (:286-297) 8 bits of the power of two below the largest channel: more is cut off
        power = np.exp2(np.clip(np.floor(np.log2(np.abs(rest).max(2, keepdims=True))), -15, 16))
    rest = np.sign(rest) * np.floor(np.minimum(np.abs(rest) / power * 255, 255) + 0.5) / 255 * power
    rest[:, 3:4] = rest[:, 8:] = 0  # ext_splats.rs:519 loses the first of degree 2, ExtSplats.ts:209 degree 3
    scene["color"] = half(color + harmonics(rest.astype(F), directions(scene, eye)))
    scene["opacity"] = half(scene["opacity"])
    scene["scale"] = np.exp(half(np.log(scene["scale"])).astype(float)).astype(F)
    q = axis_and_angle(unit(scene["rotation"]), lambda w: np.arccos(np.clip(w, 0, 1)))
    # packed once more on the GPU (splatDefines.glsl, packSplatExt), whose arc cosine, Mesa's, is off by up to 2e-4: half a step
    scene["rotation"] = axis_and_angle(q, lambda w: np.sqrt(1 - w) * (
        np.pi / 2 + w * (np.pi / 4 - 1 + w * (0.08132463 - 0.02363318 * w))))


def axis_and_angle(q, arccos):
    """Quaternions of an axis of 10 and 10 bits on an octahedron and an angle of 12."""
    q = unit(q).astype(float)
    half_angle = arccos(np.minimum(q[:, 0], 1))
    s = np.sin(half_angle)[:, None]
    axis = np.where(np.abs(s) < 1e-6, [1.0, 0, 0], q[:, 1:] / np.where(np.abs(s) < 1e-6, 1, s))
    p = axis[:, :2] / np.abs(axis).sum(1, keepdims=True)
    p = np.where(axis[:, 2:] < 0, (1 - np.abs(p[:, ::-1])) * np.where(p >= 0, 1, -1), p)
    p = np.floor(np.clip((p * 0.5 + 0.5) * 1023, 0, 1023) + 0.5) / 1023 * 2 - 1
    half_angle = np.floor(np.clip(half_angle * 2 / np.pi * 4095, 0, 4095) + 0.5) / 4095 * np.pi / 2
    z = 1 - np.abs(p).sum(1, keepdims=True)
    t = np.maximum(-z, 0)
    axis = np.concatenate((p + np.where(p >= 0, -t, t), z), 1)
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    return np.concatenate((np.cos(half_angle)[:, None], axis * np.sin(half_angle)[:, None]), 1).astype(F)


def gausscam(scene, eye, camera):
    """gausscam, README: harmonics of degree 0 alone, and unit quaternions."""
    scene["color"] = scene["sh"][:, 0] * C0 + F(0.5)


def aframe(scene, eye, camera):
    """aframe-gaussian-splatting, index.js: quaternions as they are, covariances in 32,767 steps of the largest of their six
    numbers, by parseInt, which takes 1e-7 for 1 (:386); dilated by 0.3 (:139)."""
    sigma = covariances(scene, scene["rotation"])
    most = np.abs(sigma).max((1, 2), keepdims=True)
    steps = sigma * 32767.0 / most
    small = (np.abs(steps) < 1e-6) & (steps != 0)
    with np.errstate(divide="ignore"):
        first = np.trunc(steps / 10.0 ** np.floor(np.log10(np.abs(np.where(small, steps, 1)))))
    dilate(scene, np.where(small, first, np.trunc(steps)) * (most / 32767.0).astype(F), camera, 0.3)
    scene["color"] = scene["sh"][:, 0] * C0 + F(0.5)


def gsplatjs(scene, eye, camera):
    """gsplat.js, data.cpp: as splat, and RenderProgram.ts:78: dilated by 0.3 of half pixels."""
    sigma = half(4 * covariances(scene, scene["rotation"]), 10) / 4.0
    dilate(scene, np.tril(sigma) + np.tril(sigma, -1).transpose(0, 2, 1), camera, 0.075)
    scene["color"] = scene["sh"][:, 0] * C0 + F(0.5)


def viser(scene, eye, camera):
    """viser, _scene_api.py: covariances of 16 bits, colours and opacities of 8, cut off; GaussianSplatsHelpers.ts:
    dilated by 0.3 (:124), left out beyond 1.1 half pictures (:86) or where opacity times determinant is below ¼ (:148)."""
    sigma = covariances(scene, unit(scene["rotation"])).astype(np.float16).astype(float)
    where, seen = dilate(scene, sigma, camera, 0.3)
    scene["color"], scene["opacity"] = (np.floor(np.clip(x, 0, 1).astype(float) * 255) / 255 for x in (
        scene["sh"][:, 0] * C0 + F(0.5), scene["opacity"].astype(F)))
    scene["opacity"] = np.where((where > 1.1) | (scene["opacity"] * np.linalg.det(seen) < 0.25), 0, scene["opacity"]).astype(F)


PROGRAMS = {"aframe": aframe, "gsplatjs": gsplatjs, "viser": viser, "splat": splat,
            "gs3d": gs3d, "playcanvas": playcanvas, "spark": spark, "gausscam": gausscam}


def store(program, scene, camera, out, order=None):
    numbers = read(scene)
    view = np.array(camera["world_to_camera"], float)
    PROGRAMS[program](numbers, -view[:3, :3].T @ view[:3, 3], camera)
    if order:
        first = np.array(order[: len(numbers["mean"])])[::-1]
        numbers = {name: values[first] for name, values in numbers.items()}
    write(out, numbers)


if __name__ == "__main__":
    texts = [json.loads(pathlib.Path(path).read_text()) for path in sys.argv[3:6:2]]
    store(sys.argv[1], sys.argv[2], texts[0], sys.argv[4], *texts[1:])
