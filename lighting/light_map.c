#include "lighting/light_map.h"

#include <string.h>

#include "lighting/light_axes.h"

/* The light's distance in units of the receivers' reach from their middle. Its rays then meet at 0.2°, less than the
 * sun's own disc, and floats still tell depths apart by a fiftieth of a texel. */
static const double far_away = 256.0;

/* What is farther towards the light, in the same units, casts no shadow: floats would tell no depths apart. */
static const double farthest = 1e6;

/* How far a box reaches along a direction from its middle. */
static double reach_along(const double half[3], const double direction[3]) {
  return (half[0] * fabs(direction[0]) + half[1] * fabs(direction[1])) + half[2] * fabs(direction[2]);
}

/* How far the casters' box reaches towards the light from the receivers' middle. */
static double casters_reach(const conic_casters *casters, const double origin[3], const double direction[3]) {
  double middle[3], half[3];
  for (int i = 0; i < 3; i++) {
    middle[i] = 0.5 * casters->minimum[i] + 0.5 * casters->maximum[i] - origin[i];
    half[i] = 0.5 * (casters->maximum[i] - casters->minimum[i]);
  }
  return conic_dot(middle, direction) + reach_along(half, direction);
}

static int map_edge(double texels, int most) {
  return texels < (double)most ? (int)ceil(texels) : most;
}

void conic_light_map_place(const conic_casters *casters, const conic_receivers *receivers, const double direction[3],
                           double texel, int most, conic_camera *camera, double *near_z, conic_light_map *map) {
  double rows[3][3], half = conic_length(receivers->half);
  conic_light_axes(direction, rows);
  double reach = casters_reach(casters, receivers->origin, direction);
  reach = reach > half ? reach : half;
  half = half > 0.0 ? half : texel;
  reach = reach < farthest * half ? reach : farthest * half;
  double distance = far_away * half > 2.0 * reach ? far_away * half : 2.0 * reach;
  double nearer = distance / (distance - half); /* what is nearer to the light is larger in its map */
  double x = reach_along(receivers->half, rows[0]) * nearer, y = reach_along(receivers->half, rows[1]) * nearer;
  double most_texels = (double)(most - 4), widest = 2.0 * (x > y ? x : y);
  texel = widest > texel * most_texels ? widest / most_texels : texel;
  memset(camera, 0, sizeof *camera);
  memset(map, 0, sizeof *map);
  camera->width = map->width = map_edge(2.0 * x / texel + 4.0, most);
  camera->height = map->height = map_edge(2.0 * y / texel + 4.0, most);
  camera->fx = camera->fy = distance / texel;
  camera->cx = 0.5 * (double)camera->width;
  camera->cy = 0.5 * (double)camera->height;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      camera->cam_from_world[i][j] = rows[i][j];
      map->rotation[i][j] = (float)rows[i][j];
    }
    camera->cam_from_world[i][3] = (i == 2 ? distance : 0.0) - conic_dot(rows[i], receivers->origin);
  }
  /* Receivers measure z from the same place as the camera, to the bit. */
  map->distance = (float)distance;
  camera->cam_from_world[2][3] += (double)map->distance - distance;
  *near_z = 0.5 * (distance - reach);
  map->focal = (float)camera->fx;
  map->angle = (float)(1.0 / camera->fx);
  map->center_x = (float)camera->cx;
  map->center_y = (float)camera->cy;
}
