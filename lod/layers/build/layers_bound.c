/* The bounds of a node: what its samples cover, where they lie, and which way they face. */

#include "core/base/vectors.h"
#include "core/lanes/lanes.h"
#include "lod/layers/build/layers_node.h"
#include "lod/layers/format/layers_axes.h"
#include "lod/layers/format/layers_key.h"

enum { SOME_KEYS = 512, N_PROBES = 32, N_NEAREST = 8, LEAST_TO_TELL = 32 };

/* The outline of samples without one, over the sampling distance: as far as a Gaussian of that standard deviation goes.
 */
static const double outline_over_spacing = 1.5;

static double larger(double a, double b) {
  return a > b ? a : b;
}

static void steps_of(uint64_t key, double steps[3]) {
  for (int axis = 0; axis < 3; axis++)
    steps[axis] = (double)conic_layers_step(key, axis);
}

/* Puts a value where it belongs among the smallest, ascending. */
static void keep_smallest(float *smallest, int n, float value) {
  int i = n - 1;
  for (; i > 0 && smallest[i - 1] > value; i--)
    smallest[i] = smallest[i - 1];
  smallest[i] = value;
}

/* √(area a point) about one of n places: its nearest neighbours' share of the disc that holds them. */
static double spacing_about(const float *const steps[3], size_t n, size_t i_place) {
  float nearest2[N_NEAREST + 1];
  for (int i = 0; i <= N_NEAREST; i++)
    nearest2[i] = HUGE_VALF;
  for (size_t i = 0; i < n; i += CONIC_LANES) { /* itself is the first of the nearest */
    lanes distance2 = lanes_of(0.0f);
    for (int axis = 0; axis < 3; axis++) {
      lanes way = lanes_load(steps[axis] + i) - steps[axis][i_place];
      distance2 += way * way;
    }
    if (lanes_any(lanes_less(distance2, lanes_of(nearest2[N_NEAREST]))))
      for (size_t lane = 0; lane < CONIC_LANES && i + lane < n; lane++)
        if (distance2[lane] < nearest2[N_NEAREST])
          keep_smallest(nearest2, N_NEAREST + 1, distance2[lane]);
  }
  return sqrt(3.14159265358979323846 * (double)nearest2[N_NEAREST] / (double)N_NEAREST);
}

static double middle_of(double *values, size_t n) { /* sorts them; few */
  for (size_t i = 1; i < n; i++)
    for (size_t k = i; k > 0 && values[k - 1] > values[k]; k--) {
      double held = values[k];
      values[k] = values[k - 1];
      values[k - 1] = held;
    }
  return values[(n - 1) / 2];
}

/* The median of some; those at the border of the leaf, whose neighbours lie elsewhere, do not move it much. */
static conic_status find_spacing(const conic_layers_plan *plan, const conic_layers_node *leaf, double *spacing) {
  double spacings[N_PROBES];
  size_t n = leaf->n_drawn;
  *spacing = plan->spacing / plan->quantum;
  if (n < LEAST_TO_TELL)
    return CONIC_OK;
  float *steps[3];
  size_t n_read = n + CONIC_LANES;
  conic_status status = conic_memory_allocate_these(plan->context, CONIC_ZEROED(steps[0], n_read),
                                                    CONIC_ZEROED(steps[1], n_read), CONIC_ZEROED(steps[2], n_read));
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    for (int axis = 0; axis < 3; axis++)
      steps[axis][i] = (float)conic_layers_step(leaf->keys[i], axis);
  for (size_t i = 0; i < N_PROBES && status == CONIC_OK; i++)
    spacings[i] = spacing_about((const float *const *)steps, n, (2 * i + 1) * n / (2 * (size_t)N_PROBES));
  conic_memory_release_these(plan->context, steps[0], steps[1], steps[2]);
  if (status != CONIC_OK)
    return status;
  double found = middle_of(spacings, N_PROBES);
  *spacing = found > 0.0 ? found : *spacing;
  return CONIC_OK;
}

/* A circle of this outline where the sample has no ellipse. */
static void fill_axes(const conic_layers_plan *plan, conic_layers_sample *sample, unsigned char *at, float outline) {
  conic_layers_axes axes;
  float normal[3];
  memcpy(&axes, at, sizeof axes);
  if (axes.length[0] > 0.0f)
    return;
  conic_layers_normal_of(sample->normal, normal);
  conic_layers_code_fine_normal(normal, axes.normal);
  axes.length[0] = axes.length[1] = conic_layers_axis_length(outline / plan->cutoff);
  memcpy(at, &axes, sizeof axes);
}

/* Gives the samples that have no size this one, and all the size that they will be read with. */
static void settle_outlines(const conic_layers_plan *plan, conic_layers_node *leaf, double outline) {
  const conic_layers_schema *schema = plan->schema;
  int axes = conic_layers_schema_find(schema, CONIC_LAYERS_AXES);
  int size = conic_layers_schema_find(schema, CONIC_LAYERS_SIZE);
  double largest = 0.0;
  for (size_t i = 0; i < leaf->n_drawn; i++) {
    conic_layers_sample *sample = conic_layers_sample_in(leaf->samples, leaf->stride, i);
    if (!sample->size)
      sample->size = conic_layers_code_size((float)outline);
    if (axes >= 0) {
      unsigned char *at = conic_layers_value_in(schema, leaf->samples, i, (uint32_t)axes);
      fill_axes(plan, sample, at, conic_layers_size_of(sample->size));
      sample->size = conic_layers_size_of_axes(plan->cutoff, at);
    } else if (size >= 0)
      sample->size = conic_layers_size_as_read(&schema->list[size], sample->size);
    largest = larger(largest, (double)conic_layers_size_of(sample->size));
  }
  leaf->radius = largest / plan->quantum;
}

static void find_node_box(conic_layers_node *node) {
  for (int axis = 0; axis < 3; axis++) {
    node->low[axis] = HUGE_VAL;
    node->high[axis] = -HUGE_VAL;
  }
  for (size_t i = 0; i < node->n_drawn; i++) {
    double at[3];
    steps_of(node->keys[i], at);
    conic_widen_box(node->low, node->high, at);
  }
}

/* About the middle of the box: to the farthest that is drawn, and from there on as far as these are off. */
static void find_sphere(conic_layers_node *node) {
  double farthest2 = 0.0, corner2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double half = 0.5 * (node->high[axis] - node->low[axis]);
    node->center[axis] = node->low[axis] + half;
    corner2 += half * half;
  }
  for (size_t i = 0; i < node->n_drawn; i++) {
    double at[3], way[3];
    steps_of(node->keys[i], at);
    conic_subtract(at, node->center, way);
    double distance2 = conic_dot(way, way);
    farthest2 = distance2 > farthest2 ? distance2 : farthest2;
  }
  double reach = sqrt(farthest2) + node->covering, corner = sqrt(corner2);
  node->sphere = reach < corner ? reach : corner;
}

static void find_axis(conic_layers_node *node) {
  double sum[3] = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < node->n_drawn; i++) {
    float normal[3];
    conic_layers_normal_of(conic_layers_drawn_at(node, i)->normal, normal);
    for (int axis = 0; axis < 3; axis++)
      sum[axis] += (double)normal[axis];
  }
  double length = conic_length(sum);
  for (int axis = 0; axis < 3; axis++)
    node->axis[axis] = length > 0.0 ? (double)(float)(sum[axis] / length) : axis == 2;
}

/* The normal with which a sample is drawn. */
static void drawn_normal(const conic_layers_plan *plan, const conic_layers_node *leaf, size_t i, int axes,
                         float normal[3]) {
  conic_layers_axes ellipse;
  if (axes < 0) {
    conic_layers_normal_of(conic_layers_drawn_at(leaf, i)->normal, normal);
    return;
  }
  memcpy(&ellipse, conic_layers_value_at(plan->schema, leaf->samples, i, (uint32_t)axes), sizeof ellipse);
  conic_layers_fine_normal_of(ellipse.normal, normal);
}

/* Dots turn to whoever looks: nothing bounds their normals. */
static double cone_of_leaf(const conic_layers_plan *plan, const conic_layers_node *leaf) {
  int axes = conic_layers_schema_find(plan->schema, CONIC_LAYERS_AXES);
  int dot = conic_layers_schema_find(plan->schema, CONIC_LAYERS_DOT);
  double cone = 1.0;
  for (size_t i = 0; i < leaf->n_drawn; i++) {
    float normal[3];
    drawn_normal(plan, leaf, i, axes, normal);
    const double n[3] = {(double)normal[0], (double)normal[1], (double)normal[2]};
    double cosine = conic_dot(n, leaf->axis);
    cone = cosine < cone ? cosine : cone;
    if (dot >= 0 && *conic_layers_value_at(plan->schema, leaf->samples, i, (uint32_t)dot))
      return -1.0;
  }
  return cone;
}

conic_status conic_layers_bound_leaf(const conic_layers_plan *plan, conic_layers_node *leaf) {
  double spacing;
  conic_status status = find_spacing(plan, leaf, &spacing);
  leaf->area = spacing * spacing * (double)leaf->n_drawn;
  settle_outlines(plan, leaf, outline_over_spacing * spacing * plan->quantum);
  find_node_box(leaf);
  find_sphere(leaf);
  find_axis(leaf);
  leaf->cone = cone_of_leaf(plan, leaf);
  return status;
}

typedef void visit(void *data, const conic_layers_node *below);

/* The nodes that bounds are found from. */
static void visit_below(const conic_layers_node *node, uint64_t n_place, visit *visitor, void *data) {
  if (!node->children[0] || conic_layers_is_far_below(n_place, node->n_place)) {
    visitor(data, node);
    return;
  }
  for (int i = 0; i < 2; i++)
    visit_below(node->children[i], n_place, visitor, data);
}

typedef struct bounding {
  conic_layers_node *node;
  const conic_thinner *thinner;
  size_t n_below;
  const conic_layers_node **below;
  conic_layers_chosen discs; /* the node's samples as they are drawn */
  double quantum;            /* a step of the grid, as they have it */
  int is_cut;                /* full resolution may draw less of a sample than its outline */
  _Atomic uint64_t most;     /* the bits of a number that is not negative, which have its order */
  atomic_int status;
} bounding;

static void count_below(void *data, const conic_layers_node *below) {
  (void)below;
  ((bounding *)data)->n_below++;
}

static void list_below(void *data, const conic_layers_node *below) {
  bounding *b = data;
  b->below[b->n_below++] = below;
}

static double most_so_far(bounding *b) {
  uint64_t bits = atomic_load_explicit(&b->most, memory_order_relaxed);
  double most;
  memcpy(&most, &bits, sizeof most);
  return most;
}

static void raise_most(bounding *b, double value) {
  uint64_t before = atomic_load_explicit(&b->most, memory_order_relaxed), after;
  memcpy(&after, &value, sizeof after);
  while (before < after && !atomic_compare_exchange_weak(&b->most, &before, after))
    continue;
}

/* The outline with which a sample is drawn where the node is the finest, in steps. */
static double outline_in(const conic_layers_node *node, double own) {
  return larger(own, node->is_leaf ? 0.0 : node->covering);
}

static conic_layers_disc disc_in(const conic_layers_node *node, uint64_t key, const conic_layers_facet *facet,
                                 double quantum) {
  conic_layers_disc disc;
  for (int axis = 0; axis < 3; axis++)
    disc.center[axis] = (float)conic_layers_step(key, axis);
  disc.code = facet->normal;
  disc.radius = (float)outline_in(node, (double)conic_layers_size_of(facet->size) / quantum);
  return disc;
}

/* How far the samples of a node below are from those chosen; or, once there are discs, what they are drawn as. */
static void reach_below(void *data, size_t i_item) {
  bounding *b = data;
  const conic_layers_node *below = b->below[i_item];
  int has_discs = b->discs.thinner != NULL;
  uint64_t keys[SOME_KEYS];
  conic_layers_facet facets[SOME_KEYS];
  conic_layers_disc discs[SOME_KEYS];
  double most = most_so_far(b);
  for (size_t first = 0, n; first < below->n_drawn; first += n) {
    n = below->n_drawn - first < SOME_KEYS ? below->n_drawn - first : SOME_KEYS;
    conic_status status = conic_layers_fetch_keys(below, first, n, keys);
    if (status == CONIC_OK && has_discs)
      status = conic_layers_fetch_facets(below, first, n, facets);
    if (status != CONIC_OK) {
      atomic_store(&b->status, (int)status);
      return;
    }
    for (size_t i = 0; i < n && has_discs; i++)
      discs[i] = disc_in(below, keys[i], &facets[i], b->quantum);
    most = has_discs ? b->discs.loops.error(&b->discs, discs, n, below->error, most)
                     : conic_thinner_reach(b->thinner, keys, n, below->covering, most);
  }
  raise_most(b, most);
}

static void widen_cone(void *data, const conic_layers_node *below) {
  bounding *b = data;
  double cosine = conic_cosine_of_sum(conic_cosine_between(b->node->axis, below->axis), below->cone);
  b->node->cone = cosine < b->node->cone ? cosine : b->node->cone;
}

/* The most that any node below comes to, and `least`. */
static double find_most(conic_context *context, int is_alone, bounding *b, double least) {
  atomic_store(&b->most, 0);
  raise_most(b, least);
  if (is_alone)
    conic_parallel_for(context, b->n_below, reach_below, b);
  for (size_t i = 0; i < b->n_below && !is_alone; i++)
    reach_below(b, i);
  return most_so_far(b);
}

/* Finds the largest outline with which samples are drawn, and how far any is past what full resolution draws of its
 * sample. */
static void find_past(const bounding *b) {
  conic_layers_node *node = b->node;
  node->radius = node->past = 0.0;
  for (size_t i = 0; i < node->n_drawn; i++) {
    double own = (double)conic_layers_size_of(node->facets[i].size) / b->quantum, drawn = outline_in(node, own);
    node->radius = larger(node->radius, drawn);
    node->past = larger(node->past, drawn - (b->is_cut ? 0.0 : own));
  }
  for (int i = 0; i < 2; i++)
    node->radius = larger(node->radius, node->children[i]->radius);
}

/* How far what full resolution draws is from what is drawn, and the other way round. */
static conic_status find_node_error(conic_context *context, int is_alone, bounding *b) {
  conic_layers_node *node = b->node;
  uint32_t *numbers = conic_memory_allocate(context, node->n_drawn, sizeof *numbers);
  conic_status status =
      numbers ? conic_layers_chosen_create(context, b->thinner, node->n_drawn, &b->discs) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    size_t n = conic_thinner_numbers(b->thinner, numbers);
    for (size_t i = 0; i < n; i++) {
      conic_layers_disc disc = disc_in(node, node->keys[numbers[i]], &node->facets[numbers[i]], b->quantum);
      conic_layers_normal_of(disc.code, disc.normal);
      conic_layers_chosen_put(&b->discs, i, &disc);
    }
    node->error = find_most(context, is_alone, b, node->past);
    status = (conic_status)atomic_load(&b->status);
  }
  conic_memory_release_these(context, b->discs.center[0], numbers);
  return status;
}

static conic_status find_outlines(conic_context *context, int is_alone, bounding *b) {
  conic_layers_node *node = b->node;
  visit_below(node, node->n_place, count_below, b);
  b->below = conic_memory_allocate(context, b->n_below, sizeof(void *));
  conic_status status = b->below ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    b->n_below = 0;
    visit_below(node, node->n_place, list_below, b);
    node->covering = find_most(context, is_alone, b, 0.0);
    find_past(b);
    status = (conic_status)atomic_load(&b->status);
    if (status == CONIC_OK)
      status = find_node_error(context, is_alone, b);
  }
  conic_memory_release(context, (void *)b->below);
  return status;
}

conic_status conic_layers_bound_node(const conic_layers_plan *plan, const conic_thinner *thinner, int is_alone,
                                     conic_layers_node *node) {
  const conic_layers_node *a = node->children[0], *b = node->children[1];
  bounding bounds = {.node = node, .thinner = thinner, .quantum = plan->quantum};
  bounds.is_cut = conic_layers_schema_find(plan->schema, CONIC_LAYERS_AXES) >= 0;
  atomic_init(&bounds.most, 0);
  atomic_init(&bounds.status, CONIC_OK);
  node->area = a->area + b->area;
  conic_status status = find_outlines(plan->context, is_alone, &bounds);
  for (int axis = 0; axis < 3; axis++) {
    node->low[axis] = a->low[axis] < b->low[axis] ? a->low[axis] : b->low[axis];
    node->high[axis] = larger(a->high[axis], b->high[axis]);
  }
  find_sphere(node);
  find_axis(node);
  node->cone = 1.0;
  visit_below(node, node->n_place, widen_cone, &bounds);
  return status;
}

/* Not below the value, with room for the rounding of whoever uses it. */
static float rounded_up(double value) {
  return nextafterf((float)(value * (1.0 + 1e-6)), HUGE_VALF);
}

void conic_layers_describe_node(const conic_layers_plan *plan, const conic_layers_node *node,
                                conic_layers_entry *entry) {
  unsigned n_below = conic_layers_bits_below(node->first_key, node->last_key);
  double q = plan->quantum, rounding = (double)(UINT64_C(1) << plan->bits) * 0x1p-22; /* of positions as floats */
  memset(entry, 0, sizeof *entry);
  entry->depth = (uint16_t)(3 * plan->bits - n_below);
  entry->key = node->first_key >> n_below << n_below;
  entry->n_place = node->n_place;
  entry->n_drawn = (uint32_t)node->n_drawn;
  entry->spacing = (float)(sqrt(node->area / (double)node->n_drawn) * q);
  entry->covering = rounded_up((node->covering + 2.0 * rounding) * q);
  entry->radius = rounded_up((node->radius + 2.0 * rounding) * q);
  entry->growth = node->is_leaf ? 1.0f : 0.0f;
  entry->reach = node->is_leaf ? 0.0f : entry->covering;
  entry->error = node->is_leaf ? 0.0f : rounded_up((node->error + 3.0 * rounding) * q);
  entry->sphere = rounded_up((node->sphere + node->radius + 2.0 * rounding) * q);
  double slack = 2.0 * rounding * q;
  for (int axis = 0; axis < 3; axis++) {
    double center = (node->center[axis] + 0.5) * q;
    entry->center[axis] = (float)center;
    slack += fabs((double)entry->center[axis] - center);
    entry->axis[axis] = (float)node->axis[axis];
  }
  entry->sphere = rounded_up((double)entry->sphere + slack);
  if (node->n_stand_ins > 0) {
    entry->stand_in_error = rounded_up((node->stand_in_error + 3.0 * rounding) * q);
    entry->stand_in_radius = rounded_up(node->stand_in_radius * q);
    entry->stand_in_cone = plan->is_unoriented ? 0 : (uint16_t)larger(0.0, (node->stand_in_cone + 1.0) * 32767.0 - 1.0);
  }
  entry->cone = plan->is_unoriented ? -1.0f : (float)larger(-1.0, node->cone - 4e-6);
}
