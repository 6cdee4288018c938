#include "cli/stopper.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <unistd.h>

#include "core/files/file.h"

enum { PATIENCE_MS = 300 };
static const char asked = 'a', over = 'o';

static conic_context *watched;
static const char *watched_command;
static int (*watched_exit_code)(void);
static int words[2]; /* a pipe, as handlers may write to it */
static pthread_t thread;
static atomic_int is_watching;

/* The next word, or `asked` where none comes in time. */
static char hear(int most_ms) {
  struct pollfd next = {.fd = words[0], .events = POLLIN};
  char word = asked;
  int n;
  do
    n = poll(&next, 1, most_ms);
  while (n < 0 && errno == EINTR);
  return n == 1 && read(words[0], &word, 1) != 1 ? over : word;
}

static void *watch(void *nothing) {
  if (hear(-1) == over || hear(PATIENCE_MS) == over)
    return nothing;
  conic_outputs_give_up(watched);
  conic_fail(watched, CONIC_ERROR_CANCELLED, "%s: cancelled", watched_command);
  _exit(watched_exit_code());
}

/* The thread catches no signals: they are to wake who waits for a pipe. */
void cli_stopper_begin(conic_context *context, const char *command, int (*exit_code)(void)) {
  sigset_t all, before;
  watched = context;
  watched_command = command;
  watched_exit_code = exit_code;
  if (atomic_load(&is_watching) || pipe(words) != 0)
    return;
  fcntl(words[1], F_SETFL, O_NONBLOCK);
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  atomic_store(&is_watching, pthread_create(&thread, NULL, watch, NULL) == 0);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
}

static int say(const char *word) {
  int error = errno;
  ssize_t n = write(words[1], word, 1);
  errno = error;
  return n == 1;
}

void cli_stopper_end(void) {
  if (atomic_exchange(&is_watching, 0) && say(&over))
    pthread_join(thread, NULL);
}

int cli_stopper_ask(void) {
  return atomic_load(&is_watching) && say(&asked);
}
