/* Creases among points. A normal from all neighbours is blunt near a crease, where they lie on both sides. So a small
 * plane is fitted at each place, and a point near a crease takes over the flattest plane of a neighbour in which it
 * lies, too. Where the planes of neighbours then meet sharply, both sides are clipped. */

#include "core/base/eigen.h"
#include "core/base/vectors.h"
#include "core/estimate/features.h"
#include "core/estimate/neighbourhood.h"
#include "core/splats/ellipse.h"

/* A small plane is fitted to so many neighbours, which also give the spacing. */
enum { FEW = 9 };
/* A neighbour's plane is flatter than the own one if its roughness is below half of that one's, plus this. */
#define FLATTER 0.01
/* A point lies in a plane if it is nearer to it than this many spacings, or than this many times the plane's own
 * roughness. */
#define IN_PLANE 0.15
#define IN_ROUGH 3.0
/* Splats nearer to a crease than this many spacings must cover everything up to it. */
#define BORDER 2.0
/* Lines within this many times the outline count. */
#define REACH 2.0

/* The roughness of planes that are given. */
#define SIDE_ROUGHNESS 0.1f
#define SAME_SIDE_COSINE 0.8

/* For given planes, this share of the neighbours in a plane may be cut off: noise has moved them over the edge. */
#define LOST_SHARE 0.2

/* A slot's plane: through its position. */
typedef struct slot_plane {
  float normal[3];
  float roughness; /* deviation from the plane over the extent within it */
  float spacing;
  uint8_t is_turned; /* taken over from a neighbour */
} slot_plane;

typedef struct feature_search {
  const conic_splats *splats;
  const conic_neighbourhood *neighbourhood;
  double cosine, cutoff;
  int are_sides; /* the splats' normals are those of their sides */
  slot_plane *small, *final;
  conic_clip *clips; /* by slot, of its point; n_lines 0: none */
} feature_search;

static void normal_of(const slot_plane *plane, double normal[3]) {
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = (double)plane->normal[axis];
}

static void from_to(const feature_search *s, size_t from, size_t to, double d[3]) {
  double start[3];
  conic_neighbourhood_position(s->neighbourhood, from, start);
  conic_neighbourhood_position(s->neighbourhood, to, d);
  for (int axis = 0; axis < 3; axis++)
    d[axis] -= start[axis];
}

static size_t n_few(const feature_search *s) {
  return s->neighbourhood->n_neighbours < FEW ? s->neighbourhood->n_neighbours : FEW;
}

/* The plane of the nearest few neighbours: across the direction in which they and the slot spread least about their
 * mean. */
static void fit_small(const feature_search *s, size_t slot, slot_plane *plane) {
  const uint32_t *list = conic_neighbourhood_of(s->neighbourhood, slot);
  size_t n = n_few(s);
  double mean[3] = {0.0, 0.0, 0.0}, d[FEW][3], matrix[6] = {0.0}, values[3], vectors[3][3];
  for (size_t i = 0; i < n; i++) {
    from_to(s, slot, list[i], d[i]);
    for (int axis = 0; axis < 3; axis++)
      mean[axis] += d[i][axis] / (double)(n + 1);
  }
  for (size_t i = 0; i <= n; i++) {
    double e[3];
    for (int axis = 0; axis < 3; axis++)
      e[axis] = (i < n ? d[i][axis] : 0.0) - mean[axis];
    for (int k = 0, row = 0; row < 3; row++)
      for (int column = row; column < 3; column++, k++)
        matrix[k] += e[row] * e[column];
  }
  conic_eigen3(matrix, values, vectors);
  double least = values[2] > 0.0 ? values[2] : 0.0, rest = values[0] + values[1];
  for (int axis = 0; axis < 3; axis++)
    plane->normal[axis] = (float)vectors[2][axis];
  plane->roughness = rest > 0.0 ? (float)sqrt(least / rest) : 1.0f;
  plane->spacing = n ? (float)sqrt(conic_dot(d[n - 1], d[n - 1]) * 3.14159265358979323846 / (double)(n + 1)) : 0.0f;
  plane->is_turned = 0;
}

static void fit_slots(void *data, size_t begin, size_t end) {
  const feature_search *s = data;
  for (size_t slot = begin; slot < end; slot++)
    fit_small(s, slot, &s->small[slot]);
}

/* How far the place at -d from the plane's slot is from the plane. */
static double height_over(const slot_plane *plane, const double d[3]) {
  double normal[3];
  normal_of(plane, normal);
  return fabs(conic_dot(normal, d));
}

/* Whether that place lies in the plane. */
static int is_in_plane(const slot_plane *plane, const double d[3]) {
  double spacing = (double)plane->spacing;
  double own = IN_PLANE * spacing, rough = IN_ROUGH * (double)plane->roughness * spacing;
  rough = rough < 0.3 * spacing ? rough : 0.3 * spacing;
  return height_over(plane, d) <= (own > rough ? own : rough);
}

/* The roughness of the splat's own plane among all the neighbours. */
static double wide_roughness(const feature_search *s, size_t slot, const double normal[3]) {
  const uint32_t *list = conic_neighbourhood_of(s->neighbourhood, slot);
  double across = 0.0, all = 0.0;
  for (size_t i = 0; i < s->neighbourhood->n_neighbours; i++) {
    double d[3];
    from_to(s, slot, list[i], d);
    across += conic_dot(normal, d) * conic_dot(normal, d);
    all += conic_dot(d, d);
  }
  return all > 0.0 ? sqrt(across / all) : 0.0;
}

/* The plane across the mean normal of the neighbours whose normals put them on the slot's side. */
static void average_side(const feature_search *s, size_t slot, slot_plane *plane) {
  const uint32_t *list = conic_neighbourhood_of(s->neighbourhood, slot);
  const float *own = s->neighbourhood->normals[slot];
  double sum[3] = {(double)own[0], (double)own[1], (double)own[2]};
  for (size_t i = 0; i < s->neighbourhood->n_neighbours; i++) {
    const float *other = s->neighbourhood->normals[list[i]];
    float along = own[0] * other[0] + own[1] * other[1] + own[2] * other[2];
    for (int axis = 0; axis < 3 && fabs((double)along) >= SAME_SIDE_COSINE; axis++)
      sum[axis] += along < 0.0f ? -(double)other[axis] : (double)other[axis];
  }
  conic_normalize(sum);
  for (int axis = 0; axis < 3; axis++)
    plane->normal[axis] = (float)sum[axis];
  plane->roughness = SIDE_ROUGHNESS;
}

/* The plane in which a slot's splat will lie: that of its axes, where it is flat; else the flattest near it. */
static void choose_plane(const feature_search *s, size_t slot, slot_plane *plane) {
  const uint32_t *list = conic_neighbourhood_of(s->neighbourhood, slot);
  const slot_plane *flattest = &s->small[slot];
  const float *outward = s->neighbourhood->normals[slot]; /* where the surface is flat, the splat's own normal is
                                                             reliable */
  double own[3], best[3], least = (double)flattest->roughness;
  *plane = s->small[slot];
  for (int axis = 0; axis < 3; axis++)
    own[axis] = (double)s->neighbourhood->normals[slot][axis];
  if (s->are_sides) {
    average_side(s, slot, plane);
    return;
  }
  for (size_t i = 0; i < s->neighbourhood->n_neighbours; i++) {
    double d[3];
    from_to(s, slot, list[i], d);
    const slot_plane *other = &s->small[list[i]];
    double misfit = (double)other->roughness + height_over(other, d) / (double)other->spacing;
    if (!(misfit < least) || !is_in_plane(other, d))
      continue;
    least = misfit;
    flattest = other;
    outward = s->neighbourhood->normals[list[i]];
  }
  double narrow = (double)s->small[slot].roughness, wide = wide_roughness(s, slot, own);
  if ((narrow > wide ? narrow : wide) > 2.0 * (double)flattest->roughness + FLATTER) {
    memcpy(plane->normal, flattest->normal, sizeof plane->normal);
    plane->roughness = flattest->roughness;
    plane->is_turned = 1;
  } else if (conic_dot(own, own) > 0.0)
    memcpy(plane->normal, s->neighbourhood->normals[slot], sizeof plane->normal);
  normal_of(plane, best);
  if (best[0] * (double)outward[0] + best[1] * (double)outward[1] + best[2] * (double)outward[2] < 0.0)
    for (int axis = 0; axis < 3; axis++)
      plane->normal[axis] = -plane->normal[axis];
}

static void choose_planes(void *data, size_t begin, size_t end) {
  const feature_search *s = data;
  for (size_t slot = begin; slot < end; slot++)
    choose_plane(s, slot, &s->final[slot]);
}

/* A slot's splat in hand. */
typedef struct slot_splat {
  size_t slot, point;
  double normal[3], u[3], v[3]; /* u and v are unit */
  double spacing, radius;       /* of the outline */
  size_t n_places;              /* half way to the neighbours in the same plane */
  double places[CONIC_MAX_NEIGHBOURS][2];
  double middle[2]; /* of the places: tells the splat's own side if it lies on a crease */
} slot_splat;

static double axis_length(float *const axes[3], size_t i) {
  double squared = 0.0;
  for (int axis = 0; axis < 3; axis++)
    squared += (double)axes[axis][i] * (double)axes[axis][i];
  return sqrt(squared);
}

static slot_splat place_of_slot(const feature_search *s, size_t slot) {
  slot_splat p = {.slot = slot, .point = s->neighbourhood->tree.point_of_slot[slot]};
  double greater = axis_length(s->splats->tangent_u, p.point), lesser = axis_length(s->splats->tangent_v, p.point);
  normal_of(&s->final[slot], p.normal);
  conic_tangent_basis(p.normal, p.u, p.v);
  p.spacing = (double)s->final[slot].spacing;
  p.radius = s->cutoff * (greater > lesser ? greater : lesser);
  return p;
}

/* The line where the neighbour's plane meets the slot's; it keeps the slot's own side. In units of the unit axes. */
static int meet(const feature_search *s, const slot_splat *p, size_t mate, double line[3]) {
  double normal[3], d[3];
  normal_of(&s->final[mate], normal);
  from_to(s, mate, p->slot, d);
  if (fabs(conic_dot(normal, p->normal)) >= s->cosine)
    return 0;
  line[0] = conic_dot(normal, p->u);
  line[1] = conic_dot(normal, p->v);
  line[2] = conic_dot(normal, d);
  if (line[0] * p->middle[0] + line[1] * p->middle[1] + line[2] < 0.0)
    for (int i = 0; i < 3; i++)
      line[i] = -line[i];
  double length = sqrt(line[0] * line[0] + line[1] * line[1]);
  for (int i = 0; i < 3; i++)
    line[i] /= length;
  /* Both sides overlap by as much as the planes may be off. */
  line[2] += 0.5 * p->spacing * ((double)s->final[mate].roughness + (double)s->final[p->slot].roughness);
  return length > 0.0;
}

/* Notes the creases with the neighbours' planes; returns the distance of the nearest, or infinity. Only flat planes
 * count: blunt ones say nothing. */
static double find_lines(const feature_search *s, const slot_splat *p, double reach, conic_clip_choice *choice) {
  const uint32_t *list = conic_neighbourhood_of(s->neighbourhood, p->slot);
  double nearest = HUGE_VAL;
  for (size_t i = 0; i < s->neighbourhood->n_neighbours; i++) {
    double line[3], d[3];
    from_to(s, p->slot, list[i], d);
    if (s->final[list[i]].roughness > 0.25f || !meet(s, p, list[i], line) || fabs(line[2]) > conic_length(d))
      continue;
    nearest = line[2] < nearest ? line[2] : nearest;
    conic_clip_choice_add(choice, line, reach);
  }
  return nearest;
}

/* The neighbours in the same plane: a crease leaves them whole. */
static void find_slot_places(const feature_search *s, slot_splat *p) {
  const uint32_t *list = conic_neighbourhood_of(s->neighbourhood, p->slot);
  p->n_places = 0;
  for (size_t i = 0; i < s->neighbourhood->n_neighbours; i++) {
    double d[3], normal[3];
    from_to(s, p->slot, list[i], d);
    normal_of(&s->final[list[i]], normal);
    if (fabs(conic_dot(normal, p->normal)) < s->cosine || !is_in_plane(&s->final[p->slot], d) ||
        conic_dot(d, d) > 6.25 * p->spacing * p->spacing)
      continue;
    double *at = p->places[p->n_places++];
    at[0] = 0.5 * conic_dot(d, p->u);
    at[1] = 0.5 * conic_dot(d, p->v);
    for (int k = 0; k < 2; k++)
      p->middle[k] += at[k] / (double)s->neighbourhood->n_neighbours;
  }
}

/* Makes the splat a circle in its plane, with its lines in units of the circle's axes. */
static void write_circle(const feature_search *s, const slot_splat *p, double radius) {
  double sigma = radius / s->cutoff;
  for (int axis = 0; axis < 3; axis++) {
    s->splats->tangent_u[axis][p->point] = (float)(sigma * p->u[axis]);
    s->splats->tangent_v[axis][p->point] = (float)(sigma * p->v[axis]);
  }
}

/* Lines in units of unit axes become lines in units of the splat's. */
static void scale_lines(const feature_search *s, const slot_splat *p, conic_clip *clip) {
  for (int i = 0; i < clip->n_lines; i++) {
    double a = (double)clip->lines[i][0], b = (double)clip->lines[i][1], scaled[2] = {0.0, 0.0};
    for (int axis = 0; axis < 3; axis++) {
      double along = a * p->u[axis] + b * p->v[axis];
      scaled[0] += along * (double)s->splats->tangent_u[axis][p->point];
      scaled[1] += along * (double)s->splats->tangent_v[axis][p->point];
    }
    clip->lines[i][0] = (float)scaled[0];
    clip->lines[i][1] = (float)scaled[1];
  }
}

static void clip_slot(const feature_search *s, size_t slot) {
  slot_splat p = place_of_slot(s, slot);
  conic_clip_choice choice = {.n = 0, .lost_share = s->are_sides ? LOST_SHARE : 0.0};
  conic_clip *clip = &s->clips[slot];
  *clip = (conic_clip){.splat = (uint32_t)p.point};
  if (!(p.radius > 0.0) || !(p.radius * 0.0 == 0.0)) /* not a splat */
    return;
  double reach = REACH * p.radius, border = BORDER * p.spacing;
  find_slot_places(s, &p);
  double nearest = find_lines(s, &p, reach > border ? reach : border, &choice);
  int is_clipped = conic_clip_choose(&choice, (const double(*)[2])p.places, p.n_places, 0.2, clip);
  if (!is_clipped)
    clip->n_lines = 0;
  double radius = p.radius;
  if (is_clipped && nearest < border) {
    double least = sqrt(nearest * nearest + 1.5 * p.spacing * p.spacing);
    radius = radius > least ? radius : least;
  }
  int is_near_crease = nearest < HUGE_VAL; /* else noise or a slight bend turned it, and it stays as it was */
  if ((s->final[slot].is_turned && is_near_crease) || radius > p.radius)
    write_circle(s, &p, radius);
  scale_lines(s, &p, clip);
}

static void clip_slots(void *data, size_t begin, size_t end) {
  const feature_search *s = data;
  for (size_t slot = begin; slot < end; slot++)
    clip_slot(s, slot);
}

/* Sets the slots' normals to those of their splats. */
static void set_normals(const conic_splats *splats, conic_neighbourhood *neighbourhood) {
  for (size_t slot = 0; slot < neighbourhood->tree.n_slots; slot++) {
    size_t i = neighbourhood->tree.point_of_slot[slot];
    double u[3], v[3], n[3];
    conic_vector_at(splats->tangent_u, i, u);
    conic_vector_at(splats->tangent_v, i, v);
    conic_cross(u, v, n);
    conic_normalize(n);
    neighbourhood->flags[slot] |= CONIC_SLOT_WANTED;
    for (int axis = 0; axis < 3; axis++)
      neighbourhood->normals[slot][axis] = (float)n[axis];
  }
}

/* A point at the place of an earlier one becomes like that one where it has become sharp. Returns its slot, or
 * CONIC_NO_SLOT where it has no clip lines. */
static size_t follow_slot(const feature_search *s, size_t point) {
  const conic_neighbours *tree = &s->neighbourhood->tree;
  size_t slot = tree->slot_of_point[point];
  if (slot == CONIC_NO_SLOT || (!s->clips[slot].n_lines && !s->final[slot].is_turned))
    return CONIC_NO_SLOT;
  for (int axis = 0; axis < 3; axis++) {
    s->splats->tangent_u[axis][point] = s->splats->tangent_u[axis][tree->point_of_slot[slot]];
    s->splats->tangent_v[axis][point] = s->splats->tangent_v[axis][tree->point_of_slot[slot]];
  }
  return s->clips[slot].n_lines ? slot : CONIC_NO_SLOT;
}

/* Slots have the tree's order, records the splats'. */
static conic_status hand_over_slots(conic_context *context, const feature_search *s, conic_splats *splats) {
  size_t n = 0;
  for (size_t i = 0; i < splats->count; i++)
    n += follow_slot(s, i) != CONIC_NO_SLOT;
  if (n == 0)
    return CONIC_OK;
  conic_clip *clips = conic_memory_allocate(context, n, sizeof *clips);
  if (!clips)
    return CONIC_ERROR_MEMORY;
  n = 0;
  for (size_t i = 0; i < splats->count; i++) {
    size_t slot = follow_slot(s, i);
    if (slot == CONIC_NO_SLOT)
      continue;
    clips[n] = s->clips[slot];
    clips[n++].splat = (uint32_t)i;
  }
  conic_memory_release(context, splats->clips);
  splats->clips = clips;
  splats->n_clips = n;
  return CONIC_OK;
}

static conic_status run_passes(conic_context *context, feature_search *s, conic_neighbourhood *neighbourhood,
                               conic_splats *splats) {
  size_t n = neighbourhood->tree.n_slots;
  s->neighbourhood = neighbourhood;
  conic_status status =
      conic_memory_allocate_these(context, CONIC_ROOM(s->small, n), CONIC_ROOM(s->final, n), CONIC_ROOM(s->clips, n));
  if (status == CONIC_OK)
    status = conic_neighbourhood_list(context, neighbourhood, CONIC_SLOT_WANTED, 0.0, 0.6);
  if (status == CONIC_OK)
    status = conic_slots_for(context, n, fit_slots, s, 0.6, 0.8);
  /* Twice, so that a flat plane also reaches a tip where three faces meet, from beyond the nearest neighbours. */
  for (int pass = 0; status == CONIC_OK && pass < 2; pass++) {
    slot_plane *chosen = s->final;
    s->final = pass ? s->small : s->final;
    s->small = pass ? chosen : s->small;
    status = conic_slots_for(context, n, choose_planes, s, 0.8 + 0.05 * pass, 0.85 + 0.05 * pass);
  }
  if (status == CONIC_OK)
    status = conic_slots_for(context, n, clip_slots, s, 0.9, 1.0);
  if (status == CONIC_OK)
    status = hand_over_slots(context, s, splats);
  conic_memory_release_these(context, s->small, s->final, s->clips);
  return status;
}

conic_status conic_features_in_points(conic_context *context, double cosine, int are_sides,
                                      const conic_estimate_options *options, conic_splats *splats) {
  const float *const positions[3] = {splats->position[0], splats->position[1], splats->position[2]};
  conic_neighbourhood neighbourhood;
  feature_search s = {.splats = splats, .cosine = cosine, .are_sides = are_sides, .cutoff = (double)options->cutoff};
  conic_status status =
      conic_neighbourhood_create(context, positions, splats->count, (size_t)options->n_neighbours, &neighbourhood);
  if (status != CONIC_OK)
    return status;
  set_normals(splats, &neighbourhood);
  status = run_passes(context, &s, &neighbourhood, splats);
  conic_neighbourhood_release(context, &neighbourhood);
  return status;
}
