#include "oracle/oracle_bounds.h"

/* More surfaces than this that may be the foremost are taken as one. */
enum { MOST_SURFACES = 12 };

/* What the search has at hand while it goes through one pixel's alternatives. */
typedef struct bounding_search {
  const oracle_bounding *room;
  double x, y;
  const oracle_fragment *fragments;
  size_t n, first_id;
  conic_alternative *now;
  oracle_doubts *doubts;
  int is_unbounded;
} bounding_search;

void conic_oracle_doubts_release(oracle_doubts *doubts) {
  conic_memory_release_these(doubts->context, doubts->alternatives, doubts->ids);
}

conic_status conic_oracle_doubts_add(oracle_doubts *doubts, const conic_alternative *alternative) {
  return conic_memory_append(doubts->context, &doubts->alternatives, &doubts->n, &doubts->room, alternative,
                             sizeof *alternative);
}

conic_status conic_oracle_doubts_admit(oracle_doubts *doubts, size_t first, uint32_t pixel, uint32_t id) {
  for (size_t i = first; i < doubts->n_ids; i++)
    if (doubts->ids[i].id == id || doubts->ids[i].id == CONIC_ANY_ID)
      return CONIC_OK;
  if (doubts->n_ids - first == ORACLE_MAX_IDS) {
    doubts->n_ids = first;
    id = CONIC_ANY_ID;
  }
  const conic_admissible_id admitted = {pixel, id};
  return conic_memory_append(doubts->context, &doubts->ids, &doubts->n_ids, &doubts->id_room, &admitted,
                             sizeof admitted);
}

/* A value of a part's: its least, or its greatest. */
typedef double value_of(const oracle_part *part, const void *which, int side);

static double color_limit(const oracle_part *part, const void *which, int side) {
  const oracle_splat *splat = part->fragment->candidate->splat;
  return splat->color[*(const int *)which] + (side ? splat->color_error : -splat->color_error);
}

static double normal_limit(const oracle_part *part, const void *which, int side) {
  return part->fragment->candidate->splat->normals[side][*(const int *)which];
}

static double along(const oracle_part *part, const void *which, int side) {
  const double *d = which;
  double sum = 0.0;
  for (int c = 0; c < 3; c++)
    sum += d[c] * part->fragment->candidate->splat->normals[side ^ (d[c] < 0.0)][c];
  return sum;
}

/* The extremes of Σ w v / Σ w. Where it is greatest, what lies above it has its most weight, and what lies below its
 * least: from any value, to go on to what these weights make leads upwards, and stops at the top. */
static void find_mean_range(const oracle_mixture *mixture, value_of *value, const void *which, double range[2]) {
  for (int side = 0; side < 2; side++) {
    double sign = side ? 1.0 : -1.0, best = -INFINITY;
    for (int round = 0; round < 64; round++) {
      double sum = 0.0, weights = 0.0;
      for (size_t i = 0; i < mixture->n; i++) {
        const oracle_part *part = &mixture->parts[i];
        double v = sign * value(part, which, side), weight = v > best ? part->most : part->least;
        sum += weight > 0.0 ? weight * v : 0.0;
        weights += weight;
      }
      if (!(weights > 0.0) || !(sum / weights > best))
        break;
      best = sum / weights;
    }
    range[side] = sign * best;
  }
}

void conic_oracle_mean_along(const oracle_mixture *mixture, const double d[3], double range[2]) {
  find_mean_range(mixture, along, d, range);
}

void conic_oracle_direction_range(const double box[2][3], double low[3], double high[3]) {
  double least[3], most[3]; /* the components' sizes */
  int holds_zero = 1;
  for (int c = 0; c < 3; c++) {
    int straddles = box[0][c] <= 0.0 && box[1][c] >= 0.0;
    least[c] = straddles ? 0.0 : oracle_min(fabs(box[0][c]), fabs(box[1][c]));
    most[c] = oracle_max(fabs(box[0][c]), fabs(box[1][c]));
    holds_zero &= straddles;
  }
  for (int c = 0; c < 3; c++) {
    int b = (c + 1) % 3, d = (c + 2) % 3;
    double nearest = least[b] * least[b] + least[d] * least[d], farthest = most[b] * most[b] + most[d] * most[d];
    double up = box[1][c], down = box[0][c];
    double across_up = up > 0.0 ? nearest : farthest, across_down = down < 0.0 ? nearest : farthest;
    high[c] = holds_zero ? 1.0 : up / sqrt(oracle_max(up * up + across_up, 1e-300));
    low[c] = holds_zero ? -1.0 : down / sqrt(oracle_max(down * down + across_down, 1e-300));
  }
}

/* Count, weight, and Z, which is that of the heaviest. */
static void bound_sums(const oracle_mixture *mixture, int is_one, conic_alternative *now) {
  double n_sure = 0.0, weight[2] = {0.0, 0.0}, lightest = INFINITY, heaviest = 0.0, sure = 0.0, z[2] = {INFINITY, 0.0};
  for (size_t i = 0; i < mixture->n; i++) {
    const oracle_part *part = &mixture->parts[i];
    n_sure += part->least > 0.0;
    weight[0] += part->least;
    weight[1] += part->most;
    lightest = oracle_min(lightest, part->fragment->weights.low);
    heaviest = oracle_max(heaviest, part->most);
    sure = oracle_max(sure, part->least);
  }
  for (size_t i = 0; i < mixture->n; i++)
    if (is_one || mixture->parts[i].most >= sure) {
      z[0] = oracle_min(z[0], mixture->parts[i].fragment->depths.low);
      z[1] = oracle_max(z[1], mixture->parts[i].fragment->depths.high);
    }
  now->low[ORACLE_AT_COUNT] = oracle_max(n_sure, 1.0);
  now->high[ORACLE_AT_COUNT] = is_one ? 1.0 : (double)mixture->n;
  now->low[ORACLE_AT_WEIGHT] = n_sure > 0.0 ? weight[0] : lightest;
  now->high[ORACLE_AT_WEIGHT] = is_one ? heaviest : weight[1];
  now->low[ORACLE_AT_Z] = z[0];
  now->high[ORACLE_AT_Z] = z[1];
}

/* Of a colour that may be anything, nothing is said. */
static void forget_colors(conic_alternative *now) {
  for (int c = 0; c < 3; c++) {
    now->low[ORACLE_AT_ALBEDO + c] = now->low[ORACLE_AT_RGBA + c] = -INFINITY;
    now->high[ORACLE_AT_ALBEDO + c] = now->high[ORACLE_AT_RGBA + c] = INFINITY;
  }
}

static void bound_colors(bounding_search *s, const oracle_mixture *mixture) {
  oracle_surface_range range;
  conic_alternative *now = s->now;
  int is_known = 1;
  for (size_t i = 0; i < mixture->n; i++)
    is_known &= oracle_is_finite(mixture->parts[i].fragment->candidate->splat->color_error);
  for (int c = 0; c < 3; c++) {
    double found[2];
    find_mean_range(mixture, color_limit, &c, found);
    range.albedo[0][c] = now->low[ORACLE_AT_ALBEDO + c] = found[0];
    range.albedo[1][c] = now->high[ORACLE_AT_ALBEDO + c] = found[1];
    find_mean_range(mixture, normal_limit, &c, found);
    range.mean_normal[0][c] = found[0];
    range.mean_normal[1][c] = found[1];
  }
  conic_oracle_direction_range((const double(*)[3])range.mean_normal, range.normal[0], range.normal[1]);
  memcpy(now->low + ORACLE_AT_NORMAL, range.normal[0], sizeof range.normal[0]);
  memcpy(now->high + ORACLE_AT_NORMAL, range.normal[1], sizeof range.normal[1]);
  conic_oracle_shade_range(s->room->camera, s->room->options, s->x, s->y, mixture, &range, now->low + ORACLE_AT_RGBA,
                           now->high + ORACLE_AT_RGBA);
  if (!is_known)
    forget_colors(now);
  s->is_unbounded |= !is_known;
}

/* Whether two are exactly as near, and the first has the lower number. */
static int precedes(const oracle_fragment *a, const oracle_fragment *b) {
  return a->candidate->splat->index < b->candidate->splat->index && conic_oracle_are_as_near(a, b);
}

/* Whether something that is surely there is nearer, or as near and comes first. */
static int is_farther(const oracle_mixture *mixture, const oracle_part *part) {
  for (size_t i = 0; i < mixture->n; i++) {
    const oracle_part *other = &mixture->parts[i];
    if (other == part || !(other->least > 0.0))
      continue;
    if (other->fragment->nearness.low > part->fragment->nearness.high)
      return 1;
    if (precedes(other->fragment, part->fragment))
      return 1;
  }
  return 0;
}

static conic_status admit_ids(bounding_search *s, const oracle_mixture *mixture) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < mixture->n && status == CONIC_OK; i++)
    if (!is_farther(mixture, &mixture->parts[i]))
      status = conic_oracle_doubts_admit(s->doubts, s->first_id, s->now->pixel,
                                         mixture->parts[i].fragment->candidate->splat->index);
  return status;
}

/* What the mixture may make of the pixel; with is_one, one of it alone does. */
static conic_status add_mixture(bounding_search *s, const oracle_mixture *mixture, int is_one) {
  bound_sums(mixture, is_one, s->now);
  bound_colors(s, mixture);
  conic_status status = admit_ids(s, mixture);
  return status == CONIC_OK ? conic_oracle_doubts_add(s->doubts, s->now) : status;
}

/* A pixel that nothing covers. */
static conic_status add_nothing(bounding_search *s) {
  memset(s->now->low, 0, sizeof s->now->low);
  conic_oracle_background(s->room->options, s->now->low + ORACLE_AT_RGBA);
  memcpy(s->now->high, s->now->low, sizeof s->now->low);
  conic_status status = conic_oracle_doubts_admit(s->doubts, s->first_id, s->now->pixel, CONIC_NO_ID);
  return status == CONIC_OK ? conic_oracle_doubts_add(s->doubts, s->now) : status;
}

/* The fragments' numbers, ordered by how near they may be, or may hide from, at most: the nearest first. */
static double order_key(const oracle_fragment *f, int by_nearness) {
  return by_nearness ? f->nearness.high : f->hides.high;
}
static void sift_down(const bounding_search *s, int by_nearness, size_t i, size_t n) {
  uint32_t *order = s->room->order;
  for (size_t child = 2 * i + 1; child < n; child = 2 * i + 1) {
    if (child + 1 < n &&
        order_key(&s->fragments[order[child + 1]], by_nearness) < order_key(&s->fragments[order[child]], by_nearness))
      child++;
    if (order_key(&s->fragments[order[child]], by_nearness) >= order_key(&s->fragments[order[i]], by_nearness))
      return;
    uint32_t swapped = order[child];
    order[child] = order[i];
    order[i] = swapped;
    i = child;
  }
}
static void sort_fragments(const bounding_search *s, int by_nearness) {
  uint32_t *order = s->room->order;
  for (size_t i = 0; i < s->n; i++)
    order[i] = (uint32_t)i;
  for (size_t i = s->n / 2; i-- > 0;)
    sift_down(s, by_nearness, i, s->n);
  for (size_t end = s->n; end-- > 1;) {
    uint32_t swapped = order[0];
    order[0] = order[end];
    order[end] = swapped;
    sift_down(s, by_nearness, 0, end);
  }
}

/* Some of the ordered fragments. One of them hides the most of all fragments: all that is seen below a place, which
 * lies between `low` and `high`. */
typedef struct surface {
  size_t begin, end;
  double low, high;
} surface;

/* What is seen if the surface is the foremost. What would hide more does then not cover. */
static conic_status add_surface(bounding_search *s, const surface *front) {
  oracle_mixture mixture = {s->room->parts, 0};
  const uint32_t *order = s->room->order;
  int is_alone = front->end - front->begin == 1;
  double but_for_first = is_alone ? -INFINITY : s->fragments[order[front->begin + 1]].hides.high;
  for (size_t i = 0; i < s->n; i++) {
    const oracle_fragment *f = &s->fragments[i];
    int is_first = order[front->begin] == i;
    if (f->hides.low > front->high || f->seen.high < front->low)
      continue;
    int is_sure = (is_first && is_alone) || (!f->may_miss && f->seen.low >= (is_first ? but_for_first : front->high));
    mixture.parts[mixture.n++] = (oracle_part){f, is_sure ? f->weights.low : 0.0, f->weights.high};
  }
  return mixture.n ? add_mixture(s, &mixture, 0) : CONIC_OK;
}

/* One alternative for every surface that may be the foremost. Surfaces whose places overlap count as one. */
static conic_status add_surfaces(bounding_search *s) {
  conic_status status = CONIC_OK;
  const uint32_t *order = s->room->order;
  double least = -INFINITY;
  size_t i = 0;
  sort_fragments(s, 0);
  for (size_t k = 0; k < s->n; k++)
    if (!s->fragments[k].may_miss)
      least = oracle_max(least, s->fragments[k].hides.low);
  for (int n_surfaces = 1; i < s->n && s->fragments[order[i]].hides.high >= least && status == CONIC_OK; n_surfaces++) {
    surface front = {i, i + 1, s->fragments[order[i]].hides.low, s->fragments[order[i]].hides.high};
    for (i++; i < s->n; i++) {
      const oracle_fragment *next = &s->fragments[order[i]];
      if (next->hides.high < least || (n_surfaces < MOST_SURFACES && next->hides.high < front.low))
        break;
      front.low = oracle_min(front.low, next->hides.low);
    }
    front.end = i;
    front.low = oracle_max(front.low, least);
    status = add_surface(s, &front);
  }
  return status;
}

/* Whether something surely there is exactly as near and comes first. */
static int comes_second(const bounding_search *s, const oracle_fragment *f) {
  for (size_t i = 0; i < s->n; i++)
    if (!s->fragments[i].may_miss && precedes(&s->fragments[i], f))
      return 1;
  return 0;
}

/* In one pass the nearest alone makes the pixel: one alternative for each that may be; the farthest of many as one. */
static conic_status add_nearest(bounding_search *s) {
  conic_status status = CONIC_OK;
  double least = -INFINITY;
  sort_fragments(s, 1);
  for (size_t i = 0; i < s->n; i++)
    if (!s->fragments[i].may_miss)
      least = oracle_max(least, s->fragments[i].nearness.low);
  oracle_mixture rest = {s->room->parts, 0};
  int n_single = 0;
  for (size_t i = 0; i < s->n && status == CONIC_OK; i++) {
    const oracle_fragment *f = &s->fragments[s->room->order[i]];
    if (f->nearness.high < least)
      break;
    if (comes_second(s, f))
      continue;
    int is_single = n_single++ < MOST_SURFACES;
    rest.parts[rest.n++] = (oracle_part){f, is_single ? f->weights.low : 0.0, f->weights.high};
    if (is_single) {
      status = add_mixture(s, &rest, 1);
      rest.n = 0;
    }
  }
  return rest.n && status == CONIC_OK ? add_mixture(s, &rest, 1) : status;
}

static conic_status add_fragments(bounding_search *s) {
  int is_covered = 0;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < s->n; i++)
    is_covered |= !s->fragments[i].may_miss;
  if (!is_covered)
    status = add_nothing(s);
  if (!s->n || status != CONIC_OK)
    return status;
  return s->room->options->passes == 1 ? add_nearest(s) : add_surfaces(s);
}

conic_status conic_oracle_bound(const oracle_bounding *room, double x, double y, uint32_t pixel,
                                oracle_fragment *fragments, size_t n, const oracle_rivals *rivals,
                                oracle_doubts *doubts, int *is_unbounded) {
  conic_alternative now = {.pixel = pixel};
  bounding_search s = {room, x, y, fragments, n, doubts->n_ids, &now, doubts, 0};
  conic_status status = CONIC_OK;
  if (!rivals || rivals->may_be_none)
    status = add_fragments(&s);
  s.n = n + 1;
  for (int i = 0; rivals && i < rivals->n && status == CONIC_OK; i++) {
    fragments[n] = rivals->fragments[i];
    status = add_fragments(&s);
  }
  *is_unbounded = s.is_unbounded || (rivals && rivals->is_crowded);
  return status;
}
