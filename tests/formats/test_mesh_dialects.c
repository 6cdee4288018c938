/* Meshes in every dialect of their formats: the same cube comes out of each. */
#include "tests/formats/dialects.h"

#include "conic/triangles.h"

static conic_context *context;
static mesh_file file;

/* A line for each dialect, or each set of them. */
static const char *const dialects[] = {
    "ply {ascii,le,be} at:{float,double,int,short} list:{uchar/int,uint8/uint32,int/int,uchar/ushort}",
    "ply {ascii,le,be} at:float color:{uchar,ushort,ushort/255,float,double,float/255,double/255,float-linear,int}",
    "ply {ascii,le} color:{uchar,float} names:{red,diffuse_red,r} alpha extra",
    "ply {ascii,be} normals color:uchar index:{vertex_indices,vertex_index} comment obj_info",
    "ply {ascii,le,be} facecolor:{uchar,ushort,ushort/255,float,float/255}",
    "ply {ascii,le,be} strips color:uchar",
    "ply ascii crlf color:{uchar,float} tri",
    "obj face:{v,v/t,v//n,v/t/n} {tri,quad} {positive,negative}",
    "obj face:v color:{float,double/255,float-linear} {lf,crlf}",
    "obj face:v/t/n {tabs,indented,continued,groups,weights,missing,zeros}",
    "off head:{OFF,COFF,CNOFF,NOFF,STOFF,4OFF,off} {lf,crlf}",
    "off head:{OFF,COFF} color:{double/255,float} {counts,apart,comments}",
    "off head:OFF facecolor:{double/255,float} {opaque,alpha}",
    "stl {lower,upper,capital} {lf,crlf,cr,oneline,long,unnamed}",
    "stl binary {plain,solid,trailing,magics,viscam}",
    "glb {ubyte,ushort,uint} color:{float,ubyte,ushort} parts:{3,4}",
    "glb at:{float,short,byte} ushort",
};

/* --- writers --- */

static const char *encoding_of(const char *d) {
  return is_said(d, "le") ? "le" : is_said(d, "be") ? "be" : "ascii";
}

static const char *end_of_line(const char *d) {
  return is_said(d, "crlf") ? "\r\n" : is_said(d, "cr") ? "\r" : is_said(d, "oneline") ? " " : "\n";
}

static void end_row(const char *d) {
  if (strcmp(encoding_of(d), "ascii") == 0)
    mesh_text(&file, "%s", end_of_line(d));
}

static void put_channels(const char *d, const char *color, const int code[3]) {
  for (int channel = 0; channel < 3; channel++)
    put_number(&file, encoding_of(d), color, color_value(color, code[channel]));
}

static void ply_color_names(const char *d, const char *color, const char *names) {
  const char *prefix = strcmp(names, "diffuse_red") == 0 ? "diffuse_" : "", *nl = end_of_line(d);
  for (int i = 0; i < 3; i++)
    mesh_text(&file, "property %.*s %s%s%s", (int)strcspn(color, "/-"), color, prefix,
              strcmp(names, "r") == 0 ? &"r\0g\0b"[2 * i]
              : i == 0                ? "red"
              : i == 1                ? "green"
                                      : "blue",
              nl);
}

/* A face's list of indices, or that of a strip of two triangles. */
static void ply_list(const char *d, const char *counts, const char *items, const int *corners, int n) {
  put_number(&file, encoding_of(d), counts, n);
  for (int i = 0; i < n; i++)
    put_number(&file, encoding_of(d), items, corners[i]);
}

static void write_ply(const char *d) {
  const char *at = word_of(d, "at"), *color = word_of(d, "color"), *of_faces = word_of(d, "facecolor");
  const char *nl = end_of_line(d), *names = is_said(d, "names") ? word_of(d, "names") : "red";
  char list[64] = "uchar/int";
  if (is_said(d, "list"))
    snprintf(list, sizeof list, "%s", word_of(d, "list"));
  char *items = strchr(list, '/');
  *items++ = 0;
  at = at ? at : "float";
  mesh_text(&file, "ply%sformat %s 1.0%s", nl,
            is_said(d, "le")   ? "binary_little_endian"
            : is_said(d, "be") ? "binary_big_endian"
                               : "ascii",
            nl);
  if (is_said(d, "comment"))
    mesh_text(&file, "comment made by hand, not conic%sobj_info none%s", nl, nl);
  mesh_text(&file, "element vertex %d%s", SCENE_CORNERS, nl);
  for (int axis = 0; axis < 3; axis++)
    mesh_text(&file, "property %s %c%s", at, "xyz"[axis], nl);
  for (int axis = 0; axis < 3 && is_said(d, "normals"); axis++)
    mesh_text(&file, "property float n%c%s", "xyz"[axis], nl);
  if (color)
    ply_color_names(d, color, names);
  if (is_said(d, "alpha"))
    mesh_text(&file, "property uchar alpha%s", nl);
  if (is_said(d, "extra"))
    mesh_text(&file, "property double quality%s", nl);
  if (is_said(d, "strips"))
    mesh_text(&file, "element tristrips 1%sproperty list int int vertex_indices%s", nl, nl);
  else
    mesh_text(&file, "element face %d%sproperty list %s %s %s%s", is_said(d, "tri") ? 2 * SCENE_FACES : SCENE_FACES, nl,
              list, items, is_said(d, "index") ? word_of(d, "index") : "vertex_indices", nl);
  if (of_faces)
    ply_color_names(d, of_faces, "red");
  mesh_text(&file, "end_header%s", nl);
  for (int i = 0; i < SCENE_CORNERS; i++) {
    for (int axis = 0; axis < 3; axis++)
      put_number(&file, encoding_of(d), at, scene_corner(i, axis));
    for (int axis = 0; axis < 3 && is_said(d, "normals"); axis++)
      put_number(&file, encoding_of(d), "float", scene_normal(i, axis));
    if (color)
      put_channels(d, color, scene_codes[i]);
    if (is_said(d, "alpha"))
      put_number(&file, encoding_of(d), "uchar", 255);
    if (is_said(d, "extra"))
      put_number(&file, encoding_of(d), "double", 0.5 * i);
    end_row(d);
  }
  if (is_said(d, "strips")) {
    int strip[5 * SCENE_FACES], n = 0;
    for (int i = 0; i < SCENE_FACES; i++) {
      const int *q = scene_quads[i], order[5] = {q[0], q[1], q[3], q[2], -1};
      for (int k = 0; k < 5; k++)
        strip[n++] = order[k];
    }
    ply_list(d, "int", "int", strip, n);
    end_row(d);
    return;
  }
  for (int i = 0; i < SCENE_FACES; i++) {
    const int *q = scene_quads[i], first[3] = {q[0], q[1], q[2]}, second[3] = {q[0], q[2], q[3]};
    ply_list(d, list, items, is_said(d, "tri") ? first : q, is_said(d, "tri") ? 3 : 4);
    if (of_faces)
      put_channels(d, of_faces, scene_codes[i]);
    end_row(d);
    if (is_said(d, "tri"))
      ply_list(d, list, items, second, 3);
    if (is_said(d, "tri"))
      end_row(d);
  }
}

static void obj_corner(const char *d, int i) {
  const char *face = word_of(d, "face");
  const int index = is_said(d, "negative") ? i - SCENE_CORNERS : i + 1;
  if (is_said(d, "zeros") && i == 0)
    mesh_text(&file, " %d/0/0", index);
  else if (strcmp(face, "v") == 0)
    mesh_text(&file, " %d", index);
  else if (strcmp(face, "v/t") == 0)
    mesh_text(&file, " %d/%d", index, index);
  else if (strcmp(face, "v//n") == 0)
    mesh_text(&file, " %d//%d", index, index);
  else
    mesh_text(&file, " %d/%d/%d", index, is_said(d, "missing") ? index + 70 : index, index);
}

static void obj_face(const char *d, const int *corners, int n) {
  mesh_text(&file, "%sf", is_said(d, "indented") ? "  " : "");
  for (int i = 0; i < n; i++) {
    obj_corner(d, corners[i]);
    if (is_said(d, "continued") && i == 1)
      mesh_text(&file, " \\%s", end_of_line(d));
  }
  mesh_text(&file, "%s", end_of_line(d));
}

static void write_obj(const char *d) {
  const char *color = word_of(d, "color"), *nl = end_of_line(d), *gap = is_said(d, "tabs") ? "\t" : " ";
  mesh_text(&file, "# by hand%smtllib%s", nl, nl);
  for (int i = 0; i < SCENE_CORNERS; i++) {
    mesh_text(&file, "v%s%g%s%g%s%g", gap, scene_corner(i, 0), gap, scene_corner(i, 1), gap, scene_corner(i, 2));
    for (int channel = 0; channel < 3 && color; channel++)
      mesh_text(&file, " %.9g", color_value(color, scene_codes[i][channel]));
    mesh_text(&file, "%s%s", is_said(d, "weights") ? " 1.0" : "", nl);
  }
  for (int i = 0; i < SCENE_CORNERS; i++)
    mesh_text(&file, "vn %.9g %.9g %.9g%svt %g %g%s", scene_normal(i, 0), scene_normal(i, 1), scene_normal(i, 2), nl,
              (i & 1) * 1.0, (i >> 1 & 1) * 1.0, nl);
  for (int i = 0; i < SCENE_FACES; i++) {
    const int *q = scene_quads[i], first[3] = {q[0], q[1], q[2]}, second[3] = {q[0], q[2], q[3]};
    if (is_said(d, "groups"))
      mesh_text(&file, "g side %d%ss %d%so part%susemtl%s", i, nl, i, nl, nl, nl);
    obj_face(d, is_said(d, "tri") ? first : q, is_said(d, "tri") ? 3 : 4);
    if (is_said(d, "tri"))
      obj_face(d, second, 3);
  }
}

static void write_off(const char *d) {
  const char *head = word_of(d, "head"), *color = word_of(d, "color"), *of_faces = word_of(d, "facecolor");
  const char *nl = end_of_line(d);
  if (is_said(d, "comments"))
    mesh_text(&file, "# by hand%s%s", nl, nl);
  mesh_text(&file, "%s%s%d %d 0%s", head, is_said(d, "counts") ? " " : nl, SCENE_CORNERS, SCENE_FACES, nl);
  if (is_said(d, "apart"))
    mesh_text(&file, "%s# corners%s", nl, nl);
  for (int i = 0; i < SCENE_CORNERS; i++) {
    const double w = strchr(head, '4') ? 2.0 : 1.0;
    mesh_text(&file, "%g %g %g", w * scene_corner(i, 0), w * scene_corner(i, 1), w * scene_corner(i, 2));
    if (strchr(head, '4'))
      mesh_text(&file, " 2");
    for (int axis = 0; axis < 3 && strchr(head, 'N'); axis++)
      mesh_text(&file, " %.9g", scene_normal(i, axis));
    for (int channel = 0; channel < 3 && (color || strchr(head, 'C')); channel++)
      mesh_text(&file, " %.9g", color_value(color ? color : "uchar", scene_codes[i][channel]));
    if (color || strchr(head, 'C'))
      mesh_text(&file, color && white_of(color) < 2.0 ? " 1" : " 255");
    mesh_text(&file, "%s%s", strchr(head, 'S') ? " 0 1" : "", nl);
  }
  for (int i = 0; i < SCENE_FACES; i++) {
    mesh_text(&file, "4 %d %d %d %d", scene_quads[i][0], scene_quads[i][1], scene_quads[i][2], scene_quads[i][3]);
    for (int channel = 0; channel < 3 && of_faces; channel++)
      mesh_text(&file, " %.9g", color_value(of_faces, scene_codes[i][channel]));
    mesh_text(&file, "%s%s", is_said(d, "alpha") ? (white_of(of_faces) < 2.0 ? " 1" : " 255") : "", nl);
  }
}

/* "facet" and the like, in the dialect's letters. */
static void stl_word(const char *d, const char *word) {
  for (size_t i = 0; word[i]; i++) {
    int is_upper = is_said(d, "upper") || (is_said(d, "capital") && (i == 0 || word[i - 1] == ' '));
    mesh_put(&file, &(char){(char)(is_upper && word[i] >= 'a' ? word[i] - 'a' + 'A' : word[i])}, 1);
  }
}

static void stl_line(const char *d, const char *words) {
  stl_word(d, words);
  mesh_text(&file, "%s", end_of_line(d));
}

static void stl_facet(const char *d, const int corners[3]) {
  if (is_said(d, "binary")) {
    unsigned attribute = is_said(d, "magics")   ? 12 | 18 << 5 | 24 << 10
                         : is_said(d, "viscam") ? 1u << 15 | 12 << 10 | 18 << 5 | 24
                                                : 0;
    for (int i = 0; i < 12; i++)
      put_number(&file, "le", "float", i < 3 ? 0.0 : scene_corner(corners[i / 3 - 1], i % 3));
    put_number(&file, "le", "ushort", attribute);
    return;
  }
  stl_line(d, "facet normal 0 0 0");
  stl_line(d, " outer loop");
  for (int i = 0; i < 3; i++) {
    stl_word(d, "  vertex");
    mesh_text(&file, " %g %g %.3e%s", scene_corner(corners[i], 0), scene_corner(corners[i], 1),
              scene_corner(corners[i], 2), end_of_line(d));
  }
  stl_line(d, " endloop");
  stl_line(d, "endfacet");
}

static void write_stl(const char *d) {
  if (is_said(d, "binary")) {
    char head[80] = "";
    snprintf(head, sizeof head, "%s",
             is_said(d, "solid")    ? "solid but binary"
             : is_said(d, "magics") ? "COLOR=abcd"
                                    : "");
    mesh_put(&file, head, sizeof head);
    put_number(&file, "le", "uint", 2 * SCENE_FACES);
  } else {
    stl_word(d, is_said(d, "unnamed") ? "solid" : "solid of a vertex");
    for (int i = 0; i < 900 && is_said(d, "long"); i++)
      mesh_text(&file, " name");
    mesh_text(&file, "%s", end_of_line(d));
  }
  for (int i = 0; i < SCENE_FACES; i++) {
    const int *q = scene_quads[i], first[3] = {q[0], q[1], q[2]}, second[3] = {q[0], q[2], q[3]};
    stl_facet(d, first);
    stl_facet(d, second);
  }
  if (is_said(d, "trailing"))
    mesh_text(&file, "and more");
  if (!is_said(d, "binary"))
    stl_line(d, is_said(d, "unnamed") ? "endsolid" : "endsolid of a vertex");
}

/* The number of glTF's type of components. */
static int gltf_type(const char *type) {
  static const char *const names[] = {"byte", "ubyte", "short", "ushort", "", "uint", "float"};
  for (int i = 0; i < 7; i++)
    if (strcmp(names[i], type) == 0)
      return 5120 + i;
  return 0;
}

static const char *gltf_number(const char *type) {
  return strcmp(type, "ubyte") == 0 ? "uchar" : strcmp(type, "byte") == 0 ? "char" : type;
}

/* Places, colours and indices one after the other; every element begins at a multiple of 4 bytes. */
static void write_glb(const char *d) {
  static mesh_file json, binary;
  const char *color = word_of(d, "color"), *at = is_said(d, "at") ? word_of(d, "at") : "float";
  const char *index = is_said(d, "uint") ? "uint" : is_said(d, "ushort") ? "ushort" : "ubyte";
  const int n_parts = says(d, "parts", "4") ? 4 : 3;
  const double white = !color || strcmp(color, "float") == 0 ? 1.0 : strcmp(color, "ubyte") == 0 ? 255.0 : 65535.0;
  size_t begins[4] = {0}, n_views = 0;
  json.n = binary.n = 0;
  for (int i = 0; i < SCENE_CORNERS; i++) {
    for (int axis = 0; axis < 3; axis++)
      put_number(&binary, "le", gltf_number(at), scene_corner(i, axis));
    while (binary.n % 4)
      mesh_put(&binary, "", 1);
  }
  const size_t stride = binary.n / SCENE_CORNERS;
  begins[++n_views] = binary.n;
  for (int i = 0; i < SCENE_CORNERS && color; i++) {
    for (int k = 0; k < n_parts; k++)
      put_number(&binary, "le", gltf_number(color),
                 white * (k < 3 ? conic_srgb_decode(scene_codes[i][k] / 255.0) : 1.0));
    while (binary.n % 4)
      mesh_put(&binary, "", 1);
  }
  const size_t color_stride = (binary.n - begins[1]) / SCENE_CORNERS;
  begins[++n_views] = binary.n;
  for (int i = 0; i < SCENE_FACES; i++)
    for (int k = 0; k < 6; k++)
      put_number(&binary, "le", gltf_number(index), scene_quads[i][(const int[]){0, 1, 2, 0, 2, 3}[k]]);
  begins[++n_views] = binary.n;
  while (binary.n % 4)
    mesh_put(&binary, "", 1);
  mesh_text(&json,
            "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
            "\"extensionsUsed\":[\"KHR_mesh_quantization\"],"
            "\"meshes\":[{\"primitives\":[{\"indices\":1,\"attributes\":{\"POSITION\":0%s}}]}],"
            "\"buffers\":[{\"byteLength\":%zu}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu,\"byteStride\":%zu},"
            "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}",
            color ? ",\"COLOR_0\":2" : "", binary.n, begins[1], stride, begins[2], begins[3] - begins[2]);
  if (color)
    mesh_text(&json, ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,\"byteStride\":%zu}", begins[1],
              begins[2] - begins[1], color_stride);
  mesh_text(&json,
            "],\"accessors\":[{\"bufferView\":0,\"componentType\":%d,\"count\":%d,\"type\":\"VEC3\",\"min\":[-2,-2,-2],"
            "\"max\":[3,3,3]},{\"bufferView\":1,\"componentType\":%d,\"count\":%d,\"type\":\"SCALAR\"}",
            gltf_type(at), SCENE_CORNERS, gltf_type(index), 6 * SCENE_FACES);
  if (color)
    mesh_text(&json, ",{\"bufferView\":2,\"componentType\":%d,\"count\":%d,\"type\":\"VEC%d\",\"normalized\":%s}",
              gltf_type(color), SCENE_CORNERS, n_parts, white > 1.0 ? "true" : "false");
  mesh_text(&json, "]}");
  while (json.n % 4)
    mesh_put(&json, " ", 1);
  mesh_put(&file, "glTF", 4);
  mesh_number(&file, 2, 4);
  mesh_number(&file, (uint32_t)(28 + json.n + binary.n), 4);
  mesh_number(&file, (uint32_t)json.n, 4);
  mesh_put(&file, "JSON", 4);
  mesh_put(&file, json.bytes, json.n);
  mesh_number(&file, (uint32_t)binary.n, 4);
  mesh_put(&file, "BIN\0", 4);
  mesh_put(&file, binary.bytes, binary.n);
}

/* --- what comes out --- */

/* The scene's corner of a vertex; -1: it is none. */
static int corner_of(const conic_splats *points, size_t i) {
  int corner = 0;
  for (int axis = 0; axis < 3; axis++) {
    double place = points->origin[axis] + (double)points->position[axis][i];
    CHECK(place == 3.0 || place == -2.0);
    corner |= (place == 3.0) << axis;
  }
  return corner;
}

/* Every triangle is half of a face, and turns as it does. */
static void check_faces(const conic_model *model) {
  int n_of[SCENE_FACES] = {0};
  for (size_t t = 0; t < model->n_triangles; t++) {
    int corner[3], n_found = 0;
    for (int k = 0; k < 3; k++)
      corner[k] = corner_of(&model->points, model->triangles[t][k]);
    for (int i = 0; i < SCENE_FACES; i++) {
      int at[3] = {-1, -1, -1}, n_turns = 0;
      for (int k = 0; k < 12; k++)
        if (scene_quads[i][k % 4] == corner[k / 4])
          at[k / 4] = k % 4;
      if (at[0] < 0 || at[1] < 0 || at[2] < 0)
        continue;
      for (int k = 0; k < 3; k++)
        n_turns += (at[(k + 1) % 3] - at[k] + 4) % 4;
      CHECK(n_turns == 4);
      n_of[i]++;
      n_found++;
    }
    CHECK(n_found == 1);
  }
  for (int i = 0; i < SCENE_FACES; i++)
    CHECK(n_of[i] == 2);
}

static void check_face_colors(const char *path) {
  conic_triangles triangles;
  CHECK_OK(conic_triangles_read(context, path, &triangles));
  for (size_t t = 0; t < triangles.count && triangles.material; t++)
    for (int channel = 0; channel < 3; channel++)
      CHECK_NEAR((double)triangles.materials[triangles.material[t]].color[channel],
                 conic_srgb_decode(scene_codes[t / 2][channel] / 255.0), 1e-6);
  CHECK(triangles.material != NULL);
  conic_triangles_release(context, &triangles);
}

static void check_dialect(const char *d) {
  static const dialect_format formats[] = {
      {"ply", write_ply}, {"obj", write_obj}, {"off", write_off}, {"stl", write_stl}, {"glb", write_glb}};
  static const int five_bits[3] = {99, 148, 197};
  conic_read_options options;
  conic_model model;
  const size_t n_formats = sizeof formats / sizeof *formats, i_format = dialect_format_of(d, formats, n_formats);
  CHECK(i_format < n_formats);
  if (i_format == n_formats)
    return;
  const char *path = dialect_write(d, &formats[i_format], &file);
  conic_read_options_init(&options);
  if (is_said(d, "color") && strstr(word_of(d, "color"), "linear"))
    options.colors_are = CONIC_COLORS_LINEAR;
  CHECK_OK(conic_model_read(context, path, &options, &model));
  CHECK(model.points.count == SCENE_CORNERS && model.n_triangles == 2 * SCENE_FACES);
  const int has_head_colors = is_said(d, "head") && strchr(word_of(d, "head"), 'C');
  const double bound = is_said(d, "color") && says(d, "color", "ubyte") ? 1.0 / 500.0 : 2e-5;
  for (size_t i = 0; i < model.points.count; i++) {
    const int corner = corner_of(&model.points, i);
    if (is_said(d, "color") || has_head_colors)
      check_color(&model.points, i, scene_codes[corner], bound);
    if (is_said(d, "magics") || is_said(d, "viscam"))
      check_color(&model.points, i, five_bits, 4e-3);
    for (int axis = 0; axis < 3 && model.points.normal[0] && corner > 0; axis++)
      CHECK_NEAR((double)model.points.normal[axis][i], scene_normal(corner, axis), 1e-6);
  }
  if (is_said(d, "normals") || (is_said(d, "head") && strchr(word_of(d, "head"), 'N')))
    CHECK(model.points.normal[0] != NULL);
  if (check_failures == 0)
    check_faces(&model);
  conic_model_release(context, &model);
  if (is_said(d, "facecolor"))
    check_face_colors(path);
  CHECK(unlink(path) == 0);
}

int main(void) {
  int n = 0;
  context = files_context();
  for (size_t i = 0; i < sizeof dialects / sizeof *dialects; i++)
    n += for_each_dialect(dialects[i], check_dialect);
  fprintf(stderr, "%d dialects of meshes\n", n);
  CHECK(n >= 214);
  files_end(context);
  return check_result();
}
