/* What the PLY reader says of files that are wrong, cut or changed by chance, and where memory runs out. */
#include "tests/support/ply_file.h"

static void check_fails(const char *text, const char *what, const char *where) {
  conic_model model;
  files_check_failed(text, ply_read_text(text, &model), "a.ply: ", what, where, (const char *)NULL);
}

static void test_wrong_headers(void) {
  check_fails("ply", "does not begin", "byte 0");
  check_fails("PLY\nformat", "does not begin", "byte 0");
  check_fails("ply\n", "ends within the header", "line 2");
  check_fails("ply\nformat ascii 1.0\nelement vertex 1\n", "ends within the header", "line 4");
  check_fails("ply\nformat ascii 1.1\n", "unknown PLY version '1.1'", "line 2");
  check_fails("ply\nformat binary 1.0\n", "unknown PLY encoding 'binary'", "line 2");
  check_fails("ply\nformat ascii\n", "a format line is", "line 2");
  check_fails("ply\nelement vertex 0\n" XYZ "end_header\n", "no format line", "line 6");
  check_fails(ASCII "format ascii 1.0\n", "cannot begin with 'format'", "line 3");
  check_fails(ASCII "elements vertex 1\n", "cannot begin with 'elements'", "line 3");
  check_fails(ASCII "element vertex -1\n", "an element line is", "line 3");
  check_fails(ASCII "element vertex 99999999999999999999999\n", "an element line is", "line 3");
  check_fails(ASCII "element vertex 1 2\n", "an element line is", "line 3");
  check_fails(ASCII "element a 1\nelement a 1\n", "a second element 'a'", "line 4");
  check_fails(ASCII "property float x\n", "before any element", "line 3");
  check_fails(ASCII "element vertex 1\nproperty float64x x\n", "unknown type 'float64x'", "line 4");
  check_fails(ASCII "element vertex 1\nproperty list uchar int128 x\n", "unknown type 'int128'", "line 4");
  check_fails(ASCII "element vertex 1\nproperty list float int x\n", "length of a list", "line 4");
  check_fails(ASCII "element vertex 1\nproperty float\n", "a property line is", "line 4");
  check_fails(ASCII "element vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n", "lack x, y or z",
              "line 3");
  check_fails(ASCII "element vertex 4\nend_header\n", "lack x, y or z", "line 3");
  check_fails(ASCII "element vertex 1\nproperty uint packed_position\nend_header\n0\n", "SuperSplat", "line 3");
  check_fails(ASCII "element vertex 4\nelement face 4\nend_header\n", "lack x, y or z", "line 3");
  check_fails(ASCII "element point 1\n" XYZ "end_header\n0 0 0\n", "no element 'vertex'", "line 7");
  check_fails(ASCII "element vertex 4294967295\n" XYZ "end_header\n0 0 0\n", "too many", "line 3");
  check_fails(ASCII "element vertex 4000000000\n" XYZ "end_header\n", "ends within vertex 0 of 4000000000", "line 8");
  check_fails(ASCII "element vertex 1\n" XYZ "element face 1\nproperty list uchar float vertex_indices\n"
                    "end_header\n0 0 0\n3 0 0 0\n",
              "no list of integers", "line 7");
}

static void test_wrong_text(void) {
  static const char vertices[] = ASCII "element vertex 2\n" XYZ "end_header\n";
  static const char faces[] = ASCII "element vertex 3\n" XYZ "element face 2\nproperty list char int vertex_index\n"
                                    "end_header\n0 0 0\n1 0 0\n0 1 0\n";
  static const struct {
    const char *header, *body, *what, *where;
  } wrong[] = {
      {vertices, "1 2 3\n4 5 x\n", "vertex 1: a value is not a number", "line 9"},
      {vertices, "1 2 3\n4 5 6a\n", "a value is not a number", "line 9"},
      {vertices, "1 2 3\n4 5      \n", "fewer values", "line 9"},
      {vertices, "1 2 3 4\n5 6\n", "more values", "line 8"},
      {faces, "3 0 1 2\n3 0 1 3\n", "vertex index 3, but there are only 3", "line 14"},
      {faces, "3 0 1 2\n3 0 1 -1\n", "index is negative", "line 14"},
      {faces, "3 0 1 2\n-3 0 1 2\n", "negative length", "line 14"},
      {faces, "3 0 1 2\n3 0 1 2.5\n", "not an integer", "line 14"},
      {vertices, "", "ends within vertex 0 of 2", "line 8"},
      {faces, "3 0 1 2\n128 0 1 2\n", "not an integer", "line 14"},
      {faces, "3 0 1 2\n3 0 1 nan\n", "not an integer", "line 14"},
  };
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    char text[1000];
    snprintf(text, sizeof text, "%s%s", wrong[i].header, wrong[i].body);
    check_fails(text, wrong[i].what, wrong[i].where);
  }
}

static void check_binary_fails(const char *what) {
  conic_model model;
  files_check_failed(what, ply_read(&model), "a.ply: ", what, "at byte", (const char *)NULL);
}

/* So many points are read, with a warning. */
static void check_cut(size_t n_points, const char *what) {
  conic_model model;
  files_warnings = 0;
  CHECK_OK(ply_read(&model));
  CHECK(model.points.count == n_points && files_warnings == 1 && strstr(files_warning, what));
  conic_model_release(context, &model);
}

static void test_cut_text(void) {
  static const char vertices[] = ASCII "element vertex 3\n" XYZ "end_header\n1 2 3\n4 5 6\n";
  static const char *const ends[] = {"", "7 8", "7 8   ", "\n\n"};
  for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
    char text[1000];
    conic_model model;
    snprintf(text, sizeof text, "%s%s", vertices, ends[i]);
    files_warnings = 0;
    CHECK_OK(ply_read_text(text, &model));
    CHECK(model.points.count == 2 && files_warnings == 1 && strstr(files_warning, "ends within vertex 2 of 3"));
    conic_model_release(context, &model);
  }
}

static void test_wrong_binary(void) {
  static const char faces[] = "element vertex 3\n" XYZ "element face 1\nproperty list int uint vertex_indices\n";
  static const double lists[][5] = {
      {3, 0, 1, 2, 0}, {3, 0, 1, 3, 0}, {-1, 0, 1, 2, 0}, {2147483647, 0, 1, 2, 0}, {6, 0, 1, 2, 0}};
  static const char *const messages[] = {NULL, "vertex index 3", "negative length", "runs past the end", NULL};
  for (int kind = LITTLE; kind < N_ENCODINGS; kind++) {
    for (int i = 0; i < 5; i++) {
      conic_model model;
      ply_begin((encoding)kind, faces);
      for (int k = 0; k < 9; k++)
        ply_add('f', k);
      for (int k = 0; k < 4; k++)
        ply_add('i', lists[i][k]);
      if (messages[i])
        check_binary_fails(messages[i]);
      else {
        const int is_cut = lists[i][0] > 3.0; /* its last face ends after the file */
        for (int cut = is_cut; cut < 2; cut++, ply.n--) {
          files_warnings = 0;
          CHECK_OK(ply_read(&model));
          CHECK(model.points.count == 3 && model.n_triangles == (size_t)!cut && files_warnings == cut);
          conic_model_release(context, &model);
        }
      }
    }
    ply_begin((encoding)kind, "element vertex 3\n" XYZ);
    for (int k = 0; k < 8; k++)
      ply_add('f', k);
    check_cut(2, "ends within vertex 2 of 3");
    ply_begin((encoding)kind, "element vertex 4294967294\n" XYZ);
    check_binary_fails("ends within vertex 0 of 4294967294");
    ply_begin((encoding)kind, "element other 9000000000000000000\nproperty double a\nelement vertex 0\n" XYZ);
    check_binary_fails("ends within other 0 of 9000000000000000000");
  }
}

/* Every proper beginning of a good file fails cleanly or is read with a warning. */
static void test_truncations(void) {
  for (int kind = TEXT; kind < N_ENCODINGS; kind++) {
    ply_put_mixture((encoding)kind, 1);
    size_t whole = ply.n - (kind == TEXT ? 3 : 0); /* an ascii number may lose digits, blanks and the line end */
    for (size_t n = 4; n < whole; n++) {
      conic_model model;
      ply_put_mixture((encoding)kind, 1);
      ply.n = n;
      files_warnings = 0;
      conic_status status = ply_read(&model);
      if (status != CONIC_OK)
        files_check_failed("truncated", status, "a.ply: ", (const char *)NULL);
      CHECK(files_warnings == (status == CONIC_OK));
      if (status == CONIC_OK)
        conic_model_release(context, &model);
    }
  }
}

/* Any byte may be any other: the file is read or refused, and nothing else happens (the sanitizers see to that). */
static void test_mutations(void) {
  uint32_t state = 1;
  for (int i = 0; i < 6000; i++) {
    conic_model model;
    ply_put_mixture((encoding)(i % N_ENCODINGS), i & 1);
    for (int k = 0; k <= i % 4; k++) {
      state = state * 1664525u + 1013904223u;
      size_t position = 4 + (state >> 8) % (ply.n - 4);
      state = state * 1664525u + 1013904223u;
      ply.bytes[position] = (char)(k & 1 ? '0' + (state >> 24) % 10 : state >> 24);
    }
    conic_status status = ply_read(&model);
    CHECK(status == CONIC_OK || status == CONIC_ERROR_INPUT);
    for (size_t t = 0; t < model.n_triangles; t++)
      for (int corner = 0; corner < 3; corner++)
        CHECK(model.triangles[t][corner] < model.points.count);
    conic_model_release(context, &model);
  }
}

/* An allocator whose n-th call fails, and which counts what has not been released. */
typedef struct failing_allocator {
  int n_left, n_open;
} failing_allocator;

static void *allocate_or_fail(void *cookie, size_t bytes) {
  failing_allocator *allocator = cookie;
  if (allocator->n_left-- == 0)
    return NULL;
  allocator->n_open++;
  return malloc(bytes);
}

static void release(void *cookie, void *pointer) {
  failing_allocator *allocator = cookie;
  allocator->n_open -= pointer != NULL;
  free(pointer);
}

static void test_no_memory(void) {
  failing_allocator allocator = {1 << 30, 0};
  conic_context_options options;
  conic_context *poor;
  conic_context_options_init(&options);
  options.allocate = allocate_or_fail;
  options.release = release;
  options.allocator_cookie = &allocator;
  options.threads = 1;
  CHECK_OK(conic_context_create(&options, &poor));
  ply_put_mixture(TEXT, 1);
  const char *path = files_write_bytes("a.ply", ply.bytes, ply.n);
  int n_open = allocator.n_open, n_failed = 0;
  for (conic_status status = CONIC_ERROR_MEMORY; status != CONIC_OK && n_failed < 1000; n_failed++) {
    conic_model model;
    allocator.n_left = n_failed;
    status = conic_model_read(poor, path, NULL, &model);
    CHECK(status == CONIC_OK || (status == CONIC_ERROR_MEMORY && !model.points.position[0] && !model.triangles));
    conic_model_release(poor, &model);
    CHECK(allocator.n_open == n_open);
  }
  CHECK(n_failed > 8 && n_failed < 1000);
  allocator.n_left = 1 << 30;
  conic_context_destroy(poor);
  CHECK(allocator.n_open == 0);
  unlink(path);
}

int main(void) {
  context = files_context();
  test_wrong_headers();
  test_wrong_text();
  test_cut_text();
  test_wrong_binary();
  test_truncations();
  test_mutations();
  test_no_memory();
  files_end(context);
  return check_result();
}
