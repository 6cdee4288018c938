/* Suns: discs of light, with a direction. */

#include "accumulation/disc_point.h"
#include "accumulation/sequence.h"
#include "conic/lighting.h"
#include "core/base/message.h"
#include "core/base/trigonometry.h"
#include "lighting/light_axes.h"

/* Turns the direction to a point of a cap of the sphere about it; equal areas of the disc become equal areas of the
 * cap. */
static void turn_in_disc(double direction[3], double radius_rad, const double disc[2]) {
  double square = disc[0] * disc[0] + disc[1] * disc[1], axes[3][3];
  double fallen = square * (1.0 - conic_cos(radius_rad)), sideways = square > 0.0 ? sqrt(fallen * (2.0 - fallen)) : 0.0;
  double scale = square > 0.0 ? sideways / sqrt(square) : 0.0;
  conic_light_axes(direction, axes);
  for (int i = 0; i < 3; i++)
    direction[i] = (1.0 - fallen) * direction[i] + scale * (disc[0] * axes[0][i] + disc[1] * axes[1][i]);
}

conic_status conic_lighting_sample(conic_context *context, const conic_lighting *lighting,
                                   const float radius_deg[CONIC_MAX_LIGHTS], uint64_t i_sample,
                                   conic_lighting *sample) {
  double disc[2];
  if (!lighting || !radius_deg || !sample || lighting->n_lights < 0 || lighting->n_lights > CONIC_MAX_LIGHTS)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "light: no lights to place, or more than 8");
  conic_disc_point(conic_sequence_at(i_sample, CONIC_SEQUENCE_DIRECTION),
                   conic_sequence_at(i_sample, CONIC_SEQUENCE_DIRECTION + 1), disc);
  *sample = *lighting;
  for (int i = 0; i < sample->n_lights; i++) {
    conic_light *light = &sample->lights[i];
    if (!(radius_deg[i] >= 0.0f && radius_deg[i] <= 90.0f))
      return conic_fail(context, CONIC_ERROR_ARGUMENT, "light: a disc's radius is 0 to 90 degrees");
    if (light->frame == CONIC_LIGHT_HEAD || radius_deg[i] == 0.0f)
      continue;
    if (!conic_normalize(light->direction))
      return conic_fail(context, CONIC_ERROR_ARGUMENT, "the light has no direction");
    turn_in_disc(light->direction, CONIC_PI / 180.0 * (double)radius_deg[i], disc);
  }
  return CONIC_OK;
}
