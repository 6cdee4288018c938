#include "shots/windows.h"

#include "core/image/image_common.h"
#include "raster/frame/statistics.h"

/* Windows a process: so many that those who are early have something to take, so few that the splats, which each
 * projects, are not most of the work. Where they are dealt out nobody takes more, and each has to get as much to do. */
enum { WINDOWS_EACH = 6, DEALT_EACH = 16, LEAST_SIDE = 64 };

/* What is handed over before a window's pixels. */
typedef struct window_result {
  uint64_t i_window;
} window_result;

/* What a process has counted of its windows. */
typedef struct window_sum {
  uint64_t n_windows, tallies[CONIC_SOURCE_TALLIES];
  conic_render_statistics statistics;
} window_sum;

typedef struct window_work {
  const conic_shot_work *work;
  const conic_executor *executor;
  conic_source_windows windows;
  conic_window *list; /* the hardest first */
  double *weights;
  int *owners; /* null: they are not dealt out */
  size_t n;
  unsigned planes;
  conic_image *image; /* of the first process: the whole */
  conic_window_counts counts;
} window_work;

/* --- the list --- */

static int round_to_step(double length, int step) {
  int side = (int)length;
  side = side < LEAST_SIDE ? LEAST_SIDE : side;
  return (side + step - 1) / step * step;
}

/* Squares, as far as bands and the picture's borders have them be. */
static conic_status list_windows(window_work *w, int side) {
  const conic_camera *camera = &w->windows.camera;
  int rows = w->windows.band_rows;
  size_t columns = (size_t)((camera->width + side - 1) / side), n_bands = (size_t)((camera->height + rows - 1) / rows),
         most = columns * n_bands * (size_t)((rows + side - 1) / side);
  if (conic_memory_allocate_these(w->work->context, CONIC_ROOM(w->list, most), CONIC_ZEROED(w->weights, most)) !=
      CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (int band = 0; band < camera->height; band += rows) {
    int band_end = camera->height - band < rows ? camera->height : band + rows;
    for (int y = band; y < band_end; y += side)
      for (int x = 0; x < camera->width; x += side)
        w->list[w->n++] = (conic_window){x, camera->width - x < side ? camera->width : x + side, y,
                                         band_end - y < side ? band_end : y + side};
  }
  return CONIC_OK;
}

static int band_of(const window_work *w, size_t i) {
  return w->list[i].y_begin / w->windows.band_rows;
}

/* Band by band, and of each the hardest first, so that the last ones, which others wait for, are easy; windows of one
 * weight stay in order. */
static void order_windows(window_work *w) {
  conic_source_windows_weigh(&w->windows, w->list, w->n, w->weights);
  for (size_t i = 1; i < w->n; i++) {
    conic_window window = w->list[i];
    double weight = w->weights[i];
    size_t at = i;
    for (; at > 0 && w->weights[at - 1] < weight && band_of(w, at - 1) == window.y_begin / w->windows.band_rows; at--) {
      w->list[at] = w->list[at - 1];
      w->weights[at] = w->weights[at - 1];
    }
    w->list[at] = window;
    w->weights[at] = weight;
  }
}

static conic_status choose_windows(window_work *w) {
  const conic_camera *camera = &w->windows.camera;
  int each = conic_source_windows_are_dealt(&w->windows) ? DEALT_EACH : WINDOWS_EACH;
  double pixels = (double)camera->width * (double)camera->height / (double)(w->executor->cut_for * each), side = 1.0;
  while (side * side < pixels)
    side += CONIC_WINDOW_STEP;
  conic_status status = list_windows(w, round_to_step(side, w->windows.step));
  if (status == CONIC_OK && !conic_source_windows_are_dealt(&w->windows))
    order_windows(w);
  return status;
}

/* --- pixels on their way --- */

static size_t window_bytes(const window_work *w, const conic_window *window) {
  return conic_planes_pixel_bytes(w->planes) * (size_t)(window->x_end - window->x_begin) *
         (size_t)(window->y_end - window->y_begin);
}

/* On the first process, of each window, its own included: where its pixels belong. */
static void place_plane(const window_work *w, const conic_window *window, conic_plane plane, const void *pixels) {
  size_t size = conic_planes_pixel_bytes(1u << plane), n_bytes = (size_t)(window->x_end - window->x_begin) * size;
  const char *row = pixels;
  for (int y = window->y_begin; y < window->y_end; y++, row += n_bytes)
    memcpy((char *)w->image->planes[plane] + ((size_t)y * (size_t)w->image->width + (size_t)window->x_begin) * size,
           row, n_bytes);
}

static void take_window(void *cookie, int from, const void *bytes, size_t n_bytes) {
  window_work *w = cookie;
  window_result result;
  conic_moment start = conic_moment_now();
  const char *pixels = (const char *)bytes + sizeof result;
  memcpy(&result, bytes, sizeof result);
  const conic_window *window = &w->list[result.i_window];
  size_t n = (size_t)(window->x_end - window->x_begin) * (size_t)(window->y_end - window->y_begin);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (w->planes >> i & 1) {
      place_plane(w, window, (conic_plane)i, pixels);
      pixels += n * conic_planes_pixel_bytes(1u << i);
    }
  conic_work_trace(w->work, "join", "window", result.i_window, start, n_bytes);
  (void)from;
}

static void keep_window(const window_work *w, size_t i_window, const conic_image *pixels) {
  conic_moment start = conic_moment_now();
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (w->planes >> i & 1)
      place_plane(w, &w->list[i_window], (conic_plane)i, pixels->planes[i]);
  conic_work_trace(w->work, "join", "window", i_window, start, window_bytes(w, &w->list[i_window]));
}

static conic_status hand_window(const window_work *w, size_t i_window, const conic_image *pixels) {
  window_result result = {i_window};
  size_t at = sizeof result, n = conic_image_pixels(pixels);
  size_t n_bytes = sizeof result + window_bytes(w, &w->list[i_window]);
  char *bytes = conic_memory_allocate(w->work->context, n_bytes, 1);
  if (!bytes)
    return CONIC_ERROR_MEMORY;
  memcpy(bytes, &result, sizeof result);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (w->planes >> i & 1) {
      memcpy(bytes + at, pixels->planes[i], n * conic_planes_pixel_bytes(1u << i));
      at += n * conic_planes_pixel_bytes(1u << i);
    }
  w->executor->hand(w->executor->data, bytes, n_bytes);
  conic_memory_release(w->work->context, bytes);
  return CONIC_OK;
}

/* --- dealing --- */

conic_status conic_shot_windows_deal(const conic_shot_work *work, conic_source_windows *windows,
                                     const conic_window *list, size_t n, int is_in_order, int **owners) {
  *owners = NULL;
  if (!conic_source_windows_are_dealt(windows))
    return CONIC_OK;
  conic_moment start = conic_moment_now();
  *owners = conic_memory_allocate_zeroed(work->context, n, sizeof **owners);
  conic_status status = conic_work_agree(work, *owners ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK)
    status = conic_source_windows_deal(windows, list, n, is_in_order, *owners);
  conic_work_trace(work, "open", "splats", 0, start, 0);
  return conic_work_agree(work, status);
}

/* --- what is counted --- */

void conic_windows_count(const conic_source_windows *windows, const conic_render_statistics *drawn,
                         conic_window_counts *counts) {
  counts->n_windows++;
  if (windows->is_summed)
    conic_statistics_add(drawn, &counts->statistics);
  else
    conic_statistics_add_pixels(drawn, &counts->statistics);
}

/* Times stay the first process's, as does what is not in the memory of both. */
static void add_window_sum(conic_source_windows *windows, const window_sum *other, conic_window_counts *counts) {
  conic_render_statistics part = other->statistics;
  if (!other->n_windows)
    return;
  memset(&part.ms, 0, sizeof part.ms);
  part.isa = counts->statistics.isa;
  part.threads = counts->statistics.threads;
  conic_windows_count(windows, &part, counts);
  for (int i = 0; i < CONIC_SOURCE_TALLIES; i++)
    windows->tallies[i] += other->tallies[i];
}

conic_status conic_windows_sum(const conic_shot_work *work, conic_source_windows *windows,
                               conic_window_counts *counts) {
  const conic_team *team = work->executor->team;
  window_sum own = {.n_windows = counts->n_windows, .statistics = counts->statistics};
  memcpy(own.tallies, windows->tallies, sizeof own.tallies);
  if (team) {
    window_sum *all = conic_memory_allocate(work->context, (size_t)team->count, sizeof *all);
    conic_status status = conic_work_agree(work, all ? CONIC_OK : CONIC_ERROR_MEMORY);
    if (status == CONIC_OK)
      conic_team_collect(team, &own, sizeof own, all);
    for (int i = 1; status == CONIC_OK && team->index == 0 && i < team->count; i++)
      add_window_sum(windows, &all[i], counts);
    conic_memory_release(work->context, all);
    if (status != CONIC_OK || team->index > 0)
      return status;
  }
  return conic_source_windows_count(windows, &counts->statistics);
}

/* --- drawing --- */

static conic_status draw_given_window(window_work *w, size_t i_window) {
  const conic_window *window = &w->list[i_window];
  conic_context *context = w->work->context;
  conic_image pixels;
  conic_moment start = conic_moment_now();
  conic_status status = conic_image_allocate(context, window->x_end - window->x_begin, window->y_end - window->y_begin,
                                             w->planes, &pixels);
  if (status != CONIC_OK)
    return status;
  conic_render_statistics drawn;
  status = conic_source_windows_draw(&w->windows, window, &pixels, &drawn);
  if (w->image)
    w->image->is_display = pixels.is_display;
  if (status == CONIC_OK) {
    conic_windows_count(&w->windows, &drawn, &w->counts);
    if (w->executor->index > 0)
      status = hand_window(w, i_window, &pixels);
    else
      keep_window(w, i_window, &pixels);
  }
  conic_image_release(context, &pixels);
  w->executor->did(w->executor->data, "window", i_window, start, window_bytes(w, window));
  return status;
}

static conic_status draw_next(window_work *w, size_t i_window) {
  conic_status status = conic_progress(w->work->context, "draw", (double)i_window / (double)w->n);
  return status == CONIC_OK ? draw_given_window(w, i_window) : status;
}

/* The first one is the first process's: what stands for all in its statistics is the picture's. */
static conic_status draw_given(window_work *w) {
  uint64_t unit;
  const conic_executor *executor = w->executor;
  executor->share(executor->data, w->owners ? 0 : (uint64_t)w->n - 1, executor->index == 0 ? take_window : NULL, w);
  conic_status status = w->executor->index == 0 ? draw_given_window(w, 0) : CONIC_OK;
  for (size_t i = 1; w->owners && i < w->n && status == CONIC_OK; i++)
    status = w->owners[i] == w->executor->index ? draw_next(w, i) : CONIC_OK;
  while (!w->owners && status == CONIC_OK && (unit = executor->next(executor->data)) != CONIC_NO_UNIT)
    status = draw_next(w, (size_t)unit + 1);
  return status;
}

conic_status conic_windows_draw_together(const conic_shot_work *work, const conic_look *look, conic_image *image,
                                         conic_render_statistics *statistics) {
  window_work w = {.work = work, .executor = work->executor, .image = image};
  conic_moment start = conic_moment_now();
  const conic_camera *camera = look->camera;
  w.planes = (conic_image_planes(image) ? conic_image_planes(image) : work->planes) & CONIC_WINDOWS_PLANES;
  conic_status status = conic_source_windows_begin(work->surfaces, work->renderer, camera, look->render, look->view,
                                                   w.planes, &w.windows);
  w.windows.other_bytes = w.executor->index == 0
                              ? conic_planes_pixel_bytes(w.planes) * (uint64_t)camera->width * (uint64_t)camera->height
                              : 0;
  if (status == CONIC_OK)
    status = choose_windows(&w);
  conic_work_trace(work, "open", "picture", 0, start, 0);
  status = conic_work_agree(work, status);
  if (status == CONIC_OK)
    status = conic_shot_windows_deal(work, &w.windows, w.list, w.n, 0, &w.owners);
  if (status == CONIC_OK)
    status = conic_work_agree(work, draw_given(&w));
  if (status == CONIC_OK)
    status = conic_windows_sum(work, &w.windows, &w.counts);
  conic_source_windows_end(&w.windows);
  *statistics = w.counts.statistics;
  statistics->ms.frame = 1e3 * (conic_seconds_now() - start.clock_s);
  conic_memory_release_these(work->context, w.list, w.weights, w.owners);
  return status;
}
