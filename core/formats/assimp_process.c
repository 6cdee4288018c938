#include "core/formats/assimp_process.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/message.h"

enum { POLL_MILLISECONDS = 50 };

/* What any file may take beyond what it takes by its size. */
static const uint64_t least_memory_bytes = UINT64_C(2) << 30, least_seconds = 60;
static const uint64_t memory_per_byte = 64, bytes_per_second = 100000;

static void set_limit(int resource, uint64_t most) {
  struct rlimit limit;
  if (getrlimit(resource, &limit) != 0)
    return;
  limit.rlim_cur = limit.rlim_max == RLIM_INFINITY || most < limit.rlim_max ? (rlim_t)most : limit.rlim_max;
  setrlimit(resource, &limit);
}

/* Address space that is there already (a sanitizer has much); 0 where it cannot be told. */
static uint64_t own_address_space(void) {
  unsigned long long pages = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  int n = file ? fscanf(file, "%llu", &pages) : 0;
  if (file)
    fclose(file);
  return n == 1 ? pages * (uint64_t)sysconf(_SC_PAGESIZE) : 0;
}

/* From here on this is the new process: it says nothing, ends with its parent, and dies of what it does wrong. */
static void settle(uint64_t address_space, size_t n_bytes, pid_t parent) {
  static const int signals[] = {SIGSEGV, SIGBUS,  SIGFPE,  SIGILL,  SIGABRT, SIGINT,
                                SIGTERM, SIGPIPE, SIGXCPU, SIGALRM, SIGCHLD, SIGHUP};
  for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
    signal(signals[i], SIG_DFL);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent)
    _exit(1);
  int nowhere = open("/dev/null", O_RDWR);
  for (int descriptor = 0; descriptor < 3; descriptor++)
    dup2(nowhere, descriptor);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_CPU, least_seconds + n_bytes / bytes_per_second);
  if (address_space)
    set_limit(RLIMIT_AS, address_space + least_memory_bytes + memory_per_byte * n_bytes);
}

conic_status conic_assimp_process_start(conic_context *context, const char *name,
                                        const conic_assimp_bridge_functions *bridge, conic_assimp_request request,
                                        conic_assimp_process *process) {
  int ends[2];
  uint64_t address_space = own_address_space();
  pid_t parent = getpid();
  *process = (conic_assimp_process){.context = context, .name = name, .descriptor = -1};
  if (pipe(ends) != 0)
    return conic_fail(context, CONIC_ERROR_IO, "%s: cannot read: %s", name, strerror(errno));
  pid_t id = fork();
  if (id == 0) {
    close(ends[0]);
    /* Not one of those that settling redirects. */
    request.descriptor = fcntl(ends[1], F_DUPFD, 3);
    settle(address_space, request.n_bytes, parent);
    bridge->read(&request);
    _exit(0);
  }
  close(ends[1]);
  if (id < 0) {
    close(ends[0]);
    return conic_fail(context, CONIC_ERROR_IO, "%s: cannot read: no process for it: %s", name, strerror(errno));
  }
  fcntl(ends[0], F_SETFD, FD_CLOEXEC);
  process->id = id;
  process->descriptor = ends[0];
  return CONIC_OK;
}

/* Why there is no more to read. */
static conic_status explain_end(conic_assimp_process *process) {
  int state = 0;
  pid_t ended;
  do
    ended = waitpid(process->id, &state, 0);
  while (ended < 0 && errno == EINTR);
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
