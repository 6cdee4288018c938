#include "raster/frame/raster_frame.h"

#include "raster/project/clip_lines.h"

/* Cuts a span off at low and high, and counts it from low on. */
static void cut_off(int low, int high, uint16_t *begin, uint16_t *end) {
  int first = *begin > low ? *begin : low, last = *end < high ? *end : high;
  *begin = (uint16_t)(first - low);
  *end = (uint16_t)(last > first ? last - low : first - low);
}

void conic_chunk_find_bands(int band_bits, conic_projected *projected, conic_chunk *chunk) {
  for (size_t i = 0; i < chunk->n_drawn; i++) {
    const conic_box *box = &projected->boxes[i];
    unsigned meets = (2u << ((box->y_end - 1) >> band_bits)) - (1u << (box->y_begin >> band_bits));
    projected->bands[projected->surfaces[i].index] = (unsigned char)meets;
    chunk->bands |= meets;
  }
}

void conic_chunk_keep_window(const conic_window *window, conic_projected *projected, conic_chunk *chunk) {
  size_t n = 0;
  for (size_t i = 0; i < chunk->n_drawn; i++) {
    conic_box box = projected->boxes[i];
    cut_off(window->x_begin, window->x_end, &box.x_begin, &box.x_end);
    cut_off(window->y_begin, window->y_end, &box.y_begin, &box.y_end);
    if (conic_box_is_empty(&box))
      continue;
    projected->boxes[n] = box;
    if (n != i) {
      projected->footprints[n] = projected->footprints[i];
      projected->surfaces[n] = projected->surfaces[i];
      if (projected->clips && conic_is_clipped(&projected->footprints[n]))
        projected->clips[n] = projected->clips[i];
    }
    n++;
  }
  chunk->n_elsewhere += chunk->n_drawn - n;
  chunk->n_drawn = n;
}

/* Of what is not an ellipse, no record tells all. */
static void count_one_by_one(const conic_view *view, const conic_splats *splats, size_t begin, size_t end,
                             const unsigned char *is_counted, conic_chunk *sum) {
  conic_footprint footprint;
  conic_box box;
  conic_projected_surface surface;
  conic_ray ray;
  conic_projected at = {.footprints = &footprint, .boxes = &box, .surfaces = &surface, .rays = &ray};
  for (size_t i = begin; i < end; i++) {
    conic_chunk one = {.n_drawn = 0};
    if (is_counted[i])
      continue;
    conic_project_one(view, splats, i, &at, &one);
    conic_chunk_add(&one, sum);
  }
}

void conic_chunk_count_others(const conic_view *view, const conic_splats *splats, size_t begin, size_t end,
                              const unsigned char *is_counted, const conic_projected *projected,
                              const conic_chunk *chunk, conic_chunk *sum) {
  if (chunk->n_skipped || chunk->n_fallback || chunk->n_rays) {
    count_one_by_one(view, splats, begin, end, is_counted, sum);
    return;
  }
  size_t n = 0;
  for (size_t i = 0; i < chunk->n_drawn; i++)
    n += !is_counted[projected->surfaces[i].index];
  sum->n_drawn += n;
}
