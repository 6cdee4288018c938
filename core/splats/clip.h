/* Clip lines as they are kept: which lines count, and how records are found and made. */
#pragma once

#include "conic/splats.h"
#include "core/base/real.h"

/* Whether it is a line at all: finite, and with a direction. */
static inline int conic_clip_is_line(const float line[3]) {
  return (line[0] + line[1] + line[2]) * 0.0f == 0.0f && (line[0] != 0.0f || line[1] != 0.0f);
}

/* The first record whose splat is not below `splat`. */
static inline size_t conic_clip_find(const conic_splats *splats, size_t splat) {
  size_t begin = 0;
  CONIC_BISECT(begin, splats->n_clips, splats->clips[middle].splat < splat);
  return begin;
}

/* Drops the records of the splats for which `is_dropped` answers other than 0. */
void conic_clip_filter(conic_splats *splats, int (*is_dropped)(const void *cookie, uint32_t splat), const void *cookie);
