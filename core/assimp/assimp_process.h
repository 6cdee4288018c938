/* A process of its own in which the bridge to Assimp reads a file. If it crashes, takes too much memory or time, or
 * writes to a terminal, only that process ends. */
#pragma once

#include <sys/types.h>

#include "conic/context.h"
#include "core/assimp/assimp_bridge.h"

typedef struct conic_assimp_process {
  conic_context *context;
  const char *name; /* of the file, for messages */
  pid_t id;         /* 0: none */
  int descriptor;   /* where its output comes from */
} conic_assimp_process;

/* Starts the process; `request` needs no descriptor. On success the caller ends it. Errors: IO. */
conic_status conic_assimp_process_start(conic_context *context, const char *name,
                                        const conic_assimp_bridge_functions *bridge, conic_assimp_request request,
                                        conic_assimp_process *process);

/* Takes the next bytes of its output. Errors: INPUT (it has ended before), CANCELLED. */
conic_status conic_assimp_process_take(conic_assimp_process *process, void *bytes, size_t n_bytes);

/* Ends the process at once. */
void conic_assimp_process_end(conic_assimp_process *process);
