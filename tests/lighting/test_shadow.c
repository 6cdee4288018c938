/* Shadows, light by samples, at points and from skies, and what must not change them. */
#include "core/base/team_runs.h"
#include "core/lanes/instruction_sets.h"
#include "lighting/light_work.h"
#include "tests/support/light_fixture.h"
#include "tests/support/thread_team.h"

/* --- shadows of the sun --- */

typedef struct sunny {
  light_drawer drawer;
  conic_casters casters;
  light_picture picture;
  conic_lighting_options options;
} sunny;

static void stand_in_the_sun(conic_context *context, const conic_drawing *drawing, double epsilon, int size, sunny *s) {
  *s = (sunny){.drawer = {.context = context, .drawing = drawing}};
  CHECK_OK(conic_renderer_create(context, &s->drawer.renderer));
  conic_render_options_init(&s->drawer.options);
  conic_lighting_options_init(&s->options);
  s->options.has_shadows = s->drawer.options.has_light = 1;
  s->drawer.options.light[1] = 1.0;
  s->casters = light_casters(&s->drawer, epsilon);
  s->picture = light_take_picture(&s->drawer, size, 30.0, 25.0, LIGHT_PLANES);
}

static void turn_to(sunny *s, const double sun[3]) {
  memcpy(s->drawer.options.light, sun, sizeof s->drawer.options.light);
  CHECK_OK(conic_image_light(s->drawer.context, &s->casters, &s->picture.camera, &s->drawer.options, &s->options,
                             &s->picture.image));
}

static void leave_the_sun(sunny *s) {
  conic_image_release(s->drawer.context, &s->picture.image);
  conic_renderer_destroy(s->drawer.renderer);
}

/* Towards the sun, at the given height and angle. */
static void set_sun(double height_deg, double angle_deg, double sun[3]) {
  double height = height_deg * light_pi / 180.0, angle = angle_deg * light_pi / 180.0;
  sun[0] = cos(height) * cos(angle);
  sun[1] = sin(height);
  sun[2] = cos(height) * sin(angle);
}

/* 1 and 0 by a ray; -1 where nothing is, or the surface is seen from its edge. */
static int lit_by_ray(const light_picture *picture, const ray_mesh *mesh, const double sun[3], int x, int y) {
  double place[3], normal[3];
  if (!light_place(picture, x, y, place, normal))
    return -1;
  double facing = normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2];
  for (int axis = 0; axis < 3; axis++)
    place[axis] += 1e-4 * normal[axis];
  return fabs(facing) < 0.02 ? -1 : facing > 0.0 && !ray_is_blocked(mesh, place, sun, HUGE_VAL);
}

/* Whether all about a pixel are lit as it is, as far as texels reach; and those that are lit, of one face: a texel that
 * has the wall beside it knows no better of the floor. */
static int is_inside(const light_picture *picture, const ray_mesh *mesh, const double sun[3], int x, int y, int lit) {
  double place[3], normal[3], other[3];
  light_place(picture, x, y, place, normal);
  double facing = fabs(normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2]);
  int reach = 1 + (int)ceil(1.5 / facing);
  if (reach > 7 || x < reach || y < reach || x + reach >= picture->camera.width || y + reach >= picture->camera.height)
    return 0;
  for (int j = -reach; j <= reach; j++)
    for (int i = -reach; i <= reach; i++)
      if (lit_by_ray(picture, mesh, sun, x + i, y + j) != lit ||
          (light_place(picture, x + i, y + j, place, other) && lit && memcmp(other, normal, sizeof other) != 0))
        return 0;
  return 1;
}

/* Neither a leak at the contact, nor acne. */
static void cube_leaks_nothing(conic_context *context) {
  conic_triangles mesh = light_cube_on_plane(context);
  const conic_drawing drawing = {NULL, &mesh};
  ray_mesh rays = ray_mesh_of(&mesh);
  sunny s;
  stand_in_the_sun(context, &drawing, 0.0, 160, &s);
  const float *shadow = s.picture.image.planes[CONIC_PLANE_SHADOW];
  long n_lit = 0, n_dark = 0;
  for (int i = 0; i < 12; i++) {
    double sun[3];
    set_sun(15.0 + 6.0 * i, 77.0 * i, sun);
    turn_to(&s, sun);
    for (int y = 1; y < 159; y += 2)
      for (int x = 1; x < 159; x++) {
        int lit = lit_by_ray(&s.picture, &rays, sun, x, y);
        if (lit < 0 || !is_inside(&s.picture, &rays, sun, x, y, lit))
          continue;
        n_lit += lit;
        n_dark += !lit;
        CHECK_NEAR((double)shadow[y * 160 + x], (double)lit, 0.0);
      }
  }
  CHECK(n_lit > 10000 && n_dark > 200);
  leave_the_sun(&s);
  ray_mesh_free(&rays);
  conic_triangles_release(context, &mesh);
}

/* What faces the light by more than `least` is lit wholly, all about a ball whose normals are right. */
static void expect_no_acne(sunny *s, double least) {
  const float *shadow = s->picture.image.planes[CONIC_PLANE_SHADOW];
  int size = s->picture.camera.width;
  for (int i = 0; i < 24; i++) {
    double sun[3], place[3], normal[3];
    long n = 0;
    float darkest = 1.0f;
    set_sun(-85.0 + 7.3 * i, 101.0 * i, sun);
    turn_to(s, sun);
    for (int k = 0; k < size * size; k++)
      if (light_is_covered_about(&s->picture, k % size, k / size) &&
          light_place(&s->picture, k % size, k / size, place, normal) &&
          normal[0] * place[0] + normal[1] * place[1] + normal[2] * place[2] > 0.9 &&
          normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2] > least) {
        darkest = shadow[k] < darkest ? shadow[k] : darkest;
        n++;
      }
    CHECK(n == 0 || darkest == 1.0f);
  }
}

static void ball_has_no_acne(conic_context *context) {
  conic_triangles mesh = light_mesh(context, 2 * 192 * 96);
  conic_drawing drawing = {NULL, &mesh};
  light_ball(&mesh, 192, 96);
  sunny s;
  stand_in_the_sun(context, &drawing, 0.0, 200, &s);
  expect_no_acne(&s, 0.02);
  leave_the_sun(&s);
  CHECK_OK(conic_triangles_crease(context, &mesh, 60.0));
  stand_in_the_sun(context, &drawing, 0.0, 200, &s);
  expect_no_acne(&s, 0.1);
  leave_the_sun(&s);
  conic_triangles_release(context, &mesh);
  conic_splats splats = light_splats_on_ball(context, 20000);
  double length;
  CHECK_OK(conic_splats_length(context, &splats, &length));
  drawing = (conic_drawing){&splats, NULL};
  stand_in_the_sun(context, &drawing, 1.5 * length, 200, &s);
  expect_no_acne(&s, 0.1);
  leave_the_sun(&s);
  conic_splats_release(context, &splats);
}

/* Discs on a square of edge 6, narrower than a texel where the sun grazes them. */
static void floor_has_no_acne(conic_context *context) {
  enum { N = 160, SIZE = 120 };
  conic_splats splats;
  if (conic_splats_allocate(context, (size_t)N * N, CONIC_SPLATS_TANGENTS, &splats) != CONIC_OK)
    exit(1);
  for (int i = 0; i < N * N; i++)
    for (int axis = 0; axis < 3; axis++) {
      splats.position[axis][i] = axis == 1 ? 0.0f : (float)(6.0 * ((axis ? i / N : i % N) + 0.5) / N - 3.0);
      splats.tangent_u[axis][i] = axis == 2 ? 4.5f / N : 0.0f;
      splats.tangent_v[axis][i] = axis == 0 ? 4.5f / N : 0.0f;
    }
  const conic_drawing drawing = {&splats, NULL};
  sunny s;
  double length;
  CHECK_OK(conic_splats_length(context, &splats, &length));
  stand_in_the_sun(context, &drawing, 1.5 * length, SIZE, &s);
  const float *shadow = s.picture.image.planes[CONIC_PLANE_SHADOW];
  for (int i = 0; i < 6; i++) {
    double sun[3];
    set_sun(6.0 + 4.0 * i, 50.0 * i, sun);
    turn_to(&s, sun);
    long n = 0;
    for (int k = 0; k < SIZE * SIZE; k++)
      if (light_is_covered_about(&s.picture, k % SIZE, k / SIZE)) {
        CHECK_NEAR((double)shadow[k], 1.0, 0.0);
        n++;
      }
    CHECK(n > 1000);
  }
  leave_the_sun(&s);
  conic_splats_release(context, &splats);
}

/* --- colours --- */

/* What is in shadow is what the engine draws without that light, and all else is as it was. */
static void shadow_takes_the_light_that_is_hidden(conic_context *context) {
  enum { SIZE = 96, COLORS = LIGHT_PLANES | 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_ALBEDO };
  conic_triangles mesh = light_cube_on_plane(context);
  const conic_drawing drawing = {NULL, &mesh};
  sunny s;
  stand_in_the_sun(context, &drawing, 0.0, SIZE, &s);
  conic_lighting *lighting = &s.drawer.options.lighting;
  *lighting = (conic_lighting){.is_given = 1, .n_lights = 2, .sky = {0.3f, 0.2f, 0.1f}, .ground = {0.3f, 0.2f, 0.1f}};
  lighting->lights[0] = (conic_light){CONIC_LIGHT_WORLD, {1.0f, 0.5f, 0.25f}, {1.0, 1.0, -0.5}};
  lighting->lights[1] = (conic_light){CONIC_LIGHT_HEAD, {0.2f, 0.2f, 0.2f}, {0.0, 0.0, 0.0}};
  conic_image_release(context, &s.picture.image);
  s.picture = light_take_picture(&s.drawer, SIZE, 30.0, 25.0, COLORS);
  light_picture whole = light_take_picture(&s.drawer, SIZE, 30.0, 25.0, COLORS);
  CHECK_OK(conic_image_light(context, &s.casters, &s.picture.camera, &s.drawer.options, &s.options, &s.picture.image));
  lighting->lights[0] = lighting->lights[1];
  lighting->n_lights = 1;
  light_picture without = light_take_picture(&s.drawer, SIZE, 30.0, 25.0, COLORS);
  const float *shadow = s.picture.image.planes[CONIC_PLANE_SHADOW], *rgba = s.picture.image.planes[CONIC_PLANE_RGBA];
  const float *lit = whole.image.planes[CONIC_PLANE_RGBA], *dark = without.image.planes[CONIC_PLANE_RGBA];
  long n_dark = 0;
  for (int i = 0; i < SIZE * SIZE; i++)
    for (int c = 0; c < 4; c++) {
      double expected =
          (double)shadow[i] * (double)lit[4 * i + c] + (1.0 - (double)shadow[i]) * (double)dark[4 * i + c];
      CHECK_NEAR((double)rgba[4 * i + c], expected, 1e-6);
      n_dark += lit[4 * i + c] > dark[4 * i + c] + 0.1f && shadow[i] == 0.0f;
    }
  CHECK(n_dark > 100);
  conic_image_release(context, &whole.image);
  conic_image_release(context, &without.image);
  leave_the_sun(&s);
  conic_triangles_release(context, &mesh);
}

/* The mean of samples, each lit from one direction, is the picture that is lit from all of them. */
static void mean_of_samples_is_the_picture(conic_context *context) {
  enum { SIZE = 64, N = 256, COLORS = LIGHT_PLANES | 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_ALBEDO };
  static double mean_ao[SIZE * SIZE], mean_red[SIZE * SIZE];
  conic_triangles mesh = light_cube_on_plane(context);
  const conic_drawing drawing = {NULL, &mesh};
  sunny s;
  stand_in_the_sun(context, &drawing, 0.0, SIZE, &s);
  s.drawer.options.lighting = (conic_lighting){.is_given = 1, .sky = {0.5f, 0.5f, 0.5f}, .ground = {0.2f, 0.2f, 0.2f}};
  s.drawer.options.lighting.up[1] = 1.0;
  s.options.n_directions = N;
  const conic_lighter lighter = {context, &s.casters, &s.drawer.options, &s.options};
  for (uint64_t i = 0; i < N; i++) {
    light_picture one = light_take_picture(&s.drawer, SIZE, 30.0, 25.0, COLORS);
    CHECK_OK(conic_lighter_shade((void *)&lighter, i, &one.camera, &one.image));
    for (int k = 0; k < SIZE * SIZE; k++) {
      mean_ao[k] += (double)((const float *)one.image.planes[CONIC_PLANE_AO])[k] / N;
      mean_red[k] += (double)((const float *)one.image.planes[CONIC_PLANE_RGBA])[4 * k] / N;
    }
    conic_image_release(context, &one.image);
  }
  light_picture whole = light_take_picture(&s.drawer, SIZE, 30.0, 25.0, COLORS);
  CHECK_OK(conic_image_light(context, &s.casters, &whole.camera, &s.drawer.options, &s.options, &whole.image));
  for (int k = 0; k < SIZE * SIZE; k++) {
    CHECK_NEAR(mean_ao[k], (double)((const float *)whole.image.planes[CONIC_PLANE_AO])[k], 0.02);
    CHECK_NEAR(mean_red[k], (double)((const float *)whole.image.planes[CONIC_PLANE_RGBA])[4 * k], 0.01);
  }
  conic_image_release(context, &whole.image);
  leave_the_sun(&s);
  conic_triangles_release(context, &mesh);
}

/* --- what must not matter --- */

static uint64_t light_hash(int threads, conic_isa isa, int tile) {
  conic_context *context = check_context(threads);
  conic_triangles mesh = light_cube_on_plane(context);
  conic_splats splats = light_splats_on_ball(context, 3000);
  const conic_drawing drawing = {&splats, &mesh};
  sunny s;
  stand_in_the_sun(context, &drawing, 0.1, 120, &s);
  const double sun[3] = {0.4, 0.7, 0.5};
  s.options.n_directions = 9;
  s.options.isa = isa;
  s.drawer.options.isa = isa;
  s.drawer.options.tile = tile;
  turn_to(&s, sun);
  uint64_t hash =
      3 * conic_image_hash(&s.picture.image, CONIC_PLANE_AO) + conic_image_hash(&s.picture.image, CONIC_PLANE_SHADOW);
  leave_the_sun(&s);
  conic_splats_release(context, &splats);
  conic_triangles_release(context, &mesh);
  conic_context_destroy(context);
  return hash;
}

static void light_is_the_same_everywhere(void) {
  uint64_t hash = light_hash(1, CONIC_ISA_SCALAR, 64);
  for (int isa = 0; isa < CONIC_N_ISAS; isa++)
    if (conic_isa_is_here((conic_isa)isa))
      CHECK(light_hash(2, (conic_isa)isa, 64) == hash);
  CHECK(light_hash(3, CONIC_ISA_AUTO, 8) == hash);
}

/* --- points --- */

/* Of a ball alone nothing is hidden; in its middle plane, all of a point that looks at the ball from close by. */
static void points_are_occluded(conic_context *context) {
  conic_splats splats = light_splats_on_ball(context, 4000);
  const conic_drawing drawing = {&splats, NULL};
  light_drawer drawer = {.context = context, .drawing = &drawing};
  conic_lighting_options options;
  double length, mean = 0.0;
  float *ao = malloc(splats.count * sizeof *ao);
  CHECK_OK(conic_renderer_create(context, &drawer.renderer));
  CHECK_OK(conic_splats_length(context, &splats, &length));
  conic_render_options_init(&drawer.options);
  conic_lighting_options_init(&options);
  options.n_directions = 64;
  conic_casters casters = light_casters(&drawer, 1.5 * length);
  /* The first has no axes, and the second, in the middle, none either. */
  for (int axis = 0; axis < 3; axis++) {
    splats.tangent_u[axis][0] = splats.tangent_u[axis][1] = NAN;
    splats.position[axis][1] = 0.0f;
  }
  for (int inside = 0; inside < 2; inside++) {
    for (size_t i = 0; i < splats.count; i++)
      for (int axis = 0; axis < 3 && inside; axis++)
        splats.tangent_u[axis][i] = -splats.tangent_u[axis][i];
    CHECK_OK(conic_splats_occlude(context, &casters, &splats, length, &options, ao));
    mean = 0.0;
    for (size_t i = 0; i < splats.count; i++)
      mean += (double)ao[i] / (double)splats.count;
    CHECK_NEAR(mean, inside ? 0.0 : 1.0, 0.05);
    CHECK(ao[0] > 0.7f && ao[1] < 0.05f);
  }
  CHECK(conic_splats_occlude(context, &casters, &splats, 0.0, &options, ao) == CONIC_ERROR_ARGUMENT);
  free(ao);
  conic_renderer_destroy(drawer.renderer);
  conic_splats_release(context, &splats);
}

/* A ball by a team of three, whose second process may have other receivers. */
typedef struct ball_team {
  size_t n, n_of_second;
  float *ao[3];
  conic_status statuses[3];
} ball_team;

static conic_status occlude_ball(const conic_team *team, size_t n, float *ao) {
  conic_context *context = check_context(1);
  conic_splats splats = light_splats_on_ball(context, n);
  const conic_drawing drawing = {&splats, NULL};
  light_drawer drawer = {.context = context, .drawing = &drawing};
  conic_lighting_options options;
  CHECK_OK(conic_renderer_create(context, &drawer.renderer));
  conic_render_options_init(&drawer.options);
  conic_lighting_options_init(&options);
  options.n_directions = 7;
  conic_casters casters = light_casters(&drawer, 0.02);
  conic_context_join(context, team);
  conic_status status = conic_splats_occlude(context, &casters, &splats, 0.03, &options, ao);
  status = conic_context_part(context, status);
  conic_renderer_destroy(drawer.renderer);
  conic_splats_release(context, &splats);
  conic_context_destroy(context);
  return status;
}

static void occlude_in_team(const conic_team *team, void *cookie) {
  ball_team *b = cookie;
  b->statuses[team->index] = occlude_ball(team, team->index == 1 ? b->n_of_second : b->n, b->ao[team->index]);
}

static void points_are_occluded_together(void) {
  enum { MOST = 5000 };
  const size_t counts[3][2] = {{MOST, MOST}, {500, 500}, {500, 400}};
  float *alone = calloc(4 * MOST, sizeof *alone);
  for (int i = 0; i < 3; i++) {
    ball_team b = {counts[i][0], counts[i][1], {alone + MOST, alone + 2 * MOST, alone + 3 * MOST}, {CONIC_OK}};
    int is_one = b.n == b.n_of_second;
    CHECK_OK(occlude_ball(NULL, b.n, alone));
    thread_team_run(3, occlude_in_team, &b);
    for (int k = 0; k < 3; k++) {
      CHECK(b.statuses[k] == (is_one ? CONIC_OK : k == 1 ? CONIC_ERROR_ARGUMENT : CONIC_ERROR_CANCELLED));
      CHECK(!is_one || memcmp(b.ao[k], alone, b.n * sizeof *alone) == 0);
    }
  }
  free(alone);
}

/* --- the sky --- */

/* What a white surface that faces along `axis` reflects of it. */
static void gather_sky_of(const conic_sky *sky, int axis, double sign, int n, double sum[3]) {
  memset(sum, 0, 3 * sizeof *sum);
  for (int i = 0; i < n; i++) {
    double d[3], light[3];
    conic_sky_direction(sky, (uint64_t)i, d, light);
    CHECK_NEAR(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], 1.0, 1e-12);
    for (int c = 0; c < 3; c++)
      sum[c] += light[c] * fmax(0.0, sign * d[axis]) / n;
  }
}

static void sky_is_gathered(conic_context *context) {
  enum { WIDTH = 64, HEIGHT = 32 };
  const double up[3] = {0.0, 0.0, 1.0};
  conic_image image;
  conic_sky *sky;
  double sum[3];
  gather_sky_of(NULL, 1, 1.0, 4096, sum);
  CHECK_NEAR(sum[1], 1.0, 2e-3);
  CHECK_OK(conic_image_allocate(context, WIDTH, HEIGHT, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  CHECK(conic_sky_create(context, &image, up, &sky) == CONIC_ERROR_INPUT); /* it is black */
  for (int i = 0; i < WIDTH * HEIGHT; i++) { /* 2 above the horizon, 1 below it, red; and green alone on the right */
    rgba[4 * i] = i < WIDTH * HEIGHT / 2 ? 2.0f : 1.0f;
    rgba[4 * i + 1] = i % WIDTH >= WIDTH / 2 ? 1.0f : 0.0f;
  }
  CHECK_OK(conic_sky_create(context, &image, up, &sky));
  const double expected[6][2] = {{1.5, 0.0}, {1.5, 1.0}, {1.5, 0.5}, {1.5, 0.5}, {1.0, 0.5}, {2.0, 0.5}};
  for (int side = 0; side < 6; side++) {
    gather_sky_of(sky, side / 2, side % 2 ? 1.0 : -1.0, 16384, sum);
    CHECK_NEAR(sum[0], expected[side][0], 5e-3);
    CHECK_NEAR(sum[1], expected[side][1], 5e-3);
    CHECK_NEAR(sum[2], 0.0, 0.0);
  }
  conic_sky_destroy(sky);
  CHECK(conic_sky_create(context, &image, NULL, &sky) == CONIC_ERROR_ARGUMENT && !sky);
  CHECK(conic_sky_create(context, &image, up, NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_sky_read(context, "sky.pfm", up, NULL) == CONIC_ERROR_ARGUMENT);
  rgba[5] = NAN;
  CHECK(conic_sky_create(context, &image, up, &sky) == CONIC_ERROR_INPUT && !sky);
  conic_image_release(context, &image);
}

/* A picture of few pixels, whose means over a pixel are far from what its middle has. */
static void rest_of_a_sky_has_no_mean(conic_context *context) {
  enum { WIDTH = 3, HEIGHT = 4, N = 1 << 17, N_NORMALS = 12 };
  const double up[3] = {0.3, 1.0, -0.4};
  double sums[N_NORMALS][3] = {{0.0}}, square = 0.0;
  conic_image image;
  conic_sky *sky;
  CHECK_OK(conic_image_allocate(context, WIDTH, HEIGHT, 1u << CONIC_PLANE_RGBA, &image));
  for (int i = 0; i < 4 * WIDTH * HEIGHT; i++)
    ((float *)image.planes[CONIC_PLANE_RGBA])[i] = (float)(i * i % 11);
  CHECK_OK(conic_sky_create(context, &image, up, &sky));
  for (uint64_t i = 0; i < N; i++) {
    conic_sky_rest rest;
    conic_sky_rest_without(sky, i, &rest);
    for (int k = 0; k < N_NORMALS; k++) {
      const float normal[3] = {sinf(1.0f + (float)k), cosf(2.0f * (float)k), sinf(3.0f * (float)k)};
      for (size_t c = 0; c < 3; c++) {
        double value = (double)conic_sky_rest_at(&rest, c, normal);
        sums[k][c] += value / N;
        square += value * value / N;
      }
    }
  }
  CHECK(square > 100.0);
  for (int k = 0; k < 3 * N_NORMALS; k++)
    CHECK_NEAR(sums[k / 3][k % 3], 0.0, 1e-3);
  conic_sky_destroy(sky);
  conic_image_release(context, &image);
}

/* --- what is refused --- */

static conic_status refuse_map(void *cookie, const conic_camera *camera, double near_z, conic_image *depth) {
  (void)cookie;
  CHECK(near_z > 0.0 && camera->width == depth->width && depth->planes[CONIC_PLANE_Z]);
  return CONIC_ERROR_IO;
}

static void wrong_arguments_are_refused(conic_context *context) {
  conic_triangles mesh = light_cube_on_plane(context);
  const conic_drawing drawing = {NULL, &mesh};
  sunny s;
  stand_in_the_sun(context, &drawing, 0.0, 32, &s);
  const double sun[3] = {0.4, 0.7, 0.5};
  turn_to(&s, sun);
  conic_casters broken = s.casters;
  conic_lighting_options coarse = s.options;
  conic_image *image = &s.picture.image;
  conic_camera *camera = &s.picture.camera;
  conic_render_options *render = &s.drawer.options;
  broken.draw = refuse_map;
  CHECK(conic_image_light(context, &broken, camera, render, &s.options, image) == CONIC_ERROR_IO);
  broken = s.casters;
  broken.maximum[1] = NAN;
  CHECK(conic_image_light(context, &broken, camera, render, &s.options, image) == CONIC_ERROR_ARGUMENT);
  coarse.texels = 0.0;
  CHECK(conic_image_light(context, &s.casters, camera, render, &coarse, image) == CONIC_ERROR_ARGUMENT);
  camera->width = 31;
  CHECK(conic_image_light(context, &s.casters, camera, render, &s.options, image) == CONIC_ERROR_ARGUMENT);
  leave_the_sun(&s);
  conic_triangles_release(context, &mesh);
}

int main(void) {
  conic_context *context = check_context(0);
  wrong_arguments_are_refused(context);
  sky_is_gathered(context);
  rest_of_a_sky_has_no_mean(context);
  shadow_takes_the_light_that_is_hidden(context);
  mean_of_samples_is_the_picture(context);
  cube_leaks_nothing(context);
  ball_has_no_acne(context);
  floor_has_no_acne(context);
  points_are_occluded(context);
  points_are_occluded_together();
  light_is_the_same_everywhere();
  conic_context_destroy(context);
  return check_result();
}
