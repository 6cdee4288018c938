#include "core/splats/clip.h"

#include <string.h>

void conic_clip_filter(conic_splats *splats, int (*is_dropped)(const void *cookie, uint32_t splat),
                       const void *cookie) {
  size_t n_kept = 0;
  for (size_t i = 0; i < splats->n_clips; i++)
    if (!is_dropped(cookie, splats->clips[i].splat))
      splats->clips[n_kept++] = splats->clips[i];
  splats->n_clips = n_kept;
}

/* Leaves the lines that are some. Returns whether all were. */
static int keep_lines(conic_clip *clip) {
  uint16_t n_lines = 0;
  int were_all = clip->n_lines >= 1 && clip->n_lines <= 2;
  for (int i = 0; i < clip->n_lines && i < 2; i++)
    if (conic_clip_is_line(clip->lines[i]))
      memmove(clip->lines[n_lines++], clip->lines[i], sizeof clip->lines[i]);
    else
      were_all = 0;
  clip->n_lines = n_lines;
  return were_all;
}

size_t conic_splats_repair_clips(conic_splats *splats) {
  size_t n_kept = 0, n_wrong = 0;
  for (size_t i = 0; i < splats->n_clips; i++) {
    conic_clip clip = splats->clips[i];
    int is_in_order = clip.splat < splats->count && (n_kept == 0 || splats->clips[n_kept - 1].splat < clip.splat);
    n_wrong += !keep_lines(&clip) || !is_in_order;
    if (clip.n_lines && is_in_order)
      splats->clips[n_kept++] = clip;
  }
  splats->n_clips = n_kept;
  return n_wrong;
}
