/* The derivative of a picture of Gaussians: cells of pixels, each with the Gaussians that it may show in their order,
 * and what the pixels give them summed up pixel by pixel, cell by cell, whatever thread did which. */

#include "core/base/real.h"
#include "oracle/gaussians/oracle_gradient_job.h"

enum { SHOW_RUN = 1024, EDGE = 16 };

/* What orders the Gaussians. */
typedef struct shown_rank {
  float key;
  uint32_t index;
} shown_rank;

static void show_gaussians(void *data, size_t i_run) {
  oracle_gradient_job *j = data;
  for (size_t i = i_run * SHOW_RUN; i < (i_run + 1) * SHOW_RUN && i < j->set->count; i++)
    if (!conic_oracle_show(&j->view, j->set, i, &j->shown[i]))
      j->shown[i] = (oracle_shown){.first = {1, 1}};
    else if (j->noise)
      conic_oracle_disturb_shown(j->noise, j->seed, &j->shown[i]);
}

CONIC_DEFINE_ORDER_BY_TWO(compare_ranks, shown_rank, key, index)

/* Counts, then, where `entries` is there, puts every Gaussian into its cells, in the order that all pixels share. */
static void put_shown(const oracle_gradient_job *j, const shown_rank *ranks, size_t n, size_t *places,
                      uint32_t *entries) {
  for (size_t i = 0; i < n; i++) {
    const oracle_shown *s = &j->shown[ranks[i].index];
    for (size_t y = s->first[1] / EDGE; y <= s->last[1] / EDGE; y++)
      for (size_t x = s->first[0] / EDGE; x <= s->last[0] / EDGE; x++) {
        size_t cell = y * j->across + x;
        if (entries)
          entries[places[cell]] = ranks[i].index;
        places[cell]++;
      }
  }
}

static conic_status fill_shown_cells(oracle_gradient_job *j, const shown_rank *ranks, size_t n) {
  const size_t n_cells = j->across * j->down;
  size_t *places = j->begin, sum = 0;
  put_shown(j, ranks, n, places, NULL);
  for (size_t cell = 0; cell <= n_cells; cell++) {
    size_t count = places[cell];
    places[cell] = sum;
    sum += count;
    j->most_entries = count > j->most_entries ? count : j->most_entries;
  }
  j->entries = conic_memory_allocate(j->context, sum, sizeof *j->entries);
  if (!j->entries)
    return CONIC_ERROR_MEMORY;
  put_shown(j, ranks, n, places, j->entries); /* which leaves each cell's end where its beginning was */
  for (size_t cell = n_cells; cell-- > 0;)
    places[cell + 1] = places[cell];
  places[0] = 0;
  for (size_t y = 0; y < j->down; y++) {
    size_t n_band = j->begin[(y + 1) * j->across] - j->begin[y * j->across];
    j->most_in_band = n_band > j->most_in_band ? n_band : j->most_in_band;
  }
  return CONIC_OK;
}

static conic_status sort_shown(oracle_gradient_job *j) {
  const size_t n = j->set->count;
  j->across = ((size_t)j->view.camera->width + EDGE - 1) / EDGE;
  j->down = ((size_t)j->view.camera->height + EDGE - 1) / EDGE;
  shown_rank *ranks;
  conic_status status = conic_memory_allocate_these(
      j->context, CONIC_ROOM(j->shown, n), CONIC_ZEROED(j->begin, j->across * j->down + 1), CONIC_ROOM(ranks, n));
  if (status == CONIC_OK)
    status = conic_parallel_told(j->context, "gradient", 0.0, 0.1, (n + SHOW_RUN - 1) / SHOW_RUN, show_gaussians, j);
  size_t n_shown = 0;
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    if (j->shown[i].first[0] <= j->shown[i].last[0])
      ranks[n_shown++] = (shown_rank){j->shown[i].key, (uint32_t)i};
  if (status == CONIC_OK) {
    qsort(ranks, n_shown, sizeof *ranks, compare_ranks);
    status = fill_shown_cells(j, ranks, n_shown);
  }
  conic_memory_release(j->context, ranks);
  return status;
}

int conic_oracle_pixel_weights(const conic_gaussian_weights *w, size_t pixel, double weights[N_WEIGHTS]) {
  int is_any = 0;
  for (size_t c = 0; c < 3; c++)
    weights[c] = w->rgb ? w->rgb[3 * pixel + c] : 0.0;
  weights[3] = w->alpha ? w->alpha[pixel] : 0.0;
  weights[4] = w->z ? w->z[pixel] : 0.0;
  for (int k = 0; k < N_WEIGHTS; k++)
    is_any |= weights[k] != 0.0;
  return is_any;
}

CONIC_DEFINE_ORDER_BY_TWO(compare_met, oracle_met, key, index)

/* What covers the pixel, in its order. */
static size_t meet_all_shown(const oracle_gradient_job *j, gradient_worker *w, size_t n, size_t x, size_t y,
                             const oracle_surface *surface) {
  const int is_sorted = j->view.rules->shape != CONIC_SHAPE_RAY;
  size_t n_met = 0;
  double T = 1.0;
  for (size_t i = 0; i < n; i++) {
    const oracle_shown *s = w->shown[i];
    if (x < s->first[0] || x > s->last[0] || y < s->first[1] || y > s->last[1] ||
        conic_oracle_meet_shown(&j->view, s, (double)x + 0.5, (double)y + 0.5, &w->met[n_met]) != ORACLE_COVERS ||
        (surface && w->met[n_met].z >= surface->z))
      continue;
    if (j->noise)
      conic_oracle_disturb_met(j, s, (double)x + 0.5, (double)y + 0.5, &w->met[n_met]);
    w->met[n_met].entry = (uint32_t)i;
    T *= 1.0 - w->met[n_met++].alpha;
    if (is_sorted && T < 0.5 * j->view.rules->stop)
      break;
  }
  if (!is_sorted)
    qsort(w->met, n_met, sizeof *w->met, compare_met);
  return n_met;
}

static double differentiate_pixel(const oracle_gradient_job *j, gradient_worker *w, size_t n, size_t x, size_t y,
                                  double (*sums)[N_BY_SCREEN], char *is_touched) {
  oracle_gradient_pixel pixel = {.x = (double)x + 0.5, .y = (double)y + 0.5, .background = j->background};
  pixel.passes_most = j->passes_most;
  double behind;
  if (!conic_oracle_pixel_weights(j->weights, y * (size_t)j->weights->width + x, pixel.weights))
    return 0.0;
  oracle_surface surface;
  if (j->surfaces && conic_oracle_surface_at(j->surfaces, (int)x, (int)y, &surface))
    pixel.surface = &surface;
  size_t n_met = meet_all_shown(j, w, n, x, y, pixel.surface);
  const double loss = conic_oracle_gradient_forth(&j->view, &pixel, w->shown, w->met, &n_met, &behind);
  for (size_t i = 0; i < n_met; i++)
    is_touched[w->met[i].entry] = 1;
  if (j->noise)
    conic_oracle_disturbed_back(j, &pixel, w->shown, w->met, n_met, behind, sums);
  for (size_t i = n_met; i-- > 0 && !j->noise;) {
    const oracle_met *m = &w->met[i];
    conic_oracle_gradient_back(&j->view, &pixel, w->shown[m->entry], m, m->before * (m->by_weight - behind),
                               sums[m->entry]);
    behind = m->alpha * m->by_weight + (1.0 - m->alpha) * behind;
  }
  return loss;
}

static void differentiate_cell(void *data, size_t column, int i_thread) {
  const oracle_gradient_job *j = data;
  gradient_worker *w = &j->workers[i_thread];
  const size_t cell = j->band * j->across + column, begin = j->begin[cell], n = j->begin[cell + 1] - begin;
  const size_t at = begin - j->begin[j->band * j->across];
  const size_t width = (size_t)j->view.camera->width, height = (size_t)j->view.camera->height;
  memset(j->sums + at, 0, n * sizeof *j->sums);
  memset(j->is_touched + at, 0, n);
  if (j->judging)
    memset(j->judging->bounds + at, 0, n * sizeof *j->judging->bounds);
  j->losses[column] = 0.0;
  for (size_t i = 0; i < n; i++)
    w->shown[i] = &j->shown[j->entries[begin + i]];
  for (size_t y = j->band * EDGE; y < (j->band + 1) * EDGE && y < height; y++)
    for (size_t x = column * EDGE; x < (column + 1) * EDGE && x < width; x++) {
      j->losses[column] += differentiate_pixel(j, w, n, x, y, j->sums + at, j->is_touched + at);
      if (j->judging)
        conic_oracle_bound_pixel_gradient(j, w, n, x, y, i_thread, j->judging->bounds + at);
    }
}

/* Adds what a row of cells came to. */
static void add_band(oracle_gradient_job *j) {
  const size_t begin = j->begin[j->band * j->across], n = j->begin[(j->band + 1) * j->across] - begin;
  for (size_t i = 0; i < n; i++) {
    const uint32_t index = j->entries[begin + i];
    for (int k = 0; k < N_BY_SCREEN && j->is_touched[i]; k++)
      j->totals[index][k] += j->sums[i][k];
    j->is_shown[index] |= j->is_touched[i];
    if (j->judging)
      conic_oracle_add_gradient_bound(&j->judging->totals[index], &j->judging->bounds[i]);
  }
  for (size_t column = 0; column < j->across; column++)
    j->gradient->loss += j->losses[column];
}

static conic_status make_gradient_room(oracle_gradient_job *j) {
  const size_t threads = (size_t)conic_context_threads(j->context), n = j->set->count;
  conic_status status = conic_memory_allocate_these(j->context, CONIC_ROOM(j->sums, j->most_in_band),
                                                    CONIC_ROOM(j->is_touched, j->most_in_band),
                                                    CONIC_ROOM(j->losses, j->across), CONIC_ZEROED(j->totals, n),
                                                    CONIC_ZEROED(j->is_shown, n), CONIC_ZEROED(j->workers, threads));
  for (size_t k = 0; status == CONIC_OK && k < threads; k++)
    status = conic_memory_allocate_these(j->context, CONIC_ROOM(j->workers[k].shown, j->most_entries),
                                         CONIC_ROOM(j->workers[k].met, j->most_entries + 1));
  return status == CONIC_OK && j->judging ? conic_oracle_judging_room(j) : status;
}

conic_status conic_oracle_differentiate(oracle_gradient_job *j) {
  conic_status status = sort_shown(j);
  if (status == CONIC_OK)
    status = make_gradient_room(j);
  for (j->band = 0; j->band < j->down && status == CONIC_OK; j->band++) {
    const double share = 0.9 / (double)j->down;
    status = conic_parallel_told(j->context, "gradient", 0.1 + share * (double)j->band,
                                 0.1 + share * (double)(j->band + 1), j->across, differentiate_cell, j);
    if (status == CONIC_OK)
      add_band(j);
  }
  return status;
}

void conic_oracle_gradient_end(oracle_gradient_job *j) {
  for (int k = 0; j->workers && k < conic_context_threads(j->context); k++)
    conic_memory_release_these(j->context, (void *)j->workers[k].shown, j->workers[k].met);
  conic_memory_release(j->context, j->workers);
  conic_memory_release_these(j->context, j->shown, j->begin, j->entries, j->sums, j->is_touched, j->losses, j->totals,
                             j->is_shown, j->cameras, j->doubts);
}
