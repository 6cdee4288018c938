/* Windows and WebAssembly cannot fork a process, so Assimp reads no files there: they might crash it. */
#include "core/assimp/assimp_process.h"

#include "core/base/message.h"

conic_status conic_assimp_process_start(conic_context *context, const char *name,
                                        const conic_assimp_bridge_functions *bridge, conic_assimp_request request,
                                        conic_assimp_process *process) {
  (void)bridge, (void)request;
  *process = (conic_assimp_process){.context = context, .name = name, .descriptor = -1};
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: cannot read: Assimp is not used on this system", name);
}

conic_status conic_assimp_process_take(conic_assimp_process *process, void *bytes, size_t n_bytes) {
  (void)bytes, (void)n_bytes;
  return conic_fail(process->context, CONIC_ERROR_UNSUPPORTED, "%s: cannot read: nothing is at it", process->name);
}

void conic_assimp_process_end(conic_assimp_process *process) {
  (void)process;
}
