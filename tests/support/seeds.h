/* A small sound file of every kind that is read: what the tests of bad input spoil, and what fuzzing starts from. */
#pragma once

#include "core/assimp/assimp_bridge.h"
#include "tests/support/camera_files.h"
#include "tests/support/e57_example.h"
#include "tests/support/files.h"
#include "tests/support/gaussian_fixture.h"
#include "tests/support/gltf_packed.h"
#include "tests/support/hierarchy_parts.h"
#include "tests/support/las_file.h"
#include "tests/support/laz_examples.h"
#include "tests/support/mesh_file.h"
#include "tests/support/png_file.h"

typedef struct seed {
  const char *target; /* the fuzz target that reads it: ply, obj, mtl, las, pcd, xyz, camera, colmap, pfm, exr, png,
                         cot, lpc, levels, chy, gaussians, copc, ept, potree */
  char name[32];      /* of the file */
  unsigned char *bytes;
  size_t n_bytes;
  int may_be_cut; /* what is left of it may be sound */
} seed;

enum { SEEDS_ROOM = 512 };

typedef struct seed_set {
  seed seeds[SEEDS_ROOM];
  int n;
} seed_set;

static inline seed *seeds_add(seed_set *set, const char *target, const char *ending, int may_be_cut, const void *bytes,
                              size_t n_bytes) {
  seed *added = &set->seeds[set->n++];
  if (set->n > SEEDS_ROOM) {
    fprintf(stderr, "more than %d seeds\n", SEEDS_ROOM);
    exit(1);
  }
  added->target = target;
  added->may_be_cut = may_be_cut;
  snprintf(added->name, sizeof added->name, "%02d.%s", set->n, ending);
  added->n_bytes = n_bytes;
  added->bytes = malloc(n_bytes + 1);
  if (!added->bytes)
    exit(1);
  memcpy(added->bytes, bytes, n_bytes);
  return added;
}

static inline void seeds_text(seed_set *set, const char *target, const char *ending, const char *text) {
  seeds_add(set, target, ending, 1, text, strlen(text));
}

/* Values of a binary PLY are written by letters: b and B bytes, s shorts, i ints, f floats, d doubles. */
static inline size_t seeds_value(unsigned char *to, char type, double value, int is_big) {
  float as_float = (float)value;
  uint32_t float_bits;
  uint64_t bits = (uint64_t)(int64_t)value;
  size_t n_bytes = type == 'd' ? 8 : type == 'f' || type == 'i' ? 4 : type == 's' ? 2 : 1;
  memcpy(&float_bits, &as_float, sizeof float_bits);
  if (type == 'd')
    memcpy(&bits, &value, sizeof bits);
  else if (type == 'f')
    bits = float_bits;
  for (size_t i = 0; i < n_bytes; i++)
    to[i] = (unsigned char)(bits >> 8 * (is_big ? n_bytes - 1 - i : i));
  return n_bytes;
}

/* A PLY of `rows` rows of these types after a header; a letter l is a list of three indices, c one of six floats. */
static inline void seeds_ply(seed_set *set, const char *header, const char *types, int rows, const char *face_types,
                             int face_rows, int is_big) {
  unsigned char bytes[4096];
  const char *kinds[2] = {types, face_types};
  int counts[2] = {rows, face_rows};
  size_t n = (size_t)snprintf((char *)bytes, sizeof bytes, "ply\nformat binary_%s_endian 1.0\n%send_header\n",
                              is_big ? "big" : "little", header);
  for (int kind = 0; kind < 2; kind++)
    for (int row = 0; row < counts[kind]; row++)
      for (const char *type = kinds[kind]; *type; type++) {
        if (*type == 'c') {
          n += seeds_value(bytes + n, 'b', 6, is_big);
          for (int k = 0; k < 6; k++)
            n += seeds_value(bytes + n, 'f', row + 0.125 * k, is_big);
          continue;
        }
        if (*type != 'l') {
          n += seeds_value(bytes + n, *type, row + 0.25 * (double)(type - kinds[kind]), is_big);
          continue;
        }
        n += seeds_value(bytes + n, 'b', 3, is_big);
        for (int corner = 0; corner < 3; corner++)
          n += seeds_value(bytes + n, 'i', (row + corner) % rows, is_big);
      }
  seeds_add(set, "ply", "ply", 1, bytes, n);
}

static inline void seeds_all_ply(seed_set *set) {
  const char *mesh = "element vertex 5\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
                     "property uchar green\nproperty uchar blue\nelement face 3\n"
                     "property list uchar int vertex_indices\n";
  seeds_ply(set, mesh, "fffbbb", 5, "l", 3, 0);
  seeds_ply(set, mesh, "fffbbb", 5, "l", 3, 1);
  seeds_ply(set,
            "comment far\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
            "property float nx\nproperty float ny\nproperty float nz\nproperty float radius\n"
            "property list uchar int extra\nelement tristrips 1\nproperty list uchar int vertex_indices\n",
            "dddffffl", 4, "l", 1, 0);
  seeds_ply(set,
            "element camera 1\nproperty short a\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nproperty float tu_x\nproperty float tu_y\nproperty float tu_z\nproperty float tv_x\n"
            "property float tv_y\nproperty float tv_z\nproperty float opacity\nproperty ushort red\n"
            "property ushort green\nproperty ushort blue\n",
            "s", 1, "ffffffffffsss", 3, 0);
  seeds_ply(set,
            "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float f_dc_0\n"
            "property float f_dc_1\nproperty float f_dc_2\nproperty float opacity\nproperty float scale_0\n"
            "property float scale_1\nproperty float scale_2\nproperty float rot_0\nproperty float rot_1\n"
            "property float rot_2\nproperty float rot_3\n",
            "ffffffffffffff", 3, "", 0, 0);
  seeds_ply(set,
            "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float tu_x\n"
            "property float tu_y\nproperty float tu_z\nproperty float tv_x\nproperty float tv_y\nproperty float tv_z\n"
            "property uchar dot\nproperty list uchar int clip_or\nproperty float opacity\n",
            "fffffffffblf", 3, "", 0, 0);
  seeds_ply(set,
            "comment TextureFile gone.pfm\ncomment TextureFile gone too.pfm\nelement vertex 3\nproperty float x\n"
            "property float y\nproperty float z\nproperty float s\nproperty double t\nelement face 2\n"
            "property list uchar float texcoord\nproperty list uchar int vertex_indices\nproperty short texnumber\n",
            "ffffd", 3, "cls", 2, 1);
  seeds_ply(set,
            "comment conic 0.6.0\ncomment crs EPSG:32633\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nelement face 2\nproperty list uchar int vertex_indices\nproperty double red\n"
            "property double green\nproperty double blue\n",
            "fff", 3, "lddd", 2, 0);
  seeds_text(
      set, "ply", "ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float tu_x\nproperty float tu_y\nproperty float tu_z\nproperty float tv_x\nproperty float tv_y\n"
      "property float tv_z\nproperty list uchar float clip_and\nproperty list uchar float clip_or\nend_header\n"
      "0 0 0 1 0 0 0 1 0 0 6 1 0 .5 0 1 .5\n1 0 0 1 0 0 0 1 0 3 1 nan 0 0\n2 0 0 0 0 0 0 1 0 6 0 0 1 -1 0 1 0\n");
  seeds_text(set, "ply", "ply",
             "ply\nformat ascii 1.0\nobj_info by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
             "property int z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 2\n"
             "property list uchar int vertex_index\nproperty uchar flag\nend_header\n0 0 0 0 0 1\n1e0 0 0 0 0 -1\n"
             "1 1 1 nan 0 inf\n.5 +1 -1 0 1 0\n3 0 1 2 7\n4 0 1 2 3 0\n");
  seeds_text(set, "ply", "ply",
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
             "property float texture_u\nproperty float texture_v\nelement face 2\n"
             "property list uchar int vertex_index\nproperty list int float texcoord\nend_header\n0 0 0 0 0\n"
             "1 0 0 1 0\n1 1 0 1 1\n0 1 0 nan 1\n3 0 1 2 0\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n");
}

static inline void seeds_all_text(seed_set *set) {
  seeds_text(set, "obj", "obj",
             "# by hand\nmtllib a.mtl\nv 0 0 0\nv 1 0 0 1 0.5 0\nv 1 1 \\\n 0\nv 0 1 0 1\nvt 0.5 0.5\nvn 0 0 1\n"
             "f 1/1/1 2/1/1 3/1/1\nf -4//-1 3//1 4//1\nf 1 2 3 4\no thing\ns off\n");
  seeds_text(set, "obj", "obj", "v 0 0 0 255 0 9\nv 1 0 0\nv 1 1 0 0.5 nan 1\nf 1/0/0 2/-9/-9 3\n");
  seeds_text(set, "obj", "obj", "v 589500.5 231300.25 1e7\nv 589501 231300 1e7\nv 589501 231301 1e7\nf 1 2 3\n");
  seeds_text(
      set, "obj", "obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0.5\nusemtl red\nf 1/1 2/2 3/-1\nusemtl plain\nf 1 2 3\nf 3/2 2 1\n");
  seeds_text(set, "mtl", "mtl",
             "# by hand\nnewmtl red\nKd 0.5 0.25 1e-3\nmap_Kd -clamp on -s 1 1 1 gone.png\nnewmtl other\nKd 1\n");
  seeds_text(set, "mtl", "mtl", "newmtl plain\nKd .7\nNs 3\nillum 2\nmap_Kd /proc/self/gone\n");
  seeds_text(set, "xyz", "xyz", "# by hand\n0 0 0\n1 2 3\n-1e3 .5 +7\n");
  seeds_text(set, "xyz", "xyz", "// X,Y,Z,R,G,B\n0,0,0,255,0,10\n1,2,3,0,1,2\n");
  seeds_text(set, "xyz", "pts", "3\n0 0 0 -100 255 0 10\n1 2 3 50 0 1 2\n5 6 7 0 1 2 3\n");
  seeds_text(set, "xyz", "xyz", "0 0 0 0 0 1\n1 2 nan 0 1 0\n");
  seeds_text(set, "xyz", "csv", "\xEF\xBB\xBF\"X\";\"Y\";\"Z\";id\n\"1,5\";\"2\";\"3,25\";a\n4;5;6;\n");
  seeds_text(set, "xyz", "csv", "id\tNx\tNy\tNz\tX\tY\tZ\na b\t0\t0\t1\t1,5\t2\t3\n\t0\t1\t0\t4\t5\t6\n");
  seeds_text(set, "xyz", "asc", "//X Y Z R G B I\n2\n1 2 3 4 5 6 7\n1,2,3;4,5,6 7;\n1\n9 8 7 6 5 4 3\n");
  seeds_text(set, "xyz", "xyz", "1 2 3 255 0 4 -7 0 0 1\n4 5 6 7 8 9 10 1 0 0\n");
  seeds_text(set, "xyz", "csv", "X,Y,Z\n1,2,3\n1,2\n4,,6\n");
  seeds_text(set, "xyz", "xyz", "0 0 0\n1.#QNAN -1.#IND00 1.#INF\n1.#SNAN 1 1\n");
  seeds_text(set, "xyz", "xyz", "0 0 0 65535 256 1 0 0 1\n1 2 3 7 8 9 0 1 0\n");
  seeds_text(
      set, "camera", "json",
      "{\"width\": 64, \"height\": 48, \"fx\": 50.5, \"fy\": 5e1, \"cx\": 32, \"cy\": 24, \"more\": [true, null,\n"
      "{\"a\\u0041\": \"b\\n\"}],\n\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,-3.5],[0,0,0,1]]}\n");
}

/* One camera in every format. */
static inline void seeds_all_cameras(seed_set *set) {
  camera_bytes first = {.n = 0}, second = {.n = 0}, npz = camera_npz_example(), joined;
  seeds_text(set, "camera", "json", CAMERA_TRANSFORMS);
  seeds_text(set, "camera", "json",
             "{\"camera_angle_x\": 0.7, \"camera_model\": \"OPENCV_FISHEYE\", \"k1\": 0.1, \"w\": 64, \"h\": 48,\n"
             "\"frames\": [{\"transform_matrix\": " CAMERA_MATRIX "}, {\"file_path\": \"b\\u0007\", \"h\": 9,\n"
             "\"transform_matrix\": " CAMERA_MATRIX "}]}");
  seeds_text(set, "camera", "json", CAMERA_LIST);
  seeds_text(set, "camera", "gltf", CAMERA_GLTF);
  seeds_text(set, "camera", "json",
             "{\"kind\": \"fisheye\", \"lens\": \"fov\", \"distortion\": [0.9], \"width\": 64, \"height\": 48,\n"
             "\"fx\": 50, \"fy\": 50, \"cx\": 32, \"cy\": 24, "
             "\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}");
  seeds_add(set, "camera", "npz", 1, npz.bytes, npz.n);
  camera_colmap_binary(6, (const double[]){50, 49, 31, 24, .1, .2, .3, .4, .5, .6, .7, .8}, 12, &first, &second);
  joined = camera_join_colmap('b', &first, &second);
  seeds_add(set, "colmap", "bin", 0, joined.bytes, joined.n);
  first.n = second.n = 0;
  camera_put_text(&first, CAMERA_COLMAP_CAMERAS "2 FOV 10 20 5 5 1 2 .9\n");
  camera_put_text(&second, CAMERA_COLMAP_IMAGES "8 1 0 0 0 0 0 0 2 two.png\n\n");
  joined = camera_join_colmap('t', &first, &second);
  seeds_add(set, "colmap", "txt", 1, joined.bytes, joined.n);
}

/* Three points in each of the ways of storing them. */
static inline void seeds_all_pcd(seed_set *set) {
  static const char header[] = "VERSION 0.7\nFIELDS x y z rgb normal_x normal_y normal_z a\nSIZE 4 4 4 4 4 4 4 1\n"
                               "TYPE F F F U F F F U\nCOUNT 1 1 1 1 1 1 1 2\nWIDTH 3\nHEIGHT 1\n"
                               "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ";
  enum { ROWS = 3 * 30 };
  unsigned char bytes[1024];
  size_t n = (size_t)snprintf((char *)bytes, sizeof bytes, "%sbinary\n", header);
  for (int i = 0; i < ROWS; i++)
    bytes[n + (size_t)i] = (unsigned char)(i % 30 % 4 == 3 ? 0x3f : 7 * i);
  seeds_add(set, "pcd", "pcd", 1, bytes, n + ROWS);
  /* four bytes as they are, and then 86 that repeat them */
  n = (size_t)snprintf((char *)bytes, sizeof bytes, "%sbinary_compressed\n%c%c%c%c%c%c%c%c%cabcd%c%c%c", header, 8, 0,
                       0, 0, ROWS, 0, 0, 0, 3, 0xE0, 77, 3);
  seeds_add(set, "pcd", "pcd", 1, bytes, n);
  seeds_text(set, "pcd", "pcd",
             "# .PCD v0.7\nFIELDS z x y rgba label\nSIZE 8 4 4 4 2\nTYPE F F F F U\nWIDTH 2\nHEIGHT 2\nDATA ascii\n"
             "1e7 2 3 4.2108e+06 7\n4 5 nan 4.808e+06 1\n\n0 0 0 0 0\n-1 +2 .5 1 2\n");
  seeds_text(set, "pcd", "pcd",
             "columns x y z\nsize 4 4 4\ntype F F F\npoints 3\ndata ASCII\n1 2 3\nnan nan nan\n4 5 6\n");
  seeds_text(set, "pcd", "pcd",
             "FIELDS x y z r g b\nSIZE 4 4 4 1 1 1\nTYPE I I F U U U\nPOINTS 1\nDATA ascii\n1 2 3 255 0 9\n");
}

/* The same records as seeds of what is read of the world that they lie in; and a text of it. */
static inline void seeds_all_references(seed_set *set) {
  static const char text[] = "PROJCS[\"a\",GEOGCS[\"b\",AUTHORITY[\"EPSG\",\"4326\"]],AUTHORITY[\"EPSG\",\"32610\"]]";
  static const unsigned char keys[] = {1, 0, 1, 0, 0, 0, 2, 0, 0, 4, 0, 0, 1, 0, 1, 0, 0, 12, 0, 0, 1, 0, 30, 105};
  unsigned char file[227 + 54 + sizeof keys] = "LASF";
  file[94] = 227;
  file[96] = (unsigned char)(sizeof file & 0xff);
  file[97] = (unsigned char)(sizeof file >> 8);
  file[100] = 1;
  snprintf((char *)file + 227 + 2, 16, "LASF_Projection");
  memcpy(file + 227 + 18, (const unsigned char[]){0xaf, 0x87, sizeof keys}, 3);
  memcpy(file + 227 + 54, keys, sizeof keys);
  seeds_add(set, "georeference", "las", 1, file, sizeof file);
  seeds_text(set, "georeference", "wkt", text);
  seeds_text(
      set, "georeference", "wkt",
      "PROJCS [\"WGS_1984_UTM_Zone_33N\",GEOGCS[\"any\",DATUM[\"WGS_1984\"]],PROJECTION[\"Transverse_Mercator\"],"
      "PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",15],PARAMETER[\"scale_factor\",0.9996],"
      "PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",0],UNIT[\"metre\",1]]");
}

static inline void seeds_all_las(seed_set *set) {
  const int kinds[][2] = {{2, 0}, {2, 3}, {3, 2}, {4, 1}, {4, 6}, {4, 7}, {4, 8}, {3, 4}, {3, 5}, {4, 10}};
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    las_file file = las_begin(kinds[i][0], kinds[i][1], 3, i);
    las_set_scale(&file, 0.01, 589500.0, 231300.0, 0.0);
    las_set_point(&file, 1, 100, -200, 300);
    if (kinds[i][1] == 2 || kinds[i][1] == 3 || kinds[i][1] == 5 || kinds[i][1] > 6)
      las_set_color(&file, 2, 255, 128, i == 2 ? 65535 : 7);
    seeds_add(set, "las", "las", 1, file.bytes, file.n_bytes);
    free(file.bytes);
  }
  las_file described = las_begin(4, 6, 2, 6);
  las_describe_extra(&described, 2);
  seeds_add(set, "las", "las", 1, described.bytes, described.n_bytes);
  free(described.bytes);
  static const size_t packed_formats[] = {3, 5, 7, 10};
  for (size_t i = 0; i < sizeof packed_formats / sizeof *packed_formats; i++) {
    las_file packed = laz_example_file(&laz_examples[packed_formats[i]]);
    seeds_add(set, "las", "laz", 1, packed.bytes, packed.n_bytes);
    free(packed.bytes);
  }
}

static inline void seeds_all_scans(seed_set *set) {
  e57_test_file file;
  e57_make(&file);
  seeds_add(set, "e57", "e57", 0, file.bytes, file.n_bytes);
  seeds_text(set, "ptx", "ptx",
             "2\n1\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n9 2 3 1\n4 5 6 0.25 255 0 51\n"
             "0 0 0 0.5 0 0 0\n1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 0 0 1 9 9 9\n");
}

/* Pictures as NumPy's arrays: alone, and some under the names of planes. */
static inline void seeds_all_numpy(seed_set *set) {
  static const float floats[24] = {0.5f, 1.0f, 0.25f, -1.0f};
  static const uint16_t words[24] = {0x3c00, 0x0001, 0x7c00, 0xfbff};
  static const uint8_t codes[24] = {0, 255, 17};
  const camera_bytes alone = camera_npy("<f4", "False", "(2, 4, 3)", floats, sizeof floats);
  const camera_bytes first = camera_npy("<f2", "True", "(1, 4, 3, 2)", words, sizeof words);
  const camera_part parts[] = {{"rgb.npy", camera_npy("|u1", "False", "(2, 4, 3)", codes, sizeof codes)},
                               {"A.npy", camera_npy("|u1", "False", "(2, 4)", codes, 8)},
                               {"Z.npy", camera_npy("<f4", "False", "(2, 4, 1)", floats, 32)},
                               {"id.npy", camera_npy("<u2", "False", "(2, 4)", words, 16)}};
  const camera_bytes several = camera_npz(parts, 4);
  seeds_add(set, "numpy", "npy", 1, alone.bytes, alone.n);
  seeds_add(set, "numpy", "npy", 1, first.bytes, first.n);
  seeds_add(set, "numpy", "npz", 1, several.bytes, several.n);
}

/* Pictures are written by the library into the tests' folder, and removed there. */
static inline void seeds_picture(seed_set *set, conic_context *context, const char *target, unsigned planes) {
  conic_image image;
  static unsigned char bytes[1 << 16];
  char name[16];
  snprintf(name, sizeof name, "seed.%s", target);
  const char *path = files_path(name);
  if (conic_image_allocate(context, 5, 4, planes, &image) != CONIC_OK)
    exit(1);
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    for (int i = 0; image.planes[plane] && i < 20 * conic_plane_describe((conic_plane)plane)->n_channels; i++)
      if (conic_plane_describe((conic_plane)plane)->is_uint)
        ((uint32_t *)image.planes[plane])[i] = (uint32_t)i;
      else
        ((float *)image.planes[plane])[i] = 0.125f * (float)i;
  image.n_attributes = 1;
  memset(image.attributes, 0, sizeof *image.attributes);
  snprintf(image.attributes[0].name, sizeof image.attributes[0].name, "note");
  snprintf(image.attributes[0].text, sizeof image.attributes[0].text, "by hand");
  conic_status status = conic_image_write(context, path, &image);
  conic_image_release(context, &image);
  FILE *file = status == CONIC_OK ? fopen(path, "rb") : NULL;
  if (!file)
    return; /* a build without the library for it */
  size_t n = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  unlink(path);
  seeds_add(set, target, target, 0, bytes, n);
}

/* Octrees, written by the library into the tests' folder, and removed there. */
static inline void seeds_octree(seed_set *set, conic_context *context, size_t n, int quantize) {
  static unsigned char bytes[1 << 16];
  const char *path = files_path("seed.cot");
  conic_octree_options options;
  conic_octree *octree;
  conic_splats splats;
  conic_octree_options_init(&options);
  options.quantize = quantize;
  if (conic_splats_allocate(context, n, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS, &splats) != CONIC_OK)
    exit(1);
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++) {
      splats.position[axis][i] = (float)((i * (size_t)(7 + 4 * axis)) % 31);
      splats.tangent_u[axis][i] = axis == 0 ? 1.0f : 0.0f;
      splats.tangent_v[axis][i] = axis == 1 ? 0.75f : 0.0f;
      splats.color[axis][i] = axis == 2 ? 0.3f : 1.0f;
    }
  if (conic_octree_build(context, &splats, &options, &octree) != CONIC_OK ||
      conic_octree_write(octree, path) != CONIC_OK)
    exit(1);
  conic_octree_destroy(octree);
  FILE *file = fopen(path, "rb");
  size_t n_bytes = file ? fread(bytes, 1, sizeof bytes, file) : 0;
  if (!file || fclose(file) != 0 || unlink(path) != 0)
    exit(1);
  seeds_add(set, "cot", "cot", 0, bytes, n_bytes);
}

/* Two squares at an angle, one with a texture of 2 × 2; as triangles, or gathered to surfels. */
static inline void seeds_hybrid(seed_set *set, conic_context *context, int is_gathered) {
  static const float places[3][6] = {{0, 0, 1, 1, 1, 1}, {0, 1, 0, 1, 0, 1}, {0, 0, 0, 0, 1, 1}};
  static const uint32_t corners[4][3] = {{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}};
  static unsigned char bytes[1 << 16];
  const char *path = files_path("seed.chy");
  conic_triangles mesh;
  conic_hybrid_options options;
  conic_hybrid *hybrid;
  conic_image image;
  conic_texture *texture;
  conic_hybrid_options_init(&options);
  options.phase2 = is_gathered ? 1e6 : -2.0;
  options.most_error = 0.0;
  if (conic_triangles_allocate(context, 4, 6, CONIC_TRIANGLES_COLORS | CONIC_TRIANGLES_TEXTURE_COORDINATES, &mesh) !=
          CONIC_OK ||
      conic_image_allocate(context, 2, 2, 1u << CONIC_PLANE_RGBA, &image) != CONIC_OK)
    exit(1);
  memcpy(mesh.corners, corners, sizeof corners);
  for (int i = 0; i < 6; i++) {
    for (int axis = 0; axis < 3; axis++) {
      mesh.position[axis][i] = places[axis][i];
      mesh.color[axis][i] = 0.5f + 0.1f * (float)axis;
    }
    mesh.texture_coordinate[0][i] = 0.5f * (float)(i / 2);
    mesh.texture_coordinate[1][i] = (float)(i % 2);
  }
  for (int i = 0; i < 16; i++)
    ((float *)image.planes[CONIC_PLANE_RGBA])[i] = i % 4 == 3 ? 1.0f : (float)i / 16.0f;
  if (conic_texture_create(context, &image, CONIC_WRAP_REPEAT, &texture) != CONIC_OK ||
      conic_triangles_texture(context, &mesh, texture) != CONIC_OK ||
      conic_hybrid_build(context, &mesh, &options, &hybrid, NULL) != CONIC_OK ||
      conic_hybrid_write(hybrid, path) != CONIC_OK)
    exit(1);
  conic_image_release(context, &image);
  conic_hybrid_destroy(hybrid);
  FILE *file = fopen(path, "rb");
  size_t n_bytes = file ? fread(bytes, 1, sizeof bytes, file) : 0;
  if (!file || fclose(file) != 0 || unlink(path) != 0)
    exit(1);
  seeds_add(set, "chy", "chy", 0, bytes, n_bytes);
}

/* Layered point clouds, likewise; none where this build cannot write them. */
static inline void seeds_layers(seed_set *set, conic_context *context, size_t n, unsigned fields) {
  static unsigned char bytes[1 << 16];
  const char *path = files_path("seed.lpc");
  conic_layers_options options;
  conic_layers_builder *builder;
  conic_splats splats;
  conic_layers_options_init(&options);
  options.cloud_size = 64;
  if (conic_splats_allocate(context, n, CONIC_SPLATS_NORMALS | fields, &splats) != CONIC_OK)
    exit(1);
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++) {
      splats.position[axis][i] = (float)((i * (size_t)(7 + 4 * axis)) % 31);
      splats.normal[axis][i] = axis == (int)(i % 3) ? 1.0f : 0.25f;
      if (splats.color[0])
        splats.color[axis][i] = (float)(i % 7) / 6.0f;
    }
  conic_status status = conic_layers_builder_open(context, path, &options, &builder);
  if (status == CONIC_OK)
    status = conic_layers_builder_append(builder, &splats);
  if (status == CONIC_OK)
    status = conic_layers_builder_finish(builder, NULL);
  conic_splats_release(context, &splats);
  if (status == CONIC_ERROR_UNSUPPORTED)
    return;
  FILE *file = status == CONIC_OK ? fopen(path, "rb") : NULL;
  size_t n_bytes = file ? fread(bytes, 1, sizeof bytes, file) : 0;
  if (!file || fclose(file) != 0 || unlink(path) != 0)
    exit(1);
  seeds_add(set, "lpc", "lpc", 0, bytes, n_bytes);
}

/* Hierarchies of other kinds, those of several files joined. */
static inline void seeds_all_hierarchies(seed_set *set) {
  unsigned char bytes[4096];
  seeds_add(set, "copc", "laz", 0, bytes, hierarchy_copc_example(bytes));
  seeds_add(set, "ept", "ept", 0, bytes, hierarchy_ept_example(bytes));
  seeds_add(set, "potree", "potree", 0, bytes, hierarchy_potree_example(bytes));
}

/* Every kind of PNG that libpng turns into another; none where this build leaves them to another library. */
static inline void seeds_all_png(seed_set *set) {
  static const png_kind kinds[] = {{5, 4, PNG_COLOR_ALPHA, 8, 0, 0, 2},
                                   {9, 9, PNG_COLOR, 16, 1, 1, 0},
                                   {5, 4, PNG_BY_PALETTE, 2, 0, 1, 0},
                                   {9, 3, PNG_GREY, 1, 1, 1, 1},
                                   {3, 3, PNG_GREY_ALPHA, 16, 0, 0, 0}};
  static png_file file;
  int is_there = 0;
  for (int i = 0; conic_feature_at(i); i++)
    is_there |= strcmp(conic_feature_at(i)->name, "libpng") == 0 && conic_feature_at(i)->available;
  for (size_t i = 0; is_there && i < sizeof kinds / sizeof *kinds; i++) {
    png_make(&file, &kinds[i]);
    seeds_add(set, "png", "png", 0, file.bytes, file.n_bytes);
  }
}

/* For Assimp, whose readers are not ours to test byte by byte: these are for fuzzing alone. */
static inline void seeds_all_assimp(seed_set *set) {
  static mesh_file file;
  for (int i = 0; i < MESH_N_KINDS; i++) {
    file.n = 0;
    mesh_kinds[i].make(&file);
    seeds_add(set, "assimp", mesh_kinds[i].ending, mesh_kinds[i].is_text, file.bytes, file.n);
  }
}

/* Some of everything that glTF has, and what is packed in it. */
static inline void seeds_all_gltf(seed_set *set) {
  static mesh_file made;
  static gltf_file file;
  const char *rest;
  gltf_make_rich(&made, GLTF_EMBEDDED);
  seeds_add(set, "gltf", "gltf", 0, made.bytes, made.n);
  gltf_make_rich(&made, GLTF_GLB);
  seeds_add(set, "gltf", "glb", 0, made.bytes, made.n);
  rest = gltf_draco(&file, 0, 4);
  gltf_make(&made, &file, GLTF_GLB, rest);
  seeds_add(set, "gltf", "glb", 0, made.bytes, made.n);
  for (int i = 0; i < 2; i++) {
    rest = gltf_meshopt(&file, i ? "INDICES" : "TRIANGLES", 0, 4);
    gltf_make(&made, &file, GLTF_GLB, rest);
    seeds_add(set, "gltf", "glb", 0, made.bytes, made.n);
  }
  made.n = 0;
  mesh_glb(&made);
  seeds_add(set, "gltf", "glb", 0, made.bytes, made.n);
}

/* A material with texels, one with a path, and a part of three vertices with everything. */
static inline void seeds_all_records(seed_set *set) {
  static mesh_file file;
  const conic_assimp_record records[] = {
      {.type = CONIC_ASSIMP_OPENED, .n_bytes = 5},
      {.type = CONIC_ASSIMP_MATERIAL, .picture = CONIC_ASSIMP_TEXELS, .width = 2, .height = 1, .n_bytes = 8},
      {.type = CONIC_ASSIMP_MATERIAL, .color = {1, 0.5f, 0.25f}, .picture = CONIC_ASSIMP_PATH, .n_bytes = 8},
      {.type = CONIC_ASSIMP_PART, .fields = 7, .i_material = 1, .n_vertices = 3, .n_triangles = 1},
      {.type = CONIC_ASSIMP_END, .up = {0, 1, 0}}};
  const size_t n_after[] = {5, 8, 8, 3 * (24 + 12 + 8 + 12), 0};
  file.n = 0;
  for (int i = 0; i < 5; i++) {
    mesh_put(&file, &records[i], sizeof records[i]);
    for (size_t k = 0; k < n_after[i]; k++)
      mesh_number(&file, i == 3 ? (uint32_t)(k * 5) : 'a', 1);
    for (uint32_t k = 0; i == 3 && k < 3; k++)
      mesh_number(&file, k, 4);
  }
  seeds_add(set, "assimp_records", "bin", 0, file.bytes, file.n);
}

static inline void seeds_gaussians(seed_set *set, conic_context *context, conic_gaussian_kind kind, int spz_version) {
  static const char *const endings[] = {"ply", "ply", "splat", "spz", "sog", "gltf", "glb"};
  conic_gaussians scene = gaussians_random(context, 5, kind == CONIC_GAUSSIANS_SPLAT ? 0 : 1, 0);
  conic_gaussians_write_options options;
  conic_gaussians_write_options_init(&options);
  options.kind = kind;
  options.spz_version = spz_version;
  const char *path = files_path("seed.gaussians");
  if (gaussians_have(kind) && conic_gaussians_write(context, path, &scene, &options) == CONIC_OK) {
    unsigned char bytes[16384];
    FILE *file = fopen(path, "rb");
    size_t n = file ? fread(bytes, 1, sizeof bytes, file) : 0;
    if (!file || fclose(file) != 0 || unlink(path) != 0)
      exit(1);
    seeds_add(set, "gaussians", endings[kind], kind == CONIC_GAUSSIANS_SPLAT, bytes, n);
  }
  conic_gaussians_release(context, &scene);
}

static inline void seeds_all_gaussians(seed_set *set, conic_context *context) {
  for (int kind = 0; kind < CONIC_N_GAUSSIAN_KINDS; kind++)
    seeds_gaussians(set, context, (conic_gaussian_kind)kind, 4);
  seeds_gaussians(set, context, CONIC_GAUSSIANS_SPZ, 3);
  for (int level = 0; level < 3; level++) {
    unsigned char bytes[KSPLAT_ROOM];
    seeds_add(set, "gaussians", "ksplat", 0, bytes, gaussians_put_ksplat(level, bytes));
  }
  seeds_text(set, "gaussians", "ply",
             "ply\nformat ascii 1.0\ncomment SplatRenderMode: mip\nelement vertex 2\nproperty double x\n"
             "property double y\nproperty double z\nproperty float f_dc_0\nproperty float f_dc_1\n"
             "property float f_dc_2\nproperty float opacity\nproperty float scale_0\nproperty float scale_1\n"
             "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n"
             "property float filter_3D\nend_header\n"
             "4e6 1 2 .1 .2 .3 1 -3 -2 1 0 0 0 .01\n4e6 1 3 nan 0 inf -9 -1 -1 0 0 0 0 0\n");
}

static inline seed_set *seeds_make(conic_context *context) {
  seed_set *set = calloc(1, sizeof *set);
  if (!set)
    exit(1);
  seeds_all_ply(set);
  seeds_all_text(set);
  seeds_all_cameras(set);
  seeds_all_las(set);
  seeds_all_scans(set);
  seeds_all_pcd(set);
  seeds_all_png(set);
  seeds_all_gaussians(set, context);
  seeds_octree(set, context, 1, 0);
  seeds_octree(set, context, 40, 0);
  seeds_octree(set, context, 40, 1);
  seeds_hybrid(set, context, 1);
  seeds_layers(set, context, 1, 0);
  seeds_layers(set, context, 300, CONIC_SPLATS_COLORS);
  seeds_all_numpy(set);
  seeds_picture(set, context, "pfm", 1u << CONIC_PLANE_RGBA);
  seeds_picture(set, context, "pfm", 1u << CONIC_PLANE_Z);
  seeds_picture(set, context, "exr", 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z);
  seeds_picture(set, context, "exr", (1u << CONIC_N_PLANES) - 1u);
  return set;
}

static inline void seeds_release(seed_set *set) {
  for (int i = 0; i < set->n; i++)
    free(set->seeds[i].bytes);
  free(set);
}
