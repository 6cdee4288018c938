/* What octree_view.h says of measuring: plain C, which compilers put in lanes. */
#include <math.h>

#include "lod/octree/octree_kernels.h"

/* A displacement by e of what is at X changes its projection by no more than f·e·|X|/z²: the greatest factor of the
 * projection's derivative is f·|X|/z². All that a node is about, from its leaves' discs to its own, lies in its sphere,
 * and so does the way from the one to the other. */
static inline void measure_errors(const conic_octree *octree, const conic_octree_view *view, size_t begin,
                                  float *pixels) {
  const float *x = octree->center[0] + begin, *y = octree->center[1] + begin, *z = octree->center[2] + begin;
  const float *radius = octree->radius + begin, *error = octree->error + begin;
  const conic_octree_view v = *view;
  for (int i = 0; i < CONIC_OCTREE_GROUP; i++) {
    float cx = ((v.rotation[0][0] * x[i] + v.rotation[0][1] * y[i]) + v.rotation[0][2] * z[i]) + v.translation[0];
    float cy = ((v.rotation[1][0] * x[i] + v.rotation[1][1] * y[i]) + v.rotation[1][2] * z[i]) + v.translation[1];
    float cz = ((v.rotation[2][0] * x[i] + v.rotation[2][1] * y[i]) + v.rotation[2][2] * z[i]) + v.translation[2];
    float r = radius[i] + (v.slack * ((fabsf(x[i]) + fabsf(y[i])) + fabsf(z[i])) + v.slack_offset);
    float distance = sqrtf((cx * cx + cy * cy) + cz * cz) + r, front = cz - r;
    float size = v.focal_px * error[i] * distance / (front * front);
    float left = v.side[0][0] * cx + v.side[0][2] * cz, right = v.side[1][0] * cx + v.side[1][2] * cz;
    float top = v.side[2][1] * cy + v.side[2][2] * cz, bottom = v.side[3][1] * cy + v.side[3][2] * cz;
    float least = left < right ? left : right;
    least = top < least ? top : least;
    least = bottom < least ? bottom : least;
    float before = cz - v.near_z;
    least = before < least ? before : least;
    size = front > v.near_z ? size : HUGE_VALF;
    pixels[i] = least < -r ? -1.0f : size;
  }
}

/* Nodes all of whose leaves face away are out of sight. Where some may and others do not, a part of what the node shows
 * is culled, and what is left of it may be at its other end: its error is its diameter. */
static inline void cull_backs(const conic_octree *octree, const conic_octree_view *view, size_t begin, float *pixels) {
  const float *x = octree->center[0] + begin, *y = octree->center[1] + begin, *z = octree->center[2] + begin;
  const float *nx = octree->normal[0] + begin, *ny = octree->normal[1] + begin, *nz = octree->normal[2] + begin;
  const float *radius = octree->radius + begin, *cone = octree->cone + begin, *error = octree->error + begin;
  const conic_octree_view v = *view;
  for (int i = 0; i < CONIC_OCTREE_GROUP; i++) {
    float dx = x[i] - v.eye[0], dy = y[i] - v.eye[1], dz = z[i] - v.eye[2];
    float along = (dx * nx[i] + dy * ny[i]) + dz * nz[i], distance = sqrtf((dx * dx + dy * dy) + dz * dz);
    float r = radius[i] + (v.slack * ((fabsf(x[i]) + fabsf(y[i])) + fabsf(z[i])) + v.slack_offset);
    /* α: half the angle under which the sphere is seen; γ: half the cone's. Away is where the angle between the ray and
     * the axis, α and γ are less than a right angle together. */
    float sin_a = r / distance, cos_a2 = 1.0f - sin_a * sin_a, cos_c = cone[i], sin_c2 = 1.0f - cos_c * cos_c;
    float cos_a = sqrtf(cos_a2 > 0.0f ? cos_a2 : 0.0f), sin_c = sqrtf(sin_c2 > 0.0f ? sin_c2 : 0.0f);
    float cos_both = cos_a * cos_c - sin_a * sin_c, sin_both = sin_a * cos_c + cos_a * sin_c;
    float least = cos_c < cos_both ? cos_c : cos_both; /* all of these must be above 0 */
    least = cos_a2 < least ? cos_a2 : least;
    float beyond = along - distance * (sin_both + 1e-5f);
    least = beyond < least ? beyond : least;
    float whole = pixels[i] > 0.0f ? pixels[i] * (2.0f * radius[i] / error[i]) : pixels[i];
    float opened = along > -distance * sin_c ? whole : pixels[i];
    pixels[i] = least > 0.0f ? -1.0f : opened;
  }
}

static void measure(const conic_octree *octree, const conic_octree_view *view, size_t begin, size_t n, float *pixels) {
  for (size_t k = 0; k < n; k += CONIC_OCTREE_GROUP) {
    measure_errors(octree, view, begin + k, pixels + k);
    if (view->cull_back)
      cull_backs(octree, view, begin + k, pixels + k);
  }
}
