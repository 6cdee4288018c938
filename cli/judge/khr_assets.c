/* The table of the Khronos pack. Pictures have 40 x 30 pixels; 4 before the camera one is 2/15 wide. */
#include "cli/judge/khr_assets.h"

/* --- splats --- */

#define COUNT(list) (int)(sizeof(list) / sizeof *(list))
#define SPLATS(list) .n = COUNT(list), .splats = list
#define NODES(list) .n_nodes = COUNT(list), .nodes = list
#define BALL(size) .scale = {size, size, size}, .rotation = {0, 0, 0, 1}

static const khr_splat one[] = {{{0.125, -0.0625, 0}, {0.875, 0.375, 0.1875}, {2, 3, 6, 0}, 0.75, {0.9, 0.6, 0.2}}};
static const khr_splat three[] = {{{-0.5, 0.25, 0.25}, {0.5, 0.25, 0.125}, {2, 3, 6, 0}, 0.75, {0.9, 0.3, 0.2}},
                                  {{0.5, 0.125, -0.25}, {0.25, 0.5, 0.125}, {1, 4, 4, 4}, 0.5, {0.2, 0.8, 0.3}},
                                  {{0, -0.375, 0}, {0.375, 0.125, 0.25}, {5, 4, 2, 2}, 0.875, {0.3, 0.4, 0.95}}};
static const khr_splat three_of_bytes[] = {
    {{-0.5, 0.25, 0.25}, {0.5, 0.25, 0.125}, {27, 18, 26, 120}, 0.75, {0.9, 0.3, 0.2}},
    {{0.5, 0.125, -0.25}, {0.25, 0.5, 0.125}, {-48, 72, -60, 71}, 0.5, {0.2, 0.8, 0.3}},
    {{0, -0.375, 0}, {0.375, 0.125, 0.25}, {90, -27, 82, 24}, 0.875, {0.3, 0.4, 0.95}}};
static const khr_splat about_axes[] = {{{-1, 0.5, 0}, {0.625, 0.25, 0.125}, {3, 0, 0, 4}, 0.8, {0.9, 0.3, 0.2}},
                                       {{1, 0.5, 0}, {0.625, 0.25, 0.125}, {0, 3, 0, 4}, 0.8, {0.2, 0.8, 0.3}},
                                       {{0, -0.5, 0}, {0.625, 0.25, 0.125}, {0, 0, 3, 4}, 0.8, {0.3, 0.4, 0.95}}};
static const khr_splat other_signs[] = {{{-0.75, 0, 0}, {0.625, 0.25, 0.125}, {-2, -3, 6, -7}, 0.8, {0.9, 0.3, 0.2}},
                                        {{0.75, 0, 0}, {0.625, 0.25, 0.125}, {4, -4, 4, -1}, 0.8, {0.2, 0.8, 0.3}}};
static const khr_splat of_sizes[] = {{{0, 0, -4}, {2.5, 1.25, 1}, {0, 0, 3, 4}, 0.6, {0.9, 0.3, 0.2}},
                                     {{0.5, 0.25, 0}, {0.25, 0.25, 1}, {0, 3, 0, 4}, 0.8, {0.2, 0.8, 0.3}}};
static const khr_splat flat[] = {{{-0.5, 0, 0}, {0.5, 0.375, 0}, {1, 4, 4, 4}, 0.8, {0.9, 0.3, 0.2}},
                                 {{0.625, 0, 0}, {0, 0.5, 0.25}, {5, 4, 2, 2}, 0.8, {0.2, 0.8, 0.3}}};
static const khr_splat of_opacities[] = {{{-0.5, 0, 0.5}, BALL(0.25), 1, {0.9, 0.3, 0.2}},
                                         {{-0.25, 0, 0}, BALL(0.5), 1, {0.2, 0.8, 0.3}},
                                         {{0.25, 0.25, 0.25}, BALL(0.5), 0, {1, 1, 1}},
                                         {{0.5, 0, -0.5}, BALL(0.5), 0.5, {0.3, 0.4, 0.95}}};
static const khr_splat faint[] = {{{-0.5, 0, 0.5}, BALL(0.5), 0.0036, {0.9, 0.8, 0.7}},
                                  {{0, 0, 0}, BALL(0.625), 0.0037, {0.9, 0.9, 0.9}},
                                  {{0, 0.25, -0.25}, BALL(0.5), 0.0038, {0.7, 0.8, 1}},
                                  {{0.25, 0, -0.5}, BALL(0.5), 0.0033, {0.9, 0.8, 0.7}},
                                  {{0.5, 0, -0.75}, BALL(0.75), 0.0035, {0.6, 0.7, 0.8}}};
static const khr_splat huge_ball[] = {{{0.0625, 0.03125, 0}, BALL(0.5), 1, {1, 1, 1}}};
static const khr_splat aside[] = {{{2, 0.125, 2}, {0.75, 0.375, 0.5}, {2, 3, 6, 0}, 0.8, {0.9, 0.6, 0.2}},
                                  {{-0.25, 1.25, 2}, {0.25, 0.5, 0.375}, {0, 0, 3, 4}, 0.8, {0.3, 0.4, 0.95}}};
static const khr_splat behind[] = {{{0, 0, 8}, BALL(0.5), 0.9, {1, 1, 1}},
                                   {{0.25, 0, 0}, BALL(0.5), 0.7, {0.9, 0.6, 0.2}}};
static const khr_splat dark[] = {{{-0.25, 0, 0.25}, BALL(0.5), 0.75, {-0.5, 0.25, -0.125}},
                                 {{0.25, 0, -0.25}, BALL(0.625), 0.75, {0.75, 0.5, 0.5}}};
static const khr_splat bright[] = {{{0.125, 0.0625, 0}, BALL(0.625), 0.25, {3, 2, 0.5}}};
static const khr_splat by_distance[] = {{{1.5, 0, 0.25}, BALL(0.75), 0.75, {0.9, 0.3, 0.2}},
                                        {{0, 0, 0}, BALL(0.75), 0.75, {0.2, 0.4, 0.9}}};
static const khr_splat negative_scale[] = {{{0, 0, 0}, {0.5, -0.25, 0.125}, {0, 0, 0, 1}, 0.75, {0.9, 0.6, 0.2}}};
static const khr_splat over_one[] = {{{0, 0, 0}, BALL(0.5), 1.5, {0.9, 0.6, 0.2}}};
static const khr_splat below_zero[] = {{{0, 0, 0}, BALL(0.5), -0.25, {0.9, 0.6, 0.2}}};

/* --- nodes --- */

static const khr_node moved[] = {{.mesh = 1, .translation = {0.25, -0.5, 0.75}}};
static const khr_node turned[] = {{.mesh = 1, .rotation = {2, -3, 6, 0}}};
static const khr_node turned_by_90[] = {{.mesh = 1, .rotation = {0, 1, 0, 1}}};
static const khr_node larger[] = {{.mesh = 1, .scale = {1.5, 1.5, 1.5}}};
static const khr_node stretched[] = {{.mesh = 1, .scale = {1.5, 0.75, 1}}};
static const khr_node turned_stretched[] = {
    {.mesh = 1, .translation = {0.25, 0, 0}, .rotation = {1, 4, -4, 4}, .scale = {0.75, 1.5, 1}}};
static const khr_node by_matrix[] = {{.mesh = 1,
                                      .translation = {-0.25, 0.25, 0.5},
                                      .rotation = {4, 2, 5, 2},
                                      .scale = {1.25, 1.25, 1.25},
                                      .is_matrix = 1}};
static const khr_node deep[] = {{.rotation = {0, 0, 3, 4}, .translation = {0.25, 0, 0}},
                                {.parent = 1, .scale = {1.25, 1.25, 1.25}, .translation = {0, 0.25, 0.5}},
                                {.parent = 2, .mesh = 1, .rotation = {3, 0, 0, 4}, .scale = {0.75, 1, 1.25}}};
static const khr_node twice[] = {{.mesh = 1, .translation = {-0.5, 0.25, 0.5}},
                                 {.mesh = 1, .translation = {0.5, -0.25, -0.5}, .rotation = {0, 0, 1, 0}}};
static const khr_node in_two_scenes[] = {{.mesh = 1, .translation = {0, 0.5, 0}},
                                         {.mesh = 1, .translation = {0, -0.5, 0}, .is_elsewhere = 1}};
static const khr_node two_meshes[] = {{.mesh = 1, .translation = {0.125, 0, 0}},
                                      {.mesh = 2, .rotation = {0, 0, 3, 4}, .translation = {0, 0, 0.125}}};

/* --- edits --- */

#define KERNEL "\"kernel\":\"ellipse\""
#define USED "\"extensionsUsed\":[\"KHR_gaussian_splatting\""
#define NAMED "\"KHR_gaussian_splatting:"
/* A value of an extension of the extension's, which is not required. */
#define EXTENDED(from, to, name) .edits = {{from, to ",\"extensions\":{\"" name "\":{}}"}, {USED, USED ",\"" name "\""}}
#define STORED(what, ...) .storage[KHR_##what] = {CONIC_GLTF_##__VA_ARGS__}
#define REFUSED(from, to) .edits = {{from, to}}, SPLATS(three)

const khr_asset cli_khr_assets[] = {
    {"one", "one splat, turned, of three sizes", "Splat Reconstruction", 1, SPLATS(one)},
    {"rotation-axes", "splats turned about x, y and z: the order x, y, z, w, and the direction", "Attributes", 1,
     SPLATS(about_axes)},
    {"rotation-sign", "quaternions whose w is negative", "Attributes", 1, SPLATS(other_signs)},
    {"scale-linear", "scales from 0.25 to 2.5, which are no logarithms", "Attributes", 1, SPLATS(of_sizes)},
    {"scale-zero", "flat splats: a scale of 0 is not negative", "Attributes", 1, SPLATS(flat)},
    {"opacity-linear", "opacities 0, 0.5 and 1, which are no logits", "Attributes", 1, SPLATS(of_opacities)},
    {"opacity-faint", "opacities below 1/255, which add", "Splat Composition", 1, SPLATS(faint)},
    {"cutoff", "an opaque splat, without another greatest alpha: it ends where the Mahalanobis distance is 3",
     "Ellipse Kernel Rendering", 1, SPLATS(huge_ball)},
    {"perspective-aside", "splats beside the picture: the Jacobian is that at the mean", "Splat Projection", 1,
     SPLATS(aside)},
    {"behind", "a splat behind the camera, and one before it", "Splat Projection", 1, SPLATS(behind)},
    {"degree-1", "harmonics of degree 1: their order and the Condon-Shortley phase", "Spherical Harmonics Attributes",
     1, SPLATS(three), .degree = 1},
    {"degree-2", "harmonics of degree 2", "Calculating color from Spherical Harmonics", 1, SPLATS(three), .degree = 2},
    {"degree-3", "harmonics of degree 3", "Calculating color from Spherical Harmonics", 1, SPLATS(three), .degree = 3},
    {"direction", "the direction is from the camera to each mean", "Splat Lighting", 1, SPLATS(aside), .degree = 3},
    {"color-negative", "colours below 0 count as 0", "Splat Composition", 1, SPLATS(dark)},
    {"color-bright", "a colour above 1 that alpha brings below 1: it is not limited before", "Splat Composition", 1,
     SPLATS(bright)},
    {"color-linear", "linear colours: they are blended as they are", "Available Color Spaces", 1, SPLATS(three),
     .flags = KHR_LINEAR},

    {"rotation-byte", "signed bytes, normalised", "Attributes", 2, SPLATS(three_of_bytes), STORED(ROTATION, INT8, 1)},
    {"rotation-short", "signed shorts, normalised", "Attributes", 2, SPLATS(three), STORED(ROTATION, INT16, 1)},
    {"scale-byte", "unsigned bytes that are whole numbers, under a node that makes them smaller", "Attributes", 2,
     SPLATS(three), .unit = 8, STORED(SCALE, UINT8)},
    {"scale-byte-normalized", "unsigned bytes, normalised", "Attributes", 2, SPLATS(three), STORED(SCALE, UINT8, 1)},
    {"scale-short", "unsigned shorts that are whole numbers", "Attributes", 2, SPLATS(three), .unit = 1024,
     STORED(SCALE, UINT16)},
    {"scale-short-normalized", "unsigned shorts, normalised", "Attributes", 2, SPLATS(three), STORED(SCALE, UINT16, 1)},
    {"opacity-byte", "unsigned bytes, normalised", "Attributes", 2, SPLATS(three), STORED(OPACITY, UINT8, 1)},
    {"opacity-short", "unsigned shorts, normalised", "Attributes", 2, SPLATS(three), STORED(OPACITY, UINT16, 1)},
    {"position-short", "signed shorts, normalised, by KHR_mesh_quantization", "Attributes", 2, SPLATS(three),
     .unit = 0.5, STORED(POSITION, INT16, 1),
     .edits = {{USED, "\"extensionsRequired\":[\"KHR_mesh_quantization\"]," USED ",\"KHR_mesh_quantization\""}}},
    {"all-quantized", "every attribute that may be whole numbers is", "Attributes", 2, SPLATS(three_of_bytes),
     .flags = KHR_GLB, .unit = 0.5,
     .storage = {{CONIC_GLTF_INT16, 1}, {CONIC_GLTF_INT8, 1}, {CONIC_GLTF_UINT8, 1}, {CONIC_GLTF_UINT8, 1}},
     .edits = {{USED, "\"extensionsRequired\":[\"KHR_mesh_quantization\"]," USED ",\"KHR_mesh_quantization\""}}},
    {"sparse-scale", "a sparse accessor over others, with indices of bytes", "Attributes", 2, SPLATS(three),
     STORED(SCALE, FLOAT, 0, CONIC_GLTF_UINT8)},
    {"sparse-rotation", "a sparse accessor of signed shorts, with indices of 32 bits", "Attributes", 2, SPLATS(three),
     STORED(ROTATION, INT16, 1, CONIC_GLTF_UINT32)},
    {"sparse-opacity", "a sparse accessor over zeros, without a view, with indices of shorts", "Attributes", 2,
     SPLATS(of_opacities), STORED(OPACITY, FLOAT, 0, CONIC_GLTF_UINT16, 1)},
    {"sparse-position", "a sparse accessor over zeros, with indices of bytes", "Attributes", 2, SPLATS(of_sizes),
     STORED(POSITION, FLOAT, 0, CONIC_GLTF_UINT8, 1)},
    {"interleaved", "all attributes in one view, with a stride", "Attributes", 2, SPLATS(three), .degree = 1,
     .flags = KHR_INTERLEAVED},
    {"shared", "one accessor for the three coefficients of degree 1", "Extending the Base Extension", 2, SPLATS(three),
     .degree = 1, .flags = KHR_SHARED},
    {"glb", "a binary file", "Attributes", 2, SPLATS(three), .degree = 2, .flags = KHR_GLB},
    {"glb-interleaved", "a binary file, with a stride", "Attributes", 2, .n = 24, .degree = 3,
     .flags = KHR_GLB | KHR_INTERLEAVED},
    {"written-gltf", "as conic convert writes it, with data in base64", "Attributes", 2, .n = 24, .degree = 3,
     .flags = KHR_BY_CONIC},
    {"written-glb", "as conic convert writes it", "Attributes", 2, .n = 24, .degree = 3,
     .flags = KHR_BY_CONIC | KHR_GLB},

    {"node-moved", "a node's translation", "Attributes", 3, SPLATS(three), NODES(moved)},
    {"node-turned", "a node's rotation, with degree 0", "Splat Reconstruction", 3, SPLATS(three), NODES(turned)},
    {"node-larger", "a node's scale", "Splat Reconstruction", 3, SPLATS(three), NODES(larger)},
    {"node-stretched", "a node whose scales differ", "Dependencies on glTF", 3, SPLATS(three), NODES(stretched)},
    {"node-turned-stretched", "a rotation after scales that differ; harmonics are turned, not stretched",
     "Dependencies on glTF", 3, SPLATS(three), NODES(turned_stretched), .degree = 3},
    {"node-matrix", "a node's matrix, column by column", "Dependencies on glTF", 3, SPLATS(three), NODES(by_matrix),
     .degree = 1},
    {"node-deep", "nodes in nodes", "Dependencies on glTF", 3, SPLATS(three), NODES(deep), .degree = 2},
    {"harmonics-turned-90", "harmonics are turned with the node: by 90 degrees about y", "Splat Lighting", 3,
     SPLATS(three), NODES(turned_by_90), .degree = 3},
    {"harmonics-turned", "harmonics are turned with the node: about a general axis", "Splat Lighting", 3, SPLATS(three),
     NODES(turned), .degree = 3},
    {"node-twice", "a mesh in two nodes", "Dependencies on glTF", 3, SPLATS(three), NODES(twice), .degree = 1},
    {"node-elsewhere", "a node of another scene, which is not seen", "glTF 2.0", 3, SPLATS(three),
     NODES(in_two_scenes)},
    {"camera-turned", "a camera from aside", "Splat Projection", 3, SPLATS(three), .degree = 3,
     .eye = {3.5, 0.25, 1.25}, .turn = {0, 0.6, 0, 0.8}},

    {"hints", "the projection and the sorting method are named", "Sorting Method", 4, .n = 24,
     .edits = {{KERNEL, KERNEL ",\"projection\":\"perspective\",\"sortingMethod\":\"cameraDistance\""}}},
    {"sort-distance", "the order is that of distances, which is not that of depths", "Sorting Method", 4,
     SPLATS(by_distance)},
    {"two-primitives", "two primitives of a mesh, whose splats are sorted together", "Splat Composition", 4, .n = 24,
     .degree = 1, .flags = KHR_PRIMITIVES},
    {"two-meshes", "two meshes in two nodes, whose splats are sorted together", "Splat Composition", 4, .n = 24,
     .degree = 1, NODES(two_meshes), .flags = KHR_MESHES},
    {"background", "before a coloured background", "Splat Composition", 4, SPLATS(three),
     .background = {0.25f, 0.5f, 0.75f}},
    {"fallback", "COLOR_0 and a material, which only other renderers use", "Fallback Behavior", 4, SPLATS(three),
     .degree = 1, .flags = KHR_FALLBACK},
    {"with-triangles", "a primitive of triangles in the same mesh, behind the camera", "Extending Mesh Primitives", 4,
     SPLATS(three), .flags = KHR_TRIANGLE},
    {"required", "the extension is required", "Extending Mesh Primitives", 4, SPLATS(three),
     .edits = {{USED, "\"extensionsRequired\":[\"KHR_gaussian_splatting\"]," USED}}},
    {"extras", "what a renderer passes over", "glTF 2.0", 4, SPLATS(three),
     .edits = {{KERNEL, KERNEL ",\"extras\":{\"kernel\":\"other\"}"}, {NAMED "SCALE", "\"_SIZE\":0," NAMED "SCALE"}}},
    {"kernel-other", "a kernel of an extension that is not required: it is drawn as an ellipse", "Kernel", 4,
     SPLATS(three), EXTENDED(KERNEL, "\"kernel\":\"customShape\"", "EXT_gaussian_splatting_kernel_customShape")},
    {"projection-other", "a projection of an extension that is not required", "Projection", 4, SPLATS(three),
     EXTENDED(KERNEL, KERNEL ",\"projection\":\"tangential\"", "EXT_gaussian_splatting_projection_tangential")},
    {"sorting-other", "a sorting method of an extension that is not required", "Sorting Method", 4, SPLATS(by_distance),
     EXTENDED(KERNEL, KERNEL ",\"sortingMethod\":\"zDepth\"", "EXT_gaussian_splatting_sorting_zDepth")},
    {"crowd", "sixty of degree 3", "Splat Composition", 4, .n = 60, .degree = 3, .flags = KHR_GLB},

    {"position-missing", "no POSITION", "Attributes", 0, REFUSED("\"POSITION\"", "\"_PLACE\"")},
    {"rotation-missing", "no rotation", "Attributes", 0, REFUSED(NAMED "ROTATION\"", "\"_TURN\"")},
    {"scale-missing", "no scale", "Attributes", 0, REFUSED(NAMED "SCALE\"", "\"_SIZE\"")},
    {"opacity-missing", "no opacity", "Attributes", 0, REFUSED(NAMED "OPACITY\"", "\"_ALPHA\"")},
    {"harmonics-missing", "no harmonics", "Attributes", 0, REFUSED(NAMED "SH_DEGREE_0_COEF_0\"", "\"_COLOR\"")},
    {"degree-partial", "a coefficient of degree 1 is not there", "Spherical Harmonics Attributes", 0, .degree = 1,
     REFUSED(NAMED "SH_DEGREE_1_COEF_1\"", "\"_COLOR\"")},
    {"degree-gap", "degree 2 without degree 1", "Spherical Harmonics Attributes", 0, .degree = 2,
     REFUSED(NAMED "SH_DEGREE_1", "\"_COLOR")},
    {"mode-triangles", "no points", "Dependencies on glTF", 0, REFUSED("\"mode\":0", "\"mode\":4")},
    {"kernel-missing", "no kernel", "Extending Mesh Primitives", 0, REFUSED(KERNEL ",", "")},
    {"color-space-missing", "no colour space", "Extending Mesh Primitives", 0,
     REFUSED(",\"colorSpace\":\"srgb_rec709_display\"", "")},
    {"kernel-required", "a kernel of an extension that is required", "Extending the Base Extension", 0, SPLATS(three),
     .edits = {{KERNEL, "\"kernel\":\"customShape\",\"extensions\":{\"EXT_gaussian_splatting_kernel_customShape\":{}}"},
               {USED, "\"extensionsRequired\":[\"EXT_gaussian_splatting_kernel_customShape\"]," USED
                      ",\"EXT_gaussian_splatting_kernel_customShape\""}}},
    {"scale-negative", "a scale below 0", "Attributes", 0, SPLATS(negative_scale)},
    {"opacity-over-one", "an opacity above 1", "Attributes", 0, SPLATS(over_one)},
    {"opacity-below-zero", "an opacity below 0", "Attributes", 0, SPLATS(below_zero)},
    {"rotation-unsigned", "a rotation of unsigned bytes", "Attributes", 0, SPLATS(three_of_bytes),
     STORED(ROTATION, UINT8, 1)},
    {"rotation-whole", "a rotation of signed bytes that are not normalised", "Attributes", 0, SPLATS(three_of_bytes),
     STORED(ROTATION, INT8)},
    {"scale-signed", "a scale of signed bytes", "Attributes", 0, SPLATS(three), STORED(SCALE, INT8, 1)},
    {"harmonics-bytes", "harmonics of bytes", "Attributes", 0, SPLATS(three), STORED(HARMONICS, UINT8, 1)},
    {"rotation-of-three", "a rotation of three numbers", "Attributes", 0, REFUSED("VEC4", "VEC3")},
    {"counts", "attributes of different numbers of splats", "glTF 2.0", 0,
     REFUSED("\"count\":3,\"type\":\"SCALAR\"", "\"count\":2,\"type\":\"SCALAR\"")},
    {"past-the-end", "an accessor that ends behind its view", "glTF 2.0", 0,
     REFUSED("\"count\":3,\"type\":\"SCALAR\"", "\"count\":4,\"type\":\"SCALAR\"")},
    {"buffer-missing", "a file of data that is not there", "glTF 2.0", 0, REFUSED(".bin\"", ".not\"")},
    {"version-3", "glTF 3", "glTF 2.0", 0, REFUSED("\"version\":\"2.0\"", "\"version\":\"3.0\"")},
    {"cut", "half of the JSON", "glTF 2.0", 0, SPLATS(three), .flags = KHR_CUT},
    {"cut-binary", "a binary file that ends too early", "glTF 2.0", 0, SPLATS(three), .flags = KHR_CUT | KHR_GLB},
};

const int cli_n_khr_assets = sizeof cli_khr_assets / sizeof *cli_khr_assets;

const char *cli_khr_level_about(int level) {
  static const char *const about[KHR_LEVELS] = {"a few splats, in floats", "accessors: types, sparse ones, strides",
                                                "nodes, and harmonics that they turn; cameras",
                                                "several primitives, hints, and what is passed over"};
  return about[level - 1];
}
