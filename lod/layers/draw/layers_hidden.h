/* Occlusion culling: which places of a cut are hidden by others, tested so that no bit of the picture changes. */
#ifndef CONIC_LAYERS_HIDDEN_H
#define CONIC_LAYERS_HIDDEN_H

#include "lod/layers/draw/layers_gather.h"

/* Whether the index promises that much is hidden: how many surfaces lie behind each other, on average over the pixels
 * that the places cover, if each shows the side that its area does from everywhere on average. */
double conic_layers_depth_complexity(const conic_layers *layers, const conic_layers_view *view,
                                     const conic_layers_cut *cut);

/* Sets the states of the cut's places. Places are drawn from front to back, no more than how deep they hide, a share at
 * a time; what lies wholly behind what was drawn so far is not drawn any more. Errors: as conic_layers_gather. */
conic_status conic_layers_hide(conic_layers *layers, conic_renderer *renderer, const conic_layers_view *view,
                               const conic_camera *camera, const conic_render_options *render, double until_s,
                               conic_layers_cut *cut, conic_layers_set *set);

#endif
