/* The context's members. */
#pragma once

#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>

#include "conic/context.h"

#define CONIC_MAX_THREADS 1024

typedef struct conic_pool conic_pool;

/* The system's identity of a file, whatever its names. */
typedef struct conic_file_identity {
  int is_there;
  uint64_t device, number, n_bytes;
} conic_file_identity;

/* A file that was read. */
typedef struct conic_noted_file {
  conic_file_identity file; /* of a URL, its size alone */
  char *path;
  int phase; /* when it was noted last */
} conic_noted_file;

/* Header of a block of memory that lasts as long as the context. */
typedef struct conic_lasting {
  struct conic_lasting *next;
} conic_lasting;

/* conic/loan.h */
typedef struct conic_loan {
  char *name;
  const void *what;
} conic_loan;

struct conic_context {
  conic_context_options options; /* allocate, release and threads are set */
  conic_pool *pool;
  _Atomic(conic_lasting *) lasting; /* the newest first */
  _Atomic(void *) kept[8];          /* blocks of memory; null: none */
  size_t texture_bytes;             /* of all textures that exist */
  int reads_texture;                /* the picture that is read will become a texture */
  int guards_inputs;                /* core/files/guard.h; so are the next members */
  conic_noted_file *inputs;         /* files that were read */
  size_t n_inputs, inputs_room;
  int inputs_phase;
  conic_file_identity replaceable;
  pthread_mutex_t outputs_lock;
  struct conic_output *outputs;                          /* core/files/file.h: outputs with temporary files */
  void (*watch_outputs)(void *cookie, const char *path); /* null: not called */
  void *watch_cookie;
  conic_loan *loans;
  size_t n_loans, loans_room;
  _Atomic(uint64_t) n_versions;  /* conic_context_next_version */
  const struct conic_team *team; /* core/base/team_runs.h; null: there is none */
};

/* A number for conic_render_options.splats_version: above all that a caller may give, and new in each call. */
uint64_t conic_context_next_version(conic_context *context);

/* Starts the threads beside the calling one, or as many as the system gives, and counts them. Errors: MEMORY. */
conic_status conic_pool_create(conic_context *context, conic_pool **pool);
void conic_pool_destroy(conic_context *context, conic_pool *pool);
