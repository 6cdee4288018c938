/* Cells of pixels, and the Gaussians that each may show. Nothing here knows of the renderer's tiles. */
#include "oracle/gaussians/oracle_cells.h"

#include "core/base/real.h"

enum { PLACE_RUN = 1024, CELL_EDGE = 32 };

/* Pixels of the picture of samples, first and last; none where last is below first. */
typedef struct cell_box {
  uint16_t first[2], last[2];
} cell_box;

/* What a thread keeps from cell to cell. */
typedef struct cell_worker {
  oracle_uncertain *gaussians;
  const oracle_uncertain **order;
  oracle_meeting *meetings;
  oracle_step *steps;
  char *has_color;
  size_t room;
  int has_failed;
} cell_worker;

typedef struct cell_job {
  const oracle_bound_request *b;
  int edge;                    /* of a cell, in pixels of the picture */
  size_t across, n_cells;      /* cells */
  size_t *begin, *pixel_begin; /* of each cell's Gaussians, and of its pixels */
  uint32_t *entries, *pixels;  /* pixels: places in the list of those asked for */
  cell_box *boxes;             /* of each Gaussian */
  cell_worker *workers;
} cell_job;

static void box_of_reach(const oracle_bound_request *b, const oracle_uncertain *g, cell_box *box) {
  const double size[2] = {b->width * b->samples, b->height * b->samples};
  for (int axis = 0; axis < 2; axis++) {
    double least = ceil(oracle_max(oracle_max(g->reach[0][axis], g->wide[0][axis]) - 0.5, 0.0));
    double most = floor(oracle_min(oracle_min(g->reach[1][axis], g->wide[1][axis]) - 0.5, size[axis] - 1.0));
    if (!(least <= most)) {
      *box = (cell_box){{1, 1}, {0, 0}};
      return;
    }
    box->first[axis] = (uint16_t)least;
    box->last[axis] = (uint16_t)most;
  }
}

static void box_gaussians(void *data, size_t i_run) {
  cell_job *j = data;
  const size_t n = j->b->doubting.set->count;
  for (size_t i = i_run * PLACE_RUN; i < (i_run + 1) * PLACE_RUN && i < n; i++) {
    oracle_uncertain g;
    j->boxes[i] = (cell_box){{1, 1}, {0, 0}};
    if (conic_oracle_uncertain_place(&j->b->doubting, i, &g))
      box_of_reach(j->b, &g, &j->boxes[i]);
  }
}

static const char *task_of(const oracle_bound_request *b) {
  return b->task ? b->task : "verify";
}

static size_t pixel_asked(const oracle_bound_request *b, size_t i) {
  return b->pixels ? b->pixels[i] : i;
}

static size_t cell_of_pixel(const cell_job *j, size_t pixel) {
  const size_t width = (size_t)j->b->width, edge = (size_t)j->edge;
  return pixel / width / edge * j->across + pixel % width / edge;
}

/* Counts first, then, where `entries` is there, puts: every Gaussian into the cells that have pixels asked for. */
static void put_gaussians(const cell_job *j, size_t *places, uint32_t *entries) {
  const int edge = j->edge * j->b->samples;
  for (size_t i = 0; i < j->b->doubting.set->count; i++) {
    const cell_box *box = &j->boxes[i];
    for (int y = box->first[1] / edge; y <= box->last[1] / edge && box->first[0] <= box->last[0]; y++)
      for (int x = box->first[0] / edge; x <= box->last[0] / edge; x++) {
        size_t cell = (size_t)y * j->across + (size_t)x;
        if (j->pixel_begin[cell] == j->pixel_begin[cell + 1])
          continue;
        if (entries)
          entries[places[cell]] = (uint32_t)i;
        places[cell]++;
      }
  }
}

/* Counts become places. Returns their sum. */
static size_t places_of_counts(size_t *counts, size_t n) {
  size_t sum = 0;
  for (size_t i = 0; i <= n; i++) {
    size_t count = i < n ? counts[i] : 0;
    counts[i] = sum;
    sum += count;
  }
  return sum;
}

static conic_status sort_pixels(cell_job *j) {
  const oracle_bound_request *b = j->b;
  j->across = ((size_t)b->width + (size_t)j->edge - 1) / (size_t)j->edge;
  j->n_cells = j->across * (((size_t)b->height + (size_t)j->edge - 1) / (size_t)j->edge);
  size_t *places;
  conic_status status = conic_memory_allocate_these(
      b->context, CONIC_ZEROED(j->begin, j->n_cells + 1), CONIC_ZEROED(j->pixel_begin, j->n_cells + 1),
      CONIC_ROOM(j->pixels, b->n_pixels), CONIC_ROOM(places, j->n_cells + 1));
  if (status == CONIC_OK) {
    for (size_t i = 0; i < b->n_pixels; i++)
      j->pixel_begin[cell_of_pixel(j, pixel_asked(b, i))]++;
    places_of_counts(j->pixel_begin, j->n_cells);
    memcpy(places, j->pixel_begin, (j->n_cells + 1) * sizeof *places);
    for (size_t i = 0; i < b->n_pixels; i++)
      j->pixels[places[cell_of_pixel(j, pixel_asked(b, i))]++] = (uint32_t)i;
  }
  conic_memory_release(b->context, places);
  return status;
}

static conic_status sort_into_cells(cell_job *j) {
  const oracle_bound_request *b = j->b;
  const size_t n = b->doubting.set->count;
  j->boxes = conic_memory_allocate(b->context, n, sizeof *j->boxes);
  if (!j->boxes)
    return CONIC_ERROR_MEMORY;
  conic_status status =
      conic_parallel_told(b->context, task_of(b), 0.0, 0.1, (n + PLACE_RUN - 1) / PLACE_RUN, box_gaussians, j);
  if (status != CONIC_OK)
    return status;
  put_gaussians(j, j->begin, NULL);
  j->entries = conic_memory_allocate(b->context, places_of_counts(j->begin, j->n_cells), sizeof *j->entries);
  if (!j->entries)
    return CONIC_ERROR_MEMORY;
  put_gaussians(j, j->begin, j->entries); /* which leaves each cell's end where its beginning was */
  for (size_t cell = j->n_cells; cell-- > 0;)
    j->begin[cell + 1] = j->begin[cell];
  j->begin[0] = 0;
  return CONIC_OK;
}

static int compare_uncertain(const void *a, const void *b) {
  const oracle_uncertain *const *x = a, *const *y = b;
  int order = CONIC_ORDER((float)(*x)->key.v, (float)(*y)->key.v);
  return order ? order : CONIC_ORDER((*x)->index, (*y)->index);
}

CONIC_DEFINE_ORDER_BY_TWO(compare_meetings, oracle_meeting, key, g->index)

static void release_worker(conic_context *context, cell_worker *w) {
  conic_memory_release_these(context, w->gaussians, (void *)w->order, w->meetings, w->steps, w->has_color);
}

static conic_status make_room_in_worker(const oracle_bound_request *b, cell_worker *w, size_t n) {
  if (n <= w->room)
    return CONIC_OK;
  release_worker(b->context, w);
  memset(w, 0, sizeof *w);
  w->room = n + n / 2;
  return conic_memory_allocate_these(b->context, CONIC_ROOM(w->gaussians, w->room), CONIC_ROOM(w->order, w->room),
                                     CONIC_ROOM(w->meetings, w->room), CONIC_ROOM(w->steps, w->room),
                                     CONIC_ROOM(w->has_color, w->room));
}

static int may_reach(const oracle_uncertain *g, double x, double y) {
  return x >= g->reach[0][0] && x <= g->reach[1][0] && y >= g->reach[0][1] && y <= g->reach[1][1];
}

/* Those of a cell that may cover a place, in their order. What the surface may hide takes no light. */
static size_t gather_meetings(const oracle_bound_request *b, cell_worker *w, size_t n, double x, double y,
                              const oracle_surface *surface) {
  const int is_sorted = b->doubting.view->rules->shape != CONIC_SHAPE_RAY;
  double T = 1.0, latest = -INFINITY;
  size_t n_meetings = 0;
  oracle_sight sight;
  conic_oracle_sight_of(&b->doubting, x, y, &sight);
  for (size_t i = 0; i < n; i++) {
    oracle_uncertain *g = &w->gaussians[w->order[i] - w->gaussians];
    oracle_meeting *m = &w->meetings[n_meetings];
    if (is_sorted && T < 0.5 * b->doubting.limits.stop && bounded_low(g->key) > latest)
      break; /* behind the end */
    if (!may_reach(g, x, y))
      continue;
    conic_oracle_uncertain_meet(&b->doubting, g, &sight, x, y, m);
    char *color = &w->has_color[g - w->gaussians];
    if (m->may_cover && !*color)
      *color = conic_oracle_uncertain_color(&b->doubting, g) ? 1 : 2;
    if (!m->may_cover || *color == 2)
      continue;
    n_meetings++;
    latest = oracle_max(latest, m->key_high);
    if (!m->doubts && !(surface && m->z[1] >= surface->z))
      T *= 1.0 - m->alpha[0];
  }
  if (!is_sorted)
    qsort(w->meetings, n_meetings, sizeof *w->meetings, compare_meetings);
  return n_meetings;
}

/* Sets up the cell's Gaussians, in their order but for what is ordered along rays. */
static size_t place_in_cell(const cell_job *j, cell_worker *w, size_t cell) {
  size_t n = 0;
  for (size_t i = j->begin[cell]; i < j->begin[cell + 1]; i++)
    if (conic_oracle_uncertain_place(&j->b->doubting, j->entries[i], &w->gaussians[n])) {
      w->order[n] = &w->gaussians[n];
      w->has_color[n++] = 0;
    }
  qsort(w->order, n, sizeof *w->order, compare_uncertain);
  return n;
}

/* The sample that Z and what follows it is of: nearest to the centre, of four the upper left. */
static int is_middle_sample(int samples, int x, int y) {
  return x == (samples - 1) / 2 && y == (samples - 1) / 2;
}

static void add_sample_bound(conic_gaussian_bound *sum, const conic_gaussian_bound *b, double share, int is_middle) {
  double *const to[] = {sum->value, sum->low, sum->high, sum->least, sum->most};
  const double *const from[] = {b->value, b->low, b->high, b->least, b->most};
  for (int k = 0; k < 5; k++)
    for (int c = 0; c < CONIC_N_BOUNDS; c++) {
      int is_mean = c <= CONIC_BOUND_T || (c >= CONIC_BOUND_NORMAL && c < CONIC_BOUND_COUNT);
      if (is_mean)
        to[k][c] += share * from[k][c];
      else if (c == CONIC_BOUND_COUNT)
        to[k][c] = oracle_max(to[k][c], from[k][c]);
      else if (is_middle)
        to[k][c] = from[k][c];
    }
  sum->doubts = b->doubts > sum->doubts ? b->doubts : sum->doubts;
  sum->kinds |= b->kinds;
  sum->is_wide |= b->is_wide;
  if (!is_middle)
    return;
  memcpy(sum->id, b->id, sizeof sum->id);
  memcpy(sum->last, b->last, sizeof sum->last);
  sum->n_id = b->n_id;
  sum->n_last = b->n_last;
}

static void bound_one_pixel(const oracle_bound_request *b, cell_worker *w, size_t n, size_t pixel, int i_thread,
                            conic_gaussian_bound *bound) {
  const int x = (int)(pixel % (size_t)b->width) * b->samples, y = (int)(pixel / (size_t)b->width) * b->samples;
  memset(bound, 0, sizeof *bound);
  for (int row = 0; row < b->samples; row++)
    for (int column = 0; column < b->samples; column++) {
      conic_gaussian_bound sample;
      oracle_surface surface;
      int is_there = b->surfaces && conic_oracle_surface_at(b->surfaces, x + column, y + row, &surface);
      size_t n_meetings = gather_meetings(b, w, n, x + column + 0.5, y + row + 0.5, is_there ? &surface : NULL);
      conic_oracle_composite(&b->doubting, w->meetings, n_meetings, b->background, is_there ? &surface : NULL, w->steps,
                             &sample);
      if (b->note)
        b->note(b->data, pixel, w->meetings, n_meetings, i_thread);
      if (b->samples == 1)
        *bound = sample;
      else
        add_sample_bound(bound, &sample, 1.0 / b->samples / b->samples, is_middle_sample(b->samples, column, row));
    }
}

static void bound_cell(void *data, size_t cell, int i_thread) {
  const cell_job *j = data;
  const oracle_bound_request *b = j->b;
  cell_worker *w = &j->workers[i_thread];
  if (j->pixel_begin[cell] == j->pixel_begin[cell + 1] || w->has_failed)
    return;
  if (make_room_in_worker(b, w, j->begin[cell + 1] - j->begin[cell] + 1) != CONIC_OK) {
    w->has_failed = 1;
    return;
  }
  size_t n = place_in_cell(j, w, cell);
  for (size_t k = j->pixel_begin[cell]; k < j->pixel_begin[cell + 1]; k++) {
    conic_gaussian_bound bound;
    size_t pixel = pixel_asked(b, j->pixels[k]);
    bound_one_pixel(b, w, n, pixel, i_thread, &bound);
    if (b->take)
      b->take(b->data, j->pixels[k], pixel, &bound, i_thread);
  }
}

conic_status conic_oracle_bound_all(const oracle_bound_request *b) {
  const int threads = conic_context_threads(b->context);
  cell_job j = {.b = b, .edge = CELL_EDGE / b->samples > 1 ? CELL_EDGE / b->samples : 1};
  conic_status status = sort_pixels(&j);
  if (status == CONIC_OK)
    status = sort_into_cells(&j);
  if (status == CONIC_OK && !(j.workers = conic_memory_allocate_zeroed(b->context, (size_t)threads, sizeof *j.workers)))
    status = CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_parallel_told(b->context, task_of(b), 0.1, 1.0, j.n_cells, bound_cell, &j);
  for (int k = 0; j.workers && k < threads; k++)
    if (j.workers[k].has_failed && status == CONIC_OK)
      status = CONIC_ERROR_MEMORY;
  for (int k = 0; j.workers && k < threads; k++)
    release_worker(b->context, &j.workers[k]);
  conic_memory_release_these(b->context, j.begin, j.pixel_begin, j.entries, j.pixels, j.boxes, j.workers);
  return status;
}

conic_status conic_oracle_meet_all(const oracle_bound_request *b, double x, double y, oracle_uncertain **gaussians,
                                   oracle_meeting **meetings, size_t *n) {
  size_t room = 0, n_here = 0;
  conic_status status = CONIC_OK;
  *gaussians = NULL;
  oracle_sight sight;
  conic_oracle_sight_of(&b->doubting, x, y, &sight);
  for (size_t i = 0; i < b->doubting.set->count && status == CONIC_OK; i++) {
    oracle_uncertain g;
    if (i % 65536 == 0)
      status = conic_progress(b->context, "verify", (double)i / (double)b->doubting.set->count);
    if (status != CONIC_OK || !conic_oracle_uncertain_place(&b->doubting, i, &g) || !may_reach(&g, x, y) ||
        !conic_oracle_uncertain_color(&b->doubting, &g))
      continue;
    status = conic_memory_append(b->context, gaussians, &n_here, &room, &g, sizeof g);
  }
  *meetings = status == CONIC_OK ? conic_memory_allocate(b->context, n_here, sizeof **meetings) : NULL;
  for (size_t i = 0; i < n_here && *meetings; i++)
    conic_oracle_uncertain_meet(&b->doubting, &(*gaussians)[i], &sight, x, y, &(*meetings)[i]);
  if (*meetings)
    qsort(*meetings, n_here, sizeof **meetings, compare_meetings);
  *n = n_here;
  return *meetings || status != CONIC_OK ? status : CONIC_ERROR_MEMORY;
}
