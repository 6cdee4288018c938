/* Whether a file's clouds are whole, and every sample of every node within the bounds that the index states. On the way
 * down from the root, each node keeps what is drawn in its place. All samples of a leaf's place are held against every
 * node above it. So memory does not grow with the file. */

#include "conic/layers.h"
#include "lod/layers/format/layers_decode.h"

/* A sample as it would be drawn. */
typedef struct drawn_sample {
  uint64_t key;
  float position[3], normal[3];
} drawn_sample;

/* What is drawn in a node's place, and which of the node's bounds have been found broken. */
typedef struct stage {
  const conic_layers_entry *entry;
  size_t n;
  drawn_sample *samples;
  uint32_t *first, *next; /* chains of samples by the hash of their cell, which is as wide as the covering radius */
  size_t n_cells;
  int is_bare, is_outside, is_turned;
} stage;

typedef struct layers_checking {
  conic_context *context;
  const conic_layers_file *file;
  conic_layers_decoder *decoder;
  conic_layers_header header;      /* of stand-ins */
  conic_layers_decoder *stand_ins; /* null: there are none */
  conic_layers_defects *defects;
  uint64_t n_seen;
  int n_stages;
  stage stages[CONIC_LAYERS_MOST_LEVELS];
} layers_checking;

#define NO_SAMPLE UINT32_MAX

static void cell_of(const stage *s, const float position[3], int64_t cell[3]) {
  double edge = (double)s->entry->covering > 0.0 ? (double)s->entry->covering : 1.0;
  for (int axis = 0; axis < 3; axis++) {
    double scaled = floor((double)position[axis] / edge);
    cell[axis] = scaled < 1e18 ? (int64_t)scaled : INT64_C(1000000000000000000);
  }
}

static uint32_t *chain_at(const stage *s, int64_t x, int64_t y, int64_t z) {
  uint64_t mixed = (uint64_t)x * UINT64_C(0x9e3779b97f4a7c15) ^ (uint64_t)y * UINT64_C(0xc2b2ae3d27d4eb4f) ^
                   (uint64_t)z * UINT64_C(0x165667b19e3779f9);
  return &s->first[(mixed ^ mixed >> 32) & (s->n_cells - 1)];
}

static void fill_cells(stage *s) {
  memset(s->first, 0xff, s->n_cells * sizeof *s->first);
  for (uint32_t i = 0; i < s->n; i++) {
    int64_t cell[3];
    cell_of(s, s->samples[i].position, cell);
    uint32_t *chain = chain_at(s, cell[0], cell[1], cell[2]);
    s->next[i] = *chain;
    *chain = i;
  }
}

static int is_near(const stage *s, uint32_t chain, const float position[3]) {
  double limit2 = (double)s->entry->covering * (double)s->entry->covering;
  for (; chain != NO_SAMPLE; chain = s->next[chain]) {
    const float *other = s->samples[chain].position;
    double x = (double)position[0] - (double)other[0], y = (double)position[1] - (double)other[1],
           z = (double)position[2] - (double)other[2];
    if (x * x + y * y + z * z <= limit2)
      return 1;
  }
  return 0;
}

/* Whether something that is drawn is within the covering radius: in its own cell, or in those about it. */
static int is_covered(const stage *s, const float position[3]) {
  int64_t cell[3];
  cell_of(s, position, cell);
  if (is_near(s, *chain_at(s, cell[0], cell[1], cell[2]), position))
    return 1;
  for (int i = 0; i < 27; i++)
    if (i != 13 &&
        is_near(s, *chain_at(s, cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1), position))
      return 1;
  return 0;
}

static int is_inside(const conic_layers_entry *entry, const float position[3]) {
  double x = (double)position[0] - (double)entry->center[0], y = (double)position[1] - (double)entry->center[1],
         z = (double)position[2] - (double)entry->center[2];
  return sqrt(x * x + y * y + z * z) + (double)entry->radius <= (double)entry->sphere;
}

static int is_facing(const conic_layers_entry *entry, const float normal[3]) {
  double cosine = 0.0;
  for (int axis = 0; axis < 3; axis++)
    cosine += (double)normal[axis] * (double)entry->axis[axis];
  return entry->cone <= -1.0f || cosine >= (double)entry->cone;
}

/* All that is in a leaf's place, against one of the nodes whose place it is too. */
static void hold_against(const stage *leaf, stage *above) {
  for (size_t i = 0; i < leaf->n; i++) {
    const drawn_sample *one = &leaf->samples[i];
    above->is_bare = above->is_bare || !is_covered(above, one->position);
    above->is_outside = above->is_outside || !is_inside(above->entry, one->position);
    above->is_turned = above->is_turned || !is_facing(above->entry, one->normal);
  }
}

static void release_stage(conic_context *context, stage *s) {
  conic_memory_release_these(context, s->samples, s->first, s->next);
  memset(s, 0, sizeof *s);
}

static void append_cloud(const conic_layers_cloud *cloud, stage *s) {
  for (size_t i = 0; i < cloud->count; i++) {
    drawn_sample *to = &s->samples[s->n++];
    to->key = cloud->keys[i];
    for (int axis = 0; axis < 3; axis++) {
      to->position[axis] = cloud->position[axis][i];
      to->normal[axis] = cloud->normal[axis][i];
    }
  }
}

/* What the nodes above draw in this place. */
static void append_inherited(const layers_checking *c, const stage *above, stage *s) {
  uint64_t last = conic_layers_last_key(&c->file->header, s->entry);
  for (size_t i = 0; i < above->n; i++)
    if (above->samples[i].key >= s->entry->key && above->samples[i].key <= last)
      s->samples[s->n++] = above->samples[i];
}

/* Decodes a cloud to the stage's end; says what is wrong with it, or null. */
static conic_status append_decoded(const layers_checking *c, const conic_layers_header *header,
                                   conic_layers_decoder *decoder, const conic_layers_entry *entry, stage *s,
                                   const char **wrong) {
  conic_layers_cloud cloud;
  void *block = conic_memory_allocate(c->context, conic_layers_cloud_bytes(header, entry, NULL), 1);
  if (!block)
    return CONIC_ERROR_MEMORY;
  conic_layers_cloud_place(header, entry, NULL, block, &cloud);
  *wrong = conic_layers_decode(decoder, entry, c->file->mapping.bytes + entry->offset, &cloud);
  if (!*wrong)
    append_cloud(&cloud, s);
  conic_memory_release(c->context, block);
  return CONIC_OK;
}

static conic_status make_stage(const layers_checking *c, const stage *above, const conic_layers_entry *entry,
                               stage *s) {
  size_t room = (above ? above->n : 0) + entry->n_samples;
  memset(s, 0, sizeof *s);
  s->entry = entry;
  for (s->n_cells = 64; s->n_cells < room; s->n_cells *= 2)
    continue;
  return conic_memory_allocate_these(c->context, CONIC_ROOM(s->samples, room), CONIC_ROOM(s->next, room),
                                     CONIC_ROOM(s->first, s->n_cells));
}

static void tell_wrong(const layers_checking *c, uint32_t i_node, const char *wrong, uint64_t offset) {
  conic_log(c->context, CONIC_LOG_WARNING, "%s: cloud %u: %s (at byte %llu)", c->file->name, i_node, wrong,
            (unsigned long long)offset);
  c->defects->clouds++;
}

/* Coincident samples that have been parted have one place. */
static int is_parted(const layers_checking *c, const conic_layers_entry *entry) {
  return entry->depth == 3 * c->file->header.bits;
}

static conic_status check_layers_node(layers_checking *c, uint32_t i_node);

static conic_status check_below(layers_checking *c, stage *s, const char *wrong, uint32_t i_node) {
  const conic_layers_entry *entry = s->entry;
  conic_status status = CONIC_OK;
  if (!wrong && s->n != entry->n_drawn && !is_parted(c, entry))
    wrong = "what is drawn in its place is not as much as it says";
  if (wrong)
    tell_wrong(c, i_node, wrong, entry->offset);
  fill_cells(s);
  if (entry->child == 0)
    for (int i = 0; i < c->n_stages; i++)
      hold_against(s, &c->stages[i]);
  for (uint32_t k = 0; k < 2 && entry->child != 0 && status == CONIC_OK; k++)
    status = check_layers_node(c, entry->child + k);
  c->defects->coverage += s->is_bare != 0;
  c->defects->spheres += s->is_outside != 0;
  c->defects->cones += s->is_turned != 0;
  return status;
}

/* A node's stand-ins against their own bounds. What is broken of these counts as if the node's were. */
static conic_status check_stand_ins(const layers_checking *c, uint32_t i_node, stage *of_node) {
  const conic_layers_entry *entry = &c->file->entries[c->file->header.n_clouds + i_node];
  const char *wrong = NULL;
  stage s;
  if (!c->stand_ins || entry->n_samples == 0)
    return CONIC_OK;
  conic_status status = make_stage(c, NULL, entry, &s);
  if (status == CONIC_OK)
    status = append_decoded(c, &c->header, c->stand_ins, entry, &s, &wrong);
  if (wrong)
    tell_wrong(c, i_node, wrong, entry->offset);
  for (size_t k = 0; k < s.n && status == CONIC_OK; k++) {
    of_node->is_outside = of_node->is_outside || !is_inside(entry, s.samples[k].position);
    of_node->is_turned = of_node->is_turned || !is_facing(entry, s.samples[k].normal);
  }
  release_stage(c->context, &s);
  return status;
}

static conic_status check_layers_node(layers_checking *c, uint32_t i_node) {
  const conic_layers_entry *entry = &c->file->entries[i_node];
  const stage *above = c->n_stages ? &c->stages[c->n_stages - 1] : NULL;
  stage *s = &c->stages[c->n_stages];
  const char *wrong = NULL;
  conic_status status = make_stage(c, above, entry, s);
  if (status == CONIC_OK) {
    c->n_stages++;
    if (above)
      append_inherited(c, above, s);
    status = append_decoded(c, &c->file->header, c->decoder, entry, s, &wrong);
    if (status == CONIC_OK)
      status = check_stand_ins(c, i_node, s);
    if (status == CONIC_OK)
      status = check_below(c, s, wrong, i_node);
    c->n_stages--;
  }
  release_stage(c->context, s);
  c->n_seen += entry->n_samples;
  if (status == CONIC_OK)
    status = conic_progress(c->context, "check", (double)c->n_seen / (double)c->file->header.n_samples);
  return status;
}

conic_status conic_layers_check(conic_context *context, const char *path, conic_layers_defects *defects) {
  conic_layers_file file;
  memset(defects, 0, sizeof *defects);
  conic_status status = conic_layers_file_open(context, path, &file);
  if (status != CONIC_OK)
    return status;
  layers_checking *c = conic_memory_allocate_zeroed(context, 1, sizeof *c);
  status = c ? conic_layers_decoder_create(context, &file.header, NULL, &c->decoder) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    c->context = context;
    c->file = &file;
    c->defects = defects;
    c->header = file.header;
    if (file.header.version >= 3 &&
        conic_layers_stand_in_schema(&file.header.schema, file.header.quantum, &c->header.schema))
      status = conic_layers_decoder_create(context, &c->header, NULL, &c->stand_ins);
  }
  if (status == CONIC_OK)
    status = check_layers_node(c, 0);
  if (c) {
    conic_layers_decoder_destroy(c->stand_ins);
    conic_layers_decoder_destroy(c->decoder);
  }
  conic_memory_release(context, c);
  conic_layers_file_close(&file);
  return status;
}
