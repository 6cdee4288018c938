/* What the JSON of hierarchies has in common. */
#include "lod/hierarchies/hierarchy.h"

#include <string.h>

#include "core/base/memory.h"

/* Of any such file. */
enum { MOST_BYTES = 1 << 24 };

int conic_hierarchy_is_named(const char *name, const char *file) {
  size_t n = conic_ranges_is_url(name) ? strcspn(name, "?#") : strlen(name), n_file = strlen(file);
  return n >= n_file && memcmp(name + n - n_file, file, n_file) == 0 && (n == n_file || name[n - n_file - 1] == '/');
}

conic_status conic_hierarchy_read_json(const conic_hierarchy *hierarchy, conic_json *json) {
  uint64_t size = conic_ranges_size(hierarchy->ranges);
  unsigned char *bytes;
  if (size > MOST_BYTES)
    return conic_hierarchy_wrong(hierarchy, "the file is too large");
  conic_status status = conic_hierarchy_read(hierarchy, 0, (size_t)size, &bytes);
  if (status == CONIC_OK)
    status = conic_json_take(hierarchy->context, hierarchy->name, bytes, (size_t)size, json);
  conic_memory_release(hierarchy->context, bytes);
  return status;
}

conic_status conic_hierarchy_numbers(conic_json *json, double *values, size_t n) {
  size_t n_read = 0;
  conic_status status = conic_json_numbers(json, values, n, &n_read);
  return status == CONIC_OK && n_read != n ? conic_json_wrong(json, "not as many numbers as there should be") : status;
}

conic_status conic_hierarchy_count(conic_json *json, uint64_t most, uint64_t *count) {
  double value = 0.0;
  conic_status status = conic_json_number(json, &value);
  *count = 0;
  if (status != CONIC_OK)
    return status;
  if (!(value >= 0.0 && value <= (double)most) || value != (double)(uint64_t)value)
    return conic_json_wrong(json, "no number of something");
  *count = (uint64_t)value;
  return CONIC_OK;
}
