/* What the oracle says that a scene of splats and triangles looks like, as conic verify and conic judge ask it. */
#ifndef CONIC_VERIFY_REFERENCE_H
#define CONIC_VERIFY_REFERENCE_H

#include "cli/scene/render_job.h"

/* Of what has been chosen for this camera. With `is_from_file`, ids are the names of what was chosen, as a picture from
 * a file has them. On success the caller owns *reference. */
conic_status cli_reference_draw(cli_session *session, const cli_render_job *scene, const conic_camera *camera,
                                conic_oracle_question question, conic_float_kind floats, size_t n_pixels,
                                int is_from_file, conic_reference *reference);

/* An image of another size is an input that can't be used, and is told before the oracle has worked. */
conic_status cli_reference_check_size(const char *path, const conic_image *image, const conic_camera *camera);

#endif
