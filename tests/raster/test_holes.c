/* No pinholes inside what was sampled: the scans and meshes of the shared data from six sides.
 *
 * A hole is a 4-connected set of pixels that shows nothing, or shows what lies far behind all that surrounds it. It is
 * a pinhole where one surface was sampled on all sides of it and yet does not close: where the centres of the splats
 * that its rim, the covered pixels around it, belongs to lie within 3 local spacings in each axis of the camera's
 * space, and the rim's normals agree and look at the viewer. What is left are the gaps that are in the data: where the
 * scanner saw nothing, between leaves, at silhouettes. The local spacing is the edge of the square that each point has
 * to itself, by the disc that holds its 6 nearest neighbours; of the rim's, the median. "Far behind" is 3 of those too.
 */
#include "core/estimate/neighbours.h"
#include "tests/support/fixture.h"

enum { SIZE = 1024, MAX_SPAN = 160 /* pixels; what is wider is no pinhole of these models */ };

static const double reach = 3.0;
static const double one_surface = 0.85;  /* how long the mean of a rim's normals is: within some 30° of each other */
static const double from_its_face = 0.3; /* and its mean cosine to the viewer: what is steeper is a silhouette */

typedef struct hole_search {
  const fixture *f;
  const float *spacing; /* of each splat */
  int width, height;
  int *component; /* of each pixel, from 1; 0: not yet */
  int *members;   /* the pixels of the component that is being looked at */
  int n_members;
} hole_search;

static int compare_doubles(const void *a, const void *b) {
  const double *first = a, *second = b;
  return (*first > *second) - (*first < *second);
}

static const float *depths(const hole_search *s) {
  return s->f->image.planes[CONIC_PLANE_Z];
}

static int is_covered(const hole_search *s, int pixel) {
  return ((const uint32_t *)s->f->image.planes[CONIC_PLANE_ID])[pixel] != CONIC_NO_ID;
}

static double spacing_at(const hole_search *s, int pixel) {
  return (double)s->spacing[((const uint32_t *)s->f->image.planes[CONIC_PLANE_ID])[pixel]];
}

static int is_joined(const hole_search *s, int a, int b) {
  if (!is_covered(s, a) || !is_covered(s, b))
    return is_covered(s, a) == is_covered(s, b);
  double step = fabs((double)depths(s)[a] - (double)depths(s)[b]);
  return step <= reach * fmax(spacing_at(s, a), spacing_at(s, b));
}

/* Gathers the component of `first`; returns whether it stays clear of the picture's edge. */
static int gather(hole_search *s, int first, int label, int low[2], int high[2]) {
  int is_inside = 1;
  s->members[0] = first;
  s->n_members = 1;
  s->component[first] = label;
  low[0] = high[0] = first % s->width;
  low[1] = high[1] = first / s->width;
  for (int next = 0; next < s->n_members; next++) {
    int pixel = s->members[next], x = pixel % s->width, y = pixel / s->width;
    low[0] = x < low[0] ? x : low[0];
    high[0] = x > high[0] ? x : high[0];
    low[1] = y < low[1] ? y : low[1];
    high[1] = y > high[1] ? y : high[1];
    if (x == 0 || y == 0 || x == s->width - 1 || y == s->height - 1)
      is_inside = 0;
    const int neighbours[4] = {x > 0 ? pixel - 1 : -1, x < s->width - 1 ? pixel + 1 : -1, y > 0 ? pixel - s->width : -1,
                               y < s->height - 1 ? pixel + s->width : -1};
    for (int k = 0; k < 4; k++)
      if (neighbours[k] >= 0 && !s->component[neighbours[k]] && is_joined(s, pixel, neighbours[k])) {
        s->component[neighbours[k]] = label;
        s->members[s->n_members++] = neighbours[k];
      }
  }
  return is_inside;
}

/* What surrounds a component. */
typedef struct rim {
  int n;
  double spacings[4 * MAX_SPAN * MAX_SPAN];
  double low[3], high[3]; /* of the centres of the splats that its pixels name, in camera space */
  double farthest;        /* depth */
  double normal[3];       /* the sum of the pixels' normals, and of their cosines to the viewer */
  double facing;
} rim;

static void add_to_rim(const hole_search *s, int pixel, rim *r) {
  const conic_camera *camera = &s->f->camera;
  const conic_splats *splats = &s->f->splats;
  const float *normal = (const float *)s->f->image.planes[CONIC_PLANE_NORMAL] + 3 * (size_t)pixel;
  uint32_t i = ((const uint32_t *)s->f->image.planes[CONIC_PLANE_ID])[pixel];
  const double ray[3] = {(pixel % s->width + 0.5 - camera->cx) / camera->fx,
                         (pixel / s->width + 0.5 - camera->cy) / camera->fy, 1.0};
  double along = 0.0;
  for (int row = 0; row < 3; row++) {
    const double *m = camera->cam_from_world[row];
    double place = m[3], direction = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      place += m[axis] * (splats->origin[axis] + (double)splats->position[axis][i]);
      direction += m[axis] * (double)normal[axis];
    }
    r->low[row] = fmin(r->low[row], place);
    r->high[row] = fmax(r->high[row], place);
    r->normal[row] += direction;
    along -= direction * ray[row];
  }
  r->facing += along / sqrt(ray[0] * ray[0] + ray[1] * ray[1] + 1.0);
  r->farthest = fmax(r->farthest, (double)depths(s)[pixel]);
  if (r->n < 4 * MAX_SPAN * MAX_SPAN)
    r->spacings[r->n++] = spacing_at(s, pixel);
}

/* Whether the gathered component is a pinhole: its rim covered, before it, small, and one surface seen from its face.
 */
static int is_pinhole(const hole_search *s, int label) {
  static rim r;
  double nearest = INFINITY;
  memset(&r, 0, sizeof r);
  for (int axis = 0; axis < 3; axis++) {
    r.low[axis] = INFINITY;
    r.high[axis] = -INFINITY;
  }
  for (int i = 0; i < s->n_members; i++) {
    if (is_covered(s, s->members[i]))
      nearest = fmin(nearest, (double)depths(s)[s->members[i]]);
    for (int k = 0; k < 9; k++) {
      int at = s->members[i] + (k / 3 - 1) * s->width + k % 3 - 1;
      if (s->component[at] == label)
        continue;
      if (!is_covered(s, at))
        return 0;
      add_to_rim(s, at, &r);
    }
  }
  qsort(r.spacings, (size_t)r.n, sizeof *r.spacings, compare_doubles);
  double limit = reach * r.spacings[r.n / 2];
  double normal = sqrt(r.normal[0] * r.normal[0] + r.normal[1] * r.normal[1] + r.normal[2] * r.normal[2]);
  double hole[2] = {0.0, 0.0}; /* its middle, at the rim's depth */
  for (int i = 0; i < s->n_members; i++) {
    hole[0] += (s->members[i] % s->width + 0.5 - s->f->camera.cx) / s->f->camera.fx * r.farthest / s->n_members;
    hole[1] += (s->members[i] / s->width + 0.5 - s->f->camera.cy) / s->f->camera.fy * r.farthest / s->n_members;
  }
  for (int axis = 0; axis < 2; axis++)
    if (hole[axis] < r.low[axis] || hole[axis] > r.high[axis]) /* not sampled on all sides */
      return 0;
  return nearest - r.farthest > limit && r.high[0] - r.low[0] <= limit && r.high[1] - r.low[1] <= limit &&
         r.high[2] - r.low[2] <= limit && normal >= one_surface * r.n && r.facing >= from_its_face * r.n;
}

/* The spacing around each splat; the caller frees it. */
static float *find_spacings(const fixture *f) {
  enum { K = 6 };
  const float *const positions[3] = {f->splats.position[0], f->splats.position[1], f->splats.position[2]};
  conic_neighbours tree;
  float *spacing = calloc(f->splats.count, sizeof *spacing);
  if (!spacing || conic_neighbours_build(f->context, positions, f->splats.count, &tree) != CONIC_OK)
    exit(1);
  for (size_t i = 0; i < f->splats.count; i++) {
    uint32_t slots[K];
    double distances2[K], query[3];
    for (int axis = 0; axis < 3; axis++)
      query[axis] = (double)positions[axis][i];
    size_t n = conic_neighbours_nearest(&tree, query, tree.slot_of_point[i], K, HUGE_VAL, slots, distances2);
    spacing[i] = n == K ? (float)sqrt(3.14159265358979 * distances2[K - 1] / K) : 0.0f;
  }
  conic_neighbours_release(f->context, &tree);
  return spacing;
}

/* The pinholes of the fixture's image; the first few are named. */
static int count_pinholes(const fixture *f, const float *spacing, const char *what) {
  hole_search s = {.f = f, .spacing = spacing, .width = f->image.width, .height = f->image.height};
  size_t n_pixels = (size_t)s.width * (size_t)s.height;
  int n_found = 0, label = 0;
  s.component = calloc(n_pixels, sizeof *s.component);
  s.members = calloc(n_pixels, sizeof *s.members);
  if (!s.component || !s.members)
    exit(1);
  for (int pixel = 0; pixel < (int)n_pixels; pixel++) {
    int low[2], high[2];
    if (s.component[pixel] || !gather(&s, pixel, ++label, low, high))
      continue;
    if (high[0] - low[0] >= MAX_SPAN || high[1] - low[1] >= MAX_SPAN || !is_pinhole(&s, label))
      continue;
    if (n_found++ < 5 && what)
      fprintf(stderr, "%s: a pinhole of %d pixels at (%d, %d)\n", what, s.n_members, low[0], low[1]);
  }
  free(s.component);
  free(s.members);
  return n_found;
}

/* A sheet of 40 × 40 splats at z = 2 without those of a square of `gap`, and, where asked for, a whole one at z = 3. */
static int pinholes_of_sheet(double radius_in_spacings, int gap, int has_back) {
  enum { SIDE = 40 };
  const double spacing = 0.025, sigma = radius_in_spacings * spacing / 1.5, zero[3] = {0.0, 0.0, 0.0};
  const double u[3] = {sigma, 0.0, 0.0}, v[3] = {0.0, sigma, 0.0};
  fixture f = fixture_open(1);
  fixture_camera(&f, 256, 256, 400.0);
  fixture_splats(&f, (size_t)SIDE * SIDE * 2);
  for (int i = 0; i < SIDE * SIDE * 2; i++) {
    int x = i % SIDE, y = i / SIDE % SIDE, is_back = i >= SIDE * SIDE;
    int is_gone = is_back ? !has_back : x >= 20 && x < 20 + gap && y >= 20 && y < 20 + gap;
    const double place[3] = {(x - 19.5) * spacing, (y - 19.5) * spacing, is_back ? 3.0 : 2.0};
    fixture_set(&f, (size_t)i, place, is_gone ? zero : u, is_gone ? zero : v, 1.0f, 1.0f, 1.0f);
  }
  fixture_render(&f);
  float *spacings = find_spacings(&f);
  int n = count_pinholes(&f, spacings, NULL);
  free(spacings);
  fixture_close(&f);
  return n;
}

/* The search itself: it finds what is to be found and leaves the rest. */
static void test_search(void) {
  CHECK(pinholes_of_sheet(0.9, 0, 0) == 0);
  CHECK(pinholes_of_sheet(0.3, 0, 0) == 39 * 39); /* splats that meet and do not close */
  CHECK(pinholes_of_sheet(0.9, 2, 0) == 1);
  CHECK(pinholes_of_sheet(0.9, 2, 1) == 1); /* the back sheet shines through */
  CHECK(pinholes_of_sheet(0.9, 0, 1) == 0);
  CHECK(pinholes_of_sheet(0.9, 8, 0) == 0); /* a gap, not a pinhole */
  CHECK(pinholes_of_sheet(0.9, 8, 1) == 0);
}

/* No more than `most` pinholes over all sides. */
static void test_model(const char *source_folder, const char *name, const double up[3], int most) {
  static const double sides[6][2] = {{0, 0}, {90, 0}, {180, 0}, {270, 0}, {0, 90}, {0, -90}};
  const char *path = check_data(source_folder, name);
  if (!path)
    return;
  fixture f = fixture_open(0);
  conic_model model;
  conic_estimate_options estimate;
  double low[3], high[3];
  int n_pinholes = 0;
  conic_estimate_options_init(&estimate);
  CHECK_OK(conic_model_read(f.context, path, NULL, &model));
  CHECK_OK(conic_model_to_splats(f.context, &estimate, &model, NULL));
  f.splats = model.points;
  memset(&model.points, 0, sizeof model.points);
  conic_model_release(f.context, &model);
  float *spacing = find_spacings(&f);
  conic_splats_bounds(&f.splats, low, high);
  for (int side = 0; side < 6; side++) {
    char what[64];
    conic_framing framing;
    conic_framing_init(&framing);
    framing.width = framing.height = SIZE;
    framing.azimuth_deg = sides[side][0];
    framing.elevation_deg = sides[side][1];
    memcpy(framing.up, up, sizeof framing.up);
    CHECK_OK(conic_camera_frame(f.context, &framing, low, high, &f.camera));
    fixture_render(&f);
    CHECK(f.statistics.pixels_covered > 50000);
    snprintf(what, sizeof what, "%s, azimuth %g, elevation %g", name, sides[side][0], sides[side][1]);
    n_pinholes += count_pinholes(&f, spacing, what);
  }
  fprintf(stderr, "%s: %d pinholes\n", name, n_pinholes);
  CHECK(n_pinholes <= most);
  free(spacing);
  fixture_close(&f);
}

int main(int argc, char **argv) {
  const char *source_folder = argc > 1 ? argv[1] : ".";
  const double y_up[3] = {0.0, 1.0, 0.0}, z_up[3] = {0.0, 0.0, 1.0};
  test_search();
  /* A scan with foliage: these five, of one or two pixels each, lie between leaves and at ragged borders; the stone has
   * none. */
  test_model(source_folder, "lion.ply", z_up, 5);
  test_model(source_folder, "bunny.obj", y_up, 0);
  test_model(source_folder, "igea.ply", y_up, 0);
  test_model(source_folder, "nefertiti.obj", z_up, 0);
  return check_result();
}
