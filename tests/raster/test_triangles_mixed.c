/* Splats and triangles in one picture: no fringe, no hole, no seam; one set of bits. */
#include <unistd.h>

#include "core/lanes/instruction_sets.h"
#include "tests/support/deep_file.h"
#include "tests/support/triangle_fixture.h"

/* The square [-1, 1]² in z = 0: its left half splats, its right half two triangles, all of one colour. */
static conic_triangles fill_halves(fixture *f, int n) {
  const double step = 1.0 / n, sigma = step * 0.9;
  fixture_splats(f, 2 * (size_t)n * (size_t)n);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < 2 * n; j++) {
      const double p[3] = {-1.0 + (i + 0.5) * step, -1.0 + (j + 0.5) * step, 0.0};
      const double u[3] = {sigma, 0, 0}, v[3] = {0, sigma, 0};
      fixture_set(f, 2 * (size_t)n * (size_t)i + (size_t)j, p, u, v, 0.3f, 0.6f, 0.9f);
    }
  conic_triangles t = triangles_make(f, 2, 4, CONIC_TRIANGLES_COLORS);
  for (size_t i = 0; i < 4; i++) {
    triangles_vertex(&t, i, i & 1 ? 1.0 : 0.0, i & 2 ? 1.0 : -1.0, 0.0);
    t.color[0][i] = 0.3f;
    t.color[1][i] = 0.6f;
    t.color[2][i] = 0.9f;
  }
  triangles_corner(&t, 0, 0, 1, 3);
  triangles_corner(&t, 1, 0, 3, 2);
  return t;
}

/* Where the ray through a pixel's centre meets z = 0, and the depth there. */
static double on_plane(const conic_camera *camera, int x, int y, double place[2]) {
  const double ray[3] = {(x + 0.5 - camera->cx) / camera->fx, (y + 0.5 - camera->cy) / camera->fy, 1.0};
  double o[3] = {0, 0, 0}, d[3] = {0, 0, 0};
  for (int axis = 0; axis < 3; axis++)
    for (int row = 0; row < 3; row++) {
      o[axis] -= camera->cam_from_world[row][axis] * camera->cam_from_world[row][3];
      d[axis] += camera->cam_from_world[row][axis] * ray[row];
    }
  double t = -o[2] / d[2];
  place[0] = o[0] + t * d[0];
  place[1] = o[1] + t * d[1];
  return t;
}

static void check_halves(fixture *f, const conic_triangles *t, double elevation, double azimuth, conic_method method) {
  conic_framing framing;
  const double low[3] = {-1, -1, 0}, high[3] = {1, 1, 0};
  size_t n_inside = 0, n_mixed = 0, n_wrong = 0;
  double worst_color = 0.0, worst_z = 0.0, worst_normal = 0.0;
  conic_framing_init(&framing);
  framing.width = framing.height = 160;
  framing.azimuth_deg = azimuth;
  framing.elevation_deg = elevation;
  CHECK_OK(conic_camera_frame(f->context, &framing, low, high, &f->camera));
  f->options.method = method;
  CHECK_OK(triangles_render(f, t, 1));
  for (int y = 0; y < 160; y++)
    for (int x = 0; x < 160; x++) {
      double place[2], z = on_plane(&f->camera, x, y, place);
      if (!(fabs(place[0]) < 0.98 && fabs(place[1]) < 0.98 && z > 0.0))
        continue;
      n_inside++;
      if (fixture_index(f, CONIC_PLANE_ID, x, y) == CONIC_NO_ID) {
        n_wrong++;
        continue;
      }
      const float *color = fixture_pixel(f, CONIC_PLANE_ALBEDO, x, y), expected[3] = {0.3f, 0.6f, 0.9f};
      float weight = *fixture_pixel(f, CONIC_PLANE_WEIGHT, x, y);
      n_mixed += place[0] > 0.0 && fixture_index(f, CONIC_PLANE_COUNT, x, y) > 1 && weight > 1.0f;
      for (int channel = 0; channel < 3; channel++)
        worst_color = fmax(worst_color, fabs((double)color[channel] - (double)expected[channel]));
      worst_z = fmax(worst_z, fabs((double)*fixture_pixel(f, CONIC_PLANE_Z, x, y) / z - 1.0));
      worst_normal = fmax(worst_normal, fabs(fabs((double)fixture_pixel(f, CONIC_PLANE_NORMAL, x, y)[2]) - 1.0));
    }
  printf("%s at %g: %zu inside, %zu mixed, colour %.1e, Z %.1e\n", conic_method_name(method), elevation, n_inside,
         n_mixed, worst_color, worst_z);
  CHECK(n_wrong == 0 && n_inside > 1000 && n_mixed > 50);
  CHECK(worst_color < 1e-6);
  CHECK(worst_normal < 1e-6);
  CHECK(worst_z < 1e-4); /* corners are moved by up to 1/512 px */
}

static void check_seam(void) {
  static const double angles[4][2] = {{0, 0}, {40, 30}, {70, 10}, {-20, 60}};
  fixture f = fixture_open(2);
  conic_triangles t = fill_halves(&f, 24);
  for (int i = 0; i < 4; i++) {
    check_halves(&f, &t, angles[i][0], angles[i][1], CONIC_METHOD_CONIC);
    check_halves(&f, &t, angles[i][0], angles[i][1], CONIC_METHOD_RAY);
  }
  conic_triangles_release(f.context, &t);
  fixture_close(&f);
}

/* A triangle before, between and behind two sheets of splats: who is seen, and what the planes say. */
static void check_order(void) {
  fixture f = fixture_open(1);
  conic_triangles t = triangles_make(&f, 1, 3, CONIC_TRIANGLES_COLORS);
  const double near_sheet[3] = {0, 0, 2.0}, far_sheet[3] = {0, 0, 3.0}, u[3] = {4, 0, 0}, v[3] = {0, 4, 0};
  fixture_camera(&f, 16, 16, 16.0);
  fixture_splats(&f, 2);
  fixture_set(&f, 0, near_sheet, u, v, 1, 0, 0);
  fixture_set(&f, 1, far_sheet, u, v, 0, 1, 0);
  f.options.epsilon = 0.01;
  triangles_corner(&t, 0, 0, 1, 2);
  for (int depth = 0; depth < 4; depth++) {
    static const double depths[4] = {1.0, 2.0, 2.5, 3.5};
    for (size_t i = 0; i < 3; i++) {
      triangles_vertex(&t, i, i == 1 ? 30.0 : -15.0, i == 2 ? 30.0 : -15.0, depths[depth]);
      t.color[0][i] = t.color[1][i] = 0.0f;
      t.color[2][i] = 1.0f;
    }
    for (int passes = 1; passes <= 3; passes += 2) {
      f.options.passes = passes;
      CHECK_OK(triangles_render(&f, &t, 1));
      const float *color = fixture_pixel(&f, CONIC_PLANE_ALBEDO, 8, 8);
      uint32_t id = fixture_index(&f, CONIC_PLANE_ID, 8, 8), count = fixture_index(&f, CONIC_PLANE_COUNT, 8, 8);
      int is_blended = depth == 1 && passes == 3, is_triangle = depth == 0 || (depth == 1 && passes == 1);
      if (depth == 1) /* equally near: the splat comes first */
        is_triangle = 0;
      CHECK(id == (is_triangle ? 2u : 0u));
      CHECK(count == (is_blended ? 2u : 1u));
      CHECK(is_blended ? color[0] > 0.3f && color[2] > 0.3f && color[1] == 0.0f
                       : color[is_triangle ? 2 : 0] == 1.0f && color[is_triangle ? 0 : 2] == 0.0f);
      CHECK_NEAR(*fixture_pixel(&f, CONIC_PLANE_Z, 8, 8), depth == 0 ? 1.0 : 2.0, 1e-6);
    }
  }
  conic_triangles_release(f.context, &t);
  fixture_close(&f);
}

static void hash_all(const fixture *f, uint64_t hashes[CONIC_N_DRAWN_PLANES + 1]) {
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    hashes[plane] = conic_image_hash(&f->image, (conic_plane)plane);
  hashes[CONIC_N_DRAWN_PLANES] = f->statistics.triangle_fragments * 1000003u + f->statistics.pixels_covered;
}

/* Threads, tiles and instruction sets change nothing; with splats and without, blended and not. */
static void check_identity(void) {
  static const int thread_counts[] = {1, 3};
  uint64_t expected[2][2][2][CONIC_N_DRAWN_PLANES + 1];
  for (int i_threads = 0; i_threads < 2; i_threads++) {
    fixture f = fixture_open(thread_counts[i_threads]);
    for (int has_splats = 0; has_splats < 2; has_splats++) {
      if (has_splats)
        triangles_torus_of_splats(&f, 3000);
      fixture_camera(&f, 211, 149, 120.0);
      f.camera.cam_from_world[2][3] = has_splats ? 3.0 : 0.0;
      f.options.near_z = 0.05;
      f.options.shading = CONIC_SHADE_PHONG;
      conic_triangles t = triangles_wild(&f, 2500);
      for (int variant = 0; variant < 2 * CONIC_N_ISAS * 4; variant++) {
        int isa = variant / 2 % CONIC_N_ISAS, samples = variant / 2 / CONIC_N_ISAS == 3 ? 2 : 1;
        uint64_t hashes[CONIC_N_DRAWN_PLANES + 1], *of_first = expected[has_splats][variant % 2][samples - 1];
        if (!conic_isa_is_here((conic_isa)isa) || (samples > 1 && isa > 2))
          continue;
        f.options.passes = variant % 2 ? 1 : 3;
        f.options.isa = (conic_isa)isa;
        f.options.tile = 8 << variant / 2 / CONIC_N_ISAS;
        CHECK_OK(triangles_render(&f, &t, samples));
        hash_all(&f, hashes);
        if (i_threads == 0 && isa == 0 && (f.options.tile == 8 || samples == 2))
          memcpy(of_first, hashes, sizeof hashes);
        CHECK(memcmp(of_first, hashes, sizeof hashes) == 0);
        CHECK(f.statistics.triangles_skipped == 1 && f.statistics.triangle_fragments > 10000);
      }
      conic_triangles_release(f.context, &t);
    }
    fixture_close(&f);
  }
}

/* Every plane is defined on every pixel, whatever is in it. */
static void check_defined(void) {
  fixture f = fixture_open(1);
  triangles_torus_of_splats(&f, 2000);
  fixture_camera(&f, 120, 90, 80.0);
  f.camera.cam_from_world[2][3] = 3.0;
  conic_triangles t = triangles_wild(&f, 800);
  size_t n_triangles = 0, n_splats = 0;
  CHECK_OK(triangles_render(&f, &t, 1));
  for (int y = 0; y < 90; y++)
    for (int x = 0; x < 120; x++) {
      uint32_t id = fixture_index(&f, CONIC_PLANE_ID, x, y);
      const float *n = fixture_pixel(&f, CONIC_PLANE_NORMAL, x, y);
      float z = *fixture_pixel(&f, CONIC_PLANE_Z, x, y), weight = *fixture_pixel(&f, CONIC_PLANE_WEIGHT, x, y);
      int is_covered = id != CONIC_NO_ID;
      n_triangles += is_covered && id >= 2000;
      n_splats += is_covered && id < 2000;
      CHECK(is_covered ? z > 0.0f && z * 0.0f == 0.0f && weight > 0.0f : z == 0.0f && weight == 0.0f);
      CHECK_NEAR(sqrt((double)n[0] * (double)n[0] + (double)n[1] * (double)n[1] + (double)n[2] * (double)n[2]),
                 is_covered ? 1.0 : 0.0, 1e-5);
      CHECK(!is_covered || id < 2800);
    }
  printf("defined: %zu triangles, %zu splats\n", n_triangles, n_splats);
  CHECK(n_triangles > 500 && n_splats > 500);
  conic_triangles_release(f.context, &t);
  fixture_close(&f);
}

/* What is said of a pixel adds up to it, in a deep image, too. */
static void check_explained(int passes, const char *folder) {
  fixture f = fixture_open(1);
  conic_contributions *c;
  size_t n_hidden = 0, n_mixed = 0;
  triangles_torus_of_splats(&f, 2000);
  fixture_camera(&f, 120, 90, 80.0);
  f.camera.cam_from_world[2][3] = 3.0;
  f.options.passes = passes;
  f.options.epsilon = 0.2;
  conic_triangles t = triangles_wild(&f, 800);
  const conic_drawing drawing = {&f.splats, &t};
  CHECK_OK(triangles_render(&f, &t, 1));
  CHECK_OK(conic_contributions_create_drawing(f.context, &drawing, &f.camera, &f.options, &c));
  for (int y = 0; y < 90; y++)
    for (int x = 0; x < 120; x++) {
      const conic_contribution *splats;
      const conic_triangle_contribution *triangles;
      size_t n_splats, n_triangles;
      float weight = 0.0f, nearest = 0.0f;
      uint32_t count = 0, id = CONIC_NO_ID;
      CHECK_OK(conic_contributions_at(c, x, y, &splats, &n_splats));
      CHECK_OK(conic_contributions_triangles_at(c, x, y, &triangles, &n_triangles));
      for (size_t i = 0; i < n_splats; i++)
        if (splats[i].verdict == CONIC_CONTRIBUTION_VISIBLE) {
          weight += splats[i].weight;
          count++;
          id = splats[i].inverse_depth > nearest ? splats[i].splat : id;
          nearest = splats[i].inverse_depth > nearest ? splats[i].inverse_depth : nearest;
        }
      for (size_t i = 0; i < n_triangles; i++) {
        n_hidden += triangles[i].verdict == CONIC_CONTRIBUTION_HIDDEN;
        if (triangles[i].verdict != CONIC_CONTRIBUTION_VISIBLE)
          continue;
        n_mixed += count > 0;
        weight += 1.0f;
        count++;
        id = triangles[i].inverse_depth > nearest ? 2000 + triangles[i].triangle : id;
      }
      CHECK(weight == *fixture_pixel(&f, CONIC_PLANE_WEIGHT, x, y));
      CHECK(count == fixture_index(&f, CONIC_PLANE_COUNT, x, y));
      CHECK(id == fixture_index(&f, CONIC_PLANE_ID, x, y));
    }
  printf("explained: %zu hidden triangles, %zu among splats\n", n_hidden, n_mixed);
  CHECK(n_hidden > 50 && (n_mixed > 10 || passes == 1));
  deep_counts deep;
  if (deep_check(&f, &drawing, folder, &deep))
    CHECK(deep.n_splats > 500 && deep.n_triangles > 500 && deep.n_mixed == n_mixed);
  conic_contributions_destroy(c);
  conic_triangles_release(f.context, &t);
  fixture_close(&f);
}

/* A drawing without triangles is conic_render's picture. */
static void check_splats_alone(void) {
  fixture f = fixture_open(1);
  uint64_t alone[CONIC_N_DRAWN_PLANES + 1], drawn[CONIC_N_DRAWN_PLANES + 1];
  conic_triangles none;
  memset(&none, 0, sizeof none);
  fixture_scene(&f, CONIC_SCENE_KNOT, 5000);
  fixture_camera(&f, 100, 100, 80.0);
  f.camera.cam_from_world[2][3] = 3.0;
  fixture_render(&f);
  hash_all(&f, alone);
  CHECK_OK(triangles_render(&f, &none, 1));
  hash_all(&f, drawn);
  CHECK(memcmp(alone, drawn, sizeof alone) == 0);
  fixture_close(&f);
}

int main(void) {
  char folder[FOLDER_ROOM];
  folder_make(folder);
  check_seam();
  check_order();
  check_identity();
  check_defined();
  check_explained(3, folder);
  check_explained(1, folder);
  check_splats_alone();
  rmdir(folder);
  return check_result();
}
