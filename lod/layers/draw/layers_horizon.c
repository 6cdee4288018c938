#include "lod/layers/draw/layers_horizon.h"

#include "core/base/base.h"

enum { CELL_BITS = 3, MOST_CELLS = 4 };

conic_status conic_horizon_open(conic_context *context, int width, int height, conic_horizon *horizon) {
  memset(horizon, 0, sizeof *horizon);
  horizon->width = width;
  horizon->height = height;
  horizon->pixels = conic_memory_allocate_zeroed(context, (size_t)width * (size_t)height, sizeof *horizon->pixels);
  if (!horizon->pixels)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < CONIC_HORIZON_LEVELS; i++) {
    int cell = 1 << (CELL_BITS + i);
    int w = horizon->levels[i].width = (width + cell - 1) / cell;
    int h = horizon->levels[i].height = (height + cell - 1) / cell;
    horizon->levels[i].cells = conic_memory_allocate_zeroed(context, (size_t)w * (size_t)h, sizeof(float));
    if (!horizon->levels[i].cells)
      return CONIC_ERROR_MEMORY;
    horizon->n_levels = i + 1;
    if (w == 1 && h == 1)
      break;
  }
  return CONIC_OK;
}

void conic_horizon_close(conic_context *context, conic_horizon *horizon) {
  for (int i = 0; i < CONIC_HORIZON_LEVELS; i++)
    conic_memory_release(context, horizon->levels[i].cells);
  conic_memory_release(context, horizon->pixels);
  memset(horizon, 0, sizeof *horizon);
}

static float least_of(const float *values, int stride, int x_begin, int x_end, int y_begin, int y_end) {
  float least = values[(size_t)y_begin * (size_t)stride + (size_t)x_begin];
  for (int y = y_begin; y < y_end; y++)
    for (int x = x_begin; x < x_end; x++) {
      float value = values[(size_t)y * (size_t)stride + (size_t)x];
      least = value < least ? value : least;
    }
  return least;
}

static void update_row(void *data, size_t i_row) {
  conic_horizon *h = data;
  int y = (int)i_row << CELL_BITS, cell = 1 << CELL_BITS;
  for (int i = 0; i < h->levels[0].width; i++)
    h->levels[0].cells[i_row * (size_t)h->levels[0].width + (size_t)i] = least_of(
        h->pixels, h->width, i * cell, conic_least((i + 1) * cell, h->width), y, conic_least(y + cell, h->height));
}

void conic_horizon_update(conic_context *context, conic_horizon *horizon) {
  conic_parallel_for(context, (size_t)horizon->levels[0].height, update_row, horizon);
  for (int i = 1; i < horizon->n_levels; i++) {
    const int w = horizon->levels[i - 1].width, h = horizon->levels[i - 1].height;
    for (int y = 0; y < horizon->levels[i].height; y++)
      for (int x = 0; x < horizon->levels[i].width; x++)
        horizon->levels[i].cells[(size_t)y * (size_t)horizon->levels[i].width + (size_t)x] = least_of(
            horizon->levels[i - 1].cells, w, 2 * x, conic_least(2 * x + 2, w), 2 * y, conic_least(2 * y + 2, h));
  }
}

float conic_horizon_least(const conic_horizon *horizon, const conic_window *window) {
  int width = window->x_end - window->x_begin, height = window->y_end - window->y_begin, level = 0;
  while (level + 1 < horizon->n_levels &&
         (width >> (CELL_BITS + level) >= MOST_CELLS || height >> (CELL_BITS + level) >= MOST_CELLS))
    level++;
  int bits = CELL_BITS + level;
  return least_of(horizon->levels[level].cells, horizon->levels[level].width, window->x_begin >> bits,
                  ((window->x_end - 1) >> bits) + 1, window->y_begin >> bits, ((window->y_end - 1) >> bits) + 1);
}
