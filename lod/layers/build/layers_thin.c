#include "lod/layers/build/layers_thin.h"

#include "core/base/random.h"
#include "lod/layers/format/layers_key.h"

typedef struct point {
  float x, y, z;
} point;

/* A point that was chosen, in its cell's chain. */
typedef struct chosen_point {
  point at;
  uint32_t next;
} chosen_point;

/* A cell of the grid that holds points. */
typedef struct cell {
  uint64_t place; /* its number on each axis; NO_PLACE: free */
  uint32_t first; /* of its points, which are chained by `next` */
} cell;

#define NO_PLACE UINT64_MAX
#define NO_POINT UINT32_MAX

struct conic_thinner {
  size_t n, most_points;
  point *points;   /* loaded */
  uint32_t *order; /* in which they are looked at */
  size_t n_ordered;
  size_t n_chosen;
  uint32_t *chosen;    /* which, and */
  uint32_t *number;    /* of a point that is chosen, how many before it are */
  chosen_point *links; /* where */
  size_t n_cells;      /* a power of two, over twice the chosen */
  cell *cells;
  float edge, cells_a_step;
};

/* A power of two, at least twice as many. */
static size_t cells_for(size_t n_points) {
  size_t n_cells = 64;
  while (n_cells < 2 * n_points)
    n_cells *= 2;
  return n_cells;
}

size_t conic_thinner_bytes(size_t most_points) {
  return most_points * (sizeof(point) + 3 * sizeof(uint32_t) + sizeof(chosen_point)) +
         cells_for(most_points) * sizeof(cell);
}

conic_status conic_thinner_create(conic_context *context, size_t most_points, conic_thinner **thinner) {
  size_t n_cells = cells_for(most_points);
  *thinner = NULL;
  conic_thinner *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->most_points = most_points;
  if (conic_memory_allocate_these(context, CONIC_ROOM(made->points, most_points), CONIC_ROOM(made->order, most_points),
                                  CONIC_ROOM(made->chosen, most_points), CONIC_ROOM(made->number, most_points),
                                  CONIC_ROOM(made->links, most_points), CONIC_ROOM(made->cells, n_cells)) == CONIC_OK) {
    *thinner = made;
    return CONIC_OK;
  }
  conic_thinner_destroy(context, made);
  return CONIC_ERROR_MEMORY;
}

void conic_thinner_destroy(conic_context *context, conic_thinner *thinner) {
  if (!thinner)
    return;
  void *const owned[] = {thinner->points, thinner->order, thinner->chosen,
                         thinner->number, thinner->links, thinner->cells};
  conic_memory_release_all(context, owned, sizeof owned / sizeof *owned);
  conic_memory_release(context, thinner);
}

static point point_of(uint64_t key) {
  return (point){(float)conic_layers_step(key, 0), (float)conic_layers_step(key, 1), (float)conic_layers_step(key, 2)};
}

/* Looking at them in a random order leaves no pattern; the order is that of their number, so always the same. */
static void shuffle(conic_thinner *thinner) {
  uint32_t *order = thinner->order;
  if (thinner->n_ordered == thinner->n)
    return;
  for (uint32_t i = 0; i < thinner->n; i++) {
    uint32_t k = (uint32_t)((conic_random_mix(i) >> 32) * (uint64_t)(i + 1) >> 32);
    order[i] = i;
    order[i] = order[k];
    order[k] = i;
  }
  thinner->n_ordered = thinner->n;
}

void conic_thinner_load(conic_thinner *thinner, const uint64_t *keys, size_t stride_bytes, size_t n) {
  const unsigned char *at = (const unsigned char *)keys;
  thinner->n = n;
  for (size_t i = 0; i < n; i++, at += stride_bytes) {
    uint64_t key;
    memcpy(&key, at, sizeof key);
    thinner->points[i] = point_of(key);
  }
  shuffle(thinner);
}

/* Cells are twice the distance wide and a hair, so that what is within the distance of a point lies in the eight cells
 * whose common corner is nearest to it. */
static void clear(conic_thinner *thinner, double distance, size_t n_points) {
  thinner->n_cells = cells_for(n_points);
  thinner->n_chosen = 0;
  thinner->edge = (float)((distance > 1.0 ? 2.0 * distance : 2.0) * (1.0 + 1e-4));
  thinner->cells_a_step = 1.0f / thinner->edge;
  memset(thinner->cells, 0xff, thinner->n_cells * sizeof *thinner->cells);
}

static uint64_t place_of_cell(int32_t x, int32_t y, int32_t z) {
  return (uint64_t)(uint32_t)(x + 1) << 42 | (uint64_t)(uint32_t)(y + 1) << 21 | (uint64_t)(uint32_t)(z + 1);
}

/* The cell of a place, or the free one that would be it. */
static cell *find_cell(const conic_thinner *thinner, uint64_t place) {
  size_t mask = thinner->n_cells - 1, i = (size_t)(place * UINT64_C(0x9e3779b97f4a7c15) >> 32) & mask;
  while (thinner->cells[i].place != place && thinner->cells[i].place != NO_PLACE)
    i = (i + 1) & mask;
  return &thinner->cells[i];
}

static float squared_distance(point a, point b) {
  float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return x * x + y * y + z * z;
}

/* The least squared distance to a point of the cell, *nearest, if it is below `nearest2`; else that. The first that is
 * not above `enough2` will do. */
static float look_into(const conic_thinner *thinner, uint64_t place, point at, float enough2, float nearest2,
                       point *nearest) {
  const cell *found = find_cell(thinner, place);
  if (found->place == NO_PLACE)
    return nearest2;
  for (uint32_t i = found->first; i != NO_POINT && !(nearest2 <= enough2); i = thinner->links[i].next) {
    float distance2 = squared_distance(at, thinner->links[i].at);
    if (distance2 < nearest2) {
      nearest2 = distance2;
      *nearest = thinner->links[i].at;
    }
  }
  return nearest2;
}

typedef struct octant {
  int32_t cell[3], side[3]; /* the point's own cell, and on which side of it the nearer ones are */
} octant;

static octant octant_of(const conic_thinner *thinner, point at) {
  const float coordinates[3] = {at.x, at.y, at.z};
  octant o;
  for (int axis = 0; axis < 3; axis++) {
    float scaled = coordinates[axis] * thinner->cells_a_step;
    o.cell[axis] = (int32_t)scaled;
    o.side[axis] = scaled - (float)o.cell[axis] < 0.5f ? -1 : 1;
  }
  return o;
}

/* The square of the distance to the nearest chosen point, if that is within half a cell; else some value that is more.
 * Stops at what is near enough. */
static float nearest_within_cells(const conic_thinner *thinner, point at, float enough2, point *nearest) {
  float nearest2 = HUGE_VALF;
  octant o = octant_of(thinner, at);
  for (int i = 0; i < 8 && !(nearest2 <= enough2); i++)
    nearest2 = look_into(thinner,
                         place_of_cell(o.cell[0] + (i & 1 ? o.side[0] : 0), o.cell[1] + (i & 2 ? o.side[1] : 0),
                                       o.cell[2] + (i & 4 ? o.side[2] : 0)),
                         at, enough2, nearest2, nearest);
  return nearest2;
}

static void insert(conic_thinner *thinner, uint32_t i_point) {
  octant o = octant_of(thinner, thinner->points[i_point]);
  uint64_t place = place_of_cell(o.cell[0], o.cell[1], o.cell[2]);
  cell *found = find_cell(thinner, place);
  uint32_t i = (uint32_t)thinner->n_chosen++;
  thinner->chosen[i] = i_point;
  thinner->links[i] = (chosen_point){thinner->points[i_point], found->place == place ? found->first : NO_POINT};
  found->place = place;
  found->first = i;
}

/* Fills the grid with points at least `distance` apart, until there are no more or `most` are exceeded. */
static size_t throw_darts(conic_thinner *thinner, double distance, size_t most) {
  float below2 = (float)(distance * distance);
  float enough2 = nextafterf(below2, 0.0f); /* nearer than the distance */
  point nearest;
  clear(thinner, distance, most + 1 < thinner->n ? most + 1 : thinner->n);
  for (size_t i = 0; i < thinner->n && thinner->n_chosen <= most; i++) {
    uint32_t i_point = thinner->order[i];
    if (!(nearest_within_cells(thinner, thinner->points[i_point], enough2, &nearest) < below2))
      insert(thinner, i_point);
  }
  return thinner->n_chosen;
}

/* Off by this fraction is near enough; so often it is tried. */
enum { NEAR_ENOUGH = 8, MOST_TRIES = 8 };

static size_t off_by(size_t n, size_t target) {
  return n > target ? n - target : target - n;
}

/* On a surface the number goes as the inverse square of the distance. What was tried brackets what is sought. */
static double next_distance(double distance, size_t n, size_t target, double *low, double *high) {
  double guess = distance * sqrt((double)n / (double)target);
  if (n > target && distance > *low)
    *low = distance;
  if (n < target && (*high == 0.0 || distance < *high))
    *high = distance;
  if (*high > 0.0 && !(guess > *low && guess < *high))
    guess = 0.5 * (*low + *high);
  return guess;
}

size_t conic_thinner_choose(conic_thinner *thinner, size_t target, size_t most, double *distance, uint8_t *is_chosen) {
  double at = *distance > 1.0 ? *distance : 1.0, best = 0.0, low = 0.0, high = 0.0;
  size_t n = 0, n_best = 0;
  for (int i = 0; i < MOST_TRIES; i++) {
    n = throw_darts(thinner, at, most);
    if (n <= most && (best == 0.0 || off_by(n, target) < off_by(n_best, target))) {
      best = at;
      n_best = n;
    }
    if (n <= most && off_by(n, target) * NEAR_ENOUGH <= target)
      break;
    double next = next_distance(at, n, target, &low, &high);
    if (!(fabs(next - at) > 1e-3 * at))
      break;
    at = next;
  }
  for (; best == 0.0; at *= 2.0) { /* many that coincide nearly */
    n = throw_darts(thinner, at, most);
    best = n <= most ? at : 0.0;
  }
  if (at != best || n > most)
    n = throw_darts(thinner, best, most);
  memset(is_chosen, 0, thinner->n);
  for (size_t i = 0; i < n; i++)
    is_chosen[thinner->chosen[i]] = 1;
  for (size_t i = 0, k = 0; i < thinner->n; i++)
    if (is_chosen[i])
      thinner->number[i] = (uint32_t)k++;
  *distance = best;
  return n;
}

/* Past the near cells all are looked at: that is seldom. */
static float nearest_of_all(const conic_thinner *thinner, point at) {
  float nearest2 = HUGE_VALF;
  for (size_t i = 0; i < thinner->n_chosen; i++) {
    float distance2 = squared_distance(at, thinner->links[i].at);
    nearest2 = distance2 < nearest2 ? distance2 : nearest2;
  }
  return nearest2;
}

double conic_thinner_reach(const conic_thinner *thinner, const uint64_t *keys, size_t n, double beyond, double reach) {
  point last = thinner->links[0].at; /* that was near; points that follow each other lie together */
  float half_edge = 0.5f * thinner->edge, near2 = half_edge * half_edge * (1.0f - 1e-4f);
  for (size_t i = 0; i < n; i++) {
    point at = point_of(keys[i]);
    double enough = (reach - beyond) * (1.0 - 1e-6); /* surely so, rounded as it may be */
    float enough2 = enough > 0.0 ? (float)(enough * enough) : 0.0f;
    if (squared_distance(at, last) <= enough2)
      continue;
    float nearest2 = nearest_within_cells(thinner, at, enough2, &last);
    if (nearest2 <= enough2)
      continue;
    if (nearest2 > near2)
      nearest2 = nearest_of_all(thinner, at);
    double found = sqrt((double)nearest2) + beyond;
    reach = found > reach ? found : reach;
  }
  return reach;
}

size_t conic_thinner_beside(const conic_thinner *thinner, const float at[3], int is_wide, uint32_t *list, size_t most) {
  octant o = octant_of(thinner, (point){at[0], at[1], at[2]});
  size_t n = 0;
  for (int i = 0; i < (is_wide ? 27 : 8); i++) {
    const int near[3] = {i & 1 ? o.side[0] : 0, i & 2 ? o.side[1] : 0, i & 4 ? o.side[2] : 0};
    const int all[3] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    const int *step = is_wide ? all : near;
    const cell *found =
        find_cell(thinner, place_of_cell(o.cell[0] + step[0], o.cell[1] + step[1], o.cell[2] + step[2]));
    for (uint32_t k = found->place == NO_PLACE ? NO_POINT : found->first; k != NO_POINT && n < most;
         k = thinner->links[k].next)
      list[n++] = k;
  }
  return n;
}

size_t conic_thinner_numbers(const conic_thinner *thinner, uint32_t *numbers) {
  for (size_t i = 0; i < thinner->n_chosen; i++)
    numbers[i] = thinner->number[thinner->chosen[i]];
  return thinner->n_chosen;
}
