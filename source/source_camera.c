/* How a source is looked at: a camera that its outline just fits, and which way it stands. */
#include <string.h>

#include "conic/source.h"
#include "source/source_kind.h"
#include "source/upright.h"

/* A hierarchy's outline is known well enough from what this error leaves, in pixels of the framed picture. */
static const double outline_error_px = 1.0;

/* Hands over what is seen of it from where all of it is seen. */
static conic_status choose_outline(conic_source *source, const conic_camera *camera, float cutoff) {
  conic_render_options render;
  conic_source_view view;
  conic_render_options_init(&render);
  conic_source_view_init(&view);
  render.kernel.cutoff = cutoff;
  view.error_px = source->kind->abilities & CONIC_SOURCE_CHOOSES ? outline_error_px : 0.0;
  return conic_source_choose(source, camera, &render, &view);
}

conic_status conic_source_stand(conic_source *source) {
  conic_source_scale *scale = &source->scale;
  conic_camera camera;
  if (scale->up_basis != CONIC_UP_HABIT)
    return CONIC_OK;
  conic_status status = CONIC_OK;
  if (source->kind->draw)
    scale->up_basis = conic_upright_box(scale->minimum, scale->maximum, 0);
  else {
    status = conic_source_frame(source, NULL, &camera);
    if (status == CONIC_OK)
      status = choose_outline(source, &camera, 1.5f);
    if (status == CONIC_OK)
      status = conic_upright_look(source->context, &source->choice.drawing, &scale->up_basis);
  }
  if (scale->up_basis != CONIC_UP_HABIT)
    memcpy(scale->up, (const double[3]){0.0, 0.0, 1.0}, sizeof scale->up);
  return status;
}

conic_status conic_source_fit(conic_source *source, const conic_framing *framing, float cutoff, int n_turns,
                              conic_camera *camera, double *near_z) {
  conic_framing own;
  conic_framing_init(&own);
  memcpy(own.up, source->scale.up, sizeof own.up);
  if (framing)
    own = *framing;
  double zoom = own.zoom;
  own.zoom = 1.0; /* what lies outside a picture that is zoomed into counts as well */
  conic_status status = conic_source_frame(source, &own, camera);
  if (near_z)
    *near_z = source->scale.near_z;
  if (status != CONIC_OK || source->kind->draw)
    return status == CONIC_OK ? conic_source_frame(source, framing ? framing : &own, camera) : status;
  status = choose_outline(source, camera, cutoff);
  own.zoom = zoom;
  return status == CONIC_OK
             ? conic_drawing_frame(source->context, &source->choice.drawing, cutoff, &own, n_turns, camera, near_z)
             : status;
}
