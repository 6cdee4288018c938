#include "raster/project/clip_lines.h"

#include <string.h>

#include "core/base/vectors.h"
#include "core/splats/clip.h"
#include "raster/project/clip_disc.h"
#include "raster/view/method.h"

/* Mates are clipped at the same line from both sides: by this much both keep it, so that no rounding leaves a gap. */
#define OVERLAP_PX (1.0 / 256.0)

/* The columns of M's adjugate, t_v × p, p × t_u, t_u × t_v; returns the sign of |M|. */
static double adjugate(const conic_disc *disc, double columns[3][3]) {
  conic_cross(disc->tv, disc->p, columns[0]);
  conic_cross(disc->p, disc->tu, columns[1]);
  for (int axis = 0; axis < 3; axis++)
    columns[2][axis] = disc->n[axis];
  return disc->determinant > 0.0 ? 1.0 : disc->determinant < 0.0 ? -1.0 : 0.0;
}

/* A line on the screen, from m = adj(M)·lᵀ. Returns 0 where it is none there: of a plane seen exactly from its edge, or
 * through the eye. */
static int set_line(const conic_view *view, const conic_footprint *footprint, const double columns[3][3], double sign,
                    const float line[3], conic_clip_record *record, int i) {
  double m[3];
  for (int axis = 0; axis < 3; axis++)
    m[axis] =
        ((double)line[0] * columns[0][axis] + (double)line[1] * columns[1][axis]) + (double)line[2] * columns[2][axis];
  double by_x = m[0] / view->fx, by_y = m[1] / view->fy;
  double length = sqrt(by_x * by_x + by_y * by_y);
  if (sign == 0.0 || !(length > 0.0) || !(length * 0.0 == 0.0))
    return 0;
  /* The reference is where dx = dy = 0. */
  double x = ((double)footprint->x + 0.5 - (double)footprint->dx0) - view->cx;
  double y = ((double)footprint->y + 0.5 - (double)footprint->dy0) - view->cy;
  double distance = ((x * by_x + y * by_y) + m[2]) / length;
  double d0 = sign * distance + OVERLAP_PX;
  d0 = d0 > -1e9 ? d0 < 1e9 ? d0 : 1e9 : -1e9; /* farther than any pixel */
  record->d0[i] = (float)d0;
  record->by_x[i] = (float)(sign * by_x / length);
  record->by_y[i] = (float)(sign * by_y / length);
  return 1;
}

/* The pixels of [0, size) whose centres lie in [low, high], as offsets from the reference. */
static void set_clip_range(double low, double high, int size, float reference, float fraction, float range[2]) {
  double first = ceil(low - 0.5), last = floor(high - 0.5);
  first = first > 0.0 ? first : 0.0;
  last = last < (double)(size - 1) ? last : (double)(size - 1);
  if (!(first <= last)) { /* none */
    first = 1.0;
    last = 0.0;
  }
  range[0] = ((float)first - reference) + fraction;
  range[1] = ((float)last - reference) + fraction;
}

/* Seen nearly edge-on, lines fall onto the trace of the splat's plane and clip little along it: the box does. Dots know
 * no tilt, and so nothing of it. */
static void set_clip_box(const conic_view *view, const conic_disc *disc, const conic_clip *clip,
                         const conic_footprint *footprint, conic_clip_record *record) {
  float lines[2][3], x[2], y[2];
  double low[2], high[2], growth = (double)view->growth_px + OVERLAP_PX;
  int n_lines = 0;
  for (int i = 0; i < clip->n_lines && i < 2; i++)
    if (conic_clip_is_line(clip->lines[i]))
      memcpy(lines[n_lines++], clip->lines[i], sizeof lines[0]);
  if (n_lines == 0 || conic_method_is_dot(view->method))
    return;
  if (!conic_clip_box(view, disc, (const float(*)[3])lines, n_lines, n_lines == 2 && clip->operation == CONIC_CLIP_OR,
                      low, high)) {
    low[0] = low[1] = 1e9;
    high[0] = high[1] = -1e9;
  }
  set_clip_range(low[0] - growth, high[0] + growth, view->width, footprint->x, footprint->dx0, x);
  set_clip_range(low[1] - growth, high[1] + growth, view->height, footprint->y, footprint->dy0, y);
  record->dx_low = x[0];
  record->dx_high = x[1];
  record->dy_low = y[0];
  record->dy_high = y[1];
}

static conic_clip_record project_clip(const conic_view *view, const conic_splats *splats, const conic_clip *clip,
                                      const conic_footprint *footprint) {
  conic_disc disc = conic_disc_of(view, splats, clip->splat);
  double columns[3][3], sign = adjugate(&disc, columns);
  conic_clip_record record = {
      .d0 = {1.0f, 1.0f}, .dx_low = -1e30f, .dx_high = 1e30f, .dy_low = -1e30f, .dy_high = 1e30f};
  int n_lines = 0;
  for (int i = 0; i < clip->n_lines && i < 2; i++)
    if (conic_clip_is_line(clip->lines[i]))
      n_lines += set_line(view, footprint, (const double(*)[3])columns, sign, clip->lines[i], &record, n_lines);
  record.is_or = n_lines == 2 && clip->operation == CONIC_CLIP_OR;
  set_clip_box(view, &disc, clip, footprint, &record);
  return record;
}

void conic_clip_chunk(const conic_view *view, const conic_splats *splats, size_t begin, conic_projected *projected,
                      const conic_chunk *chunk) {
  size_t i_clip = conic_clip_find(splats, begin);
  for (size_t i = chunk->first; i < chunk->first + chunk->n_drawn && i_clip < splats->n_clips; i++) {
    while (i_clip < splats->n_clips && splats->clips[i_clip].splat < projected->surfaces[i].index)
      i_clip++;
    if (i_clip == splats->n_clips || splats->clips[i_clip].splat != projected->surfaces[i].index)
      continue;
    conic_footprint *footprint = &projected->footprints[i];
    projected->clips[i] = project_clip(view, splats, &splats->clips[i_clip], footprint);
    footprint->s3 = -footprint->s3;
  }
}
