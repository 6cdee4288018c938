/* The points of many inputs that several processes read together (cli/session_team.h). Each has a consecutive part; in
 * the order of the processes, the points come as for a single process. A process alone has all. */
#pragma once

#include "cli/session_team.h"
#include "core/formats/model_part.h"

/* This process's part of one input. */
typedef struct cli_points_piece {
  int input;
  int is_whole;
  conic_points_range range;  /* else */
  conic_model_survey survey; /* if it is a part: of the whole input */
} cli_points_piece;

/* Where a share begins: at a point of an input. The shape is known unless that is the first point. */
typedef struct cli_points_cut {
  int input;
  uint64_t point;
  conic_model_shape shape;
} cli_points_cut;

typedef struct cli_points_share {
  cli_session *session;
  const conic_team *team; /* null: this process is alone */
  char *names;
  const char **inputs; /* all inputs; a folder is replaced by its files */
  int n_inputs, n_uncut, are_surveys;
  cli_points_cut *cuts; /* by process, and the end */
  cli_points_piece *pieces;
  size_t n;
} cli_points_share;

/* Lists the inputs. The first `n_uncut` are .lpc files, which are not divided. A folder that is no hierarchy is
 * replaced by its files of points, in the order of their names' bytes. Collective. The caller ends the share, after a
 * failure, too. Errors: INPUT (a folder without files of points, standard input with several processes), MEMORY,
 * CANCELLED. */
conic_status cli_points_share_list(cli_session *session, const char *const *inputs, int n_inputs, int n_uncut,
                                   cli_points_share *share);
void cli_points_share_end(cli_points_share *share); /* zero is allowed */

/* Shares the inputs out by their bytes. Files of at most `most_whole` raw points are not divided. Collective. Errors:
 * as conic_model_read, CANCELLED. */
conic_status cli_points_share_out(cli_points_share *share, const conic_read_options *options, uint64_t most_whole);

/* cli_points_stream for one of this process's pieces. */
conic_status cli_points_share_stream(const cli_points_share *share, const cli_points_piece *piece,
                                     const conic_read_options *options, conic_batch_receiver *receive, void *cookie);
