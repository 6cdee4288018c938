/* The clip lines of a mesh's splats: where a splat's plane meets the planes of the mates across its creases. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/vectors.h"
#include "core/splats/features.h"
#include "core/splats/incidence.h"

/* A crease matters to a splat that would touch it if it were twice as large: the prefilter widens splats. */
#define REACH 2.0
/* So much of a splat's own share of the surface, as a part of its distance, may be cut off: its neighbours overlap it.
 */
#define SLACK 0.1

/* Of each triangle at a vertex: the middles of its two edges, and its own. */
enum { PLACES_A_TRIANGLE = 3, MAX_PLACES = 3 * 64 };

typedef struct vertex_axes {
  double p[3], u[3], v[3], n[3]; /* the axes, and u × v as a unit vector */
} vertex_axes;

/* Returns 0 where the axes span no plane. */
static int read_axes(const conic_splats *points, size_t i, vertex_axes *at) {
  for (int axis = 0; axis < 3; axis++) {
    at->p[axis] = (double)points->position[axis][i];
    at->u[axis] = (double)points->tangent_u[axis][i];
    at->v[axis] = (double)points->tangent_v[axis][i];
  }
  conic_cross(at->u, at->v, at->n);
  return conic_normalize(at->n);
}

/* The line in which the splat's plane meets that of the crease's mate, keeping the side of `inside`. */
static void add_line(const conic_splats *points, const vertex_axes *at, const conic_crease *crease, double cutoff,
                     conic_clip_choice *choice) {
  vertex_axes mate;
  double line[3], from_mate[3], side = 0.0;
  if (!read_axes(points, crease->mate, &mate))
    return;
  for (int axis = 0; axis < 3; axis++) {
    from_mate[axis] = at->p[axis] - mate.p[axis];
    side += mate.n[axis] * ((double)points->position[axis][crease->inside] - mate.p[axis]);
  }
  side = side < 0.0 ? -1.0 : 1.0;
  line[0] = side * conic_dot(mate.n, at->u);
  line[1] = side * conic_dot(mate.n, at->v);
  line[2] = side * conic_dot(mate.n, from_mate);
  conic_clip_choice_add(choice, line, REACH * cutoff);
}

static void add_creases_of(const conic_splats *points, const conic_creases *creases, size_t vertex,
                           const vertex_axes *at, double cutoff, conic_clip_choice *choice) {
  for (size_t i = creases->starts[vertex]; i < creases->starts[vertex + 1]; i++)
    add_line(points, at, &creases->all[i], cutoff, choice);
}

/* The corners of the vertex's share of a triangle, in units of its axes. */
static size_t add_places(const conic_model *model, const uint32_t triangle[3], size_t vertex, const vertex_axes *at,
                         double (*places)[2]) {
  double edges[2][3], uu = conic_dot(at->u, at->u), vv = conic_dot(at->v, at->v);
  int corner = triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
  for (int i = 0; i < 2; i++)
    for (int axis = 0; axis < 3; axis++)
      edges[i][axis] = (double)model->points.position[axis][triangle[(corner + 1 + i) % 3]] - at->p[axis];
  for (int k = 0; k < PLACES_A_TRIANGLE; k++) {
    double offset[3];
    for (int axis = 0; axis < 3; axis++)
      offset[axis] = k < 2 ? 0.5 * edges[k][axis] : (edges[0][axis] + edges[1][axis]) / 3.0;
    places[k][0] = conic_dot(offset, at->u) / uu;
    places[k][1] = conic_dot(offset, at->v) / vv;
  }
  return PLACES_A_TRIANGLE;
}

/* The lines of the creases that the vertex or one of the vertices around it is on. */
static int clip_vertex(const conic_model *model, const conic_creases *creases, const conic_incidence *ring,
                       double cutoff, size_t vertex, conic_clip *clip) {
  vertex_axes at;
  conic_clip_choice choice = {.n = 0};
  double places[MAX_PLACES][2];
  size_t n_places = 0;
  if (!read_axes(&model->points, vertex, &at))
    return 0;
  add_creases_of(&model->points, creases, vertex, &at, cutoff, &choice);
  for (size_t i = ring->starts[vertex]; i < ring->starts[vertex + 1]; i++) {
    const uint32_t *triangle = model->triangles[ring->triangles[i]];
    if (n_places + PLACES_A_TRIANGLE <= MAX_PLACES)
      n_places += add_places(model, triangle, vertex, &at, places + n_places);
    for (int j = 0; j < 3; j++)
      if (triangle[j] != vertex)
        add_creases_of(&model->points, creases, triangle[j], &at, cutoff, &choice);
  }
  *clip = (conic_clip){.splat = (uint32_t)vertex};
  return conic_clip_choose(&choice, (const double(*)[2])places, n_places, SLACK, clip);
}

conic_status conic_creases_clip(conic_context *context, const conic_creases *creases, double cutoff,
                                conic_model *split) {
  conic_splats *points = &split->points;
  conic_incidence ring;
  size_t capacity = 0;
  conic_status status = conic_incidence_create(context, split, UINT32_MAX / 3, &ring);
  for (size_t vertex = 0; status == CONIC_OK && creases->n && vertex < points->count; vertex++) {
    conic_clip clip;
    if (!clip_vertex(split, creases, &ring, cutoff, vertex, &clip))
      continue;
    status = conic_memory_reserve(context, &points->clips, points->n_clips, points->n_clips + 1, &capacity,
                                  sizeof *points->clips);
    if (status == CONIC_OK)
      points->clips[points->n_clips++] = clip;
  }
  conic_incidence_release(context, &ring);
  return status;
}
