/* Surfels from three faces of the cluster's box (HQP §3.3.2, Algorithm 3.4). What a line of the grid meets is found by
 * looking at each face along the axis and at the lines that pass it, which gives the same as asking every line for
 * every face. */

#include "core/splats/ellipse.h"
#include "lod/clusters/cluster_sample.h"

/* Waterproof where the greatest gap, √3 spacings, is below the surfels' radius. */
static const double radius_in_spacings = 1.7320508075688772;

typedef struct box_sampling {
  conic_context *context;
  const conic_sampling_job *job;
  conic_surfels *surfels;
  double low[3]; /* of the cluster's box: where the grids begin */
} box_sampling;

static void find_cluster_box(box_sampling *b) {
  const conic_clustered_mesh *mesh = b->job->mesh;
  b->low[0] = b->low[1] = b->low[2] = HUGE_VAL;
  for (size_t i = mesh->starts[b->job->cluster]; i < mesh->starts[b->job->cluster + 1]; i++)
    for (int corner = 0; corner < 3; corner++) {
      double at[3];
      conic_mesh_corner(&mesh->mesh, mesh->faces[i], corner, at);
      for (int axis = 0; axis < 3; axis++)
        b->low[axis] = at[axis] < b->low[axis] ? at[axis] : b->low[axis];
    }
}

static conic_status add_surfel(box_sampling *b, uint32_t face, const double bary[3]) {
  const conic_clustered_mesh *mesh = b->job->mesh;
  double at[3], facing[3], normal[3], color[3], texel[3], u[3], v[3];
  double reach = radius_in_spacings * b->job->spacing, sigma = reach / b->job->cutoff;
  conic_status status = conic_surfels_reserve(b->context, b->surfels);
  if (status != CONIC_OK)
    return status;
  conic_surfel *surfel = &b->surfels->items[b->surfels->n++];
  conic_cluster_place(mesh, face, bary, at);
  conic_cluster_face_normal(mesh, face, facing);
  conic_cluster_normal(mesh, face, bary, facing, normal);
  conic_cluster_color(mesh, face, bary, color);
  conic_cluster_texel(mesh, face, bary, b->job->spacing, texel);
  conic_tangent_basis(normal, u, v);
  for (int axis = 0; axis < 3; axis++) {
    surfel->position[axis] = (float)at[axis];
    surfel->tangent_u[axis] = (float)(sigma * u[axis]);
    surfel->tangent_v[axis] = (float)(sigma * v[axis]);
    surfel->color[axis] = (float)(color[axis] * texel[axis]);
  }
  surfel->face = face;
  b->surfels->error = reach > b->surfels->error ? reach : b->surfels->error;
  b->surfels->reach = reach;
  if (conic_has_seen_colors(mesh->triangles)) /* nobody looks how they differ */
    b->surfels->change = (conic_seen_change){CONIC_SEEN_STEPS, CONIC_SEEN_STEPS * reach};
  return CONIC_OK;
}

/* A face as it is seen along an axis, in steps of the grid. */
typedef struct flat_face {
  double at[3][2], area2;
  double low[2], high[2];
} flat_face;

static flat_face flatten(const box_sampling *b, uint32_t face, int axis) {
  flat_face flat;
  for (int corner = 0; corner < 3; corner++) {
    double at[3];
    conic_mesh_corner(&b->job->mesh->mesh, face, corner, at);
    for (int k = 0; k < 2; k++) {
      int other = (axis + 1 + k) % 3;
      double step = (at[other] - b->low[other]) / b->job->spacing;
      flat.at[corner][k] = step;
      flat.low[k] = corner == 0 || step < flat.low[k] ? step : flat.low[k];
      flat.high[k] = corner == 0 || step > flat.high[k] ? step : flat.high[k];
    }
  }
  flat.area2 = (flat.at[1][0] - flat.at[0][0]) * (flat.at[2][1] - flat.at[0][1]) -
               (flat.at[1][1] - flat.at[0][1]) * (flat.at[2][0] - flat.at[0][0]);
  return flat;
}

static int meets(const flat_face *flat, double x, double y, double bary[3]) {
  for (int corner = 0; corner < 3; corner++) {
    const double *a = flat->at[(corner + 1) % 3], *b = flat->at[(corner + 2) % 3];
    bary[corner] = ((a[0] - x) * (b[1] - y) - (a[1] - y) * (b[0] - x)) / flat->area2;
    if (!(bary[corner] >= 0.0))
      return 0;
  }
  return 1;
}

static conic_status sample_face(box_sampling *b, uint32_t face, int axis) {
  flat_face flat = flatten(b, face, axis);
  conic_status status = CONIC_OK;
  if (!(fabs(flat.area2) > 0.0))
    return CONIC_OK;
  for (double y = floor(flat.low[1]); y <= flat.high[1] && status == CONIC_OK; y += 1.0)
    for (double x = floor(flat.low[0]); x <= flat.high[0] && status == CONIC_OK; x += 1.0) {
      double bary[3];
      if (meets(&flat, x, y, bary))
        status = add_surfel(b, face, bary);
    }
  return status;
}

conic_status conic_cluster_sample_box(conic_context *context, const conic_sampling_job *job, conic_surfels *surfels) {
  box_sampling b = {.context = context, .job = job, .surfels = surfels};
  conic_status status = CONIC_OK;
  find_cluster_box(&b);
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = job->mesh->starts[job->cluster]; i < job->mesh->starts[job->cluster + 1] && status == CONIC_OK; i++)
      status = sample_face(&b, job->mesh->faces[i], axis);
  return status;
}
