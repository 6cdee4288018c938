/* From files to triangles: corners' normals and texture coordinates, materials, strips; sets that are joined. */
#include "core/base/byte_order.h"
#include "tests/support/files.h"

static conic_context *context;

static conic_triangles read_text(const char *text, conic_status expected) {
  conic_triangles t;
  const char *path = files_write("a.obj", text);
  CHECK(conic_triangles_read(context, path, &t) == expected);
  CHECK(unlink(path) == 0);
  if (expected == CONIC_OK)
    CHECK_OK(conic_triangles_check(context, &t, "a.obj"));
  else
    CHECK(t.count == 0 && !t.position[0] && !t.corners);
  return t;
}

static float normal_of(const conic_triangles *t, size_t i, int k, int axis) {
  return t->normal[axis][t->normal_corners ? t->normal_corners[i][k] : t->corners[i][k]];
}

static float coordinate_of(const conic_triangles *t, size_t i, int k, int axis) {
  return t->texture_coordinate[axis][t->texture_corners ? t->texture_corners[i][k] : t->corners[i][k]];
}

static void test_corners(void) {
  conic_triangles t = read_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.25 0.5\nvt 0.75 1\nvn 0 0 2\nvn 0 1 0\n"
                                "f 1/1/1 2/2/1 3/1/2 4/2/2\nf 1 2 3\nf 1/-1 3//-2 4\n",
                                CONIC_OK);
  CHECK(t.count == 4 && t.n_vertices == 4 && t.n_materials == 0);
  CHECK(t.corners[1][0] == 0 && t.corners[1][1] == 2 && t.corners[1][2] == 3);
  CHECK(normal_of(&t, 0, 0, 2) == 2.0f && normal_of(&t, 0, 2, 1) == 1.0f && normal_of(&t, 1, 2, 1) == 1.0f);
  CHECK(coordinate_of(&t, 0, 0, 0) == 0.25f && coordinate_of(&t, 0, 1, 0) == 0.75f &&
        coordinate_of(&t, 1, 2, 1) == 1.0f);
  for (int k = 0; k < 3; k++) /* corners that name nothing */
    for (int axis = 0; axis < 3; axis++)
      CHECK(normal_of(&t, 2, k, axis) == 0.0f);
  CHECK(normal_of(&t, 3, 1, 2) == 2.0f && coordinate_of(&t, 3, 0, 0) == 0.75f && coordinate_of(&t, 3, 1, 0) == 0.0f);
  conic_triangles_release(context, &t);
  t = read_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", CONIC_OK);
  CHECK(!t.normal[0] && !t.texture_coordinate[0] && !t.color[0]);
  conic_triangles_release(context, &t);
}

static void test_refused(void) {
  read_text("v 0 0 0\nv 1 0 0\nv 1 1 0\n", CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "no faces"));
  read_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 4\n", CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "line 4"));
  files_message[0] = 0;
}

/* A material file with a colour and a picture, in the format that every build reads. */
static void test_materials(void) {
  char pfm[64 + 2 * 2 * 12];
  const float texels[12] = {0, 0, 0, 1, 1, 1, 0.5f, 0.25f, 0.125f, 1, 0, 0};
  int n = snprintf(pfm, sizeof pfm, "PF\n2 2\n-1.0\n");
  for (int i = 0; i < 12; i++)
    conic_store_float(pfm + n + 4 * i, texels[i]);
  char picture[160], library[160];
  snprintf(picture, sizeof picture, "%s", files_write_bytes("t.pfm", pfm, (size_t)n + sizeof texels));
  snprintf(library, sizeof library, "%s",
           files_write("m.mtl",
                       "# both\nnewmtl other\nKd 9 9 9\nnewmtl red\nKd 0.5 0.25 0\nmap_Kd -clamp on -s 1 1 1 t.pfm\n"
                       "newmtl plain\nNs 3\nmap_Kd gone.png\n"));
  conic_triangles t =
      read_text("mtllib m.mtl gone.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1 2 3\nusemtl red\nf 1 2 3\n"
                "usemtl plain\nf 1/1 2/1 3/1\nusemtl red\nf 3 2 1\n",
                CONIC_OK);
  CHECK(t.n_materials == 3 && t.count == 4);
  CHECK(t.material[0] == 0 && t.material[1] == 1 && t.material[2] == 2 && t.material[3] == 1);
  CHECK(t.materials[0].color[0] == 1.0f && t.materials[1].color[0] == 0.5f && t.materials[1].color[2] == 0.0f);
  CHECK(t.materials[2].color[1] == 1.0f && !t.materials[2].texture && !t.materials[0].texture);
  CHECK(t.materials[1].texture && conic_texture_width(t.materials[1].texture) == 2);
  conic_triangles_release(context, &t);
  CHECK(unlink(library) == 0);
  snprintf(library, sizeof library, "%s", files_write("m.mtl", "newmtl red\nKd 0.5 x 0\n"));
  read_text("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl red\nf 1 2 3\n", CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "m.mtl") && strstr(files_message, "line 2"));
  files_message[0] = 0;
  CHECK(unlink(library) == 0 && unlink(picture) == 0);
}

/* d and Tr; a map_d before the map_Kd whose alpha it is, and one by itself. */
static void test_alpha(void) {
  static const float texels[12] = {0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1}, whole[2] = {1, 0}, high[2] = {0, 1};
  char pfm[64 + sizeof texels], picture[160], library[160];
  int n = snprintf(pfm, sizeof pfm, "PF\n2 2\n-1.0\n");
  for (int i = 0; i < 12; i++)
    conic_store_float(pfm + n + 4 * i, texels[i]);
  snprintf(picture, sizeof picture, "%s", files_write_bytes("t.pfm", pfm, (size_t)n + sizeof texels));
  snprintf(library, sizeof library, "%s",
           files_write("m.mtl", "newmtl a\nd 0.25\nnewmtl b\nTr 0.25\nmap_d t.pfm\nmap_Kd t.pfm\nnewmtl c\n"
                                "d -halo 0.5\nmap_d t.pfm\n"));
  conic_triangles t = read_text("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n"
                                "usemtl b\nf 1/1 2/1 3/1\nusemtl c\nf 1/1 2/1 3/1\n",
                                CONIC_OK);
  CHECK(t.n_materials == 4 && t.materials[0].transparency == 0.0f && t.materials[1].transparency == 0.75f);
  CHECK(t.materials[2].transparency == 0.25f && t.materials[3].transparency == 0.0f);
  for (int i = 2; i < 4 && t.n_materials == 4; i++) {
    const float uv[2] = {0.5f, 0.5f};
    float rgba[4];
    CHECK(t.materials[i].texture && conic_texture_has_alpha(t.materials[i].texture));
    conic_texture_sample_rgba(t.materials[i].texture, uv, whole, high, rgba);
    CHECK(rgba[3] > 0.5f && rgba[3] < 0.95f);
    CHECK_NEAR((double)rgba[0], 1.0, 1e-6); /* nothing of the black that is not there */
  }
  conic_triangles_release(context, &t);
  CHECK(unlink(library) == 0 && unlink(picture) == 0);
}

#define PLY_VERTICES                                                                                                   \
  "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float %s\nproperty double %s\n"
#define PLY_FACES "element face 3\n%sproperty list uchar int vertex_indices\n%sproperty uchar flags\n"

static conic_triangles read_ply(const char *header, const char *body, conic_status expected) {
  conic_triangles t;
  char text[2000];
  snprintf(text, sizeof text, "ply\nformat ascii 1.0\n%send_header\n%s", header, body);
  const char *path = files_write("a.ply", text);
  CHECK(conic_triangles_read(context, path, &t) == expected);
  CHECK(unlink(path) == 0);
  if (expected == CONIC_OK)
    CHECK_OK(conic_triangles_check(context, &t, "a.ply"));
  else
    CHECK(t.count == 0 && !t.texture_coordinate[0]);
  return t;
}

/* Coordinates of the vertices, by each of the names; half a pair is none. */
static void test_ply_vertices(void) {
  static const char *const names[5][2] = {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"v", "u"}, {"s", "v"}};
  for (int i = 0; i < 5; i++) {
    char header[600];
    snprintf(header, sizeof header, PLY_VERTICES PLY_FACES, names[i][0], names[i][1], "", "");
    conic_triangles t = read_ply(header,
                                 "0 0 0 0.25 0.5\n1 0 0 0.75 0.125\n1 1 0 nan 1\n0 1 0 -3 2\n"
                                 "4 0 1 2 3 0\n3 3 2 1 0\n2 0 1 0\n",
                                 CONIC_OK);
    CHECK(t.count == 3 && !t.texture_corners && t.n_materials == 0);
    CHECK((t.texture_coordinate[0] != NULL) == (i < 4));
    if (i < 4) {
      CHECK(coordinate_of(&t, 0, 1, i == 3) == 0.75f && coordinate_of(&t, 0, 1, i != 3) == 0.125f);
      CHECK(coordinate_of(&t, 1, 2, i == 3) == -3.0f && coordinate_of(&t, 2, 0, i != 3) == 2.0f);
    }
    conic_triangles_release(context, &t);
  }
}

/* Coordinates of the faces' corners, before and behind their vertices, with the vertices' where a face has none. */
static void test_ply_corners(void) {
  static const char list[] = "property list uchar float texcoord\n";
  char header[600];
  snprintf(header, sizeof header, PLY_VERTICES PLY_FACES, "u", "v", "", list);
  conic_triangles t = read_ply(header,
                               "0 0 0 0.25 0.5\n1 0 0 0.75 0.125\n1 1 0 0 1\n0 1 0 -3 2\n"
                               "4 0 1 2 3 8 10 11 12 13 14 15 16 17 0\n3 3 2 1 0 0\n3 0 1 2 6 1 2 3 4 5 6 0\n",
                               CONIC_OK);
  CHECK(t.count == 4 && t.texture_corners);
  CHECK(coordinate_of(&t, 0, 0, 0) == 10.0f && coordinate_of(&t, 0, 2, 1) == 15.0f);
  CHECK(coordinate_of(&t, 1, 0, 1) == 11.0f && coordinate_of(&t, 1, 1, 0) == 14.0f &&
        coordinate_of(&t, 1, 2, 1) == 17.0f);
  CHECK(coordinate_of(&t, 2, 0, 0) == -3.0f && coordinate_of(&t, 2, 2, 1) == 0.125f);
  CHECK(coordinate_of(&t, 3, 0, 0) == 1.0f && coordinate_of(&t, 3, 2, 1) == 6.0f);
  conic_triangles_release(context, &t);

  /* Faces before vertices, lists before indices; vertices without. */
  snprintf(header, sizeof header, PLY_FACES PLY_VERTICES, list, "", "a", "b");
  t = read_ply(header,
               "6 1 2 3 4 5 6 3 0 1 2 0\n0 3 1 2 3 0\n8 10 11 12 13 14 15 16 17 4 0 1 2 3 0\n"
               "0 0 0 9 9\n1 0 0 9 9\n1 1 0 9 9\n0 1 0 9 9\n",
               CONIC_OK);
  CHECK(t.count == 4 && coordinate_of(&t, 0, 1, 1) == 4.0f && coordinate_of(&t, 1, 1, 1) == 0.0f);
  CHECK(coordinate_of(&t, 3, 2, 0) == 16.0f && coordinate_of(&t, 3, 1, 1) == 15.0f);
  conic_triangles_release(context, &t);

  /* The same with vertices that have coordinates, for lists that lie on no triangle. */
  snprintf(header, sizeof header, PLY_FACES PLY_VERTICES, list, "", "s", "t");
  t = read_ply(header,
               "4 1 2 3 4 2 0 1 0\n0 3 1 2 3 0\n0 3 0 1 2 0\n"
               "0 0 0 9 1\n1 0 0 9 2\n1 1 0 9 3\n0 1 0 9 4\n",
               CONIC_OK);
  CHECK(t.count == 2 && coordinate_of(&t, 0, 2, 1) == 4.0f && coordinate_of(&t, 1, 0, 1) == 1.0f);
  conic_triangles_release(context, &t);

  read_ply(header,
           "8 1 2 3 4 5 6 7 8 3 0 1 2 0\n0 3 1 2 3 0\n0 3 0 1 2 0\n0 0 0 9 1\n1 0 0 9 2\n1 1 0 9 3\n0 1 0 9 4\n",
           CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "two a corner") && strstr(files_message, "(line 14)"));
  read_ply(header, "200 1 2 3\n", CONIC_ERROR_INPUT);
  files_message[0] = 0;
}

/* Pictures by comments, and by the faces' numbers of them. */
static void test_ply_pictures(void) {
  char pfm[64 + 4 * 12], picture[160], header[900];
  const float texels[12] = {0, 0, 0, 1, 1, 1, 0.5f, 0.25f, 0.125f, 1, 0, 0};
  int n = snprintf(pfm, sizeof pfm, "PF\n2 2\n-1.0\n");
  for (int i = 0; i < 12; i++)
    conic_store_float(pfm + n + 4 * i, texels[i]);
  snprintf(picture, sizeof picture, "%s", files_write_bytes("a b.pfm", pfm, (size_t)n + sizeof texels));
  static const char body[] = "0 0 0 0.25 0.5\n1 0 0 0.75 0.125\n1 1 0 0 1\n0 1 0 -3 2\n"
                             "4 0 1 2 3 1 0\n3 3 2 1 7 0\n3 0 1 2 0 0\n";
  snprintf(header, sizeof header,
           "comment TextureFile   gone.pfm \r\ncomment TextureFiles x\ncomment\n" PLY_VERTICES PLY_FACES
           "comment TextureFile\ta b.pfm\n",
           "u", "v", "", "property int texnumber\n");
  conic_triangles t = read_ply(header, body, CONIC_OK);
  CHECK(t.n_materials == 3 && t.material[0] == 1 && t.material[1] == 1 && t.material[2] == 2 && t.material[3] == 0);
  CHECK(!t.materials[0].texture && t.materials[1].texture && !t.materials[2].texture);
  CHECK(t.materials[1].color[2] == 1.0f && conic_texture_height(t.materials[1].texture) == 2);
  conic_triangles_release(context, &t);

  snprintf(header, sizeof header, "comment TextureFile a b.pfm\n" PLY_VERTICES PLY_FACES, "u", "v", "",
           "property int texnumber\n");
  t = read_ply(header, body, CONIC_OK);
  CHECK(t.n_materials == 1 && !t.material && t.materials[0].texture);
  conic_triangles_release(context, &t);
  snprintf(header, sizeof header, "comment TextureFile gone.pfm\n" PLY_VERTICES PLY_FACES, "a", "b", "",
           "property int texnumber\n");
  t = read_ply(header, body, CONIC_OK); /* nothing to lay it on */
  CHECK(t.n_materials == 0);
  conic_triangles_release(context, &t);
  read_ply("comment TextureFile \n", "", CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "without a name (line 3)"));
  CHECK(unlink(picture) == 0);
  files_message[0] = 0;
}

static void test_strip(void) {
  conic_triangles t;
  const char *path =
      files_write("a.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                           "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar "
                           "blue\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                           "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n1 1 0 255 255 255\n2 1 0 0 0 0\n"
                           "9 0 1 2 3 -1 2 3 4 4\n");
  CHECK_OK(conic_triangles_read(context, path, &t));
  CHECK(unlink(path) == 0);
  CHECK(t.count == 3 && t.corners[1][0] == 2 && t.corners[1][1] == 1 && t.corners[2][2] == 4);
  CHECK(t.color[0][0] == 1.0f && t.color[1][0] == 0.0f && t.color[2][2] == 1.0f);
  conic_triangles_release(context, &t);
}

/* Two sets of different attributes: each keeps what it has, and gets what absence means. */
static void test_append(void) {
  conic_triangles a = read_text("v 70000 0 0\nv 70001 0 0\nv 70001 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n", CONIC_OK);
  conic_triangles b =
      read_text("v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nvt 0.5 0.25\nusemtl x\nf 3/1 2/1 1/1\n", CONIC_OK);
  CHECK_OK(conic_triangles_append(context, &a, &b));
  CHECK_OK(conic_triangles_check(context, &a, "joined"));
  CHECK(a.count == 2 && a.n_vertices == 6 && a.corners[1][0] == 5 && a.corners[1][2] == 3);
  CHECK(a.origin[0] == 70000.0 && a.position[0][3] == -70000.0f && a.position[0][1] == 1.0f);
  CHECK(a.color[1][0] == 1.0f && a.color[1][4] == 0.0f);
  CHECK(normal_of(&a, 0, 1, 2) == 1.0f && normal_of(&a, 1, 1, 2) == 0.0f);
  CHECK(coordinate_of(&a, 1, 0, 1) == 0.25f && coordinate_of(&a, 0, 0, 0) == 0.0f);
  CHECK(a.n_materials == 3 && a.material[0] == 0 && a.material[1] == 2);
  conic_triangles_release(context, &a);
  conic_triangles_release(context, &b);
}

static void test_smooth(void) {
  conic_triangles t = read_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 2\nv 9 9 9\nf 1 2 3\nf 1 3 4\n", CONIC_OK);
  CHECK_OK(conic_triangles_smooth(context, &t));
  CHECK_NEAR(t.normal[2][1], 1.0, 1e-7);
  CHECK_NEAR(t.normal[0][0], 2.0 / sqrt(5.0), 1e-7); /* twice the area */
  CHECK_NEAR(t.normal[2][0], 1.0 / sqrt(5.0), 1e-7);
  CHECK(t.normal[0][4] == 0.0f && t.n_normals == 5);
  conic_triangles_release(context, &t);
}

int main(void) {
  context = files_context();
  test_corners();
  test_refused();
  test_materials();
  test_alpha();
  test_ply_vertices();
  test_ply_corners();
  test_ply_pictures();
  test_strip();
  test_append();
  test_smooth();
  files_end(context);
  return check_result();
}
