/* Strips of a picture: they cover it once, whatever is kept of it, and those that end it are smaller than the first. */
#include "core/base/memory.h"
#include "shots/strips/strip_list.h"
#include "source/source_kind.h"
#include "tests/support/check.h"

enum { WIDTH = 50, STEP = 16 };

static conic_context *context;

/* Nothing lies anywhere, so each pixel is as much work. */
/* NOLINTNEXTLINE(readability-non-const-parameter): other kinds weigh */
/* NOLINTNEXTLINE(readability-non-const-parameter): other kinds weigh */
static void weigh_nothing(const conic_source_windows *w, const conic_window *list, size_t n, double *weights) {
  (void)w, (void)list, (void)n, (void)weights;
}

static const conic_source_windowing windowing = {.weigh = weigh_nothing};
static const conic_source_kind kind = {.windowing = &windowing};

static int height_of(const conic_strip *strip) {
  return strip->y_end - strip->y_begin;
}

static int is_one_of(const conic_strip *strip, const conic_strip *kept, size_t n_kept) {
  for (size_t i = 0; i < n_kept; i++)
    if (kept[i].y_begin == strip->y_begin && kept[i].y_end == strip->y_end)
      return 1;
  return 0;
}

/* Returns how many are drawn. */
static size_t check_strips(int height, int band_rows, int most_rows, int n_processes, const conic_strip *kept,
                           size_t n_kept) {
  conic_source source = {.context = context, .kind = &kind};
  const conic_source_windows windows = {
      .source = &source, .camera = {.width = WIDTH, .height = height}, .step = STEP, .band_rows = band_rows};
  conic_strip *strips;
  size_t n, n_found = 0;
  int y = 0;
  CHECK_OK(conic_list_strips(&windows, kept, n_kept, STEP, most_rows, n_processes, &strips, &n));
  for (size_t i = 0; i < n; y = strips[i++].y_end) {
    const conic_strip *s = &strips[i];
    CHECK(s->y_begin == y && s->y_end > y);
    n_found += s->is_kept != 0;
    CHECK(s->is_kept == is_one_of(s, kept, n_kept));
    if (s->is_kept)
      continue;
    CHECK(height_of(s) <= most_rows && s->y_begin / band_rows == (s->y_end - 1) / band_rows);
    int is_cut = s->y_end % band_rows && s->y_end < height && (i + 1 == n || !strips[i + 1].is_kept);
    CHECK(!is_cut || height_of(s) % STEP == 0);
  }
  CHECK(y == height && n_found == n_kept);
  conic_memory_release(context, strips);
  return n - n_kept;
}

static void check_all_sizes(void) {
  static const conic_strip kept[] = {{0, 64, 1}, {64, 128, 1}, {304, 336, 1}, {2992, 3000, 1}}, all[] = {{0, 3000, 1}};
  for (int n_processes = 1; n_processes <= 64; n_processes *= 4) {
    CHECK(check_strips(3000, 3000, 3000, n_processes, NULL, 0) >= (size_t)n_processes);
    check_strips(3000, 3000, 256, n_processes, NULL, 0);
    check_strips(3000, 208, 96, n_processes, NULL, 0);
    check_strips(3000, 3000, 3000, n_processes, kept, 4);
    check_strips(3000, 304, 128, n_processes, kept, 2);
    CHECK(check_strips(3000, 3000, 3000, n_processes, all, 1) == 0);
    CHECK(check_strips(7, 7, 16, n_processes, NULL, 0) == 1);
  }
  CHECK(check_strips(3000, 3000, 3000, 1, NULL, 0) == 1);
}

static void check_end(void) {
  conic_source source = {.context = context, .kind = &kind};
  const conic_source_windows windows = {
      .source = &source, .camera = {.width = WIDTH, .height = 8000}, .step = STEP, .band_rows = 8000};
  conic_strip *strips;
  size_t n;
  CHECK_OK(conic_list_strips(&windows, NULL, 0, STEP, 8000, 4, &strips, &n));
  CHECK(height_of(&strips[0]) <= 8000 / 4 && height_of(&strips[0]) >= 8000 / 9);
  CHECK(height_of(&strips[n - 1]) * 4 <= height_of(&strips[0]));
  conic_memory_release(context, strips);
}

int main(void) {
  context = check_context(1);
  check_all_sizes();
  check_end();
  conic_context_destroy(context);
  return check_result();
}
