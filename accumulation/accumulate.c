/* Adds sample after sample, until there are enough. */
#include <string.h>

#include "accumulation/accumulation_struct.h"
#include "accumulation/scattered.h"
#include "core/base/clock.h"
#include "core/base/message.h"
#include "core/base/options.h"

void conic_accumulate_options_init_sized(conic_accumulate_options *options, size_t size) {
  static const conic_accumulate_options own = {.size = sizeof own, .end_sample = 64};
  conic_options_give(options, size, &own);
}

static conic_status draw_sample(conic_context *context, const conic_accumulate_options *options, uint64_t index,
                                conic_image *image) {
  conic_sample sample;
  conic_camera camera = options->camera;
  conic_status status = CONIC_OK;
  if (options->camera_at)
    status = options->camera_at(options->cookie, conic_sample_time(index), &camera);
  if (status == CONIC_OK)
    status = conic_sample_place(context, &camera, &options->aperture, index, &sample);
  if (status == CONIC_OK)
    status = options->draw(options->cookie, &sample, image);
  if (status == CONIC_OK && options->shade)
    status = options->shade(options->cookie, index, &sample.camera, image);
  return status;
}

static uint64_t key_of_first(const conic_accumulation *sums, const conic_image *first) {
  conic_image known = *first; /* without the planes drawn only for `shade` */
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (!(sums->planes >> i & 1))
      known.planes[i] = NULL;
  return conic_sample_key(&known);
}

/* Checks that existing samples, if any, are of this picture: sample 0 tells. */
static conic_status settle_key(conic_context *context, const conic_accumulate_options *options,
                               conic_accumulation *sums, conic_image *image) {
  conic_status status = draw_sample(context, options, 0, image);
  if (status != CONIC_OK)
    return status;
  uint64_t key = key_of_first(sums, image);
  if (sums->key && sums->key != key)
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "accumulate: the first sample is another one: the scene, the camera or an option differs");
  sums->key = key;
  return CONIC_OK;
}

/* Whether the existing samples are enough, or took too long. */
static int is_enough(const conic_accumulate_options *options, const conic_accumulation *sums, double start) {
  uint64_t end = sums->first_sample + sums->n_samples;
  enum { LEAST_SAMPLES = 16 };
  if (end >= options->end_sample)
    return 1;
  if (sums->n_samples > 0 && options->seconds > 0.0 && conic_seconds_now() - start >= options->seconds)
    return 1;
  if (!(options->noise > 0.0) || sums->n_samples < LEAST_SAMPLES || (sums->n_samples & (sums->n_samples - 1)) != 0)
    return 0;
  double noise = conic_accumulation_noise(sums);
  return noise >= 0.0 && noise <= options->noise;
}

int conic_accumulate_is_enough(const conic_accumulate_options *options, const conic_accumulation *sums) {
  return is_enough(options, sums, conic_seconds_now());
}

conic_status conic_accumulate_check_key(conic_context *context, const conic_accumulate_options *options,
                                        conic_accumulation *sums) {
  conic_image image;
  conic_status status =
      conic_image_allocate(context, sums->width, sums->height, sums->planes | options->sample_planes, &image);
  if (status == CONIC_OK)
    status = settle_key(context, options, sums, &image);
  conic_image_release(context, &image);
  return status;
}

conic_status conic_accumulate_range(conic_context *context, const conic_accumulate_options *options, uint64_t begin,
                                    uint64_t end, conic_accumulation *sums) {
  conic_image image;
  conic_status status =
      conic_image_allocate(context, sums->width, sums->height, sums->planes | options->sample_planes, &image);
  sums->first_sample = begin - sums->n_samples; /* modulo 2⁶⁴ */
  for (uint64_t i = begin; i < end && status == CONIC_OK; i++) {
    status = conic_progress(context, "accumulate", (double)i / (double)options->end_sample);
    if (status == CONIC_OK)
      status = draw_sample(context, options, i, &image);
    if (status == CONIC_OK && i == 0)
      sums->key = key_of_first(sums, &image);
    if (status == CONIC_OK)
      status = conic_accumulation_add(sums, &image);
  }
  conic_image_release(context, &image);
  return status;
}

static conic_status add_missing_samples(conic_context *context, const conic_accumulate_options *options,
                                        conic_accumulation *sums, conic_image *image) {
  conic_status status = settle_key(context, options, sums, image);
  double start = conic_seconds_now();
  while (status == CONIC_OK && !is_enough(options, sums, start)) {
    uint64_t index = sums->first_sample + sums->n_samples;
    status = conic_progress(context, "accumulate", (double)index / (double)options->end_sample);
    if (status == CONIC_OK && index > 0) /* sample 0 is drawn already */
      status = draw_sample(context, options, index, image);
    if (status == CONIC_OK)
      status = conic_accumulation_add(sums, image);
    if (status == CONIC_OK && options->watch)
      status = options->watch(options->cookie, sums);
  }
  return status;
}

conic_status conic_accumulate(conic_context *context, const conic_accumulate_options *given, conic_accumulation *sums) {
  conic_accumulate_options options;
  conic_image image;
  conic_accumulate_options_init(&options);
  if (!sums || !conic_options_take(&options, given) || !options.draw || options.end_sample > CONIC_MAX_ACCUMULATED ||
      options.camera.width != sums->width || options.camera.height != sums->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "accumulate: nothing draws, or the camera is not of the sums' size");
  conic_status status =
      conic_image_allocate(context, sums->width, sums->height, sums->planes | options.sample_planes, &image);
  if (status == CONIC_OK)
    status = add_missing_samples(context, &options, sums, &image);
  conic_image_release(context, &image);
  return status;
}
