/* A picture that nobody holds: drawn in strips, and written row by row, to the EXR file that it would become at once.
 */
#pragma once

#include "shots/stage.h"

/* A file that strips become. */
typedef struct conic_strips_wish {
  const char *path;
  unsigned written; /* of the planes that are drawn, as bits, those that it has */
  const conic_image_options *writing;
  uint64_t strip_bytes; /* a strip's pixels at most, but for the least that there may be */
  uint64_t *hashes;     /* of the planes that are written, as conic_image_hash; null: they are not wanted */
  void *cookie;         /* of the functions, which may be null */
  /* Sets the attributes of the header, by the statistics of any strip. */
  void (*describe)(void *cookie, const conic_camera *camera, const conic_render_statistics *statistics,
                   conic_image *header);
  /* Is told, where there are some, how many rows were finished. */
  void (*found)(void *cookie, int n_rows);

  /* What is finished is kept in PATH.part and PATH.strips (shots/strips_file.h) until all is. */
  const char *key; /* of the picture, CONIC_SHA256_ROOM; null: it is not kept */
  int goes_on;     /* with what was kept, */
  int may_begin;   /* or, where nothing was, from the start */
} conic_strips_wish;

/* Draws the begun work into a file, by all processes where windows are what they share: then collective. In the first
 * process the outcome is the picture's. Errors: as conic_source_draw; IO, ARGUMENT; INPUT (what was kept is of another
 * picture). */
conic_status conic_strips_draw(conic_shot_work *work, const conic_camera *camera, const conic_strips_wish *wish,
                               conic_render_statistics *statistics);
