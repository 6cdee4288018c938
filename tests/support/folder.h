/* A new folder for what a test writes. */
#pragma once

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "core/files/disk.h"

enum { FOLDER_ROOM = 128 };

static inline void folder_make(char folder[FOLDER_ROOM]) {
  const char *place = getenv("TEMP"); /* Windows has no other */
  for (int i = 0; i < 100; i++) {
    snprintf(folder, FOLDER_ROOM, "%s/conic-test-%ld-%d", place ? place : "/tmp", (long)getpid(), i);
    if (conic_disk_make_folder(folder))
      return;
  }
  perror(folder);
  exit(1);
}
