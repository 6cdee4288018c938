/* From sites to surfels: a plane, an ellipse and a colour for what each of them stands for. */
#include "lod/patch_sample.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "lod/patch_sites.h"

/* How far an ellipse reaches beyond what it must cover, and how long it may be. */
static const double cover = 1.1;
static const double least_ratio = 0.2;
/* The least cosine between a surfel and a face for which it is widened; a steeper face counts as if it had this. */
static const double steep = 0.5;

conic_status conic_sampler_create(conic_context *context, conic_sampler **sampler) {
  *sampler = conic_memory_allocate_zeroed(context, 1, sizeof **sampler);
  if (!*sampler)
    return CONIC_ERROR_MEMORY;
  (*sampler)->context = context;
  return CONIC_OK;
}

void conic_sampler_destroy(conic_sampler *sampler) {
  if (!sampler)
    return;
  conic_memory_release(sampler->context, sampler->lattices);
  conic_memory_release(sampler->context, sampler->facing);
  conic_memory_release(sampler->context, sampler->owner);
  conic_memory_release(sampler->context, sampler->candidates);
  conic_memory_release(sampler->context, sampler->seeds);
  conic_memory_release(sampler->context, sampler->sites);
  conic_memory_release(sampler->context, sampler->table);
  conic_memory_release(sampler->context, sampler->supports);
  conic_memory_release(sampler->context, sampler);
}

conic_status conic_surfels_reserve(conic_context *context, conic_surfels *surfels) {
  if (surfels->n < surfels->room)
    return CONIC_OK;
  size_t larger = surfels->n + surfels->n / 2 + 64;
  void *items = surfels->items;
  conic_status status = conic_memory_grow(context, &items, surfels->n, larger, sizeof *surfels->items);
  surfels->items = items;
  if (status == CONIC_OK)
    surfels->room = larger;
  return status;
}

void conic_surfels_release(conic_context *context, conic_surfels *surfels) {
  conic_memory_release(context, surfels->items);
  memset(surfels, 0, sizeof *surfels);
}

/* --- the small triangles of the lattices --- */

typedef struct small_triangle {
  const conic_lattice *lattice;
  const double *facing;
  double at[3][3], bary[3][3];
  uint32_t owners[3];
} small_triangle;

/* The corners of the small triangles at (i, j): the one that points as the face does, and the one between. */
static const int corner_steps[2][3][2] = {{{0, 0}, {1, 0}, {0, 1}}, {{1, 0}, {1, 1}, {0, 1}}};

typedef conic_status small_task(conic_sampler *s, const small_triangle *t);

static conic_status do_small_triangles(conic_sampler *s, small_task *task) {
  conic_status status = CONIC_OK;
  for (size_t k = 0; k < s->n_lattices; k++) {
    const conic_lattice *l = &s->lattices[k];
    for (int i = 0; i < l->sides; i++)
      for (int j = 0; j < l->sides - i; j++)
        for (int between = 0; between < (i + j < l->sides - 1 ? 2 : 1) && status == CONIC_OK; between++) {
          small_triangle t = {.lattice = l, .facing = s->facing[k]};
          for (int corner = 0; corner < 3; corner++) {
            const int *step = corner_steps[between][corner];
            conic_lattice_bary(l, i + step[0], j + step[1], t.bary[corner]);
            conic_patch_place(s->job->mesh, l->face, t.bary[corner], t.at[corner]);
            t.owners[corner] = s->owner[conic_lattice_place(l, i + step[0], j + step[1])];
          }
          status = task(s, &t);
        }
  }
  return status;
}

/* --- planes and colours --- */

static conic_status add_to_sums(conic_sampler *s, const small_triangle *t) {
  double sides[2][3], cross[3];
  for (int axis = 0; axis < 3; axis++) {
    sides[0][axis] = t->at[1][axis] - t->at[0][axis];
    sides[1][axis] = t->at[2][axis] - t->at[0][axis];
  }
  conic_cross(sides[0], sides[1], cross);
  double share = sqrt(conic_dot(cross, cross)) / 6.0;
  for (int corner = 0; corner < 3; corner++) {
    conic_site *site = &s->sites[t->owners[corner]];
    double normal[3], color[3];
    conic_patch_normal(s->job->mesh, t->lattice->face, t->bary[corner], t->facing, normal);
    conic_patch_color(s->job->mesh, t->lattice->face, t->bary[corner], color);
    for (int axis = 0; axis < 3; axis++) {
      site->normal[axis] += share * normal[axis];
      site->color[axis] += share * color[axis];
    }
    site->area += share;
  }
  return CONIC_OK;
}

/* Where what a site stands for has no direction in the mean, its own face says. */
static void settle_planes(conic_sampler *s) {
  for (size_t i = 0; i < s->n_sites; i++) {
    conic_site *site = &s->sites[i];
    double length = sqrt(conic_dot(site->normal, site->normal));
    for (int axis = 0; axis < 3; axis++)
      site->normal[axis] = length > 0.0 ? site->normal[axis] / length : site->facing[axis];
    if (!(conic_dot(site->normal, site->normal) > 0.0))
      site->normal[2] = 1.0;
    conic_tangent_basis(site->normal, site->u, site->v);
  }
}

/* --- ellipses --- */

static void note_reach(conic_site *site, const double at[2]) {
  for (int k = 0; k < 2; k++) {
    site->low[k] = at[k] < site->low[k] ? at[k] : site->low[k];
    site->high[k] = at[k] > site->high[k] ? at[k] : site->high[k];
  }
}

/* How far the outline is from the mesh, where that is more than `known`. */
static double stray_of(const conic_sampler *s, const conic_site *site, double known) {
  const conic_ellipse *e = &site->ellipse;
  for (int k = 0; k < 4; k++) { /* the ends of both axes */
    double length = (k & 1 ? -e->reach : e->reach) * (k & 2 ? e->ratio : 1.0), at[3];
    double x = length * (k & 2 ? -e->major[1] : e->major[0]), y = length * (k & 2 ? e->major[0] : e->major[1]);
    for (int axis = 0; axis < 3; axis++)
      at[axis] = site->at[axis] + x * site->u[axis] + y * site->v[axis];
    known = conic_face_tree_farther(s->job->tree, at, known);
  }
  return known;
}

/* Notes where a point of a face comes to lie in the plane of a site: along the face's normal, so that what is seen
 * straight on the face is covered. */
static conic_status note_support(conic_sampler *s, uint32_t i_site, const double at[3], const double facing[3]) {
  conic_site *site = &s->sites[i_site];
  void *supports = s->supports;
  conic_status status =
      conic_sampler_grow(s, &supports, s->n_supports, s->n_supports + 1, &s->supports_room, sizeof *s->supports);
  s->supports = supports;
  if (status != CONIC_OK)
    return status;
  const double d[3] = {at[0] - site->at[0], at[1] - site->at[1], at[2] - site->at[2]};
  double cosine = conic_dot(facing, site->normal), above = conic_dot(d, site->normal);
  double way = above / (cosine > steep ? cosine : steep);
  conic_support *support = &s->supports[s->n_supports++];
  support->site = i_site;
  support->at[0] = conic_dot(d, site->u) - way * conic_dot(facing, site->u);
  support->at[1] = conic_dot(d, site->v) - way * conic_dot(facing, site->v);
  note_reach(site, support->at);
  site->height = fabs(way) > site->height ? fabs(way) : site->height;
  return CONIC_OK;
}

/* Each corner's owner covers the part of the triangle that is nearest to that corner: up to the middles of the sides,
 * and the triangle's own middle, where those belong to others. */
static conic_status cover_small_triangle(conic_sampler *s, const small_triangle *t) {
  double middle[3], half[3];
  conic_status status = CONIC_OK;
  int is_one = t->owners[0] == t->owners[1] && t->owners[1] == t->owners[2];
  for (int axis = 0; axis < 3; axis++)
    middle[axis] = (t->at[0][axis] + t->at[1][axis] + t->at[2][axis]) / 3.0;
  for (int corner = 0; corner < 3 && status == CONIC_OK; corner++) {
    status = note_support(s, t->owners[corner], t->at[corner], t->facing);
    for (int k = 1; k < 3 && status == CONIC_OK; k++) {
      int other = (corner + k) % 3;
      for (int axis = 0; axis < 3; axis++)
        half[axis] = 0.5 * (t->at[corner][axis] + t->at[other][axis]);
      if (t->owners[other] != t->owners[corner])
        status = note_support(s, t->owners[corner], half, t->facing);
    }
    if (status == CONIC_OK && !is_one)
      status = note_support(s, t->owners[corner], middle, t->facing);
  }
  return status;
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

/* Moves a surfel within its plane to the middle of what it stands for: at the border of a patch that lies to one side.
 */
static void settle_center(conic_site *site) {
  for (int k = 0; k < 2; k++)
    site->middle[k] = 0.5 * (site->low[k] + site->high[k]);
  for (int axis = 0; axis < 3; axis++)
    site->at[axis] += site->middle[0] * site->u[axis] + site->middle[1] * site->v[axis];
}

static void shape_ellipses(conic_sampler *s) {
  for (size_t i = 0; i < s->n_sites; i++)
    settle_center(&s->sites[i]);
  for (size_t k = 0; k < s->n_supports; k++) {
    conic_site *site = &s->sites[s->supports[k].site];
    s->supports[k].at[0] -= site->middle[0];
    s->supports[k].at[1] -= site->middle[1];
    conic_ellipse_add(site->covariance, s->supports[k].at[0], s->supports[k].at[1]);
  }
  for (size_t i = 0; i < s->n_sites; i++)
    s->sites[i].ellipse = conic_ellipse_shape(s->sites[i].covariance, least_ratio);
  for (size_t k = 0; k < s->n_supports; k++)
    conic_ellipse_cover(&s->sites[s->supports[k].site].ellipse, s->supports[k].at[0], s->supports[k].at[1]);
  for (size_t i = 0; i < s->n_sites; i++)
    widen(&s->sites[i]);
}

static conic_status emit(conic_sampler *s, const conic_site *site, conic_surfels *surfels) {
  conic_status status = conic_surfels_reserve(s->context, surfels);
  if (status != CONIC_OK)
    return status;
  conic_surfel *surfel = &surfels->items[surfels->n];
  double texel[3];
  if (!conic_ellipse_axes(&site->ellipse, site->u, site->v, s->job->cutoff, surfel->tangent_u, surfel->tangent_v))
    return CONIC_OK; /* it stands for nothing that has an area */
  conic_patch_texel(s->job->mesh, site->face, site->bary, s->job->spacing, texel);
  for (int axis = 0; axis < 3; axis++) {
    double own = site->area > 0.0 ? site->color[axis] / site->area : 1.0;
    surfel->position[axis] = (float)site->at[axis];
    surfel->color[axis] = (float)(own * texel[axis]);
  }
  surfels->n++;
  surfels->error = site->height > surfels->error ? site->height : surfels->error;
  surfels->error = stray_of(s, site, surfels->error);
  surfels->reach = site->ellipse.reach > surfels->reach ? site->ellipse.reach : surfels->reach;
  return CONIC_OK;
}

conic_status conic_patch_sample(conic_sampler *s, const conic_sampling_job *job, conic_surfels *surfels) {
  s->job = job;
  s->n_supports = 0;
  conic_status status = conic_patch_find_sites(s);
  if (status == CONIC_OK)
    status = do_small_triangles(s, add_to_sums);
  if (status != CONIC_OK)
    return status;
  settle_planes(s);
  status = do_small_triangles(s, cover_small_triangle);
  if (status != CONIC_OK)
    return status;
  shape_ellipses(s);
  for (size_t i = 0; i < s->n_sites && status == CONIC_OK; i++)
    status = emit(s, &s->sites[i], surfels);
  return status;
}
