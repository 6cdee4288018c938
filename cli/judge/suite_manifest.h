/* A suite's manifest, as far as judging needs it. */
#pragma once

#include "core/files/json_read.h"
#include "core/files/sha256.h"

enum { SUITE_NAME_ROOM = 96, SUITE_WORD_ROOM = 64 };

/* A case. Names consist of letters, digits, points, hyphens and underscores; paths of such names, none of which begins
 * with a point. */
typedef struct suite_entry {
  char name[SUITE_NAME_ROOM], scene[SUITE_WORD_ROOM], profile[SUITE_WORD_ROOM], npy[2 * SUITE_NAME_ROOM];
  char ply[2 * SUITE_NAME_ROOM], camera[2 * SUITE_NAME_ROOM]; /* of the scene; and of its camera in conic's own JSON */
  char colors[SUITE_WORD_ROOM]; /* "linear": codes are encoded by sRGB's curve; empty: colours are display values */
  char stage[SUITE_WORD_ROOM];  /* of a renderer, that the scene tests most; empty: not told */
  int level, width, height;
  int step;                       /* every so many pixels are judged; 0: all */
  uint64_t bytes;                 /* of the .npy */
  char sha256[CONIC_SHA256_ROOM]; /* of the .npy */
} suite_entry;

typedef struct suite_manifest {
  char floats[SUITE_WORD_ROOM];
  size_t n_cases;
  suite_entry *cases; /* in the file's order */
} suite_manifest;

/* Reads a manifest. On success the caller releases it; on failure it is empty. Errors: INPUT (also an unknown version),
 * MEMORY. */
conic_status cli_suite_read_manifest(conic_context *context, const char *path, suite_manifest *manifest);
void cli_suite_release_manifest(conic_context *context, suite_manifest *manifest);
