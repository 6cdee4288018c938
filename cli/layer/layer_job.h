/* The job of conic layer and conic merge, whose steps are in separate files: continuing a file, and reading inputs. */
#pragma once

#include "cli/commands/build_coloring.h"
#include "lod/blends/levels_build.h"

/* What of the inputs is kept; by what they are: Gaussian scenes as such. */
enum { CLI_LAYER_PLAIN, CLI_LAYER_FULL, CLI_LAYER_GAUSSIANS, CLI_LAYER_BY_INPUT };

typedef struct cli_layer_job {
  cli_build base; /* its input is the current one … */
  int i_input;    /* … with this number */
  const char *const *inputs;
  int n_inputs;
  conic_layers_options options;
  conic_estimate_options estimate;
  cli_coloring coloring;
  int cloud_size;
  double memory_mib, cutoff;
  cli_length quantum;
  int is_resumable;
  const char *resume_path; /* null: no build is resumed */
  int is_quantum_given, is_appending, is_merging, payload;
  const char *keep;
  char *continued; /* the values of the continued files, as --keep has them; null: none */

  cli_points_share share; /* of the continued files, then of the inputs */
  int n_continued;        /* how many of them are continued files */
  conic_layers_builder *builder;
  conic_layers_statistics statistics;
  int may_read_again, has_begun, is_raw, is_counting;
  int was_raw, has_values;                 /* of all inputs' points, any */
  int has_points, has_colors;              /* of all inputs so far */
  uint64_t n_points, n_pieces, n_finished; /* n_finished: samples that were finished before this run */
  double busy_seconds;
  cli_team_report team;

  conic_levels_builder *gaussian_builder; /* of Gaussian scenes */
  conic_levels_statistics levels;
} cli_layer_job;

/* Settles the payload where it is not given. Returns CLI_DONE, or CLI_USAGE after a message. */
int cli_layer_choose_payload(cli_layer_job *job);
/* Makes, reports and tells of a file of Gaussian scenes; the first returns the exit code. */
int cli_layer_make_gaussians(cli_layer_job *job);
void cli_layer_report_gaussians(cli_json *json, const cli_layer_job *job);
void cli_layer_tell_gaussians(const cli_layer_job *job);

/* Prepares continuing .lpc files: the grid is the first one's, and all files keep the same values of points. Errors: as
 * conic_layers_open, INPUT (they keep different values). */
conic_status cli_layer_continue(cli_layer_job *job, const char *const *paths, int n_paths);
/* Opens a continued file for reading. */
conic_status cli_layer_open_input(cli_layer_job *job, const char *path, conic_layers **layers);

/* Checks --resumable and --resume against the other options. Returns CLI_DONE, or CLI_USAGE after a message. */
int cli_layer_check_keeping(const cli_layer_job *job);
/* A key of everything that decides the bytes of the file, once the inputs are listed. Collective. Errors: MEMORY,
 * CANCELLED. */
conic_status cli_layer_make_key(const cli_layer_job *job, char key[CONIC_SHA256_ROOM]);
/* conic_model_to_splats for the current input; new axes are kept in a file, or taken from it if they were kept. Errors:
 * also IO. */
conic_status cli_layer_estimate(cli_layer_job *job, conic_model *model, conic_repairs *repairs);
/* The options --resumable and --resume, for the commands' tables. */
#define CLI_LAYER_KEEPING(job)                                                                                         \
  {"resumable",                                                                                                        \
   CLI_FLAG,                                                                                                           \
   &(job).is_resumable,                                                                                                \
   NULL,                                                                                                               \
   "note in OUT.branches what is finished, so that --resume can go on after any end",                                  \
   .acts.is_work = 1},                                                                                                 \
  {                                                                                                                    \
    "resume", CLI_TEXT, &(job).resume_path, "OUT",                                                                     \
        "go on with what OUT.branches says is finished, to the same bytes; with --resumable, too, where there is "     \
        "none "                                                                                                        \
        "begin"                                                                                                        \
  }

/* The most raw points of a file that are estimated from the whole file. */
uint64_t cli_layer_most_whole(const cli_layer_job *job);
/* How inputs are read, without the choice of points. */
void cli_layer_reading(const cli_layer_job *job, conic_read_options *options);
/* Appends this process's share to the builder. Errors: as conic_model_stream and conic_layers_builder_append. */
conic_status cli_layer_read_share(cli_layer_job *job, conic_read_options *options);
