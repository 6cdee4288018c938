/* Lights with a direction that are discs. */
#include "tests/support/lamp_fixture.h"

typedef struct sun_stage {
  lamp_scene scene;
  conic_lighting middle;
  float radius_deg[CONIC_MAX_LIGHTS];
} sun_stage;

/* Above the floor, half a plane hides what is to the left: of the sun's disc, what is beyond its edge is seen. */
static void sun_has_the_penumbra_of_a_disc(conic_context *context) {
  enum { SIZE = 128, N = 128 };
  static double mean[SIZE * SIZE];
  static const double height = 2.0, radius = 5.0;
  conic_triangles mesh = light_mesh(context, 2 * 8 * 8 + 2);
  const conic_drawing drawing = {NULL, &mesh};
  sun_stage sun = {.radius_deg = {(float)radius}};
  lamp_scene *s = &sun.scene;
  light_field(&mesh, 8, 3.0, light_flat);
  light_quad(&mesh, (const double[3]){-3.0, height, -3.0}, (const double[3]){-3.0, height, 3.0},
             (const double[3]){0.0, height, 3.0}, (const double[3]){0.0, height, -3.0});
  lamp_scene_open(context, &drawing, 0.0, s);
  s->options.n_lamps = 0;
  s->options.texels = 4.0;
  sun.middle = (conic_lighting){.is_given = 1, .n_lights = 1};
  sun.middle.lights[0] = (conic_light){CONIC_LIGHT_WORLD, {1.0f, 1.0f, 1.0f}, {0.0, 3.0, 0.0}};
  const conic_lighter lighter = {context, &s->casters, &s->drawer.options, &s->options};
  s->drawer.options.lighting = sun.middle;
  s->picture = light_take_picture(&s->drawer, SIZE, 90.0, 30.0, LIGHT_PLANES);
  for (int i = 0; i < N; i++) {
    CHECK_OK(conic_lighting_sample(context, &sun.middle, sun.radius_deg, (uint64_t)i, &s->drawer.options.lighting));
    CHECK_OK(conic_lighter_shade((void *)&lighter, (uint64_t)i, &s->picture.camera, &s->picture.image));
    for (int k = 0; k < SIZE * SIZE; k++)
      mean[k] += (double)lamp_plane(s, CONIC_PLANE_SHADOW)[k] / N;
  }
  long n_half = 0;
  double worst = 0.0;
  for (int k = 0; k < SIZE * SIZE; k++) {
    double place[3], normal[3];
    if (!light_place(&s->picture, k % SIZE, k / SIZE, place, normal) || place[1] > 0.01 || fabs(place[2]) > 2.0 ||
        fabs(place[0]) > 1.0)
      continue;
    double t = place[0] / (height * tan(radius * light_pi / 180.0));
    double seen = t >= 1.0 ? 1.0 : t <= -1.0 ? 0.0 : 0.5 + (asin(t) + t * sqrt(1.0 - t * t)) / light_pi;
    worst = fmax(worst, fabs(mean[k] - seen));
    n_half += fabs(t) < 0.8;
  }
  printf("penumbra of the sun's disc: %ld pixels, the worst is off by %.4f\n", n_half, worst);
  CHECK(n_half > 100);
  CHECK(worst < 0.03);
  lamp_scene_drop(s);
  lamp_scene_close(s);
  conic_triangles_release(context, &mesh);
}

/* Directions stay in the disc, and their mean is its middle; what has no size stays. */
static void suns_are_placed(conic_context *context) {
  enum { N = 256 };
  const float radius_deg[CONIC_MAX_LIGHTS] = {30.0f, 0.0f, 10.0f};
  const float wrong[CONIC_MAX_LIGHTS] = {91.0f};
  conic_lighting lighting = {.is_given = 1, .n_lights = 3}, sample;
  double sum[3] = {0.0, 0.0, 0.0}, least = 1.0;
  lighting.lights[0] = (conic_light){CONIC_LIGHT_CAMERA, {1.0f, 1.0f, 1.0f}, {2.0, 4.0, -4.0}};
  lighting.lights[1] = lighting.lights[0];
  lighting.lights[2].frame = CONIC_LIGHT_HEAD;
  for (int i = 0; i < N; i++) {
    CHECK_OK(conic_lighting_sample(context, &lighting, radius_deg, (uint64_t)i, &sample));
    const double *d = sample.lights[0].direction;
    double cosine = (d[0] + 2.0 * d[1] - 2.0 * d[2]) / 3.0;
    CHECK_NEAR(lamp_product(d, d), 1.0, 1e-12);
    least = fmin(least, cosine);
    for (int axis = 0; axis < 3; axis++)
      sum[axis] += d[axis] / N;
    CHECK(memcmp(&sample.lights[1], &lighting.lights[1], 2 * sizeof *sample.lights) == 0);
  }
  CHECK(least >= cos(30.0 * light_pi / 180.0) - 1e-12 && least < cos(29.0 * light_pi / 180.0));
  double length = 0.5 * (1.0 + cos(30.0 * light_pi / 180.0)); /* of the mean over a cap */
  CHECK_NEAR(sum[0], length / 3.0, 2e-3);
  CHECK_NEAR(sum[1], 2.0 * length / 3.0, 2e-3);
  CHECK_NEAR(sum[2], -2.0 * length / 3.0, 2e-3);
  CHECK(conic_lighting_sample(context, &lighting, wrong, 0, &sample) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_lighting_sample(context, &lighting, NULL, 0, &sample) == CONIC_ERROR_ARGUMENT);
  lighting.n_lights = CONIC_MAX_LIGHTS + 1;
  CHECK(conic_lighting_sample(context, &lighting, radius_deg, 0, &sample) == CONIC_ERROR_ARGUMENT);
}

int main(void) {
  conic_context *context = check_context(0);
  suns_are_placed(context);
  sun_has_the_penumbra_of_a_disc(context);
  conic_context_destroy(context);
  return check_result();
}
