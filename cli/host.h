/* A program that runs commands within itself, as Python does: what it gives and gets in place of words, files and text,
 * and who hears what a shell's user would see. */
#pragma once

#include "conic/conic.h"

/* Something in memory, under the name that the arguments call it by: conic/loan.h. */
typedef struct cli_loan {
  const char *name;
  const void *what;
} cli_loan;

/* What an option is given. */
typedef enum cli_value_type {
  CLI_VALUE_SET = 0,     /* nothing: it is a flag */
  CLI_VALUE_WHOLE = 1,   /* a whole number */
  CLI_VALUE_NUMBERS = 2, /* one number or several */
  CLI_VALUE_TEXT = 3     /* what is a word by its nature: a name, a path, "2x" */
} cli_value_type;

enum { CLI_VALUE_NUMBERS_MOST = 16 };

typedef struct cli_value {
  const char *name; /* of the option, without dashes */
  cli_value_type type;
  int n_numbers;
  int64_t whole;
  double numbers[CLI_VALUE_NUMBERS_MOST];
  const char *text;
  char said[400]; /* the run's own: numbers as a message says them */
} cli_value;

/* What lasts from one run to the next: a context, a renderer, and a few opened sources. One run at a time. */
typedef struct cli_kept cli_kept;

/* Null without memory. */
CONIC_API cli_kept *cli_kept_create(void);
/* Null is allowed. */
CONIC_API void cli_kept_destroy(cli_kept *kept);

/* A picture as it was drawn. All of it is the run's. */
typedef struct cli_drawn {
  int i_frame, reserved_int;
  const char *view; /* its name in the file of cameras; else empty */
  const conic_image *image;
  const conic_camera *camera;
  const conic_shot *shot;              /* what was drawn */
  const conic_source_options *opening; /* how its inputs were read */
  const conic_shot_writing *writing;   /* how files are made of it */
  const char *sky_path;                /* where the shot's sky was read; null: it has none */
  const char *motion_path;             /* likewise its motion */
} cli_drawn;

/* Functions may be null. They are called on the caller's thread, but for `say`, which any of the context's may call.
 * They may run commands themselves, but not with what this run keeps. */
typedef struct cli_host {
  void *cookie;
  /* As the context's options have it: not 0 cancels. */
  int (*progress)(void *cookie, const char *task, double fraction);
  double progress_seconds; /* it is called no more often than once in so many; 0: whenever there is something to tell */
  double told_at;          /* the run's own, as is the next */
  int is_stopped;          /* by what it returned */
  /* A line of a conic_log_level. */
  void (*say)(void *cookie, int level, const char *line);
  /* Asks for arrays for the planes of a frame, with anything in them; not 0: there is no memory. Null: render has no
   * picture to hand over, and needs outputs. */
  int (*lay_out)(void *cookie, int width, int height, unsigned planes, void **arrays);
  /* The frame is drawn. The arrays are the caller's. */
  void (*take)(void *cookie, const cli_drawn *drawn);
  const cli_loan *loans;
  size_t n_loans;
  cli_value *values; /* of options, beside what the arguments say */
  size_t n_values;
  cli_kept *kept;   /* null: nothing is kept */
  int keeps_source; /* so is what is opened: whoever opens the same files to be read alike has it again */

  /* What came of it. */
  int status; /* a conic_status: of the failure, where the exit code is above 1 */
  /* What --json would have been, as records one after the other: a letter, the key with its 0 (empty: none), and the
   * value. o and a begin an object and an array, e ends either (without a key), t is text with its 0, z null, n a
   * double, c a uint64_t, b a byte, 0 or 1. The caller releases it by cli_host_release. Null: nothing */
  char *facts;
  size_t n_facts_bytes, facts_room;
  int facts_are_lost; /* there was no memory for some */
} cli_host;

/* The whole program, as a shell starts it: it prints, handles signals, and returns its exit code. Once a process. */
CONIC_API int cli_host_program(int argc, char **argv);

/* Runs the command argv[0] and returns its exit code. Any number of threads may run commands at the same time. Nothing
 * is printed, and no signal is handled. */
CONIC_API int cli_host_run(cli_host *host, int argc, char **argv);
/* Releases the facts. */
CONIC_API void cli_host_release(cli_host *host);

/* Draws a shot of inputs, read as the options say, into the planes that `image` has: opens them or finds them again,
 * and calls conic_shot_draw. Sky and motion are read from their paths, if these are not null; the shot's own are not
 * looked at. Of the host's values, none are. Returns an exit code. */
CONIC_API int cli_host_draw(cli_host *host, int n_inputs, const char **inputs, const conic_source_options *opening,
                            const conic_shot *shot, const char *sky_path, const char *motion_path, int threads,
                            conic_image *image, conic_shot_outcome *outcome);

/* Finds what the scene, the texture, the sky and the motion among a shot's inputs hold, and what they lead to: reads
 * them as for drawing. The facts are then "shot": the shot with these inputs, as conic_shot_file_print writes it whole,
 * where what decides no bit is as it is by default. Returns an exit code. */
CONIC_API int cli_host_look(cli_host *host, const conic_shot_file *file);
