/* The table of fields covers the structs, down to the byte; and every field goes into a file and back to the bit, makes
 * another key, and is named where two shots differ. */
#include "conic/shot_file.h"
#include "shots/shot_fields.h"
#include "shots/shot_inputs.h"
#include "shots/shot_text.h"
#include "tests/support/files.h"

/* --- coverage --- */

static int compare_rows(const void *a, const void *b) {
  const conic_shot_row *first = *(const conic_shot_row *const *)a, *second = *(const conic_shot_row *const *)b;
  return (first->offset > second->offset) - (first->offset < second->offset);
}

/* What a member is aligned to, as far as its length tells. */
static size_t alignment_of(const conic_shot_row *row) {
  size_t element = row->of && row->kind != CONIC_ROW_POINTER ? sizeof(double) : row->bytes / conic_row_count(row);
  if (row->kind == CONIC_ROW_STRUCT && row->bytes % sizeof(double))
    return sizeof(int);
  if (row->kind == CONIC_ROW_RESERVED || row->kind == CONIC_ROW_LEFT_OUT)
    element = row->bytes % sizeof(double) ? sizeof(int) : sizeof(double);
  return element % sizeof(double) ? sizeof(int) : sizeof(double);
}

/* Between rows there are only the bytes that the next one's alignment takes; each of these holes is listed, so that a
 * new member has no place to hide in. */
static const struct {
  const char *rows, *before; /* the member that the hole is before; null: the end */
} holes[] = {{"shot", "n_samples"},   {"render", "epsilon"},  {"render", NULL},       {"view", "seconds"},
             {"view", "color_error"}, {"view", "chance"},     {"reading", "access"},  {"reading", "coloring"},
             {"reading", "cache"},    {"reading", "place"},   {"patches", "step_px"}, {"surface", "cluster"},
             {"surface", "is_sharp"}, {"coloring", "minimum"}};

static int n_holes;

static int is_hole(const char *rows, const char *before) {
  for (size_t i = 0; i < sizeof holes / sizeof *holes; i++)
    if (strcmp(holes[i].rows, rows) == 0 &&
        (holes[i].before && before ? strcmp(holes[i].before, before) == 0 : holes[i].before == before))
      return n_holes++, 1;
  return 0;
}

static void check_coverage(const conic_shot_rows *rows) {
  const conic_shot_row *sorted[64];
  size_t end = 0;
  for (size_t i = 0; i < rows->n_rows; i++)
    sorted[i] = &rows->rows[i];
  qsort(sorted, rows->n_rows, sizeof *sorted, compare_rows);
  for (size_t i = 0; i <= rows->n_rows; i++) {
    const conic_shot_row *row = i < rows->n_rows ? sorted[i] : NULL;
    size_t begin = row ? row->offset : rows->size, alignment = row ? alignment_of(row) : sizeof(double);
    int is_close = begin == end || (begin > end && begin - end < alignment && begin % alignment == 0);
    if (begin != end && (!is_close || !is_hole(rows->name, row ? row->name : NULL))) {
      fprintf(stderr, "%s: bytes %zu to %zu, before %s, are in no row\n", rows->name, end, begin,
              row ? row->name : "the end");
      check_failures++;
    }
    end = row ? row->offset + row->bytes : end;
  }
  for (size_t i = 0; i < rows->n_rows; i++) {
    const conic_shot_row *row = &rows->rows[i];
    CHECK(row->meaning || row->kind == CONIC_ROW_LENGTH || row->kind == CONIC_ROW_RESERVED);
    CHECK((row->of != NULL) ==
          (row->kind == CONIC_ROW_STRUCT || row->kind == CONIC_ROW_POINTER || row->kind == CONIC_ROW_LIST));
    CHECK(!row->of || row->kind != CONIC_ROW_STRUCT || row->of->size == row->bytes);
    CHECK((row->word != NULL) == (row->kind == CONIC_ROW_WORD || row->kind == CONIC_ROW_PLANES));
  }
}

/* --- values --- */

static uint64_t random_state = 1;
static double draw_real(void) { /* 0 to 1 */
  random_state = random_state * 6364136223846793005u + 1442695040888963407u;
  return (double)(random_state >> 11) * 0x1p-53;
}

static void fill_rows(const conic_shot_rows *rows, char *value);

static void fill_word(const conic_shot_row *row, char *at) {
  int n = 0;
  while (row->word(n))
    n++;
  int word = (int)(draw_real() * n);
  memcpy(at, &word, sizeof word);
}

static void fill_number(const conic_shot_row *row, char *at) {
  double real = row->least + (row->most - row->least) * draw_real();
  float rounded = (float)real;
  double step = floor(row->least + (row->most - row->least + 1.0) * draw_real());
  int whole = (int)step;
  uint32_t small = (uint32_t)step;
  uint64_t large = (uint64_t)step;
  if (row->kind == CONIC_ROW_DOUBLE)
    memcpy(at, &real, sizeof real);
  else if (row->kind == CONIC_ROW_FLOAT)
    memcpy(at, &rounded, sizeof rounded);
  else if (row->kind == CONIC_ROW_UINT32)
    memcpy(at, &small, sizeof small);
  else if (row->kind == CONIC_ROW_UINT64)
    memcpy(at, &large, sizeof large);
  else
    memcpy(at, &whole, sizeof whole);
}

static conic_patches_options patches;
static conic_coloring_options coloring;
static conic_camera cameras[3];

static void fill_row(const conic_shot_row *row, char *value) {
  static const char words[] = "a \"b\" \\ \xc3\xa9\n";
  char *at = value + row->offset;
  const void *to = words;
  int truth = draw_real() < 0.5, n;
  unsigned planes = (unsigned)(draw_real() * (1u << CONIC_N_PLANES));
  switch (row->kind) {
  case CONIC_ROW_STRUCT:
    fill_rows(row->of, at);
    break;
  case CONIC_ROW_POINTER:
    to = strcmp(row->name, "patches") == 0 ? (void *)&patches : (void *)&coloring;
    conic_patches_options_init(&patches);
    conic_coloring_options_init(&coloring);
    fill_rows(row->of, (char *)to);
    memcpy(at, &to, sizeof to);
    break;
  case CONIC_ROW_LIST:
    n = row->is_apart ? 3 : 2;
    for (int i = 0; i < n; i++)
      fill_rows(row->of, (row->is_apart ? (char *)cameras : at) + (size_t)i * row->of->size);
    to = cameras;
    memcpy(at, &to, row->is_apart ? sizeof to : 0);
    memcpy(value + row->length, &n, sizeof n); /* of 64 bits, the others are zero */
    break;
  case CONIC_ROW_WORD:
    fill_word(row, at);
    break;
  case CONIC_ROW_PLANES:
    memcpy(at, &planes, sizeof planes);
    break;
  case CONIC_ROW_TRUTH:
    memcpy(at, &truth, sizeof truth);
    break;
  case CONIC_ROW_TEXT:
  case CONIC_ROW_HAS:
    memcpy(at, &to, sizeof to);
    break;
  case CONIC_ROW_LENGTH:
  case CONIC_ROW_RESERVED:
  case CONIC_ROW_LEFT_OUT:
    break;
  case CONIC_ROW_INT:
  case CONIC_ROW_UINT32:
  case CONIC_ROW_UINT64:
  case CONIC_ROW_FLOAT:
  case CONIC_ROW_DOUBLE:
    for (size_t i = 0; i < conic_row_count(row); i++)
      fill_number(row, at + i * (row->bytes / conic_row_count(row)));
  }
}

static void fill_rows(const conic_shot_rows *rows, char *value) {
  static const double turned[3][4] = {{0.36, 0.48, -0.8, 0.5}, {-0.8, 0.6, 0.0, -0.25}, {0.48, 0.64, 0.6, 7.0}};
  for (size_t i = 0; i < rows->n_rows; i++)
    fill_row(&rows->rows[i], value);
  if (strcmp(rows->name, "camera") == 0) {
    conic_camera *camera = (conic_camera *)value;
    memcpy(camera->cam_from_world, turned, sizeof turned);
    camera->kind %= CONIC_CAMERA_CUBE; /* which has another shape */
    for (int axis = 0; axis < 3; axis++) {
      camera->turn[axis] = camera->shutter ? 0.1 * (axis + 1) : 0.0;
      camera->shift[axis] = camera->shutter ? camera->shift[axis] : 0.0;
    }
  }
  if (strcmp(rows->name, "render") == 0)
    ((conic_render_options *)value)->passes = draw_real() < 0.5 ? 1 : 3;
  if (strcmp(rows->name, "aperture") == 0)
    ((conic_aperture *)value)->n_blades += 3 - 3 * (((conic_aperture *)value)->n_blades > 61);
  if (strcmp(rows->name, "map") == 0)
    for (int axis = 0; axis < 3; axis++)
      ((conic_shot_map *)value)->maximum[axis] = fabs(((conic_shot_map *)value)->minimum[axis]);
  if (strcmp(rows->name, "shot") == 0) {
    ((conic_shot *)value)->n_samples++;
    ((conic_shot *)value)->view.samples = 1;
    ((conic_shot *)value)->planes &= ~(1u << CONIC_PLANE_BOUND); /* which no mean has */
  }
}

static void count_difference(void *cookie, const char *field, const char *a, const char *b) {
  fprintf(stderr, "  %s: %s, %s\n", field, a ? a : "none", b ? b : "none");
  ++*(int *)cookie;
}

static void check_round_trip(conic_context *context) {
  static const conic_shot_input inputs[] = {
      {.name = "a \"b\".ply",
       .n_bytes = 123456789012,
       .sha256 = "0123012301230123012301230123012301230123012301230123012301230123",
       .is_sampled = 1},
      {.name = "/x/sky.exr",
       .role = CONIC_SHOT_SKY,
       .sha256 = "4567456745674567456745674567456745674567456745674567456745674567"},
      {.name = "textures/c.png",
       .role = CONIC_SHOT_PART,
       .n_bytes = 5,
       .sha256 = "89ab89ab89ab89ab89ab89ab89ab89ab89ab89ab89ab89ab89ab89ab89ab89ab"}};
  conic_shot_file file, *read;
  char *text, key[CONIC_SHOT_KEY_ROOM], again[CONIC_SHOT_KEY_ROOM];
  for (int i = 0; i < 20; i++) {
    int n = 0;
    conic_shot_file_init(&file);
    fill_rows(&conic_shot_file_rows, (char *)&file);
    file.inputs = inputs;
    file.n_inputs = 3;
    CHECK_OK(conic_shot_file_print(context, &file, i % 2 ? CONIC_SHOT_WHOLE : CONIC_SHOT_COMPLETE, &text));
    CHECK_OK(conic_shot_file_parse(context, "test", text, strlen(text), &read));
    if (!read)
      return;
    CHECK_OK(conic_shot_file_compare(context, &file, read, count_difference, &n));
    CHECK_OK(conic_shot_file_key(context, &file, key));
    CHECK_OK(conic_shot_file_key(context, read, again));
    CHECK(n == 0 && strcmp(key, again) == 0 && read->n_inputs == 3 && strcmp(read->inputs[0].name, "a \"b\".ply") == 0);
    conic_shot_file_destroy(context, read);
    conic_shot_text_release(context, text);
  }
}

/* Whatever field is changed by itself, the key is another, and it is the field that is told of. */
typedef struct changing {
  conic_context *context;
  conic_shot_file *file;
  char key[CONIC_SHOT_KEY_ROOM], told[160];
  int n_fields;
} changing;

static void keep_field_name(void *cookie, const char *field, const char *a, const char *b) {
  changing *c = cookie;
  (void)a;
  (void)b;
  snprintf(c->told, sizeof c->told, "%s", field);
}

static void change_field(void *cookie, const conic_field_visit *visit) {
  changing *c = cookie;
  char *value = (char *)c->file + ((const char *)visit->value - (const char *)c->file), kept[256];
  char key[CONIC_SHOT_KEY_ROOM];
  int is_within = value >= (char *)c->file && value < (char *)(c->file + 1);
  conic_shot_file standard;
  if (!is_within || visit->row->bytes > sizeof kept)
    return;
  conic_shot_file_init(&standard);
  memcpy(kept, value + visit->row->offset, visit->row->bytes);
  for (int i = 0; i < 50 && conic_row_is_same(visit->row, visit->value, visit->standard); i++)
    fill_row(visit->row, value);
  c->told[0] = '\0';
  CHECK_OK(conic_shot_file_key(c->context, c->file, key));
  CHECK((strcmp(key, c->key) == 0) == (visit->row->is_no_key || strncmp(visit->path, "writing.", 8) == 0));
  CHECK_OK(conic_shot_file_compare(c->context, &standard, c->file, keep_field_name, c));
  CHECK(strcmp(c->told, visit->path) == 0);
  memcpy(value + visit->row->offset, kept, visit->row->bytes);
  c->n_fields++;
}

static void check_changes(conic_context *context) {
  conic_shot_file file;
  changing c = {.context = context, .file = &file};
  conic_shot_file_init(&file);
  CHECK_OK(conic_shot_file_key(context, &file, c.key));
  conic_fields_visit(&file, change_field, &c);
  CHECK(c.n_fields > 90);
}

/* --- ranges --- */

/* A number out of the range of a field, or as often as the field has numbers. */
static void print_number_of(const conic_shot_row *row, double number, char *text, size_t room) {
  size_t n = conic_row_count(row), columns = row->columns ? (size_t)row->columns : n, used = 0;
  for (size_t i = 0; i < n; i++)
    used += (size_t)snprintf(text + used, room - used, "%s%s%.17g%s",
                             i       ? ", "
                             : n > 1 ? "["
                                     : "",
                             columns < n && i % columns == 0 ? "[" : "", number,
                             columns < n && i % columns == columns - 1 ? "]" : "");
  snprintf(text + used, room - used, "%s", n > 1 ? "]" : "");
}

static void check_beyond(conic_context *context, const conic_shot_row *row, const char *before, const char *after,
                         double number) {
  char text[1024], value[512];
  conic_shot_file *file;
  print_number_of(row, number, value, sizeof value);
  snprintf(text, sizeof text, "%s\"%s\": %s%s", before, row->name, value, after);
  files_message[0] = '\0';
  CHECK(conic_shot_file_parse(context, "s.json", text, strlen(text), &file) == CONIC_ERROR_INPUT);
  if (!strstr(files_message, row->name)) {
    fprintf(stderr, "%s: %s\n", text, files_message);
    check_failures++;
  }
}

/* Every number of every struct has a range, and what is beyond is told of by the field's name. */
static void check_ranges(conic_context *context, const conic_shot_rows *rows, const char *before, const char *after) {
  for (size_t i = 0; i < rows->n_rows; i++) {
    const conic_shot_row *row = &rows->rows[i];
    char open[512], close[64];
    const int is_shot = rows == &conic_shot_file_rows && i == 1, is_list = row->kind == CONIC_ROW_LIST;
    if (row->of) {
      snprintf(open, sizeof open, "%s\"%s\": %s{", before, row->name, is_list ? "[" : "");
      snprintf(close, sizeof close, "}%s%s", is_list ? "]" : "", after);
      check_ranges(context, row->of, is_shot ? before : open, is_shot ? after : close);
    }
    if (row->kind > CONIC_ROW_DOUBLE)
      continue;
    CHECK(row->least < row->most);
    check_beyond(context, row, before, after, row->least - 1e-6 * fmax(1e6, fabs(row->least)));
    check_beyond(context, row, before, after, row->most + 1e-6 * fmax(1e6, fabs(row->most)));
  }
}

/* What holds unless it is said is in the range. */
static void check_standard(void *cookie, const conic_field_visit *visit) {
  const conic_shot_row *row = visit->row;
  (void)cookie;
  for (size_t i = 0; i < conic_row_count(row) && row->kind <= CONIC_ROW_DOUBLE && !row->is_said; i++) {
    const char *at = (const char *)visit->standard + row->offset + i * (row->bytes / conic_row_count(row));
    double real = row->kind == CONIC_ROW_INT      ? (double)*(const int *)at
                  : row->kind == CONIC_ROW_UINT32 ? (double)*(const uint32_t *)at
                  : row->kind == CONIC_ROW_UINT64 ? (double)*(const uint64_t *)at
                  : row->kind == CONIC_ROW_FLOAT  ? (double)*(const float *)at
                                                  : *(const double *)at;
    if (real - real == 0.0 && !(real >= row->least && real <= row->most)) {
      fprintf(stderr, "%s: %g is not within %g and %g\n", visit->path, real, row->least, row->most);
      check_failures++;
    }
  }
}

/* --- fields, one by one --- */

static void check_fields(void) {
  conic_shot_field field;
  size_t n = 0;
  int n_found = 0;
  for (; conic_shot_field_at(n, &field); n++) {
    CHECK(field.path[0] && field.meaning && field.count >= 1);
    if (strcmp(field.path, "render.lighting.lights[].color") == 0)
      n_found += field.kind == CONIC_SHOT_FIELD_FLOAT && field.count == 3;
    if (strcmp(field.path, "view.samples") == 0)
      n_found += field.kind == CONIC_SHOT_FIELD_INTEGER && strcmp(field.standard, "1") == 0;
    if (strcmp(field.path, "render.shading") == 0)
      n_found += strcmp(field.words[2], "phong") == 0 && !field.words[3] && strcmp(field.standard, "\"phong\"") == 0;
    if (strcmp(field.path, "reading.patches.surface.degree") == 0)
      n_found += strcmp(field.standard, "3") == 0;
    if (strcmp(field.path, "planes") == 0)
      n_found += field.kind == CONIC_SHOT_FIELD_WORDS && strcmp(field.standard, "[\"rgba\", \"Z\"]") == 0;
  }
  CHECK(n > 100 && n_found == 5);
}

static void check_schema(conic_context *context, const char *source) {
  char path[4096];
  char *text;
  snprintf(path, sizeof path, "%s/docs/reference/shot.schema.json", source);
  CHECK_OK(conic_shot_schema_print(context, &text));
  FILE *file = fopen(path, "rb");
  static char held[1 << 17];
  size_t n = file ? fread(held, 1, sizeof held - 1, file) : 0;
  if (file)
    fclose(file);
  if (n != strlen(text) || memcmp(held, text, n) != 0) {
    fprintf(stderr, "docs/reference/shot.schema.json is not the table's, which is on standard output\n");
    fputs(text, stdout);
    check_failures++;
  }
  conic_shot_text_release(context, text);
}

/* --- what is no shot --- */

static void check_refused(conic_context *context) {
  static const struct {
    const char *text, *message;
  } wrong[] = {
      {"{\"conic_shot\": 2}", "it is a shot of version 2, and this conic reads version 1"},
      {"{\"camera\": {}}", "a shot begins with its version"},
      {"{\"conic_shot\": 1, \"camra\": {}}", "there is no field 'camra'"},
      {"{\"conic_shot\": 1, \"render\": {\"metod\": \"ray\"}}", "there is no field 'metod'"},
      {"{\"conic_shot\": 1, \"render\": {\"method\": \"magic\"}}", "method cannot be 'magic'"},
      {"{\"conic_shot\": 1, \"render\": {\"tile\": 8}}", "there is no field 'tile'"},
      {"{\"conic_shot\": 1, \"shot\": {}}", "there is no field 'shot'"},
      {"{\"conic_shot\": 1, \"planes\": [\"rgb\"]}", "planes cannot be 'rgb'"},
      {"{\"conic_shot\": 1, \"view\": {\"samples\": 1.5}}", "samples is a whole number"},
      {"{\"conic_shot\": 1, \"view\": {\"budget\": -1}}", "budget is 0 to 4294967294, and not -1"},
      {"{\"conic_shot\": 1, \"noise\": 1e999}", "noise is too large"},
      {"{\"conic_shot\": 1, \"render\": {\"prefilter\": 1e39}}", "prefilter is too large"},
      {"{\"conic_shot\": 1, \"render\": {\"background\": [1, 2]}}", "background has another number of values"},
      {"{\"conic_shot\": 1, \"camera\": {\"cam_from_world\": [[1, 2, 3, 4], [1, 2, 3], [1]]}}",
       "another number of values"},
      {"{\"conic_shot\": 1, \"inputs\": [{}]}", "an input has no name"},
      {"{\"conic_shot\": 1, \"inputs\": [{\"name\": \"a\", \"as\": \"b\"}]}", "an input cannot be 'b'"},
      {"{\"conic_shot\": 1, \"inputs\": [{\"name\": \"a\", \"colour\": 1}]}", "there is no field 'colour' of an input"},
      {"{\"conic_shot\": 1, \"render\": {\"lighting\": {\"lights\": [{\"frame\": \"head\"},{\"frame\": \"head\"},"
       "{\"frame\": \"head\"},{\"frame\": \"head\"},{\"frame\": \"head\"},{\"frame\": \"head\"},"
       "{\"frame\": \"head\"},{\"frame\": \"head\"},{\"frame\": \"head\"}]}}}",
       "too many members"},
      {"{\"conic_shot\": 1, \"noise\": 1, \"noise\": 2}", "the field 'noise' stands twice"},
      {"{\"conic_shot\": 1, \"map\": {}, \"map\": {}}", "the field 'map' stands twice"},
      {"{\"conic_shot\": 1, \"conic_shot\": 1}", "the field 'conic_shot' stands twice"},
      {"{\"conic_shot\": 1, \"conic\": \"a\", \"conic\": \"b\"}", "the field 'conic' stands twice"},
      {"{\"conic_shot\": 1, \"inputs\": [{\"name\": \"a\"}], \"inputs\": [{\"name\": \"b\"}]}",
       "the field 'inputs' stands twice"},
      {"{\"conic_shot\": 1, \"inputs\": [{\"name\": \"a\", \"name\": \"b\"}]}", "the field 'name' stands twice"},
      {"{\"conic_shot\": 1, \"inputs\": [{\"name\": \"a\", \"bytes\": 1e30}]}", "bytes is 0 to 9.007199255e+15"},
      {"{\"conic_shot\": 1, \"inputs\": [{\"name\": \"a\", \"bytes\": -1}]}", "bytes is 0 to 9.007199255e+15"},
      {"{\"conic_shot\": 1, \"camera\": {\"width\": 4}}", "'height' is missing"},
      {"{\"conic_shot\": 1, \"camera\": {\"width\": 4, \"height\": 4, \"fx\": 1, \"fy\": 1, \"cx\": 0, \"cy\": 0, "
       "\"cam_from_world\": [[1, 0, 0, 0], [0, 2, 0, 0], [0, 0, 1, 0]]}}",
       "its rows are not orthonormal"},
      {"{\"conic_shot\": 1, \"way\": {\"kind\": \"orbit\"}}", "an orbit has an axis"},
      {"{\"conic_shot\": 1, \"way\": {\"kind\": \"cameras\"}}", "the camera's way has no cameras"},
      {"{\"conic_shot\": 1, \"render\": {\"lighting\": {\"lights\": [{\"frame\": \"camera\"}]}}}",
       "the light has no direction"},
      {"{\"conic_shot\": 1, \"render\": {\"lighting\": {\"sky\": [1, 1, 1]}}}", "the sky has no direction up"},
      {"{\"conic_shot\": 1, \"render\": {\"passes\": 2}}", "passes is 1 or 3"},
      {"{\"conic_shot\": 1, \"light\": {\"lamps\": [{\"kind\": \"disc\"}]}}", "a lamp's axes span nothing"},
      {"{\"conic_shot\": 1, \"aperture\": {\"n_blades\": 2}}", "a lens has 3 blades at least"},
      {"{\"conic_shot\": 1, \"aperture\": {\"diameter\": 2}}", "n_samples is above 0"},
      {"{\"conic_shot\": 1, \"n_samples\": 4, \"view\": {\"samples\": 2}}", "view.samples is 1"},
      {"{\"conic_shot\": 1, \"map\": {\"minimum\": [1, 0, 0], \"maximum\": [0, 0, 0]}}", "the map's box is empty"},
      {"{\"conic_shot\": 1} x", ""},
      {"{\"conic_shot\": 1, \"inputs\": [{\"name\": \"a\", \"sha256\": \"12\"}]}", "sha256 has 64 digits"},
      {"{}", "it is no shot"},
      {"[]", ""}};
  conic_shot_file *file;
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    files_message[0] = '\0';
    CHECK(conic_shot_file_parse(context, "s.json", wrong[i].text, strlen(wrong[i].text), &file) == CONIC_ERROR_INPUT);
    CHECK(!file && strncmp(files_message, "s.json: ", 8) == 0);
    if (!strstr(files_message, wrong[i].message)) {
      fprintf(stderr, "%s: %s\n", wrong[i].text, files_message);
      check_failures++;
    }
    files_message[0] = '\0';
    CHECK(conic_shot_file_parse(context, NULL, wrong[i].text, strlen(wrong[i].text), &file) == CONIC_ERROR_INPUT);
    CHECK(!files_message[0]);
  }
}

/* A file that stands again and again, whatever stands between. */
static void check_repeated(conic_context *context, size_t n, conic_status expected) {
  char *text = malloc(64 + 40 * n);
  conic_shot_file *file;
  size_t used = (size_t)sprintf(text, "{\"conic_shot\": 1, \"inputs\": [");
  for (size_t i = 0; i < n; i++)
    used += (size_t)sprintf(text + used, "%s{\"name\": \"%c\"}", i ? "," : "", i % 2 ? 'a' : 'b');
  used += (size_t)sprintf(text + used, "]}");
  CHECK(conic_shot_file_parse(context, "s.json", text, used, &file) == expected);
  conic_shot_file_destroy(context, file);
  free(text);
}

/* --- inputs --- */

static void look(conic_context *context, const char *path, conic_shot_input *input) {
  memset(input, 0, sizeof *input);
  input->name = path;
  CHECK_OK(conic_shot_input_look(context, path, input));
}

/* Of a large file the hash is of pieces and its time, and it says so; of a folder, of all that is in it. */
static void check_inputs(conic_context *context) {
  conic_shot_input small, large, later;
  const char *path = files_write("small", "abc");
  look(context, path, &small);
  CHECK(small.n_bytes == 3 && !small.is_sampled);
  CHECK(strcmp(small.sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad") == 0);
  CHECK(truncate(path, (64 << 20)) == 0);
  look(context, path, &large);
  CHECK(large.n_bytes == 64 << 20 && !large.is_sampled);
  CHECK(truncate(path, (64 << 20) + 1) == 0);
  look(context, path, &large);
  CHECK(large.n_bytes == (64 << 20) + 1 && large.is_sampled && strlen(large.sha256) == 64);
  FILE *file = fopen(path, "r+b");
  CHECK(file && fseek(file, -1, SEEK_END) == 0 && fputc('x', file) == 'x' && fclose(file) == 0);
  look(context, path, &later);
  CHECK(later.is_sampled && strcmp(large.sha256, later.sha256) != 0);
  unlink(path);
  look(context, files_path("none"), &small);
  CHECK(!small.n_bytes && !small.sha256[0]);
}

/* A thread beside finds the same as this one, and ends where nobody asks for it. */
static void check_beside(conic_context *context) {
  static char bytes[3 << 20];
  const char *scene[2];
  memset(bytes, 7, sizeof bytes);
  for (int i = 0; i < 2; i++) {
    FILE *file = fopen(scene[i] = strdup(files_path(i ? "second" : "first")), "wb");
    CHECK(file && fwrite(bytes, 1, sizeof bytes - (size_t)i, file) == sizeof bytes - (size_t)i && fclose(file) == 0);
  }
  const conic_shot_names names = {.scene = scene, .n_scene = 2, .texture = "-", .motion = scene[1]};
  conic_shot_inputs alone = {0}, beside = {0}, left = {0};
  CHECK_OK(conic_shot_inputs_find(context, &names, &alone));
  CHECK_OK(conic_shot_inputs_begin(context, &names, &beside));
  CHECK_OK(conic_shot_inputs_find(context, &names, &beside));
  CHECK(alone.n == 4 && beside.n == 4 && !beside.looking);
  for (size_t i = 0; i < alone.n && i < beside.n; i++)
    CHECK(strcmp(alone.inputs[i].name, beside.inputs[i].name) == 0 && alone.inputs[i].role == beside.inputs[i].role &&
          alone.inputs[i].n_bytes == beside.inputs[i].n_bytes &&
          strcmp(alone.inputs[i].sha256, beside.inputs[i].sha256) == 0);
  CHECK(strlen(alone.inputs[0].sha256) == 64 && strlen(alone.inputs[3].sha256) == 64 && !alone.inputs[2].sha256[0]);
  CHECK_OK(conic_shot_inputs_begin(context, &names, &left));
  conic_shot_inputs_release(context, &left);
  conic_shot_inputs_release(context, &alone);
  conic_shot_inputs_release(context, &beside);
  for (int i = 0; i < 2; i++) {
    unlink(scene[i]);
    free((void *)scene[i]);
  }
}

int main(int argc, char **argv) {
  conic_context *context = files_context();
  for (size_t i = 0; conic_all_shot_rows[i]; i++)
    check_coverage(conic_all_shot_rows[i]);
  if (sizeof(void *) == 8) /* else other holes */
    CHECK(n_holes == (int)(sizeof holes / sizeof *holes));
  check_round_trip(context);
  check_changes(context);
  check_fields();
  check_schema(context, argc > 1 ? argv[1] : ".");
  conic_shot_file standard;
  conic_shot_file_init(&standard);
  check_ranges(context, &conic_shot_file_rows, "{\"conic_shot\": 1, ", "}");
  conic_fields_visit(&standard, check_standard, NULL);
  check_refused(context);
  check_repeated(context, 512, CONIC_OK);
  check_repeated(context, 514, CONIC_ERROR_INPUT);
  check_repeated(context, 200000, CONIC_ERROR_INPUT);
  check_inputs(context);
  check_beside(context);
  files_end(context);
  return check_result();
}
