#include "lod/layers/draw/layers_octree.h"

#include "lod/hierarchies/node_shape.h"
#include "lod/layers/format/layers_key.h"

/* Outlines, in distances of neighbours; and no sample's is larger than so many medians of its node's. */
static const float outline_in_spacings = 1.5f, most_medians = 4.0f;

/* Samples from above that lie between a node's own are drawn a little larger than those are on average. */
static const float among_others = 1.25f;

static const conic_hierarchy_node *node_of_entry(const conic_layers *layers, uint32_t entry) {
  return &layers->octree->hierarchy->nodes[layers->octree->node_of[entry]];
}

int conic_layers_octree_is_page(const conic_layers *layers, uint32_t entry) {
  const conic_layers_octree *o = layers->octree;
  return o && o->node_of[entry] != CONIC_NO_NODE && node_of_entry(layers, entry)->is_page;
}

uint64_t conic_layers_octree_received(const conic_layers *layers) {
  const conic_hierarchy *h = layers->octree ? layers->octree->hierarchy : NULL;
  return h && h->pages != h->ranges ? conic_ranges_received(h->pages) : 0;
}

void conic_layers_octree_locate(const conic_layers *layers, uint32_t entry, conic_range *range) {
  const conic_hierarchy *h = layers->octree->hierarchy;
  h->kind->locate(h, node_of_entry(layers, entry), range);
}

/* --- a node's points become a cloud --- */

static void release_node_points(conic_context *context, conic_hierarchy_points *points) {
  conic_memory_release_these(context, points->position[0], points->color[0]);
}

static conic_status allocate_node_points(conic_context *context, size_t n, int has_colors,
                                         conic_hierarchy_points *points) {
  memset(points, 0, sizeof *points);
  points->n = n;
  points->position[0] = conic_memory_allocate(context, 3 * n, sizeof(double));
  if (has_colors)
    points->color[0] = conic_memory_allocate(context, 3 * n, sizeof(uint16_t));
  if (!points->position[0] || (has_colors && !points->color[0])) {
    release_node_points(context, points);
    return CONIC_ERROR_MEMORY;
  }
  for (int i = 1; i < 3; i++) {
    points->position[i] = points->position[0] + (size_t)i * n;
    points->color[i] = has_colors ? points->color[0] + (size_t)i * n : NULL;
  }
  return CONIC_OK;
}

/* The steps of an axis that are a cell's: its points that lie a little outside are counted in. */
typedef struct cell_side {
  double low, step, least, most;
  uint32_t first, last;
} cell_side;

static cell_side cell_side_of(const conic_hierarchy *h, const conic_hierarchy_node *node, int axis) {
  int shift = CONIC_HIERARCHY_LEVELS - node->level;
  uint32_t cell[3];
  conic_hierarchy_cell(node, cell);
  cell_side side = {.low = h->low[axis], .step = h->edge[axis] / (double)(1 << CONIC_HIERARCHY_LEVELS)};
  double width = side.step * (double)(UINT32_C(1) << shift), slack = width * CONIC_OCTREE_SLACK;
  side.first = cell[axis] << shift;
  side.last = side.first + (UINT32_C(1) << shift) - 1;
  side.least = side.low + (double)cell[axis] * width - slack;
  side.most = side.least + width + 2.0 * slack;
  return side;
}

/* Keys of all points, in no order. 0 where one is not in its place. */
static int key_points(const conic_hierarchy *h, const conic_hierarchy_node *node, const conic_hierarchy_points *points,
                      conic_radix_item *items) {
  uint32_t step[3];
  cell_side sides[3];
  for (int axis = 0; axis < 3; axis++)
    sides[axis] = cell_side_of(h, node, axis);
  for (size_t i = 0; i < points->n; i++) {
    for (int axis = 0; axis < 3; axis++) {
      const cell_side *s = &sides[axis];
      double p = points->position[axis][i];
      if (!(p >= s->least && p <= s->most))
        return 0;
      double at = (p - s->low) / s->step;
      step[axis] = at > (double)s->first ? at < (double)s->last ? (uint32_t)at : s->last : s->first;
    }
    items[i] = (conic_radix_item){conic_layers_key(step[0], step[1], step[2]) - node->key, (uint32_t)i};
  }
  return 1;
}

static void sort_into_cloud(const conic_layers *layers, const conic_hierarchy_node *node,
                            const conic_hierarchy_points *points, const conic_radix_item *items,
                            conic_layers_cloud *cloud) {
  for (size_t i = 0; i < points->n; i++) {
    size_t from = items[i].value;
    cloud->keys[i] = node->key + items[i].key;
    for (int axis = 0; axis < 3; axis++) {
      cloud->position[axis][i] = (float)(points->position[axis][from] - layers->header.origin[axis]);
      if (cloud->color[0])
        cloud->color[axis][i] = (float)points->color[axis][from];
    }
  }
  for (int axis = 0; axis < 3 && cloud->color[0]; axis++)
    conic_raw_colors_apply(&layers->octree->colors, cloud->color[axis], points->n);
}

/* Normals and outlines by the neighbours. */
static conic_status shape_cloud(const conic_layers *layers, const conic_layers_entry *entry,
                                conic_layers_cloud *cloud) {
  const conic_hierarchy *h = layers->octree->hierarchy;
  double edge = h->edge[0] < h->edge[1] ? h->edge[0] : h->edge[1];
  edge = edge < h->edge[2] ? edge : h->edge[2];
  const conic_node_shape shape = {.keys = cloud->keys,
                                  .position = {cloud->position[0], cloud->position[1], cloud->position[2]},
                                  .n = cloud->count,
                                  .step = edge / (double)(1 << CONIC_HIERARCHY_LEVELS),
                                  .normal = {cloud->normal[0], cloud->normal[1], cloud->normal[2]},
                                  .spacing = cloud->outline};
  float median;
  conic_status status = conic_node_shape_find(layers->context, &shape, &median);
  if (!(median > 0.0f))
    median = entry->spacing;
  cloud->median_outline = outline_in_spacings * median;
  for (size_t i = 0; i < cloud->count && status == CONIC_OK; i++) {
    float spacing = cloud->outline[i] > 0.0f ? cloud->outline[i] : median;
    cloud->outline[i] = outline_in_spacings * (spacing < most_medians * median ? spacing : most_medians * median);
  }
  return status;
}

static const char *take_node_points(const conic_layers *layers, uint32_t entry, const conic_hierarchy_points *points,
                                    conic_layers_cloud *cloud) {
  const conic_hierarchy_node *node = node_of_entry(layers, entry);
  conic_context *context = layers->context;
  const char *wrong = NULL;
  conic_radix_item *items = conic_memory_allocate(context, points->n, sizeof *items);
  if (!items)
    return "there is no memory for it";
  if (!key_points(layers->octree->hierarchy, node, points, items))
    wrong = "a point of it is not in its place";
  else if (conic_radix_sort(context, items, points->n, 3 * (CONIC_HIERARCHY_LEVELS - node->level)) != CONIC_OK)
    wrong = "there is no memory for it";
  if (!wrong)
    sort_into_cloud(layers, node, points, items, cloud);
  conic_memory_release(context, items);
  if (!wrong && shape_cloud(layers, &layers->entries[entry], cloud) != CONIC_OK)
    wrong = "there is no memory for it";
  return wrong;
}

const char *conic_layers_octree_decode(const conic_layers *layers, uint32_t entry, const unsigned char *bytes,
                                       size_t n_bytes, conic_layers_cloud *cloud) {
  const conic_hierarchy *h = layers->octree->hierarchy;
  conic_hierarchy_points points;
  if (allocate_node_points(layers->context, cloud->count, cloud->color[0] != NULL, &points) != CONIC_OK)
    return "there is no memory for it";
  const char *wrong = h->kind->decode(h, node_of_entry(layers, entry), bytes, n_bytes, &points);
  if (!wrong)
    wrong = take_node_points(layers, entry, &points, cloud);
  release_node_points(layers->context, &points);
  return wrong;
}

/* --- what is kept of every cloud --- */

enum { GUIDE_BITS = 6, GUIDE_LEVELS = CONIC_HIERARCHY_LEVELS - 2 };

static size_t guide_part(uint64_t key, int level) {
  return (size_t)(key >> (3 * (CONIC_HIERARCHY_LEVELS - level) - GUIDE_BITS) & 63);
}

/* Sums of normals, each turned to the side of the part's first. */
static void sum_normals(const conic_layers_cloud *cloud, int level, float sums[64][3]) {
  for (size_t i = 0; i < cloud->count; i++) {
    float *sum = sums[guide_part(cloud->keys[i], level)], along = 0.0f;
    for (int axis = 0; axis < 3; axis++)
      along += sum[axis] * cloud->normal[axis][i];
    for (int axis = 0; axis < 3; axis++)
      sum[axis] += along < 0.0f ? -cloud->normal[axis][i] : cloud->normal[axis][i];
  }
}

static int part_distance2(uint32_t a, uint32_t b) {
  int sum = 0;
  for (int axis = 0; axis < 3; axis++) {
    int apart = (int)conic_layers_step(a, axis) - (int)conic_layers_step(b, axis);
    sum += apart * apart;
  }
  return sum;
}

static int round_guide(float share) {
  return (int)(share * 127.0f + (share < 0.0f ? -0.5f : 0.5f));
}

/* Takes for each part its own mean, or the nearest part's. Returns whether there is any. */
static int fill_guide(float sums[64][3], conic_layers_guide *guide) {
  int n_found = 0;
  for (uint32_t part = 0; part < 64; part++) {
    int nearest = 1 << 10;
    for (uint32_t other = 0; other < 64; other++) {
      const float *sum = sums[other];
      float length = sqrtf(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
      int distance = part_distance2(part, other);
      if (!(length > 0.0f) || distance >= nearest)
        continue;
      nearest = distance;
      n_found++;
      for (int axis = 0; axis < 3; axis++)
        guide->normal[part][axis] = (signed char)round_guide(sum[axis] / length);
    }
  }
  return n_found > 0;
}

conic_status conic_layers_octree_keep(conic_layers *layers, uint32_t entry, const conic_layers_cloud *cloud) {
  conic_layers_octree *o = layers->octree;
  uint32_t node = o->node_of[entry];
  float sums[64][3] = {{0.0f}};
  if (o->measured[node] > 0.0f)
    return CONIC_OK;
  o->measured[node] = cloud->median_outline;
  if (layers->entries[entry].level > GUIDE_LEVELS || layers->entries[entry].child == 0)
    return CONIC_OK;
  conic_layers_guide *guide = conic_memory_allocate_zeroed(layers->context, 1, sizeof *guide);
  if (!guide)
    return CONIC_ERROR_MEMORY;
  sum_normals(cloud, layers->entries[entry].level, sums);
  if (fill_guide(sums, guide))
    o->guides[node] = guide;
  else
    conic_memory_release(layers->context, guide);
  return CONIC_OK;
}

int conic_layers_octree_guess(const conic_layers *layers, uint32_t entry, uint64_t key, float normal[3]) {
  const conic_layers_octree *o = layers->octree;
  while (entry > 0) {
    entry = layers->entries[entry].parent;
    const conic_layers_guide *guide = o->node_of[entry] != CONIC_NO_NODE ? o->guides[o->node_of[entry]] : NULL;
    if (!guide)
      continue;
    const signed char *code = guide->normal[guide_part(key, layers->entries[entry].level)];
    float x = (float)code[0], y = (float)code[1], z = (float)code[2], length = sqrtf(x * x + y * y + z * z);
    normal[0] = x / length;
    normal[1] = y / length;
    normal[2] = z / length;
    return 1;
  }
  return 0;
}

/* --- sizes --- */

float conic_layers_octree_outline(const conic_layers *layers, uint32_t entry) {
  const conic_layers_octree *o = layers->octree;
  float least = layers->entries[entry].radius;
  for (uint32_t i = entry;; i = layers->entries[i].parent) {
    float own = o->node_of[i] != CONIC_NO_NODE ? among_others * o->measured[o->node_of[i]] : 0.0f;
    least = own > 0.0f && own < least ? own : least;
    if (i == 0)
      return least;
  }
}

conic_status conic_layers_octree_measure(conic_layers *layers, const unsigned char *needed) {
  const conic_layers_octree *o = layers->octree;
  conic_status status = CONIC_OK;
  uint32_t *clouds = conic_memory_allocate(layers->context, layers->header.n_clouds, sizeof *clouds);
  size_t n = 0;
  if (!clouds)
    return CONIC_ERROR_MEMORY;
  for (uint32_t i = 0; i < layers->header.n_clouds; i++)
    if (needed[i] && layers->entries[i].n_samples > 0 && !(o->measured[o->node_of[i]] > 0.0f))
      clouds[n++] = i;
  for (size_t done = 0; done < n && status == CONIC_OK;) {
    conic_layers_loading loading = {.clouds = clouds + done, .until_s = HUGE_VAL};
    loading.n = conic_layers_store_fit(layers, clouds + done, n - done, conic_layers_cache_bytes(layers) / 2);
    status = conic_layers_store_load(layers, &loading);
    if (status == CONIC_OK)
      conic_layers_store_unpin(layers, &loading);
    done += loading.n;
  }
  conic_memory_release(layers->context, clouds);
  return status;
}

/* --- opening --- */

/* What the header of a .lpc would say. */
static void fill_header(conic_layers *layers) {
  const conic_hierarchy *h = layers->octree->hierarchy;
  conic_layers_header *header = &layers->header;
  double diagonal2 = 0.0;
  header->flags = CONIC_LAYERS_UNORIENTED;
  header->up[2] = 1.0f; /* they are of surveys */
  conic_layers_schema_add(&header->schema, CONIC_LAYERS_SIZE, "size", 0);
  header->n_samples = h->n_points;
  header->bits = CONIC_HIERARCHY_LEVELS;
  header->quantum = h->edge[0] / (double)(1 << CONIC_HIERARCHY_LEVELS);
  for (int axis = 0; axis < 3; axis++) {
    double side = h->box_high[axis] - h->box_low[axis];
    header->origin[axis] = h->low[axis];
    header->low[axis] = h->box_low[axis];
    header->high[axis] = h->box_high[axis];
    diagonal2 += side * side;
  }
  header->near_z = diagonal2 > 0.0 ? 1e-4 * sqrt(diagonal2) : 1e-4;
  header->spacing = h->spacing;
  header->splat_radius = (double)outline_in_spacings * h->spacing;
}

/* What the colours of some points are fractions of; where they mean nothing, there are none. */
static conic_status scale_colors(conic_layers *layers, const conic_hierarchy_points *points) {
  conic_raw_range range = {0.0f, 0, 0};
  conic_splats some;
  conic_status status = conic_splats_allocate(layers->context, points->n, CONIC_SPLATS_COLORS, &some);
  if (status != CONIC_OK)
    return status;
  for (int channel = 0; channel < 3; channel++)
    for (size_t i = 0; i < points->n; i++)
      some.color[channel][i] = (float)points->color[channel][i];
  conic_raw_colors_see(&some, &range);
  conic_splats_release(layers->context, &some);
  status = conic_raw_colors_scale(layers->context, &range, 0, &layers->octree->colors);
  if (layers->octree->colors.table) {
    layers->header.flags |= CONIC_LAYERS_COLORS;
    conic_layers_schema_add(&layers->header.schema, CONIC_LAYERS_COLOR, "color", 0);
  }
  return status;
}

/* How far apart the samples are that all nodes have together: as far as the first node's, if all lie on the same area.
 */
static void measure_scale(conic_layers *layers, uint32_t entry, float outline) {
  conic_layers_header *header = &layers->header;
  double share = (double)layers->entries[entry].n_samples / (double)header->n_samples;
  double spacing = (double)(outline / outline_in_spacings) * sqrt(share < 1.0 ? share : 1.0);
  layers->octree->root_spacing = entry == 0 ? outline / outline_in_spacings : 0.0f;
  header->spacing = spacing;
  header->splat_radius = (double)outline_in_spacings * spacing;
}

static conic_status measure_first_points(conic_layers *layers, uint32_t entry, const conic_hierarchy_points *points) {
  conic_layers_octree *o = layers->octree;
  conic_status status = points->color[0] ? scale_colors(layers, points) : CONIC_OK;
  if (status == CONIC_OK)
    status = conic_layers_store_allocate(layers, entry, &o->first_cloud);
  if (status != CONIC_OK)
    return status;
  o->first_node = o->node_of[entry];
  const char *wrong = take_node_points(layers, entry, points, o->first_cloud);
  if (!wrong)
    measure_scale(layers, entry, o->first_cloud->median_outline);
  return wrong ? conic_hierarchy_wrong(o->hierarchy, wrong) : CONIC_OK;
}

static conic_status unpack_first(conic_layers *layers, uint32_t entry, const unsigned char *bytes, size_t n_bytes) {
  const conic_hierarchy *h = layers->octree->hierarchy;
  conic_hierarchy_points points;
  size_t n = layers->entries[entry].n_samples;
  if (n / CONIC_HIERARCHY_POINTS_A_BYTE > n_bytes)
    return conic_hierarchy_wrong(h, "its bytes are too few for so many points");
  if (allocate_node_points(layers->context, n, h->has_colors, &points) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  const char *wrong = h->kind->decode(h, node_of_entry(layers, entry), bytes, n_bytes, &points);
  conic_status status = wrong ? conic_hierarchy_wrong(h, wrong) : measure_first_points(layers, entry, &points);
  release_node_points(layers->context, &points);
  return status;
}

/* Reads the first node that has points: what it shows of colours and distances holds for all. */
static conic_status measure_first(conic_layers *layers) {
  const conic_hierarchy *h = layers->octree->hierarchy;
  uint32_t entry = 0;
  unsigned char *bytes;
  size_t n_bytes;
  while (entry < layers->header.n_clouds && layers->entries[entry].n_samples == 0)
    entry++;
  if (entry == layers->header.n_clouds)
    return CONIC_OK;
  conic_range range = {.id = 0};
  conic_layers_octree_locate(layers, entry, &range);
  if (!conic_ranges_holds(layers->ranges, &range))
    return conic_hierarchy_wrong(h, "the first node's points lie outside the file");
  conic_status status = conic_ranges_read(layers->ranges, layers->name, &range, layers->until_s, &bytes, &n_bytes);
  if (status == CONIC_OK)
    status = unpack_first(layers, entry, bytes, n_bytes);
  conic_memory_release(layers->context, bytes);
  return status;
}

conic_layers_cloud *conic_layers_octree_take_first(conic_layers *layers, uint32_t entry) {
  conic_layers_octree *o = layers->octree;
  conic_layers_cloud *first = o->node_of[entry] == o->first_node ? o->first_cloud : NULL;
  o->first_cloud = first ? NULL : o->first_cloud;
  return first;
}

conic_status conic_layers_octree_open(conic_layers *layers, const conic_hierarchy_kind *kind) {
  conic_ranges_options options;
  conic_layers_octree *o = layers->octree = conic_memory_allocate_zeroed(layers->context, 1, sizeof *o);
  if (!o)
    return CONIC_ERROR_MEMORY;
  conic_layers_access_ranges(&layers->access, layers->until_s, &options);
  conic_ranges *ranges = layers->ranges;
  layers->ranges = NULL;
  conic_status status = conic_hierarchy_open(layers->context, kind, layers->name, ranges, &options, &o->hierarchy);
  if (status != CONIC_OK)
    return status;
  layers->ranges = o->hierarchy->ranges;
  fill_header(layers);
  conic_layers_expansion root = {.error_px = HUGE_VAL, .until_s = layers->until_s};
  status = conic_layers_octree_index(layers);
  if (status == CONIC_OK)
    status = conic_layers_octree_read_pages(layers, &(uint32_t){0}, 1, &root);
  if (status == CONIC_OK)
    status = conic_layers_octree_index(layers);
  if (status == CONIC_OK)
    status = measure_first(layers);
  return status == CONIC_OK ? conic_layers_octree_index(layers) : status; /* the outlines are known now */
}

void conic_layers_octree_close(conic_layers *layers) {
  conic_layers_octree *o = layers->octree;
  conic_hierarchy_close(o->hierarchy);
  conic_memory_release_these(layers->context, o->node_of, o->measured);
  for (size_t i = 0; o->guides && i < o->nodes_room[1]; i++)
    conic_memory_release(layers->context, o->guides[i]);
  conic_memory_release_these(layers->context, o->guides, o->is_lost, o->first_cloud, o->colors.table, o);
  layers->octree = NULL;
  layers->ranges = NULL;
}
