/* The coordinate system of world coordinates, as GeoTIFF states it (OGC 19-008r4) and LAS files keep it: numbered keys,
 * or an EPSG code from which such keys are made. */
#pragma once

#include "core/base/base.h"

/* All zero: not known. The arrays share one block, which conic_georeference_release gives back. */
typedef struct conic_georeference {
  uint16_t *keys;  /* GeoKeyDirectoryTag: a head of four numbers, then four a key; pixels are areas */
  double *numbers; /* GeoDoubleParamsTag */
  char *text;      /* GeoAsciiParamsTag, which ends in a zero byte */
  size_t n_keys, n_numbers, n_text;
  unsigned epsg;  /* of the projected system, or else of the geographic one; 0: it has no code */
  double unit_m;  /* metres of a unit of x and y; 0: the file does not say */
  int is_unknown; /* there are no keys, but the file names a system in well-known text without a code */
} conic_georeference;

/* Units of length by name, which null ends, and their metres; and the name by these, "units" for others. */
extern const char *const conic_unit_names[8];
extern const double conic_unit_metres[7];
const char *conic_unit_name(double unit_m);

/* A system from its code, 1 to 65535. Errors: MEMORY. */
conic_status conic_georeference_of_epsg(conic_context *context, unsigned epsg, conic_georeference *reference);
/* The code of the horizontal system in well-known text of either version, or in "EPSG:26910"; of text without codes
 * that of a zone of UTM on WGS 84 or NAD83, by its numbers. 0: it names none. */
unsigned conic_georeference_find_epsg(const char *text, size_t n_bytes);
/* Reads the head of a LAS: its header and the records before the points, as far as n_bytes hold them. Without a system
 * *reference is zero. Errors: MEMORY. */
conic_status conic_georeference_of_las(conic_context *context, const unsigned char *head, size_t n_bytes,
                                       conic_georeference *reference);
/* Reads the system of a LAS that can be read, also from records after its points, or of a PLY with "comment crs
 * EPSG:…". For other kinds of files *reference is zero. Errors: MEMORY. */
conic_status conic_georeference_read(conic_context *context, const char *path, conic_georeference *reference);
/* Errors: MEMORY. */
conic_status conic_georeference_copy(conic_context *context, const conic_georeference *from, conic_georeference *to);
void conic_georeference_release(conic_context *context, conic_georeference *reference);
