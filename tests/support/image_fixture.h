/* What the image tests share: a folder of their own, pictures with every kind of value, the features of the build. */
#pragma once

#include <dirent.h>
#include <stdint.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/folder.h"

#define EVERY_PLANE ((1u << CONIC_N_PLANES) - 1u)

static char test_folder[FOLDER_ROOM];

static inline void open_test_folder(void) {
  folder_make(test_folder);
}

/* The path of a file in the folder; two of them live at a time. */
static inline const char *in_folder(const char *name) {
  static char paths[2][512];
  static int turn;
  turn = 1 - turn;
  snprintf(paths[turn], sizeof paths[turn], "%s/%s", test_folder, name);
  return paths[turn];
}

/* Removes every file of the folder and says how many there were. */
static inline int empty_test_folder(void) {
  struct dirent *entry;
  int n = 0;
  DIR *folder = opendir(test_folder);
  while (folder && (entry = readdir(folder))) {
    if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
      continue;
    n += unlink(in_folder(entry->d_name)) == 0;
  }
  if (folder)
    closedir(folder);
  return n;
}

static inline void close_test_folder(void) {
  empty_test_folder();
  rmdir(test_folder);
}

static inline int has_feature(const char *name) {
  for (int i = 0; conic_feature_at(i); i++)
    if (strcmp(conic_feature_at(i)->name, name) == 0)
      return conic_feature_at(i)->available;
  return 0;
}

/* Reads a whole file; *n_bytes is 0 where it is not there. The caller frees. */
static inline unsigned char *read_bytes(const char *path, size_t *n_bytes) {
  FILE *file = fopen(path, "rb");
  *n_bytes = 0;
  if (!file)
    return NULL;
  fseek(file, 0, SEEK_END);
  size_t n = (size_t)ftell(file);
  rewind(file);
  unsigned char *bytes = malloc(n + 1);
  *n_bytes = bytes ? fread(bytes, 1, n, file) : 0;
  fclose(file);
  return bytes;
}

static inline void write_bytes(const char *path, const void *bytes, size_t n_bytes) {
  FILE *file = fopen(path, "wb");
  CHECK(file && fwrite(bytes, 1, n_bytes, file) == n_bytes);
  if (file)
    fclose(file);
}

/* A small generator of the same numbers everywhere. */
static inline uint32_t next_random(uint64_t *state) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (uint32_t)(*state >> 32);
}

/* An image whose planes hold numbers of all sizes, both zeros, infinities, NaN, denormals and the largest integers. */
static inline conic_image random_image(conic_context *context, int width, int height, unsigned planes) {
  static const float special[] = {0.0f, -0.0f, INFINITY, -INFINITY, NAN, 1e-40f, 3.4e38f, 1.0f};
  uint64_t state = 7;
  conic_image image;
  CHECK_OK(conic_image_allocate(context, width, height, planes, &image));
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    const conic_plane_description *plane = conic_plane_describe((conic_plane)i);
    size_t n = (size_t)width * (size_t)height * (size_t)plane->n_channels;
    for (size_t k = 0; image.planes[i] && k < n; k++) {
      uint32_t random = next_random(&state);
      if (plane->is_uint)
        ((uint32_t *)image.planes[i])[k] = random % 5 ? random : CONIC_NO_ID;
      else
        ((float *)image.planes[i])[k] =
            random % 16 < 8 ? special[random % 8] : ldexpf((float)next_random(&state), (int)(random >> 8) % 40 - 60);
    }
  }
  return image;
}

static inline int same_planes(const conic_image *a, const conic_image *b) {
  if (a->width != b->width || a->height != b->height || conic_image_planes(a) != conic_image_planes(b))
    return 0;
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    size_t n = (size_t)a->width * (size_t)a->height * (size_t)conic_plane_describe((conic_plane)i)->n_channels;
    if (a->planes[i] && memcmp(a->planes[i], b->planes[i], n * 4) != 0)
      return 0;
  }
  return 1;
}
