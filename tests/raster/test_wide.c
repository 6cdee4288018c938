/* ε along the ray: what a splat hides lies ε behind it, within 2 %, at every pixel that it covers. A wide splat needs a
 * factor for each pixel, and a rule says which are wide (docs/reference/picture.md, Visible). */
#include "core/lanes/instruction_sets.h"
#include "raster/project/projected.h"
#include "tests/support/examine.h"

static double ray_length_of(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void ray_of(const fixture *f, int x, int y, double d[3]) {
  d[0] = (x + 0.5 - f->camera.cx) / f->camera.fx;
  d[1] = (y + 0.5 - f->camera.cy) / f->camera.fy;
  d[2] = 1.0;
}

/* What is found of ε at pixels, over what it should be. */
typedef struct extremes {
  double least, greatest;
  size_t n;
} extremes;

static const extremes no_extremes = {HUGE_VAL, -HUGE_VAL, 0};

static void add_seen_pixel(const fixture *f, int x, int y, const conic_contribution *c, extremes *found) {
  double d[3], iz = fmin((double)c->inverse_depth, (double)c->plane_inverse_depth);
  if (!(iz > 1e-3)) /* the horizon and what is beyond it hide nothing that has a distance */
    return;
  ray_of(f, x, y, d);
  double epsilon = ray_length_of(d) / (double)c->hides - ray_length_of(d) / iz;
  found->least = fmin(found->least, epsilon / f->options.epsilon);
  found->greatest = fmax(found->greatest, epsilon / f->options.epsilon);
  found->n++;
}

static extremes measure(const fixture *f) {
  extremes found = no_extremes;
  conic_contributions *c;
  CHECK_OK(conic_contributions_create(f->context, &f->splats, &f->camera, &f->options, &c));
  for (int y = 0; y < f->camera.height; y++)
    for (int x = 0; x < f->camera.width; x++) {
      const conic_contribution *list;
      size_t n;
      CHECK_OK(conic_contributions_at(c, x, y, &list, &n));
      for (size_t i = 0; i < n; i++)
        if (list[i].verdict <= CONIC_CONTRIBUTION_HIDDEN)
          add_seen_pixel(f, x, y, &list[i], &found);
    }
  conic_contributions_destroy(c);
  return found;
}

static void check_measure(const char *what, extremes found) {
  printf("%-28s epsilon from %.4f to %.4f of itself at %zu pixels\n", what, found.least, found.greatest, found.n);
  CHECK(found.n > 0 && found.least >= 0.98 && found.greatest <= 1.02);
}

/* A floor disc about a place ahead, rolled so that no axis is the screen's. */
static void set_floor(fixture *f, double radius) {
  const double p[3] = {0.4, 1.0, 4.0}, tu[3] = {0.9 * radius, 0.0, 0.3 * radius}, tv[3] = {-0.2 * radius, 0.0, radius};
  fixture_splats(f, 2);
  fixture_set(f, 0, p, tu, tv, 1, 0, 0);
  fixture_set(f, 1, (const double[]){0, 0, -9}, tu, tv, 0, 1, 0);
}

/* With one factor it was 0.49 to 1.16 of itself. */
static void test_floor(fixture *f) {
  static const char *const names[] = {"floor, within its distance", "floor, reaching near"};
  for (int i = 0; i < 2; i++) {
    set_floor(f, i ? 4.0 : 1.5);
    for (int method = 0; method < CONIC_N_METHODS; method++) {
      f->options.method = (conic_method)method;
      check_measure(names[i], measure(f));
    }
  }
  f->options.method = CONIC_METHOD_CONIC;
}

/* A second splat, on the ray of a pixel and so far behind the floor: whether the pixel shows both. */
static int is_seen_behind(fixture *f, int x, int y, double behind) {
  double d[3], p[3];
  ray_of(f, x, y, d);
  double t = 1.0 / d[1] * ray_length_of(d) + behind;
  for (int axis = 0; axis < 3; axis++)
    p[axis] = t * d[axis] / ray_length_of(d);
  fixture_set(f, 1, p, (const double[]){1e-3, 0, 0}, (const double[]){0, 1e-3, 0}, 0, 1, 0);
  fixture_render(f);
  return fixture_index(f, CONIC_PLANE_COUNT, x, y) == 2;
}

/* In the picture, and with every instruction set the same bit. */
static void test_second_splat(fixture *f) {
  static const int places[][2] = {{45, 75}, {20, 60}, {78, 62}, {50, 60}, {33, 88}};
  set_floor(f, 4.0);
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
    int x = places[i][0], y = places[i][1];
    CHECK(is_seen_behind(f, x, y, 0.98 * f->options.epsilon));
    CHECK(!is_seen_behind(f, x, y, 1.02 * f->options.epsilon));
  }
}

/* Splats of all kinds: far and near, tilted, needles, dust, and what looks along a disc. */
static void set_random(fixture *f, uint64_t *state) {
  double p[3], axes[2][3], size = pow(10.0, -3.0 * fixture_random(state));
  p[2] = 0.5 + 4.0 * fixture_random(state);
  for (int axis = 0; axis < 2; axis++)
    p[axis] = 0.6 * p[2] * (fixture_random(state) - 0.5);
  for (int i = 0; i < 2; i++) {
    double stretch = pow(10.0, -2.0 * fixture_random(state) * fixture_random(state));
    for (int axis = 0; axis < 3; axis++)
      axes[i][axis] = stretch * size * (fixture_random(state) - 0.5);
  }
  fixture_set(f, 0, p, axes[0], axes[1], 1, 1, 1);
}

/* The rule as the page has it, in double; the greatest change that is not wide is 0.0195. */
static double change_of(const fixture *f, const conic_view *view, const conic_footprint *footprint,
                        const conic_box *box) {
  conic_disc disc = conic_disc_of(view, &f->splats, 0);
  const double focal[2] = {view->fx, view->fy}, principal[2] = {view->cx, view->cy};
  double z = disc.p[2], reach = (double)view->cutoff * hypot(disc.tu[2], disc.tv[2]), turn = 0.0, squares = 0.0;
  const int begin[2] = {box->x_begin, box->y_begin}, end[2] = {box->x_end, box->y_end};
  for (int i = 0; i < 2; i++) { /* up to the outermost pixels' centres: less than the rule's own extent */
    double place = focal[i] * disc.p[i] / z + principal[i];
    double across = fmax(fabs(end[i] - 0.5 - place), fabs(begin[i] + 0.5 - place)) / focal[i];
    turn += fabs(disc.p[i] / z) * across;
    squares += across * across;
  }
  double slope = hypot((double)footprint->plane_dx, (double)footprint->plane_dy);
  return reach / z + slope * (double)view->growth_px * z + turn + 0.5 * squares;
}

static int project(fixture *f, conic_view *view, conic_footprint *footprint, conic_box *box) {
  conic_chunk chunk;
  conic_projected_surface surface;
  conic_ray ray;
  conic_projected projected = {1, 1, &chunk, footprint, box, &surface, &ray};
  CHECK_OK(conic_view_init(f->context, &f->splats, &f->camera, &f->options, 1e-2, 1.0, view));
  conic_project_chunk(view, &f->splats, 0, &projected);
  return chunk.n_drawn == 1;
}

/* No splat is off by over 2 % anywhere, wide or not; and of those that are surely not wide, none is held to be: they
 * keep the one multiplication. */
static void test_rule(fixture *f) {
  uint64_t state = 7;
  size_t n_wide = 0, n_narrow = 0, n_narrow_covering = 0;
  extremes all = no_extremes, narrow = no_extremes;
  fixture_camera(f, 160, 120, 300.0);
  for (int i = 0; i < 6000; i++) {
    conic_view view;
    conic_footprint footprint;
    conic_box box;
    fixture_splats(f, 1);
    set_random(f, &state);
    f->options.method = (conic_method)(i % CONIC_N_METHODS);
    if (!project(f, &view, &footprint, &box))
      continue;
    double change = change_of(f, &view, &footprint, &box);
    if (change > 0.01951)
      CHECK(conic_is_wide(&footprint));
    else if (change < 0.9 * 0.0195 - 2.0 / f->camera.fx && !conic_is_laplace(&footprint))
      CHECK(!conic_is_wide(&footprint)); /* the rule's extent ends less than two pixels beyond the last centre */
    n_wide += conic_is_wide(&footprint) != 0;
    n_narrow += !conic_is_wide(&footprint);
    if (i % 3)
      continue;
    extremes found = measure(f);
    extremes *of[] = {&all, &narrow};
    for (int k = 0; k < 2 - (conic_is_wide(&footprint) != 0) && found.n; k++) {
      of[k]->least = fmin(of[k]->least, found.least);
      of[k]->greatest = fmax(of[k]->greatest, found.greatest);
      of[k]->n += found.n;
    }
    n_narrow_covering += !conic_is_wide(&footprint) && found.n;
  }
  printf("%zu splats are wide, %zu not\n", n_wide, n_narrow);
  check_measure("splats of all kinds", all);
  check_measure("those that are not wide", narrow);
  CHECK(n_wide > 500 && n_narrow > 500 && n_narrow_covering > 200);
  CHECK(narrow.greatest > 1.01 && narrow.least < 0.99); /* the rule is no stricter than it has to be */
  fixture_camera(f, 100, 100, 90.0);
  f->options.method = CONIC_METHOD_CONIC;
}

/* The nearest side of the rule, and the far one: a frontal disc on the axis, whose c alone counts. */
static void test_border(fixture *f) {
  for (int i = 0; i < 2; i++) {
    conic_view view;
    conic_footprint footprint;
    conic_box box;
    f->options.prefilter = 0.0f;
    fixture_splats(f, 1);
    double sigma = 2.0 * sqrt((i ? 0.01951 : 0.01949)) / 1.5; /* ½(e_x² + e_y²) with e = F_g·σ/p_z */
    fixture_set(f, 0, (const double[]){0, 0, 2}, (const double[]){sigma, 0, 0}, (const double[]){0, sigma, 0}, 1, 1, 1);
    CHECK(project(f, &view, &footprint, &box) && conic_is_wide(&footprint) == i);
    double epsilon = f->options.epsilon;
    f->options.epsilon = 0.0;
    CHECK(project(f, &view, &footprint, &box) && footprint.nearness == 1.0f);
    f->options.epsilon = epsilon;
    f->options.prefilter = 1.0f;
  }
}

/* Wide splats over each other, some of them clipped by near, and small ones between: the oracle judges them in double,
 * and no instruction set, tile or number of threads changes a bit. */
static void fill_hall(fixture *f) {
  uint64_t state = 3;
  fixture_splats(f, 300);
  for (size_t i = 0; i < f->splats.count; i++) {
    double size = i % 5 ? 0.05 : 1.5, p[3] = {4.0 * (fixture_random(&state) - 0.5), 1.0, 8.0 * fixture_random(&state)};
    double lift = i % 5 ? -0.4 * fixture_random(&state) : 0.1 * fixture_random(&state);
    p[1] += lift;
    const double tu[3] = {size, 0.1 * size * fixture_random(&state), 0}, tv[3] = {0, 0.05 * size, size};
    fixture_set(f, i, p, tu, tv, (float)fixture_random(&state), (float)fixture_random(&state), 0.5f);
  }
}

static void test_hall(fixture *f) {
  fill_hall(f);
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    f->options.method = (conic_method)method;
    outcome o = examine(f);
    for (int i = 0; i < CONIC_N_DRAWN_PLANES; i++)
      CHECK_NEAR(o.verdict.planes[i].max_abs, 0.0, o.verdict.planes[i].bound);
    CHECK(o.verdict.compared_pixels > 9000 && 20 * o.verdict.unstable_pixels < o.verdict.covered_pixels);
    conic_reference_release(f->context, &o.reference);
    const uint64_t hash = conic_image_hash(&f->image, CONIC_PLANE_ALBEDO), by_laplace = f->statistics.splats_by_laplace;
    CHECK((by_laplace > 0) == (method == CONIC_METHOD_AUTO));
    for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++)
      for (int tile = 8; tile <= 64 && conic_isa_is_here((conic_isa)isa); tile *= 8) {
        f->options.isa = (conic_isa)isa;
        f->options.tile = tile;
        fixture_render(f);
        CHECK(conic_image_hash(&f->image, CONIC_PLANE_ALBEDO) == hash);
        CHECK(f->statistics.splats_by_laplace == by_laplace);
      }
    f->options.isa = CONIC_ISA_AUTO;
    f->options.tile = 64;
  }
}

int main(void) {
  fixture f = fixture_open(2);
  fixture_camera(&f, 100, 100, 90.0);
  f.options.near_z = 0.01;
  f.options.epsilon = 0.3;
  test_floor(&f);
  test_second_splat(&f);
  test_rule(&f);
  test_border(&f);
  test_hall(&f);
  fixture_close(&f);
  return check_result();
}
