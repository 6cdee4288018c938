/* Lamps: what they light, by formulas, and what hides them, by rays. */
#include "core/lanes/instruction_sets.h"
#include "tests/support/lamp_fixture.h"

/* --- brightness --- */

/* 0.75·c·cos/d², where nothing is hidden, with and without shadows. */
static void plane_is_lit_by_the_formula(conic_context *context) {
  enum { SIZE = 96 };
  conic_triangles mesh = lamp_floor(context, light_flat);
  const conic_drawing drawing = {NULL, &mesh};
  lamp_scene s;
  lamp_scene_open(context, &drawing, 0.0, &s);
  s.drawer.options.exposure = 1.0;
  for (int i = 0; i < 6; i++) {
    const double heights[] = {0.05, 0.2, 0.7, 1.5, 4.0, 200.0};
    float color[3] = {2.0f, 1.0f, 0.0f};
    memcpy(s.lamp.color, color, sizeof color);
    s.lamp.position[0] = 0.3;
    s.lamp.position[1] = heights[i];
    s.lamp.position[2] = -0.4;
    s.options.has_shadows = i % 2;
    s.picture = light_take_picture(&s.drawer, SIZE, 30.0, 40.0, LAMP_PLANES);
    lamp_scene_light(&s);
    long n = 0;
    for (int k = 0; k < SIZE * SIZE; k++) {
      double place[3], normal[3], towards[3];
      if (!light_place(&s.picture, k % SIZE, k / SIZE, place, normal) ||
          lamp_plane(&s, CONIC_PLANE_RGBA)[4 * k + 3] < 1)
        continue;
      double d = lamp_towards(&s, place, towards), expected = 2.0 * 0.75 * lamp_product(normal, towards) / (d * d);
      for (int c = 0; c < 3; c++)
        CHECK_NEAR((double)lamp_plane(&s, CONIC_PLANE_RGBA)[4 * k + c], (double)color[c] * expected,
                   2e-5 * expected + 1e-7);
      CHECK(lamp_plane(&s, CONIC_PLANE_SHADOW)[k] == 1.0f);
      n++;
    }
    CHECK(n > 2000);
    lamp_scene_drop(&s);
  }
  lamp_scene_close(&s);
  conic_triangles_release(context, &mesh);
}

/* A lamp as far away as that is a light with a direction, with highlight and shadow. */
static void far_lamp_is_a_light(conic_context *context) {
  enum { SIZE = 96 };
  static const double far_away = 1000.0, direction[3] = {0.6, 0.64, 0.48};
  conic_triangles mesh = light_cube_on_plane(context);
  const conic_drawing drawing = {NULL, &mesh};
  lamp_scene s;
  lamp_scene_open(context, &drawing, 0.0, &s);
  conic_lighting *lighting = &s.drawer.options.lighting;
  s.drawer.options.shading = CONIC_SHADE_PHONG;
  for (int axis = 0; axis < 3; axis++) {
    s.lamp.position[axis] = far_away * direction[axis];
    s.lamp.color[axis] = (float)(far_away * far_away);
  }
  s.picture = light_take_picture(&s.drawer, SIZE, 30.0, 25.0, LAMP_PLANES);
  lamp_scene_light(&s);
  lamp_scene sun = s;
  *lighting = (conic_lighting){.is_given = 1, .n_lights = 1};
  lighting->lights[0] = (conic_light){CONIC_LIGHT_WORLD, {1.0f, 1.0f, 1.0f}, {0.6, 0.64, 0.48}};
  sun.drawer.options = s.drawer.options;
  sun.casters.cookie = &sun.drawer;
  sun.options.n_lamps = 0;
  sun.picture = light_take_picture(&sun.drawer, SIZE, 30.0, 25.0, LAMP_PLANES);
  lamp_scene_light(&sun);
  long n_off = 0, n_lit = 0;
  for (int k = 0; k < SIZE * SIZE; k++) {
    double lamp = (double)lamp_plane(&s, CONIC_PLANE_RGBA)[4 * k],
           light = (double)lamp_plane(&sun, CONIC_PLANE_RGBA)[4 * k];
    n_off += fabs(lamp - light) > 0.01;
    n_lit += light > 0.1;
  }

  CHECK(n_lit > 1500 && n_off < n_lit / 40);
  lamp_scene_drop(&sun);
  lamp_scene_drop(&s);
  lamp_scene_close(&s);
  conic_triangles_release(context, &mesh);
}

/* The mean over samples of what a lamp with a size sheds on the floor right below it. */
static double mean_below(conic_context *context, const conic_lamp *lamp, int n, double *mean_shadow) {
  enum { SIZE = 33 };
  conic_triangles mesh = lamp_floor(context, light_flat);
  const conic_drawing drawing = {NULL, &mesh};
  lamp_scene s;
  double sum = 0.0;
  lamp_scene_open(context, &drawing, 0.0, &s);
  s.lamp = *lamp;
  *mean_shadow = 0.0;
  const conic_lighter lighter = {context, &s.casters, &s.drawer.options, &s.options};
  for (int i = 0; i < n; i++) {
    s.picture = light_take_picture(&s.drawer, SIZE, 0.0, 90.0, LAMP_PLANES);
    CHECK_OK(conic_lighter_shade((void *)&lighter, (uint64_t)i, &s.picture.camera, &s.picture.image));
    sum += (double)lamp_plane(&s, CONIC_PLANE_RGBA)[4 * (SIZE * SIZE / 2)] / n;
    *mean_shadow += (double)lamp_plane(&s, CONIC_PLANE_SHADOW)[SIZE * SIZE / 2] / n;
    lamp_scene_drop(&s);
  }
  lamp_scene_close(&s);
  conic_triangles_release(context, &mesh);
  return sum;
}

/* E = I/(d² + r²) below the middle of a disc, I/d² below a ball; and of a small rectangle I·cos/d². */
static void lamps_with_a_size_are_as_bright_as_formulas(conic_context *context) {
  const conic_lamp disc = {.kind = CONIC_LAMP_DISC,
                           .color = {1.0f, 1.0f, 1.0f},
                           .position = {0.0, 1.5, 0.0},
                           .axes = {{1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}};
  const conic_lamp ball = {.color = {1.0f, 1.0f, 1.0f}, .position = {0.0, 1.5, 0.0}, .radius = 0.75};
  conic_lamp rectangle = disc;
  double shadow;
  rectangle.kind = CONIC_LAMP_RECTANGLE;
  for (int i = 0; i < 2; i++)
    for (int axis = 0; axis < 3; axis++)
      rectangle.axes[i][axis] *= 1e-3;
  CHECK_NEAR(mean_below(context, &disc, 256, &shadow), 0.75 / (1.5 * 1.5 + 1.0), 2e-3);
  CHECK_NEAR(shadow, 1.0, 0.0);
  CHECK_NEAR(mean_below(context, &ball, 256, &shadow), 0.75 / (1.5 * 1.5), 3e-3);
  CHECK_NEAR(shadow, 2.0 * (1.0 - sqrt(0.75)) / 0.25, 0.02);
  CHECK_NEAR(mean_below(context, &rectangle, 4, &shadow), 0.75 / (1.5 * 1.5), 1e-3);
  rectangle.axes[0][0] = -rectangle.axes[0][0]; /* it looks away */
  CHECK_NEAR(mean_below(context, &rectangle, 1, &shadow), 0.0, 0.0);
}

/* --- what is hidden --- */

static int is_lit(const lamp_scene *s, const ray_mesh *rays, int x, int y) {
  double place[3], normal[3], towards[3];
  if (!light_place(&s->picture, x, y, place, normal))
    return -1;
  double away = lamp_towards(s, place, towards);
  for (int axis = 0; axis < 3; axis++)
    place[axis] += 1e-4 * normal[axis];
  double facing = lamp_product(normal, towards);
  return fabs(facing) < 0.02 ? -1 : facing > 0.0 && !ray_is_blocked(rays, place, towards, away - 1e-3);
}

/* Whether all about are lit alike, as far as texels reach, and those that are lit, of one face. */
static int is_inside(const lamp_scene *s, const ray_mesh *rays, int x, int y, int lit) {
  double place[3], normal[3], other[3], towards[3];
  light_place(&s->picture, x, y, place, normal);
  lamp_towards(s, place, towards);
  int reach = 2 + (int)ceil(1.5 / fabs(lamp_product(normal, towards))), size = s->picture.camera.width;
  if (reach > 8 || x < reach || y < reach || x + reach >= size || y + reach >= size)
    return 0;
  for (int j = -reach; j <= reach; j++)
    for (int i = -reach; i <= reach; i++)
      if (is_lit(s, rays, x + i, y + j) != lit ||
          (light_place(&s->picture, x + i, y + j, place, other) && lit && memcmp(other, normal, sizeof other) != 0))
        return 0;
  return 1;
}

/* Neither a leak where the cube stands, nor acne. */
static void cube_hides_the_lamp(conic_context *context) {
  enum { SIZE = 160 };
  conic_triangles mesh = light_cube_on_plane(context);
  const conic_drawing drawing = {NULL, &mesh};
  ray_mesh rays = ray_mesh_of(&mesh);
  lamp_scene s;
  long n_lit = 0, n_dark = 0;
  lamp_scene_open(context, &drawing, 0.0, &s);
  s.picture = light_take_picture(&s.drawer, SIZE, 30.0, 25.0, LIGHT_PLANES);
  for (int i = 0; i < 8; i++) {
    double angle = 77.0 * i * light_pi / 180.0, away = 0.9 + 0.2 * i;
    s.lamp.position[0] = away * cos(angle);
    s.lamp.position[1] = 0.3 + 0.25 * i;
    s.lamp.position[2] = away * sin(angle);
    lamp_scene_light(&s);
    for (int y = 1; y < SIZE - 1; y += 2)
      for (int x = 1; x < SIZE - 1; x++) {
        int lit = is_lit(&s, &rays, x, y);
        if (lit < 0 || !is_inside(&s, &rays, x, y, lit))
          continue;
        n_lit += lit;
        n_dark += !lit;
        CHECK_NEAR((double)lamp_plane(&s, CONIC_PLANE_SHADOW)[y * SIZE + x], (double)lit, 0.0);
      }
  }

  CHECK(n_lit > 3500 && n_dark > 400);
  lamp_scene_drop(&s);
  lamp_scene_close(&s);
  ray_mesh_free(&rays);
  conic_triangles_release(context, &mesh);
}

static double lower_floor(double x, double z) {
  (void)x;
  (void)z;
  return -1.5;
}

/* How far the straight line between two points passes by the origin. */
static double passes_by(const double from[3], const double to[3]) {
  double d[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]}, square = lamp_product(d, d);
  double along = -lamp_product(from, d) / square, at[3];
  along = along < 0.0 ? 0.0 : along > 1.0 ? 1.0 : along;
  for (int axis = 0; axis < 3; axis++)
    at[axis] = from[axis] + along * d[axis];
  return sqrt(lamp_product(at, at));
}

/* The shadow of a ball of radius 1 on the floor has the outline of the cone about it. */
static void ball_casts_a_cone(conic_context *context) {
  enum { SIZE = 200 };
  conic_triangles mesh = light_mesh(context, 2 * 8 * 8 + 2 * 192 * 96);
  const conic_drawing drawing = {NULL, &mesh};
  lamp_scene s;
  long n_lit = 0, n_dark = 0;
  light_field(&mesh, 8, 6.0, lower_floor);
  light_ball(&mesh, 192, 96);
  lamp_scene_open(context, &drawing, 0.0, &s);
  s.picture = light_take_picture(&s.drawer, SIZE, 30.0, 40.0, LIGHT_PLANES);
  const double positions[2][3] = {{0.2, 4.0, 0.3}, {2.0, 2.0, -1.0}};
  for (int i = 0; i < 2; i++) {
    memcpy(s.lamp.position, positions[i], sizeof positions[i]);
    lamp_scene_light(&s);
    for (int k = 0; k < SIZE * SIZE; k++) {
      double place[3], normal[3];
      if (!light_place(&s.picture, k % SIZE, k / SIZE, place, normal) || place[1] > -1.49)
        continue;
      double by = passes_by(s.lamp.position, place);
      if (fabs(by - 1.0) < 0.12)
        continue;
      CHECK_NEAR((double)lamp_plane(&s, CONIC_PLANE_SHADOW)[k], by > 1.0 ? 1.0 : 0.0, 0.0);
      n_lit += by > 1.0;
      n_dark += by < 1.0;
    }
  }
  CHECK(n_lit > 8000 && n_dark > 800);
  lamp_scene_drop(&s);
  lamp_scene_close(&s);
  conic_triangles_release(context, &mesh);
}

/* What faces the lamp by more than `least` is lit wholly, from wherever it shines on a ball. */
static void expect_no_acne(conic_context *context, const conic_drawing *drawing, double epsilon, double least) {
  enum { SIZE = 160 };
  lamp_scene s;
  lamp_scene_open(context, drawing, epsilon, &s);
  s.picture = light_take_picture(&s.drawer, SIZE, 30.0, 25.0, LIGHT_PLANES);
  for (int i = 0; i < 12; i++) {
    double height = (-85.0 + 14.6 * i) * light_pi / 180.0, angle = 101.0 * i * light_pi / 180.0, away = 1.3 + 0.4 * i;
    s.lamp.position[0] = away * cos(height) * cos(angle);
    s.lamp.position[1] = away * sin(height);
    s.lamp.position[2] = away * cos(height) * sin(angle);
    lamp_scene_light(&s);
    float darkest = 1.0f;
    for (int k = 0; k < SIZE * SIZE; k++) {
      double place[3], normal[3], towards[3];
      if (!light_is_covered_about(&s.picture, k % SIZE, k / SIZE) ||
          !light_place(&s.picture, k % SIZE, k / SIZE, place, normal))
        continue;
      lamp_towards(&s, place, towards);
      if (lamp_product(normal, place) > 0.9 && lamp_product(normal, towards) > least)
        darkest = lamp_plane(&s, CONIC_PLANE_SHADOW)[k] < darkest ? lamp_plane(&s, CONIC_PLANE_SHADOW)[k] : darkest;
    }
    CHECK(darkest == 1.0f);
  }
  lamp_scene_drop(&s);
  lamp_scene_close(&s);
}

static void ball_has_no_acne(conic_context *context) {
  conic_triangles mesh = light_mesh(context, 2 * 192 * 96);
  conic_drawing drawing = {NULL, &mesh};
  light_ball(&mesh, 192, 96);
  expect_no_acne(context, &drawing, 0.0, 0.02);
  conic_triangles_release(context, &mesh);
  conic_splats splats = light_splats_on_ball(context, 20000);
  double length;
  CHECK_OK(conic_splats_length(context, &splats, &length));
  drawing = (conic_drawing){&splats, NULL};
  expect_no_acne(context, &drawing, 1.5 * length, 0.1);
  for (size_t i = 0; i < splats.count; i += 10) /* large discs stick out of the ball */
    for (int axis = 0; axis < 3; axis++) {
      splats.tangent_u[axis][i] *= 5.0f;
      splats.tangent_v[axis][i] *= 5.0f;
    }
  expect_no_acne(context, &drawing, 1.5 * length, 0.1);
  conic_splats_release(context, &splats);
}

/* --- six sides --- */

/* Discs on the six sides of a box of half edge 1, which overlap. */
static conic_splats splats_on_box(conic_context *context, int n) {
  conic_splats splats;
  if (conic_splats_allocate(context, (size_t)(6 * n * n), CONIC_SPLATS_TANGENTS, &splats) != CONIC_OK)
    exit(1);
  for (int i = 0; i < 6 * n * n; i++) {
    int side = i / (n * n), axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3, place = i % (n * n);
    splats.position[axis][i] = side % 2 ? 1.0f : -1.0f;
    splats.position[u][i] = (float)(2.0 * (place % n + 0.5) / n - 1.0);
    splats.position[v][i] = (float)(2.0 * (place / n + 0.5) / n - 1.0);
    for (int k = 0; k < 3; k++) {
      splats.tangent_u[k][i] = k == u ? 1.2f / (float)n : 0.0f;
      splats.tangent_v[k][i] = k == v ? 1.2f / (float)n : 0.0f;
    }
  }
  return splats;
}

/* From the middle of the box along an axis, 90 degrees wide. */
static light_picture look_inside(light_drawer *drawer, int side, int size) {
  light_picture picture = {.camera = {.width = size, .height = size, .fx = 0.5 * size, .fy = 0.5 * size}};
  conic_camera *c = &picture.camera;
  int axis = side / 2;
  c->cx = c->cy = 0.5 * size;
  c->cam_from_world[2][axis] = side % 2 ? 1.0 : -1.0;
  c->cam_from_world[0][(axis + 1) % 3] = 1.0;
  c->cam_from_world[1][(axis + 2) % 3] = side % 2 ? 1.0 : -1.0;
  CHECK_OK(conic_image_allocate(drawer->context, size, size, LIGHT_PLANES, &picture.image));
  CHECK_OK(conic_render_drawing(drawer->context, drawer->renderer, drawer->drawing, c, &drawer->options, 1,
                                &picture.image, NULL));
  return picture;
}

/* A lamp inside lights all of it, wherever the maps' sides meet; one outside, nothing. */
static void box_keeps_its_light(conic_context *context, const conic_drawing *drawing, double epsilon, double margin) {
  enum { SIZE = 96 };
  const double positions[4][3] = {{0.0, 0.0, 0.0}, {0.31, -0.42, 0.17}, {1.9, 0.4, -0.3}, {-1.5, 2.0, 1.2}};
  lamp_scene s;
  lamp_scene_open(context, drawing, epsilon, &s);
  for (int side = 0; side < 6; side++) {
    s.picture = look_inside(&s.drawer, side, SIZE);
    for (int i = 0; i < 4; i++) {
      memcpy(s.lamp.position, positions[i], sizeof positions[i]);
      lamp_scene_light(&s);
      long n = 0, n_wrong = 0;
      for (int k = 0; k < SIZE * SIZE; k++) {
        double place[3], normal[3];
        int at_edge = 0;
        CHECK(light_place(&s.picture, k % SIZE, k / SIZE, place, normal));
        for (int axis = 0; axis < 3; axis++)
          at_edge += fabs(place[axis]) > 1.0 - margin;
        n += at_edge < 2;
        n_wrong += at_edge < 2 && lamp_plane(&s, CONIC_PLANE_SHADOW)[k] != (i < 2 ? 1.0f : 0.0f);
      }
      CHECK(n > 7000 && n_wrong == 0);
    }
    lamp_scene_drop(&s);
  }
  lamp_scene_close(&s);
}

static void boxes_have_no_seams(conic_context *context) {
  conic_triangles mesh = light_mesh(context, 12);
  conic_drawing drawing = {NULL, &mesh};
  light_box(&mesh, (const double[3]){-1.0, -1.0, -1.0}, (const double[3]){1.0, 1.0, 1.0});
  box_keeps_its_light(context, &drawing, 0.0, 0.06);
  conic_triangles_release(context, &mesh);
  conic_splats splats = splats_on_box(context, 40);
  double length;
  CHECK_OK(conic_splats_length(context, &splats, &length));
  drawing = (conic_drawing){&splats, NULL};
  box_keeps_its_light(context, &drawing, 1.5 * length, 0.12);
  conic_splats_release(context, &splats);
}

/* Only sides that pixels lie on are drawn. */
static void maps_are_drawn_where_pixels_lie(conic_context *context) {
  conic_triangles mesh = lamp_floor(context, light_flat);
  const conic_drawing drawing = {NULL, &mesh};
  lamp_scene s;
  lamp_scene_open(context, &drawing, 0.0, &s);
  s.picture = light_take_picture(&s.drawer, 64, 30.0, 40.0, LIGHT_PLANES);
  s.lamp.position[1] = 8.0; /* all of the floor is below it */
  lamp_scene_light(&s);
  CHECK(s.drawer.n_maps == 1);
  s.lamp.position[1] = 1.0;
  lamp_scene_light(&s);
  CHECK(s.drawer.n_maps == 6);
  s.options.has_shadows = 0;
  lamp_scene_light(&s);
  CHECK(s.drawer.n_maps == 6);
  lamp_scene_drop(&s);
  lamp_scene_close(&s);
  conic_triangles_release(context, &mesh);
}

/* --- what must not matter, and what is refused --- */

static uint64_t lamp_hash(int threads, conic_isa isa, int tile) {
  conic_context *context = check_context(threads);
  conic_triangles mesh = light_cube_on_plane(context);
  conic_splats splats = light_splats_on_ball(context, 3000);
  const conic_drawing drawing = {&splats, &mesh};
  const conic_lamp lamps[3] = {
      {CONIC_LAMP_SPHERE, {1.0f, 0.5f, 2.0f}, {1.5, 1.2, 0.4}, 0.2, {{0.0}}, {0}},
      {CONIC_LAMP_DISC, {2.0f, 1.5f, 1.0f}, {-1.0, 2.2, 1.4}, 0.0, {{0.3, 0, 0}, {0, 0, 0.3}}, {0}},
      {CONIC_LAMP_RECTANGLE, {1, 1, 1}, {0, 3, 0}, 0.0, {{0.3, 0.1, 0}, {0, 0, 0.8}}, {0}}};
  lamp_scene s;
  lamp_scene_open(context, &drawing, 0.1, &s);
  s.drawer.options.shading = CONIC_SHADE_PHONG;
  s.options.lamps = lamps;
  s.options.n_lamps = 3;
  s.options.is_sample = 1;
  s.options.first_direction = 5;
  s.options.isa = isa;
  s.drawer.options.isa = isa;
  s.drawer.options.tile = tile;
  s.picture = light_take_picture(&s.drawer, 120, 30.0, 25.0, LAMP_PLANES);
  lamp_scene_light(&s);
  uint64_t hash =
      3 * conic_image_hash(&s.picture.image, CONIC_PLANE_RGBA) + conic_image_hash(&s.picture.image, CONIC_PLANE_SHADOW);
  lamp_scene_drop(&s);
  lamp_scene_close(&s);
  conic_splats_release(context, &splats);
  conic_triangles_release(context, &mesh);
  conic_context_destroy(context);
  return hash;
}

static void lamps_are_the_same_everywhere(void) {
  uint64_t hash = lamp_hash(1, CONIC_ISA_SCALAR, 64);
  for (int isa = 0; isa < CONIC_N_ISAS; isa++)
    if (conic_isa_is_here((conic_isa)isa))
      CHECK(lamp_hash(2, (conic_isa)isa, 64) == hash);
  CHECK(lamp_hash(3, CONIC_ISA_AUTO, 8) == hash);
}

static void wrong_lamps_are_refused(conic_context *context) {
  conic_triangles mesh = lamp_floor(context, light_flat);
  const conic_drawing drawing = {NULL, &mesh};
  lamp_scene s;
  lamp_scene_open(context, &drawing, 0.0, &s);
  s.picture = light_take_picture(&s.drawer, 32, 30.0, 40.0, LAMP_PLANES);
  const conic_lamp right = {.color = {1.0f, 1.0f, 1.0f}, .position = {0.0, 1.0, 0.0}};
  conic_lamp wrong[6] = {right, right, right, right, right, right};
  wrong[0].kind = (conic_lamp_kind)7;
  wrong[1].color[2] = -1.0f;
  wrong[2].position[0] = NAN;
  wrong[3].radius = -1.0;
  wrong[4].kind = CONIC_LAMP_DISC; /* without axes */
  wrong[5].reserved[3] = 1;
  for (int i = 0; i < 6; i++) {
    s.lamp = wrong[i];
    CHECK(conic_image_light(context, &s.casters, &s.picture.camera, &s.drawer.options, &s.options, &s.picture.image) ==
          CONIC_ERROR_ARGUMENT);
  }
  s.lamp = right;
  s.options.n_lamps = CONIC_MAX_LAMPS + 1;
  CHECK(conic_image_light(context, &s.casters, &s.picture.camera, &s.drawer.options, &s.options, &s.picture.image) ==
        CONIC_ERROR_ARGUMENT);
  s.options.n_lamps = 1; /* on the floor, where it is as far as a pixel is wide */
  s.lamp.position[1] = 0.0;
  lamp_scene_light(&s);
  for (int k = 0; k < 32 * 32; k++)
    CHECK(isfinite(lamp_plane(&s, CONIC_PLANE_RGBA)[4 * k]) && isfinite(lamp_plane(&s, CONIC_PLANE_SHADOW)[k]));
  lamp_scene_drop(&s);
  lamp_scene_close(&s);
  conic_triangles_release(context, &mesh);
}

int main(void) {
  conic_context *context = check_context(0);
  wrong_lamps_are_refused(context);
  plane_is_lit_by_the_formula(context);
  far_lamp_is_a_light(context);
  lamps_with_a_size_are_as_bright_as_formulas(context);
  cube_hides_the_lamp(context);
  ball_casts_a_cone(context);
  ball_has_no_acne(context);
  boxes_have_no_seams(context);
  maps_are_drawn_where_pixels_lie(context);
  lamps_are_the_same_everywhere();
  conic_context_destroy(context);
  return check_result();
}
