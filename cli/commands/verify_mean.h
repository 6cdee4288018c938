/* conic verify of a picture that is the mean of samples: each of them, and the mean. */
#ifndef CONIC_VERIFY_MEAN_H
#define CONIC_VERIFY_MEAN_H

#include "cli/scene/render_job.h"
#include "conic/oracle.h"

typedef struct cli_mean_verdict {
  conic_reference reference;    /* of the mean; the caller's to release, also after a failure */
  conic_oracle_verdict verdict; /* of the picture: rgba, albedo and weight by the mean; Z, count and id by the middle */
  size_t n_wrong;               /* pixels of samples */
  conic_oracle_fault worst;     /* of these, in sample */
  unsigned long long i_worst;
  double render_ms, oracle_ms;
} cli_mean_verdict;

/* Judges the picture of so many samples as the options have it: the image, where `image_path` says that there is one,
 * or what is drawn into it here, and then each sample, too. `n_pixels` as verify has it. */
conic_status cli_verify_mean(cli_session *session, cli_render_job *scene, size_t n_pixels, const char *image_path,
                             conic_image *image, cli_mean_verdict *result);

#endif
