/* What conic layer and conic merge do, in the steps that are files of their own: what goes on, what is read. */
#ifndef CONIC_LAYER_JOB_H
#define CONIC_LAYER_JOB_H

#include "cli/commands/build_coloring.h"
#include "cli/commands/build_steps.h"
#include "cli/points/points_share.h"
#include "cli/team_shares.h"
#include "conic/layers.h"
#include "core/files/sha256.h"

typedef struct cli_layer_job {
  cli_build base; /* its input is the one that is being read, */
  int i_input;    /* of this number */
  const char *const *inputs;
  int n_inputs;
  conic_layers_options options;
  conic_estimate_options estimate;
  cli_coloring coloring;
  int cloud_size;
  double memory_mib, cutoff;
  cli_length quantum;
  int is_resumable;
  const char *resume_path; /* null: nothing is gone on with */
  int is_quantum_given, is_appending, is_merging, payload;
  const char *keep;
  char *continued; /* the values of the files that go on, as --keep has them; null: they have none */

  cli_points_share share; /* of the files that go on, and then of the inputs */
  int n_continued;        /* how many those are */
  conic_layers_builder *builder;
  conic_layers_statistics statistics;
  int may_read_again, has_begun, is_raw, is_counting;
  int has_points, has_colors;              /* of all inputs up to here */
  uint64_t n_points, n_pieces, n_finished; /* the last: samples, before it began */
  double busy_seconds;
  cli_team_shares shares;
} cli_layer_job;

/* Of the .lpc files that go on: the grid is the first one's, and what they keep of points is what all keep. Errors: as
 * conic_layers_open, INPUT (they keep different values). */
conic_status cli_layer_continue(cli_layer_job *job, const char *const *paths, int n_paths);
/* Opens one of them for reading. */
conic_status cli_layer_open_input(cli_layer_job *job, const char *path, conic_layers **layers);

/* What --resumable and --resume mean together with the others. Returns CLI_DONE, or CLI_USAGE after a message. */
int cli_layer_check_keeping(const cli_layer_job *job);
/* What decides the bytes of the file, once the inputs are listed. Collective. Errors: MEMORY, CANCELLED. */
conic_status cli_layer_make_key(const cli_layer_job *job, char key[CONIC_SHA256_ROOM]);
/* As conic_model_to_splats of the input that is being read, of which the axes that are made are kept, or taken from
 * what is. Errors: also IO. */
conic_status cli_layer_estimate(cli_layer_job *job, conic_model *model, conic_repairs *repairs);
/* The two options, in the commands' tables. */
#define CLI_LAYER_KEEPING(job)                                                                                         \
  {"resumable", CLI_FLAG, &(job).is_resumable, NULL,                                                                   \
   "note in OUT.branches what is finished, so that --resume can go on after any end"},                                 \
  {                                                                                                                    \
    "resume", CLI_TEXT, &(job).resume_path, "OUT",                                                                     \
        "go on with what OUT.branches says is finished, to the same bytes; with --resumable, too, where there is "     \
        "none "                                                                                                        \
        "begin"                                                                                                        \
  }

/* How many raw points of a file are estimated from the whole of it, at most. */
uint64_t cli_layer_most_whole(const cli_layer_job *job);
/* How inputs are read, but for which points of them are wanted. */
void cli_layer_reading(const cli_layer_job *job, conic_read_options *options);
/* Appends this process's share to the builder. Errors: as conic_model_stream and conic_layers_builder_append. */
conic_status cli_layer_read_share(cli_layer_job *job, conic_read_options *options);

#endif
