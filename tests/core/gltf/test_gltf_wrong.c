/* glTF that asks for what is not there: every number that leads into a buffer is checked, and a message says what is
 * wrong. */
#include "tests/support/files.h"
#include "tests/support/gltf_file.h"

static conic_context *context;

#define MESH "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],\"nodes\":[{\"mesh\":0}]"
#define ACCESSOR "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}"
#define INDICES "{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}"
#define VIEW "{\"buffer\":0,\"byteLength\":36}"
#define LAST_VIEW "{\"buffer\":0,\"byteOffset\":36,\"byteLength\":8}"

/* A triangle of three floats a place and three indices, any part of which is replaced: null, as it should be. */
typedef struct wrong_file {
  const char *mesh, *accessor, *indices, *view, *last_view, *message;
} wrong_file;

static const wrong_file files[] = {
    {NULL, NULL, NULL, NULL, NULL, NULL},
    {NULL, "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}", NULL, NULL, NULL,
     "4 items reaches past the end of its view"},
    {NULL, "{\"bufferView\":0,\"componentType\":5126,\"count\":4294967294,\"type\":\"VEC3\"}", NULL, NULL, NULL,
     "4294967294 items reaches past the end of its view"},
    {NULL, "{\"bufferView\":0,\"componentType\":5126,\"count\":-1,\"type\":\"VEC3\"}", NULL, NULL, NULL,
     "items of the type VEC3"},
    {NULL, "{\"bufferView\":0,\"componentType\":5126,\"count\":2.5,\"type\":\"VEC3\"}", NULL, NULL, NULL,
     "items of the type VEC3"},
    {NULL, "{\"bufferView\":0,\"componentType\":5126,\"count\":1e30,\"type\":\"VEC3\"}", NULL, NULL, NULL,
     "items of the type VEC3"},
    {NULL, "{\"bufferView\":0,\"componentType\":5124,\"count\":3,\"type\":\"VEC3\"}", NULL, NULL, NULL,
     "components of the type 5124"},
    {NULL, "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"}", NULL, NULL, NULL, "another type"},
    {NULL, "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"MAT3\"}", NULL, NULL, NULL, "another type"},
    {NULL, "{\"bufferView\":7,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}", NULL, NULL, NULL,
     "view is not there"},
    {NULL, "{\"bufferView\":0,\"byteOffset\":4,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}", NULL, NULL, NULL,
     "past the end of its view"},
    {NULL, "{\"bufferView\":0,\"byteOffset\":1e18,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}", NULL, NULL,
     NULL, "begins past the end"},
    {NULL, "{\"bufferView\":0,\"byteOffset\":-4,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}", NULL, NULL,
     NULL, "begins past the end"},
    {NULL, "{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}", NULL, NULL, NULL, "have no data"},
    {NULL, NULL, NULL, "{\"buffer\":0,\"byteLength\":37}", "{\"buffer\":0,\"byteOffset\":40,\"byteLength\":8}",
     "past the end of its buffer"},
    {NULL, NULL, NULL, "{\"buffer\":0,\"byteOffset\":18446744073709551615,\"byteLength\":37}", NULL,
     "past the end of its buffer"},
    {NULL, NULL, NULL, "{\"buffer\":0,\"byteOffset\":8,\"byteLength\":18446744073709551608}", NULL,
     "past the end of its buffer"},
    {NULL, NULL, NULL, "{\"buffer\":3,\"byteLength\":36}", NULL, "buffer is not there"},
    {NULL, NULL, NULL, "{\"byteLength\":36}", NULL, "buffer is not there"},
    {NULL, NULL, NULL, "{\"buffer\":0,\"byteLength\":36,\"byteStride\":16}", NULL, "past the end of its view"},
    {NULL, NULL, NULL, "{\"buffer\":0,\"byteLength\":36,\"byteStride\":8}", NULL, "where an accessor's items have 12"},
    {NULL, NULL, NULL, "{\"buffer\":0,\"byteLength\":36,\"byteStride\":1e9}", NULL, "a stride of 1e+09 bytes"},
    {NULL, NULL, "{\"bufferView\":1,\"componentType\":5126,\"count\":1,\"type\":\"SCALAR\"}", NULL, NULL,
     "of another type than they have"},
    {NULL, NULL, "{\"bufferView\":1,\"componentType\":5122,\"count\":3,\"type\":\"SCALAR\"}", NULL, NULL,
     "of another type than they have"},
    {NULL, NULL, "{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}", NULL,
     "{\"buffer\":0,\"byteOffset\":31,\"byteLength\":4}", "index 63 of a face is out of range"},
    {NULL,
     "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":4,\"indices\":{"
     "\"bufferView\":1,\"componentType\":5123},\"values\":{\"bufferView\":0}}}",
     NULL, NULL, NULL, "more than its items"},
    {NULL,
     "{\"bufferView\":0,\"componentType\":5126,\"count\":2,\"type\":\"VEC3\",\"sparse\":{\"count\":2,\"indices\":{"
     "\"bufferView\":1,\"byteOffset\":2,\"componentType\":5123},\"values\":{\"bufferView\":0}}}",
     NULL, NULL, NULL, "sparse value 2 of an accessor that has 2 items"},
    {NULL,
     "{\"componentType\":5126,\"count\":400000000,\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":{"
     "\"bufferView\":1,\"componentType\":5123},\"values\":{\"bufferView\":0}}}",
     NULL, NULL, NULL, "400000000 items has no view"},
    {"\"meshes\":[{\"primitives\":[{\"mode\":7,\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}]", NULL,
     NULL, NULL, NULL, "mode 7"},
    {"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":9}}]}],\"nodes\":[{\"mesh\":0}]", NULL, NULL, NULL,
     NULL, "POSITION is not there"},
    {"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":2}}]}],\"nodes\":[{\"mesh\":0}]", NULL,
     NULL, NULL, NULL, "2 items of NORMAL, where there should be"},
    {"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":5}]}],\"nodes\":[{\"mesh\":0}]", NULL,
     NULL, NULL, NULL, "accessor is not there"},
    {"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":1}]", NULL, NULL, NULL,
     NULL, "node's mesh is not there (line 1)"},
    {"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":4}]}],\"nodes\":[{\"mesh\":0}]", NULL,
     NULL, NULL, NULL, "material is not there"},
    {"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0,\"rotation\":[0,0,0,0]}"
     "]",
     NULL, NULL, NULL, NULL, "rotation is none"},
    {"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0,\"scale\":[1,1]}]", NULL,
     NULL, NULL, NULL, "another number of numbers (line 1)"},
    {"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"extensions\":{\"KHR_draco_mesh_compression\":{"
     "\"attributes\":{\"POSITION\":1}}}}]}],\"nodes\":[{\"mesh\":0}]",
     "{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}", NULL, NULL, NULL, "have no data"},
    {"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":2}}]}],\"nodes\":[{\"mesh\":0,\"extensions\":{"
     "\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":0,\"SCALE\":2}}}}]",
     "{\"bufferView\":0,\"componentType\":5126,\"count\":0,\"type\":\"VEC3\"}", NULL, NULL, NULL,
     "SCALE of instances are of another type or number"},
    {"\"scene\":3,\"meshes\":[],\"nodes\":[]", NULL, NULL, NULL, NULL, "neither faces nor points"},
    {"\"scene\":3,\"nodes\":[{}]", NULL, NULL, NULL, NULL, "scene is not there"},
};

static void check_wrong(const wrong_file *f) {
  static const double places[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  static const gltf_storage floats = {GLTF_FLOAT, 0, 0, 0}, shorts = {GLTF_UINT16, 0, 0, 0};
  static gltf_file file;
  static mesh_file bytes;
  static const double corners[3] = {0, 1, 2};
  memset(&file, 0, sizeof file);
  gltf_put(&file, floats, 3, places[0], 3);
  gltf_put(&file, shorts, 1, corners, 3);
  file.accessors.n = file.views.n = 0;
  mesh_text(&file.accessors, "%s,%s,{\"bufferView\":0,\"componentType\":5126,\"count\":2,\"type\":\"VEC3\"}",
            f->accessor ? f->accessor : ACCESSOR, f->indices ? f->indices : INDICES);
  mesh_text(&file.views, "%s,%s", f->view ? f->view : VIEW, f->last_view ? f->last_view : LAST_VIEW);
  gltf_make(&bytes, &file, GLTF_GLB, f->mesh ? f->mesh : MESH);
  conic_triangles t;
  const char *path = files_write_bytes("a.glb", bytes.bytes, bytes.n);
  conic_status status = conic_triangles_read(context, path, &t);
  if (f->message)
    files_check_failed(f->message, status, "a.glb: ", f->message, (const char *)NULL);
  else
    CHECK(status == CONIC_OK && t.count == 1 && t.position[0][1] == 1.0f);
  conic_triangles_release(context, &t);
  CHECK(unlink(path) == 0);
}

/* A file that is cut off anywhere is refused. */
static void test_cut(void) {
  static mesh_file whole;
  whole.n = 0;
  mesh_glb(&whole);
  for (size_t n = 4; n + 200 < whole.n; n += 7) {
    conic_model model;
    const char *path = files_write_bytes("a.glb", whole.bytes, n);
    files_check_failed("cut", conic_model_read(context, path, NULL, &model), "a.glb: ", (const char *)NULL);
    CHECK(unlink(path) == 0);
  }
}

/* Whatever byte of a file is wrong, the file is read or refused with one message, and no index leads astray. */
static void test_spoiled(void) {
  static mesh_file whole;
  gltf_make_rich(&whole, GLTF_GLB);
  for (size_t i = 0; i < whole.n; i++) {
    conic_triangles t;
    whole.bytes[i] ^= i % 3 ? 0x04 : 0xFF;
    const char *path = files_write_bytes("a.glb", whole.bytes, whole.n);
    files_message[0] = 0;
    conic_status status = conic_triangles_read(context, path, &t);
    CHECK(status == CONIC_OK || (status == CONIC_ERROR_INPUT && files_message[0]));
    CHECK(conic_triangles_check(context, &t, "spoiled") == CONIC_OK);
    conic_triangles_release(context, &t);
    whole.bytes[i] ^= i % 3 ? 0x04 : 0xFF;
    CHECK(unlink(path) == 0);
  }
}

/* Where the parts of such a file are, as far as its two drawn nodes go. */
static void test_whole(void) {
  static mesh_file whole;
  conic_triangles t;
  double low[3], high[3];
  for (int i = 0; i < 2; i++) {
    gltf_make_rich(&whole, i ? GLTF_GLB : GLTF_EMBEDDED);
    const char *path = files_write_bytes("a.glb", whole.bytes, whole.n);
    CHECK_OK(conic_triangles_read(context, path, &t));
    conic_triangles_bounds(&t, low, high);
    CHECK(t.count == 6 && t.n_materials == 3);
    CHECK_NEAR(low[0], -1.5, 1e-6);
    CHECK_NEAR(high[0], 0.0, 1e-6);
    CHECK_NEAR(low[1], -5.5, 1e-6);
    CHECK_NEAR(high[1], 1.0, 1e-6);
    conic_triangles_release(context, &t);
    CHECK(unlink(path) == 0);
  }
}

int main(void) {
  context = files_context();
  for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    check_wrong(&files[i]);
  test_cut();
  test_whole();
  test_spoiled();
  files_end(context);
  return check_result();
}
