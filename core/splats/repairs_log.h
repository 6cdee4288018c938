#pragma once

#include "conic/model.h"

/* Says at level INFO what of a file's points could not be used as it stood; nothing where all could. */
void conic_repairs_log(conic_context *context, const char *path, const conic_repairs *repairs);
