#include "core/pictures/georeference.h"

#include <ctype.h>
#include <strings.h>

#include "core/base/byte_order.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/files/las_layout.h"
#include "core/files/number.h"

const char *const conic_unit_names[] = {"m", "mm", "cm", "km", "ft", "us-ft", "in", NULL};
const double conic_unit_metres[] = {1.0, 1e-3, 1e-2, 1e3, 0.3048, 1200.0 / 3937.0, 0.0254};

const char *conic_unit_name(double unit_m) {
  for (int i = 0; conic_unit_names[i]; i++)
    if (fabs(unit_m / conic_unit_metres[i] - 1.0) < 1e-9)
      return conic_unit_names[i];
  return "units";
}

/* GeoKeys: the kind of system (1: projected, 2: geographic), the kind of pixel (1: an area), the systems' codes, and
 * the code of the unit of lengths. */
enum {
  KEY_MODEL = 1024,
  KEY_RASTER = 1025,
  KEY_GEOGRAPHIC = 2048,
  KEY_PROJECTED = 3072,
  KEY_UNIT = 3076,
  USER_DEFINED = 32767
};

enum { KEY_NUMBERS = 4 }; /* of the directory's head, and of a key */

/* Of the head of a record after the points. */
enum { LATE_HEAD = 60 };
enum { RECORD_KEYS = 34735, RECORD_NUMBERS = 34736, RECORD_TEXT = 34737, RECORD_WKT = 2112 };

enum { MOST_HEAD = 1 << 24, MOST_TEXT = 1 << 16 };

void conic_georeference_release(conic_context *context, conic_georeference *reference) {
  conic_memory_release(context, reference->numbers);
  memset(reference, 0, sizeof *reference);
}

/* Makes room for so many of each; numbers first, for their alignment. */
static conic_status make_key_room(conic_context *context, size_t n_numbers, size_t n_keys, size_t n_text,
                                  conic_georeference *reference) {
  size_t n_bytes = n_numbers * sizeof(double) + n_keys * sizeof(uint16_t) + n_text;
  memset(reference, 0, sizeof *reference);
  reference->numbers = conic_memory_allocate_zeroed(context, n_bytes, 1);
  if (!reference->numbers)
    return CONIC_ERROR_MEMORY;
  reference->keys = (uint16_t *)(reference->numbers + n_numbers);
  reference->text = (char *)(reference->keys + n_keys);
  reference->n_numbers = n_numbers;
  reference->n_keys = n_keys;
  reference->n_text = n_text;
  return CONIC_OK;
}

conic_status conic_georeference_copy(conic_context *context, const conic_georeference *from, conic_georeference *to) {
  memset(to, 0, sizeof *to);
  if (!from->keys)
    return CONIC_OK;
  conic_status status = make_key_room(context, from->n_numbers, from->n_keys, from->n_text, to);
  if (status != CONIC_OK)
    return status;
  memcpy(to->keys, from->keys, from->n_keys * sizeof *to->keys);
  memcpy(to->numbers, from->numbers, from->n_numbers * sizeof *to->numbers);
  memcpy(to->text, from->text, from->n_text);
  to->epsg = from->epsg;
  to->unit_m = from->unit_m;
  return CONIC_OK;
}

static void put_key(uint16_t *to, unsigned key, unsigned value) {
  to[0] = (uint16_t)key;
  to[1] = 0; /* the value is here */
  to[2] = 1;
  to[3] = (uint16_t)value;
}

conic_status conic_georeference_of_epsg(conic_context *context, unsigned epsg, conic_georeference *reference) {
  const int is_geographic = epsg >= 4000 && epsg < 5000; /* EPSG reserves these codes for geographic systems */
  conic_status status = make_key_room(context, 0, (size_t)4 * KEY_NUMBERS, 0, reference);
  if (status != CONIC_OK)
    return status;
  static const uint16_t head[KEY_NUMBERS] = {1, 1, 0, 3};
  memcpy(reference->keys, head, sizeof head);
  put_key(reference->keys + 4, KEY_MODEL, is_geographic ? 2 : 1);
  put_key(reference->keys + 8, KEY_RASTER, 1);
  put_key(reference->keys + 12, is_geographic ? KEY_GEOGRAPHIC : KEY_PROJECTED, epsg);
  reference->epsg = epsg;
  return CONIC_OK;
}

/* --- well-known text --- */

/* Where the bracket of the first of these elements opens; null: there is none. Quoted names are skipped. */
static const char *find_element(const char *at, const char *end, const char *const *names) {
  int is_quoted = 0;
  for (; at < end; at++) {
    is_quoted ^= *at == '"';
    for (size_t i = 0; names[i] && !is_quoted; i++) {
      size_t n = strlen(names[i]);
      size_t blanks = n;
      while ((size_t)(end - at) > blanks && at[blanks] == ' ')
        blanks++;
      if ((size_t)(end - at) > blanks && memcmp(at, names[i], n) == 0 && at[blanks] == '[')
        return at + blanks;
    }
  }
  return NULL;
}

/* The number after `beginning`; 0: the code begins otherwise. */
static unsigned take_code(const char *at, const char *end, const char *beginning) {
  size_t n = strlen(beginning);
  unsigned code = 0;
  if ((size_t)(end - at) <= n || memcmp(at, beginning, n) != 0)
    return 0;
  for (at += n; at < end && (*at == '"' || *at == ' ');)
    at++;
  for (; at < end && *at >= '0' && *at <= '9' && code < 100000; at++)
    code = 10 * code + (unsigned)(*at - '0');
  return code < 65536 ? code : 0;
}

/* The code of the element itself, not of an element within it. */
static unsigned find_own_code(const char *open, const char *end) {
  int depth = 0, is_quoted = 0;
  for (const char *at = open; at < end; at++) {
    is_quoted ^= *at == '"';
    if (is_quoted || (*at != '[' && *at != ']'))
      continue;
    depth += *at == '[' ? 1 : -1;
    if (depth == 0)
      return 0;
    int is_id = depth == 2 && ((at - open > 9 && memcmp(at - 9, "AUTHORITY", 9) == 0) ||
                               (at - open > 3 && (at[-3] == ',' || at[-3] == ' ') && memcmp(at - 2, "ID", 2) == 0));
    if (is_id && *at == '[') /* AUTHORITY["EPSG","26910"] or ID["EPSG",26910] */
      return take_code(at, end, "[\"EPSG\",");
  }
  return 0;
}

/* Whether the words are there, in any case, and with any sign for the blanks between them. */
static int has_words(const char *at, const char *end, const char *words) {
  for (size_t n = strlen(words); (size_t)(end - at) >= n; at++) {
    size_t i = 0;
    while (i < n && (words[i] == ' ' || tolower((unsigned char)at[i]) == words[i]))
      i++;
    if (i == n)
      return 1;
  }
  return 0;
}

/* The number behind a parameter's name; NaN: it is not there. */
static double find_parameter(const char *at, const char *end, const char *name) {
  double value;
  for (size_t n = strlen(name); (size_t)(end - at) > n; at++) {
    if (strncasecmp(at, name, n) != 0 || at[n] != '"')
      continue;
    for (at += n + 1; at < end && (*at == ',' || *at == ' ');)
      at++;
    return conic_number_parse(at, (size_t)(end - at), &value) ? value : NAN;
  }
  return NAN;
}

/* A zone of UTM on WGS 84 or NAD83, whose numbers allow no doubt. */
static unsigned find_utm(const char *open, const char *end) {
  const double zone = (find_parameter(open, end, "central_meridian") + 183.0) / 6.0;
  const double north = find_parameter(open, end, "false_northing");
  const int is_wgs =
      has_words(open, end, "wgs 84") || has_words(open, end, "wgs84") || has_words(open, end, "wgs 1984");
  if (!has_words(open, end, "transverse mercator") || !has_words(open, end, "met") || has_words(open, end, "foot") ||
      find_parameter(open, end, "false_easting") != 500000.0 || find_parameter(open, end, "scale_factor") != 0.9996 ||
      find_parameter(open, end, "latitude_of_origin") != 0.0 || !(zone >= 1.0 && zone <= 60.0) || zone != floor(zone))
    return 0;
  if (is_wgs)
    return north == 0.0 ? 32600 + (unsigned)zone : north == 10000000.0 ? 32700 + (unsigned)zone : 0;
  const int is_nad83 =
      has_words(open, end, "north american datum 1983\"") || has_words(open, end, "north american 1983\"");
  return is_nad83 && north == 0.0 && zone <= 23.0 ? 26900 + (unsigned)zone : 0;
}

unsigned conic_georeference_find_epsg(const char *text, size_t n_bytes) {
  static const char *const projected[] = {"PROJCS", "PROJCRS", "PROJECTEDCRS", NULL};
  static const char *const geographic[] = {"GEOGCS", "GEOGCRS", "GEODCRS", "GEOGRAPHICCRS", NULL};
  const char *end = text + n_bytes, *open = find_element(text, end, projected);
  if (!open)
    open = find_element(text, end, geographic);
  unsigned code = open ? find_own_code(open, end) : take_code(text, end, "EPSG:");
  return open && !code ? find_utm(open, end) : code;
}

/* Metres of a projected system's unit: of the first UNIT that has no angle; 0: there is none. */
static double find_unit(const char *text, size_t n_bytes) {
  static const char *const units[] = {"UNIT", "LENGTHUNIT", NULL}, *const projected[] = {"PROJCS", NULL};
  static const char *const newer[] = {"PROJCRS", "PROJECTEDCRS", NULL}, *const axes[] = {"CS", NULL};
  const char *end = text + n_bytes, *at = find_element(text, end, newer);
  at = at ? find_element(at, end, axes) : find_element(text, end, projected);
  while (at && (at = find_element(at, end, units))) {
    const char *name = ++at, *name_end = memchr(name, ',', (size_t)(end - name));
    double value;
    if (!name_end || !conic_number_parse(name_end + 1, (size_t)(end - name_end - 1), &value))
      return 0.0;
    if (!has_words(name, name_end, "degree") && !has_words(name, name_end, "rad") && !has_words(name, name_end, "gon"))
      return value > 0.0 && value < 1e6 ? value : 0.0;
  }
  return 0.0;
}

/* --- the records of a LAS --- */

typedef struct las_record {
  const unsigned char *bytes; /* null: missing */
  size_t n_bytes;
} las_record;

typedef struct las_records {
  las_record keys, numbers, text, wkt;
} las_records;

static void note_record(const unsigned char *head, const unsigned char *bytes, size_t n_bytes, las_records *found) {
  las_record *to = NULL;
  if (!conic_las_is_of_world(head))
    return;
  switch (conic_load_16(head + 18)) {
  case RECORD_KEYS:
    to = &found->keys;
    break;
  case RECORD_NUMBERS:
    to = &found->numbers;
    break;
  case RECORD_TEXT:
    to = &found->text;
    break;
  case RECORD_WKT:
    to = &found->wkt;
    break;
  default:
    return;
  }
  if (!to->bytes)
    *to = (las_record){bytes, n_bytes};
}

static las_records list_world_records(const unsigned char *head, size_t n_bytes) {
  las_records found = {.keys = {0}};
  size_t at = conic_load_16(head + CONIC_LAS_HEADER_BYTES);
  for (uint32_t i = conic_load_32(head + CONIC_LAS_N_RECORDS); i > 0; i--) {
    size_t n = at < n_bytes && n_bytes - at >= CONIC_LAS_RECORD_HEAD ? conic_load_16(head + at + 20) : SIZE_MAX;
    if (n > n_bytes || at + CONIC_LAS_RECORD_HEAD + n > n_bytes)
      break;
    note_record(head + at, head + at + CONIC_LAS_RECORD_HEAD, n, &found);
    at += CONIC_LAS_RECORD_HEAD + n;
  }
  return found;
}

/* Whether all of a directory's keys are there, and point to existing values. */
static int keys_are_sound(const las_records *found) {
  size_t n = found->keys.n_bytes / sizeof(uint16_t);
  const unsigned char *bytes = found->keys.bytes;
  if (!bytes || n < KEY_NUMBERS || conic_load_16(bytes) != 1 || conic_load_16(bytes + 6) == 0 ||
      conic_load_16(bytes + 6) > n / KEY_NUMBERS - 1)
    return 0;
  for (size_t i = 1; i <= conic_load_16(bytes + 6); i++) {
    const unsigned char *key = bytes + 8 * i;
    size_t place = conic_load_16(key + 2), end = (size_t)conic_load_16(key + 4) + conic_load_16(key + 6);
    if ((place == RECORD_NUMBERS && end > found->numbers.n_bytes / sizeof(double)) ||
        (place == RECORD_TEXT && end > found->text.n_bytes) || (place == RECORD_KEYS && end > n))
      return 0;
  }
  return 1;
}

/* Takes the file's keys in their order, and adds the one that makes pixels areas. */
static conic_status take_keys(conic_context *context, const las_records *found, conic_georeference *reference) {
  size_t n = conic_load_16(found->keys.bytes + 6), n_numbers = found->numbers.n_bytes / sizeof(double), n_put = 0;
  size_t n_text = found->text.n_bytes;
  while (n_text > 0 && found->text.bytes[n_text - 1] == 0) /* one zero is put at the end */
    n_text--;
  conic_status status = make_key_room(context, n_numbers, KEY_NUMBERS * (n + 2), n_text + 1, reference);
  int has_raster = 0;
  if (status != CONIC_OK)
    return status;
  for (size_t i = 0; i < n_numbers; i++)
    reference->numbers[i] = conic_load_double(found->numbers.bytes + sizeof(double) * i);
  if (n_text)
    memcpy(reference->text, found->text.bytes, n_text);
  for (size_t i = 0; i <= n; i++) {
    uint16_t *to = reference->keys + KEY_NUMBERS * n_put++, key[KEY_NUMBERS];
    for (size_t k = 0; k < KEY_NUMBERS; k++)
      key[k] = conic_load_16(found->keys.bytes + 2 * (KEY_NUMBERS * i + k));
    if (i > 0 && key[0] >= KEY_RASTER && !has_raster) {
      has_raster = 1;
      put_key(to, KEY_RASTER, 1);
      to = key[0] == KEY_RASTER ? to : reference->keys + KEY_NUMBERS * n_put++;
    }
    if (i == 0 || key[0] != KEY_RASTER)
      memcpy(to, key, sizeof key);
    int is_code = i > 0 && key[1] == 0 && key[3] != 0 && key[3] != USER_DEFINED;
    if (is_code && (key[0] == KEY_PROJECTED || (key[0] == KEY_GEOGRAPHIC && !reference->epsg)))
      reference->epsg = key[3];
    if (i > 0 && key[0] == KEY_PROJECTED && !is_code)
      reference->epsg = 0;
    if (i > 0 && key[0] == KEY_UNIT && key[1] == 0) /* EPSG's metre, foot and US survey foot */
      reference->unit_m = key[3] == 9001 ? 1.0 : key[3] == 9002 ? 0.3048 : key[3] == 9003 ? 1200.0 / 3937.0 : 0.0;
  }
  if (!has_raster)
    put_key(reference->keys + KEY_NUMBERS * n_put++, KEY_RASTER, 1);
  reference->keys[3] = (uint16_t)(n_put - 1);
  reference->n_keys = KEY_NUMBERS * n_put;
  return CONIC_OK;
}

static conic_status take_las(conic_context *context, const las_records *found, conic_georeference *reference) {
  unsigned epsg =
      found->wkt.bytes ? conic_georeference_find_epsg((const char *)found->wkt.bytes, found->wkt.n_bytes) : 0;
  memset(reference, 0, sizeof *reference);
  if (keys_are_sound(found))
    return take_keys(context, found, reference);
  reference->is_unknown = found->wkt.bytes && found->wkt.n_bytes > 1 && !epsg;
  conic_status status = epsg ? conic_georeference_of_epsg(context, epsg, reference) : CONIC_OK;
  if (found->wkt.bytes)
    reference->unit_m = find_unit((const char *)found->wkt.bytes, found->wkt.n_bytes);
  return status;
}

conic_status conic_georeference_of_las(conic_context *context, const unsigned char *head, size_t n_bytes,
                                       conic_georeference *reference) {
  memset(reference, 0, sizeof *reference);
  if (n_bytes < CONIC_LAS_LEAST_HEADER || memcmp(head, "LASF", 4) != 0)
    return CONIC_OK;
  const las_records found = list_world_records(head, n_bytes);
  return take_las(context, &found, reference);
}

/* Reads the well-known text after the points; text that cannot be read counts as none. */
static conic_status read_late_text(conic_context *context, FILE *file, const unsigned char *head,
                                   conic_georeference *reference) {
  uint64_t at = conic_load_64(head + CONIC_LAS_LATE_RECORDS);
  unsigned char record[LATE_HEAD];
  for (uint32_t i = conic_load_32(head + CONIC_LAS_N_LATE_RECORDS); i > 0 && at < INT64_MAX / 2; i--) {
    las_records found = {.keys = {0}};
    if (fseeko(file, (off_t)at, SEEK_SET) != 0 || fread(record, sizeof record, 1, file) != 1)
      return CONIC_OK;
    uint64_t n_bytes = conic_load_64(record + 20);
    note_record(record, record, 0, &found);
    if (!found.wkt.bytes || n_bytes > MOST_TEXT) {
      at += LATE_HEAD + (n_bytes < INT64_MAX / 2 ? n_bytes : INT64_MAX / 2);
      continue;
    }
    char *text = conic_memory_allocate(context, (size_t)n_bytes, 1);
    if (!text)
      return CONIC_ERROR_MEMORY;
    size_t n = fread(text, 1, (size_t)n_bytes, file);
    unsigned epsg = conic_georeference_find_epsg(text, n);
    double unit_m = find_unit(text, n);
    conic_memory_release(context, text);
    reference->is_unknown = n > 1 && !epsg;
    conic_status status = epsg ? conic_georeference_of_epsg(context, epsg, reference) : CONIC_OK;
    reference->unit_m = unit_m;
    return status;
  }
  return CONIC_OK;
}

/* As conic writes it (core/formats/ply_write.c), within the first lines. */
static conic_status read_ply(conic_context *context, const char *start, size_t n, conic_georeference *reference) {
  static const char mark[] = "\ncomment crs ";
  for (const char *at = start; (at = memchr(at, '\n', (size_t)(start + n - at))); at++) {
    size_t left = (size_t)(start + n - at);
    if (left > sizeof mark && memcmp(at, mark, sizeof mark - 1) == 0) {
      const char *line = at + sizeof mark - 1, *line_end = memchr(line, '\n', (size_t)(start + n - line));
      unsigned epsg = conic_georeference_find_epsg(line, (size_t)((line_end ? line_end : start + n) - line));
      return epsg ? conic_georeference_of_epsg(context, epsg, reference) : CONIC_OK;
    }
    if (left > 11 && memcmp(at, "\nend_header", 11) == 0)
      break;
  }
  return CONIC_OK;
}

static conic_status read_las(conic_context *context, FILE *file, conic_georeference *reference) {
  unsigned char start[CONIC_LAS_HEADER_1_4] = {0};
  size_t n = fread(start, 1, sizeof start, file), n_head = conic_load_32(start + CONIC_LAS_POINTS);
  if (n > 4 && memcmp(start, "ply", 3) == 0)
    return read_ply(context, (const char *)start, n, reference);
  if (n < CONIC_LAS_LEAST_HEADER || memcmp(start, "LASF", 4) != 0)
    return CONIC_OK;
  n_head = n_head < MOST_HEAD ? n_head : MOST_HEAD;
  unsigned char *head = fseeko(file, 0, SEEK_SET) == 0 ? conic_memory_allocate(context, n_head, 1) : NULL;
  if (!head)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_georeference_of_las(context, head, fread(head, 1, n_head, file), reference);
  conic_memory_release(context, head);
  if (status == CONIC_OK && !reference->keys && n == CONIC_LAS_HEADER_1_4 && start[CONIC_LAS_MINOR] >= 4)
    status = read_late_text(context, file, start, reference);
  return status;
}

conic_status conic_georeference_read(conic_context *context, const char *path, conic_georeference *reference) {
  memset(reference, 0, sizeof *reference);
  FILE *file = conic_file_is_there(path) ? conic_disk_open_stream(path, "rb") : NULL;
  conic_status status = file ? read_las(context, file, reference) : CONIC_OK;
  if (file)
    fclose(file);
  return status;
}
