/* Whether a point is within a solid is told by the discs of its surface that are nearest to the point: by the side of
 * their planes. Over an edge two discs are about as near, and the solid lies below both of them, if it is convex there,
 * or below either. The planes of these discs are also the lines at which a splat is clipped. */
#include "conic/csg.h"

#include "core/base/vectors.h"
#include "core/estimate/neighbours.h"
#include "core/splats/clip.h"
#include "core/splats/columns.h"
#include "core/splats/splats_gather.h"

enum { N_NEAREST = 32, MOST_SIDES = 3, CHUNK = 512, CHUNKS_A_REPORT = 64 };
/* A disc is of the other side of an edge where the cosine between its normal and the nearest one's is less. */
#define OTHER_SIDE_COSINE 0.9
/* A point lies over the edge where that disc is farther than the nearest by less than this share. */
#define ABOUT_AS_NEAR 1.25

/* One of the two surfaces, and which of its splats stay. */
typedef struct solid {
  const conic_splats *splats;
  conic_splats close; /* what is given, without strides */
  float *block;
  conic_neighbours tree;
  uint8_t *fate;
  conic_clip *clips; /* of each splat; no lines: none */
} solid;

enum { DROPPED, KEPT, CUT, CUT_UNCLIPPED };

/* A disc of a surface, from a point: its plane, in the point's frame. */
typedef struct face {
  double normal[3];
  double height;   /* of the point above the plane */
  double distance; /* from the point to the disc */
  double center[3];
} face;

typedef struct cutting {
  solid *of, *by;
  double cutoff;
  double offset[3]; /* from the origin of `by` to that of `of` */
  int keeps_inside;
} cutting;

static void axes_of(const conic_splats *splats, size_t i, double u[3], double v[3]) {
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (double)splats->tangent_u[axis][i];
    v[axis] = (double)splats->tangent_v[axis][i];
  }
}

/* How far the place (u, v) of a splat's plane, in its axes of these lengths, is beyond what its clip lines keep. */
static double beyond_lines(const conic_splats *splats, size_t i, const double place[2], const double lengths[2]) {
  size_t at = conic_clip_find(splats, i);
  if (at == splats->n_clips || splats->clips[at].splat != i)
    return 0.0;
  const conic_clip *clip = &splats->clips[at];
  double beyond[2] = {0.0, 0.0};
  for (int k = 0; k < clip->n_lines; k++) {
    const double a = (double)clip->lines[k][0], b = (double)clip->lines[k][1];
    const double slope[3] = {a / lengths[0], b / lengths[1], 0.0};
    double value = a * place[0] + b * place[1] + (double)clip->lines[k][2];
    beyond[k] = value < 0.0 ? -value / conic_length(slope) : 0.0;
  }
  if (clip->n_lines == 2 && clip->operation == CONIC_CLIP_OR)
    return beyond[0] < beyond[1] ? beyond[0] : beyond[1];
  return sqrt(beyond[0] * beyond[0] + beyond[1] * beyond[1]); /* of a corner of right angles */
}

/* The face of a splat; returns 0 where it has none. */
static int look_at_face(const conic_splats *splats, size_t i, const double point[3], double cutoff, face *f) {
  double u[3], v[3], within[3];
  axes_of(splats, i, u, v);
  conic_cross(u, v, f->normal);
  const double lengths[2] = {conic_length(u), conic_length(v)};
  if (!conic_normalize(f->normal))
    return 0;
  for (int axis = 0; axis < 3; axis++)
    f->center[axis] = (double)splats->position[axis][i] - point[axis];
  f->height = -conic_dot(f->normal, f->center);
  for (int axis = 0; axis < 3; axis++)
    within[axis] = -f->center[axis] - f->height * f->normal[axis];
  const double place[2] = {conic_dot(within, u) / (lengths[0] * lengths[0]),
                           conic_dot(within, v) / (lengths[1] * lengths[1])};
  double radius = sqrt(place[0] * place[0] + place[1] * place[1]);
  double beyond = radius > cutoff ? conic_length(within) * (1.0 - cutoff / radius) : 0.0;
  double clipped = beyond_lines(splats, i, place, lengths);
  beyond = beyond > clipped ? beyond : clipped;
  f->distance = sqrt(f->height * f->height + beyond * beyond);
  return 1;
}

/* Of the discs of one side, the one whose middle is the nearest: where the surface is round, its plane fits best. */
static face most_central(const face *all, int n, int nearest) {
  int central = nearest;
  for (int k = 0; k < n; k++)
    if (conic_dot(all[k].normal, all[nearest].normal) >= OTHER_SIDE_COSINE &&
        conic_length(all[k].center) < conic_length(all[central].center))
      central = k;
  face result = all[central];
  result.distance = all[nearest].distance;
  return result;
}

/* The nearest disc and, near an edge or a corner, the nearest of each other side. Returns how many these are. */
static int find_faces(const solid *by, const double point[3], double cutoff, face faces[MOST_SIDES]) {
  uint32_t slots[N_NEAREST];
  double distances2[N_NEAREST];
  face all[N_NEAREST];
  int n = 0, n_faces = 0;
  size_t n_found = conic_neighbours_nearest(&by->tree, point, CONIC_NO_SLOT, N_NEAREST, HUGE_VAL, slots, distances2);
  for (size_t k = 0; k < n_found; k++)
    n += look_at_face(by->splats, by->tree.point_of_slot[slots[k]], point, cutoff, &all[n]);
  for (int nearest = 0; nearest >= 0 && n_faces < MOST_SIDES; n_faces += nearest >= 0) {
    nearest = -1;
    for (int k = 0; k < n; k++) {
      int is_new = 1;
      for (int of = 0; of < n_faces; of++)
        is_new = is_new && conic_dot(all[k].normal, faces[of].normal) < OTHER_SIDE_COSINE;
      if (is_new && (nearest < 0 || all[k].distance < all[nearest].distance))
        nearest = k;
    }
    if (nearest >= 0)
      faces[n_faces] = most_central(all, n, nearest);
  }
  return n_faces;
}

/* Whether two faces are those of an edge that sticks out: the other one's middle lies below the first one's plane. */
static int is_convex(const face *first, const face *other) {
  double between[3];
  conic_subtract(other->center, first->center, between);
  return conic_dot(first->normal, between) <= 0.0;
}

static int is_inside(const face *faces, int n) {
  int inside = faces[0].height < 0.0;
  for (int k = 1; k < n && faces[k].distance <= ABOUT_AS_NEAR * faces[0].distance; k++) {
    int is_below = faces[k].height < 0.0;
    inside = is_convex(&faces[0], &faces[k]) ? inside && is_below : inside || is_below;
  }
  return inside;
}

/* The line at which a face's plane cuts a splat, with what stays on its side; and whether it leaves all of the outline,
 * some, or none. */
enum { LEAVES_NONE, LEAVES_SOME, LEAVES_ALL };
static int cut_by_face(const cutting *c, const face *f, const double u[3], const double v[3], float line[3]) {
  double sign = c->keeps_inside ? -1.0 : 1.0;
  double a = sign * conic_dot(f->normal, u), b = sign * conic_dot(f->normal, v), height = sign * f->height;
  double reach = c->cutoff * sqrt(a * a + b * b);
  line[0] = (float)a;
  line[1] = (float)b;
  line[2] = (float)height;
  if (!(height < reach))
    return LEAVES_ALL;
  return height > -reach && conic_clip_is_line(line) ? LEAVES_SOME : LEAVES_NONE;
}

/* Lines that all cut a splat, or of which each does; the nearest to its centre first. */
typedef struct cut_lines {
  float lines[MOST_SIDES + 2][3];
  double distances[MOST_SIDES + 2];
  int n;
} cut_lines;

static void add_line(cut_lines *cut, const float line[3]) {
  const double slope[3] = {(double)line[0], (double)line[1], 0.0};
  double distance = (double)line[2] / conic_length(slope);
  int to = cut->n++;
  for (; to > 0 && distance < cut->distances[to - 1]; to--) {
    memcpy(cut->lines[to], cut->lines[to - 1], sizeof cut->lines[to]);
    cut->distances[to] = cut->distances[to - 1];
  }
  memcpy(cut->lines[to], line, sizeof cut->lines[to]);
  cut->distances[to] = distance;
}

/* What the faces leave of a splat, of all of them or of either; the lines that are needed for it are added. */
static int cut_by_faces(const cutting *c, const face *faces, int n, int is_either, const double u[3], const double v[3],
                        cut_lines *cut) {
  float lines[MOST_SIDES][3];
  int left[MOST_SIDES], most = LEAVES_NONE, least = LEAVES_ALL;
  for (int k = 0; k < n; k++) {
    left[k] = cut_by_face(c, &faces[k], u, v, lines[k]);
    most = left[k] > most ? left[k] : most;
    least = left[k] < least ? left[k] : least;
  }
  int result = is_either ? most : least;
  for (int k = 0; k < n && result == LEAVES_SOME; k++)
    if (left[k] == LEAVES_SOME)
      add_line(cut, lines[k]);
  return result;
}

/* The lines of the cut and the splat's own ones. Of more than two the nearest stay, or the own ones, where these are
 * not all joined by AND; returns 0 then. */
static int take_lines(const conic_splats *splats, size_t i, cut_lines *cut, int is_either, conic_clip *clip) {
  size_t at = conic_clip_find(splats, i);
  const conic_clip *own = at < splats->n_clips && splats->clips[at].splat == i ? &splats->clips[at] : NULL;
  int is_or = (cut->n > 1 && is_either) || (own && own->n_lines > 1 && own->operation == CONIC_CLIP_OR);
  if (own && (cut->n == 0 || is_or)) {
    *clip = *own;
    return cut->n == 0;
  }
  for (int k = 0; own && k < own->n_lines; k++)
    add_line(cut, own->lines[k]);
  clip->n_lines = (uint16_t)(cut->n < 2 ? cut->n : 2);
  clip->operation = is_or ? CONIC_CLIP_OR : CONIC_CLIP_AND;
  memcpy(clip->lines, cut->lines, sizeof clip->lines);
  return cut->n <= 2;
}

/* Of a round surface another disc is the nearest where its plane cuts the splat than at the splat's middle: this looks
 * again there. The faces are then those from the middle. */
static int look_where_cut(const cutting *c, const double point[3], const double u[3], const double v[3],
                          face faces[MOST_SIDES]) {
  float line[3];
  double there[3], moved[3];
  if (cut_by_face(c, &faces[0], u, v, line) != LEAVES_SOME)
    return 1;
  double slope2 = (double)line[0] * (double)line[0] + (double)line[1] * (double)line[1];
  for (int axis = 0; axis < 3; axis++) {
    moved[axis] = -(double)line[2] / slope2 * ((double)line[0] * u[axis] + (double)line[1] * v[axis]);
    there[axis] = point[axis] + moved[axis];
  }
  int n = find_faces(c->by, there, c->cutoff, faces);
  for (int k = 0; k < n; k++)
    faces[k].height -= conic_dot(faces[k].normal, moved);
  return n;
}

static int decide_splat(const cutting *c, size_t i) {
  const conic_splats *splats = c->of->splats;
  double point[3], u[3], v[3];
  face faces[MOST_SIDES];
  cut_lines cut = {.n = 0};
  for (int axis = 0; axis < 3; axis++)
    point[axis] = (double)splats->position[axis][i] + c->offset[axis];
  c->of->clips[i] = (conic_clip){.n_lines = 0};
  int n = find_faces(c->by, point, c->cutoff, faces);
  int is_kept = n ? is_inside(faces, n) == c->keeps_inside : !c->keeps_inside;
  int stays = is_kept, is_either = 0;
  axes_of(splats, i, u, v);
  double reach = c->cutoff * fmax(conic_length(u), conic_length(v));
  while (n > 0 && faces[n - 1].distance > reach)
    n--;
  if (n == 1)
    n = look_where_cut(c, point, u, v, faces);
  while (n > 1 && faces[n - 1].distance > reach)
    n--;
  if (n > 0 && !(splats->dot && splats->dot[i] != 0.0f)) {
    is_either = n > 1 && is_convex(&faces[0], &faces[1]) != c->keeps_inside;
    int left = cut_by_faces(c, faces, n, is_either, u, v, &cut);
    stays = left == LEAVES_SOME || (left == LEAVES_ALL && stays);
  }
  int n_cut = cut.n;
  if (stays && !take_lines(splats, i, &cut, is_either, &c->of->clips[i]))
    return is_kept ? CUT_UNCLIPPED : DROPPED;
  return !stays ? DROPPED : n_cut ? CUT : KEPT;
}

static void decide_chunk(void *data, size_t i_item) {
  const cutting *c = data;
  size_t end = (i_item + 1) * CHUNK < c->of->splats->count ? (i_item + 1) * CHUNK : c->of->splats->count;
  for (size_t i = i_item * CHUNK; i < end; i++)
    c->of->fate[i] = (uint8_t)decide_splat(c, i);
}

static conic_status decide(conic_context *context, solid *of, solid *by, double cutoff, int keeps_inside, double from,
                           double to) {
  cutting c = {of, by, cutoff, .keeps_inside = keeps_inside};
  for (int axis = 0; axis < 3; axis++)
    c.offset[axis] = of->splats->origin[axis] - by->splats->origin[axis];
  return conic_parallel_runs(context, "csg", from, to, (of->splats->count + CHUNK - 1) / CHUNK, CHUNKS_A_REPORT,
                             decide_chunk, &c);
}

/* Turns splats over: the two axes change places. */
static void turn_over(conic_splats *splats) {
  for (int axis = 0; axis < 3; axis++) {
    float *u = splats->tangent_u[axis];
    splats->tangent_u[axis] = splats->tangent_v[axis];
    splats->tangent_v[axis] = u;
  }
  for (size_t k = 0; k < splats->n_clips; k++)
    for (int i = 0; i < splats->clips[k].n_lines; i++) {
      float *line = splats->clips[k].lines[i], a = line[0];
      line[0] = line[1];
      line[1] = a;
    }
}

/* The splats that stay, with their lines. */
static conic_status gather_kept(conic_context *context, const solid *s, conic_splats *kept, size_t *n_kept,
                                conic_csg_report *report) {
  size_t n = 0, n_clips = 0, count = s->splats->count;
  uint32_t *sources = conic_memory_allocate(context, count + 1, sizeof *sources);
  conic_clip *clips = conic_memory_allocate(context, count + 1, sizeof *clips);
  conic_status status = sources && clips ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < count && status == CONIC_OK; i++) {
    if (s->fate[i] == DROPPED)
      continue;
    report->n_clipped += s->fate[i] == CUT;
    report->n_unclipped += s->fate[i] == CUT_UNCLIPPED;
    if (s->clips[i].n_lines) {
      clips[n_clips] = s->clips[i];
      clips[n_clips++].splat = (uint32_t)n;
    }
    sources[n++] = (uint32_t)i;
  }
  *n_kept = n;
  if (status == CONIC_OK)
    status = conic_splats_gather(context, s->splats, sources, n, kept);
  if (status == CONIC_OK) {
    kept->clips = clips;
    kept->n_clips = n_clips;
    clips = NULL;
  }
  conic_memory_release_these(context, sources, clips);
  return status;
}

static conic_status prepare_solid(conic_context *context, const conic_splats *given, solid *s) {
  conic_status status = conic_splats_enter(context, "csg", given, &s->close, &s->block);
  if (status != CONIC_OK)
    return status;
  if (!given->tangent_u[0])
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "csg: the splats have no tangent axes");
  s->splats = &s->close;
  s->fate = conic_memory_allocate_zeroed(context, given->count + 1, 1);
  s->clips = conic_memory_allocate(context, given->count + 1, sizeof *s->clips);
  return s->fate && s->clips
             ? conic_neighbours_build(context, (const float *const *)s->close.position, given->count, &s->tree)
             : CONIC_ERROR_MEMORY;
}

static void release_solid(conic_context *context, solid *s) {
  conic_neighbours_release(context, &s->tree);
  conic_memory_release_these(context, s->fate, s->clips, s->block);
}

static conic_status join(conic_context *context, solid solids[2], conic_csg_operation operation, double cutoff,
                         conic_splats *result, conic_csg_report *report) {
  conic_splats more = {0};
  conic_status status = decide(context, &solids[0], &solids[1], cutoff, operation == CONIC_CSG_INTERSECTION, 0.0, 0.5);
  if (status == CONIC_OK)
    status = decide(context, &solids[1], &solids[0], cutoff, operation != CONIC_CSG_UNION, 0.5, 1.0);
  if (status == CONIC_OK)
    status = gather_kept(context, &solids[0], result, &report->n_kept[0], report);
  if (status == CONIC_OK)
    status = gather_kept(context, &solids[1], &more, &report->n_kept[1], report);
  if (status == CONIC_OK && operation == CONIC_CSG_DIFFERENCE)
    turn_over(&more);
  if (status == CONIC_OK)
    status = conic_splats_append(context, result, &more);
  conic_splats_release(context, &more);
  return status;
}

conic_status conic_splats_csg(conic_context *context, const conic_splats *a, const conic_splats *b,
                              conic_csg_operation operation, float cutoff, conic_splats *result,
                              conic_csg_report *report) {
  solid solids[2] = {{0}, {0}};
  conic_csg_report own = {{0}};
  *result = (conic_splats){0};
  if ((unsigned)operation > CONIC_CSG_DIFFERENCE || !(cutoff > 0.0f))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "csg: an unknown operation, or a cutoff that is none");
  conic_status status = prepare_solid(context, a, &solids[0]);
  if (status == CONIC_OK)
    status = prepare_solid(context, b, &solids[1]);
  if (status == CONIC_OK)
    status = join(context, solids, operation, (double)cutoff, result, &own);
  for (int i = 0; i < 2; i++)
    release_solid(context, &solids[i]);
  if (status != CONIC_OK)
    conic_splats_release(context, result);
  if (report)
    *report = own;
  return status;
}
