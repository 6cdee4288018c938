/* Writes a picture that is drawn in strips, as their rows come: to its file those whose turn it is, and others to a
 * file beside it until then; or, where it is to be gone on with, to OUT.strips (cli/render/strips_file.h). */
#ifndef CONIC_STRIPS_WRITER_H
#define CONIC_STRIPS_WRITER_H

#include "cli/render/strip_list.h"
#include "cli/render/strips_file.h"
#include "cli/scene/render_job.h"
#include "core/pictures/image_exr_bands.h"

typedef struct cli_strips_writer {
  /* Filled in by the caller: */
  cli_session *session;
  cli_render_job *job; /* whose hashes grow where is_hashed */
  const conic_camera *camera;
  const char *path, *part; /* part: null where nothing is kept */
  unsigned written;        /* planes, as bits */
  int is_hashed;
  const cli_strip *strips; /* all of the picture's, from the top */
  cli_strips_file kept;

  /* Its own: */
  conic_status status;
  conic_exr_bands *file;
  size_t next, n_passed; /* the strip whose turn it is, and those before it that are drawn */
  conic_image odd;       /* rows that are not yet enough to be packed, from */
  int odd_y, n_odd;
  conic_pile pile;
  cli_strip_record *waiting;
  size_t first_waiting, n_waiting, waiting_room;
} cli_strips_writer;

/* Once what the header says is known: the job's statistics are those of any strip. Errors: as conic_exr_bands_open. */
conic_status cli_strips_writer_open(cli_strips_writer *writer, int is_display);

/* What waits from the beginning: the strips that are kept. Once it is open. Errors: MEMORY, IO, INPUT. */
conic_status cli_strips_writer_go_on(cli_strips_writer *writer);

/* Takes a piece, whose bytes follow it; of a strip in their order, which an end without rows ends. What fails is the
 * writer's status. */
void cli_strips_writer_take(cli_strips_writer *writer, const void *bytes);

/* Ends what was begun, and with success the file; returns the status. Errors: IO, ARGUMENT. */
conic_status cli_strips_writer_end(cli_strips_writer *writer, conic_status status);

#endif
