/* Command-line arguments, by table. Long options take `--name value` and `--name=value`; `--` ends them. */
#pragma once

#include "cli/option_facts.h"
#include "cli/session.h"

typedef enum cli_option_type {
  CLI_FLAG,   /* int *: set to 1 */
  CLI_INT,    /* int *, within minimum and maximum */
  CLI_COUNT,  /* unsigned long long *, within minimum and maximum; also 10k, 2M, 1e6 */
  CLI_NUMBER, /* double *, within minimum and maximum */
  CLI_TEXT,   /* const char ** */
  CLI_CHOICE, /* int *: the index of the word in `choices` */
  CLI_VECTOR, /* double[3]: X,Y,Z */
  CLI_SIZE,   /* int[2]: WxH, each within minimum and maximum */
  CLI_PARSED  /* any: by `parse` */
} cli_option_type;

/* What an option has an effect on, as bits CLI_FACT(NAME) (cli/option_facts.h). Zeros: on everything. */
typedef struct cli_effect {
  cli_facts on, needs; /* of each, what is drawn and what is asked for, any one has to hold, */
  cli_facts apart;     /* and none of these, */
  const char *why;     /* which this gives the reason for; may be null */
  /* What else has to be said, any one of these, with bars between: "name", another option; "name=word", which has that
   * value; "name=.end", a value that ends so; "@word", an argument; "@", any argument; or "!…" alone, which has to be
   * missing. Null: nothing. */
  const char *with;
  int is_work;   /* it decides time, memory or what is said, and no bit of what is made */
  int is_warned; /* where it has no effect that is a warning; else wrong usage */
} cli_effect;

typedef struct cli_option {
  const char *name; /* without the dashes; one letter means a short option, unless `dashes` says more */
  cli_option_type type;
  void *value;
  const char *argument;       /* what the help calls the value: "FILE", "N"; null for flags */
  const char *help;           /* one line; the default in brackets at its end. Null: another name of the option above */
  double minimum, maximum;    /* both 0: no limits */
  const char *const *choices; /* null-terminated; but of CLI_CHOICE, what completion offers */
  int (*parse)(const char *text, void *value); /* 0: not understood */
  int *is_given;                               /* set to 1 when the option is given; may be null */
  const char *dashes;                          /* null: one before a name of one letter, else two */
  const char *group;                           /* heads this option and those below, up to the next; null: goes on */
  const char *intro;                           /* of the group, one line; null: none */
  /* What may stand behind a colon of the value: a parser, and what it is handed. */
  int (*parse_tail)(const char *text, void *tail);
  void *tail;
  int may_repeat;  /* `parse` takes every value; else the last one holds */
  int is_usual;    /* the short help has it, too */
  const char *now; /* an old spelling, which no help shows: what to write in its place. Null: it is none */
  cli_effect acts;
} cli_option;

/* The options that a command understands: its own, and those of every command. */
typedef struct cli_option_table {
  const cli_option *own, *common;
  int n_own, n_common;
} cli_option_table;

/* What stands before an option's name. */
static inline const char *cli_dashes(const cli_option *option) {
  return option->dashes ? option->dashes : option->name[1] ? "--" : "-";
}

/* Reads arguments into the options' values, and what is no option into positional[0 … *n_positional); --threads,
 * --json, --quiet, --verbose (and --help), and -q -v -h, are understood for every command. Returns CLI_DONE, or
 * CLI_USAGE after a message; -1 when help was asked for and given (cli/help/help.h). `positional` has room for argc. */
int cli_parse(cli_session *session, const cli_option *options, int n_options, int argc, char **argv,
              const char **positional, int *n_positional);
/* The same, which notes each option's last value in values[0 … n_options): null where it was not given, and the name of
 * a flag that was. */
int cli_parse_noting(cli_session *session, const cli_option *options, int n_options, int argc, char **argv,
                     const char **positional, int *n_positional, const char **values);

/* For commands that read what a glTF may be. */
#define CLI_OUTSIDE(session)                                                                                           \
  {                                                                                                                    \
    "allow-outside", CLI_FLAG, &(session)->allows_outside, NULL,                                                       \
        "a glTF may name buffers and pictures outside of its folder", .acts.is_work = 1                                \
  }

/* For commands that read all of a cloud that may be on a web server. */
#define CLI_WAITING(session)                                                                                           \
  {"timeout",                                                                                                          \
   CLI_NUMBER,                                                                                                         \
   &(session)->stall_seconds,                                                                                          \
   "S",                                                                                                                \
   "of a URL, a server that is silent for so long is asked again, up to 4 times [15]",                                 \
   1,                                                                                                                  \
   3600,                                                                                                               \
   .acts = {.on = CLI_FACT(URL), .is_work = 1, .is_warned = 1}},                                                       \
  {                                                                                                                    \
    "deadline", CLI_NUMBER, &(session)->deadline, "S",                                                                 \
        "of a URL, no more is read after so many seconds; where not all has come, nothing is written", 0.001, 1e6,     \
        .acts = {                                                                                                      \
          .on = CLI_FACT(URL),                                                                                         \
          .is_work = 1,                                                                                                \
          .is_warned = 1                                                                                               \
        }                                                                                                              \
  }

/* For commands that read textures. */
#define CLI_TEXTURE_BOUND(session)                                                                                     \
  {                                                                                                                    \
    "max-texture", CLI_INT, &(session)->max_texture_mib, "MiB",                                                        \
        "what textures may take in memory together; one more is refused before it is decoded [4096]", 1, 1 << 20,      \
        .acts = {                                                                                                      \
          .on = CLI_FACT(TEXTURED),                                                                                    \
          .is_work = 1                                                                                                 \
        }                                                                                                              \
  }

/* A length: in world units, or with an x behind it ("0.5x") in median sample spacings of the scene. */
typedef struct cli_length {
  double value;
  int is_in_spacings;
} cli_length;

/* Parses a length that is not negative into a cli_length: a `parse` for CLI_PARSED. 0 where it is none. */
int cli_parse_length(const char *text, void *length);

/* What the columns of text are: the option --columns, into a const char *, and its parser. */
#define CLI_COLUMNS(to)                                                                                                \
  {                                                                                                                    \
    "columns", CLI_PARSED, to, "NAMES",                                                                                \
        "what the columns of a text file are, as x,y,z,intensity,-,r,g,b [as its header says]",                        \
        .parse = cli_parse_columns, .acts = {                                                                          \
          .on = CLI_FACT(TEXT)                                                                                         \
        }                                                                                                              \
  }
/* What colours are: the option --colors, into an int of conic_color_meaning. */
#define CLI_COLORS(to)                                                                                                 \
  {                                                                                                                    \
    "colors", CLI_CHOICE, to, "WHAT",                                                                                  \
        "what colours mean that are fractions of 1: display values, as other programs write them, or linear ones, as " \
        "conic's .ply has them: file, display, linear [file]",                                                         \
        .choices = cli_color_meanings, .acts = {                                                                       \
          .on = CLI_FACT(FRACTIONS)                                                                                    \
        }                                                                                                              \
  }
extern const char *const cli_color_meanings[];

/* All of them, for commands that read points and meshes of any kind into a cli_build. */
#define CLI_READING(session, build)                                                                                    \
  CLI_COLUMNS(&(build)->columns), CLI_COLORS(&(build)->colors_are), CLI_OUTSIDE(session)
int cli_parse_columns(const char *text, void *columns);

/* Which points are wanted: the option --where, into a const char *. */
#define CLI_WHERE(to)                                                                                                  \
  {                                                                                                                    \
    "where", CLI_TEXT, to, "WHAT",                                                                                     \
        "which points are wanted, by their values: 'classification = 2, 9 and not (intensity < 100 or z > 50)' [all]", \
        .acts = {                                                                                                      \
          .on = CLI_FACT(SPLATS) | CLI_FACT(LEVELS)                                                                    \
        }                                                                                                              \
  }

/* Parses a count as CLI_COUNT does: 100000, 10k, 2M, 1e6; 0 where it is none. */
int cli_parse_count(const char *text, unsigned long long *value);

/* Parses a decimal number whole; 0 where it is none. */
int cli_parse_number(const char *text, double *number);

/* Says, in the message about the value that is being read, what is wrong with it: a text that stays. Returns 0. */
int cli_because(const char *reason);

/* Parses "X,Y,Z" whole; 0 where it is not, or of a direction is 0. */
int cli_parse_vector(const char *text, double vector[3]);
int cli_parse_direction(const char *text, double vector[3]);
int cli_parse_pair(const char *text, char separator, double pair[2]);
