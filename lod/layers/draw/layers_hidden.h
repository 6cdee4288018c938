/* Occlusion culling: which places of a cut are hidden by others. No bit of the picture changes by it. */
#ifndef CONIC_LAYERS_HIDDEN_H
#define CONIC_LAYERS_HIDDEN_H

#include "lod/layers/draw/layers_gather.h"

/* How many surfaces lie behind each other, on average over the pixels that the places cover. It tells whether much is
 * hidden. Each place is taken to show as much of its area as it does on average from all sides. */
double conic_layers_depth_complexity(const conic_layers *layers, const conic_layers_view *view,
                                     const conic_layers_cut *cut);

/* Sets the states of the cut's places. Of places, only how deep they hide is drawn, from front to back, a share at a
 * time. What lies wholly behind what was drawn so far is not drawn any more. Errors: as conic_layers_gather. */
conic_status conic_layers_hide(conic_layers *layers, conic_renderer *renderer, const conic_layers_view *view,
                               const conic_camera *camera, const conic_render_options *render, double until_s,
                               conic_layers_cut *cut, conic_layers_set *set);

#endif
