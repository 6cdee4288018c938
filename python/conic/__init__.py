"""conic: a software rasteriser for surface splatting, and a judge of Gaussian renderers.

    import conic
    picture = conic.render(conic.open("scan.ply"), size=(640, 480))
    picture["rgba"], picture["Z"], picture.statistics["hash"]["rgba"]

Functions are the program's commands, and their keywords the commands' options; pictures are the program's to the bit.
"""

from ._camera import Camera, list_cameras
from ._commands import (command, conformance, convert, csg, devices, diff, explain, gradient, hybrid, info, judge,
                        judge_intermediates, layers, make, mls, octree, prepare, project, render, turntable, verify)
from ._library import features, release, version
from ._picture import Picture
from ._shot import Shot
from ._scene import Gaussians, Mesh, Scene, Splats, open
from .errors import (ArgumentError, Cancelled, ConicWarning, Error, InputError, OutOfMemoryError, OutputError,
                     UnsupportedError)

__version__ = version()

__all__ = [
    "ArgumentError", "Camera", "Cancelled", "ConicWarning", "Error", "Gaussians", "InputError", "Mesh",
    "OutOfMemoryError", "OutputError", "Picture", "Scene", "Shot", "Splats", "UnsupportedError", "command",
    "conformance", "convert", "csg", "devices", "diff", "explain", "features", "gradient", "hybrid", "info", "judge",
    "judge_intermediates", "layers", "list_cameras", "make", "mls", "octree", "open", "prepare", "project", "release",
    "render", "turntable", "verify", "version"
]
