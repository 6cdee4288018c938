/* An image held against the oracle's reference. */

#include "oracle/oracle_evidence.h"
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
  int is_equal; /* all values are the floats next to those that they are compared with */
} errors;

/* A pixel of the reference, and what is noted of its doubts. */
typedef struct judged {
  const conic_reference *reference;
  const conic_image *image, *greatest; /* the second: oracle_evidence_at's */
  size_t i, at;                        /* in the reference, in the image */
  const conic_alternative *alternatives;
  const conic_admissible_id *ids;
  size_t n_alternatives, n_ids;
} judged;

/* What a difference in a plane is measured by. */
static double scale_of(const conic_reference *reference, conic_plane plane, double expected) {
  if (plane == CONIC_PLANE_Z)
    return expected != 0.0 ? fabs(expected) : 1.0;
  if (plane == CONIC_PLANE_RGBA)
    return reference->white * oracle_max(1.0, fabs(expected) / reference->white);
  return plane == CONIC_PLANE_ALBEDO || plane == CONIC_PLANE_WEIGHT ? oracle_max(1.0, fabs(expected)) : 1.0;
}

static int is_admissible(const judged *j, double id) {
  for (size_t i = 0; i < j->n_ids; i++)
    if (j->ids[i].id == CONIC_ANY_ID || (double)j->ids[i].id == id)
      return 1;
  return 0;
}

/* How far a value is outside of what it may be. */
static double find_excess(const judged *j, conic_plane plane, int channel, oracle_evidence found, double low,
                          double high) {
  int is_alpha = plane == CONIC_PLANE_RGBA && channel == 3;
  double outside = oracle_evidence_outside(found, low, high), expected = found.high < low ? low : high;
  if (outside == 0.0 || (plane == CONIC_PLANE_ID && is_admissible(j, found.low)))
    return 0.0;
  double excess = outside / (is_alpha ? 1.0 : scale_of(j->reference, plane, expected));
  return excess == excess ? excess : INFINITY;
}

/* How a pixel's value in a channel compares with the reference's, or with the alternative's. */
static void judge_channel(const judged *j, conic_plane plane, int channel, const conic_alternative *alternative,
                          errors *e) {
  const conic_plane_description *about = conic_plane_describe(plane);
  size_t n = (size_t)about->n_channels, c = (size_t)channel;
  double expected = j->reference->planes[plane][n * j->i + c];
  conic_oracle_fault value = {.plane = (int)plane, .channel = channel, .low = expected, .high = expected};
  oracle_evidence found = oracle_evidence_at(j->image, j->greatest, plane, about->is_uint, n * j->at + c);
  if (alternative && plane != CONIC_PLANE_ID) {
    value.low = alternative->low[places[plane] + channel];
    value.high = alternative->high[places[plane] + channel];
  }
  value.found = oracle_evidence_next(found, value.low, value.high);
  double excess = find_excess(j, plane, channel, found, value.low, value.high), severity = 0.0;
  if (j->n_alternatives && plane == CONIC_PLANE_ID && !is_admissible(j, found.low))
    excess = oracle_max(excess, 1.0);
  if (excess > 0.0) /* what has to be exact is wrong by no more than just wrong */
    severity = bounds[plane] > 0.0 ? excess / bounds[plane] : 1.0 + 1e-9;
  e->planes[plane] = oracle_max(e->planes[plane], excess);
  e->is_equal &= oracle_evidence_is_equal(found, expected);
  if (severity > e->severity) {
    e->severity = severity;
    e->fault = value;
  }
}

/* A picture without alpha is read with 1 there. */
static int n_judged_channels(const conic_image *image, int plane) {
  int n = conic_plane_describe((conic_plane)plane)->n_channels;
  return plane == CONIC_PLANE_RGBA && image->lacks_alpha ? n - 1 : n;
}

static void judge_planes(const judged *j, const conic_alternative *alternative, errors *e) {
  memset(e, 0, sizeof *e);
  e->is_equal = 1;
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++) /* the others are names, given after drawing */
    for (int c = 0; j->image->planes[plane] && c < n_judged_channels(j->image, plane); c++)
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

/* What of a judgement is filled in besides the verdict; null members are not wanted. */
typedef struct compare_notes {
  conic_oracle_judgement *judgement;
  oracle_worst *worst;
  uint8_t *classes;
} compare_notes;

static int is_outside(const errors *e, const conic_oracle_verdict *verdict) {
  int is_wrong = 0;
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    is_wrong |= e->planes[plane] > verdict->planes[plane].bound;
  return is_wrong;
}

static void note_wrong_pixel(const judged *j, errors *e, double *worst, oracle_worst *list,
                             conic_oracle_verdict *verdict) {
  e->fault.x = (int)(j->at % (size_t)j->image->width);
  e->fault.y = (int)(j->at / (size_t)j->image->width);
  if (list)
    conic_oracle_worst_put(list, &e->fault, e->severity);
  if (!(e->severity > *worst))
    return;
  *worst = e->severity;
  verdict->worst = e->fault;
}

/* The class of a pixel that is not wrong. What fits the reference's own values and its id is no more than rounded, and
 * so is what only precision has put in doubt. */
static conic_pixel_class class_of_pixel(const judged *j, const conic_oracle_verdict *verdict, unsigned *reasons) {
  judged alone = *j;
  errors own;
  *reasons = j->reference->unstable[j->i];
  alone.n_alternatives = alone.n_ids = 0;
  judge_planes(&alone, NULL, &own);
  if (own.is_equal)
    return CONIC_PIXEL_EQUAL;
  if (!is_outside(&own, verdict) || *reasons == 1u << CONIC_UNSTABLE_PRECISION)
    return CONIC_PIXEL_ROUNDED;
  if (!*reasons) /* another id as near */
    *reasons = 1u << CONIC_UNSTABLE_DEPTH_TIE;
  return CONIC_PIXEL_EXPLAINED;
}

static void note_pixel_class(const judged *j, int is_wrong, const conic_oracle_verdict *verdict,
                             const compare_notes *notes) {
  unsigned reasons = 0;
  conic_pixel_class class = is_wrong ? CONIC_PIXEL_WRONG : class_of_pixel(j, verdict, &reasons);
  notes->judgement->pixels[class]++;
  for (int k = 0; k < CONIC_N_UNSTABLE_REASONS && class == CONIC_PIXEL_EXPLAINED; k++)
    notes->judgement->explained_by[k] += reasons >> k & 1;
  if (notes->classes)
    notes->classes[j->at] = (uint8_t) class;
}

/* `stable` has room for the errors of the covered, stable pixels, plane by plane. */
static void compare_pixels(judged j, double *stable, size_t room, const compare_notes *notes,
                           conic_oracle_verdict *verdict) {
  const conic_reference *reference = j.reference;
  double worst = 0.0;
  size_t n_stable = 0;
  j.alternatives = reference->alternatives;
  j.ids = reference->ids;
  for (size_t i = 0; i < reference->n_pixels; i++) {
    errors e;
    go_on(&j, i);
    if (reference->unstable[i] && !j.n_alternatives)
      continue;
    compare_pixel(&j, &e);
    int is_wrong = is_outside(&e, verdict);
    for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
      verdict->planes[plane].max_abs = oracle_max(verdict->planes[plane].max_abs, e.planes[plane]);
    verdict->wrong_pixels += (size_t)is_wrong;
    if (is_wrong)
      note_wrong_pixel(&j, &e, &worst, notes->worst, verdict);
    if (notes->judgement)
      note_pixel_class(&j, is_wrong, verdict, notes);
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

static conic_status compare_images(conic_context *context, const judged *j, const compare_notes *notes,
                                   conic_oracle_verdict *verdict) {
  const conic_reference *reference = j->reference;
  const conic_image *image = j->image;
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
  compare_pixels(*j, stable, reference->covered_pixels, notes, verdict);
  verdict->pass = is_exact || (!verdict->wrong_pixels &&
                               (double)reference->unbounded_pixels <= unbounded_limit * (double)reference->n_pixels);
  conic_memory_release(context, stable);
  return CONIC_OK;
}

conic_status conic_oracle_compare(conic_context *context, const conic_reference *reference, const conic_image *image,
                                  conic_oracle_verdict *verdict) {
  const compare_notes nothing = {.judgement = NULL};
  const judged j = {.reference = reference, .image = image};
  memset(verdict, 0, sizeof *verdict);
  return compare_images(context, &j, &nothing, verdict);
}

conic_status conic_oracle_judge(conic_context *context, const conic_reference *reference,
                                /* NOLINTNEXTLINE(readability-non-const-parameter): filled in */
                                const conic_oracle_judging *judging, const conic_image *image, uint8_t *classes,
                                conic_oracle_judgement *judgement) {
  conic_oracle_judging own;
  oracle_worst worst = {.n = 0};
  const compare_notes notes = {judgement, &worst, classes};
  memset(judgement, 0, sizeof *judgement);
  conic_oracle_judging_init(&own);
  if (judging && !conic_options_take(&own, judging))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: no such options");
  if (reference->question != CONIC_ORACLE_METHOD || !conic_oracle_evidence_fits(image, own.greatest))
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "judge: it is asked about the method, with the greatest values of all planes");
  const judged j = {.reference = reference, .image = image, .greatest = own.greatest};
  conic_status status = compare_images(context, &j, &notes, &judgement->verdict);
  memcpy(judgement->worst, worst.faults, sizeof judgement->worst);
  judgement->n_worst = worst.n;
  return status;
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
