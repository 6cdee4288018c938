/* A process of its own in which the bridge to Assimp reads a file. If it breaks down there, takes memory or time beyond
 * reason, or says something on a terminal, that is the end of that process only. */
#ifndef CONIC_ASSIMP_PROCESS_H
#define CONIC_ASSIMP_PROCESS_H

#include <sys/types.h>

#include "conic/context.h"
#include "core/assimp/assimp_bridge.h"

typedef struct conic_assimp_process {
  conic_context *context;
  const char *name; /* of the file, for messages */
  pid_t id;         /* 0: none */
  int descriptor;   /* what it writes */
} conic_assimp_process;

/* Starts it; `request` needs no descriptor. On success the caller ends it. Errors: IO. */
conic_status conic_assimp_process_start(conic_context *context, const char *name,
                                        const conic_assimp_bridge_functions *bridge, conic_assimp_request request,
                                        conic_assimp_process *process);

/* Takes the next bytes that it writes. Errors: INPUT (it has ended before), CANCELLED. */
conic_status conic_assimp_process_take(conic_assimp_process *process, void *bytes, size_t n_bytes);

/* Whatever it is at. */
void conic_assimp_process_end(conic_assimp_process *process);

#endif
