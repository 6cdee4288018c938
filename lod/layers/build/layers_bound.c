/* The bounds of a node: what its samples cover, where they lie, and which way they face. */
#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/real.h"
#include "core/base/vectors.h"
#include "lod/layers/build/layers_branch.h"
#include "lod/layers/format/layers_key.h"

enum { N_PROBES = 32, N_NEAREST = 8, LEAST_TO_TELL = 32 };

/* The outline of samples without one, over the sampling distance: as far as a Gaussian of that standard deviation goes.
 */
static const double outline_over_spacing = 1.5;

/* A leaf's samples are drawn alike. One that is many times larger than most is not let to blow up the others, as the
 * automatic ε does it (docs/reference/picture.md). */
static const double most_over_median = 4.0;

static double size_of(uint16_t code) {
  return (double)conic_float_of_bits((uint32_t)code << 16);
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
static double spacing_about(const float (*steps)[3], size_t n, size_t i_place) {
  float nearest2[N_NEAREST + 1];
  for (int i = 0; i <= N_NEAREST; i++)
    nearest2[i] = HUGE_VALF;
  for (size_t i = 0; i < n; i++) { /* itself is the first of the nearest */
    float x = steps[i][0] - steps[i_place][0], y = steps[i][1] - steps[i_place][1], z = steps[i][2] - steps[i_place][2];
    float distance2 = x * x + y * y + z * z;
    if (distance2 < nearest2[N_NEAREST])
      keep_smallest(nearest2, N_NEAREST + 1, distance2);
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
static conic_status find_spacing(const conic_layers_plan *plan, const conic_layers_branch *leaf, double *spacing) {
  double spacings[N_PROBES];
  size_t n = leaf->n_drawn;
  *spacing = plan->spacing / plan->quantum;
  if (n < LEAST_TO_TELL)
    return CONIC_OK;
  float(*steps)[3] = conic_memory_allocate(plan->context, n, sizeof *steps);
  if (!steps)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++)
      steps[i][axis] = (float)conic_layers_step(leaf->keys[i], axis);
  for (size_t i = 0; i < N_PROBES; i++)
    spacings[i] = spacing_about((const float(*)[3])steps, n, (2 * i + 1) * n / (2 * (size_t)N_PROBES));
  conic_memory_release(plan->context, steps);
  double found = middle_of(spacings, N_PROBES);
  *spacing = found > 0.0 ? found : *spacing;
  return CONIC_OK;
}

/* The largest outline that samples have of their own, in steps; 0 where none has one. */
static double outline_given(const conic_layers_plan *plan, const conic_layers_branch *leaf) {
  double some[N_PROBES], largest = 0.0;
  size_t n = 0;
  for (size_t i = 0; i < leaf->n_drawn; i++) {
    double size = size_of(leaf->samples[i].size);
    largest = size > largest ? size : largest;
  }
  for (size_t i = 0; i < N_PROBES; i++) {
    double size = size_of(leaf->samples[(2 * i + 1) * leaf->n_drawn / (2 * (size_t)N_PROBES)].size);
    if (size > 0.0)
      some[n++] = size;
  }
  double most = n ? most_over_median * middle_of(some, n) : largest;
  return (largest < most ? largest : most) / plan->quantum;
}

static void find_branch_box(conic_layers_branch *branch) {
  for (int axis = 0; axis < 3; axis++) {
    branch->low[axis] = HUGE_VAL;
    branch->high[axis] = -HUGE_VAL;
  }
  for (size_t i = 0; i < branch->n_drawn; i++) {
    double at[3];
    steps_of(branch->keys[i], at);
    for (int axis = 0; axis < 3; axis++) {
      branch->low[axis] = at[axis] < branch->low[axis] ? at[axis] : branch->low[axis];
      branch->high[axis] = at[axis] > branch->high[axis] ? at[axis] : branch->high[axis];
    }
  }
}

/* About the middle of the box: to the farthest that is drawn, and from there on as far as these are off. */
static void find_sphere(conic_layers_branch *branch) {
  double farthest2 = 0.0, corner2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double half = 0.5 * (branch->high[axis] - branch->low[axis]);
    branch->center[axis] = branch->low[axis] + half;
    corner2 += half * half;
  }
  for (size_t i = 0; i < branch->n_drawn; i++) {
    double at[3], way[3];
    steps_of(branch->keys[i], at);
    conic_subtract(at, branch->center, way);
    double distance2 = conic_dot(way, way);
    farthest2 = distance2 > farthest2 ? distance2 : farthest2;
  }
  double reach = sqrt(farthest2) + branch->covering, corner = sqrt(corner2);
  branch->sphere = reach < corner ? reach : corner;
}

static void find_axis(conic_layers_branch *branch) {
  double sum[3] = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < branch->n_drawn; i++) {
    float normal[3];
    conic_layers_normal_of(branch->samples[i].normal, normal);
    for (int axis = 0; axis < 3; axis++)
      sum[axis] += (double)normal[axis];
  }
  double length = conic_length(sum);
  for (int axis = 0; axis < 3; axis++)
    branch->axis[axis] = length > 0.0 ? (double)(float)(sum[axis] / length) : axis == 2;
}

/* The cosine of the sum of two angles, given theirs; −1 where it is more than a half turn. */
static double cosine_of_sum(double a, double b) {
  a = a > 1.0 ? 1.0 : a < -1.0 ? -1.0 : a;
  b = b > 1.0 ? 1.0 : b < -1.0 ? -1.0 : b;
  if (a + b <= 0.0) /* over a half turn together: a ≤ cos(π − angle of b) */
    return -1.0;
  return a * b - sqrt((1.0 - a * a) * (1.0 - b * b));
}

conic_status conic_layers_bound_leaf(const conic_layers_plan *plan, conic_layers_branch *leaf) {
  double spacing, given = outline_given(plan, leaf);
  conic_status status = find_spacing(plan, leaf, &spacing);
  leaf->area = spacing * spacing * (double)leaf->n_drawn;
  leaf->radius = given > 0.0 ? given : outline_over_spacing * spacing;
  leaf->outline_low = leaf->outline_high = leaf->radius;
  find_branch_box(leaf);
  find_sphere(leaf);
  find_axis(leaf);
  leaf->cone = 1.0;
  for (size_t i = 0; i < leaf->n_drawn; i++) {
    float normal[3];
    conic_layers_normal_of(leaf->samples[i].normal, normal);
    const double n[3] = {(double)normal[0], (double)normal[1], (double)normal[2]};
    double cosine = conic_dot(n, leaf->axis);
    leaf->cone = cosine < leaf->cone ? cosine : leaf->cone;
  }
  return status;
}

typedef void visit(void *data, const conic_layers_branch *below);

/* The nodes that bounds are found from. */
static void visit_below(const conic_layers_branch *branch, uint64_t n_place, visit *visitor, void *data) {
  if (!branch->children[0] || conic_layers_is_far_below(n_place, branch->n_place)) {
    visitor(data, branch);
    return;
  }
  for (int i = 0; i < 2; i++)
    visit_below(branch->children[i], n_place, visitor, data);
}

typedef struct bounding {
  conic_layers_branch *node;
  conic_thinner *thinner;
} bounding;

static void reach_out(void *data, const conic_layers_branch *below) {
  bounding *b = data;
  b->node->covering = conic_thinner_reach(b->thinner, below->keys, below->n_drawn, below->covering, b->node->covering);
}

static void widen_cone(void *data, const conic_layers_branch *below) {
  bounding *b = data;
  double cosine = cosine_of_sum(conic_dot(b->node->axis, below->axis), below->cone);
  b->node->cone = cosine < b->node->cone ? cosine : b->node->cone;
}

static double larger(double a, double b) {
  return a > b ? a : b;
}

void conic_layers_bound_node(conic_thinner *thinner, conic_layers_branch *node) {
  const conic_layers_branch *a = node->children[0], *b = node->children[1];
  bounding bounds = {node, thinner};
  node->covering = 0.0;
  visit_below(node, node->n_place, reach_out, &bounds);
  node->area = a->area + b->area;
  node->outline_low = a->outline_low < b->outline_low ? a->outline_low : b->outline_low;
  node->outline_high = larger(a->outline_high, b->outline_high);
  node->radius =
      larger(node->covering + node->outline_high, outline_over_spacing * sqrt(node->area / (double)node->n_drawn));
  node->radius = larger(node->radius, larger(a->radius, b->radius));
  for (int axis = 0; axis < 3; axis++) {
    node->low[axis] = a->low[axis] < b->low[axis] ? a->low[axis] : b->low[axis];
    node->high[axis] = larger(a->high[axis], b->high[axis]);
  }
  find_sphere(node);
  find_axis(node);
  node->cone = 1.0;
  visit_below(node, node->n_place, widen_cone, &bounds);
}

/* Not below the value, with room for the rounding of whoever uses it. */
static float rounded_up(double value) {
  return nextafterf((float)(value * (1.0 + 1e-6)), HUGE_VALF);
}

/* Between what is drawn and what full resolution draws, in steps. A drawn disc reaches past its own sample's there by
 * no more than the difference of the outlines. What is drawn there lies no farther from the disc of a sample within the
 * covering radius than that, and what the two discs part by that are turned against each other. */
static double error_of_branch(const conic_layers_branch *branch) {
  double half_turn = branch->cone < 0.0 ? 1.0 : sqrt(1.0 - branch->cone * branch->cone); /* sine of half the cone */
  double past = branch->radius - branch->outline_low;
  double off = branch->covering + (half_turn < 0.5 ? 2.0 * half_turn : 1.0) * branch->outline_high;
  return branch->is_leaf ? 0.0 : larger(past, off);
}

void conic_layers_describe_branch(const conic_layers_plan *plan, const conic_layers_branch *branch,
                                  conic_layers_entry *entry) {
  uint64_t differing = branch->first_key ^ branch->last_key;
  unsigned n_below = differing ? 64u - (unsigned)__builtin_clzll(differing) : 0u;
  double q = plan->quantum, rounding = (double)(UINT64_C(1) << plan->bits) * 0x1p-22; /* of positions as floats */
  memset(entry, 0, sizeof *entry);
  entry->depth = (uint16_t)(3 * plan->bits - n_below);
  entry->key = branch->first_key >> n_below << n_below;
  entry->n_place = branch->n_place;
  entry->n_drawn = (uint32_t)branch->n_drawn;
  entry->spacing = (float)(sqrt(branch->area / (double)branch->n_drawn) * q);
  entry->covering = rounded_up((branch->covering + 2.0 * rounding) * q);
  entry->radius = rounded_up(branch->radius * q);
  entry->error = rounded_up((error_of_branch(branch) + 0.8660254037844387 + rounding) * q);
  entry->sphere = rounded_up((branch->sphere + branch->radius) * q);
  double slack = 2.0 * rounding * q;
  for (int axis = 0; axis < 3; axis++) {
    double center = (branch->center[axis] + 0.5) * q;
    entry->center[axis] = (float)center;
    slack += fabs((double)entry->center[axis] - center);
    entry->axis[axis] = (float)branch->axis[axis];
  }
  entry->sphere = rounded_up((double)entry->sphere + slack);
  entry->cone = plan->is_unoriented ? -1.0f : (float)larger(-1.0, branch->cone - 4e-6);
}
