/* Assimp 5 takes the first model of a 3MF alone, and gives up on archives that tell sizes only in their list, as lib3mf
 * writes them. So the archive is written anew: the resources of other models go before those of the first one, with
 * their numbers moved on. */
#include "core/assimp/assimp_3mf.h"

#include "core/files/disk.h"
#include "core/files/zip.h"

/* Numbers of resources are below this; those of the list's i-th file move on by i times it. */
enum { NUMBERS = 1 << 20, MOST_FILES = 2000 };

static const size_t most_bytes = 0x7FFFFFFF;

typedef struct package {
  conic_context *context;
  const char *name;
  conic_zip zip;
  conic_zip_writer to;
  char root[CONIC_ZIP_NAME]; /* the first model */
  char *text;                /* the model that is written */
  size_t n_text, room;
  conic_status status; /* after an error nothing is put any more */
} package;

static void put(package *p, const char *from, const char *end) {
  size_t n = (size_t)(end - from);
  if (p->status == CONIC_OK)
    p->status = conic_memory_reserve(p->context, &p->text, p->n_text, p->n_text + n, &p->room, 1);
  if (p->status != CONIC_OK || !from)
    return;
  memcpy(p->text + p->n_text, from, n);
  p->n_text += n;
}

/* Takes a file of the archive, ended by zero, which the caller releases; 0: it is not there. */
static int take_file(package *p, const char *name, unsigned char **bytes, size_t *n) {
  *bytes = NULL;
  if (p->status == CONIC_OK)
    p->status = conic_zip_read(&p->zip, name, most_bytes, bytes, n);
  if (*bytes)
    (*bytes)[*n] = 0;
  return *bytes != NULL;
}

static int is_model(const char *name) {
  size_t n = strlen(name);
  return n > 6 && strcmp(name + n - 6, ".model") == 0;
}

/* The number of another model in the archive's list, from 1; 0: the first model. */
static unsigned number_of_model(const package *p, const char *path, size_t n) {
  char name[CONIC_ZIP_NAME];
  size_t at = 0;
  for (unsigned i = 1; i < MOST_FILES && conic_zip_next(&p->zip, &at, name); i++)
    if (n == strlen(name) + 1 && memcmp(name, path + 1, n - 1) == 0 && strcmp(name, p->root) != 0)
      return i;
  return 0;
}

/* The value of a tag's attribute by the end of its name, after a blank or colon; null: it has none. */
static const char *find_value(const char *tag, const char *end, const char *name) {
  size_t n = strlen(name);
  for (const char *at = tag; (size_t)(end - at) > n + 2; at++)
    if (memcmp(at, name, n) == 0 && at[n] == '=')
      return at + n + 2;
  return NULL;
}

/* Puts a tag with its numbers moved on: an object's that is elsewhere by its own path. */
static void put_tag(package *p, const char *tag, const char *end, unsigned i_file) {
  static const char *const names[] = {" id", " pid", " texid", " objectid"};
  const char *path = find_value(tag, end, ":path"), *value;
  unsigned i_path = path ? number_of_model(p, path, strcspn(path, "\"'")) : i_file;
  for (int i = 0; i < 4; i++)
    if ((value = find_value(tag, end, names[i]))) { /* a tag has one of them, or an id and a pid in this order */
      char number[32];
      unsigned long own = strtoul(value, NULL, 10);
      int n = snprintf(number, sizeof number, "%lu", own + (unsigned long)NUMBERS * (i == 3 ? i_path : i_file));
      if (own >= NUMBERS && p->status == CONIC_OK)
        p->status = conic_fail(p->context, CONIC_ERROR_UNSUPPORTED, "%s: the number %lu is too large", p->name, own);
      put(p, tag, value);
      put(p, number, number + n);
      tag = value + strcspn(value, "\"'");
    }
  put(p, tag, end);
}

/* Most of the text are vertices, whose tags have no numbers. */
static void put_moved(package *p, const char *at, const char *end, unsigned i_file) {
  while (at < end) {
    const char *open = memchr(at, '<', (size_t)(end - at)),
               *close = open ? memchr(open, '>', (size_t)(end - open)) : NULL;
    put(p, at, close ? open : end);
    if (close && strncmp(open, "<vertex", 7) == 0)
      put(p, open, close);
    else if (close)
      put_tag(p, open, close, i_file);
    at = close ? close : end;
  }
}

/* Where the resources of a model's text begin and end. */
static const char *find_resources(package *p, const char *text, const char **end) {
  const char *begin = text ? strstr(text, "<resources>") : NULL;
  *end = begin ? strstr(begin, "</resources>") : NULL;
  if (!*end && p->status == CONIC_OK)
    p->status = conic_fail(p->context, CONIC_ERROR_INPUT, "%s: a model of the 3MF has no resources", p->name);
  return *end ? begin + strlen("<resources>") : NULL;
}

/* Puts the resources of all other models into those of the first, which the relations name. */
static void put_models(package *p) {
  char name[CONIC_ZIP_NAME];
  const char *begin, *end;
  size_t n, n_root = 0, at = 0;
  unsigned char *relations, *root, *other;
  int has_relations = take_file(p, "_rels/.rels", &relations, &n);
  while (has_relations && conic_zip_next(&p->zip, &at, name))
    if (is_model(name) && strstr((const char *)relations, name))
      memcpy(p->root, name, sizeof p->root);
  conic_memory_release(p->context, relations);
  take_file(p, p->root, &root, &n_root);
  const char *text = (const char *)root, *start = find_resources(p, text, &end);
  if (start)
    put(p, text, start);
  at = 0;
  for (unsigned i = 1; i < MOST_FILES && start && conic_zip_next(&p->zip, &at, name); i++) {
    if (!is_model(name) || strcmp(name, p->root) == 0)
      continue;
    take_file(p, name, &other, &n);
    begin = find_resources(p, (const char *)other, &end);
    if (begin)
      put_moved(p, begin, end, i);
    conic_memory_release(p->context, other);
  }
  if (start)
    put_moved(p, start, text + n_root, 0);
  conic_memory_release(p->context, root);
}

/* Stores the model, and the other files that it may refer to. */
static void write_archive(package *p) {
  char name[CONIC_ZIP_NAME];
  size_t n, at = 0;
  int is_done = p->status == CONIC_OK && conic_zip_add(&p->to, p->root, (const unsigned char *)p->text, p->n_text);
  while (is_done && p->status == CONIC_OK && conic_zip_next(&p->zip, &at, name)) {
    if (is_model(name) || strstr(name, "Metadata/") || strstr(name, "Thumbnails/") || name[strlen(name) - 1] == '/')
      continue;
    unsigned char *bytes;
    is_done = take_file(p, name, &bytes, &n) && conic_zip_add(&p->to, name, bytes, n);
    conic_memory_release(p->context, bytes);
  }
  if (p->status == CONIC_OK && !(is_done && conic_zip_end(&p->to)))
    p->status = conic_fail(p->context, CONIC_ERROR_IO, "%s: cannot unpack it into a temporary file", p->name);
}

conic_status conic_3mf_unpack(conic_context *context, const char *name, unsigned char **bytes, size_t *n_bytes) {
  package p = {.context = context, .name = name, .to = {.to = conic_disk_open_nameless()}};
  if (!p.to.to)
    return conic_fail(context, CONIC_ERROR_IO, "%s: cannot make a temporary file", name);
  p.status = conic_zip_open(context, name, *bytes, *n_bytes, &p.zip);
  put_models(&p);
  write_archive(&p);
  if (p.status == CONIC_OK) {
    conic_memory_release(context, *bytes);
    *n_bytes = p.to.offset;
    *bytes = conic_memory_allocate(context, *n_bytes, 1);
    p.status = *bytes ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  rewind(p.to.to);
  if (p.status == CONIC_OK && fread(*bytes, 1, *n_bytes, p.to.to) != *n_bytes)
    p.status = conic_fail(context, CONIC_ERROR_IO, "%s: cannot read a temporary file", name);
  conic_memory_release(context, p.text);
  fclose(p.to.to);
  return p.status;
}
