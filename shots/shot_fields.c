#include "shots/shot_fields.h"

#include "core/base/base.h"
#include "shots/shot_faults.h"

/* --- words --- */

/* Those that the library names. */
#define NAMED(function, named, type, n)                                                                                \
  static const char *function(int i) {                                                                                 \
    return i >= 0 && i < (n) ? named((type)i) : NULL;                                                                  \
  }
NAMED(camera_kind_word, conic_camera_kind_name, conic_camera_kind, CONIC_N_CAMERA_KINDS)
NAMED(lens_word, conic_lens_name, conic_lens, CONIC_N_LENSES)
NAMED(shutter_word, conic_shutter_name, conic_shutter, CONIC_N_SHUTTERS)
NAMED(method_word, conic_method_name, conic_method, CONIC_N_METHODS)
NAMED(kernel_word, conic_kernel_type_name, conic_kernel_type, CONIC_N_KERNELS)
NAMED(shading_word, conic_shading_name, conic_shading, CONIC_N_SHADINGS)
NAMED(profile_word, conic_gaussian_profile_name, conic_gaussian_profile, CONIC_N_GAUSSIAN_PROFILES)
NAMED(tone_word, conic_tone_name, conic_tone, CONIC_N_TONES)
NAMED(compression_word, conic_compression_name, conic_compression, CONIC_N_COMPRESSIONS)

/* And those that have no names elsewhere. */
#define LISTED(function, ...)                                                                                          \
  static const char *function(int i) {                                                                                 \
    static const char *const words[] = {__VA_ARGS__};                                                                  \
    return i >= 0 && i < (int)(sizeof words / sizeof *words) ? words[i] : NULL;                                        \
  }
LISTED(way_word, "still", "orbit", "cameras")
LISTED(focus_word, "middle", "depth", "pixel")
LISTED(light_frame_word, "world", "camera", "head")
LISTED(lamp_word, "sphere", "disc", "rectangle")
LISTED(transparency_word, "none", "layers", "chance")
LISTED(as_word, "points", "mesh", "hybrid", "patches", "auto")
LISTED(colors_word, "file", "display", "linear")
LISTED(surface_word, "mls", "apss")
LISTED(surface_plane_word, "full", "fast")
LISTED(surface_weight_word, "gauss", "compact", "flat")

static const char *plane_word(int i) {
  const conic_plane_description *plane = i >= 0 && i < CONIC_N_PLANES ? conic_plane_describe((conic_plane)i) : NULL;
  return plane ? plane->name : NULL;
}

/* --- rows --- */

#define AT(member) #member, offsetof(S, member), sizeof(((S *)0)->member)
#define SIZE_ROW                                                                                                       \
  { CONIC_ROW_LEFT_OUT, AT(size), .meaning = "the length of the struct, by which versions are told apart" }
#define RESERVED(member)                                                                                               \
  { CONIC_ROW_RESERVED, AT(member) }
#define IN(from, to) .least = (from), .most = (to)
#define ISA_ROW                                                                                                        \
  { CONIC_ROW_LEFT_OUT, AT(isa), .meaning = "all instruction sets draw the same bits" }
#define TABLE(table, standard, fault)                                                                                  \
  static const conic_shot_rows table##_rows = {                                                                        \
      #table, sizeof(S), table##_list, sizeof table##_list / sizeof *table##_list, standard, fault};

#define S conic_camera
static const conic_shot_row camera_list[] = {
    {CONIC_ROW_INT, AT(width), "px", "the picture's width", .is_said = 1, IN(1, 65535)},
    {CONIC_ROW_INT, AT(height), "px", "the picture's height", .is_said = 1, IN(1, 65535)},
    {CONIC_ROW_DOUBLE, AT(fx), "px", "the focal length to the right", .is_said = 1, IN(1e-12, 1e12)},
    {CONIC_ROW_DOUBLE, AT(fy), "px", "the focal length downwards", .is_said = 1, IN(1e-12, 1e12)},
    {CONIC_ROW_DOUBLE, AT(cx), "px", "the principal point, from the left edge", .is_said = 1, IN(-1e12, 1e12)},
    {CONIC_ROW_DOUBLE, AT(cy), "px", "the principal point, from the upper edge", .is_said = 1, IN(-1e12, 1e12)},
    {CONIC_ROW_DOUBLE, AT(cam_from_world), NULL, "rows of the rotation and the translation; z goes forward, y down",
     .columns = 4, .is_said = 1, IN(-1e30, 1e30)},
    {CONIC_ROW_WORD, AT(kind), NULL, "how directions become places in the picture", camera_kind_word},
    {CONIC_ROW_WORD, AT(lens), NULL, "how the lens distorts", lens_word},
    {CONIC_ROW_DOUBLE, AT(distortion), NULL, "the lens's numbers", IN(-1e12, 1e12)},
    {CONIC_ROW_WORD, AT(shutter), NULL, "which way a rolling shutter goes", shutter_word},
    {CONIC_ROW_DOUBLE, AT(turn), NULL, "of a rolling shutter, x, y and z of the quaternion to its last pose",
     IN(-1, 1)},
    {CONIC_ROW_DOUBLE, AT(shift), NULL, "of a rolling shutter, what the translation gains", IN(-1e30, 1e30)},
    RESERVED(reserved_word)};
TABLE(camera, NULL, conic_fault_of_camera)
#undef S

#define S conic_camera_way
static const conic_shot_row way_list[] = {
    {CONIC_ROW_WORD, AT(kind), NULL, "how the camera goes on while the shutter is open", way_word},
    RESERVED(reserved_int),
    {CONIC_ROW_DOUBLE, AT(frames_a_turn), "frames", "of an orbit: how long a turn takes", IN(0, 1e9)},
    {CONIC_ROW_DOUBLE, AT(center), "world", "of an orbit: what it turns about", IN(-1e30, 1e30)},
    {CONIC_ROW_DOUBLE, AT(up), NULL, "of an orbit: the axis", IN(-1e30, 1e30)},
    {CONIC_ROW_LIST, AT(cameras), NULL, "one a frame", .of = &camera_rows, .is_apart = 1, .length_is_64 = 1,
     .length = offsetof(S, n_cameras)},
    {CONIC_ROW_LENGTH, AT(n_cameras)},
    {CONIC_ROW_DOUBLE, AT(place), "frames", "which of the cameras is the shot's own, from 0", IN(0, 1e9)},
    RESERVED(reserved)};
TABLE(way, NULL, conic_fault_of_way)
#undef S

#define S conic_stereo_eye
static const conic_shot_row eye_list[] = {
    {CONIC_ROW_DOUBLE, AT(shift), "world", "how far to the right the eye is from the middle of two; the camera has it",
     IN(-1e29, 1e29)},
    {CONIC_ROW_DOUBLE, AT(convergence), "world", "the depth at which both eyes agree; 0: they are parallel",
     IN(0, 1e29)},
    {CONIC_ROW_DOUBLE, AT(center), "world", "whose depth it is, where it is found", IN(-1e30, 1e30)},
    {CONIC_ROW_TRUTH, AT(finds_convergence), NULL, "it is found"},
    RESERVED(reserved_int),
    RESERVED(reserved)};
TABLE(eye, NULL, NULL)
#undef S

#define S conic_kernel
static const conic_shot_row kernel_list[] = {
    {CONIC_ROW_WORD, AT(type), NULL, "how a splat fades from its centre to its edge", kernel_word},
    {CONIC_ROW_FLOAT, AT(cutoff), "sigma", "where a splat ends", IN(0.25, 5)},
    {CONIC_ROW_FLOAT, AT(a), NULL, "confetti's a", IN(1e-6, 1e6)},
    {CONIC_ROW_FLOAT, AT(b), NULL, "confetti's b", IN(1e-6, 1e6)},
    {CONIC_ROW_INT, AT(n), NULL, "confetti's n", IN(1, 16)}};
TABLE(kernel, NULL, NULL)
#undef S

#define S conic_light
static const conic_shot_row light_list[] = {
    {CONIC_ROW_WORD, AT(frame), NULL, "what the light moves with", light_frame_word},
    {CONIC_ROW_FLOAT, AT(color), "linear", "red, green, blue", IN(0, 1e6)},
    {CONIC_ROW_DOUBLE, AT(direction), NULL, "towards the light", IN(-1e30, 1e30)}};
TABLE(light, NULL, conic_fault_of_light)
#undef S

#define S conic_lighting
static const conic_shot_row lighting_list[] = {
    {CONIC_ROW_TRUTH, AT(is_given), NULL, "these lights count, and not the one of the options"},
    {CONIC_ROW_LENGTH, AT(n_lights)},
    {CONIC_ROW_LIST, AT(lights), NULL, "lights without a place", .of = &light_rows, .length = offsetof(S, n_lights)},
    {CONIC_ROW_FLOAT, AT(sky), "linear", "light from above: red, green, blue", IN(0, 1e6)},
    {CONIC_ROW_FLOAT, AT(ground), "linear", "light from below", IN(0, 1e6)},
    {CONIC_ROW_DOUBLE, AT(up), NULL, "which way is above", IN(-1e30, 1e30)},
    RESERVED(reserved)};
TABLE(lighting, NULL, conic_fault_of_lighting)
#undef S

static void set_render(void *value) {
  conic_render_options_init((conic_render_options *)value);
}

#define S conic_render_options
static const conic_shot_row render_list[] = {
    SIZE_ROW,
    {CONIC_ROW_WORD, AT(method), NULL, "how a splat becomes pixels", method_word},
    {CONIC_ROW_STRUCT, AT(kernel), NULL, "how a splat fades", .of = &kernel_rows},
    {CONIC_ROW_FLOAT, AT(prefilter), "px2", "the variance of the blur that keeps small splats from flickering",
     IN(0, 10000)},
    {CONIC_ROW_DOUBLE, AT(epsilon), "world", "splats so near to each other blend; below 0: by their sizes",
     IN(-1e30, 1e29)},
    {CONIC_ROW_INT, AT(passes), NULL, "3: the splats of a surface blend; 1: the nearest wins", IN(1, 3)},
    {CONIC_ROW_TRUTH, AT(cull_back), NULL, "what faces away is left out"},
    {CONIC_ROW_DOUBLE, AT(near_z), "world", "nothing nearer to the camera is drawn; 0: by the scene", IN(0, 1e30)},
    {CONIC_ROW_DOUBLE, AT(splat_length), "world", "the usual length of a splat; 0: by the scene", IN(0, 1e30)},
    {CONIC_ROW_WORD, AT(shading), NULL, "how surfaces answer light", shading_word},
    {CONIC_ROW_TRUTH, AT(has_light), NULL, "one light, which `light` points to"},
    {CONIC_ROW_DOUBLE, AT(light), NULL, "towards that light", IN(-1e30, 1e30)},
    {CONIC_ROW_TRUTH, AT(has_background), NULL, "`background` is behind the picture"},
    {CONIC_ROW_FLOAT, AT(background), "linear", "red, green, blue", IN(-1e18, 1e18)},
    {CONIC_ROW_DOUBLE, AT(exposure), "stops", "each doubles the brightness", IN(-100, 100)},
    {CONIC_ROW_LEFT_OUT, AT(tile), .meaning = "all tiles draw the same bits"},
    ISA_ROW,
    {CONIC_ROW_STRUCT, AT(lighting), NULL, "light without a place", .of = &lighting_rows},
    {CONIC_ROW_LEFT_OUT, AT(splats_version), .meaning = "by which a device knows what it has; it changes no bit"},
    {CONIC_ROW_LEFT_OUT, AT(skip_hidden), .meaning = "the same picture, sooner"}};
TABLE(render, set_render, conic_fault_of_render)
#undef S

static void set_view(void *value) {
  conic_source_view_init((conic_source_view *)value);
}

#define S conic_source_view
static const conic_shot_row view_list[] = {
    SIZE_ROW,
    {CONIC_ROW_DOUBLE, AT(error_px), "px", "how far off the picture may be; 0: all is drawn", IN(0, 1e9)},
    {CONIC_ROW_UINT64, AT(budget), NULL, "or the best of so many splats and triangles", IN(0, 4294967294.0)},
    {CONIC_ROW_INT, AT(only_kind), NULL, "of a hybrid: 0 triangles alone, 1 surfels alone, -1 as it was built",
     IN(-1, 1)},
    {CONIC_ROW_INT, AT(samples), NULL, "N x N a pixel", IN(1, CONIC_MAX_SAMPLES)},
    {CONIC_ROW_INT, AT(most_levels), NULL, "of a hierarchy, so many levels; 0: all", IN(0, 1000)},
    {CONIC_ROW_LEFT_OUT, AT(occlusion), .meaning = "what is hidden may be left unread; it changes no bit"},
    {CONIC_ROW_LEFT_OUT, AT(may_be_coarser), .meaning = "what did not come nobody can say again"},
    {CONIC_ROW_LEFT_OUT, AT(seconds), .meaning = "what came by then nobody can say again"},
    {CONIC_ROW_TRUTH, AT(tolerates_damage), NULL, "what is damaged is drawn coarser", .is_no_key = 1},
    {CONIC_ROW_DOUBLE, AT(color_error), "steps", "of a hybrid: how far off its colours may be", IN(1e-9, 1e9)},
    {CONIC_ROW_WORD, AT(transparency), NULL, "how light comes through", transparency_word},
    {CONIC_ROW_DOUBLE, AT(chance), NULL, "of transparency by chance: which", IN(0, 1)},
    {CONIC_ROW_TRUTH, AT(is_alone), NULL, "what is left out for an error is found for this picture alone"},
    RESERVED(reserved_int)};
TABLE(view, set_view, NULL)
#undef S

static void set_gaussians(void *value) {
  conic_gaussian_options_init((conic_gaussian_options *)value);
}

#define S conic_gaussian_options
static const conic_shot_row gaussians_list[] = {
    SIZE_ROW,
    {CONIC_ROW_WORD, AT(profile), NULL, "whose way of compositing", profile_word},
    {CONIC_ROW_FLOAT, AT(background), "display", "what is behind: red, green, blue", IN(-1e18, 1e18)},
    ISA_ROW,
    {CONIC_ROW_UINT32, AT(ignores_center), NULL, "1: the picture's middle is taken for the principal point", IN(0, 1)},
    {CONIC_ROW_LEFT_OUT, AT(device), .meaning = "all devices draw the same bits"},
    {CONIC_ROW_DOUBLE, AT(prefilter), "px2", "of exact: the variance of the filter on the screen", IN(0, 10000)}};
TABLE(gaussians, set_gaussians, NULL)
#undef S

#define S conic_lamp
static const conic_shot_row lamp_list[] = {
    {CONIC_ROW_WORD, AT(kind), NULL, "what gives the light", lamp_word},
    {CONIC_ROW_FLOAT, AT(color), "linear", "of what faces it at distance 1", IN(0, 1e12)},
    {CONIC_ROW_DOUBLE, AT(position), "world", "its middle", IN(-1e19, 1e19)},
    {CONIC_ROW_DOUBLE, AT(radius), "world", "of a sphere", IN(0, 1e19)},
    {CONIC_ROW_DOUBLE, AT(axes), "world", "of what is flat: from the middle to two edges", .columns = 3,
     IN(-1e19, 1e19)},
    RESERVED(reserved)};
TABLE(lamp, NULL, NULL)
#undef S

#define S conic_shot_light
static const conic_shot_row shot_light_list[] = {
    {CONIC_ROW_UINT64, AT(n_directions), NULL, "from which light of all around may be hidden; 0: it is not",
     IN(0, 1e6)},
    {CONIC_ROW_TRUTH, AT(has_shadows), NULL, "lights with a direction cast shadows"},
    {CONIC_ROW_LENGTH, AT(n_lamps)},
    {CONIC_ROW_LIST, AT(lamps), NULL, "lights with a place", .of = &lamp_rows, .length = offsetof(S, n_lamps)},
    {CONIC_ROW_FLOAT, AT(sun_radius_deg), "degrees", "how large each light without a place is", IN(0, 90)},
    {CONIC_ROW_LEFT_OUT, AT(sky), .meaning = "the input whose role is sky"},
    {CONIC_ROW_DOUBLE, AT(reflectance), NULL, "how much of each colour is the sky, mirrored", IN(0, 1)},
    {CONIC_ROW_DOUBLE, AT(dome_stops), "stops", "how much darker eye-dome lighting makes what lies deep", IN(0, 16)},
    RESERVED(reserved)};
TABLE(shot_light, NULL, conic_fault_of_shot_light)
#undef S

#define S conic_aperture
static const conic_shot_row aperture_list[] = {
    {CONIC_ROW_DOUBLE, AT(diameter), "world", "of the lens; 0: a pinhole", IN(0, 1e29)},
    {CONIC_ROW_DOUBLE, AT(focus), "world", "the depth at which all is sharp", IN(0, 1e29)},
    {CONIC_ROW_INT, AT(n_blades), NULL, "corners of the lens; 0: it is round", IN(0, CONIC_MAX_BLADES)},
    RESERVED(reserved_int),
    RESERVED(reserved)};
TABLE(aperture, NULL, conic_fault_of_aperture)
#undef S

static void set_surface_standard(void *value) {
  conic_surface_options_init((conic_surface_options *)value);
}

#define S conic_surface_options
static const conic_shot_row surface_list[] = {
    SIZE_ROW,
    {CONIC_ROW_WORD, AT(type), NULL, "polynomials or spheres", surface_word},
    {CONIC_ROW_WORD, AT(plane), NULL, "which plane polynomials stand over", surface_plane_word},
    {CONIC_ROW_WORD, AT(weight), NULL, "how weights fall", surface_weight_word},
    {CONIC_ROW_INT, AT(degree), NULL, "of the polynomials", IN(1, CONIC_SURFACE_MAX_DEGREE)},
    {CONIC_ROW_DOUBLE, AT(h), "world", "what is smaller is smoothed away; 0: as the points lie", IN(0, 1e29)},
    {CONIC_ROW_DOUBLE, AT(neglect), "h", "from which distance on points weigh nothing", IN(1, 6)},
    {CONIC_ROW_INT, AT(n_local), NULL, "which neighbour says how the points lie", IN(6, 64)},
    {CONIC_ROW_DOUBLE, AT(cluster), NULL, "how small, for their distance, cells are that count as one", IN(0, 1)},
    ISA_ROW,
    {CONIC_ROW_UINT64, AT(is_sharp), NULL, "1: creases stay sharp", IN(0, 1)},
    RESERVED(reserved)};
TABLE(surface, set_surface_standard, NULL)
#undef S

static void set_patches(void *value) {
  conic_patches_options_init((conic_patches_options *)value);
}

#define S conic_patches_options
static const conic_shot_row patches_list[] = {
    SIZE_ROW,
    {CONIC_ROW_STRUCT, AT(surface), NULL, "the polynomials", .of = &surface_rows},
    {CONIC_ROW_LEFT_OUT, AT(cutoff), .meaning = "a source puts that of its reading in its place"},
    {CONIC_ROW_DOUBLE, AT(step_px), "px", "how far apart samples of a patch are", IN(1e-3, 1e6)},
    {CONIC_ROW_LEFT_OUT, AT(mesh), .meaning = "a source has it of the inputs"}};
TABLE(patches, set_patches, NULL)
#undef S

static void set_coloring(void *value) {
  conic_coloring_options_init((conic_coloring_options *)value);
}

#define S conic_coloring_options
static const conic_shot_row coloring_list[] = {
    SIZE_ROW,
    {CONIC_ROW_TEXT, AT(by), NULL, "what colours are made of"},
    {CONIC_ROW_TEXT, AT(ramp), NULL, "by which ramp; none: the one that suits"},
    {CONIC_ROW_TRUTH, AT(has_range), NULL, "`minimum` and `maximum` are the ramp's ends"},
    {CONIC_ROW_DOUBLE, AT(minimum), NULL, "what the ramp begins with", IN(-1e300, 1e300)},
    {CONIC_ROW_DOUBLE, AT(maximum), NULL, "and ends with", IN(-1e300, 1e300)},
    {CONIC_ROW_DOUBLE, AT(up), NULL, "of heights: which way is up; 0: the scene's", IN(-1e30, 1e30)}};
TABLE(coloring, set_coloring, NULL)
#undef S

static void set_reading(void *value) {
  conic_source_options_init((conic_source_options *)value);
}

#define S conic_source_options
static const conic_shot_row reading_list[] = {
    SIZE_ROW,
    {CONIC_ROW_WORD, AT(as), NULL, "what a file becomes that does not say by itself", as_word},
    {CONIC_ROW_TRUTH, AT(is_whole), NULL, "of a hierarchy every splat is read"},
    {CONIC_ROW_FLOAT, AT(cutoff), "sigma", "where the splats end that are made", IN(0.25, 5)},
    {CONIC_ROW_INT, AT(n_neighbours), NULL, "of which a raw point's size is made", IN(6, 64)},
    {CONIC_ROW_LEFT_OUT, AT(texture_path), .meaning = "the input whose role is texture"},
    {CONIC_ROW_TRUTH, AT(is_smooth), NULL, "meshes are round everywhere"},
    {CONIC_ROW_LEFT_OUT, AT(access), .meaning = "memory and patience change no bit"},
    {CONIC_ROW_POINTER, AT(patches), NULL, "how points become patches", .of = &patches_rows},
    {CONIC_ROW_TRUTH, AT(h_in_spacings), NULL, "the patches' h is in spacings"},
    {CONIC_ROW_TRUTH, AT(projects_degrees), NULL, "longitude and latitude become metres"},
    {CONIC_ROW_TRUTH, AT(finds_dots), NULL, "points without a surface become dots"},
    {CONIC_ROW_POINTER, AT(coloring), NULL, "what colours are made of", .of = &coloring_rows},
    {CONIC_ROW_TEXT, AT(columns), NULL, "what the columns of text are"},
    {CONIC_ROW_DOUBLE, AT(crease_deg), "degrees", "edges up to that are round", IN(0, 180)},
    {CONIC_ROW_HAS, AT(gaussians), NULL, "Gaussian scenes are composited, and are no splats like others"},
    {CONIC_ROW_TEXT, AT(where), NULL, "which points are wanted"},
    {CONIC_ROW_TRUTH, AT(keeps_alpha), NULL, "vertices keep their alpha"},
    {CONIC_ROW_LEFT_OUT, AT(cache), .meaning = "what is kept is what would be built"},
    {CONIC_ROW_WORD, AT(colors_are), NULL, "what colours mean that are fractions of 1", colors_word},
    {CONIC_ROW_TEXT, AT(place), NULL, "where inputs stand: each its number, a colon and its matrix"},
    {CONIC_ROW_UINT64, AT(most_raw), NULL, "no more raw points are taken; 0: all", IN(0, 4294967294.0)}};
TABLE(reading, set_reading, NULL)
#undef S

#define S conic_shot_map
static const conic_shot_row map_list[] = {
    {CONIC_ROW_TRUTH, AT(is_wanted), NULL, "it is a map, whose camera follows from the scene"},
    {CONIC_ROW_INT, AT(epsg), NULL, "its coordinate system; 0: the file's", IN(0, 65535)},
    {CONIC_ROW_DOUBLE, AT(pixel), "world", "a pixel's edge; 0: the spacing of the points", IN(0, 1e12)},
    {CONIC_ROW_DOUBLE, AT(minimum), "world", "what is seen, from; null: no bound", IN(-1e300, 1e300)},
    {CONIC_ROW_DOUBLE, AT(maximum), "world", "what is seen, to", IN(-1e300, 1e300)},
    RESERVED(reserved)};

static void set_map(void *value) {
  conic_shot_map *map = value;
  memset(map, 0, sizeof *map);
  for (int axis = 0; axis < 3; axis++) {
    map->minimum[axis] = -(double)INFINITY;
    map->maximum[axis] = (double)INFINITY;
  }
}

TABLE(map, set_map, conic_fault_of_map)
#undef S

#define S conic_shot_writing
static const conic_shot_row writing_list[] = {
    {CONIC_ROW_WORD, AT(tone), NULL, "how files of 8 and 16 bits show what is brighter than white", tone_word},
    {CONIC_ROW_WORD, AT(compression), NULL, "of an EXR", compression_word},
    {CONIC_ROW_TRUTH, AT(is_half), NULL, "colours and directions of an EXR are half floats"},
    {CONIC_ROW_TRUTH, AT(is_bare), NULL, "files to look at have no dark greys behind the picture"},
    {CONIC_ROW_TRUTH, AT(has_legend), NULL, "the picture says what its colours mean"},
    {CONIC_ROW_TRUTH, AT(has_mattes), NULL, "an EXR has mattes"},
    {CONIC_ROW_TEXT, AT(matte_by), NULL, "the property of Gaussians whose values have a matte each"},
    RESERVED(reserved)};
TABLE(writing, NULL, NULL)
#undef S

static void set_shot(void *value) {
  conic_shot_init((conic_shot *)value);
}

#define S conic_shot
static const conic_shot_row shot_list[] = {
    SIZE_ROW,
    {CONIC_ROW_STRUCT, AT(camera), NULL, "where it is seen from", .of = &camera_rows},
    {CONIC_ROW_STRUCT, AT(way), NULL, "where the camera goes", .of = &way_rows},
    {CONIC_ROW_STRUCT, AT(eye), NULL, "which of two eyes sees it", .of = &eye_rows},
    {CONIC_ROW_PLANES, AT(planes), NULL, "what the picture holds", plane_word},
    RESERVED(reserved_int),
    {CONIC_ROW_STRUCT, AT(render), NULL, "how splats and triangles are drawn", .of = &render_rows},
    {CONIC_ROW_STRUCT, AT(view), NULL, "how much is drawn", .of = &view_rows},
    {CONIC_ROW_STRUCT, AT(gaussians), NULL, "how Gaussian scenes are composited", .of = &gaussians_rows},
    {CONIC_ROW_STRUCT, AT(light), NULL, "light that may be hidden", .of = &shot_light_rows},
    {CONIC_ROW_TRUTH, AT(has_backdrop), NULL, "a gradient is behind the picture"},
    {CONIC_ROW_FLOAT, AT(backdrop_top), "linear", "its colour above: red, green, blue", IN(-1e18, 1e18)},
    {CONIC_ROW_FLOAT, AT(backdrop_bottom), "linear", "and below", IN(-1e18, 1e18)},
    {CONIC_ROW_UINT64, AT(n_samples), NULL, "the picture is the mean of so many; 0: it is drawn at once",
     IN(0, CONIC_MAX_ACCUMULATED)},
    {CONIC_ROW_DOUBLE, AT(noise), NULL, "fewer are enough when it is so near to its end", IN(0, 1e9)},
    {CONIC_ROW_STRUCT, AT(aperture), NULL, "the lens", .of = &aperture_rows},
    {CONIC_ROW_WORD, AT(focus_kind), NULL, "how it is known where all is sharp", focus_word},
    {CONIC_ROW_TRUTH, AT(is_shutter_open), NULL, "samples are of different moments"},
    {CONIC_ROW_DOUBLE, AT(focus_pixel), "px", "what is there is sharp", IN(0, 65535)},
    {CONIC_ROW_DOUBLE, AT(shutter), "frames", "from when to when it is open", IN(-1e5, 1e5)},
    {CONIC_ROW_DOUBLE, AT(frame), "frames", "the moment, for what moves", IN(-1e9, 1e9)},
    {CONIC_ROW_LEFT_OUT, AT(motion), .meaning = "the input whose role is motion"},
    {CONIC_ROW_UINT64, AT(catchers), NULL, "inputs, as bits, that are seen by what they darken alone",
     IN(0, 9007199254740992)},
    {CONIC_ROW_UINT64, AT(holdouts), NULL, "and those that hide what is behind them and are not seen",
     IN(0, 9007199254740992)},
    RESERVED(reserved)};
TABLE(shot, set_shot, conic_fault_of_shot)
#undef S

static void set_file(void *value) {
  conic_shot_file_init((conic_shot_file *)value);
}

#define S conic_shot_file
static const conic_shot_row file_list[] = {
    SIZE_ROW,
    {CONIC_ROW_STRUCT, AT(shot), NULL, "the shot", .of = &shot_rows},
    {CONIC_ROW_STRUCT, AT(reading), NULL, "how files become what is drawn", .of = &reading_rows},
    {CONIC_ROW_STRUCT, AT(map), NULL, "a map, seen from above", .of = &map_rows},
    {CONIC_ROW_STRUCT, AT(writing), NULL, "how the picture becomes files", .of = &writing_rows},
    {CONIC_ROW_LEFT_OUT, AT(inputs), .meaning = "they stand in the file by themselves"},
    {CONIC_ROW_LEFT_OUT, AT(n_inputs), .meaning = "how many these are"}};
#undef S

const conic_shot_rows conic_shot_file_rows = {
    "file", sizeof(conic_shot_file), file_list, sizeof file_list / sizeof *file_list, set_file, NULL};

const conic_shot_rows *const conic_all_shot_rows[] = {&conic_shot_file_rows,
                                                      &shot_rows,
                                                      &camera_rows,
                                                      &way_rows,
                                                      &eye_rows,
                                                      &render_rows,
                                                      &kernel_rows,
                                                      &lighting_rows,
                                                      &light_rows,
                                                      &view_rows,
                                                      &gaussians_rows,
                                                      &shot_light_rows,
                                                      &lamp_rows,
                                                      &aperture_rows,
                                                      &reading_rows,
                                                      &patches_rows,
                                                      &surface_rows,
                                                      &coloring_rows,
                                                      &map_rows,
                                                      &writing_rows,
                                                      NULL};

void conic_shot_file_init_sized(conic_shot_file *file, size_t size) {
  conic_shot_file own;
  memset(&own, 0, sizeof own);
  own.size = sizeof own;
  conic_shot_init(&own.shot);
  conic_source_options_init(&own.reading);
  set_map(&own.map);
  conic_options_give(file, size, &own);
}

size_t conic_row_count(const conic_shot_row *row) {
  static const size_t bytes_each[] = {[CONIC_ROW_INT] = sizeof(int),
                                      [CONIC_ROW_TRUTH] = sizeof(int),
                                      [CONIC_ROW_UINT32] = sizeof(uint32_t),
                                      [CONIC_ROW_UINT64] = sizeof(uint64_t),
                                      [CONIC_ROW_FLOAT] = sizeof(float),
                                      [CONIC_ROW_DOUBLE] = sizeof(double),
                                      [CONIC_ROW_LEFT_OUT] = 0};
  return bytes_each[row->kind] ? row->bytes / bytes_each[row->kind] : 1;
}

size_t conic_row_length(const conic_shot_row *row, const void *value) {
  uint64_t length = 0;
  int n = 0;
  if (row->length_is_64)
    memcpy(&length, (const char *)value + row->length, sizeof length);
  else
    memcpy(&n, (const char *)value + row->length, sizeof n);
  size_t found = row->length_is_64 ? (size_t)length : n > 0 ? (size_t)n : 0, most = row->bytes / row->of->size;
  return !row->is_apart && found > most ? most : found;
}

void conic_rows_standard(const conic_shot_rows *rows, conic_standard *standard) {
  memset(standard, 0, sizeof *standard);
  if (rows->set_standard)
    rows->set_standard(standard->bytes);
}
