/* Which Gaussians are merged: pairs of neighbours, the cheapest first. */

#include "core/base/heap.h"
#include "core/base/vectors.h"
#include "core/estimate/neighbours.h"
#include "core/splats/kernel.h"
#include "lod/blends/blend.h"

enum { NEAREST = 8, MOST_EDGES = 24 };

/* A Gaussian as an axis sees it. */
typedef struct shadow {
  double x, y, xx, xy, yy;
} shadow;

static shadow shadow_of(const conic_blend *b, int axis) {
  static const int planes[3][5] = {{1, 2, 3, 4, 5}, {0, 2, 0, 2, 5}, {0, 1, 0, 1, 3}};
  const int *p = planes[axis];
  return (shadow){b->mean[p[0]], b->mean[p[1]], b->covariance[p[2]], b->covariance[p[3]], b->covariance[p[4]]};
}

static double root_of(const shadow *s) {
  const double d = s->xx * s->yy - s->xy * s->xy;
  return d > 0.0 ? sqrt(d) : 0.0;
}

/* The integral of two bells' product, over 2π. */
static double overlap(const shadow *a, const shadow *b, double roots) {
  const double xx = a->xx + b->xx, xy = a->xy + b->xy, yy = a->yy + b->yy, det = xx * yy - xy * xy;
  const double x = a->x - b->x, y = a->y - b->y;
  if (!(det > 0.0))
    return 0.0;
  const double q = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / det;
  return roots / sqrt(det) * (double)conic_exp_negative((float)(-0.5 * q));
}

/* How much the square of an opacity counts beside that of a colour. */
static const double of_opacity = 0.2;

/* The squares of both, less those of one bell that has as much light and the same moments. */
static double cost_from(const conic_blend *a, const conic_blend *b, int axis) {
  const shadow s[2] = {shadow_of(a, axis), shadow_of(b, axis)};
  const double o[2] = {(double)a->row[CONIC_BLEND_OPACITY], (double)b->row[CONIC_BLEND_OPACITY]};
  const double roots[2] = {root_of(&s[0]), root_of(&s[1])}, wa = o[0] * a->area, wb = o[1] * b->area;
  const double part = wa + wb > 0.0 ? wa / (wa + wb) : 0.5, dx = s[0].x - s[1].x, dy = s[0].y - s[1].y;
  const double between = part * (1.0 - part), rest = 1.0 - part;
  const shadow m = {
      part * s[0].x + rest * s[1].x, part * s[0].y + rest * s[1].y, part * s[0].xx + rest * s[1].xx + between * dx * dx,
      part * s[0].xy + rest * s[1].xy + between * dx * dy, part * s[0].yy + rest * s[1].yy + between * dy * dy};
  const double root = root_of(&m);
  const double level = root > 0.0 ? fmin(1.0, (o[0] * roots[0] + o[1] * roots[1]) / root) : 0.0;
  double aa = of_opacity, ab = aa, bb = aa, am = aa, bm = aa, mm = aa;
  for (int c = 0; c < 3; c++) {
    const double cm = part * a->color[c] + rest * b->color[c];
    aa += a->color[c] * a->color[c];
    ab += a->color[c] * b->color[c];
    bb += b->color[c] * b->color[c];
    am += a->color[c] * cm;
    bm += b->color[c] * cm;
    mm += cm * cm;
  }
  const double square = 0.5 * (o[0] * o[0] * aa * roots[0] + o[1] * o[1] * bb * roots[1] + level * level * mm * root) +
                        2.0 * o[0] * o[1] * ab * overlap(&s[0], &s[1], roots[0] * roots[1]) -
                        2.0 * o[0] * level * am * overlap(&s[0], &m, roots[0] * root) -
                        2.0 * o[1] * level * bm * overlap(&s[1], &m, roots[1] * root);
  return sqrt(fmax(square, 0.0) * root);
}

/* What two would lose if they were one, about. */
static double find_cost(const conic_blend *a, const conic_blend *b) {
  return cost_from(a, b, 0) + cost_from(a, b, 1) + cost_from(a, b, 2);
}

/* A node of those that are merged: a Gaussian, or a pair of such. */
typedef struct blend_knot {
  uint32_t into; /* what it became part of; itself: it is still there */
  uint32_t n_parts, n_near;
  uint32_t near[MOST_EDGES], best; /* neighbours, which may have been merged since; best: the cheapest of them */
  double costs[MOST_EDGES];        /* below 0: not found yet */
} blend_knot;

typedef struct blend_merging {
  conic_context *context;
  const conic_blend *blends;
  size_t n, n_knots;
  conic_blend *now; /* by knot */
  float (*rows)[CONIC_BLEND_HARMONICS + 3];
  blend_knot *knots;
  conic_heap heap;
} blend_merging;

static uint32_t root_knot(const blend_merging *m, uint32_t i) {
  while (m->knots[i].into != i)
    i = m->knots[i].into;
  return i;
}

static int is_near(const blend_knot *k, uint32_t n, uint32_t other) {
  for (uint32_t e = 0; e < n; e++)
    if (k->near[e] == other)
      return 1;
  return 0;
}

/* Finds a knot's cheapest partner and puts it into the queue. */
static void enqueue(blend_merging *m, uint32_t i) {
  blend_knot *k = &m->knots[i];
  uint32_t n = 0;
  double least = HUGE_VAL;
  for (uint32_t e = 0; e < k->n_near; e++) {
    const uint32_t other = root_knot(m, k->near[e]);
    if (other == i || is_near(k, n, other))
      continue;
    const double known = other == k->near[e] ? k->costs[e] : -1.0;
    k->near[n] = other;
    k->costs[n++] = known;
    if (k->n_parts + m->knots[other].n_parts > CONIC_BLEND_MOST_PARTS)
      continue;
    k->costs[n - 1] = known < 0.0 ? find_cost(&m->now[i], &m->now[other]) : known;
    if (k->costs[n - 1] < least) {
      least = k->costs[n - 1];
      k->best = other;
    }
  }
  k->n_near = n;
  m->heap.keys[i] = least;
  if (least < HUGE_VAL)
    conic_heap_push(&m->heap, i);
}

static void join_knots(blend_merging *m, uint32_t a, uint32_t b) {
  const uint32_t i = (uint32_t)m->n_knots++;
  blend_knot *k = &m->knots[i];
  const conic_blend parts[2] = {m->now[a], m->now[b]};
  conic_blend_merge(parts, 2, 0, m->rows[i]);
  conic_blend_take(m->rows[i], 0, &m->now[i]);
  *k = (blend_knot){.into = i, .n_parts = m->knots[a].n_parts + m->knots[b].n_parts};
  m->knots[a].into = m->knots[b].into = i;
  const blend_knot *both[2] = {&m->knots[a], &m->knots[b]};
  for (uint32_t e = 0; e < MOST_EDGES; e++) /* in turns, so that neither's are left out */
    for (int side = 0; side < 2; side++)
      if (e < both[side]->n_near && k->n_near < MOST_EDGES) {
        const uint32_t other = root_knot(m, both[side]->near[e]);
        int is_known = other == i;
        for (uint32_t f = 0; f < k->n_near; f++)
          is_known |= k->near[f] == other;
        if (!is_known)
          k->costs[k->n_near] = -1.0;
        k->near[k->n_near++] = other;
      }
  enqueue(m, i);
}

static conic_status find_near(blend_merging *m) {
  float *places[3] = {NULL, NULL, NULL};
  conic_neighbours tree;
  conic_status status = conic_memory_allocate_these(m->context, CONIC_ROOM(places[0], m->n),
                                                    CONIC_ROOM(places[1], m->n), CONIC_ROOM(places[2], m->n));
  for (size_t i = 0; status == CONIC_OK && i < m->n; i++)
    for (int axis = 0; axis < 3; axis++)
      places[axis][i] = (float)m->blends[i].mean[axis];
  if (status == CONIC_OK)
    status = conic_neighbours_build(m->context, (const float *const *)places, m->n, &tree);
  if (status == CONIC_OK) {
    for (size_t i = 0; i < m->n; i++) {
      uint32_t slots[NEAREST];
      double distances2[NEAREST];
      const uint32_t own = tree.slot_of_point[i];
      blend_knot *k = &m->knots[i];
      *k = (blend_knot){.into = (uint32_t)i, .n_parts = 1};
      const uint32_t first = tree.point_of_slot[own];
      size_t n = conic_neighbours_nearest(&tree, m->blends[i].mean, own, NEAREST, HUGE_VAL, slots, distances2);
      if (first != i) /* at the same place */
        k->near[k->n_near++] = first;
      for (size_t e = 0; e < n; e++)
        k->near[k->n_near++] = tree.point_of_slot[slots[e]];
      for (size_t e = 0; e < MOST_EDGES; e++)
        k->costs[e] = -1.0;
    }
    conic_neighbours_release(m->context, &tree);
  }
  conic_memory_release_these(m->context, places[0], places[1], places[2]);
  return status;
}

/* Where neighbours were not enough, as with many at one place: joins what follows each other. */
static void join_in_order(blend_merging *m, size_t n_left, size_t n_wanted) {
  size_t n_before = n_left + 1;
  while (n_left > n_wanted && n_left < n_before) {
    const size_t end = m->n_knots;
    uint32_t before = UINT32_MAX;
    n_before = n_left;
    for (uint32_t i = 0; i < end && n_left > n_wanted; i++) {
      if (m->knots[i].into != i)
        continue;
      const int is_pair =
          before != UINT32_MAX && m->knots[before].n_parts + m->knots[i].n_parts <= CONIC_BLEND_MOST_PARTS;
      if (is_pair)
        join_knots(m, before, i);
      n_left -= (size_t)is_pair;
      before = is_pair ? UINT32_MAX : i;
    }
  }
}

/* Numbers what is left by first parts. */
static size_t number_groups(const blend_merging *m, uint32_t *group) {
  uint32_t n = 0;
  for (size_t i = 0; i < m->n_knots; i++)
    m->knots[i].best = UINT32_MAX;
  for (size_t i = 0; i < m->n; i++) {
    blend_knot *k = &m->knots[root_knot(m, (uint32_t)i)];
    if (k->best == UINT32_MAX)
      k->best = n++;
    group[i] = k->best;
  }
  return n;
}

conic_status conic_blend_group(conic_context *context, const conic_blend *blends, size_t n, size_t n_wanted,
                               uint32_t *group, size_t *n_groups) {
  blend_merging m = {.context = context, .blends = blends, .n = n, .n_knots = n};
  size_t n_left = n;
  conic_status status = conic_memory_allocate_these(context, CONIC_ROOM(m.now, 2 * n), CONIC_ROOM(m.rows, 2 * n),
                                                    CONIC_ROOM(m.knots, 2 * n), CONIC_ROOM(m.heap.slots, 2 * n),
                                                    CONIC_ROOM(m.heap.keys, 2 * n));
  if (status == CONIC_OK)
    status = find_near(&m);
  if (status == CONIC_OK) {
    memcpy(m.now, blends, n * sizeof *blends);
    for (size_t i = 0; i < n; i++)
      enqueue(&m, (uint32_t)i);
    while (n_left > n_wanted && m.heap.n > 0) {
      const uint32_t i = conic_heap_pop(&m.heap), other = m.knots[i].best;
      if (m.knots[i].into != i)
        continue;
      if (m.knots[other].into != other || m.knots[i].n_parts + m.knots[other].n_parts > CONIC_BLEND_MOST_PARTS) {
        enqueue(&m, i);
        continue;
      }
      join_knots(&m, i, other);
      n_left--;
    }
    join_in_order(&m, n_left, n_wanted);
    *n_groups = number_groups(&m, group);
  }
  conic_memory_release_these(context, m.now, m.rows, m.knots, m.heap.slots, m.heap.keys);
  return status;
}
