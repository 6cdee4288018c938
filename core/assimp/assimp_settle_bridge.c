#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "core/assimp/assimp_writer_bridge.h"

/* Any file may take so much; larger ones may take more, by their size. */
static const uint64_t least_memory_bytes = UINT64_C(1) << 30, least_seconds = 60;
static const uint64_t memory_per_byte = 256, bytes_per_second = 100000;

static void set_limit(int resource, uint64_t most) {
  struct rlimit limit;
  if (getrlimit(resource, &limit) != 0)
    return;
  limit.rlim_cur = limit.rlim_max == RLIM_INFINITY || most < limit.rlim_max ? (rlim_t)most : limit.rlim_max;
  setrlimit(resource, &limit);
}

/* Address space that is taken already (a sanitizer takes much); 0 where it is not known. */
static uint64_t own_address_space(void) {
  char pages[32] = "0";
  FILE *file = fopen("/proc/self/statm", "r");
  int is_known = file && fgets(pages, sizeof pages, file);
  if (file)
    fclose(file);
  return is_known ? strtoull(pages, NULL, 10) * (uint64_t)sysconf(_SC_PAGESIZE) : 0;
}

void conic_assimp_settle(conic_assimp_request *request) {
  static const int faults[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPIPE, SIGXCPU, SIGALRM, SIGCHLD};
  static const int wishes[] = {SIGINT, SIGTERM, SIGHUP}; /* signals to the parent, with which this process ends */
  uint64_t address_space = own_address_space(), n_bytes = request->n_bytes;
  for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++)
    signal(faults[i], SIG_DFL);
  for (size_t i = 0; i < sizeof wishes / sizeof wishes[0]; i++)
    signal(wishes[i], SIG_IGN);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  request->descriptor = fcntl(request->descriptor, F_DUPFD, 3); /* not one of the standard streams, which lead nowhere
                                                                   from here on */
  int nowhere = open("/dev/null", O_RDWR);
  for (int descriptor = 0; descriptor < 3; descriptor++)
    dup2(nowhere, descriptor);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_CPU, least_seconds + n_bytes / bytes_per_second);
  if (address_space)
    set_limit(RLIMIT_AS, address_space + least_memory_bytes + memory_per_byte * n_bytes);
}
