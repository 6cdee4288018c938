/* What the text of shots has besides the fields. */
#ifndef CONIC_SHOT_ROLES_H
#define CONIC_SHOT_ROLES_H

#include "conic/shot_file.h"

/* Of the text: it grows with every field that older versions do not know. */
enum { CONIC_SHOT_VERSION = 1 };

/* "scene", "texture" …; null for a number that is none. */
const char *conic_shot_role_name(conic_shot_role role);

#endif
