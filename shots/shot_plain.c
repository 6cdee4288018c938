#include "shots/shot_plain.h"

#include <string.h>

/* What lens and shutter do not have is not there. */
static void plain_samples(conic_shot *shot) {
  if (shot->n_samples == 0) {
    shot->noise = 0.0;
    shot->is_shutter_open = 0;
    memset(&shot->aperture, 0, sizeof shot->aperture);
  }
  if (!(shot->aperture.diameter > 0.0)) {
    memset(&shot->aperture, 0, sizeof shot->aperture);
    shot->focus_kind = CONIC_FOCUS_MIDDLE;
  }
  if (!shot->is_shutter_open) {
    memset(&shot->way, 0, sizeof shot->way);
    memset(shot->shutter, 0, sizeof shot->shutter);
  }
  if (shot->way.kind != CONIC_WAY_CAMERAS)
    shot->way.cameras = NULL, shot->way.n_cameras = 0;
  if (shot->eye.shift == 0.0)
    memset(&shot->eye, 0, sizeof shot->eye);
}

static void plain_shot(conic_shot *shot, unsigned abilities) {
  conic_shot standard;
  conic_shot_init(&standard);
  plain_samples(shot);
  if (shot->focus_kind != CONIC_FOCUS_DEPTH)
    shot->aperture.focus = 0.0;
  if (shot->focus_kind != CONIC_FOCUS_PIXEL)
    memset(shot->focus_pixel, 0, sizeof shot->focus_pixel);
  if (!shot->has_backdrop) {
    memset(shot->backdrop_top, 0, sizeof shot->backdrop_top);
    memset(shot->backdrop_bottom, 0, sizeof shot->backdrop_bottom);
  }
  if (!shot->render.has_background)
    memset(shot->render.background, 0, sizeof shot->render.background);
  if (!(abilities & CONIC_SOURCE_COMPOSITES))
    shot->gaussians = standard.gaussians;
}

static void plain_reading(conic_source_options *reading, unsigned abilities) {
  reading->texture_path = NULL;
  reading->access = NULL;
  if (reading->as != CONIC_AS_PATCHES) {
    reading->patches = NULL;
    reading->h_in_spacings = 0;
  }
  if (!(abilities & CONIC_SOURCE_COMPOSITES))
    reading->gaussians = NULL;
}

void conic_shot_file_plain(conic_shot_file *file, unsigned abilities) {
  plain_shot(&file->shot, abilities);
  plain_reading(&file->reading, abilities);
  if (file->map.is_wanted)
    memset(&file->shot.camera, 0, sizeof file->shot.camera); /* it follows */
}
