"""For tests of other renderers: the judge in one line.

    from conic.testing import assert_matches
    assert_matches(conic.Gaussians(means, quats, scales, opacities, sh), camera, picture, profile="gsplat-1.6")

Beside gsplat.rasterization, whose `meta` has what it makes of each Gaussian before it composites:

    assert_intermediates(meta, scene, camera, profile="gsplat-1.6", render_colors=colors, render_alphas=alphas)

With pytest, what a failure leaves behind stands in its report: see `pytest --help`, --conic-reports."""

from __future__ import annotations

import os
import tempfile
from typing import Any, Dict, List, Optional

from ._commands import AnyCamera, Options, judge, judge_intermediates
from ._scene import AnyScene

__all__ = ["PictureMismatch", "assert_intermediates", "assert_matches", "describe"]


class PictureMismatch(AssertionError):
    """A picture is not what it should be; `verdict` says why, and `files` are the report and the map."""

    def __init__(self, message: str, verdict: Dict[str, Any], files: List[str]) -> None:
        super().__init__(message)
        self.verdict = verdict
        self.files = files


def describe(verdict: Dict[str, Any]) -> str:
    """What :func:`conic.judge` has found, in a few lines."""
    pixels = verdict["pixels"]
    lines = [f"the picture is {verdict['verdict']}: " + ", ".join(f"{n} {name}" for name, n in pixels.items())]
    for fault in verdict.get("diagnosis", [])[:3]:
        lines.append(f"  {fault['share']:6.1%} explained by {fault['name']}")
    for fault in verdict.get("nearest", [])[:1]:
        lines.append(f"  not explained; nearest is {fault['name']}, by {fault['share']:.1%}")
    for worst in verdict.get("worst", [])[:3]:
        place = f"pixel {worst['x']},{worst['y']}" if "x" in worst else f"pixel {worst.get('pixel')}"
        found, low, high = (worst.get(key) for key in ("found", "low", "high"))
        what = f"{worst.get('plane')}[{worst.get('channel')}]"
        lines.append(f"  {place}: {what} is {found}; it may be {low} to {high}")
    return "\n".join(lines)


def assert_matches(scene: AnyScene, camera: AnyCamera, picture: Any, *, profile: Optional[str] = None,
                   max_wrong: int = 0, reports: Optional[str] = None, **options: Options) -> Dict[str, Any]:
    """Fails unless the picture is what the profile (or, of surfels, the method) makes of the scene, but for what
    floats may do to it. Arguments are those of :func:`conic.judge`, whose answer is returned.

    A failure's message has the verdict and the diagnosis, and names the report (HTML) and the map (PNG), which stand
    in `reports`, or else in a new folder of the system's for temporary files."""
    words = {"profile": profile, "max_wrong": max_wrong, **options}
    verdict = judge(scene, camera, picture, **words)
    if verdict["verdict"] == "right":
        return verdict
    folder = reports or tempfile.mkdtemp(prefix="conic-report-")
    os.makedirs(folder, exist_ok=True)
    files = [os.path.join(folder, name) for name in ("report.html", "map.png")]
    judge(scene, camera, picture, **{**words, "report": files[0], "map": files[1]})
    files = [path for path in files if os.path.exists(path)]
    raise PictureMismatch("\n".join([describe(verdict), *(f"  see {path}" for path in files)]), verdict, files)


def assert_intermediates(arrays: Dict[str, Any], scene: AnyScene, camera: AnyCamera, *, profile: Optional[str] = None,
                         render_colors: Any = None, render_alphas: Any = None, max_wrong: int = 0,
                         **options: Options) -> Dict[str, Any]:
    """Fails unless a renderer's means on the screen, conics, radii, lists of tiles … are what the profile makes of the
    scene, but for what floats may do to them. `arrays` is gsplat's `meta`, or a dict of any of its arrays, of one
    camera; what rasterization returns beside it may be given, too. A failure's message names the first stage that is
    wrong, the Gaussian, and what its number may be. Returns what :func:`conic.judge_intermediates` does."""
    given = {**arrays, "render_colors": render_colors, "render_alphas": render_alphas}
    verdict = judge_intermediates(scene, camera, given, profile=profile, max_wrong=max_wrong, **options)
    if verdict["verdict"] == "right":
        return verdict
    lines = [f"the first stage that is wrong is {verdict['stage']}:"]
    for array in verdict["arrays"]:
        if array["wrong"] > max_wrong:
            worst = array["worst"]
            of = f" of Gaussian {worst['gaussian']}" if "gaussian" in worst else ""
            lines.append(f"  {array['stage']}: {array['name']}, {array['wrong']} of {array['judged']} wrong; row "
                         f"{worst['row']}[{worst['column']}]{of} is {worst['found']}; it may be {worst['low']} to "
                         f"{worst['high']}" + (f": {worst['what']}" if "what" in worst else ""))
    raise PictureMismatch("\n".join(lines), verdict, [])
