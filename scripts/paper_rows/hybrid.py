"""Hybrid Rendering of Points and Polygons, with quadrics (the thesis behind hybrid models)."""

from .page import ABSENT, FULL, PARTLY, Rows
from .tools import read_floats, thousands

TITLE = "Hybrid Quadric Points"
INTRODUCTION = """
A mesh as clusters, drawn as triangles where it is flat and as surfels where it bends. Cow and bunny are the thesis' own
meshes; bones and dragon are not public.
"""
ROWS = Rows()
add, words = ROWS.add, ROWS.words
LIKE_THESIS = ("--sampling", "box", "--phase1", 0.05, "--most-error", 0, "--single")
MODELS = {"cow.obj": (0.195, 4.8), "bunny.obj": (0.1205, 3.2)}


def build_like(bench, model):
    """The thesis' triangles and surfels, by limits that come near its counts."""
    phase2, density = MODELS[model]
    name = model.split(".")[0] + "-like.chy"
    if name not in bench.known:
        bench.known[name] = bench.run("hybrid", bench.model(model), "-o", bench.path(name), *LIKE_THESIS, "--phase2", phase2,
                                      "--density", density, "--threads", 1)
    return bench.path(name), bench.known[name]


words("H1", "Eqs. 3.1–3.8: edges collapse by quadrics", FULL, "conic hybrid", "[Measured](../notes/hybrid-measured.md)")
words("H2", "Eqs. 3.9–3.14, Algs. 3.2–3.3, Fig. 4.12: clusters in two phases, in n log n", FULL, "conic hybrid",
      "0.010, 0.14, 0.47 and 3.3 s for 5.8 K, 69 K, 200 K and 1 M triangles")
words("H3", "Figs. 4.1–4.3: the cow's clusters at three costs", FULL, "conic hybrid --phase1 COST",
      "1,622, 272 and 102 clusters; [picture](../pictures/hybrid/clusters.png)")
words("H4", "§3.2.4: levels of detail that keep the borders of patches", FULL, "conic render x.chy --error PX",
      "Neighbours fit to the bit: none of 37.2 M pixels is empty")
words("H5", "§3.3.1, end of 3.3.2: surfels, and their levels by halving", FULL, "conic hybrid",
      "Ellipses; levels are nodes of a tree")
words("H6", "Alg. 3.4: rays from three faces, l / c apart, between a least and a greatest distance", PARTLY,
      "conic hybrid --sampling box --density 4", "26,291 surfels of the cow. No least and greatest distance: a patch is small where its "
      "surface bends")
words("H7", "§3.3.2: bump, displacement and procedural maps while sampling", ABSENT, "conic hybrid --texture",
      "Colours of a texture are sampled. Heights would move surfels off the mesh whose edges they must meet: displace the mesh "
      "first")
words("H8", "Eqs. 3.15–3.27: EWA by the Jacobian", FULL, "conic render --method affine",
      "Eq. 3.27 as corrected ([errata](../notes/errata.md))")
words("H9", "§3.4.2, Figs. 4.5–4.6: a depth for each pixel, ε of 0.75–1.5 grid distances, three passes", FULL,
      "conic render --epsilon 1.5x", "[picture](../pictures/stability/walls.png)")


@add("H11", "Table 4.2, Fig. 4.8: a checkerboard's surfels by their distance: 320 K at 0.005, 163 K, 80 K, 20 K, 3 K, < 1 K "
     "at 0.1", FULL, "conic hybrid --sampling box",
     "Ours are area / distance² of a board of edge 1. The thesis' are eight times these, so its board is larger: it does not "
     "say")
def _(bench):
    board = bench.path("board.obj")
    with open(board, "w", encoding="utf-8") as file:
        file.write("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n")
    texts = []
    edge = (1 + 1 + 2**0.5) / 3
    for distance in (0.005, 0.01, 0.02, 0.1):
        report = bench.run("hybrid", board, "-o", bench.path("board.chy"), *LIKE_THESIS, "--phase2", "1e6", "--density",
                           edge / distance)
        texts.append(f"{distance}: {thousands(report['surfels'])}")
    return "; ".join(texts)


words("H10", "Fig. 4.7: EWA removes the aliasing of a checkerboard", FULL, "test_checkerboard",
      "[picture](../pictures/papers/checkerboard.png): without and with the prefilter")
words("H12", "Fig. 4.9: holes at the corners of patches", FULL, "scripts/hybrid-watertight", "None")
words("H13", "Fig. 4.10: one sampling distance for the whole cow loses horns and ears", FULL,
      "conic hybrid --sampling box --phase1 -2 --phase2 1e6", "[picture](../pictures/papers/head.png): one distance, and "
      "each patch's own")
words("H14", "Figs. 4.4, 4.11, 4.16–4.20: pictures of the models", FULL, "scripts/hybrid-pictures",
      "[head](../pictures/hybrid/head.png), [models](../pictures/hybrid/models.png)")


@add("H15", "Table 4.3: cow 1,533 triangles + 51,731 surfels, 2.6 + 77 s; bunny 13,038 + 308,550, 30.6 + 182 s", FULL,
     "conic hybrid " + " ".join(map(str, LIKE_THESIS)), "`--phase2` and `--density` come near its counts; our defaults keep more triangles, "
     "which draw faster", quick=True)
def _(bench):
    texts = []
    for model in MODELS:
        _, report = build_like(bench, model)
        seconds = report["seconds"]
        texts.append(f"{model.split('.')[0]} {thousands(report['triangles'])} + {thousands(report['surfels'])}, "
                     f"{seconds['cluster']:.2f} + {seconds['sample']:.2f} s")
    return "; ".join(texts)


@add("H16", "Table 4.4, Fig. 4.13: the mesh itself is 4.5–15 times as fast as the hybrid", FULL, "conic render x.chy --repeat 3",
     quick=True)
def _(bench):
    texts = []
    for model in MODELS:
        file, _ = build_like(bench, model)
        hybrid, mesh = bench.frames_in_turns(5, (file, "--size", "512x512"),
                                             (bench.model(model), "--as", "mesh", "--size", "512x512"))
        texts.append(f"{model.split('.')[0]} {hybrid / mesh:.1f} ×")
    return ", ".join(texts)


def count_contributing(bench, file, *options):
    """Mean of the plane `count`, of pixels that show anything."""
    bench.render(file, "--size", "512x512", "--only", "surfels", "--aov", "count", *options, out="count.pfm")
    counts = read_floats(bench.path("count.pfm"))
    return float(counts[counts > 0].mean())


@add("H17", "Figs. 4.14–4.15, Table 4.3: 10.9–40.1 surfels contribute to a pixel: cow 11.2, bunny 15.8", FULL,
     "conic render x.chy --only surfels --aov count",
     "The plane `count`, of pixels that show something. JSON `overdraw` counts hidden fragments, too; "
     "[picture](../pictures/hybrid/overlap.png)", quick=True)
def _(bench):
    texts = []
    for model in MODELS:
        like, _ = build_like(bench, model)
        own = bench.once(model.split(".")[0] + ".chy", lambda out: bench.run("hybrid", bench.model(model), "-o", out))
        texts.append(f"{model.split('.')[0]} {count_contributing(bench, like):.1f}, as conic builds it "
                     f"{count_contributing(bench, own):.1f}")
    return "; ".join(texts)


words("H18", "Future: points as input", FULL, "conic hybrid scan.ply", "The lion: 29.3 % of the primitives, 39.0 dB")
words("H19", "Future: fewer overlaps, levels by cost, normal cones", FULL, "conic hybrid; conic render --cull back",
      "Blue noise: 3.3 surfels a pixel")
DEPARTURES = [
    "Surfels are blue noise by default, on ellipses, closer where colours meet; `--sampling box` is the thesis' grids.",
    "A patch stays triangles where surfels would be farther off than `--most-error`.",
]
