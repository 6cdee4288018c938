/* What the oracle says of pixels in doubt: that it holds whichever way the decisions fall, and no more than that; and
 * that no splat is overlooked, nor another pixel judged than was asked for. */
#include "oracle/oracle_bounds.h"
#include "tests/support/examine.h"
#include "tests/support/triangle_fixture.h"

static double between(uint64_t *state, double low, double high) {
  return low + (high - low) * fixture_random(state);
}

static void random_direction(uint64_t *state, double d[3]) {
  double length;
  do {
    for (int c = 0; c < 3; c++)
      d[c] = between(state, -1.0, 1.0);
    length = oracle_length(d);
  } while (!(length > 0.1 && length < 1.0));
  for (int c = 0; c < 3; c++)
    d[c] /= length;
}

/* The directions of a box's points keep to their range, and the corners and what is nearest to 0 reach its ends. */
static void test_directions(void) {
  uint64_t state = 5;
  for (int i = 0; i < 2000; i++) {
    double box[2][3], low[3], high[3], least[3] = {1.0, 1.0, 1.0}, most[3] = {-1.0, -1.0, -1.0};
    int holds_zero = 1;
    for (int c = 0; c < 3; c++) {
      double middle = between(&state, -1.0, 1.0), half = between(&state, 0.0, i % 2 ? 0.1 : 0.8);
      box[0][c] = middle - half;
      box[1][c] = middle + half;
      holds_zero &= box[0][c] <= 0.0 && box[1][c] >= 0.0;
    }
    conic_oracle_direction_range((const double(*)[3])box, low, high);
    for (int k = 0; k < 27; k++) {
      int digits[3] = {k % 3, k / 3 % 3, k / 9};
      double v[3];
      for (int c = 0; c < 3; c++)
        v[c] = digits[c] < 2 ? box[digits[c]][c] : oracle_max(box[0][c], oracle_min(box[1][c], 0.0));
      double length = oracle_length(v);
      for (int c = 0; c < 3 && length > 0.0; c++) {
        CHECK(v[c] / length >= low[c] - 1e-12 && v[c] / length <= high[c] + 1e-12);
        least[c] = oracle_min(least[c], v[c] / length);
        most[c] = oracle_max(most[c], v[c] / length);
      }
    }
    for (int c = 0; c < 3 && !holds_zero; c++) {
      CHECK_NEAR(least[c], low[c], 1e-12);
      CHECK_NEAR(most[c], high[c], 1e-12);
    }
  }
}

enum { MOST = 7 };

/* Fragments made up, with what is not sure about them. */
typedef struct made_up {
  int n;
  oracle_splat splats[MOST], turned[MOST];
  oracle_candidate candidates[MOST];
  oracle_fragment fragments[MOST + 1];
} made_up;

/* In some layers, with depths that are doubtful by a hair or by more than the layers are apart. */
static void make_up(uint64_t *state, made_up *m) {
  memset(m, 0, sizeof *m);
  m->n = 1 + (int)between(state, 0.0, MOST);
  for (int i = 0; i < m->n; i++) {
    oracle_splat *splat = &m->splats[i];
    oracle_fragment *f = &m->fragments[i];
    double iz = 1.0 + 0.1 * floor(between(state, 0.0, 4.0)) + between(state, 0.0, 1e-3);
    double half = fixture_random(state) < 0.5 ? 1e-7 : between(state, 0.0, 0.05);
    splat->index = (uint32_t)i;
    splat->opacity = 1.0;
    splat->placed.p[2] = 1.0 / iz;
    splat->placed.p[0] = (double)i; /* nobody's copy */
    splat->is_facing_unsure = fixture_random(state) < 0.2;
    random_direction(state, splat->normal);
    for (int c = 0; c < 3; c++) {
      splat->color[c] = between(state, 0.0, 1.0);
      splat->normals[0][c] = splat->is_facing_unsure ? -fabs(splat->normal[c]) : splat->normal[c];
      splat->normals[1][c] = splat->is_facing_unsure ? fabs(splat->normal[c]) : splat->normal[c];
    }
    m->candidates[i].splat = splat;
    m->candidates[i].shape.range[1] = 1.0;
    f->candidate = &m->candidates[i];
    f->may_miss = fixture_random(state) < 0.5;
    double behind = between(state, 0.9, 1.0), weight = between(state, 0.01, 1.0), spread = between(state, 0.0, 0.1);
    f->seen = (oracle_interval){iz - half, iz, iz + half};
    f->hides = (oracle_interval){behind * f->seen.low, behind * iz, behind * f->seen.high};
    f->nearness = f->seen;
    f->weights = (oracle_interval){weight * (1.0 - spread), weight, weight * (1.0 + spread)};
    f->depths = (oracle_interval){1.0 / f->seen.high, 1.0 / iz, 1.0 / f->seen.low};
  }
}

/* One of the ways in which all may be decided; returns how many fragments cover then. */
static size_t decide(uint64_t *state, made_up *m, oracle_fragment decided[MOST]) {
  size_t n = 0;
  for (int i = 0; i < m->n; i++) {
    const oracle_fragment *f = &m->fragments[i];
    double at = fixture_random(state), weight = floor(between(state, 0.0, 3.0)) / 2.0;
    if (f->may_miss && fixture_random(state) < 0.5)
      continue;
    m->turned[i] = m->splats[i];
    for (int c = 0; c < 3 && m->splats[i].is_facing_unsure && at < 0.5; c++)
      m->turned[i].normal[c] = -m->splats[i].normal[c];
    m->candidates[i].splat = &m->turned[i];
    oracle_fragment *d = &decided[n++];
    *d = *f;
    d->covers = 1;
    d->seen.value = d->iz = f->seen.low + at * (f->seen.high - f->seen.low);
    d->hides.value = f->hides.low + at * (f->hides.high - f->hides.low);
    d->weight = f->weights.low + weight * (f->weights.high - f->weights.low);
    d->z = 1.0 / d->iz;
  }
  return n;
}

static void values_of(const conic_camera *camera, const conic_render_options *options, oracle_fragment *decided,
                      size_t n, double values[CONIC_N_ALTERNATIVE_VALUES], uint32_t *id) {
  memset(values, 0, CONIC_N_ALTERNATIVE_VALUES * sizeof *values);
  *id = CONIC_NO_ID;
  conic_oracle_see(decided, n);
  if (!n) {
    conic_oracle_background(options, values + ORACLE_AT_RGBA);
    return;
  }
  oracle_pixel pixel;
  conic_oracle_blend(decided, n, options->passes, 0, &pixel);
  conic_oracle_shade(camera, options, 5.5, 4.5, &pixel, values + ORACLE_AT_RGBA);
  memcpy(values + ORACLE_AT_NORMAL, pixel.normal, sizeof pixel.normal);
  memcpy(values + ORACLE_AT_ALBEDO, pixel.albedo, sizeof pixel.albedo);
  values[ORACLE_AT_Z] = pixel.z;
  values[ORACLE_AT_WEIGHT] = pixel.weight;
  values[ORACLE_AT_COUNT] = (double)pixel.count;
  *id = pixel.id;
}

static int is_within(const conic_alternative *a, const double values[CONIC_N_ALTERNATIVE_VALUES]) {
  for (int c = 0; c < CONIC_N_ALTERNATIVE_VALUES; c++)
    if (!(values[c] >= a->low[c] - 1e-9 && values[c] <= a->high[c] + 1e-9))
      return 0;
  return 1;
}

static int is_among(const oracle_doubts *doubts, const double values[CONIC_N_ALTERNATIVE_VALUES], uint32_t id) {
  int is_value = 0, is_id = 0;
  for (size_t i = 0; i < doubts->n; i++)
    is_value |= is_within(&doubts->alternatives[i], values);
  for (size_t i = 0; i < doubts->n_ids; i++)
    is_id |= doubts->ids[i].id == id;
  return is_value && is_id;
}

/* However all is decided, the pixel is one of the alternatives; and there are not many of them. */
static void test_decisions(fixture *f, conic_shading shading, int passes) {
  uint64_t state = 77;
  conic_render_options options = f->options;
  oracle_part parts[MOST + 1];
  uint32_t order[MOST + 1];
  size_t n_missed = 0, n_alternatives = 0;
  fixture_camera(f, 12, 9, 10.0);
  options.shading = shading;
  options.passes = passes;
  options.has_background = 1;
  options.background[1] = 0.25f;
  options.exposure = -0.5;
  options.lighting = (conic_lighting){
      .is_given = 1,
      .n_lights = 2,
      .lights = {{.frame = CONIC_LIGHT_CAMERA, .color = {0.7f, 0.5f, 0.4f}, .direction = {-2.0, 1.0, 1.5}},
                 {.frame = CONIC_LIGHT_HEAD, .color = {0.2f, 0.2f, 0.9f}}},
      .sky = {0.2f, 0.3f, 0.1f},
      .ground = {0.1f, 0.05f, 0.1f},
      .up = {0.3, -1.0, 0.2}};
  const oracle_bounding room = {&f->camera, &options, parts, order};
  for (int i = 0; i < 2000; i++) {
    made_up m;
    oracle_doubts doubts = {.context = f->context};
    int is_unbounded;
    make_up(&state, &m);
    CHECK_OK(conic_oracle_bound(&room, 5.5, 4.5, 0, m.fragments, (size_t)m.n, NULL, &doubts, &is_unbounded));
    CHECK(!is_unbounded);
    n_alternatives += doubts.n;
    for (int k = 0; k < 50; k++) {
      oracle_fragment decided[MOST];
      double values[CONIC_N_ALTERNATIVE_VALUES];
      uint32_t id;
      size_t n = decide(&state, &m, decided);
      values_of(&f->camera, &options, decided, n, values, &id);
      n_missed += !is_among(&doubts, values, id);
    }
    conic_oracle_doubts_release(&doubts);
  }
  CHECK(n_missed == 0);
  CHECK(n_alternatives > 2000 && n_alternatives < 8000);
}

/* The extremes of a mean are those of all choices of least and greatest weights. */
static void test_means(void) {
  uint64_t state = 9;
  for (int i = 0; i < 1000; i++) {
    made_up m;
    oracle_part parts[MOST];
    double d[3], range[2], least = INFINITY, most = -INFINITY;
    make_up(&state, &m);
    random_direction(&state, d);
    for (int k = 0; k < m.n; k++) {
      m.splats[k].is_facing_unsure = 0;
      memcpy(m.splats[k].normals[0], m.splats[k].normal, sizeof d);
      memcpy(m.splats[k].normals[1], m.splats[k].normal, sizeof d);
      parts[k] = (oracle_part){&m.fragments[k], m.fragments[k].may_miss ? 0.0 : m.fragments[k].weights.low,
                               m.fragments[k].weights.high};
    }
    const oracle_mixture mixture = {parts, (size_t)m.n};
    conic_oracle_mean_along(&mixture, d, range);
    for (unsigned choice = 0; choice < 1u << m.n; choice++) {
      double sum = 0.0, weights = 0.0;
      for (int k = 0; k < m.n; k++) {
        double weight = choice >> k & 1u ? parts[k].most : parts[k].least;
        sum += weight * oracle_dot(d, m.splats[k].normal);
        weights += weight;
      }
      if (weights > 0.0) {
        least = oracle_min(least, sum / weights);
        most = oracle_max(most, sum / weights);
      }
    }
    CHECK_NEAR(range[0], least, 1e-12);
    CHECK_NEAR(range[1], most, 1e-12);
  }
}

/* More ids than are told are any id; each is told once. */
static void test_ids(fixture *f) {
  oracle_doubts doubts = {.context = f->context};
  for (uint32_t i = 0; i < 2 * ORACLE_MAX_IDS; i++)
    CHECK_OK(conic_oracle_doubts_admit(&doubts, 0, 3, i / 2));
  CHECK(doubts.n_ids == ORACLE_MAX_IDS);
  CHECK_OK(conic_oracle_doubts_admit(&doubts, 0, 3, 1000));
  CHECK_OK(conic_oracle_doubts_admit(&doubts, 0, 3, 1001));
  CHECK(doubts.n_ids == 1 && doubts.ids[0].id == CONIC_ANY_ID && doubts.ids[0].pixel == 3);
  conic_oracle_doubts_release(&doubts);
}

/* A disc before a wall, of which four pixels' centres lie on the edge; `size` scales it. */
static void set_edge(fixture *f, double size) {
  const double wall[3] = {0, 0, 2}, wide[2][3] = {{1, 0, 0}, {0, 1, 0}}, p[3] = {0.005, 0.005, 1};
  const double tu[3] = {0.02 * size, 0, 0}, tv[3] = {0, 0.02 * size, 0};
  fixture_splats(f, 2);
  fixture_set(f, 0, p, tu, tv, 0.9f, 0.1f, 0.2f);
  fixture_set(f, 1, wall, wide[0], wide[1], 0.1f, 0.8f, 0.4f);
}

static int passes(fixture *f, const conic_reference *reference) {
  conic_oracle_verdict verdict;
  CHECK_OK(conic_oracle_compare(f->context, reference, &f->image, &verdict));
  CHECK(verdict.pass == (verdict.wrong_pixels == 0));
  if (!verdict.pass) {
    const conic_oracle_fault *worst = &verdict.worst;
    CHECK(worst->x == 19 && worst->y == 16 && !(worst->found >= worst->low && worst->found <= worst->high));
  }
  return verdict.pass;
}

/* On an edge a pixel may be of either side, but neither between them nor of both at once. */
static void test_edge(fixture *f) {
  const size_t at = 16 * 32 + 19;
  conic_reference reference;
  conic_image sides[2];
  fixture_camera(f, 32, 32, 100.0);
  f->options.method = CONIC_METHOD_DISC;
  f->options.epsilon = 0.01;
  set_edge(f, 1.0);
  CHECK_OK(conic_oracle_render(f->context, &f->splats, &f->camera, &f->options, CONIC_ORACLE_METHOD, &reference));
  CHECK(reference.unstable[at] & 1u << CONIC_UNSTABLE_CUTOFF && reference.unstable_pixels == 4);
  CHECK(reference.n_alternatives == 8 && reference.n_ids == 8);
  for (int side = 0; side < 2; side++) {
    set_edge(f, side ? 1.0 + 3e-6 : 1.0 - 3e-6);
    fixture_render(f);
    CHECK(fixture_index(f, CONIC_PLANE_ID, 19, 16) == (side ? 0u : 1u));
    CHECK(passes(f, &reference));
    sides[side] = f->image;
    memset(&f->image, 0, sizeof f->image);
  }
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++) {
    if (plane == CONIC_PLANE_COUNT || plane == CONIC_PLANE_NORMAL)
      continue; /* which are the same */
    const conic_plane_description *about = conic_plane_describe((conic_plane)plane);
    for (int mixed = plane == CONIC_PLANE_ID; mixed < 2; mixed++) {
      fixture_render(f);
      float *here = (float *)f->image.planes[plane] + at * (size_t)about->n_channels;
      const float *there = (const float *)sides[0].planes[plane] + at * (size_t)about->n_channels;
      if (mixed)
        memcpy(here, there, (size_t)about->n_channels * sizeof *here);
      else
        here[0] = 0.5f * (here[0] + there[0]);
      CHECK(passes(f, &reference) == (plane == CONIC_PLANE_ID)); /* ids are judged by themselves */
    }
  }
  fixture_render(f);
  ((uint32_t *)f->image.planes[CONIC_PLANE_ID])[at] = 7;
  CHECK(!passes(f, &reference));
  for (int side = 0; side < 2; side++)
    conic_image_release(f->context, &sides[side]);
  conic_reference_release(f->context, &reference);
  f->options.method = CONIC_METHOD_CONIC;
  f->options.epsilon = -1.0;
}

static void fill_cloud(fixture *f, size_t count, double low_z, double longest, double thinness) {
  uint64_t state = 21;
  fixture_splats(f, count);
  for (size_t i = 0; i < count; i++) {
    double z = between(&state, low_z, 4.0), width = fabs(z) + 0.2, sigma = longest * pow(0.1, fixture_random(&state));
    double p[3] = {width * between(&state, -0.5, 0.5), width * between(&state, -0.5, 0.5), z}, tu[3], n[3], tv[3];
    random_direction(&state, tu);
    random_direction(&state, n);
    oracle_cross(tu, n, tv);
    for (int c = 0; c < 3; c++) {
      tu[c] *= sigma;
      tv[c] *= thinness * sigma;
    }
    fixture_set(f, i, p, tu, tv, (float)fixture_random(&state), (float)fixture_random(&state),
                (float)fixture_random(&state));
  }
}

/* Thousands of thin splats a line of sight: of many pixels some decision is in doubt, and all are judged. */
static void test_crowd(fixture *f) {
  fixture_camera(f, 128, 128, 110.0);
  fill_cloud(f, 20000, 1.0, 0.1, 0.02);
  f->options.prefilter = 0.0f;
  f->options.shading = CONIC_SHADE_PHONG;
  outcome o = examine(f);
  printf("a crowd: %zu of %zu unstable, colours within %.2g of each other\n", o.reference.unstable_pixels,
         o.reference.covered_pixels, conic_reference_width(&o.reference, CONIC_PLANE_RGBA));
  CHECK((double)o.reference.unstable_pixels > 0.028 * (double)o.reference.covered_pixels);
  CHECK(o.verdict.pass && o.reference.unbounded_pixels == 0);
  /* What is outside of all alternatives fails. */
  const conic_alternative *a = &o.reference.alternatives[o.reference.n_alternatives / 2];
  double high = 0.0;
  for (size_t i = 0; i < o.reference.n_alternatives; i++)
    if (o.reference.alternatives[i].pixel == a->pixel)
      high = oracle_max(high, o.reference.alternatives[i].high[ORACLE_AT_RGBA]);
  float *rgba = (float *)f->image.planes[CONIC_PLANE_RGBA] + 4 * a->pixel;
  rgba[0] = (float)(high + 0.5e-4);
  CHECK_OK(conic_oracle_compare(f->context, &o.reference, &f->image, &o.verdict));
  CHECK(o.verdict.pass);
  rgba[0] = (float)(high + 2e-4);
  CHECK_OK(conic_oracle_compare(f->context, &o.reference, &f->image, &o.verdict));
  CHECK(!o.verdict.pass && o.verdict.wrong_pixels == 1);
  conic_reference_release(f->context, &o.reference);
  f->options.prefilter = 1.0f;
}

static void check_equal(const conic_reference *a, const conic_reference *b) {
  CHECK(a->n_pixels == b->n_pixels && a->n_alternatives == b->n_alternatives && a->n_ids == b->n_ids);
  for (int i = 0; i < CONIC_N_DRAWN_PLANES; i++)
    CHECK(memcmp(a->planes[i], b->planes[i],
                 a->n_pixels * sizeof(double) * (size_t)conic_plane_describe((conic_plane)i)->n_channels) == 0);
  CHECK(memcmp(a->unstable, b->unstable, a->n_pixels) == 0);
  CHECK(memcmp(a->alternatives, b->alternatives, a->n_alternatives * sizeof *a->alternatives) == 0);
  CHECK(memcmp(a->ids, b->ids, a->n_ids * sizeof *a->ids) == 0);
}

/* The boxes by which splats are found leave out none: the picture is that of all splats at all pixels. */
static void test_search(fixture *f) {
  const conic_drawing drawing = {&f->splats, NULL};
  fixture_camera(f, 70, 50, 45.0);
  f->options.near_z = 0.05;
  for (int method = 0; method < CONIC_N_METHODS; method++)
    for (int i = 0; i < 3; i++) {
      const oracle_request quick = {CONIC_ORACLE_METHOD, i == 2 ? 2 : 1, i == 1 ? 500 : 0, 0};
      oracle_request brute = quick;
      conic_reference a, b;
      brute.is_brute = 1;
      f->options.method = (conic_method)method;
      fill_cloud(f, 400, i ? -0.5 : 0.5, i ? 0.3 : 0.05, 0.5);
      CHECK_OK(conic_oracle_draw(f->context, &drawing, &f->camera, &f->options, &quick, &a));
      CHECK_OK(conic_oracle_draw(f->context, &drawing, &f->camera, &f->options, &brute, &b));
      CHECK(a.covered_pixels > 50);
      check_equal(&a, &b);
      conic_reference_release(f->context, &a);
      conic_reference_release(f->context, &b);
    }
  f->options.near_z = 0.0;
  f->options.method = CONIC_METHOD_CONIC;
}

/* Splats at every distance: the box of the sphere holds that of the splat. */
static void test_reach(fixture *f) {
  oracle_scene scene;
  size_t n_placed = 0;
  fixture_camera(f, 640, 480, 900.0);
  f->camera.fy = 350.0;
  fill_cloud(f, 20000, 0.0, 0.2, 1.0);
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    f->options.method = (conic_method)method;
    CHECK_OK(conic_oracle_scene_create(f->context, &f->splats, &f->camera, &f->options, CONIC_FLOATS_OWN, 0, &scene));
    for (size_t i = 0; i < f->splats.count; i++) {
      oracle_splat splat;
      if (!conic_oracle_scene_place(&scene, i, &splat))
        continue;
      n_placed++;
      for (int axis = 0; axis < 2; axis++)
        CHECK((double)scene.reaches[i].box[0][axis] <= splat.box[0][axis] &&
              (double)scene.reaches[i].box[1][axis] >= splat.box[1][axis]);
    }
    conic_oracle_scene_release(f->context, &scene);
  }
  CHECK(n_placed > 100000);
  f->options.method = CONIC_METHOD_CONIC;
}

/* Of some pixels the reference says what it says of them among all. */
static void test_some_pixels(fixture *f) {
  conic_triangles t = triangles_torus(f, 20, 10, 0.4);
  const conic_drawing drawing = {&f->splats, &t};
  fixture_camera(f, 90, 70, 60.0);
  f->camera.cam_from_world[2][3] = 3.0;
  fixture_scene(f, CONIC_SCENE_KNOT, 3000);
  for (int samples = 1; samples < 3; samples++) {
    conic_reference all, some;
    conic_oracle_verdict verdict;
    CHECK_OK(triangles_render(f, &t, samples));
    CHECK_OK(
        conic_oracle_render_drawing(f->context, &drawing, &f->camera, &f->options, CONIC_ORACLE_METHOD, samples, &all));
    CHECK_OK(conic_oracle_render_pixels(f->context, &drawing, &f->camera, &f->options, CONIC_ORACLE_METHOD, samples,
                                        631, &some));
    CHECK(some.n_pixels == 631 && all.n_pixels == 6300 && !all.pixels);
    for (size_t i = 0; i < 631; i++) {
      size_t at = some.pixels[i];
      CHECK(at >= 6300 * i / 631 && at < 6300 * (i + 1) / 631);
      CHECK(some.unstable[i] == all.unstable[at]);
      for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++) {
        size_t n = (size_t)conic_plane_describe((conic_plane)plane)->n_channels;
        CHECK(memcmp(some.planes[plane] + n * i, all.planes[plane] + n * at, n * sizeof(double)) == 0);
      }
    }
    CHECK_OK(conic_oracle_compare(f->context, &some, &f->image, &verdict));
    CHECK(verdict.pass && verdict.compared_pixels + verdict.unstable_pixels == 631);
    ((float *)f->image.planes[CONIC_PLANE_Z])[some.pixels[300]] += 1.0f;
    CHECK_OK(conic_oracle_compare(f->context, &some, &f->image, &verdict));
    CHECK(!verdict.pass && (uint32_t)(verdict.worst.y * 90 + verdict.worst.x) == some.pixels[300]);
    conic_reference_release(f->context, &all);
    conic_reference_release(f->context, &some);
  }
  conic_triangles_release(f->context, &t);
}

int main(void) {
  fixture f = fixture_open(2);
  test_directions();
  test_means();
  test_ids(&f);
  for (int passes_asked = 1; passes_asked <= 3; passes_asked += 2) {
    test_decisions(&f, CONIC_SHADE_NONE, passes_asked);
    test_decisions(&f, CONIC_SHADE_LAMBERT, passes_asked);
    test_decisions(&f, CONIC_SHADE_PHONG, passes_asked);
  }
  test_edge(&f);
  test_crowd(&f);
  test_search(&f);
  test_reach(&f);
  test_some_pixels(&f);
  fixture_close(&f);
  return check_result();
}
