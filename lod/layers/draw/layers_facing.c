/* Which way the samples of a layered point cloud face, in 1024 sets. A set whose samples in a place all face away is
 * left out at once. */
#include "lod/layers/draw/layers_view.h"

#include <math.h>
#include <string.h>

#include "lod/layers/format/layers_code.h"

enum { CODES = 256, CODES_A_SET = CODES / CONIC_LAYERS_FACING_SIDE };

/* All of this is computed in floats and kept apart by more than they round. */
static const float facing_slack = 1e-3f;

/* The codes of a set are a square. */
static void find_cone(conic_layers_facings *facings, int i_set) {
  int x = i_set / CONIC_LAYERS_FACING_SIDE * CODES_A_SET, y = i_set % CONIC_LAYERS_FACING_SIDE * CODES_A_SET;
  float sum[3] = {0.0f, 0.0f, 0.0f}, least = 1.0f;
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < CODES_A_SET * CODES_A_SET; i++) {
      const uint8_t code[2] = {(uint8_t)(x + i / CODES_A_SET), (uint8_t)(y + i % CODES_A_SET)};
      float normal[3];
      conic_layers_normal_of(code, normal);
      float cosine = normal[0] * sum[0] + normal[1] * sum[1] + normal[2] * sum[2];
      least = pass && cosine < least ? cosine : least;
      for (int axis = 0; axis < 3 && !pass; axis++)
        sum[axis] += normal[axis];
    }
    float length = sqrtf(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    for (int axis = 0; axis < 3 && !pass; axis++)
      facings->axis[axis][i_set] = sum[axis] /= length;
  }
  facings->cosine[i_set] = least;
  facings->sine[i_set] = sqrtf(1.0f - least * least);
}

void conic_layers_facings_init(conic_layers_facings *facings) {
  for (int i = 0; i < CONIC_LAYERS_FACINGS; i++)
    find_cone(facings, i);
}

void conic_layers_find_turned(const conic_layers_facings *facings, const conic_layers_view *view,
                              const conic_layers_entry *entry, conic_layers_turned *turned) {
  float to[3], distance = 0.0f;
  memset(turned, 0, sizeof *turned);
  for (int axis = 0; axis < 3; axis++) {
    to[axis] = (float)((double)entry->center[axis] - view->from.eye[axis]);
    distance += to[axis] * to[axis];
  }
  distance = sqrtf(distance);
  float sine = entry->sphere / distance + facing_slack; /* of the angle under which the sphere's radius is seen */
  if (!(sine < 1.0f))
    return;
  float cosine = sqrtf(1.0f - sine * sine);
  for (int i = 0; i < CONIC_LAYERS_FACINGS; i++) {
    float along = (facings->axis[0][i] * to[0] + facings->axis[1][i] * to[1] + facings->axis[2][i] * to[2]) / distance;
    int is_away = facings->cosine[i] * cosine > facings->sine[i] * sine + facing_slack &&
                  along > facings->sine[i] * cosine + facings->cosine[i] * sine + facing_slack;
    turned->bits[i / 32] |= (uint32_t)is_away << i % 32;
    turned->is_any |= is_away;
  }
}
