/* Clip lines of splats that are rounded. */
#include "lod/octree/octree_nodes.h"

static double dot_at(float *const a[3], size_t i, float *const b[3], size_t k) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++)
    sum += (double)a[axis][i] * (double)b[axis][k];
  return sum;
}

/* A line says where a·u + b·v + c is at least 0. In space that is a direction in the splat's plane and what it is at
 * the centre; both are looked at from the rounded splat's centre and along its axes. */
static void move_line(const conic_splats *before, const conic_splats *after, size_t i, float line[3]) {
  double uu = dot_at(before->tangent_u, i, before->tangent_u, i),
         vv = dot_at(before->tangent_v, i, before->tangent_v, i);
  double uv = dot_at(before->tangent_u, i, before->tangent_v, i), determinant = uu * vv - uv * uv;
  double along_u = ((double)line[0] * vv - (double)line[1] * uv) / determinant;
  double along_v = ((double)line[1] * uu - (double)line[0] * uv) / determinant;
  double moved[3] = {0.0, 0.0, (double)line[2]};
  for (int axis = 0; axis < 3; axis++) {
    double slope = along_u * (double)before->tangent_u[axis][i] + along_v * (double)before->tangent_v[axis][i];
    moved[0] += slope * (double)after->tangent_u[axis][i];
    moved[1] += slope * (double)after->tangent_v[axis][i];
    moved[2] += slope * ((double)after->position[axis][i] - (double)before->position[axis][i]);
  }
  for (int k = 0; k < 3; k++)
    line[k] = (float)moved[k];
}

void conic_octree_move_clips(conic_octree *octree, const conic_splats *before, const conic_splats *after) {
  for (size_t i = 0; octree->n_clips && i < octree->n_leaves; i++) {
    uint32_t i_clip = octree->clip_of_point[octree->index[i]];
    for (int k = 0; i_clip != CONIC_NO_CLIP && k < octree->clips[i_clip].n_lines; k++)
      move_line(before, after, i, octree->clips[i_clip].lines[k]);
  }
}
