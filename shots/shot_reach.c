#include "shots/shot_reach.h"

double conic_splat_reach(const conic_shot_work *work) {
  const conic_source_scale *scale = conic_source_measure(work->source);
  return scale->n_splats ? (double)work->shot->render.kernel.cutoff * scale->splat_length : 0.0;
}

void conic_find_reach(const conic_shot_work *work, double minimum[3], double maximum[3]) {
  double reach = 4.0 * conic_splat_reach(work); /* no splat counts that is larger (docs/reference/picture.md, ε) */
  conic_source_box(work->source, minimum, maximum);
  for (int axis = 0; axis < 3; axis++) {
    minimum[axis] -= reach;
    maximum[axis] += reach;
  }
}
