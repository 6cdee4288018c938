/* Scenes that break other renderers: surfaces nearer to each other than the depth tolerance, tolerances of all sizes,
 * dust, other orders of the same splats, other places and scales of the same scene (docs/reference/accuracy.md). */
#include "tests/support/stability.h"

static const float red[3] = {1, 0, 0};

static void straight(fixture *f, int width, int height, double focal_px) {
  conic_render_options_init(&f->options);
  f->options.shading = CONIC_SHADE_NONE;
  f->options.near_z = 1e-3;
  fixture_camera(f, width, height, focal_px);
}

/* The largest green, which is the back wall's alone, over the middle of the picture. */
static double largest_bleeding(const fixture *f) {
  double worst = 0.0;
  for (int y = f->image.height / 4; y < f->image.height * 3 / 4; y++)
    for (int x = f->image.width / 4; x < f->image.width * 3 / 4; x++)
      worst = fmax(worst, (double)fixture_pixel(f, CONIC_PLANE_RGBA, x, y)[1]);
  return worst;
}

/* Two walls. Farther apart than ε, nothing of the back one shows; nearer, they are one surface and blend, unless a
 * smaller ε is asked for. ε is the outline's radius. */
static void test_walls(fixture *f) {
  static const struct {
    const char *name;
    double gap; /* in ε */
    double epsilon, least, most;
    double unstable; /* without ε, discs of one plane are as near as each other: all hangs on roundings */
  } cases[] = {
      {"walls 2 tolerances apart", 2.0, -1.0, 0.0, 0.0, 0.02},
      {"walls 1.05 tolerances apart", 1.05, -1.0, 0.0, 0.0, 0.02},
      {"walls half a tolerance apart", 0.5, -1.0, 0.3, 0.7, 0.02},
      {"walls half a tolerance apart, smaller epsilon", 0.5, 0.02, 0.0, 0.0, 0.02},
      {"walls half a tolerance apart, epsilon 0", 0.5, 0.0, 0.0, 0.0, 1.0},
      {"walls 2 tolerances apart, larger epsilon", 2.0, 0.3, 0.3, 0.7, 0.02},
  };
  enum { N = 24 };
  straight(f, 96, 96, 90.0);
  for (int k = 0; k < 6; k++) {
    double outline = 1.5 * 2.0 / N;
    stability_sheet front = stability_wall(2.0, N, 1.0f, 0.0f, 0.0f);
    stability_sheet back = stability_wall(2.0 + cases[k].gap * outline, N, 0.0f, 1.0f, 0.0f);
    back.center[0] = 0.3 / N; /* not disc behind disc */
    fixture_splats(f, 2 * N * N);
    stability_fill(f, stability_fill(f, 0, &front), &back);
    f->options.epsilon = cases[k].epsilon;
    stability_agree(f, cases[k].name, cases[k].unstable);
    for (int method = 0; method < CONIC_N_METHODS; method++) {
      if (!stability_fills(method))
        continue;
      f->options.method = (conic_method)method;
      fixture_render(f);
      double bleeding = largest_bleeding(f);
      printf("%-44s %-7s the back wall's share is %.3f\n", cases[k].name, conic_method_name((conic_method)method),
             bleeding);
      CHECK(bleeding >= cases[k].least && bleeding <= cases[k].most);
    }
  }
}

/* Two sheets through each other: each is seen where it is nearer, and they blend within ε of the line where they meet.
 */
static void test_interpenetration(fixture *f) {
  enum { N = 32 };
  straight(f, 112, 96, 100.0);
  stability_sheet a = {{0, 0, 2.5}, {0.8, 0, 0.6}, {0, 1, 0}, N, 1.5, 0, {{1, 0, 0}, {1, 0, 0}}};
  stability_sheet b = {{0, 0, 2.5}, {0.8, 0, -0.6}, {0, 1, 0}, N, 1.5, 0, {{0, 1, 0}, {0, 1, 0}}};
  fixture_splats(f, 2 * N * N);
  stability_fill(f, stability_fill(f, 0, &a), &b);
  stability_agree(f, "sheets through each other", 0.03);
  double epsilon = 1.5 * 2.0 / N;
  for (int x = 20; x < 92; x++) {
    double s = (x + 0.5 - 56.0) / 100.0, z_a = 2.5 / (1.0 - 0.75 * s), z_b = 2.5 / (1.0 + 0.75 * s);
    const float *color = fixture_pixel(f, CONIC_PLANE_RGBA, x, 48);
    if (fabs(z_a - z_b) * sqrt(1.0 + s * s) > 1.2 * epsilon) { /* 1.2: the ray meets tilted discs elsewhere */
      CHECK(color[z_a < z_b] == 0.0f);
      CHECK(color[!(z_a < z_b)] > 0.999f);
    }
  }
}

/* ε of all kinds over a closed surface: none makes a hole, and the oracle agrees. */
static void test_epsilons(fixture *f) {
  static const double epsilons[] = {0.0, 1e-12, 1e-4, 0.5, 1e6};
  straight(f, 96, 96, 100.0);
  f->camera.cam_from_world[2][3] = 3.0;
  fixture_scene(f, CONIC_SCENE_SPHERE, 1500);
  size_t covered = 0;
  for (int k = 0; k < 5; k++) {
    char name[60];
    f->options.epsilon = epsilons[k];
    snprintf(name, sizeof name, "a sphere with epsilon %g", epsilons[k]);
    stability_agree(f, name, 0.02);
    covered = k ? covered : stability_covered(f);
    CHECK(stability_covered(f) == covered);
    for (int y = 0; y < 96; y++)
      for (int x = 0; x < 96; x++)
        CHECK(stability_covers(&f->image, x, y) || hypot(x - 47.5, y - 47.5) > 34.0); /* its outline is at 35.4 */
  }
}

/* One disc a hundred times the others', a wall behind it, and dust: the giant's ε is capped by the others' sizes, so it
 * hides what is six of their outlines behind it; dust keeps its own. */
static void test_mixed_sizes(fixture *f) {
  enum { N = 30 };
  double outline = 1.5 * 2.0 / N;
  straight(f, 96, 96, 100.0);
  stability_sheet wall = stability_wall(2.0 + 6.0 * outline, N, 0.0f, 1.0f, 0.0f);
  fixture_splats(f, N * N + 1 + 200);
  size_t next = stability_fill(f, 0, &wall);
  const double p[3] = {0, 0, 2.0}, tu[3] = {100 * outline, 0, 0}, tv[3] = {0, 100 * outline, 0};
  fixture_set(f, next++, p, tu, tv, red[0], red[1], red[2]);
  for (int i = 0; i < 200; i++) { /* dust just behind the giant, nearer than its ε, in its colour */
    const double q[3] = {0.05 * (i % 20) - 0.5, 0.1 * (i / 20.0) - 0.5, 2.0 + 2.0 * outline};
    const double du[3] = {1e-4, 0, 0}, dv[3] = {0, 1e-4, 0};
    fixture_set(f, next++, q, du, dv, red[0], red[1], red[2]);
  }
  /* The giant is frontal: by `ray`, its range of depths is narrower than the oracle's bound of what roundings make of
   * it, so that all its pixels are in doubt. */
  stability_agree_but(f, "huge and tiny tolerances mixed", 0.02, "ray");
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    if (!stability_fills(method))
      continue;
    f->options.method = (conic_method)method;
    fixture_render(f);
    CHECK(largest_bleeding(f) == 0.0);
  }
}

/* One splat of dust before a wall: an opaque dot of the prefilter's width, and not a bit of any other pixel. */
static void test_dust(fixture *f) {
  enum { N = 24 };
  straight(f, 96, 96, 100.0);
  stability_sheet wall = stability_wall(2.0, N, 0.2f, 0.8f, 0.4f);
  fixture_splats(f, N * N + 1);
  const double p[3] = {0.011, 0.017, 1.2}, tu[3] = {1e-6, 0, 0}, tv[3] = {0, 1e-6, 0};
  fixture_set(f, stability_fill(f, 0, &wall), p, tu, tv, red[0], red[1], red[2]);
  stability_agree(f, "a stray splat of dust", 0.02);
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    if (!stability_fills(method))
      continue;
    size_t n_changed = 0;
    f->options.method = (conic_method)method;
    conic_image with = stability_draw(f);
    f->splats.count--;
    fixture_render(f);
    f->splats.count++;
    for (int y = 0; y < 96; y++)
      for (int x = 0; x < 96; x++)
        n_changed += memcmp((const float *)with.planes[CONIC_PLANE_RGBA] + 4 * (96 * y + x),
                            fixture_pixel(f, CONIC_PLANE_RGBA, x, y), 4 * sizeof(float)) != 0;
    printf("%-44s %-7s changes %zu pixels\n", "a stray splat of dust", conic_method_name((conic_method)method),
           n_changed);
    CHECK(n_changed >= 4 && n_changed <= 9);
    conic_image_release(f->context, &with);
  }
}

static void reverse(fixture *f) {
  float **arrays[] = {f->splats.position, f->splats.tangent_u, f->splats.tangent_v, f->splats.color};
  size_t n = f->splats.count;
  for (int k = 0; k < 4; k++)
    for (int c = 0; c < 3; c++)
      for (size_t i = 0; i < n / 2; i++) {
        float kept = arrays[k][c][i];
        arrays[k][c][i] = arrays[k][c][n - 1 - i];
        arrays[k][c][n - 1 - i] = kept;
      }
}

/* Whether two visible splats are the nearest at a pixel, as far away to the bit: the first of the file names it. */
static int is_tied(conic_contributions *c, int x, int y) {
  const conic_contribution *list;
  size_t n, n_nearest = 0;
  float nearest = 0.0f;
  CHECK_OK(conic_contributions_at(c, x, y, &list, &n));
  for (size_t i = 0; i < n; i++) {
    if (list[i].verdict != CONIC_CONTRIBUTION_VISIBLE)
      continue;
    n_nearest = list[i].inverse_depth > nearest ? 1 : n_nearest + (list[i].inverse_depth == nearest);
    nearest = fmaxf(nearest, list[i].inverse_depth);
  }
  return n_nearest > 1;
}

/* At how many pixels another splat gives the id, which only a tie may bring about; and the most that albedo changes. */
static size_t compare_reversed(fixture *f, const conic_image *forwards, double *albedo) {
  const uint32_t *ids = forwards->planes[CONIC_PLANE_ID], *others = f->image.planes[CONIC_PLANE_ID];
  const float *a = forwards->planes[CONIC_PLANE_ALBEDO], *b = f->image.planes[CONIC_PLANE_ALBEDO];
  size_t n_changed = 0;
  conic_contributions *c;
  CHECK_OK(conic_contributions_create(f->context, &f->splats, &f->camera, &f->options, &c));
  *albedo = 0.0;
  for (int y = 0; y < f->camera.height; y++)
    for (int x = 0; x < f->camera.width; x++) {
      size_t at = (size_t)y * (size_t)f->camera.width + (size_t)x;
      for (int channel = 0; channel < 3; channel++)
        *albedo = fmax(*albedo, fabs((double)a[3 * at + (size_t)channel] - (double)b[3 * at + (size_t)channel]));
      if (ids[at] == CONIC_NO_ID || others[at] == (uint32_t)f->splats.count - 1 - ids[at])
        continue;
      n_changed++;
      CHECK(is_tied(c, x, y));
    }
  conic_contributions_destroy(c);
  return n_changed;
}

/* The same splats from last to first: the same picture but for the order of its sums, and for the first of splats that
 * are as near. Z is the heaviest splat's, so it may jump to another's within ε where two are as heavy. */
static void test_reverse(fixture *f) {
  static const struct {
    conic_scene_type type;
    size_t n;
    const char *name;
  } scenes[] = {{CONIC_SCENE_KNOT, 4000, "knot from last to first"},
                {CONIC_SCENE_TERRAIN, 20000, "terrain from last to first"},
                {CONIC_SCENE_PLANE, 10000, "plane from last to first"},
                {CONIC_SCENE_SPHERE, 20000, "sphere from last to first"}};
  for (int i = 0; i < 4 * CONIC_N_METHODS; i++) {
    f->options.method = (conic_method)(i % CONIC_N_METHODS);
    if (!stability_fills(i % CONIC_N_METHODS))
      continue;
    stability_look(f, (const double[]){1.0, 1.5, 2.2}, (const double[]){-1.0, -1.5, -2.2}, 0.1);
    f->camera.width = f->camera.height = 160;
    f->camera.cx = f->camera.cy = 80.0;
    f->options.shading = CONIC_SHADE_PHONG;
    fixture_scene(f, scenes[i / CONIC_N_METHODS].type, scenes[i / CONIC_N_METHODS].n);
    conic_image forwards = stability_draw(f);
    reverse(f);
    fixture_render(f);
    reverse(f);
    double albedo;
    size_t n_changed = compare_reversed(f, &forwards, &albedo);
    stability_difference d = stability_compare(&forwards, &f->image);
    stability_print(scenes[i / CONIC_N_METHODS].name, f, &d);
    printf("%-44s albedo %.1e  id at %zu pixels\n", "", albedo, n_changed);
    CHECK(d.both > 1000 && d.coverage == 0);
    CHECK(albedo <= 6e-7 && d.color <= 3e-6);
    /* The splats of a sea lie in one plane. */
    CHECK(n_changed <= (scenes[i / CONIC_N_METHODS].type == CONIC_SCENE_TERRAIN ? 150 : 3));
    CHECK(d.depth_p999 <= 1e-6);
    conic_image_release(f->context, &forwards);
  }
  f->options.shading = CONIC_SHADE_NONE;
}

/* Draws the knot `scale` times as large, `offset` from the origin; what the camera sees is the same. */
static conic_image draw_moved(fixture *f, double scale, double offset) {
  const double forward[3] = {-0.4, -0.3, -1.0}, eye[3] = {0.4 * 2.5, 0.3 * 2.5, 2.5};
  const double center[3] = {offset, -0.3 * offset, 0.7 * offset};
  double at[3];
  fixture_scene(f, CONIC_SCENE_KNOT, 3000);
  for (int c = 0; c < 3; c++) {
    f->splats.origin[c] = center[c];
    at[c] = center[c] + scale * eye[c];
    for (size_t i = 0; i < f->splats.count; i++) {
      f->splats.position[c][i] = (float)((double)f->splats.position[c][i] * scale);
      f->splats.tangent_u[c][i] = (float)((double)f->splats.tangent_u[c][i] * scale);
      f->splats.tangent_v[c][i] = (float)((double)f->splats.tangent_v[c][i] * scale);
    }
  }
  stability_look(f, at, forward, 0.0);
  return stability_draw(f);
}

/* Far from the origin, tiny, huge, all at once: the same picture. What may differ is what a rounding of the input
 * decides (an outline through a pixel's centre), one pixel in five hundred at most. */
static void test_places_and_scales(fixture *f) {
  static const struct {
    const char *name;
    double scale, offset, color;
  } cases[] = {{"1e7 from the origin", 1, 1e7, 1e-4},
               {"a scene scaled by 1e6", 1e6, 0, 1e-4},
               {"a scene scaled by 1e-6", 1e-6, 0, 1e-4},
               {"scaled by 1e6, 1e13 away", 1e6, 1e13, 1e-4},
               {"scaled by 1e-6, 10 away", 1e-6, 10, 1e-4}};
  straight(f, 128, 112, 120.0);
  f->options.near_z = 0.0;
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    if (!stability_fills(method))
      continue;
    f->options.method = (conic_method)method;
    conic_image here = draw_moved(f, 1.0, 0.0);
    for (int k = 0; k < 5; k++) {
      f->options.method = (conic_method)method;
      conic_image there = draw_moved(f, cases[k].scale, cases[k].offset);
      const float *a = here.planes[CONIC_PLANE_Z];
      float *b = there.planes[CONIC_PLANE_Z];
      for (int i = 0; i < 128 * 112; i++)
        b[i] = (float)((double)b[i] / cases[k].scale);
      stability_difference d = stability_compare(&here, &there);
      stability_print(cases[k].name, f, &d);
      CHECK(a[56 * 128 + 64] >= 0.0f);
      CHECK(d.both > 2500);
      CHECK(d.coverage * 500 <= d.both);
      CHECK(d.color_p999 <= cases[k].color);
      conic_image_release(f->context, &there);
    }
    conic_image_release(f->context, &here);
  }
  straight(f, 64, 56, 60.0); /* the same parts of the scene, for the oracle */
  f->options.near_z = 0.0;
  for (int k = 0; k < 5; k++) {
    conic_image there = draw_moved(f, cases[k].scale, cases[k].offset);
    conic_image_release(f->context, &there);
    stability_agree(f, cases[k].name, 0.02);
  }
}

int main(void) {
  fixture f = fixture_open(2);
  test_walls(&f);
  test_interpenetration(&f);
  test_epsilons(&f);
  test_mixed_sizes(&f);
  test_dust(&f);
  test_reverse(&f);
  test_places_and_scales(&f);
  fixture_close(&f);
  return check_result();
}
