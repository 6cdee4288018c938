/* The oracle's reference of a scene of splats and triangles, for conic verify and conic judge. */
#pragma once

#include "cli/scene/render_job.h"

/* The reference of the choice for this camera. With `is_from_file`, ids are the names of the choice, as a picture from
 * a file has them. On success the caller owns *reference. */
conic_status cli_reference_draw(cli_session *session, const cli_render_job *scene, const conic_camera *camera,
                                conic_oracle_question question, conic_float_kind floats, size_t n_pixels,
                                int is_from_file, conic_reference *reference);

/* Refuses an image of another size, before the oracle has worked. */
conic_status cli_reference_check_size(const char *path, const conic_image *image, const conic_camera *camera);

/* Writes how a value of a pixel is wrong: as an object under `key`, or as members of an open object. */
void cli_report_fault(cli_json *json, const char *key, const conic_oracle_fault *fault);
void cli_fault_members(cli_json *json, const conic_oracle_fault *fault);

typedef struct cli_mean_verdict {
  conic_reference reference;    /* of the mean; the caller releases it, after a failure, too */
  conic_oracle_verdict verdict; /* of the picture: rgba, albedo and weight by the mean; Z, count and id by the middle */
  size_t n_wrong;               /* pixels of samples */
  conic_oracle_fault worst;     /* the worst of these, in sample: */
  unsigned long long i_worst;
  double render_ms, oracle_ms;
} cli_mean_verdict;

/* Judges the picture of as many samples as the options say: the image, if `image_path` names one; else the picture
 * drawn into it here, and then each sample, too. `n_pixels` as in verify. */
conic_status cli_verify_mean(cli_session *session, cli_render_job *scene, size_t n_pixels, const char *image_path,
                             conic_image *image, cli_mean_verdict *result);
