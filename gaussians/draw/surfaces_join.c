#include "gaussians/draw/surfaces_join.h"

#include "core/base/base.h"
#include "core/base/color.h"

typedef struct surface_joining {
  conic_image *surfaces;
  const float *background;
  int is_linear;
  uint32_t first_id;
  conic_gaussian_planes *planes;
} surface_joining;

float conic_surface_shown(float premultiplied, float A, int is_linear) {
  return is_linear ? premultiplied : A * (float)conic_srgb_encode((double)(premultiplied / A));
}

static void join_colors(const surface_joining *j, size_t i, float T, const float rgba[4]) {
  conic_gaussian_planes *p = j->planes;
  const float A = rgba[3];
  for (size_t c = 0; c < 3; c++) {
    const float behind = j->background ? j->background[c] : 0.0f;
    const float color = A > 0.0f ? conic_surface_shown(rgba[c], A, j->is_linear) + (1.0f - A) * behind : behind;
    p->rgb[3 * i + c] += T * color;
  }
  p->transparency[i] = T * (1.0f - A);
}

/* Planes of depth: w is what of the light is the surface's. */
static void join_depths(const surface_joining *j, size_t i, float T, float w) {
  conic_gaussian_planes *p = j->planes;
  const float z = ((const float *)j->surfaces->planes[CONIC_PLANE_Z])[i], before = 1.0f - T;
  if (p->z)
    p->z[i] = before > 0.0f ? (before * p->z[i] + w * z) / (before + w) : z;
  if (p->inverse_z)
    p->inverse_z[i] += w / z;
  if (p->median_z && T > 0.5f && !(T - w > 0.5f))
    p->median_z[i] = z;
}

static void join_others(const surface_joining *j, size_t i, float T, float w) {
  conic_gaussian_planes *p = j->planes;
  const uint32_t *ids = j->surfaces->planes[CONIC_PLANE_ID];
  const float *normal = j->surfaces->planes[CONIC_PLANE_NORMAL];
  for (size_t c = 0; p->normal && c < 3; c++)
    p->normal[3 * i + c] += w * normal[3 * i + c];
  if (p->count)
    p->count[i]++;
  if (p->last)
    p->last[i] = j->first_id + ids[i];
  if (p->id && w > 1.0f - T)
    p->id[i] = j->first_id + ids[i];
}

/* Planes of surfaces alone: Gaussians have no albedo and no weight, and no light is hidden from them. */
static void join_own(const surface_joining *j, size_t i, float T) {
  static const struct {
    conic_plane plane;
    float of_gaussians;
  } all[] = {
      {CONIC_PLANE_ALBEDO, 0.0f}, {CONIC_PLANE_WEIGHT, 0.0f}, {CONIC_PLANE_AO, 1.0f}, {CONIC_PLANE_SHADOW, 1.0f}};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    float *plane = j->surfaces->planes[all[k].plane];
    const size_t n = (size_t)conic_plane_describe(all[k].plane)->n_channels;
    for (size_t at = n * i; plane && at < n * (i + 1); at++)
      plane[at] = (1.0f - T) * all[k].of_gaussians + T * plane[at];
  }
}

static void join_row(void *data, size_t row) {
  const surface_joining *j = data;
  const size_t width = (size_t)j->planes->width;
  const float *rgba = j->surfaces->planes[CONIC_PLANE_RGBA];
  for (size_t i = row * width; i < (row + 1) * width; i++) {
    const float T = j->planes->transparency[i], w = T * rgba[4 * i + 3];
    join_colors(j, i, T, &rgba[4 * i]);
    join_own(j, i, T);
    if (!(w > 0.0f))
      continue;
    join_depths(j, i, T, w);
    join_others(j, i, T, w);
  }
}

void conic_surfaces_join(conic_context *context, conic_image *surfaces, const float background[3], int is_linear,
                         uint32_t first_id, conic_gaussian_planes *planes) {
  surface_joining j = {surfaces, background, is_linear, first_id, planes};
  conic_parallel_for(context, (size_t)planes->height, join_row, &j);
}
