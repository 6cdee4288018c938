#include "cli/session.h"

#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>

#include "cli/host_keeps.h"
#include "cli/shell.h"
#include "cli/stopper.h"
#include "core/files/guard.h"
#include "core/image/image_common.h"
#include "shots/executor.h"

/* Messages may come from any of the context's threads, and each must first take the progress bar off the screen. */
static pthread_mutex_t screen = PTHREAD_MUTEX_INITIALIZER;
static int bar_is_shown;

/* One thing that fails may do so in every thread, and make others fail: the first is told. */
static atomic_int has_failed;

/* When the first signal came, by the monotonic clock; 0: none has. Threads may handle signals at the same time. */
static atomic_llong interrupted_at_ms;
static atomic_int first_signal;
static atomic_int closed_pipe_signal; /* what is written to a pipe has no reader any more */

/* Of the run that this thread is in; null: the program's own. */
static _Thread_local cli_host *thread_host;

cli_host *cli_session_host(cli_host *host) {
  cli_host *before = thread_host;
  thread_host = host;
  return before;
}

/* Takes messages in the place of the screen; null: nobody does. */
static int (*holds)(conic_log_level level, const char *message);

void cli_session_hold(int (*hold)(conic_log_level level, const char *message)) {
  holds = hold;
}

static void say_to_host(const cli_host *host, conic_log_level level, const char *message) {
  if (host->say)
    host->say(host->cookie, (int)level, message);
}

double cli_seconds(void) {
  return conic_seconds_now();
}

unsigned long long cli_peak_rss_bytes(void) {
  return cli_shell_peak_bytes();
}

int cli_session_speaks(const cli_session *session) {
  return !session->team || session->team->index == 0;
}

static void erase_bar(void) {
  if (bar_is_shown)
    fputs("\r\033[K", stderr);
  bar_is_shown = 0;
}

/* One line, whatever the names in it hold. */
static void print_message(conic_log_level level, const char *format, va_list arguments) {
  static const char *const labels[] = {"error: ", "warning: ", ""};
  char message[2048];
  vsnprintf(message, sizeof message, format, arguments);
  for (char *c = message; *c; c++)
    if ((unsigned char)*c < 0x20 || *c == 0x7F)
      *c = '?';
  if (thread_host) {
    say_to_host(thread_host, level, message);
    return;
  }
  if (holds && holds(level, message))
    return;
  pthread_mutex_lock(&screen);
  erase_bar();
  fprintf(stderr, "conic: %s%s\n", labels[level], message);
  pthread_mutex_unlock(&screen);
}

/* What a host is to know of a failure that is told here first. */
static void note_failure(int exit_code) {
  if (thread_host && thread_host->status == CONIC_OK && exit_code != CLI_RESOURCE) /* of which there are several */
    thread_host->status = (int)(exit_code == CLI_USAGE ? CONIC_ERROR_ARGUMENT : CONIC_ERROR_INPUT);
}

int cli_usage(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  print_message(CONIC_LOG_ERROR, format, arguments);
  va_end(arguments);
  note_failure(CLI_USAGE);
  return CLI_USAGE;
}

int cli_error(int exit_code, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  print_message(CONIC_LOG_ERROR, format, arguments);
  va_end(arguments);
  note_failure(exit_code);
  return exit_code;
}

void cli_note(const cli_session *session, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  if (!session || !session->is_quiet || session->host)
    print_message(CONIC_LOG_INFO, format, arguments);
  va_end(arguments);
}

void cli_warn(const cli_session *session, const char *format, ...) {
  va_list arguments;
  if (session->is_quiet && !session->host)
    return;
  va_start(arguments, format);
  print_message(CONIC_LOG_WARNING, format, arguments);
  va_end(arguments);
}

/* What failed after a signal was stopped by it; what was done all the same, or was wrong before, stays what it was. */
int cli_exit_after_signals(int exit_code) {
  if (exit_code <= CLI_DIFFERENT)
    return exit_code;
  if (atomic_load(&first_signal))
    return 128 + atomic_load(&first_signal);
  return exit_code == CLI_RESOURCE && atomic_load(&closed_pipe_signal) ? 128 + atomic_load(&closed_pipe_signal)
                                                                       : exit_code;
}

int cli_exit_of(conic_status status) {
  if (thread_host && status != CONIC_OK && thread_host->status == CONIC_OK)
    thread_host->status = (int)status;
  switch (status) {
  case CONIC_OK:
    return CLI_DONE;
  case CONIC_ERROR_ARGUMENT:
    return CLI_USAGE;
  case CONIC_ERROR_INPUT:
    return CLI_INPUT;
  case CONIC_ERROR_MEMORY:
  case CONIC_ERROR_IO:
  case CONIC_ERROR_UNSUPPORTED:
  case CONIC_ERROR_CANCELLED:
    break;
  }
  return CLI_RESOURCE;
}

static int bar_cells(void) {
  int cells = cli_shell_columns() - 42;
  return cells < 0 ? 0 : cells > 40 ? 40 : cells;
}

static void draw_bar(cli_session *session, double fraction, double now) {
  char bar[48] = "", remaining[32] = "";
  int cells = bar_cells(), full = (int)(fraction * cells);
  for (int i = 0; i < cells; i++)
    bar[i] = i < full ? '#' : '.';
  double elapsed = now - session->task_seconds;
  if (fraction > 0.0 && elapsed > 0.5) {
    double seconds = elapsed * (1.0 - fraction) / fraction;
    if (seconds < 359999.0)
      snprintf(remaining, sizeof remaining, "  ETA %d:%02d", (int)seconds / 60, (int)seconds % 60);
  }
  fprintf(stderr, "\r%-10.22s %s %3d %%%s\033[K", session->task, bar, (int)(100.0 * fraction), remaining);
  fflush(stderr);
  bar_is_shown = 1;
  session->drawn_seconds = now;
}

void cli_session_part(cli_session *session, const char *name, int i_part, int n_parts) {
  session->part = name;
  session->i_part = i_part;
  session->n_parts = n_parts;
  session->part_share = 0.0;
  snprintf(session->task, sizeof session->task, "%s %d/%d", name, i_part, n_parts);
  if (i_part == 1)
    session->task_seconds = cli_seconds();
}

/* Of the whole, where a part has done so much of one of its tasks: a bar does not go back. */
static double share_of_parts(cli_session *session, double fraction) {
  if (session->part_share < fraction)
    session->part_share = fraction;
  return ((double)session->i_part - 1.0 + session->part_share) / (double)session->n_parts;
}

static void show_progress(cli_session *session, const char *task, double fraction) {
  const double refresh_seconds = 1.0 / 6.0;
  double now = cli_seconds();
  fraction = fraction > 0.0 ? fraction < 1.0 ? fraction : 1.0 : 0.0;
  if (session->part)
    fraction = share_of_parts(session, fraction);
  else if (strncmp(session->task, task, sizeof session->task - 1) != 0) {
    snprintf(session->task, sizeof session->task, "%s", task);
    session->task_seconds = now;
  }
  if (fraction >= 1.0) {
    erase_bar();
    if (!session->part)
      session->task[0] = '\0';
  } else if (now - session->drawn_seconds >= refresh_seconds)
    draw_bar(session, fraction, now);
}

static int tell_host(cli_session *session, cli_host *host, const char *task, double fraction) {
  const double now = host->progress_seconds > 0.0 ? cli_seconds() : 0.0;
  if (session->part)
    fraction = share_of_parts(session, fraction);
  if (!host->progress || (host->told_at > 0.0 && now - host->told_at < host->progress_seconds))
    return host->is_stopped;
  host->told_at = now;
  host->is_stopped |= host->progress(host->cookie, session->part ? session->part : task, fraction) != 0;
  return host->is_stopped;
}

static int on_progress(void *cookie, const char *task, double fraction) {
  cli_session *session = cookie;
  if (session->deadline > 0.0 && strcmp(task, "fetch") == 0 && cli_seconds() > session->late_seconds)
    session->is_late = 1;
  if (session->is_late)
    return 1;
  if (session->host)
    return tell_host(session, session->host, task, fraction);
  if (session->has_bar) {
    pthread_mutex_lock(&screen);
    show_progress(session, task, fraction);
    pthread_mutex_unlock(&screen);
  }
  return atomic_load(&interrupted_at_ms) != 0;
}

/* Whether it was said before: files are read several times, and what is wrong with them is said once. */
static int is_said_again(cli_session *session, const char *message) {
  enum { ROOM = sizeof session->said / sizeof session->said[0] };
  const uint64_t hash = conic_hash_bytes(message, strlen(message));
  int is_known = 0;
  pthread_mutex_lock(&screen);
  for (size_t i = 0; i < ROOM; i++)
    is_known |= session->said[i] == hash;
  if (!is_known)
    session->said[session->n_said++ % ROOM] = hash;
  pthread_mutex_unlock(&screen);
  return is_known;
}

static void on_log(void *cookie, conic_log_level level, const char *message) {
  static const char cancelled[] = ": cancelled";
  cli_session *session = cookie;
  char late[128];
  if (level == CONIC_LOG_ERROR && session->is_late) {
    snprintf(late, sizeof late, "%s: not all has come within --deadline %.9g", session->command, session->deadline);
    message = late;
  }
  if (level == CONIC_LOG_WARNING && is_said_again(session, message))
    return;
  if (session->host) {
    say_to_host(session->host, level, message);
    return;
  }
  if ((level == CONIC_LOG_WARNING && session->is_quiet) || (level == CONIC_LOG_INFO && !session->is_verbose))
    return;
  if (level == CONIC_LOG_ERROR && atomic_exchange(&has_failed, 1) && !session->is_verbose)
    return;
  if (holds && holds(level, message))
    return;
  const size_t n = strlen(message), n_end = sizeof cancelled - 1;
  const int is_end = level == CONIC_LOG_ERROR && n > n_end && strcmp(message + n - n_end, cancelled) == 0;
  const char *label = level == CONIC_LOG_ERROR ? "error: " : level == CONIC_LOG_WARNING ? "warning: " : "";
  pthread_mutex_lock(&screen);
  erase_bar();
  if (is_end) /* of a part, whose name says nothing to who typed the command */
    fprintf(stderr, "conic: %s%s%s\n", label, session->command, cancelled);
  else
    fprintf(stderr, "conic: %s%s\n", label, message);
  pthread_mutex_unlock(&screen);
}

/* Signals that come together are one wish to stop: a terminal, timeout and service managers signal the process and then
 * its group, and so reach it twice. Nobody's fingers are that fast. */
static const long long one_wish_ms = 250;

/* The first signal asks the work to stop, so that it removes what it has half written; a later one ends it at once. */
static void on_interrupt(int signal_number) {
  long long now_ms = (long long)(1e3 * conic_seconds_now()) + 1, first_ms = 0;
  int none = 0;
  atomic_compare_exchange_strong(&first_signal, &none, signal_number);
  if (atomic_compare_exchange_strong(&interrupted_at_ms, &first_ms, now_ms)) {
    cli_stopper_ask();
    return;
  }
  if (now_ms - first_ms < one_wish_ms || cli_stopper_ask())
    return;
  signal(signal_number, SIG_DFL);
  raise(signal_number); /* takes effect when the handler returns */
}

/* The write fails, after which is cleaned up as after any other failure. */
static void on_closed_pipe(int signal_number) {
  atomic_store(&closed_pipe_signal, signal_number);
}

static int stopped_exit_code(void) {
  return cli_exit_after_signals(CLI_RESOURCE);
}

/* A host's runs leave the process as it is: its signals, its terminal. */
static int open_hosted(cli_session *session, const conic_context_options *options) {
  cli_host *host = session->host;
  conic_status status = cli_kept_context(host->kept, options, &session->context);
  if (status != CONIC_OK) {
    host->status = (int)status;
    return cli_error(cli_exit_of(status), "%s: cannot start: %s", session->command, conic_status_string(status));
  }
  conic_guard_inputs(session->context, session->replaced_path);
  for (size_t i = 0; i < host->n_loans && status == CONIC_OK; i++)
    status = conic_lend(session->context, host->loans[i].name, host->loans[i].what);
  return cli_exit_of(status);
}

static void (*plans)(void *cookie, conic_context *context);
static void *plan_cookie;

void cli_session_plan(void (*plan)(void *cookie, conic_context *context), void *cookie) {
  plans = plan;
  plan_cookie = cookie;
}

int cli_session_open(cli_session *session) {
  conic_context_options options;
  conic_context_options_init(&options);
  options.log = on_log;
  options.log_cookie = session;
  options.progress = on_progress;
  options.progress_cookie = session;
  options.threads = !session->threads && session->team ? session->team->threads : session->threads;
  options.large_pages = session->draws_many_frames;
  options.isa = session->isa;
  options.allows_outside = session->allows_outside;
  session->late_seconds = cli_seconds() + session->deadline;
  if (session->max_texture_mib)
    options.max_texture_bytes = (size_t)session->max_texture_mib << 20;
  if (session->host)
    return open_hosted(session, &options);
  if (plans)
    options.threads = 1;
  conic_status status = conic_context_create(&options, &session->context);
  if (status != CONIC_OK)
    return cli_error(cli_exit_of(status), "%s: cannot start: %s", session->command, conic_status_string(status));
  if (plans)
    plans(plan_cookie, session->context);
  conic_guard_inputs(session->context, session->replaced_path);
  session->has_bar = !session->is_quiet && cli_shell_has_cursor() && cli_session_speaks(session);
  cli_stopper_begin(session->context, session->command, stopped_exit_code);
  cli_shell_catch(on_interrupt, on_closed_pipe);
  return CLI_DONE;
}

void cli_session_close(cli_session *session) {
  if (session->host) {
    cli_kept_leave(session->host->kept, session->context);
    session->context = NULL;
    return;
  }
  erase_bar();
  cli_stopper_end();
  conic_context_destroy(session->context);
  session->context = NULL;
}
