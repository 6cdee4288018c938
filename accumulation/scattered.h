/* Sums of samples that are no run: several processes make them of one accumulation's samples. Their facts mean nothing
 * until they are joined into the sums of a run. */
#pragma once

#include "conic/accumulate.h"

/* Draws and adds the samples from `begin` to before `end`, whichever were added before. Sample 0 sets the key. Ignores
 * `noise`, `seconds` and `watch`. Errors: as conic_accumulate. */
conic_status conic_accumulate_range(conic_context *context, const conic_accumulate_options *options, uint64_t begin,
                                    uint64_t end, conic_accumulation *sums);

/* Whether the samples of a run are enough for the options, apart from their seconds. */
int conic_accumulate_is_enough(const conic_accumulate_options *options, const conic_accumulation *sums);

/* The check that conic_accumulate makes first with sums that have samples. Errors: as there. */
conic_status conic_accumulate_check_key(conic_context *context, const conic_accumulate_options *options,
                                        conic_accumulation *sums);

/* The sums are divided into `n` consecutive parts; returns part `i`, *n_bytes bytes in this machine's order, which the
 * sums own. */
const void *conic_accumulation_part(const conic_accumulation *sums, int i, int n, size_t *n_bytes);

/* Adds the same part of other sums of the same size and planes to a part. Errors: ARGUMENT (the length differs). */
conic_status conic_accumulation_join_part(conic_accumulation *sums, int i, int n, const void *bytes, size_t n_bytes);

/* What else must be known of sums beside their parts. */
typedef struct conic_scattered {
  uint64_t n_samples, n_half, key;
} conic_scattered;
conic_scattered conic_accumulation_scattered(const conic_accumulation *sums);

/* Replaces a part by one to which other sums were joined elsewhere, and adds the samples of its maker. Errors: ARGUMENT
 * (the length or the keys differ). */
conic_status conic_accumulation_take_part(conic_accumulation *sums, int i, int n, const conic_scattered *other,
                                          const void *bytes, size_t n_bytes);

/* Says that all samples are there: the run from `first_sample` on. */
void conic_accumulation_joined(conic_accumulation *sums, uint64_t first_sample);

/* Removes all samples. */
void conic_accumulation_clear(conic_accumulation *sums);
