"""The structs of include/conic/ and cli/host.h that Python fills or reads.

tests/python/layouts.sh holds every one against the headers, member by member."""

import ctypes
from ctypes import (CFUNCTYPE, POINTER, c_char, c_char_p, c_double, c_float, c_int, c_int64, c_size_t,
                    c_uint32, c_uint64, c_void_p)

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
        ("scalar_origin", c_double),
        ("reserved", c_uint64 * 2),
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
        ("scalar_origin", c_double),
        ("reserved", c_uint64 * 4),
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
        ("follows_cutoff", c_uint64),
        ("colors_are", c_uint32),
        ("reserved_word", c_uint32),
        ("n_unmeasured", c_uint64),
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
        ("up", c_float * 3),
        ("reserved", c_uint64 * 3),
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
        ("shutter", c_uint32),
        ("reserved_word", c_uint32),
        ("turn", c_double * 3),
        ("shift", c_double * 3),
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
        ("allows_outside", c_int),
    ]


class Loan(ctypes.Structure):
    C_NAME = "cli_loan"
    _fields_ = [("name", c_char_p), ("what", c_void_p)]


VALUE_SET, VALUE_WHOLE, VALUE_NUMBERS, VALUE_TEXT = range(4)
MOST_NUMBERS = 16


class Value(ctypes.Structure):
    C_NAME = "cli_value"
    _fields_ = [
        ("name", c_char_p),
        ("type", c_int),
        ("n_numbers", c_int),
        ("whole", c_int64),
        ("numbers", c_double * MOST_NUMBERS),
        ("text", c_char_p),
        ("said", c_char * 400),
    ]


# --- shots ---

MAX_LIGHTS = 8
MAX_LAMPS = 8
MAX_METHODS = 16


class CameraWay(ctypes.Structure):
    C_NAME = "conic_camera_way"
    _fields_ = [
        ("kind", c_int),
        ("reserved_int", c_int),
        ("frames_a_turn", c_double),
        ("center", c_double * 3),
        ("up", c_double * 3),
        ("cameras", POINTER(Camera)),
        ("n_cameras", c_uint64),
        ("place", c_double),
        ("reserved", c_uint64 * 4),
    ]


class StereoEye(ctypes.Structure):
    C_NAME = "conic_stereo_eye"
    _fields_ = [
        ("shift", c_double),
        ("convergence", c_double),
        ("center", c_double * 3),
        ("finds_convergence", c_int),
        ("reserved_int", c_int),
        ("reserved", c_uint64 * 2),
    ]


class Kernel(ctypes.Structure):
    C_NAME = "conic_kernel"
    _fields_ = [("type", c_int), ("cutoff", c_float), ("a", c_float), ("b", c_float), ("n", c_int)]


class Light(ctypes.Structure):
    C_NAME = "conic_light"
    _fields_ = [("frame", c_int), ("color", c_float * 3), ("direction", c_double * 3)]


class Lighting(ctypes.Structure):
    C_NAME = "conic_lighting"
    _fields_ = [
        ("is_given", c_int),
        ("n_lights", c_int),
        ("lights", Light * MAX_LIGHTS),
        ("sky", c_float * 3),
        ("ground", c_float * 3),
        ("up", c_double * 3),
        ("reserved", c_uint64 * 4),
    ]


class RenderOptions(ctypes.Structure):
    C_NAME = "conic_render_options"
    _fields_ = [
        ("size", c_size_t),
        ("method", c_int),
        ("kernel", Kernel),
        ("prefilter", c_float),
        ("epsilon", c_double),
        ("passes", c_int),
        ("cull_back", c_int),
        ("near_z", c_double),
        ("splat_length", c_double),
        ("shading", c_int),
        ("has_light", c_int),
        ("light", c_double * 3),
        ("has_background", c_int),
        ("background", c_float * 3),
        ("exposure", c_double),
        ("tile", c_int),
        ("isa", c_int),
        ("lighting", Lighting),
        ("splats_version", c_uint64),
        ("skip_hidden", c_int),
    ]


class SourceView(ctypes.Structure):
    C_NAME = "conic_source_view"
    _fields_ = [
        ("size", c_size_t),
        ("error_px", c_double),
        ("budget", c_uint64),
        ("only_kind", c_int),
        ("samples", c_int),
        ("most_levels", c_int),
        ("occlusion", c_int),
        ("may_be_coarser", c_int),
        ("seconds", c_double),
        ("tolerates_damage", c_int),
        ("color_error", c_double),
        ("transparency", c_int),
        ("chance", c_double),
        ("is_alone", c_int),
        ("reserved_int", c_int),
    ]


class GaussianOptions(ctypes.Structure):
    C_NAME = "conic_gaussian_options"
    _fields_ = [
        ("size", c_size_t),
        ("profile", c_int),
        ("background", c_float * 3),
        ("isa", c_int),
        ("ignores_center", c_uint32),
        ("device", c_void_p),
        ("prefilter", c_double),
    ]


class Lamp(ctypes.Structure):
    C_NAME = "conic_lamp"
    _fields_ = [
        ("kind", c_int),
        ("color", c_float * 3),
        ("position", c_double * 3),
        ("radius", c_double),
        ("axes", (c_double * 3) * 2),
        ("reserved", c_uint64 * 4),
    ]


class ShotLight(ctypes.Structure):
    C_NAME = "conic_shot_light"
    _fields_ = [
        ("n_directions", c_uint64),
        ("has_shadows", c_int),
        ("n_lamps", c_int),
        ("lamps", Lamp * MAX_LAMPS),
        ("sun_radius_deg", c_float * MAX_LIGHTS),
        ("sky", c_void_p),
        ("reflectance", c_double),
        ("dome_stops", c_double),
        ("reserved", c_uint64 * 2),
    ]


class Aperture(ctypes.Structure):
    C_NAME = "conic_aperture"
    _fields_ = [
        ("diameter", c_double),
        ("focus", c_double),
        ("n_blades", c_int),
        ("reserved_int", c_int),
        ("reserved", c_uint64 * 4),
    ]


class Shot(ctypes.Structure):
    C_NAME = "conic_shot"
    _fields_ = [
        ("size", c_size_t),
        ("camera", Camera),
        ("way", CameraWay),
        ("eye", StereoEye),
        ("planes", c_uint32),
        ("reserved_int", c_int),
        ("render", RenderOptions),
        ("view", SourceView),
        ("gaussians", GaussianOptions),
        ("light", ShotLight),
        ("has_backdrop", c_int),
        ("backdrop_top", c_float * 3),
        ("backdrop_bottom", c_float * 3),
        ("n_samples", c_uint64),
        ("noise", c_double),
        ("aperture", Aperture),
        ("focus_kind", c_int),
        ("is_shutter_open", c_int),
        ("focus_pixel", c_double * 2),
        ("shutter", c_double * 2),
        ("frame", c_double),
        ("motion", c_void_p),
        ("catchers", c_uint64),
        ("holdouts", c_uint64),
        ("reserved", c_uint64 * 6),
    ]


# --- how files are read ---


class Access(ctypes.Structure):
    C_NAME = "conic_layers_access"
    _fields_ = [
        ("size", c_size_t),
        ("memory_bytes", c_uint64),
        ("connect_seconds", c_double),
        ("stall_seconds", c_double),
        ("n_retries", c_int),
        ("pause_seconds", c_double),
        ("n_connections", c_int),
        ("seconds", c_double),
    ]


class Surface(ctypes.Structure):
    C_NAME = "conic_surface_options"
    _fields_ = [
        ("size", c_size_t),
        ("type", c_int),
        ("plane", c_int),
        ("weight", c_int),
        ("degree", c_int),
        ("h", c_double),
        ("neglect", c_double),
        ("n_local", c_int),
        ("cluster", c_double),
        ("isa", c_int),
        ("is_sharp", c_uint64),
        ("reserved", c_uint64 * 7),
    ]


class Patches(ctypes.Structure):
    C_NAME = "conic_patches_options"
    _fields_ = [
        ("size", c_size_t),
        ("surface", Surface),
        ("cutoff", c_float),
        ("step_px", c_double),
        ("mesh", c_void_p),
    ]


class Coloring(ctypes.Structure):
    C_NAME = "conic_coloring_options"
    _fields_ = [
        ("size", c_size_t),
        ("by", c_char_p),
        ("ramp", c_char_p),
        ("has_range", c_int),
        ("minimum", c_double),
        ("maximum", c_double),
        ("up", c_double * 3),
    ]


class Reading(ctypes.Structure):
    C_NAME = "conic_source_options"
    _fields_ = [
        ("size", c_size_t),
        ("as", c_int),
        ("is_whole", c_int),
        ("cutoff", c_float),
        ("n_neighbours", c_int),
        ("texture_path", c_char_p),
        ("is_smooth", c_int),
        ("access", POINTER(Access)),
        ("patches", POINTER(Patches)),
        ("h_in_spacings", c_int),
        ("projects_degrees", c_int),
        ("finds_dots", c_int),
        ("coloring", POINTER(Coloring)),
        ("columns", c_char_p),
        ("crease_deg", c_double),
        ("gaussians", POINTER(GaussianOptions)),
        ("where", c_char_p),
        ("keeps_alpha", c_int),
        ("cache", c_char_p),
        ("colors_are", c_int),
        ("place", c_char_p),
        ("most_raw", c_uint64),
    ]


# --- a shot's file ---


class ShotInput(ctypes.Structure):
    C_NAME = "conic_shot_input"
    _fields_ = [
        ("name", c_char_p),
        ("role", c_int),
        ("is_sampled", c_int),
        ("n_bytes", c_uint64),
        ("sha256", c_char * 72),
        ("reserved", c_uint64 * 4),
    ]


class ShotMap(ctypes.Structure):
    C_NAME = "conic_shot_map"
    _fields_ = [
        ("is_wanted", c_int),
        ("epsg", c_int),
        ("pixel", c_double),
        ("minimum", c_double * 3),
        ("maximum", c_double * 3),
        ("reserved", c_uint64 * 4),
    ]


class ShotWriting(ctypes.Structure):
    C_NAME = "conic_shot_writing"
    _fields_ = [
        ("tone", c_int),
        ("compression", c_int),
        ("is_half", c_int),
        ("is_bare", c_int),
        ("has_legend", c_int),
        ("has_mattes", c_int),
        ("matte_by", c_char_p),
        ("reserved", c_uint64 * 3),
    ]


class ShotFile(ctypes.Structure):
    C_NAME = "conic_shot_file"
    _fields_ = [
        ("size", c_size_t),
        ("shot", Shot),
        ("reading", Reading),
        ("map", ShotMap),
        ("writing", ShotWriting),
        ("inputs", POINTER(ShotInput)),
        ("n_inputs", c_size_t),
    ]


class ShotField(ctypes.Structure):
    C_NAME = "conic_shot_field"
    _fields_ = [
        ("path", c_char * 96),
        ("kind", c_int),
        ("count", c_int),
        ("unit", c_char_p),
        ("meaning", c_char_p),
        ("words", c_char_p * 32),
        ("standard", c_char * 160),
    ]


# --- what comes of a picture ---


class Milliseconds(ctypes.Structure):
    C_NAME = "conic_render_milliseconds"
    _fields_ = [*((name, c_double) for name in ("lod", "setup", "bin", "visibility", "accumulate", "resolve", "frame")),
                ("reserved", c_uint64 * 8)]


class Statistics(ctypes.Structure):
    C_NAME = "conic_render_statistics"
    _fields_ = [
        ("splats_in", c_uint64),
        ("splats_culled", c_uint64),
        ("splats_skipped", c_uint64),
        ("splats_drawn", c_uint64),
        ("splats_fallback", c_uint64),
        ("splats_by_method", c_uint64 * MAX_METHODS),
        ("fragments", c_uint64),
        ("pixels_covered", c_uint64),
        ("triangles_in", c_uint64),
        ("triangles_culled", c_uint64),
        ("triangles_skipped", c_uint64),
        ("triangles_drawn", c_uint64),
        ("triangle_fragments", c_uint64),
        ("near_z", c_double),
        ("epsilon", c_double),
        ("epsilon_is_fixed", c_int),
        ("threads", c_int),
        ("tile", c_int),
        ("isa", c_char_p),
        ("ms", Milliseconds),
        ("splats_by_laplace", c_uint64),
        ("reserved", c_uint64 * 15),
    ]


class AccumulationFacts(ctypes.Structure):
    C_NAME = "conic_accumulation_facts"
    _fields_ = [
        ("width", c_int),
        ("height", c_int),
        ("planes", c_uint32),
        ("reserved_int", c_uint32),
        ("first_sample", c_uint64),
        ("end_sample", c_uint64),
        ("key", c_uint64),
        ("reserved", c_uint64 * 4),
    ]


class Outcome(ctypes.Structure):
    C_NAME = "conic_shot_outcome"
    _fields_ = [
        ("statistics", Statistics),
        ("light_ms", c_double),
        ("samples", AccumulationFacts),
        ("noise", c_double),
        ("focus_depth", c_double),
        ("bound", c_double),
        ("reserved", c_uint64 * 7),
    ]


class Drawn(ctypes.Structure):
    C_NAME = "cli_drawn"
    _fields_ = [
        ("i_frame", c_int),
        ("reserved_int", c_int),
        ("view", c_char_p),
        ("image", POINTER(Image)),
        ("camera", POINTER(Camera)),
        ("shot", POINTER(Shot)),
        ("opening", POINTER(Reading)),
        ("writing", POINTER(ShotWriting)),
        ("sky_path", c_char_p),
        ("motion_path", c_char_p),
    ]


LayOutFunction = CFUNCTYPE(c_int, c_void_p, c_int, c_int, c_uint32, POINTER(c_void_p))
TakeFunction = CFUNCTYPE(None, c_void_p, POINTER(Drawn))


class Host(ctypes.Structure):
    C_NAME = "cli_host"
    _fields_ = [
        ("cookie", c_void_p),
        ("progress", ProgressFunction),
        ("progress_seconds", c_double),
        ("told_at", c_double),
        ("is_stopped", c_int),
        ("say", LogFunction),
        ("lay_out", LayOutFunction),
        ("take", TakeFunction),
        ("loans", POINTER(Loan)),
        ("n_loans", c_size_t),
        ("values", POINTER(Value)),
        ("n_values", c_size_t),
        ("kept", c_void_p),
        ("keeps_source", c_int),
        ("status", c_int),
        ("facts", c_void_p),
        ("n_facts_bytes", c_size_t),
        ("facts_room", c_size_t),
        ("facts_are_lost", c_int),
    ]


STRUCTS = (Strides, Splats, TrianglesStrides, Triangles, Model, Gaussians, Camera, Cameras, CamerasOptions, Attribute,
           Image, ImageOptions, PlaneDescription, Feature, ContextOptions, Loan, Value, CameraWay, StereoEye, Kernel,
           Light, Lighting, RenderOptions, SourceView, GaussianOptions, Lamp, ShotLight, Aperture, Shot, Access,
           Surface, Patches, Coloring, Reading, ShotInput, ShotMap, ShotWriting, ShotFile, ShotField, Milliseconds,
           Statistics, AccumulationFacts, Outcome, Drawn, Host)
