/* render --camera top: an orthophoto, north up, where it lies on the earth. */
#pragma once

#include "cli/cut_region.h"
#include "cli/json_write.h"
#include "cli/session.h"

struct cli_render_job;

/* What was asked for, and what became of it. */
typedef struct cli_top_job {
  int is_wanted;
  double gsd;         /* a pixel's edge in world units; 0: the points' spacing */
  cli_cut_region box; /* infinite: all there is */
  int epsg;           /* 0: as the file says */

  int64_t column, row; /* of the upper left pixel, from the world's origin (source/top_view.h) */
  int width, height;
  unsigned found_epsg; /* 0: none is known */
  uint64_t n_blocks;   /* drawn */
} cli_top_job;

/* Wrong usage where other options say something of a picture that is none from above. */
int cli_top_check(const cli_session *session, const struct cli_render_job *job);
/* Whether the outputs can be written, as far as their names tell. */
conic_status cli_top_check_formats(conic_context *context, const struct cli_render_job *job);
/* Draws and writes the pictures of an open scene, and reports. Returns the exit code. */
int cli_top_render(cli_session *session, struct cli_render_job *job);
