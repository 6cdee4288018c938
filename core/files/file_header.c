#include "core/files/file_header.h"

#include <string.h>

#include "core/base/byte_order.h"
#include "core/base/message.h"
#include "core/files/file.h"

enum { AT_SUM = CONIC_FILE_HEADER_BYTES - 8 };

int conic_file_is_of_kind(const conic_file_kind *kind, const char *path) {
  return conic_file_begins_with(path, kind->magic, sizeof kind->magic);
}

void conic_file_make_header(const conic_file_kind *kind, const void *numbers,
                            unsigned char bytes[CONIC_FILE_HEADER_BYTES]) {
  memset(bytes, 0, CONIC_FILE_HEADER_BYTES);
  memcpy(bytes, kind->magic, sizeof kind->magic);
  conic_file_mend_header(kind, numbers, bytes);
}

void conic_file_mend_header(const conic_file_kind *kind, const void *numbers, unsigned char *bytes) {
  if (numbers)
    conic_file_fields_write(kind->fields, kind->n_fields, numbers, bytes + sizeof kind->magic);
  conic_store_64(bytes + AT_SUM, conic_checksum(bytes, AT_SUM));
}

conic_status conic_file_read_header(conic_context *context, const char *path, const conic_file_kind *kind,
                                    const unsigned char *bytes, size_t n_bytes, void *numbers) {
  if (n_bytes < sizeof kind->magic || memcmp(bytes, kind->magic, sizeof kind->magic) != 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: no %s file (at byte 0)", path, kind->ending);
  if (n_bytes < CONIC_FILE_HEADER_BYTES)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: ends within its header (at byte %zu)", path, n_bytes);
  uint32_t version = conic_load_32(bytes + sizeof kind->magic);
  if (version != kind->version)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: version %u of the format is not known (at byte 8)", path,
                      (unsigned)version);
  if (conic_load_64(bytes + AT_SUM) != conic_checksum(bytes, AT_SUM))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the header is damaged (at byte %d)", path, AT_SUM);
  conic_file_fields_read(kind->fields, kind->n_fields, bytes + sizeof kind->magic, numbers);
  const char *wrong = kind->fault(numbers);
  return wrong ? conic_fail(context, CONIC_ERROR_INPUT, "%s: the header has %s (at byte 8)", path, wrong) : CONIC_OK;
}

conic_status conic_file_open_kind(conic_context *context, const char *path, const conic_file_kind *kind,
                                  conic_mapping *file, void *numbers) {
  conic_status status = conic_mapping_open(context, path, file);
  return status == CONIC_OK ? conic_file_read_header(context, path, kind, file->bytes, file->n_bytes, numbers) : status;
}
