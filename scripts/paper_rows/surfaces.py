"""Computing and Rendering Point Set Surfaces (Alexa, Behr, Cohen-Or, Fleishman, Levin, Silva)."""

from .page import ABSENT, FULL, OTHER, PARTLY, Rows
from .tools import thousands

TITLE = "Point Set Surfaces"
INTRODUCTION = """
Surfaces by moving least squares: projected, thinned, densified, and drawn as patches.
"""
ROWS = Rows()
add, words = ROWS.add, ROWS.words


words("S1", "§3, Eqs. 1–6: a plane, a polynomial, a search along the normal", FULL, "conic mls project",
      "As corrected ([errata](../notes/errata.md))")


@add("S2", "§3.2: a point that is projected twice stays", FULL, "test_mls_project", quick=True)
def _(bench):
    moves = bench.test("test_mls_project", r"a second time they move by ([\d.e+-]+) h")[0]
    return f"moves by {max(map(float, moves)):.0e} h at most"


words("S3", "Eq. 4, §3.4: Gaussian weights, or compact ones", FULL, "conic mls project --weight compact")
words("S4", "Fig. 4: h small and large", FULL, "conic mls project --h 2x", "[picture](../pictures/surfaces/h.png)")
words("S5", "§3.3: degree 3 or 4; higher ones oscillate", FULL, "conic mls project --degree 3",
      "1 to 4; higher ones are not built")
words("S6", "§3.4: cell by cell, out of core", FULL, "conic mls project --memory 30",
      "13 MiB for a million points, in place of 94")


@add("S7", "§3.4: far samples as one", FULL, "conic mls project --cluster 0.3", quick=True,
     why="Pays only where h is wide; costs 0.0007 h of accuracy")
def _(bench):
    texts = []
    bunny = bench.model("bunny.obj")
    for h in ("2x", "5x", "10x"):
        ms = [bench.run("mls", "project", bunny, "-o", bench.path("p.ply"), "--h", h, "--threads", 1, *more)["seconds"]["work"]
              for more in ((), ("--cluster", 0.3))]
        texts.append(f"h {h}: {ms[0] / ms[1]:.1f} ×")
    return "bunny: " + ", ".join(texts)


words("S8", "§3.4: the plane through the point itself is faster", FULL, "conic mls project --plane fast",
      "1.01 in the place of 0.28 M points/s, of the sums alone")


@add("S9", "§3.5: the bunny, 1,500–3,500 points/s", FULL, "conic mls project bunny.obj --threads 1", quick=True)
def _(bench):
    texts = []
    for plane in ("full", "fast"):
        report = bench.run("mls", "project", bench.model("bunny.obj"), "-o", bench.path("p.ply"), "--plane", plane,
                           "--threads", 1)
        texts.append(f"{plane} {35947 / report['seconds']['work'] / 1e3:.0f} K points/s")
    return ", ".join(texts)


@add("S10", "Eq. 7: the error falls as h^(m+1)", FULL, "test_mls_order", "[chart](../pictures/surfaces/order.svg)")
def _(bench):
    lines = bench.test("test_mls_order", r"gyroid, mls, full, degree (\d): .*: order ([\d.]+)")[0]
    return "gyroid: " + ", ".join(f"degree {degree}: {order}" for degree, order in lines)


words("S13", "§5.1: what contributes least goes first", FULL, "conic mls thin",
      "9.4e-4 off where a random choice is 3.2e-3 off")
words("S14", "Figs. 6–7: coloured by contribution; 37 K → 20 K points", FULL, "conic mls thin --keep contribution",
      "[picture](../pictures/papers/contribution.png): all of nefertiti, and the 10,000 that are left; grey ones cannot be measured")
words("S15", "§5.2, Fig. 8: densifying at the vertices of a Voronoi diagram, 800 → 20,000", OTHER, "conic mls densify",
      "By the largest empty circles that darts find: 12,228 points leave no gap, 4.2e-3 off; "
      "[picture](../pictures/surfaces/densify.png)")
words("S17", "§6.2, Figs. 9–10: a patch's extent and spacing, evaluated by forward differences", FULL,
      "conic render --method patch", "Weights of the grid are even to 6 % rms; errors of the differences stay within 2 px "
      "steps")
words("S18", "§6.3: grids of several resolutions, made when wanted", FULL, "conic render --method patch", "3 to 64 rows")
DEPARTURES = [
    "The plane is projected until the point is a fixed point: the printed search does not give one.",
    "Densifying fills the largest empty circles that darts find, not the vertices of a Voronoi diagram.",
]
