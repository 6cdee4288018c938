#include <glob.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "cli/shell.h"

/* NOLINTNEXTLINE(readability-non-const-parameter): Windows changes it */
char **cli_shell_begin(int *argc, char **argv) {
  (void)argc;
  return argv;
}

/* What waits, say for a pipe, is woken. */
static void catch_signal(int signal_number, void (*handler)(int)) {
  struct sigaction action;
  if (sigaction(signal_number, NULL, &action) != 0 || action.sa_handler == SIG_IGN)
    return;
  memset(&action, 0, sizeof action);
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  sigaction(signal_number, &action, NULL);
}

void cli_shell_catch(void (*on_wish)(int signal_number), void (*on_closed_pipe)(int signal_number)) {
  const int wishes[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};
  for (size_t i = 0; i < sizeof wishes / sizeof *wishes; i++)
    catch_signal(wishes[i], on_wish);
  catch_signal(SIGPIPE, on_closed_pipe);
  signal(SIGXFSZ, SIG_IGN); /* a file that may not grow further is a failed write, after which is cleaned up */
}

/* NOLINTBEGIN(cert-env33-c): the user's own shell, for words that are quoted */
int cli_shell_has_program(const char *name) {
  char command[256];
  int n = snprintf(command, sizeof command, "command -v %s > /dev/null 2>&1", name);
  return n < (int)sizeof command && system(command) == 0;
}

FILE *cli_shell_pipe_to(const char *const *words) {
  char command[16384] = "exec";
  size_t n = strlen(command);
  for (; *words; words++) {
    n += (size_t)snprintf(command + n, sizeof command - n, " '");
    for (const char *at = *words; *at && n + 16 < sizeof command; at++)
      n += (size_t)snprintf(command + n, sizeof command - n, *at == '\'' ? "'\\''" : "%c", *at);
    if (n + 16 >= sizeof command)
      return NULL;
    n += (size_t)snprintf(command + n, sizeof command - n, "'");
  }
  FILE *pipe = popen(command, "w");
  signal(SIGPIPE, SIG_IGN);
  return pipe;
}
/* NOLINTEND(cert-env33-c) */

int cli_shell_pipe_end(FILE *pipe) {
  int code = pclose(pipe);
  return code != -1 && WIFEXITED(code) ? WEXITSTATUS(code) : -1;
}

int cli_shell_is_terminal(FILE *stream) {
  return isatty(fileno(stream));
}

int cli_shell_has_cursor(void) {
  const char *kind = getenv("TERM");
  return isatty(STDERR_FILENO) && kind && *kind && strcmp(kind, "dumb") != 0;
}

int cli_shell_columns(void) {
  struct winsize window;
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col ? window.ws_col : 80;
}

/* The kernel's own mark of this program: getrusage also counts what the shell that started it held. */
double cli_shell_cpu_seconds(void) {
  struct timespec spent;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &spent);
  return (double)spent.tv_sec + 1e-9 * (double)spent.tv_nsec;
}

void cli_shell_name_host(char *processor, size_t processor_room, char *system, size_t system_room) {
  static const char key[] = "model name";
  struct utsname names;
  char line[256];
  FILE *file = fopen("/proc/cpuinfo", "r");
  snprintf(processor, processor_room, "unknown");
  snprintf(system, system_room, "unknown");
  while (file && fgets(line, sizeof line, file))
    if (strncmp(line, key, sizeof key - 1) == 0 && strchr(line, ':')) {
      line[strcspn(line, "\n")] = 0;
      snprintf(processor, processor_room, "%s", strchr(line, ':') + 1 + strspn(strchr(line, ':') + 1, " "));
      break;
    }
  if (file)
    fclose(file);
  if (uname(&names) == 0)
    snprintf(system, system_room, "%s %s, %s", names.sysname, names.release, names.machine);
}

unsigned long long cli_shell_peak_bytes(void) {
  unsigned long long kibibytes = 0;
  char line[256];
  FILE *file = fopen("/proc/self/status", "r");
  while (file && !kibibytes && fgets(line, sizeof line, file))
    if (strncmp(line, "VmHWM:", 6) == 0)
      kibibytes = strtoull(line + 6, NULL, 10);
  if (file)
    fclose(file);
  struct rusage usage;
  if (!kibibytes && getrusage(RUSAGE_SELF, &usage) == 0)
#if defined(__APPLE__)
    kibibytes = (unsigned long long)usage.ru_maxrss / 1024; /* there in bytes */
#else
    kibibytes = (unsigned long long)usage.ru_maxrss;
#endif
  return kibibytes * 1024;
}

void cli_shell_give_back_memory(void) {
#if defined(__GLIBC__)
  (void)mallopt(M_MMAP_THRESHOLD, 128 << 10);
#endif
}

int cli_shell_match(const char *pattern, int (*take)(void *cookie, const char *path), void *cookie) {
  glob_t found = {.gl_pathc = 0};
  int result = glob(pattern, GLOB_NOSORT, NULL, &found);
  for (size_t i = 0; result == 0 && i < found.gl_pathc; i++)
    if (!take(cookie, found.gl_pathv[i]))
      break;
  globfree(&found);
  return result != GLOB_NOSPACE;
}
