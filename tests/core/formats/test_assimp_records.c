/* What the process that reads through Assimp writes is put together, and not believed: here it is a file. */
#include <fcntl.h>

#include "core/assimp/assimp_read.h"
#include "tests/support/files.h"
#include "tests/support/mesh_file.h"

static conic_context *context;
static mesh_file records;

static void put_record(conic_assimp_record record, const void *bytes) {
  mesh_put(&records, &record, sizeof record);
  mesh_put(&records, bytes, (size_t)record.n_bytes);
}

/* Two triangles at an angle: corners 1 and 2 of both are at the same places, with normals of their own. */
static void put_part(uint32_t last_index) {
  static const double places[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  static const float normals[6][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  const uint32_t triangles[2][3] = {{0, 1, 2}, {3, 4, last_index}};
  put_record(
      (conic_assimp_record){
          .type = CONIC_ASSIMP_PART, .fields = CONIC_ASSIMP_NORMALS, .n_vertices = 6, .n_triangles = 2},
      "");
  mesh_put(&records, places, sizeof places);
  mesh_put(&records, normals, sizeof normals);
  mesh_put(&records, triangles, sizeof triangles);
}

/* Reads the records that were put, as if of a file "a.fbx". */
static conic_status read_records(conic_model *model) {
  const char *path = files_write_bytes("records", records.bytes, records.n);
  conic_input input = {.context = context, .name = "a.fbx"};
  conic_assimp_process process = {.context = context, .name = "a.fbx", .descriptor = open(path, O_RDONLY)};
  conic_read_options options;
  conic_read_options_init(&options);
  options.keeps_faces = 1;
  conic_status status = conic_assimp_read_records(&input, &process, &options, model);
  conic_assimp_process_end(&process);
  CHECK(unlink(path) == 0);
  records.n = 0;
  return status;
}

static void test_model(void) {
  static const unsigned char texels[2][4] = {{255, 0, 51, 255}, {0, 0, 255, 255}};
  conic_model model;
  conic_triangles t;
  put_record((conic_assimp_record){.type = CONIC_ASSIMP_OPENED, .n_bytes = 5}, "b.bin");
  put_record((conic_assimp_record){.type = CONIC_ASSIMP_MATERIAL,
                                   .color = {1, 0.2f, 0},
                                   .picture = CONIC_ASSIMP_TEXELS,
                                   .width = 2,
                                   .height = 1,
                                   .n_bytes = sizeof texels},
             texels);
  put_part(5);
  put_record((conic_assimp_record){.type = CONIC_ASSIMP_END, .up = {0, 0, -1}}, "");
  CHECK_OK(read_records(&model));
  CHECK(model.points.count == 4 && model.n_triangles == 2 && model.up[2] == -1.0);
  CHECK(model.triangles[1][0] == 1 && model.triangles[1][1] == 3 && model.triangles[1][2] == 2);
  CHECK_NEAR(model.points.normal[0][1], sqrt(0.5), 1e-6); /* the mean of both */
  CHECK_OK(conic_triangles_take(context, &model, &t));
  CHECK_OK(conic_triangles_check(context, &t, "a.fbx"));
  CHECK(t.normal[2][t.normal_corners[0][1]] == 1.0f && t.normal[0][t.normal_corners[1][0]] == 1.0f);
  CHECK(t.n_materials == 2 && t.material[1] == 0 && conic_texture_width(t.materials[0].texture) == 2);
  CHECK(t.materials[0].color[0] == 1.0f && t.materials[0].color[1] == (float)0.033104766570885055); /* code 51 */
  conic_triangles_release(context, &t);
  conic_model_release(context, &model);
}

static void check_refused(const char *what) {
  conic_model model;
  files_check_failed(what, read_records(&model), "a.fbx: ", what, (const char *)NULL);
  conic_model_release(context, &model);
}

static void test_refused(void) {
  const conic_assimp_record end = {.type = CONIC_ASSIMP_END};
  put_part(6);
  put_record(end, "");
  check_refused("index 6");
  put_part(5);
  check_refused("does not survive"); /* it has ended without its last word */
  put_part(5);
  records.n -= 4;
  check_refused("does not survive");
  put_record(end, "");
  check_refused("neither faces nor points");
  put_record((conic_assimp_record){.type = CONIC_ASSIMP_PART, .n_triangles = 1}, "");
  check_refused("no vertices");
  put_record((conic_assimp_record){.type = CONIC_ASSIMP_PART, .n_vertices = UINT64_MAX}, "");
  check_refused("too many");
  put_record((conic_assimp_record){.type = CONIC_ASSIMP_PART, .n_vertices = 1, .n_triangles = UINT64_MAX}, "");
  check_refused("too many");
  put_record((conic_assimp_record){.type = CONIC_ASSIMP_MATERIAL, .picture = CONIC_ASSIMP_TEXELS, .width = 9}, "");
  check_refused("texels");
  put_record((conic_assimp_record){.type = 77}, "");
  check_refused("lost its way");
  put_record((conic_assimp_record){.type = CONIC_ASSIMP_FAILED, .n_bytes = 12}, "it is\nso.\n\n ");
  check_refused("cannot read: it is");
  CHECK(!strchr(files_message, '\n'));
}

int main(void) {
  context = files_context();
  test_model();
  test_refused();
  files_end(context);
  return check_result();
}
