/* On an OpenCL device, pictures of triangles, alone and together with splats, are those of the CPU, in every bit of
 * every plane: large and smaller than a pixel, clipped, culled, with all attributes and none, by tiles and by pixels.
 */
#include "opencl/opencl_renderer.h"
#include "tests/support/opencl_fixture.h"
#include "tests/support/triangle_fixture.h"

enum { N_RENDERERS = 4 };

/* Ways to draw the same. */
typedef struct way {
  const char *name;
  conic_opencl_work work;
  int projects_on_host;
  size_t part_splats;
} way;

static const way ways[N_RENDERERS] = {{"tiles", CONIC_OPENCL_WORK_TILES, 0, 0},
                                      {"pixels", CONIC_OPENCL_WORK_PIXELS, 0, 0},
                                      {"tiles, in parts", CONIC_OPENCL_WORK_TILES, 0, 301},
                                      {"pixels, by the host, in parts", CONIC_OPENCL_WORK_PIXELS, 1, 400}};

static conic_renderer *renderers[N_RENDERERS];

/* With `simulates` also on a device that does not say that it rounds correctly, as a simulator may. */
static void open_renderers(conic_context *context, int simulates) {
  for (int i = 0; i < (simulates ? 2 : N_RENDERERS); i++) {
    conic_opencl_options options;
    conic_opencl_options_init(&options);
    options.allow_inexact = simulates;
    options.work = ways[i].work;
    options.projects_on_host = ways[i].projects_on_host;
    options.part_splats = ways[i].part_splats;
    CHECK_OK(conic_opencl_renderer_create(context, &options, NULL, &renderers[i]));
  }
}

static void check_counts(const conic_render_statistics *a, const conic_render_statistics *b) {
  CHECK(a->splats_drawn == b->splats_drawn && a->splats_culled == b->splats_culled);
  CHECK(a->fragments == b->fragments && a->pixels_covered == b->pixels_covered);
  CHECK(a->triangles_in == b->triangles_in && a->triangles_culled == b->triangles_culled);
  CHECK(a->triangles_skipped == b->triangles_skipped && a->triangles_drawn == b->triangles_drawn);
  CHECK(a->triangle_fragments == b->triangle_fragments && a->near_z == b->near_z);
}

/* Fills the planes with what nothing draws, so that what is not drawn differs. */
static void spoil(conic_image *image) {
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    if (image->planes[plane])
      memset(image->planes[plane], 0x5a,
             (size_t)image->width * (size_t)image->height * 4 *
                 (size_t)conic_plane_describe((conic_plane)plane)->n_channels);
}

/* Draws the fixture's splats and the triangles on the CPU and in all ways on the device, blended and not. */
static void compare(fixture *f, const conic_triangles *t, int samples, const char *scene) {
  conic_image image;
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &image));
  const conic_drawing drawing = {f->splats.count ? &f->splats : NULL, t};
  for (int passes = 1; passes <= 3; passes += 2) {
    f->options.passes = passes;
    CHECK_OK(triangles_render(f, t, samples));
    for (int i = 0; i < N_RENDERERS && renderers[i]; i++) {
      conic_render_statistics statistics;
      char what[160];
      snprintf(what, sizeof what, "%s, %zu splats, passes %d: %s", scene, f->splats.count, passes, ways[i].name);
      spoil(&image);
      CHECK_OK(conic_render_drawing(f->context, renderers[i], &drawing, &f->camera, &f->options, samples, &image,
                                    &statistics));
      CHECK(opencl_same(&f->image, &image, what));
      check_counts(&f->statistics, &statistics);
    }
  }
  conic_image_release(f->context, &image);
}

/* How many pixels show a triangle, by the last picture of the CPU. */
static size_t triangle_pixels(const fixture *f) {
  const uint32_t *ids = f->image.planes[CONIC_PLANE_ID];
  size_t n = 0;
  for (size_t i = 0; i < (size_t)f->image.width * (size_t)f->image.height; i++)
    n += ids[i] != CONIC_NO_ID && ids[i] >= f->splats.count;
  return n;
}

static conic_texture *make_texture(fixture *f, int width, int height, conic_texture_wrap wrap) {
  conic_image image;
  conic_texture *texture;
  CHECK_OK(conic_image_allocate(f->context, width, height, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (int i = 0; i < width * height; i++)
    for (int channel = 0; channel < 4; channel++)
      rgba[4 * i + channel] = channel == 3 ? 1.0f : (float)((i * 7 + channel * 5) % 11) / 11.0f;
  CHECK_OK(conic_texture_create(f->context, &image, wrap, &texture));
  conic_image_release(f->context, &image);
  return texture;
}

/* Triangles of all sizes around and behind the camera, with the attributes of `fields`; one is not finite. */
static conic_triangles fill_wild(fixture *f, size_t count, unsigned fields) {
  conic_triangles t = triangles_make(f, count, 3 * count, fields);
  uint64_t state = 3;
  for (size_t i = 0; i < count; i++) {
    double size = pow(10.0, 0.4 - 3.0 * fixture_random(&state)), center[3];
    for (int axis = 0; axis < 3; axis++)
      center[axis] = 3.0 * (fixture_random(&state) - 0.5) + (axis == 2 ? 1.5 : 0.0);
    for (size_t k = 3 * i; k < 3 * i + 3; k++) {
      for (int axis = 0; axis < 3; axis++) {
        t.position[axis][k] = (float)(center[axis] + size * (fixture_random(&state) - 0.5));
        if (t.color[0])
          t.color[axis][k] = any_value(&state, 2.0, 0.01);
        if (t.normal[0])
          t.normal[axis][k] = any_value(&state, 1.0, 0.01);
      }
      for (int axis = 0; axis < 2 && t.texture_coordinate[0]; axis++)
        t.texture_coordinate[axis][k] = any_value(&state, 4.0, 0.01);
    }
    triangles_corner(&t, i, (uint32_t)(3 * i), (uint32_t)(3 * i + 1), (uint32_t)(3 * i + 2));
  }
  t.position[0][5] = NAN;
  return t;
}

/* Gives the set three materials: two share a texture, one has none; and attributes indices of their own. */
static void add_materials(fixture *f, conic_triangles *t, conic_material materials[4], uint32_t (*corners)[3],
                          uint32_t *material) {
  materials[0] = (conic_material){{1.0f, 0.5f, 0.25f}, make_texture(f, 37, 20, CONIC_WRAP_REPEAT)};
  materials[1] = (conic_material){{0.5f, 1.0f, 1.5f}, NULL};
  materials[2] = (conic_material){{0.75f, 0.25f, 1.0f}, materials[0].texture};
  materials[3] = (conic_material){{1.0f, 1.0f, 1.0f}, make_texture(f, 5, 64, CONIC_WRAP_CLAMP)};
  for (size_t i = 0; i < t->count; i++) {
    material[i] = (uint32_t)((i + i / 3) % 4);
    for (int k = 0; k < 3; k++)
      corners[i][k] = t->corners[t->count - 1 - i][2 - k];
  }
  t->n_materials = 4;
  t->materials = materials;
  t->material = material;
  t->n_normals = t->n_texture_coordinates = t->n_vertices;
  t->normal_corners = t->texture_corners = corners;
}

static void drop_materials(conic_triangles *t) {
  conic_texture_destroy(t->materials[0].texture);
  conic_texture_destroy(t->materials[3].texture);
  t->n_materials = 0;
  t->materials = NULL;
  t->material = NULL;
  t->normal_corners = t->texture_corners = NULL;
}

/* Options as they come, by number. */
static void vary(fixture *f, int number) {
  choose(f, number * 5 + 1);
  f->options.cull_back = number % 4 == 3;
  f->options.near_z = 0.05;
  f->options.light[0] = 1.0;
  f->options.light[1] = 2.0;
  f->options.exposure = number % 2 ? 0.5 : 0.0;
}

/* The variants first … end - 1. */
static void check_wild(fixture *f, size_t count, size_t n_splats, int first, int end) {
  static const unsigned fields[4] = {
      0, CONIC_TRIANGLES_COLORS, CONIC_TRIANGLES_NORMALS | CONIC_TRIANGLES_TEXTURE_COORDINATES,
      CONIC_TRIANGLES_COLORS | CONIC_TRIANGLES_NORMALS | CONIC_TRIANGLES_TEXTURE_COORDINATES};
  uint32_t(*corners)[3] = calloc(count, sizeof *corners), *material = calloc(count, sizeof *material);
  uint64_t state = 7;
  size_t n_seen = 0;
  for (int number = first; number < end && corners && material; number++) {
    conic_material materials[4];
    conic_triangles t = fill_wild(f, count, fields[number % 4]);
    if (t.normal[0])
      add_materials(f, &t, materials, corners, material);
    vary(f, number);
    f->splats.count = 0;
    compare(f, &t, 1, "wild");
    n_seen += triangle_pixels(f);
    fill(f, &state, 2.0, number % 2 ? 0.01 : 0.0);
    f->splats.count = n_splats;
    compare(f, &t, 1, "wild");
    n_seen += triangle_pixels(f);
    if (t.materials)
      drop_materials(&t);
    conic_triangles_release(f->context, &t);
  }
  printf("wild: %zu pixels show a triangle\n", n_seen);
  CHECK(n_seen > 10 * (size_t)(end - first));
  free(corners);
  free(material);
}

/* A closed mesh of triangles smaller than a pixel, shell in shell with splats so that the two blend. */
static void check_fine(fixture *f) {
  conic_triangles t = triangles_torus(f, 200, 70, 0.3);
  fixture_scene(f, CONIC_SCENE_TORUS, 1500);
  triangles_camera(f, 9, 70);
  conic_render_options_init(&f->options);
  f->options.cull_back = 1;
  compare(f, &t, 1, "fine");
  CHECK(f->statistics.triangle_fragments > 500);
  f->options.epsilon = 10.0; /* nothing hides anything */
  compare(f, &t, 1, "fine, all blend");
  f->options.epsilon = 0.0;
  compare(f, &t, 2, "fine, samples");
  conic_triangles_release(f->context, &t);
}

/* A floor on which the camera stands: some of it reaches near, some the guard band, and some triangles fill tiles. */
static void check_floor(fixture *f) {
  conic_triangles t = triangles_make(f, 3, 5, CONIC_TRIANGLES_COLORS);
  for (size_t i = 0; i < 5; i++) {
    static const double places[5][3] = {
        {-900, 0.001, -900}, {900, 0.001, -900}, {900, 0.001, 900}, {-900, 0.001, 900}, {0, -500, 900}};
    triangles_vertex(&t, i, places[i][0], places[i][1], places[i][2]);
    for (int channel = 0; channel < 3; channel++)
      t.color[channel][i] = (float)((i + (size_t)channel) % 3) * 0.5f;
  }
  triangles_corner(&t, 0, 0, 2, 1);
  triangles_corner(&t, 1, 0, 3, 2);
  triangles_corner(&t, 2, 2, 3, 4);
  fixture_camera(f, 131, 97, 70.0);
  conic_render_options_init(&f->options);
  f->options.near_z = 1e-5;
  f->splats.count = 0;
  compare(f, &t, 1, "floor");
  CHECK(triangle_pixels(f) > 6000);
  f->options.near_z = 0.003;
  compare(f, &t, 1, "floor cut by near");
  conic_triangles_release(f->context, &t);
}

/* Corners in the very centres of pixels, so that samples have their depths, as far as rounding does not leave them. */
static void check_corners(fixture *f) {
  enum { N = 24 };
  conic_triangles t = triangles_make(f, 2 * N * N, (N + 1) * (N + 1), CONIC_TRIANGLES_COLORS);
  uint64_t state = 17;
  fixture_camera(f, 3 * N + 1, 3 * N + 1, 64.0);
  for (uint32_t i = 0; i <= N; i++)
    for (uint32_t j = 0; j <= N; j++) {
      double z = pow(10.0, 2.0 * fixture_random(&state)), x = 3.0 * i + 0.5, y = 3.0 * j + 0.5;
      uint32_t here = i * (N + 1) + j, cell = i * N + j;
      triangles_vertex(&t, here, (x - f->camera.cx) / 64.0 * z, (y - f->camera.cy) / 64.0 * z, z);
      for (int channel = 0; channel < 3; channel++)
        t.color[channel][here] = (float)fixture_random(&state);
      if (i == N || j == N)
        continue;
      triangles_corner(&t, 2 * cell, here, here + 1, here + N + 2);
      triangles_corner(&t, 2 * cell + 1, here, here + N + 2, here + N + 1);
    }
  conic_render_options_init(&f->options);
  f->splats.count = 0;
  compare(f, &t, 1, "corners");
  CHECK(triangle_pixels(f) == 9 * N * N);
  conic_triangles_release(f->context, &t);
}

/* Single planes; and splats alone again, after triangles have gone through the same renderer. */
static void check_planes(fixture *f) {
  conic_triangles t = fill_wild(f, 200, CONIC_TRIANGLES_COLORS);
  conic_image image;
  fixture_scene(f, CONIC_SCENE_KNOT, 900);
  fixture_camera(f, 90, 70, 60.0);
  f->camera.cam_from_world[2][3] = 2.5;
  const conic_drawing drawing = {&f->splats, &t};
  for (int passes = 1; passes <= 3; passes += 2) {
    conic_render_options_init(&f->options);
    f->options.passes = passes;
    CHECK_OK(triangles_render(f, &t, 1));
    for (int i = 0; i < 2; i++)
      for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++) {
        CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, 1u << plane, &image));
        spoil(&image);
        CHECK_OK(conic_render_drawing(f->context, renderers[i], &drawing, &f->camera, &f->options, 1, &image, NULL));
        CHECK(conic_image_hash(&image, (conic_plane)plane) == conic_image_hash(&f->image, (conic_plane)plane));
        conic_image_release(f->context, &image);
      }
    fixture_render(f);
    CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &image));
    for (int i = 0; i < N_RENDERERS; i++) {
      CHECK_OK(conic_render(renderers[i], &f->splats, &f->camera, &f->options, &image, NULL));
      CHECK(opencl_same(&f->image, &image, "splats alone, afterwards"));
    }
    conic_image_release(f->context, &image);
  }
  conic_triangles_release(f->context, &t);
}

/* The pass of hiding, of both kinds and of each alone. */
static void check_hiding(fixture *f) {
  conic_triangles t = fill_wild(f, 200, 0);
  conic_image here, there;
  fixture_scene(f, CONIC_SCENE_KNOT, 900);
  fixture_camera(f, 90, 70, 60.0);
  f->camera.cam_from_world[2][3] = 2.5;
  const conic_drawing drawings[3] = {{&f->splats, &t}, {&f->splats, NULL}, {NULL, &t}};
  conic_render_options_init(&f->options);
  f->options.passes = CONIC_PASS_OF_HIDING;
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, 1u << CONIC_PLANE_Z, &here));
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, 1u << CONIC_PLANE_Z, &there));
  for (int i = 0; i < 3; i++) {
    CHECK_OK(conic_render_drawing(f->context, f->renderer, &drawings[i], &f->camera, &f->options, 1, &here, NULL));
    for (int k = 0; k < N_RENDERERS && renderers[k]; k++) {
      spoil(&there);
      CHECK_OK(conic_render_drawing(f->context, renderers[k], &drawings[i], &f->camera, &f->options, 1, &there, NULL));
      CHECK(conic_image_hash(&here, CONIC_PLANE_Z) == conic_image_hash(&there, CONIC_PLANE_Z));
    }
  }
  conic_image_release(f->context, &here);
  conic_image_release(f->context, &there);
  conic_triangles_release(f->context, &t);
}

/* A device that has no double precision says so, and so does one that cannot hold the triangles. One that is no CPU
 * gets copies of them. */
static void check_devices(fixture *f, conic_opencl_work work) {
  conic_triangles t =
      fill_wild(f, 2000, CONIC_TRIANGLES_COLORS | CONIC_TRIANGLES_NORMALS | CONIC_TRIANGLES_TEXTURE_COORDINATES);
  const conic_drawing drawing = {&f->splats, &t};
  conic_opencl_options options;
  conic_opencl *opencl;
  conic_renderer *renderer;
  conic_image image;
  conic_opencl_options_init(&options);
  options.work = work;
  CHECK_OK(conic_opencl_open(f->context, &options, &opencl));
  CHECK_OK(conic_renderer_create(f->context, &renderer));
  conic_renderer_take(renderer, &opencl->backend);
  triangles_camera(f, 3, 40);
  conic_render_options_init(&f->options);
  CHECK_OK(triangles_render(f, &t, 1));
  uint64_t memory_bytes = opencl->device.memory_bytes;
  opencl->device.has_double = 0;
  CHECK(conic_render_drawing(f->context, renderer, &drawing, &f->camera, &f->options, 1, &f->image, NULL) ==
        CONIC_ERROR_UNSUPPORTED);
  opencl->device.has_double = 1;
  opencl->device.memory_bytes = 1 << 16;
  CHECK(conic_render_drawing(f->context, renderer, &drawing, &f->camera, &f->options, 1, &f->image, NULL) ==
        CONIC_ERROR_MEMORY);
  opencl->device.memory_bytes = memory_bytes;
  opencl->device.is_cpu = 0;
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &image));
  spoil(&image);
  CHECK_OK(conic_render_drawing(f->context, renderer, &drawing, &f->camera, &f->options, 1, &image, NULL));
  CHECK(opencl_same(&f->image, &image, "no CPU"));
  conic_image_release(f->context, &image);
  conic_renderer_destroy(renderer);
  conic_triangles_release(f->context, &t);
}

/* FOLDER, or FOLDER small: for a simulator (scripts/oclgrind) */
int main(int argc, char **argv) {
  fixture f = fixture_open(2);
  int is_small = argc > 2 && strcmp(argv[2], "small") == 0;
  opencl_need_device(f.context);
  open_renderers(f.context, is_small);
  if (is_small) {
    fixture_camera(&f, 19, 18, 15.0);
    check_wild(&f, 24, 30, 2, 4);
  } else {
    fixture_camera(&f, 118, 90, 70.0);
    check_wild(&f, 600, 800, 0, 8);
    check_fine(&f);
    check_floor(&f);
    check_corners(&f);
    check_planes(&f);
    check_hiding(&f);
    check_devices(&f, CONIC_OPENCL_WORK_TILES);
    check_devices(&f, CONIC_OPENCL_WORK_PIXELS);
  }
  for (int i = 0; i < N_RENDERERS; i++)
    conic_renderer_destroy(renderers[i]);
  fixture_close(&f);
  return check_result();
}
