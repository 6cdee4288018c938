/* Coverage of triangles: exact, whatever they are, and every sample inside a closed mesh once. */
#include "tests/support/triangle_fixture.h"

/* Closed meshes from all sides, at sizes from triangles of many pixels down to many a pixel: what faces the viewer
 * covers as many samples as what faces away, and a convex mesh covers each pixel once. */
static void check_closed(void) {
  fixture f = fixture_open(2);
  for (int shape = 0; shape < 3; shape++) {
    int n = shape == 2 ? 240 : 24;
    conic_triangles t = triangles_torus(&f, n, shape == 2 ? 90 : 16, shape == 0 ? 0.6 : 0.3);
    for (int i = 0; i < 26; i++) {
      triangles_camera(&f, i, i % 3 == 0 ? 40 : 111);
      f.options.cull_back = 0;
      CHECK_OK(triangles_render(&f, &t, 1));
      uint64_t all = f.statistics.triangle_fragments, pixels = f.statistics.pixels_covered;
      f.options.cull_back = 1;
      CHECK_OK(triangles_render(&f, &t, 1));
      CHECK(2 * f.statistics.triangle_fragments == all);
      CHECK(f.statistics.pixels_covered == pixels && pixels > 100);
    }
    conic_triangles_release(f.context, &t);
  }
  fixture_close(&f);
}

/* A cube's corners moved about, its faces still planar enough to be convex: each pixel once. */
static void check_convex(void) {
  fixture f = fixture_open(1);
  conic_triangles t = triangles_make(&f, 20, 12, 0);
  const double g = 1.618033988749895;
  static const uint32_t faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                        {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                        {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                        {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int i = 0; i < 12; i++) {
    double a = i & 1 ? 1.0 : -1.0, b = i & 2 ? -g : g, p[3] = {0, 0, 0};
    int axis = i / 4; /* (±1, ±g, 0), (0, ±1, ±g), (±g, 0, ±1) */
    p[axis] = 0.7 * a;
    p[(axis + 1) % 3] = 0.7 * b;
    triangles_vertex(&t, (size_t)i, p[0], p[1], p[2]);
  }
  for (size_t i = 0; i < 20; i++)
    triangles_corner(&t, i, faces[i][0], faces[i][1], faces[i][2]);
  f.options.cull_back = 1;
  for (int i = 0; i < 26; i++) {
    triangles_camera(&f, i, 97);
    CHECK_OK(triangles_render(&f, &t, 1));
    CHECK(f.statistics.pixels_covered > 1000);
    CHECK(f.statistics.triangle_fragments == f.statistics.pixels_covered);
  }
  conic_triangles_release(f.context, &t);
  fixture_close(&f);
}

/* Whether a triangle of corners in 1/256 px covers a sample, in 128 bits and by the words of the definition: inside, or
 * on an edge that is top (level, the inside below) or left (the inside to its right). */
static int covers(const int64_t x[3], const int64_t y[3], int64_t px, int64_t py) {
  __int128 area = (__int128)(x[1] - x[0]) * (y[2] - y[0]) - (__int128)(x[2] - x[0]) * (y[1] - y[0]);
  if (area == 0)
    return 0;
  for (int k = 0; k < 3; k++) {
    int a = k, b = (k + 1) % 3, c = (k + 2) % 3;
    __int128 side = (__int128)(x[b] - x[a]) * (py - y[a]) - (__int128)(px - x[a]) * (y[b] - y[a]);
    if (area < 0)
      side = -side;
    if (side > 0)
      continue;
    int is_top = y[a] == y[b] && y[c] > y[a];
    /* right of an edge that is not level, at the third corner's height: is the corner? */
    __int128 right =
        ((__int128)(x[c] - x[a]) * (y[b] - y[a]) - (__int128)(y[c] - y[a]) * (x[b] - x[a])) * (y[b] > y[a] ? 1 : -1);
    int is_left = y[a] != y[b] && right > 0;
    if (side < 0 || !(is_top || is_left))
      return 0;
  }
  return 1;
}

static int64_t random_place(uint64_t *state, int kind) {
  double u = fixture_random(state);
  if (kind == 0) /* around the image, often on samples and each other's lines */
    return (int64_t)(u * 40.0) * 128;
  if (kind == 1) /* small */
    return 4000 + (int64_t)(u * 900.0);
  if (kind == 2)
    return (int64_t)(u * 16000.0) - 3000;
  return (int64_t)((u - 0.5) * 2.0 * (kind == 3 ? 8.0e6 : 1.6e7)); /* huge: floats hold it */
}

/* Random triangles, each alone: the covered pixels are those of the definition, for every instruction set. */
static void check_soup(void) {
  enum { WIDTH = 37, HEIGHT = 29, COUNT = 1500 };
  fixture f = fixture_open(1);
  conic_triangles t = triangles_make(&f, 1, 3, 0);
  uint64_t state = 11;
  size_t n_wrong = 0, n_covered = 0;
  fixture_camera(&f, WIDTH, HEIGHT, 1.0);
  f.camera.cx = f.camera.cy = 0.0;
  f.options.near_z = 0.5;
  triangles_corner(&t, 0, 0, 1, 2);
  for (int i = 0; i < COUNT; i++) {
    int64_t x[3], y[3];
    for (int k = 0; k < 3; k++) {
      x[k] = random_place(&state, i % 5);
      y[k] = random_place(&state, i % 5);
      triangles_vertex(&t, (size_t)k, (double)x[k] / 256.0, (double)y[k] / 256.0, 1.0);
    }
    f.options.isa = (conic_isa)(CONIC_ISA_SCALAR + i / 5 % 4);
    f.options.tile = 8 << i % 4;
    if (triangles_render(&f, &t, 1) != CONIC_OK)
      continue; /* this machine has not got the instructions */
    for (int py = 0; py < HEIGHT; py++)
      for (int px = 0; px < WIDTH; px++) {
        int is_covered = fixture_index(&f, CONIC_PLANE_ID, px, py) == 0;
        n_covered += (size_t)is_covered;
        n_wrong += is_covered != covers(x, y, px * 256 + 128, py * 256 + 128);
      }
  }
  printf("soup: %zu covered, %zu wrong\n", n_covered, n_wrong);
  CHECK(n_wrong == 0 && n_covered > 50000);
  conic_triangles_release(f.context, &t);
  fixture_close(&f);
}

/* A floor of many triangles on which the camera stands, so that some reach near and some the guard band: what is below
 * the horizon is covered once. */
static void check_near(void) {
  enum { N = 9 };
  fixture f = fixture_open(1);
  conic_triangles t = triangles_make(&f, 2 * N * N, (N + 1) * (N + 1), 0);
  uint64_t state = 5;
  for (uint32_t i = 0; i <= N; i++)
    for (uint32_t j = 0; j <= N; j++) {
      int is_inner = i > 0 && i < N && j > 0 && j < N;
      double shake = is_inner ? 300.0 : 0.0;
      triangles_vertex(&t, i * (N + 1) + j, 1000.0 * (2.0 * i / N - 1.0) + shake * (fixture_random(&state) - 0.5),
                       0.001, 1000.0 * (2.0 * j / N - 1.0) + shake * (fixture_random(&state) - 0.5));
      if (i < N && j < N) {
        uint32_t here = i * (N + 1) + j, cell = i * N + j;
        triangles_corner(&t, 2 * cell, here, here + 1, here + N + 2);
        triangles_corner(&t, 2 * cell + 1, here, here + N + 2, here + N + 1);
      }
    }
  fixture_camera(&f, 150, 90, 70.0);
  f.options.near_z = 1e-5;
  CHECK_OK(triangles_render(&f, &t, 1));
  CHECK(f.statistics.triangle_fragments == f.statistics.pixels_covered);
  CHECK(f.statistics.pixels_covered == 150 * 45);
  for (int x = 0; x < 150; x++) /* the horizon is the last row's upper border; corners are moved by up to 1/512 px */
    for (int y = 46; y < 90; y++) {
      double below = y + 0.5 - 45.0, z = 0.001 * 70.0 / below;
      CHECK_NEAR(*fixture_pixel(&f, CONIC_PLANE_Z, x, y), z, z / (512.0 * below) + 1e-6 * z);
    }
  f.options.near_z = 0.003; /* now cuts the floor in the picture */
  CHECK_OK(triangles_render(&f, &t, 1));
  CHECK(f.statistics.triangle_fragments == f.statistics.pixels_covered);
  CHECK(fixture_index(&f, CONIC_PLANE_ID, 75, 67) != CONIC_NO_ID);
  CHECK(fixture_index(&f, CONIC_PLANE_ID, 75, 70) == CONIC_NO_ID);
  conic_triangles_release(f.context, &t);
  fixture_close(&f);
}

/* What cannot be drawn is counted, and harms nothing. */
static void check_hostile(void) {
  fixture f = fixture_open(1);
  conic_triangles t = triangles_make(&f, 7, 10, CONIC_TRIANGLES_COLORS);
  fixture_camera(&f, 32, 32, 16.0);
  f.options.near_z = 0.1;
  for (size_t i = 0; i < 10; i++) {
    static const double places[10][3] = {{-2, -2, 1},     {2, -2, 1},   {0, 2, 1},      {NAN, 0, 1}, {INFINITY, 0, 1},
                                         {3e38, 3e38, 1}, {0, 0, 3e38}, {-1, -1, -0.5}, {1, 1, -1},  {1e-30, 0, 1}};
    triangles_vertex(&t, i, places[i][0], places[i][1], places[i][2]);
    t.color[0][i] = i == 0 ? NAN : 1.0f;
    t.color[1][i] = i == 1 ? INFINITY : 1.0f;
    t.color[2][i] = i == 2 ? -3e38f : 1.0f;
  }
  triangles_corner(&t, 0, 0, 1, 3); /* not finite */
  triangles_corner(&t, 1, 0, 1, 4);
  triangles_corner(&t, 2, 0, 1, 6); /* its inverse depth is no number that is held */
  triangles_corner(&t, 3, 7, 8, 7); /* behind */
  triangles_corner(&t, 4, 0, 0, 1); /* without area */
  triangles_corner(&t, 5, 0, 1, 5); /* far out */
  triangles_corner(&t, 6, 0, 1, 2);
  CHECK_OK(triangles_render(&f, &t, 1));
  CHECK(f.statistics.triangles_skipped == 3 && f.statistics.triangles_culled == 2 && f.statistics.triangles_drawn == 2);
  CHECK(f.statistics.pixels_covered > 400);
  for (int y = 0; y < 32; y++)
    for (int x = 0; x < 32; x++)
      for (int channel = 0; channel < 4; channel++)
        CHECK(fixture_pixel(&f, CONIC_PLANE_RGBA, x, y)[channel] * 0.0f == 0.0f);
  t.corners[2][1] = 10;
  CHECK(triangles_render(&f, &t, 1) == CONIC_ERROR_INPUT);
  conic_triangles_release(f.context, &t);
  CHECK_OK(triangles_render(&f, &t, 1)); /* nothing at all */
  CHECK(f.statistics.pixels_covered == 0);
  fixture_close(&f);
}

/* Depth, colour and normal of a triangle in perspective, against the plane that it lies in. */
static void check_attributes(void) {
  fixture f = fixture_open(1);
  conic_triangles t = triangles_make(&f, 2, 4, CONIC_TRIANGLES_COLORS | CONIC_TRIANGLES_NORMALS);
  fixture_camera(&f, 120, 80, 60.0);
  for (uint32_t i = 0; i < 4; i++) { /* colours and normals are affine in the place, so that all can be told from it */
    double u = i & 1 ? 1.0 : -1.0, v = i & 2 ? 1.0 : -1.0;
    triangles_vertex(&t, i, 2.0 * u, 1.0 + 0.2 * v, 4.0 + 3.0 * v);
    t.color[0][i] = (float)(0.5 + 0.5 * u);
    t.color[1][i] = (float)(0.5 + 0.5 * v);
    t.color[2][i] = 0.25f;
    t.normal[0][i] = (float)u;
    t.normal[1][i] = -3.0f;
    t.normal[2][i] = 0.0f;
  }
  triangles_corner(&t, 0, 0, 1, 3);
  triangles_corner(&t, 1, 0, 3, 2);
  for (int clips = 0; clips < 2; clips++) {
    f.options.near_z = clips ? 1.5 : 0.1;
    size_t n = 0;
    CHECK_OK(triangles_render(&f, &t, 1));
    for (int y = 0; y < 80; y++)
      for (int x = 0; x < 120; x++) {
        double dx = (x + 0.5 - 60.0) / 60.0, dy = (y + 0.5 - 40.0) / 60.0; /* y = 1 + 0.2v, z = 4 + 3v */
        double v = (4.0 * dy - 1.0) / (0.2 - 3.0 * dy), z = 4.0 + 3.0 * v, u = dx * z / 2.0;
        if (fixture_index(&f, CONIC_PLANE_ID, x, y) == CONIC_NO_ID)
          continue;
        const float *color = fixture_pixel(&f, CONIC_PLANE_ALBEDO, x, y);
        const float *normal = fixture_pixel(&f, CONIC_PLANE_NORMAL, x, y);
        double length = sqrt(u * u + 9.0);
        n++;
        /* snapping moves places by up to 1/512 px, which is the more in the plane the flatter one looks at it */
        CHECK_NEAR(*fixture_pixel(&f, CONIC_PLANE_Z, x, y), z, 0.004 * z);
        CHECK_NEAR(color[0], 0.5 + 0.5 * u, 0.004);
        CHECK_NEAR(color[1], 0.5 + 0.5 * v, 0.008);
        CHECK_NEAR(color[2], 0.25, 1e-7);
        CHECK_NEAR(normal[0], u / length, 0.004);
        CHECK_NEAR(normal[1], -3.0 / length, 0.004);
        CHECK(*fixture_pixel(&f, CONIC_PLANE_WEIGHT, x, y) == 1.0f);
      }
    printf("attributes: %zu pixels\n", n);
    CHECK(n > 700);
  }
  conic_triangles_release(f.context, &t);
  fixture_close(&f);
}

/* Real meshes from all sides: those that are closed cover with their fronts what they cover with their backs. */
static void check_real(const char *source_folder) {
  const char *path = check_data(source_folder, "fandisk.obj");
  conic_triangles t;
  if (!path)
    return;
  fixture f = fixture_open(2);
  double low[3], high[3];
  CHECK_OK(conic_triangles_read(f.context, path, &t));
  conic_triangles_bounds(&t, low, high);
  for (int i = 0; i < 26; i++) {
    triangles_camera(&f, i, 60);
    conic_framing framing;
    conic_framing_init(&framing);
    framing.width = framing.height = 60;
    framing.azimuth_deg = 37.0 * i;
    framing.elevation_deg = 7.0 * i - 90.0;
    CHECK_OK(conic_camera_frame(f.context, &framing, low, high, &f.camera));
    f.options.cull_back = 0;
    CHECK_OK(triangles_render(&f, &t, 1));
    uint64_t all = f.statistics.triangle_fragments;
    f.options.cull_back = 1;
    CHECK_OK(triangles_render(&f, &t, 1));
    CHECK(2 * f.statistics.triangle_fragments == all && all > 500);
  }
  conic_triangles_release(f.context, &t);
  fixture_close(&f);
}

/* Corner normals that lean away from the viewer, as they do at outlines, and that point through the face, as where a
 * file winds its faces the other way: what is seen faces the viewer and does not jump from pixel to pixel. */
static void check_leaning_normals(void) {
  static const double normals[3][3] = {{0.9, 0.1, -0.5}, {1.0, 0.0, 0.35}, {0.8, -0.3, -0.1}};
  for (int is_inside_out = 0; is_inside_out < 2; is_inside_out++) {
    fixture f = fixture_open(1);
    fixture_camera(&f, 64, 64, 64.0);
    conic_triangles t = triangles_make(&f, 1, 3, CONIC_TRIANGLES_NORMALS);
    triangles_vertex(&t, 0, -1.0, -1.0, 2.0);
    triangles_vertex(&t, 1, -0.9, 1.0, 2.0);
    triangles_vertex(&t, 2, 1.0, 0.0, 2.0);
    triangles_corner(&t, 0, 0, 1, 2);
    for (size_t k = 0; k < 3; k++)
      for (int axis = 0; axis < 3; axis++)
        t.normal[axis][k] = (float)(is_inside_out ? -normals[k][axis] : normals[k][axis]);
    CHECK_OK(triangles_render(&f, &t, 1));
    const float *n = f.image.planes[CONIC_PLANE_NORMAL];
    int n_covered = 0;
    for (int y = 0; y < 64; y++)
      for (int x = 1; x < 64; x++) {
        const float *here = n + 3 * (y * 64 + x), *left = here - 3;
        if (fixture_index(&f, CONIC_PLANE_ID, x, y) == CONIC_NO_ID)
          continue;
        double dx = (x + 0.5 - 32.0) / 64.0, dy = (y + 0.5 - 32.0) / 64.0;
        n_covered++;
        CHECK((double)here[0] * dx + (double)here[1] * dy + (double)here[2] < 1e-6);
        CHECK_NEAR((double)(here[0] * here[0] + here[1] * here[1] + here[2] * here[2]), 1.0, 1e-5);
        if (fixture_index(&f, CONIC_PLANE_ID, x - 1, y) != CONIC_NO_ID)
          for (int axis = 0; axis < 3; axis++)
            CHECK_NEAR((double)here[axis], (double)left[axis], 0.1);
      }
    CHECK(n_covered > 500);
    conic_triangles_release(f.context, &t);
    fixture_close(&f);
  }
}

int main(int argc, char **argv) {
  check_closed();
  check_convex();
  check_soup();
  check_near();
  check_hostile();
  check_attributes();
  check_leaning_normals();
  check_real(argc > 1 ? argv[1] : ".");
  return check_result();
}
