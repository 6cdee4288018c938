"""How each program is made to draw. DRAW has a function for each, which takes options, program and cases, and stores a
picture of each case. Absent is raised where something is not to be had."""
import base64
import functools
import http.server
import importlib.util
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import threading
import time
import types
import urllib.parse

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
WIDTH, HEIGHT = 640, 360


class Absent(Exception):
    pass


def python_of(folder):
    own = folder / "venv/bin/python"
    return str(own) if own.exists() else sys.executable


def source_of(options, repository, *under):
    """The program's files, or those of some folders, from the git directory of its repository: OWNER+NAME, or
    OWNER+NAME@COMMIT."""
    folder = options.output / "sources" / repository
    if all((folder / name).exists() for name in under or [""]):
        return folder
    repository, _, commit = repository.partition("@")
    commit = commit or "HEAD"
    store = pathlib.Path(options.sources or "") / repository / "repo"
    if not options.sources or not store.exists():
        raise Absent(f"its sources are not in --sources ({repository})")
    names = subprocess.run(["git", "-C", store, "ls-tree", "-r", commit, "--name-only", *under],
                           capture_output=True, text=True, check=True).stdout.splitlines()
    cat = subprocess.Popen(["git", "-C", store, "cat-file", "--batch"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    for name in names:
        cat.stdin.write(f"{commit}:{name}\n".encode())
        cat.stdin.flush()
        head = cat.stdout.readline().split()
        if head[-1] == b"missing":
            continue
        data = cat.stdout.read(int(head[2]))
        cat.stdout.read(1)
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    cat.stdin.close()
    cat.wait()
    return folder


def draw_by_torch(options, program, cases):
    """By examples/conformance/run-gsplat.py, which takes a folder like a suite's."""
    where = options.output / "torch"
    shutil.rmtree(where, ignore_errors=True)
    where.mkdir(parents=True)
    lines = []
    for name, scene, camera, picture in cases:
        (where / f"{name}.json").write_text(json.dumps(camera))
        shutil.copy(scene, where / f"{name}.ply")
        lines.append(f"{name}\t{name}.ply\t{name}.json\t{program.profile}\t0,0,0\n")
    (where / "cases.tsv").write_text("".join(lines))
    package = [str(source_of(options, program.repository, "gsplat"))] if program.repository else []
    told = subprocess.run([python_of(options.output), ROOT / "examples/conformance/run-gsplat.py", where, where, *package],
                          capture_output=True, text=True, timeout=3000)
    if told.returncode:
        raise Absent(told.stderr.strip().splitlines()[-1])
    for name, scene, camera, picture in cases:
        shutil.copy(where / f"{name}.npy", picture)


unseen_seconds = 0.0  # of the processor, by processes of Chromium that nobody waited for


def seconds_below(pid):
    """Processor seconds of the processes that are below this one, and of those that they waited for."""
    of, parents = {}, {}
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            words = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        parents[int(path.parent.name)] = int(words[1])
        of[int(path.parent.name)] = sum(map(int, words[11:15])) / os.sysconf("SC_CLK_TCK")
    below, more = set(), {pid}
    while more:
        more = {child for child, parent in parents.items() if parent in more}
        below |= more
    return sum(of[child] for child in below)


def waited_seconds():
    use = resource.getrusage(resource.RUSAGE_CHILDREN)
    return use.ru_utime + use.ru_stime


def draw_in_browser(options, cases, folder, page_of):
    """page_of tells, of a scene, a camera and the server, the page's address and what to run in it."""
    try:
        import numpy as np
        from playwright.sync_api import sync_playwright
    except ImportError as error:
        raise Absent(f"{error}; --install fetches it")
    if not shutil.which("chromium"):
        raise Absent("no chromium: apt install chromium")

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *words):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    begin = waited_seconds()
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=[
            "--no-sandbox", "--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist"])
        for name, scene, camera, picture in cases:
            page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
            page.set_default_timeout(120000)
            if os.environ.get("LEAGUE_LOG"):
                page.on("console", lambda message: print("page:", message.text, file=sys.stderr))
                page.on("pageerror", lambda error: print("page:", error, file=sys.stderr))
            page.add_init_script((HERE / "floats.js").read_text())
            address, then = page_of(scene, camera, f"http://127.0.0.1:{server.server_port}")
            page.goto(address)
            if then:
                page.evaluate(then)
            np.save(picture, settled(page, np))
            picture.with_suffix(".order").write_text(json.dumps(page.evaluate("window.leagueOrder || null")))
            page.close()
        seconds = seconds_below(os.getpid())
        browser.close()
    global unseen_seconds
    unseen_seconds += max(0.0, seconds - (waited_seconds() - begin))
    server.shutdown()


def settled(page, np):
    """The picture, once it has stayed the same for three seconds, or empty for fifteen."""
    for _ in range(120):
        time.sleep(1.0)
        got = page.evaluate("window.league ? league.still() : null")
        if got and got["same"] >= (15 if got["empty"] else 3):
            got = page.evaluate("league.floats()")
            return np.frombuffer(base64.b64decode(got["data"]), np.float32).reshape(got["h"], got["w"], 4)[::-1]
    raise Absent("its page never settled")


def draw_by_splat(options, program, cases):
    folder = source_of(options, program.repository)

    def page_of(scene, camera, server):
        shutil.copy(scene, folder)
        m = camera["world_to_camera"]
        view = json.dumps([m[row][column] for column in range(4) for row in range(4)])
        return (f"{server}/index.html?url={server}/{scene.name}#{urllib.parse.quote(view)}",
                f"camera.fx = {camera['fx']}; camera.fy = {camera['fy']}; window.dispatchEvent(new Event('resize'))")

    draw_in_browser(options, cases, folder, page_of)


def put_three(folder):
    """three.js and stage.js; three.js 180 is in the bundle that PyPI's nicegui has for its scenes."""
    nicegui = importlib.util.find_spec("nicegui")
    if not nicegui:
        raise Absent("no nicegui, in which three.js is; --install fetches it")
    bundle = pathlib.Path(nicegui.origin).parent / "elements/scene/dist/index.js"
    shutil.copy(bundle, folder / "bundle.js")
    shutil.copy(HERE / "stage.js", folder)
    texts = "\n".join(path.read_text() for path in [*folder.rglob("*.js")] if path.name != "bundle.js")
    (folder / "three.js").write_text("import { THREE } from './bundle.js';\nexport const { "
                                     + ", ".join(sorted(set(re.findall(r"\b[A-Z]\w*", texts)) - {"THREE"})) + " } = THREE;\n")


def draw_by_page(options, cases, folder, name):
    shutil.copy(HERE / f"{name}.html", folder / "page.html")

    def page_of(scene, camera, server):
        shutil.copy(scene, folder)
        return f"{server}/page.html?scene={scene.name}&camera={urllib.parse.quote(json.dumps(camera))}", None

    draw_in_browser(options, cases, folder, page_of)


def draw_by_playcanvas(options, program, cases):
    folder = source_of(options, program.repository, "src")
    (folder / "none.js").write_text("export const zipSync = 0, strToU8 = 0;\n")
    draw_by_page(options, cases, folder, "playcanvas")


def draw_by_gs3d(options, program, cases):
    folder = source_of(options, program.repository, "src")
    put_three(folder)
    for path in (folder / "src/worker").glob("*.wasm"):
        text = base64.b64encode(path.read_bytes()).decode()
        path.with_suffix(".wasm.js").write_text(f"export default '{text}';\n")
    draw_by_page(options, cases, folder, "gs3d")


def draw_by_spark(options, program, cases):
    folder = source_of(options, program.repository, "dist/spark.module.min.js")
    put_three(folder)
    draw_by_page(options, cases, folder, "spark")


def draw_by_gausscam(options, program, cases):
    """By its WebGPU pipeline on Mesa's lavapipe, as its README does (all in one link that stays where it is); the 32-bit
    floats that it would then round to 8 bits."""
    icd = pathlib.Path("/usr/share/vulkan/icd.d/lvp_icd.x86_64.json")
    if not icd.exists():
        raise Absent("no lavapipe: apt install mesa-vulkan-drivers")
    os.environ.update(VK_ICD_FILENAMES=str(icd), XDG_RUNTIME_DIR=str(options.output))
    try:
        import numpy as np
        from gausscam.backends._wgpu_base import FullGpuPipeline
    except ImportError as error:
        raise Absent(f"{error}; --install fetches it")
    import stored
    for name, path, camera, picture in cases:
        scene, view = stored.read(path), np.array(camera["world_to_camera"])
        turn, n = view[:3, :3].T, len(scene["mean"])
        numbers = {"xyz": scene["mean"], "rot": scene["rotation"] / np.linalg.norm(scene["rotation"], axis=1, keepdims=True),
                   "scale": scene["scale"], "opacity": scene["opacity"].astype("f4"), "sh": scene["sh"][:, 0],
                   "slots": np.zeros(n, "i4"), "W": np.int32(WIDTH), "H": np.int32(HEIGHT),
                   "fovy": np.float32(2 * np.degrees(np.arctan(HEIGHT / 2 / camera["fy"]))),
                   "cam_pos": (-turn @ view[:3, 3])[None].astype("f4"), "cam_xmat": (turn * [1, -1, -1])[None].astype("f4")}
        pipeline = FullGpuPipeline(numbers, "llvmpipe")
        pipeline.set_links(np.zeros((1, 3), "f4"), np.array([[1, 0, 0, 0]], "f4"))
        pipeline.render_frame()
        pixels = np.frombuffer(pipeline.queue.read_buffer(pipeline.b_renders), "f4").reshape(HEIGHT, WIDTH, 4)
        np.save(picture, pixels[..., :3])


def draw_by_torch_splatting(options, program, cases):
    """hbb1/torch-splatting on the CPU. It draws 256 x 256 pixels in tiles of 64: the list of pixels is replaced."""
    try:
        import numpy as np
        import torch
    except ImportError as error:
        raise Absent(f"{error}; --install fetches it")
    import stored
    folder = source_of(options, program.repository, "gaussian_splatting")
    for path in folder.rglob("*.py"):
        path.write_text(path.read_text().replace("'cuda'", "'cpu'").replace('"cuda"', '"cpu"'))
    sys.path.insert(0, str(folder))
    sys.modules.setdefault("einops", types.SimpleNamespace(reduce=None))
    render = importlib.import_module("gaussian_splatting.gauss_render")
    for name, path, camera, picture in cases:
        scene, view = stored.read(path), np.array(camera["world_to_camera"])
        seen = scene["mean"] @ view[2, :3] + view[2, 3] >= 0.2  # it leaves these out of one list and not of another
        scene = {kind: torch.from_numpy(np.ascontiguousarray(values[seen], "f4")) for kind, values in scene.items()}
        width, height, fx, fy = (camera[kind] for kind in ("width", "height", "fx", "fy"))
        project = np.zeros((4, 4))
        project[0, 0], project[1, 1], project[2, 2], project[2, 3], project[3, 2] = 2 * fx / width, 2 * fy / height, 1, -0.01, 1
        eye = types.SimpleNamespace(
            image_width=width, image_height=height, focal_x=fx, focal_y=fy, FoVx=2 * np.arctan(width / 2 / fx),
            FoVy=2 * np.arctan(height / 2 / fy), world_view_transform=torch.from_numpy(view.T.astype("f4")),
            projection_matrix=torch.from_numpy(project.T.astype("f4")),
            camera_center=torch.from_numpy((-view[:3, :3].T @ view[:3, 3]).astype("f4")))
        model = types.SimpleNamespace(get_xyz=scene["mean"], get_opacity=scene["opacity"][:, None], get_features=scene["sh"],
                                      get_scaling=scene["scale"], get_rotation=scene["rotation"])
        own = render.GaussRenderer(active_sh_degree=int(scene["sh"].shape[1] ** 0.5) - 1, white_bkgd=False)
        own.pix_coord = torch.stack(torch.meshgrid(torch.arange(width), torch.arange(height), indexing="xy"), -1)
        with torch.no_grad():
            drawn = own(eye, model)
        np.save(picture, torch.cat([drawn["render"], drawn["alpha"]], -1).numpy())


def draw_by_aframe(options, program, cases):
    folder = source_of(options, program.repository, "index.js")
    put_three(folder)
    draw_by_page(options, cases, folder, "aframe")


def draw_by_gsplatjs(options, program, cases):
    """From its TypeScript, without the types, which the node of playwright can take away."""
    folder = source_of(options, program.repository, "src")
    if not importlib.util.find_spec("playwright"):
        raise Absent("no playwright; --install fetches it")

    def constructor(match):  # `public x: T` among what it takes is a field, which node cannot make
        fields = re.findall(r"(?:public|private) (\w+)", match[1])
        return (f"constructor({re.sub('public |private ', '', match[1])}) {{{match[2] or ''}"
                + "".join(f" this.{name} = {name};" for name in fields))

    for path in [*folder.rglob("*.ts")]:
        text = re.sub(r"constructor\(([^()]*)\) {(\s*super\(.*?\);)?", constructor, path.read_text())
        text = re.sub(r'import (\w+) from "([^"]+)\.ts\?worker&inline";', r"""const \1 = class extends Worker {
  constructor() { super(new URL("\2.js", import.meta.url), { type: "module" }); } };""", text)
        path.write_text(re.sub(r'(from "\.[^"]*?)(\.js)?";', r'\1.js";', text))
    node = pathlib.Path(importlib.util.find_spec("playwright").origin).parent / "driver/node"
    strip = """const fs = require('fs'), strip = require('module').stripTypeScriptTypes;
for (const name of process.argv.slice(1))
  fs.writeFileSync(name.slice(0, -2) + 'js', strip(fs.readFileSync(name, 'utf8')));"""
    names = [str(path) for path in folder.rglob("*.ts") if not path.name.endswith(".d.ts")]
    subprocess.run([node, "-e", strip, *names], check=True, capture_output=True)
    draw_by_page(options, cases, folder, "gsplatjs")


def draw_by_viser(options, program, cases):
    """Its client's page, which its server fills by a socket. It has no harmonics: colours are of degree 0."""
    try:
        import numpy as np
        import viser
    except ImportError as error:
        raise Absent(f"{error}; --install fetches it")
    import stored
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    given = {}

    @server.on_client_connect
    def _(client):
        view = np.array(given["world_to_camera"])
        turn = viser.transforms.SO3.from_matrix(view[:3, :3].T)
        with client.atomic():
            client.camera.wxyz, client.camera.position = turn.wxyz, -view[:3, :3].T @ view[:3, 3]
            client.camera.near, client.camera.far = 0.1, 1000.0
            client.camera.fov = 2 * np.arctan(given["height"] / 2 / given["fy"])

    def page_of(path, camera, _):
        scene = stored.read(path)
        given.update(camera)
        server.scene.add_gaussian_splats(
            "/scene", scene["mean"], stored.covariances(scene, stored.unit(scene["rotation"])),
            scene["sh"][:, 0] * stored.C0 + np.float32(0.5), scene["opacity"][:, None].astype("f4"))
        return f"http://127.0.0.1:{server.get_port()}/?fixedDpr=1", None

    draw_in_browser(options, cases, options.output, page_of)
    server.stop()


def draw_by_viewer(options, program, cases):
    """limacv's viewer: its OpenGL renderer, into floats, without a window. Its blending makes no alpha: three planes."""
    os.environ.update(PYOPENGL_PLATFORM="egl", EGL_PLATFORM="surfaceless", LIBGL_ALWAYS_SOFTWARE="1")
    try:
        import numpy as np
        from OpenGL import EGL, GL
        import glm  # noqa: its own need
        import plyfile  # noqa
    except ImportError as error:
        raise Absent(f"{error}; --install fetches it")
    import stored
    folder = source_of(options, program.repository)
    display = EGL.eglGetDisplay(EGL.EGL_DEFAULT_DISPLAY)
    EGL.eglInitialize(display, None, None)
    EGL.eglBindAPI(EGL.EGL_OPENGL_API)
    configs, n = (EGL.EGLConfig * 1)(), EGL.EGLint()
    EGL.eglChooseConfig(display, [EGL.EGL_RENDERABLE_TYPE, EGL.EGL_OPENGL_BIT, EGL.EGL_NONE], configs, 1, n)
    context = EGL.eglCreateContext(display, configs[0], EGL.EGL_NO_CONTEXT, [
        EGL.EGL_CONTEXT_MAJOR_VERSION, 4, EGL.EGL_CONTEXT_MINOR_VERSION, 3, EGL.EGL_NONE])
    EGL.eglMakeCurrent(display, EGL.EGL_NO_SURFACE, EGL.EGL_NO_SURFACE, context)
    GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, GL.glGenFramebuffers(1))
    GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, GL.glGenRenderbuffers(1))
    GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, GL.GL_RGBA32F, WIDTH, HEIGHT)
    GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, GL.GL_COLOR_ATTACHMENT0, GL.GL_RENDERBUFFER, 1)
    before = os.getcwd()
    os.chdir(folder)  # it opens its shaders from here
    sys.path.insert(0, str(folder))
    ogl, util, util_gau = (importlib.import_module(name) for name in ("renderer_ogl", "util", "util_gau"))
    renderer = ogl.OpenGLRenderer(WIDTH, HEIGHT)
    os.chdir(before)
    for name, path, given, picture in cases:
        scene, view = stored.read(path), np.array(given["world_to_camera"])
        flat = [values.reshape(len(values), -1).astype("f4") for values in
                (scene["mean"], stored.unit(scene["rotation"]), scene["scale"], scene["opacity"], scene["sh"])]
        camera = util.Camera(HEIGHT, WIDTH)
        camera.fovy, camera.position = 2 * np.arctan(HEIGHT / 2 / given["fy"]), -view[:3, :3].T @ view[:3, 3]
        camera.get_view_matrix = lambda: np.diag([1, -1, -1, 1]) @ view
        renderer.update_gaussian_data(util_gau.GaussianData(*flat))
        renderer.sort_and_update(camera)
        for tell in (renderer.update_camera_pose, renderer.update_camera_intrin):
            tell(camera)
        renderer.set_scale_modifier(1.0)
        renderer.set_render_mod(3)
        GL.glClearColor(0, 0, 0, 0)
        GL.glClear(GL.GL_COLOR_BUFFER_BIT)
        renderer.draw()
        np.save(picture, GL.glReadPixels(0, 0, WIDTH, HEIGHT, GL.GL_RGB, GL.GL_FLOAT, outputType=np.ndarray)
                .reshape(HEIGHT, WIDTH, 3)[::-1])


def draw_by_warp(options, program, cases):
    """3DGS-native by Warp's processor back end, called as its train.py does, quaternions x, y, z, w as its kernel reads."""
    try:
        import numpy as np
        import warp
    except ImportError as error:
        raise Absent(f"{error}; --install fetches it")
    import stored
    folder = source_of(options, program.repository, "forward.py", "config.py", "utils")
    text = (folder / "config.py").read_text()
    (folder / "config.py").write_text(text.replace('DEVICE = "cuda"', 'DEVICE = "cpu"'))
    warp.config.quiet, warp.config.kernel_cache_dir = True, str(options.output / "warp")
    sys.path.insert(0, str(folder))
    forward = importlib.import_module("forward")
    for name, path, camera, picture in cases:
        scene, view = stored.read(path), np.array(camera["world_to_camera"])
        tan_x, tan_y = WIDTH / 2 / camera["fx"], HEIGHT / 2 / camera["fy"]
        project = importlib.import_module("utils.math_utils").projection_matrix(
            2 * np.arctan(tan_x), 2 * np.arctan(tan_y), 0.01, 100.0)
        sh = np.zeros((len(scene["mean"]), 16, 3), "f4")
        sh[:, :scene["sh"].shape[1]] = scene["sh"]
        drawn, _, more = forward.render_gaussians(
            background=np.zeros(3, "f4"), means3D=scene["mean"], colors=None, opacity=scene["opacity"][:, None].astype("f4"),
            scales=scene["scale"], rotations=stored.unit(scene["rotation"])[:, [1, 2, 3, 0]], scale_modifier=1.0,
            viewmatrix=view.T.astype("f4"), projmatrix=(project @ view).T.astype("f4"), tan_fovx=tan_x, tan_fovy=tan_y,
            image_height=HEIGHT, image_width=WIDTH, sh=sh, degree=int(scene["sh"].shape[1] ** 0.5) - 1,
            campos=(-view[:3, :3].T @ view[:3, 3]).astype("f4"), prefiltered=False, antialiasing=False, clamped=True)
        np.save(picture, np.dstack((drawn.numpy(), 1 - more["final_Ts"].numpy())))


DRAW = {"torch": draw_by_torch, "splat": draw_by_splat, "playcanvas": draw_by_playcanvas, "gs3d": draw_by_gs3d,
        "spark": draw_by_spark, "gausscam": draw_by_gausscam, "torch-splatting": draw_by_torch_splatting,
        "aframe": draw_by_aframe, "gsplatjs": draw_by_gsplatjs, "viser": draw_by_viser, "viewer": draw_by_viewer,
        "warp": draw_by_warp}
IN_CHROMIUM = {"splat", "playcanvas", "gs3d", "spark", "aframe", "gsplatjs", "viser"}
