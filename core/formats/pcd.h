/* The reader of PCD, the Point Cloud Library's format: ascii, binary and binary_compressed.
 *
 * Positions in single precision are kept as they are. Positions in double, and those of text, are measured from the
 * first finite one, the origin. A colour is packed (rgb, rgba) or three fields; its scale is told by the largest value
 * of the whole file (core/splats/raw_colors.h). The viewpoint is ignored. A file with fewer points than it declares is
 * read as far as it goes, with a warning. */
#ifndef CONIC_PCD_H
#define CONIC_PCD_H

#include "conic/model.h"
#include "core/files/input.h"
#include "core/splats/builder.h"

/* Whether the first line that is no comment is one of a PCD header. */
int conic_pcd_is_likely(const char *bytes, size_t n);

/* Reads a model from the start of the file; with a delivery the points go there. On failure *model is for the caller to
 * release. Errors: INPUT, MEMORY, CANCELLED, the receiver's. */
conic_status conic_pcd_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

#endif
