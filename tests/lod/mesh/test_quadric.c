/* A quadric at a place is the sum of the weighted squared distances from its planes. */
#include "lod/mesh/quadric.h"

#include "tests/support/check.h"
#include "tests/support/random_numbers.h"

enum { N_PLANES = 7 };

int main(void) {
  uint64_t state = 21;
  for (int run = 0; run < 100; run++) {
    conic_quadric first, second;
    double normals[N_PLANES][3], offsets[N_PLANES], weights[N_PLANES], place[3], expected = 0.0;
    memset(&first, 0, sizeof first);
    memset(&second, 0, sizeof second);
    for (int i = 0; i < N_PLANES; i++) {
      for (int axis = 0; axis < 3; axis++)
        normals[i][axis] = random_unit(&state) - 0.5;
      offsets[i] = random_unit(&state) - 0.5;
      weights[i] = random_unit(&state);
      conic_quadric_add_plane(i < 3 ? &first : &second, normals[i], offsets[i], weights[i]);
    }
    conic_quadric_add(&first, &second);
    for (int axis = 0; axis < 3; axis++)
      place[axis] = 4.0 * random_unit(&state) - 2.0;
    for (int i = 0; i < N_PLANES; i++) {
      double distance = normals[i][0] * place[0] + normals[i][1] * place[1] + normals[i][2] * place[2] + offsets[i];
      expected += weights[i] * distance * distance;
    }
    CHECK_NEAR(conic_quadric_at(&first, place), expected, 1e-12);
  }
  return check_result();
}
