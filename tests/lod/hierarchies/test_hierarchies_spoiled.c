/* COPC, EPT and Potree 2 that are spoiled: refused with one line, or read; never anything else. */
#include "tests/support/files.h"
#include "tests/support/hierarchy_parts.h"

typedef struct example {
  const char *name;
  size_t (*make)(unsigned char *to);
  size_t n_points, n_bytes;
  unsigned char bytes[4096];
} example;

static conic_status read_example(conic_context *context, const example *e, const unsigned char *bytes, size_t n_bytes) {
  if (strcmp(e->name, "copc") != 0)
    return hierarchy_read_parts(context, strcmp(e->name, "ept") == 0, bytes, n_bytes);
  const char *path = files_write_bytes("x.copc.laz", bytes, n_bytes);
  conic_status status = conic_layers_is_hierarchy(path) ? hierarchy_read(context, path) : CONIC_ERROR_INPUT;
  CHECK(unlink(path) == 0);
  return status;
}

static int check_example(conic_context *context, const example *e, const unsigned char *bytes, size_t n_bytes) {
  files_message[0] = 0;
  conic_status status = read_example(context, e, bytes, n_bytes);
  if (status != CONIC_OK && status != CONIC_ERROR_INPUT && status != CONIC_ERROR_MEMORY) {
    fprintf(stderr, "%s: status %d: %s\n", e->name, (int)status, files_message);
    check_failures++;
  }
  return status == CONIC_OK;
}

static void count_example(conic_context *context, const example *e) {
  hierarchy_parts parts = {.folder = ""};
  conic_layers *layers;
  conic_splats splats;
  const char *path;
  if (strcmp(e->name, "copc") == 0)
    path = files_write_bytes("x.copc.laz", e->bytes, e->n_bytes);
  else {
    parts = hierarchy_unpack(strcmp(e->name, "ept") == 0, e->bytes, e->n_bytes);
    path = parts.first;
  }
  CHECK_OK(conic_layers_open(context, path, NULL, &layers));
  CHECK(layers && strcmp(conic_layers_kind_name(layers), e->name) == 0);
  CHECK_OK(conic_layers_splats(layers, 1.5f, &splats));
  CHECK(splats.count == e->n_points);
  for (size_t i = 0; i < splats.count; i++)
    for (int axis = 0; axis < 3; axis++)
      CHECK(splats.origin[axis] + (double)splats.position[axis][i] >= 3.99 &&
            splats.origin[axis] + (double)splats.position[axis][i] <= 5.01);
  conic_splats_release(context, &splats);
  conic_layers_close(layers);
  if (parts.folder[0])
    hierarchy_remove(&parts);
}

/* Of a hierarchy in parts, the first eight bytes are the test's own. */
static void spoil_example(conic_context *context, const example *e) {
  static const unsigned char values[] = {0, 0xff, 0x80, '9'};
  unsigned char bytes[4096];
  size_t first = strcmp(e->name, "copc") == 0 ? 0 : 8;
  for (size_t i = first; i < e->n_bytes; i += 1 + e->n_bytes / 300)
    for (size_t k = 0; k < sizeof values; k++) {
      memcpy(bytes, e->bytes, e->n_bytes);
      bytes[i] = values[k];
      check_example(context, e, bytes, e->n_bytes);
    }
  for (size_t n = 0; n < e->n_bytes; n += 1 + e->n_bytes / 100)
    CHECK(!check_example(context, e, e->bytes, n) || n + 2 > e->n_bytes || first == 0);
}

int main(void) {
  static example examples[] = {{.name = "copc", .make = hierarchy_copc_example, .n_points = 1},
                               {.name = "ept", .make = hierarchy_ept_example, .n_points = 6},
                               {.name = "potree", .make = hierarchy_potree_example, .n_points = 3}};
  conic_context *context = files_context();
  for (size_t i = 0; i < sizeof examples / sizeof *examples; i++) {
    examples[i].n_bytes = examples[i].make(examples[i].bytes);
    count_example(context, &examples[i]);
    spoil_example(context, &examples[i]);
  }
  files_end(context);
  return check_result();
}
