/* Which input has an id: of splats and of triangles, which are appended each on their own. */
#include "tests/support/files.h"

enum { N_INPUTS = 5 };

/* Three corners of a triangle at x = 10 n; every second file also has two splats' points, and every third no faces. */
static const char *write_input(int n) {
  char name[16], text[400];
  int length = snprintf(text, sizeof text, "v %d 0 0\nv %d 0 1\nv %d 1 0\n", 10 * n, 10 * n, 10 * n);
  if (n % 2)
    length += snprintf(text + length, sizeof text - (size_t)length, "v %d 5 5\nv %d 6 5\nv %d 5 6\nv %d 6 6\n", 10 * n,
                       10 * n, 10 * n, 10 * n);
  if (n % 3)
    snprintf(text + length, sizeof text - (size_t)length, "f 1 2 3\n");
  snprintf(name, sizeof name, "%d.obj", n);
  return files_write(name, text);
}

/* By the places of what the source hands over. */
static void check_source(const conic_source *source, size_t least_splats, size_t least_triangles) {
  const conic_drawing *drawing = &conic_source_chosen(source)->drawing;
  size_t n_splats = drawing->splats->count, n_triangles = drawing->triangles ? drawing->triangles->count : 0;
  CHECK(n_splats >= least_splats && n_triangles >= least_triangles);
  for (size_t i = 0; i < n_splats; i++) {
    double x = drawing->splats->origin[0] + (double)drawing->splats->position[0][i];
    CHECK((double)(10 * conic_source_input_of(source, (uint32_t)i)) == x);
  }
  for (size_t i = 0; i < n_triangles; i++) {
    uint32_t corner = drawing->triangles->corners[i][0];
    double x = drawing->triangles->origin[0] + (double)drawing->triangles->position[0][corner];
    CHECK((double)(10 * conic_source_input_of(source, (uint32_t)(n_splats + i))) == x);
  }
  conic_source_input_of(source, CONIC_NO_ID); /* some number */
}

int main(void) {
  conic_context *context = files_context();
  char paths[N_INPUTS][160];
  const char *inputs[N_INPUTS];
  conic_source_options options;
  conic_source *source;
  for (int i = 0; i < N_INPUTS; i++) {
    snprintf(paths[i], sizeof paths[i], "%s", write_input(i));
    inputs[i] = paths[i];
  }
  conic_source_options_init(&options);
  CHECK_OK(conic_source_open(context, inputs, N_INPUTS, &options, &source));
  check_source(source, 20, 0);
  conic_source_close(source);
  options.as = CONIC_AS_AUTO;
  CHECK_OK(conic_source_open(context, inputs, N_INPUTS, &options, &source));
  check_source(source, 8, 3);
  conic_source_close(source);
  options.as = CONIC_AS_PATCHES; /* whose ids are those of the points */
  CHECK_OK(conic_source_open(context, inputs, N_INPUTS, &options, &source));
  CHECK(conic_source_input_of(source, 2) == 0 && conic_source_input_of(source, 3) == 1);
  conic_source_close(source);
  for (int i = 0; i < N_INPUTS; i++)
    CHECK(unlink(paths[i]) == 0);
  files_end(context);
  return check_result();
}
