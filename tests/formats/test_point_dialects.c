/* Points in every dialect of their formats: the same hundred come out of each, with all that their dialect keeps. */
#include "tests/formats/dialects.h"
#include "tests/support/las_file.h"

static conic_context *context;
static mesh_file file;

/* A line for each dialect, or each set of them. Columns of text are joined by + signs. */
static const char *const dialects[] = {
    "xyz columns:x+y+z {blank,tab,comma,semicolon} {lf,crlf}",
    "xyz columns:{x+y+z+rgb,x+y+z+i+rgb,x+y+z+rgb+n,x+y+z+n+rgb,x+y+z+n,row+column+x+y+z+rgb} {blank,tab,semicolon}",
    "xyz columns:x+y+z+rgb+{s,c} {blank,comma}",
    "xyz columns:x+y+z+rgb color:{float,ushort} {blank,comma}",
    "xyz columns:x+y+z+i+c+t+n+rgb names:{plain,hash,slashes,upper} {blank,tab,comma,semicolon}",
    "xyz columns:i+rgb+x+y+z names:plain {quoted,comma} {lf,crlf}",
    "xyz columns:x+y+z+i {semicolon,tab,blank} decimalcomma",
    "xyz columns:x+y+z+i+rgb counted {blank,tab}",
    "xyz columns:x+y+z+rgb mark blank",
    "pcd {ascii,binary,lzf} at:{float,double} {none,packed,packed-u,channels,rgba}",
    "pcd {ascii,binary,lzf} {padded,normals,fields,counts}",
    "pcd {ascii,binary} {columns,lower,nocount,nosize,organized,unmeasured} fields",
    "pcd ascii crlf fields",
    "las minor:{0,1,2,3} form:{0,1}",
    "las minor:{2,3} form:{2,3} color:{uchar,ushort,upper}",
    "las minor:3 form:{4,5}",
    "las minor:4 form:{0,1,2,3,4,5,6,7,8,9,10} {plain,extra}",
    "las minor:4 form:{7,8,10} color:{uchar,upper}",
    "ptx {plain,color} {lf,crlf} {still,moved,holes}",
};

static const char *end_of_line(const char *d) {
  return is_said(d, "crlf") ? "\r\n" : "\n";
}

/* --- text --- */

/* The values of a column, and what they are called. */
static int list_column(const char *column, const char *color, int i, double values[3], const char *names[3]) {
  static const char *const all[][4] = {
      {"x", "x"},          {"y", "y"},     {"z", "z"},        {"rgb", "r", "g", "b"}, {"n", "nx", "ny", "nz"},
      {"i", "intensity"},  {"c", "class"}, {"t", "gps_time"}, {"s", "scalar"},        {"row", "row"},
      {"column", "column"}};
  size_t k = 0;
  while (strcmp(all[k][0], column) != 0)
    k++;
  int n = k == 3 || k == 4 ? 3 : 1;
  for (int part = 0; part < n; part++) {
    names[part] = all[k][1 + part];
    values[part] = k < 3    ? scene_point(i, (int)k)
                   : k == 3 ? color_value(color, scene_point_code(i, part))
                   : k == 4 ? scene_point_normal(i, part)
                   : k == 5 ? scene_intensity(i)
                   : k == 6 ? scene_class(i)
                   : k == 7 ? scene_time(i)
                   : k == 8 ? 0.01 * i - 0.4
                   : k == 9 ? i / 10
                            : i % 10;
  }
  return n;
}

/* The line of point i; below 0 that of the names. */
static void text_line(const char *d, int i) {
  const char *color = is_said(d, "color") ? word_of(d, "color") : "uchar";
  const char *gap = is_said(d, "tab")         ? "\t"
                    : is_said(d, "comma")     ? ","
                    : is_said(d, "semicolon") ? "; "
                    : is_said(d, "quoted")    ? ","
                                              : " ";
  int n_put = 0;
  for (const char *c = word_of(d, "columns"); *c; c += strcspn(c, "+"), c += *c == '+') {
    char column[16], number[40];
    double values[3];
    const char *names[3];
    snprintf(column, sizeof column, "%.*s", (int)strcspn(c, "+"), c);
    int n = list_column(column, color, i < 0 ? 0 : i, values, names);
    for (int part = 0; part < n; part++) {
      snprintf(number, sizeof number, "%.14g", values[part]);
      char *point = strchr(number, '.');
      if (is_said(d, "decimalcomma") && point)
        *point = ',';
      mesh_text(&file, is_said(d, "quoted") ? "%s\"%s\"" : "%s%s", n_put++ ? gap : "", i < 0 ? names[part] : number);
    }
  }
  mesh_text(&file, "%s", end_of_line(d));
}

static void write_text(const char *d) {
  const char *names = word_of(d, "names");
  if (is_said(d, "mark"))
    mesh_text(&file, "\xEF\xBB\xBF");
  if (is_said(d, "counted"))
    mesh_text(&file, "%d%s", SCENE_POINTS, end_of_line(d));
  if (names) {
    mesh_text(&file, "%s", strcmp(names, "hash") == 0 ? "# " : strcmp(names, "slashes") == 0 ? "//" : "");
    size_t first = file.n;
    text_line(d, -1);
    for (size_t k = first; k < file.n && strcmp(names, "upper") == 0; k++)
      file.bytes[k] =
          (unsigned char)(file.bytes[k] >= 'a' && file.bytes[k] <= 'z' ? file.bytes[k] - 32 : file.bytes[k]);
  }
  for (int i = 0; i < SCENE_POINTS; i++)
    text_line(d, i);
}

/* --- PCD --- */

typedef struct pcd_column {
  const char *name, *type; /* the type of PLY */
  int count;
  double (*value)(int i, int k); /* of place k */
} pcd_column;

static double place(int i, int k) {
  return scene_point(i, k);
}
static double zero(int i, int k) {
  (void)i, (void)k;
  return 7.0;
}
static double packed(int i, int k) {
  float value;
  uint32_t bits =
      (uint32_t)scene_point_code(i, 0) << 16 | (uint32_t)scene_point_code(i, 1) << 8 | (uint32_t)scene_point_code(i, 2);
  memcpy(&value, &bits, sizeof value);
  return k ? (double)bits : (double)value;
}
static double code(int i, int k) {
  return scene_point_code(i, k);
}
static double normal(int i, int k) {
  return scene_point_normal(i, k);
}
static double field(int i, int k) {
  return k == 0 ? scene_intensity(i) : k == 1 ? scene_class(i) : scene_time(i);
}

static int pcd_columns(const char *d, pcd_column list[16]) {
  const char *at = is_said(d, "at") ? word_of(d, "at") : "float";
  int n = 0;
  for (int axis = 0; axis < 3; axis++)
    list[n++] = (pcd_column){(const char *[]){"x", "y", "z"}[axis], at, 1, place};
  if (is_said(d, "padded"))
    list[n++] = (pcd_column){"_", "uchar", 4, zero};
  if (is_said(d, "counts"))
    list[n++] = (pcd_column){"histogram", "float", 33, zero};
  if (is_said(d, "packed"))
    list[n++] = (pcd_column){"rgb", "float", 1, packed};
  if (is_said(d, "packed-u") || is_said(d, "rgba"))
    list[n++] = (pcd_column){is_said(d, "rgba") ? "rgba" : "rgb", "uint", 1, packed};
  for (int k = 0; k < 3 && is_said(d, "channels"); k++)
    list[n++] = (pcd_column){(const char *[]){"r", "g", "b"}[k], "uchar", 1, code};
  for (int k = 0; k < 3 && is_said(d, "normals"); k++)
    list[n++] = (pcd_column){(const char *[]){"normal_x", "normal_y", "normal_z"}[k], "float", 1, normal};
  for (int k = 0; k < 3 && is_said(d, "fields"); k++)
    list[n++] = (pcd_column){(const char *[]){"intensity", "class", "gps_time"}[k],
                             (const char *[]){"float", "uchar", "double"}[k], 1, field};
  return n;
}

static double pcd_value(const pcd_column *list, int i_column, int i) {
  int k = 0;
  for (int before = i_column; before > 0 && list[before - 1].value == list[i_column].value; before--)
    k++;
  if (list[i_column].value == packed && strcmp(list[i_column].type, "uint") == 0)
    k = 1;
  return list[i_column].value(i, k);
}

static void pcd_head_line(const char *d, const char *word, const pcd_column *list, int n, int what) {
  mesh_text(&file, "%s", word);
  for (int i = 0; i < n; i++) {
    const char *type = list[i].type;
    int n_bytes = strstr(type, "char") ? 1 : strcmp(type, "double") == 0 ? 8 : 4;
    if (what == 0)
      mesh_text(&file, " %s", list[i].name);
    else if (what == 2)
      mesh_text(&file, " %c", type[0] == 'u' ? 'U' : 'F');
    else
      mesh_text(&file, " %d", what == 1 ? n_bytes : list[i].count);
  }
  mesh_text(&file, "%s", end_of_line(d));
}

/* As runs of letters that nothing is left out of. */
static void put_unpacked(const unsigned char *bytes, size_t n) {
  mesh_number(&file, (uint32_t)(n + (n + 31) / 32), 4);
  mesh_number(&file, (uint32_t)n, 4);
  for (size_t at = 0; at < n; at += 32) {
    size_t step = n - at < 32 ? n - at : 32;
    mesh_put(&file, &(unsigned char){(unsigned char)(step - 1)}, 1);
    mesh_put(&file, bytes + at, step);
  }
}

static void write_pcd(const char *d) {
  static mesh_file rows;
  pcd_column list[16];
  const char *nl = end_of_line(d);
  const int n = pcd_columns(d, list), is_ascii = is_said(d, "ascii"), is_lower = is_said(d, "lower");
  const int n_points = SCENE_POINTS + (is_said(d, "unmeasured") ? 2 : 0);
  mesh_text(&file, "# .PCD v.7 by hand%s%s%s", nl, is_lower ? "version .7" : "VERSION .7", nl);
  pcd_head_line(d, is_said(d, "columns") ? "COLUMNS" : is_lower ? "fields" : "FIELDS", list, n, 0);
  pcd_head_line(d, is_lower ? "size" : "SIZE", list, n, 1);
  pcd_head_line(d, is_lower ? "type" : "TYPE", list, n, 2);
  if (!is_said(d, "nocount"))
    pcd_head_line(d, is_lower ? "count" : "COUNT", list, n, 3);
  if (!is_said(d, "nosize"))
    mesh_text(&file, "WIDTH %d%sHEIGHT %d%s", is_said(d, "organized") ? 20 : n_points, nl,
              is_said(d, "organized") ? n_points / 20 : 1, nl);
  mesh_text(&file, "VIEWPOINT 0 0 0 1 0 0 0%sPOINTS %d%s", nl, n_points, nl);
  mesh_text(&file, "%s %s%s", is_lower ? "data" : "DATA",
            is_ascii            ? "ascii"
            : is_said(d, "lzf") ? "binary_compressed"
                                : "binary",
            nl);
  rows.n = 0;
  for (int k = 0; k < (is_said(d, "lzf") ? n : 1); k++) /* compressed, all of a field stand together */
    for (int i = 0; i < n_points; i++) {
      for (int c = is_said(d, "lzf") ? k : 0; c < (is_said(d, "lzf") ? k + 1 : n); c++)
        for (int part = 0; part < list[c].count; part++) {
          const int is_hole = i >= SCENE_POINTS;
          double value = is_hole && c < 3 ? NAN : pcd_value(list, c, is_hole ? 0 : i);
          if (is_hole && c < 3 && is_ascii)
            mesh_text(&rows, "nan ");
          else
            put_number(&rows, is_ascii ? "ascii" : "le", list[c].type, value);
        }
      if (is_ascii)
        mesh_text(&rows, "%s", nl);
    }
  if (is_said(d, "lzf"))
    put_unpacked(rows.bytes, rows.n);
  else
    mesh_put(&file, rows.bytes, rows.n);
}

/* --- LAS --- */

static int las_form(const char *d) {
  return atoi(word_of(d, "form"));
}

static void write_las(const char *d) {
  static const int time_at[] = {0, 20, 0, 20, 20, 20, 22, 22, 22, 22, 22};
  const int form = las_form(d), has_color = form == 2 || form == 3 || form == 5 || form == 7 || form == 8 || form == 10;
  las_file made = las_begin(atoi(word_of(d, "minor")), form, SCENE_POINTS, is_said(d, "extra") ? 3 : 0);
  las_set_scale(&made, 0.25, 1000.0, 0.0, 0.0);
  for (int i = 0; i < SCENE_POINTS; i++) {
    const size_t at = made.points_offset + (size_t)i * made.point_bytes;
    const unsigned scale = says(d, "color", "uchar") ? 1 : says(d, "color", "upper") ? 256 : 257;
    las_set_point(&made, (size_t)i, (int32_t)(4.0 * (scene_point(i, 0) - 1000.0)), (int32_t)(4.0 * scene_point(i, 1)),
                  (int32_t)(4.0 * scene_point(i, 2)));
    las_put(&made, at + 12, (uint64_t)scene_intensity(i), 2);
    las_put(&made, at + (form < 6 ? 15 : 16), (uint64_t)scene_class(i), 1);
    if (time_at[form])
      las_put_double(&made, at + (size_t)time_at[form], scene_time(i));
    if (has_color)
      las_set_color(&made, (size_t)i, scale * (unsigned)scene_point_code(i, 0),
                    scale * (unsigned)scene_point_code(i, 1), scale * (unsigned)scene_point_code(i, 2));
  }
  mesh_put(&file, made.bytes, made.n_bytes);
  free(made.bytes);
}

/* --- PTX --- */

static void write_ptx(const char *d) {
  const char *nl = end_of_line(d);
  const int n_holes = is_said(d, "holes") ? 10 : 0, shift = is_said(d, "moved") ? 5 : 0;
  mesh_text(&file, "%d%s10%s%d 0 0%s1 0 0%s0 1 0%s0 0 1%s", (SCENE_POINTS + n_holes) / 10, nl, nl, shift, nl, nl, nl,
            nl);
  mesh_text(&file, "1 0 0 0%s0 1 0 0%s0 0 1 0%s%d 0 0 1%s", nl, nl, nl, shift, nl);
  for (int i = 0; i < SCENE_POINTS + n_holes; i++) {
    const int is_hole = i >= SCENE_POINTS;
    if (is_hole)
      mesh_text(&file, "0 0 0 0.5");
    else
      mesh_text(&file, "%.9g %.9g %.9g %.9g", scene_point(i, 0) - shift, scene_point(i, 1), scene_point(i, 2),
                scene_intensity(i) / 4096.0);
    if (is_said(d, "color"))
      mesh_text(&file, " %d %d %d", is_hole ? 0 : scene_point_code(i, 0), is_hole ? 0 : scene_point_code(i, 1),
                is_hole ? 0 : scene_point_code(i, 2));
    mesh_text(&file, "%s", nl);
  }
}

/* --- what comes out --- */

static void check_value(const conic_splats *points, const char *name, double (*value)(int i), double bound) {
  size_t k = 0;
  while (points->values && k < points->values->n && strcmp(points->values->field[k].name, name) != 0)
    k++;
  if (!points->values || k == points->values->n) {
    fprintf(stderr, "no value %s\n", name);
    check_failures++;
    return;
  }
  for (int i = 0; i < SCENE_POINTS; i++)
    CHECK_NEAR(points->values->value[k][i], value(i), bound);
}

static double class_of(int i) {
  return scene_class(i);
}
static double ptx_intensity(int i) {
  return scene_intensity(i) / 4096.0;
}

static void check_values(const char *d, const conic_splats *points) {
  const char *columns = word_of(d, "columns");
  const int is_las = strncmp(d, "las", 3) == 0, form = is_las ? las_form(d) : 0;
  if (is_las || is_said(d, "fields") || is_said(d, "names"))
    check_value(points, says(d, "names", "upper") ? "INTENSITY" : "intensity", scene_intensity, 0.0);
  if (is_las)
    check_value(points, "classification", class_of, 0.0);
  if ((is_las && (form == 1 || form > 2)) || is_said(d, "fields") || (columns && strstr(columns, "+t")))
    check_value(points, says(d, "names", "upper") ? "GPS_TIME" : "gps_time", scene_time, 1e-5);
  if (strncmp(d, "ptx", 3) == 0)
    check_value(points, "intensity", ptx_intensity, 1e-7);
}

static void check_dialect(const char *d) {
  static const dialect_format formats[] = {
      {"xyz", write_text}, {"pcd", write_pcd}, {"las", write_las}, {"ptx", write_ptx}};
  conic_read_options options;
  conic_model model;
  const size_t n_formats = sizeof formats / sizeof *formats, i_format = dialect_format_of(d, formats, n_formats);
  CHECK(i_format < n_formats);
  if (i_format == n_formats)
    return;
  const char *path = dialect_write(d, &formats[i_format], &file), *columns = word_of(d, "columns");
  conic_read_options_init(&options);
  options.keep = "all";
  CHECK_OK(conic_model_read(context, path, &options, &model));
  CHECK(unlink(path) == 0);
  CHECK(model.points.count == SCENE_POINTS);
  CHECK(model.n_unmeasured == (is_said(d, "unmeasured") ? 2 : is_said(d, "holes") ? 10 : 0));
  const int form = i_format == 2 ? las_form(d) : 0;
  const int has_color = (columns && strstr(columns, "rgb")) || is_said(d, "packed") || is_said(d, "packed-u") ||
                        is_said(d, "rgba") || is_said(d, "channels") || form == 2 || form == 3 || form == 5 ||
                        form == 7 || form == 8 || form == 10 || (i_format == 3 && is_said(d, "color"));
  const int has_normals = is_said(d, "normals") || (columns && strstr(columns, "+n"));
  CHECK((model.points.normal[0] != NULL) == has_normals && (model.points.color[0] != NULL) == has_color);
  for (size_t i = 0; i < model.points.count && model.points.count == SCENE_POINTS; i++) {
    const int expected[3] = {scene_point_code((int)i, 0), scene_point_code((int)i, 1), scene_point_code((int)i, 2)};
    for (int axis = 0; axis < 3; axis++)
      CHECK_NEAR(model.points.origin[axis] + (double)model.points.position[axis][i], scene_point((int)i, axis), 1e-6);
    for (int axis = 0; axis < 3 && has_normals && model.points.normal[0]; axis++)
      CHECK_NEAR((double)model.points.normal[axis][i], scene_point_normal((int)i, axis), 1e-6);
    if (has_color)
      check_color(&model.points, i, expected, 2e-5);
  }
  if (model.points.count == SCENE_POINTS)
    check_values(d, &model.points);
  conic_model_release(context, &model);
}

int main(void) {
  int n = 0;
  context = files_context();
  for (size_t i = 0; i < sizeof dialects / sizeof *dialects; i++)
    n += for_each_dialect(dialects[i], check_dialect);
  fprintf(stderr, "%d dialects of points\n", n);
  CHECK(n >= 177);
  files_end(context);
  return check_result();
}
