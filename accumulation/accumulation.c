#include "accumulation/accumulation_struct.h"
#include "accumulation/sequence.h"
#include "core/image/image_common.h"

size_t conic_accumulation_channel(unsigned planes, conic_plane plane) {
  size_t n = 0;
  for (int i = 0; i < (int)plane; i++)
    if (planes >> i & 1)
      n += (size_t)conic_plane_describe((conic_plane)i)->n_channels;
  return n;
}

/* Whether a sample is in the half that is also summed separately. Every run of two samples has one in it; and the
 * halves of this dimension are as even in pixel and lens as any halves of the sequence. */
static int is_in_half(uint64_t i_sample) {
  return conic_sequence_at(i_sample, CONIC_SEQUENCE_HALF) < 0.5;
}

static double luminance_of(const float *rgba) {
  return 0.2126 * (double)rgba[0] + 0.7152 * (double)rgba[1] + 0.0722 * (double)rgba[2];
}

conic_status conic_accumulation_create(conic_context *context, int width, int height, unsigned planes,
                                       uint64_t first_sample, conic_accumulation **made) {
  if (!made)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "accumulation: no place to put it");
  *made = NULL;
  planes &= CONIC_ACCUMULATED_PLANES;
  if (width < 1 || height < 1 || width > CONIC_IMAGE_MAX_SIZE || height > CONIC_IMAGE_MAX_SIZE || !planes ||
      first_sample >= CONIC_MAX_ACCUMULATED)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "accumulation: no plane has means, or a number is out of range");
  conic_accumulation *sums = conic_memory_allocate_zeroed(context, 1, sizeof *sums);
  if (!sums)
    return CONIC_ERROR_MEMORY;
  sums->context = context;
  sums->width = width;
  sums->height = height;
  sums->planes = planes;
  sums->n_channels = conic_accumulation_channel(planes, CONIC_N_PLANES) + 1;
  sums->first_sample = first_sample;
  size_t n_pixels = (size_t)width * (size_t)height;
  sums->sums = conic_memory_allocate_zeroed(context, n_pixels, sums->n_channels * sizeof *sums->sums);
  if (!sums->sums) {
    conic_accumulation_destroy(sums);
    return CONIC_ERROR_MEMORY;
  }
  *made = sums;
  return CONIC_OK;
}

void conic_accumulation_destroy(conic_accumulation *sums) {
  if (!sums)
    return;
  conic_memory_release_these(sums->context, sums->sums, sums);
}

void conic_accumulation_inspect(const conic_accumulation *sums, conic_accumulation_facts *facts) {
  *facts = (conic_accumulation_facts){.width = sums->width,
                                      .height = sums->height,
                                      .planes = sums->planes,
                                      .first_sample = sums->first_sample,
                                      .end_sample = sums->first_sample + sums->n_samples,
                                      .key = sums->key};
}

void conic_accumulation_set_key(conic_accumulation *sums, uint64_t key) {
  sums->key = key;
}

uint64_t conic_sample_key(const conic_image *sample) {
  uint64_t hashes[CONIC_N_PLANES] = {0};
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (CONIC_ACCUMULATED_PLANES >> i & 1)
      hashes[i] = conic_image_hash(sample, (conic_plane)i);
  uint64_t key = 0;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    key = (key ^ hashes[i]) * UINT64_C(0x9e3779b97f4a7c15) + (uint64_t)sample->width;
  return key ? key : 1;
}

/* --- adding --- */

typedef struct adding {
  conic_accumulation *sums;
  const conic_image *sample;
  int is_half;
} adding;

static void add_sample_row(void *data, size_t y) {
  const adding *work = data;
  const conic_accumulation *a = work->sums;
  size_t width = (size_t)a->width, first = 0;
  conic_exact_sum *row = a->sums + y * width * a->n_channels;
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    if (!(a->planes >> i & 1))
      continue;
    size_t n = (size_t)conic_plane_describe((conic_plane)i)->n_channels;
    const float *from = (const float *)work->sample->planes[i] + y * width * n;
    for (size_t x = 0; x < width; x++)
      for (size_t c = 0; c < n; c++)
        conic_exact_add(&row[x * a->n_channels + first + c], (double)from[x * n + c]);
    first += n;
  }
  if (!work->is_half || !(a->planes & 1u << CONIC_PLANE_RGBA))
    return;
  const float *rgba = (const float *)work->sample->planes[CONIC_PLANE_RGBA] + 4 * y * width;
  for (size_t x = 0; x < width; x++)
    conic_exact_add(&row[(x + 1) * a->n_channels - 1], luminance_of(rgba + 4 * x));
}

conic_status conic_accumulation_add(conic_accumulation *sums, const conic_image *sample) {
  conic_context *context = sums->context;
  if (!sample || sample->width != sums->width || sample->height != sums->height ||
      sums->planes & ~conic_image_planes(sample))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "accumulation: the sample has another size, or lacks a plane");
  uint64_t i_sample = sums->first_sample + sums->n_samples;
  if (i_sample >= CONIC_MAX_ACCUMULATED)
    return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "accumulation: there are %u samples already, which is all",
                      CONIC_MAX_ACCUMULATED);
  adding work = {sums, sample, is_in_half(i_sample)};
  conic_parallel_for(context, (size_t)sums->height, add_sample_row, &work);
  sums->n_samples++;
  sums->n_half += (uint64_t)work.is_half;
  return CONIC_OK;
}

/* --- merging --- */

typedef struct merging {
  conic_accumulation *sums;
  const conic_accumulation *other;
} merging;

static void merge_row(void *data, size_t y) {
  const merging *work = data;
  size_t n = (size_t)work->sums->width * work->sums->n_channels;
  for (size_t i = y * n; i < (y + 1) * n; i++)
    conic_exact_merge(&work->sums->sums[i], work->other->sums[i]);
}

conic_status conic_accumulation_merge(conic_accumulation *sums, const conic_accumulation *other) {
  conic_context *context = sums->context;
  if (!other || other == sums || other->width != sums->width || other->height != sums->height ||
      other->planes != sums->planes || (other->key && sums->key && other->key != sums->key))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "accumulation: the sums are not of the same picture");
  int is_behind = other->first_sample == sums->first_sample + sums->n_samples;
  if (!is_behind && other->first_sample + other->n_samples != sums->first_sample)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "accumulation: the samples do not follow each other");
  merging work = {sums, other};
  conic_parallel_for(context, (size_t)sums->height, merge_row, &work);
  sums->first_sample = is_behind ? sums->first_sample : other->first_sample;
  sums->n_samples += other->n_samples;
  sums->n_half += other->n_half;
  sums->key = sums->key ? sums->key : other->key;
  return CONIC_OK;
}

/* --- what they mean --- */

typedef struct resolving {
  const conic_accumulation *sums;
  conic_image *image;
} resolving;

static int has_noise(const conic_accumulation *a) {
  return (a->planes & 1u << CONIC_PLANE_RGBA) && a->n_half > 0 && a->n_half < a->n_samples;
}

/* Half the difference between the luminance of the half's samples and that of the others. */
static double half_difference(const conic_accumulation *a, const conic_exact_sum *pixel) {
  size_t first = conic_accumulation_channel(a->planes, CONIC_PLANE_RGBA);
  double channels[3], half = conic_exact_value(pixel[a->n_channels - 1]);
  for (size_t c = 0; c < 3; c++)
    channels[c] = conic_exact_value(pixel[first + c]);
  double all = 0.2126 * channels[0] + 0.7152 * channels[1] + 0.0722 * channels[2];
  return 0.5 * (half / (double)a->n_half - (all - half) / (double)(a->n_samples - a->n_half));
}

static void resolve_means(const conic_accumulation *a, conic_plane plane, const conic_exact_sum *pixel, float *to) {
  size_t n = (size_t)conic_plane_describe(plane)->n_channels;
  double values[4] = {0.0}, scale = (double)a->n_samples;
  for (size_t c = 0; c < n; c++)
    values[c] = conic_exact_value(pixel[c]);
  if (plane == CONIC_PLANE_NORMAL) { /* the direction of the sum */
    scale = sqrt((values[0] * values[0] + values[1] * values[1]) + values[2] * values[2]);
    if (!(scale > 0.0))
      scale = 1.0;
  }
  for (size_t c = 0; c < n; c++)
    to[c] = a->n_samples ? (float)(values[c] / scale) : 0.0f;
}

static void resolve_row(void *data, size_t y) {
  const resolving *work = data;
  const conic_accumulation *a = work->sums;
  size_t width = (size_t)a->width, first = 0;
  const conic_exact_sum *row = a->sums + y * width * a->n_channels;
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    size_t n = (size_t)conic_plane_describe((conic_plane)i)->n_channels;
    float *to = work->image->planes[i];
    if (!(a->planes >> i & 1))
      continue;
    for (size_t x = 0; x < width && to; x++)
      resolve_means(a, (conic_plane)i, row + x * a->n_channels + first, to + (y * width + x) * n);
    first += n;
  }
  uint32_t *samples = work->image->planes[CONIC_PLANE_SAMPLES];
  float *variance = work->image->planes[CONIC_PLANE_VARIANCE];
  for (size_t x = 0; x < width && samples; x++)
    samples[y * width + x] = (uint32_t)a->n_samples;
  for (size_t x = 0; x < width && variance; x++) {
    double difference = has_noise(a) ? half_difference(a, row + x * a->n_channels) : 0.0;
    variance[y * width + x] = (float)(difference * difference);
  }
}

conic_status conic_accumulation_resolve(const conic_accumulation *sums, conic_image *image) {
  if (!image || image->width != sums->width || image->height != sums->height)
    return conic_fail(sums->context, CONIC_ERROR_ARGUMENT, "accumulation: the image has another size");
  resolving work = {.sums = sums, .image = image};
  conic_parallel_for(sums->context, (size_t)sums->height, resolve_row, &work);
  return CONIC_OK;
}

double conic_accumulation_noise(const conic_accumulation *a) {
  double squares = 0.0;
  uint64_t n_covered = 0;
  size_t alpha = conic_accumulation_channel(a->planes, CONIC_PLANE_RGBA) + 3;
  if (!has_noise(a))
    return -1.0;
  for (size_t i = 0; i < (size_t)a->width * (size_t)a->height; i++) {
    const conic_exact_sum *pixel = a->sums + i * a->n_channels;
    if (!(pixel[alpha].whole | pixel[alpha].part))
      continue;
    double difference = half_difference(a, pixel);
    squares += difference * difference;
    n_covered++;
  }
  return n_covered ? sqrt(squares / (double)n_covered) : 0.0;
}
