/* Final pictures: the mean of many whole pictures ("samples"). Each has its own place in the pixel, point on the lens,
 * moment and light. docs/reference/accumulation.md defines them.
 *
 * Sums are exact: only which samples were added decides their bits. The order, and the cut into runs, threads or
 * processes, does not matter. */
#ifndef CONIC_ACCUMULATE_H
#define CONIC_ACCUMULATE_H

#include "conic/image.h"

CONIC_BEGIN_C

#define CONIC_MAX_ACCUMULATED (1u << 24)
#define CONIC_MAX_BLADES 64

/* The planes that have means, as bits; all other planes are those of the pixels' centres. */
#define CONIC_ACCUMULATED_PLANES                                                                                       \
  (1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_ALBEDO | 1u << CONIC_PLANE_WEIGHT |           \
   1u << CONIC_PLANE_TRANSPARENCY | 1u << CONIC_PLANE_INVERSE_Z | 1u << CONIC_PLANE_AO | 1u << CONIC_PLANE_SHADOW)

/* A lens: a disc or a polygon of equal sides, in the plane of the eye. */
typedef struct conic_aperture {
  double diameter; /* of the lens, or of the circle through its corners, in world units; 0: a pinhole */
  double focus;    /* camera-space z at which all is sharp, above 0; unused without a lens */
  int n_blades;    /* corners, 3 to CONIC_MAX_BLADES, the first at the top; 0: a disc */
  int reserved_int;
  uint64_t reserved[4];
} conic_aperture;

/* One sample of the sequence. */
typedef struct conic_sample {
  uint64_t index;
  double time;         /* in the shutter, 0 to 1 */
  double lens[2];      /* the eye's way to the right and down, in world units */
  conic_camera camera; /* draws the sample; a pinhole's includes the eye's way, for others conic_gather takes it */
  double lens_forward; /* the eye's way forward, for equirectangular cameras and cubes, whose lens is a ball */
  uint64_t reserved[3];
} conic_sample;

/* Sample `index` (below CONIC_MAX_ACCUMULATED) of a camera. `camera` is the one at the time that conic_sample_time
 * gives. A null aperture is a pinhole. The lens of a camera that sees all directions is round. Errors: ARGUMENT. */
CONIC_API conic_status conic_sample_place(conic_context *context, const conic_camera *camera,
                                          const conic_aperture *aperture, uint64_t index, conic_sample *sample);
CONIC_API double conic_sample_time(uint64_t index);

/* The camera at `part` of the way from one to the other. The eye moves on a straight line; the rotation's quaternion
 * changes linearly and is normalised; the inner numbers change linearly. Parts may lie beyond 0 and 1. Errors: ARGUMENT
 * (size, kind or lens differ; they look in opposite directions, between which there is no single way). */
CONIC_API conic_status conic_camera_between(conic_context *context, const conic_camera *from, const conic_camera *to,
                                            double part, conic_camera *camera);

/* The sums of a run of samples. One thread at a time. */
typedef struct conic_accumulation conic_accumulation;

/* Starts sums without samples; the next sample is `first_sample`. They hold the planes among `planes` that have means.
 * They take 16 bytes a channel and pixel, and 16 a pixel for the estimate of the noise. On success the caller owns
 * *sums, which must not outlive the context. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_accumulation_create(conic_context *context, int width, int height, unsigned planes,
                                                 uint64_t first_sample, conic_accumulation **sums);
CONIC_API void conic_accumulation_destroy(conic_accumulation *sums);

typedef struct conic_accumulation_facts {
  int width, height;
  unsigned planes;
  unsigned reserved_int;
  uint64_t first_sample, end_sample; /* the samples are first_sample to end_sample - 1 */
  uint64_t key;                      /* of sample 0; 0: not known */
  uint64_t reserved[4];
} conic_accumulation_facts;

CONIC_API void conic_accumulation_inspect(const conic_accumulation *sums, conic_accumulation_facts *facts);

/* Tells pictures apart: the hash of sample 0 (conic_sample_key). Sums whose keys differ are of different pictures. */
CONIC_API void conic_accumulation_set_key(conic_accumulation *sums, uint64_t key);
/* The hash of the planes of a sample that have means. */
CONIC_API uint64_t conic_sample_key(const conic_image *sample);

/* Adds the next sample: an image of the sums' size with at least their planes. NaN counts as 0; numbers beyond ±2³⁸ are
 * cut to it. Errors: ARGUMENT, UNSUPPORTED (there are CONIC_MAX_ACCUMULATED). */
CONIC_API conic_status conic_accumulation_add(conic_accumulation *sums, const conic_image *sample);

/* Adds the samples of `other`. They must end where these begin, or begin where these end; size, planes and key must
 * agree. Errors: ARGUMENT; the sums are then as they were. */
CONIC_API conic_status conic_accumulation_merge(conic_accumulation *sums, const conic_accumulation *other);

/* Fills the image's planes that have means, and the planes samples and variance, where image and sums have them; other
 * planes stay. Without samples the filled planes are 0. Errors: ARGUMENT. */
CONIC_API conic_status conic_accumulation_resolve(const conic_accumulation *sums, conic_image *image);

/* How far the picture is from the mean of infinitely many samples, judged by its two halves: half the root mean square
 * difference of their luminances, over all pixels that are covered. Below 0: not known yet, or there is no rgba. */
CONIC_API double conic_accumulation_noise(const conic_accumulation *sums);

/* Keeps sums in a file, to the bit. Errors: MEMORY, IO; INPUT (it holds none, or is damaged). */
CONIC_API conic_status conic_accumulation_write(const conic_accumulation *sums, const char *path);
CONIC_API conic_status conic_accumulation_read(conic_context *context, const char *path, conic_accumulation **sums);

/* What makes and judges samples. All callbacks get `cookie`; any status but OK ends the accumulation. */
typedef struct conic_accumulate_options {
  size_t size;         /* sizeof(conic_accumulate_options), set by the init function */
  conic_camera camera; /* in the middle of the pixel and of the lens */
  conic_aperture aperture;
  uint64_t end_sample;    /* samples before this one are added */
  double seconds;         /* above 0: no sample begins after so many */
  double noise;           /* above 0: the noise that is good enough; tested whenever the number of samples is a power of
                             two, 16 at least */
  unsigned sample_planes; /* planes drawn of each sample beside the sums', for `shade` */
  void *cookie;
  /* The camera at a time in the shutter, 0 to 1; null: it stands still. */
  conic_status (*camera_at)(void *cookie, double time, conic_camera *camera);
  /* Draws a sample at one sample a pixel; the scene, too, may depend on its time. */
  conic_status (*draw)(void *cookie, const conic_sample *sample, conic_image *image);
  /* Changes a drawn sample before it is added, as by light of its own; null: nothing changes. */
  conic_status (*shade)(void *cookie, uint64_t i_sample, const conic_camera *sample_camera, conic_image *sample);
  /* Sees the sums after each sample; null: not called. */
  conic_status (*watch)(void *cookie, const conic_accumulation *sums);
} conic_accumulate_options;

/* 64 samples, a pinhole. */
CONIC_API void conic_accumulate_options_init_sized(conic_accumulate_options *options, size_t size);
#define conic_accumulate_options_init(options) conic_accumulate_options_init_sized(options, sizeof *(options))

/* Adds the samples that are still missing. New sums get the key of sample 0, which is drawn for that where they begin
 * later. Sums that have samples are continued only if sample 0 still has their key. Errors: ARGUMENT (also another
 * key), MEMORY, CANCELLED, and what the callbacks return; the sums are then those of the samples that are done. */
CONIC_API conic_status conic_accumulate(conic_context *context, const conic_accumulate_options *options,
                                        conic_accumulation *sums);

CONIC_END_C
#endif
