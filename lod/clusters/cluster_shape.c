/* A plane for what each site stands for, and an ellipse that covers it. */

#include "core/base/vectors.h"
#include "lod/clusters/cluster_sites.h"

/* --- the smallest ellipse --- */

/* Each round a point's weight is multiplied by what it wants of the ellipse (Titterington 1978): those on its border
 * come to hold all weight, the points within lose theirs. So many rounds leave a few per cent of the area to win. */
enum { ROUNDS = 8 };

/* For points in a line, the covariance says no more than that. */
static const double flattest = 1e-9;

static void find_moments(const double *weights, const double (*points)[2], int n_points, double center[2],
                         double covariance[3]) {
  center[0] = center[1] = covariance[0] = covariance[1] = covariance[2] = 0.0;
  for (int i = 0; i < n_points; i++) {
    center[0] += weights[i] * points[i][0];
    center[1] += weights[i] * points[i][1];
  }
  for (int i = 0; i < n_points; i++) {
    double x = points[i][0] - center[0], y = points[i][1] - center[1];
    covariance[0] += weights[i] * x * x;
    covariance[1] += weights[i] * x * y;
    covariance[2] += weights[i] * y * y;
  }
}

void conic_least_ellipse(const double (*points)[2], int n_points, double center[2], double covariance[3]) {
  double weights[CONIC_LEAST_ELLIPSE_POINTS];
  for (int i = 0; i < n_points; i++)
    weights[i] = 1.0 / (double)n_points;
  for (int round = 0; round < ROUNDS; round++) {
    find_moments(weights, points, n_points, center, covariance);
    double trace = covariance[0] + covariance[2];
    double determinant = covariance[0] * covariance[2] - covariance[1] * covariance[1];
    if (!(determinant > flattest * trace * trace))
      return;
    for (int i = 0; i < n_points; i++) {
      double x = points[i][0] - center[0], y = points[i][1] - center[1];
      double square = (covariance[2] * x * x - 2.0 * covariance[1] * x * y + covariance[0] * y * y) / determinant;
      weights[i] *= (1.0 + square) / 3.0; /* their sum stays 1 */
    }
  }
  find_moments(weights, points, n_points, center, covariance);
}

/* How far an ellipse reaches beyond what it must cover, and how long it may be. */
static const double cover = 1.1;
static const double least_ratio = 0.2;
/* The least cosine between a surfel and a face for which it is widened; a steeper face counts as if it had this. */
static const double steep = 0.5;

/* --- the small triangles of the lattices --- */

typedef struct small_triangle {
  const conic_face_lattice *lattice;
  const double *facing;
  const double *at[3];
  int steps[3][2];
  uint32_t owners[3];
  int is_between; /* two that point as the face does */
} small_triangle;

/* The corners of the small triangles at (i, j): the one that points as the face does, and the one between. */
static const int corner_steps[2][3][2] = {{{0, 0}, {1, 0}, {0, 1}}, {{1, 0}, {1, 1}, {0, 1}}};

typedef conic_status small_task(conic_sampler *s, const small_triangle *t);

/* Whether something of a face's belongs to a site that is not settled. */
static int has_work(const conic_sampler *s, const conic_face_lattice *l) {
  uint32_t n = conic_face_lattice_places(l->sides), i = 0;
  while (i < n && s->now.sites[s->now.owner[l->first + i]].is_settled)
    i++;
  return i < n;
}

static conic_status do_small_triangles(conic_sampler *s, small_task *task) {
  conic_status status = CONIC_OK;
  for (size_t k = 0; k < s->n_lattices; k++) {
    const conic_face_lattice *l = &s->now.lattices[k];
    if (!has_work(s, l))
      continue;
    for (int i = 0; i < l->sides; i++)
      for (int j = 0; j < l->sides - i; j++)
        for (int between = 0; between < (i + j < l->sides - 1 ? 2 : 1) && status == CONIC_OK; between++) {
          small_triangle t;
          t.lattice = l;
          t.facing = s->facing[k];
          t.is_between = between;
          for (int corner = 0; corner < 3; corner++) {
            t.steps[corner][0] = i + corner_steps[between][corner][0];
            t.steps[corner][1] = j + corner_steps[between][corner][1];
            uint32_t place = conic_face_lattice_place(l, t.steps[corner][0], t.steps[corner][1]);
            t.at[corner] = s->places[place];
            t.owners[corner] = s->now.owner[place];
          }
          status = task(s, &t);
        }
  }
  return status;
}

/* --- planes and colours --- */

/* The normal and the colour at a corner. */
static void look_at_corner(const conic_sampler *s, const small_triangle *t, int corner, double normal[3],
                           double color[3]) {
  double bary[3];
  conic_face_lattice_bary(t->lattice, t->steps[corner][0], t->steps[corner][1], bary);
  conic_cluster_normal(s->job->mesh, t->lattice->face, bary, t->facing, normal);
  conic_cluster_color(s->job->mesh, t->lattice->face, bary, color);
}

static conic_status add_to_sums(conic_sampler *s, const small_triangle *t) {
  const conic_triangles *triangles = s->job->mesh->triangles;
  int varies = triangles->normal[0] || triangles->color[0], is_known = 0; /* over a face */
  double sides[2][3], cross[3], normal[3], color[3];
  for (int axis = 0; axis < 3; axis++) {
    sides[0][axis] = t->at[1][axis] - t->at[0][axis];
    sides[1][axis] = t->at[2][axis] - t->at[0][axis];
  }
  conic_cross(sides[0], sides[1], cross);
  double share = conic_length(cross) / 6.0;
  for (int corner = 0; corner < 3; corner++) {
    conic_site *site = &s->now.sites[t->owners[corner]];
    if (site->is_settled)
      continue;
    if (varies || !is_known)
      look_at_corner(s, t, corner, normal, color);
    is_known = 1;
    for (int axis = 0; axis < 3; axis++) {
      site->normal[axis] += share * normal[axis];
      site->color[axis] += share * color[axis];
    }
    site->area += share;
  }
  return CONIC_OK;
}

/* Where what a site stands for has no direction in the mean, its own face says. */
void conic_cluster_settle_planes(conic_sampler *s) {
  for (size_t i = 0; i < s->now.n_sites; i++) {
    conic_site *site = &s->now.sites[i];
    if (site->is_settled)
      continue;
    double length = conic_length(site->normal);
    for (int axis = 0; axis < 3; axis++)
      site->normal[axis] = length > 0.0 ? site->normal[axis] / length : site->facing[axis];
    if (!(conic_dot(site->normal, site->normal) > 0.0))
      site->normal[2] = 1.0;
    conic_tangent_basis(site->normal, site->u, site->v);
  }
}

/* --- what must be covered --- */

static conic_status grow_supports(conic_sampler *s) {
  return conic_memory_reserve(s->context, &s->supports, s->n_supports, s->n_supports + 1, &s->supports_room,
                              sizeof *s->supports);
}

conic_status conic_cluster_note_support(conic_sampler *s, uint32_t i_site, const double at[3], uint32_t face,
                                        const double facing[3]) {
  conic_site *site = &s->now.sites[i_site];
  if (site->is_settled)
    return CONIC_OK;
  conic_status status = s->n_supports < s->supports_room ? CONIC_OK : grow_supports(s);
  if (status != CONIC_OK)
    return status;
  const double d[3] = {at[0] - site->at[0], at[1] - site->at[1], at[2] - site->at[2]};
  double cosine = conic_dot(facing, site->normal);
  conic_support *support = &s->supports[s->n_supports++];
  site->n_supports++;
  support->site = i_site;
  support->face = face;
  support->cosine = cosine > steep ? cosine : steep;
  support->above = conic_dot(d, site->normal);
  support->at[0] = conic_dot(d, site->u);
  support->at[1] = conic_dot(d, site->v);
  support->slope[0] = conic_dot(facing, site->u) / support->cosine;
  support->slope[1] = conic_dot(facing, site->v) / support->cosine;
  CONIC_WIDEN(site->lowest, site->highest, support->above, support->above);
  return CONIC_OK;
}

/* Finds the point on the way from one place to another that is as near to the owner of the one as to the owner of the
 * other. */
static void find_border(const conic_sampler *s, const small_triangle *t, int from, int to, double at[3]) {
  const conic_site *a = &s->now.sites[t->owners[from]], *b = &s->now.sites[t->owners[to]];
  double more = 0.0, slope = 0.0, share;
  for (int axis = 0; axis < 3; axis++) {
    double to_a = a->foot[axis] - t->at[from][axis], to_b = b->foot[axis] - t->at[from][axis];
    more += 0.5 * (to_b * to_b - to_a * to_a);
    slope += (t->at[to][axis] - t->at[from][axis]) * (to_b - to_a);
  }
  share = !(slope > 0.0) ? 0.5 : more <= 0.0 ? 0.0 : more < slope ? more / slope : 1.0;
  for (int axis = 0; axis < 3; axis++)
    at[axis] = t->at[from][axis] + share * (t->at[to][axis] - t->at[from][axis]);
}

static conic_status cover_places(conic_sampler *s) {
  conic_status status = CONIC_OK;
  for (size_t k = 0; k < s->n_lattices; k++) {
    const conic_face_lattice *l = &s->now.lattices[k];
    size_t begin = l->first, end = begin + conic_face_lattice_places(l->sides);
    if (!has_work(s, l))
      continue;
    for (size_t i = begin; i < end && status == CONIC_OK; i++)
      status = conic_cluster_note_support(s, s->now.owner[i], s->places[i], l->face, s->facing[k]);
  }
  return status;
}

/* Each corner's owner covers its part of the triangle: from the corner, which is noted, up to the borders on the sides,
 * and to the middle between those where all three have others. Every side is one of a triangle that points as the face
 * does. */
static conic_status cover_small_triangle(conic_sampler *s, const small_triangle *t) {
  double border[3][3], middle[3]; /* border k: on the side that begins at corner k */
  int n_parted = 0;
  conic_status status = CONIC_OK;
  for (int k = 0; k < 3; k++) {
    uint32_t owners[2] = {t->owners[k], t->owners[(k + 1) % 3]};
    if (owners[0] == owners[1])
      continue;
    n_parted++;
    find_border(s, t, k, (k + 1) % 3, border[k]);
    for (int end = 0; end < 2 && status == CONIC_OK && !t->is_between; end++)
      status = conic_cluster_note_support(s, owners[end], border[k], t->lattice->face, t->facing);
  }
  if (n_parted < 3)
    return status;
  for (int axis = 0; axis < 3; axis++)
    middle[axis] = (border[0][axis] + border[1][axis] + border[2][axis]) / 3.0;
  for (int corner = 0; corner < 3 && status == CONIC_OK; corner++)
    status = conic_cluster_note_support(s, t->owners[corner], middle, t->lattice->face, t->facing);
  return status;
}

/* Lists the supports of this pass site by site, what was noted last first. */
static conic_status sort_supports(conic_sampler *s) {
  size_t begin = s->n_sorted, most = 0;
  for (size_t i = 0; i < s->now.n_sites; i++) {
    conic_site *site = &s->now.sites[i];
    if (site->is_settled)
      continue;
    most = site->n_supports > most ? site->n_supports : most;
    begin += site->n_supports;
    site->first_support = begin;
  }
  conic_status status = conic_memory_reserve(s->context, &s->of_sites, s->n_sorted, s->n_supports, &s->of_sites_room,
                                             sizeof *s->of_sites);
  size_t points_room = s->points_room;
  for (int i = 0; i < 2 && status == CONIC_OK; i++) {
    s->points_room = points_room;
    status = conic_memory_reserve(s->context, &s->points[i], 0, most, &s->points_room, sizeof *s->points[i]);
  }
  for (; s->n_sorted < s->n_supports && status == CONIC_OK; s->n_sorted++)
    s->of_sites[--s->now.sites[s->supports[s->n_sorted].site].first_support] = (uint32_t)s->n_sorted;
  return status;
}

/* --- ellipses --- */

/* Half of the directions, in turn about the plane, in which a site's farthest supports are looked for. */
enum { N_LOOKS = CONIC_LEAST_ELLIPSE_POINTS / 2 };
static const double looks[N_LOOKS][2] = {{1.0, 0.0}, {0.7071, 0.7071}, {0.0, 1.0}, {-0.7071, 0.7071}};

/* Lays the plane halfway between the lowest and the highest that it stands for, and finds where the supports come to
 * lie in it: along the face's normal, so that what is seen straight on the face is covered. */
static void settle_height(conic_sampler *s, conic_site *site) {
  double lift = 0.5 * (site->lowest + site->highest);
  for (int axis = 0; axis < 3; axis++)
    site->at[axis] += lift * site->normal[axis];
  for (size_t k = 0; k < site->n_supports; k++) {
    const conic_support *support = &s->supports[s->of_sites[site->first_support + k]];
    double above = support->above - lift, way = fabs(above / support->cosine);
    for (int i = 0; i < 2; i++)
      s->points[i][k] = support->at[i] - above * support->slope[i];
    site->height = way > site->height ? way : site->height;
  }
}

/* The farthest of a site's points along a direction and against it: of several as far the first. */
typedef struct extent {
  double most, least;
  size_t at_most, at_least;
} extent;

static const extent no_extent = {-HUGE_VAL, HUGE_VAL, 0, 0};

/* Chance decides whether it grows: without branches. */
static inline void extend(extent *e, double along, size_t i) {
  e->at_most = along > e->most ? i : e->at_most;
  e->most = along > e->most ? along : e->most;
  e->at_least = along < e->least ? i : e->at_least;
  e->least = along < e->least ? along : e->least;
}

/* The supports that lie farthest out, one in each of the directions. */
static int find_farthest(const conic_sampler *s, const conic_site *site,
                         double farthest[CONIC_LEAST_ELLIPSE_POINTS][2]) {
  extent extents[N_LOOKS] = {no_extent, no_extent, no_extent, no_extent};
  for (size_t k = 0; k < site->n_supports; k++)
    for (int i = 0; i < N_LOOKS; i++)
      extend(&extents[i], s->points[0][k] * looks[i][0] + s->points[1][k] * looks[i][1], k);
  if (!(extents[0].most > -HUGE_VAL))
    return 0;
  for (int i = 0; i < N_LOOKS; i++)
    for (int axis = 0; axis < 2; axis++) {
      farthest[i][axis] = s->points[axis][extents[i].at_most];
      farthest[N_LOOKS + i][axis] = s->points[axis][extents[i].at_least];
    }
  return 2 * N_LOOKS;
}

/* Makes the ellipse large enough for all supports. Notes for each of the four ends of its axes on which face the
 * support lies that is farthest that way. */
static void cover_supports(const conic_sampler *s, conic_site *site, const double center[2]) {
  extent major = no_extent, minor = no_extent;
  double reach2 = 0.0;
  const double *direction = site->ellipse.major, ratio = site->ellipse.ratio;
  for (size_t k = 0; k < site->n_supports; k++) {
    double x = s->points[0][k] - center[0], y = s->points[1][k] - center[1];
    double along = x * direction[0] + y * direction[1], across = y * direction[0] - x * direction[1];
    double wide = across / ratio, needed2 = along * along + wide * wide; /* as conic_ellipse_cover */
    reach2 = needed2 > reach2 ? needed2 : reach2;
    extend(&major, along, k);
    extend(&minor, across, k);
  }
  const size_t farthest[4] = {major.at_most, minor.at_most, major.at_least, minor.at_least};
  site->ellipse.reach = sqrt(reach2);
  for (int i = 0; i < 4; i++)
    site->end_faces[i] = s->supports[s->of_sites[site->first_support + farthest[i]]].face;
}

/* A plane that lies off what it stands for is seen beside it, and may leave a gap to its neighbours: the outline grows
 * by as much. */
static void widen(conic_site *site) {
  conic_ellipse *e = &site->ellipse;
  conic_ellipse_overlap(e, site->area, cover, 0.0, HUGE_VAL);
  double minor = e->ratio * e->reach + site->height;
  e->reach += site->height;
  e->ratio = e->reach > 0.0 ? minor / e->reach : 1.0;
}

static void shape_site(conic_sampler *s, conic_site *site) {
  double farthest[CONIC_LEAST_ELLIPSE_POINTS][2], center[2] = {0.0, 0.0}, covariance[3];
  memcpy(site->foot, site->at, sizeof site->foot);
  settle_height(s, site);
  int n = find_farthest(s, site, farthest);
  if (n == 0)
    return;
  conic_least_ellipse((const double(*)[2])farthest, n, center, covariance);
  site->ellipse = conic_ellipse_shape(covariance, least_ratio);
  cover_supports(s, site, center);
  for (int axis = 0; axis < 3; axis++)
    site->at[axis] += center[0] * site->u[axis] + center[1] * site->v[axis];
  widen(site);
  double smear = site->contrast * site->ellipse.reach;
  site->least_error = smear > site->height ? smear : site->height;
  site->error = conic_site_error(s, site, s->job->tolerance, &site->error_bound);
}

conic_status conic_cluster_shape_supported(conic_sampler *s) {
  conic_status status = sort_supports(s);
  for (size_t i = 0; i < s->now.n_sites && status == CONIC_OK; i++)
    if (!s->now.sites[i].is_settled)
      shape_site(s, &s->now.sites[i]);
  return status;
}

conic_status conic_cluster_shape_sites(conic_sampler *s) {
  conic_status status = do_small_triangles(s, add_to_sums);
  if (status != CONIC_OK)
    return status;
  conic_cluster_settle_planes(s);
  conic_cluster_find_contrasts(s);
  status = cover_places(s);
  if (status == CONIC_OK)
    status = do_small_triangles(s, cover_small_triangle);
  return status == CONIC_OK ? conic_cluster_shape_supported(s) : status;
}
