/* Densifying (PSS §5.2): adds points of the surface wherever a circle of a certain radius is empty, the widest circles
 * first.
 *
 * Triangles say where there is surface: the set's own, or those that each point makes with its neighbours (Delaunay's).
 * In passes with ever smaller radii, a dart is thrown at every place of the triangles without a point nearby, and the
 * darts are projected. */

#include "core/base/team_runs.h"
#include "core/base/vectors.h"
#include "core/splats/builder.h"
#include "core/splats/splats_gather.h"
#include "surface/densify_triangles.h"

/* --- landings --- */

typedef enum landed_how {
  LANDED_WELL,  /* on the surface, where it was thrown */
  LANDED_ASIDE, /* on the surface, but beside its place */
  LANDED_FLAT,  /* there is no surface, so it stays in its triangle */
  LANDED_NOWHERE
} landed_how;

typedef struct landed_dart {
  double place[3];
  float normal[3], color[3];
  landed_how how;
} landed_dart;

typedef struct landing_places {
  landed_dart *list; /* by dart */
  size_t room;
} landing_places;

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
  landing_places *landed;
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
                             landed_dart *landed) {
  const conic_surface *surface = work->surface;
  const uint32_t *corners = work->triangles->corners[dart->triangle];
  const double shares[3] = {dart->shares[0], dart->shares[1], 1.0 - dart->shares[0] - dart->shares[1]};
  double sum[3] = {0.0, 0.0, 0.0};
  memcpy(landed->place, dart->place, sizeof landed->place);
  int is_smooth = triangle->is_bent || (!work->triangles->are_given && do_corners_agree(triangle));
  landed->how = work->triangles->are_given || is_smooth ? LANDED_FLAT : LANDED_NOWHERE;
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
  landed_dart *landed = &work->landed->list[i];
  conic_dart_triangle triangle;
  conic_landing landing;
  double side[3], color[3], edge;
  *landed = (landed_dart){.how = LANDED_NOWHERE};
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
  landed->how = aside2 > ASIDE * ASIDE * edge * edge ? LANDED_ASIDE : LANDED_WELL;
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

/* Errors: MEMORY, CANCELLED. */
static conic_status land_darts(const conic_surface *surface, const conic_densify_triangles *triangles,
                               const conic_darts *darts, double from, double to, conic_workspace *workspaces,
                               landing_places *landed) {
  conic_context *context = surface->context;
  landing_work work = {surface, triangles, darts, landed, workspaces};
  if (darts->n > landed->room &&
      conic_memory_reserve(context, &landed->list, 0, darts->n, &landed->room, sizeof *landed->list) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  conic_team_loop loop = conic_team_loop_of("densify", from, to, darts->n, CHUNK, CHUNKS_A_REPORT, land_chunk, &work);
  loop.columns[0] = (conic_team_column){landed->list, sizeof *landed->list};
  return conic_team_runs(context, &loop);
}

/* --- densifying --- */

enum { TRIANGLES_A_REPORT = 4096 };

/* Darts are thrown at this share of the radius: the lattice may miss places, and projection moves darts. */
static const double RADIUS_SHARE = 0.97;

/* Each pass's radius, as a share of the last. */
static const double PASS_SHARE = 0.7;

CONIC_DEFINE_ZERO_OPTIONS(conic_densify_options)

typedef struct densifying {
  const conic_surface *surface;
  const conic_densify_options *options;
  conic_splats *points; /* grows */
  size_t limit;
  conic_densify_triangles triangles;
  conic_workspace *workspaces;
  conic_darts darts;
  landing_places landed; /* where the darts landed */
  uint8_t *is_moved;     /* by triangle: a dart of it landed elsewhere, or nowhere */
  size_t n_flat, n_evaluations;
} densifying;

/* --- a pass --- */

static conic_status set_up_board(const densifying *work, double radius, conic_dart_board *board) {
  const conic_splats *points = work->points;
  conic_status status = conic_dart_board_begin(work->surface->context, radius, points->count, board);
  for (size_t i = 0; i < points->count && status == CONIC_OK; i++) {
    const double place[3] = {(double)points->position[0][i], (double)points->position[1][i],
                             (double)points->position[2][i]};
    if (conic_dot(place, place) < HUGE_VAL)
      status = conic_dart_board_add(board, place);
  }
  return status;
}

/* Throws darts at all triangles, or, the second time, at those marked as moved. */
static conic_status throw_darts(densifying *work, conic_dart_board *board, int is_second, double from, double to) {
  const conic_densify_triangles *triangles = &work->triangles;
  conic_status status = CONIC_OK;
  work->darts.n = 0;
  for (size_t i = 0; i < triangles->n && status == CONIC_OK; i++) {
    conic_dart_triangle triangle;
    if (i % TRIANGLES_A_REPORT == 0)
      status = conic_progress(work->surface->context, "densify", from + (to - from) * (double)i / (double)triangles->n);
    if (status != CONIC_OK || !(triangles->reaches[i] > board->radius) || (is_second && !work->is_moved[i]))
      continue;
    conic_densify_triangle(triangles, i, &triangle);
    status = conic_darts_throw(board, &triangle, (uint32_t)i, CONIC_MAX_POINTS - work->points->count, &work->darts);
  }
  return status;
}

static conic_status append_landed(densifying *work, size_t i) {
  const landed_dart *from = &work->landed.list[i];
  conic_splats *points = work->points;
  size_t to = points->count++;
  for (int axis = 0; axis < 3; axis++) {
    points->position[axis][to] = (float)from->place[axis];
    if (points->normal[0])
      points->normal[axis][to] = (float)from->normal[axis];
    if (points->color[0])
      points->color[axis][to] = (float)from->color[axis];
  }
  work->n_flat += from->how == LANDED_FLAT;
  return CONIC_OK;
}

/* Appends the landed darts, as far as there is room; if there are too many, an even choice, and *is_full is set. In the
 * second throw of a radius, darts that landed beside a point are left out. */
static conic_status append_darts(densifying *work, double radius, int is_second, int *is_full) {
  conic_context *context = work->surface->context;
  size_t n = work->darts.n, room = work->limit > work->points->count ? work->limit - work->points->count : 0;
  size_t n_kept = n < room ? n : room;
  conic_dart_board board;
  *is_full = n > room;
  conic_status status =
      conic_splats_resize(context, work->points, work->points->count + n_kept, conic_splats_fields(work->points));
  if (status != CONIC_OK || !n)
    return status;
  status = is_second ? set_up_board(work, 0.5 * radius, &board) : CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    const landed_dart *landed = &work->landed.list[i];
    int is_chosen = (uint64_t)(i + 1) * n_kept / n > (uint64_t)i * n_kept / n;
    if (landed->how != LANDED_WELL)
      work->is_moved[work->darts.list[i].triangle] = 1;
    if (landed->how == LANDED_NOWHERE || !is_chosen || (is_second && conic_dart_board_covers(&board, landed->place)))
      continue;
    status = append_landed(work, i);
    if (is_second && status == CONIC_OK)
      status = conic_dart_board_add(&board, landed->place);
  }
  if (is_second)
    conic_dart_board_end(&board);
  return status;
}

static conic_status throw_once(densifying *work, double radius, int is_second, double from, double to, int *is_full) {
  conic_dart_board board;
  conic_status status = set_up_board(work, radius, &board);
  if (status == CONIC_OK)
    status = throw_darts(work, &board, is_second, from, 0.5 * (from + to));
  conic_dart_board_end(&board);
  if (status == CONIC_OK)
    status = land_darts(work->surface, &work->triangles, &work->darts, 0.5 * (from + to), to, work->workspaces,
                        &work->landed);
  return status == CONIC_OK ? append_darts(work, radius, is_second, is_full) : status;
}

/* Makes passes from the widest circle down; *left is the greatest radius of a circle that may still be empty. */
static conic_status run_passes(densifying *work, double *left) {
  double least = RADIUS_SHARE * work->options->spacing, radius = least;
  int n_passes = 1, is_full = 0;
  conic_status status = CONIC_OK;
  *left = work->triangles.widest;
  for (; radius < PASS_SHARE * work->triangles.widest; n_passes++)
    radius /= PASS_SHARE;
  for (int i = 0; i < n_passes && status == CONIC_OK && !is_full; i++, radius *= PASS_SHARE) {
    double from = (double)i / (double)(n_passes + 1), to = (double)(i + 1) / (double)(n_passes + 1);
    status = throw_once(work, radius, 0, from, to, &is_full);
    if (!is_full && *left > radius / RADIUS_SHARE)
      *left = radius / RADIUS_SHARE;
  }
  if (status == CONIC_OK && !is_full)
    status = throw_once(work, least, 1, (double)n_passes / (double)(n_passes + 1), 1.0, &is_full);
  return status;
}

/* --- the whole --- */

static conic_status begin_densifying(densifying *work) {
  conic_context *context = work->surface->context;
  const conic_splats *from = &work->surface->points;
  memcpy(work->points->origin, from->origin, sizeof from->origin);
  work->limit = work->options->max_count ? work->options->max_count : (size_t)CONIC_MAX_POINTS;
  conic_status status = conic_splats_append(context, work->points, from);
  if (status == CONIC_OK)
    status = conic_workspaces_create(context, &work->workspaces);
  if (status == CONIC_OK)
    status = conic_densify_triangles_find(work->surface, work->options, work->workspaces, &work->triangles);
  if (status != CONIC_OK)
    return status;
  work->is_moved = conic_memory_allocate_zeroed(context, work->triangles.n, sizeof *work->is_moved);
  return work->is_moved ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static void report_densified(const densifying *work, double left, conic_surface_report *report) {
  memset(report, 0, sizeof *report);
  report->n_in = work->surface->points.count;
  report->n_out = work->points->count;
  report->n_flat = work->n_flat;
  report->h = work->surface->median_h;
  report->error = left;
  report->n_evaluations = work->n_evaluations;
}

static int are_densify_options(const conic_surface *surface, const conic_densify_options *o) {
  if (!(o->spacing > 0.0) || !(o->hole >= 0.0) || (o->n_triangles && !o->triangles))
    return 0;
  for (size_t i = 0; i < o->n_triangles; i++)
    for (int k = 0; k < 3; k++)
      if (o->triangles[i][k] >= surface->points.count)
        return 0;
  return 1;
}

conic_status conic_surface_densify(conic_surface *surface, const conic_densify_options *given, conic_splats *dense,
                                   conic_surface_report *report) {
  conic_context *context = surface->context;
  conic_densify_options own, *options = &own;
  densifying work = {.surface = surface, .options = options, .points = dense};
  double left = 0.0;
  memset(dense, 0, sizeof *dense);
  conic_densify_options_init(options);
  if (!conic_options_take(options, given) || !are_densify_options(surface, options))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "densify: no spacing is given, or triangles without their points");
  conic_status status = begin_densifying(&work);
  if (status == CONIC_OK)
    status = run_passes(&work, &left);
  if (status == CONIC_OK)
    status = conic_workspaces_check(context, work.workspaces);
  if (status == CONIC_OK)
    status = conic_workspaces_count(context, work.workspaces, &work.n_evaluations);
  if (status == CONIC_OK && report)
    report_densified(&work, left, report);
  conic_densify_triangles_release(context, &work.triangles);
  conic_memory_release_these(context, work.is_moved, work.darts.list, work.landed.list);
  conic_workspaces_release(context, work.workspaces);
  if (status != CONIC_OK)
    conic_splats_release(context, dense);
  return status;
}
