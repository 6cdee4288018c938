/* Writes an asset of the Khronos pack, and works out what is to be seen: each number as it is stored, at the place
 * where the nodes put it. Nothing of that is taken from conic's own reader. */
#include "cli/judge/khr_assets.h"

#include <stdarg.h>

#include "core/base/byte_order.h"
#include "core/base/color.h"
#include "core/base/eigen.h"
#include "core/base/random.h"
#include "core/base/vectors.h"
#include "core/files/file.h"
#include "gaussians/scene/gaussian_set.h"

enum { MOST_SPLATS = 64, MOST_NODES = 8, MOST_ATTRIBUTES = 20, TEXT_ROOM = 16384, BYTES_ROOM = 65536, PARTS = 2 };
enum { WIDTH = 40, HEIGHT = 30, COLOR = MOST_ATTRIBUTES };

/* 2 atan(½): the focal length is the picture's height. */
static const double angle_y_rad = 0.92729521800161219;

typedef struct khr_text {
  char text[TEXT_ROOM];
  size_t n;
} khr_text;

typedef struct khr_writer {
  const khr_asset *asset;
  khr_text json, views, accessors, meshes;
  int n_views, n_accessors;
  unsigned char bytes[BYTES_ROOM];
  size_t n_bytes;
  size_t in_row, row, rows_at;                        /* of interleaved attributes */
  double values[MOST_ATTRIBUTES + 1][4][MOST_SPLATS]; /* as they are stored */
  double worlds[MOST_NODES][3][4];
} khr_writer;

CONIC_AS_PRINTF(2, 3) static void add(khr_text *to, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  to->n += (size_t)vsnprintf(to->text + to->n, TEXT_ROOM - to->n, format, arguments);
  va_end(arguments);
}

/* --- the splats --- */

static int part_of(const khr_asset *asset, int i) {
  return asset->flags & (KHR_PRIMITIVES | KHR_MESHES) ? i % PARTS : 0;
}

static khr_splat splat_of(const khr_asset *asset, int i) {
  if (asset->splats)
    return asset->splats[i];
  double r[13];
  for (uint64_t k = 0; k < 13; k++)
    r[k] = 2.0 * conic_random_uniform(11, (uint64_t)i, k) - 1.0;
  return (khr_splat){.mean = {1.6 * r[0], 1.1 * r[1], r[2]},
                     .scale = {0.35 + 0.2 * r[3], 0.35 + 0.2 * r[4], 0.35 + 0.2 * r[5]},
                     .rotation = {r[6], r[7], r[8], r[9]},
                     .opacity = 0.35 + 0.3 * r[10],
                     .color = {0.5 + 0.4 * r[11], 0.5 + 0.4 * r[12], 0.5 + 0.4 * r[3]}};
}

/* Coefficients above degree 0, each different, but where an accessor stands for several. */
static double harmonic_of(const khr_asset *asset, int i, int k, int channel) {
  const int i_own = asset->flags & KHR_SHARED ? 1 : k;
  return ((13 * (7 * i + 5 * i_own + 3 * channel)) % 17 - 8) / 32.0;
}

static double number_of(const khr_asset *asset, int i, int attribute, int k) {
  const khr_splat s = splat_of(asset, i);
  const double unit = asset->unit > 0.0 ? asset->unit : 1.0, *q = s.rotation;
  const double color = (s.color[k < 3 ? k : 0] - 0.5) / CONIC_SH_CONSTANT;
  switch (attribute) {
  case KHR_POSITION:
    return s.mean[k] * unit;
  case KHR_ROTATION:
    return q[k] / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  case KHR_SCALE:
    return s.scale[k] * unit;
  case KHR_OPACITY:
    return s.opacity;
  case KHR_HARMONICS:
    return color;
  case COLOR:
    return k == 3 ? s.opacity : conic_srgb_decode(s.color[k] < 0.0 ? 0.0 : s.color[k] > 1.0 ? 1.0 : s.color[k]);
  default:
    return harmonic_of(asset, i, attribute - KHR_HARMONICS, k);
  }
}

/* --- buffers, views and accessors --- */

static size_t size_of(int component) {
  return component == CONIC_GLTF_FLOAT || component == CONIC_GLTF_UINT32 ? 4
         : component == CONIC_GLTF_INT8 || component == CONIC_GLTF_UINT8 ? 1
                                                                         : 2;
}

static double most_of(int component) {
  return component == CONIC_GLTF_INT8    ? 127.0
         : component == CONIC_GLTF_UINT8 ? 255.0
         : component == CONIC_GLTF_INT16 ? 32767.0
                                         : 65535.0;
}

/* Begins a view at the next multiple of 4; a stride of 0 is not written. */
static void begin_view(khr_writer *w, size_t n_bytes, size_t stride) {
  w->n_bytes = (w->n_bytes + 3) / 4 * 4;
  add(&w->views, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu", w->n_views++ ? "," : "", w->n_bytes, n_bytes);
  if (stride)
    add(&w->views, ",\"byteStride\":%zu,\"target\":34962", stride);
  add(&w->views, "}");
}

/* Writes a number, and returns the code, or the float. */
static double put_number(khr_writer *w, size_t at, const khr_storage *storage, double value) {
  if (storage->component == CONIC_GLTF_FLOAT) {
    conic_store_float(w->bytes + at, (float)value);
    return (double)(float)value;
  }
  const double code = floor(value * (storage->is_normalized ? most_of(storage->component) : 1.0) + 0.5);
  const uint32_t bits = (uint32_t)(int32_t)code;
  for (size_t i = 0; i < size_of(storage->component); i++)
    w->bytes[at + i] = (unsigned char)(bits >> 8 * i);
  return code;
}

/* The splats of a part, or of them those whose values are sparse. */
static int list_splats(const khr_writer *w, int part, int attribute, int n, const khr_storage *sparse, int *list) {
  int count = 0, i_own = 0;
  for (int i = 0; i < w->asset->n; i++) {
    int is_zero = 1;
    if (part_of(w->asset, i) != part)
      continue;
    for (int k = 0; k < n; k++)
      is_zero &= number_of(w->asset, i, attribute, k) == 0.0;
    if (!sparse || (sparse->lacks_base ? !is_zero : i_own % 2))
      list[count++] = sparse ? i_own : i;
    i_own++;
  }
  return count;
}

static void add_sparse(khr_writer *w, int part, int attribute, int n, const khr_storage *storage) {
  int own[MOST_SPLATS], all[MOST_SPLATS];
  const khr_storage indices = {.component = storage->sparse};
  const size_t index_size = size_of(storage->sparse), size = size_of(storage->component);
  list_splats(w, part, attribute, n, NULL, all);
  const int count = list_splats(w, part, attribute, n, storage, own);
  add(&w->accessors,
      ",\"sparse\":{\"count\":%d,\"indices\":{\"bufferView\":%d,\"componentType\":%d},\"values\":{\"bufferView\":%d}}",
      count, w->n_views, storage->sparse, w->n_views + 1);
  begin_view(w, (size_t)count * index_size, 0);
  for (int i = 0; i < count; i++, w->n_bytes += index_size)
    put_number(w, w->n_bytes, &indices, own[i]);
  begin_view(w, (size_t)count * (size_t)n * size, 0);
  for (int i = 0; i < count; i++)
    for (int k = 0; k < n; k++, w->n_bytes += size)
      put_number(w, w->n_bytes, storage, number_of(w->asset, all[own[i]], attribute, k));
}

/* An accessor of an attribute of a part's splats; what is stored goes to `values`. */
static void add_accessor(khr_writer *w, int part, int attribute, int n) {
  static const char *const types[] = {NULL, "SCALAR", NULL, "VEC3", "VEC4"};
  const khr_asset *asset = w->asset;
  khr_storage storage = attribute <= KHR_HARMONICS ? asset->storage[attribute] : (khr_storage){.component = 0};
  storage.component = storage.component ? storage.component : CONIC_GLTF_FLOAT;
  const size_t size = size_of(storage.component), item = ((size_t)n * size + 3) / 4 * 4;
  const int is_in_rows = asset->flags & KHR_INTERLEAVED && w->row > 0;
  double ends[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  int list[MOST_SPLATS];
  const size_t count = (size_t)list_splats(w, part, attribute, n, NULL, list);
  const size_t stride = is_in_rows ? w->row : item;
  if (!storage.lacks_base && !(is_in_rows && w->in_row)) {
    begin_view(w, count * stride, stride);
    w->rows_at = w->n_bytes;
    w->n_bytes += count * stride;
  }
  add(&w->accessors, "%s{\"componentType\":%d,\"count\":%zu,\"type\":\"%s\"", w->n_accessors++ ? "," : "",
      storage.component, count, types[n]);
  if (!storage.lacks_base)
    add(&w->accessors, ",\"bufferView\":%d,\"byteOffset\":%zu", w->n_views - 1, is_in_rows ? w->in_row : 0);
  if (storage.is_normalized)
    add(&w->accessors, ",\"normalized\":true");
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < n; k++) {
      const double value = number_of(asset, list[i], attribute, k);
      const size_t at = w->rows_at + i * stride + (is_in_rows ? w->in_row : 0) + (size_t)k * size;
      const double code = storage.lacks_base ? (double)(float)value : put_number(w, at, &storage, value);
      w->values[attribute][k][list[i]] = storage.is_normalized ? code / most_of(storage.component) : code;
      if (storage.sparse && !storage.lacks_base && i % 2)
        put_number(w, at, &storage, w->values[attribute][k][list[0]]); /* what the sparse value replaces */
      if (attribute == KHR_POSITION) {
        ends[0][k] = fmin(ends[0][k], code);
        ends[1][k] = fmax(ends[1][k], code);
      }
    }
  if (storage.sparse)
    add_sparse(w, part, attribute, n, &storage);
  if (attribute == KHR_POSITION)
    add(&w->accessors, ",\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]", ends[0][0], ends[0][1], ends[0][2],
        ends[1][0], ends[1][1], ends[1][2]);
  add(&w->accessors, "}");
  w->in_row += item;
}

/* --- meshes --- */

static void add_primitive(khr_writer *w, int part) {
  static const char *const names[] = {"POSITION", "KHR_gaussian_splatting:ROTATION", "KHR_gaussian_splatting:SCALE",
                                      "KHR_gaussian_splatting:OPACITY"};
  const khr_asset *asset = w->asset;
  const int n_harmonics = (asset->degree + 1) * (asset->degree + 1);
  const int n_attributes = KHR_HARMONICS + n_harmonics;
  w->in_row = 0;
  w->row = 4 * (size_t)(3 + 4 + 3 + 1 + 3 * n_harmonics);
  add(&w->meshes, "{\"mode\":0,\"attributes\":{");
  for (int i = 0; i < n_attributes; i++) {
    const int k = i - KHR_HARMONICS, degree = k >= 9 ? 3 : k >= 4 ? 2 : k >= 1;
    const int is_same = asset->flags & KHR_SHARED && k > 1;
    if (i < KHR_HARMONICS)
      add(&w->meshes, "%s\"%s\":%d", i ? "," : "", names[i], w->n_accessors);
    else
      add(&w->meshes, ",\"KHR_gaussian_splatting:SH_DEGREE_%d_COEF_%d\":%d", degree, k - degree * degree,
          w->n_accessors - is_same);
    if (is_same)
      memcpy(w->values[i], w->values[i - 1], sizeof w->values[i]);
    else
      add_accessor(w, part, i, i == KHR_ROTATION ? 4 : i == KHR_OPACITY ? 1 : 3);
  }
  w->row = 0;
  if (asset->flags & KHR_FALLBACK) {
    add(&w->meshes, ",\"COLOR_0\":%d", w->n_accessors);
    add_accessor(w, part, COLOR, 4);
  }
  add(&w->meshes,
      "},%s\"extensions\":{\"KHR_gaussian_splatting\":{\"kernel\":\"ellipse\",\"colorSpace\":"
      "\"%s_rec709_display\"}}}",
      asset->flags & KHR_FALLBACK ? "\"material\":0," : "", asset->flags & KHR_LINEAR ? "lin" : "srgb");
}

/* A triangle behind every camera. */
static void add_triangle(khr_writer *w) {
  static const float corners[9] = {-1.0f, -1.0f, 40.0f, 1.0f, -1.0f, 40.0f, 0.0f, 1.0f, 40.0f};
  add(&w->meshes, ",{\"mode\":4,\"attributes\":{\"POSITION\":%d}}", w->n_accessors);
  add(&w->accessors,
      ",{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"bufferView\":%d,\"min\":[-1,-1,40],\"max\":[1,1,40]}",
      w->n_views);
  w->n_accessors++;
  begin_view(w, sizeof corners, 12);
  for (int i = 0; i < 9; i++, w->n_bytes += 4)
    conic_store_float(w->bytes + w->n_bytes, corners[i]);
}

static void add_meshes(khr_writer *w) {
  const unsigned flags = w->asset->flags;
  add(&w->meshes, "{\"primitives\":[");
  add_primitive(w, 0);
  if (flags & (KHR_PRIMITIVES | KHR_MESHES)) {
    add(&w->meshes, flags & KHR_MESHES ? "]},{\"primitives\":[" : ",");
    add_primitive(w, 1);
  }
  if (flags & KHR_TRIANGLE)
    add_triangle(w);
  add(&w->meshes, "]}");
}

/* --- nodes --- */

static const khr_node plain_nodes[] = {{.mesh = 1}, {.mesh = 2}};

static int count_nodes(const khr_asset *asset) {
  return asset->n_nodes ? asset->n_nodes : asset->flags & KHR_MESHES ? 2 : 1;
}

static const khr_node *node_of(const khr_asset *asset, int i) {
  return asset->n_nodes ? &asset->nodes[i] : &plain_nodes[i];
}

/* The node's own rotation x, y, z, w, and scale, as they are written. */
static void find_own(const khr_asset *asset, const khr_node *node, double rotation[4], double scale[3]) {
  const double *q = node->rotation, length = sqrt(conic_dot(q, q) + q[3] * q[3]);
  const double unit = node->mesh && asset->unit > 0.0 ? asset->unit : 1.0;
  for (int k = 0; k < 4; k++)
    rotation[k] = length > 0.0 ? q[k] / length : k == 3;
  for (int k = 0; k < 3; k++)
    scale[k] = (node->scale[k] > 0.0 ? node->scale[k] : 1.0) / unit;
}

static void place_nodes(khr_writer *w) {
  for (int i = 0; i < count_nodes(w->asset); i++) {
    const khr_node *node = node_of(w->asset, i);
    double rotation[4], scale[3], turn[3][3], own[3][4];
    find_own(w->asset, node, rotation, scale);
    conic_rotation_of((const double[4]){rotation[3], rotation[0], rotation[1], rotation[2]}, turn);
    for (int row = 0; row < 3; row++) {
      for (int k = 0; k < 3; k++)
        own[row][k] = turn[row][k] * scale[k];
      own[row][3] = node->translation[row];
    }
    if (node->parent)
      conic_gltf_join_places((const double(*)[4])w->worlds[node->parent - 1], (const double(*)[4])own, w->worlds[i]);
    else
      memcpy(w->worlds[i], own, sizeof own);
  }
}

static void add_numbers(khr_text *to, const char *key, const double *numbers, int n) {
  add(to, ",\"%s\":[", key);
  for (int k = 0; k < n; k++)
    add(to, "%s%.17g", k ? "," : "", numbers[k]);
  add(to, "]");
}

static void add_node(khr_writer *w, int i) {
  const khr_node *node = node_of(w->asset, i);
  double rotation[4], scale[3], matrix[16] = {[15] = 1.0};
  int n_children = 0;
  find_own(w->asset, node, rotation, scale);
  add(&w->json, "{\"name\":\"node-%d\"", i);
  if (node->mesh)
    add(&w->json, ",\"mesh\":%d", node->mesh - 1);
  if (node->is_matrix) {
    for (int k = 0; k < 12; k++) /* such a node has no parent */
      matrix[4 * (k % 4) + k / 4] = w->worlds[i][k / 4][k % 4];
    add_numbers(&w->json, "matrix", matrix, 16);
  } else {
    add_numbers(&w->json, "translation", node->translation, 3);
    add_numbers(&w->json, "rotation", rotation, 4);
    add_numbers(&w->json, "scale", scale, 3);
  }
  for (int k = 0; k < count_nodes(w->asset); k++)
    if (node_of(w->asset, k)->parent == i + 1)
      add(&w->json, "%s%d", n_children++ ? "," : ",\"children\":[", k);
  add(&w->json, n_children ? "]},\n" : "},\n");
}

static void add_scenes(khr_writer *w) {
  const khr_asset *asset = w->asset;
  const int n = count_nodes(asset);
  int n_elsewhere = 0;
  for (int i = 0; i < n; i++)
    if (node_of(asset, i)->is_elsewhere)
      add(&w->json, n_elsewhere++ ? ",%d" : "\"scenes\":[{\"nodes\":[%d", i);
  add(&w->json, n_elsewhere ? "]},{\"nodes\":[%d" : "\"scenes\":[{\"nodes\":[%d", n);
  for (int i = 0; i < n; i++)
    if (!node_of(asset, i)->parent && !node_of(asset, i)->is_elsewhere)
      add(&w->json, ",%d", i);
  add(&w->json, "]}],\n\"scene\":%d,\n\"nodes\":[", n_elsewhere > 0);
  for (int i = 0; i < n; i++)
    add_node(w, i);
  suite_scene scene;
  cli_khr_scene(asset, &scene);
  const double *turn = asset->turn, none[4] = {0.0, 0.0, 0.0, 1.0};
  add(&w->json, "{\"name\":\"camera\",\"camera\":0");
  add_numbers(&w->json, "translation", scene.eye, 3);
  add_numbers(&w->json, "rotation", turn[3] != 0.0 ? turn : none, 4);
  add(&w->json,
      "}],\n\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":%.17g,\"aspectRatio\":%.17g,"
      "\"znear\":0.01}}],\n",
      angle_y_rad, (double)WIDTH / HEIGHT);
}

/* --- the file --- */

static conic_status edit(suite_files *suite, khr_writer *w, const char *from, const char *to) {
  khr_text *edited = &w->views; /* it is in the JSON by now */
  const char *at = w->json.text;
  int n = 0;
  edited->n = 0;
  for (const char *next; (next = strstr(at, from)); at = next + strlen(from), n++)
    add(edited, "%.*s%s", (int)(next - at), at, to);
  add(edited, "%s", at);
  w->json = *edited;
  return n ? CONIC_OK : conic_fail(suite->context, CONIC_ERROR_ARGUMENT, "%s: no %s in it", w->asset->name, from);
}

static void make_json(khr_writer *w) {
  const khr_asset *asset = w->asset;
  add(&w->json, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"conic conformance\"},\n"
                "\"extensionsUsed\":[\"KHR_gaussian_splatting\"],\n");
  add_scenes(w);
  add(&w->json, "\"meshes\":[%s],\n\"accessors\":[%s],\n\"bufferViews\":[%s],\n", w->meshes.text, w->accessors.text,
      w->views.text);
  if (asset->flags & KHR_FALLBACK)
    add(&w->json, "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0,0,1]}}],\n");
  add(&w->json, "\"buffers\":[{\"byteLength\":%zu", w->n_bytes);
  if (!(asset->flags & KHR_GLB))
    add(&w->json, ",\"uri\":\"%s.bin\"", asset->name);
  add(&w->json, "}]}\n");
}

static conic_status write_bytes(suite_files *suite, const char *path, const void *const *parts, const size_t *sizes,
                                size_t n_parts, int is_cut) {
  char full[4096];
  conic_output *output;
  conic_status status = cli_suite_join(suite->context, suite->folder, path, full, sizeof full);
  if (status == CONIC_OK)
    status = conic_output_open(suite->context, full, &output);
  if (status != CONIC_OK)
    return status;
  for (size_t i = 0; i < n_parts; i++)
    fwrite(parts[i], 1, is_cut && i == n_parts - 1 ? sizes[i] / 2 : sizes[i], conic_output_stream(output));
  status = conic_output_commit(output);
  return status == CONIC_OK ? cli_suite_add_file(suite, path) : status;
}

static conic_status write_file(suite_files *suite, khr_writer *w) {
  char path[SUITE_PATH_ROOM];
  const int is_cut = (w->asset->flags & KHR_CUT) != 0;
  cli_khr_path(w->asset, path);
  if (w->asset->flags & KHR_GLB) {
    unsigned char heads[28];
    while (w->json.n % 4)
      add(&w->json, " ");
    const uint32_t words[7] = {0x46546c67,          2,          (uint32_t)(28 + w->json.n + w->n_bytes),
                               (uint32_t)w->json.n, 0x4e4f534a, (uint32_t)w->n_bytes,
                               0x004e4942};
    for (int i = 0; i < 7; i++)
      conic_store_32(heads + (size_t)i * 4, words[i]);
    const void *const parts[] = {heads, w->json.text, heads + 20, w->bytes};
    return write_bytes(suite, path, parts, (const size_t[]){20, w->json.n, 8, w->n_bytes}, 4, is_cut);
  }
  const void *const json = w->json.text, *const bytes = w->bytes;
  conic_status status = write_bytes(suite, path, &json, &w->json.n, 1, is_cut);
  memcpy(strrchr(path, '.'), ".bin", sizeof ".bin");
  return status == CONIC_OK ? write_bytes(suite, path, &bytes, &w->n_bytes, 1, 0) : status;
}

/* --- what is to be seen --- */

/* Σ = M C Cᵀ Mᵀ of the text: its axes are the new ones. */
static void put_ellipsoid(const khr_writer *w, const double world[3][4], int i_splat, size_t i, conic_gaussians *to) {
  const double(*rotation)[MOST_SPLATS] = w->values[KHR_ROTATION];
  const double q[4] = {rotation[3][i_splat], rotation[0][i_splat], rotation[1][i_splat], rotation[2][i_splat]};
  double turn[3][3], columns[3][3], squares[6] = {0}, lengths[3], axes[3][3], unit[4];
  conic_rotation_of(q, turn);
  for (int k = 0; k < 3; k++) {
    double mean = world[k][3];
    for (int row = 0; row < 3; row++) {
      const double axis[3] = {turn[0][k], turn[1][k], turn[2][k]};
      columns[k][row] = conic_dot(world[row], axis) * w->values[KHR_SCALE][k][i_splat];
      mean += world[k][row] * w->values[KHR_POSITION][row][i_splat];
    }
    to->position[k][i] = (float)mean;
    conic_add_outer(squares, columns[k], columns[k]);
  }
  conic_eigen3(squares, lengths, axes);
  conic_cross(axes[0], axes[1], axes[2]);
  for (int k = 0; k < 3; k++) {
    to->scale[k][i] = (float)sqrt(fmax(lengths[k], 0.0));
    for (int row = 0; row < 3; row++)
      columns[row][k] = axes[k][row];
  }
  conic_gaussians_find_quaternion((const double(*)[3])columns, unit);
  for (int k = 0; k < 4; k++)
    to->rotation[k][i] = (float)unit[k];
}

/* Adds the splats of a mesh at a node's place; returns through n how many there are then. */
static conic_status see_mesh(suite_files *suite, const khr_writer *w, int i_node, conic_gaussians *seen, size_t *n) {
  const khr_asset *asset = w->asset;
  const double(*world)[4] = w->worlds[i_node];
  const int mesh = node_of(asset, i_node)->mesh - 1, n_harmonics = (asset->degree + 1) * (asset->degree + 1);
  double turn[3][3];
  conic_gaussians one;
  for (int k = 0; k < 3; k++) {
    const double column[3] = {world[0][k], world[1][k], world[2][k]};
    for (int row = 0; row < 3; row++)
      turn[row][k] = world[row][k] / conic_length(column);
  }
  conic_status status = conic_gaussians_allocate(suite->context, 1, asset->degree, 0, &one);
  for (int i = 0; status == CONIC_OK && i < asset->n; i++) {
    if (asset->flags & KHR_MESHES && part_of(asset, i) != mesh)
      continue;
    for (int k = 0; k < 3 * n_harmonics; k++)
      conic_gaussians_put_harmonic(&one, 0, (size_t)k, (float)w->values[KHR_HARMONICS + k / 3][k % 3][i]);
    one.opacity[0] = (float)w->values[KHR_OPACITY][0][i];
    conic_gaussians_rotate(suite->context, &one, (const double(*)[3])turn);
    put_ellipsoid(w, world, i, 0, &one);
    conic_gaussians_put(&one, seen, (*n)++);
  }
  conic_gaussians_release(suite->context, &one);
  return status;
}

static int is_seen(const khr_asset *asset, int i_node) {
  return node_of(asset, i_node)->mesh && !node_of(asset, i_node)->is_elsewhere;
}

static conic_status see(suite_files *suite, const khr_writer *w, conic_gaussians *seen) {
  const khr_asset *asset = w->asset;
  size_t n = 0, most = 0;
  for (int i = 0; i < count_nodes(asset); i++)
    for (int k = 0; is_seen(asset, i) && k < asset->n; k++)
      most += !(asset->flags & KHR_MESHES) || part_of(asset, k) == node_of(asset, i)->mesh - 1;
  conic_status status = conic_gaussians_allocate(suite->context, most, asset->degree, 0, seen);
  for (int i = 0; status == CONIC_OK && i < count_nodes(asset); i++)
    if (is_seen(asset, i))
      status = see_mesh(suite, w, i, seen, &n);
  return status;
}

/* --- all of it --- */

void cli_khr_path(const khr_asset *asset, char path[SUITE_PATH_ROOM]) {
  snprintf(path, SUITE_PATH_ROOM, "%s/%s.%s", asset->level ? "scenes" : "broken", asset->name,
           asset->flags & KHR_GLB ? "glb" : "gltf");
}

void cli_khr_scene(const khr_asset *asset, suite_scene *scene) {
  static const double ahead[3] = {0.0, 0.0, 4.0};
  const double *turn = asset->turn;
  const int is_turned = turn[3] != 0.0;
  *scene = (suite_scene){.name = asset->name,
                         .about = asset->about,
                         .level = asset->level,
                         .width = WIDTH,
                         .height = HEIGHT,
                         .focal = {HEIGHT, HEIGHT},
                         .center = {0.5 * WIDTH, 0.5 * HEIGHT},
                         .rotation = {turn[0], is_turned ? turn[3] : 1.0, turn[2], -turn[1]},
                         .asset = asset};
  memcpy(scene->eye, is_turned ? asset->eye : ahead, sizeof scene->eye);
  memcpy(scene->background, asset->background, sizeof scene->background);
}

conic_status cli_khr_write(suite_files *suite, const khr_asset *asset, conic_gaussians *seen) {
  khr_writer *w = conic_memory_allocate_zeroed(suite->context, 1, sizeof *w);
  if (!w)
    return CONIC_ERROR_MEMORY;
  w->asset = asset;
  add_meshes(w);
  w->n_bytes = (w->n_bytes + 3) / 4 * 4;
  place_nodes(w);
  make_json(w);
  conic_status status = CONIC_OK;
  for (int i = 0; status == CONIC_OK && i < 4 && asset->edits[i][0]; i++)
    status = edit(suite, w, asset->edits[i][0], asset->edits[i][1]);
  if (status == CONIC_OK)
    status = see(suite, w, seen);
  if (status == CONIC_OK && !(asset->flags & KHR_BY_CONIC))
    status = write_file(suite, w);
  conic_memory_release(suite->context, w);
  return status;
}
