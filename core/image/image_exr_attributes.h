/* An image's attributes in the header of an EXR that is being written. */
#ifndef CONIC_IMAGE_EXR_ATTRIBUTES_H
#define CONIC_IMAGE_EXR_ATTRIBUTES_H

#if CONIC_HAVE_OPENEXR

#include <openexr.h>

#include "conic/image.h"

/* Before the part is added: what their names need. */
exr_result_t conic_exr_prepare_attributes(exr_context_t file, const conic_image *image);

/* After the required attributes are set. */
exr_result_t conic_exr_add_attributes(exr_context_t file, const conic_image *image);

#endif
#endif
