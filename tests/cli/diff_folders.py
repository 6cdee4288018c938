"""Pictures for diff_folders.sh, and their measures by the formulas of the papers, of arrays in [0, 1].

diff_folders.py make: gt/ (PNG), large/ (the same, each pixel four of one mean) and renders/ (PFM of display values).
diff_folders.py check VIEWS.json: whether conic's measures of them are those of the formulas.
"""

import json
import struct
import sys
import zlib

import numpy as np


def write_png(path, codes):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width, _ = codes.shape
    rows = b"".join(b"\0" + row.tobytes() for row in codes)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)))
        file.write(chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def write_pfm(path, values):
    height, width, _ = values.shape
    with open(path, "wb") as file:
        file.write(b"PF\n%d %d\n-1\n" % (width, height) + values[::-1].astype("<f4").tobytes())


def psnr(a, b):
    return -10 * np.log10(np.mean((a - b) ** 2))


def ssim(a, b, padding):
    """Wang et al. (2004) with Gaussian windows; padded by 5 it is that of 3D Gaussian splatting's metrics.py."""
    weight = np.exp(-((np.arange(11) - 5) ** 2) / (2 * 1.5**2))
    weight = np.outer(weight, weight) / weight.sum() ** 2

    def mean(plane):
        plane = np.pad(plane, padding)
        return (np.lib.stride_tricks.sliding_window_view(plane, (11, 11)) * weight).sum((-1, -2))

    found = []
    for p, q in zip(np.moveaxis(a, 2, 0), np.moveaxis(b, 2, 0)):
        m, n = mean(p), mean(q)
        v, w, both = mean(p * p) - m * m, mean(q * q) - n * n, mean(p * q) - m * n
        found.append(np.mean((2 * m * n + 1e-4) * (2 * both + 9e-4) / ((m * m + n * n + 1e-4) * (v + w + 9e-4))))
    return np.mean(found)


def pictures():
    random = np.random.default_rng(1)
    for i in range(3):
        smooth = np.cumsum(np.cumsum(random.random((21, 27, 3)), 0), 1)
        codes = np.uint8(254 * smooth / smooth.max())
        render = np.float32(np.clip(codes / 255 + random.normal(0, 0.04 * (i + 1), codes.shape), -0.1, 1.1))
        yield f"IMG_{i}", codes, render


def make():
    import os

    for folder in ("gt", "large", "renders"):
        os.mkdir(folder)
    for name, codes, render in pictures():
        large = codes.repeat(2, 0).repeat(2, 1)
        large[::2, ::2] += 1
        large[1::2, 1::2] -= codes > 0
        large[::2, ::2] -= codes == 0
        write_png(f"gt/{name}.png", codes)
        write_png(f"large/{name}.png", large)
        write_pfm(f"renders/{name}.pfm", render)


def check(path):
    views = json.load(open(path))
    wanted = []
    for _, codes, render in pictures():
        a, b = codes / 255, np.clip(render.astype(float), 0, 1)
        wanted.append((psnr(a, b), ssim(a, b, 0), ssim(a, b, 5)))
    got = [tuple(view[key] for key in ("psnr", "ssim", "ssim_padded")) for view in views["views"]]
    got.append(tuple(views["mean"][key] for key in ("psnr", "ssim", "ssim_padded")))
    wanted.append(tuple(np.mean(wanted, 0)))
    print(np.abs(np.array(got) - wanted).max(0))
    return np.allclose(got, wanted, rtol=0, atol=1e-6)


if __name__ == "__main__":
    sys.exit(make() if sys.argv[1] == "make" else not check(sys.argv[2]))
