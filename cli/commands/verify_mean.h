/* conic verify for a picture that is the mean of samples: judges each sample, and the mean. */
#ifndef CONIC_VERIFY_MEAN_H
#define CONIC_VERIFY_MEAN_H

#include "cli/scene/render_job.h"
#include "conic/oracle.h"

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

#endif
