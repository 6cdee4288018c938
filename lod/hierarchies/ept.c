/* EPT (Entwine point tiles): ept.json, a file of JSON a page of the hierarchy, and a file a node. */

#include "core/files/zstd.h"
#include "lod/hierarchies/hierarchy.h"

typedef enum ept_packing { EPT_LASZIP, EPT_BINARY, EPT_ZSTANDARD, EPT_UNKNOWN } ept_packing;

static const char *const packing_names[] = {"laszip", "binary", "zstandard"};
static const char *const endings[] = {"laz", "bin", "zst"};

typedef struct ept_own {
  ept_packing packing;
} ept_own;

/* What one attribute of the schema says. */
typedef struct ept_dimension {
  char name[32], type[16];
  uint64_t n_bytes;
  double scale, offset;
} ept_dimension;

static int is_ept(const char *name, const unsigned char *head, size_t n_head) {
  (void)head;
  return n_head > 0 && conic_hierarchy_is_named(name, "ept.json");
}

static void place_dimension(conic_point_layout *layout, const ept_dimension *d) {
  static const char *const positions[] = {"X", "Y", "Z"}, *const colors[] = {"Red", "Green", "Blue"};
  conic_point_field field = {layout->n_bytes, (uint8_t)d->n_bytes, 'u'};
  field.type = strcmp(d->type, "signed") == 0 ? 'i' : strcmp(d->type, "float") == 0 ? 'f' : 'u';
  for (int axis = 0; axis < 3; axis++) {
    if (strcmp(d->name, positions[axis]) == 0) {
      layout->position[axis] = field;
      layout->scale[axis] = d->scale;
      layout->offset[axis] = d->offset;
    }
    if (strcmp(d->name, colors[axis]) == 0)
      layout->color[axis] = field;
  }
  if (strcmp(d->name, "Intensity") == 0)
    layout->intensity = field;
}

static conic_status read_dimension(conic_json *json, conic_point_layout *layout) {
  ept_dimension d = {.scale = 1.0};
  char key[CONIC_JSON_KEY_ROOM];
  conic_status status = conic_json_begin_object(json);
  while (status == CONIC_OK && conic_json_next_member(json, key)) {
    if (strcmp(key, "name") == 0)
      status = conic_json_text(json, d.name, sizeof d.name);
    else if (strcmp(key, "type") == 0)
      status = conic_json_text(json, d.type, sizeof d.type);
    else if (strcmp(key, "size") == 0)
      status = conic_hierarchy_count(json, 8, &d.n_bytes);
    else if (strcmp(key, "scale") == 0)
      status = conic_json_number(json, &d.scale);
    else if (strcmp(key, "offset") == 0)
      status = conic_json_number(json, &d.offset);
    else
      status = conic_json_skip(json);
  }
  if (json->status != CONIC_OK)
    return json->status;
  if (layout->n_bytes > 1 << 16)
    return conic_json_wrong(json, "a point is too long");
  place_dimension(layout, &d);
  layout->n_bytes += (uint32_t)d.n_bytes;
  return status;
}

static conic_status read_schema(conic_json *json, conic_point_layout *layout) {
  conic_status status = conic_json_begin_array(json);
  memset(layout, 0, sizeof *layout);
  while (status == CONIC_OK && conic_json_next_item(json))
    status = read_dimension(json, layout);
  return json->status;
}

static conic_status read_ept_packing(conic_json *json, ept_packing *packing) {
  char text[32] = "";
  conic_status status = conic_json_text(json, text, sizeof text);
  for (*packing = EPT_LASZIP; *packing < EPT_UNKNOWN && strcmp(text, packing_names[*packing]) != 0;)
    ++*packing;
  return status == CONIC_OK && *packing == EPT_UNKNOWN
             ? conic_json_wrong(json, "points that are packed so cannot be read; laszip, binary and zstandard can")
             : status;
}

typedef struct ept_head {
  double bounds[6], tight[6];
  uint64_t span;
  int has_bounds, has_tight;
} ept_head;

/* Which world it is in. What is said otherwise than expected says nothing. */
static conic_status read_reference(conic_hierarchy *h, conic_json *json) {
  const char *begin = json->next;
  char key[CONIC_JSON_KEY_ROOM], text[8192];
  unsigned epsg = 0;
  conic_json within;
  conic_status status = conic_json_skip(json);
  if (status == CONIC_OK)
    status = conic_json_take(h->context, h->name, begin, (size_t)(json->next - begin), &within);
  if (status != CONIC_OK)
    return status;
  within.is_silent = 1;
  conic_json_begin_object(&within);
  while (conic_json_next_member(&within, key)) {
    int is_code = strcmp(key, "horizontal") == 0;
    conic_json_text(&within, text, sizeof text);
    if (is_code || (strcmp(key, "wkt") == 0 && !epsg))
      epsg = is_code ? (unsigned)strtoul(text, NULL, 10) : conic_georeference_find_epsg(text, strlen(text));
  }
  conic_json_close(&within);
  conic_georeference_release(h->context, &h->reference);
  return epsg > 0 && epsg < 65536 ? conic_georeference_of_epsg(h->context, epsg, &h->reference) : CONIC_OK;
}

static conic_status read_member(conic_hierarchy *h, conic_json *json, const char *key, void *data) {
  ept_head *head = data;
  if (strcmp(key, "bounds") == 0) {
    head->has_bounds = 1;
    return conic_hierarchy_numbers(json, head->bounds, 6);
  }
  if (strcmp(key, "boundsConforming") == 0) {
    head->has_tight = 1;
    return conic_hierarchy_numbers(json, head->tight, 6);
  }
  if (strcmp(key, "span") == 0 || strcmp(key, "ticks") == 0)
    return conic_hierarchy_count(json, 1 << 20, &head->span);
  if (strcmp(key, "points") == 0)
    return conic_hierarchy_count(json, UINT64_C(1) << 53, &h->n_points);
  if (strcmp(key, "dataType") == 0)
    return read_ept_packing(json, &((ept_own *)h->own)->packing);
  if (strcmp(key, "schema") == 0)
    return read_schema(json, &h->layout);
  if (strcmp(key, "srs") == 0)
    return read_reference(h, json);
  return conic_json_skip(json);
}

static const char *take_head(conic_hierarchy *h, const ept_head *head) {
  const double *tight = head->has_tight ? head->tight : head->bounds;
  if (!head->has_bounds || head->span == 0)
    return "bounds or span are missing";
  for (int axis = 0; axis < 3; axis++) {
    h->low[axis] = head->bounds[axis];
    h->edge[axis] = head->bounds[3 + axis] - head->bounds[axis];
    h->box_low[axis] = tight[axis];
    h->box_high[axis] = tight[3 + axis];
    if (((ept_own *)h->own)->packing != EPT_LASZIP && !conic_point_field_is_good(&h->layout.position[axis]))
      return "the schema has no position that can be read";
    if (h->layout.color[axis].n_bytes && !conic_point_field_is_good(&h->layout.color[axis]))
      return "the schema has no colours that can be read";
  }
  if (h->layout.intensity.n_bytes && !conic_point_field_is_good(&h->layout.intensity))
    return "the schema has no intensity that can be read";
  if (!h->layout.color[1].n_bytes || !h->layout.color[2].n_bytes)
    h->layout.color[0].n_bytes = 0;
  h->spacing = h->edge[0] / (double)head->span;
  h->has_colors = conic_point_layout_has_colors(&h->layout);
  const conic_hierarchy_node root = {.is_page = 1};
  return conic_hierarchy_add(h, &root);
}

static conic_status open_ept(conic_hierarchy *h) {
  ept_head head;
  memset(&head, 0, sizeof head);
  ept_own *own = h->own = conic_memory_allocate_zeroed(h->context, 1, sizeof *own);
  if (!own)
    return CONIC_ERROR_MEMORY;
  own->packing = EPT_UNKNOWN;
  conic_status status = conic_hierarchy_read_json(h, read_member, &head);
  if (status != CONIC_OK)
    return status;
  const char *wrong = own->packing == EPT_UNKNOWN ? "it does not say how points are packed" : take_head(h, &head);
  return wrong ? conic_hierarchy_wrong(h, wrong) : CONIC_OK;
}

static void locate_ept(const conic_hierarchy *h, const conic_hierarchy_node *node, conic_range *range) {
  const ept_own *own = h->own;
  uint32_t cell[3];
  conic_hierarchy_cell(node, cell);
  range->offset = 0;
  range->n_bytes = node->is_page ? CONIC_HIERARCHY_PAGE_BYTES : (size_t)UINT32_MAX / 4;
  snprintf(range->file, sizeof range->file, "ept-%s/%u-%u-%u-%u.%s", node->is_page ? "hierarchy" : "data", node->level,
           cell[0], cell[1], cell[2], node->is_page ? "json" : endings[own->packing]);
}

/* "D-X-Y-Z" */
static int parse_cell(const char *text, uint32_t numbers[4]) {
  for (int i = 0; i < 4; i++) {
    uint32_t n_digits = 0;
    for (numbers[i] = 0; *text >= '0' && *text <= '9' && n_digits < 8; text++, n_digits++)
      numbers[i] = 10 * numbers[i] + (uint32_t)(*text - '0');
    if (n_digits == 0 || *text != (i < 3 ? '-' : '\0'))
      return 0;
    text++;
  }
  return 1;
}

static const char *take_ept_member(conic_hierarchy *h, conic_json *json, const char *name) {
  uint32_t numbers[4];
  double count = 0.0;
  conic_hierarchy_node node = {.is_page = 0};
  if (conic_json_number(json, &count) != CONIC_OK)
    return "its hierarchy is no list of nodes";
  if (!parse_cell(name, numbers) || !conic_hierarchy_key(numbers[0], numbers + 1, &node.key))
    return "its hierarchy names what is no node";
  node.level = (uint8_t)numbers[0];
  if (count == -1.0) {
    node.is_page = 1;
    return conic_hierarchy_add(h, &node);
  }
  if (!(count >= 0.0 && count <= (double)CONIC_HIERARCHY_NODE_POINTS) || count != (double)(uint32_t)count)
    return "its hierarchy counts what are no points";
  node.n_points = (uint32_t)count;
  return conic_hierarchy_add(h, &node);
}

static const char *take_ept_page(conic_hierarchy *h, const conic_hierarchy_node *page, const unsigned char *bytes,
                                 size_t n_bytes) {
  conic_json json;
  char key[CONIC_JSON_KEY_ROOM];
  const char *wrong = NULL;
  size_t first = h->n_nodes;
  int has_own = 0;
  if (n_bytes == 0 || conic_json_take(h->context, h->name, bytes, n_bytes, &json) != CONIC_OK)
    return "its hierarchy cannot be read";
  json.is_silent = 1;
  if (conic_json_begin_object(&json) != CONIC_OK)
    wrong = "its hierarchy is no JSON";
  while (!wrong && conic_json_next_member(&json, key))
    wrong = take_ept_member(h, &json, key);
  if (!wrong && conic_json_end(&json) != CONIC_OK)
    wrong = "its hierarchy is no JSON";
  conic_json_close(&json);
  for (size_t i = first; i < h->n_nodes; i++)
    has_own |= h->nodes[i].level == page->level;
  /* Writers leave out a node that has no points of its own, though it stands above others. */
  const conic_hierarchy_node empty = {.level = page->level, .key = page->key};
  return wrong || has_own || first == h->n_nodes ? wrong : conic_hierarchy_add(h, &empty);
}

static const char *unpack_zstandard(const conic_hierarchy *h, const unsigned char *bytes, size_t n_bytes,
                                    conic_hierarchy_points *points) {
  size_t n = points->n * h->layout.n_bytes;
  const char *wrong = "there is no memory for it";
  conic_zstd *zstd = NULL;
  unsigned char *records = conic_memory_allocate(h->context, n, 1);
  if (records && conic_zstd_create(h->context, &zstd) == CONIC_OK)
    wrong = conic_zstd_unpack(zstd, bytes, n_bytes, records, n)
                ? conic_hierarchy_take_records(h, records, n, points)
                : "its bytes are spoiled, or hold another number of points";
  conic_zstd_destroy(h->context, zstd);
  conic_memory_release(h->context, records);
  return wrong;
}

static const char *decode_ept(const conic_hierarchy *h, const conic_hierarchy_node *node, const unsigned char *bytes,
                              size_t n_bytes, conic_hierarchy_points *points) {
  const ept_own *own = h->own;
  (void)node;
  if (own->packing == EPT_BINARY)
    return conic_hierarchy_take_records(h, bytes, n_bytes, points);
  return own->packing == EPT_ZSTANDARD ? unpack_zstandard(h, bytes, n_bytes, points)
                                       : conic_hierarchy_take_laz(h->context, bytes, n_bytes, points);
}

const conic_hierarchy_kind conic_hierarchy_kind_ept = {.name = "ept",
                                                       .is_one = is_ept,
                                                       .open = open_ept,
                                                       .locate = locate_ept,
                                                       .take_page = take_ept_page,
                                                       .decode = decode_ept};
