/* A glTF 2 file: what its JSON says, the numbers in its buffers, and where its nodes place things. Nothing in a file is
 * trusted: numbers of the JSON are doubles and are looked at when they are used, and whatever leads into a buffer is
 * checked against its length. */
#pragma once

#include "core/base/base.h"
#include "core/files/json_read.h"
#include "core/files/mapping.h"

enum { CONIC_GLTF_NONE = -1 };

/* Component types of accessors. */
enum { CONIC_GLTF_INT8 = 5120, CONIC_GLTF_UINT8, CONIC_GLTF_INT16, CONIC_GLTF_UINT16, CONIC_GLTF_UINT32 = 5125 };
enum { CONIC_GLTF_FLOAT = 5126 };

/* The lists of a file. Lists within items (primitives of meshes …) stand one after the other; a slice says which of
 * them are an item's. */
typedef enum conic_gltf_list_id {
  CONIC_GLTF_BUFFERS,
  CONIC_GLTF_VIEWS,
  CONIC_GLTF_ACCESSORS,
  CONIC_GLTF_IMAGES,
  CONIC_GLTF_SAMPLERS,
  CONIC_GLTF_TEXTURES,
  CONIC_GLTF_MATERIALS,
  CONIC_GLTF_MESHES,
  CONIC_GLTF_PRIMITIVES,
  CONIC_GLTF_TARGETS,
  CONIC_GLTF_ATTRIBUTES,
  CONIC_GLTF_NODES,
  CONIC_GLTF_SKINS,
  CONIC_GLTF_SCENES,
  CONIC_GLTF_CAMERAS,
  CONIC_GLTF_NUMBERS,
  CONIC_GLTF_USED,     /* names of extensions */
  CONIC_GLTF_REQUIRED, /* and of those without which the file means something else */
  CONIC_GLTF_N_LISTS
} conic_gltf_list_id;

typedef struct conic_gltf_list {
  void *items;
  size_t n, room;
} conic_gltf_list;

typedef struct conic_gltf_slice {
  size_t first, n;
} conic_gltf_slice;

typedef struct conic_gltf_text {
  const char *bytes; /* as in the JSON, with escapes; null: none */
  size_t length;
} conic_gltf_text;

typedef struct conic_gltf_buffer {
  conic_gltf_text uri;
  double length;
  const unsigned char *bytes; /* once it is open */
  size_t n_bytes;
  unsigned char *own;    /* decoded */
  conic_mapping mapping; /* or a file */
} conic_gltf_buffer;

/* Of EXT_meshopt_compression. */
typedef struct conic_gltf_packed {
  double buffer, offset, length, stride, count;
  char mode[16], filter[16];
} conic_gltf_packed;

typedef struct conic_gltf_view {
  double buffer, offset, length, stride;
  int is_packed;
  conic_gltf_packed packed;
  unsigned char *own; /* unpacked */
} conic_gltf_view;

typedef struct conic_gltf_accessor {
  double view, offset, component, count;
  double n_sparse, sparse_view, sparse_offset, sparse_component, value_view, value_offset;
  int is_normalized;
  char type[8];
} conic_gltf_accessor;

typedef struct conic_gltf_image {
  conic_gltf_text uri;
  double view;
} conic_gltf_image;

typedef struct conic_gltf_sampler {
  double wrap[2];
} conic_gltf_sampler;

typedef struct conic_gltf_texture {
  double sampler, image, webp, basisu;
} conic_gltf_texture;

/* A material's use of a texture: coordinates are offset + turn(rotation) · (scale × those of the set). */
typedef struct conic_gltf_texture_use {
  double texture, set, other_set, offset[2], rotation, scale[2];
} conic_gltf_texture_use;

typedef struct conic_gltf_material {
  double color[4], diffuse[4], emission[3], cutoff;
  conic_gltf_texture_use base, of_diffuse, of_emission;
  int is_glossy; /* KHR_materials_pbrSpecularGlossiness */
  char alpha_mode[8];
} conic_gltf_material;

extern const conic_gltf_material conic_gltf_no_material; /* what is drawn without one */

typedef struct conic_gltf_attribute {
  char name[CONIC_JSON_KEY_ROOM];
  double accessor;
} conic_gltf_attribute;

typedef struct conic_gltf_primitive {
  double indices, material, mode, draco_view, spz_view;
  conic_gltf_slice attributes, targets, draco_attributes;
  int is_gaussian;
  char color_space[32], kernel[24], projection[24], sorting[24];
} conic_gltf_primitive;

typedef struct conic_gltf_target {
  conic_gltf_slice attributes;
} conic_gltf_target;

typedef struct conic_gltf_mesh {
  conic_gltf_slice primitives, weights;
} conic_gltf_mesh;

typedef struct conic_gltf_node {
  double mesh, camera, skin;
  double matrix[16], translation[3], rotation[4], scale[3]; /* the rotation is x, y, z, w; without
                                                               a matrix its last number is 0 */
  int has_instances, is_visible, is_placed;
  size_t parent; /* SIZE_MAX: none */
  conic_gltf_slice children, weights, instances;
  uint64_t line; /* of the JSON */
  char name[64];
  double world[3][4];
} conic_gltf_node;

typedef struct conic_gltf_skin {
  double inverses;
  conic_gltf_slice joints;
} conic_gltf_skin;

typedef struct conic_gltf_scene {
  conic_gltf_slice nodes;
} conic_gltf_scene;

typedef struct conic_gltf_camera {
  int is_orthographic;
  double angle_y_rad, aspect, half_width, half_height; /* 0: not given */
} conic_gltf_camera;

typedef struct conic_gltf {
  conic_context *context;
  const char *name; /* of the file, for messages */
  const char *path; /* files lie beside it; null: nowhere */
  conic_json json;
  const unsigned char *binary; /* of a .glb; null: none */
  size_t n_binary;
  double scene;
  char version[8], least_version[8];
  int is_tileset;
  conic_gltf_list lists[CONIC_GLTF_N_LISTS];
} conic_gltf;

/* Reads the JSON of a .gltf or .glb, whose bytes must outlive *gltf. The caller closes it, on failure too. Errors:
 * INPUT, MEMORY. */
conic_status conic_gltf_open(conic_context *context, const char *name, const char *path, const unsigned char *bytes,
                             size_t n_bytes, conic_gltf *gltf);
void conic_gltf_close(conic_gltf *gltf);

/* Fills in the lists from the JSON. Errors: INPUT, MEMORY. */
conic_status conic_gltf_read_json(conic_gltf *gltf);

/* Checks that no extension is required that is not known, or that this build cannot read; of those that are only used
 * it warns. Errors: INPUT, with the extension's name. */
conic_status conic_gltf_check_extensions(const conic_gltf *gltf);

/* "FILE: what is wrong". */
conic_status conic_gltf_wrong(const conic_gltf *gltf, const char *format, ...) CONIC_AS_PRINTF(2, 3);
#ifdef __clang_analyzer__ /* which then knows that it fails */
#define conic_gltf_wrong(...) ((void)(conic_gltf_wrong)(__VA_ARGS__), CONIC_ERROR_INPUT)
#endif
void conic_gltf_warn(const conic_gltf *gltf, const char *format, ...) CONIC_AS_PRINTF(2, 3);

/* Whether a number of the JSON is a whole one below `end`, of which there are fewer than 2⁵³. */
static inline int conic_gltf_is_index(double number, size_t end) {
  return number >= 0.0 && number < (double)end && number == (double)(size_t)number;
}

/* Item `number` of a list; null where there is none. */
void *conic_gltf_at(const conic_gltf *gltf, conic_gltf_list_id list, double number);
/* Item i of a slice. */
void *conic_gltf_item(const conic_gltf *gltf, conic_gltf_list_id list, conic_gltf_slice slice, size_t i);

/* The accessor of the attribute of that name; CONIC_GLTF_NONE: none. */
double conic_gltf_find(const conic_gltf *gltf, conic_gltf_slice attributes, const char *name);

/* The bytes of a buffer's view, unpacked. `stride` is 0 where the view has none. Errors: INPUT, UNSUPPORTED, MEMORY. */
typedef struct conic_gltf_bytes {
  const unsigned char *bytes;
  size_t n_bytes, stride;
} conic_gltf_bytes;
conic_status conic_gltf_open_view(conic_gltf *gltf, double number, conic_gltf_bytes *view);
/* Of a part of a buffer. */
conic_status conic_gltf_open_part(conic_gltf *gltf, double number, double offset, double length,
                                  conic_gltf_bytes *part);
/* Unpacks a view of EXT_meshopt_compression into its `own`. */
conic_status conic_gltf_unpack(conic_gltf *gltf, conic_gltf_view *view, size_t n_bytes);
int conic_gltf_can_unpack(void);

/* The path of a file that the file names by a URI: as written, else decoded, else, with finds_beside, the last part of
 * it; empty where there is none. Errors: INPUT (it would lie outside of the file's folder, which the context does not
 * allow). */
conic_status conic_gltf_find_file(const conic_gltf *gltf, conic_gltf_text uri, int finds_beside, char *path,
                                  size_t room);
/* The bytes of a "data:" URI, in a block that the caller releases; null where it is none. Errors: INPUT, MEMORY. */
conic_status conic_gltf_decode_uri(const conic_gltf *gltf, conic_gltf_text uri, unsigned char **bytes, size_t *n_bytes);

/* The numbers of an accessor: `count` items of n components. */
typedef struct conic_gltf_array {
  const unsigned char *bytes;
  size_t stride, count;
  int component, n, is_normalized;
  unsigned char *own; /* null: they lie in a buffer */
} conic_gltf_array;

/* Opens an accessor, with sparse values put in. The caller closes it, on failure too. Errors: INPUT, UNSUPPORTED,
 * MEMORY. */
conic_status conic_gltf_open_array(conic_gltf *gltf, double number, conic_gltf_array *array);
void conic_gltf_close_array(const conic_gltf *gltf, conic_gltf_array *array);

/* Component k of item i; normalized integers are -1 or 0 to 1. */
double conic_gltf_value(const conic_gltf_array *array, size_t i, int k);

/* --- nodes --- */

/* Where a node's own numbers place what is in it: rows. Returns 0 where its rotation is none. */
int conic_gltf_place_of(const conic_gltf_node *node, double rows[3][4]);
void conic_gltf_join_places(const double outer[3][4], const double inner[3][4], double joined[3][4]);

/* Finds all nodes' parents. Errors: INPUT. */
conic_status conic_gltf_link_nodes(conic_gltf *gltf);

/* Called for every mesh that is drawn, at its place in the world. */
typedef conic_status conic_gltf_visit(void *cookie, const conic_gltf_node *node, const double world[3][4]);

/* Visits the nodes of the file's scene that have a mesh, parents before children, once an instance; a file without
 * nodes has its meshes where they are. Errors: INPUT, UNSUPPORTED, MEMORY, the visitor's. */
conic_status conic_gltf_visit_meshes(conic_gltf *gltf, conic_gltf_visit *visit, void *cookie);
