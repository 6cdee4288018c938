/* Potree 2: metadata.json, the hierarchy's pages in hierarchy.bin, and the points in octree.bin. */

#include "core/base/byte_order.h"
#include "core/files/unbrotli.h"
#include "lod/hierarchies/hierarchy.h"

enum { POTREE_RECORD = 22, POTREE_PROXY = 2 };

typedef struct potree_own {
  uint64_t first_page; /* its bytes */
  int is_packed, has_encoding;
  /* Where packed points have them: attribute after attribute, each of all points; bytes of a point in all before. */
  uint32_t packed_position, packed_color, packed_intensity, packed_bytes;
  int has_packed_color;
} potree_own;

static int is_potree(const char *name, const unsigned char *head, size_t n_head) {
  (void)head;
  return n_head > 0 && conic_hierarchy_is_named(name, "metadata.json");
}

typedef struct potree_attribute {
  char name[32], type[16];
  uint64_t n_bytes, n_elements;
} potree_attribute;

static char type_of_attribute(const char *name) {
  return name[0] == 'i' ? 'i' : name[0] == 'u' ? 'u' : 'f';
}

/* Adds an attribute behind those before. Packed, a position takes 16 bytes and a colour 8. */
static const char *place_attribute(conic_hierarchy *h, const potree_attribute *a) {
  potree_own *own = h->own;
  conic_point_layout *layout = &h->layout;
  int is_color = strcmp(a->name, "rgb") == 0 || strcmp(a->name, "rgba") == 0;
  uint32_t n_packed = (uint32_t)a->n_bytes, n_each = a->n_elements ? (uint32_t)(a->n_bytes / a->n_elements) : 0;
  if (a->n_bytes == 0 || layout->n_bytes > 1 << 16)
    return "an attribute is of no size, or a point is too long";
  if (strcmp(a->name, "position") == 0) {
    if (a->n_bytes != 12 || strcmp(a->type, "int32") != 0)
      return "positions are read as three numbers of int32 only";
    for (uint32_t axis = 0; axis < 3; axis++)
      layout->position[axis] = (conic_point_field){layout->n_bytes + 4 * axis, 4, 'i'};
    own->packed_position = own->packed_bytes;
    n_packed = 16;
  } else if (is_color) {
    if (a->n_elements < 3 || (n_each != 1 && n_each != 2) || type_of_attribute(a->type) != 'u')
      return "colours are read as numbers of uint16 or uint8 only";
    for (uint32_t channel = 0; channel < 3; channel++)
      layout->color[channel] = (conic_point_field){layout->n_bytes + n_each * channel, (uint8_t)n_each, 'u'};
    own->packed_color = own->packed_bytes;
    own->has_packed_color = 1;
    n_packed = 8;
  } else if (strcmp(a->name, "intensity") == 0 && a->n_elements == 1 && a->n_bytes <= 8) {
    const conic_point_field field = {layout->n_bytes, (uint8_t)a->n_bytes, type_of_attribute(a->type)};
    if (conic_point_field_is_good(&field))
      layout->intensity = field;
    own->packed_intensity = own->packed_bytes;
  }
  own->packed_bytes += n_packed;
  layout->n_bytes += (uint32_t)a->n_bytes;
  return NULL;
}

/* The numbers that come next; others are passed over. The box of positions is the points'. */
static conic_status read_potree_attribute(conic_hierarchy *h, conic_json *json) {
  potree_attribute a = {.n_elements = 1};
  char key[CONIC_JSON_KEY_ROOM];
  double low[3], high[3];
  size_t n_low = 0, n_high = 0;
  conic_status status = conic_json_begin_object(json);
  while (status == CONIC_OK && conic_json_next_member(json, key)) {
    if (strcmp(key, "name") == 0)
      status = conic_json_text(json, a.name, sizeof a.name);
    else if (strcmp(key, "type") == 0)
      status = conic_json_text(json, a.type, sizeof a.type);
    else if (strcmp(key, "size") == 0)
      status = conic_hierarchy_count(json, 1 << 16, &a.n_bytes);
    else if (strcmp(key, "numElements") == 0)
      status = conic_hierarchy_count(json, 1 << 16, &a.n_elements);
    else if (strcmp(key, "min") == 0)
      status = conic_json_numbers(json, low, 3, &n_low);
    else if (strcmp(key, "max") == 0)
      status = conic_json_numbers(json, high, 3, &n_high);
    else
      status = conic_json_skip(json);
  }
  if (json->status != CONIC_OK)
    return json->status;
  if (strcmp(a.name, "position") == 0 && n_low == 3 && n_high == 3) {
    memcpy(h->box_low, low, sizeof low);
    memcpy(h->box_high, high, sizeof high);
  }
  const char *wrong = place_attribute(h, &a);
  return wrong ? conic_json_wrong(json, wrong) : status;
}

static conic_status read_potree_attributes(conic_hierarchy *h, conic_json *json) {
  conic_status status = conic_json_begin_array(json);
  while (status == CONIC_OK && conic_json_next_item(json))
    status = read_potree_attribute(h, json);
  return json->status;
}

static conic_status read_page_sizes(conic_hierarchy *h, conic_json *json) {
  char key[CONIC_JSON_KEY_ROOM];
  conic_status status = conic_json_begin_object(json);
  while (status == CONIC_OK && conic_json_next_member(json, key))
    status = strcmp(key, "firstChunkSize") == 0
                 ? conic_hierarchy_count(json, CONIC_HIERARCHY_PAGE_BYTES, &((potree_own *)h->own)->first_page)
                 : conic_json_skip(json);
  return json->status;
}

static conic_status read_box(conic_hierarchy *h, conic_json *json) {
  char key[CONIC_JSON_KEY_ROOM];
  double high[3] = {NAN, NAN, NAN};
  conic_status status = conic_json_begin_object(json);
  while (status == CONIC_OK && conic_json_next_member(json, key)) {
    int is_low = strcmp(key, "min") == 0;
    status = is_low || strcmp(key, "max") == 0 ? conic_hierarchy_numbers(json, is_low ? h->low : high, 3)
                                               : conic_json_skip(json);
  }
  for (int axis = 0; axis < 3; axis++)
    h->edge[axis] = high[axis] - h->low[axis];
  return json->status;
}

static conic_status read_encoding(conic_hierarchy *h, conic_json *json) {
  potree_own *own = h->own;
  char text[32] = "";
  conic_status status = conic_json_text(json, text, sizeof text);
  own->is_packed = strcmp(text, "BROTLI") == 0;
  own->has_encoding = 1;
  return status == CONIC_OK && !own->is_packed && strcmp(text, "DEFAULT") != 0
             ? conic_json_wrong(json, "points of this encoding cannot be read; DEFAULT and BROTLI can")
             : status;
}

/* "EPSG:26910", well-known text, or what proj takes, which has no code. */
static conic_status read_projection(conic_hierarchy *h, conic_json *json) {
  char text[8192];
  conic_status status = conic_json_text(json, text, sizeof text);
  unsigned epsg = conic_georeference_find_epsg(text, strlen(text));
  if (status != CONIC_OK || epsg == 0)
    return status;
  conic_georeference_release(h->context, &h->reference);
  return conic_georeference_of_epsg(h->context, epsg, &h->reference);
}

static conic_status read_potree_member(conic_hierarchy *h, conic_json *json, const char *key, void *data) {
  (void)data;
  if (strcmp(key, "points") == 0)
    return conic_hierarchy_count(json, UINT64_C(1) << 53, &h->n_points);
  if (strcmp(key, "hierarchy") == 0)
    return read_page_sizes(h, json);
  if (strcmp(key, "offset") == 0)
    return conic_hierarchy_numbers(json, h->layout.offset, 3);
  if (strcmp(key, "scale") == 0)
    return conic_hierarchy_numbers(json, h->layout.scale, 3);
  if (strcmp(key, "spacing") == 0)
    return conic_json_number(json, &h->spacing);
  if (strcmp(key, "boundingBox") == 0)
    return read_box(h, json);
  if (strcmp(key, "encoding") == 0)
    return read_encoding(h, json);
  if (strcmp(key, "projection") == 0)
    return read_projection(h, json);
  return strcmp(key, "attributes") == 0 ? read_potree_attributes(h, json) : conic_json_skip(json);
}

static const char *what_of_metadata_is_wrong(const conic_hierarchy *h) {
  const potree_own *own = h->own;
  if (!own->has_encoding || own->first_page == 0)
    return "this is no metadata of Potree 2: encoding or hierarchy are missing";
  if (!h->layout.position[0].n_bytes)
    return "it has no attribute of positions";
  if (own->is_packed && !conic_unbrotli_is_there())
    return "its points are packed with Brotli, which this build is without";
  return NULL;
}

/* The box where no attribute tells is the cell. */
static void complete_box(conic_hierarchy *h) {
  int is_told = 0;
  for (int axis = 0; axis < 3; axis++)
    is_told |= h->box_low[axis] != 0.0 || h->box_high[axis] != 0.0;
  for (int axis = 0; axis < 3 && !is_told; axis++) {
    h->box_low[axis] = h->low[axis];
    h->box_high[axis] = h->low[axis] + h->edge[axis];
  }
}

static conic_status open_potree_file(const conic_hierarchy *h, const char *file, conic_ranges **ranges) {
  char *name;
  conic_status status = conic_ranges_name_beside(h->context, h->name, file, &name);
  if (status == CONIC_OK)
    status = conic_ranges_open(h->context, name, &h->access, ranges);
  conic_memory_release(h->context, name);
  return status;
}

static conic_status open_potree(conic_hierarchy *h) {
  conic_ranges *pages = NULL, *points = NULL;
  potree_own *own = h->own = conic_memory_allocate_zeroed(h->context, 1, sizeof *own);
  if (!own)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_hierarchy_read_json(h, read_potree_member, NULL);
  const char *wrong = status == CONIC_OK ? what_of_metadata_is_wrong(h) : NULL;
  if (wrong)
    status = conic_hierarchy_wrong(h, wrong);
  complete_box(h);
  if (status == CONIC_OK)
    status = open_potree_file(h, "hierarchy.bin", &pages);
  if (status == CONIC_OK)
    status = open_potree_file(h, "octree.bin", &points);
  if (status != CONIC_OK) {
    conic_ranges_close(pages);
    return status;
  }
  conic_ranges_close(h->ranges);
  h->pages = pages;
  h->ranges = points;
  h->has_colors = conic_point_layout_has_colors(&h->layout);
  const conic_hierarchy_node root = {.is_page = 1, .n_bytes = own->first_page};
  wrong = conic_hierarchy_add(h, &root);
  return wrong ? conic_hierarchy_wrong(h, wrong) : CONIC_OK;
}

static void locate_potree(const conic_hierarchy *h, const conic_hierarchy_node *node, conic_range *range) {
  (void)h;
  range->offset = node->offset;
  range->n_bytes = (size_t)node->n_bytes;
}

/* The nodes of a page follow each other by level; each says which children it has, and they come in its order. */
typedef struct potree_page {
  conic_hierarchy *hierarchy;
  size_t n_records, n_named;
  struct potree_name {
    uint64_t key;
    uint8_t level;
  } * names; /* of the records */
} potree_page;

static const char *name_children(potree_page *p, const struct potree_name *parent, unsigned mask) {
  for (uint64_t i = 0; i < 8; i++) {
    if (!(mask >> i & 1))
      continue;
    if (p->n_named == p->n_records)
      return "its page of the hierarchy has fewer nodes than it says";
    if (parent->level == CONIC_HIERARCHY_LEVELS)
      return "a node is too deep";
    int shift = 3 * (CONIC_HIERARCHY_LEVELS - 1 - parent->level);
    p->names[p->n_named++] = (struct potree_name){parent->key | i << shift, (uint8_t)(parent->level + 1)};
  }
  return NULL;
}

static const char *take_potree_record(potree_page *p, size_t i, const unsigned char *record) {
  const struct potree_name name = p->names[i];
  conic_hierarchy_node node = {.key = name.key,
                               .level = name.level,
                               .n_points = (uint32_t)conic_load_bits(record + 2, 4),
                               .offset = conic_load_bits(record + 6, 8),
                               .n_bytes = conic_load_bits(record + 14, 8)};
  if (record[0] > POTREE_PROXY)
    return "its page of the hierarchy has a node of no kind";
  node.is_page = record[0] == POTREE_PROXY;
  if (node.is_page || node.n_bytes == 0)
    node.n_points = 0;
  const char *wrong = conic_hierarchy_add(p->hierarchy, &node);
  return wrong || node.is_page ? wrong : name_children(p, &name, record[1]);
}

static const char *take_potree_page(conic_hierarchy *h, const conic_hierarchy_node *page, const unsigned char *bytes,
                                    size_t n_bytes) {
  const char *wrong = NULL;
  potree_page p = {.hierarchy = h, .n_records = n_bytes / POTREE_RECORD, .n_named = 1};
  if (n_bytes == 0 || n_bytes % POTREE_RECORD)
    return "its page of the hierarchy is of no whole number of nodes";
  p.names = conic_memory_allocate(h->context, p.n_records, sizeof *p.names);
  if (!p.names)
    return "there is no memory for it";
  p.names[0] = (struct potree_name){page->key, page->level};
  for (size_t i = 0; i < p.n_records && !wrong; i++)
    wrong = i < p.n_named ? take_potree_record(&p, i, bytes + i * POTREE_RECORD)
                          : "its page of the hierarchy has more nodes than it says";
  conic_memory_release(h->context, p.names);
  return wrong;
}

/* Every third bit of 48. */
static uint32_t third_bits(uint64_t code) {
  uint32_t value = 0;
  for (int i = 0; i < 16; i++)
    value |= (uint32_t)(code >> 3 * i & 1) << i;
  return value;
}

static double signed_of(uint32_t bits) {
  return bits >> 31 ? -(double)(~bits) - 1.0 : (double)bits;
}

/* Positions are two Morton codes of 48 bits, the upper halves first; colours one. */
static void take_planes(const conic_hierarchy *h, const unsigned char *planes, conic_hierarchy_points *points) {
  const potree_own *own = h->own;
  const unsigned char *position = planes + own->packed_position * points->n;
  const unsigned char *color = planes + own->packed_color * points->n;
  for (size_t i = 0; i < points->n; i++) {
    uint64_t upper = conic_load_bits(position + 16 * i, 8), lower = conic_load_bits(position + 16 * i + 8, 8);
    for (int axis = 0; axis < 3; axis++)
      points->position[axis][i] =
          signed_of(third_bits(upper >> axis) << 16 | third_bits(lower >> axis)) * h->layout.scale[axis] +
          h->layout.offset[axis];
  }
  for (int channel = 0; channel < 3 && points->color[0] && own->has_packed_color; channel++)
    for (size_t i = 0; i < points->n; i++)
      points->color[channel][i] = (uint16_t)third_bits(conic_load_bits(color + 8 * i, 8) >> channel);
}

/* Intensities stand in a plane of their own, as records of nothing else. */
static void take_intensities(const conic_hierarchy *h, const unsigned char *planes, conic_hierarchy_points *points) {
  const potree_own *own = h->own;
  conic_point_layout layout = {.n_bytes = h->layout.intensity.n_bytes, .intensity = h->layout.intensity};
  layout.intensity.at = 0;
  if (points->color[0] && !own->has_packed_color)
    conic_point_layout_take_colors(&layout, planes + own->packed_intensity * points->n, points);
}

static const char *decode_potree(const conic_hierarchy *h, const conic_hierarchy_node *node, const unsigned char *bytes,
                                 size_t n_bytes, conic_hierarchy_points *points) {
  const potree_own *own = h->own;
  size_t n = points->n * own->packed_bytes;
  (void)node;
  if (!own->is_packed)
    return conic_hierarchy_take_records(h, bytes, n_bytes, points);
  unsigned char *planes = conic_memory_allocate(h->context, n, 1);
  if (!planes)
    return "there is no memory for it";
  const char *wrong = conic_unbrotli(h->context, bytes, n_bytes, planes, n)
                          ? NULL
                          : "its bytes are spoiled, or hold another number of points";
  if (!wrong) {
    take_planes(h, planes, points);
    take_intensities(h, planes, points);
  }
  conic_memory_release(h->context, planes);
  return wrong;
}

const conic_hierarchy_kind conic_hierarchy_kind_potree = {.name = "potree",
                                                          .is_one = is_potree,
                                                          .open = open_potree,
                                                          .locate = locate_potree,
                                                          .take_page = take_potree_page,
                                                          .decode = decode_potree};
