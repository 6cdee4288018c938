/* How far a site's surfel is from what it stands for, and from the mesh. */
#include "lod/clusters/cluster_sites.h"

#include "core/base/vectors.h"

enum { N_ENDS = 20 };

/* Where a surfel is measured, in its half axes: sixteen places of its outline in turn, and four within. */
static const double ends[N_ENDS][2] = {{1.0, 0.0},  {0.92388, 0.38268},   {0.70711, 0.70711},   {0.38268, 0.92388},
                                       {0.0, 1.0},  {-0.38268, 0.92388},  {-0.70711, 0.70711},  {-0.92388, 0.38268},
                                       {-1.0, 0.0}, {-0.92388, -0.38268}, {-0.70711, -0.70711}, {-0.38268, -0.92388},
                                       {0.0, -1.0}, {0.38268, -0.92388},  {0.70711, -0.70711},  {0.92388, -0.38268},
                                       {0.5, 0.0},  {0.0, 0.5},           {-0.5, 0.0},          {0.0, -0.5}};

static void find_ends(const conic_site *site, double at[N_ENDS][3]) {
  const conic_ellipse *e = &site->ellipse;
  for (int k = 0; k < N_ENDS; k++) {
    double along = ends[k][0] * e->reach, across = ends[k][1] * e->reach * e->ratio;
    double x = along * e->major[0] - across * e->major[1], y = along * e->major[1] + across * e->major[0];
    for (int axis = 0; axis < 3; axis++)
      at[k][axis] = site->at[axis] + x * site->u[axis] + y * site->v[axis];
  }
}

/* More than rounding takes. */
static const double rounding = 1.0 + 1e-9;

/* The mesh is no farther than the supports, which lie on it. Everything is relative to the site's foot, in the axes of
 * its plane and in units of `way`, which is no less than to any of the places: thus floats do, and `vague` is more than
 * they lose. */
static void bound_by_supports(const conic_sampler *s, const conic_site *site, double way, double bounds[N_ENDS]) {
  static const double vague = 1e-5;
  const uint32_t *of_site = &s->of_sites[site->first_support];
  const conic_ellipse *e = &site->ellipse;
  const double d[3] = {site->at[0] - site->foot[0], site->at[1] - site->foot[1], site->at[2] - site->foot[2]};
  double x = conic_dot(d, site->u), y = conic_dot(d, site->v), z = conic_dot(d, site->normal), unit = 1.0 / way;
  float ends_x[N_ENDS], ends_y[N_ENDS], least2[N_ENDS];
  for (int i = 0; i < N_ENDS; i++) {
    double along = ends[i][0] * e->reach, across = ends[i][1] * e->reach * e->ratio;
    ends_x[i] = (float)((x + (along * e->major[0] - across * e->major[1])) * unit);
    ends_y[i] = (float)((y + (along * e->major[1] + across * e->major[0])) * unit);
    least2[i] = HUGE_VALF;
  }
  for (size_t k = 0; k < site->n_supports; k++) {
    const conic_support *support = &s->supports[of_site[k]];
    float at_x = (float)(support->at[0] * unit), at_y = (float)(support->at[1] * unit);
    float dz = (float)((support->above - z) * unit), dz2 = dz * dz;
    for (int i = 0; i < N_ENDS; i++) {
      float dx = ends_x[i] - at_x, dy = ends_y[i] - at_y, distance2 = (dx * dx + dy * dy) + dz2;
      least2[i] = distance2 < least2[i] ? distance2 : least2[i];
    }
  }
  for (int i = 0; i < N_ENDS; i++)
    bounds[i] = way * (sqrt((double)least2[i]) * (1.0 + vague) + vague);
}

/* No place is farther from the mesh than another is, and the way to that. */
static void bound_by(const double at[N_ENDS][3], int from, double distance, double bounds[N_ENDS]) {
  for (int k = 0; k < N_ENDS; k++) {
    double x = at[k][0] - at[from][0], y = at[k][1] - at[from][1], z = at[k][2] - at[from][2];
    double bound = (distance + sqrt((x * x + y * y) + z * z)) * rounding;
    bounds[k] = bound < bounds[k] ? bound : bounds[k];
  }
  bounds[from] = distance;
}

static int largest_of(const double bounds[N_ENDS]) {
  int largest = 0;
  for (int k = 1; k < N_ENDS; k++)
    largest = bounds[k] > bounds[largest] ? k : largest;
  return largest;
}

/* The end of an axis that is nearest to place k of a site. */
static int end_of(int k) {
  return k < 16 ? (k + 2) / 4 % 4 : k - 16;
}

/* The face of the support that is nearest to the place. */
static uint32_t face_near(const conic_sampler *s, const conic_site *site, const double at[3]) {
  const double d[3] = {at[0] - site->foot[0], at[1] - site->foot[1], at[2] - site->foot[2]};
  double x = conic_dot(d, site->u), y = conic_dot(d, site->v), z = conic_dot(d, site->normal), least2 = HUGE_VAL;
  const uint32_t *of_site = &s->of_sites[site->first_support];
  uint32_t nearest = 0;
  for (size_t k = 0; k < site->n_supports; k++) {
    const conic_support *support = &s->supports[of_site[k]];
    double dx = x - support->at[0], dy = y - support->at[1], dz = z - support->above;
    double distance2 = (dx * dx + dy * dy) + dz * dz;
    nearest = distance2 < least2 ? of_site[k] : nearest;
    least2 = distance2 < least2 ? distance2 : least2;
  }
  return s->supports[nearest].face;
}

/* As conic_face_tree_bound. Most places are near enough to the face that is tried first, many others to that of the
 * support that is nearest. */
static double measure_place(const conic_sampler *s, const conic_site *site, const double at[3], uint32_t *near,
                            double enough) {
  double distance = conic_face_distance(&s->job->mesh->mesh, *near, at);
  if (distance <= enough)
    return distance;
  *near = face_near(s, site, at);
  return conic_face_tree_bound(s->job->tree, at, near, enough);
}

/* That of any place of the ellipse from the site's foot. */
static double greatest_way(const conic_site *site) {
  const double d[3] = {site->at[0] - site->foot[0], site->at[1] - site->foot[1], site->at[2] - site->foot[2]};
  return (conic_length(d) + site->ellipse.reach) * rounding;
}

/* What is known without a look at the mesh. The foot lies on it, and so do the supports, which nobody asks for where
 * the foot is near enough. */
static void begin_bounds(const conic_sampler *s, const conic_site *site, double enough, double bounds[N_ENDS]) {
  double way = s->job->is_off_mesh ? HUGE_VAL : greatest_way(site);
  for (int i = 0; i < N_ENDS; i++)
    bounds[i] = way;
  if (way > enough && !s->job->is_off_mesh)
    bound_by_supports(s, site, way, bounds);
}

/* Measures the places that are not known to be near enough, at first the one that may be farthest. That is soon far
 * enough from those before, or near enough to them, so that the others need no look. Most are near the face that was
 * nearest to the place before, or near the face of the support that is farthest that way. Returns the largest distance,
 * or `known`. */
static double measure_ends(const conic_sampler *s, const conic_site *site, double known, double bounds[N_ENDS]) {
  double at[N_ENDS][3];
  uint32_t near[4];
  memcpy(near, site->end_faces, sizeof near);
  find_ends(site, at);
  for (int k = largest_of(bounds); bounds[k] > known; k = largest_of(bounds)) {
    double distance = measure_place(s, site, at[k], &near[end_of(k)], known);
    known = distance > known ? distance : known;
    bound_by((const double(*)[3])at, k, distance, bounds);
  }
  return known;
}

double conic_site_error(const conic_sampler *s, const conic_site *site, double known, double *bound) {
  double bounds[N_ENDS];
  known = site->least_error > known ? site->least_error : known;
  begin_bounds(s, site, known, bounds);
  known = bounds[largest_of(bounds)] > known ? measure_ends(s, site, known, bounds) : known;
  double farthest = bounds[largest_of(bounds)];
  *bound = farthest > site->least_error ? farthest : site->least_error;
  return known;
}

/* --- closely --- */

/* Rings about the middle, the last the outline, at places a fortieth of a turn apart. A surfel of a cluster is farthest
 * on its outline; one that stands for more may lie over what the mesh leaves open. */
enum { RINGS = 4, PLACES_ON_RING = 40 };
static const double turn[2] = {0.98768834, 0.15643447};

/* No place is farther from the mesh than the one that was measured last is, and the way to that: so many need no look.
 */
typedef struct measured {
  double at[3], bound;
  uint32_t near; /* a face */
} measured;

static double farther_at(const conic_sampler *s, const double at[3], measured *last, double known) {
  const double way[3] = {at[0] - last->at[0], at[1] - last->at[1], at[2] - last->at[2]};
  if ((last->bound + conic_length(way)) * rounding <= known)
    return known;
  memcpy(last->at, at, sizeof last->at);
  last->bound = conic_face_tree_bound(s->job->tree, at, &last->near, known);
  return last->bound > known ? last->bound : known;
}

static double farther_on_ring(const conic_sampler *s, const conic_site *site, double size, measured *last,
                              double known) {
  const conic_ellipse *e = &site->ellipse;
  double way[2] = {size * e->reach, 0.0};
  for (int k = 0; k < PLACES_ON_RING; k++) {
    double across = e->ratio * way[1],
           turned[2] = {turn[0] * way[0] - turn[1] * way[1], turn[1] * way[0] + turn[0] * way[1]};
    double x = way[0] * e->major[0] - across * e->major[1], y = way[0] * e->major[1] + across * e->major[0], at[3];
    for (int axis = 0; axis < 3; axis++)
      at[axis] = site->at[axis] + x * site->u[axis] + y * site->v[axis];
    known = farther_at(s, at, last, known);
    memcpy(way, turned, sizeof way);
  }
  return known;
}

double conic_site_off_mesh(const conic_sampler *s, const conic_site *site, double known) {
  measured last = {.bound = HUGE_VAL, .near = site->face};
  known = farther_at(s, site->at, &last, known);
  if ((last.bound + site->ellipse.reach) * rounding <= known)
    return known;
  int n_rings = s->job->is_off_mesh ? RINGS : 1;
  for (int ring = RINGS; ring > RINGS - n_rings; ring--)
    known = farther_on_ring(s, site, (double)ring / RINGS, &last, known);
  return known;
}
