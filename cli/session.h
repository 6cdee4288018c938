/* What every sub-command shares: the context with its messages and progress bar, exit codes, the clock, JSON output. */
#pragma once

#include "conic/conic.h"
#include "core/base/base.h"

enum cli_exit { CLI_DONE = 0, CLI_DIFFERENT = 1, CLI_USAGE = 2, CLI_INPUT = 3, CLI_RESOURCE = 4 };

struct cli_option_table;

typedef struct cli_session {
  const char *command; /* the sub-command's name */
  int threads;         /* --threads; 0: all */
  int is_quiet, is_verbose;
  uint64_t said[16];     /* hashes of the last warnings; 0: none */
  size_t n_said;         /* warnings, each once */
  int has_bar;           /* there is a terminal that can show one, and it is wanted */
  const char *json_path; /* --json; null: none */
  char task[32];         /* what the progress bar is about; empty: nothing yet */
  double task_seconds;   /* when that began */
  double drawn_seconds;  /* when the bar was last drawn */
  const char *part;      /* cli_session_part; null: none */
  int i_part, n_parts;
  double part_share;     /* of the part, what is done */
  double stall_seconds;  /* --timeout of commands that make files; 0: the library's */
  double deadline;       /* their --deadline: seconds after opening; 0: none */
  double late_seconds;   /* when that is, by cli_seconds */
  int is_late;           /* it has passed, and more was to come from a server */
  int max_texture_mib;   /* --max-texture; 0: the library's bound. It is set before cli_session_open, as are those: */
  int allows_outside;    /* --allow-outside */
  int draws_many_frames; /* of the same model; this and isa are set before cli_session_open */
  conic_isa isa;         /* --isa */
  const char
      *replaced_path;     /* --in-place: the only input that may be written over; null: none may. Set before opening */
  conic_context *context; /* made by cli_session_open */
  /* How cli_parse answers --help; null: as text. `help` is its own. */
  void (*show_help)(struct cli_session *session, const struct cli_option_table *table);
  void *help;
  int is_help_whole; /* --all: of commands that have a short one */
  struct {
    const char *name, *now;
    const struct cli_word *word; /* which the argument `name` is one of; null: it is conic's own spelling of before */
  } old_spellings[8];            /* of options that were given, and what they are now; names null: no more */
  char meant[1024];              /* the command in full, where it was given in other words; empty: it was not */
  struct cli_shot_again
      *again;            /* cli/render/shot_again.h: what the arguments that are read draw again; null: nothing */
  struct cli_host *host; /* cli/host.h: what runs the command within itself; null: a shell */
  const struct conic_executor *team; /* the processes that run it together (cli/session_team.h); null: it is alone */
} cli_session;

/* Makes the context. Returns CLI_DONE or, after an error message, the exit code. */
int cli_session_open(cli_session *session);
/* From now on `plan` is told each new context, which has one thread; null: no more. */
void cli_session_plan(void (*plan)(void *cookie, conic_context *context), void *cookie);
/* From now on what this thread prints for people is said to a host; null: to nobody but these. Returns who was told it
 * before: a host's functions may run commands themselves. */
struct cli_host *cli_session_host(struct cli_host *host);
/* From now on `hold` sees what this process would print for people, and keeps it where it returns 1. */
void cli_session_hold(int (*hold)(conic_log_level level, const char *message));
/* Ends the context; fine where it was never made. */
void cli_session_close(cli_session *session);

/* Says that what follows is part `i_part` of `n_parts`, from 1, of one long work, say a turntable's frame 3 of 36: the
 * progress bar then is about all of them. `name` is to stay. */
void cli_session_part(cli_session *session, const char *name, int i_part, int n_parts);

/* Whether this process says and writes what comes of the command: it is alone, or the first of several. */
int cli_session_speaks(const cli_session *session);

/* The exit code that stands for a status; the message has been printed by the context's log. */
int cli_exit_of(conic_status status);

/* Prints "conic: error: …" and returns CLI_USAGE. */
int cli_usage(const char *format, ...) CONIC_AS_PRINTF(1, 2);
/* Prints "conic: error: …" and returns `exit_code`. */
int cli_error(int exit_code, const char *format, ...) CONIC_AS_PRINTF(2, 3);

/* Prints "conic: …", unless the run is quiet: what was chosen for the user, who may want it otherwise. What was asked
 * for is said to all: of no session. */
void cli_note(const cli_session *session, const char *format, ...) CONIC_AS_PRINTF(2, 3);
/* Prints "conic: warning: …" unless the session is quiet. */
void cli_warn(const cli_session *session, const char *format, ...) CONIC_AS_PRINTF(2, 3);

/* The exit code of the program where a command's is `exit_code`: 128 and the signal's number where one has stopped it.
 */
int cli_exit_after_signals(int exit_code);

/* Seconds of a monotonic clock. */
double cli_seconds(void);
/* The process's peak resident set. */
unsigned long long cli_peak_rss_bytes(void);
