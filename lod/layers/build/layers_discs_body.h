/* How far full resolution is from the discs that stand for it, found by holding discs against discs, in lanes of any
 * instruction set. */

#include "core/lanes/lanes.h"
#include "lod/layers/build/layers_thin.h"
#include "lod/layers/format/layers_axes.h"

enum { N_CORNERS = 16, N_PLACES = N_CORNERS + CONIC_LANES, MOST_NEAR = 64 };

static conic_layers_disc disc_of(const conic_layers_chosen *chosen, size_t i) {
  conic_layers_disc disc = {.radius = chosen->radius[i]};
  for (int axis = 0; axis < 3; axis++) {
    disc.center[axis] = chosen->center[axis][i];
    disc.normal[axis] = chosen->normal[axis][i];
  }
  return disc;
}

/* All of the disc is no farther than this from one other: by how high it lies above that, how much it is or may be
 * turned against it, and how far it reaches past it. */
static float error_from_one(const conic_layers_disc *disc, const conic_layers_disc *s, float most2, int is_turn_known) {
  float height = 0.0f, way2 = 0.0f, turn = 1.0f;
  for (int axis = 0; axis < 3; axis++) {
    float way = disc->center[axis] - s->center[axis];
    height += way * s->normal[axis];
    way2 += way * way;
  }
  if (way2 > most2)
    return HUGE_VALF;
  if (is_turn_known) {
    const float *n = disc->normal;
    float cosine = n[0] * s->normal[0] + n[1] * s->normal[1] + n[2] * s->normal[2], sine2 = 1.0f - cosine * cosine;
    turn = sine2 > 0.0f ? sqrtf(sine2) : 0.0f;
  }
  float past = sqrtf(way2) + disc->radius - s->radius;
  return fabsf(height) + disc->radius * turn + (past > 0.0f ? past : 0.0f);
}

/* The same of several chosen ones. */
typedef struct disc_errors {
  lanes error, least; /* no place of the disc is nearer than that */
} disc_errors;

CONIC_INLINE disc_errors errors_from_some(const conic_layers_disc *disc, const conic_layers_chosen *chosen, size_t i) {
  const lanes none = lanes_of(0.0f), radius = lanes_of(disc->radius);
  lanes height = none, way2 = none, cosine = none;
  for (int axis = 0; axis < 3; axis++) {
    lanes way = lanes_of(disc->center[axis]) - lanes_load(chosen->center[axis] + i),
          normal = lanes_load(chosen->normal[axis] + i);
    height += way * normal;
    way2 += way * way;
    cosine += lanes_of(disc->normal[axis]) * normal;
  }
  lanes turned = radius * lanes_sqrt(lanes_max(lanes_of(1.0f) - cosine * cosine, none)),
        own = lanes_load(chosen->radius + i), far = lanes_sqrt(way2), high = lanes_absolute(height);
  return (disc_errors){high + turned + lanes_max(far + radius - own, none),
                       lanes_max(far - radius - own, high - turned)};
}

/* A disc's middle and the corners of a polygon around it, and how far each is from the nearest disc, squared. */
typedef struct disc_places {
  float at[3][N_PLACES], nearest2[N_PLACES];
} disc_places;

/* The polygon is turned by an angle. */
static void lay_out_places(const conic_layers_disc *disc, const float turn[2], disc_places *places) {
  static const float corners[4] = {1.0f, 0.84775907f, 0.56645450f, 0.19891237f};
  float across[N_CORNERS], up[N_CORNERS];
  for (int i = 0; i < N_CORNERS; i++) {
    across[i] = corners[i % 4] * (i & 4 ? -disc->radius : disc->radius);
    up[i] = corners[3 - i % 4] * (i & 8 ? -disc->radius : disc->radius);
  }
  const float *n = disc->normal;
  float sign = n[2] >= 0.0f ? 1.0f : -1.0f, a = -1.0f / (sign + n[2]), b = n[0] * n[1] * a;
  const float u[3] = {1.0f + sign * (n[0] * n[0]) * a, sign * b, -sign * n[0]};
  const float v[3] = {b, sign + n[1] * n[1] * a, -n[1]};
  for (int i = 0; i < N_CORNERS; i += CONIC_LANES) {
    lanes x = lanes_load(across + i), y = lanes_load(up + i);
    lanes along_u = x * turn[0] - y * turn[1], along_v = x * turn[1] + y * turn[0];
    for (int axis = 0; axis < 3; axis++)
      lanes_store(places->at[axis] + i, lanes_of(disc->center[axis]) + along_u * u[axis] + along_v * v[axis]);
    lanes_store(places->nearest2 + i, lanes_of(HUGE_VALF));
  }
  for (int axis = 0; axis < 3; axis++)
    lanes_store(places->at[axis] + N_CORNERS, lanes_of(disc->center[axis]));
  lanes_store(places->nearest2 + N_CORNERS, lanes_of(HUGE_VALF));
}

/* Whether all places are near enough, now that there is this disc, too. */
static int bring_nearer(disc_places *places, const conic_layers_disc *s, float enough2) {
  const lanes none = lanes_of(0.0f);
  lanes farthest2 = none;
  for (int i = 0; i < N_PLACES; i += CONIC_LANES) {
    lanes height = none, way2 = none;
    for (int axis = 0; axis < 3; axis++) {
      lanes way = lanes_load(places->at[axis] + i) - s->center[axis];
      height += way * s->normal[axis];
      way2 += way * way;
    }
    lanes along = lanes_sqrt(lanes_max(way2 - height * height, none)), past = lanes_max(along - s->radius, none);
    lanes nearest2 = lanes_min(height * height + past * past, lanes_load(places->nearest2 + i));
    lanes_store(places->nearest2 + i, nearest2);
    farthest2 = lanes_max(nearest2, farthest2);
  }
  return !lanes_any(lanes_less(lanes_of(enough2), farthest2));
}

static float farthest_of(const disc_places *places) {
  float farthest2 = 0.0f;
  for (int i = 0; i <= N_CORNERS; i++)
    farthest2 = places->nearest2[i] > farthest2 ? places->nearest2[i] : farthest2;
  return sqrtf(farthest2);
}

static float squared(float enough) {
  return enough > 0.0f ? enough * enough : 0.0f;
}

static float disc_off(const conic_layers_disc *disc, const conic_layers_disc *from, size_t n, float enough) {
  static const float turn[2] = {1.0f, 0.0f};
  disc_places places;
  conic_layers_disc wider = *disc;
  const float *at = disc->center;
  wider.radius *= 1.02f; /* corners lie around the disc */
  float rounding =
      1e-6f * (fabsf(at[0]) + fabsf(at[1]) + fabsf(at[2])) + 1e-3f * disc->radius; /* a sine has 3 digits */
  for (size_t i = 0; i < n; i++)                                                   /* one alone does */
    if (error_from_one(&wider, &from[i], HUGE_VALF, 1) * (1.0f + 1e-5f) + rounding <= enough)
      return enough;
  lay_out_places(disc, turn, &places);
  for (size_t i = 0; i < n && !bring_nearer(&places, &from[i], squared(enough)); i++)
    continue;
  return farthest_of(&places);
}

/* A disc that is held against the chosen ones about it. */
typedef struct disc_search {
  const conic_layers_chosen *chosen;
  const conic_layers_disc *disc;
  float beside2; /* what is nearer is in the rows */
  conic_thinner_rows rows;
  uint32_t near[MOST_NEAR]; /* some that may be near enough */
  size_t n_near;
} disc_search;

/* How far the disc is from those of all rows, or from the near ones; where it is no more than `enough`, any number that
 * is not. */
static float error_of_places(const disc_search *p, int are_near, const float turn[2], float enough) {
  disc_places places;
  float enough2 = squared(enough);
  lay_out_places(p->disc, turn, &places);
  for (size_t i = 0; i < p->n_near && are_near; i++) {
    const conic_layers_disc s = disc_of(p->chosen, p->near[i]);
    if (bring_nearer(&places, &s, enough2))
      break;
  }
  for (size_t i_row = 0; i_row < p->rows.n && !are_near; i_row++)
    for (uint32_t i = p->rows.list[i_row].begin; i < p->rows.list[i_row].end; i++) {
      const conic_layers_disc s = disc_of(p->chosen, i);
      if (bring_nearer(&places, &s, enough2))
        return farthest_of(&places);
    }
  return farthest_of(&places);
}

/* Looks also at corners of the same polygon turned, where places between the corners could come to more than enough.
 * They lie within a fifth of the radius of its corners, so that nothing else decides whether one counts. */
static float error_of_more_places(const disc_search *p, int are_near, float enough) {
  static const float turns[4][2] = {
      {1.0f, 0.0f}, {0.99518473f, 0.09801714f}, {0.98078528f, 0.19509032f}, {0.95694034f, 0.29028468f}};
  float nearly = enough - 0.2f * p->disc->radius, farthest = error_of_places(p, are_near, turns[0], nearly);
  for (int i = 1; i < 4 && farthest > nearly; i++) {
    float error = error_of_places(p, are_near, turns[i], enough);
    farthest = error > farthest ? error : farthest;
  }
  return farthest;
}

/* The least error from one of those about the disc. The first that is near enough becomes *last; else, those are listed
 * of which some places may be near enough. */
static float error_from_rows(disc_search *p, int is_wide, float enough, uint32_t *last) {
  float least = HUGE_VALF, errors[CONIC_LANES];
  p->n_near = 0;
  conic_thinner_beside(p->chosen->thinner, p->disc->center, is_wide, &p->rows);
  for (size_t i_row = 0; i_row < p->rows.n; i_row++)
    for (uint32_t i = p->rows.list[i_row].begin; i < p->rows.list[i_row].end; i += CONIC_LANES) {
      const lanes_mask is_in =
          lanes_less_int(ints_of_indices(lanes_ascending(i)), lanes_of_int((int32_t)p->rows.list[i_row].end));
      const disc_errors found = errors_from_some(p->disc, p->chosen, i);
      unsigned may = lanes_bits(is_in) & ~lanes_bits(lanes_less(lanes_of(enough), found.least));
      lanes_store(errors, lanes_select(is_in, found.error, lanes_of(HUGE_VALF)));
      for (; may; may &= may - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(may);
        if (errors[lane] <= enough) {
          *last = i + lane;
          return errors[lane];
        }
        if (p->n_near < MOST_NEAR)
          p->near[p->n_near++] = i + lane;
      }
      for (int lane = 0; lane < CONIC_LANES; lane++)
        least = errors[lane] < least ? errors[lane] : least;
    }
  return least;
}

/* How far the disc is from the chosen ones; `enough`, or less, where it is no more than that. *last is one that may do,
 * and then the one that did. */
static float error_of_disc(disc_search *p, float enough, uint32_t *last) {
  const conic_layers_disc before = disc_of(p->chosen, *last);
  float least = error_from_one(p->disc, &before, p->beside2, 1), measured = HUGE_VALF;
  for (int is_wide = 0; is_wide < 2 && !(least <= enough); is_wide++) {
    least = error_from_rows(p, is_wide, enough, last);
    if (!(least <= enough) && p->n_near > 0)
      measured = error_of_more_places(p, 1, enough);
    if (measured <= enough)
      return measured;
  }
  if (least <= enough)
    return least;
  /* NOLINTNEXTLINE(clang-analyzer-core.*): rows were looked for above */
  if (p->rows.n == 0) {
    const conic_layers_disc first = disc_of(p->chosen, conic_thinner_first(p->chosen->thinner));
    return error_from_one(p->disc, &first, HUGE_VALF, 1);
  }
  measured = error_of_more_places(p, 0, enough);
  return measured < least ? measured : least;
}

static double disc_error(const conic_layers_chosen *chosen, const conic_layers_disc *discs, size_t n, double beyond,
                         double error) {
  disc_search p;
  uint32_t last = conic_thinner_first(chosen->thinner);
  p.chosen = chosen;
  p.beside2 = conic_thinner_beside2(chosen->thinner);
  conic_layers_disc before = disc_of(chosen, last);
  for (size_t i = 0; i < n; i++) {
    float enough = (float)(error - beyond);
    if (error_from_one(&discs[i], &before, p.beside2, 0) <= enough)
      continue;
    conic_layers_disc disc = discs[i];
    if (disc.code)
      conic_layers_normal_of(disc.code, disc.normal);
    p.disc = &disc;
    double found = (double)error_of_disc(&p, enough, &last) + beyond;
    before = disc_of(chosen, last);
    error = found > error ? found : error;
  }
  return error;
}
