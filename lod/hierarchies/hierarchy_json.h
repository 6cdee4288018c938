/* What the JSON of hierarchies has in common. */
#ifndef CONIC_HIERARCHY_JSON_H
#define CONIC_HIERARCHY_JSON_H

#include "core/files/json_read.h"
#include "lod/hierarchies/hierarchy.h"

/* Whether a name ends with this file; what a URL has from "?" on does not count. */
int conic_hierarchy_is_named(const char *name, const char *file);

/* Reads all of the opened file into *json, which the caller closes. Errors: as conic_ranges_read. */
conic_status conic_hierarchy_read_json(const conic_hierarchy *hierarchy, conic_json *json);

/* Reads the array that comes next, of exactly n numbers. */
conic_status conic_hierarchy_numbers(conic_json *json, double *values, size_t n);

/* A whole number from 0 to `most`. */
conic_status conic_hierarchy_count(conic_json *json, uint64_t most, uint64_t *count);

#endif
