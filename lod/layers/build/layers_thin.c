#include "lod/layers/build/layers_thin.h"

#include "core/base/random.h"
#include "core/lanes/lanes.h"
#include "lod/layers/format/layers_key.h"

typedef struct point {
  float x, y, z;
} point;

/* A point that was chosen, in its cell's chain. */
typedef struct chosen_point {
  point at;
  uint32_t next;
} chosen_point;

#define NO_POINT UINT32_MAX

struct conic_thinner {
  size_t n, most_points;
  point *points; /* loaded */
  float low[3], high[3];
  uint32_t *order; /* in which they are looked at */
  size_t n_ordered;
  size_t n_chosen;
  uint32_t *chosen;    /* which, and */
  uint32_t *number;    /* of a point that is chosen, how many before it are */
  chosen_point *links; /* where */
  size_t n_cells;
  uint32_t *cells;   /* of each, the first of its chain; once all are chosen, how many come before it */
  uint32_t first;    /* in that order, the one chosen first */
  uint32_t *by_cell; /* the chosen, cell by cell, and where they are; a few more can be read */
  float *at[3];
  float edge, cells_a_step;
  int shift; /* 2^shift cells on each axis share a place in `cells` where there are too many of them */
  int32_t first_cell[3], cells_on[3];
};

/* A surface of n points meets some n of the (n/3)^1.5 cells around it. */
static size_t cells_for(size_t n_points) {
  return 12 * n_points + 64;
}

size_t conic_thinner_bytes(size_t most_points) {
  return most_points * (2 * sizeof(point) + 4 * sizeof(uint32_t) + sizeof(chosen_point)) +
         cells_for(most_points) * sizeof(uint32_t);
}

conic_status conic_thinner_create(conic_context *context, size_t most_points, conic_thinner **thinner) {
  size_t n_cells = cells_for(most_points), n_read = most_points + CONIC_LANES;
  *thinner = NULL;
  conic_thinner *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->most_points = most_points;
  made->n_cells = n_cells;
  if (conic_memory_allocate_these(context, CONIC_ROOM(made->points, most_points), CONIC_ROOM(made->order, most_points),
                                  CONIC_ROOM(made->chosen, most_points), CONIC_ROOM(made->number, most_points),
                                  CONIC_ROOM(made->links, most_points), CONIC_ROOM(made->cells, n_cells + 1),
                                  CONIC_ROOM(made->by_cell, most_points), CONIC_ZEROED(made->at[0], n_read),
                                  CONIC_ZEROED(made->at[1], n_read), CONIC_ZEROED(made->at[2], n_read)) == CONIC_OK) {
    *thinner = made;
    return CONIC_OK;
  }
  conic_thinner_destroy(context, made);
  return CONIC_ERROR_MEMORY;
}

void conic_thinner_destroy(conic_context *context, conic_thinner *thinner) {
  if (!thinner)
    return;
  conic_memory_release_these(context, thinner->points, thinner->order, thinner->chosen, thinner->number, thinner->links,
                             thinner->cells, thinner->by_cell, thinner->at[0], thinner->at[1], thinner->at[2], thinner);
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
  for (int axis = 0; axis < 3; axis++) {
    thinner->low[axis] = HUGE_VALF;
    thinner->high[axis] = 0.0f;
  }
  for (size_t i = 0; i < n; i++, at += stride_bytes) {
    uint64_t key;
    memcpy(&key, at, sizeof key);
    const point p = point_of(key);
    thinner->points[i] = p;
    const float on_axis[3] = {p.x, p.y, p.z};
    for (int axis = 0; axis < 3; axis++) {
      thinner->low[axis] = on_axis[axis] < thinner->low[axis] ? on_axis[axis] : thinner->low[axis];
      thinner->high[axis] = on_axis[axis] > thinner->high[axis] ? on_axis[axis] : thinner->high[axis];
    }
  }
  shuffle(thinner);
}

/* On an axis; the first is 1, so that there is one before it. */
static int32_t cell_of(const conic_thinner *thinner, float coordinate) {
  return (int32_t)(coordinate * thinner->cells_a_step) + 1;
}

/* Cells are twice the distance wide and a hair, so that what is within the distance of a point lies in the eight cells
 * whose common corner is nearest to it. The grid has those of all points and one more on each side. */
static void clear(conic_thinner *thinner, double distance) {
  uint64_t n = UINT64_MAX;
  thinner->n_chosen = 0;
  thinner->edge = (float)((distance > 1.0 ? 2.0 * distance : 2.0) * (1.0 + 1e-4));
  thinner->cells_a_step = 1.0f / thinner->edge;
  for (thinner->shift = 0; n > thinner->n_cells; thinner->shift++) {
    n = 1;
    for (int axis = 0; axis < 3; axis++) {
      thinner->first_cell[axis] = (cell_of(thinner, thinner->low[axis]) - 1) >> thinner->shift;
      thinner->cells_on[axis] =
          ((cell_of(thinner, thinner->high[axis]) + 1) >> thinner->shift) - thinner->first_cell[axis] + 1;
      n *= (uint64_t)thinner->cells_on[axis];
    }
  }
  thinner->shift--;
  memset(thinner->cells, 0xff, n * sizeof *thinner->cells);
}

static float squared_distance(point a, point b) {
  float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return x * x + y * y + z * z;
}

/* The places in `cells` of a point's own cell, and of the nearer one on its other side, on an axis; their sum over the
 * axes is a cell's. */
static inline void places_on(const conic_thinner *thinner, int axis, float coordinate, int32_t stride,
                             uint32_t places[2]) {
  float scaled = coordinate * thinner->cells_a_step;
  int32_t cell = (int32_t)scaled, other = cell + 2 * !(scaled - (float)cell < 0.5f);
  places[0] = (uint32_t)(((cell + 1) >> thinner->shift) - thinner->first_cell[axis]) * (uint32_t)stride;
  places[1] = (uint32_t)((other >> thinner->shift) - thinner->first_cell[axis]) * (uint32_t)stride;
}

static inline void places_of(const conic_thinner *thinner, point at, uint32_t places[3][2]) {
  const int32_t *n = thinner->cells_on;
  places_on(thinner, 0, at.x, 1, places[0]);
  places_on(thinner, 1, at.y, n[0], places[1]);
  places_on(thinner, 2, at.z, n[0] * n[1], places[2]);
}

/* Whether a chosen point is nearer than that; it is within half a cell. */
static int has_near(const conic_thinner *thinner, point at, uint32_t places[3][2], float below2) {
  for (int i = 0; i < 8; i++) {
    uint32_t k = thinner->cells[places[0][i & 1] + places[1][i >> 1 & 1] + places[2][i >> 2]];
    for (; k != NO_POINT; k = thinner->links[k].next)
      if (squared_distance(at, thinner->links[k].at) < below2)
        return 1;
  }
  return 0;
}

static void insert(conic_thinner *thinner, uint32_t i_point, uint32_t places[3][2]) {
  uint32_t *first = &thinner->cells[places[0][0] + places[1][0] + places[2][0]], i = (uint32_t)thinner->n_chosen++;
  thinner->chosen[i] = i_point;
  thinner->links[i] = (chosen_point){thinner->points[i_point], *first};
  *first = i;
}

/* Fills the grid with points at least `distance` apart, until there are no more or `most` are exceeded. */
static size_t throw_darts(conic_thinner *thinner, double distance, size_t most) {
  float below2 = (float)(distance * distance);
  uint32_t places[3][2];
  clear(thinner, distance);
  for (size_t i = 0; i < thinner->n && thinner->n_chosen <= most; i++) {
    uint32_t i_point = thinner->order[i];
    const point at = thinner->points[i_point];
    places_of(thinner, at, places);
    if (!has_near(thinner, at, places, below2))
      insert(thinner, i_point, places);
  }
  return thinner->n_chosen;
}

/* Brings the chosen into the order of their cells. */
static void sort_by_cell(conic_thinner *thinner) {
  size_t n_cells = 1;
  uint32_t n = 0;
  for (int axis = 0; axis < 3; axis++)
    n_cells *= (size_t)thinner->cells_on[axis];
  for (size_t i = 0; i < n_cells; i++) {
    uint32_t k = thinner->cells[i];
    thinner->cells[i] = n;
    for (; k != NO_POINT; k = thinner->links[k].next) {
      if (k == 0)
        thinner->first = n;
      thinner->by_cell[n] = k;
      thinner->at[0][n] = thinner->links[k].at.x;
      thinner->at[1][n] = thinner->links[k].at.y;
      thinner->at[2][n++] = thinner->links[k].at.z;
    }
  }
  thinner->cells[n_cells] = n;
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

/* Squares of distances are whole numbers. So distances whose squares have the same next one choose the same. */
typedef struct tries {
  float below2[MOST_TRIES];
  size_t n_chosen[MOST_TRIES], n;
  double thrown; /* what the grid was filled with */
} tries;

static size_t try_distance(conic_thinner *thinner, double distance, size_t most, tries *t) {
  float below2 = ceilf((float)(distance * distance));
  for (size_t i = 0; i < t->n; i++)
    if (t->below2[i] == below2)
      return t->n_chosen[i];
  t->thrown = distance;
  t->below2[t->n] = below2;
  return t->n_chosen[t->n++] = throw_darts(thinner, distance, most);
}

size_t conic_thinner_choose(conic_thinner *thinner, size_t target, size_t most, double *distance, uint8_t *is_chosen) {
  double at = *distance > 1.0 ? *distance : 1.0, best = 0.0, low = 0.0, high = 0.0;
  size_t n = 0, n_best = 0;
  tries t = {.n = 0};
  for (int i = 0; i < MOST_TRIES; i++) {
    n = try_distance(thinner, at, most, &t);
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
    t.thrown = at;
  }
  if (t.thrown != best)
    throw_darts(thinner, best, most);
  n = thinner->n_chosen;
  sort_by_cell(thinner);
  memset(is_chosen, 0, thinner->n);
  for (size_t i = 0; i < n; i++)
    is_chosen[thinner->chosen[i]] = 1;
  for (size_t i = 0, k = 0; i < thinner->n; i++)
    if (is_chosen[i])
      thinner->number[i] = (uint32_t)k++;
  *distance = best;
  return n;
}

/* Lists those of a row that lie in cells `from` to `to`, in runs. */
static void list_runs(const conic_thinner *thinner, const int32_t from[3], const int32_t to[3], conic_thinner_row row,
                      conic_thinner_rows *rows) {
  for (uint32_t i = row.begin; i < row.end && rows->n < CONIC_THINNER_ROWS; i++) {
    int is_in = 1;
    for (int axis = 0; axis < 3; axis++) {
      int32_t cell = cell_of(thinner, thinner->at[axis][i]);
      is_in &= cell >= from[axis] && cell <= to[axis];
    }
    if (is_in && rows->n > 0 && rows->list[rows->n - 1].end == i)
      rows->list[rows->n - 1].end++;
    else if (is_in)
      rows->list[rows->n++] = (conic_thinner_row){i, i + 1};
  }
}

void conic_thinner_beside(const conic_thinner *thinner, const float at[3], int is_wide, conic_thinner_rows *rows) {
  int32_t from[3], to[3], low[3], high[3];
  for (int axis = 0; axis < 3; axis++) {
    float scaled = at[axis] * thinner->cells_a_step;
    int32_t cell = (int32_t)scaled;
    int is_low = scaled - (float)cell < 0.5f;
    from[axis] = cell + 1 - (is_wide || is_low);
    to[axis] = cell + 1 + (is_wide || !is_low);
    low[axis] = (from[axis] >> thinner->shift) - thinner->first_cell[axis];
    high[axis] = (to[axis] >> thinner->shift) - thinner->first_cell[axis];
    low[axis] = low[axis] > 0 ? low[axis] : 0;
    high[axis] = high[axis] < thinner->cells_on[axis] ? high[axis] : thinner->cells_on[axis] - 1;
  }
  rows->n = 0;
  for (int32_t z = low[2]; z <= high[2]; z++)
    for (int32_t y = low[1]; y <= high[1] && low[0] <= high[0]; y++) {
      const uint32_t *first = thinner->cells + ((ptrdiff_t)z * thinner->cells_on[1] + y) * thinner->cells_on[0];
      const conic_thinner_row row = {first[low[0]], first[high[0] + 1]};
      if (thinner->shift > 0)
        list_runs(thinner, from, to, row, rows);
      else if (row.begin < row.end)
        rows->list[rows->n++] = row;
    }
}

/* The square of the distance to the nearest chosen point of some rows, which becomes *nearest. */
static float nearest_in_rows(const conic_thinner *thinner, const conic_thinner_rows *rows, point at, point *nearest) {
  const lanes x = lanes_of(at.x), y = lanes_of(at.y), z = lanes_of(at.z);
  lanes least = lanes_of(HUGE_VALF);
  int_lanes which = lanes_of_int(0);
  for (size_t i_row = 0; i_row < rows->n; i_row++)
    for (uint32_t i = rows->list[i_row].begin; i < rows->list[i_row].end; i += CONIC_LANES) {
      const int_lanes number = ints_of_indices(lanes_ascending(i));
      lanes dx = x - lanes_load(thinner->at[0] + i), dy = y - lanes_load(thinner->at[1] + i),
            dz = z - lanes_load(thinner->at[2] + i), distance2 = dx * dx + dy * dy + dz * dz;
      lanes_mask is_in = lanes_less_int(number, lanes_of_int((int32_t)rows->list[i_row].end));
      distance2 = lanes_select(is_in, distance2, lanes_of(HUGE_VALF));
      which = lanes_select_ints(lanes_less(distance2, least), number, which);
      least = lanes_min(distance2, least);
    }
  int best = 0;
  for (int lane = 1; lane < CONIC_LANES; lane++)
    best = least[lane] < least[best] ? lane : best;
  int32_t i = which[best];
  *nearest = (point){thinner->at[0][i], thinner->at[1][i], thinner->at[2][i]};
  return least[best];
}

double conic_thinner_reach(const conic_thinner *thinner, const uint64_t *keys, size_t n, double beyond, double reach) {
  point last = thinner->links[0].at; /* that was near; points that follow each other lie together */
  float half_edge = 0.5f * thinner->edge, near2 = half_edge * half_edge * (1.0f - 1e-4f);
  conic_thinner_rows rows;
  for (size_t i = 0; i < n; i++) {
    point at = point_of(keys[i]);
    double enough = (reach - beyond) * (1.0 - 1e-6); /* surely so, rounded as it may be */
    float enough2 = enough > 0.0 ? (float)(enough * enough) : 0.0f;
    if (squared_distance(at, last) <= enough2)
      continue;
    conic_thinner_beside(thinner, (const float[3]){at.x, at.y, at.z}, 0, &rows);
    float nearest2 = nearest_in_rows(thinner, &rows, at, &last);
    if (nearest2 <= enough2)
      continue;
    if (nearest2 > near2) { /* past the near cells all are looked at: that is seldom */
      const conic_thinner_rows all = {1, {{0, (uint32_t)thinner->n_chosen}}};
      nearest2 = nearest_in_rows(thinner, &all, at, &last);
    }
    double found = sqrt((double)nearest2) + beyond;
    reach = found > reach ? found : reach;
  }
  return reach;
}

float conic_thinner_beside2(const conic_thinner *thinner) {
  return thinner->edge * thinner->edge * (1.0f - 1e-4f);
}

uint32_t conic_thinner_first(const conic_thinner *thinner) {
  return thinner->first;
}

size_t conic_thinner_numbers(const conic_thinner *thinner, uint32_t *numbers) {
  for (size_t i = 0; i < thinner->n_chosen; i++)
    numbers[i] = thinner->number[thinner->chosen[thinner->by_cell[i]]];
  return thinner->n_chosen;
}
