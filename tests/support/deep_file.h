/* What the tests of deep images share: reading one back, and holding it against the picture. */
#pragma once

#include "core/base/byte_order.h"
#include "tests/support/fixture.h"
#include "tests/support/image_fixture.h"
#if CONIC_HAVE_ZLIB
#include <zlib.h>
#endif

/* Steps over the attributes of an EXR's header; `most` becomes maxSamplesPerPixel. Returns where the table of the
 * lines' places begins. */
static inline size_t deep_skip_header(const unsigned char *bytes, size_t n_bytes, int32_t *most) {
  size_t at = 8;
  while (at < n_bytes && bytes[at]) {
    const char *name = (const char *)bytes + at;
    int32_t size;
    at += strlen(name) + 1;
    at += strlen((const char *)bytes + at) + 1;
    size = (int32_t)conic_load_32(bytes + at);
    at += 4;
    if (strcmp(name, "maxSamplesPerPixel") == 0)
      *most = (int32_t)conic_load_32(bytes + at);
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

typedef struct deep_sample {
  float rgba[4], depth, weight;
  uint32_t id;
} deep_sample;

/* What ZIPS has made of n bytes, undone; the caller frees. */
static inline unsigned char *deep_unpack(const unsigned char *packed, size_t n_packed, size_t n) {
  unsigned char *bytes = malloc(n + 1), *arranged = malloc(n + 1);
  if (!bytes || !arranged)
    exit(1);
  if (n_packed == n)
    memcpy(bytes, packed, n);
#if CONIC_HAVE_ZLIB
  else {
    uLongf n_found = (uLongf)n;
    CHECK(uncompress(arranged, &n_found, packed, (uLong)n_packed) == Z_OK && n_found == n);
    for (size_t i = 1; i < n; i++)
      arranged[i] = (unsigned char)(arranged[i] + arranged[i - 1] - 128);
    for (size_t i = 0; i < n; i++)
      bytes[i] = arranged[i / 2 + (i % 2 ? (n + 1) / 2 : 0)];
  }
#endif
  free(arranged);
  return bytes;
}

static inline int deep_compare_ids(const void *a, const void *b) {
  const deep_sample *first = a, *second = b;
  return (first->id > second->id) - (first->id < second->id);
}

/* From front to back, and over each other the picture: a sample covers what those before it have left. */
static inline void deep_check_flat(const fixture *f, const deep_sample *samples, size_t n, int x, int y) {
  double over[4] = {0.0, 0.0, 0.0, 0.0};
  for (size_t i = 0; i < n; i++) {
    const double left = 1.0 - over[3];
    CHECK(i == 0 || samples[i].depth >= samples[i - 1].depth);
    CHECK(samples[i].rgba[3] > 0.0f && samples[i].rgba[3] <= 1.0f);
    for (int c = 0; c < 4; c++)
      over[c] += left * (double)samples[i].rgba[c];
  }
  CHECK(n == 0 || samples[n - 1].rgba[3] == 1.0f);
  for (int c = 0; c < 4; c++)
    CHECK_NEAR(over[c], (double)fixture_pixel(f, CONIC_PLANE_RGBA, x, y)[c], 2e-6);
}

/* In the order of their numbers the samples add up to the picture's other planes. */
static inline void deep_check_sums(const fixture *f, size_t n_splats, deep_sample *samples, size_t n, int x, int y,
                                   deep_counts *counts) {
  float sum = 0.0f, heaviest = 0.0f, z = 0.0f;
  uint32_t named = fixture_index(f, CONIC_PLANE_ID, x, y);
  int is_named = named == CONIC_NO_ID;
  if (n > 0)
    qsort(samples, n, sizeof *samples, deep_compare_ids);
  for (size_t i = 0; i < n; i++) {
    const deep_sample *s = &samples[i];
    sum += s->weight;
    z = heaviest < s->weight ? s->depth : z;
    heaviest = heaviest < s->weight ? s->weight : heaviest;
    is_named |= s->id == named;
    CHECK(i == 0 || s->id > samples[i - 1].id);
    CHECK(s->id < n_splats || (s->weight == 1.0f && i == n - 1));
    counts->n_splats += s->id < n_splats;
    counts->n_triangles += s->id >= n_splats;
    counts->n_mixed += s->id >= n_splats && i > 0;
  }
  CHECK(sum == *fixture_pixel(f, CONIC_PLANE_WEIGHT, x, y));
  CHECK(z == *fixture_pixel(f, CONIC_PLANE_Z, x, y));
  CHECK(n == fixture_index(f, CONIC_PLANE_COUNT, x, y));
  CHECK(is_named);
  counts->most = (int32_t)n > counts->most ? (int32_t)n : counts->most;
}

/* A line, in its file's own layout: y, the packed sizes of the table and the samples, the samples' size; then both. The
 * channels stand in the order of their names: A, B, G, R, Z, id, weight. */
static inline void deep_check_line(const fixture *f, size_t n_splats, const unsigned char *chunk, int y,
                                   deep_counts *counts) {
  int32_t line = (int32_t)conic_load_32(chunk), begin = 0;
  uint64_t sizes[3] = {conic_load_64(chunk + 4), conic_load_64(chunk + 12), conic_load_64(chunk + 20)};
  size_t width = (size_t)f->camera.width;
  CHECK(line == y && sizes[0] <= 4 * width && sizes[1] <= sizes[2] && sizes[2] % 28 == 0);
  unsigned char *ends = deep_unpack(chunk + 28, sizes[0], 4 * width);
  unsigned char *values = deep_unpack(chunk + 28 + sizes[0], sizes[1], sizes[2]);
  size_t n = sizes[2] / 28;
  deep_sample *samples = calloc(n + 1, sizeof *samples);
  for (size_t i = 0; samples && i < n; i++) {
    void *const to[7] = {&samples[i].rgba[3], &samples[i].rgba[2], &samples[i].rgba[1], &samples[i].rgba[0],
                         &samples[i].depth,   &samples[i].id,      &samples[i].weight};
    for (size_t c = 0; c < 7; c++)
      memcpy(to[c], &(uint32_t){conic_load_32(values + 4 * (c * n + i))}, 4);
  }
  for (int x = 0; samples && x < f->camera.width; x++) {
    int32_t end = (int32_t)conic_load_32(ends + 4 * x);
    CHECK(begin <= end && (size_t)end <= n);
    deep_check_flat(f, samples + begin, (size_t)(end - begin), x, y);
    deep_check_sums(f, n_splats, samples + begin, (size_t)(end - begin), x, y, counts);
    begin = end;
  }
  CHECK((size_t)begin == n);
  free(ends);
  free(values);
  free(samples);
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
    uint64_t place = conic_load_64(bytes[0] + table + 8 * (size_t)y);
    CHECK(place < n_bytes[0]);
    if (place < n_bytes[0])
      deep_check_line(f, n_splats, bytes[0] + place, y, counts);
  }
  CHECK(counts->most == most_said);
  free(bytes[0]);
  free(bytes[1]);
  return 1;
}
