/* What surfaces mirror of a sky: the sky's colours in directions, and pixels whose normals are known. */
#include "conic/lighting.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "lighting/light_work.h"
#include "tests/support/check.h"

enum { WIDTH = 128, HEIGHT = 64, N_PIXELS = 5 };

static conic_status draw_nothing(void *cookie, const conic_camera *camera, double near_z, conic_image *depth) {
  (void)cookie, (void)camera, (void)near_z, (void)depth;
  return CONIC_OK;
}

/* Red is the greatest of each colour and 1, so that the light of a direction is its colour times a constant. */
static conic_sky *make_sky(conic_context *context) {
  static float rgba[4 * WIDTH * HEIGHT];
  const double up[3] = {0.0, 0.6, 0.8};
  conic_image image = {.width = WIDTH, .height = HEIGHT, .planes[CONIC_PLANE_RGBA] = rgba};
  conic_sky *sky = NULL;
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    rgba[4 * i] = rgba[4 * i + 3] = 1.0f;
    rgba[4 * i + 1] = 0.5f + 0.4f * (float)sin(2.0 * CONIC_PI * (i % WIDTH + 0.5) / WIDTH);
    rgba[4 * i + 2] = 0.1f + 0.8f * ((float)(i / WIDTH) + 0.5f) / HEIGHT;
  }
  CHECK_OK(conic_sky_create(context, &image, up, &sky));
  return sky;
}

/* The sky looks as it shines: within a pixel of where a direction of its light is. */
static void check_directions(const conic_sky *sky) {
  for (uint64_t i = 0; i < 2000; i++) {
    double direction[3], light[3];
    conic_sky_direction(sky, i, direction, light);
    const float towards[3] = {(float)direction[0], (float)direction[1], (float)direction[2]};
    float color[3];
    conic_sky_look(sky, towards, color);
    CHECK_NEAR((double)color[0], 1.0, 1e-6);
    CHECK_NEAR((double)color[1], light[1] / light[0], 0.4 * 2.0 * CONIC_PI / WIDTH);
    CHECK_NEAR((double)color[2], light[2] / light[0], 0.8 / HEIGHT);
  }
}

typedef struct picture {
  float rgba[4 * N_PIXELS], albedo[3 * N_PIXELS], normal[3 * N_PIXELS], z[N_PIXELS], ao[N_PIXELS];
} picture;

/* A row of pixels, the last of which shows nothing. */
static void light_picture(conic_context *context, const conic_sky *sky, double reflectance, const conic_camera *camera,
                          picture *p) {
  const conic_casters casters = {.draw = draw_nothing, .minimum = {-9, -9, -9}, .maximum = {9, 9, 9}};
  conic_image image = {.width = N_PIXELS, .height = 1};
  conic_lighting_options options;
  conic_render_options render;
  conic_lighting_options_init(&options);
  conic_render_options_init(&render);
  options.n_directions = 16;
  options.sky = sky;
  options.reflectance = reflectance;
  render.exposure = 1.0f;
  render.lighting.is_given = 1;
  memset(p, 0, sizeof *p);
  for (int i = 0; i + 1 < N_PIXELS; i++) {
    double n[3] = {0.3 * i - 0.4, 0.2, -1.0};
    conic_normalize(n);
    p->z[i] = 2.0f;
    p->rgba[4 * i + 3] = 1.0f;
    for (int c = 0; c < 3; c++) {
      p->normal[3 * i + c] = (float)n[c];
      p->albedo[3 * i + c] = 0.5f;
    }
  }
  image.planes[CONIC_PLANE_RGBA] = p->rgba;
  image.planes[CONIC_PLANE_ALBEDO] = p->albedo;
  image.planes[CONIC_PLANE_NORMAL] = p->normal;
  image.planes[CONIC_PLANE_Z] = p->z;
  image.planes[CONIC_PLANE_AO] = p->ao;
  CHECK_OK(conic_image_light(context, &casters, camera, &render, &options, &image));
}

int main(void) {
  conic_context *context = check_context(1);
  const conic_camera camera = {.width = N_PIXELS,
                               .height = 1,
                               .fx = 5.0,
                               .fy = 5.0,
                               .cx = 0.5 * N_PIXELS,
                               .cy = 0.5,
                               .cam_from_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  conic_sky *sky = make_sky(context);
  picture plain, mirrored;
  check_directions(sky);
  light_picture(context, sky, 0.0, &camera, &plain);
  light_picture(context, sky, 0.25, &camera, &mirrored);
  for (int i = 0; i + 1 < N_PIXELS; i++) {
    double towards[3] = {-(i + 0.5 - camera.cx) / camera.fx, 0.0, -1.0}, along = 0.0;
    float away[3], color[3];
    conic_normalize(towards);
    for (int c = 0; c < 3; c++)
      along += towards[c] * (double)plain.normal[3 * i + c];
    for (int c = 0; c < 3; c++)
      away[c] = (float)(2.0 * along * (double)plain.normal[3 * i + c] - towards[c]);
    conic_sky_look(sky, away, color);
    for (int c = 0; c < 3; c++) {
      CHECK(plain.rgba[4 * i + c] > 0.0f);
      CHECK_NEAR((double)mirrored.rgba[4 * i + c], 0.75 * (double)plain.rgba[4 * i + c] + 0.25 * 2.0 * (double)color[c],
                 1e-5);
    }
  }
  for (int c = 0; c < 4; c++)
    CHECK(mirrored.rgba[4 * (N_PIXELS - 1) + c] == 0.0f);
  conic_sky_destroy(sky);
  conic_context_destroy(context);
  return check_result();
}
