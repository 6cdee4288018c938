/* Sampling a cluster in passes: what one keeps from the last is what it would have found, errors are the same however
 * much of them is known before, and where wider spacings are said to give the same they do. */
#include "core/base/memory.h"
#include "lod/clusters/cluster_sites.h"
#include "tests/support/hybrid_fixture.h"

/* A terrain that is one cluster. */
typedef struct one_cluster {
  conic_triangles triangles;
  conic_adjacency adjacency;
  conic_mesh_clusters clusters;
  conic_face_tree tree;
  conic_clustered_mesh mesh;
  uint32_t *faces;
  size_t starts[2];
} one_cluster;

static void make_cluster(conic_context *context, size_t side, one_cluster *p) {
  static uint32_t no_clusters[1 << 12];
  static uint8_t gathered = 1;
  memset(p, 0, sizeof *p);
  hybrid_terrain(context, side, &p->triangles);
  size_t n = p->triangles.count;
  p->faces = conic_memory_allocate(context, n, sizeof *p->faces);
  CHECK(n <= sizeof no_clusters / sizeof *no_clusters && p->faces);
  for (size_t i = 0; i < n; i++)
    p->faces[i] = (uint32_t)i;
  p->starts[1] = n;
  p->clusters.n_clusters = 1;
  p->clusters.of_face = no_clusters;
  p->clusters.is_gathered = &gathered;
  p->mesh = (conic_clustered_mesh){.triangles = &p->triangles,
                                   .adjacency = &p->adjacency,
                                   .clusters = &p->clusters,
                                   .faces = p->faces,
                                   .starts = p->starts};
  conic_mesh *mesh = &p->mesh.mesh;
  *mesh = (conic_mesh){
      .n_vertices = p->triangles.n_vertices, .n_faces = n, .faces = (const uint32_t(*)[3])p->triangles.corners};
  for (int axis = 0; axis < 3; axis++)
    mesh->position[axis] = p->triangles.position[axis];
  CHECK_OK(conic_adjacency_find(context, mesh, &p->adjacency));
  CHECK_OK(conic_face_tree_build(context, mesh, &p->adjacency, &p->tree));
}

static void release_cluster(conic_context *context, one_cluster *p) {
  conic_face_tree_release(context, &p->tree);
  conic_adjacency_release(context, &p->adjacency);
  conic_memory_release(context, p->faces);
  conic_triangles_release(context, &p->triangles);
}

static conic_sampling_job job_of(const one_cluster *p, double spacing, double tolerance) {
  return (conic_sampling_job){.mesh = &p->mesh,
                              .tree = &p->tree,
                              .spacing = spacing,
                              .tolerance = tolerance * spacing,
                              .most = 2 * p->triangles.count,
                              .useful = SIZE_MAX,
                              .cutoff = 1.5};
}

static int is_same(const conic_site *a, const conic_site *b) {
  return a->face == b->face && a->place == b->place && memcmp(a->at, b->at, sizeof a->at) == 0 &&
         memcmp(a->foot, b->foot, sizeof a->foot) == 0 && memcmp(a->bary, b->bary, sizeof a->bary) == 0 &&
         memcmp(a->normal, b->normal, sizeof a->normal) == 0 && memcmp(a->color, b->color, sizeof a->color) == 0 &&
         memcmp(a->u, b->u, sizeof a->u) == 0 && memcmp(&a->ellipse, &b->ellipse, sizeof a->ellipse) == 0 &&
         a->area == b->area && a->spacing == b->spacing && a->height == b->height && a->least_error == b->least_error &&
         a->error == b->error && a->n_supports == b->n_supports;
}

/* The sites of the last of several passes against those that are found for the same depths from nothing. */
static void check_settled(conic_context *context, conic_sampler *s, size_t *n_kept) {
  size_t n = s->now.n_sites, n_settled = 0;
  conic_site *sites = conic_memory_allocate(context, n, sizeof *sites);
  CHECK(sites && s->finest > 0);
  memcpy(sites, s->now.sites, n * sizeof *sites);
  s->n_supports = s->n_sorted = 0;
  CHECK_OK(conic_cluster_find_sites(s));
  CHECK_OK(conic_cluster_shape_sites(s));
  CHECK(s->now.n_sites == n);
  for (size_t i = 0; i < n; i++) {
    CHECK(is_same(&sites[i], &s->now.sites[i]));
    CHECK(!s->now.sites[i].is_settled);
    n_settled += sites[i].is_settled != 0;
  }
  *n_kept += n_settled;
  conic_memory_release(context, sites);
}

/* The less is known the more is measured; with nothing known, all of it. */
static void check_errors(const conic_sampler *s) {
  size_t n_larger = 0;
  for (size_t i = 0; i < s->now.n_sites; i++) {
    double bound, error = conic_site_error(s, &s->now.sites[i], 0.0, &bound);
    CHECK(error > 0.0 && bound <= error && error >= s->now.sites[i].height);
    for (int k = 1; k <= 8; k++) {
      double known = 0.1 * k * s->job->spacing, more = conic_site_error(s, &s->now.sites[i], known, &bound);
      CHECK_NEAR(more, error > known ? error : known, 1e-12 * more);
      CHECK(bound >= error * (1.0 - 1e-12) && bound <= more);
      n_larger += error > known;
    }
  }
  CHECK(n_larger > 10);
}

static void check_passes(conic_context *context, const one_cluster *p, double tolerance, size_t *n_kept) {
  conic_sampler *s;
  conic_surfels surfels = {0};
  CHECK_OK(conic_sampler_create(context, &s));
  conic_sampling_job job = job_of(p, 0.5 * conic_cluster_edge_length(&p->mesh, 0), tolerance);
  for (int level = 0; level < 4; level++) { /* the others begin where the one before ended */
    CHECK_OK(conic_cluster_sample(s, &job, &surfels));
    if (level == 1)
      check_errors(s);
    check_settled(context, s, n_kept);
    job.spacing *= 2.0;
    job.tolerance *= 2.0;
    job.is_coarser = 1;
  }
  conic_surfels_release(context, &surfels);
  conic_sampler_destroy(s);
}

static int owns_some(const conic_sampler *s, uint32_t site, size_t lattice) {
  const conic_face_lattice *l = &s->now.lattices[lattice];
  int is_any = 0;
  for (uint32_t i = 0; i < conic_face_lattice_places(l->sides); i++)
    is_any |= s->now.owner[l->first + i] == site;
  return is_any;
}

/* As if one place had been another site's in the last pass: neither that nor who has a place of that face is settled.
 */
static void check_gains(conic_context *context, const one_cluster *p) {
  conic_sampler *s;
  conic_surfels surfels = {0};
  conic_sampling_job job = job_of(p, 0.5 * conic_cluster_edge_length(&p->mesh, 0), 0.5);
  job.most = 0;
  CHECK_OK(conic_sampler_create(context, &s));
  CHECK_OK(conic_cluster_sample(s, &job, &surfels));
  conic_cluster_end_pass(s);
  for (size_t k = 10; k < 30; k++) {
    CHECK_OK(conic_cluster_find_sites(s));
    uint32_t place = s->now.lattices[k].first, loser = (uint32_t)(s->now.n_sites - k);
    place += s->now.sites[s->now.owner[place]].place == place; /* one at which no site is */
    uint32_t own = s->now.owner[place];
    CHECK(s->last.owner[place] == own && s->now.sites[own].place != place && !owns_some(s, loser, k));
    s->last.owner[place] = loser;
    conic_cluster_settle_sites(s);
    for (uint32_t i = 0; i < s->now.n_sites; i++)
      CHECK(s->now.sites[i].is_settled == (i != loser && !owns_some(s, i, k)));
    s->last.owner[place] = own;
  }
  conic_surfels_release(context, &surfels);
  conic_sampler_destroy(s);
}

static void check_coarsest(conic_context *context, const one_cluster *p) {
  conic_sampler *s;
  conic_surfels narrow = {0}, wide = {0}, wider = {0};
  CHECK_OK(conic_sampler_create(context, &s));
  conic_sampling_job jobs[3] = {job_of(p, 0.3, 0.5), job_of(p, 3.0, 0.5), job_of(p, 6.0, 0.5)};
  CHECK_OK(conic_cluster_sample(s, &jobs[0], &narrow));
  CHECK_OK(conic_cluster_sample(s, &jobs[1], &wide));
  CHECK_OK(conic_cluster_sample(s, &jobs[2], &wider));
  CHECK(!narrow.is_coarsest && wide.is_coarsest && wider.is_coarsest);
  CHECK(wide.n > 0 && wide.n == wider.n);
  CHECK(memcmp(wide.items, wider.items, wide.n * sizeof *wide.items) == 0);
  conic_surfels_release(context, &narrow);
  conic_surfels_release(context, &wide);
  conic_surfels_release(context, &wider);
  conic_sampler_destroy(s);
}

static long n_left;

static void *allocate_few(void *cookie, size_t bytes) {
  (void)cookie;
  return n_left-- > 0 ? malloc(bytes) : NULL;
}

static void release_any(void *cookie, void *pointer) {
  (void)cookie;
  free(pointer);
}

/* Memory that runs out anywhere is told, and nothing is lost. */
static void check_memory(const one_cluster *p) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  options.allocate = allocate_few;
  options.release = release_any;
  options.threads = 1;
  n_left = 1000;
  CHECK_OK(conic_context_create(&options, &context));
  conic_status status = CONIC_ERROR_MEMORY;
  long n_failed = 0;
  for (; status == CONIC_ERROR_MEMORY; n_failed++) {
    conic_sampler *s = NULL;
    conic_surfels surfels = {0};
    conic_sampling_job job = job_of(p, 0.5 * conic_cluster_edge_length(&p->mesh, 0), 0.3);
    n_left = n_failed;
    status = conic_sampler_create(context, &s);
    if (status == CONIC_OK)
      status = conic_cluster_sample(s, &job, &surfels);
    conic_surfels_release(context, &surfels);
    conic_sampler_destroy(s);
  }
  CHECK(status == CONIC_OK && n_failed > 20);
  conic_context_destroy(context);
}

int main(void) {
  conic_context *context = check_context(1);
  one_cluster p;
  size_t n_kept = 0;
  make_cluster(context, 32, &p);
  for (int i = 0; i < 3; i++)
    check_passes(context, &p, 0.15 + 0.15 * i, &n_kept);
  CHECK(n_kept > 5000);
  check_gains(context, &p);
  check_coarsest(context, &p);
  release_cluster(context, &p);
  make_cluster(context, 8, &p);
  check_memory(&p);
  release_cluster(context, &p);
  conic_context_destroy(context);
  return check_result();
}
