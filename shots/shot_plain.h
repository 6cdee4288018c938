/* Pictures that are the same have one shot. */
#ifndef CONIC_SHOT_PLAIN_H
#define CONIC_SHOT_PLAIN_H

#include "conic/shot_file.h"

/* What decides no bit becomes as it is by default: numbers of a lens, a shutter or an eye that there is not, of splats
 * where Gaussian scenes are composited, and so on. `abilities` are the source's, of conic_source_abilities. */
void conic_shot_file_plain(conic_shot_file *file, unsigned abilities);

#endif
