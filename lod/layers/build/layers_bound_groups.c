/* How far the ellipses that stand for groups of a node's samples are from what full resolution draws. */
#include "core/base/base.h"
#include "lod/layers/build/layers_node.h"
#include "lod/layers/format/layers_axes.h"
#include "lod/layers/format/layers_key.h"

/* As full resolution draws a sample; that may be less than its outline where it has an ellipse. */
static conic_layers_disc own_disc(const conic_layers_plan *plan, int is_cut, uint64_t key,
                                  const conic_layers_facet *facet) {
  conic_layers_disc own = {.radius = 0.0f};
  for (int axis = 0; axis < 3; axis++)
    own.center[axis] = (float)conic_layers_step(key, axis);
  conic_layers_normal_of(facet->normal, own.normal);
  own.radius = own.longer = is_cut ? 0.0f : (float)((double)conic_layers_size_of(facet->size) / plan->quantum);
  return own;
}

static int may_be_cut(const conic_layers_plan *plan) {
  return conic_layers_schema_find(plan->schema, CONIC_LAYERS_AXES) >= 0;
}

static void fill_members(conic_layers_node_groups *g) {
  const conic_layers_node *node = g->node;
  int is_cut = may_be_cut(g->plan);
  for (size_t i = 0; i < node->n_drawn; i++) {
    g->own[i] = own_disc(g->plan, is_cut, node->keys[i], &node->facets[i]);
    g->members[i] = g->own[i];
    float outline = (float)((double)conic_layers_size_of(node->facets[i].size) / g->plan->quantum);
    g->members[i].radius = g->members[i].longer =
        conic_layers_member_radius(outline, node->is_leaf ? 0.0f : (float)node->covering);
  }
}

static conic_status fill_finer(conic_layers_node_groups *g) {
  enum { SOME = 256 };
  const conic_layers_node *node = g->node;
  uint64_t keys[SOME];
  conic_layers_facet facets[SOME];
  int is_cut = may_be_cut(g->plan);
  size_t n_finer = node->is_leaf ? node->n_drawn : node->children[0]->n_drawn + node->children[1]->n_drawn;
  conic_status status =
      conic_memory_allocate_these(g->plan->context, CONIC_ROOM(g->finer, n_finer),
                                  CONIC_ROOM(g->boxes, (n_finer + CONIC_LAYERS_BOXED - 1) / CONIC_LAYERS_BOXED));
  if (status == CONIC_OK && node->is_leaf) {
    memcpy(g->finer, g->own, n_finer * sizeof *g->finer);
    g->n_finer = n_finer;
  }
  for (int i = 0; i < 2 && !node->is_leaf; i++)
    for (size_t first = 0, n; first < node->children[i]->n_drawn && status == CONIC_OK; first += n) {
      n = node->children[i]->n_drawn - first < SOME ? node->children[i]->n_drawn - first : SOME;
      status = conic_layers_fetch_keys(node->children[i], first, n, keys);
      if (status == CONIC_OK)
        status = conic_layers_fetch_facets(node->children[i], first, n, facets);
      for (size_t k = 0; k < n && status == CONIC_OK; k++)
        g->finer[g->n_finer++] = own_disc(g->plan, is_cut, keys[k], &facets[k]);
    }
  for (size_t i = 0; i < g->n_finer && status == CONIC_OK; i++)
    for (int axis = 0; axis < 3; axis++) {
      float *low = &g->boxes[i / CONIC_LAYERS_BOXED][axis], *high = low + 3;
      float from = g->finer[i].center[axis] - g->finer[i].radius, to = g->finer[i].center[axis] + g->finer[i].radius;
      *low = i % CONIC_LAYERS_BOXED == 0 || from < *low ? from : *low;
      *high = i % CONIC_LAYERS_BOXED == 0 || to > *high ? to : *high;
    }
  return status;
}

static int is_in_box(const float box[6], const float at[3], float margin) {
  return at[0] > box[0] - margin && at[0] < box[3] + margin && at[1] > box[1] - margin && at[1] < box[4] + margin &&
         at[2] > box[2] - margin && at[2] < box[5] + margin;
}

/* How far a place is from the nearest of a group's samples, or else from that of finer ones; or no more than `enough`.
 */
static float error_from_own(const conic_layers_node_groups *g, const conic_layers_group *group, const float at[3],
                            float enough) {
  float nearest2 = HUGE_VALF, enough2 = enough * enough;
  for (uint32_t i = group->begin; i < group->end && nearest2 > enough2; i++) {
    float error2 = conic_layers_error2_from(&g->own[g->grouping.order[i]], at);
    nearest2 = error2 < nearest2 ? error2 : nearest2;
  }
  for (size_t box = 0; box * CONIC_LAYERS_BOXED < g->n_finer && nearest2 > enough2; box++) {
    size_t end = (box + 1) * CONIC_LAYERS_BOXED;
    if (!is_in_box(g->boxes[box], at, sqrtf(nearest2)))
      continue;
    for (size_t i = box * CONIC_LAYERS_BOXED; i < end && i < g->n_finer; i++) {
      float error2 = conic_layers_error2_from(&g->finer[i], at);
      nearest2 = error2 < nearest2 ? error2 : nearest2;
    }
  }
  return sqrtf(nearest2);
}

/* The farthest of 16 places on the ellipse's rim, turned by an angle, and as many half way; no more than `enough` does
 * not count. */
static float past_at_places(const conic_layers_node_groups *g, const conic_layers_group *group,
                            const conic_layers_disc *e, const float turn[2], float enough) {
  static const float corners[4][2] = {
      {1.0f, 0.0f}, {0.92387953f, 0.38268343f}, {0.70710678f, 0.70710678f}, {0.38268343f, 0.92387953f}};
  float u[3], v[3], farthest = 0.0f;
  conic_layers_disc_axes(e, u, v);
  for (int i = 0; i < 32; i++) {
    float c = corners[i % 4][0], s = corners[i % 4][1], ring = i < 16 ? 1.0f : 0.5f, at[3];
    int quarter = i / 4 % 4;
    float x = quarter % 2 ? -s : c, y = quarter % 2 ? c : s;
    ring = quarter / 2 ? -ring : ring;
    float along = ring * (x * turn[0] - y * turn[1]) * e->longer,
          across = ring * (x * turn[1] + y * turn[0]) * e->radius;
    for (int axis = 0; axis < 3; axis++)
      at[axis] = e->center[axis] + along * u[axis] + across * v[axis];
    float error = error_from_own(g, group, at, enough);
    farthest = error > farthest ? error : farthest;
  }
  return farthest;
}

/* How far the ellipse is past the samples, or no more than `past`. Where places between could come to more than that,
 * these are looked at, too: they lie within a fifth of the longer axis. */
static float past_group(const conic_layers_node_groups *g, const conic_layers_group *group, const conic_layers_disc *e,
                        float past) {
  static const float turns[4][2] = {
      {1.0f, 0.0f}, {0.99518473f, 0.09801714f}, {0.98078528f, 0.19509032f}, {0.95694034f, 0.29028468f}};
  float nearly = past - 0.2f * e->longer > 0.0f ? past - 0.2f * e->longer : 0.0f;
  float farthest = past_at_places(g, group, e, turns[0], nearly);
  for (int i = 1; i < 4 && farthest > nearly; i++) {
    float error = past_at_places(g, group, e, turns[i], past > farthest ? past : farthest);
    farthest = error > farthest ? error : farthest;
  }
  return farthest > past ? farthest : past;
}

/* How high the group's samples reach over the ellipse. */
static float height_over(const conic_layers_node_groups *g, const conic_layers_group *group,
                         const conic_layers_disc *e) {
  float highest = 0.0f;
  for (uint32_t i = group->begin; i < group->end; i++) {
    const conic_layers_disc *m = &g->members[g->grouping.order[i]];
    float height = 0.0f, cosine = 0.0f;
    for (int axis = 0; axis < 3; axis++) {
      height += (m->center[axis] - e->center[axis]) * e->normal[axis];
      cosine += m->normal[axis] * e->normal[axis];
    }
    float sine2 = 1.0f - cosine * cosine;
    height = fabsf(height) + m->radius * (sine2 > 0.0f ? sqrtf(sine2) : 0.0f);
    highest = height > highest ? height : highest;
  }
  return highest;
}

/* The ellipse of each sample's group. */
static void fit_groups(conic_layers_node_groups *g) {
  conic_layers_node *node = g->node;
  for (size_t i = 0; i < g->grouping.n_groups; i++) {
    const conic_layers_group *group = &g->grouping.groups[i];
    conic_layers_disc *ellipse = &g->ellipses[g->grouping.order[group->begin]];
    conic_layers_fit_group(&g->grouping, group, g->members, g->plan->is_unoriented, ellipse);
    node->radius = (double)ellipse->longer > node->radius ? (double)ellipse->longer : node->radius;
    for (uint32_t k = group->begin + 1; k < group->end; k++)
      g->ellipses[g->grouping.order[k]] = *ellipse;
  }
}

/* No place of the ellipse is farther from the samples of its group: each is no farther than this from the disc of any,
 * by how high it lies over that and how far past it. */
static float farthest_past(const conic_layers_node_groups *g, const conic_layers_group *group,
                           const conic_layers_disc *e) {
  float least = HUGE_VALF;
  for (uint32_t i = group->begin; i < group->end; i++) {
    const conic_layers_disc *own = &g->own[g->grouping.order[i]];
    float way2 = 0.0f, height = 0.0f, cosine = 0.0f;
    for (int axis = 0; axis < 3; axis++) {
      float way = own->center[axis] - e->center[axis];
      way2 += way * way;
      height += way * own->normal[axis];
      cosine += e->normal[axis] * own->normal[axis];
    }
    float sine2 = 1.0f - cosine * cosine, past = e->longer + sqrtf(way2) - own->radius;
    float far = fabsf(height) + e->longer * (sine2 > 0.0f ? sqrtf(sine2) : 0.0f) + (past > 0.0f ? past : 0.0f);
    least = far < least ? far : least;
  }
  return least;
}

static double raise_error(const conic_layers_node_groups *g, double error) {
  for (size_t i = 0; i < g->grouping.n_groups; i++) {
    const conic_layers_group *group = &g->grouping.groups[i];
    const conic_layers_disc *ellipse = &g->ellipses[g->grouping.order[group->begin]];
    float height = g->node->is_leaf ? height_over(g, group, ellipse) : 0.0f;
    error = (double)height > error ? (double)height : error;
    if (farthest_past(g, group, ellipse) > (float)error)
      error = (double)past_group(g, group, ellipse, (float)error);
  }
  return error;
}

conic_status conic_layers_node_groups_begin(const conic_layers_plan *plan, conic_layers_node *node,
                                            conic_layers_node_groups *g) {
  size_t n = node->n_drawn;
  *g = (conic_layers_node_groups){.plan = plan, .node = node};
  conic_status status = conic_memory_allocate_these(plan->context, CONIC_ROOM(g->members, n), CONIC_ROOM(g->own, n),
                                                    CONIC_ROOM(g->ellipses, n));
  if (status == CONIC_OK)
    status = conic_layers_group_all(plan->context, &g->grouping, node->keys, n);
  if (status == CONIC_OK) {
    fill_members(g);
    status = fill_finer(g);
  }
  if (status != CONIC_OK)
    return status;
  conic_layers_part_groups(&g->grouping, conic_layers_part_of((uint32_t)n, 4));
  fit_groups(g);
  return CONIC_OK;
}

void conic_layers_node_groups_end(conic_layers_node_groups *g) {
  conic_layers_grouping_release(g->plan->context, &g->grouping);
  conic_memory_release_these(g->plan->context, g->members, g->own, g->ellipses, g->finer, g->boxes);
}

/* As more and smaller groups are drawn for a budget, errors count for these, too. What a closed surface promises is no
 * less than its parts do, which end somewhere: else all of them would give way at once. */
void conic_layers_bound_groups(conic_layers_node_groups *g) {
  conic_layers_node *node = g->node;
  double error = raise_error(g, node->grouped[0]);
  conic_layers_part_groups(&g->grouping, conic_layers_part_of((uint32_t)node->n_drawn, 2));
  fit_groups(g);
  node->grouped[1] = raise_error(g, node->is_leaf ? 0.0 : error);
  node->grouped[0] = error > node->grouped[1] ? error : node->grouped[1];
  for (int i = 0; i < 2 && !node->is_leaf; i++)
    if (node->children[i]->grouped[0] > node->grouped[0])
      node->grouped[0] = node->children[i]->grouped[0];
}
