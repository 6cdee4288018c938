/* A file's points in parts, of which several processes each read their own: what they are handed is what one process
 * is that reads all, and in the order of the parts it is the same row of batches. */
#ifndef CONIC_MODEL_PART_H
#define CONIC_MODEL_PART_H

#include "conic/model.h"
#include "core/splats/builder.h"
#include "core/splats/raw_colors.h"

/* Parts begin at multiples of so many points: then the batches are those of the whole. */
enum { CONIC_PART_STEP = 1 << 16 };

/* What the head of a file says. */
typedef struct conic_model_shape {
  int can_part;      /* a part can be read without what comes before it; else nothing below is known */
  int is_raw;        /* points without normals and axes */
  int needs_survey;  /* what its colours mean is known once all have been looked at */
  uint64_t n_points; /* wanted or not */
  unsigned fields;   /* bits of conic_splats_field, if nothing but such points is made of the file; else 0 */
} conic_model_shape;

/* What is known of points once all have been looked at; zeroed: of none. */
typedef struct conic_model_survey {
  uint64_t n_wanted;
  conic_raw_range colors;
} conic_model_survey;

/* Looks at a file's head. Null options are the defaults. Errors: as conic_model_read. */
conic_status conic_model_look(conic_context *context, const char *path, const conic_read_options *options,
                              conic_model_shape *shape);

/* Adds what a part of a file has that can be parted. Errors: as conic_model_read. */
conic_status conic_model_survey_part(conic_context *context, const char *path, const conic_read_options *options,
                                     const conic_points_range *range, conic_model_survey *survey);
void conic_model_survey_add(conic_model_survey *survey, const conic_model_survey *other);

/* As conic_model_stream, a part of a file that can be parted, whose survey, if it needs one, is of all its points.
 * Errors: as conic_model_stream. */
conic_status conic_model_stream_part(conic_context *context, const char *path, const conic_read_options *options,
                                     const conic_points_range *range, const conic_model_survey *survey,
                                     conic_batch_receiver *receive, void *cookie);

#endif
