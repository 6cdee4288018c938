#include "raster/frame/statistics.h"

void conic_statistics_add_pixels(const conic_render_statistics *part, conic_render_statistics *sum) {
  const conic_render_statistics before = *sum;
  *sum = *part;
  sum->triangle_fragments += before.triangle_fragments;
  sum->fragments += before.fragments;
  sum->pixels_covered += before.pixels_covered;
  sum->ms.setup += before.ms.setup;
  sum->ms.bin += before.ms.bin;
  sum->ms.visibility += before.ms.visibility;
  sum->ms.accumulate += before.ms.accumulate;
  sum->ms.resolve += before.ms.resolve;
  sum->ms.frame += before.ms.frame;
}

void conic_statistics_add(const conic_render_statistics *part, conic_render_statistics *sum) {
  const conic_render_statistics before = *sum;
  conic_statistics_add_pixels(part, sum);
  sum->splats_in += before.splats_in;
  sum->splats_culled += before.splats_culled;
  sum->splats_skipped += before.splats_skipped;
  sum->splats_drawn += before.splats_drawn;
  sum->splats_fallback += before.splats_fallback;
  sum->splats_by_laplace += before.splats_by_laplace;
  for (int i = 0; i < CONIC_N_METHODS; i++)
    sum->splats_by_method[i] += before.splats_by_method[i];
  sum->triangles_in += before.triangles_in;
  sum->triangles_drawn += before.triangles_drawn;
  sum->triangles_culled += before.triangles_culled;
  sum->triangles_skipped += before.triangles_skipped;
}
