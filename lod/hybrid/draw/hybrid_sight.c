/* Which nodes stand for all of their clusters before any of the clusters is looked at. */
#include "lod/hybrid/draw/hybrid_offers.h"

/* All of the sphere: what reaches out of the picture has clusters that take nothing. */
static int is_all_in_sight(const conic_hybrid_camera *view, const conic_hybrid_bound *bound) {
  double at[3], radius = (double)bound->radius * (1.0 + 1e-6);
  int is_in = 1;
  conic_viewpoint_move_floats(&view->from, bound->center, at);
  for (int i = 0; i < 4; i++)
    is_in &= conic_dot(view->from.side[i], at) >= radius;
  return is_in && at[2] - radius > view->near_z;
}

int conic_hybrid_stands_at_once(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                                const conic_hybrid_node *node, double error_px, conic_hybrid_offer *offer,
                                double *saved_ns) {
  double least_ns = CONIC_HYBRID_LEAST_NS * (double)(node->end - node->begin);
  if (!is_all_in_sight(view, &node->bound))
    return 0;
  *offer = conic_hybrid_node_offer(hybrid, view, node, error_px);
  if (!(offer->amount <= least_ns))
    return 0;
  *saved_ns += least_ns - offer->amount;
  return 1;
}
