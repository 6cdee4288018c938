/* Whose a record of variable length in a LAS file is. */
#ifndef CONIC_LAS_USER_H
#define CONIC_LAS_USER_H

#include <string.h>

/* `record` is its head, of 54 bytes. */
static inline int conic_las_is_of_user(const unsigned char *record, const char *user) {
  return strncmp((const char *)record + 2, user, 16) == 0;
}

#endif
