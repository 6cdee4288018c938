/* The context's inside. */
#ifndef CONIC_CONTEXT_STRUCT_H
#define CONIC_CONTEXT_STRUCT_H

#include "conic/context.h"

#define CONIC_MAX_THREADS 1024

typedef struct conic_pool conic_pool;

struct conic_context {
  conic_context_options options; /* allocate, release and threads are set */
  conic_pool *pool;
};

/* Starts the threads beside the calling one; fewer where the system gives fewer, and counts them. Errors: MEMORY. */
conic_status conic_pool_create(conic_context *context, conic_pool **pool);
void conic_pool_destroy(conic_context *context, conic_pool *pool);

#endif
