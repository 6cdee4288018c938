/* Eye-dome lighting: what stands out towards the eye around a pixel takes its light, as the plane Z tells. */

#include "conic/lighting.h"
#include "core/image/image_common.h"
#include "core/splats/kernel.h"

/* How far from a pixel its neighbours are. */
static const int rings[] = {1, 2, 4, 8};
enum { N_RINGS = sizeof rings / sizeof *rings, N_WAYS = 8 };
static const int ways[N_WAYS][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

typedef struct dome_work {
  const conic_camera *camera;
  conic_image *image;
  float natural_stops; /* the strength as a power of e */
} dome_work;

/* The sine of the angle by which a neighbour stands out of the plane across the view, below 0 where it lies behind;
 * 0 where there is none. */
static float find_rise(const dome_work *d, long x, long y, float z, float wide) {
  const float *depths = d->image->planes[CONIC_PLANE_Z];
  if (x < 0 || y < 0 || x >= d->image->width || y >= d->image->height)
    return 0.0f;
  float other = depths[y * (long)d->image->width + x];
  float rise = other > 0.0f ? z - other : 0.0f;
  return rise / sqrtf(rise * rise + wide * wide);
}

/* Of all neighbours the mean of what each takes. A slope that goes on behind the pixel takes half. */
static float find_darkness(const dome_work *d, long x, long y, float z, float pixel) {
  float sum = 0.0f;
  for (int ring = 0; ring < N_RINGS; ring++)
    for (int i = 0; i < N_WAYS / 2; i++) {
      const int dx = ways[i][0] * rings[ring], dy = ways[i][1] * rings[ring];
      float wide = (float)rings[ring] * pixel * (i % 2 ? 1.41421356f : 1.0f);
      float a = find_rise(d, x + dx, y + dy, z, wide), b = find_rise(d, x - dx, y - dy, z, wide);
      float taken_a = a + 0.5f * (b < 0.0f ? b : 0.0f), taken_b = b + 0.5f * (a < 0.0f ? a : 0.0f);
      sum += (taken_a > 0.0f ? taken_a : 0.0f) + (taken_b > 0.0f ? taken_b : 0.0f);
    }
  return sum / (float)(N_RINGS * N_WAYS);
}

static void shade_dome_row(void *data, size_t y) {
  const dome_work *d = data;
  const size_t width = (size_t)d->image->width;
  const float *z = (const float *)d->image->planes[CONIC_PLANE_Z] + y * width;
  float *rgba = (float *)d->image->planes[CONIC_PLANE_RGBA] + 4 * y * width;
  const double focal = 0.5 * (d->camera->fx + d->camera->fy);
  const int is_parallel = d->camera->kind == CONIC_CAMERA_ORTHOGRAPHIC;
  for (size_t x = 0; x < width; x++) {
    if (!(z[x] > 0.0f))
      continue;
    float pixel = (float)(is_parallel ? 1.0 / focal : (double)z[x] / focal);
    float light = conic_exp_negative(-d->natural_stops * find_darkness(d, (long)x, (long)y, z[x], pixel));
    for (int c = 0; c < 3; c++)
      rgba[4 * x + (size_t)c] *= light;
  }
}

conic_status conic_image_eye_dome(conic_context *context, const conic_camera *camera, double stops,
                                  conic_image *image) {
  dome_work work = {camera, image, (float)(stops * 0.69314718055994530942)};
  if (!camera || !image || !(stops >= 0.0 && stops <= 16.0) || image->width != camera->width ||
      image->height != camera->height || !image->planes[CONIC_PLANE_Z] || !image->planes[CONIC_PLANE_RGBA])
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "eye-dome lighting wants 0 to 16 stops, and the planes rgba and Z of the camera's size");
  conic_parallel_for(context, (size_t)image->height, shade_dome_row, &work);
  return CONIC_OK;
}
