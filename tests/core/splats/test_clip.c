/* Clip lines: kept with their splats, read and written, drawn as docs/reference/picture.md says, and verified by the
 * oracle. */
#include "conic/conic.h"
#include "tests/support/files.h"
#include "tests/support/solid.h"

/* A set whose splat i is at x = i; every third has lines, whose last number is i too. */
static void fill_numbered(conic_context *context, conic_splats *splats, size_t count, unsigned more_fields) {
  unsigned fields = CONIC_SPLATS_TANGENTS | CONIC_SPLATS_CLIPS | more_fields;
  CHECK_OK(conic_splats_allocate(context, count, fields, splats));
  CHECK(splats->n_clips == 0 && splats->clips && conic_splats_fields(splats) == fields);
  for (size_t i = 0; i < count; i++) {
    for (int axis = 0; axis < 3; axis++) {
      splats->position[axis][i] = axis ? 0.25f : (float)i;
      splats->tangent_u[axis][i] = axis == 0 ? 1.0f : 0.0f;
      splats->tangent_v[axis][i] = axis == 1 ? 1.0f : 0.0f;
    }
    if (i % 3 == 0)
      splats->clips[splats->n_clips++] = (conic_clip){.splat = (uint32_t)i,
                                                      .n_lines = (uint16_t)(1 + i / 3 % 2),
                                                      .operation = i % 4 == 0 ? CONIC_CLIP_OR : CONIC_CLIP_AND,
                                                      .lines = {{1.0f, 0.5f, (float)i}, {-1.0f, 2.0f, (float)i}}};
  }
}

/* The lines are still those of the splats that they were made for. */
static void check_numbered(const conic_splats *splats, size_t n_clips) {
  CHECK(splats->n_clips == n_clips);
  for (size_t i = 0; i < splats->n_clips; i++) {
    const conic_clip *clip = &splats->clips[i];
    CHECK(clip->splat < splats->count && (i == 0 || splats->clips[i - 1].splat < clip->splat));
    size_t number = (size_t)splats->position[0][clip->splat];
    CHECK(clip->lines[0][2] == (float)number && clip->n_lines == 1 + number / 3 % 2);
  }
}

static void test_sets(conic_context *context) {
  conic_splats splats, more;
  fill_numbered(context, &splats, 100, 0);
  fill_numbered(context, &more, 40, CONIC_SPLATS_OPACITIES);
  for (size_t i = 0; i < 40; i++)
    more.position[0][i] += 0.25f;
  CHECK_OK(conic_splats_append(context, &splats, &more));
  CHECK(splats.n_clips == 34 + 14 && splats.clips[34].splat == 100 && splats.clips[47].splat == 139);
  check_numbered(&splats, 48);
  conic_splats_release(context, &more);
  CHECK_OK(conic_splats_thin(context, &splats, 60, 5));
  size_t n_left = 0;
  for (size_t i = 0; i < splats.count; i++)
    n_left += (size_t)splats.position[0][i] % 3 == 0;
  check_numbered(&splats, n_left);

  memset(&more, 0, sizeof more);
  CHECK_OK(conic_splats_append(context, &more, &splats));
  check_numbered(&more, n_left);
  conic_splats_release(context, &more);
  CHECK(!more.clips && more.n_clips == 0);
  conic_splats_release(context, &splats);
}

static void test_repairs(conic_context *context) {
  conic_model model;
  conic_repairs repairs;
  conic_estimate_options options;
  memset(&model, 0, sizeof model);
  conic_estimate_options_init(&options);
  fill_numbered(context, &model.points, 60, 0);
  conic_clip *clips = model.points.clips; /* of splats 0, 3, 6 … with 1, 2, 1, 2 … lines */
  clips[0].lines[0][1] = NAN;             /* nothing left */
  clips[1].lines[0][0] = INFINITY;        /* one line left */
  clips[2].lines[0][0] = clips[2].lines[0][1] = 0.0f;
  clips[3].n_lines = 7;
  clips[4].splat = 3;              /* out of order */
  clips[8].splat = clips[7].splat; /* twice */
  clips[19].splat = 60;            /* of no splat */
  for (int axis = 0; axis < 3; axis++)
    model.points.tangent_u[axis][18] = 0.0f; /* new axes: lines in units of the old ones are lost */
  CHECK_OK(conic_model_to_splats(context, &options, &model, &repairs));
  CHECK(repairs.clip == 8 && repairs.zero == 1);
  CHECK(model.points.n_clips == 20 - 2 - 1 - 1 - 1 - 1 && model.points.clips[0].splat == 3);
  CHECK(model.points.clips[0].n_lines == 1 && model.points.clips[0].lines[0][0] == -1.0f);
  for (size_t i = 0; i < model.points.n_clips; i++)
    CHECK(model.points.clips[i].n_lines >= 1 && model.points.clips[i].n_lines <= 2 &&
          model.points.clips[i].splat != 18);
  CHECK(conic_splats_repair_clips(&model.points) == 0);
  conic_model_release(context, &model);
}

static void test_file(conic_context *context, conic_ply_encoding encoding) {
  conic_splats splats;
  conic_model model;
  conic_splats_writer *writer;
  conic_write_options options;
  conic_write_options_init(&options);
  options.encoding = encoding;
  options.circles = 1; /* not with clip lines */
  fill_numbered(context, &splats, 700, 0);
  const char *path = files_path("clips.ply");
  CHECK_OK(conic_splats_writer_open(context, path, 1400, conic_splats_fields(&splats), &options, &writer));
  CHECK_OK(conic_splats_writer_append(writer, &splats));
  CHECK_OK(conic_splats_writer_append(writer, &splats));
  CHECK_OK(conic_splats_writer_finish(writer));
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(model.points.count == 1400 && model.points.n_clips == 2 * splats.n_clips);
  check_numbered(&model.points, 2 * splats.n_clips);
  for (size_t i = 0; i < splats.n_clips && !check_failures; i++) {
    const conic_clip *a = &splats.clips[i], *b = &model.points.clips[splats.n_clips + i];
    CHECK(b->splat == a->splat + 700 && b->n_lines == a->n_lines && b->operation == a->operation);
    CHECK(memcmp(a->lines, b->lines, (size_t)a->n_lines * sizeof a->lines[0]) == 0);
  }
  conic_model_release(context, &model);
  conic_splats_release(context, &splats);
  remove(path);
}

#define AXES_HEADER                                                                                                    \
  "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"                    \
  "property float tu_x\nproperty float tu_y\nproperty float tu_z\nproperty float tv_x\nproperty float tv_y\n"          \
  "property float tv_z\nproperty list uchar float clip_or\nproperty list uint double clip_and\nend_header\n"

static void test_hand_made(conic_context *context) {
  conic_model model;
  const char *sound = AXES_HEADER "0 0 0 1 0 0 0 1 0 0 3 1 nan 3\n1 0 0 1 0 0 0 1 0 6 1 2 3 4 5 6 0\n";
  CHECK_OK(conic_model_read(context, files_write_bytes("a.ply", sound, strlen(sound)), NULL, &model));
  CHECK(model.points.n_clips == 2 && model.points.clips[0].n_lines == 1 &&
        model.points.clips[0].operation == CONIC_CLIP_AND && model.points.clips[1].n_lines == 2 &&
        model.points.clips[1].operation == CONIC_CLIP_OR && model.points.clips[1].lines[1][2] == 6.0f);
  conic_model_release(context, &model);
  static const char *const wrong[][2] = {
      {AXES_HEADER "0 0 0 1 0 0 0 1 0 0 4 1 2 3 4\n1 0 0 1 0 0 0 1 0 0 0\n", "neither 0 nor 3 nor 6 values (line 16)"},
      {AXES_HEADER "0 0 0 1 0 0 0 1 0 3 1 2 3 3 1 2 3\n1 0 0 1 0 0 0 1 0 0 0\n",
       "both clip_and and clip_or (line 16)"}};
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    const char *path = files_write_bytes("b.ply", wrong[i][0], strlen(wrong[i][0]));
    CHECK(conic_model_read(context, path, NULL, &model) == CONIC_ERROR_INPUT);
    if (!strstr(files_message, wrong[i][1])) {
      fprintf(stderr, "got: %s\n", files_message);
      check_failures++;
    }
    remove(path);
  }
  remove(files_path("a.ply"));
}

/* l·(u, v, 1) of the splat's plane at a pixel, by Cramer's rule; in pixels, by its change over a pixel. */
static double distance_px(const fixture *f, const float line[3], double x, double y) {
  double value[3];
  for (int k = 0; k < 3; k++) {
    double d[3] = {(x + (k == 1) - f->camera.cx) / f->camera.fx, (y + (k == 2) - f->camera.cy) / f->camera.fy, 1.0};
    double m[3][4], w[3];
    for (int row = 0; row < 3; row++) { /* w0·tu + w1·tv + w2·p = d */
      m[row][0] = (double)f->splats.tangent_u[row][0];
      m[row][1] = (double)f->splats.tangent_v[row][0];
      m[row][2] = (double)f->splats.position[row][0];
      m[row][3] = d[row];
    }
    for (int i = 0; i < 4; i++) /* determinants with column i - 1 replaced, i = 0: none */
      value[k] = 0.0;
    double determinants[4];
    for (int i = 0; i < 4; i++) {
      double c[3][3];
      for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
          c[row][column] = m[row][column == i - 1 ? 3 : column];
      determinants[i] = c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) -
                        c[0][1] * (c[1][0] * c[2][2] - c[1][2] * c[2][0]) +
                        c[0][2] * (c[1][0] * c[2][1] - c[1][1] * c[2][0]);
    }
    for (int i = 0; i < 3; i++)
      w[i] = determinants[i + 1] / determinants[0];
    value[k] = (double)line[0] * w[0] + (double)line[1] * w[1] + (double)line[2] * w[2];
  }
  return value[0] / hypot(value[1] - value[0], value[2] - value[0]);
}

/* The box on the screen of what the lines leave of the disc, by many of its points. */
static void sample_box(const fixture *f, const float lines[2][3], int n_lines, int operation, double low[2],
                       double high[2]) {
  enum { N = 1500 };
  double cutoff = (double)f->options.kernel.cutoff;
  for (int k = 0; k < N * N; k++) {
    double u = cutoff * (2.0 * (k % N) / (N - 1) - 1.0), v = cutoff * (2.0 * (k / N) / (N - 1) - 1.0), at[3], kept[2];
    for (int i = 0; i < 2; i++)
      kept[i] = (double)lines[i][0] * u + (double)lines[i][1] * v + (double)lines[i][2];
    if (n_lines == 1)
      kept[1] = kept[0];
    if (u * u + v * v > cutoff * cutoff ||
        (operation == CONIC_CLIP_OR ? fmax(kept[0], kept[1]) : fmin(kept[0], kept[1])) < 0.0)
      continue;
    for (int axis = 0; axis < 3; axis++)
      at[axis] = (double)f->splats.position[axis][0] + u * (double)f->splats.tangent_u[axis][0] +
                 v * (double)f->splats.tangent_v[axis][0];
    const double place[2] = {f->camera.cx + f->camera.fx * at[0] / at[2], f->camera.cy + f->camera.fy * at[1] / at[2]};
    for (int i = 0; i < 2; i++) {
      low[i] = fmin(low[i], place[i]);
      high[i] = fmax(high[i], place[i]);
    }
  }
}

/* One tilted splat, with and without lines: what is gone is what they do not keep, and what is farther from what they
 * do keep than the prefilter reaches. */
static void test_half_planes(fixture *f, conic_method method, int operation, int n_lines) {
  static const float lines[2][3] = {{0.8f, 0.6f, -0.3f}, {-0.2f, 1.0f, 0.4f}};
  enum { EDGE = 120 };
  static uint32_t unclipped[EDGE * EDGE];
  conic_clip clip = {.splat = 0, .n_lines = (uint16_t)n_lines, .operation = (uint16_t)operation};
  memcpy(clip.lines, lines, sizeof lines);
  fixture_camera(f, EDGE, EDGE, 200.0);
  fixture_splats(f, 1);
  fixture_set(f, 0, (const double[]){0.05, -0.02, 2.0}, (const double[]){0.25, 0.02, 0.12},
              (const double[]){-0.03, 0.2, -0.1}, 1, 1, 1);
  f->options.method = method;
  fixture_render(f);
  memcpy(unclipped, f->image.planes[CONIC_PLANE_COUNT], sizeof unclipped);
  f->splats.clips = &clip;
  f->splats.n_clips = 1;
  fixture_render(f);
  f->splats.clips = NULL;
  f->splats.n_clips = 0;
  int n_kept = 0, n_clipped = 0, is_dot = method == CONIC_METHOD_DISC;
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9}, growth = 1.5 + 1.0 / 256.0;
  sample_box(f, lines, n_lines, operation, low, high);
  for (int y = 0; y < EDGE; y++)
    for (int x = 0; x < EDGE; x++) {
      double first = distance_px(f, clip.lines[0], x + 0.5, y + 0.5);
      double second = n_lines == 2 ? distance_px(f, clip.lines[1], x + 0.5, y + 0.5) : first;
      double kept = operation == CONIC_CLIP_OR ? fmax(first, second) : fmin(first, second);
      uint32_t covers = fixture_index(f, CONIC_PLANE_COUNT, x, y);
      if (!unclipped[y * EDGE + x] || fabs(kept + 1.0 / 256.0) < 2e-3) {
        CHECK(unclipped[y * EDGE + x] || !covers);
        continue;
      }
      double beyond_x = fmax(low[0] - (x + 0.5), x + 0.5 - high[0]);
      double beyond = fmax(beyond_x, fmax(low[1] - (y + 0.5), y + 0.5 - high[1]));
      if (!is_dot && kept > 0.0 && fabs(beyond - growth) < 0.05)
        continue;
      CHECK(covers == (kept > -1.0 / 256.0 && (is_dot || beyond < growth)));
      n_kept += covers != 0;
      n_clipped += covers == 0;
    }
  CHECK(n_kept > 100 && n_clipped > 100);
}

/* On a line that runs through pixels' centres, both mates keep them. */
static void test_overlap(fixture *f) {
  fixture_camera(f, 64, 64, 64.0);
  fixture_splats(f, 2);
  for (size_t i = 0; i < 2; i++) {
    const double p[3] = {0.5 / 64.0 * 2.0 + (i ? 0.1 : -0.1), 0.0, 2.0};
    fixture_set(f, i, p, (const double[]){0.3, 0, 0}, (const double[]){0, 0.3, 0}, 1, 1, 1);
  }
  conic_clip clips[2] = {{.splat = 0, .n_lines = 1, .lines = {{-0.3f, 0.0f, 0.1f}}},
                         {.splat = 1, .n_lines = 1, .lines = {{0.3f, 0.0f, 0.1f}}}};
  f->splats.clips = clips;
  f->splats.n_clips = 2;
  fixture_render(f);
  f->splats.clips = NULL;
  f->splats.n_clips = 0;
  CHECK(fixture_index(f, CONIC_PLANE_COUNT, 32, 32) == 2);
  CHECK(fixture_index(f, CONIC_PLANE_ID, 31, 32) == 0 && fixture_index(f, CONIC_PLANE_COUNT, 31, 32) == 1);
  CHECK(fixture_index(f, CONIC_PLANE_ID, 33, 32) == 1 && fixture_index(f, CONIC_PLANE_COUNT, 33, 32) == 1);
}

/* Splats all about the eye: before it, through the near plane, edge-on; with all kinds of lines. */
static void fill_wild(fixture *f, uint64_t *state, size_t n) {
  fixture_splats(f, n);
  f->splats.clips = calloc(n, sizeof *f->splats.clips);
  for (size_t i = 0; i < n; i++) {
    double p[3], u[3], v[3], size = pow(10.0, -0.5 - 1.5 * fixture_random(state)), thin = i % 5 ? 1.0 : 1e-3;
    for (int axis = 0; axis < 3; axis++) {
      p[axis] = 3.0 * (fixture_random(state) - 0.5) + (axis == 2 ? 1.4 : 0.0);
      u[axis] = size * (fixture_random(state) - 0.5);
    }
    for (int axis = 0; axis < 3; axis++) /* some nearly point at the eye */
      v[axis] = i % 7 ? thin * size * (fixture_random(state) - 0.5) : size * p[axis] + 1e-3 * fixture_random(state);
    fixture_set(f, i, p, u, v, (float)fixture_random(state), 0.5f, (float)fixture_random(state));
    if (i % 4 == 0)
      continue;
    conic_clip clip = {.splat = (uint32_t)i, .n_lines = (uint16_t)(1 + i % 2), .operation = (uint16_t)(i / 2 % 2)};
    for (int k = 0; k < 6; k++)
      clip.lines[k / 3][k % 3] = (float)(2.0 * fixture_random(state) - (k % 3 == 2 ? 0.5 : 1.0));
    if (i % 23 == 0)
      clip.lines[0][0] = NAN;
    if (i % 29 == 0)
      clip.lines[1][0] = clip.lines[1][1] = 0.0f;
    f->splats.clips[f->splats.n_clips++] = clip;
  }
}

static void drop_clips(fixture *f) {
  free(f->splats.clips);
  f->splats.clips = NULL;
  f->splats.n_clips = 0;
}

/* Every instruction set clips the same pixels. */
static void test_isas(fixture *f, conic_method method, int passes) {
  uint64_t state = 23, hashes[CONIC_N_DRAWN_PLANES] = {0};
  fill_wild(f, &state, 3000);
  fixture_camera(f, 131, 97, 77.0);
  f->options.method = method;
  f->options.passes = passes;
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++) {
    f->options.isa = (conic_isa)isa;
    conic_image_release(f->context, &f->image);
    CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &f->image));
    conic_status status = conic_render(f->renderer, &f->splats, &f->camera, &f->options, &f->image, NULL);
    CHECK(status == CONIC_OK || (isa != CONIC_ISA_SCALAR && status == CONIC_ERROR_UNSUPPORTED));
    for (int plane = 0; status == CONIC_OK && plane < CONIC_N_DRAWN_PLANES; plane++) {
      uint64_t hash = conic_image_hash(&f->image, (conic_plane)plane);
      CHECK(isa == CONIC_ISA_SCALAR || hash == hashes[plane]);
      if (isa == CONIC_ISA_SCALAR)
        hashes[plane] = hash;
    }
  }
  drop_clips(f);
  f->options.passes = 3;
  f->options.isa = CONIC_ISA_AUTO;
}

/* What is exact is asked of a picture of half the size: its integrals take most of the time. */
static void test_oracle(fixture *f, conic_method method) {
  uint64_t state = 11;
  fill_wild(f, &state, 300);
  f->options.method = method;
  f->options.near_z = 0.05;
  for (int question = 0; question < 2; question++) {
    conic_reference reference;
    conic_oracle_verdict verdict;
    fixture_camera(f, 120 >> question, 90 >> question, 80.0 / (1 + question));
    fixture_render(f);
    CHECK_OK(conic_oracle_render(f->context, &f->splats, &f->camera, &f->options, (conic_oracle_question)question,
                                 &reference));
    CHECK_OK(conic_oracle_compare(f->context, &reference, &f->image, &verdict));
    CHECK(verdict.pass);
    for (int plane = 0; plane < CONIC_N_DRAWN_PLANES && question == 0; plane++) {
      if (!(verdict.planes[plane].max_abs <= verdict.planes[plane].bound))
        fprintf(stderr, "method %d, plane %d: %g, %zu unstable\n", method, plane, verdict.planes[plane].max_abs,
                reference.unstable_pixels);
      CHECK(verdict.planes[plane].max_abs <= verdict.planes[plane].bound);
    }
    CHECK(reference.covered_pixels > (size_t)(method == CONIC_METHOD_POINT ? 50 : 2000) >> 2 * question);
    CHECK(reference.unstable_pixels < reference.covered_pixels / 5);
    conic_reference_release(f->context, &reference);
  }
  drop_clips(f);
  f->options.near_z = 0.0;
}

/* Clipped splats far from the origin are drawn as at the origin. */
static void test_far(fixture *f) {
  enum { EDGE = 150 };
  static uint32_t here[EDGE * EDGE];
  fixture_scene(f, CONIC_SCENE_CORNER, 2000);
  for (int i = 0; i < 2; i++) {
    solid_look(f, 35, 25, 1);
    f->camera.width = f->camera.height = EDGE;
    for (int row = 0; i && row < 3; row++)
      f->camera.cam_from_world[row][3] -= 1e6 * f->camera.cam_from_world[row][0];
    f->splats.origin[0] = i ? 1e6 : 0.0;
    fixture_render(f);
    if (!i)
      memcpy(here, f->image.planes[CONIC_PLANE_ID], sizeof here);
  }
  int n_different = 0;
  for (size_t k = 0; k < EDGE * EDGE; k++)
    n_different += here[k] != ((const uint32_t *)f->image.planes[CONIC_PLANE_ID])[k];
  CHECK(n_different <= EDGE * EDGE / 1000);
}

/* The made scenes, from all sides: closed to a hair, and nothing past their silhouettes but the overlap; past those of
 * faces that are nearly edge-on, the cube by little more than the prefilter adds, the corner, which has faces that the
 * eye lies in, by an outline. */
static void test_solids(fixture *f) {
  for (int method = 0; method < CONIC_N_METHODS; method++)
    for (int lacks_octant = 0; lacks_octant < 2; lacks_octant++) {
      if (method == CONIC_METHOD_POINT || method == CONIC_METHOD_DISC) /* neither fills faces nor ends at their edges */
        continue;
      f->options.method = (conic_method)method;
      fixture_scene(f, lacks_octant ? CONIC_SCENE_CORNER : CONIC_SCENE_CUBE, 3000);
      CHECK(f->splats.n_clips > 300 && f->splats.n_clips < 3000);
      solid_check(f, lacks_octant, 1e-3, 1.0 / 256.0 + 1e-3, 1.51);
    }
  f->options.method = CONIC_METHOD_CONIC;
  f->options.isa = CONIC_ISA_SCALAR;
  fixture_scene(f, CONIC_SCENE_CORNER, 220);
  solid_check(f, 1, 1e-3, 0.03, 1.51);
  fixture_scene(f, CONIC_SCENE_CUBE, 60);
  solid_check(f, 0, 1e-3, 1.0 / 256.0 + 1e-3, 1.51);
}

int main(void) {
  conic_context *context = files_context();
  test_sets(context);
  test_repairs(context);
  test_file(context, CONIC_PLY_BINARY);
  test_file(context, CONIC_PLY_ASCII);
  test_hand_made(context);
  files_end(context);
  fixture f = fixture_open(2);
  f.options.isa = CONIC_ISA_AUTO;
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    for (int n_lines = 1; n_lines <= 2 && method != CONIC_METHOD_POINT; n_lines++)
      test_half_planes(&f, (conic_method)method, CONIC_CLIP_AND, n_lines);
    if (method != CONIC_METHOD_POINT)
      test_half_planes(&f, (conic_method)method, CONIC_CLIP_OR, 2);
    test_oracle(&f, (conic_method)method);
    test_isas(&f, (conic_method)method, 3);
    test_isas(&f, (conic_method)method, 1);
  }
  f.options.method = CONIC_METHOD_AUTO;
  test_overlap(&f);
  test_far(&f);
  test_solids(&f);
  fixture_close(&f);
  return check_result();
}
