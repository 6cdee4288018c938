"""The structs of include/conic/ and cli/host.h that Python fills or reads.

tests/python/layouts.sh holds every one against the headers, member by member."""

import ctypes
from ctypes import (CFUNCTYPE, POINTER, c_char, c_char_p, c_double, c_float, c_int, c_size_t, c_uint32,
                    c_uint64, c_void_p)

MAX_PLANES = 24
MAX_ATTRIBUTES = 24

Column = c_void_p  # float *: of a caller's array, which may be strided
Triple = Column * 3


class Strides(ctypes.Structure):
    C_NAME = "conic_splats_strides"
    _fields_ = [(name, c_size_t) for name in
                ("position", "tangent_u", "tangent_v", "normal", "color", "opacity", "dot", "scalar", "sight")]


class Splats(ctypes.Structure):
    C_NAME = "conic_splats"
    _fields_ = [
        ("count", c_size_t),
        ("origin", c_double * 3),
        ("position", Triple),
        ("tangent_u", Triple),
        ("tangent_v", Triple),
        ("normal", Triple),
        ("color", Triple),
        ("opacity", Column),
        ("n_clips", c_size_t),
        ("clips", c_void_p),
        ("strides", Strides),
        ("dot", Column),
        ("scalar", Column),
        ("sight", Triple),
        ("values", c_uint64),
        ("reserved", c_uint64 * 3),
    ]


class TrianglesStrides(ctypes.Structure):
    C_NAME = "conic_triangles_strides"
    _fields_ = [(name, c_size_t) for name in ("position", "color", "normal", "texture_coordinate", "scalar")]


class Triangles(ctypes.Structure):
    C_NAME = "conic_triangles"
    _fields_ = [
        ("count", c_size_t),
        ("corners", c_void_p),
        ("n_vertices", c_size_t),
        ("origin", c_double * 3),
        ("position", Triple),
        ("color", Triple),
        ("n_normals", c_size_t),
        ("normal", Triple),
        ("normal_corners", c_void_p),
        ("n_texture_coordinates", c_size_t),
        ("texture_coordinate", Column * 2),
        ("texture_corners", c_void_p),
        ("n_materials", c_size_t),
        ("materials", c_void_p),
        ("material", c_void_p),
        ("cluster", c_void_p),
        ("strides", TrianglesStrides),
        ("scalar", Column),
        ("alpha", Column),
        ("reserved", c_uint64 * 5),
    ]


class Model(ctypes.Structure):
    C_NAME = "conic_model"
    _fields_ = [
        ("points", Splats),
        ("n_triangles", c_size_t),
        ("triangles", c_void_p),
        ("kind", c_int),
        ("faces", c_void_p),
        ("up", c_double * 3),
        ("fields", c_void_p),
        ("n_fields", c_size_t),
        ("reserved", c_uint64 * 3),
    ]


class Gaussians(ctypes.Structure):
    C_NAME = "conic_gaussians"
    _fields_ = [
        ("count", c_size_t),
        ("origin", c_double * 3),
        ("position", Triple),
        ("scale", Triple),
        ("rotation", Column * 4),
        ("opacity", Column),
        ("sh_degree", c_int),
        ("sh", c_void_p),
        ("sh_half", c_void_p),
        ("log_scale", Triple),
        ("logit_opacity", Column),
        ("kind", c_int),
        ("frame", c_char * 4),
        ("is_antialiased", c_int),
        ("is_linear", c_int),
        ("n_left_out", c_int),
        ("reserved_int", c_int),
        ("reserved", c_uint64 * 4),
    ]


class Camera(ctypes.Structure):
    C_NAME = "conic_camera"
    _fields_ = [
        ("width", c_int),
        ("height", c_int),
        ("fx", c_double),
        ("fy", c_double),
        ("cx", c_double),
        ("cy", c_double),
        ("cam_from_world", (c_double * 4) * 3),
        ("kind", c_uint32),
        ("lens", c_uint32),
        ("distortion", c_double * 8),
        ("reserved", c_uint64 * 7),
    ]


class Cameras(ctypes.Structure):
    C_NAME = "conic_cameras"
    _fields_ = [
        ("count", c_size_t),
        ("cameras", POINTER(Camera)),
        ("names", POINTER(c_char_p)),
        ("path", c_char_p),
        ("kind", c_uint32),
        ("reserved_int", c_uint32),
        ("reserved", c_uint64 * 6),
    ]


class CamerasOptions(ctypes.Structure):
    C_NAME = "conic_cameras_options"
    _fields_ = [("size", c_size_t), ("width", c_int), ("height", c_int)]


class Attribute(ctypes.Structure):
    C_NAME = "conic_attribute"
    _fields_ = [("name", c_char * 40), ("type", c_int), ("text", c_char * 88), ("values", c_double * 16)]


class Image(ctypes.Structure):
    C_NAME = "conic_image"
    _fields_ = [
        ("width", c_int),
        ("height", c_int),
        ("planes", c_void_p * MAX_PLANES),
        ("n_attributes", c_int),
        ("attributes", Attribute * MAX_ATTRIBUTES),
        ("lacks_alpha", c_uint64),
        ("is_display", c_uint64),
        ("manifest", c_char_p),
        ("half_planes", c_uint64),
        ("shot", c_char_p),
        ("reserved", c_uint64 * 3),
    ]


class ImageOptions(ctypes.Structure):
    C_NAME = "conic_image_options"
    _fields_ = [("size", c_size_t), ("format", c_char_p), ("is_half", c_int), ("compression", c_int), ("tone", c_int)]


class PlaneDescription(ctypes.Structure):
    C_NAME = "conic_plane_description"
    _fields_ = [("name", c_char_p), ("n_channels", c_int), ("is_uint", c_int), ("channels", c_char_p * 4)]


class Feature(ctypes.Structure):
    C_NAME = "conic_feature"
    _fields_ = [("name", c_char_p), ("available", c_int)]


LogFunction = CFUNCTYPE(None, c_void_p, c_int, c_char_p)
ProgressFunction = CFUNCTYPE(c_int, c_void_p, c_char_p, c_double)


class ContextOptions(ctypes.Structure):
    C_NAME = "conic_context_options"
    _fields_ = [
        ("size", c_size_t),
        ("allocate", c_void_p),
        ("release", c_void_p),
        ("allocator_cookie", c_void_p),
        ("log", LogFunction),
        ("log_cookie", c_void_p),
        ("progress", ProgressFunction),
        ("progress_cookie", c_void_p),
        ("threads", c_int),
        ("large_pages", c_int),
        ("max_allocation_bytes", c_size_t),
        ("isa", c_int),
        ("max_texture_bytes", c_size_t),
    ]


class Loan(ctypes.Structure):
    C_NAME = "cli_loan"
    _fields_ = [("name", c_char_p), ("what", c_void_p)]


LayOutFunction = CFUNCTYPE(c_int, c_void_p, c_int, c_int, c_uint32, POINTER(c_void_p))
TakeFunction = CFUNCTYPE(None, c_void_p, c_int, c_char_p, POINTER(Image), POINTER(Camera))


class Host(ctypes.Structure):
    C_NAME = "cli_host"
    _fields_ = [
        ("cookie", c_void_p),
        ("progress", ProgressFunction),
        ("say", LogFunction),
        ("lay_out", LayOutFunction),
        ("take", TakeFunction),
        ("loans", POINTER(Loan)),
        ("n_loans", c_size_t),
        ("kept", c_void_p),
        ("source_key", c_char_p),
        ("status", c_int),
        ("json", c_void_p),
        ("json_bytes", c_size_t),
    ]


STRUCTS = (Strides, Splats, TrianglesStrides, Triangles, Model, Gaussians, Camera, Cameras, CamerasOptions, Attribute,
           Image, ImageOptions, PlaneDescription, Feature, ContextOptions, Loan, Host)
