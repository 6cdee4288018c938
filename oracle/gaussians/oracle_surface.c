#include "oracle/gaussians/oracle_surface.h"

#include "oracle/gaussians/oracle_bounded.h"

/* The transfer curve of sRGB. */
static double encode(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * conic_oracle_exp(conic_oracle_log(linear) / 2.4) - 0.055;
}

int conic_oracle_surfaces_fit(const conic_gaussian_surfaces *surfaces, int width, int height, unsigned planes) {
  const unsigned rgba = 1u << CONIC_PLANE_RGBA, z = 1u << CONIC_PLANE_Z, normal = 1u << CONIC_PLANE_NORMAL,
                 id = 1u << CONIC_PLANE_ID, last = 1u << CONIC_PLANE_LAST;
  const unsigned wanted = rgba | z | (planes & normal) | (planes & (id | last) ? id : 0);
  return surfaces->image->width == width && surfaces->image->height == height &&
         !(wanted & ~conic_image_planes(surfaces->image));
}

int conic_oracle_surface_at(const conic_gaussian_surfaces *surfaces, int x, int y, oracle_surface *surface) {
  const conic_image *image = surfaces->image;
  const size_t at = (size_t)y * (size_t)image->width + (size_t)x;
  const float *rgba = (const float *)image->planes[CONIC_PLANE_RGBA] + 4 * at;
  const float *normal = image->planes[CONIC_PLANE_NORMAL];
  const uint32_t *id = image->planes[CONIC_PLANE_ID];
  if (!(rgba[3] > 0.0f))
    return 0;
  for (size_t c = 0; c < 3; c++) {
    const double linear = (double)rgba[c];
    surface->color[c] = surfaces->is_linear ? linear : encode(linear);
    surface->color_off[c] = surfaces->is_linear ? 0.0 : 4.0 * ORACLE_FLOAT_UNIT * fabs(surface->color[c]);
    surface->normal[c] = normal ? (double)normal[3 * at + c] : 0.0;
  }
  surface->z = (double)((const float *)image->planes[CONIC_PLANE_Z])[at];
  surface->id = id ? surfaces->first_id + id[at] : CONIC_NO_ID;
  return 1;
}
