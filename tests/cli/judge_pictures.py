"""Makes pictures of P.pfm and its planes as other programs write them, for tests/cli/judge.sh: NumPy's arrays, PNG."""

import struct
import sys
import zlib

import numpy


def read_pfm(path):
    with open(path, "rb") as file:
        channels = 3 if file.readline().strip() == b"PF" else 1
        width, height = map(int, file.readline().split())
        file.readline()
        values = numpy.frombuffer(file.read(), "<f4").reshape(height, width, channels)
    return values[::-1].copy()


def write_png(path, codes, n_bytes=None):
    bits, (height, width, channels) = 8 * codes.dtype.itemsize, codes.shape
    rows = codes.astype(codes.dtype.newbyteorder(">")).tobytes()
    stride = len(rows) // height
    data = b"".join(b"\0" + rows[y * stride : (y + 1) * stride] for y in range(height))

    def chunk(name, content):
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))

    kind = {3: 2, 4: 6}[channels]
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, 0))
    png += chunk(b"IDAT", zlib.compress(data)) + chunk(b"IEND", b"")
    with open(path, "wb") as file:
        file.write(png[:n_bytes])


def codes(values, most, add=0.5):
    return numpy.floor(numpy.clip(values, 0, 1).astype("f8") * most + add).astype("u1" if most == 255 else "<u2")


def encode(values):
    v = numpy.clip(values, 0, 1)
    return numpy.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)


stem = sys.argv[1]
rgb, z, ids = read_pfm(stem + ".pfm"), read_pfm(stem + ".Z.pfm"), read_pfm(stem + ".id.pfm")
numpy.save("rgb.npy", rgb)
numpy.save("rgb.Z.npy", z[:, :, 0])
numpy.save("rgb.id.npy", ids[:, :, 0].astype("i8"))
numpy.save("rgb64.npy", rgb.astype("f8"))
numpy.save("chw.npy", rgb.transpose(2, 0, 1).copy())
numpy.save("batch.npy", rgb[None])
numpy.save("half.npy", rgb.astype("f2"))
numpy.save("bytes.npy", codes(rgb, 255))
numpy.save("floor.npy", codes(rgb, 255, 0.0))
numpy.save("words.npy", codes(rgb, 65535))
numpy.savez("all.npz", image=rgb, Z=z[:, :, 0], id=ids[:, :, 0].astype("u4"))
numpy.savez_compressed("deflated.npz", rgb=rgb, Z=z)
numpy.savez("names.npz", something=rgb)
wrong = rgb.copy()
wrong[7, 5, 1] += 0.01
numpy.save("wrong.npy", wrong)
wrong = rgb.copy()
wrong[3, 3, 0], wrong[4, 4, 2] = numpy.nan, numpy.inf
numpy.save("nan.npy", wrong)
numpy.save("size.npy", rgb[:, :-1])
numpy.save("shape.npy", numpy.zeros((3, 5, 7, 9), "f4"))
with open("rgb.npy", "rb") as file, open("cut.npy", "wb") as cut:
    cut.write(file.read()[:-40])
opaque = numpy.concatenate([rgb, numpy.ones_like(z)], axis=2)
write_png("codes8.png", codes(rgb, 255))
write_png("codes16.png", codes(rgb, 65535))
write_png("opaque8.png", codes(opaque, 255))
write_png("srgb8.png", codes(encode(rgb), 255))
write_png("toned8.png", codes(rgb / (1 + rgb), 255))
write_png("cut.png", codes(rgb, 255), 200)
