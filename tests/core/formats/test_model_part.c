/* Files whose points are read in parts: together these are all of them, bit for bit, whoever reads which; and what
 * cannot be parted says so. */
#include "core/formats/model_part.h"
#include "tests/support/files.h"
#include "tests/support/laz_examples.h"

enum { MOST = 1000 };

static conic_context *context;

/* What has come of a file: how many points, and those of a finite place. */
typedef struct row_of_points {
  size_t n_all, n;
  double place[MOST][3];
  float color[MOST];
} row_of_points;

static conic_status take_parts_row(void *cookie, const conic_splats *batch) {
  row_of_points *row = cookie;
  row->n_all += batch->count;
  for (size_t i = 0; i < batch->count && row->n < MOST; i++) {
    if (!(batch->position[1][i] - batch->position[1][i] == 0.0f))
      continue;
    for (int axis = 0; axis < 3; axis++)
      row->place[row->n][axis] = batch->origin[axis] + (double)batch->position[axis][i];
    row->color[row->n] = batch->color[1] ? batch->color[1][i] : -1.0f;
    row->n++;
  }
  return CONIC_OK;
}

static conic_status read_parts(const char *path, const conic_read_options *options, uint64_t step, row_of_points *row) {
  conic_model_shape shape;
  conic_model_survey survey = {.n_wanted = 0};
  conic_status status = conic_model_look(context, path, options, &shape);
  CHECK(status != CONIC_OK || shape.can_part);
  for (int is_survey = 1; is_survey >= 0; is_survey--)
    for (conic_points_range part = {0, step}; part.first < shape.n_points && status == CONIC_OK;
         part = (conic_points_range){part.end, part.end + step}) {
      conic_model_survey own = {.n_wanted = 0};
      if (is_survey)
        status = conic_model_survey_part(context, path, options, &part, &own);
      else
        status = conic_model_stream_part(context, path, options, &part, &survey, take_parts_row, row);
      conic_model_survey_add(&survey, &own);
    }
  CHECK(survey.n_wanted == row->n_all);
  const conic_points_range none = {step, step};
  if (status == CONIC_OK)
    status = conic_model_stream_part(context, path, options, &none, &survey, take_parts_row, row);
  return status;
}

static void check_parts(const char *path, const char *where) {
  static const uint64_t steps[] = {17, 1000};
  conic_read_options options;
  row_of_points whole = {.n_all = 0};
  conic_read_options_init(&options);
  options.where = where;
  CHECK_OK(conic_model_stream(context, path, &options, take_parts_row, &whole));
  CHECK(whole.n > 0);
  for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
    row_of_points parts = {.n_all = 0};
    CHECK_OK(read_parts(path, &options, steps[i], &parts));
    CHECK(parts.n_all == whole.n_all && parts.n == whole.n &&
          memcmp(parts.place, whole.place, whole.n * sizeof *whole.place) == 0);
    CHECK(memcmp(parts.color, whole.color, whole.n * sizeof *whole.color) == 0);
  }
}

/* Positions as doubles, whose first ones are none; before them and after them stands what nobody wants. */
static void check_ply(const char *type, int has_faces) {
  char bytes[16384];
  int n = snprintf(bytes, sizeof bytes,
                   "ply\nformat binary_little_endian 1.0\nelement before 1\nproperty int a\nelement vertex 600\n"
                   "property %s x\nproperty %s y\nproperty %s z\nproperty uchar value\n%send_header\n1234",
                   type, type, type, has_faces ? "element face 1\nproperty list uchar int vertex_indices\n" : "");
  size_t at = (size_t)n;
  for (int i = 0; i < 600; i++) {
    for (int axis = 0; axis < 3; axis++) {
      double value = i < 300 && axis == 1 ? strtod("nan", NULL) : 1e6 + i * 0.37 + axis;
      float narrow = (float)value;
      size_t size = strcmp(type, "double") == 0 ? sizeof value : sizeof narrow;
      memcpy(bytes + at, size == sizeof value ? (const void *)&value : &narrow, size);
      at += size;
    }
    bytes[at++] = (char)(i % 5);
  }
  memcpy(bytes + at, "\3\0\0\0\0\1\0\0\0\2\0\0\0", 13);
  const char *path = files_write_bytes("a.ply", bytes, at + (has_faces ? 13 : 0));
  check_parts(path, NULL);
  if (!has_faces)
    check_parts(path, "value > 2");
  CHECK(unlink(path) == 0);
}

/* Points that are so far apart that whole windows of the file are passed over. */
static void check_las(void) {
  las_file file = las_begin(2, 2, 90, 11000);
  las_set_scale(&file, 0.001, 589500.0, 231300.0, -50.0);
  for (size_t i = 0; i < 90; i++) {
    las_set_point(&file, i, (int32_t)(1000 * i), -2000 + (int32_t)i, 3000);
    las_set_color(&file, i, 0, i == 40 ? 4000 : 7 * (unsigned)i, 0); /* one point says that there are 12 bits */
  }
  const char *path = files_write_bytes("a.las", file.bytes, file.n_bytes);
  check_parts(path, NULL);
  CHECK(unlink(path) == 0);
  free(file.bytes);
}

/* In chunks, also without the table of them, as where the file was not ended. */
static void check_laz(void) {
  for (size_t i = 0; i < LAZ_EXAMPLES; i++) {
    las_file file = laz_example_file(&laz_examples[i]);
    const char *path = files_write_bytes("a.laz", file.bytes, file.n_bytes);
    check_parts(path, NULL);
    if (i == 0) {
      check_parts(path, "not intensity < 100");
      las_put(&file, file.points_offset, 0, 8);
      files_write_bytes("a.laz", file.bytes, file.n_bytes);
      check_parts(path, NULL);
    }
    CHECK(unlink(path) == 0);
    free(file.bytes);
  }
}

static void check_unparted(const char *name, const char *text) {
  conic_model_shape shape;
  const char *path = files_write(name, text);
  CHECK_OK(conic_model_look(context, path, NULL, &shape));
  CHECK(!shape.can_part);
  CHECK(unlink(path) == 0);
}

int main(void) {
  context = files_context();
  check_ply("double", 0);
  check_ply("double", 1);
  check_ply("float", 0);
  check_las();
  check_laz();
  check_unparted("a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                 "end_header\n1 2 3\n");
  check_unparted("a.xyz", "1 2 3\n4 5 6\n");
  files_end(context);
  return check_result();
}
