/* A file's points in parts, so that several processes can each read their own. The batches of the parts, in order, are
 * those of a process that reads the whole file. */
#pragma once

#include "core/splats/builder.h"
#include "core/splats/raw_colors.h"

/* Parts begin at multiples of so many points, as the whole file's batches do. */
enum { CONIC_PART_STEP = 1 << 16 };

/* The facts of a file's head. */
typedef struct conic_model_shape {
  int can_part;      /* parts can be read without what comes before them; else nothing below is known */
  int is_raw;        /* points without normals and axes */
  int needs_survey;  /* the meaning of its colours is known once all have been read */
  unsigned raw_kind; /* then they are of that conic_raw_kind */
  uint64_t n_points; /* all, wanted or not */
  unsigned fields;   /* bits of conic_splats_field, if the file becomes such points and nothing else; else 0 */
} conic_model_shape;

/* Facts about points that need all of them; zeroed: no points yet. */
typedef struct conic_model_survey {
  uint64_t n_wanted;
  conic_raw_range colors;
} conic_model_survey;

/* Reads a file's head. Null options are the defaults. Errors: as conic_model_read. */
conic_status conic_model_look(conic_context *context, const char *path, const conic_read_options *options,
                              conic_model_shape *shape);

/* Adds the facts of one part of a file that can be read in parts. Errors: as conic_model_read. */
conic_status conic_model_survey_part(conic_context *context, const char *path, const conic_read_options *options,
                                     const conic_points_range *range, conic_model_survey *survey);
void conic_model_survey_add(conic_model_survey *survey, const conic_model_survey *other);

/* conic_model_stream for one part of a file that can be read in parts; its survey, if it needs one, is of all its
 * points. Errors: as conic_model_stream. */
conic_status conic_model_stream_part(conic_context *context, const char *path, const conic_read_options *options,
                                     const conic_points_range *range, const conic_model_survey *survey,
                                     conic_batch_receiver *receive, void *cookie);
