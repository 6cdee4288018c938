/* What is seen from its side takes fewer splats: floors, silhouettes, wide cones, against Confetti's rule at the same
 * measured error, and while the view moves. */
#include "core/base/vectors.h"
#include "lod/octree/octree_cover.h"
#include "lod/octree/octree_view.h"
#include "tests/support/octree_fixture.h"

enum { SIZE = 256 };

/* A plane through the middle, turned in itself so that its edges follow no row of pixels, with waves of all lengths. */
static void make_floor(fixture *f, size_t n, double turn_rad) {
  const float c = (float)cos(turn_rad), s = (float)sin(turn_rad);
  fixture_scene(f, CONIC_SCENE_PLANE, n);
  float *const *const vectors[3] = {f->splats.position, f->splats.tangent_u, f->splats.tangent_v};
  for (size_t i = 0; i < n; i++) {
    for (int k = 0; k < 3; k++) {
      float x = vectors[k][0][i], y = vectors[k][1][i];
      vectors[k][0][i] = c * x - s * y;
      vectors[k][1][i] = s * x + c * y;
    }
    for (int channel = 0; channel < 3; channel++) {
      double value = 0.5, x = (double)f->splats.position[0][i], y = (double)f->splats.position[1][i];
      for (int wave = 0; wave < 6; wave++) {
        double angle = 1.3 * wave + 0.7 * channel, along = x * cos(angle) + y * sin(angle);
        value += 0.22 * pow(1.4, -wave) * sin(4.0 * pow(1.83, wave) * along + 2.0 * wave + channel);
      }
      f->splats.color[channel][i] = (float)fmin(fmax(value, 0.0), 1.0);
    }
  }
}

/* The plane's normal is z; it is seen from the front at 0. */
static void look_at_floor(fixture *f, double tilt_deg, double zoom) {
  octree_frame(f, SIZE, tilt_deg, 0.0, zoom);
}

static const float *draw_whole_plane(fixture *f) {
  static float rgba[4 * SIZE * SIZE];
  fixture_render(f);
  memcpy(rgba, f->image.planes[CONIC_PLANE_RGBA], sizeof rgba);
  return rgba;
}

static double decibels(const fixture *f, const float *whole) {
  const float *rgba = f->image.planes[CONIC_PLANE_RGBA];
  double sum = 1e-12;
  for (int i = 0; i < 4 * SIZE * SIZE; i++)
    sum += ((double)whole[i] - (double)rgba[i]) * ((double)whole[i] - (double)rgba[i]) / (4.0 * SIZE * SIZE);
  return -10.0 * log10(sum);
}

static int count_covered(const float *rgba) {
  int n = 0;
  for (int i = 0; i < SIZE * SIZE; i++)
    n += rgba[4 * i + 3] > 0.0f;
  return n;
}

/* The picture of a floor's middle, without its edges: its splats follow what is seen of it, not what there is of it.
 * Nodes halve from level to level, so a mean over an octave of errors is taken. */
static void test_floor(void) {
  fixture f = fixture_open(2);
  conic_selection selection = {0};
  make_floor(&f, 200000, 0.35);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  f.options.near_z = conic_octree_near(octree);
  double n_front = 0.0;
  for (double tilt = 0.0; tilt < 76.0; tilt += 15.0) {
    look_at_floor(&f, tilt, tilt < 70.0 ? 4.0 : 8.0);
    double n = 0.0, pixels = count_covered(draw_whole_plane(&f));
    for (int step = 0; step < 8; step++) {
      double error_px = 1.5 * pow(2.0, step / 8.0);
      octree_select(octree, &f, error_px, 0, &selection);
      n += (double)selection.splats.count * error_px * error_px / (8.0 * pixels);
    }
    fprintf(stderr, "floor at %g: %.4f splats a pixel at an error of 1 pixel\n", tilt, n);
    n_front = tilt == 0.0 ? n : n_front;
    CHECK(n <= 1.2 * n_front);
  }
  conic_selection_release(f.context, &selection);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

/* Confetti's size of a node on the screen: its major axis, by the cosine of γ - θ. */
static double confetti_pixels(const conic_octree *octree, const conic_octree_view *view, size_t i, double plain) {
  double way[3], n[3], u[3];
  for (int axis = 0; axis < 3; axis++) {
    way[axis] = (double)octree->center[axis][i] - (double)view->eye[axis];
    n[axis] = (double)octree->normal[axis][i];
    u[axis] = octree->scale.cutoff * (double)octree->drawn[i].tangent_u[axis];
  }
  double cosine = fmin(fabs(conic_dot(way, n)) / conic_length(way), 1.0), cone = (double)octree->cone[i];
  double between = cosine >= cone ? 1.0 : cosine * cone + sqrt((1.0 - cosine * cosine) * (1.0 - cone * cone));
  return plain / (double)octree->error[i] * conic_length(u) * between;
}

/* What the error of a node would be on the screen if it were seen from the front; below 0 out of sight. */
static double plain_pixels(const conic_octree *octree, const conic_octree_view *view, size_t i) {
  double c[3], r = (double)octree->radius[i];
  for (int row = 0; row < 3; row++) {
    c[row] = (double)view->translation[row];
    for (int axis = 0; axis < 3; axis++)
      c[row] += (double)view->rotation[row][axis] * (double)octree->center[axis][i];
  }
  double front = c[2] - r;
  return (double)view->focal_px * (double)octree->error[i] * (conic_length(c) + r) / (front * front);
}

/* The set that Confetti's rule chooses: so many splats, or a few less. */
typedef struct confetti {
  const conic_octree *octree;
  const conic_octree_view *view;
  float *sizes; /* of the nodes; below 0 out of sight */
} confetti;

static int faces_away(const conic_octree *octree, const conic_octree_view *view, size_t i) {
  float along = 0.0f;
  for (int axis = 0; axis < 3; axis++)
    along += (octree->center[axis][i] - view->eye[axis]) * octree->normal[axis][i];
  return view->cull_back && along > 0.0f;
}

static size_t confetti_walk(const confetti *rule, double tolerance, conic_splats *splats) {
  const conic_octree *octree = rule->octree;
  size_t n = 0;
  for (size_t i = 0; i < octree->n_nodes;) {
    int is_drawn = (double)rule->sizes[i] <= tolerance, is_out = rule->sizes[i] < 0.0f;
    size_t first = octree->first_leaf[i], last = is_drawn ? first + 1 : octree->first_leaf[i + 1];
    float turned = is_drawn && faces_away(octree, rule->view, i) ? -1.0f : 1.0f;
    for (size_t k = first; k < last && !is_out; k++, n++)
      for (int axis = 0; axis < 3 && splats; axis++) {
        const conic_drawn_node *from = is_drawn ? &octree->drawn[i] : &octree->drawn_leaves[k];
        splats->position[axis][n] = from->position[axis];
        splats->tangent_u[axis][n] = from->tangent_u[axis];
        splats->tangent_v[axis][n] = turned * from->tangent_v[axis];
        splats->color[axis][n] = from->color[axis];
        splats->opacity[n] = from->opacity;
      }
    i = is_drawn ? octree->end[i] : i + 1;
  }
  return n;
}

/* Draws what Confetti's rule makes of so many splats; how good that is. */
static double confetti_decibels(fixture *f, conic_octree *octree, size_t budget, const float *whole) {
  conic_octree_view view;
  conic_octree_view_init(octree, &f->camera, &f->options, f->options.near_z, &view);
  confetti rule = {octree, &view, calloc(octree->n_nodes + CONIC_OCTREE_GROUP, sizeof(float))};
  conic_splats splats;
  double low = 0.0, high = 1e4;
  if (!rule.sizes)
    exit(1);
  view.measure(octree, &view, 0, octree->n_nodes, rule.sizes);
  for (size_t i = 0; i < octree->n_nodes; i++)
    if (rule.sizes[i] >= 0.0f)
      rule.sizes[i] = (float)confetti_pixels(octree, &view, i, plain_pixels(octree, &view, i));
  for (int step = 0; step < 60; step++) {
    double middle = 0.5 * (low + high);
    *(confetti_walk(&rule, middle, NULL) <= budget ? &high : &low) = middle;
  }
  size_t n = confetti_walk(&rule, high, NULL);
  CHECK_OK(conic_splats_allocate(f->context, n, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES,
                                 &splats));
  confetti_walk(&rule, high, &splats);
  conic_selection selection = {.splats = splats, .ids = calloc(n, sizeof(uint32_t))};
  octree_draw(f, octree, &selection);
  conic_splats_release(f->context, &splats);
  free(selection.ids);
  free(rule.sizes);
  return decibels(f, whole);
}

/* With 1.2 times as many splats as Confetti's rule takes, the picture is as good at least. Returns by how much. */
static double gain_over_confetti(fixture *f, conic_octree *octree, double error_px, const char *what) {
  conic_selection selection = {0};
  const float *whole = draw_whole_plane(f);
  octree_select(octree, f, error_px, 0, &selection);
  octree_draw(f, octree, &selection);
  double own = decibels(f, whole);
  double other = confetti_decibels(f, octree, (size_t)((double)selection.splats.count / 1.2), whole);
  fprintf(stderr, "%s, %g px: %zu splats, %.2f dB; by Confetti's rule, with fewer, %.2f dB\n", what, error_px,
          selection.splats.count, own, other);
  conic_selection_release(f->context, &selection);
  return own - other;
}

/* Where nodes end on the floor depends on how it lies in the axes: the mean of some ways. */
static void test_confetti_floor(void) {
  enum { N_TURNS = 3, N_TILTS = 7, N_ERRORS = 3 };
  static const double tilts[N_TILTS] = {0.0, 45.0, 60.0, 75.0, 80.0, 85.0, 89.0},
                      errors_px[N_ERRORS] = {3.0, 1.5, 0.75};
  double gains[N_TILTS][N_ERRORS] = {{0}};
  fixture f = fixture_open(2);
  for (int turn = 0; turn < N_TURNS; turn++) {
    make_floor(&f, 30000, 0.2 + 0.2 * turn);
    conic_octree *octree = octree_build(f.context, &f.splats, 0);
    f.options.near_z = conic_octree_near(octree);
    for (int i = 0; i < N_TILTS; i++)
      for (int k = 0; k < N_ERRORS; k++) {
        look_at_floor(&f, tilts[i], 1.0);
        gains[i][k] += gain_over_confetti(&f, octree, errors_px[k], "floor") / N_TURNS;
      }
    conic_octree_destroy(octree);
  }
  for (int i = 0; i < N_TILTS; i++)
    for (int k = 0; k < N_ERRORS; k++)
      CHECK(gains[i][k] >= 0.0);
  fixture_close(&f);
}

static void test_against_confetti(conic_scene_type type, int cull_back, double zoom, const char *what) {
  fixture f = fixture_open(2);
  fixture_scene(&f, type, 100000);
  octree_frame(&f, SIZE, 30.0, 15.0, zoom);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  f.options.near_z = conic_octree_near(octree);
  f.options.cull_back = cull_back;
  for (double error_px = 4.0; error_px > 0.9; error_px *= 0.5)
    CHECK(gain_over_confetti(&f, octree, error_px, what) >= 0.0);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

/* The greatest cosine under which a place of the node's leaves is seen, of those tried. */
static double seen_cosine(const conic_octree *octree, const conic_octree_view *view, size_t i) {
  double greatest = 0.0;
  for (size_t k = octree->first_leaf[i]; k < octree->first_leaf[octree->end[i]]; k++)
    for (int corner = 0; corner < 9; corner++) {
      double u[3], v[3], n[3], way[3], angle = 0.785398163 * corner, r = corner < 8 ? octree->scale.cutoff : 0.0;
      for (int axis = 0; axis < 3; axis++) {
        u[axis] = (double)octree->leaves.tangent_u[axis][k];
        v[axis] = (double)octree->leaves.tangent_v[axis][k];
        way[axis] = (double)octree->leaves.position[axis][k] + r * (cos(angle) * u[axis] + sin(angle) * v[axis]) -
                    (double)view->eye[axis];
      }
      conic_cross(u, v, n);
      greatest = fmax(greatest, fabs(conic_dot(way, n)) / (conic_length(way) * conic_length(n)));
    }
  return greatest;
}

/* No node counts less than the root of what its leaves show, than a share of its error, or less because its leaves face
 * in all directions; and some count less. */
static void check_tilt_weights(fixture *f, const char *what) {
  conic_octree_view view;
  conic_octree *octree = octree_build(f->context, &f->splats, 0);
  float *pixels = calloc(octree->n_nodes + CONIC_OCTREE_GROUP, sizeof *pixels);
  if (!pixels)
    exit(1);
  conic_octree_view_init(octree, &f->camera, &f->options, conic_octree_near(octree), &view);
  view.measure(octree, &view, 0, octree->n_nodes, pixels);
  size_t n_less = 0, n_bent = 0, n_seen = 0;
  for (size_t i = 0; i < octree->n_nodes; i++) {
    if (pixels[i] < 0.0f || isinf(pixels[i]))
      continue;
    double weight = (double)pixels[i] / plain_pixels(octree, &view, i), cone = (double)octree->cone[i];
    CHECK(weight < 1.01 && weight > 1.0 / (double)CONIC_COVER_WEIGHT - 1e-4);
    CHECK(weight > sqrt(seen_cosine(octree, &view, i)) - 1e-3);
    if (cone < 0.998) { /* 1/16 is the sine of 3.6 degrees */
      CHECK(weight > 1.0 - 1e-4);
      n_bent++;
    }
    if ((double)octree->error[i] > (double)octree->radius[i]) { /* sticks out; is strict down to a 10th */
      CHECK(weight > 1.0 - 1e-4 || seen_cosine(octree, &view, i) < 0.1);
    }
    n_less += weight < 0.9;
    n_seen++;
  }
  fprintf(stderr, "%s: of %zu nodes in sight %zu count less, %zu are bent\n", what, n_seen, n_less, n_bent);
  CHECK(n_seen > 100 && n_less > 10);
  free(pixels);
  conic_octree_destroy(octree);
}

static void test_weights(conic_scene_type type, double zoom, const char *what) {
  fixture f = fixture_open(2);
  fixture_scene(&f, type, 20000);
  octree_frame(&f, SIZE, 30.0, 10.0, zoom);
  check_tilt_weights(&f, what);
  fixture_close(&f);
}

/* Two floors, one over the other, from close by: what is seen of nodes differs from place to place, and no cone says
 * that one floor is lower. */
static void test_weights_nearby(void) {
  fixture f = fixture_open(2);
  make_floor(&f, 20000, 0.35);
  for (size_t i = 0; i < f.splats.count; i += 2)
    f.splats.position[2][i] -= 0.0026f;
  look_at_floor(&f, 83.7, 1.0);
  f.camera.cam_from_world[2][3] = 0.2;
  check_tilt_weights(&f, "floors");
  fixture_close(&f);
}

static double squares_between(const float *a, const float *b) {
  double sum = 0.0;
  for (int i = 0; i < 4 * SIZE * SIZE; i++)
    sum += ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]);
  return sum;
}

/* Going down to a floor by half a degree a frame: where nodes take their children's place, the picture changes little
 * more than that of everything does. */
static void test_descent(void) {
  static float wholes[2][4 * SIZE * SIZE], chosen[2][4 * SIZE * SIZE];
  fixture f = fixture_open(2);
  conic_selection selection = {0};
  double changed = 0.0, changed_whole = 0.0;
  make_floor(&f, 100000, 0.35);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  f.options.near_z = conic_octree_near(octree);
  for (int frame = 0; frame < 50; frame++) {
    look_at_floor(&f, 60.0 + 0.5 * frame, 1.5);
    memcpy(wholes[frame % 2], draw_whole_plane(&f), sizeof wholes[0]);
    octree_select(octree, &f, 1.0, 0, &selection);
    octree_draw(&f, octree, &selection);
    memcpy(chosen[frame % 2], f.image.planes[CONIC_PLANE_RGBA], sizeof chosen[0]);
    changed += frame ? squares_between(chosen[0], chosen[1]) : 0.0;
    changed_whole += frame ? squares_between(wholes[0], wholes[1]) : 0.0;
  }
  fprintf(stderr, "descent: changes %.3f of everything's\n", sqrt(changed / changed_whole));
  CHECK(changed <= changed_whole * 1.05 * 1.05);
  conic_selection_release(f.context, &selection);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

int main(void) {
  test_floor();
  test_confetti_floor();
  test_against_confetti(CONIC_SCENE_KNOT, 0, 1.0, "knot");
  test_against_confetti(CONIC_SCENE_KNOT, 1, 1.0, "knot, --cull back");
  test_against_confetti(CONIC_SCENE_SPHERE, 0, 1.0, "sphere");
  test_against_confetti(CONIC_SCENE_TERRAIN, 0, 2.0, "terrain");
  test_weights(CONIC_SCENE_KNOT, 1.0, "knot");
  test_weights(CONIC_SCENE_TERRAIN, 2.0, "terrain");
  test_weights_nearby();
  test_descent();
  return check_result();
}
