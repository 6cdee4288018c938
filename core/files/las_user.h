/* Which user a variable-length record of a LAS file belongs to. */
#ifndef CONIC_LAS_USER_H
#define CONIC_LAS_USER_H

#include <string.h>

/* Whether a record is that user's; `record` is its head, of 54 bytes. */
static inline int conic_las_is_of_user(const unsigned char *record, const char *user) {
  return strncmp((const char *)record + 2, user, 16) == 0;
}

#endif
