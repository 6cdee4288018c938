/* The points of many inputs that several processes take in (cli/session_team.h), each a part of them in a row: in the
 * order of the processes they come as one process would have them. Alone, a process has all. */
#ifndef CONIC_POINTS_SHARE_H
#define CONIC_POINTS_SHARE_H

#include "cli/session_team.h"
#include "core/formats/model_part.h"

/* What of one input is this process's. */
typedef struct cli_points_piece {
  int input;
  int is_whole;
  conic_points_range range;  /* else */
  conic_model_survey survey; /* else, of the whole input */
} cli_points_piece;

/* Where a share begins: at a point of an input, of which this is known where it is not the first. */
typedef struct cli_points_cut {
  int input;
  uint64_t point;
  conic_model_shape shape;
} cli_points_cut;

typedef struct cli_points_share {
  cli_session *session;
  const conic_team *team; /* null: alone */
  char *names;
  const char **inputs; /* of all; a folder stands for its files */
  int n_inputs, n_uncut, are_surveys;
  cli_points_cut *cuts; /* by process, and the end */
  cli_points_piece *pieces;
  size_t n;
} cli_points_share;

/* Lists the inputs, of which the first `n_uncut` are .lpc files, that are not parted: of a folder, that is no
 * hierarchy, the files of points by their names' bytes. Collective. The caller ends it, also after a failure. Errors:
 * INPUT (a folder without any, standard input of several), MEMORY, CANCELLED. */
conic_status cli_points_share_list(cli_session *session, const char *const *inputs, int n_inputs, int n_uncut,
                                   cli_points_share *share);
void cli_points_share_end(cli_points_share *share); /* zero is allowed */

/* Shares them out, by their bytes; raw ones of no more than `most_whole` points are not parted. Collective. Errors: as
 * conic_model_read, CANCELLED. */
conic_status cli_points_share_out(cli_points_share *share, const conic_read_options *options, uint64_t most_whole);

/* As cli_points_stream, of one of this process's pieces. */
conic_status cli_points_share_stream(const cli_points_share *share, const cli_points_piece *piece,
                                     const conic_read_options *options, conic_batch_receiver *receive, void *cookie);

#endif
