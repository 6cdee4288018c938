/* The text in a picture that says how it was made (conic/shot_file.h): the string attribute conicShot of an EXR, the
 * text of that keyword in a PNG, the description of a TIFF. */
#pragma once

#include "core/base/base.h"

#define CONIC_SHOT_KEYWORD "conicShot"

/* Finds the text of a picture, or, of a file that begins as JSON does, all of it, with zero at its end; *text null: it
 * has none. The caller releases it through the context's memory. Errors: INPUT, MEMORY. */
conic_status conic_picture_shot_text(conic_context *context, const char *path, char **text, size_t *n_bytes);
