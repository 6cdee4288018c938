/* The oracle's reference of a scene of splats and triangles, for conic verify and conic judge. */
#ifndef CONIC_VERIFY_REFERENCE_H
#define CONIC_VERIFY_REFERENCE_H

#include "cli/scene/render_job.h"

/* The reference of the choice for this camera. With `is_from_file`, ids are the names of the choice, as a picture from
 * a file has them. On success the caller owns *reference. */
conic_status cli_reference_draw(cli_session *session, const cli_render_job *scene, const conic_camera *camera,
                                conic_oracle_question question, conic_float_kind floats, size_t n_pixels,
                                int is_from_file, conic_reference *reference);

/* Refuses an image of another size, before the oracle has worked. */
conic_status cli_reference_check_size(const char *path, const conic_image *image, const conic_camera *camera);

#endif
