/* What the program asks of a system, where a runtime of WebAssembly is one: no processes, signals or terminal. */
#include <fcntl.h>
#include <stdint.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/shell.h"
#include "cli/stopper.h"
#include "core/base/base.h"

char **cli_shell_begin(int *argc, char **argv) {
  (void)argc;
  return argv;
}

void cli_shell_catch(void (*on_wish)(int signal_number), void (*on_closed_pipe)(int signal_number)) {
  (void)on_wish, (void)on_closed_pipe;
}

int cli_shell_is_terminal(FILE *stream) {
  (void)stream;
  return 0;
}

int cli_shell_has_cursor(void) {
  return 0;
}

int cli_shell_columns(void) {
  return 80;
}

int cli_shell_has_program(const char *name) {
  (void)name;
  return 0;
}

FILE *cli_shell_pipe_to(const char *const *words) {
  (void)words;
  return NULL;
}

int cli_shell_pipe_end(FILE *pipe) {
  (void)pipe;
  return -1;
}

unsigned long long cli_shell_peak_bytes(void) {
  return (unsigned long long)__builtin_wasm_memory_size(0) << 16; /* which never shrinks */
}

double cli_shell_cpu_seconds(void) {
  return conic_seconds_now();
}

void cli_shell_name_host(char *processor, size_t processor_room, char *system, size_t system_room) {
  snprintf(processor, processor_room, "unknown");
  snprintf(system, system_room, "WASI, wasm32");
}

void cli_shell_give_back_memory(void) {
}

/* Whoever starts a program of WebAssembly has put names in place of patterns. */
int cli_shell_match(const char *pattern, int (*take)(void *cookie, const char *path), void *cookie) {
  take(cookie, pattern);
  return 1;
}

void cli_stopper_begin(conic_context *context, const char *command, int (*exit_code)(void)) {
  (void)context, (void)command, (void)exit_code;
}

void cli_stopper_end(void) {
}

int cli_stopper_ask(void) {
  return 0;
}

/* What wasi-libc declares and lacks. */

int madvise(void *bytes, size_t n_bytes, int advice) {
  (void)bytes, (void)n_bytes, (void)advice;
  return 0;
}

int fchmod(int descriptor, mode_t permissions) {
  (void)descriptor, (void)permissions;
  return 0;
}

/* Whether a process is there cannot be told, so that none is taken to be gone. */
int kill(pid_t process, int signal_number) {
  (void)process, (void)signal_number;
  errno = EPERM;
  return -1;
}

int mkstemp(char *pattern) {
  char *end = pattern + strlen(pattern);
  for (int i = 0; i < 100; i++) {
    uint64_t random;
    if (getentropy(&random, sizeof random) != 0)
      return -1;
    for (char *at = end - 6; at < end; at++, random /= 26)
      *at = (char)('a' + random % 26);
    int descriptor = open(pattern, O_RDWR | O_CREAT | O_EXCL, 0600);
    if (descriptor >= 0 || errno != EEXIST)
      return descriptor;
  }
  return -1;
}

FILE *tmpfile(void) {
  char pattern[] = "conic-XXXXXX";
  int descriptor = mkstemp(pattern);
  if (descriptor < 0)
    return NULL;
  unlink(pattern);
  return fdopen(descriptor, "w+b");
}
