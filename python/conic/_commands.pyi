# The signatures of _commands.py. Made by python/make-options of `conic help --format json`: not to be changed by hand.
from typing import Any, Dict, List, Literal, Optional, Sequence, Tuple, Union

from ._camera import Camera, PathLike
from ._picture import Picture
from ._scene import AnyScene, Scene
from ._shot import Shot

AnyCamera = Union[Camera, PathLike]
Options = Any


def render(
    scene: AnyScene,
    camera: Union[None, AnyCamera, Shot] = None,
    *,
    planes: Optional[Sequence[str]] = None,
    output: Union[None, PathLike, Sequence[PathLike]] = None,
    progress: Any = None,
    threads: Optional[int] = None,
    view: Union[None, int, str] = None,
    size: Optional[Union[str, Sequence[int]]] = None,
    profile: Optional[Literal["exact", "inria-2023", "gsplat-1.5", "gsplat-1.5-aa", "gsplat-1.6", "gsplat-1.6-aa",
        "2dgs-2024", "2dgs-gsplat", "khr-2026", "inria-2023-aa", "mip-2023", "brush-1", "splat-2023",
        "playcanvas-2", "spark-2", "gs3d-0.4", "3dgut-2025", "surface"]] = None,
    method: Optional[Literal["conic", "ray", "affine", "point", "disc", "auto", "patch"]] = None,
    quality: Optional[Literal["draft", "good", "final", "sketch"]] = None,
    samples: Optional[int] = None,
    as_: Optional[Literal["auto", "points", "mesh", "hybrid"]] = None,
    shade: Optional[Literal["none", "lambert", "phong", "edl", "lambert+edl", "phong+edl"]] = None,
    background: Optional[Union[str, float, Sequence[float]]] = None,
    exposure: Optional[Union[str, float, Sequence[float]]] = None,
    azimuth: Optional[float] = None,
    elevation: Optional[float] = None,
    turntable: Optional[Union[str, float, Sequence[float]]] = None,
    in_memory: bool = True,
    exr: Optional[Union[str, float, Sequence[float]]] = None,
    tone: Optional[Literal["srgb", "filmic", "aces", "agx"]] = None,
    deep: Optional[PathLike] = None,
    show: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    save_shot: Optional[PathLike] = None,
    no_shot: Optional[bool] = None,
    again: Optional[PathLike] = None,
    path: Optional[PathLike] = None,
    fps: Optional[float] = None,
    film: Optional[Union[str, float, Sequence[float]]] = None,
    frames: Optional[Union[str, float, Sequence[float]]] = None,
    resumable: Optional[bool] = None,
    resume: Optional[PathLike] = None,
    stereo: Optional[float] = None,
    accumulate: Optional[Union[int, str]] = None,
    time: Optional[float] = None,
    noise: Optional[float] = None,
    preview: Optional[float] = None,
    aperture: Optional[Union[str, float, Sequence[float]]] = None,
    focus: Optional[Union[str, float, Sequence[float]]] = None,
    shutter: Optional[Union[str, float, Sequence[float]]] = None,
    motion: Optional[PathLike] = None,
    box: Optional[Union[str, float, Sequence[float]]] = None,
    progressive: Optional[PathLike] = None,
    deadline: Optional[float] = None,
    tolerate: Optional[bool] = None,
    memory: Optional[int] = None,
    occlusion: Optional[Literal["auto", "on", "off"]] = None,
    timeout: Optional[float] = None,
    ao: Optional[int] = None,
    shadow: Optional[bool] = None,
    matte_by: Optional[PathLike] = None,
    transparency: Optional[bool] = None,
    catcher: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    holdout: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    repeat: Optional[int] = None,
    fov: Optional[float] = None,
    zoom: Optional[float] = None,
    projection: Optional[Literal["perspective", "fisheye", "orthographic", "panorama", "cube"]] = None,
    eye: Optional[Union[str, float, Sequence[float]]] = None,
    up: Optional[Union[str, float, Sequence[float]]] = None,
    texture: Optional[PathLike] = None,
    max_texture: Optional[int] = None,
    allow_outside: Optional[bool] = None,
    crease: Optional[Union[str, float, Sequence[float]]] = None,
    color_by: Optional[PathLike] = None,
    ramp: Optional[Union[str, float, Sequence[float]]] = None,
    where: Optional[PathLike] = None,
    place: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    error: Optional[float] = None,
    budget: Optional[Union[int, str]] = None,
    cache: Optional[PathLike] = None,
    only: Optional[Literal["triangles", "surfels"]] = None,
    kernel: Optional[Union[str, float, Sequence[float]]] = None,
    cutoff: Optional[float] = None,
    prefilter: Optional[float] = None,
    epsilon: Optional[Union[str, float, Sequence[float]]] = None,
    passes: Optional[int] = None,
    cull: Optional[Literal["none", "back"]] = None,
    near: Optional[Union[str, float, Sequence[float]]] = None,
    light: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    sky: Optional[Union[str, float, Sequence[float]]] = None,
    reflect: Optional[float] = None,
    k: Optional[int] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    tile: Optional[int] = None,
    device: Optional[Union[str, float, Sequence[float]]] = None,
    plain: Optional[bool] = None,
    isa: Optional[Literal["auto", "scalar", "sse2", "avx2", "avx512", "neon"]] = None,
) -> Any:
    """Draws a scene; with the same options, the bits are those of `conic render`.

    `scene`: what :func:`open` gives, :class:`Splats`, :class:`Mesh`, :class:`Gaussians`, a path, an array (N, 3) of
    points, or a list of these.
    `camera`: a :class:`Camera`, or a file of cameras, of which `view` names one; without, all of the scene is framed.
    `planes`: of "rgba", "Z", "N", "albedo", "weight", "count", "id", "P", of Gaussian scenes "T", "medianZ",
    "inverseZ", "last", "doubt"; "ao", "shadow"; "motion", "bound" (rgba and Z). `profile`: how a Gaussian scene is composited. `output`:
    files to write, besides. `progress`: True, a function of a task's name and the share of it that is done, or a tqdm
    bar. All other options of `conic help render` are taken by their names.

    Without `in_memory`, pictures go to `output` alone, and an .exr that is larger than half of `memory` is drawn and
    written strip by strip.

    A :class:`Shot` in the place of the camera is drawn as it is, and takes no options but `progress` and `threads`.

    Returns a :class:`Picture`: a dict of arrays by plane, (H, W, 4) for rgba and (H, W) for Z, and "statistics"; for
    `view="all"`, `turntable=N` and `stereo=E` a list of them.

    Options:

    output: where the picture goes: .exr, .png, .tif, .jpg, .pfm …, or of several .mp4, .webm or .gif, a film by
        ffmpeg; - is standard output; exr:- and pfm:NAME say of what kind that is, or a name without an ending
        [png]; may be repeated
    exr: numbers of an .exr: float, or half for rgba, N and albedo; and how it is compressed: zip, none, rle,
        zips, piz, or pxr24, which loses bits of floats, as in half,piz [float,zip]
    tone: how files of 8 and 16 bits show what is brighter than white: srgb (as white), filmic (Hable's curve),
        aces (Hill's fit) or agx (Sobotka's); .exr, .pfm and .hdr stay linear [srgb]
    deep: every splat and triangle of every pixel, as a deep image: colour, depth, id, weight
    show: a picture of what was drawn: overdraw:OUT.png, how many splats each pixel blends (blue 1, red 4,
        yellow 16, white 64), or overdraw-confetti:OUT.png (blue 1, green 8, red 16); clusters:OUT.png, of a
        .chy each patch in a colour of its own; boxes:OUT.png, of a .cot or .lpc the nodes of a level with their
        boxes, boxes@3:OUT.png those of level 3 from the root; legend:OUT.png, what the colours mean, or legend,
        in the picture itself
    save_shot: all that decides the picture, as text by which conic render draws it again
    no_shot: leave out of .exr, .png and .tif what they say of how they were made
    again: draw again what a picture says that it was drawn from, to the bit; other options change that. Inputs
        are looked for beside it, here, and among those that are given
    turntable: N pictures around the scene: OUT.0001.exr …, or as OUT_%04d.exr or OUT_####.exr says
    path: pictures along a camera's way, in place of --camera: through the keys of a .json, of which each has
        time (in seconds), place, target, roll and fov (degrees), or through the cameras of a file, one a
        second; OUT.0000.exr …
    fps: pictures of a second of --path, and of a film [25]
    film: how -o OUT.mp4 or OUT.webm codes colours: by 8 or 10 bits, and with the constant quality Q, 0 to 63,
        less is better [8:17; of .webm 8:24]
    frames: only the frames A to B in steps of STEP, or A-BxSTEP; those of --turntable count from 1, those of
        --view all from 0 [all]
    resumable: keep beside the first OUT what is finished, so that --resume can go on after any end: frames in
        OUT.frames, of one --accumulate the sums in OUT.sums, and of one .exr larger than half of --memory the
        strips in OUT.strips and OUT.part
    resume: go on with what OUT.frames, OUT.sums or OUT.strips says is finished, to the bit as if it had never
        stopped; with --resumable, too, where there is none begin
    stereo: two pictures, of eyes that are E apart, in world units: OUT.left.exr and OUT.right.exr, or left and
        right in the place of %V [one]
    accumulate: the mean of N whole pictures, each with its own place in the pixel, point on the lens and moment
        [none: drawn at once]
    time: no sample is begun after S seconds [no limit]
    noise: 16, 32, 64 … samples are enough when their two halves say that the picture is E from its end, in
        luminance [none]
    preview: write the picture as it is every S seconds, too [only at the end]
    aperture: the diameter of the lens: a length, also in spacings (2x); what is out of focus blurs; of one that
        is not round the number of its corners behind it [0: a pinhole]
    focus: the depth at which all is sharp; X,Y: what is at that pixel; auto: what is in the picture's middle
        [auto]
    shutter: open from A to B, in frames from the one drawn, along a --turntable, the cameras of a file or
        --motion: 0:0.5 blurs half the way to the next; up to 100000 either way [closed]
    motion: where the inputs are at which frame, as matrices, or what shape they have, as files (JSON) [they
        stand still]
    box: of --camera top: the part of the ground that is drawn; X0,Y0,X1,Y1 for all heights [all]
    progressive: of a cloud in levels, also a picture after each level that has been read: DIR/0001.exr …
    deadline: of a cloud in levels, no more is read after so many seconds; what is missing is drawn coarser
    tolerate: of a cloud in levels, what is damaged or does not come is drawn coarser, with a warning
    memory: of a cloud in levels, what its clouds, splats and pixels may take in memory [512]; of a .chy, what
        is read and drawn [all]; of all else, twice what the pixels of one .exr may, if it is all that is
        written and has no --ao, --shadow, lamps or --accumulate [2048]
    occlusion: of a cloud in levels, do not read what is hidden behind the rest: auto, on or off; changes no bit
        of the picture [auto]
    timeout: of a URL, a server that is silent for so long is asked again, up to 4 times [15]
    ao: light from all around falls only where nothing hides it, as so many directions tell: 64 look smooth,
        1024 are exact
    shadow: the lights cast shadows, but for those at your eye
    matte_by: of Gaussian scenes, a matte for each value of a property of their .ply, as FILE/VALUE [one for
        each input]
    transparency: splats let light through as their opacity says, and meshes as the alpha of their materials and
        pictures
    catcher: of an input only the shadows that fall on it: black, and A says how dark
    holdout: an input hides what is behind it, and is not seen itself
    repeat: draw N times and report the median of the times [1]
    size: the picture's width and height in pixels; cameras of a file are scaled to it [1024x1024, or the
        file's]
    camera: cameras, in place of --azimuth and those below it: a COLMAP folder, transforms.json, cameras.json,
        .npz of viewmats and Ks, glTF, or conic's JSON; top: a map, seen from straight above, with the unit of
        the points that a pixel is wide behind it, top:0.1, or else their typical distance, and the EPSG code
        that a .tif notes, top:0.1:25832, or else the file's
    view: which of the cameras of --camera: a number from 0, the name of an image with or without its folder and
        ending, or all [the only one]; without --camera a side: front, back, left, right, top, bottom, or iso,
        from a corner
    azimuth: the camera's place around the scene: 0 in front, 90 to the right of that [30, or before what faces
        elsewhere]
    elevation: the camera's height, from -90 (below) over 0 to 90 (above) [15; 35 for what lies flat, and
        surveys]
    fov: field of view across the shorter side [40]
    zoom: multiplies the focal length: 2 shows the middle, twice as large [1]
    projection: perspective, orthographic (parallel), fisheye, panorama (all around) or cube (six sides, one
        below the other) [perspective]
    eye: the place from which the camera looks [where it sees all of the scene; a panorama's and a cube's: the
        scene's middle]
    up: what points up: x, y, z, -x … or X,Y,Z [the file's, or by its shape]
    as_: what a mesh is drawn as: auto (triangles), points (splats of the vertices), mesh or hybrid (both)
        [auto]
    texture: the picture on a mesh's surface [as its materials say]
    max_texture: what textures may take in memory together; one more is refused before it is decoded [4096]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    crease: triangles without normals look smooth over edges up to this angle, 0 to 90 degrees; 0: every face is
        flat; all: any triangles look smooth everywhere, by the mean normal of the faces about each vertex [30]
    color_by: what the points' colours are made of: rgb, intensity, height, classification, normal, or a value
        in the file by its name; auto: rgb, or else intensity [auto]
    ramp: the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or
        classes; the values at its two ends behind it, or alone [what suits, from the 2nd to the 98th
        percentile]
    where: which points are wanted, by their values: 'classification = 2, 9 and not (intensity < 100 or z > 50)'
        [all]
    place: where an input stands: a shift of 3 numbers, or 12 or 16 of a matrix, row by row, that turns, scales
        evenly and shifts [as the file has it]
    error: draw as coarsely as keeps the error on the screen below so many pixels; 0: draw all; of meshes and a
        .chy, also by how many steps colours may differ: black and white do by 100, and 2 are just visible [0:2]
    budget: draw N splats and triangles at most, those whose error is the least [all]
    cache: of --error and --budget, keep what is built of points and meshes in this folder, up to 4 GiB, and
        take it from there the next time
    only: of a .chy, draw every patch as triangles, or every one as surfels (splats) [as built]
    method: how a splat becomes pixels, from rough to exact: point, disc, affine, conic, ray; auto: conic where
        that is exact enough, else ray or, of large splats, laplace; patch: as part of a smooth surface through
        the points, with patch:D by polynomials of degree D, 1 to 4 [3], and with patch:D:H smoother than the
        length H, as 2x [auto]
    profile: how a Gaussian scene is drawn: exact, as a version of another program (inria-2023, gsplat-1.5,
        gsplat-1.5-aa, gsplat-1.6, gsplat-1.6-aa, 2dgs-2024, 2dgs-gsplat, khr-2026, inria-2023-aa, mip-2023,
        brush-1, splat-2023, playcanvas-2, spark-2, gs3d-0.4, 3dgut-2025), or surface: as opaque splats;
        inria-2023 and others that take the picture's middle for the camera's principal point do so with any
        camera where :ignore-center stands behind them [exact]
    quality: draft (--method conic, 1 sample), good (auto, 2 x 2 samples) or final (auto, 4 x 4); sketch: draft,
        of at most 30,000 of the raw points, and of levels with --error 2; --method and --samples go first
        [good]
    kernel: how a splat fades from its centre to its edge: gauss, hat, box (not at all) or confetti:A,B,N
        [gauss]
    cutoff: at how many standard deviations from its centre a splat ends [1.5]
    prefilter: the variance, in square pixels, of the blur that keeps small splats from flickering; 0: none [1;
        0 of Gaussian scenes]
    epsilon: splats so near to each other along the ray are blended as one surface: a length, also in spacings
        (2x), or auto [auto]
    passes: 3: blend the splats of a surface; 1: the nearest splat wins [3]
    samples: average N x N samples in each pixel, which makes silhouettes soft [2; 1 with --profile, --repeat or
        --deep]
    cull: back: leave out what faces away; or none [none]
    near: nothing nearer to the camera is drawn [1e-4 of the scene's diagonal]
    shade: none (colours as they are), lambert (matt), phong (with a highlight), or edl (eye-dome lighting:
        darker where what is around is nearer, by up to so many stops as stand behind it, edl:4); lambert+edl
        and phong+edl are both [phong; none for maps of what has colours]
    light: a light: X,Y,Z, the direction towards it, in the scene; camera:X,Y,Z, likewise, but it moves with the
        camera (right, up, towards you); head, at your eye; each with its colour :R,G,B behind it or without,
        and a direction then with the radius of its disc, :2deg, for soft shadows with --accumulate; lamp:X,Y,Z,
        a place, with :R,G,B of which a surface at distance 1 is lit, then :RADIUS of a ball, then :X,Y,Z where
        to it shines, for a disc or, with :WxH, a rectangle, and :X,Y,Z where to its H goes [up in the scene];
        studio, several that suit most scenes; none. Up to 8 of a direction, 8 lamps [studio]
    sky: light from all around; of two colours, the first falls on what faces up, the second on what faces down
        [the studio's]; or a picture of all directions, such as sky.exr or sky.pfm, which needs --ao
    reflect: so much of each colour, 0 to 1, is the picture of --sky as a smooth surface mirrors it; nothing
        hides it [0]
    background: linear colour behind the scene, a name as white, or #rrggbb; two go from top to bottom; none:
        transparent [dark greys in PNG and JPEG, else none]
    exposure: stops, -100 to 100: each doubles the brightness; auto: as bright as leaves 1 pixel in 20 near
        white [0]
    planes: planes: rgba, Z (depth), N (normal), albedo, weight, count, id, joined by commas, or all; P (place
        in the world); cluster of hybrids; T, medianZ, inverseZ, last, doubt of Gaussian scenes; ao and shadow,
        what light arrives; bound, how far a pixel by --error or --budget is off, for which all is drawn, too;
        motion, into .exr: pixels to the next frame, and to the one before; cryptomatte, into .exr: mattes by
        which each input, or each patch of a hybrid, is picked by its name in Nuke or Blender [rgba,Z]
    k: how many neighbours a raw point's size and normal are estimated from, 6 to 64 [20]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    tile: the edge, in pixels, of the squares that a picture is drawn in: 8, 16, 32 or 64; changes no bit of it
        [64]
    device: what draws: cpu, opencl (the first device) or opencl:P.D (see conic devices), which :gather makes go
        about it as on a GPU and :lanes as on a CPU; changes no bit of the picture; with :inexact behind it also
        one whose rounding makes the picture another one [cpu]
    plain: draw as the library does by default: of a mesh the vertices, framed by a sphere, with a headlight and
        one sample
    isa: the processor's instructions: auto, scalar, sse2, avx2, avx512, neon; changes no bit of the picture
        [auto]
    threads: how many threads compute; the results never depend on it [0: all]
    """


def turntable(
    scene: AnyScene,
    n: int = 36,
    camera: Optional[AnyCamera] = None,
    **options: Options,
) -> List[Picture]:
    """Draws `n` pictures around a scene, evenly apart: :func:`render` with `turntable=n`, whose other options are taken
    by their names, such as `size=(640, 480)`. Returns a list of :class:`Picture`, (H, W, 4) and (H, W) as there.
    """


def verify(
    scene: AnyScene,
    camera: Optional[AnyCamera] = None,
    *,
    image: Optional[PathLike] = None,
    progress: Any = None,
    threads: Optional[int] = None,
    against: Optional[Literal["method", "exact"]] = None,
    pixels: Optional[Union[int, str]] = None,
    sample: Optional[Union[int, str]] = None,
    aperture: Optional[Union[str, float, Sequence[float]]] = None,
    focus: Optional[Union[str, float, Sequence[float]]] = None,
    shutter: Optional[Union[str, float, Sequence[float]]] = None,
    motion: Optional[PathLike] = None,
    turntable: Optional[Union[str, float, Sequence[float]]] = None,
    frames: Optional[Union[str, float, Sequence[float]]] = None,
    accumulate: Optional[Union[int, str]] = None,
    transparency: Optional[bool] = None,
    size: Optional[Union[str, Sequence[int]]] = None,
    view: Optional[Union[str, float, Sequence[float]]] = None,
    azimuth: Optional[float] = None,
    elevation: Optional[float] = None,
    fov: Optional[float] = None,
    zoom: Optional[float] = None,
    projection: Optional[Literal["perspective", "fisheye", "orthographic", "panorama", "cube"]] = None,
    eye: Optional[Union[str, float, Sequence[float]]] = None,
    up: Optional[Union[str, float, Sequence[float]]] = None,
    as_: Optional[Literal["auto", "points", "mesh", "hybrid"]] = None,
    texture: Optional[PathLike] = None,
    max_texture: Optional[int] = None,
    allow_outside: Optional[bool] = None,
    crease: Optional[Union[str, float, Sequence[float]]] = None,
    color_by: Optional[PathLike] = None,
    ramp: Optional[Union[str, float, Sequence[float]]] = None,
    where: Optional[PathLike] = None,
    place: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    error: Optional[float] = None,
    budget: Optional[Union[int, str]] = None,
    cache: Optional[PathLike] = None,
    only: Optional[Literal["triangles", "surfels"]] = None,
    method: Optional[Literal["conic", "ray", "affine", "point", "disc", "auto", "patch"]] = None,
    profile: Optional[Literal["exact", "inria-2023", "gsplat-1.5", "gsplat-1.5-aa", "gsplat-1.6", "gsplat-1.6-aa",
        "2dgs-2024", "2dgs-gsplat", "khr-2026", "inria-2023-aa", "mip-2023", "brush-1", "splat-2023",
        "playcanvas-2", "spark-2", "gs3d-0.4", "3dgut-2025", "surface"]] = None,
    quality: Optional[Literal["draft", "good", "final", "sketch"]] = None,
    kernel: Optional[Union[str, float, Sequence[float]]] = None,
    cutoff: Optional[float] = None,
    prefilter: Optional[float] = None,
    epsilon: Optional[Union[str, float, Sequence[float]]] = None,
    passes: Optional[int] = None,
    samples: Optional[int] = None,
    cull: Optional[Literal["none", "back"]] = None,
    near: Optional[Union[str, float, Sequence[float]]] = None,
    shade: Optional[Literal["none", "lambert", "phong", "edl", "lambert+edl", "phong+edl"]] = None,
    light: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    sky: Optional[Union[str, float, Sequence[float]]] = None,
    reflect: Optional[float] = None,
    background: Optional[Union[str, float, Sequence[float]]] = None,
    exposure: Optional[Union[str, float, Sequence[float]]] = None,
    planes: Optional[Union[str, float, Sequence[float]]] = None,
    k: Optional[int] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    tile: Optional[int] = None,
    device: Optional[Union[str, float, Sequence[float]]] = None,
    plain: Optional[bool] = None,
    isa: Optional[Literal["auto", "scalar", "sse2", "avx2", "avx512", "neon"]] = None,
) -> Dict[str, Any]:
    """Holds a picture against the double-precision oracle: conic's own, or `image`, a file or arrays, of whatever
    renderer. `against="exact"` asks whether the method is right, and not only its arithmetic. See "pass".

    Options:

    against: method: its own formula in double precision; exact: the kernel itself, projected and filtered
        [method]
    image: the picture to verify, of whatever renderer [drawn anew]
    pixels: judge this many pixels, spread evenly; always the same ones [all]
    sample: of conic render --accumulate, sample I, from 0, instead of a picture that is drawn at once
    aperture: the diameter of the lens: a length, also in spacings (2x); what is out of focus blurs; of one that
        is not round the number of its corners behind it [0: a pinhole]
    focus: the depth at which all is sharp; X,Y: what is at that pixel; auto: what is in the picture's middle
        [auto]
    shutter: open from A to B, in frames from the one drawn, along a --turntable, the cameras of a file or
        --motion: 0:0.5 blurs half the way to the next; up to 100000 either way [closed]
    motion: where the inputs are at which frame, as matrices, or what shape they have, as files (JSON) [they
        stand still]
    turntable: the picture is one of N around the scene
    frames: of --turntable, which, from 1 [1]
    accumulate: as conic render has it: judge the mean of N samples, and where they are drawn anew, each of
        them, too
    transparency: as conic render has it: surfaces among Gaussians let light through, each sample by chance
    size: the picture's width and height in pixels; cameras of a file are scaled to it [1024x1024, or the
        file's]
    camera: cameras, in place of --azimuth and those below it: a COLMAP folder, transforms.json, cameras.json,
        .npz of viewmats and Ks, glTF, or conic's JSON; top: a map, seen from straight above, with the unit of
        the points that a pixel is wide behind it, top:0.1, or else their typical distance, and the EPSG code
        that a .tif notes, top:0.1:25832, or else the file's
    view: which of the cameras of --camera: a number from 0, the name of an image with or without its folder and
        ending, or all [the only one]; without --camera a side: front, back, left, right, top, bottom, or iso,
        from a corner
    azimuth: the camera's place around the scene: 0 in front, 90 to the right of that [30, or before what faces
        elsewhere]
    elevation: the camera's height, from -90 (below) over 0 to 90 (above) [15; 35 for what lies flat, and
        surveys]
    fov: field of view across the shorter side [40]
    zoom: multiplies the focal length: 2 shows the middle, twice as large [1]
    projection: perspective, orthographic (parallel), fisheye, panorama (all around) or cube (six sides, one
        below the other) [perspective]
    eye: the place from which the camera looks [where it sees all of the scene; a panorama's and a cube's: the
        scene's middle]
    up: what points up: x, y, z, -x … or X,Y,Z [the file's, or by its shape]
    as_: what a mesh is drawn as: auto (triangles), points (splats of the vertices), mesh or hybrid (both)
        [auto]
    texture: the picture on a mesh's surface [as its materials say]
    max_texture: what textures may take in memory together; one more is refused before it is decoded [4096]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    crease: triangles without normals look smooth over edges up to this angle, 0 to 90 degrees; 0: every face is
        flat; all: any triangles look smooth everywhere, by the mean normal of the faces about each vertex [30]
    color_by: what the points' colours are made of: rgb, intensity, height, classification, normal, or a value
        in the file by its name; auto: rgb, or else intensity [auto]
    ramp: the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or
        classes; the values at its two ends behind it, or alone [what suits, from the 2nd to the 98th
        percentile]
    where: which points are wanted, by their values: 'classification = 2, 9 and not (intensity < 100 or z > 50)'
        [all]
    place: where an input stands: a shift of 3 numbers, or 12 or 16 of a matrix, row by row, that turns, scales
        evenly and shifts [as the file has it]
    error: draw as coarsely as keeps the error on the screen below so many pixels; 0: draw all; of meshes and a
        .chy, also by how many steps colours may differ: black and white do by 100, and 2 are just visible [0:2]
    budget: draw N splats and triangles at most, those whose error is the least [all]
    cache: of --error and --budget, keep what is built of points and meshes in this folder, up to 4 GiB, and
        take it from there the next time
    only: of a .chy, draw every patch as triangles, or every one as surfels (splats) [as built]
    method: how a splat becomes pixels, from rough to exact: point, disc, affine, conic, ray; auto: conic where
        that is exact enough, else ray or, of large splats, laplace; patch: as part of a smooth surface through
        the points, with patch:D by polynomials of degree D, 1 to 4 [3], and with patch:D:H smoother than the
        length H, as 2x [auto]
    profile: how a Gaussian scene is drawn: exact, as a version of another program (inria-2023, gsplat-1.5,
        gsplat-1.5-aa, gsplat-1.6, gsplat-1.6-aa, 2dgs-2024, 2dgs-gsplat, khr-2026, inria-2023-aa, mip-2023,
        brush-1, splat-2023, playcanvas-2, spark-2, gs3d-0.4, 3dgut-2025), or surface: as opaque splats;
        inria-2023 and others that take the picture's middle for the camera's principal point do so with any
        camera where :ignore-center stands behind them [exact]
    quality: draft (--method conic, 1 sample), good (auto, 2 x 2 samples) or final (auto, 4 x 4); sketch: draft,
        of at most 30,000 of the raw points, and of levels with --error 2; --method and --samples go first
        [good]
    kernel: how a splat fades from its centre to its edge: gauss, hat, box (not at all) or confetti:A,B,N
        [gauss]
    cutoff: at how many standard deviations from its centre a splat ends [1.5]
    prefilter: the variance, in square pixels, of the blur that keeps small splats from flickering; 0: none [1;
        0 of Gaussian scenes]
    epsilon: splats so near to each other along the ray are blended as one surface: a length, also in spacings
        (2x), or auto [auto]
    passes: 3: blend the splats of a surface; 1: the nearest splat wins [3]
    samples: average N x N samples in each pixel, which makes silhouettes soft [2; 1 with --profile, --repeat or
        --deep]
    cull: back: leave out what faces away; or none [none]
    near: nothing nearer to the camera is drawn [1e-4 of the scene's diagonal]
    shade: none (colours as they are), lambert (matt), phong (with a highlight), or edl (eye-dome lighting:
        darker where what is around is nearer, by up to so many stops as stand behind it, edl:4); lambert+edl
        and phong+edl are both [phong; none for maps of what has colours]
    light: a light: X,Y,Z, the direction towards it, in the scene; camera:X,Y,Z, likewise, but it moves with the
        camera (right, up, towards you); head, at your eye; each with its colour :R,G,B behind it or without,
        and a direction then with the radius of its disc, :2deg, for soft shadows with --accumulate; lamp:X,Y,Z,
        a place, with :R,G,B of which a surface at distance 1 is lit, then :RADIUS of a ball, then :X,Y,Z where
        to it shines, for a disc or, with :WxH, a rectangle, and :X,Y,Z where to its H goes [up in the scene];
        studio, several that suit most scenes; none. Up to 8 of a direction, 8 lamps [studio]
    sky: light from all around; of two colours, the first falls on what faces up, the second on what faces down
        [the studio's]; or a picture of all directions, such as sky.exr or sky.pfm, which needs --ao
    reflect: so much of each colour, 0 to 1, is the picture of --sky as a smooth surface mirrors it; nothing
        hides it [0]
    background: linear colour behind the scene, a name as white, or #rrggbb; two go from top to bottom; none:
        transparent [dark greys in PNG and JPEG, else none]
    exposure: stops, -100 to 100: each doubles the brightness; auto: as bright as leaves 1 pixel in 20 near
        white [0]
    planes: planes: rgba, Z (depth), N (normal), albedo, weight, count, id, joined by commas, or all; P (place
        in the world); cluster of hybrids; T, medianZ, inverseZ, last, doubt of Gaussian scenes; ao and shadow,
        what light arrives; bound, how far a pixel by --error or --budget is off, for which all is drawn, too;
        motion, into .exr: pixels to the next frame, and to the one before; cryptomatte, into .exr: mattes by
        which each input, or each patch of a hybrid, is picked by its name in Nuke or Blender [rgba,Z]
    k: how many neighbours a raw point's size and normal are estimated from, 6 to 64 [20]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    tile: the edge, in pixels, of the squares that a picture is drawn in: 8, 16, 32 or 64; changes no bit of it
        [64]
    device: what draws: cpu, opencl (the first device) or opencl:P.D (see conic devices), which :gather makes go
        about it as on a GPU and :lanes as on a CPU; changes no bit of the picture; with :inexact behind it also
        one whose rounding makes the picture another one [cpu]
    plain: draw as the library does by default: of a mesh the vertices, framed by a sphere, with a headlight and
        one sample
    isa: the processor's instructions: auto, scalar, sse2, avx2, avx512, neon; changes no bit of the picture
        [auto]
    threads: how many threads compute; the results never depend on it [0: all]
    """


def judge(
    scene: AnyScene,
    camera: AnyCamera,
    picture: Any,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    floats: Optional[Literal["own", "strict", "fast"]] = None,
    max_wrong: Optional[Union[int, str]] = None,
    pixels: Optional[Union[int, str]] = None,
    map: Optional[PathLike] = None,
    report: Optional[PathLike] = None,
    transfer: Optional[Literal["linear", "srgb"]] = None,
    codes: Optional[Literal["either", "nearest", "down"]] = None,
    clipped: Optional[bool] = None,
    straight: Optional[bool] = None,
    no_diagnosis: Optional[bool] = None,
    allow_vague: Optional[bool] = None,
    time: Optional[bool] = None,
    suite: Optional[PathLike] = None,
    pictures: Optional[PathLike] = None,
    level: Optional[int] = None,
    junit: Optional[PathLike] = None,
    gradients: Optional[PathLike] = None,
    weights: Optional[PathLike] = None,
    raw: Optional[bool] = None,
    intermediates: Optional[PathLike] = None,
    size: Optional[Union[str, Sequence[int]]] = None,
    view: Optional[Union[str, float, Sequence[float]]] = None,
    azimuth: Optional[float] = None,
    elevation: Optional[float] = None,
    fov: Optional[float] = None,
    zoom: Optional[float] = None,
    projection: Optional[Literal["perspective", "fisheye", "orthographic", "panorama", "cube"]] = None,
    eye: Optional[Union[str, float, Sequence[float]]] = None,
    up: Optional[Union[str, float, Sequence[float]]] = None,
    as_: Optional[Literal["auto", "points", "mesh", "hybrid"]] = None,
    texture: Optional[PathLike] = None,
    max_texture: Optional[int] = None,
    allow_outside: Optional[bool] = None,
    crease: Optional[Union[str, float, Sequence[float]]] = None,
    color_by: Optional[PathLike] = None,
    ramp: Optional[Union[str, float, Sequence[float]]] = None,
    where: Optional[PathLike] = None,
    place: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    error: Optional[float] = None,
    budget: Optional[Union[int, str]] = None,
    cache: Optional[PathLike] = None,
    only: Optional[Literal["triangles", "surfels"]] = None,
    method: Optional[Literal["conic", "ray", "affine", "point", "disc", "auto", "patch"]] = None,
    profile: Optional[Literal["exact", "inria-2023", "gsplat-1.5", "gsplat-1.5-aa", "gsplat-1.6", "gsplat-1.6-aa",
        "2dgs-2024", "2dgs-gsplat", "khr-2026", "inria-2023-aa", "mip-2023", "brush-1", "splat-2023",
        "playcanvas-2", "spark-2", "gs3d-0.4", "3dgut-2025", "surface"]] = None,
    quality: Optional[Literal["draft", "good", "final", "sketch"]] = None,
    kernel: Optional[Union[str, float, Sequence[float]]] = None,
    cutoff: Optional[float] = None,
    prefilter: Optional[float] = None,
    epsilon: Optional[Union[str, float, Sequence[float]]] = None,
    passes: Optional[int] = None,
    samples: Optional[int] = None,
    cull: Optional[Literal["none", "back"]] = None,
    near: Optional[Union[str, float, Sequence[float]]] = None,
    shade: Optional[Literal["none", "lambert", "phong", "edl", "lambert+edl", "phong+edl"]] = None,
    light: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    sky: Optional[Union[str, float, Sequence[float]]] = None,
    reflect: Optional[float] = None,
    background: Optional[Union[str, float, Sequence[float]]] = None,
    exposure: Optional[Union[str, float, Sequence[float]]] = None,
    planes: Optional[Union[str, float, Sequence[float]]] = None,
    k: Optional[int] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    tile: Optional[int] = None,
    device: Optional[Union[str, float, Sequence[float]]] = None,
    plain: Optional[bool] = None,
    isa: Optional[Literal["auto", "scalar", "sse2", "avx2", "avx512", "neon"]] = None,
) -> Dict[str, Any]:
    """Whether another renderer's picture is what its profile, or its method, makes of the scene.

    `picture`: a file, an array (H, W, 3 or 4) of floats or bytes, or a dict of planes. `report` and `map` name files
    to write, `max_wrong` how many pixels may be wrong (0). The answer has "verdict" ("right" or "wrong"), "pixels"
    by class, and a "diagnosis".

    Options:

    picture: what is judged: EXR, PFM or NPY (with planes beside it, P.Z.npy …), NPZ, or PNG
    floats: of what drew it: own (conic's), strict (all in float, in any order), or fast (and a GPU's fast
        exponential) [fast]
    max_wrong: so many pixels may be wrong [0]
    pixels: judge this many pixels, spread evenly; always the same ones [all]
    map: the class of every pixel in false colours, with a legend
    report: a page with all that was found, pictures and all
    transfer: codes of 8 or 16 bits: linear (code / 255) or srgb (decoded) [linear of Gaussian scenes, else
        srgb]
    codes: codes were rounded to the nearest, down, or either [either]
    clipped: colours of 0 and 1 stand for what is beyond, in floats, too
    straight: colours are not multiplied by alpha; of a PNG they never are
    no_diagnosis: don't look for the mistake that explains wrong pixels, which may take longer than judging them
    allow_vague: a picture may be right although more than 1 % of its pixels may be anything within more than
        1/255
    time: print what each stage took
    suite: judge what conic conformance wrote, in the place of a scene
    pictures: of a suite: where CASE.exr, .pfm, .npy, .npz or .png are, planes beside them
    level: of a suite: only cases up to this level [all]
    junit: of a suite: the cases as JUnit's XML, as CI systems take it
    gradients: judge a derivative, in the place of a picture: .ply as conic gradient's, or .npz
    weights: of --gradients: W of L = sum W C, as conic gradient has it
    raw: of --gradients: they are by ln s and logit o
    intermediates: judge means2d, conics, isect_ids … in the place of a picture, as conic project has them
    size: the picture's width and height in pixels; cameras of a file are scaled to it [1024x1024, or the
        file's]
    camera: cameras, in place of --azimuth and those below it: a COLMAP folder, transforms.json, cameras.json,
        .npz of viewmats and Ks, glTF, or conic's JSON; top: a map, seen from straight above, with the unit of
        the points that a pixel is wide behind it, top:0.1, or else their typical distance, and the EPSG code
        that a .tif notes, top:0.1:25832, or else the file's
    view: which of the cameras of --camera: a number from 0, the name of an image with or without its folder and
        ending, or all [the only one]; without --camera a side: front, back, left, right, top, bottom, or iso,
        from a corner
    azimuth: the camera's place around the scene: 0 in front, 90 to the right of that [30, or before what faces
        elsewhere]
    elevation: the camera's height, from -90 (below) over 0 to 90 (above) [15; 35 for what lies flat, and
        surveys]
    fov: field of view across the shorter side [40]
    zoom: multiplies the focal length: 2 shows the middle, twice as large [1]
    projection: perspective, orthographic (parallel), fisheye, panorama (all around) or cube (six sides, one
        below the other) [perspective]
    eye: the place from which the camera looks [where it sees all of the scene; a panorama's and a cube's: the
        scene's middle]
    up: what points up: x, y, z, -x … or X,Y,Z [the file's, or by its shape]
    as_: what a mesh is drawn as: auto (triangles), points (splats of the vertices), mesh or hybrid (both)
        [auto]
    texture: the picture on a mesh's surface [as its materials say]
    max_texture: what textures may take in memory together; one more is refused before it is decoded [4096]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    crease: triangles without normals look smooth over edges up to this angle, 0 to 90 degrees; 0: every face is
        flat; all: any triangles look smooth everywhere, by the mean normal of the faces about each vertex [30]
    color_by: what the points' colours are made of: rgb, intensity, height, classification, normal, or a value
        in the file by its name; auto: rgb, or else intensity [auto]
    ramp: the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or
        classes; the values at its two ends behind it, or alone [what suits, from the 2nd to the 98th
        percentile]
    where: which points are wanted, by their values: 'classification = 2, 9 and not (intensity < 100 or z > 50)'
        [all]
    place: where an input stands: a shift of 3 numbers, or 12 or 16 of a matrix, row by row, that turns, scales
        evenly and shifts [as the file has it]
    error: draw as coarsely as keeps the error on the screen below so many pixels; 0: draw all; of meshes and a
        .chy, also by how many steps colours may differ: black and white do by 100, and 2 are just visible [0:2]
    budget: draw N splats and triangles at most, those whose error is the least [all]
    cache: of --error and --budget, keep what is built of points and meshes in this folder, up to 4 GiB, and
        take it from there the next time
    only: of a .chy, draw every patch as triangles, or every one as surfels (splats) [as built]
    method: how a splat becomes pixels, from rough to exact: point, disc, affine, conic, ray; auto: conic where
        that is exact enough, else ray or, of large splats, laplace; patch: as part of a smooth surface through
        the points, with patch:D by polynomials of degree D, 1 to 4 [3], and with patch:D:H smoother than the
        length H, as 2x [auto]
    profile: how a Gaussian scene is drawn: exact, as a version of another program (inria-2023, gsplat-1.5,
        gsplat-1.5-aa, gsplat-1.6, gsplat-1.6-aa, 2dgs-2024, 2dgs-gsplat, khr-2026, inria-2023-aa, mip-2023,
        brush-1, splat-2023, playcanvas-2, spark-2, gs3d-0.4, 3dgut-2025), or surface: as opaque splats;
        inria-2023 and others that take the picture's middle for the camera's principal point do so with any
        camera where :ignore-center stands behind them [exact]
    quality: draft (--method conic, 1 sample), good (auto, 2 x 2 samples) or final (auto, 4 x 4); sketch: draft,
        of at most 30,000 of the raw points, and of levels with --error 2; --method and --samples go first
        [good]
    kernel: how a splat fades from its centre to its edge: gauss, hat, box (not at all) or confetti:A,B,N
        [gauss]
    cutoff: at how many standard deviations from its centre a splat ends [1.5]
    prefilter: the variance, in square pixels, of the blur that keeps small splats from flickering; 0: none [1;
        0 of Gaussian scenes]
    epsilon: splats so near to each other along the ray are blended as one surface: a length, also in spacings
        (2x), or auto [auto]
    passes: 3: blend the splats of a surface; 1: the nearest splat wins [3]
    samples: average N x N samples in each pixel, which makes silhouettes soft [2; 1 with --profile, --repeat or
        --deep]
    cull: back: leave out what faces away; or none [none]
    near: nothing nearer to the camera is drawn [1e-4 of the scene's diagonal]
    shade: none (colours as they are), lambert (matt), phong (with a highlight), or edl (eye-dome lighting:
        darker where what is around is nearer, by up to so many stops as stand behind it, edl:4); lambert+edl
        and phong+edl are both [phong; none for maps of what has colours]
    light: a light: X,Y,Z, the direction towards it, in the scene; camera:X,Y,Z, likewise, but it moves with the
        camera (right, up, towards you); head, at your eye; each with its colour :R,G,B behind it or without,
        and a direction then with the radius of its disc, :2deg, for soft shadows with --accumulate; lamp:X,Y,Z,
        a place, with :R,G,B of which a surface at distance 1 is lit, then :RADIUS of a ball, then :X,Y,Z where
        to it shines, for a disc or, with :WxH, a rectangle, and :X,Y,Z where to its H goes [up in the scene];
        studio, several that suit most scenes; none. Up to 8 of a direction, 8 lamps [studio]
    sky: light from all around; of two colours, the first falls on what faces up, the second on what faces down
        [the studio's]; or a picture of all directions, such as sky.exr or sky.pfm, which needs --ao
    reflect: so much of each colour, 0 to 1, is the picture of --sky as a smooth surface mirrors it; nothing
        hides it [0]
    background: linear colour behind the scene, a name as white, or #rrggbb; two go from top to bottom; none:
        transparent [dark greys in PNG and JPEG, else none]
    exposure: stops, -100 to 100: each doubles the brightness; auto: as bright as leaves 1 pixel in 20 near
        white [0]
    planes: planes: rgba, Z (depth), N (normal), albedo, weight, count, id, joined by commas, or all; P (place
        in the world); cluster of hybrids; T, medianZ, inverseZ, last, doubt of Gaussian scenes; ao and shadow,
        what light arrives; bound, how far a pixel by --error or --budget is off, for which all is drawn, too;
        motion, into .exr: pixels to the next frame, and to the one before; cryptomatte, into .exr: mattes by
        which each input, or each patch of a hybrid, is picked by its name in Nuke or Blender [rgba,Z]
    k: how many neighbours a raw point's size and normal are estimated from, 6 to 64 [20]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    tile: the edge, in pixels, of the squares that a picture is drawn in: 8, 16, 32 or 64; changes no bit of it
        [64]
    device: what draws: cpu, opencl (the first device) or opencl:P.D (see conic devices), which :gather makes go
        about it as on a GPU and :lanes as on a CPU; changes no bit of the picture; with :inexact behind it also
        one whose rounding makes the picture another one [cpu]
    plain: draw as the library does by default: of a mesh the vertices, framed by a sphere, with a headlight and
        one sample
    isa: the processor's instructions: auto, scalar, sse2, avx2, avx512, neon; changes no bit of the picture
        [auto]
    threads: how many threads compute; the results never depend on it [0: all]
    """


def project(
    scene: AnyScene,
    camera: AnyCamera,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    floats: Optional[Literal["own", "strict", "fast"]] = None,
    size: Optional[Union[str, Sequence[int]]] = None,
    view: Optional[Union[str, float, Sequence[float]]] = None,
    azimuth: Optional[float] = None,
    elevation: Optional[float] = None,
    fov: Optional[float] = None,
    zoom: Optional[float] = None,
    projection: Optional[Literal["perspective", "fisheye", "orthographic", "panorama", "cube"]] = None,
    eye: Optional[Union[str, float, Sequence[float]]] = None,
    up: Optional[Union[str, float, Sequence[float]]] = None,
    as_: Optional[Literal["auto", "points", "mesh", "hybrid"]] = None,
    texture: Optional[PathLike] = None,
    max_texture: Optional[int] = None,
    allow_outside: Optional[bool] = None,
    crease: Optional[Union[str, float, Sequence[float]]] = None,
    color_by: Optional[PathLike] = None,
    ramp: Optional[Union[str, float, Sequence[float]]] = None,
    where: Optional[PathLike] = None,
    place: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    error: Optional[float] = None,
    budget: Optional[Union[int, str]] = None,
    cache: Optional[PathLike] = None,
    only: Optional[Literal["triangles", "surfels"]] = None,
    method: Optional[Literal["conic", "ray", "affine", "point", "disc", "auto", "patch"]] = None,
    profile: Optional[Literal["exact", "inria-2023", "gsplat-1.5", "gsplat-1.5-aa", "gsplat-1.6", "gsplat-1.6-aa",
        "2dgs-2024", "2dgs-gsplat", "khr-2026", "inria-2023-aa", "mip-2023", "brush-1", "splat-2023",
        "playcanvas-2", "spark-2", "gs3d-0.4", "3dgut-2025", "surface"]] = None,
    quality: Optional[Literal["draft", "good", "final", "sketch"]] = None,
    kernel: Optional[Union[str, float, Sequence[float]]] = None,
    cutoff: Optional[float] = None,
    prefilter: Optional[float] = None,
    epsilon: Optional[Union[str, float, Sequence[float]]] = None,
    passes: Optional[int] = None,
    samples: Optional[int] = None,
    cull: Optional[Literal["none", "back"]] = None,
    near: Optional[Union[str, float, Sequence[float]]] = None,
    shade: Optional[Literal["none", "lambert", "phong", "edl", "lambert+edl", "phong+edl"]] = None,
    light: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    sky: Optional[Union[str, float, Sequence[float]]] = None,
    reflect: Optional[float] = None,
    background: Optional[Union[str, float, Sequence[float]]] = None,
    exposure: Optional[Union[str, float, Sequence[float]]] = None,
    planes: Optional[Union[str, float, Sequence[float]]] = None,
    k: Optional[int] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    tile: Optional[int] = None,
    device: Optional[Union[str, float, Sequence[float]]] = None,
    plain: Optional[bool] = None,
    isa: Optional[Literal["auto", "scalar", "sse2", "avx2", "avx512", "neon"]] = None,
) -> Dict[str, numpy.ndarray]:
    """What a profile makes of each Gaussian before it is composited, by gsplat's names: "radii", "means2d", "depths",
    "conics", "opacities", "colors", "isect_ids", "flatten_ids" …, and what floats may make of them: "means2d_low",
    "means2d_high" …

    Options:

    output: all arrays by gsplat's names, and their ranges: .npz; or .csv, without lists
    floats: whose roundings the ranges are of: own, strict or fast (a GPU's) [fast]
    size: the picture's width and height in pixels; cameras of a file are scaled to it [1024x1024, or the
        file's]
    camera: cameras, in place of --azimuth and those below it: a COLMAP folder, transforms.json, cameras.json,
        .npz of viewmats and Ks, glTF, or conic's JSON; top: a map, seen from straight above, with the unit of
        the points that a pixel is wide behind it, top:0.1, or else their typical distance, and the EPSG code
        that a .tif notes, top:0.1:25832, or else the file's
    view: which of the cameras of --camera: a number from 0, the name of an image with or without its folder and
        ending, or all [the only one]; without --camera a side: front, back, left, right, top, bottom, or iso,
        from a corner
    azimuth: the camera's place around the scene: 0 in front, 90 to the right of that [30, or before what faces
        elsewhere]
    elevation: the camera's height, from -90 (below) over 0 to 90 (above) [15; 35 for what lies flat, and
        surveys]
    fov: field of view across the shorter side [40]
    zoom: multiplies the focal length: 2 shows the middle, twice as large [1]
    projection: perspective, orthographic (parallel), fisheye, panorama (all around) or cube (six sides, one
        below the other) [perspective]
    eye: the place from which the camera looks [where it sees all of the scene; a panorama's and a cube's: the
        scene's middle]
    up: what points up: x, y, z, -x … or X,Y,Z [the file's, or by its shape]
    as_: what a mesh is drawn as: auto (triangles), points (splats of the vertices), mesh or hybrid (both)
        [auto]
    texture: the picture on a mesh's surface [as its materials say]
    max_texture: what textures may take in memory together; one more is refused before it is decoded [4096]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    crease: triangles without normals look smooth over edges up to this angle, 0 to 90 degrees; 0: every face is
        flat; all: any triangles look smooth everywhere, by the mean normal of the faces about each vertex [30]
    color_by: what the points' colours are made of: rgb, intensity, height, classification, normal, or a value
        in the file by its name; auto: rgb, or else intensity [auto]
    ramp: the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or
        classes; the values at its two ends behind it, or alone [what suits, from the 2nd to the 98th
        percentile]
    where: which points are wanted, by their values: 'classification = 2, 9 and not (intensity < 100 or z > 50)'
        [all]
    place: where an input stands: a shift of 3 numbers, or 12 or 16 of a matrix, row by row, that turns, scales
        evenly and shifts [as the file has it]
    error: draw as coarsely as keeps the error on the screen below so many pixels; 0: draw all; of meshes and a
        .chy, also by how many steps colours may differ: black and white do by 100, and 2 are just visible [0:2]
    budget: draw N splats and triangles at most, those whose error is the least [all]
    cache: of --error and --budget, keep what is built of points and meshes in this folder, up to 4 GiB, and
        take it from there the next time
    only: of a .chy, draw every patch as triangles, or every one as surfels (splats) [as built]
    method: how a splat becomes pixels, from rough to exact: point, disc, affine, conic, ray; auto: conic where
        that is exact enough, else ray or, of large splats, laplace; patch: as part of a smooth surface through
        the points, with patch:D by polynomials of degree D, 1 to 4 [3], and with patch:D:H smoother than the
        length H, as 2x [auto]
    profile: how a Gaussian scene is drawn: exact, as a version of another program (inria-2023, gsplat-1.5,
        gsplat-1.5-aa, gsplat-1.6, gsplat-1.6-aa, 2dgs-2024, 2dgs-gsplat, khr-2026, inria-2023-aa, mip-2023,
        brush-1, splat-2023, playcanvas-2, spark-2, gs3d-0.4, 3dgut-2025), or surface: as opaque splats;
        inria-2023 and others that take the picture's middle for the camera's principal point do so with any
        camera where :ignore-center stands behind them [exact]
    quality: draft (--method conic, 1 sample), good (auto, 2 x 2 samples) or final (auto, 4 x 4); sketch: draft,
        of at most 30,000 of the raw points, and of levels with --error 2; --method and --samples go first
        [good]
    kernel: how a splat fades from its centre to its edge: gauss, hat, box (not at all) or confetti:A,B,N
        [gauss]
    cutoff: at how many standard deviations from its centre a splat ends [1.5]
    prefilter: the variance, in square pixels, of the blur that keeps small splats from flickering; 0: none [1;
        0 of Gaussian scenes]
    epsilon: splats so near to each other along the ray are blended as one surface: a length, also in spacings
        (2x), or auto [auto]
    passes: 3: blend the splats of a surface; 1: the nearest splat wins [3]
    samples: average N x N samples in each pixel, which makes silhouettes soft [2; 1 with --profile, --repeat or
        --deep]
    cull: back: leave out what faces away; or none [none]
    near: nothing nearer to the camera is drawn [1e-4 of the scene's diagonal]
    shade: none (colours as they are), lambert (matt), phong (with a highlight), or edl (eye-dome lighting:
        darker where what is around is nearer, by up to so many stops as stand behind it, edl:4); lambert+edl
        and phong+edl are both [phong; none for maps of what has colours]
    light: a light: X,Y,Z, the direction towards it, in the scene; camera:X,Y,Z, likewise, but it moves with the
        camera (right, up, towards you); head, at your eye; each with its colour :R,G,B behind it or without,
        and a direction then with the radius of its disc, :2deg, for soft shadows with --accumulate; lamp:X,Y,Z,
        a place, with :R,G,B of which a surface at distance 1 is lit, then :RADIUS of a ball, then :X,Y,Z where
        to it shines, for a disc or, with :WxH, a rectangle, and :X,Y,Z where to its H goes [up in the scene];
        studio, several that suit most scenes; none. Up to 8 of a direction, 8 lamps [studio]
    sky: light from all around; of two colours, the first falls on what faces up, the second on what faces down
        [the studio's]; or a picture of all directions, such as sky.exr or sky.pfm, which needs --ao
    reflect: so much of each colour, 0 to 1, is the picture of --sky as a smooth surface mirrors it; nothing
        hides it [0]
    background: linear colour behind the scene, a name as white, or #rrggbb; two go from top to bottom; none:
        transparent [dark greys in PNG and JPEG, else none]
    exposure: stops, -100 to 100: each doubles the brightness; auto: as bright as leaves 1 pixel in 20 near
        white [0]
    planes: planes: rgba, Z (depth), N (normal), albedo, weight, count, id, joined by commas, or all; P (place
        in the world); cluster of hybrids; T, medianZ, inverseZ, last, doubt of Gaussian scenes; ao and shadow,
        what light arrives; bound, how far a pixel by --error or --budget is off, for which all is drawn, too;
        motion, into .exr: pixels to the next frame, and to the one before; cryptomatte, into .exr: mattes by
        which each input, or each patch of a hybrid, is picked by its name in Nuke or Blender [rgba,Z]
    k: how many neighbours a raw point's size and normal are estimated from, 6 to 64 [20]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    tile: the edge, in pixels, of the squares that a picture is drawn in: 8, 16, 32 or 64; changes no bit of it
        [64]
    device: what draws: cpu, opencl (the first device) or opencl:P.D (see conic devices), which :gather makes go
        about it as on a GPU and :lanes as on a CPU; changes no bit of the picture; with :inexact behind it also
        one whose rounding makes the picture another one [cpu]
    plain: draw as the library does by default: of a mesh the vertices, framed by a sphere, with a headlight and
        one sample
    isa: the processor's instructions: auto, scalar, sse2, avx2, avx512, neon; changes no bit of the picture
        [auto]
    threads: how many threads compute; the results never depend on it [0: all]
    """


def judge_intermediates(
    scene: AnyScene,
    camera: AnyCamera,
    arrays: Dict[str, Any],
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    picture: Optional[PathLike] = None,
    floats: Optional[Literal["own", "strict", "fast"]] = None,
    max_wrong: Optional[Union[int, str]] = None,
    pixels: Optional[Union[int, str]] = None,
    map: Optional[PathLike] = None,
    report: Optional[PathLike] = None,
    transfer: Optional[Literal["linear", "srgb"]] = None,
    codes: Optional[Literal["either", "nearest", "down"]] = None,
    clipped: Optional[bool] = None,
    straight: Optional[bool] = None,
    no_diagnosis: Optional[bool] = None,
    allow_vague: Optional[bool] = None,
    time: Optional[bool] = None,
    suite: Optional[PathLike] = None,
    pictures: Optional[PathLike] = None,
    level: Optional[int] = None,
    junit: Optional[PathLike] = None,
    gradients: Optional[PathLike] = None,
    weights: Optional[PathLike] = None,
    raw: Optional[bool] = None,
    intermediates: Optional[PathLike] = None,
    size: Optional[Union[str, Sequence[int]]] = None,
    view: Optional[Union[str, float, Sequence[float]]] = None,
    azimuth: Optional[float] = None,
    elevation: Optional[float] = None,
    fov: Optional[float] = None,
    zoom: Optional[float] = None,
    projection: Optional[Literal["perspective", "fisheye", "orthographic", "panorama", "cube"]] = None,
    eye: Optional[Union[str, float, Sequence[float]]] = None,
    up: Optional[Union[str, float, Sequence[float]]] = None,
    as_: Optional[Literal["auto", "points", "mesh", "hybrid"]] = None,
    texture: Optional[PathLike] = None,
    max_texture: Optional[int] = None,
    allow_outside: Optional[bool] = None,
    crease: Optional[Union[str, float, Sequence[float]]] = None,
    color_by: Optional[PathLike] = None,
    ramp: Optional[Union[str, float, Sequence[float]]] = None,
    where: Optional[PathLike] = None,
    place: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    error: Optional[float] = None,
    budget: Optional[Union[int, str]] = None,
    cache: Optional[PathLike] = None,
    only: Optional[Literal["triangles", "surfels"]] = None,
    method: Optional[Literal["conic", "ray", "affine", "point", "disc", "auto", "patch"]] = None,
    profile: Optional[Literal["exact", "inria-2023", "gsplat-1.5", "gsplat-1.5-aa", "gsplat-1.6", "gsplat-1.6-aa",
        "2dgs-2024", "2dgs-gsplat", "khr-2026", "inria-2023-aa", "mip-2023", "brush-1", "splat-2023",
        "playcanvas-2", "spark-2", "gs3d-0.4", "3dgut-2025", "surface"]] = None,
    quality: Optional[Literal["draft", "good", "final", "sketch"]] = None,
    kernel: Optional[Union[str, float, Sequence[float]]] = None,
    cutoff: Optional[float] = None,
    prefilter: Optional[float] = None,
    epsilon: Optional[Union[str, float, Sequence[float]]] = None,
    passes: Optional[int] = None,
    samples: Optional[int] = None,
    cull: Optional[Literal["none", "back"]] = None,
    near: Optional[Union[str, float, Sequence[float]]] = None,
    shade: Optional[Literal["none", "lambert", "phong", "edl", "lambert+edl", "phong+edl"]] = None,
    light: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    sky: Optional[Union[str, float, Sequence[float]]] = None,
    reflect: Optional[float] = None,
    background: Optional[Union[str, float, Sequence[float]]] = None,
    exposure: Optional[Union[str, float, Sequence[float]]] = None,
    planes: Optional[Union[str, float, Sequence[float]]] = None,
    k: Optional[int] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    tile: Optional[int] = None,
    device: Optional[Union[str, float, Sequence[float]]] = None,
    plain: Optional[bool] = None,
    isa: Optional[Literal["auto", "scalar", "sse2", "avx2", "avx512", "neon"]] = None,
) -> Dict[str, Any]:
    """Whether another renderer's intermediates are what its profile makes of the scene: gsplat's `meta`, as it is, or
    any of its arrays by their names; with "render_colors" and "render_alphas" its picture, too. Arrays on a GPU are
    moved. The answer has "verdict", "stage" (the first that is wrong), and "arrays".

    Options:

    picture: what is judged: EXR, PFM or NPY (with planes beside it, P.Z.npy …), NPZ, or PNG
    floats: of what drew it: own (conic's), strict (all in float, in any order), or fast (and a GPU's fast
        exponential) [fast]
    max_wrong: so many pixels may be wrong [0]
    pixels: judge this many pixels, spread evenly; always the same ones [all]
    map: the class of every pixel in false colours, with a legend
    report: a page with all that was found, pictures and all
    transfer: codes of 8 or 16 bits: linear (code / 255) or srgb (decoded) [linear of Gaussian scenes, else
        srgb]
    codes: codes were rounded to the nearest, down, or either [either]
    clipped: colours of 0 and 1 stand for what is beyond, in floats, too
    straight: colours are not multiplied by alpha; of a PNG they never are
    no_diagnosis: don't look for the mistake that explains wrong pixels, which may take longer than judging them
    allow_vague: a picture may be right although more than 1 % of its pixels may be anything within more than
        1/255
    time: print what each stage took
    suite: judge what conic conformance wrote, in the place of a scene
    pictures: of a suite: where CASE.exr, .pfm, .npy, .npz or .png are, planes beside them
    level: of a suite: only cases up to this level [all]
    junit: of a suite: the cases as JUnit's XML, as CI systems take it
    gradients: judge a derivative, in the place of a picture: .ply as conic gradient's, or .npz
    weights: of --gradients: W of L = sum W C, as conic gradient has it
    raw: of --gradients: they are by ln s and logit o
    intermediates: judge means2d, conics, isect_ids … in the place of a picture, as conic project has them
    size: the picture's width and height in pixels; cameras of a file are scaled to it [1024x1024, or the
        file's]
    camera: cameras, in place of --azimuth and those below it: a COLMAP folder, transforms.json, cameras.json,
        .npz of viewmats and Ks, glTF, or conic's JSON; top: a map, seen from straight above, with the unit of
        the points that a pixel is wide behind it, top:0.1, or else their typical distance, and the EPSG code
        that a .tif notes, top:0.1:25832, or else the file's
    view: which of the cameras of --camera: a number from 0, the name of an image with or without its folder and
        ending, or all [the only one]; without --camera a side: front, back, left, right, top, bottom, or iso,
        from a corner
    azimuth: the camera's place around the scene: 0 in front, 90 to the right of that [30, or before what faces
        elsewhere]
    elevation: the camera's height, from -90 (below) over 0 to 90 (above) [15; 35 for what lies flat, and
        surveys]
    fov: field of view across the shorter side [40]
    zoom: multiplies the focal length: 2 shows the middle, twice as large [1]
    projection: perspective, orthographic (parallel), fisheye, panorama (all around) or cube (six sides, one
        below the other) [perspective]
    eye: the place from which the camera looks [where it sees all of the scene; a panorama's and a cube's: the
        scene's middle]
    up: what points up: x, y, z, -x … or X,Y,Z [the file's, or by its shape]
    as_: what a mesh is drawn as: auto (triangles), points (splats of the vertices), mesh or hybrid (both)
        [auto]
    texture: the picture on a mesh's surface [as its materials say]
    max_texture: what textures may take in memory together; one more is refused before it is decoded [4096]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    crease: triangles without normals look smooth over edges up to this angle, 0 to 90 degrees; 0: every face is
        flat; all: any triangles look smooth everywhere, by the mean normal of the faces about each vertex [30]
    color_by: what the points' colours are made of: rgb, intensity, height, classification, normal, or a value
        in the file by its name; auto: rgb, or else intensity [auto]
    ramp: the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or
        classes; the values at its two ends behind it, or alone [what suits, from the 2nd to the 98th
        percentile]
    where: which points are wanted, by their values: 'classification = 2, 9 and not (intensity < 100 or z > 50)'
        [all]
    place: where an input stands: a shift of 3 numbers, or 12 or 16 of a matrix, row by row, that turns, scales
        evenly and shifts [as the file has it]
    error: draw as coarsely as keeps the error on the screen below so many pixels; 0: draw all; of meshes and a
        .chy, also by how many steps colours may differ: black and white do by 100, and 2 are just visible [0:2]
    budget: draw N splats and triangles at most, those whose error is the least [all]
    cache: of --error and --budget, keep what is built of points and meshes in this folder, up to 4 GiB, and
        take it from there the next time
    only: of a .chy, draw every patch as triangles, or every one as surfels (splats) [as built]
    method: how a splat becomes pixels, from rough to exact: point, disc, affine, conic, ray; auto: conic where
        that is exact enough, else ray or, of large splats, laplace; patch: as part of a smooth surface through
        the points, with patch:D by polynomials of degree D, 1 to 4 [3], and with patch:D:H smoother than the
        length H, as 2x [auto]
    profile: how a Gaussian scene is drawn: exact, as a version of another program (inria-2023, gsplat-1.5,
        gsplat-1.5-aa, gsplat-1.6, gsplat-1.6-aa, 2dgs-2024, 2dgs-gsplat, khr-2026, inria-2023-aa, mip-2023,
        brush-1, splat-2023, playcanvas-2, spark-2, gs3d-0.4, 3dgut-2025), or surface: as opaque splats;
        inria-2023 and others that take the picture's middle for the camera's principal point do so with any
        camera where :ignore-center stands behind them [exact]
    quality: draft (--method conic, 1 sample), good (auto, 2 x 2 samples) or final (auto, 4 x 4); sketch: draft,
        of at most 30,000 of the raw points, and of levels with --error 2; --method and --samples go first
        [good]
    kernel: how a splat fades from its centre to its edge: gauss, hat, box (not at all) or confetti:A,B,N
        [gauss]
    cutoff: at how many standard deviations from its centre a splat ends [1.5]
    prefilter: the variance, in square pixels, of the blur that keeps small splats from flickering; 0: none [1;
        0 of Gaussian scenes]
    epsilon: splats so near to each other along the ray are blended as one surface: a length, also in spacings
        (2x), or auto [auto]
    passes: 3: blend the splats of a surface; 1: the nearest splat wins [3]
    samples: average N x N samples in each pixel, which makes silhouettes soft [2; 1 with --profile, --repeat or
        --deep]
    cull: back: leave out what faces away; or none [none]
    near: nothing nearer to the camera is drawn [1e-4 of the scene's diagonal]
    shade: none (colours as they are), lambert (matt), phong (with a highlight), or edl (eye-dome lighting:
        darker where what is around is nearer, by up to so many stops as stand behind it, edl:4); lambert+edl
        and phong+edl are both [phong; none for maps of what has colours]
    light: a light: X,Y,Z, the direction towards it, in the scene; camera:X,Y,Z, likewise, but it moves with the
        camera (right, up, towards you); head, at your eye; each with its colour :R,G,B behind it or without,
        and a direction then with the radius of its disc, :2deg, for soft shadows with --accumulate; lamp:X,Y,Z,
        a place, with :R,G,B of which a surface at distance 1 is lit, then :RADIUS of a ball, then :X,Y,Z where
        to it shines, for a disc or, with :WxH, a rectangle, and :X,Y,Z where to its H goes [up in the scene];
        studio, several that suit most scenes; none. Up to 8 of a direction, 8 lamps [studio]
    sky: light from all around; of two colours, the first falls on what faces up, the second on what faces down
        [the studio's]; or a picture of all directions, such as sky.exr or sky.pfm, which needs --ao
    reflect: so much of each colour, 0 to 1, is the picture of --sky as a smooth surface mirrors it; nothing
        hides it [0]
    background: linear colour behind the scene, a name as white, or #rrggbb; two go from top to bottom; none:
        transparent [dark greys in PNG and JPEG, else none]
    exposure: stops, -100 to 100: each doubles the brightness; auto: as bright as leaves 1 pixel in 20 near
        white [0]
    planes: planes: rgba, Z (depth), N (normal), albedo, weight, count, id, joined by commas, or all; P (place
        in the world); cluster of hybrids; T, medianZ, inverseZ, last, doubt of Gaussian scenes; ao and shadow,
        what light arrives; bound, how far a pixel by --error or --budget is off, for which all is drawn, too;
        motion, into .exr: pixels to the next frame, and to the one before; cryptomatte, into .exr: mattes by
        which each input, or each patch of a hybrid, is picked by its name in Nuke or Blender [rgba,Z]
    k: how many neighbours a raw point's size and normal are estimated from, 6 to 64 [20]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    tile: the edge, in pixels, of the squares that a picture is drawn in: 8, 16, 32 or 64; changes no bit of it
        [64]
    device: what draws: cpu, opencl (the first device) or opencl:P.D (see conic devices), which :gather makes go
        about it as on a GPU and :lanes as on a CPU; changes no bit of the picture; with :inexact behind it also
        one whose rounding makes the picture another one [cpu]
    plain: draw as the library does by default: of a mesh the vertices, framed by a sphere, with a headlight and
        one sample
    isa: the processor's instructions: auto, scalar, sse2, avx2, avx512, neon; changes no bit of the picture
        [auto]
    threads: how many threads compute; the results never depend on it [0: all]
    """


def explain(
    scene: AnyScene,
    camera: Optional[AnyCamera] = None,
    pixel: Optional[Sequence[int]] = None,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    splat: Optional[Union[int, str]] = None,
    dump_projection: Optional[PathLike] = None,
    sample: Optional[Union[int, str]] = None,
    aperture: Optional[Union[str, float, Sequence[float]]] = None,
    focus: Optional[Union[str, float, Sequence[float]]] = None,
    shutter: Optional[Union[str, float, Sequence[float]]] = None,
    motion: Optional[PathLike] = None,
    turntable: Optional[Union[str, float, Sequence[float]]] = None,
    frames: Optional[Union[str, float, Sequence[float]]] = None,
    size: Optional[Union[str, Sequence[int]]] = None,
    view: Optional[Union[str, float, Sequence[float]]] = None,
    azimuth: Optional[float] = None,
    elevation: Optional[float] = None,
    fov: Optional[float] = None,
    zoom: Optional[float] = None,
    projection: Optional[Literal["perspective", "fisheye", "orthographic", "panorama", "cube"]] = None,
    eye: Optional[Union[str, float, Sequence[float]]] = None,
    up: Optional[Union[str, float, Sequence[float]]] = None,
    as_: Optional[Literal["auto", "points", "mesh", "hybrid"]] = None,
    texture: Optional[PathLike] = None,
    max_texture: Optional[int] = None,
    allow_outside: Optional[bool] = None,
    crease: Optional[Union[str, float, Sequence[float]]] = None,
    color_by: Optional[PathLike] = None,
    ramp: Optional[Union[str, float, Sequence[float]]] = None,
    where: Optional[PathLike] = None,
    place: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    error: Optional[float] = None,
    budget: Optional[Union[int, str]] = None,
    cache: Optional[PathLike] = None,
    only: Optional[Literal["triangles", "surfels"]] = None,
    method: Optional[Literal["conic", "ray", "affine", "point", "disc", "auto", "patch"]] = None,
    profile: Optional[Literal["exact", "inria-2023", "gsplat-1.5", "gsplat-1.5-aa", "gsplat-1.6", "gsplat-1.6-aa",
        "2dgs-2024", "2dgs-gsplat", "khr-2026", "inria-2023-aa", "mip-2023", "brush-1", "splat-2023",
        "playcanvas-2", "spark-2", "gs3d-0.4", "3dgut-2025", "surface"]] = None,
    quality: Optional[Literal["draft", "good", "final", "sketch"]] = None,
    kernel: Optional[Union[str, float, Sequence[float]]] = None,
    cutoff: Optional[float] = None,
    prefilter: Optional[float] = None,
    epsilon: Optional[Union[str, float, Sequence[float]]] = None,
    passes: Optional[int] = None,
    samples: Optional[int] = None,
    cull: Optional[Literal["none", "back"]] = None,
    near: Optional[Union[str, float, Sequence[float]]] = None,
    shade: Optional[Literal["none", "lambert", "phong", "edl", "lambert+edl", "phong+edl"]] = None,
    light: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    sky: Optional[Union[str, float, Sequence[float]]] = None,
    reflect: Optional[float] = None,
    background: Optional[Union[str, float, Sequence[float]]] = None,
    exposure: Optional[Union[str, float, Sequence[float]]] = None,
    planes: Optional[Union[str, float, Sequence[float]]] = None,
    k: Optional[int] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    tile: Optional[int] = None,
    device: Optional[Union[str, float, Sequence[float]]] = None,
    plain: Optional[bool] = None,
    isa: Optional[Literal["auto", "scalar", "sse2", "avx2", "avx512", "neon"]] = None,
) -> Dict[str, Any]:
    """Why a pixel (x, y) is as it is: everything that contributes to it; or where `splat=I` lies.

    Options:

    pixel: every splat in reach of this pixel, from 0,0 at the upper left
    splat: where splat I of the input lies on the screen
    dump_projection: where every splat does, as a table (CSV)
    sample: of conic render --accumulate, sample I, from 0, instead of a picture that is drawn at once
    aperture: the diameter of the lens: a length, also in spacings (2x); what is out of focus blurs; of one that
        is not round the number of its corners behind it [0: a pinhole]
    focus: the depth at which all is sharp; X,Y: what is at that pixel; auto: what is in the picture's middle
        [auto]
    shutter: open from A to B, in frames from the one drawn, along a --turntable, the cameras of a file or
        --motion: 0:0.5 blurs half the way to the next; up to 100000 either way [closed]
    motion: where the inputs are at which frame, as matrices, or what shape they have, as files (JSON) [they
        stand still]
    turntable: the picture is one of N around the scene
    frames: of --turntable, which, from 1 [1]
    size: the picture's width and height in pixels; cameras of a file are scaled to it [1024x1024, or the
        file's]
    camera: cameras, in place of --azimuth and those below it: a COLMAP folder, transforms.json, cameras.json,
        .npz of viewmats and Ks, glTF, or conic's JSON; top: a map, seen from straight above, with the unit of
        the points that a pixel is wide behind it, top:0.1, or else their typical distance, and the EPSG code
        that a .tif notes, top:0.1:25832, or else the file's
    view: which of the cameras of --camera: a number from 0, the name of an image with or without its folder and
        ending, or all [the only one]; without --camera a side: front, back, left, right, top, bottom, or iso,
        from a corner
    azimuth: the camera's place around the scene: 0 in front, 90 to the right of that [30, or before what faces
        elsewhere]
    elevation: the camera's height, from -90 (below) over 0 to 90 (above) [15; 35 for what lies flat, and
        surveys]
    fov: field of view across the shorter side [40]
    zoom: multiplies the focal length: 2 shows the middle, twice as large [1]
    projection: perspective, orthographic (parallel), fisheye, panorama (all around) or cube (six sides, one
        below the other) [perspective]
    eye: the place from which the camera looks [where it sees all of the scene; a panorama's and a cube's: the
        scene's middle]
    up: what points up: x, y, z, -x … or X,Y,Z [the file's, or by its shape]
    as_: what a mesh is drawn as: auto (triangles), points (splats of the vertices), mesh or hybrid (both)
        [auto]
    texture: the picture on a mesh's surface [as its materials say]
    max_texture: what textures may take in memory together; one more is refused before it is decoded [4096]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    crease: triangles without normals look smooth over edges up to this angle, 0 to 90 degrees; 0: every face is
        flat; all: any triangles look smooth everywhere, by the mean normal of the faces about each vertex [30]
    color_by: what the points' colours are made of: rgb, intensity, height, classification, normal, or a value
        in the file by its name; auto: rgb, or else intensity [auto]
    ramp: the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or
        classes; the values at its two ends behind it, or alone [what suits, from the 2nd to the 98th
        percentile]
    where: which points are wanted, by their values: 'classification = 2, 9 and not (intensity < 100 or z > 50)'
        [all]
    place: where an input stands: a shift of 3 numbers, or 12 or 16 of a matrix, row by row, that turns, scales
        evenly and shifts [as the file has it]
    error: draw as coarsely as keeps the error on the screen below so many pixels; 0: draw all; of meshes and a
        .chy, also by how many steps colours may differ: black and white do by 100, and 2 are just visible [0:2]
    budget: draw N splats and triangles at most, those whose error is the least [all]
    cache: of --error and --budget, keep what is built of points and meshes in this folder, up to 4 GiB, and
        take it from there the next time
    only: of a .chy, draw every patch as triangles, or every one as surfels (splats) [as built]
    method: how a splat becomes pixels, from rough to exact: point, disc, affine, conic, ray; auto: conic where
        that is exact enough, else ray or, of large splats, laplace; patch: as part of a smooth surface through
        the points, with patch:D by polynomials of degree D, 1 to 4 [3], and with patch:D:H smoother than the
        length H, as 2x [auto]
    profile: how a Gaussian scene is drawn: exact, as a version of another program (inria-2023, gsplat-1.5,
        gsplat-1.5-aa, gsplat-1.6, gsplat-1.6-aa, 2dgs-2024, 2dgs-gsplat, khr-2026, inria-2023-aa, mip-2023,
        brush-1, splat-2023, playcanvas-2, spark-2, gs3d-0.4, 3dgut-2025), or surface: as opaque splats;
        inria-2023 and others that take the picture's middle for the camera's principal point do so with any
        camera where :ignore-center stands behind them [exact]
    quality: draft (--method conic, 1 sample), good (auto, 2 x 2 samples) or final (auto, 4 x 4); sketch: draft,
        of at most 30,000 of the raw points, and of levels with --error 2; --method and --samples go first
        [good]
    kernel: how a splat fades from its centre to its edge: gauss, hat, box (not at all) or confetti:A,B,N
        [gauss]
    cutoff: at how many standard deviations from its centre a splat ends [1.5]
    prefilter: the variance, in square pixels, of the blur that keeps small splats from flickering; 0: none [1;
        0 of Gaussian scenes]
    epsilon: splats so near to each other along the ray are blended as one surface: a length, also in spacings
        (2x), or auto [auto]
    passes: 3: blend the splats of a surface; 1: the nearest splat wins [3]
    samples: average N x N samples in each pixel, which makes silhouettes soft [2; 1 with --profile, --repeat or
        --deep]
    cull: back: leave out what faces away; or none [none]
    near: nothing nearer to the camera is drawn [1e-4 of the scene's diagonal]
    shade: none (colours as they are), lambert (matt), phong (with a highlight), or edl (eye-dome lighting:
        darker where what is around is nearer, by up to so many stops as stand behind it, edl:4); lambert+edl
        and phong+edl are both [phong; none for maps of what has colours]
    light: a light: X,Y,Z, the direction towards it, in the scene; camera:X,Y,Z, likewise, but it moves with the
        camera (right, up, towards you); head, at your eye; each with its colour :R,G,B behind it or without,
        and a direction then with the radius of its disc, :2deg, for soft shadows with --accumulate; lamp:X,Y,Z,
        a place, with :R,G,B of which a surface at distance 1 is lit, then :RADIUS of a ball, then :X,Y,Z where
        to it shines, for a disc or, with :WxH, a rectangle, and :X,Y,Z where to its H goes [up in the scene];
        studio, several that suit most scenes; none. Up to 8 of a direction, 8 lamps [studio]
    sky: light from all around; of two colours, the first falls on what faces up, the second on what faces down
        [the studio's]; or a picture of all directions, such as sky.exr or sky.pfm, which needs --ao
    reflect: so much of each colour, 0 to 1, is the picture of --sky as a smooth surface mirrors it; nothing
        hides it [0]
    background: linear colour behind the scene, a name as white, or #rrggbb; two go from top to bottom; none:
        transparent [dark greys in PNG and JPEG, else none]
    exposure: stops, -100 to 100: each doubles the brightness; auto: as bright as leaves 1 pixel in 20 near
        white [0]
    planes: planes: rgba, Z (depth), N (normal), albedo, weight, count, id, joined by commas, or all; P (place
        in the world); cluster of hybrids; T, medianZ, inverseZ, last, doubt of Gaussian scenes; ao and shadow,
        what light arrives; bound, how far a pixel by --error or --budget is off, for which all is drawn, too;
        motion, into .exr: pixels to the next frame, and to the one before; cryptomatte, into .exr: mattes by
        which each input, or each patch of a hybrid, is picked by its name in Nuke or Blender [rgba,Z]
    k: how many neighbours a raw point's size and normal are estimated from, 6 to 64 [20]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    tile: the edge, in pixels, of the squares that a picture is drawn in: 8, 16, 32 or 64; changes no bit of it
        [64]
    device: what draws: cpu, opencl (the first device) or opencl:P.D (see conic devices), which :gather makes go
        about it as on a GPU and :lanes as on a CPU; changes no bit of the picture; with :inexact behind it also
        one whose rounding makes the picture another one [cpu]
    plain: draw as the library does by default: of a mesh the vertices, framed by a sphere, with a headlight and
        one sample
    isa: the processor's instructions: auto, scalar, sse2, avx2, avx512, neon; changes no bit of the picture
        [auto]
    threads: how many threads compute; the results never depend on it [0: all]
    """


def diff(
    a: Any,
    b: Any,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    heatmap: Optional[PathLike] = None,
    heatmap_of: Optional[Literal["samples", "flip"]] = None,
    max_abs: Optional[float] = None,
    min_psnr: Optional[float] = None,
    min_ssim: Optional[float] = None,
    max_flip: Optional[float] = None,
    display: Optional[Literal["auto", "none", "a", "b", "both"]] = None,
    reduce: Optional[bool] = None,
    match: Optional[Literal["auto", "name", "number", "order"]] = None,
    subset: Optional[bool] = None,
    csv: Optional[PathLike] = None,
) -> Dict[str, Any]:
    """How two pictures differ: files, folders, arrays or :class:`Picture`. "identical", "max_abs", "psnr", "ssim",
    "flip" …; where limits are given, "pass".

    Options:

    heatmap: write a picture of where they differ; of folders H.NAME.png for each view
    heatmap_of: what it paints: samples, their largest difference; flip, what is seen of it [samples]
    max_abs: let no sample differ by more [identical]
    min_psnr: let the colour's peak signal-to-noise ratio be no lower [identical]
    min_ssim: let the structural similarity be no lower [identical]
    max_flip: let the mean FLIP be no higher [identical]
    display: whose colours are display values: none, a, b or both [auto: as an EXR says, of itself and of a
        .pfm, .hdr or NumPy file beside it]
    reduce: bring the larger picture to the size of the other one
    match: how pictures of two folders find each other: by name, number or order [auto]
    subset: of folders: B need not have all the pictures of A
    csv: of folders: write the table into a file
    threads: how many threads compute; the results never depend on it [0: all]
    """


def info(
    path: PathLike,
    *,
    check: Optional[bool] = False,
    cameras: Optional[bool] = None,
    size: Optional[Union[str, Sequence[int]]] = None,
    allow_outside: Optional[bool] = None,
    threads: Optional[int] = None,
) -> Dict[str, Any]:
    """What a file holds; with `check`, also what of it cannot be drawn.

    Options:

    check: also look for what cannot be drawn
    cameras: of a glTF, the cameras in it, as of files of cameras alone
    size: of cameras: pixels [the file's]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    threads: how many threads compute; the results never depend on it [0: all]
    """


def devices(
) -> Dict[str, Any]:
    """The OpenCL devices of this machine, for `device=` of :func:`render`.
    """


def conformance(
    folder: PathLike,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    khr: Optional[bool] = None,
    profile: Optional[PathLike] = None,
    level: Optional[int] = None,
    floats: Optional[Literal["fast", "strict"]] = None,
) -> Dict[str, Any]:
    """Writes a suite of cases by which any Gaussian renderer can be judged.

    Options:

    khr: the pack for KHR_gaussian_splatting: glTF files, valid and broken
    profile: only these profiles, with commas between [all]
    level: only cases up to this level [7]
    floats: what renderers may round: fast: as a GPU's fast mathematics; strict: e^x to 2 ulp [fast]
    threads: how many threads compute; the results never depend on it [0: all]
    """


def command(
    name: str,
    *arguments: str,
    progress: Any = None,
    **options: Options,
) -> Dict[str, Any]:
    """Any command of the program with its arguments as the shell has them, as one for which there is no function.
    """


def make(
    name: str,
    output: Optional[PathLike] = None,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    n: Optional[Union[int, str]] = None,
    seed: Optional[Union[int, str]] = None,
    jitter: Optional[float] = None,
    noise: Optional[float] = None,
    far: Optional[Sequence[float]] = None,
    degree: Optional[int] = None,
    ascii: Optional[bool] = None,
) -> Scene:
    """Samples an analytic scene ("sphere", "knot", "terrain" … "gaussians") into `n` splats.

    Options:

    output: the file to write; - is standard output
    n: how many splats: 100000, 10k, 2M, 1e6 [100k]
    seed: the number that the jitter, the noise and the terrain's shape are drawn from [0]
    jitter: move each splat in its plane by up to J spacings [0]
    noise: move each along its normal by chance, by N spacings in the mean square [0]
    far: move the scene away from the origin; positions then are doubles [0,0,0]
    degree: of gaussians: the degree of their spherical harmonics, 0 to 4 [3]
    ascii: write text instead of binary
    threads: how many threads compute; the results never depend on it [0: all]
    """


def prepare(
    scene: AnyScene,
    output: Optional[PathLike] = None,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    in_place: Optional[bool] = None,
    k: Optional[int] = None,
    ellipse: Optional[Union[str, float, Sequence[float]]] = None,
    features: Optional[float] = None,
    count: Optional[Union[int, str]] = None,
    seed: Optional[Union[int, str]] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    allow_outside: Optional[bool] = None,
    timeout: Optional[float] = None,
    deadline: Optional[float] = None,
    where: Optional[PathLike] = None,
    plain: Optional[bool] = None,
    bake: Optional[Union[str, float, Sequence[float]]] = None,
    directions: Optional[int] = None,
    color_by: Optional[PathLike] = None,
    ramp: Optional[Union[str, float, Sequence[float]]] = None,
    up: Optional[Union[str, float, Sequence[float]]] = None,
) -> Scene:
    """Points or a mesh become splats: normals, sizes, thinning (`count`), sharp edges (`features`).

    Options:

    output: the file to write
    in_place: write over the input, in place of -o, once all is written
    k: how many neighbours a point's ellipse comes from, 6 to 64 [20]
    ellipse: what a point's ellipse goes around: its voronoi cell, or bounding all K neighbours, as Confetti has
        it [voronoi]
    features: creases sharper than ANGLE degrees become sharp, by clip lines [none]
    count: keep N of the points, chosen at random, and fit the sizes to them
    seed: which points --count chooses; those of a smaller count are among those of a larger one [0]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    timeout: of a URL, a server that is silent for so long is asked again, up to 4 times [15]
    deadline: of a URL, no more is read after so many seconds; where not all has come, nothing is written
    where: which points are wanted, by their values: 'classification = 2, 9 and not (intensity < 100 or z > 50)'
        [all]
    plain: every point becomes an ellipse; else those that lie on no surface become round dots
    bake: ao: how much light from all around reaches each point, as the value ao; color: colours are darkened by
        it, too
    directions: of --bake: from so many directions [256]
    color_by: what the points' colours are made of: rgb, intensity, height, classification, normal, or a value
        in the file by its name; auto: rgb, or else intensity [auto]
    ramp: the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or
        classes; the values at its two ends behind it, or alone [what suits, from the 2nd to the 98th
        percentile]
    up: what points up, for --color-by height and in a .lpc: x, y, z, -x … or X,Y,Z [y; z for surveys]
    threads: how many threads compute; the results never depend on it [0: all]
    """


def octree(
    scene: AnyScene,
    output: Optional[PathLike] = None,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    quantize: Optional[bool] = None,
    cutoff: Optional[float] = None,
    k: Optional[int] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    allow_outside: Optional[bool] = None,
    where: Optional[PathLike] = None,
    color_by: Optional[PathLike] = None,
    ramp: Optional[Union[str, float, Sequence[float]]] = None,
    up: Optional[Union[str, float, Sequence[float]]] = None,
) -> Scene:
    """Builds an octree (.cot), of which `error=` and `budget=` of :func:`render` choose.

    Options:

    output: the file to write
    quantize: round the splats: about half the size; the error is stated
    cutoff: the --cutoff of the pictures to come [1.5]
    k: neighbours that a raw point's size is estimated from, 6 to 64 [20]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    where: which points are wanted, by their values: 'classification = 2, 9 and not (intensity < 100 or z > 50)'
        [all]
    color_by: what the points' colours are made of: rgb, intensity, height, classification, normal, or a value
        in the file by its name; auto: rgb, or else intensity [auto]
    ramp: the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or
        classes; the values at its two ends behind it, or alone [what suits, from the 2nd to the 98th
        percentile]
    up: what points up, for --color-by height and in a .lpc: x, y, z, -x … or X,Y,Z [y; z for surveys]
    threads: how many threads compute; the results never depend on it [0: all]
    """


def layers(
    scene: AnyScene,
    output: Optional[PathLike] = None,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    cloud_size: Optional[int] = None,
    memory: Optional[float] = None,
    quantum: Optional[Union[str, float, Sequence[float]]] = None,
    cutoff: Optional[float] = None,
    k: Optional[int] = None,
    payload: Optional[Literal["plain", "full", "gaussians"]] = None,
    keep: Optional[PathLike] = None,
    append: Optional[bool] = None,
    resumable: Optional[bool] = None,
    resume: Optional[PathLike] = None,
    where: Optional[PathLike] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    allow_outside: Optional[bool] = None,
    timeout: Optional[float] = None,
    deadline: Optional[float] = None,
    color_by: Optional[PathLike] = None,
    ramp: Optional[Union[str, float, Sequence[float]]] = None,
    up: Optional[Union[str, float, Sequence[float]]] = None,
) -> Scene:
    """Builds a layered point cloud (.lpc) of one or more files, out of core.

    Options:

    output: the file to write
    cloud_size: about how many samples a cloud has, 64 to 32768 [2048]
    memory: what building may take in memory; what does not fit goes to files beside the output [1024]
    quantum: the steps that positions are rounded to: a length, also in spacings (2x) [0.5x; x/4096 with
        --payload full]
    cutoff: the --cutoff of the pictures to come [1.5]
    k: neighbours that raw points' normals are estimated from, 6 to 64 [20]
    payload: what of a splat is kept: plain, its place, size, direction and colour, and that it is a dot; full,
        also ellipses, opacities and clip lines, and all of it finely; gaussians, of Gaussian scenes all, in
        levels of merged ones [gaussians of such scenes, else plain]
    keep: which values of the points are kept, for --color-by and --where: intensity,gps_time or all [none]
    append: add to the OUT.lpc that there is; its samples stay where they are
    resumable: note in OUT.branches what is finished, so that --resume can go on after any end
    resume: go on with what OUT.branches says is finished, to the same bytes; with --resumable, too, where there
        is none begin
    where: which points are wanted, by their values: 'classification = 2, 9 and not (intensity < 100 or z > 50)'
        [all]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    timeout: of a URL, a server that is silent for so long is asked again, up to 4 times [15]
    deadline: of a URL, no more is read after so many seconds; where not all has come, nothing is written
    color_by: what the points' colours are made of: rgb, intensity, height, classification, normal, or a value
        in the file by its name; auto: rgb, or else intensity [auto]
    ramp: the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or
        classes; the values at its two ends behind it, or alone [what suits, from the 2nd to the 98th
        percentile]
    up: what points up, for --color-by height and in a .lpc: x, y, z, -x … or X,Y,Z [y; z for surveys]
    threads: how many threads compute; the results never depend on it [0: all]
    """


def mls(
    what: str,
    scene: AnyScene,
    output: Optional[PathLike] = None,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    in_place: Optional[bool] = None,
    type: Optional[Literal["mls", "apss"]] = None,
    plane: Optional[Literal["full", "fast"]] = None,
    degree: Optional[int] = None,
    weight: Optional[Literal["gauss", "compact", "flat"]] = None,
    h: Optional[Union[str, float, Sequence[float]]] = None,
    k: Optional[int] = None,
    neglect: Optional[float] = None,
    cluster: Optional[float] = None,
    sharp: Optional[bool] = None,
    count: Optional[Union[int, str]] = None,
    max_error: Optional[Union[str, float, Sequence[float]]] = None,
    keep: Optional[Literal["contribution"]] = None,
    spacing: Optional[Union[str, float, Sequence[float]]] = None,
    hole: Optional[Union[str, float, Sequence[float]]] = None,
    memory: Optional[Union[int, str]] = None,
    isa: Optional[Literal["auto", "scalar", "sse2", "avx2", "avx512", "neon"]] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    allow_outside: Optional[bool] = None,
) -> Scene:
    """Cleans ("project"), thins ("thin") or densifies ("densify") points by the surface that they mean.

    Options:

    output: the file to write
    in_place: write over the input, in place of -o, once all is written
    type: how the surface is fitted: mls, by polynomials over planes; apss, by algebraic spheres [mls]
    plane: of --type mls, where the plane lies: full, where it makes this a projection; fast, through the point
        itself [full]
    degree: of --type mls, the degree of the polynomials, 1 to 4 [3]
    weight: how a sample's weight falls with its distance: gauss, compact or flat [gauss]
    h: what is smaller is smoothed away: a length, also in spacings (2x) [of each point its own, by -k]
    k: where each point has an h of its own: neighbours beyond the K-th weigh nothing, 6 to 64 [32]
    neglect: samples farther away than C times h weigh nothing, 1 to 6 [2]
    cluster: project: cells smaller than T times their distance count as one sample, 0 to 1 [0]
    sharp: keep creases sharp, and clip the splats that are written at them
    count: thin: points to keep [a tenth]; densify: points to stop at
    max_error: thin: keep the surface within E of what it was
    keep: thin: contribution, how far each point that is left lies from the surface of the others, as a value
    spacing: densify: no circle of a greater radius stays empty [0.5x]
    hole: densify: circles of a greater radius are holes and stay; faces are none [1.25 h]
    memory: project: work cell by cell in so much memory, the rest beside the output
    isa: auto, scalar, sse2, avx2, avx512, neon; changes no bit [auto]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    threads: how many threads compute; the results never depend on it [0: all]
    """


def csg(
    scene: AnyScene,
    other: AnyScene,
    output: Optional[PathLike] = None,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    union: Optional[bool] = None,
    intersection: Optional[bool] = None,
    difference: Optional[bool] = None,
    k: Optional[int] = None,
    cutoff: Optional[float] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    allow_outside: Optional[bool] = None,
    timeout: Optional[float] = None,
    deadline: Optional[float] = None,
) -> Scene:
    """Joins two solids (`union=True`), intersects them (`intersection`), or takes one from the other (`difference`).

    Options:

    output: the file to write
    union: what is in either
    intersection: what is in both
    difference: what is in A and not in B
    k: neighbours that a raw point's size is estimated from, 6 to 64 [20]
    cutoff: the --cutoff of the pictures to come [1.5]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    timeout: of a URL, a server that is silent for so long is asked again, up to 4 times [15]
    deadline: of a URL, no more is read after so many seconds; where not all has come, nothing is written
    threads: how many threads compute; the results never depend on it [0: all]
    """


def hybrid(
    mesh: AnyScene,
    output: Optional[PathLike] = None,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    phase1: Optional[float] = None,
    phase2: Optional[float] = None,
    largest: Optional[float] = None,
    density: Optional[float] = None,
    most_error: Optional[float] = None,
    sampling: Optional[Literal["blue", "box"]] = None,
    texture: Optional[PathLike] = None,
    max_texture: Optional[int] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    allow_outside: Optional[bool] = None,
    smooth: Optional[bool] = None,
    crease: Optional[float] = None,
    cutoff: Optional[float] = None,
    memory: Optional[int] = None,
    single: Optional[bool] = None,
    color_by: Optional[PathLike] = None,
    ramp: Optional[Union[str, float, Sequence[float]]] = None,
    up: Optional[Union[str, float, Sequence[float]]] = None,
) -> Scene:
    """Builds a hybrid model (.chy) of a mesh or of points: triangles where it is flat, surfels where it is detailed.

    Options:

    output: the file to write
    phase1: pieces that are flat together are joined up to this cost; more makes larger clusters [0.12]
    phase2: what then is still small is gathered into patches of surfels up to this cost; -2: nothing, 1e6: all
        [0.4]
    largest: how much of the mesh's area a cluster of the first phase may have; 0: that of 2000 faces, 0.02 at
        most [0]
    density: how many surfels lie along a mean edge of a patch [2]
    most_error: a patch stays triangles where its surfels would be farther from it, in distances between them;
        0: none [0.5]
    sampling: blue (blue noise, ellipses) or box (three grids, circles: for comparison) [blue]
    texture: the picture on the mesh's surface [as its materials say]
    max_texture: what textures may take in memory together; one more is refused before it is decoded [4096]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    smooth: triangles look smooth everywhere: each vertex gets the mean normal of its faces
    crease: triangles without normals look smooth over edges up to this angle, in degrees; 0: every face is flat
        [30]
    cutoff: the --cutoff of the pictures to come [1.5]
    memory: of a PLY that is larger than memory, what building may take; in cells, so that the file is another
        one [the mesh is read whole]
    single: without the simpler levels that --error chooses from
    color_by: what the points' colours are made of: rgb, intensity, height, classification, normal, or a value
        in the file by its name; auto: rgb, or else intensity [auto]
    ramp: the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or
        classes; the values at its two ends behind it, or alone [what suits, from the 2nd to the 98th
        percentile]
    up: what points up, for --color-by height and in a .lpc: x, y, z, -x … or X,Y,Z [y; z for surveys]
    threads: how many threads compute; the results never depend on it [0: all]
    """


def convert(
    scene: AnyScene,
    output: PathLike,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    to: Optional[Literal["auto", "ply", "compressed-ply", "splat", "spz", "sog", "gltf", "glb"]] = None,
    sh_degree: Optional[int] = None,
    frame: Optional[PathLike] = None,
    from_frame: Optional[PathLike] = None,
    keep_order: Optional[bool] = None,
    sh_bits: Optional[int] = None,
    measure: Optional[int] = None,
    spz_version: Optional[int] = None,
    allow_outside: Optional[bool] = None,
) -> Scene:
    """Writes a Gaussian scene in another format, which the output's ending says.

    Options:

    output: the file to write: .ply .compressed.ply .splat .spz .sog .gltf .glb
    to: the format, where the name does not say it [as the name says]
    sh_degree: keep harmonics up to this degree [4]
    frame: where x, y, z shall point, as rdf: right, down, forward; or keep [the format's habit]
    from_frame: where they point in the input [the format's habit]
    keep_order: keep the order of the Gaussians; else neighbours are brought together, which packs better
    sh_bits: of .spz: bits of each number of the harmonics, 1 to 8 [8]
    measure: draw both scenes from N sides, and say how pictures differ
    spz_version: of .spz: 3 for readers of before 2026 [4]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    threads: how many threads compute; the results never depend on it [0: all]
    """


def gradient(
    scene: AnyScene,
    camera: AnyCamera,
    weights: Any,
    output: Optional[PathLike] = None,
    *,
    progress: Any = None,
    threads: Optional[int] = None,
    raw: Optional[bool] = None,
    floats: Optional[Literal["own", "strict", "fast"]] = None,
    no_doubts: Optional[bool] = None,
    size: Optional[Union[str, Sequence[int]]] = None,
    view: Optional[Union[str, float, Sequence[float]]] = None,
    azimuth: Optional[float] = None,
    elevation: Optional[float] = None,
    fov: Optional[float] = None,
    zoom: Optional[float] = None,
    projection: Optional[Literal["perspective", "fisheye", "orthographic", "panorama", "cube"]] = None,
    eye: Optional[Union[str, float, Sequence[float]]] = None,
    up: Optional[Union[str, float, Sequence[float]]] = None,
    as_: Optional[Literal["auto", "points", "mesh", "hybrid"]] = None,
    texture: Optional[PathLike] = None,
    max_texture: Optional[int] = None,
    allow_outside: Optional[bool] = None,
    crease: Optional[Union[str, float, Sequence[float]]] = None,
    color_by: Optional[PathLike] = None,
    ramp: Optional[Union[str, float, Sequence[float]]] = None,
    where: Optional[PathLike] = None,
    place: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    error: Optional[float] = None,
    budget: Optional[Union[int, str]] = None,
    cache: Optional[PathLike] = None,
    only: Optional[Literal["triangles", "surfels"]] = None,
    method: Optional[Literal["conic", "ray", "affine", "point", "disc", "auto", "patch"]] = None,
    profile: Optional[Literal["exact", "inria-2023", "gsplat-1.5", "gsplat-1.5-aa", "gsplat-1.6", "gsplat-1.6-aa",
        "2dgs-2024", "2dgs-gsplat", "khr-2026", "inria-2023-aa", "mip-2023", "brush-1", "splat-2023",
        "playcanvas-2", "spark-2", "gs3d-0.4", "3dgut-2025", "surface"]] = None,
    quality: Optional[Literal["draft", "good", "final", "sketch"]] = None,
    kernel: Optional[Union[str, float, Sequence[float]]] = None,
    cutoff: Optional[float] = None,
    prefilter: Optional[float] = None,
    epsilon: Optional[Union[str, float, Sequence[float]]] = None,
    passes: Optional[int] = None,
    samples: Optional[int] = None,
    cull: Optional[Literal["none", "back"]] = None,
    near: Optional[Union[str, float, Sequence[float]]] = None,
    shade: Optional[Literal["none", "lambert", "phong", "edl", "lambert+edl", "phong+edl"]] = None,
    light: Optional[Union[Union[str, float, Sequence[float]], Sequence[Any]]] = None,
    sky: Optional[Union[str, float, Sequence[float]]] = None,
    reflect: Optional[float] = None,
    background: Optional[Union[str, float, Sequence[float]]] = None,
    exposure: Optional[Union[str, float, Sequence[float]]] = None,
    planes: Optional[Union[str, float, Sequence[float]]] = None,
    k: Optional[int] = None,
    columns: Optional[Union[str, float, Sequence[float]]] = None,
    colors: Optional[Literal["file", "display", "linear"]] = None,
    tile: Optional[int] = None,
    device: Optional[Union[str, float, Sequence[float]]] = None,
    plain: Optional[bool] = None,
    isa: Optional[Literal["auto", "scalar", "sse2", "avx2", "avx512", "neon"]] = None,
) -> Scene:
    """How the sum of a picture's pixels times `weights`, a file or an array (H, W, 3 or 4), changes with every number
    of a Gaussian scene, in double precision: a PLY of what the gradients are.

    Options:

    weights: W of L = sum W C: a picture with R, G, B and, where they count, A and Z, or an .npy (height, width,
        3 to 5)
    output: the derivative by each Gaussian's parameters, and its doubts
    raw: by what files store: the logarithms of scales and the opacity's logit
    floats: whose roundings may put a decision in doubt: own, strict or fast (a GPU's) [strict]
    no_doubts: do not look for decisions in doubt, which is faster
    size: the picture's width and height in pixels; cameras of a file are scaled to it [1024x1024, or the
        file's]
    camera: cameras, in place of --azimuth and those below it: a COLMAP folder, transforms.json, cameras.json,
        .npz of viewmats and Ks, glTF, or conic's JSON; top: a map, seen from straight above, with the unit of
        the points that a pixel is wide behind it, top:0.1, or else their typical distance, and the EPSG code
        that a .tif notes, top:0.1:25832, or else the file's
    view: which of the cameras of --camera: a number from 0, the name of an image with or without its folder and
        ending, or all [the only one]; without --camera a side: front, back, left, right, top, bottom, or iso,
        from a corner
    azimuth: the camera's place around the scene: 0 in front, 90 to the right of that [30, or before what faces
        elsewhere]
    elevation: the camera's height, from -90 (below) over 0 to 90 (above) [15; 35 for what lies flat, and
        surveys]
    fov: field of view across the shorter side [40]
    zoom: multiplies the focal length: 2 shows the middle, twice as large [1]
    projection: perspective, orthographic (parallel), fisheye, panorama (all around) or cube (six sides, one
        below the other) [perspective]
    eye: the place from which the camera looks [where it sees all of the scene; a panorama's and a cube's: the
        scene's middle]
    up: what points up: x, y, z, -x … or X,Y,Z [the file's, or by its shape]
    as_: what a mesh is drawn as: auto (triangles), points (splats of the vertices), mesh or hybrid (both)
        [auto]
    texture: the picture on a mesh's surface [as its materials say]
    max_texture: what textures may take in memory together; one more is refused before it is decoded [4096]
    allow_outside: a glTF may name buffers and pictures outside of its folder
    crease: triangles without normals look smooth over edges up to this angle, 0 to 90 degrees; 0: every face is
        flat; all: any triangles look smooth everywhere, by the mean normal of the faces about each vertex [30]
    color_by: what the points' colours are made of: rgb, intensity, height, classification, normal, or a value
        in the file by its name; auto: rgb, or else intensity [auto]
    ramp: the colours of --color-by: sequential, grey, heat, diverging, terrain, viridis, magma, turbo or
        classes; the values at its two ends behind it, or alone [what suits, from the 2nd to the 98th
        percentile]
    where: which points are wanted, by their values: 'classification = 2, 9 and not (intensity < 100 or z > 50)'
        [all]
    place: where an input stands: a shift of 3 numbers, or 12 or 16 of a matrix, row by row, that turns, scales
        evenly and shifts [as the file has it]
    error: draw as coarsely as keeps the error on the screen below so many pixels; 0: draw all; of meshes and a
        .chy, also by how many steps colours may differ: black and white do by 100, and 2 are just visible [0:2]
    budget: draw N splats and triangles at most, those whose error is the least [all]
    cache: of --error and --budget, keep what is built of points and meshes in this folder, up to 4 GiB, and
        take it from there the next time
    only: of a .chy, draw every patch as triangles, or every one as surfels (splats) [as built]
    method: how a splat becomes pixels, from rough to exact: point, disc, affine, conic, ray; auto: conic where
        that is exact enough, else ray or, of large splats, laplace; patch: as part of a smooth surface through
        the points, with patch:D by polynomials of degree D, 1 to 4 [3], and with patch:D:H smoother than the
        length H, as 2x [auto]
    profile: how a Gaussian scene is drawn: exact, as a version of another program (inria-2023, gsplat-1.5,
        gsplat-1.5-aa, gsplat-1.6, gsplat-1.6-aa, 2dgs-2024, 2dgs-gsplat, khr-2026, inria-2023-aa, mip-2023,
        brush-1, splat-2023, playcanvas-2, spark-2, gs3d-0.4, 3dgut-2025), or surface: as opaque splats;
        inria-2023 and others that take the picture's middle for the camera's principal point do so with any
        camera where :ignore-center stands behind them [exact]
    quality: draft (--method conic, 1 sample), good (auto, 2 x 2 samples) or final (auto, 4 x 4); sketch: draft,
        of at most 30,000 of the raw points, and of levels with --error 2; --method and --samples go first
        [good]
    kernel: how a splat fades from its centre to its edge: gauss, hat, box (not at all) or confetti:A,B,N
        [gauss]
    cutoff: at how many standard deviations from its centre a splat ends [1.5]
    prefilter: the variance, in square pixels, of the blur that keeps small splats from flickering; 0: none [1;
        0 of Gaussian scenes]
    epsilon: splats so near to each other along the ray are blended as one surface: a length, also in spacings
        (2x), or auto [auto]
    passes: 3: blend the splats of a surface; 1: the nearest splat wins [3]
    samples: average N x N samples in each pixel, which makes silhouettes soft [2; 1 with --profile, --repeat or
        --deep]
    cull: back: leave out what faces away; or none [none]
    near: nothing nearer to the camera is drawn [1e-4 of the scene's diagonal]
    shade: none (colours as they are), lambert (matt), phong (with a highlight), or edl (eye-dome lighting:
        darker where what is around is nearer, by up to so many stops as stand behind it, edl:4); lambert+edl
        and phong+edl are both [phong; none for maps of what has colours]
    light: a light: X,Y,Z, the direction towards it, in the scene; camera:X,Y,Z, likewise, but it moves with the
        camera (right, up, towards you); head, at your eye; each with its colour :R,G,B behind it or without,
        and a direction then with the radius of its disc, :2deg, for soft shadows with --accumulate; lamp:X,Y,Z,
        a place, with :R,G,B of which a surface at distance 1 is lit, then :RADIUS of a ball, then :X,Y,Z where
        to it shines, for a disc or, with :WxH, a rectangle, and :X,Y,Z where to its H goes [up in the scene];
        studio, several that suit most scenes; none. Up to 8 of a direction, 8 lamps [studio]
    sky: light from all around; of two colours, the first falls on what faces up, the second on what faces down
        [the studio's]; or a picture of all directions, such as sky.exr or sky.pfm, which needs --ao
    reflect: so much of each colour, 0 to 1, is the picture of --sky as a smooth surface mirrors it; nothing
        hides it [0]
    background: linear colour behind the scene, a name as white, or #rrggbb; two go from top to bottom; none:
        transparent [dark greys in PNG and JPEG, else none]
    exposure: stops, -100 to 100: each doubles the brightness; auto: as bright as leaves 1 pixel in 20 near
        white [0]
    planes: planes: rgba, Z (depth), N (normal), albedo, weight, count, id, joined by commas, or all; P (place
        in the world); cluster of hybrids; T, medianZ, inverseZ, last, doubt of Gaussian scenes; ao and shadow,
        what light arrives; bound, how far a pixel by --error or --budget is off, for which all is drawn, too;
        motion, into .exr: pixels to the next frame, and to the one before; cryptomatte, into .exr: mattes by
        which each input, or each patch of a hybrid, is picked by its name in Nuke or Blender [rgba,Z]
    k: how many neighbours a raw point's size and normal are estimated from, 6 to 64 [20]
    columns: what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]
    colors: what colours mean that are fractions of 1: display values, as other programs write them, or linear
        ones, as conic's .ply has them: file, display, linear [file]
    tile: the edge, in pixels, of the squares that a picture is drawn in: 8, 16, 32 or 64; changes no bit of it
        [64]
    device: what draws: cpu, opencl (the first device) or opencl:P.D (see conic devices), which :gather makes go
        about it as on a GPU and :lanes as on a CPU; changes no bit of the picture; with :inexact behind it also
        one whose rounding makes the picture another one [cpu]
    plain: draw as the library does by default: of a mesh the vertices, framed by a sphere, with a headlight and
        one sample
    isa: the processor's instructions: auto, scalar, sse2, avx2, avx512, neon; changes no bit of the picture
        [auto]
    threads: how many threads compute; the results never depend on it [0: all]
    """
