/* What the tests of deep images share: reading one back, and holding it against the picture. */
#ifndef CONIC_DEEP_FILE_H
#define CONIC_DEEP_FILE_H

#include "tests/support/fixture.h"
#include "tests/support/image_fixture.h"

/* Steps over the attributes of an EXR's header; `most` becomes maxSamplesPerPixel. Returns where the table of the
 * lines' places begins. */
static inline size_t deep_skip_header(const unsigned char *bytes, size_t n_bytes, int32_t *most) {
  size_t at = 8;
  while (at < n_bytes && bytes[at]) {
    const char *name = (const char *)bytes + at;
    int32_t size;
    at += strlen(name) + 1;
    at += strlen((const char *)bytes + at) + 1;
    memcpy(&size, bytes + at, 4);
    at += 4;
    if (strcmp(name, "maxSamplesPerPixel") == 0)
      memcpy(most, bytes + at, 4);
    at += (size_t)size;
  }
  return at + 1;
}

/* What there is in a deep file. */
typedef struct deep_counts {
  int32_t most; /* in one pixel */
  size_t n_splats, n_triangles;
  size_t n_mixed; /* pixels of both */
} deep_counts;

/* One line of the file against the picture: the weights of each pixel add up to its weight plane, the first of the
 * heaviest has its depth, what is named by its id is there, and a triangle comes last and with weight 1. */
static inline void deep_check_line(const fixture *f, size_t n_splats, const unsigned char *chunk, int y,
                                   deep_counts *counts) {
  int32_t line, begin = 0;
  uint64_t sizes[3];
  size_t width = (size_t)f->camera.width;
  memcpy(&line, chunk, 4);
  memcpy(sizes, chunk + 4, sizeof sizes);
  CHECK(line == y && sizes[0] == 4 * width && sizes[1] == sizes[2] && sizes[1] % 12 == 0);
  const unsigned char *ends = chunk + 28, *depths = ends + 4 * width, *ids = depths + sizes[1] / 3;
  const unsigned char *weights = ids + sizes[1] / 3;
  for (int x = 0; x < f->camera.width; x++) {
    int32_t end;
    float sum = 0.0f, heaviest = 0.0f, z = 0.0f, weight, depth;
    uint32_t id = CONIC_NO_ID, last = CONIC_NO_ID, named = fixture_index(f, CONIC_PLANE_ID, x, y);
    int is_named = named == CONIC_NO_ID;
    memcpy(&end, ends + 4 * x, 4);
    for (int32_t i = begin; i < end; i++) {
      memcpy(&weight, weights + 4 * i, 4);
      memcpy(&depth, depths + 4 * i, 4);
      memcpy(&id, ids + 4 * i, 4);
      sum += weight;
      z = heaviest < weight ? depth : z;
      heaviest = heaviest < weight ? weight : heaviest;
      is_named |= id == named;
      CHECK(last == CONIC_NO_ID || last < id);
      CHECK(id < n_splats || (weight == 1.0f && i == end - 1));
      counts->n_splats += id < n_splats;
      counts->n_triangles += id >= n_splats;
      counts->n_mixed += id >= n_splats && i > begin;
      last = id;
    }
    CHECK(sum == *fixture_pixel(f, CONIC_PLANE_WEIGHT, x, y));
    CHECK(z == *fixture_pixel(f, CONIC_PLANE_Z, x, y));
    CHECK((uint32_t)(end - begin) == fixture_index(f, CONIC_PLANE_COUNT, x, y));
    CHECK(is_named);
    counts->most = end - begin > counts->most ? end - begin : counts->most;
    begin = end;
  }
  CHECK((uint64_t)begin * 12 == sizes[1]);
}

/* Writes the deep image of what the fixture's picture was drawn of, by two numbers of threads, and compares it with the
 * picture. Returns 0 where this build has no deep images. */
static inline int deep_check(const fixture *f, const conic_drawing *drawing, const char *folder, deep_counts *counts) {
  static const int thread_counts[] = {3, 1};
  unsigned char *bytes[2] = {NULL, NULL};
  size_t n_bytes[2] = {0, 0};
  int32_t most_said = -1;
  conic_status status = CONIC_OK;
  memset(counts, 0, sizeof *counts);
  for (int i = 0; i < 2 && status == CONIC_OK; i++) {
    conic_contributions *c;
    char path[200];
    snprintf(path, sizeof path, "%s/deep.exr", folder);
    fixture other = fixture_open(thread_counts[i]);
    CHECK_OK(conic_contributions_create_drawing(other.context, drawing, &f->camera, &f->options, &c));
    status = conic_contributions_write(c, path, &f->image);
    conic_contributions_destroy(c);
    fixture_close(&other);
    if (status != CONIC_OK)
      continue;
    bytes[i] = read_bytes(path, &n_bytes[i]);
    remove(path);
  }
  if (status == CONIC_ERROR_UNSUPPORTED)
    return 0;
  CHECK_OK(status);
  CHECK(bytes[0] && bytes[1]);
  if (!bytes[0] || !bytes[1])
    return 1;
  CHECK(n_bytes[0] == n_bytes[1] && memcmp(bytes[0], bytes[1], n_bytes[0]) == 0);
  size_t table = deep_skip_header(bytes[0], n_bytes[0], &most_said),
         n_splats = drawing->splats ? drawing->splats->count : 0;
  for (int y = 0; y < f->camera.height; y++) {
    uint64_t place;
    memcpy(&place, bytes[0] + table + 8 * (size_t)y, 8);
    CHECK(place < n_bytes[0]);
    if (place < n_bytes[0])
      deep_check_line(f, n_splats, bytes[0] + place, y, counts);
  }
  CHECK(counts->most == most_said);
  free(bytes[0]);
  free(bytes[1]);
  return 1;
}

#endif
