/* Sums of samples that are no run: parts of one accumulation that several processes make. Until they are joined into
 * sums of a run, their facts mean nothing. */
#ifndef CONIC_SCATTERED_H
#define CONIC_SCATTERED_H

#include "conic/accumulate.h"

/* Draws and adds the samples from `begin` to before `end`, whichever were added before. Sample 0 sets the key. `noise`,
 * `seconds` and `watch` are not looked at. Errors: as conic_accumulate. */
conic_status conic_accumulate_range(conic_context *context, const conic_accumulate_options *options, uint64_t begin,
                                    uint64_t end, conic_accumulation *sums);

/* Whether the samples of a run are enough for the options, but for their seconds. */
int conic_accumulate_is_enough(const conic_accumulate_options *options, const conic_accumulation *sums);

/* What conic_accumulate does first with sums that have samples already. Errors: as there. */
conic_status conic_accumulate_check_key(conic_context *context, const conic_accumulate_options *options,
                                        conic_accumulation *sums);

/* The sums in `n` parts, one behind the other: part `i` as *n_bytes bytes of the same machine, which are the sums' own.
 */
const void *conic_accumulation_part(const conic_accumulation *sums, int i, int n, size_t *n_bytes);

/* Adds to a part the same part of other sums of the same size and planes. Errors: ARGUMENT (it is not so long). */
conic_status conic_accumulation_join_part(conic_accumulation *sums, int i, int n, const void *bytes, size_t n_bytes);

/* What is to be known of sums beside their parts. */
typedef struct conic_scattered {
  uint64_t n_samples, n_half, key;
} conic_scattered;
conic_scattered conic_accumulation_scattered(const conic_accumulation *sums);

/* Takes a part to which other sums were joined elsewhere, and the samples of whoever had it. Errors: ARGUMENT (it is
 * not so long, or the keys differ). */
conic_status conic_accumulation_take_part(conic_accumulation *sums, int i, int n, const conic_scattered *other,
                                          const void *bytes, size_t n_bytes);

/* All samples are there: they are the run from `first_sample` on. */
void conic_accumulation_joined(conic_accumulation *sums, uint64_t first_sample);

/* No samples any more. */
void conic_accumulation_clear(conic_accumulation *sums);

#endif
