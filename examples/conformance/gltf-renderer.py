"""A renderer of glTF files by KHR_gaussian_splatting, in plain numpy: what conic conformance --khr asks for.

    conic conformance --khr pack
    python3 gltf-renderer.py pack pictures
    conic judge --suite pack --pictures pictures

It takes the camera from the file, too. The names of functions and the comments follow the extension's text.
"""

import base64
import json
import os
import struct
import sys

import numpy as np

F = np.float32
NAME = "KHR_gaussian_splatting"
TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class File:
    def __init__(self, path):
        data = open(path, "rb").read()
        self.folder, self.binary = os.path.dirname(path), None
        if data[:4] == b"glTF":
            n = struct.unpack("<I", data[12:16])[0]
            self.json, self.binary = json.loads(data[20:20 + n]), data[28 + n:]
        else:
            self.json = json.loads(data)
        self.buffers = [self.buffer(buffer) for buffer in self.json["buffers"]]

    def buffer(self, buffer):
        uri = buffer.get("uri")
        if uri is None:
            return self.binary
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return open(os.path.join(self.folder, uri), "rb").read()

    def items(self, i_view, offset, count, width, kind):
        """Items of a view, whose stride may be larger than they are."""
        view, dtype = self.json["bufferViews"][i_view], np.dtype(kind)
        start, stride = view.get("byteOffset", 0) + offset, view.get("byteStride", width * dtype.itemsize)
        data = np.frombuffer(self.buffers[view["buffer"]], np.uint8)
        rows = [data[start + i * stride:start + i * stride + width * dtype.itemsize] for i in range(count)]
        return np.concatenate(rows).view(dtype).reshape(count, width)

    def accessor(self, number):
        a = self.json["accessors"][number]
        width, kind = WIDTHS[a["type"]], TYPES[a["componentType"]]
        values = np.zeros((a["count"], width), kind)
        if "bufferView" in a:
            values = self.items(a["bufferView"], a.get("byteOffset", 0), a["count"], width, kind).copy()
        if "sparse" in a:
            sparse = a["sparse"]
            at, new = sparse["indices"], sparse["values"]
            indices = self.items(at["bufferView"], at.get("byteOffset", 0), sparse["count"], 1,
                                 TYPES[at["componentType"]])[:, 0]
            values[indices] = self.items(new["bufferView"], new.get("byteOffset", 0), sparse["count"], width, kind)
        if a.get("normalized"):
            return np.maximum(values / np.float64(np.iinfo(values.dtype).max), -1)
        return values.astype(np.float64)


def rotation(q):
    x, y, z, w = np.moveaxis(q, -1, 0)  # w comes last, and the length is 1
    rows = [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
            2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
            2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]
    return np.stack(rows, -1).reshape(q.shape[:-1] + (3, 3))


def places(file):
    """Yields the nodes of the file's scene with their global matrices."""
    def walk(number, outer):
        node = file.json["nodes"][number]
        own = np.eye(4)
        if "matrix" in node:
            own = np.array(node["matrix"], float).reshape(4, 4).T  # column by column
        else:
            own[:3, :3] = rotation(np.array(node.get("rotation", (0, 0, 0, 1)), float)) * node.get("scale", (1, 1, 1))
            own[:3, 3] = node.get("translation", (0, 0, 0))
        own = outer @ own
        yield node, own
        for child in node.get("children", ()):
            yield from walk(child, own)

    scene = file.json["scenes"][file.json["scene"]]
    for number in scene["nodes"]:
        yield from walk(number, np.eye(4))


def harmonics(degree, d):
    x, y, z = d.T
    basis = [np.full(len(d), 0.2820947917738781)]
    if degree > 0:
        basis += [y * -0.4886025119029199, z * 0.4886025119029199, x * -0.4886025119029199]
    if degree > 1:
        basis += [x * y * 1.092548430592079, y * z * -1.092548430592079,
                  (2 * z * z - x * x - y * y) * 0.3153915652525200, x * z * -1.092548430592079,
                  (x * x - y * y) * 0.5462742152960395]
    if degree > 2:
        basis += [y * (3 * x * x - y * y) * -0.5900435899266435, x * y * z * 2.890611442640554,
                  y * (4 * z * z - x * x - y * y) * -0.4570457994644657,
                  z * (2 * z * z - 3 * x * x - 3 * y * y) * 0.3731763325901154,
                  x * (4 * z * z - x * x - y * y) * -0.4570457994644657, z * (x * x - y * y) * 1.445305721320277,
                  x * (x * x - 3 * y * y) * -0.5900435899266435]
    return np.stack(basis, 1)


def reconstruct(file, primitive, world, eye):
    """The means, covariances, opacities and colours of a primitive's splats, in global space."""
    attributes = {name: file.accessor(number) for name, number in primitive["attributes"].items()}
    C = rotation(attributes[NAME + ":ROTATION"]) * attributes[NAME + ":SCALE"][:, None, :]
    M = world[:3, :3]
    means = attributes["POSITION"] @ M.T + world[:3, 3]
    names = [f"{NAME}:SH_DEGREE_{degree}_COEF_{k}" for degree in range(4) for k in range(2 * degree + 1)]
    coefficients = [attributes[name] for name in names if name in attributes]
    # Turning the coefficients by the node's rotation is turning the direction back.
    turn = M / np.linalg.norm(M, axis=0)
    directions = (means - eye) / np.linalg.norm(means - eye, axis=1, keepdims=True) @ turn
    basis = harmonics(int(len(coefficients) ** 0.5) - 1, directions)
    colors = np.maximum(sum(basis[:, k, None] * coefficients[k] for k in range(len(coefficients))) + 0.5, 0)
    return means, M @ C @ C.transpose(0, 2, 1) @ M.T, attributes[NAME + ":OPACITY"][:, 0], colors


def draw(file, width, height, background):
    ahead = np.array(((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 4), (0, 0, 0, 1)))  # of files without a camera
    camera = next((own for node, own in places(file) if "camera" in node), ahead)
    perspective = file.json["cameras"][0]["perspective"] if "cameras" in file.json else {"yfov": 2 * np.arctan(0.5)}
    focal = height / 2 / np.tan(perspective["yfov"] / 2)
    parts = [reconstruct(file, primitive, own, camera[:3, 3]) for node, own in places(file) if "mesh" in node
             for primitive in file.json["meshes"][node["mesh"]]["primitives"]
             if NAME in primitive.get("extensions", ())]
    means, covariances, opacities, colors = (np.concatenate(columns) for columns in zip(*parts))
    W = np.diag((1, -1, -1)) @ camera[:3, :3].T  # x right, y down, z forward
    x, y, z = ((means - camera[:3, 3]) @ W.T).T
    X, Y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    rgb, T = np.zeros((height, width, 3), F), np.ones((height, width), F)
    for i in np.argsort(np.sqrt(x * x + y * y + z * z), kind="stable"):  # from the front to the back
        if z[i] <= 0:
            continue
        J = focal / z[i] * np.array(((1, 0, -x[i] / z[i]), (0, 1, -y[i] / z[i])))
        (a, b), (_, c) = np.linalg.inv(J @ W @ covariances[i] @ W.T @ J.T)
        dx, dy = focal * x[i] / z[i] + width / 2 - X, focal * y[i] / z[i] + height / 2 - Y
        square = a * dx * dx + c * dy * dy + 2 * b * dx * dy  # of the Mahalanobis distance
        alpha = np.where(square <= 9, opacities[i] * np.exp(-0.5 * square), 0).astype(F)
        rgb += (alpha * T)[..., None] * colors[i].astype(F)
        T *= 1 - alpha
    return np.concatenate((rgb + T[..., None] * np.array(background, F), 1 - T[..., None]), 2)


def main(pack, pictures):
    os.makedirs(pictures, exist_ok=True)
    manifest = json.load(open(pack + "/manifest.json"))
    scenes = {scene["name"]: scene for scene in manifest["scenes"]}
    for case in manifest["cases"]:
        scene = scenes[case["scene"]]
        rgba = draw(File(f"{pack}/{scene['files']['gltf']}"), scene["width"], scene["height"], scene["background"])
        np.save(f"{pictures}/{case['name']}.npy", rgba.astype(F))


if __name__ == "__main__":
    main(*sys.argv[1:])
