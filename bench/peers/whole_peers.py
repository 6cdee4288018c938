"""Whole commands by libraries for Python, which `whole` beside this runs and measures: from a file to a picture, or to the
normals of its points.

    python3 whole_peers.py f3d|pyvista|open3d IN OUT.png          a picture of 1024 x 1024
    python3 whole_peers.py embreex MESH OUT.png                   the same of a mesh, by rays
    python3 whole_peers.py meshoptimizer MESH OUT.npy             a tenth of its triangles
    python3 whole_peers.py open3d-normals|nanoflann IN OUT.npy    normals; nanoflann: the 16 nearest points alone
    python3 whole_peers.py --check NAME                           fails where it cannot be had
"""
import sys

SIZE = 1024
NEIGHBOURS = 16


def draw_f3d(path, out):
    import f3d
    engine = f3d.Engine.create(True)
    engine.window.size = SIZE, SIZE
    engine.scene.add(path)
    engine.window.render_to_image().save(out)


def draw_pyvista(path, out):
    import pyvista
    plotter = pyvista.Plotter(off_screen=True, window_size=(SIZE, SIZE))
    data = pyvista.read(path)
    scalars = "RGB" if "RGB" in data.point_data else None
    plotter.add_mesh(data, scalars=scalars, rgb=scalars is not None)
    plotter.screenshot(out)


def draw_open3d(path, out):
    import open3d
    is_mesh = path.endswith(".obj")
    cloud = open3d.io.read_triangle_mesh(path) if is_mesh else open3d.io.read_point_cloud(path)
    renderer = open3d.visualization.rendering.OffscreenRenderer(SIZE, SIZE)
    material = open3d.visualization.rendering.MaterialRecord()
    if is_mesh:
        cloud.compute_vertex_normals()
        material.shader = "defaultLit"
    renderer.scene.add_geometry("cloud", cloud, material)
    box = cloud.get_axis_aligned_bounding_box()
    renderer.setup_camera(40.0, box.get_center(), box.get_center() + box.get_extent().max() * 2.0, [0.0, 1.0, 0.0])
    open3d.io.write_image(out, renderer.render_to_image())


def normals_open3d(path, out):
    import numpy
    import open3d
    cloud = open3d.io.read_point_cloud(path)
    cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(NEIGHBOURS))
    numpy.save(out, numpy.asarray(cloud.normals))


def neighbours_nanoflann(path, out):
    import numpy
    import open3d  # which reads the file
    import pynanoflann
    points = numpy.asarray(open3d.io.read_point_cloud(path).points, dtype=numpy.float32)
    tree = pynanoflann.KDTree(n_neighbors=NEIGHBOURS)
    tree.fit(points)
    numpy.save(out, tree.kneighbors(points)[1])


def draw_embreex(path, out):
    import numpy
    import trimesh
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene
    from PIL import Image
    mesh = trimesh.load(path, force="mesh", process=False)
    scene = EmbreeScene()
    TriangleMesh(scene, numpy.asarray(mesh.triangles, dtype=numpy.float32))
    across = (numpy.arange(SIZE, dtype=numpy.float32) + 0.5) / SIZE - 0.5
    x, y = numpy.meshgrid(across, -across)
    away = numpy.stack([x, y, numpy.full_like(x, -1.4)], -1).reshape(-1, 3)
    away /= numpy.linalg.norm(away, axis=1, keepdims=True)
    eye = mesh.bounds.mean(axis=0) + [0.0, 0.0, 1.6 * mesh.extents.max()]
    hit = scene.run(numpy.ascontiguousarray(numpy.broadcast_to(eye, away.shape), dtype=numpy.float32), away)
    light = numpy.abs((mesh.face_normals[hit] * away).sum(axis=1)) * (hit >= 0)
    Image.fromarray((255.0 * light).astype(numpy.uint8).reshape(SIZE, SIZE)).save(out)


def simplify_meshoptimizer(path, out):
    import meshoptimizer
    import numpy
    import trimesh
    mesh = trimesh.load(path, force="mesh", process=False)
    indices = numpy.asarray(mesh.faces, dtype=numpy.uint32).ravel()
    fewer = numpy.zeros_like(indices)
    n = meshoptimizer.simplify(fewer, indices, numpy.asarray(mesh.vertices, dtype=numpy.float32),
                               target_index_count=len(indices) // 30 * 3, target_error=1.0)
    numpy.save(out, fewer[:n])


PEERS = {"embreex": (draw_embreex, ["embreex", "trimesh", "PIL"]),
         "meshoptimizer": (simplify_meshoptimizer, ["meshoptimizer", "trimesh"]),
         "f3d": (draw_f3d, ["f3d"]), "pyvista": (draw_pyvista, ["pyvista"]), "open3d": (draw_open3d, ["open3d"]),
         "open3d-normals": (normals_open3d, ["open3d"]),
         "nanoflann": (neighbours_nanoflann, ["pynanoflann", "open3d"])}

if sys.argv[1] == "--check":
    for module in PEERS[sys.argv[2]][1]:
        __import__(module)
else:
    PEERS[sys.argv[1]][0](*sys.argv[2:])
