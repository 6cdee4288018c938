/* The ways in which a chart draws its scenes: words of conic render, some of which change from way to way. */
#pragma once

#include "bench/chart.h"

enum { CLI_MOST_CHART_SCENES = 8, CLI_MOST_BESIDE = 24, CLI_MOST_FACTORS = 4 };

/* Another program's picture of the first scene, and the time that it took. */
typedef struct cli_chart_beside {
  char name[24];
  double ms;
  const char *path;
} cli_chart_beside;

typedef struct cli_charts_beside {
  cli_chart_beside pictures[CLI_MOST_BESIDE];
  int n;
} cli_charts_beside;

/* Appends what "NAME=MS:PICTURE" says to a cli_charts_beside; 0 where it is not understood. */
int cli_chart_parse_beside(const char *text, void *beside);

/* A chart as its arguments have it. */
typedef struct cli_chart_asked {
  int argc; /* of the command, with its own options */
  char **argv;
  int is_quick;
  const char **scenes; /* of these, those that are no options; the caller's */
  int n_scenes;
  const char *over; /* axes with commas between, each NAME, NAME=VALUE:VALUE… or several joined by +; null: what fits */
  cli_charts_beside beside;
} cli_chart_asked;

/* One scene, and the options that are this way's own. */
typedef struct cli_chart_way {
  int i_scene;
  int n_factors;                        /* 0: another program's picture, which `value` names */
  char axis[48], value[64];             /* as a table has them: "as+error", "hybrid:1" */
  char words[2 * CLI_MOST_FACTORS][64]; /* "--error", "1" …; an empty one is left out */
} cli_chart_way;

/* What is known of the scene when its ways are listed. */
typedef struct cli_chart_facts {
  int chooses, has_splats, has_faces, is_composited;
  uint64_t n_primitives;
} cli_chart_facts;

/* Appends the ways of scene i to *ways, of which there are *n: memory of the C library, the caller's to free. Returns
 * CLI_DONE, or the exit code after a message. */
int cli_chart_list_ways(const cli_chart_asked *asked, int i_scene, const cli_chart_facts *facts, cli_chart_way **ways,
                        int *n);

/* The arguments of conic render, or of the chart's own parser, for a way: `argv` has room for asked->argc and
 * CLI_MOST_WORDS more. A null way is the scene as it is; `samples`, where not null, are those of a pixel. Returns how
 * many. */
enum { CLI_MOST_WORDS = 2 * CLI_MOST_FACTORS + 4 };
int cli_chart_words(const cli_chart_asked *asked, int i_scene, const cli_chart_way *way, const char **argv);
