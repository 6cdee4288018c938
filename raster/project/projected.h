/* Projected splats: what one frame needs to know of each splat that it may draw. */
#pragma once

#include <stdint.h>

#include "raster/view/view.h"

/* The part that both passes read, one cache line.
 *
 * Pixel offsets are taken from the splat's reference: pixel (x, y) plus a fraction, dx = (pixel - x) + dx0, so that
 * their precision depends neither on the place on the screen nor on the tile. q  = (s1·dx + s2·dy)² + (s3·dy)², the
 * Cholesky form of δᵀV⁻¹δ: without the cancellation that a needle's expanded quadratic has; covered where q < support
 *   iz = iz0 + iz_dy·dy + iz_dx·dx, clamped to [iz_far, iz_near]: inverse depth
 * The sign of s3 says whether the splat has clip lines (raster/project/clip_lines.h). Where s3 is 0 the splat is drawn
 * by the exact ray–splat parameter, with the coefficients of rays[i_ray]. */
typedef struct conic_footprint {
  float x, y; /* whole numbers */
  float dx0, dy0;
  union {
    float s1;
    uint32_t i_ray;
  };
  float s2, s3;
  float iz0, iz_dx, iz_dy;
  float plane_dx, plane_dy; /* gradient of the inverse depth of the splat's plane, not shrunk by the prefilter */
  float iz_far, iz_near;
  float nearness;  /* s = 1 / (1 + ε/‖p‖); of a wide splat, whose pixels each have an s of their own, -ε */
  float amplitude; /* A·opacity */
} conic_footprint;

/* Drawn by raster/project/laplace.h. */
static inline int conic_is_laplace(const conic_footprint *footprint) {
  return footprint->s3 == 0.0f && footprint->s2 != 0.0f;
}

/* From this relative change of the distance along the rays on, a splat is wide: with what the sum of its parts leaves
 * out, the distance is then within 2 % of ‖p‖ wherever a splat that is not wide covers a pixel
 * (docs/reference/picture.md, Visible). */
#define CONIC_NARROW_CHANGE 0.0195f

static inline int conic_is_wide(const conic_footprint *footprint) {
  return footprint->nearness < 0.0f;
}

/* The pixels that a footprint may cover, within the image: what binning reads, apart from the rest. It is rounded
 * outwards to blocks of 4 × 4 pixels there: where a pixel is covered, its q decides, and for rays their own limits. */
typedef struct conic_box {
  uint16_t x_begin, x_end, y_begin, y_end;
} conic_box;

static inline int conic_box_is_empty(const conic_box *box) {
  return box->x_begin >= box->x_end || box->y_begin >= box->y_end;
}

/* u = U/iz, v = V/iz, each of U, V affine on the screen like iz: the splat's parameter at a pixel.
 *
 * Where the footprint's s2 is not 0 (raster/project/laplace.h) the reference is the projected p, so that u0 = v0 = 0
 * and no range of iz is needed. Their places hold h·V⁻¹ of the Jacobian at p: what it makes of (dx, dy) is how far from
 * the pixel the place is that it mostly sees. */
typedef struct conic_ray {
  union {
    float u0;
    float pull_xx;
  };
  float u_dx, u_dy;
  union {
    float v0;
    float pull_yy;
  };
  float v_dx, v_dy;
  union {
    float iz_low; /* covered only where iz lies between: what the disc reaches, widened by the prefilter; */
    float pull_xy;
  };
  float iz_high;
  float dx_low, dx_high, dy_low, dy_high; /* and only in the splat's box: low ≤ dx ≤ high */
} conic_ray;

/* The part that blending and resolving read, half a cache line. */
typedef struct conic_projected_surface {
  float color[3];
  float normal[3]; /* world, unit, towards the viewer */
  uint32_t index;  /* in the splat set */
  float amplitude; /* the footprint's: blending need not read that */
} conic_projected_surface;

/* A splat with more opacity, or a colour beyond this, is skipped: no sum of 2³² of them overflows. */
#define CONIC_GREATEST_OPACITY 1e6f
#define CONIC_GREATEST_COLOR 1e18f

/* Set-up may write so many records past a chunk's last, to all arrays but rays and clips. */
#define CONIC_PROJECT_SLACK 16

/* A chunk of consecutive splats, projected and compacted. */
typedef struct conic_chunk {
  size_t first, n_drawn;    /* its splats are at first … first + n_drawn in the arrays below */
  size_t first_ray, n_rays; /* its rays likewise in rays */
  size_t n_laplaces;        /* of them */
  size_t n_culled, n_skipped, n_fallback;
  size_t n_elsewhere; /* drawn in the picture, and not in the window (raster/frame/windowed.c) */
  unsigned bands;     /* of conic_projected: those that its splats meet */
} conic_chunk;

/* Projected splats, chunk by chunk, each in file order until raster/tiles/bins.h sorts it. The arrays have room for
 * every splat of the chunks; only what is drawn is touched. */
typedef struct conic_projected {
  size_t n_chunks, chunk_size;
  conic_chunk *chunks;
  conic_footprint *footprints;
  conic_box *boxes;
  conic_projected_surface *surfaces;
  conic_ray *rays;
  struct conic_clip_record *clips; /* of the footprints that are marked; null where the set has no clip lines */
  /* Of a picture that is drawn in bands: a bit for each that a splat meets, and the band whose splats alone are
   * projected, or 0: all are. */
  unsigned char *bands;
  unsigned band;
} conic_projected;

/* Projects splat i, the next of its chunk, and appends it to the chunk where it is drawn. */
void conic_project_one(const conic_view *view, const conic_splats *splats, size_t i, conic_projected *projected,
                       conic_chunk *chunk);

/* `project` in plain C. */
void conic_project_range(const conic_view *view, const conic_splats *splats, size_t begin, size_t end,
                         conic_projected *projected, conic_chunk *chunk);

/* Projects the whole of chunk i_chunk by conic_project_range, each splat with a place of its own in the arrays. */
void conic_project_chunk(const conic_view *view, const conic_splats *splats, size_t i_chunk,
                         conic_projected *projected);

/* What became of a splat. */
typedef enum conic_outcome {
  CONIC_DRAWN_VARIANCE, /* by a variance on the screen: the dual conic's, or the centre's Jacobian's */
  CONIC_DRAWN_RAY,      /* by the exact ray–splat parameter */
  CONIC_DRAWN_DOT,      /* by a circle or a pixel about the projected centre */
  CONIC_DRAWN_SEGMENT,  /* edge-on and reaching the near plane: by the variance of a segment */
  CONIC_CULLED,
  CONIC_SKIPPED
} conic_outcome;

/* A splat in camera space, in double, for the paths that float cannot walk. */
typedef struct conic_disc {
  double p[3], tu[3], tv[3];
  double n[3];        /* tu × tv */
  double determinant; /* p · n */
} conic_disc;

conic_disc conic_disc_of(const conic_view *view, const conic_splats *splats, size_t i);

/* Sets up a splat by the ray–splat parameter; its projected disc, clipped at near where it reaches it, gives the
 * box. nearness and amplitude are left to the caller. Returns DRAWN_RAY, CULLED (off-screen) or SKIPPED. */
conic_outcome conic_project_ray(const conic_view *view, const conic_disc *disc, conic_footprint *footprint,
                                conic_box *box, conic_ray *ray);

/* The same for a disc that reaches the near plane, which may turn out to stand edge-on (DRAWN_SEGMENT: the amplitude
 * is 0). */
conic_outcome conic_project_near(const conic_view *view, const conic_disc *disc, conic_footprint *footprint,
                                 conic_box *box, conic_ray *ray);
