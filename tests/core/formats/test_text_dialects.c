/* Text as programs export it: the dialects that are read, the columns that they name, and those that are refused since
 * nobody can tell what they mean. */
#include "core/base/color.h"
#include "core/formats/text_columns.h"
#include "tests/support/files.h"

static conic_context *context;

static conic_status read_named(const char *name, const char *text, const char *columns, conic_model *model) {
  conic_read_options options;
  conic_read_options_init(&options);
  options.columns = columns;
  const char *path = files_write(name, text);
  files_warnings = 0;
  conic_status status = conic_model_read(context, path, &options, model);
  CHECK(unlink(path) == 0);
  return status;
}

/* Every dialect holds the same two points: (1.5, 2.5, 3.5) and (4.25, −5, 6), with a colour of 255, 51, 0 and 0, 0, 255
 * or a normal along z and x where it has them. */
static void check_points(const char *what, const conic_model *model, unsigned fields) {
  static const double places[2][3] = {{1.5, 2.5, 3.5}, {4.25, -5.0, 6.0}};
  static const double codes[2][3] = {{255, 51, 0}, {0, 0, 255}};
  static const float normals[2][3] = {{0, 0, 1}, {1, 0, 0}};
  const conic_splats *points = &model->points;
  int is_right = points->count == 2 && conic_splats_fields(points) == fields && model->kind == CONIC_MODEL_XYZ;
  for (int i = 0; is_right && i < 2; i++)
    for (int axis = 0; axis < 3; axis++) {
      is_right &= points->origin[axis] + (double)points->position[axis][i] == places[i][axis];
      if (points->color[0])
        is_right &= points->color[axis][i] == (float)conic_srgb_decode(codes[i][axis] / 255.0);
      if (points->normal[0])
        is_right &= points->normal[axis][i] == normals[i][axis];
    }
  if (!is_right) {
    fprintf(stderr, "'%s': %zu points, fields %u, are not as they should be; %s\n", what, points->count,
            conic_splats_fields(points), files_message);
    check_failures++;
  }
}

static void check_read(const char *name, const char *text, unsigned fields) {
  conic_model model;
  CHECK_OK(read_named(name, text, NULL, &model));
  check_points(text, &model, fields);
  CHECK(files_warnings == 0 || strstr(files_warning, "the columns are taken for"));
  conic_model_release(context, &model);
}

enum { NONE = 0, COLORS = CONIC_SPLATS_COLORS, NORMALS = CONIC_SPLATS_NORMALS, BOTH = COLORS | NORMALS };

static void test_headers(void) {
  check_read("a.csv", "X,Y,Z\n1.5,2.5,3.5\n4.25,-5,6\n", NONE);
  check_read("a.csv", "\"X\",\"Y\",\"Z\"\n1.5,2.5,3.5\n4.25,-5,6\n", NONE);
  check_read("a.csv", "\"X\";\"Y\";\"Z\"\r\n\"1.5\";\"2.5\";\"3.5\"\r\n\"4.25\";\"-5\";\"6\"\r\n", NONE);
  check_read("a.txt", "X  Y  Z\n1.5  2.5  3.5\n4.25  -5  6\n", NONE);
  check_read("a.txt", "x y z r g b\n1.5 2.5 3.5 255 51 0\n4.25 -5 6 0 0 255\n", COLORS);
  check_read("a.txt", "r g b x y z\n255 51 0 1.5 2.5 3.5\n0 0 255 4.25 -5 6\n", COLORS);
  check_read("a.asc", "% Z X Y\n% by hand\n3.5 1.5 2.5\n6 4.25 -5\n", NONE);
  check_read("a.asc", "//X Y Z\n1.5 2.5 3.5\n4.25 -5 6\n", NONE);
  check_read("a.asc", "//X Y Z R G B\n2\n1.5 2.5 3.5 255 51 0\n4.25 -5 6 0 0 255\n", COLORS); /* names and a count */
  check_read("a.xyz", "# X Y Z R G B Intensity Nx Ny Nz\n1.5 2.5 3.5 255 51 0 -7 0 0 1\n4.25 -5 6 0 0 255 9 1 0 0\n",
             BOTH);
  check_read("a.xyz", "# X Y Z\n1.5 2.5 3.5 255 51 0\n4.25 -5 6 0 0 255\n", COLORS); /* goes without saying */
  check_read("a.xyz", "# Z X Y\n3.5 1.5 2.5 17\n6 4.25 -5 18\n", NONE);              /* and this does not */
  check_read("a.xyz", "# x y z are in metres\n1.5 2.5 3.5\n4.25 -5 6\n", NONE);
  check_read("a.xyz", "# Intensity Nx Ny Nz X Y Z\n7 0 0 1 1.5 2.5 3.5\n9 1 0 0 4.25 -5 6\n", NORMALS);
  check_read("a.csv", "id,Easting (m),Northing (m),Elevation [m],class\nA1,1.5,2.5,3.5,tree top\nA2,4.25,-5,6,\n",
             NONE);
  check_read("a.csv", "Points:0,Points:1,Points:2,Normals:0,Normals:1,Normals:2\n1.5,2.5,3.5,0,0,1\n4.25,-5,6,1,0,0\n",
             NORMALS);
  check_read("a.txt", "label\tx\ty\tz\nsome tree\t1.5\t2.5\t3.5\n\t4.25\t-5\t6\n", NONE); /* tabs, and one is missing */
  check_read("a.txt", "Z\tX\tY\tnormal_x\tnormal_y\tnormal_z\n3.5\t1.5\t2.5\t0\t0\t1\n6\t4.25\t-5\t1\t0\t0\n", NORMALS);
  check_read("a.csv", "x,y,z,Red,Green,Blue,Alpha\n1.5,2.5,3.5,255,51,0,128\n4.25,-5,6,0,0,255,128\n", COLORS);
  check_read("a.csv", "x,y,z,r,g\n1.5,2.5,3.5,255,51\n4.25,-5,6,0,0\n", NONE); /* a colour lacks a part */
  check_read("a.csv", "x;y;z\n1.5 2.5 3.5\n4.25 -5 6\n", NONE);                /* parted otherwise than its names */
  check_read("a.csv", "time,x,y,z\n,1.5,2.5,3.5\n2021-04-01 10:00,4.25,-5,6\n", NONE);
}

static void test_separators(void) {
  check_read("a.csv", "1.5;2.5;3.5\n4.25;-5;6\n", NONE);
  check_read("a.csv", "1.5;2.5;3.5;\n4.25;-5;6;\n", NONE); /* every line ends with one */
  check_read("a.xyz", "1.5\t2.5\t3.5\r\n4.25\t-5\t6\r\n", NONE);
  check_read("a.xyz", "1.5 , 2.5 ,3.5\n4.25, -5, 6\n", NONE);
  check_read("a.xyz", "1.5,2.5,3.5 255 51 0\n4.25,-5,6 0 0 255\n", COLORS);
  check_read("a.xyz", "1.5,2.5,3.5;255,51,0\n4.25,-5,6;0,0,255\n", COLORS);
  check_read("a.csv", "\"1.5\",\"2.5\",\"3.5\"\n\"4.25\",\"-5\",\"6\"\n", NONE);
  check_read("a.neu",
             "\xEF\xBB\xBF"
             "1.5 2.5 3.5\n4.25 -5 6\n",
             NONE); /* a byte-order mark */
  check_read("a.csv", "\xEF\xBB\xBFX;Y;Z\n1.5;2.5;3.5\n4.25;-5;6\n", NONE);
}

static void test_decimal_commas(void) {
  check_read("a.csv", "1,5;2,5;3,5\n4,25;-5;6\n", NONE);
  check_read("a.xyz", "1,5 2,5 3,5\n4,25 -5 6\n", NONE);
  check_read("a.txt", "x\ty\tz\n1,5\t2,5\t3,5\n4,25\t-5\t6\n", NONE);
  check_read("a.csv", "X;Y;Z;R;G;B\n1,5;2,5;3,5;255;51;0\n4,25;-5,0;6,0;0;0;255\n", COLORS);
  check_read("a.csv", "\"1,5\",\"2,5\",\"3,5\"\n\"4,25\",\"-5\",\"6\"\n", NONE);
  check_read("a.xyz", "1,5e0 25,0e-1 3,5\n4,25 -5 6\n", NONE);
}

/* Columns that nobody names. */
static void test_numbers_of_columns(void) {
  check_read("a.xyz", "1.5 2.5 3.5 17 18\n4.25 -5 6 19 20\n", NONE);
  check_read("a.xyzrgb", "1.5 2.5 3.5 255 51 0\n4.25 -5 6 0 0 255\n", COLORS);
  check_read("a.xyz", "1.5 2.5 3.5 0.5 255 51 0 0.1\n4.25 -5 6 0.5 0 0 255 0.1\n", COLORS);
  check_read("a.xyz", "1.5 2.5 3.5 0 0 1 0.5 0.1\n4.25 -5 6 1 0 0 0.5 0.1\n", NORMALS);
  check_read("a.xyz", "1.5 2.5 3.5 255 51 0 -7.5 0 0 1\n4.25 -5 6 0 0 255 9.5 1 0 0\n", BOTH);
  check_read("a.xyz", "1.5 2.5 3.5 0 0 1 255 51 0 -7.5\n4.25 -5 6 1 0 0 0 0 255 9.5\n", BOTH);
  check_read("a.xyz", "1.5 2.5 3.5 -7 255 51 0 0 0 1 4\n4.25 -5 6 9 0 0 255 1 0 0 4\n", BOTH);
}

static void check_columns(const char *text, const char *columns, unsigned fields) {
  conic_model model;
  CHECK_OK(read_named("a.txt", text, columns, &model));
  check_points(text, &model, fields);
  conic_model_release(context, &model);
}

static void test_columns(void) {
  const char *text = "255 51 0 17 1.5 2.5 3.5\n0 0 255 17 4.25 -5 6\n";
  check_columns(text, "r,g,b,-,x,y,z", COLORS);
  check_columns(text, "-,-,-,amplitude,x,y,z", NONE);
  check_columns("1.5 2.5 3.5 9 8 7\n4.25 -5 6 9 8 7\n", "x,y,z", NONE);  /* what follows is passed over */
  check_columns("t,u,v\nA,2.5,1.5,3.5\nB,-5,4.25,6\n", "-,y,x,z", NONE); /* in place of the header's */
  check_columns("3,5;1,5;2,5;0;0;1\n6,0;4,25;-5,0;1;0;0\n", "z,x,y,nx,ny,nz", NORMALS);
  conic_text_columns columns;
  CHECK(!conic_text_columns_parse("x,y,z,Scalar intensity,-,-", &columns));
  CHECK(conic_text_columns_find(&columns, "scalar_Intensity") == 3 && conic_text_columns_find(&columns, "gain") == -1);
  static const char *const wrong[][2] = {{"x,y", "x, y and z"},  {"", "x, y and z"},   {"x,y,z,r,g", "r, g and b"},
                                         {"x,y,z,nx", "nx, ny"}, {"x,y,z,x", "twice"}, {"x,,y,z", "missing"},
                                         {"x,y,z,a,A", "twice"}};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    const char *why = conic_text_columns_parse(wrong[i][0], &columns);
    CHECK(why && strstr(why, wrong[i][1]));
  }
  conic_model model;
  CHECK(read_named("a.txt", text, "x,y", &model) == CONIC_ERROR_ARGUMENT);
  files_check_failed("fewer", read_named("a.txt", text, "x,y,z,p,q,s,t,u", &model), "7 values", "names 8", "line 1",
                     NULL);
}

/* Lines that differ from what the header names are passed over and told, unless they are the most. */
static void test_odd_lines(void) {
  conic_model model;
  CHECK_OK(read_named("a.txt", "X, Y, Z\n\n1.5 , 2.5 , 3.5,27\n1.5 , 2.5 , 3.5\n4.25 , -5 , 6\n", NULL, &model));
  check_points("odd", &model, NONE);
  CHECK(files_warnings == 1 && strstr(files_warning, "1 lines") && strstr(files_warning, "line 3"));
  conic_model_release(context, &model);
  files_check_failed("most", read_named("a.txt", "X,Y,Z\n1,2,3\n1,2\n1,2\n", NULL, &model), "most lines", "line 3",
                     NULL);
}

static void check_refused(const char *text, const char *what, const char *where) {
  conic_model model;
  files_check_failed(text, read_named("a.csv", text, NULL, &model), "a.csv: ", what, where, (const char *)NULL);
}

static void test_refused(void) {
  check_refused("1,234.5 2,345.6 3,456.7\n", "thousands", "line 1");
  check_refused("1,5;2.5;3\n", "both commas and points", "line 1");
  check_refused("\"1,234.5\",\"2,345.6\",\"3,456.7\"\n", "thousands", "line 1");
  check_refused("1,5, 2,5, 3,5\n", "cannot be told", "line 1");
  check_refused("1,25,2,05,3,75\n", "decimal", "line 1");
  check_refused("X,Y,Z\n1,5,2,5,3,5\n", "6 values, where the header names 3", "line 2");
  check_refused("one two three\n", "names of columns", "line 1");
  check_refused("Once upon a time, there was a y.\n1 2 3\n", "names of columns", "conic reads PLY");
  check_refused("id,depth\n1,2\n", "--columns", "line 1");
  check_refused("X,Y,Z\n1,2,3\n1,two,3\n", "not a number", "line 3");
  check_refused("X,Y,Z\n", "without a point", "line 2");
  check_refused("\1\2\3\n", "no text", "line 1");
  check_refused("x y z\r1 2 3\r4 5 6\r", "carriage return alone", "line 1");
  check_refused("15\n71\n0 0 0\n1 0 0\n", "PTX scan", "line 2");
}

/* Two bytes a character, with and without a mark. */
static void test_wide(void) {
  static const char *const wide[] = {"\xFF\xFEx\0 \0y\0 \0z\0\n\0", "\xFE\xFF\0x\0 \0y\0 \0z\0\n",
                                     "x\0 \0y\0 \0z\0\n\0  ", "\0x\0 \0y\0 \0z\0\n  "};
  for (size_t i = 0; i < sizeof wide / sizeof *wide; i++) {
    conic_model model;
    const char *path = files_write_bytes("a.txt", wide[i], 14);
    files_check_failed("wide", conic_model_read(context, path, NULL, &model), "UTF-16", "iconv", (const char *)NULL);
    CHECK(unlink(path) == 0);
  }
}

/* The dialect holds on behind the first block and the first window, and without an ending that tells. */
static void test_long(void) {
  enum { N = 40000 };
  conic_model model;
  const char *path = files_path("long");
  FILE *file = fopen(path, "w");
  if (!file)
    exit(1);
  fputs("Z;X;Y\n", file);
  for (int i = 0; i < N; i++)
    fprintf(file, "%d,5;%d;1,25\n", i, 2 * i);
  fclose(file);
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(model.points.count == N && model.points.position[0][N - 1] == 2.0f * (N - 1));
  CHECK(model.points.count == N && model.points.position[2][N - 1] == (float)(N - 1));
  conic_model_release(context, &model);
  CHECK(unlink(path) == 0);
}

int main(void) {
  context = files_context();
  test_headers();
  test_separators();
  test_decimal_commas();
  test_numbers_of_columns();
  test_columns();
  test_odd_lines();
  test_refused();
  test_wide();
  test_long();
  files_end(context);
  return check_result();
}
