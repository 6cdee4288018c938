/* A picture of a Gaussian scene held against what floats may make of it. */

#include "oracle/gaussians/oracle_cells.h"
#include "oracle/oracle_evidence.h"

/* Where the picture's values may lie. */
typedef struct judged_range {
  double v, low, high, least, most;
} judged_range;

typedef struct judge_job {
  const conic_image *image;
  const conic_gaussian_judging *judging;
  conic_gaussian_verdict *verdicts; /* by thread, as is the next */
  oracle_worst *worst;
  uint8_t *classes;
} judge_job;

/* A pixel as it is judged. */
typedef struct judge_pixel {
  conic_gaussian_class class;
  double severity[CONIC_N_PLANES], width[CONIC_N_PLANES], worst; /* worst: outside of what it may be */
  conic_oracle_fault fault;
  uint32_t faults; /* as in conic_gaussian_judging */
} judge_pixel;

static judged_range range_at(const conic_gaussian_bound *b, int channel) {
  return (judged_range){b->value[channel], b->low[channel], b->high[channel], b->least[channel], b->most[channel]};
}

/* Rounded to float once more. */
static judged_range rounded_range(judged_range r) {
  r.low -= ORACLE_FLOAT_UNIT * fabs(r.low);
  r.least -= ORACLE_FLOAT_UNIT * fabs(r.least);
  r.high += ORACLE_FLOAT_UNIT * fabs(r.high);
  r.most += ORACLE_FLOAT_UNIT * fabs(r.most);
  return r;
}

/* Of others, 1 − T or Σ w: that differs by a rounding a product, and two a sum. */
static judged_range range_of_alpha(const judge_job *j, const conic_gaussian_bound *b) {
  judged_range T = rounded_range(range_at(b, CONIC_BOUND_T)); /* a mean is rounded before it is subtracted */
  if (j->judging->is_opaque)
    return (judged_range){1.0, 1.0, 1.0, 1.0, 1.0};
  if (j->judging->model && j->judging->model->is_setup_in_float) {
    double off = 3.0 * ORACLE_FLOAT_UNIT * b->most[CONIC_BOUND_COUNT];
    T = (judged_range){T.v, T.low - off, T.high + off, T.least - off, T.most + off};
  }
  return rounded_range((judged_range){1.0 - T.v, 1.0 - T.high, 1.0 - T.low, 1.0 - T.most, 1.0 - T.least});
}

/* A vector that is off by h, once it is of unit length, by 2|h|/(|v| − |h|). */
static void spread_direction(const double v[3], const double h[3], double *spread) {
  double room = oracle_length(v) - oracle_length(h);
  *spread = room > 0.0 ? oracle_min(2.0 * oracle_length(h) / room, 2.0) + 4.0 * ORACLE_FLOAT_UNIT : 2.0;
}

static judged_range range_of_normal(const conic_gaussian_bound *b, int c) {
  double v[3], rounded[3], doubtful[3], spread, wide;
  for (int k = 0; k < 3; k++) {
    const judged_range r = range_at(b, CONIC_BOUND_NORMAL + k);
    v[k] = r.v;
    rounded[k] = oracle_max(r.high - r.v, r.v - r.low);
    doubtful[k] = oracle_max(r.most - r.v, r.v - r.least);
  }
  double length = oracle_length(v), n = length > 0.0 ? v[c] / length : 0.0;
  spread_direction(v, rounded, &spread);
  spread_direction(v, doubtful, &wide);
  if (!(b->most[CONIC_BOUND_COUNT] > 0.0))
    spread = wide = 0.0;
  return (judged_range){n, n - spread, n + spread, n - wide, n + wide};
}

static judged_range range_in_plane(const judge_job *j, const conic_gaussian_bound *b, conic_plane plane, int channel) {
  if (plane == CONIC_PLANE_RGBA)
    return channel == 3 ? range_of_alpha(j, b) : rounded_range(range_at(b, CONIC_BOUND_RGB + channel));
  if (plane == CONIC_PLANE_TRANSPARENCY)
    return rounded_range(range_at(b, CONIC_BOUND_T));
  if (plane == CONIC_PLANE_NORMAL)
    return range_of_normal(b, channel);
  return range_at(b, plane == CONIC_PLANE_Z          ? CONIC_BOUND_Z
                     : plane == CONIC_PLANE_COUNT    ? CONIC_BOUND_COUNT
                     : plane == CONIC_PLANE_MEDIAN_Z ? CONIC_BOUND_MEDIAN_Z
                                                     : CONIC_BOUND_INVERSE_Z);
}

static double unit_of_plane(conic_plane plane, double expected) {
  if (plane == CONIC_PLANE_Z || plane == CONIC_PLANE_MEDIAN_Z)
    return expected != 0.0 ? fabs(expected) : 1.0;
  return oracle_max(1.0, fabs(expected));
}

static void note_class(judge_pixel *p, conic_gaussian_class class) {
  p->class = class > p->class ? class : p->class;
}

static void judge_value(const judge_job *j, const conic_gaussian_bound *b, conic_plane plane, int channel,
                        oracle_evidence found, judge_pixel *p) {
  const judged_range r = range_in_plane(j, b, plane, channel);
  const double scale = unit_of_plane(plane, r.v), nothing = 1e-37; /* what underflow may leave */
  const double off = oracle_evidence_outside(found, r.v, r.v) / scale;
  const double outside = oracle_evidence_outside(found, r.least - nothing, r.most + nothing) / scale;
  p->severity[plane] = oracle_max(p->severity[plane], off);
  p->width[plane] = oracle_max(p->width[plane], (r.most - r.least) / scale);
  if (outside == 0.0) {
    int is_rounded = oracle_evidence_outside(found, r.low - nothing, r.high + nothing) == 0.0;
    note_class(p, oracle_evidence_is_equal(found, r.v) ? CONIC_PIXEL_EQUAL
                  : is_rounded                         ? CONIC_PIXEL_ROUNDED
                                                       : CONIC_PIXEL_EXPLAINED);
    return;
  }
  note_class(p, CONIC_PIXEL_WRONG);
  p->faults |= 1u << plane | (plane == CONIC_PLANE_RGBA ? 1u << (CONIC_MAX_PLANES + channel) : 0u);
  if (outside > p->worst) {
    p->worst = outside;
    p->fault = (conic_oracle_fault){.plane = (int)plane,
                                    .channel = channel,
                                    .found = oracle_evidence_next(found, r.least, r.most),
                                    .low = r.least,
                                    .high = r.most};
  }
}

static void judge_name(conic_plane plane, const uint32_t *ids, int n, uint32_t found, judge_pixel *p) {
  int is_in = n > CONIC_MAX_BOUND_IDS;
  for (int k = 0; k < n && k < CONIC_MAX_BOUND_IDS; k++)
    is_in |= ids[k] == found;
  if (!is_in && p->class < CONIC_PIXEL_WRONG) {
    p->worst = 1e-30; /* least of faults, since names have no distance */
    p->fault = (conic_oracle_fault){.plane = (int)plane, .found = found, .low = ids[0], .high = ids[0]};
  }
  p->severity[plane] = is_in ? p->severity[plane] : 1.0;
  p->faults |= (uint32_t)!is_in << plane;
  note_class(p, !is_in ? CONIC_PIXEL_WRONG : n == 1 ? CONIC_PIXEL_EQUAL : CONIC_PIXEL_ROUNDED);
}

static void judge_planes_at(const judge_job *j, const conic_gaussian_bound *b, size_t pixel, judge_pixel *p) {
  static const conic_plane planes[] = {
      CONIC_PLANE_RGBA,         CONIC_PLANE_Z,        CONIC_PLANE_NORMAL,   CONIC_PLANE_COUNT,
      CONIC_PLANE_TRANSPARENCY, CONIC_PLANE_MEDIAN_Z, CONIC_PLANE_INVERSE_Z};
  const conic_image *image = j->image;
  memset(p, 0, sizeof *p);
  for (size_t k = 0; k < sizeof planes / sizeof *planes; k++) {
    const conic_plane_description *about = conic_plane_describe(planes[k]);
    for (int c = 0; image->planes[planes[k]] && c < about->n_channels; c++) {
      size_t at = pixel * (size_t)about->n_channels + (size_t)c;
      if (planes[k] == CONIC_PLANE_RGBA && c == 3 && image->lacks_alpha)
        continue;
      judge_value(j, b, planes[k], c, oracle_evidence_at(image, j->judging->greatest, planes[k], about->is_uint, at),
                  p);
    }
  }
  if (image->planes[CONIC_PLANE_ID])
    judge_name(CONIC_PLANE_ID, b->id, b->n_id, ((const uint32_t *)image->planes[CONIC_PLANE_ID])[pixel], p);
  if (image->planes[CONIC_PLANE_LAST])
    judge_name(CONIC_PLANE_LAST, b->last, b->n_last, ((const uint32_t *)image->planes[CONIC_PLANE_LAST])[pixel], p);
}

static float range_of_pixel(const judge_pixel *p) {
  double sum = 0.0;
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    sum += p->width[plane] * conic_plane_describe((conic_plane)plane)->n_channels;
  return (float)sum;
}

static void judge_bound(void *data, size_t i, size_t pixel, const conic_gaussian_bound *b, int i_thread) {
  const judge_job *j = data;
  conic_gaussian_verdict *v = &j->verdicts[i_thread];
  judge_pixel p;
  (void)i;
  judge_planes_at(j, b, pixel, &p);
  v->judged_pixels++;
  v->covered_pixels += b->value[CONIC_BOUND_COUNT] > 0.0;
  v->wide_pixels += b->is_wide != 0;
  v->vague_pixels += p.width[CONIC_PLANE_RGBA] > 1.0 / 255.0;
  v->doubtful_pixels += b->doubts > 0;
  v->pixels[p.class]++;
  for (int k = 0; k < CONIC_N_GAUSSIAN_DOUBTS; k++) {
    v->doubtful[k] += b->kinds >> k & 1;
    v->explained_by[k] += p.class == CONIC_PIXEL_EXPLAINED && b->kinds >> k & 1;
  }
  for (int plane = 0; plane < CONIC_N_PLANES; plane++) {
    v->planes[plane].max_abs = oracle_max(v->planes[plane].max_abs, p.severity[plane]);
    v->planes[plane].bound = oracle_max(v->planes[plane].bound, p.width[plane]);
  }
  if (j->classes)
    j->classes[pixel] = (uint8_t)p.class;
  if (j->judging->ranges)
    j->judging->ranges[pixel] = range_of_pixel(&p);
  if (j->judging->faults)
    j->judging->faults[pixel] = p.faults;
  if (p.class != CONIC_PIXEL_WRONG)
    return;
  p.fault.x = (int)(pixel % (size_t)j->image->width);
  p.fault.y = (int)(pixel / (size_t)j->image->width);
  conic_oracle_worst_put(&j->worst[i_thread], &p.fault, p.worst);
}

void conic_gaussian_verdict_add(const conic_gaussian_verdict *v, conic_gaussian_verdict *to) {
  to->judged_pixels += v->judged_pixels;
  to->covered_pixels += v->covered_pixels;
  to->wide_pixels += v->wide_pixels;
  to->vague_pixels += v->vague_pixels;
  to->doubtful_pixels += v->doubtful_pixels;
  for (int k = 0; k < CONIC_N_GAUSSIAN_CLASSES; k++)
    to->pixels[k] += v->pixels[k];
  for (int k = 0; k < CONIC_N_GAUSSIAN_DOUBTS; k++) {
    to->doubtful[k] += v->doubtful[k];
    to->explained_by[k] += v->explained_by[k];
  }
  for (int plane = 0; plane < CONIC_N_PLANES; plane++) {
    to->planes[plane].max_abs = oracle_max(to->planes[plane].max_abs, v->planes[plane].max_abs);
    to->planes[plane].bound = oracle_max(to->planes[plane].bound, v->planes[plane].bound);
    to->planes[plane].is_compared |= v->planes[plane].is_compared;
  }
  for (int k = 0; k < v->n_worst && to->n_worst < CONIC_MAX_FAULTS; k++)
    to->worst[to->n_worst++] = v->worst[k];
  to->pass &= v->pass;
}

static void add_worst(oracle_worst *to, const oracle_worst *w) {
  for (int k = 0; k < w->n; k++)
    conic_oracle_worst_put(to, &w->faults[k], w->severity[k]);
}

/* The planes that Gaussian scenes have, but for what the renderer does not draw. */
static const unsigned judged_planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL |
                                      1u << CONIC_PLANE_COUNT | 1u << CONIC_PLANE_ID |
                                      (CONIC_GAUSSIAN_PLANES & ~(1u << CONIC_PLANE_DOUBT));

static conic_status judge_all(oracle_entry *e, judge_job *j, conic_gaussian_verdict *verdict) {
  oracle_bound_request *b = &e->bounding;
  const size_t whole = b->n_pixels, threads = (size_t)conic_context_threads(b->context);
  uint32_t *pixels = NULL;
  if (j->judging->n_pixels && j->judging->n_pixels < whole) {
    b->n_pixels = j->judging->n_pixels;
    b->pixels = pixels = conic_memory_allocate(b->context, b->n_pixels, sizeof *pixels);
    if (!pixels)
      return CONIC_ERROR_MEMORY;
    conic_oracle_choose_pixels(whole, b->n_pixels, pixels);
  }
  b->surfaces = j->judging->surfaces;
  b->take = judge_bound;
  b->data = j;
  j->verdicts = conic_memory_allocate_zeroed(b->context, threads, sizeof *j->verdicts);
  j->worst = conic_memory_allocate_zeroed(b->context, threads, sizeof *j->worst);
  conic_status status = j->verdicts && j->worst ? conic_oracle_bound_all(b) : CONIC_ERROR_MEMORY;
  oracle_worst worst = {.n = 0};
  for (size_t k = 0; status == CONIC_OK && k < threads; k++) {
    conic_gaussian_verdict_add(&j->verdicts[k], verdict);
    add_worst(&worst, &j->worst[k]);
  }
  memcpy(verdict->worst, worst.faults, sizeof verdict->worst);
  verdict->n_worst = worst.n;
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    verdict->planes[plane].is_compared = j->image->planes[plane] && judged_planes >> plane & 1;
  verdict->pass = verdict->pixels[CONIC_PIXEL_WRONG] == 0;
  conic_memory_release_these(b->context, j->verdicts, j->worst, pixels);
  return status;
}

/* The options as this version has them. Errors: ARGUMENT. */
static conic_status take_judging(conic_context *context, const conic_gaussian_judging *judging,
                                 const conic_camera *camera, const conic_image *image, conic_gaussian_judging *own) {
  conic_gaussian_judging_init(own);
  if (judging && !conic_options_take(own, judging))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: no such options");
  if (!image || !camera || image->width != camera->width || image->height != camera->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: the image is not of the camera's size");
  if (!conic_oracle_evidence_fits(image, own->greatest))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: the greatest values lack a plane of the image");
  if (own->surfaces && !conic_oracle_surfaces_fit(own->surfaces, own->samples * image->width,
                                                  own->samples * image->height, conic_image_planes(image)))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: the surfaces are not those of the picture's samples");
  return CONIC_OK;
}

conic_status conic_gaussian_judge(conic_context *context, const conic_gaussians *gaussians, const conic_camera *camera,
                                  const conic_gaussian_options *options, const conic_gaussian_judging *judging,
                                  /* NOLINTNEXTLINE(readability-non-const-parameter): filled in */
                                  const conic_image *image, uint8_t *classes, conic_gaussian_verdict *verdict) {
  oracle_entry e;
  conic_gaussian_judging own;
  memset(verdict, 0, sizeof *verdict);
  conic_status status = take_judging(context, judging, camera, image, &own);
  if (status == CONIC_OK)
    status = conic_oracle_enter(context, gaussians, camera, options, own.model, own.samples, &e);
  if (status != CONIC_OK)
    return status;
  judge_job j = {.image = image, .judging = &own, .classes = classes};
  return judge_all(&e, &j, verdict);
}

static void take_doubts(void *data, size_t i, size_t pixel, const conic_gaussian_bound *b, int i_thread) {
  (void)i, (void)i_thread;
  ((uint32_t *)data)[pixel] = b->doubts;
}

conic_status conic_gaussian_find_doubts(conic_context *context, const conic_gaussians *gaussians,
                                        const conic_camera *camera, const conic_gaussian_options *options,
                                        const conic_gaussian_judging *judging, conic_image *image) {
  oracle_entry e;
  conic_gaussian_judging own;
  conic_status status = take_judging(context, judging, camera, image, &own);
  if (status == CONIC_OK && !image->planes[CONIC_PLANE_DOUBT])
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: the image has no plane doubt");
  if (status == CONIC_OK)
    status = conic_oracle_enter(context, gaussians, camera, options, own.model, own.samples, &e);
  if (status != CONIC_OK)
    return status;
  e.bounding.surfaces = own.surfaces;
  e.bounding.take = take_doubts;
  e.bounding.data = image->planes[CONIC_PLANE_DOUBT];
  return conic_oracle_bound_all(&e.bounding);
}

static void take_bound(void *data, size_t i, size_t pixel, const conic_gaussian_bound *b, int i_thread) {
  (void)pixel, (void)i_thread;
  ((conic_gaussian_bound *)data)[i] = *b;
}

conic_status conic_gaussian_bound_pixels(conic_context *context, const conic_gaussians *gaussians,
                                         const conic_camera *camera, const conic_gaussian_options *options,
                                         const conic_float_model *model, const uint32_t *pixels, size_t n,
                                         conic_gaussian_bound *bounds) {
  oracle_entry e;
  conic_status status = conic_oracle_enter(context, gaussians, camera, options, model, 1, &e);
  if (status != CONIC_OK)
    return status;
  int is_there = bounds && (pixels || n == e.bounding.n_pixels);
  for (size_t i = 0; is_there && pixels && i < n; i++)
    is_there = pixels[i] < e.bounding.n_pixels;
  if (!is_there)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: a pixel is not in the picture");
  e.bounding.pixels = pixels;
  e.bounding.n_pixels = n;
  e.bounding.take = take_bound;
  e.bounding.data = bounds;
  return conic_oracle_bound_all(&e.bounding);
}
