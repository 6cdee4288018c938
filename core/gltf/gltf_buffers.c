/* Buffers and views: the bytes of a glTF, wherever they are. */
#include "core/base/context_struct.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/gltf/gltf.h"

enum { LONGEST_NAME = 2048, LONGEST_PATH = 4096 };

/* --- files beside --- */

/* Whether a name leads out of the folder that it is beside. */
static int is_outside(const char *name) {
  if (conic_disk_is_absolute(name) || name[0] == '/' || strstr(name, ":/"))
    return 1;
  for (const char *c = name; c; c = strchr(c, '/')) {
    c += *c == '/';
    if (strncmp(c, "..", 2) == 0 && (c[2] == '/' || c[2] == 0))
      return 1;
  }
  return 0;
}

static int is_file_beside(const conic_gltf *gltf, const char *name, char *path, size_t room) {
  int n_folder = conic_disk_is_absolute(name) ? 0 : (int)(conic_file_name(gltf->path) - gltf->path);
  int n = snprintf(path, room, "%.*s%s", n_folder, gltf->path, name);
  return name[0] && n > 0 && (size_t)n < room && conic_file_is_there(path);
}

conic_status conic_gltf_find_file(const conic_gltf *gltf, conic_gltf_text uri, int finds_beside, char *path,
                                  size_t room) {
  char raw[LONGEST_NAME], plain[LONGEST_NAME];
  path[0] = 0;
  if (uri.length >= sizeof raw || !gltf->path)
    return conic_gltf_wrong(gltf, "the name %.*s is too long, or of no file that can be looked for",
                            (int)(uri.length < 80 ? uri.length : 80), uri.bytes ? uri.bytes : "");
  snprintf(raw, sizeof raw, "%.*s", (int)uri.length, uri.bytes);
  memcpy(plain, raw, sizeof plain);
  conic_input_make_plain(plain);
  const char *slash = strrchr(plain, '/'), *names[] = {raw, plain, finds_beside && slash ? slash + 1 : NULL};
  int is_left_out = 0;
  for (int i = 0; i < 3 && names[i]; i++)
    if (!gltf->context->options.allows_outside && is_outside(names[i]))
      is_left_out = 1;
    else if (is_file_beside(gltf, names[i], path, room))
      return CONIC_OK;
  path[0] = 0;
  return is_left_out
             ? conic_gltf_wrong(gltf, "%s is not in the file's folder or below it (--allow-outside reads it)", plain)
             : CONIC_OK;
}

/* --- base64 --- */

static int decode_letter(char c) {
  return c >= 'A' && c <= 'Z'   ? c - 'A'
         : c >= 'a' && c <= 'z' ? c - 'a' + 26
         : c >= '0' && c <= '9' ? c - '0' + 52
         : c == '+'             ? 62
         : c == '/'             ? 63
                                : CONIC_GLTF_NONE;
}

static conic_status decode_base64(const conic_gltf *gltf, const char *text, size_t length, unsigned char **bytes,
                                  size_t *n_bytes) {
  uint32_t bits = 0;
  int n_bits = 0;
  *bytes = conic_memory_allocate(gltf->context, length, 1);
  if (!*bytes)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < length && text[i] != '='; i++) {
    i += text[i] == '\\' && i + 1 < length; /* JSON may have \/ for / */
    int value = decode_letter(text[i]);
    if (value == CONIC_GLTF_NONE)
      return conic_gltf_wrong(gltf, "data in the JSON are no base64");
    bits = (bits << 6 | (uint32_t)value) & 0xffffff;
    n_bits += 6;
    if (n_bits >= 8)
      (*bytes)[(*n_bytes)++] = (unsigned char)(bits >> (n_bits -= 8));
  }
  return CONIC_OK;
}

conic_status conic_gltf_decode_uri(const conic_gltf *gltf, conic_gltf_text uri, unsigned char **bytes,
                                   size_t *n_bytes) {
  static const char base64[] = ";base64,";
  const size_t n = sizeof base64 - 1;
  *bytes = NULL;
  *n_bytes = 0;
  if (uri.length < 5 || memcmp(uri.bytes, "data:", 5) != 0)
    return CONIC_OK;
  for (size_t i = 5; i + n <= uri.length && i < 256; i++)
    if (memcmp(uri.bytes + i, base64, n) == 0)
      return decode_base64(gltf, uri.bytes + i + n, uri.length - i - n, bytes, n_bytes);
  return conic_gltf_wrong(gltf, "data in the JSON are no base64");
}

/* --- buffers --- */

static conic_status open_buffer_file(conic_gltf *gltf, conic_gltf_buffer *buffer) {
  char path[LONGEST_PATH];
  conic_status status = conic_gltf_find_file(gltf, buffer->uri, 0, path, sizeof path);
  if (status == CONIC_OK && !path[0])
    return conic_gltf_wrong(gltf, "cannot read: its buffer %.*s is not there",
                            buffer->uri.length < 200 ? (int)buffer->uri.length : 200, buffer->uri.bytes);
  if (status == CONIC_OK)
    status = conic_mapping_open(gltf->context, path, &buffer->mapping);
  buffer->bytes = buffer->mapping.bytes;
  buffer->n_bytes = buffer->mapping.n_bytes;
  return status;
}

/* A buffer without a name is the second part of a .glb. */
static conic_status open_buffer(conic_gltf *gltf, conic_gltf_buffer *buffer) {
  if (!buffer->uri.bytes) {
    buffer->bytes = gltf->binary;
    buffer->n_bytes = gltf->n_binary;
    return gltf->binary ? CONIC_OK : conic_gltf_wrong(gltf, "a buffer has no data");
  }
  conic_status status = conic_gltf_decode_uri(gltf, buffer->uri, &buffer->own, &buffer->n_bytes);
  buffer->bytes = buffer->own;
  return status == CONIC_OK && !buffer->bytes ? open_buffer_file(gltf, buffer) : status;
}

conic_status conic_gltf_open_part(conic_gltf *gltf, double number, double offset, double length,
                                  conic_gltf_bytes *part) {
  conic_gltf_buffer *buffer = conic_gltf_at(gltf, CONIC_GLTF_BUFFERS, number);
  if (!buffer)
    return conic_gltf_wrong(gltf, "a view's buffer is not there");
  conic_status status = buffer->bytes ? CONIC_OK : open_buffer(gltf, buffer);
  if (status != CONIC_OK)
    return status;
  if (!conic_gltf_is_index(offset, buffer->n_bytes + 1) ||
      !conic_gltf_is_index(length, buffer->n_bytes - (size_t)offset + 1))
    return conic_gltf_wrong(gltf, "a view reaches past the end of its buffer, which has %zu bytes", buffer->n_bytes);
  part->bytes = buffer->bytes + (size_t)offset;
  part->n_bytes = (size_t)length;
  return CONIC_OK;
}

conic_status conic_gltf_open_view(conic_gltf *gltf, double number, conic_gltf_bytes *view) {
  conic_gltf_view *known = conic_gltf_at(gltf, CONIC_GLTF_VIEWS, number);
  *view = (conic_gltf_bytes){NULL, 0, 0};
  if (!known)
    return conic_gltf_wrong(gltf, "a buffer's view is not there");
  if (!conic_gltf_is_index(known->stride, 256))
    return conic_gltf_wrong(gltf, "a stride of %g bytes, where 4 to 252 may be", known->stride);
  view->stride = (size_t)known->stride;
  if (!known->is_packed)
    return conic_gltf_open_part(gltf, known->buffer, known->offset, known->length, view);
  if (!conic_gltf_is_index(known->length, CONIC_MOST_BYTES))
    return conic_gltf_wrong(gltf, "a view of %g bytes", known->length);
  view->n_bytes = (size_t)known->length;
  conic_status status = known->own ? CONIC_OK : conic_gltf_unpack(gltf, known, view->n_bytes);
  view->bytes = known->own;
  return status;
}
