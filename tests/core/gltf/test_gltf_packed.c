/* What is packed in glTF: by Draco, by meshopt, each where its library is there, else refused by its name. */
#include "tests/support/files.h"
#include "tests/support/gltf_packed.h"

static conic_context *context;

static int is_refused(const char *name, conic_status status) {
  int is_without = status != CONIC_OK && strstr(files_message, name) && strstr(files_message, "this build is without");
  if (is_without)
    fprintf(stderr, "%s\n", files_message);
  return is_without;
}

/* Both triangles of the square, from the front. */
static void check_square(const conic_triangles *t) {
  double low[3], high[3], area = 0.0;
  conic_triangles_bounds(t, low, high);
  CHECK(t->count == 2 && t->n_vertices == 4);
  for (int axis = 0; axis < 3; axis++) {
    CHECK_NEAR(low[axis], 0.0, 1e-6);
    CHECK_NEAR(high[axis], axis < 2 ? 1.0 : 0.0, 1e-6);
  }
  for (size_t i = 0; i < t->count; i++) {
    double p[3][2];
    for (int k = 0; k < 3; k++)
      for (int axis = 0; axis < 2; axis++)
        p[k][axis] = (double)t->position[axis][t->corners[i][k]];
    area += 0.5 * ((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]));
  }
  CHECK_NEAR(area, 1.0, 1e-6);
}

static void read_and_check(const gltf_file *file, const char *rest, const char *extension, const char *wrong) {
  static mesh_file bytes;
  conic_triangles t;
  gltf_make(&bytes, file, GLTF_GLB, rest);
  const char *path = files_write_bytes("a.glb", bytes.bytes, bytes.n);
  conic_status status = conic_triangles_read(context, path, &t);
  CHECK(unlink(path) == 0);
  if (is_refused(extension, status))
    return;
  if (wrong)
    files_check_failed(extension, status, "a.glb: ", wrong, (const char *)NULL);
  else {
    CHECK_OK(status);
    if (status != CONIC_OK)
      fprintf(stderr, "%s: %s\n", extension, files_message);
    check_square(&t);
  }
  conic_triangles_release(context, &t);
}

static void check_draco(size_t cut, int spoiled, int count, const char *wrong) {
  static gltf_file file;
  const char *rest = gltf_draco(&file, cut, count);
  if (spoiled)
    file.buffer.bytes[spoiled] ^= 0x55;
  read_and_check(&file, rest, "KHR_draco_mesh_compression", wrong);
}

static void test_draco(void) {
  check_draco(0, 0, 4, NULL);
  check_draco(40, 0, 4, "spoiled");
  check_draco(0, 2, 4, "spoiled");
  check_draco(0, 0, 5, "4 items of POSITION, where there should be");
}

static void check_meshopt(const char *mode, size_t cut, int count, const char *wrong) {
  static gltf_file file;
  const char *rest = gltf_meshopt(&file, mode, cut, count);
  read_and_check(&file, rest, "EXT_meshopt_compression", wrong);
}

static void test_meshopt(void) {
  check_meshopt("TRIANGLES", 0, 4, NULL);
  check_meshopt("INDICES", 0, 4, NULL);
  check_meshopt("TRIANGLES", 8, 4, "spoiled");
  check_meshopt("NONSENSE", 0, 4, "spoiled");
  check_meshopt("TRIANGLES", 0, 5, "another length than its items");
}

int main(void) {
  context = files_context();
  test_draco();
  test_meshopt();
  files_end(context);
  return check_result();
}
