#include "lod/layers/draw/layers_bands.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/threads.h"
#include "raster/project/projected.h"
#include "raster/view/method.h"
#include "raster/view/part.h"

typedef struct bands {
  const conic_layers_band_drawing *d;
  uint32_t *chosen; /* places that may meet the window */
  size_t n_chosen;
  double most;                 /* splats at a time */
  double excess;               /* how many there were in the last window, over how many were expected */
  conic_render_options render; /* with tiles that are small enough for a window of one */
} bands;

/* How many splats a place gives, about: of a grazing one few. */
static uint64_t place_weight(const bands *b, const conic_layers_place *place) {
  uint64_t n = b->d->layers->entries[place->node].n_drawn;
  return place->state == CONIC_PLACE_SHOWN ? n : place->state == CONIC_PLACE_GRAZING ? n / 16 + 1 : 0;
}

/* How much of a place's extent lies between begin and end. */
static double share_of(int place_begin, int place_end, int begin, int end) {
  int from = place_begin > begin ? place_begin : begin, to = place_end < end ? place_end : end;
  return from < to ? (double)(to - from) / (double)(place_end - place_begin) : 0.0;
}

/* How many of a place's splats are in a window, if they are spread evenly over its pixels. */
static double splats_in(const bands *b, const conic_layers_place *place, const conic_window *window) {
  const conic_window *pixels = &place->sight.pixels;
  double share = share_of(pixels->x_begin, pixels->x_end, window->x_begin, window->x_end);
  if (place->state == CONIC_PLACE_HIDDEN || share == 0.0)
    return 0.0;
  share *= share_of(pixels->y_begin, pixels->y_end, window->y_begin, window->y_end);
  return share * (double)place_weight(b, place);
}

static double expect_splats(const bands *b, const conic_window *window) {
  double n = 0.0;
  for (size_t i = 0; i < b->d->cut->n; i++)
    n += splats_in(b, &b->d->cut->places[i], window);
  return n * b->excess;
}

/* Shortens the window, from its far end along an axis, to as many tiles as there is memory for, at least one. */
static void shorten(bands *b, conic_window *window, int is_along_x) {
  int begin = is_along_x ? window->x_begin : window->y_begin, *end = is_along_x ? &window->x_end : &window->y_end;
  int whole = *end;
  double n = 0.0;
  for (*end = begin; *end < whole;) {
    conic_window next = *window;
    *(is_along_x ? &next.x_begin : &next.y_begin) = *end;
    int next_end = *end + b->render.tile < whole ? *end + b->render.tile : whole;
    *(is_along_x ? &next.x_end : &next.y_end) = next_end;
    n += expect_splats(b, &next);
    if (*end > begin && n > b->most)
      return;
    *end = next_end;
  }
}

/* Makes tiles smaller where one of the row that begins the window holds more than there is memory for, if the row is as
 * uneven as most are. */
static void fit_tiles(bands *b, const conic_window *window) {
  enum { LEAST_TILE = 8, UNEVEN = 3 };
  for (; b->render.tile > LEAST_TILE; b->render.tile /= 2) {
    conic_window row = *window;
    row.y_end = row.y_begin + b->render.tile < window->y_end ? row.y_begin + b->render.tile : window->y_end;
    if (UNEVEN * expect_splats(b, &row) * b->render.tile <= b->most * (row.x_end - row.x_begin))
      return;
  }
}

/* The next window after one that was drawn, from left to right and then downwards: whole rows of tiles where there is
 * memory for them, else a part of one row. 0 after the last. */
static int next_window(bands *b, conic_window *window) {
  int width = b->d->camera->width, height = b->d->camera->height;
  if (window->x_end < width) {
    window->x_begin = window->x_end;
    window->x_end = width;
  } else {
    *window = (conic_window){0, width, window->y_end, height};
    if (window->y_begin < height) {
      fit_tiles(b, window);
      shorten(b, window, 0);
    }
  }
  if (window->y_begin >= height)
    return 0;
  if (expect_splats(b, window) > b->most)
    shorten(b, window, 1);
  return 1;
}

static conic_status gather_band(bands *b, const conic_window *window, int is_whole, size_t most) {
  const conic_layers_band_drawing *d = b->d;
  b->n_chosen = 0;
  for (size_t i = 0; i < d->cut->n; i++)
    if (splats_in(b, &d->cut->places[i], window) > 0.0)
      b->chosen[b->n_chosen++] = (uint32_t)i;
  conic_layers_gathering gathering = {.cut = d->cut,
                                      .chosen = b->chosen,
                                      .n_chosen = b->n_chosen,
                                      .view = d->view,
                                      .window = is_whole ? NULL : window,
                                      .cutoff = d->render->kernel.cutoff,
                                      .camera = d->camera,
                                      .until_s = HUGE_VAL,
                                      .most = most};
  return conic_layers_gather(d->layers, &gathering, d->set);
}

/* Numbers in the set become numbers in the file. */
static void rename_window(const conic_layers_band_drawing *d, const conic_window *window) {
  uint32_t *ids = d->image->planes[CONIC_PLANE_ID];
  for (int y = window->y_begin; ids && y < window->y_end; y++)
    for (int x = window->x_begin; x < window->x_end; x++) {
      uint32_t *id = &ids[(size_t)y * (size_t)d->image->width + (size_t)x];
      *id = *id < d->set->splats.count ? d->set->ids[*id] : *id;
    }
}

/* Splats that an earlier band has counted already. */
typedef struct recount {
  const bands *b;
  conic_view view;
  const conic_window *window;
  conic_chunk *chunks; /* a thread */
} recount;

/* Whether the window is the first that these pixels meet. */
static int is_first_window(const conic_window *pixels, const conic_window *window) {
  return pixels->y_begin >= window->y_begin && pixels->x_begin >= window->x_begin;
}

static void recount_piece(void *data, size_t i_piece, int i_thread) {
  recount *r = data;
  const conic_layers_band_drawing *d = r->b->d;
  const conic_layers_piece *piece = &d->set->pieces[i_piece];
  const conic_layers_place *place = &d->cut->places[piece->i_place];
  const conic_splats *splats = &d->set->splats;
  conic_chunk *sum = &r->chunks[i_thread];
  conic_footprint footprint;
  conic_box box;
  conic_projected_surface surface;
  conic_ray ray;
  conic_projected at = {.footprints = &footprint, .boxes = &box, .surfaces = &surface, .rays = &ray};
  if (is_first_window(&place->sight.pixels, r->window))
    return;
  for (size_t i = 0; i < piece->n_kept; i++) {
    size_t k = piece->at + i;
    const float position[3] = {splats->position[0][k], splats->position[1][k], splats->position[2][k]};
    conic_window pixels = place->sight.pixels;
    conic_layers_narrow(d->view, position, (double)d->layers->entries[place->node].radius, &pixels);
    if (is_first_window(&pixels, r->window))
      continue;
    conic_chunk one = {.n_drawn = 0};
    conic_project_one(&r->view, splats, k, &at, &one);
    sum->n_drawn += one.n_drawn;
    sum->n_rays += one.n_rays;
    sum->n_laplaces += one.n_laplaces;
    sum->n_skipped += one.n_skipped;
    sum->n_fallback += one.n_fallback;
  }
}

static void take_from(const recount *r, int n_threads, conic_method method, conic_render_statistics *band) {
  conic_render_statistics twice;
  uint64_t n_rays = 0;
  memset(&twice, 0, sizeof twice);
  for (int i = 0; i < n_threads; i++) {
    twice.splats_drawn += r->chunks[i].n_drawn;
    twice.splats_skipped += r->chunks[i].n_skipped;
    twice.splats_fallback += r->chunks[i].n_fallback;
    n_rays += r->chunks[i].n_rays;
    twice.splats_by_laplace += r->chunks[i].n_laplaces;
  }
  conic_method_count(method, n_rays, &twice);
  band->splats_drawn -= twice.splats_drawn;
  band->splats_skipped -= twice.splats_skipped;
  band->splats_fallback -= twice.splats_fallback;
  band->splats_by_laplace -= twice.splats_by_laplace;
  for (int i = 0; i < CONIC_N_METHODS; i++)
    band->splats_by_method[i] -= twice.splats_by_method[i];
}

/* Takes out of a band's counts what belongs to an earlier one. */
static conic_status count_once(const bands *b, const conic_window *window, conic_render_statistics *band) {
  const conic_layers_band_drawing *d = b->d;
  conic_context *context = d->layers->context;
  recount r = {.b = b, .window = window};
  conic_status status = conic_view_init(context, &d->set->splats, d->camera, d->render, d->render->near_z,
                                        d->render->splat_length, &r.view);
  if (status != CONIC_OK)
    return status;
  r.chunks = conic_memory_allocate_zeroed(context, (size_t)conic_context_threads(context), sizeof *r.chunks);
  if (!r.chunks)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(context, d->set->n_pieces, recount_piece, &r);
  take_from(&r, conic_context_threads(context), d->render->method, band);
  band->splats_in = 0;
  for (size_t i = 0; i < d->set->n_pieces; i++)
    if (is_first_window(&d->cut->places[d->set->pieces[i].i_place].sight.pixels, window)) {
      band->splats_in += d->set->pieces[i].n_chosen;
      *d->n_turned += d->set->pieces[i].n_turned;
    }
  conic_memory_release(context, r.chunks);
  return CONIC_OK;
}

static void add_band(const conic_render_statistics *band, conic_render_statistics *sum) {
  conic_render_statistics before = *sum;
  *sum = *band;
  sum->splats_in += before.splats_in;
  sum->splats_culled += before.splats_culled;
  sum->splats_skipped += before.splats_skipped;
  sum->splats_drawn += before.splats_drawn;
  sum->splats_fallback += before.splats_fallback;
  sum->splats_by_laplace += before.splats_by_laplace;
  for (int i = 0; i < CONIC_N_METHODS; i++)
    sum->splats_by_method[i] += before.splats_by_method[i];
  sum->fragments += before.fragments;
  sum->pixels_covered += before.pixels_covered;
  sum->ms.setup += before.ms.setup;
  sum->ms.bin += before.ms.bin;
  sum->ms.visibility += before.ms.visibility;
  sum->ms.accumulate += before.ms.accumulate;
  sum->ms.resolve += before.ms.resolve;
  sum->ms.frame += before.ms.frame;
}

/* Half the window, in whole tiles. */
static void halve_window(const bands *b, conic_window *window) {
  int n_rows = (window->y_end - window->y_begin + b->render.tile - 1) / b->render.tile;
  int n_columns = (window->x_end - window->x_begin + b->render.tile - 1) / b->render.tile;
  if (n_rows > 1)
    window->y_end = window->y_begin + n_rows / 2 * b->render.tile;
  else if (n_columns > 1)
    window->x_end = window->x_begin + n_columns / 2 * b->render.tile;
}

/* Windows are chosen by estimates; where there is more in one than there is memory for, a part of it does. */
static conic_status gather_window(bands *b, conic_window *window) {
  const conic_layers_set *set = b->d->set;
  size_t most = (size_t)(b->most + 0.25 * b->most);
  for (;;) {
    double expected = expect_splats(b, window) / b->excess;
    int is_least =
        window->y_end - window->y_begin <= b->render.tile && window->x_end - window->x_begin <= b->render.tile;
    conic_status status = gather_band(b, window, 0, is_least ? 0 : most);
    if (status != CONIC_OK || !set->is_cut_short) {
      b->excess = expected > 0.0 ? 0.5 * (b->excess + (double)set->splats.count / expected) : b->excess;
      b->excess = b->excess > 0.25 ? b->excess : 0.25;
      return status;
    }
    b->excess *= 1.5;
    halve_window(b, window);
  }
}

static conic_status draw_window(bands *b, conic_window *window, conic_render_statistics *sum) {
  const conic_layers_band_drawing *d = b->d;
  conic_render_statistics band;
  conic_status status = gather_window(b, window);
  if (status == CONIC_OK)
    status = conic_render_window(d->renderer, &d->set->splats, d->camera, &b->render, window, d->image, &band);
  if (status == CONIC_OK)
    status = count_once(b, window, &band);
  if (status != CONIC_OK)
    return status;
  rename_window(d, window);
  add_band(&band, sum);
  return CONIC_OK;
}

static conic_status draw_whole(bands *b, const conic_window *whole, conic_render_statistics *statistics) {
  const conic_layers_band_drawing *d = b->d;
  conic_status status = gather_band(b, whole, 1, 0);
  if (status == CONIC_OK && d->is_gathered)
    d->is_gathered(d->data);
  if (status == CONIC_OK)
    status = conic_render_samples(d->layers->context, d->renderer, &d->set->splats, d->camera, d->render, d->samples,
                                  d->image, statistics);
  if (status == CONIC_OK)
    rename_window(d, whole);
  for (size_t i = 0; i < d->set->n_pieces; i++)
    *d->n_turned += d->set->pieces[i].n_turned;
  return status;
}

static conic_status draw_all_windows(bands *b, conic_render_statistics *statistics, int *n_bands) {
  const conic_layers_band_drawing *d = b->d;
  const conic_window whole = {0, d->camera->width, 0, d->camera->height};
  conic_window window = {0, d->camera->width, 0, 0};
  conic_status status = CONIC_OK;
  *n_bands = 1;
  if (expect_splats(b, &whole) <= b->most) /* all lies within it: this is no estimate, but of grazing places */
    return draw_whole(b, &whole, statistics);
  if (d->samples > 1)
    return conic_fail(
        d->layers->context, CONIC_ERROR_MEMORY,
        "%s: the picture needs more splats than memory is given; only with 1 sample a pixel is it drawn in windows",
        d->layers->name);
  memset(statistics, 0, sizeof *statistics);
  for (*n_bands = 0; status == CONIC_OK && next_window(b, &window); ++*n_bands)
    status = draw_window(b, &window, statistics);
  statistics->splats_culled = statistics->splats_in - statistics->splats_drawn - statistics->splats_skipped;
  return status;
}

conic_status conic_layers_draw_bands(const conic_layers_band_drawing *drawing, conic_render_statistics *statistics,
                                     int *n_bands) {
  conic_context *context = drawing->layers->context;
  bands b = {.d = drawing, .render = *drawing->render, .excess = 1.0};
  size_t most = conic_layers_drawing_bytes(drawing->layers) / CONIC_LAYERS_SPLAT_BYTES + 1;
  b.most = (double)most;
  b.chosen = conic_memory_allocate(context, drawing->cut->n, sizeof *b.chosen);
  conic_status status = b.chosen ? draw_all_windows(&b, statistics, n_bands) : CONIC_ERROR_MEMORY;
  conic_memory_release(context, b.chosen);
  return status;
}
