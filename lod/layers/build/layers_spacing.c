/* The sampling distance of samples that do not fit into memory. A few of them, taken all over, give a guess; a pass
 * over all finds the true neighbours of some of these, which the guess says how far to look for. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/real.h"
#include "lod/layers/build/layers_intake.h"

enum { N_PLACES = 256, N_NEAREST = 8, N_CELLS = 16384, MOST_PASSES = 6 };

#define NO_PLACE UINT32_MAX

/* A place in whose neighbourhood samples are counted. */
typedef struct spacing_place {
  double at[3];
  double nearest2[N_NEAREST + 1]; /* ascending; the first is the place's own sample */
} spacing_place;

typedef struct mark {
  uint32_t place, next;
} mark;

/* Which cells of a grid have a place in or beside them, as chains of marks by the cell's hash. */
typedef struct spacing_search {
  double low[3], edge;
  size_t n_places, n_marks;
  spacing_place places[N_PLACES];
  mark marks[27 * N_PLACES];
  uint32_t first[N_CELLS];
} spacing_search;

static int64_t cell_on(const spacing_search *s, int axis, double position) {
  return (int64_t)floor((position - s->low[axis]) / s->edge);
}

static size_t hash(int64_t x, int64_t y, int64_t z) {
  uint64_t mixed = (uint64_t)x * UINT64_C(0x9e3779b97f4a7c15) ^ (uint64_t)y * UINT64_C(0xc2b2ae3d27d4eb4f) ^
                   (uint64_t)z * UINT64_C(0x165667b19e3779f9);
  return (size_t)((mixed ^ mixed >> 29) * UINT64_C(0xbf58476d1ce4e5b9) >> 50);
}

static void mark_cells(spacing_search *s, uint32_t i_place) {
  const double *at = s->places[i_place].at;
  int64_t cell[3];
  for (int axis = 0; axis < 3; axis++)
    cell[axis] = cell_on(s, axis, at[axis]);
  for (int i = 0; i < 27; i++) {
    uint32_t *first = &s->first[hash(cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1)];
    if (*first != NO_PLACE && s->marks[*first].place == i_place)
      continue; /* two of the cells have one hash */
    s->marks[s->n_marks] = (mark){i_place, *first};
    *first = (uint32_t)s->n_marks++;
  }
}

static void lay_out_marks(const conic_layers_intake *intake, double edge, spacing_search *s) {
  s->edge = edge;
  s->n_marks = 0;
  s->n_places = intake->n_some < N_PLACES ? intake->n_some : N_PLACES;
  memcpy(s->low, intake->low, sizeof s->low);
  memset(s->first, 0xff, sizeof s->first);
  for (size_t i = 0; i < s->n_places; i++) {
    memcpy(s->places[i].at, intake->some[i * intake->n_some / s->n_places], sizeof s->places[i].at);
    for (int k = 0; k <= N_NEAREST; k++)
      s->places[i].nearest2[k] = HUGE_VAL;
    mark_cells(s, (uint32_t)i);
  }
}

static void keep_distance(spacing_place *p, double distance2) {
  int i = N_NEAREST;
  for (; i > 0 && p->nearest2[i - 1] > distance2; i--)
    p->nearest2[i] = p->nearest2[i - 1];
  p->nearest2[i] = distance2;
}

static void look_at_sample(spacing_search *s, const double position[3]) {
  double edge2 = s->edge * s->edge;
  uint32_t i = s->first[hash(cell_on(s, 0, position[0]), cell_on(s, 1, position[1]), cell_on(s, 2, position[2]))];
  for (; i != NO_PLACE; i = s->marks[i].next) {
    spacing_place *p = &s->places[s->marks[i].place];
    double x = position[0] - p->at[0], y = position[1] - p->at[1], z = position[2] - p->at[2];
    double distance2 = x * x + y * y + z * z;
    if (distance2 <= edge2 && distance2 < p->nearest2[N_NEAREST])
      keep_distance(p, distance2);
  }
}

static conic_status look_at_all(const conic_layers_intake *intake, unsigned char *samples, spacing_search *s) {
  uint64_t offset = 0, n_done = 0;
  conic_layers_block block;
  int is_there = 1;
  conic_status status = conic_layers_intake_read(intake, &offset, &block, samples, &is_there);
  while (status == CONIC_OK && is_there) {
    for (size_t i = 0; i < block.count; i++) {
      double position[3];
      for (int axis = 0; axis < 3; axis++)
        position[axis] =
            block.origin[axis] + (double)conic_layers_raw_at(samples, intake->raw_bytes, i)->position[axis];
      look_at_sample(s, position);
    }
    n_done += block.count;
    status = conic_progress(intake->context, "measure", (double)n_done / (double)intake->n_own);
    if (status == CONIC_OK)
      status = conic_layers_intake_read(intake, &offset, &block, samples, &is_there);
  }
  return status;
}

/* What the others of a team have found, too. */
static conic_status unite_places(const conic_layers_intake *intake, spacing_search *s, conic_status status) {
  enum { N = N_NEAREST + 1 };
  const conic_team *team = intake->team;
  double own[N_PLACES][N], *all;
  if (!team)
    return status;
  all = conic_memory_allocate(intake->context, (size_t)team->count, sizeof own);
  status = conic_team_agree(team, status == CONIC_OK && !all ? CONIC_ERROR_MEMORY : status);
  for (size_t i = 0; i < s->n_places; i++)
    memcpy(own[i], s->places[i].nearest2, sizeof own[i]);
  if (status == CONIC_OK)
    conic_team_collect(team, own, s->n_places * sizeof own[0], all);
  for (size_t i = 0; i < (size_t)team->count * s->n_places && status == CONIC_OK; i++)
    for (int k = 0; k < N && (int)(i / s->n_places) != team->index; k++)
      if (all[i * N + (size_t)k] < s->places[i % s->n_places].nearest2[N_NEAREST])
        keep_distance(&s->places[i % s->n_places], all[i * N + (size_t)k]);
  conic_memory_release(intake->context, all);
  return status;
}

/* The lower median over the places that have neighbours enough; 0 where fewer than half have. */
static double median_of_places(const spacing_search *s) {
  double spacings[N_PLACES];
  size_t n = 0;
  for (size_t i = 0; i < s->n_places; i++)
    if (s->places[i].nearest2[N_NEAREST] < HUGE_VAL)
      spacings[n++] = sqrt(3.14159265358979323846 * s->places[i].nearest2[N_NEAREST] / (double)N_NEAREST);
  if (2 * n < s->n_places)
    return 0.0;
  qsort(spacings, n, sizeof *spacings, conic_compare_doubles);
  return spacings[(n - 1) / 2];
}

/* What the spacing of the few says of that of all. */
static conic_status guess_spacing(const conic_layers_intake *intake, double *guess) {
  conic_splats few;
  conic_status status = conic_splats_allocate(intake->context, intake->n_some, 0, &few);
  if (status != CONIC_OK)
    return status;
  memcpy(few.origin, intake->low, sizeof few.origin);
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < intake->n_some; i++)
      few.position[axis][i] = (float)(intake->some[i][axis] - intake->low[axis]);
  status = conic_splats_spacing(intake->context, &few, guess);
  *guess *= sqrt((double)intake->n_some / (double)intake->n_samples);
  conic_splats_release(intake->context, &few);
  return status;
}

conic_status conic_layers_intake_spacing(conic_layers_intake *intake, double *spacing) {
  *spacing = 0.0;
  conic_status status = conic_team_agree(intake->team, guess_spacing(intake, spacing));
  if (status != CONIC_OK || !(*spacing > 0.0) || intake->n_some == intake->n_samples)
    return status; /* the few are all */
  double edge = 6.0 * *spacing, guess = *spacing;
  spacing_search *s = conic_memory_allocate(intake->context, 1, sizeof *s);
  unsigned char *samples = conic_memory_allocate(intake->context, CONIC_LAYERS_BLOCK, intake->raw_bytes);
  status = conic_team_agree(intake->team, s && samples ? CONIC_OK : CONIC_ERROR_MEMORY);
  *spacing = 0.0;
  for (int i = 0; i < MOST_PASSES && status == CONIC_OK && !(*spacing > 0.0); i++, edge *= 3.0) {
    lay_out_marks(intake, edge, s);
    status = unite_places(intake, s, look_at_all(intake, samples, s));
    *spacing = median_of_places(s);
  }
  if (!(*spacing > 0.0))
    *spacing = guess;
  conic_memory_release(intake->context, samples);
  conic_memory_release(intake->context, s);
  return status;
}
