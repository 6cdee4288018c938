#include "core/assimp/assimp_process.h"
#include "core/base/base.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

enum { POLL_MILLISECONDS = 50 };

conic_status conic_assimp_process_start(conic_context *context, const char *name,
                                        const conic_assimp_bridge_functions *bridge, conic_assimp_request request,
                                        conic_assimp_process *process) {
  int ends[2];
  *process = (conic_assimp_process){.context = context, .name = name, .descriptor = -1};
  if (pipe(ends) != 0)
    return conic_fail(context, CONIC_ERROR_IO, "%s: cannot read: %s", name, strerror(errno));
  fcntl(ends[0], F_SETFD, FD_CLOEXEC);
  fcntl(ends[1], F_SETFD, FD_CLOEXEC);
  pid_t id = fork();
  if (id == 0) {
    close(ends[0]);
    request.descriptor = ends[1];
    bridge->read(&request); /* and that ends the process */
  }
  close(ends[1]);
  if (id < 0) {
    close(ends[0]);
    return conic_fail(context, CONIC_ERROR_IO, "%s: cannot read: no process for it: %s", name, strerror(errno));
  }
  process->id = id;
  process->descriptor = ends[0];
  return CONIC_OK;
}

/* Says why there is no more to read. */
static conic_status explain_end(conic_assimp_process *process) {
  int state = 0;
  pid_t ended = 0;
  while (process->id > 0 && (ended = waitpid(process->id, &state, 0)) < 0 && errno == EINTR)
    ;
  process->id = 0;
  int is_slow = ended > 0 && WIFSIGNALED(state) && WTERMSIG(state) == SIGXCPU;
  return conic_fail(process->context, CONIC_ERROR_INPUT,
                    is_slow ? "%s: cannot read: Assimp takes too long for it"
                            : "%s: cannot read: the file is spoiled in a way that Assimp does not survive",
                    process->name);
}

conic_status conic_assimp_process_take(conic_assimp_process *process, void *bytes, size_t n_bytes) {
  for (size_t done = 0; done < n_bytes;) {
    struct pollfd wait = {.fd = process->descriptor, .events = POLLIN};
    int n_ready = poll(&wait, 1, POLL_MILLISECONDS);
    if (n_ready == 0 || (n_ready < 0 && errno == EINTR)) {
      conic_status status = conic_progress(process->context, "read", 0.5);
      if (status != CONIC_OK)
        return status;
      continue;
    }
    ssize_t n = read(process->descriptor, (char *)bytes + done, n_bytes - done);
    if (n < 0 && errno == EINTR)
      continue;
    if (n <= 0)
      return explain_end(process);
    done += (size_t)n;
  }
  return CONIC_OK;
}

void conic_assimp_process_end(conic_assimp_process *process) {
  if (process->id > 0) {
    kill(process->id, SIGKILL);
    while (waitpid(process->id, NULL, 0) < 0 && errno == EINTR)
      ;
  }
  if (process->descriptor >= 0)
    close(process->descriptor);
  *process = (conic_assimp_process){.descriptor = -1};
}
