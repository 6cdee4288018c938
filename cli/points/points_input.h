/* Points to build from: a model's, or those of another kind's hierarchy, which may be on a web server. */
#pragma once

#include "cli/session.h"
#include "conic/gaussians.h"
#include "conic/layers_draw.h"
#include "core/base/base.h"
#include "core/pictures/georeference.h"

/* Whether it is read as another kind's hierarchy, which gives only places and colours. */
int cli_points_are_hierarchy(const char *path);

/* Whether a file is text, or cannot be looked at now. */
int cli_points_may_be_text(conic_context *context, const char *path);

/* Whether all are surveys, whose z points up. */
int cli_points_are_surveys(const char *const *paths, int n_paths);

/* conic_layers_open by the session's --timeout; of memory_bytes 0 is the library's. */
conic_status cli_points_open(cli_session *session, const char *path, uint64_t memory_bytes, conic_layers **layers);

/* The coordinate system of a file or a hierarchy of points. Errors: MEMORY; those of opening it. */
conic_status cli_points_find_reference(cli_session *session, const char *path, conic_georeference *reference);
/* Its code, for an output that keeps no more; 0: it has none. A warning says that a system without one gets lost; where
 * `keeps_none`, that any does. Errors: as above. */
conic_status cli_points_find_epsg(cli_session *session, const char *path, int keeps_none, unsigned *epsg);

/* Writes what was made of the input as a PLY, which keeps the input's system by its code. Errors: as above, IO. */
conic_status cli_points_write(cli_session *session, const char *input, const char *output, float cutoff,
                              const conic_splats *points);

/* As conic_model_stream. */
conic_status cli_points_stream(cli_session *session, const char *path, const conic_read_options *options,
                               conic_batch_receiver *receive, void *cookie);

/* As conic_gaussians_read_model. */
conic_status cli_points_read(cli_session *session, const char *path, const conic_read_options *options,
                             conic_model *model);

/* Appends the path to `names`, with a zero at its end; for a folder that is no hierarchy, appends each of its files
 * whose names end so, or of points where that is null, in the order of their names' bytes. The caller releases the
 * names. Errors: INPUT (the folder has none), MEMORY. */
conic_status cli_points_folder_list(conic_context *context, const char *path, const char *const *endings, char **names,
                                    size_t *n_bytes, size_t *room);
