#include "lod/octree/octree_cover.h"

#include "core/base/trigonometry.h"
#include "core/base/vectors.h"

void conic_disc_samples_init(conic_disc_samples *samples) {
  /* Rings that are turned against each other, found by search; a test holds the gap. The outermost, where most is to be
   * found out, is whole lanes by itself. */
  static const struct {
    int n;
    double radius, turn;
  } rings[] = {{16, 1.0, 0.0}, {12, 0.6131, 0.7384}, {4, 0.2478, 0.7273}};
  int n = 0;
  for (int ring = 0; ring < 3; ring++)
    for (int i = 0; i < rings[ring].n; i++) {
      double angle = 2.0 * CONIC_PI * ((double)i + rings[ring].turn) / (double)rings[ring].n;
      samples->x[n] = (float)(rings[ring].radius * conic_cos(angle));
      samples->y[n++] = (float)(rings[ring].radius * conic_sin(angle));
    }
}

void conic_discs_set_half(conic_discs *discs, size_t first) {
  for (int axis = 0; axis < 3; axis++) {
    const float *u = discs->u[axis], *v = discs->v[axis];
    float *half = discs->half[axis];
    for (size_t k = first; k < discs->count; k++)
      half[k] = sqrtf(u[k] * u[k] + v[k] * v[k]);
  }
}

static void pad(conic_discs *discs) {
  for (size_t k = discs->count; k % CONIC_DISC_BLOCK != 0; k++) {
    for (int axis = 0; axis < 3; axis++) {
      discs->center[axis][k] = HUGE_VALF; /* in no box */
      discs->u[axis][k] = discs->v[axis][k] = discs->half[axis][k] = 0.0f;
    }
    discs->error[k] = 0.0f;
  }
}

void conic_discs_close(conic_discs *discs) {
  size_t n_blocks = (discs->count + CONIC_DISC_BLOCK - 1) / CONIC_DISC_BLOCK;
  pad(discs);
  for (int axis = 0; axis < 3; axis++) {
    for (size_t block = 0; block < n_blocks; block++) {
      float low = HUGE_VALF, high = -HUGE_VALF;
      for (size_t k = block * CONIC_DISC_BLOCK; k < (block + 1) * CONIC_DISC_BLOCK && k < discs->count; k++) {
        float from = discs->center[axis][k] - discs->half[axis][k], to = discs->center[axis][k] + discs->half[axis][k];
        CONIC_WIDEN(low, high, from, to);
      }
      discs->block_center[axis][block] = 0.5f * low + 0.5f * high;
      discs->block_half[axis][block] = 0.5f * high - 0.5f * low;
    }
    for (size_t block = n_blocks; block % CONIC_DISC_BLOCK != 0; block++) {
      discs->block_center[axis][block] = HUGE_VALF;
      discs->block_half[axis][block] = 0.0f;
    }
  }
}
