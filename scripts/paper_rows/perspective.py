"""Perspective Accurate Splatting (Zwicker, Räsänen, Botsch, Dachsbacher, Pauly)."""

from .page import FULL, OTHER, PARTLY, Rows
from .tools import thousands

TITLE = "Perspective Accurate Splatting"
INTRODUCTION = """
Splats by their exact outline in perspective, and clip lines for sharp features.
"""
ROWS = Rows()
add, words = ROWS.add, ROWS.words


@add("P1", "Eqs. 1–3: a pixel is a filtered, weighted sum", FULL, "test_errata_pas",
     "As corrected: amplitude and variance ([errata](../notes/errata.md))", quick=True)
def _(bench):
    bench.test("test_errata_pas", r"")
    return "the test holds"


@add("P2", "Eqs. 4–9: the projective map of the splat's plane, its centre and its tight box", FULL, "test_projection",
     quick=True)
def _(bench):
    found = bench.test("test_projection", r"off by ([\d.e+-]+) relative .*box by ([\d.e+-]+) px")[0][0]
    return f"the outline's value is off by {found[0]} relative, its box by {found[1]} px"


words("P3", "Eqs. 10–11: the outline at F_g is exact", FULL, "conic render --method conic", "[Accuracy](accuracy.md)")
words("P4", "§4.4: centres are off, without artefacts", FULL, "conic render --method auto",
      "Each splat's error is bounded; `auto` takes `ray` where it would be seen ([accuracy](accuracy.md))")


words("P5", "Fig. 2: contours of a splat in a bad case: exact, theirs and Heckbert's", FULL, "scripts/isocontours.py",
      "[picture](../pictures/papers/isocontours.svg): grey what is true; `conic` has the outline, but not what is in it")


@add("P7", "Fig. 7: an affine approximation tears surfaces, theirs does not", FULL, "test_closed_plane",
     "[picture](../pictures/papers/affine.png): a floor seen along it, affine above, exact below")
def _(bench):
    lines = bench.test("test_closed_plane", r"(\w+), prefilter [\d.]+, cutoff [\d.]+: (\d+) holes in (\d+) pixels")[0]
    holes = {}
    for method, n_holes, n_pixels in lines:
        known = holes.get(method, (0, 0))
        holes[method] = (known[0] + int(n_holes), known[1] + int(n_pixels))
    return ", ".join(f"{method} {n:,} holes in {of:,} pixels" for method, (n, of) in holes.items())


words("P8", "§5, Fig. 4: clip lines from neighbours' planes, none to two a splat", FULL, "conic prepare --features 40",
      "[Measured](../notes/features.md)")
words("P9", "Fig. 5: a cube without and with clip lines", FULL, "conic make cube -n 400",
      "[picture](../pictures/papers/cube.png)")
words("P10", "§5, Fig. 8: a CSG object of 6,433 splats", FULL, "conic csg A B --difference; test_solids",
      "[picture](../pictures/papers/csg.png): lines lie at the seam, within what flat discs are off round surfaces")
words("P11", "§5: features found by themselves", FULL, "conic prepare --features 40; conic mls project --sharp",
      "[Measured](../notes/surfaces-measured.md)")
words("P12", "§6: three passes, a table of the Gaussian, F_g 1–2; ill-conditioned splats are left out", FULL,
      "conic render --passes 3 --cutoff F", "These are drawn: leaving them out opens holes ([accuracy](accuracy.md))")


@add("P13", "Table 1: one pass is 3.6–3.7 times as fast as three: 11.2 / 3.1 and 10.4 / 2.8 M splats/s at 512² and "
     "1280 × 1024, of 400 and 650 thousand splats", PARTLY, "conic render --passes 1",
     "On a processor the frame is not bound by passes: set-up is done once for all three")
def _(bench):
    texts = []
    for count in (400000, 650000):
        splats = bench.once(f"sphere{count}.ply", lambda out: bench.run("make", "sphere", "-n", count, "-o", out))
        for size in ("512x512", "1280x1024"):
            three, one = bench.frames_in_turns(7, (splats, "--size", size), (splats, "--size", size, "--passes", 1))
            texts.append(f"{count // 1000} k, {size}: {count / one / 1e3:.1f} / {count / three / 1e3:.1f} M/s, {three / one:.2f} ×")
    return "; ".join(texts)


@add("P14", "§6: clipping hardly costs anything", FULL, "conic make cube -n N",
     "The frame with clip lines over the frame without; only splats that have lines test them")
def _(bench):
    texts = []
    for count in (220, 3000):
        cube = bench.once(f"cube{count}.ply", lambda out: bench.run("make", "cube", "-n", count, "-o", out))
        bare = bench.once(f"bare{count}.ply", lambda out: leave_out_clip_lines(cube, out))
        clipped, whole = bench.frames_in_turns(21, (cube,), (bare,))
        texts.append(f"cube of {thousands(count)} splats: {clipped / whole:.2f} ×")
    return "; ".join(texts)


def leave_out_clip_lines(file, out):
    """A copy of a PLY of `conic make` without the lists of clip lines at its rows' ends."""
    with open(file, "rb") as source:
        lines = list(iter(source.readline, b"end_header\n"))
        data = source.read()
    n_bytes = sum({b"float": 4, b"uchar": 1}[line.split()[1]] for line in lines
                  if line.startswith(b"property") and b" list " not in line)
    rows, at = [], 0
    while at < len(data):
        rows.append(data[at:at + n_bytes])
        at += n_bytes
        for _ in range(sum(b" list " in line for line in lines)):
            at += 1 + 4 * data[at]
    with open(out, "wb") as target:
        target.write(b"".join(line for line in lines if b" list " not in line) + b"end_header\n" + b"".join(rows))


@add("P15", "Fig. 6: Moiré on a checkerboard without the prefilter", FULL, "test_checkerboard",
     "[picture](../pictures/papers/checkerboard.png): without and with it", quick=True)
def _(bench):
    far, near, wide, _, bare, _ = bench.test(
        "test_checkerboard", r"near: ([\d.]+) / ([\d.]+) dB, with a cutoff of 3 ([\d.]+) / ([\d.]+), without prefilter "
        r"([\d.]+) / ([\d.]+)")[0][0]
    return f"far half {far} dB, with a cutoff of 3 {wide}, without the prefilter {bare}"


words("P6", "Fig. 3: discs that touch in the plane touch in the picture", FULL, "refimages/pas-3-conic; refimages/pas-3-affine",
      "Within 5e-3 px ([measured](../notes/accuracy.md))")
words("P16", "Future: curved splats, n-gons", PARTLY, "conic render --method patch",
      "Curved patches go through points ([surfaces](surfaces.md)); no file holds curved splats, which would ask for a search "
      "along each pixel's ray")
words("P17", "Future: hierarchies", FULL, "conic octree; conic layer; conic hybrid")
DEPARTURES = [
    "Splats that are ill-conditioned are drawn: edge-on by the dual conic, across the near plane by the exact parameter.",
    "The amplitude is that of a kernel of unit peak: a splat smaller than a pixel weighs less, not more.",
]
