/* How the places of a layered point cloud look in one picture: bounds that hold for all that is drawn of them. */
#pragma once

#include "core/image/viewpoint.h"
#include "lod/layers/format/layers_decode.h"
#include "raster/view/part.h"

typedef struct conic_layers_view {
  int width, height;
  conic_viewpoint from; /* places from the origin; the sides as far out as the prefilter reaches */
  double fx, fy, cx, cy;
  double least_focal, greatest_focal;
  double near_z;
  double growth_px; /* how far the prefilter moves an outline, and a pixel for all that rounds */
  double beyond_px; /* a splat's plane counts at pixels up to so far from its disc; with grows_with_size, farther by the
                       splat's own size */
  int grows_with_size;
  int is_exact_outline; /* discs are drawn within their widened projection; else also where their Jacobian puts them */
  int is_flat;          /* splats have no plane but the one across the line of sight */
  int cull_back;
} conic_layers_view;

void conic_layers_view_init(const conic_layers_header *header, const conic_camera *camera,
                            const conic_render_options *render, double near_z, conic_layers_view *view);

/* What a picture shows of a place at most. */
typedef struct conic_layers_sight {
  double error_px;     /* infinite where the place reaches the near plane */
  double near_iz;      /* no inverse depth of its splats is greater; infinite likewise */
  double distance;     /* of its nearest point, at least, to the eye */
  conic_window pixels; /* those that it may cover */
} conic_layers_sight;

/* 0 where nothing of the place can be in the picture. */
int conic_layers_look(const conic_layers_view *view, const conic_layers_entry *entry, conic_layers_sight *sight);

/* Narrows a place's pixels to those that one of its splats may cover. Its position is relative to the origin. 0: there
 * are none. */
int conic_layers_narrow(const conic_layers_view *view, const float position[3], double radius, conic_window *pixels);

/* How many pixels a splat of the place reaches at most from where its centre is seen. Narrowing comes to no more.
 * Infinite where a splat may be close to the eye. */
double conic_layers_reach(const conic_layers_view *view, const conic_layers_entry *entry,
                          const conic_layers_sight *sight);

/* 0 where neither a splat that reaches so far, nor its pixels by narrowing, can meet the window. */
static inline int conic_layers_may_meet(const conic_layers_view *view, const float position[3], double reach_px,
                                        const conic_window *window) {
  double p[3];
  if (!(reach_px < HUGE_VAL))
    return 1;
  conic_viewpoint_move_floats(&view->from, position, p);
  double x = view->cx + view->fx * p[0] / p[2], y = view->cy + view->fy * p[1] / p[2];
  return y + reach_px >= (double)window->y_begin && y - reach_px <= (double)window->y_end &&
         x + reach_px >= (double)window->x_begin && x - reach_px <= (double)window->x_end;
}

/* The least |n·p| of the place's splats: their planes are at least so far from the eye. 0 where that is not known. */
double conic_layers_least_offset(const conic_layers_view *view, const conic_layers_entry *entry);

/* Where everything hides up to the inverse depth `hiding`, no splat of the place is seen whose plane is farther from
 * the eye than this. Infinite where that cannot be said of any. */
double conic_layers_hidden_offset(const conic_layers_view *view, const conic_layers_entry *entry,
                                  const conic_layers_sight *sight, double hiding);

/* --- which way samples face --- */

/* The cone of each set: unit axis, and cosine and sine of half its opening. */
typedef struct conic_layers_facings {
  float axis[3][CONIC_LAYERS_FACINGS], cosine[CONIC_LAYERS_FACINGS], sine[CONIC_LAYERS_FACINGS];
} conic_layers_facings;

/* For each set, whether its samples face away wherever they lie in a place. */
typedef struct conic_layers_turned {
  uint32_t bits[CONIC_LAYERS_FACINGS / 32];
  int is_any;
} conic_layers_turned;

void conic_layers_facings_init(conic_layers_facings *facings);

void conic_layers_find_turned(const conic_layers_facings *facings, const conic_layers_view *view,
                              const conic_layers_entry *entry, conic_layers_turned *turned);

static inline int conic_layers_is_turned(const conic_layers_turned *turned, uint16_t facing) {
  return (int)(turned->bits[facing >> 5] >> (facing & 31) & 1);
}
