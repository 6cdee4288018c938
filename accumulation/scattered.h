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

/* The sums as bytes of the same machine: *n_bytes of them at what is returned, behind a header of
 * CONIC_SCATTERED_HEADER words that is filled in. They are the sums' own. */
enum { CONIC_SCATTERED_HEADER = 4 };
const void *conic_accumulation_bytes(const conic_accumulation *sums, uint64_t header[CONIC_SCATTERED_HEADER],
                                     size_t *n_bytes);

/* Adds what conic_accumulation_bytes gave of other sums of the same size and planes. Errors: ARGUMENT (the bytes are
 * not so many, or the keys differ). */
conic_status conic_accumulation_join(conic_accumulation *sums, const uint64_t header[CONIC_SCATTERED_HEADER],
                                     const void *bytes, size_t n_bytes);

/* All samples are there: they are the run from `first_sample` on. */
void conic_accumulation_joined(conic_accumulation *sums, uint64_t first_sample);

/* No samples any more. */
void conic_accumulation_clear(conic_accumulation *sums);

#endif
