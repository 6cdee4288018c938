/* The sub-commands, one file each: cli/NAME.c. */
#pragma once

#include "cli/session.h"

struct conic_executor;

/* Whatever a scene is read from. */
#define CLI_READABLE                                                                                                   \
  "PLY, XYZ, PTS, CSV, LAS, LAZ, PCD, E57, PTX, OBJ, STL, OFF, glTF, GLB, 3MF, DAE, FBX, .cot, .chy, "                 \
  ".lpc, COPC, EPT, Potree 2"
#define CLI_READABLE_GAUSSIANS "Gaussian scenes in .ply, .splat, .ksplat, .spz, .sog and glTF"

/* Words that a command takes as an argument, or as an option's value. */
typedef struct cli_words {
  const char *title;                            /* "scenes": what they are */
  const char *option;                           /* the option's name; null: they are arguments */
  const char *(*at)(int i, const char **about); /* the i-th, and what it means; null past the last. Static */
} cli_words;

typedef struct cli_example {
  const char *what, *command; /* "draw a scan", "conic render scan.ply -o scan.png" */
} cli_example;

typedef struct cli_command {
  const char *name;
  const char *summary; /* one line for `conic help` */
  const char *usage;   /* "conic render IN… -o OUT [options]" */
  /* argv[0] is the sub-command's name. Returns the exit code. */
  int (*run)(cli_session *session, int argc, char **argv);
  /* For the manual page and the help; may be null. */
  const char *description; /* whole sentences: what goes in, what comes out */
  const cli_words *words;
  cli_example examples[4];
  int is_shared; /* a team works on it together (cli/session_team.h); else its first process does alone */
} cli_command;

extern const cli_command cli_make, cli_prepare, cli_octree, cli_layer, cli_merge, cli_cut, cli_mls, cli_csg, cli_hybrid,
    cli_render, cli_sheet, cli_contact, cli_diff, cli_info, cli_verify, cli_judge, cli_explain, cli_gradient,
    cli_conformance, cli_chart, cli_bench, cli_devices, cli_convert, cli_project;

/* Runs what the arguments say, argv[0] being the program's name. Returns its exit code. */
int cli_program(int argc, char **argv, const struct conic_executor *team);
/* The command of that name, or null. */
const cli_command *cli_find_command(const char *name);
/* The i-th command; null past the last. */
const cli_command *cli_command_at(int i);
/* conic help [--format FORMAT] [COMMAND]; argv[0] is "help". Returns the exit code. */
int cli_help(int argc, char **argv);
/* The short help, without commands' options. */
void cli_help_usage(FILE *to);
/* How cli_parse answers --help unless the session says otherwise: a command's options as text. */
void cli_help_text(cli_session *session, const struct cli_option_table *table);

/* Says that there is no such command or option, and which is near. Returns CLI_USAGE. */
int cli_refuse_command(const char *name);
