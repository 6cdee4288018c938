/* Several lights, and light from all around: shading against the page's formulas in double, the frames in which lights
 * stand, and what is no light. */
#include "raster/tiles/lights.h"
#include "tests/support/fixture.h"

static conic_light light_in(conic_light_frame frame, double x, double y, double z) {
  conic_light light = {.frame = frame, .color = {1.0f, 1.0f, 1.0f}, .direction = {x, y, z}};
  return light;
}

static double random_direction(uint64_t *state, double v[3]) {
  double length;
  do {
    for (int i = 0; i < 3; i++)
      v[i] = 2.0 * fixture_random(state) - 1.0;
    length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  } while (!(length > 0.1 && length < 1.0));
  for (int i = 0; i < 3; i++)
    v[i] /= length;
  return length;
}

static double dot_of(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A camera that is turned, by two angles. */
static void turn_camera(conic_camera *camera, double yaw, double pitch) {
  const double rows[3][3] = {{cos(yaw), 0.0, -sin(yaw)},
                             {sin(yaw) * sin(pitch), cos(pitch), cos(yaw) * sin(pitch)},
                             {sin(yaw) * cos(pitch), -sin(pitch), cos(yaw) * cos(pitch)}};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      camera->cam_from_world[i][j] = rows[i][j];
}

/* picture.md, Shading. */
static double shade_channel(const conic_camera *camera, const conic_lighting *lighting, int is_phong, int c,
                            double albedo, const double m[3], const double n[3], const double v[3]) {
  double up_length = sqrt(dot_of(lighting->up, lighting->up)), sky = (double)lighting->sky[c];
  double share = 0.5 * (1.0 + dot_of(m, lighting->up) / up_length), ground = (double)lighting->ground[c];
  double lit = ground + (sky - ground) * share, glossy = 0.0;
  for (int i = 0; i < lighting->n_lights; i++) {
    const conic_light *light = &lighting->lights[i];
    const double *d = light->direction, length = sqrt(dot_of(d, d));
    double l[3], color = (double)light->color[c];
    for (int j = 0; j < 3; j++) {
      const double(*rows)[4] = camera->cam_from_world;
      double turned = rows[0][j] * d[0] - rows[1][j] * d[1] - rows[2][j] * d[2];
      l[j] = light->frame == CONIC_LIGHT_HEAD ? v[j] : (light->frame == CONIC_LIGHT_CAMERA ? turned : d[j]) / length;
    }
    double facing = dot_of(m, l), along = dot_of(n, l), mirrored = 2.0 * along * dot_of(n, v) - dot_of(l, v);
    lit += facing > 0.0 ? 0.75 * color * facing : 0.0;
    glossy += is_phong && along > 0.0 && mirrored > 0.0 ? 0.15 * color * pow(mirrored, 32.0) * dot_of(m, m) : 0.0;
  }
  return albedo * lit + glossy;
}

static void fill_lighting(uint64_t *state, int n_lights, conic_lighting *lighting) {
  memset(lighting, 0, sizeof *lighting);
  lighting->is_given = 1;
  lighting->n_lights = n_lights;
  random_direction(state, lighting->up);
  for (int c = 0; c < 3; c++) {
    lighting->sky[c] = (float)fixture_random(state);
    lighting->ground[c] = (float)fixture_random(state);
    lighting->up[c] *= 3.0;
  }
  for (int i = 0; i < n_lights; i++) {
    lighting->lights[i].frame = (conic_light_frame)(i % 3);
    for (int c = 0; c < 3; c++) {
      lighting->lights[i].color[c] = (float)fixture_random(state);
      lighting->lights[i].direction[c] = 4.0 * fixture_random(state) - 2.0;
    }
  }
}

static void test_against_double(fixture *f) {
  uint64_t state = 19;
  conic_finish_lights lights;
  const conic_finish finish = {.options = &f->options, .lights = &lights};
  for (int number = 0; number < 4000; number++) {
    double v[3], n[3], m[3];
    float albedo[3], normal[3], mean[3], viewer[3], shaded[3];
    fill_lighting(&state, number % (CONIC_MAX_LIGHTS + 1), &f->options.lighting);
    f->options.shading = number % 2 ? CONIC_SHADE_PHONG : CONIC_SHADE_LAMBERT;
    turn_camera(&f->camera, 6.0 * fixture_random(&state), 3.0 * fixture_random(&state));
    CHECK_OK(conic_finish_lights_init(f->context, &f->camera, &f->options, &lights));
    random_direction(&state, v);
    double length = random_direction(&state, n);
    for (int i = 0; i < 3; i++) {
      viewer[i] = (float)v[i];
      normal[i] = (float)n[i];
      mean[i] = (float)(m[i] = n[i] * length);
      albedo[i] = (float)fixture_random(&state);
    }
    conic_shade(&finish, albedo, normal, mean, viewer, shaded);
    for (int c = 0; c < 3; c++)
      CHECK_NEAR((double)shaded[c],
                 shade_channel(&f->camera, &f->options.lighting, number % 2, c, (double)albedo[c], m, n, v), 2e-5);
  }
}

/* The words of the page: right, up, towards the viewer. The camera looks along z, with y down. */
static void test_camera_frame(fixture *f) {
  static const double turned[3][3] = {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  conic_finish_lights lights;
  fixture_camera(f, 8, 8, 8.0);
  for (int axis = 0; axis < 3; axis++) {
    f->options.lighting = (conic_lighting){.is_given = 1, .n_lights = 1};
    f->options.lighting.lights[0] = light_in(CONIC_LIGHT_CAMERA, axis == 0, axis == 1, axis == 2);
    CHECK_OK(conic_finish_lights_init(f->context, &f->camera, &f->options, &lights));
    for (int i = 0; i < 3; i++)
      CHECK((double)lights.lights[0].towards[i] == turned[axis][i]);
  }
}

static uint64_t hash_of_frame(fixture *f) {
  fixture_render(f);
  return conic_image_hash(&f->image, CONIC_PLANE_RGBA);
}

/* Given as one of several, the one white light has the same bits; and so has a picture whose camera, splats and light
 * of the world turn together, as one of the camera does by itself. */
static void test_same_bits(fixture *f) {
  fixture_camera(f, 96, 80, 90.0);
  f->camera.cam_from_world[2][3] = 2.6;
  fixture_scene(f, CONIC_SCENE_KNOT, 3000);
  f->options.shading = CONIC_SHADE_PHONG;
  for (int is_world = 0; is_world < 2; is_world++) {
    memset(&f->options.lighting, 0, sizeof f->options.lighting);
    f->options.has_light = is_world;
    f->options.light[0] = -0.5;
    f->options.light[2] = -1.0;
    uint64_t alone = hash_of_frame(f);
    f->options.has_light = 0;
    f->options.lighting = (conic_lighting){.is_given = 1, .n_lights = 1};
    f->options.lighting.lights[0] = light_in(is_world ? CONIC_LIGHT_WORLD : CONIC_LIGHT_HEAD, -0.5, 0.0, -1.0);
    for (int c = 0; c < 3; c++)
      f->options.lighting.sky[c] = f->options.lighting.ground[c] = 0.05f;
    CHECK(hash_of_frame(f) == alone);
    f->options.lighting.lights[0] = light_in(CONIC_LIGHT_CAMERA, -0.5, 0.0, 1.0); /* the camera is not turned */
    CHECK((hash_of_frame(f) == alone) == is_world);
  }
}

/* The frame from one side, and the scene's light with it. */
static void test_turned_camera(fixture *f) {
  fixture_camera(f, 96, 80, 90.0);
  fixture_scene(f, CONIC_SCENE_SPHERE, 3000);
  f->options.lighting =
      (conic_lighting){.is_given = 1, .n_lights = 1, .lights = {light_in(CONIC_LIGHT_CAMERA, 1, 0, 0)}};
  for (int i = 0; i < 4; i++) {
    turn_camera(&f->camera, 1.57 * i, 0.4 * i);
    f->camera.cam_from_world[2][3] = 2.6;
    fixture_render(f);
    double left = 0.0, right = 0.0;
    for (int x = 0; x < 96; x++)
      *(x < 48 ? &left : &right) += (double)fixture_pixel(f, CONIC_PLANE_RGBA, x, 40)[1];
    CHECK(right > 4.0 * left);
  }
}

static void check_refused(fixture *f, const conic_lighting *lighting) {
  conic_finish_lights lights;
  f->options.lighting = *lighting;
  CHECK(conic_finish_lights_init(f->context, &f->camera, &f->options, &lights) == CONIC_ERROR_ARGUMENT);
}

static void test_refusals(fixture *f) {
  const conic_lighting sound = {
      .is_given = 1, .n_lights = 1, .lights = {light_in(CONIC_LIGHT_CAMERA, 0, 1, 0)}, .sky = {0.5f}, .up = {0, 1, 0}};
  conic_finish_lights lights;
  f->options.lighting = sound;
  CHECK_OK(conic_finish_lights_init(f->context, &f->camera, &f->options, &lights));
  conic_lighting l = sound;
  l.n_lights = CONIC_MAX_LIGHTS + 1;
  check_refused(f, &l);
  l.n_lights = -1;
  check_refused(f, &l);
  l = sound;
  l.lights[0].direction[1] = 0.0;
  check_refused(f, &l);
  l = sound;
  l.lights[0].color[2] = NAN;
  check_refused(f, &l);
  l.lights[0].color[2] = -0.5f;
  check_refused(f, &l);
  l = sound;
  l.lights[0].frame = (conic_light_frame)3;
  check_refused(f, &l);
  l = sound;
  l.up[1] = 0.0;
  check_refused(f, &l);
  l = sound;
  l.ground[0] = INFINITY;
  check_refused(f, &l);
  l = sound;
  l.reserved[3] = 1;
  check_refused(f, &l);
}

int main(void) {
  fixture f = fixture_open(1);
  fixture_camera(&f, 8, 8, 8.0);
  test_against_double(&f);
  test_camera_frame(&f);
  test_same_bits(&f);
  test_turned_camera(&f);
  test_refusals(&f);
  fixture_close(&f);
  return check_result();
}
