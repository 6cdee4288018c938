/* The keys of a motion as their file has them. */
#ifndef CONIC_MOTION_FILE_H
#define CONIC_MOTION_FILE_H

#include "conic/context.h"

enum { CONIC_MOTION_MOST_KEYS = 100000, CONIC_MOTION_NAME_ROOM = 1024, CONIC_MOTION_ALL = -1 };

/* Where an input is at a moment, or what shape it has. */
typedef struct conic_motion_key {
  int input; /* from 0; or CONIC_MOTION_ALL */
  int has_matrix;
  double frame, matrix[3][4];
  char *file; /* null: it is a pose */
} conic_motion_key;

typedef struct conic_motion_keys {
  conic_motion_key *keys; /* by frame, ascending; of one frame as the file has them */
  size_t count, room;
} conic_motion_keys;

/* Reads the file. What is there after a failure is released, too. Errors: INPUT, MEMORY. */
conic_status conic_motion_keys_read(conic_context *context, const char *path, conic_motion_keys *keys);
void conic_motion_keys_release(conic_context *context, conic_motion_keys *keys);

#endif
