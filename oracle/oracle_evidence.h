/* What is held against the oracle: a value of a picture with what it stands for, and the pixels that are worst. */
#pragma once

#include "conic/oracle.h"
#include "oracle/oracle_math.h"

/* Of a picture's value the least and the greatest that it stands for. */
typedef struct oracle_evidence {
  double low, high;
} oracle_evidence;

static inline double oracle_sample_at(const conic_image *image, conic_plane plane, int is_uint, size_t at) {
  const void *values = image->planes[plane];
  return is_uint ? (double)((const uint32_t *)values)[at] : (double)((const float *)values)[at];
}

static inline oracle_evidence oracle_evidence_at(const conic_image *image, const conic_image *greatest,
                                                 conic_plane plane, int is_uint, size_t at) {
  double low = oracle_sample_at(image, plane, is_uint, at);
  return (oracle_evidence){low, greatest ? oracle_sample_at(greatest, plane, is_uint, at) : low};
}

/* NaN and infinity are no values; what has been cut off has one end. */
static inline int oracle_evidence_is_none(oracle_evidence e) {
  return !(e.low <= e.high) || e.low == INFINITY || e.high == -INFINITY;
}

/* The one of them that is next to a range. */
static inline double oracle_evidence_next(oracle_evidence e, double low, double high) {
  if (oracle_evidence_is_none(e))
    return e.low;
  return e.high < low ? e.high : e.low > high ? e.low : oracle_max(e.low, low);
}

/* How far they are outside of a range; infinity where they are none. */
static inline double oracle_evidence_outside(oracle_evidence e, double low, double high) {
  if (oracle_evidence_is_none(e))
    return INFINITY;
  double out = e.high < low ? low - e.high : e.low > high ? e.low - high : 0.0;
  return out == out ? out : INFINITY;
}

/* Whether it is the float next to a value, or stands for it. */
static inline int oracle_evidence_is_equal(oracle_evidence e, double value) {
  return e.low == e.high ? (float)e.low == (float)value : e.low <= value && value <= e.high;
}

/* The worst of many faults, the worst first; of those as bad, the first in the picture. */
typedef struct oracle_worst {
  conic_oracle_fault faults[CONIC_MAX_FAULTS];
  double severity[CONIC_MAX_FAULTS];
  int n;
} oracle_worst;

void conic_oracle_worst_put(oracle_worst *worst, const conic_oracle_fault *fault, double severity);

/* Whether the greatest values are there for all planes of an image. */
int conic_oracle_evidence_fits(const conic_image *image, const conic_image *greatest);
