/* The analytic scenes: on their surfaces, closed, even, and the same bits however they are asked for. */
#include "conic/conic.h"
#include "core/base/color.h"
#include "core/scenes/scene_terrain.h"
#include "tests/support/check.h"
#include "tests/support/scene_grid.h"

#define PI 3.14159265358979323846

enum { FIELDS = CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_CLIPS, N_ARRAYS = 12 };

static conic_scene_options options_of(conic_scene_type type, size_t count) {
  conic_scene_options options;
  conic_scene_options_init(&options);
  options.type = type;
  options.count = count;
  return options;
}

/* All splats of a scene; ends the program where that fails. */
static conic_splats sample_all(conic_context *context, const conic_scene_options *options) {
  conic_scene *scene;
  conic_splats splats;
  if (conic_scene_create(context, options, &scene) != CONIC_OK ||
      conic_splats_allocate(context, options->count, FIELDS, &splats) != CONIC_OK ||
      conic_scene_sample(scene, 0, options->count, &splats) != CONIC_OK)
    exit(1);
  conic_scene_destroy(scene);
  return splats;
}

static conic_splats sample_plain(conic_context *context, conic_scene_type type, size_t count) {
  conic_scene_options options = options_of(type, count);
  return sample_all(context, &options);
}

static void list_arrays(const conic_splats *splats, float *arrays[N_ARRAYS]) {
  for (int axis = 0; axis < 3; axis++) {
    arrays[axis] = splats->position[axis];
    arrays[3 + axis] = splats->tangent_u[axis];
    arrays[6 + axis] = splats->tangent_v[axis];
    arrays[9 + axis] = splats->color[axis];
  }
}

/* Whether the clip lines of part[0 … n) are those of whole[first … first + n). */
static int are_clips_part(const conic_splats *whole, size_t first, const conic_splats *part, size_t n) {
  size_t at = 0;
  while (at < whole->n_clips && whole->clips[at].splat < first)
    at++;
  for (size_t i = 0; i < part->n_clips; i++, at++) {
    conic_clip moved = part->clips[i];
    moved.splat += (uint32_t)first;
    if (at == whole->n_clips || memcmp(&moved, &whole->clips[at], sizeof moved) != 0)
      return 0;
  }
  return at == whole->n_clips || whole->clips[at].splat >= first + n;
}

/* Whether part[0 … n) is whole[first … first + n), bit for bit. */
static int is_part(const conic_splats *whole, size_t first, const conic_splats *part, size_t n) {
  float *a[N_ARRAYS], *b[N_ARRAYS];
  list_arrays(whole, a);
  list_arrays(part, b);
  for (int i = 0; i < N_ARRAYS; i++)
    if (memcmp(a[i] + first, b[i], n * sizeof(float)) != 0)
      return 0;
  return part->count == n && are_clips_part(whole, first, part, n);
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void get(float *const vector[3], size_t i, double value[3]) {
  for (int axis = 0; axis < 3; axis++)
    value[axis] = (double)vector[axis][i];
}

/* t_u × t_v, made a unit. */
static void normal_of(const conic_splats *splats, size_t i, double normal[3]) {
  double u[3], v[3];
  get(splats->tangent_u, i, u);
  get(splats->tangent_v, i, v);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = u[(axis + 1) % 3] * v[(axis + 2) % 3] - u[(axis + 2) % 3] * v[(axis + 1) % 3];
  double length = sqrt(dot(normal, normal));
  for (int axis = 0; axis < 3; axis++)
    normal[axis] /= length;
}

/* The spacing sqrt(area / count) that the splats' outlines stand for, at the default cutoff. */
static double spacing_of(const conic_splats *splats) {
  double u[3];
  get(splats->tangent_u, 0, u);
  return sqrt(dot(u, u));
}

static void test_refusals(conic_context *context) {
  conic_scene *scene;
  conic_splats splats;
  conic_scene_options options = options_of(CONIC_SCENE_SPHERE, 0);
  CHECK(conic_scene_create(context, &options, &scene) == CONIC_ERROR_ARGUMENT && !scene);
  options = options_of((conic_scene_type)CONIC_N_SCENES, 10);
  CHECK(conic_scene_create(context, &options, &scene) == CONIC_ERROR_ARGUMENT);
  options = options_of(CONIC_SCENE_SPHERE, 10);
  options.jitter = -0.1;
  CHECK(conic_scene_create(context, &options, &scene) == CONIC_ERROR_ARGUMENT);
  options = options_of(CONIC_SCENE_SPHERE, 10);
  options.noise = (double)NAN;
  CHECK(conic_scene_create(context, &options, &scene) == CONIC_ERROR_ARGUMENT);
  options = options_of(CONIC_SCENE_SPHERE, 10);
  options.cutoff = 0.0f;
  CHECK(conic_scene_create(context, &options, &scene) == CONIC_ERROR_ARGUMENT);
  options = options_of(CONIC_SCENE_SPHERE, 10);
  options.offset[1] = HUGE_VAL;
  CHECK(conic_scene_create(context, &options, &scene) == CONIC_ERROR_ARGUMENT);

  options = options_of(CONIC_SCENE_SPHERE, 10);
  CHECK_OK(conic_scene_create(context, &options, &scene));
  CHECK_OK(conic_splats_allocate(context, 20, FIELDS, &splats));
  CHECK(conic_scene_sample(scene, 5, 6, &splats) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_scene_sample(scene, 11, 0, &splats) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_scene_sample(scene, (size_t)-1, 2, &splats) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_scene_sample(scene, 10, 0, &splats) == CONIC_OK && splats.count == 0);
  conic_splats_release(context, &splats);
  CHECK_OK(conic_splats_allocate(context, 20, CONIC_SPLATS_TANGENTS, &splats));
  CHECK(conic_scene_sample(scene, 0, 5, &splats) == CONIC_ERROR_ARGUMENT);
  conic_splats_release(context, &splats);
  conic_scene_destroy(scene);
  CHECK(!conic_scene_name((conic_scene_type)CONIC_N_SCENES) && !conic_scene_summary((conic_scene_type)-1));
}

static void test_batches(conic_context *context, const conic_scene_options *options, const conic_splats *whole) {
  static const size_t sizes[] = {1, 7, 4097, 333, 1, 5000, 2};
  conic_scene *scene;
  conic_splats batch;
  CHECK_OK(conic_scene_create(context, options, &scene));
  CHECK_OK(conic_splats_allocate(context, 5000, FIELDS, &batch));
  for (size_t first = 0, i = 0; first < options->count; first += batch.count, i++) {
    size_t n = sizes[i % 7] < options->count - first ? sizes[i % 7] : options->count - first;
    CHECK_OK(conic_scene_sample(scene, first, n, &batch));
    CHECK(is_part(whole, first, &batch, n));
    if (check_failures)
      break;
  }
  conic_splats_release(context, &batch);
  conic_scene_destroy(scene);
}

static void test_bits(conic_context *context, conic_scene_type type) {
  conic_scene_options options = options_of(type, 20011);
  options.seed = 77;
  options.jitter = 0.3;
  options.noise = 0.1;
  conic_splats whole = sample_all(context, &options);
  static const int threads[] = {1, 7};
  for (int i = 0; i < 2; i++) {
    conic_context *other = check_context(threads[i]);
    conic_splats again = sample_all(other, &options);
    CHECK(is_part(&whole, 0, &again, options.count));
    conic_splats_release(other, &again);
    conic_context_destroy(other);
  }
  test_batches(context, &options, &whole);
  options.seed = 78;
  conic_splats moved = sample_all(context, &options);
  CHECK(!is_part(&whole, 0, &moved, options.count));
  conic_splats_release(context, &moved);
  conic_splats_release(context, &whole);
}

/* Equally long, orthogonal axes; colours of 8-bit codes. */
static void test_splats(const conic_splats *splats) {
  float decode[256], thresholds[255];
  double sigma = spacing_of(splats);
  conic_srgb_decode_table(decode);
  conic_srgb_thresholds(thresholds);
  for (size_t i = 0; i < splats->count; i++) {
    double u[3], v[3];
    get(splats->tangent_u, i, u);
    get(splats->tangent_v, i, v);
    CHECK_NEAR(sqrt(dot(u, u)), sigma, 2e-7 * sigma);
    CHECK_NEAR(sqrt(dot(v, v)), sigma, 2e-7 * sigma);
    CHECK_NEAR(dot(u, v), 0.0, 2e-7 * sigma * sigma);
    for (int c = 0; c < 3; c++)
      CHECK(decode[conic_srgb_code(thresholds, splats->color[c][i])] == splats->color[c][i]);
    if (check_failures)
      return;
  }
}

/* Where the surface is zero and which way its outside lies, written apart from the library and with the C library's
 * functions: the signed distance to first order. */
static double distance_plane(const double p[3], double outward[3]) {
  outward[0] = outward[1] = 0.0;
  outward[2] = 1.0;
  CHECK(fabs(p[0]) < 0.5 && fabs(p[1]) < 0.5);
  return p[2];
}

static double distance_sphere(const double p[3], double outward[3]) {
  double radius = sqrt(dot(p, p));
  for (int axis = 0; axis < 3; axis++)
    outward[axis] = p[axis] / radius;
  return radius - 1.0;
}

static double distance_torus(const double p[3], double outward[3]) {
  double ring = hypot(p[0], p[2]), tube = hypot(ring - 1.0, p[1]);
  outward[0] = p[0] / ring * (ring - 1.0) / tube;
  outward[1] = p[1] / tube;
  outward[2] = p[2] / ring * (ring - 1.0) / tube;
  return tube - 0.4;
}

static void knot_curve(double t, double place[3]) {
  place[0] = (1.0 + 0.45 * cos(3.0 * t)) * sin(2.0 * t);
  place[1] = 0.45 * sin(3.0 * t);
  place[2] = (1.0 + 0.45 * cos(3.0 * t)) * cos(2.0 * t);
}

static double knot_distance(double t, const double p[3], double difference[3]) {
  double place[3];
  knot_curve(t, place);
  for (int axis = 0; axis < 3; axis++)
    difference[axis] = p[axis] - place[axis];
  return sqrt(dot(difference, difference));
}

/* The nearest place of the curve by trial in steps, then in ever smaller ones. */
static double distance_knot(const double p[3], double outward[3]) {
  double best = HUGE_VAL, at = 0.0, step = 2.0 * PI / 400.0;
  for (int i = 0; i < 400; i++) {
    double d = knot_distance((double)i * step, p, outward);
    at = d < best ? (double)i * step : at;
    best = d < best ? d : best;
  }
  for (; step > 1e-9; step *= 0.5)
    for (int side = -1; side <= 1; side += 2) {
      double d = knot_distance(at + side * step, p, outward);
      at = d < best ? at + side * step : at;
      best = d < best ? d : best;
    }
  best = knot_distance(at, p, outward);
  for (int axis = 0; axis < 3; axis++)
    outward[axis] /= best;
  return best - 0.26;
}

static double distance_terrain(const double p[3], double outward[3]) {
  conic_terrain_place place;
  conic_terrain_at(0, p[0], p[2], &place);
  double length = sqrt(1.0 + place.slope[0] * place.slope[0] + place.slope[1] * place.slope[1]);
  outward[0] = -place.slope[0] / length;
  outward[1] = 1.0 / length;
  outward[2] = -place.slope[1] / length;
  CHECK(fabs(p[0]) <= 1.0 && fabs(p[2]) <= 1.0 && p[1] >= 0.0);
  return (p[1] - place.height) / length;
}

static double distance_gyroid(const double p[3], double outward[3]) {
  const double k = 22.0 * PI;
  double x = k * p[0], y = k * p[1], z = k * p[2];
  outward[0] = cos(x) * cos(y) - sin(z) * sin(x);
  outward[1] = cos(y) * cos(z) - sin(x) * sin(y);
  outward[2] = cos(z) * cos(x) - sin(y) * sin(z);
  double length = sqrt(dot(outward, outward));
  for (int axis = 0; axis < 3; axis++) {
    CHECK(fabs(p[axis]) < 1.01);
    outward[axis] /= length;
  }
  return (sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x)) / (k * length);
}

/* The outside of the cube is where its greatest coordinate is. */
static double distance_cube(const double p[3], double outward[3]) {
  int axis = 0;
  for (int i = 1; i < 3; i++)
    axis = fabs(p[i]) > fabs(p[axis]) ? i : axis;
  outward[0] = outward[1] = outward[2] = 0.0;
  outward[axis] = p[axis] < 0.0 ? -1.0 : 1.0;
  return fabs(p[axis]) - 0.5;
}

/* Of the missing octant, where the least one is. */
static double distance_corner(const double p[3], double outward[3]) {
  double d = distance_cube(p, outward);
  int axis = 0;
  if (fabs(d) < 1e-6) {
    CHECK(!(p[0] > 1e-6 && p[1] > 1e-6 && p[2] > 1e-6));
    return d;
  }
  for (int i = 1; i < 3; i++)
    axis = p[i] < p[axis] ? i : axis;
  for (int i = 0; i < 3; i++)
    outward[i] = i == axis;
  return p[axis];
}

static double (*const distances[CONIC_N_SCENES])(const double[3], double[3]) = {
    distance_plane,   distance_sphere, distance_torus, distance_knot,
    distance_terrain, distance_gyroid, distance_cube,  distance_corner};

static void test_surface(conic_context *context, conic_scene_type type) {
  conic_splats splats = sample_plain(context, type, 5003);
  test_splats(&splats);
  for (size_t i = 0; i < splats.count && !check_failures; i++) {
    double p[3], outward[3], normal[3];
    get(splats.position, i, p);
    normal_of(&splats, i, normal);
    CHECK_NEAR(distances[type](p, outward), 0.0, 3e-7);
    /* The terrain's slope changes within the rounding of a position, and jumps at the shore. */
    if (type != CONIC_SCENE_TERRAIN || p[1] > 0.001)
      CHECK(dot(outward, normal) > (type == CONIC_SCENE_TERRAIN ? 0.999 : 1.0 - 1e-9));
  }
  conic_splats_release(context, &splats);
  for (size_t count = 1; count <= 7; count++) {
    splats = sample_plain(context, type, count);
    test_splats(&splats);
    for (size_t i = 0; i < count; i++) {
      double p[3], outward[3];
      get(splats.position, i, p);
      CHECK_NEAR(distances[type](p, outward), 0.0, 3e-7);
    }
    conic_splats_release(context, &splats);
  }
}

/* Every place of the surface, as a finer sampling has them, is inside some outline. */
static void test_closed(conic_context *context, conic_scene_type type, size_t count) {
  conic_splats splats = sample_plain(context, type, count), finer = sample_plain(context, type, 3 * count + 1);
  double outline = 1.5 * spacing_of(&splats), largest = 0.0;
  scene_grid grid = scene_grid_make(&splats, outline);
  for (size_t i = 0; i < finer.count; i++) {
    double p[3], nearest;
    get(finer.position, i, p);
    scene_grid_look(&grid, p, outline, &nearest);
    largest = nearest > largest ? nearest : largest;
  }
  CHECK(largest < outline);
  scene_grid_release(&grid);
  conic_splats_release(context, &finer);
  conic_splats_release(context, &splats);
}

/* The number of splats about each one is what the area says, within `bound`; for surfaces without border. */
static void test_even(conic_context *context, conic_scene_type type, size_t count, double bound) {
  conic_splats splats = sample_plain(context, type, count);
  double radius = 6.0 * spacing_of(&splats), expected = PI * 36.0, sum = 0.0;
  size_t n_looked = 0;
  scene_grid grid = scene_grid_make(&splats, radius);
  for (size_t i = 0; i < count; i += 7) {
    double p[3], nearest;
    get(splats.position, i, p);
    double n = (double)scene_grid_look(&grid, p, radius, &nearest);
    CHECK_NEAR(n / expected, 1.0, bound);
    if (check_failures)
      break;
    sum += n;
    n_looked++;
  }
  CHECK(n_looked > count / 100);
  CHECK_NEAR(sum / (double)n_looked / expected, 1.0, 0.05);
  scene_grid_release(&grid);
  conic_splats_release(context, &splats);
}

/* The surface's area over a cell of the square, by sums over a fine grid. */
static double area_over(double x, double z, double edge) {
  enum { STEPS = 32 };
  double sum = 0.0;
  for (int k = 0; k < STEPS * STEPS; k++) {
    conic_terrain_place place;
    conic_terrain_at(0, x + edge * (k % STEPS + 0.5) / STEPS, z + edge * (double)(k / STEPS + 0.5) / STEPS, &place);
    sum += sqrt(1.0 + place.slope[0] * place.slope[0] + place.slope[1] * place.slope[1]);
  }
  return sum * edge * edge / (STEPS * STEPS);
}

/* Rough ground has no round neighbourhoods; so the splats over each of many cells against the area there. */
static void test_even_terrain(conic_context *context) {
  enum { COUNT = 200003, EDGE = 16 };
  conic_splats splats = sample_plain(context, CONIC_SCENE_TERRAIN, COUNT);
  double spacing = spacing_of(&splats), counts[EDGE][EDGE] = {{0}};
  for (size_t i = 0; i < COUNT; i++) {
    int column = (int)(((double)splats.position[0][i] + 1.0) * 0.5 * EDGE);
    int row = (int)(((double)splats.position[2][i] + 1.0) * 0.5 * EDGE);
    counts[row < EDGE ? row : EDGE - 1][column < EDGE ? column : EDGE - 1] += 1.0;
  }
  for (int k = 0; k < EDGE * EDGE; k++) {
    double area = area_over(2.0 * (k % EDGE) / EDGE - 1.0, 2.0 * (double)(k / EDGE) / EDGE - 1.0, 2.0 / EDGE);
    CHECK_NEAR(counts[k / EDGE][k % EDGE] * spacing * spacing / area, 1.0, 0.06);
  }
  conic_splats_release(context, &splats);
}

/* The areas that the outlines stand for. */
static void test_areas(conic_context *context) {
  static const double areas[] = {1.0, 4.0 * PI, 4.0 * PI * PI * 0.4};
  for (int i = 0; i < 3; i++) {
    conic_splats splats = sample_plain(context, (conic_scene_type)i, 1000);
    double spacing = spacing_of(&splats);
    CHECK_NEAR(spacing * spacing * 1000.0, areas[i], 1e-6 * areas[i]);
    conic_splats_release(context, &splats);
  }
  /* From 30° to the side and 15° above, the cube covers this much; half of the surface faces each way. */
  double shadow = 4.0 * (sin(PI / 6.0) * cos(PI / 12.0) + sin(PI / 12.0) + cos(PI / 6.0) * cos(PI / 12.0));
  conic_splats splats = sample_plain(context, CONIC_SCENE_GYROID, 1000);
  double area = spacing_of(&splats) * spacing_of(&splats) * 1000.0;
  CHECK(area / 2.0 / shadow > 20.0);
  conic_splats_release(context, &splats);
}

/* Noise and jitter, as differences from the set without. */
static void test_moves(conic_context *context) {
  enum { COUNT = 40000 };
  conic_scene_options options = options_of(CONIC_SCENE_SPHERE, COUNT);
  conic_splats plain = sample_all(context, &options);
  options.noise = 0.5;
  conic_splats noisy = sample_all(context, &options);
  options.noise = 0.0;
  options.jitter = 0.4;
  conic_splats jittered = sample_all(context, &options);
  double spacing = spacing_of(&plain), mean = 0.0, square = 0.0, most = 0.0, jitter_square = 0.0;
  for (size_t i = 0; i < COUNT; i++) {
    double a[3], b[3], c[3], normal[3];
    get(plain.position, i, a);
    get(noisy.position, i, b);
    get(jittered.position, i, c);
    normal_of(&plain, i, normal);
    for (int axis = 0; axis < 3; axis++) {
      b[axis] = (b[axis] - a[axis]) / spacing;
      c[axis] = (c[axis] - a[axis]) / spacing;
    }
    double along = dot(b, normal);
    CHECK_NEAR(dot(b, b), along * along, 1e-4);
    CHECK_NEAR(dot(c, normal), 0.0, 1e-4);
    mean += along / COUNT;
    square += along * along / COUNT;
    most = dot(c, c) > most ? dot(c, c) : most;
    jitter_square += dot(c, c) / COUNT;
  }
  CHECK_NEAR(mean, 0.0, 5.0 * 0.5 / sqrt(COUNT));
  CHECK_NEAR(square, 0.25, 5.0 * 0.25 * sqrt(2.0 / COUNT));
  CHECK(sqrt(most) <= 0.4001 && sqrt(most) > 0.399);
  CHECK_NEAR(jitter_square, 0.08, 0.001); /* a disc's mean square is half of its radius squared */
  conic_splats_release(context, &plain);
  conic_splats_release(context, &noisy);
  conic_splats_release(context, &jittered);
}

static void test_offset(conic_context *context) {
  conic_scene_options options = options_of(CONIC_SCENE_TORUS, 999);
  conic_splats here = sample_all(context, &options);
  options.offset[0] = 1e7;
  options.offset[2] = -0.1;
  conic_splats there = sample_all(context, &options);
  CHECK(is_part(&here, 0, &there, 999));
  CHECK(there.origin[0] == 1e7 && there.origin[1] == 0.0 && there.origin[2] == -0.1);
  CHECK(here.origin[0] == 0.0 && here.origin[1] == 0.0 && here.origin[2] == 0.0);
  conic_splats_release(context, &here);
  conic_splats_release(context, &there);
}

/* Written as circles and read again: the same places, normals, radii and colours. */
static void test_file(conic_context *context) {
  const char *path = "test_scene_circles.ply";
  conic_write_options options;
  conic_model model;
  conic_splats splats = sample_plain(context, CONIC_SCENE_KNOT, 3001);
  conic_write_options_init(&options);
  options.circles = 1;
  CHECK_OK(conic_splats_write(context, path, &splats, &options));
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(model.points.count == splats.count);
  double sigma = spacing_of(&splats);
  for (size_t i = 0; i < model.points.count && !check_failures; i++) {
    double before[3], after[3], u[3], v[3];
    normal_of(&splats, i, before);
    normal_of(&model.points, i, after);
    get(model.points.tangent_u, i, u);
    get(model.points.tangent_v, i, v);
    CHECK_NEAR(dot(u, u) / (sigma * sigma), 1.0, 1e-6);
    CHECK_NEAR(dot(v, v) / (sigma * sigma), 1.0, 1e-6);
    for (int axis = 0; axis < 3; axis++) {
      CHECK_NEAR(before[axis], after[axis], 5e-7);
      CHECK(splats.position[axis][i] == model.points.position[axis][i] && model.points.origin[axis] == 0.0);
      CHECK(splats.color[axis][i] == model.points.color[axis][i]);
    }
  }
  remove(path);
  conic_model_release(context, &model);
  conic_splats_release(context, &splats);
}

/* The plane's checkerboard: white, and code 32; dark at (-½, -½). A square count gives a grid. */
static void test_checkerboard(conic_context *context) {
  static const size_t counts[] = {6400, 6401};
  float dark = (float)conic_srgb_decode(32.0 / 255.0);
  for (int k = 0; k < 2; k++) {
    conic_splats splats = sample_plain(context, CONIC_SCENE_PLANE, counts[k]);
    for (size_t i = 0; i < counts[k]; i++) {
      double x = 8.0 * ((double)splats.position[0][i] + 0.5), y = 8.0 * ((double)splats.position[1][i] + 0.5);
      int is_white = ((int)x + (int)y) % 2;
      if (fabs(x - floor(x + 0.5)) < 1e-5 || fabs(y - floor(y + 0.5)) < 1e-5)
        continue; /* on a line, where the rounding of the position decides */
      for (int c = 0; c < 3; c++)
        CHECK(splats.color[c][i] == (is_white ? 1.0f : dark));
      if (k == 0) {
        CHECK_NEAR(10.0 * x - floor(10.0 * x), 0.5, 1e-4);
        CHECK_NEAR(10.0 * y - floor(10.0 * y), 0.5, 1e-4);
      }
    }
    conic_splats_release(context, &splats);
  }
}

int main(void) {
  static const size_t closed_counts[CONIC_N_SCENES] = {20011, 20011, 20011, 20011, 60013, 700001, 20011, 20011};
  conic_context *context = check_context(2);
  test_refusals(context);
  for (int type = 0; type < CONIC_N_SCENES; type++) {
    test_bits(context, (conic_scene_type)type);
    test_surface(context, (conic_scene_type)type);
    test_closed(context, (conic_scene_type)type, closed_counts[type]);
  }
  test_even(context, CONIC_SCENE_SPHERE, 50021, 0.12);
  test_even(context, CONIC_SCENE_TORUS, 50021, 0.12);
  test_even(context, CONIC_SCENE_KNOT, 100003, 0.2);
  test_even_terrain(context);
  test_areas(context);
  test_moves(context);
  test_offset(context);
  test_file(context);
  test_checkerboard(context);
  conic_context_destroy(context);
  return check_result();
}
