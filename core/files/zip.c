#include "core/files/zip.h"

#include "core/base/byte_order.h"
#include "core/files/inflate.h"

/* Bytes of the records, without names and what follows them. */
enum { END = 22, ENTRY = 46, LOCAL = 30, STORED = 0, DEFLATED = 8 };

/* The CRC: a remainder by the polynomial 0x04c11db7, with its bits reversed. */
uint32_t conic_zip_sum(const unsigned char *bytes, size_t n) {
  uint32_t table[256], sum = 0xffffffff;
  for (uint32_t i = 0; i < 256; i++) {
    table[i] = i;
    for (int bit = 0; bit < 8; bit++)
      table[i] = table[i] >> 1 ^ (table[i] & 1 ? 0xedb88320 : 0);
  }
  for (size_t i = 0; i < n; i++)
    sum = sum >> 8 ^ table[(sum ^ bytes[i]) & 0xff];
  return ~sum;
}

static conic_status zip_wrong(const conic_zip *zip, const char *what, size_t at) {
  return conic_fail(zip->context, CONIC_ERROR_INPUT, "%s: the ZIP archive is spoiled: %s (at byte %zu)", zip->name,
                    what, at);
}

conic_status conic_zip_open(conic_context *context, const char *name, const unsigned char *bytes, size_t n_bytes,
                            conic_zip *zip) {
  *zip = (conic_zip){.context = context, .name = name, .bytes = bytes, .n_bytes = n_bytes};
  size_t earliest = n_bytes > END + 65535 ? n_bytes - END - 65535 : 0, at = n_bytes < END ? 0 : n_bytes - END;
  while (n_bytes >= END && at > earliest && memcmp(bytes + at, "PK\5\6", 4) != 0)
    at--;
  if (n_bytes < END || memcmp(bytes + at, "PK\5\6", 4) != 0)
    return zip_wrong(zip, "its list of files is not there", n_bytes);
  size_t n_directory = conic_load_32(bytes + at + 12);
  zip->n_entries = conic_load_16(bytes + at + 10);
  zip->directory = conic_load_32(bytes + at + 16);
  if (n_directory > at || zip->directory > at - n_directory)
    return zip_wrong(zip, "its list of files is not where it should be", at);
  return CONIC_OK;
}

static const size_t none = (size_t)-1;

/* How long the name of the entry at `at` is, and where the next one begins; 0: it is none. */
static int measure_entry(const conic_zip *zip, size_t at, size_t *n_name, size_t *next) {
  if (at > zip->n_bytes || zip->n_bytes - at < ENTRY || memcmp(zip->bytes + at, "PK\1\2", 4) != 0)
    return 0;
  const unsigned char *entry = zip->bytes + at;
  *n_name = conic_load_16(entry + 28);
  *next = at + ENTRY + *n_name + conic_load_16(entry + 30) + conic_load_16(entry + 32);
  return *next <= zip->n_bytes;
}

/* Finds the entry of that file, or `none`; returns 0 where the list is spoiled. */
static int find_entry(const conic_zip *zip, const char *file, size_t *found) {
  size_t n_file = strlen(file), n_name, at = zip->directory, next;
  for (size_t i = 0; i < zip->n_entries; i++, at = next) {
    *found = at;
    if (!measure_entry(zip, at, &n_name, &next))
      return 0;
    const unsigned char *name = zip->bytes + at + ENTRY;
    if (n_name >= n_file && memcmp(name + n_name - n_file, file, n_file) == 0 &&
        (n_name == n_file || name[n_name - n_file - 1] == '/'))
      return 1;
  }
  *found = none;
  return 1;
}

int conic_zip_next(const conic_zip *zip, size_t *at, char name[CONIC_ZIP_NAME]) {
  size_t n_name, next, here = *at ? *at : zip->directory;
  if (!measure_entry(zip, here, &n_name, &next))
    return 0;
  snprintf(name, CONIC_ZIP_NAME, "%.*s", (int)n_name, (const char *)zip->bytes + here + ENTRY);
  *at = next;
  return 1;
}

int conic_zip_has(const conic_zip *zip, const char *file) {
  size_t found;
  return find_entry(zip, file, &found) && found != none;
}

/* Where the packed bytes begin, after their record; `none` where some are missing. */
static size_t find_packed(const conic_zip *zip, size_t local, size_t n_packed) {
  if (local > zip->n_bytes || zip->n_bytes - local < LOCAL || memcmp(zip->bytes + local, "PK\3\4", 4) != 0)
    return none;
  size_t at = local + LOCAL + conic_load_16(zip->bytes + local + 26) + conic_load_16(zip->bytes + local + 28);
  return at <= zip->n_bytes && zip->n_bytes - at >= n_packed ? at : none;
}

static conic_status unpack_file(const conic_zip *zip, size_t entry_at, size_t packed, size_t n_packed,
                                unsigned char *to, size_t n_bytes) {
  const unsigned char *entry = zip->bytes + entry_at;
  size_t n = n_packed;
  if (conic_load_16(entry + 10) == STORED)
    memcpy(to, zip->bytes + packed, n_bytes < n_packed ? n_bytes : n_packed);
  else
    n = conic_inflate(CONIC_DEFLATE_BARE, zip->bytes + packed, n_packed, to, n_bytes, NULL);
  return n == n_bytes && conic_zip_sum(to, n_bytes) == conic_load_32(entry + 16)
             ? CONIC_OK
             : zip_wrong(zip, "a file in it is not what its sum says", packed);
}

/* Takes the sizes and the place of what is packed from ZIP64's field, which has those that do not fit into an entry. */
static void take_long(const unsigned char *entry, size_t *n_bytes, size_t *n_packed, size_t *local) {
  const unsigned char *at = entry + ENTRY + conic_load_16(entry + 28), *end = at + conic_load_16(entry + 30);
  size_t *const values[] = {n_bytes, n_packed, local};
  while (end - at >= 4 && conic_load_16(at) != 1 && end - at >= 4 + conic_load_16(at + 2))
    at += 4 + conic_load_16(at + 2);
  at += 4;
  for (int i = 0; i < 3; i++)
    if (*values[i] == 0xffffffff && end - at >= 8) {
      *values[i] = (size_t)conic_load_64(at);
      at += 8;
    }
}

conic_status conic_zip_read(const conic_zip *zip, const char *file, size_t most_bytes, unsigned char **contents,
                            size_t *n_contents) {
  size_t at;
  *contents = NULL;
  *n_contents = 0;
  if (!find_entry(zip, file, &at))
    return zip_wrong(zip, "an entry of its list is none", at);
  if (at == none)
    return conic_fail(zip->context, CONIC_ERROR_INPUT, "%s: the ZIP archive has no file %s (at byte %zu)", zip->name,
                      file, zip->directory);
  const unsigned char *entry = zip->bytes + at;
  size_t method = conic_load_16(entry + 10), n_packed = conic_load_32(entry + 20), n_bytes = conic_load_32(entry + 24);
  size_t local = conic_load_32(entry + 42);
  take_long(entry, &n_bytes, &n_packed, &local);
  size_t packed = find_packed(zip, local, n_packed);
  if (conic_load_16(entry + 8) & 1 || (method != STORED && method != DEFLATED))
    return zip_wrong(zip, "a file in it is encrypted, or packed in a way that is not known", at);
  if (method == DEFLATED && !conic_inflate_is_there())
    return conic_fail(zip->context, CONIC_ERROR_UNSUPPORTED, "%s: its files are deflated: this build lacks zlib",
                      zip->name);
  if (packed == none || n_bytes > most_bytes || (double)n_bytes > conic_inflate_most_bytes(n_packed) ||
      (method == STORED && n_bytes != n_packed))
    return zip_wrong(zip, "a file in it is larger than it can be", at);
  *contents = conic_memory_allocate(zip->context, n_bytes + 1, 1);
  if (!*contents)
    return CONIC_ERROR_MEMORY;
  conic_status status = unpack_file(zip, at, packed, n_packed, *contents, n_bytes);
  if (status == CONIC_OK) {
    *n_contents = n_bytes;
    return CONIC_OK;
  }
  conic_memory_release(zip->context, *contents);
  *contents = NULL;
  return status;
}

/* The facts of a file in both records, from "version needed" on. */
static void put_facts(const conic_zip_writer *writer, int i, unsigned char facts[26]) {
  memset(facts, 0, 26);
  conic_store_bits(facts, 2, 10);
  conic_store_bits(facts + 8, 2, 0x21); /* the first day that a date can hold */
  conic_store_32(facts + 10, writer->files[i].sum);
  conic_store_32(facts + 14, writer->files[i].n_bytes);
  conic_store_32(facts + 18, writer->files[i].n_bytes);
  conic_store_bits(facts + 22, 2, (uint32_t)strlen(writer->files[i].name));
}

static void put_record(conic_zip_writer *writer, const void *bytes, size_t n_bytes) {
  if (n_bytes > 0xfffff000 - writer->offset || fwrite(bytes, 1, n_bytes, writer->to) != n_bytes) {
    writer->is_failed = 1;
    return;
  }
  writer->offset += (uint32_t)n_bytes;
}

int conic_zip_add(conic_zip_writer *writer, const char *name, const unsigned char *bytes, size_t n_bytes) {
  unsigned char record[LOCAL] = "PK\3\4";
  int i = writer->n_files;
  if (i == CONIC_ZIP_MOST_FILES || n_bytes > 0xfffff000)
    return 0;
  snprintf(writer->files[i].name, sizeof writer->files[i].name, "%s", name);
  writer->files[i].sum = conic_zip_sum(bytes, n_bytes);
  writer->files[i].n_bytes = (uint32_t)n_bytes;
  writer->files[i].offset = writer->offset;
  writer->n_files++;
  put_facts(writer, i, record + 4);
  put_record(writer, record, sizeof record);
  put_record(writer, name, strlen(name));
  put_record(writer, bytes, n_bytes);
  return !writer->is_failed;
}

int conic_zip_end(conic_zip_writer *writer) {
  unsigned char end[END] = "PK\5\6";
  uint32_t directory = writer->offset;
  for (int i = 0; i < writer->n_files; i++) {
    unsigned char entry[ENTRY] = "PK\1\2";
    conic_store_bits(entry + 4, 2, 10);
    put_facts(writer, i, entry + 6);
    conic_store_32(entry + 42, writer->files[i].offset);
    put_record(writer, entry, sizeof entry);
    put_record(writer, writer->files[i].name, strlen(writer->files[i].name));
  }
  conic_store_bits(end + 8, 2, (uint32_t)writer->n_files);
  conic_store_bits(end + 10, 2, (uint32_t)writer->n_files);
  conic_store_32(end + 12, writer->offset - directory);
  conic_store_32(end + 16, directory);
  put_record(writer, end, sizeof end);
  return !writer->is_failed;
}
