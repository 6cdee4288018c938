"""VTK's points as discs that face the camera, the nearest of which wins: vtkPointGaussianMapper, by OpenGL without a
display. Prints what the first frame, which uploads, and then a frame took, as a median in milliseconds, and writes the
picture.

    python3 points_vtk.py SPLATS.ply CAMERA OUT.pfm FRAMES         arguments as those of discs_embree.c
"""
import math
import statistics
import sys
import time

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

FIELDS = [(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz", "radius")] + [(name, "u1") for name in "rgb"]


def read_splats(path):
    with open(path, "rb") as file:
        return numpy.frombuffer(file.read().split(b"end_header\n", 1)[1], dtype=numpy.dtype(FIELDS))


def make_actor(splats):
    points, data = vtk.vtkPoints(), vtk.vtkPolyData()
    points.SetData(numpy_to_vtk(numpy.stack([splats[k] for k in "xyz"], axis=1), deep=True))
    data.SetPoints(points)
    for name, values in (("radius", splats["radius"]), ("color", numpy.stack([splats[k] for k in "rgb"], axis=1))):
        array = numpy_to_vtk(numpy.ascontiguousarray(values), deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
    data.GetPointData().SetActiveScalars("color")
    mapper = vtk.vtkPointGaussianMapper()
    mapper.SetInputData(data)
    mapper.SetScaleArray("radius")
    mapper.SetScaleFactor(1.0)
    mapper.EmissiveOff()
    mapper.SetSplatShaderCode("//VTK::Color::Impl\n"
                              "if (dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy) > 1.0) { discard; }\n"
                              "diffuseColor = vec3(0.0); ambientColor = vertexColorVSOutput.rgb; opacity = 1.0;\n")
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(1.0)
    actor.GetProperty().SetDiffuse(0.0)
    return actor


def place(camera, width, height, fx, fy, cx, cy, rows):
    rotation = [rows[4 * i:4 * i + 3] for i in range(3)]
    eye = [-sum(rotation[k][i] * rows[4 * k + 3] for k in range(3)) for i in range(3)]
    camera.SetPosition(*eye)
    camera.SetFocalPoint(*(eye[i] + rotation[2][i] for i in range(3)))
    camera.SetViewUp(*(-value for value in rotation[1]))
    camera.SetViewAngle(2.0 * math.degrees(math.atan(0.5 * height / fy)))
    camera.SetWindowCenter(1.0 - 2.0 * cx / width, 2.0 * cy / height - 1.0)


def main(path, camera, out, n_frames):
    width, height, *numbers = (float(word) for word in camera.split())
    renderer, window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(int(width), int(height))
    window.AddRenderer(renderer)
    renderer.AddActor(make_actor(read_splats(path)))
    place(renderer.GetActiveCamera(), width, height, *numbers[:4], numbers[4:])
    renderer.ResetCameraClippingRange()
    times, image = [], vtk.vtkUnsignedCharArray()
    for _ in range(n_frames + 1):
        start = time.perf_counter()
        window.Render()
        window.GetPixelData(0, 0, int(width) - 1, int(height) - 1, 1, image, 0)
        times.append(1e3 * (time.perf_counter() - start))
    codes = vtk_to_numpy(image).reshape(int(height), int(width), 3).astype("float32") / 255.0
    linear = numpy.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055)**2.4).astype("<f4")
    with open(out, "wb") as file:
        file.write(b"PF\n%d %d\n-1.0\n" % (width, height) + linear.tobytes())
    print(f"{times[0]:.2f} {statistics.median(times[1:]):.2f}")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4]))
