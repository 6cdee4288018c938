/* The sampling distance of samples that do not fit into memory. A few of them, taken all over, give a guess of it. The
 * guess says how far to look for the neighbours of some of the few, and a pass over all samples finds these. */

#include "lod/layers/build/layers_raws.h"

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

static void lay_out_marks(const conic_layers_raws *raws, double edge, spacing_search *s) {
  s->edge = edge;
  s->n_marks = 0;
  s->n_places = raws->n_some < N_PLACES ? raws->n_some : N_PLACES;
  memcpy(s->low, raws->payload.facts.low, sizeof s->low);
  memset(s->first, 0xff, sizeof s->first);
  for (size_t i = 0; i < s->n_places; i++) {
    memcpy(s->places[i].at, raws->some[i * raws->n_some / s->n_places], sizeof s->places[i].at);
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

typedef struct looking {
  const conic_layers_raws *raws;
  spacing_search *search;
} looking;

static conic_status look_at_block(void *data, const conic_layers_block *block, const unsigned char *samples) {
  const looking *l = data;
  for (size_t i = 0; i < block->count; i++) {
    const conic_layers_raw *raw = conic_layers_raw_at(samples, l->raws->raw_bytes, i);
    double position[3];
    for (int axis = 0; axis < 3; axis++)
      position[axis] = block->origin[axis] + (double)raw->position[axis];
    look_at_sample(l->search, position);
  }
  return CONIC_OK;
}

/* Adds what the others of a team have found. */
static conic_status combine_places(const conic_layers_raws *raws, spacing_search *s, conic_status status) {
  enum { N = N_NEAREST + 1 };
  const conic_team *team = raws->team;
  double own[N_PLACES][N], *all;
  if (!team)
    return status;
  all = conic_memory_allocate(raws->context, (size_t)team->count, sizeof own);
  status = conic_team_agree(team, status == CONIC_OK && !all ? CONIC_ERROR_MEMORY : status);
  for (size_t i = 0; i < s->n_places; i++)
    memcpy(own[i], s->places[i].nearest2, sizeof own[i]);
  if (status == CONIC_OK)
    conic_team_collect(team, own, s->n_places * sizeof own[0], all);
  for (size_t i = 0; i < (size_t)team->count * s->n_places && status == CONIC_OK; i++)
    for (int k = 0; k < N && (int)(i / s->n_places) != team->index; k++)
      if (all[i * N + (size_t)k] < s->places[i % s->n_places].nearest2[N_NEAREST])
        keep_distance(&s->places[i % s->n_places], all[i * N + (size_t)k]);
  conic_memory_release(raws->context, all);
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

/* Guesses the spacing of all samples from that of the few. */
static conic_status guess_spacing(const conic_layers_raws *raws, double *guess) {
  const conic_layers_facts *facts = &raws->payload.facts;
  conic_splats few;
  conic_status status = conic_splats_allocate(raws->context, raws->n_some, 0, &few);
  if (status != CONIC_OK)
    return status;
  memcpy(few.origin, facts->low, sizeof few.origin);
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < raws->n_some; i++)
      few.position[axis][i] = (float)(raws->some[i][axis] - facts->low[axis]);
  status = conic_splats_spacing(raws->context, &few, guess);
  *guess *= sqrt((double)raws->n_some / (double)facts->n_samples);
  conic_splats_release(raws->context, &few);
  return status;
}

conic_status conic_layers_raws_spacing(conic_layers_raws *raws, double *spacing) {
  *spacing = 0.0;
  conic_status status = conic_team_agree(raws->team, guess_spacing(raws, spacing));
  if (status != CONIC_OK || !(*spacing > 0.0) || raws->n_some == raws->payload.facts.n_samples)
    return status; /* the few are all */
  double edge = 6.0 * *spacing, guess = *spacing;
  spacing_search *s = conic_memory_allocate(raws->context, 1, sizeof *s);
  looking all = {raws, s};
  status = conic_team_agree(raws->team, s ? CONIC_OK : CONIC_ERROR_MEMORY);
  *spacing = 0.0;
  for (int i = 0; i < MOST_PASSES && status == CONIC_OK && !(*spacing > 0.0); i++, edge *= 3.0) {
    lay_out_marks(raws, edge, s);
    status = combine_places(raws, s, conic_layers_raws_visit(raws, "measure", look_at_block, &all));
    *spacing = median_of_places(s);
  }
  if (!(*spacing > 0.0))
    *spacing = guess;
  conic_memory_release(raws->context, s);
  return status;
}
