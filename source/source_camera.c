/* Cameras for a source: one that its outline just fits; and which way is up. */

#include "raster/framing/drawing_frame.h"
#include "source/source_samples.h"
#include "source/surfaces_among.h"
#include "source/upright.h"

/* The outline of a hierarchy is known well enough with this error, in pixels of the framed picture. */
static const double outline_error_px = 1.0;

/* Chooses what a camera sees that sees the whole source. */
static conic_status choose_outline(conic_source *source, const conic_camera *camera, float cutoff) {
  conic_render_options render;
  conic_source_view view;
  conic_render_options_init(&render);
  conic_source_view_init(&view);
  render.kernel.cutoff = cutoff;
  view.error_px = source->kind->abilities & CONIC_SOURCE_CHOOSES ? outline_error_px : 0.0;
  return conic_source_choose(source, camera, &render, &view);
}

static conic_status find_outline(conic_source *source, const conic_camera *camera, float cutoff,
                                 conic_drawing *outline);

/* Adds the outline of surfaces among Gaussians: their splats to what is kept of these. */
static conic_status add_surfaces(conic_source *source, const conic_camera *camera, float cutoff,
                                 conic_drawing *outline) {
  conic_drawing own;
  conic_status status = find_outline(conic_source_surfaces(source), camera, cutoff, &own);
  if (status == CONIC_OK && !source->has_surfaces_outline)
    status = conic_splats_append(source->context, &source->outline, own.splats);
  source->has_surfaces_outline = status == CONIC_OK;
  outline->triangles = own.triangles;
  return status;
}

/* Finds the outline of any source: one that streams is drawn once instead. */
static conic_status find_outline(conic_source *source, const conic_camera *camera, float cutoff,
                                 conic_drawing *outline) {
  static const conic_triangles no_triangles;
  conic_status status = CONIC_OK;
  if (!source->kind->draw) {
    status = choose_outline(source, camera, cutoff);
    *outline = source->choice.drawing;
    return status;
  }
  if (source->outline.count == 0)
    status = conic_source_take_samples(source, &source->outline);
  *outline = (conic_drawing){&source->outline, &no_triangles};
  if (status == CONIC_OK && conic_source_surfaces(source))
    status = add_surfaces(source, camera, cutoff, outline);
  return status;
}

static conic_status look_around(conic_source *source, conic_up_basis *basis) {
  conic_camera camera;
  conic_drawing outline;
  conic_status status = conic_source_frame(source, NULL, &camera);
  if (status == CONIC_OK)
    status = find_outline(source, &camera, 1.5f, &outline);
  if (status == CONIC_OK)
    status = conic_upright_look(source->context, &source->shares, &outline, basis, source->fronts);
  source->has_front = status == CONIC_OK;
  return status;
}

conic_status conic_source_stand(conic_source *source) {
  conic_source_scale *scale = &source->scale;
  conic_status status = CONIC_OK;
  if (scale->up_basis != CONIC_UP_HABIT)
    return CONIC_OK;
  status = look_around(source, &scale->up_basis);
  if (scale->up_basis != CONIC_UP_HABIT)
    memcpy(scale->up, (const double[3]){0.0, 0.0, 1.0}, sizeof scale->up);
  return status;
}

/* Points over land; their normals, which may be guessed, are turned up. */
static int is_ground(const conic_source_scale *scale) {
  return !scale->n_triangles && scale->up[2] > 0.0 && scale->up_basis <= CONIC_UP_OPEN;
}

conic_status conic_source_front(conic_source *source, double front[3], double *least_slope) {
  static const double least_of_ground = 0.25, least_of_facades = 0.5; /* boxes that lack a side are none */
  conic_up_basis basis;
  conic_status status = CONIC_OK;
  memset(front, 0, 3 * sizeof *front);
  if (!source->has_front && !conic_source_gaussians(source))
    status = look_around(source, &basis);
  if (status == CONIC_OK)
    memcpy(front, source->fronts[is_ground(&source->scale)], 3 * sizeof *front);
  *least_slope = is_ground(&source->scale) ? least_of_ground : least_of_facades;
  return status;
}

conic_status conic_source_fit(conic_source *source, const conic_framing *framing, float cutoff, int n_turns,
                              conic_camera *camera, double *near_z) {
  conic_framing own;
  conic_drawing outline;
  conic_framing_init(&own);
  memcpy(own.up, source->scale.up, sizeof own.up);
  if (framing)
    own = *framing;
  double zoom = own.zoom;
  own.zoom = 1.0; /* parts outside of a zoomed picture count, too */
  conic_status status = conic_source_frame(source, &own, camera);
  if (status == CONIC_OK)
    status = find_outline(source, camera, cutoff, &outline);
  own.zoom = zoom;
  if (source->kind->draw && !conic_source_surfaces(source))
    cutoff = 0.0f; /* samples have no outlines: each is as wide as its pixel */
  return status == CONIC_OK ? conic_drawing_frame_shared(source->context, &source->shares, &outline, cutoff, &own,
                                                         n_turns, camera, near_z)
                            : status;
}
