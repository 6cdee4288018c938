/* Points as LAS 1.4, in point format 6, or 7 with colours. */
#pragma once

#include "conic/splats.h"
#include "core/pictures/georeference.h"

typedef struct conic_las_writer conic_las_writer;

/* Starts a file that appears under its name when it is whole. If `source` (may be null) is a LAS or LAZ, the steps of
 * the positions, the kind of times and the records about the coordinate system are the source's. Else that is the
 * reference, which may be empty, and steps are 0.001, or 1e-7 where the first point may be longitude and latitude. On
 * success the caller owns *writer and ends it with conic_las_writer_end. Errors: ARGUMENT (standard output), MEMORY,
 * IO. */
conic_status conic_las_writer_open(conic_context *context, const char *path, const char *source,
                                   const conic_georeference *reference, conic_las_writer **writer);
/* Appends places, colours and the named values that the first batch has: as fields of the format where it has that
 * name, else as extra bytes. Positions that are not finite are left out. Errors: MEMORY, IO, UNSUPPORTED (a position is
 * too far out for its steps). */
conic_status conic_las_writer_append(conic_las_writer *writer, const conic_splats *batch);
/* Completes the file, or drops it if the status is not OK. Releases the writer, which may be null, and returns the
 * status. Errors: IO. */
conic_status conic_las_writer_end(conic_las_writer *writer, conic_status status);
