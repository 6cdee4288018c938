/* Points drawn as polynomial patches: the grids against plain sums, pictures against the true surface, and the bits. */
#include "surface/patches/patch.h"
#include "tests/support/fixture.h"
#include "tests/support/surface_shapes.h"

static const double degrees = 57.29577951308232;

/* --- grids --- */

static float next(uint64_t *seed) {
  return (float)(2.0 * random_unit(seed) - 1.0);
}

static conic_patch make_patch(int degree, uint64_t *seed) {
  conic_patch patch;
  memset(&patch, 0, sizeof patch);
  for (int axis = 0; axis < 3; axis++) {
    patch.center[axis] = next(seed);
    patch.along[axis] = next(seed);
    patch.across[axis] = next(seed);
    patch.normal[axis] = next(seed);
  }
  for (int k = 0; k < (degree + 1) * (degree + 2) / 2; k++)
    patch.coefficients[k] = next(seed);
  return patch;
}

/* The height and its slopes by plain sums of powers. */
static void evaluate(const conic_patch *patch, int degree, double s, double t, double g[3]) {
  g[0] = g[1] = g[2] = 0.0;
  for (int power = 0, k = 0; power <= degree; power++)
    for (int j = 0; j <= power; j++, k++) {
      double c = (double)patch->coefficients[k];
      int i = power - j;
      g[0] += c * pow(s, i) * pow(t, j);
      g[1] += i ? c * i * pow(s, i - 1) * pow(t, j) : 0.0;
      g[2] += j ? c * j * pow(s, i) * pow(t, j - 1) : 0.0;
    }
}

enum { MOST_SAMPLES = 64 * 64 };

static void check_part(const conic_patch *patch, int degree, const conic_grid_part *part) {
  static float arrays[10][MOST_SAMPLES];
  conic_grid_samples to = {{arrays[0], arrays[1], arrays[2]},
                           {arrays[3], arrays[4], arrays[5]},
                           {arrays[6], arrays[7], arrays[8]},
                           arrays[9]};
  const double cutoff = 1.5, n = (double)part->n, sigma = CONIC_SAMPLE_OUTLINE * 2.0 / n / cutoff;
  size_t at = 0, count = conic_grid_sample(patch, degree, cutoff, part, &to);
  double off = 0.0, peak = cutoff * cutoff / (2.0 * acos(-1.0) * 1.17 * 1.17 * (1.0 - exp(-0.5 * cutoff * cutoff)));
  CHECK(count == conic_grid_count(part, NULL));
  for (int64_t row = part->row; row < part->row + part->n_rows; row++)
    for (int64_t column = part->column; column < part->column + part->n_columns; column++) {
      double s = (double)(2 * column + 1) / n - 1.0, t = (double)(2 * row + 1) / n - 1.0, g[3];
      if ((2 * column + 1 - part->n) * (2 * column + 1 - part->n) + (2 * row + 1 - part->n) * (2 * row + 1 - part->n) >
          part->n * part->n)
        continue;
      evaluate(patch, degree, s, t, g);
      for (int axis = 0; axis < 3; axis++) {
        double normal = (double)patch->normal[axis], along = (double)patch->along[axis],
               across = (double)patch->across[axis];
        off = fmax(off, fabs((double)patch->center[axis] + s * along + t * across + g[0] * normal -
                             (double)to.position[axis][at]));
        off = fmax(off, fabs(sigma * (along + g[1] * normal) - (double)to.tangent_u[axis][at]));
        off = fmax(off, fabs(sigma * (across + g[2] * normal) - (double)to.tangent_v[axis][at]));
      }
      double inside = 1.0 - s * s - t * t;
      off = fmax(off, fabs(peak * fmax(inside * inside, 0x1p-10) - (double)to.weight[at]));
      at++;
    }
  CHECK(at == count);
  CHECK(off < 2e-6); /* values of up to 16, as floats */
}

static void test_grids(void) {
  static const int sizes[] = {3, 4, 6, 8, 12, 16, 24, 32, 48, 64};
  uint64_t seed = 7;
  for (int degree = 1; degree <= 4; degree++)
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
      conic_patch patch = make_patch(degree, &seed);
      conic_grid_part whole = conic_grid_whole(sizes[i]);
      check_part(&patch, degree, &whole);
      conic_grid_part parts[] = {{1024, 500, 16, 16, 16}, {1 << 26, (1 << 25) + 16, 1 << 25, 16, 16}};
      check_part(&patch, degree, &parts[0]);
      check_part(&patch, degree, &parts[1]);
    }
}

/* --- pictures --- */

/* Looks at `target` along a direction. */
static void look_at(fixture *f, const double target[3], const double direction[3], double distance, double focal_px) {
  double z[3], x[3], y[3], length = 0.0, flat = hypot(direction[0], direction[2]);
  fixture_camera(f, 160, 160, focal_px);
  for (int i = 0; i < 3; i++)
    length += direction[i] * direction[i];
  for (int i = 0; i < 3; i++)
    z[i] = direction[i] / sqrt(length);
  x[0] = direction[2] / flat;
  x[1] = 0.0;
  x[2] = -direction[0] / flat;
  for (int i = 0; i < 3; i++)
    y[i] = z[(i + 1) % 3] * x[(i + 2) % 3] - z[(i + 2) % 3] * x[(i + 1) % 3];
  const double *rows[3] = {x, y, z};
  for (int r = 0; r < 3; r++) {
    f->camera.cam_from_world[r][3] = r == 2 ? distance : 0.0;
    for (int c = 0; c < 3; c++) {
      f->camera.cam_from_world[r][c] = rows[r][c];
      f->camera.cam_from_world[r][3] -= rows[r][c] * target[c];
    }
  }
}

static void to_world(const fixture *f, const double cam[3], double world[3]) {
  for (int c = 0; c < 3; c++) {
    world[c] = 0.0;
    for (int r = 0; r < 3; r++)
      world[c] += f->camera.cam_from_world[r][c] * (cam[r] - f->camera.cam_from_world[r][3]);
  }
}

/* How near a pixel's ray comes to the torus, in pixels there; negative inside. */
static double ray_distance_px(const fixture *f, int x, int y) {
  double least = HUGE_VAL, normal[3];
  for (double z = 0.5; z < 6.0;) {
    const double cam[3] = {(x + 0.5 - f->camera.cx) / f->camera.fx * z, (y + 0.5 - f->camera.cy) / f->camera.fy * z, z};
    double world[3];
    to_world(f, cam, world);
    double distance = shape_distance(SHAPE_TORUS, world, normal);
    least = fmin(least, distance * f->camera.fx / z);
    z += fmax(0.7 * fabs(distance), 1e-3);
  }
  return least;
}

/* What a picture of the torus has wrong. */
typedef struct picture_error {
  double normal_rms, normal_p99; /* degrees, over the covered pixels whose ray meets the torus by more than 2 px; the
                                    first without the last hundredth, where one part of it hides another */
  int n_holes;                   /* pixels that it meets by half a pixel or more, and that are not covered */
  double overhang_px;            /* how far from the torus a pixel is that is covered */
} picture_error;

static int compare_doubles(const void *a, const void *b) {
  double first = *(const double *)a, second = *(const double *)b;
  return (first > second) - (first < second);
}

static double off_by_pixel[160 * 160]; /* what judge goes by: ray_distance_px */

static void trace_rays(const fixture *f) {
  for (int y = 0; y < f->camera.height; y++)
    for (int x = 0; x < f->camera.width; x++)
      off_by_pixel[y * f->camera.width + x] = ray_distance_px(f, x, y);
}

static picture_error judge(const fixture *f) {
  static double angles[160 * 160];
  picture_error e = {0};
  size_t n = 0;
  for (int y = 0; y < f->image.height; y++)
    for (int x = 0; x < f->image.width; x++) {
      double off_px = off_by_pixel[y * f->image.width + x], z = (double)*fixture_pixel(f, CONIC_PLANE_Z, x, y),
             world[3], normal[3];
      int is_covered = fixture_index(f, CONIC_PLANE_ID, x, y) != CONIC_NO_ID;
      e.n_holes += !is_covered && off_px <= -0.5;
      if (!is_covered)
        continue;
      e.overhang_px = fmax(e.overhang_px, off_px);
      if (off_px > -2.0)
        continue;
      const double cam[3] = {(x + 0.5 - f->camera.cx) / f->camera.fx * z, (y + 0.5 - f->camera.cy) / f->camera.fy * z,
                             z};
      const float *drawn = fixture_pixel(f, CONIC_PLANE_NORMAL, x, y);
      to_world(f, cam, world);
      shape_distance(SHAPE_TORUS, world, normal);
      double cosine = normal[0] * (double)drawn[0] + normal[1] * (double)drawn[1] + normal[2] * (double)drawn[2];
      angles[n] = degrees * acos(fmin(1.0, fabs(cosine)));
      n++;
    }
  CHECK(n > 1000);
  qsort(angles, n, sizeof angles[0], compare_doubles);
  for (size_t i = 0; i < n - n / 100; i++)
    e.normal_rms += angles[i] * angles[i] / (double)(n - n / 100);
  e.normal_rms = sqrt(e.normal_rms);
  e.normal_p99 = angles[n - 1 - n / 100];
  return e;
}

/* `n` splats of a jittered torus, their axes estimated from the bare points. */
static void fill_torus(fixture *f, size_t n) {
  conic_model model;
  conic_repairs repairs;
  conic_estimate_options options;
  conic_estimate_options_init(&options);
  memset(&model, 0, sizeof model);
  conic_splats samples = shape_sample(f->context, SHAPE_TORUS, n, 0.0, 3);
  model.points = samples;
  CHECK_OK(conic_model_to_splats(f->context, &options, &model, &repairs));
  conic_splats_release(f->context, &f->splats);
  f->splats = model.points;
}

static conic_patches *lay(const fixture *f, const conic_splats *splats, conic_isa isa) {
  conic_patches_options options;
  conic_patches *patches;
  conic_patches_options_init(&options);
  options.surface.isa = isa;
  if (conic_patches_create(f->context, splats, &options, &patches) != CONIC_OK)
    exit(1);
  return patches;
}

/* Draws with patches into f's image; the fixture's splats stay. */
static conic_patch_selection draw(fixture *f, conic_patches *patches) {
  conic_patch_selection selection;
  CHECK_OK(conic_patches_select(patches, &f->camera, &f->options, &selection));
  conic_splats own = f->splats;
  f->splats = selection.splats;
  fixture_render(f);
  f->splats = own;
  conic_patch_selection_name(&selection, &f->image);
  return selection;
}

/* A picture of few points at ten times its size is smooth: its normals are the surface's, and so is its outline. */
static void test_smoothness(fixture *f) {
  static const double targets[2][3] = {{0.4, 0.38, 1.0}, {1.4, 0.0, 0.0}}, direction[3] = {0.1, -0.6, -1.0};
  double length;
  fill_torus(f, 2000);
  CHECK_OK(conic_splats_length(f->context, &f->splats, &length));
  conic_patches *patches = lay(f, &f->splats, CONIC_ISA_AUTO);
  for (int i = 0; i < 2; i++) {
    look_at(f, targets[i], direction, 3.0, 900.0); /* the torus is 840 pixels wide, a spacing 25 */
    trace_rays(f);
    f->options.epsilon = -1.0;
    fixture_render(f);
    picture_error splats = judge(f);
    f->options.epsilon = 1.5 * length;
    conic_patch_selection selection = draw(f, patches);
    picture_error drawn = judge(f);
    printf("torus, zoom 10: normals off by %.3f deg rms, %.3f (99 %%), outline by %.2f px, %d holes as splats;\n"
           "  %.3f, %.3f, %.2f px, %d as %zu patches of %zu samples\n",
           splats.normal_rms, splats.normal_p99, splats.overhang_px, splats.n_holes, drawn.normal_rms, drawn.normal_p99,
           drawn.overhang_px, drawn.n_holes, selection.n_patches, selection.n_samples);
    CHECK(drawn.normal_rms < 0.15 && drawn.normal_p99 < 0.5);
    CHECK(drawn.normal_rms < 0.1 * splats.normal_rms);
    CHECK(drawn.overhang_px < 2.0); /* the prefilter alone reaches 1.5 */
    CHECK(splats.overhang_px > 3.0 || i == 0);
    CHECK(drawn.n_holes == 0);
    CHECK(selection.n_splats == 0 && selection.n_culled > 1000);
  }
  conic_patches_destroy(patches);
}

/* A hundred times nearer than a patch is large. */
static void test_near(fixture *f) {
  const double distance = 0.003;
  double target[3] = {0.4, 0.0, 1.0}, normal[3], direction[3];
  fill_torus(f, 250);
  double off = shape_distance(SHAPE_TORUS, target, normal);
  for (int i = 0; i < 3; i++) {
    target[i] -= off * normal[i];
    direction[i] = -normal[i] + (i == 1 ? 0.3 : 0.0);
  }
  conic_patches *patches = lay(f, &f->splats, CONIC_ISA_AUTO);
  f->options.near_z = 1e-5;
  look_at(f, target, direction, distance, 160.0);
  conic_patch_selection selection = draw(f, patches);
  int n_holes = 0;
  for (int k = 0; k < 160 * 160; k++)
    n_holes += ((const uint32_t *)f->image.planes[CONIC_PLANE_ID])[k] == CONIC_NO_ID;
  printf("torus at %g: %zu samples of %zu patches, %d holes\n", distance, selection.n_samples, selection.n_patches,
         n_holes);
  CHECK(n_holes == 0);
  CHECK(selection.n_samples < 1000000);
  f->options.near_z = 0.0;
  conic_patches_destroy(patches);
}

/* --- bits --- */

static void hash_all(const fixture *f, uint64_t hashes[CONIC_N_DRAWN_PLANES]) {
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    hashes[plane] = conic_image_hash(&f->image, (conic_plane)plane);
}

/* From afar all are splats, and the picture is theirs. */
static void test_far(fixture *f) {
  static const double center[3] = {0, 0, 0}, direction[3] = {0.3, -0.5, -1.0};
  uint64_t as_splats[CONIC_N_DRAWN_PLANES], as_patches[CONIC_N_DRAWN_PLANES];
  fill_torus(f, 4000);
  conic_patches *patches = lay(f, &f->splats, CONIC_ISA_AUTO);
  look_at(f, center, direction, 8.0, 160.0);
  f->options.epsilon = 0.05;
  fixture_render(f);
  hash_all(f, as_splats);
  conic_patch_selection selection = draw(f, patches);
  hash_all(f, as_patches);
  CHECK(selection.n_splats == 4000 && selection.n_patches == 0);
  CHECK(memcmp(as_splats, as_patches, sizeof as_splats) == 0);
  conic_patches_destroy(patches);
}

/* Whatever was drawn before, whatever counts, and with however many threads. */
static void test_bits(void) {
  static const int thread_counts[] = {1, 2, 7};
  static const double center[3] = {1.0, 0.2, 0.5}, direction[3] = {0.3, -0.5, -1.0}, other[3] = {-0.2, -0.5, -1.0};
  uint64_t expected[CONIC_N_DRAWN_PLANES], hashes[CONIC_N_DRAWN_PLANES];
  for (int t = 0; t < 3; t++) {
    fixture f = fixture_open(thread_counts[t]);
    fill_torus(&f, 1500);
    for (int isa = CONIC_ISA_AUTO; isa < (t == 1 ? CONIC_N_ISAS : 1); isa++) {
      conic_patches_options options;
      conic_patches *patches;
      conic_patches_options_init(&options);
      options.surface.isa = (conic_isa)isa;
      conic_status status = conic_patches_create(f.context, &f.splats, &options, &patches);
      if (status == CONIC_ERROR_UNSUPPORTED)
        continue;
      CHECK_OK(status);
      look_at(&f, center, direction, 2.0, 400.0);
      f.options.epsilon = 0.05;
      conic_patch_selection first = draw(&f, patches);
      hash_all(&f, hashes);
      if (t == 0 && isa == CONIC_ISA_AUTO)
        memcpy(expected, hashes, sizeof expected);
      CHECK(memcmp(expected, hashes, sizeof hashes) == 0);
      CHECK(first.n_kept == 0 && first.n_patches > 50 && first.n_splats < 10);
      look_at(&f, center, other, 2.2, 400.0); /* another picture between, which shares some grids */
      conic_patch_selection between = draw(&f, patches);
      look_at(&f, center, direction, 2.0, 400.0);
      conic_patch_selection again = draw(&f, patches);
      hash_all(&f, hashes);
      CHECK(memcmp(expected, hashes, sizeof hashes) == 0);
      CHECK(between.n_kept > 0 && again.n_kept > 0 && again.n_kept < again.n_samples);
      conic_patches_destroy(patches);
    }
    fixture_close(&f);
  }
}

/* What culling leaves out is not in the picture. */
static void test_culling(fixture *f) {
  static const double center[3] = {1.0, 0.2, 0.5}, direction[3] = {0.3, -0.5, -1.0};
  fill_torus(f, 3000);
  conic_patches *patches = lay(f, &f->splats, CONIC_ISA_AUTO);
  look_at(f, center, direction, 2.0, 400.0);
  f->options.cull_back = 1;
  conic_patch_selection culled = draw(f, patches);
  size_t n_culled = culled.n_culled;
  uint64_t hashes[CONIC_N_DRAWN_PLANES], all[CONIC_N_DRAWN_PLANES];
  hash_all(f, hashes);
  f->options.cull_back = 0;
  conic_patch_selection selection;
  CHECK_OK(conic_patches_select(patches, &f->camera, &f->options, &selection));
  CHECK(selection.n_culled < n_culled);
  f->options.cull_back = 1; /* now splat by splat alone */
  conic_splats own = f->splats;
  f->splats = selection.splats;
  fixture_render(f);
  f->splats = own;
  conic_patch_selection_name(&selection, &f->image);
  hash_all(f, all);
  CHECK(memcmp(hashes, all, sizeof all) == 0);
  f->options.cull_back = 0;
  conic_patches_destroy(patches);
}

/* --- what has no patch --- */

static void test_failures(fixture *f) {
  static const double center[3] = {0.4, 0.3, 1.0}, direction[3] = {0.0, -0.5, -1.0};
  conic_patches_report report;
  fill_torus(f, 3000);
  conic_splats *s = &f->splats;
  s->position[1][10] = NAN;
  for (int axis = 0; axis < 3; axis++) {
    s->position[axis][20] = s->position[axis][21];   /* two points in one place */
    s->position[axis][30] = axis == 1 ? 2.0f : 0.0f; /* far from all others */
    s->tangent_u[axis][40] = 0.0f;
  }
  conic_clip clips[2] = {{.splat = 50, .n_lines = 1, .lines = {{1.0f, 0.0f, 0.0f}}},
                         {.splat = 2900, .n_lines = 1, .lines = {{0.0f, 1.0f, 0.0f}}}};
  s->clips = clips;
  s->n_clips = 2;
  conic_patches *patches = lay(f, s, CONIC_ISA_AUTO);
  conic_patches_describe(patches, &report);
  CHECK(report.n_points == 3000 && report.outcomes[CONIC_SURFACE_NOT_FINITE] == 1);
  printf("%zu patches of 3000 points\n", report.n_patches);
  CHECK(report.n_patches == 2997); /* all but one that is no number, and two at creases; the far one is flat */
  look_at(f, center, direction, 6.0, 1000.0);
  conic_patch_selection selection = draw(f, patches);
  size_t of_twins[2] = {0, 0}, n_clips = 0;
  for (size_t i = 0; i < selection.splats.count; i++) {
    of_twins[0] += selection.points[i] == 20;
    of_twins[1] += selection.points[i] == 21;
  }
  for (size_t i = 0; i < selection.splats.n_clips; i++) {
    uint32_t point = selection.points[selection.splats.clips[i].splat];
    n_clips += point == clips[0].splat || point == clips[1].splat;
  }
  CHECK(of_twins[0] == of_twins[1]);
  CHECK(n_clips == selection.splats.n_clips && n_clips > 0);
  CHECK(f->statistics.splats_skipped >= 1); /* the one that is not a number */
  for (int k = 0; k < 160 * 160; k++) {
    uint32_t id = ((const uint32_t *)f->image.planes[CONIC_PLANE_ID])[k];
    CHECK(id < 3000 || id == CONIC_NO_ID);
  }
  conic_patches_destroy(patches);
  s->clips = NULL;
  s->n_clips = 0;
}

/* --- meshes --- */

/* A mesh, the splats of its vertices as a picture of points has them, and patches through these. */
static conic_patches *lay_mesh(fixture *f, float (*places)[3], size_t n, uint32_t (*faces)[3], size_t n_faces,
                               conic_triangles *mesh) {
  conic_model model = {.n_triangles = n_faces};
  conic_estimate_options options;
  conic_patches_options laying;
  conic_patches *patches;
  CHECK_OK(conic_triangles_allocate(f->context, n_faces, n, 0, mesh));
  CHECK_OK(conic_splats_allocate(f->context, n, 0, &model.points));
  for (size_t i = 0; i < 3 * n; i++)
    mesh->position[i % 3][i / 3] = model.points.position[i % 3][i / 3] = places[i / 3][i % 3];
  memcpy(mesh->corners, faces, n_faces * sizeof *faces);
  model.triangles = mesh->corners;
  CHECK_OK(conic_triangles_crease(f->context, mesh, 30.0));
  conic_estimate_options_init(&options);
  options.stays_at_mesh = 1;
  CHECK_OK(conic_model_to_splats(f->context, &options, &model, NULL));
  conic_splats_release(f->context, &f->splats);
  f->splats = model.points;
  conic_patches_options_init(&laying);
  laying.mesh = mesh;
  CHECK_OK(conic_patches_create(f->context, &f->splats, &laying, &patches));
  return patches;
}

/* Few vertices of a torus: patches are as round as those of bare points, and go through the vertices. */
static void test_mesh(fixture *f) {
  enum { N = 50, M = 20 };
  static const double target[3] = {0.4, 0.38, 1.0}, direction[3] = {0.1, -0.6, -1.0};
  static float places[N * M][3];
  static uint32_t faces[2 * N * M][3];
  conic_triangles mesh;
  conic_patches_report report;
  for (int i = 0; i < N * M; i++) {
    double a = 2.0 * acos(-1.0) * (i / M) / N, b = 2.0 * acos(-1.0) * (i % M) / M, out = 1.0 + 0.4 * cos(b);
    const double place[3] = {out * cos(a), 0.4 * sin(b), out * sin(a)};
    uint32_t along = (uint32_t)((i / M + 1) % N * M), here = (uint32_t)(i / M * M), next = (uint32_t)(i % M + 1) % M;
    const uint32_t quad[4] = {(uint32_t)i, here + next, along + next, along + (uint32_t)(i % M)};
    for (int k = 0; k < 3; k++) {
      places[i][k] = (float)place[k];
      faces[2 * i][k] = quad[k];
      faces[2 * i + 1][k] = quad[(k + 2) % 4];
    }
  }
  conic_patches *patches = lay_mesh(f, places, N * M, faces, 2 * N * M, &mesh);
  conic_patches_describe(patches, &report);
  look_at(f, target, direction, 3.0, 300.0);
  trace_rays(f);
  f->options.epsilon = 16.0 * report.mesh_off;
  fixture_render(f);
  picture_error splats = judge(f);
  conic_patch_selection selection = draw(f, patches);
  picture_error drawn = judge(f);
  printf(
      "torus of 1,000 vertices: normals off by %.3f deg rms (99 %%: %.3f) as splats, %.3f (%.3f) as %zu patches of %zu "
      "samples, %d holes, %g off\n",
      splats.normal_rms, splats.normal_p99, drawn.normal_rms, drawn.normal_p99, selection.n_patches,
      selection.n_samples, drawn.n_holes, report.mesh_off);
  CHECK(report.n_patches == N * M && selection.n_splats == 0);
  CHECK(drawn.normal_rms < 0.5 && splats.normal_rms > 4.0 && drawn.n_holes == 0);
  CHECK(report.mesh_off > 0.0 && report.mesh_off < 5e-3);
  for (size_t i = 0; i < selection.splats.count; i++)
    CHECK(selection.points[i] < N * M); /* a patch is that of the vertex, whatever its splats are */
  conic_patches_destroy(patches);
  conic_triangles_release(f->context, &mesh);
}

/* A cube's faces stay flat, and end where they meet: three patches a corner, one a face. */
static void test_creases(fixture *f) {
  static const double target[3] = {0.0, 0.0, 0.0}, direction[3] = {-0.7, -0.6, -1.0};
  static uint32_t faces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                  {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  float places[8][3];
  conic_triangles mesh;
  int n_off = 0, n_covered = 0;
  for (int i = 0; i < 24; i++)
    places[i / 3][i % 3] = i / 3 >> i % 3 & 1 ? 0.5f : -0.5f;
  conic_patches *patches = lay_mesh(f, places, 8, faces, 12, &mesh);
  look_at(f, target, direction, 3.0, 200.0);
  f->options.epsilon = 1e-3;
  conic_patch_selection selection = draw(f, patches);
  CHECK(selection.n_patches == 24 && selection.n_splats == 0 && selection.splats.n_clips > 24);
  for (int k = 0; k < 160 * 160; k++) {
    const float *drawn = fixture_pixel(f, CONIC_PLANE_NORMAL, k % 160, k / 160);
    double greatest = fmax(fmax(fabs((double)drawn[0]), fabs((double)drawn[1])), fabs((double)drawn[2]));
    if (((const uint32_t *)f->image.planes[CONIC_PLANE_ID])[k] == CONIC_NO_ID)
      continue;
    n_covered++;
    n_off += greatest < 0.9999;
  }
  printf("cube: %d of %d pixels between two faces' normals, %zu samples\n", n_off, n_covered, selection.n_samples);
  CHECK(n_covered > 6000 && n_off < 300); /* a pixel or two along the edges, which are 200 long */
  conic_patches_destroy(patches);
  conic_triangles_release(f->context, &mesh);
}

static void test_refusals(const fixture *f) {
  conic_patches_options options;
  conic_patches *patches;
  conic_patch_selection selection;
  conic_splats bare = f->splats;
  conic_patches_options_init(&options);
  options.step_px = 0.0;
  CHECK(conic_patches_create(f->context, &f->splats, &options, &patches) == CONIC_ERROR_ARGUMENT && !patches);
  conic_patches_options_init(&options);
  options.surface.type = CONIC_SURFACE_APSS;
  CHECK(conic_patches_create(f->context, &f->splats, &options, &patches) == CONIC_ERROR_ARGUMENT && !patches);
  conic_patches_options_init(&options);
  for (int axis = 0; axis < 3; axis++)
    bare.tangent_u[axis] = bare.tangent_v[axis] = NULL;
  CHECK(conic_patches_create(f->context, &bare, &options, &patches) == CONIC_ERROR_ARGUMENT && !patches);
  options.cutoff = 3.0f;
  CHECK_OK(conic_patches_create(f->context, &f->splats, &options, &patches));
  CHECK(conic_patches_select(patches, &f->camera, &f->options, &selection) == CONIC_ERROR_ARGUMENT);
  conic_patches_destroy(patches);
}

int main(void) {
  fixture f = fixture_open(2);
  test_grids();
  test_smoothness(&f);
  test_near(&f);
  test_far(&f);
  test_bits();
  test_culling(&f);
  test_failures(&f);
  test_mesh(&f);
  test_creases(&f);
  test_refusals(&f);
  fixture_close(&f);
  return check_result();
}
