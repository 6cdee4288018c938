/* The keys of a motion, as in their file. */
#pragma once

#include "conic/motion.h"

enum { CONIC_MOTION_MOST_KEYS = 100000, CONIC_MOTION_NAME_ROOM = 1024, CONIC_MOTION_ALL = -1 };

/* An input's place at a moment, or its shape. */
typedef struct conic_motion_key {
  int input; /* from 0; or CONIC_MOTION_ALL */
  int has_matrix;
  double frame, matrix[3][4];
  char *file; /* null: the key is a pose */
} conic_motion_key;

typedef struct conic_motion_keys {
  conic_motion_key *keys; /* by frame, ascending; keys of one frame in the file's order */
  size_t count, room;
} conic_motion_keys;

/* Reads the file. The caller releases the keys, after a failure, too. Errors: INPUT, MEMORY. */
conic_status conic_motion_keys_read(conic_context *context, const char *path, conic_motion_keys *keys);
void conic_motion_keys_release(conic_context *context, conic_motion_keys *keys);

/* Where the inputs are at a moment, in frames: n poses that stay until the next question. Errors: as
 * conic_motion_apply. */
conic_status conic_motion_find(conic_motion *motion, double frame, const conic_source_pose **poses, size_t *n);
