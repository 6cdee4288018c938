/* Points to build from: a model's, or those of another kind's hierarchy, which may be on a web server. */
#ifndef CONIC_POINTS_INPUT_H
#define CONIC_POINTS_INPUT_H

#include "conic/gaussians.h"
#include "conic/model.h"

/* Whether it is read as another kind's hierarchy, which gives only places and colours. */
int cli_points_are_hierarchy(const char *path);

/* Whether all are surveys, whose z points up. */
int cli_points_are_surveys(const char *const *paths, int n_paths);

/* As conic_model_stream. */
conic_status cli_points_stream(conic_context *context, const char *path, const conic_read_options *options,
                               conic_batch_receiver *receive, void *cookie);

/* As conic_gaussians_read_model. */
conic_status cli_points_read(conic_context *context, const char *path, const conic_read_options *options,
                             conic_model *model);

#endif
