#include "surface/landings.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/team_runs.h"
#include "core/base/vectors.h"

enum { CHUNK = 64, CHUNKS_A_REPORT = 64, MOST_SHARING = 24 };

/* Darts share their candidates within a box of this many h. */
static const double SHARED_BOX = 0.5;

/* How far from its place a dart may land: in a mesh, a share of the triangle's longest edge; among points, of that or
 * of h, whichever is longer. Beyond, it has met another sheet. */
static const double STRAY_IN_MESH = 0.35, STRAY_AMONG_POINTS = 0.5;

/* The least cosine between the normals of a triangle and of the surface over it. */
static const double LEAST_AGREEMENT = 0.5;

/* A dart that moves along its triangle by more than this share of the longest edge may leave a gap. */
static const double ASIDE = 0.25;

typedef struct landing_work {
  const conic_surface *surface;
  const conic_densify_triangles *triangles;
  const conic_darts *darts;
  conic_landing_places *landed;
  conic_workspace *workspaces;
} landing_work;

static double scale_at(const landing_work *work, const conic_dart *dart) {
  const uint32_t *corners = work->triangles->corners[dart->triangle];
  double rest = 1.0 - dart->shares[0] - dart->shares[1];
  int nearest =
      dart->shares[0] >= dart->shares[1] ? (dart->shares[0] >= rest ? 0 : 2) : (dart->shares[1] >= rest ? 1 : 2);
  return (double)work->surface->h[corners[nearest]];
}

/* Whether the corners face the same way, unlike the two sides of a step. */
static int do_corners_agree(const conic_dart_triangle *triangle) {
  int do_agree = 1;
  for (int k = 0; k < 3; k++)
    do_agree &= conic_dot(triangle->normals[k], triangle->normals[(k + 1) % 3]) >= LEAST_AGREEMENT;
  return do_agree;
}

/* Takes the mean of the corners' attributes, by the dart's shares. */
static void stay_in_triangle(const landing_work *work, const conic_dart *dart, const conic_dart_triangle *triangle,
                             conic_landed *landed) {
  const conic_surface *surface = work->surface;
  const uint32_t *corners = work->triangles->corners[dart->triangle];
  const double shares[3] = {dart->shares[0], dart->shares[1], 1.0 - dart->shares[0] - dart->shares[1]};
  double sum[3] = {0.0, 0.0, 0.0};
  memcpy(landed->place, dart->place, sizeof landed->place);
  int is_smooth = triangle->is_bent || (!work->triangles->are_given && do_corners_agree(triangle));
  landed->how = work->triangles->are_given || is_smooth ? CONIC_LANDED_FLAT : CONIC_LANDED_NOWHERE;
  for (int k = 0; k < 3; k++)
    for (int axis = 0; axis < 3; axis++) {
      sum[axis] += shares[k] * triangle->normals[k][axis];
      landed->color[axis] += surface->color[0] ? (float)shares[k] * surface->color[axis][corners[k]] : 0.0f;
    }
  conic_normalize(sum);
  for (int axis = 0; axis < 3; axis++)
    landed->normal[axis] = (float)(is_smooth ? sum[axis] : triangle->across[axis]);
}

static double longest_edge(const conic_dart_triangle *triangle) {
  double longest2 = 0.0;
  for (int k = 0; k < 3; k++) {
    double edge[3];
    conic_subtract(triangle->corners[(k + 1) % 3], triangle->corners[k], edge);
    longest2 = conic_dot(edge, edge) > longest2 ? conic_dot(edge, edge) : longest2;
  }
  return sqrt(longest2);
}

/* Whether a dart landed on the sheet that it was thrown at. */
static int is_on_sheet(const landing_work *work, const conic_dart_triangle *triangle, const conic_landing *landing) {
  double edge = longest_edge(triangle), moved = conic_length(landing->offset), h = landing->h;
  double farthest = work->triangles->are_given ? STRAY_IN_MESH * edge : STRAY_AMONG_POINTS * (edge > h ? edge : h);
  return landing->outcome == CONIC_SURFACE_DONE && moved <= farthest &&
         fabs(conic_dot(landing->normal, triangle->across)) >= LEAST_AGREEMENT;
}

static void land(const landing_work *work, size_t i, double h, conic_workspace *workspace) {
  const conic_dart *dart = &work->darts->list[i];
  conic_landed *landed = &work->landed->list[i];
  conic_dart_triangle triangle;
  conic_landing landing;
  double side[3], color[3], edge;
  *landed = (conic_landed){.how = CONIC_LANDED_NOWHERE};
  conic_densify_triangle(work->triangles, dart->triangle, &triangle);
  edge = longest_edge(&triangle);
  const float across[3] = {(float)triangle.across[0], (float)triangle.across[1], (float)triangle.across[2]};
  workspace->side = work->surface->normal[0] ? across : NULL;
  workspace->is_trusting = 1; /* is_on_sheet checks the result instead */
  conic_surface_project_one(work->surface, dart->place, h, CONIC_NO_SLOT, 1, workspace, &landing);
  workspace->is_trusting = 0;
  workspace->side = NULL;
  if (!is_on_sheet(work, &triangle, &landing)) {
    stay_in_triangle(work, dart, &triangle, landed);
    return;
  }
  conic_surface_attributes(work->surface, workspace, side, color);
  double up = conic_dot(landing.offset, landing.normal), sign = conic_dot(side, landing.normal) < 0.0 ? -1.0 : 1.0;
  double aside2 = conic_dot(landing.offset, landing.offset) - up * up;
  landed->how = aside2 > ASIDE * ASIDE * edge * edge ? CONIC_LANDED_ASIDE : CONIC_LANDED_WELL;
  for (int axis = 0; axis < 3; axis++) {
    landed->place[axis] = dart->place[axis] + landing.offset[axis];
    landed->normal[axis] = (float)(sign * landing.normal[axis]);
    landed->color[axis] = (float)color[axis];
  }
}

/* Grows the box to hold the place, unless it would become longer than `most`. */
static int grow_landing_box(const double place[3], double most, double box[6]) {
  double grown[6];
  for (int axis = 0; axis < 3; axis++) {
    grown[axis] = place[axis] < box[axis] ? place[axis] : box[axis];
    grown[3 + axis] = place[axis] > box[3 + axis] ? place[axis] : box[3 + axis];
    if (grown[3 + axis] - grown[axis] > most)
      return 0;
  }
  memcpy(box, grown, sizeof grown);
  return 1;
}

/* Gathers candidates for the darts from i on whose places are close enough together; returns how many darts those
 * are. */
static size_t share(const landing_work *work, size_t i, size_t end, conic_workspace *workspace) {
  const conic_dart *first = &work->darts->list[i];
  double greatest_h = scale_at(work, first), box[6];
  size_t n = 1;
  for (int axis = 0; axis < 3; axis++)
    box[axis] = box[3 + axis] = first->place[axis];
  for (; i + n < end && n < MOST_SHARING; n++) {
    double h = scale_at(work, &first[n]);
    if (!grow_landing_box(first[n].place, SHARED_BOX * h, box))
      break;
    greatest_h = h > greatest_h ? h : greatest_h;
  }
  conic_surface_gather(work->surface, box, 2.0 * conic_surface_margin(work->surface, greatest_h), workspace,
                       &workspace->shared);
  return n;
}

static void land_chunk(void *data, size_t i_item, int i_thread) {
  landing_work *work = data;
  conic_workspace *workspace = &work->workspaces[i_thread];
  size_t end = (i_item + 1) * CHUNK < work->darts->n ? (i_item + 1) * CHUNK : work->darts->n;
  for (size_t i = i_item * CHUNK; i < end;)
    for (size_t n = share(work, i, end, workspace); n; n--, i++)
      land(work, i, scale_at(work, &work->darts->list[i]), workspace);
}

conic_status conic_land_darts(const conic_surface *surface, const conic_densify_triangles *triangles,
                              const conic_darts *darts, double from, double to, conic_workspace *workspaces,
                              conic_landing_places *landed) {
  conic_context *context = surface->context;
  landing_work work = {surface, triangles, darts, landed, workspaces};
  if (darts->n > landed->room &&
      conic_memory_reserve(context, &landed->list, 0, darts->n, &landed->room, sizeof *landed->list) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  conic_team_loop loop = conic_team_loop_of("densify", from, to, darts->n, CHUNK, CHUNKS_A_REPORT, land_chunk, &work);
  loop.columns[0] = (conic_team_column){landed->list, sizeof *landed->list};
  return conic_team_runs(context, &loop);
}
