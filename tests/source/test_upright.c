/* Which way up a source stands: by what of its shape, and not by what tells nothing. */
#include "tests/support/check.h"

enum { SIDE = 12 };

/* A height over each place of the square [-1, 1]², or a place of a solid. */
typedef void surface_at(double s, double t, double place[3]);

/* A grid of (SIDE + 1)² vertices, whose triangles face along ds × dt. */
static void add_grid(conic_triangles *t, surface_at *at) {
  for (int i = 0; i <= SIDE; i++)
    for (int j = 0; j <= SIDE; j++) {
      double place[3];
      at(2.0 * j / SIDE - 1.0, 2.0 * i / SIDE - 1.0, place);
      for (int axis = 0; axis < 3; axis++)
        t->position[axis][t->n_vertices] = (float)place[axis];
      t->n_vertices++;
    }
  uint32_t first = (uint32_t)t->n_vertices - (SIDE + 1) * (SIDE + 1);
  for (uint32_t i = 0; i < SIDE; i++)
    for (uint32_t j = 0; j < SIDE; j++) {
      uint32_t a = first + i * (SIDE + 1) + j, b = a + 1, c = a + SIDE + 1, d = c + 1;
      const uint32_t corners[2][3] = {{a, b, d}, {a, d, c}};
      memcpy(t->corners[t->count], corners, sizeof corners);
      t->count += 2;
    }
}

static void at_ground(double s, double t, double place[3]) {
  place[0] = 4.0 * s;
  place[1] = 5.0 * t;
  place[2] = 0.3 * s * t;
}

static void at_wall(double s, double t, double place[3]) {
  place[0] = s;
  place[1] = 0.0;
  place[2] = t;
}

static void at_card(double s, double t, double place[3]) {
  place[0] = s;
  place[1] = t;
  place[2] = 0.0;
}

/* A dome as high as it is wide, open below. */
static void at_dome(double s, double t, double place[3]) {
  double r = s * s + t * t;
  place[0] = s;
  place[1] = t;
  place[2] = 1.8 * (1.0 - 0.5 * r);
}

/* A closed pear that stands on its flat end: rings from s = -1, the middle of its base, to the tip. */
static void at_pear(double s, double t, double place[3]) {
  double turn = 3.14159265358979 * t, along = 0.5 * (s + 1.0);
  double radius = along < 0.25 ? 3.2 * along : 0.8 * cos(1.5707963 * (along - 0.25) / 0.75);
  place[0] = radius * cos(turn);
  place[1] = -radius * sin(turn);
  place[2] = along < 0.25 ? 0.0 : 4.0 * (along - 0.25);
}

/* It leans, so that neither way of mirroring leaves it as it is. */
static void at_leaning_pear(double s, double t, double place[3]) {
  at_pear(s, t, place);
  place[0] += 0.15 * place[2] * place[2];
  place[1] += 0.15 * place[2] * place[2];
}

/* A plate, rounded on top. */
static void at_plate(double s, double t, double place[3]) {
  at_pear(s, t, place);
  place[0] *= 1.7;
  place[1] *= 0.1;
}

/* Long, without a base. */
static void at_rocket(double s, double t, double place[3]) {
  at_pear(s, t, place);
  place[2] += s < -0.5 ? 0.5 * (1.0 + s) : 0.25;
  place[2] *= 1.5;
}

/* Open behind, as a face is: its left and right are alike. */
static void at_face(double s, double t, double place[3]) {
  at_dome(s, t, place);
  place[1] += 0.6 * place[2] * (1.0 - t);
}

static void at_ball(double s, double t, double place[3]) {
  double turn = 3.14159265358979 * t, tilt = 1.57079632679 * s;
  place[0] = cos(tilt) * cos(turn);
  place[1] = -cos(tilt) * sin(turn);
  place[2] = sin(tilt);
}

/* A body with its head, arms and legs, part by part: as wide as it is tall, and as flat as what lies. */
static int i_part;

static void at_figure(double s, double t, double place[3]) {
  static const double middles[5][3] = {{0, 0, 0.2}, {-0.8, 0, 0.5}, {0.8, 0, 0.5}, {-0.3, 0, -0.9}, {0.3, 0, -0.9}};
  static const double sizes[5][3] = {
      {0.4, 0.3, 1}, {0.6, 0.15, 0.15}, {0.6, 0.15, 0.15}, {0.2, 0.2, 0.6}, {0.2, 0.2, 0.6}};
  at_ball(s, t, place);
  for (int axis = 0; axis < 3; axis++)
    place[axis] = middles[i_part % 5][axis] + sizes[i_part % 5][axis] * place[axis];
}

/* `is_y_up`: the same shape with what was z in y. */
static conic_up_basis stand(surface_at *at, int is_y_up) {
  conic_context *context = check_context(2);
  conic_triangles triangles;
  conic_splats splats;
  conic_source *source;
  memset(&splats, 0, sizeof splats);
  const size_t n_parts = at == at_figure ? 5 : 1;
  CHECK_OK(
      conic_triangles_allocate(context, n_parts * 2 * SIDE * SIDE, n_parts * (SIDE + 1) * (SIDE + 1), 0, &triangles));
  triangles.count = triangles.n_vertices = 0;
  for (size_t i = 0; i < n_parts; i++, i_part++)
    add_grid(&triangles, at);
  for (size_t i = 0; is_y_up && i < triangles.n_vertices; i++) {
    float z = triangles.position[2][i];
    triangles.position[2][i] = -triangles.position[1][i];
    triangles.position[1][i] = z;
  }
  CHECK_OK(conic_source_of_drawing(context, &splats, &triangles, &source));
  CHECK_OK(conic_source_stand(source));
  const conic_source_scale *scale = conic_source_measure(source);
  conic_up_basis basis = scale->up_basis;
  CHECK(scale->up[0] == 0.0 && scale->up[basis == CONIC_UP_HABIT ? 1 : 2] == 1.0);
  conic_source_close(source);
  conic_context_destroy(context);
  return basis;
}

int main(void) {
  CHECK(stand(at_ground, 0) == CONIC_UP_FLAT);
  CHECK(stand(at_ground, 1) == CONIC_UP_HABIT);
  CHECK(stand(at_wall, 0) == CONIC_UP_FACING);
  CHECK(stand(at_card, 0) == CONIC_UP_HABIT);
  CHECK(stand(at_dome, 0) == CONIC_UP_OPEN);
  CHECK(stand(at_dome, 1) == CONIC_UP_HABIT);
  CHECK(stand(at_pear, 0) == CONIC_UP_EVEN);
  CHECK(stand(at_pear, 1) == CONIC_UP_HABIT);
  CHECK(stand(at_leaning_pear, 0) == CONIC_UP_BASE);
  CHECK(stand(at_leaning_pear, 1) == CONIC_UP_HABIT);
  CHECK(stand(at_figure, 0) == CONIC_UP_EVEN);
  CHECK(stand(at_figure, 1) == CONIC_UP_HABIT);
  CHECK(stand(at_plate, 1) == CONIC_UP_FLAT);
  CHECK(stand(at_rocket, 0) == CONIC_UP_HABIT);
  CHECK(stand(at_face, 0) == CONIC_UP_HABIT);
  CHECK(stand(at_ball, 0) == CONIC_UP_HABIT);
  return check_result();
}
