/* How the head of a LAS file is laid out. */
#pragma once

#include <string.h>

/* Where the public header has its fields. */
enum {
  CONIC_LAS_ENCODING = 6,
  CONIC_LAS_MAJOR = 24,
  CONIC_LAS_MINOR = 25,
  CONIC_LAS_SYSTEM = 26,
  CONIC_LAS_SOFTWARE = 58,
  CONIC_LAS_HEADER_BYTES = 94,
  CONIC_LAS_POINTS = 96,
  CONIC_LAS_N_RECORDS = 100,
  CONIC_LAS_FORMAT = 104,
  CONIC_LAS_POINT_BYTES = 105,
  CONIC_LAS_N_POINTS_32 = 107,
  CONIC_LAS_SCALE = 131,
  CONIC_LAS_OFFSET = 155,
  CONIC_LAS_BOUNDS = 179,
  CONIC_LAS_WAVEFORMS = 227,    /* since 1.3: where waveforms begin */
  CONIC_LAS_LATE_RECORDS = 235, /* since 1.4: where the records after the points begin, and how many there are */
  CONIC_LAS_N_LATE_RECORDS = 243,
  CONIC_LAS_N_POINTS = 247,
  CONIC_LAS_BY_RETURN = 255
};

/* The least bytes of a header, those of version 1.4, and those of a record's head. */
enum { CONIC_LAS_LEAST_HEADER = 227, CONIC_LAS_HEADER_1_4 = 375, CONIC_LAS_RECORD_HEAD = 54 };

/* Whether the record with that head belongs to the user of coordinate systems. */
static inline int conic_las_is_of_world(const unsigned char *record) {
  return strncmp((const char *)record + 2, "LASF_Projection", 16) == 0;
}
