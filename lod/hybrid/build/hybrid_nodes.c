/* The hierarchy over the clusters, and ways to draw many of them as one. */
#include "lod/hybrid/build/hybrid_build.h"

#include "core/base/random.h"
#include "core/base/trigonometry.h"
#include "lod/clusters/cluster_sites.h"

/* The most surfels of a level, above which its node's children do as well. */
enum { MOST_SITES = 64 };

/* The first level's spacing, in radii of the node's point; and how much smaller are the surfels that one is made of. */
static const double first_spacing = 0.35, finer = 0.5;

/* The same of splats that stay, in sides of the square that one has. */
static const double first_of_kept = 0.75;

/* A cluster's surfel as a part of what one of a node's stands for. */
typedef struct surfel_piece {
  double at[3], normal[3], area;
  uint32_t site;
  const conic_surfel *surfel;
} surfel_piece;

/* What a thread keeps from node to node. */
typedef struct node_worker {
  conic_sampler *sampler;
  size_t n_pieces, room;
  surfel_piece *pieces;
  double error;         /* the greatest of the levels that the pieces are of */
  conic_seen_sums sums; /* how colours of these differ from the mesh's */
} node_worker;

typedef struct nodes_pass {
  conic_ways_job *job;
  node_worker *workers;
  conic_status *statuses;
} nodes_pass;

/* --- pieces --- */

static conic_status add_surfel_piece(const nodes_pass *pass, node_worker *w, const conic_surfel *surfel) {
  conic_status status =
      conic_memory_reserve(w->sampler->context, &w->pieces, w->n_pieces, w->n_pieces + 1, &w->room, sizeof *w->pieces);
  if (status != CONIC_OK)
    return status;
  surfel_piece *p = &w->pieces[w->n_pieces];
  double u[3], v[3], cutoff = (double)pass->job->options->cutoff;
  for (int axis = 0; axis < 3; axis++) {
    p->at[axis] = (double)surfel->position[axis];
    u[axis] = (double)surfel->tangent_u[axis];
    v[axis] = (double)surfel->tangent_v[axis];
  }
  conic_cross(u, v, p->normal);
  double length = conic_length(p->normal);
  for (int axis = 0; axis < 3; axis++)
    p->normal[axis] /= length;
  p->area = CONIC_PI * cutoff * cutoff * length;
  p->surfel = surfel;
  w->n_pieces += length > 0.0; /* axes of the least floats may have lost their right angle, and so all area */
  return CONIC_OK;
}

/* The coarsest surfels of a cluster that are small beside the spacing, or its finest. */
static const conic_surfels *fine_enough(const conic_cluster_ways *ways, double spacing) {
  int k = ways->n_surfels - 1;
  while (k > 0 && ways->surfels[k].reach > finer * spacing)
    k--;
  return &ways->surfels[k];
}

/* All of a node's clusters as surfels, shuffled; none where there is a cluster without. */
static conic_status gather_pieces(const nodes_pass *pass, node_worker *w, const conic_hybrid_node *node,
                                  double spacing) {
  conic_status status = CONIC_OK;
  w->n_pieces = 0;
  w->error = 0.0;
  w->sums = (conic_seen_sums){0.0, 0.0, 0.0};
  for (uint32_t i = node->begin; i < node->end; i++) {
    if (pass->job->ways[i].n_surfels == 0) {
      w->n_pieces = 0;
      return CONIC_OK;
    }
    const conic_surfels *surfels = fine_enough(&pass->job->ways[i], spacing);
    w->error = surfels->error > w->error ? surfels->error : w->error;
    conic_seen_sums_add(&w->sums, surfels->change, pass->job->ways[i].area);
    for (size_t k = 0; k < surfels->n && status == CONIC_OK; k++)
      status = add_surfel_piece(pass, w, &surfels->items[k]);
  }
  for (size_t i = w->n_pieces; i > 1 && status == CONIC_OK; i--) {
    size_t other = (size_t)(conic_random_bits(node->begin, i, node->end) % i);
    surfel_piece swapped = w->pieces[i - 1];
    w->pieces[i - 1] = w->pieces[other];
    w->pieces[other] = swapped;
  }
  return status;
}

/* --- sites --- */

static uint32_t nearest_alike(const conic_sampler *s, const surfel_piece *p, double most) {
  double least2 = most * most;
  uint32_t nearest = CONIC_NO_SITE;
  for (uint32_t i = 0; i < s->now.n_sites; i++) {
    const conic_site *site = &s->now.sites[i];
    double x = p->at[0] - site->at[0], y = p->at[1] - site->at[1], z = p->at[2] - site->at[2];
    double distance2 = (x * x + y * y) + z * z;
    if (distance2 < least2 && conic_dot(p->normal, site->facing) >= CONIC_SITES_ALIKE) {
      least2 = distance2;
      nearest = i;
    }
  }
  return nearest;
}

static conic_status add_site(conic_sampler *s, const surfel_piece *p, double spacing) {
  conic_site *site = conic_memory_add(s->context, &s->now.sites, &s->now.n_sites, &s->now.sites_room, sizeof *site);
  if (!site)
    return CONIC_ERROR_MEMORY;
  memcpy(site->at, p->at, sizeof site->at);
  memcpy(site->facing, p->normal, sizeof site->facing);
  site->face = p->surfel->face;
  site->spacing = spacing;
  conic_site_begin_contrast(site);
  return CONIC_OK;
}

/* Sites no nearer to each other than the spacing, but where they face apart. */
static conic_status choose_sites(node_worker *w, double spacing) {
  conic_status status = CONIC_OK;
  w->sampler->now.n_sites = 0;
  for (size_t i = 0; i < w->n_pieces && status == CONIC_OK && w->sampler->now.n_sites <= MOST_SITES; i++)
    if (nearest_alike(w->sampler, &w->pieces[i], spacing) == CONIC_NO_SITE)
      status = add_site(w->sampler, &w->pieces[i], spacing);
  return status;
}

static void add_to_site(conic_site *site, const surfel_piece *p) {
  const double color[3] = {(double)p->surfel->color[0], (double)p->surfel->color[1], (double)p->surfel->color[2]};
  for (int k = 0; k < 3; k++) {
    site->normal[k] += p->area * p->normal[k];
    site->color[k] += p->area * color[k];
  }
  conic_site_note_color(site, color);
  conic_site_end_contrast(site);
  site->area += p->area;
}

/* A surfel reaches a tenth past what it stands for, and an octagon in its outline not so far within. */
static const double octagon[8][2] = {{1.0, 0.0},  {0.70711, 0.70711},   {0.0, 1.0},  {-0.70711, 0.70711},
                                     {-1.0, 0.0}, {-0.70711, -0.70711}, {0.0, -1.0}, {0.70711, -0.70711}};

static conic_status note_piece(conic_sampler *s, const surfel_piece *p) {
  conic_status status = CONIC_OK;
  for (int k = 0; k < 8 && status == CONIC_OK; k++) {
    double at[3];
    for (int axis = 0; axis < 3; axis++)
      at[axis] = p->at[axis] + s->job->cutoff * (octagon[k][0] * (double)p->surfel->tangent_u[axis] +
                                                 octagon[k][1] * (double)p->surfel->tangent_v[axis]);
    status = conic_cluster_note_support(s, p->site, at, p->surfel->face, p->normal);
  }
  return status;
}

static conic_status shape_sites(node_worker *w) {
  conic_sampler *s = w->sampler;
  conic_status status = CONIC_OK;
  s->n_supports = s->n_sorted = 0;
  for (size_t i = 0; i < w->n_pieces; i++) {
    w->pieces[i].site = nearest_alike(s, &w->pieces[i], HUGE_VAL);
    add_to_site(&s->now.sites[w->pieces[i].site], &w->pieces[i]);
  }
  conic_cluster_settle_planes(s);
  for (size_t i = 0; i < w->n_pieces && status == CONIC_OK; i++)
    status = note_piece(s, &w->pieces[i]);
  return status == CONIC_OK ? conic_cluster_shape_supported(s) : status;
}

/* What the pieces are off, and the site is off from them; or its ellipse from the mesh, if that is more. Where it is
 * more than `known`; else `known`. */
static double error_of_level(const node_worker *w, const conic_site *site, double known) {
  double error = w->error + site->least_error;
  return conic_site_off_mesh(w->sampler, site, error > known ? error : known);
}

/* What the pieces' own colours are off, and those that stand for them from these. */
static conic_seen_change with_pieces(const node_worker *w, conic_seen_change change) {
  conic_seen_change pieces = conic_seen_sums_change(&w->sums, (conic_seen_change){0.0, 0.0});
  return (conic_seen_change){change.steps + pieces.steps, change.smear + pieces.smear};
}

static conic_status emit(node_worker *w, const conic_site *site, conic_surfels *surfels) {
  conic_status status = conic_surfels_reserve(w->sampler->context, surfels);
  if (status != CONIC_OK)
    return status;
  conic_surfel *surfel = &surfels->items[surfels->n];
  if (!conic_ellipse_axes(&site->ellipse, site->u, site->v, w->sampler->job->cutoff, surfel->tangent_u,
                          surfel->tangent_v))
    return CONIC_OK;
  for (int k = 0; k < 3; k++) {
    surfel->position[k] = (float)site->at[k];
    surfel->color[k] = (float)(site->color[k] / site->area);
  }
  surfel->face = site->face;
  surfels->n++;
  surfels->reach = site->ellipse.reach > surfels->reach ? site->ellipse.reach : surfels->reach;
  surfels->error = error_of_level(w, site, surfels->error);

  return CONIC_OK;
}

static conic_status make_level(const nodes_pass *pass, node_worker *w, double spacing, conic_surfels *surfels) {
  const conic_ways_job *job = pass->job;
  const conic_sampling_job sampling = {.mesh = job->mesh,
                                       .tree = &job->tree,
                                       .spacing = spacing,
                                       .tolerance = HUGE_VAL, /* errors are found below */
                                       .is_off_mesh = 1,
                                       .cutoff = (double)job->options->cutoff};
  w->sampler->job = &sampling;
  conic_status status = choose_sites(w, spacing);
  if (status == CONIC_OK && w->sampler->now.n_sites <= MOST_SITES) {
    status = shape_sites(w);
    for (size_t i = 0; i < w->sampler->now.n_sites && status == CONIC_OK; i++)
      status = emit(w, &w->sampler->now.sites[i], surfels);
    if (status == CONIC_OK)
      surfels->change = with_pieces(w, conic_sites_change(w->sampler, (conic_seen_change){0.0, 0.0}));
  }
  w->sampler->job = NULL;
  return status;
}

/* --- nodes --- */

static size_t count_coarsest(const conic_ways_job *job, const conic_hybrid_node *node) {
  size_t n = 0;
  for (uint32_t i = node->begin; i < node->end; i++)
    n += job->ways[i].n_surfels ? job->ways[i].surfels[job->ways[i].n_surfels - 1].n : 0;
  return n;
}

/* Each level has a fourth less than the one before, the first than the clusters by themselves. */
static conic_status find_levels(const nodes_pass *pass, node_worker *w, const conic_hybrid_node *node, double spacing,
                                int n_most, conic_surfels *levels, int *n_levels) {
  size_t n_last = count_coarsest(pass->job, node);
  conic_status status = CONIC_OK;
  for (int k = *n_levels; k < n_most && status == CONIC_OK && n_last > 1; k++, spacing *= 2.0) {
    conic_surfels *surfels = &levels[*n_levels];
    surfels->error = *n_levels ? surfels[-1].error : 0.0;
    status = gather_pieces(pass, w, node, spacing);
    if (status == CONIC_OK && w->n_pieces > 0)
      status = make_level(pass, w, spacing, surfels);
    if (surfels->n > 0 && 4 * surfels->n <= 3 * n_last) {
      n_last = surfels->n;
      ++*n_levels;
    } else
      conic_surfels_release(pass->job->context, surfels);
  }
  return status;
}

/* Coarser levels of splats that stay, as a node's are made, from twice the mean distance on. */
static conic_status find_kept_levels(nodes_pass *pass, node_worker *w, uint32_t cluster) {
  conic_cluster_ways *ways = &pass->job->ways[cluster];
  const conic_hybrid_node alone = {.begin = cluster, .end = cluster + 1};
  double spacing = first_of_kept * sqrt(ways->area / (double)ways->surfels[0].n);
  int first = ways->n_surfels;
  conic_status status =
      find_levels(pass, w, &alone, spacing, CONIC_MOST_SURFEL_LEVELS, ways->surfels, &ways->n_surfels);
  for (int k = first; k < ways->n_surfels && ways->surfels[0].are_dots; k++) {
    conic_surfels *surfels = &ways->surfels[k];
    surfels->are_dots = 1;
    surfels->error += surfels->reach; /* a dot is as wide as it is long, whoever looks */
    surfels->error = surfels->error > surfels[-1].error ? surfels->error : surfels[-1].error;
    surfels->reach *= 2.0;
  }
  return status;
}

/* A disc as large as the sphere hides all that is in it. None of that is farther from the disc than the centre is; nor
 * is a place of the disc farther from the mesh than the centre, and a radius more. */
static conic_status find_point(const nodes_pass *pass, node_worker *w, size_t i) {
  const conic_clustered_mesh *mesh = pass->job->mesh;
  conic_hybrid_node *node = &pass->job->nodes[i];
  double center[3], farthest2 = 0.0, color[3] = {0.0, 0.0, 0.0}, area = 0.0;
  conic_status status = gather_pieces(pass, w, node, HUGE_VAL);
  if (status != CONIC_OK || w->n_pieces == 0)
    return status;
  for (int axis = 0; axis < 3; axis++)
    center[axis] = (double)node->bound.center[axis];
  for (size_t k = mesh->starts[node->begin]; k < mesh->starts[node->end]; k++)
    for (int corner = 0; corner < 3; corner++) {
      double at[3];
      conic_mesh_corner(&mesh->mesh, mesh->faces[k], corner, at);
      for (int axis = 0; axis < 3; axis++)
        at[axis] -= center[axis];
      double distance2 = conic_dot(at, at);
      farthest2 = distance2 > farthest2 ? distance2 : farthest2;
    }
  conic_site all = {.ellipse = {.reach = 0.0}};
  conic_site_begin_contrast(&all);
  for (size_t k = 0; k < w->n_pieces; k++) {
    double own[3];
    area += w->pieces[k].area;
    for (int channel = 0; channel < 3; channel++) {
      own[channel] = (double)w->pieces[k].surfel->color[channel];
      color[channel] += w->pieces[k].area * own[channel];
    }
    conic_site_note_color(&all, own);
  }
  conic_site_end_contrast(&all);
  double radius = sqrt(farthest2) * (1.0 + 1e-6);
  all.ellipse.reach = radius;
  conic_seen_change change = with_pieces(w, conic_site_change(&all));
  node->point.radius = (float)radius;
  node->point.change = conic_seen_float(change.steps);
  node->point.smear = conic_seen_float(change.smear);
  node->point.error = (float)((radius + conic_face_tree_farther(&pass->job->tree, center, 0.0)) * (1.0 + 1e-6));
  for (int channel = 0; channel < 3; channel++)
    node->point.color[channel] = (float)(color[channel] / area);
  return CONIC_OK;
}

static conic_status do_node(nodes_pass *pass, size_t i, node_worker *w) {
  conic_node_ways *ways = &pass->job->node_ways[i];
  const conic_hybrid_node *node = &pass->job->nodes[i];
  conic_status status = find_point(pass, w, i);
  return status == CONIC_OK ? find_levels(pass, w, node, first_spacing * (double)node->point.radius,
                                          CONIC_MOST_NODE_LEVELS, ways->surfels, &ways->n_surfels)
                            : status;
}

static void node_task(void *data, size_t i_task, int i_thread) {
  nodes_pass *pass = data;
  node_worker *w = &pass->workers[i_thread];
  conic_status *status = &pass->statuses[i_thread];
  if (*status == CONIC_OK && !w->sampler)
    *status = conic_sampler_create(pass->job->context, &w->sampler);
  if (*status != CONIC_OK)
    return;
  if (pass->job->node_ways)
    *status = do_node(pass, i_task, w);
  else if (conic_cluster_is_kept(pass->job->mesh, (uint32_t)i_task))
    *status = find_kept_levels(pass, w, (uint32_t)i_task);
}

/* Nodes; or, before there are any, clusters. */
static conic_status run_pass(nodes_pass *pass, int n_threads) {
  const conic_ways_job *job = pass->job;
  size_t n = job->node_ways ? job->n_nodes : job->mesh->clusters->n_clusters;
  conic_status status = conic_parallel_told(job->context, "join", 0.0, 1.0, n, node_task, pass);
  for (int i = 0; i < n_threads; i++)
    status = pass->statuses[i] != CONIC_OK ? pass->statuses[i] : status;
  return status;
}

static conic_status find_ways(conic_ways_job *job) {
  int n_threads = conic_context_threads(job->context);
  nodes_pass pass = {.job = job,
                     .workers = conic_memory_allocate_zeroed(job->context, (size_t)n_threads, sizeof *pass.workers),
                     .statuses = conic_memory_allocate_zeroed(job->context, (size_t)n_threads, sizeof *pass.statuses)};
  conic_status status = pass.workers && pass.statuses ? run_pass(&pass, n_threads) : CONIC_ERROR_MEMORY;
  for (int i = 0; pass.workers && i < n_threads; i++) {
    conic_memory_release(job->context, pass.workers[i].pieces);
    conic_sampler_destroy(pass.workers[i].sampler);
  }
  conic_memory_release_these(job->context, pass.workers, pass.statuses);
  return status;
}

/* How far each cluster's surfels may stand out of its sphere. */
static float reach_of_surfels(const conic_cluster_ways *ways) {
  float longest = 0.0f;
  for (int k = 0; k < ways->n_surfels; k++) {
    float reach = (float)(ways->surfels[k].reach * (1.0 + 1e-6));
    longest = reach > longest ? reach : longest;
  }
  return longest;
}

conic_status conic_find_nodes(conic_ways_job *job) {
  size_t n = job->n_clusters;
  job->n_nodes = conic_hybrid_count_nodes(n);
  job->nodes = conic_memory_allocate(job->context, job->n_nodes, sizeof *job->nodes);
  conic_hybrid_bound *bounds = conic_memory_allocate(job->context, n, sizeof *bounds);
  float *reach = conic_memory_allocate(job->context, n, sizeof *reach);
  int is_leveled = !job->options->has_single_levels && job->options->sampling == CONIC_SAMPLING_BLUE;
  conic_status status = job->nodes && bounds && reach ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK && is_leveled && job->mesh->kept)
    status = find_ways(job);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    bounds[i] = job->ways[i].bound;
    reach[i] = reach_of_surfels(&job->ways[i]);
  }
  if (status == CONIC_OK)
    conic_hybrid_fill_nodes(bounds, reach, n, job->nodes);
  if (status == CONIC_OK && is_leveled) {
    job->node_ways = conic_memory_allocate_zeroed(job->context, job->n_nodes, sizeof *job->node_ways);
    status = job->node_ways ? find_ways(job) : CONIC_ERROR_MEMORY;
  }
  conic_memory_release_these(job->context, reach, bounds);
  return status;
}

void conic_nodes_release(conic_ways_job *job) {
  for (size_t i = 0; job->node_ways && i < job->n_nodes; i++)
    for (int k = 0; k < job->node_ways[i].n_surfels; k++)
      conic_surfels_release(job->context, &job->node_ways[i].surfels[k]);
  conic_cluster_levels_release(job->context, &job->whole);
  conic_memory_release_these(job->context, job->node_ways, job->nodes);
  job->node_ways = NULL;
  job->nodes = NULL;
}
