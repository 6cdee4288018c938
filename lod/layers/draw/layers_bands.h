/* A picture, or a window of it, drawn in bands, or in parts of bands, each with no more splats than memory holds. */
#ifndef CONIC_LAYERS_BANDS_H
#define CONIC_LAYERS_BANDS_H

#include "lod/layers/draw/layers_gather.h"

typedef struct conic_layers_band_drawing {
  conic_layers *layers;
  conic_renderer *renderer;
  const conic_camera *camera;
  const conic_render_options *render; /* near_z and splat_length given */
  const conic_layers_cut *cut;
  const conic_layers_view *view;
  int samples;
  conic_transparency transparency; /* NONE where the samples keep no opacities */
  double chance;
  conic_window window;    /* the picture's pixels that the image has: all, or some within one of its bands */
  const uint32_t *chosen; /* places of the cut, ascending: those that the window may show */
  size_t n_chosen;
  const unsigned char *is_counted; /* a place of the cut: 0 where another window counts what becomes of its splats */
  conic_image *image;
  conic_layers_set *set;
  void (*is_gathered)(void *data); /* called where nothing more will be read; null: nothing */
  void *data;
  uint64_t *n_turned; /* grows by the samples that face away and were left out */
} conic_layers_band_drawing;

/* Draws the chosen places that are not hidden, in as many bands as memory asks for. *statistics become those of the
 * whole picture, whatever the bands; or, for a window, its share of them. Errors: as conic_layers_draw. */
conic_status conic_layers_draw_bands(const conic_layers_band_drawing *drawing, conic_render_statistics *statistics,
                                     int *n_bands);

#endif
