#include "lod/hierarchies/hierarchy.h"

#include "core/base/byte_order.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "lod/layers/format/layers_key.h"

static const conic_hierarchy_kind *const kinds[] = {&conic_hierarchy_kind_copc, &conic_hierarchy_kind_ept,
                                                    &conic_hierarchy_kind_potree};
enum { N_KINDS = sizeof kinds / sizeof *kinds };

/* No coordinate is farther out, and no length is greater. */
static const double farthest = 1e15;

const conic_hierarchy_kind *conic_hierarchy_kind_of(const char *name, const unsigned char *head, size_t n_head) {
  for (int i = 0; i < N_KINDS; i++)
    if (kinds[i]->is_one(name, head, n_head))
      return kinds[i];
  return NULL;
}

int conic_hierarchy_find_file(const char *path, char *file, size_t room) {
  static const char *const first[] = {"ept.json", "metadata.json"};
  conic_disk_entry found;
  int is_folder = conic_disk_look(path, &found) && found.is_folder;
  for (size_t i = 0; i < sizeof first / sizeof *first && is_folder; i++) {
    int n = snprintf(file, room, "%s/%s", path, first[i]);
    if (n > 0 && (size_t)n < room && conic_file_is_there(file))
      return 1;
  }
  int n = snprintf(file, room, "%s", path);
  return n >= 0 && (size_t)n < room;
}

const char *conic_hierarchy_name_of(const char *path) {
  unsigned char head[CONIC_HIERARCHY_HEAD_BYTES];
  char file[CONIC_HIERARCHY_PATH_ROOM];
  size_t n = conic_hierarchy_find_file(path, file, sizeof file) ? conic_file_read_head(file, head, sizeof head) : 0;
  const conic_hierarchy_kind *kind = n > 0 ? conic_hierarchy_kind_of(file, head, n) : NULL;
  return kind ? kind->name : NULL;
}

int conic_hierarchy_is_file(const char *path) {
  return conic_hierarchy_name_of(path) != NULL;
}

conic_status conic_hierarchy_open(conic_context *context, const conic_hierarchy_kind *kind, const char *name,
                                  conic_ranges *ranges, const conic_ranges_options *access,
                                  conic_hierarchy **hierarchy) {
  conic_hierarchy *h = *hierarchy = conic_memory_allocate_zeroed(context, 1, sizeof *h);
  if (!h) {
    conic_ranges_close(ranges);
    return CONIC_ERROR_MEMORY;
  }
  h->context = context;
  h->kind = kind;
  h->name = name;
  h->ranges = h->pages = ranges;
  h->access = *access;
  conic_status status = kind->open(h);
  const char *wrong = status == CONIC_OK ? conic_hierarchy_check(h) : NULL;
  if (wrong)
    status = conic_hierarchy_wrong(h, wrong);
  if (status == CONIC_OK)
    return CONIC_OK;
  conic_hierarchy_close(h);
  *hierarchy = NULL;
  return status;
}

void conic_hierarchy_close(conic_hierarchy *hierarchy) {
  if (!hierarchy)
    return;
  conic_context *context = hierarchy->context;
  if (hierarchy->pages != hierarchy->ranges)
    conic_ranges_close(hierarchy->pages);
  conic_ranges_close(hierarchy->ranges);
  conic_memory_release_these(context, hierarchy->nodes, hierarchy->own);
  conic_georeference_release(context, &hierarchy->reference);
  conic_memory_release(context, hierarchy);
}

conic_status conic_hierarchy_wrong(const conic_hierarchy *hierarchy, const char *what) {
  return conic_fail(hierarchy->context, CONIC_ERROR_INPUT, "%s: %s", hierarchy->name, what);
}

conic_status conic_hierarchy_read(const conic_hierarchy *hierarchy, size_t n_bytes, unsigned char **bytes) {
  uint64_t size = conic_ranges_size(hierarchy->ranges);
  size_t n_read;
  *bytes = NULL;
  if (n_bytes == 0 || n_bytes > size)
    return conic_fail(hierarchy->context, CONIC_ERROR_INPUT, "%s: the file ends too early (at byte %llu)",
                      hierarchy->name, (unsigned long long)size);
  const conic_range range = {.n_bytes = n_bytes};
  return conic_ranges_read(hierarchy->ranges, hierarchy->name, &range, hierarchy->access.until_s, bytes, &n_read);
}

const char *conic_hierarchy_add(conic_hierarchy *hierarchy, const conic_hierarchy_node *node) {
  if (node->level > CONIC_HIERARCHY_LEVELS)
    return "a node is too deep";
  if (node->n_points > CONIC_HIERARCHY_NODE_POINTS)
    return "a node has too many points";
  if (hierarchy->n_nodes >= UINT32_MAX / 16)
    return "there are too many nodes";
  if (node->n_bytes > UINT32_MAX || (node->is_page && node->n_bytes > CONIC_HIERARCHY_PAGE_BYTES))
    return "a node or page has too many bytes";
  if (conic_memory_append(hierarchy->context, &hierarchy->nodes, &hierarchy->n_nodes, &hierarchy->nodes_room, node,
                          sizeof *node) != CONIC_OK)
    return "there is no memory for it";
  return NULL;
}

int conic_hierarchy_key(uint32_t level, const uint32_t cell[3], uint64_t *key) {
  if (level > CONIC_HIERARCHY_LEVELS)
    return 0;
  for (int axis = 0; axis < 3; axis++)
    if (cell[axis] >> level)
      return 0;
  *key = conic_layers_key(cell[0], cell[1], cell[2]) << 3 * (CONIC_HIERARCHY_LEVELS - level);
  return 1;
}

void conic_hierarchy_cell(const conic_hierarchy_node *node, uint32_t cell[3]) {
  for (int axis = 0; axis < 3; axis++)
    cell[axis] = conic_layers_step(node->key >> 3 * (CONIC_HIERARCHY_LEVELS - node->level), axis);
}

const char *conic_hierarchy_take_records(const conic_hierarchy *hierarchy, const unsigned char *records, size_t n_bytes,
                                         conic_hierarchy_points *points) {
  if (n_bytes != points->n * hierarchy->layout.n_bytes)
    return "it has another size than its points";
  conic_point_layout_take(&hierarchy->layout, records, points);
  return NULL;
}

static int is_from_to(double value, double least, double most) {
  return value >= least && value <= most; /* false where it is no number */
}

const char *conic_hierarchy_check(const conic_hierarchy *h) {
  for (int axis = 0; axis < 3; axis++) {
    if (!is_from_to(h->low[axis], -farthest, farthest) || !is_from_to(h->edge[axis], 0.0, farthest) ||
        !(h->edge[axis] > 0.0))
      return "the root's cell is out of range";
    if (!is_from_to(h->box_low[axis], -farthest, farthest) ||
        !is_from_to(h->box_high[axis], h->box_low[axis], farthest))
      return "the box is out of range";
    if (!conic_is_finite(h->layout.scale[axis]) || h->layout.scale[axis] == 0.0 ||
        !conic_is_finite(h->layout.offset[axis]))
      return "a scale or offset is out of range";
  }
  if (!(h->spacing > 0.0) || !is_from_to(h->spacing, 0.0, farthest))
    return "the spacing is out of range";
  return h->n_points == 0 ? "it holds no point" : NULL;
}

/* --- JSON --- */

/* Of any such file. */
enum { MOST_BYTES = 1 << 24 };

int conic_hierarchy_is_named(const char *name, const char *file) {
  size_t n = conic_ranges_is_url(name) ? strcspn(name, "?#") : strlen(name), n_file = strlen(file);
  return n >= n_file && memcmp(name + n - n_file, file, n_file) == 0 && (n == n_file || name[n - n_file - 1] == '/');
}

conic_status conic_hierarchy_read_json(conic_hierarchy *hierarchy, conic_hierarchy_member *read, void *data) {
  uint64_t size = conic_ranges_size(hierarchy->ranges);
  unsigned char *bytes;
  conic_json json;
  char key[CONIC_JSON_KEY_ROOM];
  if (size > MOST_BYTES)
    return conic_hierarchy_wrong(hierarchy, "the file is too large");
  conic_status status = conic_hierarchy_read(hierarchy, (size_t)size, &bytes);
  if (status == CONIC_OK)
    status = conic_json_take(hierarchy->context, hierarchy->name, bytes, (size_t)size, &json);
  conic_memory_release(hierarchy->context, bytes);
  if (status != CONIC_OK)
    return status;
  status = conic_json_begin_object(&json);
  while (status == CONIC_OK && conic_json_next_member(&json, key))
    status = read(hierarchy, &json, key, data);
  if (status == CONIC_OK)
    status = conic_json_end(&json);
  conic_json_close(&json);
  return status;
}

conic_status conic_hierarchy_numbers(conic_json *json, double *values, size_t n) {
  size_t n_read = 0;
  conic_status status = conic_json_numbers(json, values, n, &n_read);
  return status == CONIC_OK && n_read != n ? conic_json_wrong(json, "not as many numbers as there should be") : status;
}

conic_status conic_hierarchy_count(conic_json *json, uint64_t most, uint64_t *count) {
  double value = 0.0;
  conic_status status = conic_json_number(json, &value);
  *count = 0;
  if (status != CONIC_OK)
    return status;
  if (!(value >= 0.0 && value <= (double)most) || value != (double)(uint64_t)value)
    return conic_json_wrong(json, "no number of something");
  *count = (uint64_t)value;
  return CONIC_OK;
}

/* --- points in records --- */

int conic_point_field_is_good(const conic_point_field *field) {
  int n = field->n_bytes;
  if (field->type == 'f')
    return n == 4 || n == 8;
  return (field->type == 'i' || field->type == 'u') && (n == 1 || n == 2 || n == 4 || n == 8);
}

int conic_point_layout_has_colors(const conic_point_layout *layout) {
  return layout->intensity.n_bytes > 0 ||
         (layout->color[0].n_bytes > 0 && layout->color[1].n_bytes > 0 && layout->color[2].n_bytes > 0);
}

static double field_number(const unsigned char *record, const conic_point_field *field) {
  uint64_t bits = conic_load_bits(record + field->at, field->n_bytes);
  if (field->type == 'u')
    return (double)bits;
  if (field->type == 'i') {
    uint64_t sign = UINT64_C(1) << (8 * field->n_bytes - 1);
    return bits & sign ? -(double)((sign << 1) - bits) : (double)bits; /* of 8 bytes, sign << 1 is 0, and so it is */
  }
  return field->n_bytes == 4 ? (double)conic_float_of_bits((uint32_t)bits) : conic_double_of_bits(bits);
}

/* What is no number of 16 bits becomes the nearest. */
static uint16_t color_code_of(double value) {
  return value > 0.0 ? value < 65535.0 ? (uint16_t)value : UINT16_MAX : 0;
}

void conic_point_layout_take(const conic_point_layout *layout, const unsigned char *records,
                             conic_hierarchy_points *points) {
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < points->n; i++)
      points->position[axis][i] =
          field_number(records + i * layout->n_bytes, &layout->position[axis]) * layout->scale[axis] +
          layout->offset[axis];
  conic_point_layout_take_colors(layout, records, points);
}

void conic_point_layout_take_colors(const conic_point_layout *layout, const unsigned char *records,
                                    conic_hierarchy_points *points) {
  for (int channel = 0; channel < 3 && points->color[0]; channel++) {
    const conic_point_field *color = layout->color[0].n_bytes ? &layout->color[channel] : &layout->intensity;
    for (size_t i = 0; i < points->n; i++)
      points->color[channel][i] =
          color->n_bytes ? color_code_of(field_number(records + i * layout->n_bytes, color)) : UINT16_MAX;
  }
}

int conic_point_layout_of_las(unsigned format, uint32_t n_bytes, conic_point_layout *layout) {
  static const struct {
    uint8_t n_bytes, color;
  } formats[] = {{20, 0}, {28, 0},  {26, 20}, {34, 28}, {57, 0}, {63, 28},
                 {30, 0}, {36, 30}, {38, 30}, {59, 0},  {67, 30}};
  if (format >= sizeof formats / sizeof *formats || n_bytes < formats[format].n_bytes)
    return 0;
  memset(layout, 0, sizeof *layout);
  layout->n_bytes = n_bytes;
  layout->intensity = (conic_point_field){12, 2, 'u'};
  for (uint32_t axis = 0; axis < 3; axis++) {
    layout->position[axis] = (conic_point_field){4 * axis, 4, 'i'};
    if (formats[format].color)
      layout->color[axis] = (conic_point_field){formats[format].color + 2 * axis, 2, 'u'};
  }
  return 1;
}
