/* Surfaces among Gaussians: what stages between the two need. */
#pragma once

#include "conic/source.h"

/* The source of the surfaces that are drawn among a source's Gaussians, which stays its own; null: there are none. */
conic_source *conic_source_surfaces(const conic_source *source);

/* How surfaces are drawn for a picture of both: without a background, a pixel each of its samples, and by the error
 * that the source's Gaussians were chosen by. */
typedef struct conic_surfaces_look {
  conic_camera camera;
  conic_render_options render;
  conic_source_view view;
  unsigned planes; /* that a picture with the given ones needs of them */
} conic_surfaces_look;

conic_surfaces_look conic_surfaces_look_of(const conic_source *source, const conic_camera *camera,
                                           const conic_render_options *render, const conic_source_view *view,
                                           unsigned planes);

/* Draws the surfaces of a source that has some by themselves, with the planes that a picture with the given ones needs
 * of them. The caller releases *surfaces, after a failure, too. Errors: as conic_source_draw. */
conic_status conic_source_draw_surfaces(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                        const conic_render_options *render, const conic_source_view *view,
                                        unsigned planes, conic_image *surfaces);

/* Draws the surfaces, without a background, one sample a pixel, into all planes that the image has: those that it needs
 * by itself are bits of `planes`. */
typedef struct conic_surfaces_drawer {
  unsigned planes;
  conic_status (*draw)(void *cookie, const conic_camera *camera, const conic_render_options *render,
                       const conic_source_view *view, conic_image *surfaces, conic_render_statistics *statistics);
  void *cookie;
} conic_surfaces_drawer;

/* conic_source_draw of a source with surfaces, which the drawer draws as finely as samples are. Errors: as there, and
 * the drawer's. */
conic_status conic_source_draw_among(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                     const conic_render_options *render, const conic_source_view *view,
                                     const conic_surfaces_drawer *drawer, conic_image *image,
                                     conic_render_statistics *statistics);
