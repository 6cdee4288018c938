#include "lod/layers/build/layers_stand_ins.h"

#include "core/base/color.h"
#include "core/base/heap.h"
#include "core/base/vectors.h"
#include "lod/layers/format/layers_axes.h"
#include "lod/layers/format/layers_key.h"

/* How many samples a stand-in stands for. */
enum { SAMPLES_A_STAND_IN = 16 };

/* Circles overlap. So a sample counts as if it were smaller than what it stands for, and no circle has to hold all of
 * its samples. */
static const double share_of_covering = 0.6, share_of_hold = 0.95;

typedef struct disc_member {
  float at[3], normal[3]; /* all lengths are in steps */
  float own, drawn;       /* what full resolution surely draws of it, and where the node's samples are drawn */
  float radius;           /* of what it counts as here */
  uint32_t i;
} disc_member;

/* Members that follow each other. */
typedef struct member_group {
  size_t begin, end;
  double limit; /* up to which, on the axis along which they spread most, they are on the first side */
  int axis;
} member_group;

typedef struct circle {
  double at[3], normal[3], radius, color[3];
} circle;

struct conic_layers_standing {
  conic_layers_schema schema;
  conic_layers_coder *coder;
  conic_layers_disc_loops loops;
  disc_member *members;
  conic_layers_disc *discs; /* of a group */
  member_group *groups;
  conic_heap heap; /* of groups, by how far they reach */
  uint32_t *slots;
  double *keys;
  size_t n_groups, most_groups;
  unsigned char *records; /* of both */
  float colors[256], thresholds[255];
};

static size_t most_stand_ins(const conic_layers_plan *plan) {
  return conic_layers_most_in_leaf(plan) / SAMPLES_A_STAND_IN + 1;
}

size_t conic_layers_standing_bytes(const conic_layers_plan *plan) {
  return conic_layers_most_in_leaf(plan) * (sizeof(disc_member) + sizeof(conic_layers_disc)) +
         most_stand_ins(plan) * (sizeof(member_group) + 16 + 4 * sizeof(conic_layers_sample));
}

conic_status conic_layers_standing_create(const conic_layers_plan *plan, conic_layers_standing **standing) {
  conic_context *context = plan->context;
  conic_layers_schema schema;
  conic_isa isa;
  *standing = NULL;
  if (!conic_layers_stand_in_schema(plan->schema, plan->quantum, &schema))
    return CONIC_OK;
  conic_status status = conic_isa_choose(context, CONIC_ISA_AUTO, &isa);
  if (status != CONIC_OK)
    return status;
  conic_layers_standing *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->schema = schema;
  made->most_groups = most_stand_ins(plan);
  conic_srgb_decode_table(made->colors);
  conic_srgb_thresholds(made->thresholds);
  conic_layers_disc_loops_init(&made->loops, isa);
  status = conic_layers_coder_create(context, made->most_groups, &schema, NULL, &made->coder);
  if (status == CONIC_OK)
    status = conic_memory_allocate_these(
        context, CONIC_ROOM(made->members, conic_layers_most_in_leaf(plan)),
        CONIC_ROOM(made->discs, conic_layers_most_in_leaf(plan)), CONIC_ROOM(made->groups, made->most_groups),
        CONIC_ROOM(made->slots, made->most_groups), CONIC_ROOM(made->keys, made->most_groups));
  made->records = conic_memory_allocate(context, 2 * made->most_groups, schema.sample_bytes);
  if (status == CONIC_OK && made->records)
    *standing = made;
  else
    conic_layers_standing_destroy(context, made);
  return *standing ? CONIC_OK : status == CONIC_OK ? CONIC_ERROR_MEMORY : status;
}

void conic_layers_standing_destroy(conic_context *context, conic_layers_standing *standing) {
  if (!standing)
    return;
  conic_layers_coder_destroy(standing->coder);
  conic_memory_release_these(context, standing->members, standing->discs, standing->groups, standing->slots,
                             standing->keys, standing->records, standing);
}

/* --- parting --- */

/* How far members reach, squared, and more where their normals differ. They are parted in the middle of the axis along
 * which they reach farthest. */
static double measure_members(const conic_layers_standing *s, member_group *g) {
  double most = 0.0, spread = 0.0, normal[3] = {0.0, 0.0, 0.0}, n = (double)(g->end - g->begin);
  for (int axis = 0; axis < 3; axis++) {
    float low = s->members[g->begin].at[axis], high = low;
    for (size_t i = g->begin; i < g->end; i++) {
      const disc_member *m = &s->members[i];
      low = m->at[axis] < low ? m->at[axis] : low;
      high = m->at[axis] > high ? m->at[axis] : high;
      normal[axis] += (double)m->normal[axis];
    }
    double range = (double)(high - low);
    spread += range * range;
    if (!(range > most))
      continue;
    most = range;
    g->axis = axis;
    g->limit = (double)low + 0.5 * range;
  }
  return spread * (3.0 - 2.0 * conic_dot(normal, normal) / (n * n));
}

static void push_group(conic_layers_standing *s, size_t i) {
  s->keys[i] = -measure_members(s, &s->groups[i]);
  conic_heap_push(&s->heap, (uint32_t)i);
}

/* Parts the group that reaches farthest until there are so many or the members of each coincide. */
static void part_members(conic_layers_standing *s, size_t n_members, size_t n_groups) {
  s->heap = (conic_heap){0, s->slots, s->keys};
  s->groups[0] = (member_group){.begin = 0, .end = n_members};
  push_group(s, 0);
  for (s->n_groups = 1; s->n_groups < n_groups && s->keys[s->slots[0]] < 0.0; s->n_groups++) {
    size_t i_group = conic_heap_pop(&s->heap);
    member_group *first = &s->groups[i_group], *second = &s->groups[s->n_groups];
    size_t at = first->begin;
    for (size_t i = first->begin; i < first->end; i++)
      if ((double)s->members[i].at[first->axis] <= first->limit) {
        disc_member held = s->members[at];
        s->members[at++] = s->members[i];
        s->members[i] = held;
      }
    *second = (member_group){.begin = at, .end = first->end};
    first->end = at;
    push_group(s, i_group);
    push_group(s, s->n_groups);
  }
}

/* --- circles --- */

/* Means are weighed by area. Normals without a side, and those that would cancel, count as if they were on the side of
 * the first. */
static void find_means(const conic_layers_standing *s, const conic_layers_plan *plan, const unsigned char *samples,
                       const member_group *g, int turns, circle *c) {
  const disc_member *first = &s->members[g->begin];
  double weight = 0.0;
  memset(c, 0, sizeof *c);
  for (size_t i = g->begin; i < g->end; i++) {
    const disc_member *m = &s->members[i];
    const uint8_t *color = conic_layers_sample_at(samples, plan->sample_bytes, m->i)->color;
    double w = (double)m->radius * (double)m->radius + 1e-30, side;
    float along = 0.0f;
    for (int axis = 0; axis < 3 && turns; axis++)
      along += m->normal[axis] * first->normal[axis];
    side = along < 0.0f ? -w : w;
    weight += w;
    for (int axis = 0; axis < 3; axis++) {
      c->at[axis] += w * (double)(m->at[axis] - first->at[axis]);
      c->normal[axis] += side * (double)m->normal[axis];
      c->color[axis] += w * (double)s->colors[color[axis]];
    }
  }
  for (int axis = 0; axis < 3; axis++) {
    c->at[axis] = (double)first->at[axis] + c->at[axis] / weight;
    c->color[axis] /= weight;
  }
  if (!turns && conic_length(c->normal) < 0.1 * weight)
    find_means(s, plan, samples, g, 1, c);
}

/* Codes what a circle has but for its size, more coarsely than a sample's; it becomes what is read. */
static void code_means(const conic_layers_standing *s, circle *c, conic_layers_sample *record) {
  uint32_t steps[3];
  float normal[3];
  const double length = conic_length(c->normal), scale = length < 1e30 ? 1.0 : 1.0 / length; /* floats end soon after */
  for (int axis = 0; axis < 3; axis++) {
    steps[axis] = (uint32_t)(c->at[axis] + 0.5);
    c->at[axis] = (double)steps[axis];
    normal[axis] = (float)(c->normal[axis] * scale);
    record->color[axis] = (uint8_t)((conic_srgb_code(s->thresholds, (float)c->color[axis]) & ~3) | 2);
  }
  record->key = conic_layers_key(steps[0], steps[1], steps[2]);
  conic_layers_code_normal(normal, record->normal);
  for (int k = 0; k < 2; k++)
    record->normal[k] = record->normal[k] < 254 ? record->normal[k] | 1 : 253;
  conic_layers_normal_of(record->normal, normal);
  for (int axis = 0; axis < 3; axis++)
    c->normal[axis] = (double)normal[axis];
}

static void code_size(const conic_layers_standing *s, double quantum, const member_group *g, circle *c,
                      conic_layers_sample *record) {
  const conic_layers_attribute *sizes = &s->schema.list[conic_layers_schema_find(&s->schema, CONIC_LAYERS_SIZE)];
  double way[3], hold = 0.0;
  for (size_t i = g->begin; i < g->end; i++) {
    for (int axis = 0; axis < 3; axis++)
      way[axis] = (double)s->members[i].at[axis] - c->at[axis];
    double reach = conic_length(way) + (double)s->members[i].radius;
    hold = reach > hold ? reach : hold;
  }
  record->size = conic_layers_size_as_read(sizes, conic_layers_code_size((float)(share_of_hold * hold * quantum)));
  c->radius = (double)conic_layers_size_of(record->size) / quantum;
}

/* --- how far off they are --- */

static conic_layers_disc disc_of_circle(const circle *c) {
  conic_layers_disc disc = {.radius = (float)c->radius};
  for (int axis = 0; axis < 3; axis++) {
    disc.center[axis] = (float)c->at[axis];
    disc.normal[axis] = (float)c->normal[axis];
  }
  return disc;
}

static conic_layers_disc disc_of_member(const disc_member *m, float radius) {
  conic_layers_disc disc = {.radius = radius};
  memcpy(disc.center, m->at, sizeof disc.center);
  memcpy(disc.normal, m->normal, sizeof disc.normal);
  return disc;
}

/* How far the circle is from what full resolution draws of the members, and what is drawn of these from the circle; or
 * what is known of others, where that is more. */
static void measure_circle(const conic_layers_standing *s, const member_group *g, const circle *c, float *past,
                           float *off) {
  const conic_layers_disc disc = disc_of_circle(c);
  for (size_t i = g->begin; i < g->end; i++)
    s->discs[i - g->begin] = disc_of_member(&s->members[i], s->members[i].own);
  float found = s->loops.off(&disc, s->discs, g->end - g->begin, *past);
  *past = found > *past ? found : *past;
  for (size_t i = g->begin; i < g->end; i++) {
    const conic_layers_disc drawn = disc_of_member(&s->members[i], s->members[i].drawn);
    found = s->loops.off(&drawn, &disc, 1, *off);
    *off = found > *off ? found : *off;
  }
}

/* --- of a node --- */

static void list_members(conic_layers_standing *s, const conic_layers_plan *plan, const unsigned char *samples,
                         const conic_layers_node *node) {
  int is_cut = conic_layers_schema_find(plan->schema, CONIC_LAYERS_AXES) >= 0; /* by clip lines, perhaps */
  float covering = node->is_leaf ? 0.0f : (float)node->covering, least = (float)share_of_covering * covering;
  for (size_t i = 0; i < node->n_drawn; i++) {
    const conic_layers_sample *sample = conic_layers_sample_at(samples, plan->sample_bytes, i);
    float own = (float)((double)conic_layers_size_of(sample->size) / plan->quantum);
    disc_member *m = &s->members[i];
    *m = (disc_member){.own = is_cut ? 0.0f : own, .i = (uint32_t)i};
    m->drawn = own > covering ? own : covering;
    m->radius = own > least ? own : least;
    conic_layers_normal_of(sample->normal, m->normal);
    for (int axis = 0; axis < 3; axis++)
      m->at[axis] = (float)conic_layers_step(sample->key, axis);
  }
}

/* Dots turn to whoever looks; where all members are dots, so does what stands for them. */
static void code_dot(const conic_layers_standing *s, const conic_layers_plan *plan, const unsigned char *samples,
                     const member_group *g, unsigned char *record) {
  int from = conic_layers_schema_find(plan->schema, CONIC_LAYERS_DOT),
      to = conic_layers_schema_find(&s->schema, CONIC_LAYERS_DOT);
  unsigned char dot = 1;
  if (to < 0)
    return;
  for (size_t i = g->begin; i < g->end; i++)
    dot &= *conic_layers_value_at(plan->schema, samples, s->members[i].i, (uint32_t)from);
  *conic_layers_value_in(&s->schema, record, 0, (uint32_t)to) = dot;
}

static void widen_bounds(const circle *c, conic_layers_node *node) {
  double cosine = conic_dot(c->normal, node->axis);
  node->stand_in_cone = cosine < node->stand_in_cone ? cosine : node->stand_in_cone;
  node->stand_in_radius = c->radius > node->stand_in_radius ? c->radius : node->stand_in_radius;
}

void conic_layers_stand_in(conic_layers_standing *s, const conic_layers_plan *plan, int which,
                           const unsigned char *samples, conic_layers_node *node) {
  unsigned char *record = s->records + (size_t)which * s->most_groups * s->schema.sample_bytes;
  size_t n_wanted = (node->n_drawn + SAMPLES_A_STAND_IN - 1) / SAMPLES_A_STAND_IN;
  float off = 0.0f, past = 0.0f;
  list_members(s, plan, samples, node);
  part_members(s, node->n_drawn, n_wanted);
  node->n_stand_ins = s->n_groups;
  node->stand_in_radius = 0.0;
  node->stand_in_cone = node->cone;
  memset(record, 0, s->n_groups * s->schema.sample_bytes);
  for (size_t i = 0; i < s->n_groups; i++, record += s->schema.sample_bytes) {
    const member_group *g = &s->groups[i];
    conic_layers_sample *sample = conic_layers_sample_in(record, s->schema.sample_bytes, 0);
    circle c;
    find_means(s, plan, samples, g, plan->is_unoriented, &c);
    code_means(s, &c, sample);
    code_size(s, plan->quantum, g, &c, sample);
    code_dot(s, plan, samples, g, record);
    widen_bounds(&c, node);
    measure_circle(s, g, &c, &past, &off);
  }
  double far = (double)off + (node->is_leaf ? 0.0 : node->error);
  node->stand_in_error = far > (double)past ? far : (double)past;
  qsort(s->records + (size_t)which * s->most_groups * s->schema.sample_bytes, s->n_groups, s->schema.sample_bytes,
        conic_layers_compare_keys);
}

void conic_layers_stand_ins_encode(conic_layers_standing *s, int which, const conic_layers_node *node,
                                   conic_layers_entry *entry, const unsigned char **bytes) {
  uint64_t attribute_bytes[CONIC_LAYERS_MOST_ATTRIBUTES] = {0};
  const unsigned char *records = s->records + (size_t)which * s->most_groups * s->schema.sample_bytes;
  size_t n_bytes = conic_layers_encode(s->coder, records, node->n_stand_ins, entry->key, bytes, attribute_bytes);
  entry->n_stand_ins = (uint16_t)node->n_stand_ins;
  entry->stand_in_bytes = (uint32_t)n_bytes;
  entry->stand_in_sum = conic_checksum(*bytes, n_bytes);
}
