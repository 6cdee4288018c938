/* Contributions: what each splat adds to each pixel, behind the sums of an image. They explain why a pixel is as it is
 * (conic explain), and make deep images (conic render --deep). They agree with conic_render bit for bit: the weights of
 * a pixel's visible splats, added in the order of the splats, make its weight plane. */
#ifndef CONIC_CONTRIBUTIONS_H
#define CONIC_CONTRIBUTIONS_H

#include "conic/triangles.h"

CONIC_BEGIN_C

/* What becomes of a splat in a frame. */
typedef enum conic_fate {
  CONIC_FATE_VARIANCE = 0, /* drawn as an ellipse on the screen: by a variance */
  CONIC_FATE_RAY = 1,      /* drawn by the exact ray–splat parameter */
  CONIC_FATE_CULLED = 2,   /* behind near, off the screen, or facing away where such splats are culled */
  CONIC_FATE_SKIPPED = 3   /* cannot be drawn: not finite, or without area */
} conic_fate;

/* "variance", "ray", "culled", "skipped"; null for a number that is no fate. */
CONIC_API const char *conic_fate_name(conic_fate fate);

/* A splat on the screen. Where it is not drawn, only `splat` and `fate` are set. */
typedef struct conic_projection {
  uint32_t splat; /* index in the set */
  conic_fate fate;
  int x_begin, x_end, y_begin, y_end; /* pixels that it may cover */
  double amplitude;                   /* includes the opacity; multiplies the kernel, for rays together with a factor a
                                         pixel */
  double nearest_z, farthest_z;       /* the range of its depths in camera space */
  double nearness;                    /* 1 / (1 + ε/distance) */
  float color[3], normal[3];          /* linear; world, unit, towards the viewer */
  /* Of a variance only: the centre, the variance with the prefilter in it (xx, xy, yy in px²), and its inverse, the
   * conic. A pixel at (x, y) from the centre is covered where a·x² + 2b·xy + c·y² is below the support. */
  double center_px[2], variance_px[3], conic[3];
  uint64_t reserved[8];
} conic_projection;

/* What a splat does to a pixel in its reach. */
typedef enum conic_contribution_verdict {
  CONIC_CONTRIBUTION_VISIBLE = 0, /* it is blended */
  CONIC_CONTRIBUTION_HIDDEN = 1,  /* it covers the pixel, but behind another; or is not the nearest, where one wins */
  CONIC_CONTRIBUTION_CLIPPED = 2, /* beyond a clip line; or its ellipse covers the pixel, but at a depth beyond its
                                     depths */
  CONIC_CONTRIBUTION_OUTSIDE = 3  /* beyond the cutoff */
} conic_contribution_verdict;

#define CONIC_N_CONTRIBUTION_VERDICTS 4

/* "visible", "hidden", "clipped", "outside"; null for a number that is none. */
CONIC_API const char *conic_contribution_verdict_name(conic_contribution_verdict verdict);

typedef struct conic_contribution {
  uint32_t splat;
  conic_contribution_verdict verdict;
  /* Where it covers the pixel (visible or hidden), else zero: */
  float q;                                  /* squared distance in standard deviations */
  float weight;                             /* what it adds to the sums, if visible */
  float depth;                              /* camera-space z, as in the plane Z if it were the heaviest */
  float inverse_depth, plane_inverse_depth; /* iz and iz_plane of docs/reference/picture.md, which decide visibility */
  float hides;                              /* s·min(iz, iz_plane): splats below that are hidden */
} conic_contribution;

/* A triangle that covers a pixel. */
typedef struct conic_triangle_contribution {
  uint32_t triangle;
  conic_contribution_verdict verdict; /* visible; or hidden, behind another triangle or behind splats */
  float depth, inverse_depth;
  float hides; /* iz / (1 + ε·iz/|d|): splats below that are hidden, if the triangle is the nearest */
  float color[3], normal[3];
} conic_triangle_contribution;

/* A frame's splats, projected. One thread at a time. */
typedef struct conic_contributions conic_contributions;

/* Projects the splats, with tangent axes, for a frame; `options` as for conic_render. The splats must outlive
 * *contributions. On success the caller owns *contributions, which must not outlive the context; on failure it is null.
 * Errors: ARGUMENT, MEMORY, UNSUPPORTED (the options' instruction set is not here). */
CONIC_API conic_status conic_contributions_create(conic_context *context, const conic_splats *splats,
                                                  const conic_camera *camera, const conic_render_options *options,
                                                  conic_contributions **contributions);
/* conic_contributions_create for splats and triangles: what a triangle hides is hidden. Errors also: INPUT
 * (conic_triangles_check). */
CONIC_API conic_status conic_contributions_create_drawing(conic_context *context, const conic_drawing *drawing,
                                                          const conic_camera *camera,
                                                          const conic_render_options *options,
                                                          conic_contributions **contributions);
/* Null is allowed. */
CONIC_API void conic_contributions_destroy(conic_contributions *contributions);

/* Projects splat `i` of the set again and fills in all of *projection. Errors: ARGUMENT (there is no such splat). */
CONIC_API conic_status conic_contributions_project(const conic_contributions *contributions, size_t i,
                                                   conic_projection *projection);

/* Lists every splat that may cover the pixel, in the order of the set: *list has *n of them and stays until the next
 * call. Errors: ARGUMENT (outside the picture), MEMORY. */
CONIC_API conic_status conic_contributions_at(conic_contributions *contributions, int x, int y,
                                              const conic_contribution **list, size_t *n);

/* Lists every triangle that covers the pixel, as conic_contributions_at does the splats; the list of splats stays. */
CONIC_API conic_status conic_contributions_triangles_at(conic_contributions *contributions, int x, int y,
                                                        const conic_triangle_contribution **list, size_t *n);

/* Writes the visible splats of every pixel, and the visible triangle, as a deep scanline EXR, from front to back:
 * channels R, G, B, A (premultiplied), Z (the depth), id (UINT; triangle j is the number of splats + j) and weight.
 * Laid over each other, a pixel's samples make the pixel of `header`, where that has rgba of this size, else the
 * albedo; alpha is 1. `header` also gives the attributes; it may be null. The file appears under its name only when it
 * is whole. Reports progress as "deep". Errors: UNSUPPORTED (a build without OpenEXR), MEMORY, IO, CANCELLED. */
CONIC_API conic_status conic_contributions_write(conic_contributions *contributions, const char *path,
                                                 const conic_image *header);

CONIC_END_C
#endif
