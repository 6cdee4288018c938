#include <stdio.h>
#include <string.h>

#include "conic/layers.h"

int conic_layers_is_file(const char *path) {
  char start[8] = "";
  FILE *file = fopen(path, "rb");
  size_t n = file ? fread(start, 1, sizeof start, file) : 0;
  if (file)
    fclose(file);
  return n == sizeof start && memcmp(start, "CONICLP\n", sizeof start) == 0;
}
