/* The JSON of a glTF, read by tables of what matters in it; the rest is passed over. */
#include "core/gltf/gltf.h"

typedef enum field_kind {
  NUMBER,  /* a double */
  NUMBERS, /* n doubles */
  TRUTH,   /* an int */
  TEXT,    /* char[n] */
  RAW,     /* a conic_gltf_text */
  MARK,    /* an int says that there is such an object */
  ITEMS,   /* objects, appended to list n; a slice says which, but of those of the root */
  LIST,    /* numbers, appended to theirs */
  MAP,     /* names with numbers, appended to the attributes */
  WORDS    /* texts, appended to list n */
} field_kind;

/* A value by its path from the item, "a/b/c". A mark comes before what is within its object. */
typedef struct field {
  const char *path;
  field_kind kind;
  size_t at, n;
} field;

enum { WORD_ROOM = 64, LONGEST_JSON_PATH = 256 };
#define NO_SLICE SIZE_MAX
#define NONE CONIC_GLTF_NONE
#define AT(type, member) offsetof(conic_gltf_##type, member)
#define TEXT_AT(type, member) TEXT, AT(type, member), sizeof(((conic_gltf_##type *)0)->member)
#define ROOT(member) offsetof(conic_gltf, member)

static const field buffer_fields[] = {
    {"uri", RAW, AT(buffer, uri)}, {"byteLength", NUMBER, AT(buffer, length)}, {NULL}};

#define MESHOPT "extensions/EXT_meshopt_compression"
static const field view_fields[] = {{"buffer", NUMBER, AT(view, buffer)},
                                    {"byteOffset", NUMBER, AT(view, offset)},
                                    {"byteLength", NUMBER, AT(view, length)},
                                    {"byteStride", NUMBER, AT(view, stride)},
                                    {MESHOPT, MARK, AT(view, is_packed)},
                                    {MESHOPT "/buffer", NUMBER, AT(view, packed.buffer)},
                                    {MESHOPT "/byteOffset", NUMBER, AT(view, packed.offset)},
                                    {MESHOPT "/byteLength", NUMBER, AT(view, packed.length)},
                                    {MESHOPT "/byteStride", NUMBER, AT(view, packed.stride)},
                                    {MESHOPT "/count", NUMBER, AT(view, packed.count)},
                                    {MESHOPT "/mode", TEXT_AT(view, packed.mode)},
                                    {MESHOPT "/filter", TEXT_AT(view, packed.filter)},
                                    {NULL}};

static const field accessor_fields[] = {{"bufferView", NUMBER, AT(accessor, view)},
                                        {"byteOffset", NUMBER, AT(accessor, offset)},
                                        {"componentType", NUMBER, AT(accessor, component)},
                                        {"count", NUMBER, AT(accessor, count)},
                                        {"type", TEXT_AT(accessor, type)},
                                        {"normalized", TRUTH, AT(accessor, is_normalized)},
                                        {"sparse/count", NUMBER, AT(accessor, n_sparse)},
                                        {"sparse/indices/bufferView", NUMBER, AT(accessor, sparse_view)},
                                        {"sparse/indices/byteOffset", NUMBER, AT(accessor, sparse_offset)},
                                        {"sparse/indices/componentType", NUMBER, AT(accessor, sparse_component)},
                                        {"sparse/values/bufferView", NUMBER, AT(accessor, value_view)},
                                        {"sparse/values/byteOffset", NUMBER, AT(accessor, value_offset)},
                                        {NULL}};

static const field image_fields[] = {{"uri", RAW, AT(image, uri)}, {"bufferView", NUMBER, AT(image, view)}, {NULL}};
static const field sampler_fields[] = {
    {"wrapS", NUMBER, AT(sampler, wrap[0])}, {"wrapT", NUMBER, AT(sampler, wrap[1])}, {NULL}};
static const field texture_fields[] = {{"sampler", NUMBER, AT(texture, sampler)},
                                       {"source", NUMBER, AT(texture, image)},
                                       {"extensions/EXT_texture_webp/source", NUMBER, AT(texture, webp)},
                                       {"extensions/KHR_texture_basisu/source", NUMBER, AT(texture, basisu)},
                                       {NULL}};

/* NOLINTBEGIN(bugprone-macro-parentheses): literals and members, which stand bare */
#define TEXTURE(path, use)                                                                                             \
  {path "/index", NUMBER, AT(material, use.texture)}, {path "/texCoord", NUMBER, AT(material, use.set)},               \
      {path "/extensions/KHR_texture_transform/offset", NUMBERS, AT(material, use.offset), 2},                         \
      {path "/extensions/KHR_texture_transform/rotation", NUMBER, AT(material, use.rotation)},                         \
      {path "/extensions/KHR_texture_transform/scale", NUMBERS, AT(material, use.scale), 2}, {                         \
    path "/extensions/KHR_texture_transform/texCoord", NUMBER, AT(material, use.other_set)                             \
  }
/* NOLINTEND(bugprone-macro-parentheses) */
#define GLOSSY "extensions/KHR_materials_pbrSpecularGlossiness"
static const field material_fields[] = {{"pbrMetallicRoughness/baseColorFactor", NUMBERS, AT(material, color), 4},
                                        TEXTURE("pbrMetallicRoughness/baseColorTexture", base),
                                        {"emissiveFactor", NUMBERS, AT(material, emission), 3},
                                        TEXTURE("emissiveTexture", of_emission),
                                        {"alphaMode", TEXT_AT(material, alpha_mode)},
                                        {"alphaCutoff", NUMBER, AT(material, cutoff)},
                                        {GLOSSY, MARK, AT(material, is_glossy)},
                                        {GLOSSY "/diffuseFactor", NUMBERS, AT(material, diffuse), 4},
                                        TEXTURE(GLOSSY "/diffuseTexture", of_diffuse),
                                        {NULL}};

#define DRACO "extensions/KHR_draco_mesh_compression"
#define SPLATS "extensions/KHR_gaussian_splatting"
static const field primitive_fields[] = {
    {"attributes", MAP, AT(primitive, attributes)},
    {"indices", NUMBER, AT(primitive, indices)},
    {"material", NUMBER, AT(primitive, material)},
    {"mode", NUMBER, AT(primitive, mode)},
    {"targets", ITEMS, AT(primitive, targets), CONIC_GLTF_TARGETS},
    {DRACO "/bufferView", NUMBER, AT(primitive, draco_view)},
    {DRACO "/attributes", MAP, AT(primitive, draco_attributes)},
    {SPLATS, MARK, AT(primitive, is_gaussian)},
    {SPLATS "/colorSpace", TEXT_AT(primitive, color_space)},
    {SPLATS "/kernel", TEXT_AT(primitive, kernel)},
    {SPLATS "/projection", TEXT_AT(primitive, projection)},
    {SPLATS "/sortingMethod", TEXT_AT(primitive, sorting)},
    {SPLATS "/extensions/KHR_gaussian_splatting_compression_spz/bufferView", NUMBER, AT(primitive, spz_view)},
    {SPLATS "/extensions/KHR_gaussian_splatting_compression_spz_2/bufferView", NUMBER, AT(primitive, spz_view)},
    {SPLATS "/extensions/KHR_spz_gaussian_splats_compression/bufferView", NUMBER, AT(primitive, spz_view)},
    {"extensions/KHR_spz_gaussian_splats_compression/bufferView", NUMBER, AT(primitive, spz_view)},
    {NULL}};
static const field mesh_fields[] = {
    {"primitives", ITEMS, AT(mesh, primitives), CONIC_GLTF_PRIMITIVES}, {"weights", LIST, AT(mesh, weights)}, {NULL}};

static const field node_fields[] = {{"mesh", NUMBER, AT(node, mesh)},
                                    {"camera", NUMBER, AT(node, camera)},
                                    {"skin", NUMBER, AT(node, skin)},
                                    {"matrix", NUMBERS, AT(node, matrix), 16},
                                    {"translation", NUMBERS, AT(node, translation), 3},
                                    {"rotation", NUMBERS, AT(node, rotation), 4},
                                    {"scale", NUMBERS, AT(node, scale), 3},
                                    {"children", LIST, AT(node, children)},
                                    {"weights", LIST, AT(node, weights)},
                                    {"name", TEXT_AT(node, name)},
                                    {"extensions/EXT_mesh_gpu_instancing", MARK, AT(node, has_instances)},
                                    {"extensions/EXT_mesh_gpu_instancing/attributes", MAP, AT(node, instances)},
                                    {"extensions/KHR_node_visibility/visible", TRUTH, AT(node, is_visible)},
                                    {NULL}};

static const field skin_fields[] = {
    {"inverseBindMatrices", NUMBER, AT(skin, inverses)}, {"joints", LIST, AT(skin, joints)}, {NULL}};
static const field scene_fields[] = {{"nodes", LIST, AT(scene, nodes)}, {NULL}};
static const field camera_fields[] = {
    {"perspective/yfov", NUMBER, AT(camera, angle_y_rad)},  {"perspective/aspectRatio", NUMBER, AT(camera, aspect)},
    {"orthographic", MARK, AT(camera, is_orthographic)},    {"orthographic/xmag", NUMBER, AT(camera, half_width)},
    {"orthographic/ymag", NUMBER, AT(camera, half_height)}, {NULL}};

static const field root_fields[] = {{"asset/version", TEXT, ROOT(version), sizeof((conic_gltf *)0)->version},
                                    {"asset/minVersion", TEXT, ROOT(least_version), sizeof((conic_gltf *)0)->version},
                                    {"scene", NUMBER, ROOT(scene)},
                                    {"root", MARK, ROOT(is_tileset)},
                                    {"extensionsUsed", WORDS, NO_SLICE, CONIC_GLTF_USED},
                                    {"extensionsRequired", WORDS, NO_SLICE, CONIC_GLTF_REQUIRED},
                                    {"buffers", ITEMS, NO_SLICE, CONIC_GLTF_BUFFERS},
                                    {"bufferViews", ITEMS, NO_SLICE, CONIC_GLTF_VIEWS},
                                    {"accessors", ITEMS, NO_SLICE, CONIC_GLTF_ACCESSORS},
                                    {"images", ITEMS, NO_SLICE, CONIC_GLTF_IMAGES},
                                    {"samplers", ITEMS, NO_SLICE, CONIC_GLTF_SAMPLERS},
                                    {"textures", ITEMS, NO_SLICE, CONIC_GLTF_TEXTURES},
                                    {"materials", ITEMS, NO_SLICE, CONIC_GLTF_MATERIALS},
                                    {"meshes", ITEMS, NO_SLICE, CONIC_GLTF_MESHES},
                                    {"nodes", ITEMS, NO_SLICE, CONIC_GLTF_NODES},
                                    {"skins", ITEMS, NO_SLICE, CONIC_GLTF_SKINS},
                                    {"scenes", ITEMS, NO_SLICE, CONIC_GLTF_SCENES},
                                    {"cameras", ITEMS, NO_SLICE, CONIC_GLTF_CAMERAS},
                                    {NULL}};

/* What items are before the JSON says anything of them. */
#define NO_USE                                                                                                         \
  {                                                                                                                    \
    .texture = NONE, .other_set = NONE, .scale = { 1, 1 }                                                              \
  }
static const conic_gltf_view no_view = {.buffer = NONE};
static const conic_gltf_accessor no_accessor = {.view = NONE};
static const conic_gltf_image no_image = {.view = NONE};
static const conic_gltf_sampler no_sampler = {{10497, 10497}};
static const conic_gltf_texture no_texture = {NONE, NONE, NONE, NONE};
const conic_gltf_material conic_gltf_no_material = {.color = {1, 1, 1, 1},
                                                    .diffuse = {1, 1, 1, 1},
                                                    .cutoff = 0.5,
                                                    .base = NO_USE,
                                                    .of_diffuse = NO_USE,
                                                    .of_emission = NO_USE};
static const conic_gltf_primitive no_primitive = {
    .indices = NONE, .material = NONE, .mode = 4, .draco_view = NONE, .spz_view = NONE};
static const conic_gltf_node no_node = {.mesh = NONE,
                                        .camera = NONE,
                                        .skin = NONE,
                                        .rotation = {0, 0, 0, 1},
                                        .scale = {1, 1, 1},
                                        .is_visible = 1,
                                        .parent = SIZE_MAX};
static const conic_gltf_skin no_skin = {.inverses = NONE};
/* A buffer, a mesh, a target, an attribute, a scene and a camera begin as zeros. */
static const union {
  conic_gltf_buffer buffer;
  conic_gltf_mesh mesh;
  conic_gltf_attribute attribute;
} zeros;

static const struct list_facts {
  size_t size;
  const void *start;
  const field *fields; /* null: a map */
} lists[CONIC_GLTF_N_LISTS] = {
    [CONIC_GLTF_BUFFERS] = {sizeof(conic_gltf_buffer), &zeros, buffer_fields},
    [CONIC_GLTF_VIEWS] = {sizeof(conic_gltf_view), &no_view, view_fields},
    [CONIC_GLTF_ACCESSORS] = {sizeof(conic_gltf_accessor), &no_accessor, accessor_fields},
    [CONIC_GLTF_IMAGES] = {sizeof(conic_gltf_image), &no_image, image_fields},
    [CONIC_GLTF_SAMPLERS] = {sizeof(conic_gltf_sampler), &no_sampler, sampler_fields},
    [CONIC_GLTF_TEXTURES] = {sizeof(conic_gltf_texture), &no_texture, texture_fields},
    [CONIC_GLTF_MATERIALS] = {sizeof(conic_gltf_material), &conic_gltf_no_material, material_fields},
    [CONIC_GLTF_MESHES] = {sizeof(conic_gltf_mesh), &zeros, mesh_fields},
    [CONIC_GLTF_PRIMITIVES] = {sizeof(conic_gltf_primitive), &no_primitive, primitive_fields},
    [CONIC_GLTF_TARGETS] = {sizeof(conic_gltf_target), &zeros, NULL},
    [CONIC_GLTF_ATTRIBUTES] = {sizeof(conic_gltf_attribute), &zeros, NULL},
    [CONIC_GLTF_NODES] = {sizeof(conic_gltf_node), &no_node, node_fields},
    [CONIC_GLTF_SKINS] = {sizeof(conic_gltf_skin), &no_skin, skin_fields},
    [CONIC_GLTF_SCENES] = {sizeof(conic_gltf_scene), &zeros, scene_fields},
    [CONIC_GLTF_CAMERAS] = {sizeof(conic_gltf_camera), &zeros, camera_fields},
    [CONIC_GLTF_NUMBERS] = {sizeof(double), &zeros, NULL},
    [CONIC_GLTF_USED] = {WORD_ROOM, &zeros, NULL},
    [CONIC_GLTF_REQUIRED] = {WORD_ROOM, &zeros, NULL},
};

/* Appends what such an item is at first; null without memory. */
static void *append(conic_gltf *gltf, size_t id) {
  conic_gltf_list *list = &gltf->lists[id];
  if (conic_memory_append(gltf->context, &list->items, &list->n, &list->room, lists[id].start, lists[id].size) !=
      CONIC_OK)
    return NULL;
  return (char *)list->items + (list->n - 1) * lists[id].size;
}

static conic_status read_map(conic_gltf *gltf, conic_gltf_slice *slice) {
  char key[CONIC_JSON_KEY_ROOM];
  slice->first = gltf->lists[CONIC_GLTF_ATTRIBUTES].n;
  conic_status status = conic_json_begin_object(&gltf->json);
  while (status == CONIC_OK && conic_json_next_member(&gltf->json, key)) {
    conic_gltf_attribute *attribute = append(gltf, CONIC_GLTF_ATTRIBUTES);
    if (!attribute)
      return CONIC_ERROR_MEMORY;
    memcpy(attribute->name, key, sizeof attribute->name);
    status = conic_json_number(&gltf->json, &attribute->accessor);
  }
  slice->n = gltf->lists[CONIC_GLTF_ATTRIBUTES].n - slice->first;
  return status;
}

static conic_status read_object(conic_gltf *gltf, const field *fields, char *item, const char *path);

static conic_status read_items(conic_gltf *gltf, const field *f, char *item) {
  conic_json *json = &gltf->json;
  conic_gltf_slice *slice = f->at == NO_SLICE ? NULL : (conic_gltf_slice *)(void *)(item + f->at);
  size_t id = f->kind == LIST ? CONIC_GLTF_NUMBERS : f->n, first = gltf->lists[id].n;
  if (f->kind == ITEMS && conic_json_is_object(json)) /* the dictionaries of version 1 are arrays in version 2 */
    return conic_json_wrong(json, "this is glTF 1, which is not read; save it as glTF 2 (Blender, or gltf-pipeline)");
  conic_status status = conic_json_begin_array(json);
  while (status == CONIC_OK && conic_json_next_item(json)) {
    uint64_t line = json->line;
    void *added = append(gltf, id);
    if (!added)
      return CONIC_ERROR_MEMORY;
    if (f->kind == LIST)
      status = conic_json_number(json, added);
    else if (f->kind == WORDS)
      status = conic_json_text(json, added, WORD_ROOM);
    else if (!lists[id].fields)
      status = read_map(gltf, added);
    else
      status = read_object(gltf, lists[id].fields, added, "");
    if (id == CONIC_GLTF_NODES)
      ((conic_gltf_node *)added)->line = line;
  }
  if (slice)
    *slice = (conic_gltf_slice){first, gltf->lists[id].n - first};
  return status;
}

static conic_status read_numbers(conic_gltf *gltf, double *numbers, size_t n) {
  size_t n_read;
  conic_status status = conic_json_numbers(&gltf->json, numbers, n, &n_read);
  return status == CONIC_OK && n_read != n ? conic_json_wrong(&gltf->json, "a list has another number of numbers")
                                           : status;
}

static conic_status read_field(conic_gltf *gltf, const field *f, char *item) {
  conic_json *json = &gltf->json;
  void *at = item + (f->at == NO_SLICE ? 0 : f->at);
  switch (f->kind) {
  case NUMBER:
    return conic_json_number(json, at);
  case NUMBERS:
    return read_numbers(gltf, at, f->n);
  case TRUTH:
    return conic_json_truth(json, at);
  case TEXT:
    return conic_json_text(json, at, f->n);
  case RAW:
    return conic_json_raw_text(json, &((conic_gltf_text *)at)->bytes, &((conic_gltf_text *)at)->length);
  case MAP:
    return read_map(gltf, at);
  case ITEMS:
  case LIST:
  case WORDS:
  case MARK:
    break;
  }
  return read_items(gltf, f, item);
}

/* The first field at a path, or within the object there; null: nothing there matters. */
static const field *find_field(const field *fields, const char *path, size_t length) {
  while (fields->path &&
         (strncmp(fields->path, path, length) != 0 || (fields->path[length] != 0 && fields->path[length] != '/')))
    fields++;
  return fields->path ? fields : NULL;
}

/* Items stay where they are while they are read: none of a list is within another of it. */
static conic_status read_object(conic_gltf *gltf, const field *fields, char *item, const char *path) {
  char key[CONIC_JSON_KEY_ROOM], within[LONGEST_JSON_PATH];
  conic_status status = conic_json_begin_object(&gltf->json);
  while (status == CONIC_OK && conic_json_next_member(&gltf->json, key)) {
    int n = snprintf(within, sizeof within, "%s%s%s", path, path[0] ? "/" : "", key);
    const field *f = n > 0 && n < LONGEST_JSON_PATH ? find_field(fields, within, (size_t)n) : NULL;
    if (f && f->kind == MARK && !f->path[n])
      *(int *)(void *)(item + f->at) = 1;
    if (!f || (f->kind == MARK && !find_field(f + 1, within, (size_t)n)))
      status = conic_json_skip(&gltf->json);
    else if (f->kind == MARK || f->path[n])
      status = read_object(gltf, fields, item, within);
    else
      status = read_field(gltf, f, item);
  }
  return status == CONIC_OK ? gltf->json.status : status;
}

conic_status conic_gltf_read_json(conic_gltf *gltf) {
  gltf->scene = NONE;
  return read_object(gltf, root_fields, (char *)gltf, "");
}

void *conic_gltf_at(const conic_gltf *gltf, conic_gltf_list_id list, double number) {
  return conic_gltf_is_index(number, gltf->lists[list].n)
             ? (char *)gltf->lists[list].items + (size_t)number * lists[list].size
             : NULL;
}

void *conic_gltf_item(const conic_gltf *gltf, conic_gltf_list_id list, conic_gltf_slice slice, size_t i) {
  return (char *)gltf->lists[list].items + (slice.first + i) * lists[list].size;
}

double conic_gltf_find(const conic_gltf *gltf, conic_gltf_slice attributes, const char *name) {
  for (size_t i = 0; i < attributes.n; i++) {
    const conic_gltf_attribute *attribute = conic_gltf_item(gltf, CONIC_GLTF_ATTRIBUTES, attributes, i);
    if (strcmp(attribute->name, name) == 0)
      return attribute->accessor;
  }
  return NONE;
}
