/* An image held against the oracle's reference. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "oracle/oracle_pixel.h"

static const double bounds[CONIC_N_PLANES] = {
    [CONIC_PLANE_RGBA] = ORACLE_COLOR_BOUND,
    [CONIC_PLANE_Z] = ORACLE_Z_BOUND,
    [CONIC_PLANE_NORMAL] = ORACLE_NORMAL_BOUND,
    [CONIC_PLANE_ALBEDO] = ORACLE_COLOR_BOUND,
    [CONIC_PLANE_WEIGHT] = ORACLE_WEIGHT_BOUND,
    [CONIC_PLANE_COUNT] = 0.0,
    [CONIC_PLANE_ID] = 0.0,
};

/* Of the judged pixels. */
static const double unbounded_limit = 0.001;

/* Where the planes' channels stand in an alternative. */
static const int places[CONIC_N_DRAWN_PLANES] = {
    [CONIC_PLANE_RGBA] = ORACLE_AT_RGBA,     [CONIC_PLANE_Z] = ORACLE_AT_Z,
    [CONIC_PLANE_NORMAL] = ORACLE_AT_NORMAL, [CONIC_PLANE_ALBEDO] = ORACLE_AT_ALBEDO,
    [CONIC_PLANE_WEIGHT] = ORACLE_AT_WEIGHT, [CONIC_PLANE_COUNT] = ORACLE_AT_COUNT,
};

/* What a pixel is off by in each plane. */
typedef struct errors {
  double planes[CONIC_N_DRAWN_PLANES], severity; /* the greatest of them in bounds */
  conic_oracle_fault fault;                      /* where that is, but for the place */
} errors;

/* A pixel of the reference, and what is noted of its doubts. */
typedef struct judged {
  const conic_reference *reference;
  const conic_image *image;
  size_t i, at; /* in the reference, in the image */
  const conic_alternative *alternatives;
  const conic_admissible_id *ids;
  size_t n_alternatives, n_ids;
} judged;

static double sample(const conic_image *image, conic_plane plane, int is_uint, size_t at) {
  if (is_uint)
    return (double)((const uint32_t *)image->planes[plane])[at];
  return (double)((const float *)image->planes[plane])[at];
}

/* What a difference in a plane is measured by. */
static double scale_of(const conic_reference *reference, conic_plane plane, double expected) {
  switch (plane) {
  case CONIC_PLANE_Z:
    return expected != 0.0 ? fabs(expected) : 1.0;
  case CONIC_PLANE_RGBA:
    return reference->white * oracle_max(1.0, fabs(expected) / reference->white);
  case CONIC_PLANE_ALBEDO:
  case CONIC_PLANE_WEIGHT:
    return oracle_max(1.0, fabs(expected));
  default:
    return 1.0;
  }
}

static int is_admissible(const judged *j, double id) {
  for (size_t i = 0; i < j->n_ids; i++)
    if (j->ids[i].id == CONIC_ANY_ID || (double)j->ids[i].id == id)
      return 1;
  return 0;
}

/* How far a value is outside of what it may be. */
static double find_excess(const judged *j, conic_plane plane, int channel, const conic_oracle_fault *value) {
  double found = value->found, expected = found < value->low ? value->low : value->high;
  int is_alpha = plane == CONIC_PLANE_RGBA && channel == 3;
  if (found >= value->low && found <= value->high)
    return 0.0;
  if (plane == CONIC_PLANE_ID && is_admissible(j, found))
    return 0.0;
  double excess = fabs(found - expected) / (is_alpha ? 1.0 : scale_of(j->reference, plane, expected));
  return excess == excess ? excess : INFINITY;
}

/* How a pixel's value in a channel compares with the reference's, or with the alternative's. */
static void judge_channel(const judged *j, conic_plane plane, int channel, const conic_alternative *alternative,
                          errors *e) {
  const conic_plane_description *about = conic_plane_describe(plane);
  size_t n = (size_t)about->n_channels, c = (size_t)channel;
  double expected = j->reference->planes[plane][n * j->i + c];
  conic_oracle_fault value = {.plane = (int)plane, .channel = channel, .low = expected, .high = expected};
  value.found = sample(j->image, plane, about->is_uint, n * j->at + c);
  if (alternative && plane != CONIC_PLANE_ID) {
    value.low = alternative->low[places[plane] + channel];
    value.high = alternative->high[places[plane] + channel];
  }
  double excess = find_excess(j, plane, channel, &value), severity = 0.0;
  if (j->n_alternatives && plane == CONIC_PLANE_ID && !is_admissible(j, value.found))
    excess = oracle_max(excess, 1.0);
  if (excess > 0.0) /* what has to be exact is wrong by no more than just wrong */
    severity = bounds[plane] > 0.0 ? excess / bounds[plane] : 1.0 + 1e-9;
  e->planes[plane] = oracle_max(e->planes[plane], excess);
  if (severity > e->severity) {
    e->severity = severity;
    e->fault = value;
  }
}

static void judge_planes(const judged *j, const conic_alternative *alternative, errors *e) {
  memset(e, 0, sizeof *e);
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++) /* the others are names, given after drawing */
    for (int c = 0; j->image->planes[plane] && c < conic_plane_describe((conic_plane)plane)->n_channels; c++)
      judge_channel(j, (conic_plane)plane, c, alternative, e);
}

/* Of several alternatives the one that fits best. */
static void compare_pixel(const judged *j, errors *e) {
  judge_planes(j, j->n_alternatives ? &j->alternatives[0] : NULL, e);
  for (size_t i = 1; i < j->n_alternatives && e->severity > 0.0; i++) {
    errors other;
    judge_planes(j, &j->alternatives[i], &other);
    if (other.severity < e->severity)
      *e = other;
  }
}

/* The pixel after the one given, in the reference's order. */
static void go_on(judged *j, size_t i) {
  const conic_reference *r = j->reference;
  j->i = i;
  j->at = r->pixels ? r->pixels[i] : i;
  j->alternatives += j->n_alternatives;
  j->ids += j->n_ids;
  j->n_alternatives = j->n_ids = 0;
  while (j->alternatives + j->n_alternatives < r->alternatives + r->n_alternatives &&
         j->alternatives[j->n_alternatives].pixel == i)
    j->n_alternatives++;
  while (j->ids + j->n_ids < r->ids + r->n_ids && j->ids[j->n_ids].pixel == i)
    j->n_ids++;
}

static void note_wrong_pixel(const judged *j, const errors *e, double *worst, conic_oracle_verdict *verdict) {
  int is_wrong = 0;
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++) {
    verdict->planes[plane].max_abs = oracle_max(verdict->planes[plane].max_abs, e->planes[plane]);
    is_wrong |= e->planes[plane] > verdict->planes[plane].bound;
  }
  verdict->wrong_pixels += (size_t)is_wrong;
  if (!is_wrong || !(e->severity > *worst))
    return;
  *worst = e->severity;
  verdict->worst = e->fault;
  verdict->worst.x = (int)(j->at % (size_t)j->image->width);
  verdict->worst.y = (int)(j->at / (size_t)j->image->width);
}

/* `stable` has room for the errors of the covered, stable pixels, plane by plane. */
static void compare_pixels(const conic_reference *reference, const conic_image *image, double *stable, size_t room,
                           conic_oracle_verdict *verdict) {
  judged j = {.reference = reference, .image = image, .alternatives = reference->alternatives, .ids = reference->ids};
  double worst = 0.0;
  size_t n_stable = 0;
  for (size_t i = 0; i < reference->n_pixels; i++) {
    errors e;
    go_on(&j, i);
    if (reference->unstable[i] && !j.n_alternatives)
      continue;
    compare_pixel(&j, &e);
    note_wrong_pixel(&j, &e, &worst, verdict);
    if (!reference->unstable[i] && reference->planes[CONIC_PLANE_COUNT][i] > 0.0) {
      for (size_t plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
        stable[plane * room + n_stable] = e.planes[plane];
      n_stable++;
    }
  }
  for (size_t plane = 0; plane < CONIC_N_DRAWN_PLANES && n_stable; plane++)
    verdict->planes[plane].p999 =
        conic_oracle_select(stable + plane * room, n_stable, (size_t)(0.999 * (double)(n_stable - 1)));
}

conic_status conic_oracle_compare(conic_context *context, const conic_reference *reference, const conic_image *image,
                                  conic_oracle_verdict *verdict) {
  memset(verdict, 0, sizeof *verdict);
  if (image->width != reference->width || image->height != reference->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "an image of %d x %d and a reference of %d x %d are not comparable", image->width, image->height,
                      reference->width, reference->height);
  double *stable = conic_memory_allocate(context, reference->covered_pixels, CONIC_N_DRAWN_PLANES * sizeof *stable);
  if (!stable)
    return CONIC_ERROR_MEMORY;
  int is_exact = reference->question == CONIC_ORACLE_EXACT;
  verdict->unbounded_limit = unbounded_limit;
  verdict->covered_pixels = reference->covered_pixels;
  verdict->unstable_pixels = reference->unstable_pixels;
  verdict->compared_pixels = reference->n_pixels - reference->unstable_pixels;
  for (int i = 0; i < CONIC_N_DRAWN_PLANES; i++) {
    verdict->planes[i].is_compared = image->planes[i] != NULL;
    verdict->planes[i].bound = is_exact ? NAN : bounds[i];
  }
  compare_pixels(reference, image, stable, reference->covered_pixels, verdict);
  verdict->pass = is_exact || (!verdict->wrong_pixels &&
                               (double)reference->unbounded_pixels <= unbounded_limit * (double)reference->n_pixels);
  conic_memory_release(context, stable);
  return CONIC_OK;
}

double conic_reference_width(const conic_reference *reference, conic_plane plane) {
  double widest = 0.0;
  if ((unsigned)plane >= CONIC_N_DRAWN_PLANES || plane == CONIC_PLANE_ID)
    return 0.0;
  for (size_t i = 0; i < reference->n_alternatives; i++)
    for (int c = places[plane]; c < places[plane] + conic_plane_describe(plane)->n_channels; c++) {
      const conic_alternative *a = &reference->alternatives[i];
      double width = (a->high[c] - a->low[c]) / scale_of(reference, plane, a->high[c]);
      if (oracle_is_finite(width))
        widest = oracle_max(widest, width);
    }
  return widest;
}
