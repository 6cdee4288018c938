/* What lets light through: against closed forms, against the picture without, and against itself in other orders. */
#include "tests/support/triangle_fixture.h"

enum { SIZE = 48 };

static void draw_as(fixture *f, const conic_triangles *triangles, conic_transparency how, double chance, int samples) {
  const conic_drawing drawing = {f->splats.count ? &f->splats : NULL, triangles};
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &f->image));
  CHECK_OK(conic_render_transparent(f->context, f->renderer, &drawing, &f->camera, &f->options, how, chance, samples,
                                    &f->image, &f->statistics));
}

static void draw(fixture *f, const conic_triangles *triangles) {
  draw_as(f, triangles, CONIC_TRANSPARENCY_LAYERS, 0.0, 1);
}

static void copy_image(fixture *f, conic_image *copy) {
  *copy = f->image;
  memset(&f->image, 0, sizeof f->image);
}

static int is_same(const conic_image *a, const conic_image *b) {
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (a->planes[i] && memcmp(a->planes[i], b->planes[i],
                               4 * (size_t)conic_plane_describe((conic_plane)i)->n_channels * (size_t)a->width *
                                   (size_t)a->height) != 0)
      return 0;
  return 1;
}

/* The greatest difference of rgba. */
static double distance(const conic_image *a, const conic_image *b) {
  const float *first = a->planes[CONIC_PLANE_RGBA], *second = b->planes[CONIC_PLANE_RGBA];
  double most = 0.0;
  for (size_t i = 0; i < 4 * (size_t)a->width * (size_t)a->height; i++)
    most = fmax(most, fabs((double)first[i] - (double)second[i]));
  return most;
}

/* --- parallel planes --- */

typedef struct layer {
  double z;
  float opacity, color[3];
} layer;

static const layer layers[] = {
    {4.0, 0.25f, {0.1f, 0.9f, 0.4f}}, {3.0, 0.5f, {0.8f, 0.2f, 0.3f}}, {5.0, 1.0f, {0.3f, 0.3f, 0.7f}}};
static const int front_to_back[] = {1, 0, 2};

/* Splats of the layers that are named, side by side in the file. */
static void fill_planes(fixture *f, const int *which, int n_layers) {
  enum { EDGE = 25 };
  size_t n = (size_t)n_layers * EDGE * EDGE;
  conic_splats_release(f->context, &f->splats);
  CHECK_OK(conic_splats_allocate(f->context, n, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES,
                                 &f->splats));
  for (size_t i = 0; i < n; i++) {
    const layer *from = &layers[which[i % (size_t)n_layers]];
    size_t at = i / (size_t)n_layers;
    double step = 0.06 * from->z, column = (double)(at % EDGE) - EDGE / 2, row = (double)(at / EDGE) - EDGE / 2;
    fixture_set(f, i, (const double[3]){step * column, step * row, from->z}, (const double[3]){step, 0, 0},
                (const double[3]){0, step, 0}, from->color[0], from->color[1], from->color[2]);
    f->splats.opacity[i] = from->opacity;
  }
}

static conic_triangles make_quads(fixture *f, const int *which, int n) {
  conic_triangles t = triangles_make(f, 2 * (size_t)n, 4 * (size_t)n, CONIC_TRIANGLES_COLORS);
  t.n_materials = (size_t)n;
  t.materials = calloc((size_t)n, sizeof *t.materials);
  t.material = calloc(2 * (size_t)n, sizeof *t.material);
  for (uint32_t i = 0; i < (uint32_t)n; i++) {
    const layer *from = &layers[which[i]];
    for (uint32_t k = 0; k < 4; k++) {
      triangles_vertex(&t, 4 * i + k, (k % 2 ? 2.0 : -2.0) * from->z, (k / 2 ? 2.0 : -2.0) * from->z, from->z);
      for (int c = 0; c < 3; c++)
        t.color[c][4 * i + k] = from->color[c];
    }
    triangles_corner(&t, 2 * i, 4 * i, 4 * i + 1, 4 * i + 2);
    triangles_corner(&t, 2 * i + 1, 4 * i + 1, 4 * i + 3, 4 * i + 2);
    t.materials[i] = (conic_material){.color = {1, 1, 1}, .transparency = 1.0f - from->opacity};
    t.material[2 * i] = t.material[2 * i + 1] = i;
  }
  return t;
}

static void release_quads(fixture *f, conic_triangles *t) {
  free(t->materials);
  free(t->material);
  t->materials = NULL;
  t->material = NULL;
  t->n_materials = 0;
  conic_triangles_release(f->context, t);
}

/* n layers from the front, in every pixel, over a background of brightness `behind`. */
static void check_layers(const fixture *f, int n, double behind) {
  double rgb[3] = {0, 0, 0}, light = 1.0;
  for (int i = 0; i < n; i++) {
    const layer *l = &layers[front_to_back[i]];
    for (int c = 0; c < 3; c++)
      rgb[c] += light * (double)l->opacity * (double)l->color[c];
    light *= 1.0 - (double)l->opacity;
  }
  for (int i = 0; i < SIZE * SIZE; i++) {
    const float *rgba = fixture_pixel(f, CONIC_PLANE_RGBA, i % SIZE, i / SIZE);
    const float *albedo = fixture_pixel(f, CONIC_PLANE_ALBEDO, i % SIZE, i / SIZE);
    for (int c = 0; c < 3; c++) {
      CHECK_NEAR((double)rgba[c], rgb[c] + light * behind, 1e-6);
      CHECK_NEAR((double)albedo[c], rgb[c], 1e-6);
    }
    CHECK_NEAR((double)rgba[3], behind > 0.0 ? 1.0 : 1.0 - light, 1e-7);
    CHECK_NEAR((double)*fixture_pixel(f, CONIC_PLANE_Z, i % SIZE, i / SIZE), layers[1].z, 1e-5);
    CHECK_NEAR((double)fixture_pixel(f, CONIC_PLANE_NORMAL, i % SIZE, i / SIZE)[2], -1.0, 1e-6);
  }
}

static void test_planes(fixture *f) {
  static const int all[] = {0, 1, 2};
  conic_image forwards;
  for (int n = 1; n <= 3; n++) {
    const int one[] = {1};
    fill_planes(f, n == 1 ? one : all, n);
    draw(f, NULL);
    check_layers(f, n, 0.0);
    CHECK(fixture_index(f, CONIC_PLANE_ID, 20, 20) % (uint32_t)n == (n == 1 ? 0u : 1u));
    conic_triangles quads = make_quads(f, n == 1 ? one : all, n);
    f->splats.count = 0;
    draw(f, &quads);
    check_layers(f, n, 0.0);
    CHECK(fixture_index(f, CONIC_PLANE_ID, 20, 20) / 2 == (n == 1 ? 0u : 1u));
    release_quads(f, &quads);
  }
  fill_planes(f, all, 2);
  f->options.has_background = 1;
  f->options.background[0] = f->options.background[1] = f->options.background[2] = 0.4f;
  draw_as(f, NULL, CONIC_TRANSPARENCY_LAYERS, 0.0, 2);
  check_layers(f, 2, (double)0.4f);
  f->options.has_background = 0;
  fill_planes(f, all, 3);
  draw(f, NULL);
  copy_image(f, &forwards);
  fill_planes(f, (const int[]){2, 1, 0}, 3);
  draw(f, NULL);
  CHECK(distance(&forwards, &f->image) <= 1e-6);
  conic_image_release(f->context, &forwards);
}

/* Splats before and behind triangles. */
static void test_mixed(fixture *f) {
  conic_triangles quad = make_quads(f, (const int[]){0}, 1);
  fill_planes(f, (const int[]){1, 2}, 2);
  draw(f, &quad);
  check_layers(f, 3, 0.0);
  release_quads(f, &quad);
  quad = make_quads(f, (const int[]){1}, 1);
  fill_planes(f, (const int[]){2, 0}, 2);
  draw(f, &quad);
  check_layers(f, 3, 0.0);
  release_quads(f, &quad);
}

/* A surface's opacity is the mean of its splats': what the picture shows of these as a colour. */
static void test_mean(fixture *f) {
  uint64_t state = 11;
  double most = 0.0;
  fill_planes(f, (const int[]){1}, 1);
  for (size_t i = 0; i < f->splats.count; i++)
    f->splats.opacity[i] = f->splats.color[0][i] = (float)fixture_random(&state);
  draw(f, NULL);
  float *alpha = malloc(SIZE * SIZE * sizeof *alpha);
  for (int i = 0; i < SIZE * SIZE; i++)
    alpha[i] = fixture_pixel(f, CONIC_PLANE_RGBA, i % SIZE, i / SIZE)[3];
  float *opacity = f->splats.opacity;
  f->splats.opacity = NULL;
  fixture_render(f);
  f->splats.opacity = opacity;
  for (int i = 0; i < SIZE * SIZE; i++)
    most = fmax(most, fabs((double)alpha[i] - (double)*fixture_pixel(f, CONIC_PLANE_ALBEDO, i % SIZE, i / SIZE)));
  CHECK(most < 2e-7);
  free(alpha);
}

/* --- shells --- */

static void fill_sphere(fixture *f, float opacity) {
  fixture_scene(f, CONIC_SCENE_SPHERE, 8000);
  float *opacities = f->splats.opacity;
  CHECK(!opacities);
  f->splats.opacity = malloc(f->splats.count * sizeof *opacities);
  for (size_t i = 0; i < f->splats.count; i++)
    f->splats.opacity[i] = opacity;
  f->camera.cam_from_world[2][3] = 4.0;
}

static void release_sphere(fixture *f) {
  free(f->splats.opacity);
  f->splats.opacity = NULL;
  f->camera.cam_from_world[2][3] = 0.0;
}

static void test_shell(fixture *f) {
  fill_sphere(f, 0.3f);
  draw(f, NULL);
  int n = 0;
  for (int y = SIZE / 2 - 6; y < SIZE / 2 + 6; y++)
    for (int x = SIZE / 2 - 6; x < SIZE / 2 + 6; x++)
      n += fabs((double)fixture_pixel(f, CONIC_PLANE_RGBA, x, y)[3] - 0.51) > 1e-6;
  CHECK(n == 0);
  release_sphere(f);
}

/* --- the picture without --- */

/* An opacity of 2 counts as 1, but takes the way of what is transparent, as a mask does that hides nothing. */
static void test_opaque(fixture *f, conic_method method, int with_triangles) {
  conic_image plain;
  f->options.method = method;
  f->options.epsilon = -1.0;
  f->options.shading = CONIC_SHADE_PHONG;
  fill_sphere(f, 1.0f);
  conic_triangles t = with_triangles ? triangles_wild(f, 300) : (conic_triangles){.count = 0};
  if (with_triangles)
    f->camera.cam_from_world[2][3] = 1.5;
  draw_as(f, &t, CONIC_TRANSPARENCY_NONE, 0.0, 1);
  copy_image(f, &plain);
  draw(f, &t);
  CHECK(is_same(&plain, &f->image));
  for (size_t i = 0; i < f->splats.count; i++)
    f->splats.opacity[i] = 2.0f;
  for (size_t i = 0; i < t.n_materials; i++) {
    t.materials[i].transparency = 0.5f;
    t.materials[i].alpha_mode = CONIC_ALPHA_MASK;
    t.materials[i].alpha_cutoff = 0.25f;
  }
  draw(f, &t);
  CHECK(is_same(&plain, &f->image));
  f->options.shading = CONIC_SHADE_NONE;
  f->options.epsilon = 0.3;
  f->options.method = CONIC_METHOD_AUTO;
  conic_image_release(f->context, &plain);
  conic_triangles_release(f->context, &t);
  release_sphere(f);
}

/* --- alpha of textures --- */

/* A quad of SIZE × SIZE pixels with stripes of `edge` pixels; every other one has alpha 0, and is of another colour. */
static conic_triangles make_card(fixture *f, uint32_t mode, int n_stripes) {
  static const layer card = {1.0, 1.0f, {1.0f, 1.0f, 1.0f}};
  conic_triangles t = triangles_make(f, 2, 4, CONIC_TRIANGLES_TEXTURE_COORDINATES);
  conic_image image;
  CHECK_OK(conic_image_allocate(f->context, n_stripes, n_stripes, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (int i = 0; i < n_stripes * n_stripes; i++) {
    const float texel[2][4] = {{0.25f, 0.5f, 0.75f, 1.0f}, {0.0f, 0.0f, 0.0f, 0.0f}};
    memcpy(rgba + 4 * i, texel[i % n_stripes % 2], sizeof texel[0]);
  }
  for (uint32_t k = 0; k < 4; k++) {
    double half = 0.5 * SIZE / f->camera.fx * card.z;
    triangles_vertex(&t, k, k % 2 ? half : -half, k / 2 ? half : -half, card.z);
    t.texture_coordinate[0][k] = (float)(k % 2);
    t.texture_coordinate[1][k] = (float)(k / 2);
  }
  triangles_corner(&t, 0, 0, 1, 2);
  triangles_corner(&t, 1, 1, 3, 2);
  conic_texture *texture;
  CHECK_OK(conic_texture_create(f->context, &image, CONIC_WRAP_CLAMP, &texture));
  CHECK(conic_texture_has_alpha(texture));
  CHECK_OK(conic_triangles_texture(f->context, &t, texture));
  conic_image_release(f->context, &image);
  t.materials[0].alpha_mode = mode;
  t.materials[0].alpha_cutoff = 0.5f;
  return t;
}

static void test_card(fixture *f, uint32_t mode) {
  enum { N_STRIPES = 4, EDGE = SIZE / N_STRIPES };
  conic_triangles t = make_card(f, mode, N_STRIPES);
  int n_wrong = 0, n_between = 0;
  f->splats.count = 0;
  draw(f, &t);
  for (int i = 0; i < SIZE * SIZE; i++) {
    const float *rgba = fixture_pixel(f, CONIC_PLANE_RGBA, i % SIZE, i / SIZE);
    int is_hole = i % SIZE / EDGE % 2;
    n_between += rgba[3] > 0.0f && rgba[3] < 1.0f;
    if (mode == CONIC_ALPHA_MASK)
      n_wrong += rgba[3] != (is_hole ? 0.0f : 1.0f);
    else if (mode == CONIC_ALPHA_OPAQUE)
      n_wrong += rgba[3] != 1.0f;
    else
      n_wrong += (rgba[3] < 0.5f) != is_hole;
    for (int c = 0; c < 3 && mode != CONIC_ALPHA_OPAQUE && rgba[3] > 0.0f; c++)
      CHECK_NEAR((double)rgba[c], 0.25 * (c + 1) * (double)rgba[3], 1e-6); /* nothing of the holes' black */
    CHECK((fixture_index(f, CONIC_PLANE_ID, i % SIZE, i / SIZE) == CONIC_NO_ID) == (rgba[3] == 0.0f));
  }
  CHECK(n_wrong == 0);
  CHECK((n_between > 0) == (mode == CONIC_ALPHA_BLEND));
  conic_triangles_release(f->context, &t);
}

/* --- alpha of vertices --- */

/* A floor under the eye, from behind it to z = 8, whose alpha goes from 0 to 1 along z; one face is wound the other
 * way. Before it all is cut off. */
static void test_vertex_alpha(fixture *f) {
  static const double from_z = -2.0, to_z = 8.0;
  conic_triangles t = triangles_make(f, 2, 4, CONIC_TRIANGLES_ALPHAS | CONIC_TRIANGLES_COLORS);
  conic_material material = {.color = {1, 1, 1}, .transparency = 0.5f};
  for (uint32_t k = 0; k < 4; k++) {
    triangles_vertex(&t, k, k % 2 ? 40.0 : -40.0, 1.0, k / 2 ? to_z : from_z);
    for (int c = 0; c < 3; c++)
      t.color[c][k] = 0.5f;
    t.alpha[k] = k / 2 ? 1.0f : 0.0f;
  }
  triangles_corner(&t, 0, 0, 1, 2);
  triangles_corner(&t, 1, 1, 2, 3);
  f->splats.count = 0;
  for (int kind = 0; kind < 4; kind++) {
    double factor = kind ? 0.5 : 1.0;
    t.materials = kind ? &material : NULL;
    t.n_materials = kind != 0;
    material.alpha_mode = kind == 2 ? CONIC_ALPHA_MASK : kind == 3 ? CONIC_ALPHA_OPAQUE : CONIC_ALPHA_BLEND;
    material.alpha_cutoff = 0.4f;
    CHECK(conic_drawing_is_transparent(&(conic_drawing){.triangles = &t}) == (kind != 3));
    draw(f, &t);
    for (int i = 0; i < SIZE * SIZE; i++) {
      double dy = (i / SIZE + 0.5 - f->camera.cy) / f->camera.fy, z = 1.0 / dy;
      double alpha = z > 0.1 && z < to_z ? factor * (z - from_z) / (to_z - from_z) : 0.0;
      const float *rgba = fixture_pixel(f, CONIC_PLANE_RGBA, i % SIZE, i / SIZE);
      if (kind == 2 && fabs(alpha - 0.4) < 1e-4)
        continue;
      double expected = kind < 2 || alpha == 0.0 ? alpha : kind == 3 || alpha > 0.4 ? 1.0 : 0.0;
      CHECK_NEAR((double)rgba[3], expected, 1e-5);
      CHECK_NEAR((double)rgba[1], 0.5 * expected, 1e-5);
    }
  }
  t.materials = NULL;
  t.n_materials = 0;
  conic_triangles_release(f->context, &t);
}

/* --- one surface a picture --- */

static void test_chance(fixture *f) {
  enum { N = 128 };
  static const int all[] = {0, 1};
  static double sum[SIZE * SIZE * 4];
  conic_image whole;
  fill_planes(f, all, 2);
  draw(f, NULL);
  copy_image(f, &whole);
  memset(sum, 0, sizeof sum);
  for (int k = 0; k < N; k++) {
    draw_as(f, NULL, CONIC_TRANSPARENCY_CHANCE, (k + 0.5) / N, 1);
    for (int i = 0; i < SIZE * SIZE; i++) {
      const float *rgba = fixture_pixel(f, CONIC_PLANE_RGBA, i % SIZE, i / SIZE);
      double z = (double)*fixture_pixel(f, CONIC_PLANE_Z, i % SIZE, i / SIZE);
      const layer *shown = z == 0.0 ? NULL : &layers[z < 3.5 ? 1 : 0];
      CHECK(rgba[3] == (shown ? 1.0f : 0.0f));
      for (int c = 0; c < 4; c++) {
        CHECK_NEAR((double)rgba[c], !shown ? 0.0 : c == 3 ? 1.0 : (double)shown->color[c], 1e-6);
        sum[4 * i + c] += (double)rgba[c] / N;
      }
    }
  }
  double most = 0.0;
  for (int i = 0; i < 4 * SIZE * SIZE; i++)
    most = fmax(most, fabs(sum[i] - (double)((const float *)whole.planes[CONIC_PLANE_RGBA])[i]));
  CHECK(most < 2.0 / N);
  conic_image_release(f->context, &whole);
}

/* --- the same bits --- */

static void test_bits(fixture *f) {
  static const int tiles[] = {8, 64};
  conic_image first;
  fill_sphere(f, 0.4f);
  for (size_t i = 0; i < f->splats.count; i += 3)
    f->splats.opacity[i] = 1.0f;
  conic_triangles t = triangles_wild(f, 300);
  f->camera.cam_from_world[2][3] = 1.5;
  t.materials[0].transparency = 0.5f;
  draw(f, &t);
  copy_image(f, &first);
  for (int k = 0; k < 2; k++) {
    fixture other = fixture_open(k ? 3 : 1);
    other.splats = f->splats;
    other.camera = f->camera;
    other.options.epsilon = f->options.epsilon;
    other.options.tile = tiles[k];
    other.options.isa = k ? CONIC_ISA_AUTO : CONIC_ISA_SCALAR;
    draw(&other, &t);
    CHECK(is_same(&first, &other.image));
    memset(&other.splats, 0, sizeof other.splats);
    fixture_close(&other);
  }
  conic_image_release(f->context, &first);
  conic_triangles_release(f->context, &t);
  release_sphere(f);
}

static void test_refusals(fixture *f) {
  const conic_drawing drawing = {&f->splats, NULL};
  const conic_render_options before = f->options;
  fill_planes(f, (const int[]){0}, 1);
  draw(f, NULL);
  CHECK(conic_render_transparent(f->context, f->renderer, &drawing, &f->camera, &f->options, CONIC_TRANSPARENCY_CHANCE,
                                 1.0, 1, &f->image, NULL) == CONIC_ERROR_ARGUMENT);
  f->options.passes = 1;
  CHECK(conic_render_transparent(f->context, f->renderer, &drawing, &f->camera, &f->options, CONIC_TRANSPARENCY_LAYERS,
                                 0.0, 1, &f->image, NULL) == CONIC_ERROR_ARGUMENT);
  f->options = before;
}

int main(void) {
  fixture f = fixture_open(2);
  fixture_camera(&f, SIZE, SIZE, 40.0);
  f.options.epsilon = 0.3;
  test_planes(&f);
  test_mixed(&f);
  test_mean(&f);
  test_shell(&f);
  test_opaque(&f, CONIC_METHOD_CONIC, 0);
  test_opaque(&f, CONIC_METHOD_RAY, 1);
  test_opaque(&f, CONIC_METHOD_AUTO, 1);
  for (uint32_t mode = CONIC_ALPHA_BLEND; mode <= CONIC_ALPHA_OPAQUE; mode++)
    test_card(&f, mode);
  test_vertex_alpha(&f);
  test_chance(&f);
  test_bits(&f);
  test_refusals(&f);
  fixture_close(&f);
  return check_result();
}
