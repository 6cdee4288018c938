/* Shots: each is, to the bit, the picture that the pieces make which it joins; what a plan says of many of them; and
 * those that cannot be, which are refused. */
#include "accumulation/sequence.h"
#include "conic/gather.h"
#include "raster/tiles/lights.h"
#include "shots/shot_plan.h"
#include "source/source_kind.h"
#include "tests/support/shot_fixture.h"

enum { WIDTH = 72, HEIGHT = 60, N_SAMPLES = 5 };
enum {
  RGBA = 1u << CONIC_PLANE_RGBA,
  Z = 1u << CONIC_PLANE_Z,
  NORMAL = 1u << CONIC_PLANE_NORMAL,
  ALBEDO = 1u << CONIC_PLANE_ALBEDO,
  ID = 1u << CONIC_PLANE_ID,
  POSITION = 1u << CONIC_PLANE_POSITION,
  CLUSTER = 1u << CONIC_PLANE_CLUSTER,
  SHADOW = 1u << CONIC_PLANE_SHADOW,
  SAMPLES = 1u << CONIC_PLANE_SAMPLES,
  T = 1u << CONIC_PLANE_TRANSPARENCY
};

/* --- by pieces --- */

typedef struct pieces {
  conic_context *context;
  conic_source *source;
  conic_renderer *renderer;
  conic_shot shot;
  conic_lighting lighting; /* of views: their lights stay where the whole picture's are */
  const conic_sample *sample;
} pieces;

static double reach_of(const pieces *p) {
  const conic_source_scale *scale = conic_source_measure(p->source);
  return scale->n_splats ? (double)p->shot.render.kernel.cutoff * scale->splat_length : 0.0;
}

static void find_box(const pieces *p, double minimum[3], double maximum[3]) {
  conic_source_box(p->source, minimum, maximum);
  for (int axis = 0; axis < 3; axis++) {
    minimum[axis] -= 4.0 * reach_of(p);
    maximum[axis] += 4.0 * reach_of(p);
  }
}

static conic_status draw_depth(void *cookie, const conic_camera *camera, double near_z, conic_image *depth) {
  const pieces *p = cookie;
  const conic_source_scale *scale = conic_source_measure(p->source);
  conic_render_options render = p->shot.render;
  conic_source_view view = p->shot.view;
  render.near_z = near_z;
  render.passes = CONIC_PASS_OF_HIDING;
  render.epsilon = scale->epsilon;
  render.splat_length = CONIC_MAP_LENGTHS * scale->splat_length;
  render.cull_back = 0;
  render.shading = CONIC_SHADE_NONE;
  view.samples = 1;
  return conic_source_draw(p->source, p->renderer, camera, &render, &view, depth, NULL);
}

/* Lights a picture: by itself, or as one of the samples. */
static conic_status light_piece(pieces *p, const conic_camera *camera, const conic_lighting *lighting,
                                conic_image *image) {
  conic_lighting_options options;
  conic_casters casters = {.draw = draw_depth, .cookie = p, .epsilon = reach_of(p), .epsilon_is_drawn = 1};
  conic_render_options render = p->shot.render;
  const conic_lighter lighter = {p->context, &casters, &render, &options};
  render.lighting = *lighting;
  find_box(p, casters.minimum, casters.maximum);
  conic_lighting_options_init(&options);
  options.n_directions = p->shot.light.n_directions;
  options.has_shadows = p->shot.light.has_shadows;
  options.lamps = p->shot.light.lamps;
  options.n_lamps = (size_t)p->shot.light.n_lamps;
  options.samples = p->shot.view.samples;
  options.isa = render.isa;
  return p->sample ? conic_lighter_shade((void *)&lighter, p->sample->index, camera, image)
                   : conic_image_light(p->context, &casters, camera, &render, &options, image);
}

static conic_status draw_plain(pieces *p, const conic_camera *camera, const conic_render_options *render,
                               const conic_source_view *view, conic_image *image) {
  return conic_source_draw(p->source, p->renderer, camera, render, view, image, NULL);
}

static conic_status draw_view(void *cookie, const conic_gather_view *gathered, conic_image *image) {
  pieces *p = cookie;
  conic_render_options render = p->shot.render;
  conic_source_view view = p->shot.view;
  render.near_z = gathered->near_z;
  render.lighting = p->lighting;
  view.samples = gathered->samples;
  conic_status status = draw_plain(p, &gathered->camera, &render, &view, image);
  return status == CONIC_OK && p->sample && conic_shot_is_lit(&p->shot)
             ? light_piece(p, &gathered->camera, &p->lighting, image)
             : status;
}

static conic_status gather(pieces *p, const conic_camera *camera, conic_image *image) {
  conic_gather_options options;
  conic_gather_options_init(&options);
  p->lighting = p->shot.render.lighting;
  conic_lighting_place(camera, &p->lighting);
  options.camera = *camera;
  options.near_z = p->shot.render.near_z;
  options.samples = p->shot.view.samples;
  options.cookie = p;
  options.draw = draw_view;
  find_box(p, options.minimum, options.maximum);
  if (p->sample) {
    options.edge = 512;
    for (int axis = 0; axis < 2; axis++)
      options.shift[axis] = conic_sequence_at(p->sample->index, CONIC_SEQUENCE_VIEW + axis);
  }
  if (p->sample && conic_shot_is_lit(&p->shot))
    options.view_planes = Z | NORMAL | ALBEDO;
  return conic_gather(p->context, &options, image);
}

static conic_status draw_one(pieces *p, const conic_camera *camera, conic_image *image) {
  if (camera->kind)
    return gather(p, camera, image);
  return draw_plain(p, camera, &p->shot.render, &p->shot.view, image);
}

static conic_status draw_sample_by_pieces(void *cookie, const conic_sample *sample, conic_image *image) {
  pieces *p = cookie;
  p->sample = sample;
  conic_status status = draw_one(p, &sample->camera, image);
  if (status == CONIC_OK && !sample->camera.kind && conic_shot_is_lit(&p->shot))
    status = light_piece(p, &sample->camera, &p->shot.render.lighting, image);
  p->sample = NULL;
  return status;
}

static conic_status accumulate(pieces *p, conic_image *image) {
  conic_accumulate_options options;
  conic_accumulation *sums;
  const conic_camera *camera = &p->shot.camera;
  conic_accumulate_options_init(&options);
  options.camera = *camera;
  options.aperture = p->shot.aperture;
  options.end_sample = p->shot.n_samples;
  options.cookie = p;
  options.draw = draw_sample_by_pieces;
  if (conic_shot_is_lit(&p->shot) && !camera->kind)
    options.sample_planes = Z | NORMAL | ALBEDO;
  CHECK_OK(conic_accumulation_create(p->context, camera->width, camera->height,
                                     conic_image_planes(image) & CONIC_ACCUMULATED_PLANES, 0, &sums));
  conic_status status = conic_accumulate(p->context, &options, sums);
  if (status == CONIC_OK)
    status = conic_accumulation_resolve(sums, image);
  conic_accumulation_destroy(sums);
  return status;
}

static conic_status draw_by_pieces(pieces *p, conic_image *image) {
  if (p->shot.n_samples)
    return accumulate(p, image);
  conic_status status = draw_one(p, &p->shot.camera, image);
  return status == CONIC_OK && conic_shot_is_lit(&p->shot)
             ? light_piece(p, &p->shot.camera, &p->shot.render.lighting, image)
             : status;
}

/* The hash of a plane of the shot by its pieces; of the shot itself into *drawn. */
static uint64_t hash_both(pieces *p, const conic_shot *shot, conic_plane plane, uint64_t *drawn) {
  conic_image image, own;
  conic_shot_outcome outcome;
  p->shot = *shot;
  conic_source_settle(p->source, &p->shot.render);
  CHECK_OK(conic_image_allocate(p->context, shot->camera.width, shot->camera.height, shot->planes, &image));
  CHECK_OK(conic_shot_draw(p->source, p->renderer, shot, &image, &outcome));
  CHECK(outcome.samples.end_sample == shot->n_samples);
  *drawn = conic_image_hash(&image, plane);
  CHECK_OK(conic_image_allocate(p->context, image.width, image.height, conic_shot_needs(shot, shot->planes), &own));
  CHECK_OK(draw_by_pieces(p, &own));
  uint64_t hash = conic_image_hash(&own, plane);
  conic_image_release(p->context, &own);
  conic_image_release(p->context, &image);
  return hash;
}

/* What may be joined: a camera, light, samples. All 24 pictures differ. */
static void test_pieces(conic_context *context, int scene) {
  static const conic_camera_kind kinds[] = {CONIC_CAMERA_PERSPECTIVE, CONIC_CAMERA_FISHEYE,
                                            CONIC_CAMERA_EQUIRECTANGULAR};
  enum { N_LIGHTS = 4, N_ALL = 3 * N_LIGHTS * 2 };
  const conic_lighting lighting = {
      /* which turns with the camera, but not with the views of one picture */
      .is_given = 1,
      .n_lights = 1,
      .sky = {0.3f, 0.3f, 0.4f},
      .ground = {0.3f, 0.3f, 0.4f},
      .lights = {{.frame = CONIC_LIGHT_CAMERA, .direction = {0.5f, 0.7f, 0.3f}, .color = {1.0f, 0.9f, 0.8f}}}};
  pieces p = {.context = context, .source = shot_open(context, scene)};
  uint64_t hashes[N_ALL];
  CHECK_OK(conic_renderer_create(context, &p.renderer));
  for (int i = 0; i < N_ALL; i++) {
    int i_light = i / 3 % N_LIGHTS;
    conic_shot shot = shot_of(p.source, kinds[i % 3], WIDTH, HEIGHT);
    shot.planes = RGBA | Z | NORMAL;
    shot.light.n_directions = i_light & 1 ? 6 : 0;
    shot.light.n_lamps = i_light >> 1;
    shot.light.lamps[0] = (conic_lamp){.position = {0.5, 1.5, 0.4}, .color = {2.0f, 1.0f, 0.5f}, .radius = 0.2};
    shot.n_samples = i / (3 * N_LIGHTS) ? N_SAMPLES : 0;
    shot.view.samples = shot.n_samples ? 1 : 2;
    shot.render.lighting = lighting;
    uint64_t by_pieces = hash_both(&p, &shot, CONIC_PLANE_RGBA, &hashes[i]);
    if (by_pieces != hashes[i])
      fprintf(stderr, "scene %d, picture %d\n", scene, i);
    CHECK(by_pieces == hashes[i]);
    for (int k = 0; k < i; k++)
      CHECK(hashes[k] != hashes[i]);
  }
  conic_renderer_destroy(p.renderer);
  conic_source_close(p.source);
}

/* The image's planes are what is drawn, and nothing of the others shows. */
static void test_planes(conic_context *context) {
  conic_source *source = shot_open(context, SHOT_MESH);
  conic_renderer *renderer;
  uint64_t hashes[2] = {0, 1};
  CHECK_OK(conic_renderer_create(context, &renderer));
  for (int i = 0; i < 2; i++) {
    conic_shot shot = shot_of(source, CONIC_CAMERA_PERSPECTIVE, WIDTH, HEIGHT);
    conic_image image;
    shot.light.has_shadows = 1;
    shot.render.lighting.n_lights = 1;
    shot.render.lighting.lights[0] = (conic_light){.direction = {0.3f, 1.0f, 0.2f}, .color = {1.0f, 1.0f, 1.0f}};
    CHECK_OK(conic_image_allocate(context, WIDTH, HEIGHT, i ? SHADOW | POSITION | RGBA : SHADOW, &image));
    CHECK_OK(conic_shot_draw(source, renderer, &shot, &image, NULL));
    hashes[i] = conic_image_hash(&image, CONIC_PLANE_SHADOW);
    CHECK(conic_image_planes(&image) == (i ? SHADOW | POSITION | RGBA : SHADOW));
    conic_image_release(context, &image);
  }
  CHECK(hashes[0] == hashes[1]);
  conic_renderer_destroy(renderer);
  conic_source_close(source);
}

/* --- plans --- */

typedef struct plan_case {
  int scene;
  conic_camera_kind kind;
  uint64_t n_samples;
  int n_directions;
  unsigned planes;
  double aperture;
  conic_shot_plan plan;
} plan_case;

static const plan_case plan_cases[] = {
    {SHOT_SPLATS, CONIC_CAMERA_PERSPECTIVE, 0, 0, RGBA, 0.0, {0, 0, CONIC_LIT_NOT, RGBA, 1}},
    {SHOT_LAYERS, CONIC_CAMERA_PERSPECTIVE, 0, 0, RGBA | ID, 0.0, {0, 0, CONIC_LIT_NOT, RGBA | ID, 1}},
    {SHOT_MESH, CONIC_CAMERA_PERSPECTIVE, 0, 0, POSITION, 0.0, {0, 0, CONIC_LIT_NOT, POSITION | Z, 1}},
    {SHOT_MESH, CONIC_CAMERA_PERSPECTIVE, 0, 8, RGBA, 0.0, {0, 0, CONIC_LIT_WHOLE, RGBA | Z | NORMAL | ALBEDO, 1}},
    {SHOT_MESH, CONIC_CAMERA_PERSPECTIVE, 0, 8, Z, 0.0, {0, 0, CONIC_LIT_WHOLE, Z | NORMAL, 1}},
    {SHOT_MESH, CONIC_CAMERA_FISHEYE, 0, 0, RGBA, 0.0, {0, 1, CONIC_LIT_NOT, RGBA, 1}},
    {SHOT_MESH, CONIC_CAMERA_FISHEYE, 0, 8, RGBA, 0.0, {0, 1, CONIC_LIT_WHOLE, RGBA | Z | NORMAL | ALBEDO, 1}},
    {SHOT_MESH, CONIC_CAMERA_CUBE, 0, 8, RGBA, 0.0, {0, 1, CONIC_LIT_BY_VIEW, RGBA | Z | NORMAL | ALBEDO, 1}},
    {SHOT_MESH, CONIC_CAMERA_PERSPECTIVE, 4, 0, RGBA, 0.0, {1, 0, CONIC_LIT_NOT, RGBA, 1}},
    {SHOT_MESH, CONIC_CAMERA_PERSPECTIVE, 4, 0, RGBA, 0.1, {1, 0, CONIC_LIT_NOT, RGBA | Z, 1}},
    {SHOT_MESH, CONIC_CAMERA_PERSPECTIVE, 4, 8, RGBA, 0.0, {1, 0, CONIC_LIT_BY_SAMPLE, RGBA | Z | NORMAL | ALBEDO, 1}},
    {SHOT_MESH, CONIC_CAMERA_FISHEYE, 4, 8, RGBA, 0.0, {1, 1, CONIC_LIT_BY_VIEW, RGBA | Z | NORMAL | ALBEDO, 1}},
    {SHOT_GAUSSIANS, CONIC_CAMERA_PERSPECTIVE, 0, 0, RGBA | T, 0.0, {0, 0, CONIC_LIT_NOT, RGBA | T, 1}},
    {SHOT_GAUSSIANS, CONIC_CAMERA_FISHEYE, 0, 0, RGBA, 0.0, {0, 0, CONIC_LIT_NOT, RGBA, 1}},
    {SHOT_GAUSSIANS, CONIC_CAMERA_CUBE, 0, 0, RGBA, 0.0, {0, 1, CONIC_LIT_NOT, RGBA, 1}},
    {SHOT_GAUSSIANS, CONIC_CAMERA_FISHEYE, 4, 0, RGBA, 0.1, {1, 1, CONIC_LIT_NOT, RGBA | Z, 1}}};

static void test_plans(conic_context *context) {
  conic_source *sources[SHOT_N_SCENES];
  conic_renderer *renderer;
  CHECK_OK(conic_renderer_create(context, &renderer));
  for (int scene = 0; scene < SHOT_N_SCENES; scene++)
    sources[scene] = shot_open(context, scene);
  for (size_t i = 0; i < sizeof plan_cases / sizeof *plan_cases; i++) {
    const plan_case *c = &plan_cases[i];
    conic_shot_plan plan;
    conic_shot shot = shot_of(sources[c->scene], c->kind, WIDTH, c->kind == CONIC_CAMERA_CUBE ? 6 * WIDTH : HEIGHT);
    shot.n_samples = c->n_samples;
    shot.light.n_directions = (uint64_t)c->n_directions;
    shot.planes = c->planes;
    shot.aperture.diameter = c->aperture;
    CHECK_OK(conic_shot_plan_make(sources[c->scene], renderer, &shot, &plan));
    int is_right = plan.is_accumulated == c->plan.is_accumulated && plan.is_gathered == c->plan.is_gathered &&
                   plan.lit == c->plan.lit && plan.planes == c->plan.planes && plan.has_windows == c->plan.has_windows;
    if (!is_right)
      fprintf(stderr, "plan %zu: %d %d %d %x %d\n", i, plan.is_accumulated, plan.is_gathered, (int)plan.lit,
              plan.planes, plan.has_windows);
    CHECK(is_right);
  }
  for (int scene = 0; scene < SHOT_N_SCENES; scene++)
    conic_source_close(sources[scene]);
  conic_renderer_destroy(renderer);
}

/* --- what cannot be --- */

static void expect_fault(conic_source *source, conic_renderer *renderer, const conic_shot *shot, const char *text) {
  conic_image image;
  CHECK_OK(conic_image_allocate(source->context, shot->camera.width, shot->camera.height, shot->planes, &image));
  files_message[0] = 0;
  CHECK(conic_shot_draw(source, renderer, shot, &image, NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(strstr(files_message, text));
  if (!strstr(files_message, text))
    fprintf(stderr, "'%s' lacks '%s'\n", files_message, text);
  conic_image_release(source->context, &image);
}

static void test_faults(conic_context *context) {
  conic_source *mesh = shot_open(context, SHOT_MESH), *gaussians = shot_open(context, SHOT_GAUSSIANS);
  conic_renderer *renderer;
  CHECK_OK(conic_renderer_create(context, &renderer));
  const conic_shot plain = shot_of(mesh, CONIC_CAMERA_PERSPECTIVE, WIDTH, HEIGHT);
  conic_shot shot = plain;
  shot.size = 0;
  expect_fault(mesh, renderer, &shot, "not initialised");
  shot = plain;
  shot.light.n_lamps = CONIC_MAX_LAMPS + 1;
  expect_fault(mesh, renderer, &shot, "lamps");
  shot = plain;
  shot.n_samples = (uint64_t)CONIC_MAX_ACCUMULATED + 1;
  expect_fault(mesh, renderer, &shot, "more samples");
  shot = plain;
  shot.n_samples = 4;
  shot.view.samples = 2;
  expect_fault(mesh, renderer, &shot, "view.samples");
  shot = plain;
  shot.planes |= SAMPLES;
  expect_fault(mesh, renderer, &shot, "of means");
  shot = plain;
  shot.aperture.diameter = 0.1;
  expect_fault(mesh, renderer, &shot, "n_samples");
  shot = plain;
  shot.is_shutter_open = 1;
  expect_fault(mesh, renderer, &shot, "n_samples");
  shot = plain;
  shot.planes |= T;
  expect_fault(mesh, renderer, &shot, "Gaussians");
  shot = plain;
  shot.planes |= CLUSTER;
  expect_fault(mesh, renderer, &shot, "hybrids");
  shot = plain;
  shot.light.n_directions = 4;
  expect_fault(gaussians, renderer, &shot, "Gaussians");
  conic_image image;
  CHECK_OK(conic_image_allocate(context, WIDTH + 1, HEIGHT, RGBA, &image));
  CHECK(conic_shot_draw(mesh, renderer, &plain, &image, NULL) == CONIC_ERROR_ARGUMENT);
  conic_image_release(context, &image);
  conic_renderer_destroy(renderer);
  conic_source_close(gaussians);
  conic_source_close(mesh);
}

int main(void) {
  conic_context *context = files_context();
  shot_write_scenes(context);
  test_pieces(context, SHOT_MESH);
  test_pieces(context, SHOT_SPLATS);
  test_planes(context);
  test_plans(context);
  test_faults(context);
  for (int i = 0; i < SHOT_N_SCENES; i++)
    remove(shot_paths[i]);
  files_end(context);
  return check_result();
}
