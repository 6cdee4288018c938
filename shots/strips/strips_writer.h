/* Writes a picture that is drawn in strips, as their rows come: to its file those whose turn it is, and others to a
 * file beside it until then; or, where it is to be gone on with, to OUT.strips (shots/strips_file.h). */
#pragma once

#include "core/pictures/image_exr_bands.h"
#include "shots/strips/strip_list.h"
#include "shots/strips/strips.h"
#include "shots/strips/strips_file.h"

typedef struct conic_strips_writer {
  /* Filled in by the caller: */
  conic_context *context;
  const conic_camera *camera;
  const conic_strips_wish *wish; /* whose hashes grow */
  const char *part;              /* null where nothing is kept */
  const conic_strip *strips;     /* all of the picture's, from the top */
  conic_strips_file kept;

  /* Its own: */
  conic_status status;
  conic_exr_bands *file;
  size_t next, n_passed; /* the strip whose turn it is, and those before it that are drawn */
  conic_image odd;       /* rows that are not yet enough to be packed, from */
  int odd_y, n_odd;
  conic_pile pile;
  conic_strip_record *waiting;
  size_t first_waiting, n_waiting, waiting_room;
} conic_strips_writer;

/* Once what the header says is known, by the statistics of any strip. Errors: as conic_exr_bands_open. */
conic_status conic_strips_writer_open(conic_strips_writer *writer, const conic_render_statistics *statistics,
                                      int is_display);

/* What waits from the beginning: the strips that are kept. Once it is open. Errors: MEMORY, IO, INPUT. */
conic_status conic_strips_writer_go_on(conic_strips_writer *writer);

/* Takes a piece, whose bytes follow it; of a strip in their order, which an end without rows ends. What fails is the
 * writer's status. */
void conic_strips_writer_take(conic_strips_writer *writer, const void *bytes);

/* Ends what was begun, and with success the file; returns the status. Errors: IO, ARGUMENT. */
conic_status conic_strips_writer_end(conic_strips_writer *writer, conic_status status);
