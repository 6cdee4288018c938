#include "oracle/oracle_evidence.h"

CONIC_DEFINE_NAMES(conic_pixel_class_name, conic_pixel_class, CONIC_N_PIXEL_CLASSES, "equal", "rounded", "explained",
                   "wrong")

CONIC_DEFINE_ZERO_OPTIONS(conic_oracle_judging)

static int is_worse_fault(const oracle_worst *w, int i, const conic_oracle_fault *fault, double severity) {
  const conic_oracle_fault *other = &w->faults[i];
  if (severity != w->severity[i])
    return severity > w->severity[i];
  return fault->y != other->y ? fault->y < other->y : fault->x < other->x;
}

void conic_oracle_worst_put(oracle_worst *w, const conic_oracle_fault *fault, double severity) {
  int at = w->n;
  while (at > 0 && is_worse_fault(w, at - 1, fault, severity))
    at--;
  if (at == CONIC_MAX_FAULTS)
    return;
  w->n += w->n < CONIC_MAX_FAULTS;
  for (int k = w->n - 1; k > at; k--) {
    w->faults[k] = w->faults[k - 1];
    w->severity[k] = w->severity[k - 1];
  }
  w->faults[at] = *fault;
  w->severity[at] = severity;
}

int conic_oracle_evidence_fits(const conic_image *image, const conic_image *greatest) {
  if (!greatest)
    return 1;
  unsigned planes = conic_image_planes(image);
  return greatest->width == image->width && greatest->height == image->height &&
         (conic_image_planes(greatest) & planes) == planes;
}
