/* An E57 file of two scans that is put together in memory: pages, packets, and bits across their ends. */
#pragma once

#include "core/base/real.h"
#include "core/scans/e57_file.h"
#include "tests/support/check.h"

enum { E57_PAGE = 128, E57_CONTENT = E57_PAGE - 4, E57_POINTS = 5 };

typedef struct e57_test_file {
  unsigned char bytes[16384]; /* first the content alone, and at the end with the pages' sums */
  size_t n_bytes;
} e57_test_file;

/* Bits of one column, the lowest first. */
typedef struct e57_test_stream {
  unsigned char bytes[256];
  size_t n_bits;
} e57_test_stream;

static inline void e57_put(e57_test_file *file, uint64_t value, size_t n_bytes) {
  for (size_t i = 0; i < n_bytes; i++)
    file->bytes[file->n_bytes++] = (unsigned char)(value >> (8 * i));
}

static inline void e57_put_at(e57_test_file *file, size_t at, uint64_t value, size_t n_bytes) {
  size_t n = file->n_bytes;
  file->n_bytes = at;
  e57_put(file, value, n_bytes);
  file->n_bytes = n;
}

/* Where content lies once there are sums. */
static inline uint64_t e57_place(size_t content) {
  return content / E57_CONTENT * E57_PAGE + content % E57_CONTENT;
}

static inline void e57_stream_put(e57_test_stream *stream, uint64_t value, unsigned n_bits) {
  for (unsigned i = 0; i < n_bits; i++, stream->n_bits++)
    stream->bytes[stream->n_bits / 8] |= (unsigned char)((value >> i & 1u) << stream->n_bits % 8);
}

/* The section of a scan's streams, in two packets, of which the second begins within values, and an index and an
 * ignored packet between them. Returns where it begins. */
static inline size_t e57_put_section(e57_test_file *file, const e57_test_stream *streams, size_t n) {
  size_t section = file->n_bytes;
  e57_put(file, 1, 8);
  e57_put(file, 0, 8);
  e57_put(file, e57_place(section + 32), 8);
  e57_put(file, 0, 8);
  for (int half = 0; half < 2; half++) {
    size_t packet = file->n_bytes;
    e57_put(file, 1, 4);
    e57_put(file, n, 2);
    for (size_t i = 0; i < n; i++) {
      size_t all = (streams[i].n_bits + 7) / 8;
      e57_put(file, half ? all - all / 2 : all / 2, 2);
    }
    for (size_t i = 0; i < n; i++) {
      size_t all = (streams[i].n_bits + 7) / 8;
      for (size_t k = half ? all / 2 : 0; k < (half ? all : all / 2); k++)
        e57_put(file, streams[i].bytes[k], 1);
    }
    while (file->n_bytes % 4)
      e57_put(file, 0, 1);
    e57_put_at(file, packet + 2, file->n_bytes - packet - 1, 2);
    if (half == 0) {
      e57_put(file, 0 | 15 << 16, 4); /* an index of 16 bytes */
      e57_put(file, 0, 8);
      e57_put(file, 0, 4);
      e57_put(file, 2 | 3 << 16, 4);
    }
  }
  return section;
}

static const double e57_places[E57_POINTS][3] = {
    {5.0, 1.0, -2.0}, {5.01, 0.5, 3.0}, {-5.0, 2.25, 0.0}, {15.0, -1e3, 7.5}, {4.99, 0.125, 0.5}};
static const unsigned e57_intensities[E57_POINTS] = {0, 4095, 17, 2048, 1};
static const unsigned e57_states[E57_POINTS] = {0, 0, 2, 0, 1}; /* the third and the last were not measured */

static const char e57_cartesian[] =
    "<cartesianX type=\"ScaledInteger\" minimum=\"-1000\" maximum=\"1000\" scale=\"0.01\" offset=\"5\"/>"
    "<cartesianY type=\"Float\"/><cartesianZ type=\"Float\" precision=\"single\"/>"
    "<cartesianInvalidState type=\"Integer\" minimum=\"0\" maximum=\"2\"/>"
    "<intensity type=\"Integer\" minimum=\"0\" maximum=\"4095\">0</intensity>"
    "<colorRed type=\"Integer\" minimum=\"0\" maximum=\"255\"/><colorGreen type=\"Integer\" minimum=\"0\" "
    "maximum=\"255\"/>"
    "<colorBlue type=\"Integer\" minimum=\"0\" maximum=\"255\"/><rowIndex type=\"Integer\" minimum=\"7\" "
    "maximum=\"7\"/>";

static inline size_t e57_put_cartesian(e57_test_file *file) {
  e57_test_stream streams[9];
  memset(streams, 0, sizeof streams);
  for (int i = 0; i < E57_POINTS; i++) {
    int64_t x = (int64_t)((e57_places[i][0] - 5.0) * 100.0 + (e57_places[i][0] < 5.0 ? -0.5 : 0.5));
    e57_stream_put(&streams[0], (uint64_t)(x + 1000), 11);
    e57_stream_put(&streams[1], conic_bits_of_double(e57_places[i][1]), 64);
    e57_stream_put(&streams[2], conic_bits_of_float((float)e57_places[i][2]), 32);
    e57_stream_put(&streams[3], e57_states[i], 2);
    e57_stream_put(&streams[4], e57_intensities[i], 12);
    for (int channel = 0; channel < 3; channel++)
      e57_stream_put(&streams[5 + channel], (uint64_t)(50 * i + 10 * channel), 8);
  }
  return e57_put_section(file, streams, 9);
}

static const char e57_spherical[] = "<sphericalRange type=\"Float\"/><sphericalAzimuth type=\"Float\"/>"
                                    "<sphericalElevation type=\"Float\"/>";

/* Two points: 2 along x, and 3 along z. */
static inline size_t e57_put_spherical(e57_test_file *file) {
  static const double values[2][3] = {{2.0, 0.0, 0.0}, {3.0, 1.0, 1.57079632679489661923}};
  e57_test_stream streams[3];
  memset(streams, 0, sizeof streams);
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 3; k++)
      e57_stream_put(&streams[k], conic_bits_of_double(values[i][k]), 64);
  return e57_put_section(file, streams, 3);
}

/* Puts the sums in, from the last page to the first, for which its content moves. */
static inline void e57_put_pages(e57_test_file *file, size_t xml, size_t xml_bytes) {
  while (file->n_bytes % E57_CONTENT)
    e57_put(file, 0, 1);
  size_t n_pages = file->n_bytes / E57_CONTENT;
  for (size_t page = n_pages; page-- > 0;)
    memmove(file->bytes + page * E57_PAGE, file->bytes + page * E57_CONTENT, E57_CONTENT);
  file->n_bytes = n_pages * E57_PAGE;
  e57_put_at(file, 16, file->n_bytes, 8);
  e57_put_at(file, 24, e57_place(xml), 8);
  e57_put_at(file, 32, xml_bytes, 8);
  e57_put_at(file, 40, E57_PAGE, 8);
  conic_e57_mend(file->bytes, file->n_bytes);
}

/* A scan of cartesian points that is turned by 90° about z and moved to (100, 200, 300), and one of spherical ones at
 * the origin. */
static inline void e57_make(e57_test_file *file) {
  memset(file, 0, sizeof *file);
  memcpy(file->bytes, "ASTM-E57", 8);
  e57_put_at(file, 8, 1, 4);
  file->n_bytes = 48;
  uint64_t first = e57_place(e57_put_cartesian(file)), second = e57_place(e57_put_spherical(file));
  size_t xml = file->n_bytes;
  int n = snprintf(
      (char *)file->bytes + xml, sizeof file->bytes / 2 - xml,
      "<?xml version=\"1.0\"?><e57Root type=\"Structure\" xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\">"
      "<data3D type=\"Vector\"><vectorChild><pose><rotation><w>0.7071067811865476</w><x/><y>0</y>"
      "<z>0.7071067811865476</z></rotation><translation><x>100</x><y>2e2</y><z>300</z></translation></pose>"
      "<colorLimits><colorRedMinimum/><colorRedMaximum>255</colorRedMaximum></colorLimits>"
      "<points type=\"CompressedVector\" fileOffset=\"%llu\" recordCount=\"%d\"><prototype>%s</prototype>"
      "<codecs type=\"Vector\"/></points></vectorChild><vectorChild><points fileOffset=\"%llu\" recordCount=\"2\">"
      "<prototype>%s</prototype></points></vectorChild></data3D></e57Root>",
      (unsigned long long)first, E57_POINTS, e57_cartesian, (unsigned long long)second, e57_spherical);
  file->n_bytes += (size_t)n;
  e57_put_pages(file, xml, (size_t)n);
}
