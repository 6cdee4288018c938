/* A picture that is being lit. */
#pragma once

#include "lighting/lit_map.h"
#include "raster/tiles/finish.h"

/* Turns what the points of a surface receive into what the pixels of a picture receive. */

/* A pixel that gets the mean of what some about it received. */
typedef struct conic_spread_mean {
  uint64_t about[2]; /* a bit for each of the pixels around, row by row; none: it keeps what it has */
  uint32_t pixel;
  float value;
} conic_spread_mean;

enum {
  CONIC_MOST_SPREAD_PX = 4,
  CONIC_SPREAD_WINDOW = (2 * CONIC_MOST_SPREAD_PX + 1) * (2 * CONIC_MOST_SPREAD_PX + 1)
};

typedef struct conic_edge_spread {
  conic_context *context;
  const conic_image *image;
  const conic_receivers *receivers;
  conic_camera_rays rays;
  float epsilon;             /* the casters' */
  int samples;               /* N × N of the picture's pixel */
  size_t edge_px;            /* how far splats may stick out, to CONIC_MOST_SPREAD_PX */
  unsigned char *kind;       /* of each pixel */
  unsigned char *takes_mean; /* of each pixel: 1 where it gets what others about it received */
  uint32_t *means_before;    /* of each row, and of all: the means in the rows above */
  conic_spread_mean *means;
  ptrdiff_t offsets[CONIC_SPREAD_WINDOW]; /* of the bits of `about`: to their pixels */
  float *filled;                          /* of each pixel: what it gets */
  float otherwise;                        /* for pixels that get nothing; NaN before the first filling */
  float *columns;                         /* room of each thread */
} conic_edge_spread;

/* Finds which pixels of the picture, which has Z and N, are at edges. Keeps references to the arguments. Errors:
 * MEMORY; the caller releases it then, too. */
conic_status conic_edge_spread_init(conic_context *context, const conic_camera *camera, const conic_image *image,
                                    const conic_receivers *receivers, double epsilon, int samples,
                                    conic_edge_spread *spread);

/* Fills `filled` from what the receivers received; `otherwise` for pixels without receivers at or around them. */
void conic_edge_spread_fill(conic_edge_spread *spread, const float *of_receivers, float otherwise);

void conic_edge_spread_release(conic_edge_spread *spread);

/* What a sky sheds on a surface by its normal, without one direction's share of it: of three colours q0 + q1·n +
 * n·q2·n. Both are by a polynomial in place of the cosine that ends at 0. Over all directions the mean is 0. Added to a
 * sample's light from its direction, it leaves only what is hidden to chance. */
typedef struct conic_sky_rest {
  float q0[3], q1[3][3], q2[3][3][3];
} conic_sky_rest;

/* Without direction i of the sequence. */
void conic_sky_rest_without(const conic_sky *sky, uint64_t i, conic_sky_rest *rest);

static inline float conic_sky_rest_at(const conic_sky_rest *rest, size_t c, const float n[3]) {
  float sum = rest->q0[c];
  for (int i = 0; i < 3; i++) {
    const float *q = rest->q2[c][i];
    sum += (rest->q1[c][i] + ((q[0] * n[0] + q[1] * n[1]) + q[2] * n[2])) * n[i];
  }
  return sum;
}

/* The sky's colour in a direction, which is a unit vector: linear between the centres of its pixels. */
void conic_sky_look(const conic_sky *sky, const float direction[3], float color[3]);

typedef struct conic_light_work {
  conic_context *context;
  const conic_camera *camera;
  const conic_render_options *render;
  const conic_lighting_options *options;
  conic_image *image;
  conic_finish finish;
  conic_finish_lights lights; /* all of them */
  conic_finish_lights one;    /* the current one */
  conic_receivers receivers;
  conic_map_room room;
  conic_edge_spread spread;
  float *rows;    /* room of each thread: 4 a pixel of a row */
  float *hidden;  /* of each pixel: the unexposed colour that hidden lights would make; null: no colours */
  float *visible; /* of each receiver */
  conic_sky_sums sums;
  float *sums_block;
  double power;      /* Σ of the luminances of the lights so far */
  float *lamp_power; /* of each pixel: the same sum over lamps; null: there are no lamps */
} conic_light_work;

static inline size_t conic_light_pixel(const conic_light_work *l, size_t x, size_t y) {
  return y * (size_t)l->image->width + x;
}

static inline float conic_light_luminance(const float color[3]) {
  return (0.2126f * color[0] + 0.7152f * color[1]) + 0.0722f * color[2];
}

/* How much of the pixel is covered; its background is not. */
static inline float conic_light_coverage(const conic_light_work *l, size_t pixel) {
  float alpha = ((const float *)l->image->planes[CONIC_PLANE_RGBA])[4 * pixel + 3];
  return l->render->has_background || !(alpha < 1.0f) ? 1.0f : alpha;
}

/* The colour of what the pixel shows, as if it covered the pixel, by the lights of `finish`; returns 0 where it shows
 * nothing. */
static inline int conic_light_shade(const conic_light_work *l, const conic_finish *finish, size_t x, size_t y,
                                    float shaded[3]) {
  size_t pixel = conic_light_pixel(l, x, y);
  const float *albedo = (const float *)l->image->planes[CONIC_PLANE_ALBEDO] + 3 * pixel;
  const float *normal = (const float *)l->image->planes[CONIC_PLANE_NORMAL] + 3 * pixel;
  float coverage = conic_light_coverage(l, pixel), viewer[3] = {0.0f, 0.0f, 0.0f}, own[3];
  for (int c = 0; c < 3 && coverage > 0.0f; c++)
    own[c] = albedo[c] / coverage;
  if (!(coverage > 0.0f))
    return 0;
  if (finish->lights->n_lights > 0) /* what is from all around looks alike from everywhere */
    conic_pixel_viewer(&l->spread.rays, x, y, viewer);
  conic_shade(finish, own, normal, normal, viewer, shaded);
  return 1;
}

/* Adds the arriving light of the options' lamps to the picture's colours, and to its shadow, which is divided by the
 * power later. Errors: MEMORY, CANCELLED, the drawer's. */
conic_status conic_light_add_lamps(conic_light_work *l);
