/* From a cluster to surfels: sites, closer ones where their ellipses stray from the surface, and colours. */
#include "lod/clusters/cluster_sample.h"

#include "core/base/vectors.h"
#include "lod/clusters/cluster_sites.h"

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
  conic_memory_release_these(sampler->context, sampler->last.lattices, sampler->last.owner, sampler->last.sites,
                             sampler->now.lattices, sampler->facing, sampler->depth, sampler->places,
                             sampler->lattice_of, sampler->now.owner, sampler->candidates, sampler->seeds,
                             sampler->now.sites);
  conic_place_table_release(sampler->context, &sampler->table);
  conic_memory_release_these(sampler->context, sampler->supports, sampler->of_sites);
  for (int i = 0; i < 2; i++)
    conic_memory_release(sampler->context, sampler->points[i]);
  conic_memory_release(sampler->context, sampler);
}

conic_status conic_surfels_reserve(conic_context *context, conic_surfels *surfels) {
  return conic_memory_reserve(context, &surfels->items, surfels->n, surfels->n + 1, &surfels->room,
                              sizeof *surfels->items);
}

void conic_surfels_release(conic_context *context, conic_surfels *surfels) {
  conic_memory_release(context, surfels->items);
  memset(surfels, 0, sizeof *surfels);
}

/* --- surfels --- */

static conic_status emit(conic_sampler *s, conic_site *site, conic_surfels *surfels) {
  conic_status status = conic_surfels_reserve(s->context, surfels);
  if (status != CONIC_OK)
    return status;
  conic_surfel *surfel = &surfels->items[surfels->n];
  double texel[3];
  if (!conic_ellipse_axes(&site->ellipse, site->u, site->v, s->job->cutoff, surfel->tangent_u, surfel->tangent_v))
    return CONIC_OK; /* it stands for nothing that has an area */
  conic_cluster_texel(s->job->mesh, site->face, site->bary, site->spacing, texel);
  for (int axis = 0; axis < 3; axis++) {
    double own = site->area > 0.0 ? site->color[axis] / site->area : 1.0;
    surfel->position[axis] = (float)site->at[axis];
    surfel->color[axis] = (float)(own * texel[axis]);
  }
  surfel->face = site->face;
  surfels->n++;
  site->is_drawn = 1;
  surfels->reach = site->ellipse.reach > surfels->reach ? site->ellipse.reach : surfels->reach;
  return CONIC_OK;
}

/* The sites that are drawn and may err by more than is known, the one that may by the most first: in the place of the
 * candidates, which have had their turn. */
static conic_status order_by_bound(conic_sampler *s, double known, size_t *n) {
  conic_status status =
      conic_memory_reserve(s->context, &s->candidates, 0, s->now.n_sites, &s->candidates_room, sizeof *s->candidates);
  *n = 0;
  for (uint32_t i = 0; i < s->now.n_sites && status == CONIC_OK; i++) {
    float bound = (float)s->now.sites[i].error_bound;
    uint32_t bits = conic_bits_of_float(bound); /* of positive numbers these are in the numbers' order */
    if (s->now.sites[i].is_drawn && s->now.sites[i].error_bound > known)
      s->candidates[(*n)++] = (conic_radix_item){UINT32_MAX - bits, i};
  }
  return status == CONIC_OK ? conic_radix_sort(s->context, s->candidates, *n, 32) : status;
}

/* Raises *known to the largest error of what is drawn. Most are known well enough from the sites' making; beginning
 * with the site that may have the largest, few are measured again. */
static conic_status find_largest_error(conic_sampler *s, double *known) {
  size_t n;
  for (size_t i = 0; i < s->now.n_sites; i++) {
    const conic_site *site = &s->now.sites[i];
    double least = site->error > s->job->tolerance ? site->error : site->least_error;
    *known = site->is_drawn && least > *known ? least : *known;
  }
  conic_status status = order_by_bound(s, *known, &n);
  for (size_t k = 0; k < n && status == CONIC_OK; k++) {
    const conic_site *site = &s->now.sites[s->candidates[k].value];
    double bound;
    if (site->error_bound > *known)
      *known = conic_site_error(s, site, *known, &bound);
  }
  return status;
}

static conic_status find_site_errors(conic_sampler *s, conic_surfels *surfels) {
  conic_status status = find_largest_error(s, &surfels->error);
  surfels->refined_error = surfels->error;
  for (size_t i = 0; i < s->now.n_sites && status == CONIC_OK; i++)
    if (s->now.sites[i].is_drawn)
      surfels->error = conic_site_off_mesh(s, &s->now.sites[i], surfels->error);
  return status;
}

/* Whether a surfel stands out from the mesh by more than is allowed; places count there, and colours do not. */
static int is_out(const conic_sampler *s) {
  double known = s->job->most_out;
  for (size_t i = 0; i < s->now.n_sites && known <= s->job->most_out; i++)
    if (s->now.sites[i].is_drawn)
      known = conic_site_off_mesh(s, &s->now.sites[i], known);
  return known > s->job->most_out;
}

/* --- closer where it must be --- */

/* How often sites are looked for anew, and by which factors the error grows above which they are parted. */
enum { MOST_PASSES = CONIC_MOST_DEPTH + 2, LIMITS = 12 };
static const double limit_step = 1.25;

/* The error above which sites are parted: that which is wanted, or the next above it by which no more come of it than
 * are allowed; infinite where none is to be parted. One that is parted becomes four, about. */
static double error_to_part(const conic_sampler *s) {
  double limit = s->job->tolerance;
  for (int k = 0; k < LIMITS; k++, limit *= limit_step) {
    size_t n_bad = 0;
    for (size_t i = 0; i < s->now.n_sites; i++)
      n_bad += s->now.sites[i].error > limit;
    if (n_bad == 0)
      break;
    if (s->now.n_sites + 3 * n_bad <= s->job->most)
      return limit;
  }
  return HUGE_VAL;
}

/* Halves the spacing on the faces for which a site with a larger error stands. Returns whether there are any. */
static int refine_faces(conic_sampler *s, double limit) {
  int is_any = 0;
  for (size_t k = 0; k < s->n_lattices; k++) {
    const conic_face_lattice *l = &s->now.lattices[k];
    int is_bad = 0;
    for (uint32_t i = 0; i < conic_face_lattice_places(l->sides) && !is_bad; i++)
      is_bad = s->now.sites[s->now.owner[l->first + i]].error > limit;
    if (is_bad && s->depth[k] < CONIC_MOST_DEPTH) {
      s->depth[k]++;
      is_any = 1;
    }
  }
  return is_any;
}

/* Where spacings begin: as wide as wanted; after a finer level of the same cluster a step wider than that needed. */
static conic_status begin_depths(conic_sampler *s) {
  size_t n = s->job->mesh->starts[s->job->cluster + 1] - s->job->mesh->starts[s->job->cluster];
  conic_status status = conic_memory_reserve(s->context, &s->depth, 0, n, &s->depth_room, sizeof *s->depth);
  if (status != CONIC_OK)
    return status;
  for (size_t i = 0; i < n; i++)
    s->depth[i] = s->job->is_coarser && s->depth[i] ? (uint8_t)(s->depth[i] - 1) : 0;
  return CONIC_OK;
}

static int has_texture(const conic_triangles *t) {
  int is_any = 0;
  for (size_t i = 0; i < t->n_materials; i++)
    is_any |= t->materials[i].texture != NULL;
  return is_any;
}

/* Whether a wider spacing would give the same sites. Then faces have no places but their corners, all of them near each
 * other, and nothing is to be split. (A wider spacing sees less of textures.) */
static int is_coarsest(const conic_sampler *s) {
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, square = 0.0;
  int is_plain = s->finest == 0 && !has_texture(s->job->mesh->triangles);
  for (size_t k = 0; k < s->n_lattices && is_plain; k++)
    is_plain = s->now.lattices[k].sides == 1;
  for (size_t i = 0; i < s->now.n_sites && is_plain; i++)
    is_plain = s->now.sites[i].error <= s->job->tolerance;
  for (size_t i = 0; i < s->n_places && is_plain; i++)
    conic_widen_box(low, high, s->places[i]);
  for (int axis = 0; axis < 3; axis++)
    square += (high[axis] - low[axis]) * (high[axis] - low[axis]);
  return is_plain && square < 0.999 * s->job->spacing * s->job->spacing;
}

conic_status conic_cluster_sample(conic_sampler *s, const conic_sampling_job *job, conic_surfels *surfels) {
  s->job = job;
  s->n_supports = s->n_sorted = 0;
  conic_status status = begin_depths(s);
  for (int pass = 1; status == CONIC_OK; pass++) {
    if (pass > 1)
      conic_cluster_end_pass(s);
    status = conic_cluster_find_sites(s);
    if (status == CONIC_OK && pass > 1)
      conic_cluster_settle_sites(s);
    if (status == CONIC_OK)
      status = conic_cluster_shape_sites(s);
    if (status != CONIC_OK || pass == MOST_PASSES || !refine_faces(s, error_to_part(s)))
      break;
  }
  for (size_t i = 0; i < s->now.n_sites && status == CONIC_OK; i++)
    status = emit(s, &s->now.sites[i], surfels);
  if (status == CONIC_OK)
    surfels->change = conic_sites_change(s, surfels->change);
  surfels->is_coarsest = status == CONIC_OK && is_coarsest(s);
  surfels->is_out = status == CONIC_OK && s->job->most_out < HUGE_VAL && is_out(s);
  if (status == CONIC_OK && surfels->n <= job->useful)
    status = find_site_errors(s, surfels);
  return status;
}
