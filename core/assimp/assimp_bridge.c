/* Assimp's scene as records: the meshes where their nodes place them. */
#include "core/assimp/assimp_bridge.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "conic/export.h"
#include "conic/version.h"
#include "core/assimp/assimp_writer_bridge.h"
#include "core/base/vectors.h"

enum { BLOCK = 1024, MOST_NOTES = 4 };

/* Rows of world from mesh, in double, and the rows that turn normals. */
typedef struct placement {
  double rows[3][4], normal_rows[3][3];
  int is_mirrored;
} placement;

static placement place_below(const placement *parent, const struct aiMatrix4x4 *m) {
  const double own[4][4] = {{(double)m->a1, (double)m->a2, (double)m->a3, (double)m->a4},
                            {(double)m->b1, (double)m->b2, (double)m->b3, (double)m->b4},
                            {(double)m->c1, (double)m->c2, (double)m->c3, (double)m->c4},
                            {0.0, 0.0, 0.0, 1.0}};
  placement product;
  for (int row = 0; row < 3; row++)
    for (int column = 0; column < 4; column++) {
      double sum = 0.0;
      for (int k = 0; k < 4; k++)
        sum += parent->rows[row][k] * own[k][column];
      product.rows[row][column] = sum;
    }
  return product;
}

/* What is sent of the vertices of a mesh. */
typedef struct sent_vertices {
  const conic_assimp_writer *w;
  const struct aiMesh *mesh;
  const placement *place;
  const struct aiVector3D *coordinates;
} sent_vertices;

/* Writes so much of vertex i to the record's place. */
typedef void vertex_writer(const sent_vertices *v, unsigned i, void *to);

static void send_vertices(conic_assimp_writer *w, const sent_vertices *v, vertex_writer *write, size_t size) {
  double block[BLOCK][3];
  for (unsigned done = 0, m; done < v->mesh->mNumVertices; done += m) {
    m = v->mesh->mNumVertices - done < BLOCK ? v->mesh->mNumVertices - done : BLOCK;
    for (unsigned i = 0; i < m; i++)
      write(v, done + i, (char *)block + i * size);
    conic_assimp_send_bytes(w, block, m * size);
  }
}

static void write_position(const sent_vertices *v, unsigned i, void *to) {
  const struct aiVector3D *p = &v->mesh->mVertices[i];
  for (int row = 0; row < 3; row++) {
    const double *r = v->place->rows[row];
    ((double *)to)[row] = r[0] * (double)p->x + r[1] * (double)p->y + r[2] * (double)p->z + r[3];
  }
}

static void write_normal(const sent_vertices *v, unsigned i, void *to) {
  const struct aiVector3D *n = &v->mesh->mNormals[i];
  for (int row = 0; row < 3; row++) {
    const double *r = v->place->normal_rows[row];
    ((float *)to)[row] = (float)(r[0] * (double)n->x + r[1] * (double)n->y + r[2] * (double)n->z);
  }
}

static void write_coordinate(const sent_vertices *v, unsigned i, void *to) {
  ((float *)to)[0] = (float)v->coordinates[i].x;
  ((float *)to)[1] = (float)v->coordinates[i].y;
}

/* Transparent black means no colour in .amf files. */
static void write_color(const sent_vertices *v, unsigned i, void *to) {
  const struct aiColor4D *color = &v->mesh->mColors[0][i];
  int is_unset = color->a <= 0 && strcmp(v->w->request->ending, "amf") == 0;
  ((float *)to)[0] = is_unset ? 1.0f : (float)color->r;
  ((float *)to)[1] = is_unset ? 1.0f : (float)color->g;
  ((float *)to)[2] = is_unset ? 1.0f : (float)color->b;
}

static void send_triangles(conic_assimp_writer *w, const struct aiMesh *mesh, int is_mirrored) {
  const unsigned second = is_mirrored ? 2 : 1, third = is_mirrored ? 1 : 2;
  uint32_t block[BLOCK][3];
  size_t m = 0;
  for (unsigned i = 0; i < mesh->mNumFaces; i++) {
    if (mesh->mFaces[i].mNumIndices != 3)
      continue;
    block[m][0] = mesh->mFaces[i].mIndices[0];
    block[m][1] = mesh->mFaces[i].mIndices[second];
    block[m][2] = mesh->mFaces[i].mIndices[third];
    if (++m == BLOCK) {
      conic_assimp_send_bytes(w, block, sizeof block);
      m = 0;
    }
  }
  conic_assimp_send_bytes(w, block, m * sizeof block[0]);
}

static size_t count_faces(const struct aiMesh *mesh, unsigned n_corners) {
  size_t n = 0;
  for (unsigned i = 0; i < mesh->mNumFaces; i++)
    n += mesh->mFaces[i].mNumIndices == n_corners;
  return n;
}

/* A mesh where a node places it; points only where no mesh has triangles. */
static void send_mesh(conic_assimp_writer *w, const struct aiMesh *mesh, const placement *place) {
  size_t n_triangles = count_faces(mesh, 3);
  int is_points = !w->has_triangles && (count_faces(mesh, 1) || mesh->mNumFaces == 0);
  if (!mesh->mVertices || mesh->mNumVertices == 0 || (n_triangles == 0 && !is_points))
    return;
  const struct aiVector3D *coordinates =
      w->request->keeps_faces ? mesh->mTextureCoords[conic_assimp_coordinates(w, mesh)] : NULL;
  conic_assimp_record record = {.type = CONIC_ASSIMP_PART,
                                .n_vertices = mesh->mNumVertices,
                                .n_triangles = n_triangles,
                                .i_material = w->request->keeps_faces ? conic_assimp_material(w, mesh) : UINT32_MAX};
  record.fields = (mesh->mNormals ? CONIC_ASSIMP_NORMALS : 0u) | (coordinates ? CONIC_ASSIMP_COORDINATES : 0u) |
                  (mesh->mColors[0] ? CONIC_ASSIMP_COLORS : 0u);
  conic_assimp_send_bytes(w, &record, sizeof record);
  const sent_vertices v = {w, mesh, place, coordinates};
  send_vertices(w, &v, write_position, 3 * sizeof(double));
  if (mesh->mNormals)
    send_vertices(w, &v, write_normal, 3 * sizeof(float));
  if (coordinates)
    send_vertices(w, &v, write_coordinate, 2 * sizeof(float));
  if (mesh->mColors[0])
    send_vertices(w, &v, write_color, 3 * sizeof(float));
  send_triangles(w, mesh, place->is_mirrored);
}

static void send_node(conic_assimp_writer *w, const struct aiNode *node, const placement *parent) {
  placement place = place_below(parent, &node->mTransformation);
  place.is_mirrored = conic_normal_rows((const double(*)[4])place.rows, place.normal_rows);
  for (unsigned i = 0; i < node->mNumMeshes && !w->is_failed; i++)
    if (node->mMeshes[i] < w->scene->mNumMeshes)
      send_mesh(w, w->scene->mMeshes[node->mMeshes[i]], &place);
  for (unsigned i = 0; i < node->mNumChildren && !w->is_failed; i++)
    send_node(w, node->mChildren[i], &place);
}

static int find_number(const struct aiMetadata *data, const char *key, int none) {
  for (unsigned i = 0; data && i < data->mNumProperties; i++)
    if (strcmp(data->mKeys[i].data, key) == 0 && data->mValues[i].mType == AI_INT32)
      return *(const int32_t *)data->mValues[i].mData;
  return none;
}

/* Which way is up in Assimp's scene: Assimp has turned DAE, 3DS and DXF by it already. */
static void find_scene_up(const conic_assimp_writer *w, double up[3]) {
  static const char *const z_up[] = {"3mf", "amf"};
  int axis = 1;
  for (size_t i = 0; i < sizeof z_up / sizeof z_up[0]; i++)
    if (strcmp(w->request->ending, z_up[i]) == 0)
      axis = 2;
  double sign = 1.0;
  if (strcmp(w->request->ending, "fbx") == 0) {
    axis = find_number(w->scene->mMetaData, "UpAxis", 1);
    sign = find_number(w->scene->mMetaData, "UpAxisSign", 1) < 0 ? -1.0 : 1.0;
  }
  if (axis >= 0 && axis < 3)
    up[axis] = sign;
}

static void send_scene(conic_assimp_writer *w) {
  static const placement world = {.rows = {{1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}}};
  conic_assimp_record end = {.type = CONIC_ASSIMP_END};
  w->sent = malloc((w->scene->mNumMaterials + 1u) * sizeof *w->sent);
  if (!w->sent) {
    conic_assimp_send_failure(w, "out of memory");
    return;
  }
  for (unsigned i = 0; i < w->scene->mNumMaterials; i++)
    w->sent[i] = -1;
  for (unsigned i = 0; i < w->scene->mNumMeshes; i++)
    w->has_triangles |= count_faces(w->scene->mMeshes[i], 3) > 0;
  if (w->scene->mRootNode)
    send_node(w, w->scene->mRootNode, &world);
  find_scene_up(w, end.up);
  conic_assimp_send_bytes(w, &end, sizeof end);
  free(w->sent);
}

/* Listens to Assimp's messages for those that say that part of the file is left out, or may not be. */
static void hear(const char *message, char *cookie) {
  static const char *const told[] = {"drop", "nvalid", "incorrect", "unexpected", "empty"};
  conic_assimp_writer *w = (conic_assimp_writer *)cookie;
  const char *text = strstr(message, ": ");
  if (strncmp(message, "Warn", 4) != 0 || !text)
    return;
  text += 2;
  if (strstr(text, "out-of-range")) {
    w->why_refused = "a face's index is out of range";
    return;
  }
  for (size_t i = 0; i < sizeof told / sizeof told[0] && w->n_notes < MOST_NOTES; i++)
    if (strstr(text, told[i])) {
      conic_assimp_send(w, (conic_assimp_record){.type = CONIC_ASSIMP_NOTE}, text, strlen(text));
      w->n_notes++;
      break;
    }
}

static const struct aiScene *import(conic_assimp_writer *w) {
  struct aiFileIO io = conic_assimp_files(w);
  struct aiLogStream stream = {hear, (char *)w};
  struct aiPropertyStore *properties = aiCreatePropertyStore();
  aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, 0);
  aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_FBX_READ_WEIGHTS, 0);
  aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
  aiAttachLogStream(&stream);
  return aiImportFileExWithProperties(w->request->name, aiProcess_Triangulate | aiProcess_TransformUVCoords, &io,
                                      properties);
}

static void read_and_end(conic_assimp_request *request) {
  conic_assimp_settle(request);
  conic_assimp_writer w = {.request = request};
  w.scene = import(&w);
  const char *why = w.why_refused ? w.why_refused : aiGetErrorString();
  if (w.scene && !w.why_refused)
    send_scene(&w);
  else
    conic_assimp_send_failure(&w,
                              strstr(why, "bad_alloc") ? "it takes more memory than a file of its size should" : why);
  _exit(0);
}

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

CONIC_API extern const conic_assimp_bridge_functions conic_assimp_bridge;
const conic_assimp_bridge_functions conic_assimp_bridge = {
    TEXT(CONIC_VERSION_MAJOR) "." TEXT(CONIC_VERSION_MINOR) "." TEXT(CONIC_VERSION_PATCH), read_and_end};
