/* One small mesh as a file of every kind that is read through Assimp, made by hand: four corners, four faces. */
#pragma once

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/message.h"
#include "tests/support/png_file.h"

static const float mesh_corners[4][3] = {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 1}};
static const uint16_t mesh_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
static const float mesh_coordinates[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}}; /* from the picture's top left */

typedef struct mesh_file {
  unsigned char bytes[1 << 15];
  size_t n;
} mesh_file;

static inline void mesh_put(mesh_file *file, const void *bytes, size_t n) {
  if (file->n + n > sizeof file->bytes)
    exit(1);
  memcpy(file->bytes + file->n, bytes, n);
  file->n += n;
}

static inline void mesh_text(mesh_file *file, const char *format, ...) CONIC_AS_PRINTF(2, 3);
static inline void mesh_text(mesh_file *file, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  int n = vsnprintf((char *)file->bytes + file->n, sizeof file->bytes - file->n, format, arguments);
  va_end(arguments);
  if (n < 0 || (size_t)n >= sizeof file->bytes - file->n)
    exit(1);
  file->n += (size_t)n;
}

/* The lowest n bytes. */
static inline void mesh_number(mesh_file *file, uint32_t value, size_t n) {
  for (size_t i = 0; i < n; i++)
    mesh_put(file, &(unsigned char){(unsigned char)(value >> 8 * i)}, 1);
}

/* All corners, or those of all faces, as text: BEFORE x y z AFTER. */
static inline void mesh_corner_lines(mesh_file *file, const char *before, const char *after) {
  for (int i = 0; i < 4; i++)
    mesh_text(file, "%s%g %g %g%s", before, (double)mesh_corners[i][0], (double)mesh_corners[i][1],
              (double)mesh_corners[i][2], after);
}

static inline void mesh_face_lines(mesh_file *file, const char *before, const char *between, const char *after) {
  for (int i = 0; i < 4; i++)
    mesh_text(file, "%s%d%s%d%s%d%s", before, mesh_faces[i][0], between, mesh_faces[i][1], between, mesh_faces[i][2],
              after);
}

static inline void mesh_obj(mesh_file *file) {
  mesh_corner_lines(file, "v ", "\n");
  for (int i = 0; i < 4; i++)
    mesh_text(file, "f %d %d %d\n", mesh_faces[i][0] + 1, mesh_faces[i][1] + 1, mesh_faces[i][2] + 1);
}

static inline void mesh_stl_text(mesh_file *file) {
  mesh_text(file, "solid by hand\n");
  for (int i = 0; i < 4; i++) {
    mesh_text(file, "facet normal 0 0 0\nouter loop\n");
    for (int k = 0; k < 3; k++) {
      const float *corner = mesh_corners[mesh_faces[i][k]];
      mesh_text(file, "vertex %g %g %g\n", (double)corner[0], (double)corner[1], (double)corner[2]);
    }
    mesh_text(file, "endloop\nendfacet\n");
  }
  mesh_text(file, "endsolid by hand\n");
}

/* The header begins as that of a text, which programs do write. */
static inline void mesh_stl(mesh_file *file) {
  char header[80] = "solid by a program";
  mesh_put(file, header, sizeof header);
  mesh_number(file, 4, 4);
  for (int i = 0; i < 4; i++) {
    mesh_put(file, (const float[3]){0, 0, 7}, 12);
    for (int k = 0; k < 3; k++)
      mesh_put(file, mesh_corners[mesh_faces[i][k]], 12);
    mesh_number(file, 0, 2);
  }
}

static inline void mesh_off(mesh_file *file) {
  mesh_text(file, "OFF\n4 4 6\n");
  mesh_corner_lines(file, "", "\n");
  mesh_face_lines(file, "3 ", " ", "\n");
}

/* Corners, their coordinates, faces: what both kinds of glTF hold. */
enum { MESH_BUFFER_BYTES = 48 + 32 + 24 };

static inline void mesh_buffer(mesh_file *file) {
  mesh_put(file, mesh_corners, sizeof mesh_corners);
  mesh_put(file, mesh_coordinates, sizeof mesh_coordinates);
  mesh_put(file, mesh_faces, sizeof mesh_faces);
}

static inline void mesh_base64(mesh_file *file, const unsigned char *bytes, size_t n) {
  static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < n; i += 3) {
    uint32_t bits = (uint32_t)bytes[i] << 16 | (i + 1 < n ? (uint32_t)bytes[i + 1] << 8 : 0) |
                    (i + 2 < n ? (uint32_t)bytes[i + 2] : 0);
    mesh_text(file, "%c%c%c%c", letters[bits >> 18], letters[bits >> 12 & 63],
              i + 1 < n ? letters[bits >> 6 & 63] : '=', i + 2 < n ? letters[bits & 63] : '=');
  }
}

/* All but where the bytes of the buffer and of the picture are: `buffer` and `image` say so. The scene is node 0. */
static inline void mesh_gltf_json(mesh_file *file, const char *buffer, const char *nodes, const char *material,
                                  const char *image, size_t image_bytes) {
  mesh_text(file,
            "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[%s],"
            "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"indices\":2%s}]}],"
            "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],"
            "\"max\":[3,2,1]},{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
            "{\"bufferView\":2,\"componentType\":5123,\"count\":12,\"type\":\"SCALAR\"}],"
            "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":32},"
            "{\"buffer\":0,\"byteOffset\":80,\"byteLength\":24}",
            nodes, material[0] ? ",\"material\":0" : "");
  if (image_bytes)
    mesh_text(file, ",{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":%zu}", MESH_BUFFER_BYTES, image_bytes);
  mesh_text(file, "],\"buffers\":[{\"byteLength\":%zu%s", MESH_BUFFER_BYTES + image_bytes, buffer);
  if (!buffer[0] && !image_bytes) {
    mesh_file bytes = {.n = 0};
    mesh_buffer(&bytes);
    mesh_text(file, ",\"uri\":\"data:application/octet-stream;base64,");
    mesh_base64(file, bytes.bytes, bytes.n);
    mesh_text(file, "\"");
  }
  mesh_text(file, "}]");
  if (material[0])
    mesh_text(file, ",\"materials\":[{\"pbrMetallicRoughness\":{%s}}]", material);
  if (image[0])
    mesh_text(file, ",\"textures\":[{\"source\":0}],\"images\":[%s]", image);
  mesh_text(file, "}");
}

/* A picture of 2 × 2 in the file; a node doubles the mesh, and the one above moves it. */
static inline void mesh_glb(mesh_file *file) {
  static const png_kind picture = {.width = 2, .height = 2, .kind = PNG_COLOR, .depth = 8};
  png_file png;
  mesh_file json = {.n = 0};
  png_make(&png, &picture);
  mesh_gltf_json(&json, "", "{\"children\":[1],\"translation\":[10,0,0]},{\"mesh\":0,\"scale\":[2,2,2]}",
                 "\"baseColorFactor\":[0.5,1,0.25,1],\"baseColorTexture\":{\"index\":0}",
                 "{\"mimeType\":\"image/png\",\"bufferView\":3}", png.n_bytes);
  while (json.n % 4)
    mesh_put(&json, " ", 1);
  size_t n = MESH_BUFFER_BYTES + png.n_bytes, n_padded = (n + 3) / 4 * 4;
  mesh_put(file, "glTF\2\0\0\0", 8);
  mesh_number(file, (uint32_t)(12 + 8 + json.n + 8 + n_padded), 4);
  mesh_number(file, (uint32_t)json.n, 4);
  mesh_put(file, "JSON", 4);
  mesh_put(file, json.bytes, json.n);
  mesh_number(file, (uint32_t)n_padded, 4);
  mesh_put(file, "BIN\0", 4);
  mesh_buffer(file);
  mesh_put(file, png.bytes, png.n_bytes);
  mesh_put(file, "\0\0\0", n_padded - n);
}

static inline void mesh_gltf(mesh_file *file) {
  mesh_gltf_json(file, "", "{\"mesh\":0}", "", "", 0);
}

static inline void mesh_dae(mesh_file *file) {
  mesh_text(file, "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
                  "version=\"1.4.1\"><asset><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id=\"g\">"
                  "<mesh><source id=\"p\"><float_array id=\"a\" count=\"12\">");
  mesh_corner_lines(file, "", " ");
  mesh_text(file, "</float_array><technique_common><accessor source=\"#a\" count=\"4\" stride=\"3\"><param name=\"X\" "
                  "type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor>"
                  "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/>"
                  "</vertices><triangles count=\"4\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>");
  mesh_face_lines(file, "", " ", " ");
  mesh_text(file,
            "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id=\"s\">"
            "<node id=\"n\"><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes><scene>"
            "<instance_visual_scene url=\"#s\"/></scene></COLLADA>\n");
}

/* A polygon's last corner is written as its complement. */
static inline void mesh_fbx(mesh_file *file) {
  mesh_text(file, "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7300\n}\n"
                  "GlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n"
                  "\t\tP: \"UpAxis\", \"int\", \"Integer\", \"\",2\n\t\tP: \"UpAxisSign\", \"int\", \"Integer\", "
                  "\"\",1\n\t}\n}\nDefinitions:  {\n\tVersion: 100\n\tCount: 2\n}\nObjects:  {\n\tGeometry: 1000, "
                  "\"Geometry::\", \"Mesh\" {\n\t\tVertices: *12 {\n\t\t\ta: ");
  for (int i = 0; i < 12; i++)
    mesh_text(file, "%s%g", i ? "," : "", (double)mesh_corners[i / 3][i % 3]);
  mesh_text(file, "\n\t\t}\n\t\tPolygonVertexIndex: *12 {\n\t\t\ta: ");
  for (int i = 0; i < 4; i++)
    mesh_text(file, "%s%d,%d,%d", i ? "," : "", mesh_faces[i][0], mesh_faces[i][1], ~(int)mesh_faces[i][2]);
  mesh_text(file,
            "\n\t\t}\n\t\tGeometryVersion: 124\n\t}\n\tModel: 2000, \"Model::mesh\", \"Mesh\" {\n\t\tVersion: 232\n"
            "\t}\n}\nConnections:  {\n\tC: \"OO\",2000,0\n\tC: \"OO\",1000,2000\n}\n");
}

static inline void mesh_x3d(mesh_file *file) {
  mesh_text(file, "<?xml version=\"1.0\"?>\n<X3D profile=\"Interchange\" version=\"3.0\"><Scene><Shape><Appearance>"
                  "<Material diffuseColor=\"1 1 1\"/></Appearance><IndexedFaceSet coordIndex=\"");
  mesh_face_lines(file, "", " ", " -1 ");
  mesh_text(file, "\"><Coordinate point=\"");
  mesh_corner_lines(file, "", " ");
  mesh_text(file, "\"/></IndexedFaceSet></Shape></Scene></X3D>\n");
}

static inline void mesh_amf(mesh_file *file) {
  mesh_text(file, "<?xml version=\"1.0\"?>\n<amf unit=\"millimeter\"><object id=\"0\"><mesh><vertices>");
  for (int i = 0; i < 4; i++)
    mesh_text(file, "<vertex><coordinates><x>%g</x><y>%g</y><z>%g</z></coordinates></vertex>",
              (double)mesh_corners[i][0], (double)mesh_corners[i][1], (double)mesh_corners[i][2]);
  mesh_text(file, "</vertices><volume>");
  for (int i = 0; i < 4; i++)
    mesh_text(file, "<triangle><v1>%d</v1><v2>%d</v2><v3>%d</v3></triangle>", mesh_faces[i][0], mesh_faces[i][1],
              mesh_faces[i][2]);
  mesh_text(file, "</volume></mesh></object></amf>\n");
}

/* Faces with four corners, of which the last two are one. */
static inline void mesh_dxf(mesh_file *file) {
  mesh_text(file, "  0\nSECTION\n  2\nENTITIES\n");
  for (int i = 0; i < 4; i++) {
    mesh_text(file, "  0\n3DFACE\n  8\n0\n");
    for (int k = 0; k < 4; k++) {
      const float *corner = mesh_corners[mesh_faces[i][k < 3 ? k : 2]];
      for (int axis = 0; axis < 3; axis++)
        mesh_text(file, " %d\n%g\n", 10 * (axis + 1) + k, (double)corner[axis]);
    }
  }
  mesh_text(file, "  0\nENDSEC\n  0\nEOF\n");
}

static inline void mesh_3ds(mesh_file *file) {
  enum { VERTICES = 6 + 2 + 48, FACES = 6 + 2 + 32, MESH = 6 + VERTICES + FACES, OBJECT = 6 + 2 + MESH };
  const uint32_t chunks[][2] = {{0x4D4D, 6 + 6 + OBJECT}, {0x3D3D, 6 + OBJECT}, {0x4000, OBJECT}};
  for (int i = 0; i < 3; i++) {
    mesh_number(file, chunks[i][0], 2);
    mesh_number(file, chunks[i][1], 4);
  }
  mesh_put(file, "m", 2);
  mesh_number(file, 0x4100, 2);
  mesh_number(file, MESH, 4);
  mesh_number(file, 0x4110, 2);
  mesh_number(file, VERTICES, 4);
  mesh_number(file, 4, 2);
  mesh_put(file, mesh_corners, sizeof mesh_corners);
  mesh_number(file, 0x4120, 2);
  mesh_number(file, FACES, 4);
  mesh_number(file, 4, 2);
  for (int i = 0; i < 4; i++) {
    mesh_put(file, mesh_faces[i], 6);
    mesh_number(file, 7, 2);
  }
}

typedef struct mesh_entry {
  const char *name;
  mesh_file content;
  uint32_t crc, at;
} mesh_entry;

static inline void mesh_zip_entry(mesh_file *file, const mesh_entry *entry, int is_listed) {
  mesh_put(file, is_listed ? "PK\1\2\24\0" : "PK\3\4", is_listed ? 6 : 4);
  mesh_put(file, "\24\0\0\0\0\0\0\0\41\0", 10); /* stored, on the first day */
  mesh_number(file, entry->crc, 4);
  mesh_number(file, (uint32_t)entry->content.n, 4);
  mesh_number(file, (uint32_t)entry->content.n, 4);
  mesh_number(file, (uint32_t)strlen(entry->name), 2);
  mesh_number(file, 0, 2);
  for (int i = 0; is_listed && i < 10; i++)
    mesh_number(file, 0, 1);
  if (is_listed)
    mesh_number(file, entry->at, 4);
  mesh_put(file, entry->name, strlen(entry->name));
  if (!is_listed)
    mesh_put(file, entry->content.bytes, entry->content.n);
}

static inline void mesh_zip(mesh_file *file, mesh_entry *entries, int n) {
  for (int i = 0; i < n; i++) {
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t k = 0; k < entries[i].content.n; k++) {
      crc ^= entries[i].content.bytes[k];
      for (int bit = 0; bit < 8; bit++)
        crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
    }
    entries[i].crc = ~crc;
    entries[i].at = (uint32_t)file->n;
    mesh_zip_entry(file, &entries[i], 0);
  }
  size_t list_at = file->n;
  for (int i = 0; i < n; i++)
    mesh_zip_entry(file, &entries[i], 1);
  size_t list_bytes = file->n - list_at;
  mesh_put(file, "PK\5\6\0\0\0\0", 8);
  mesh_number(file, (uint32_t)n, 2);
  mesh_number(file, (uint32_t)n, 2);
  mesh_number(file, (uint32_t)list_bytes, 4);
  mesh_number(file, (uint32_t)list_at, 4);
  mesh_number(file, 0, 2);
}

static inline void mesh_3mf(mesh_file *file) {
  static mesh_entry entries[3] = {
      {.name = "[Content_Types].xml"}, {.name = "_rels/.rels"}, {.name = "3D/3dmodel.model"}};
  for (int i = 0; i < 3; i++)
    entries[i].content.n = 0;
  mesh_text(&entries[0].content,
            "<?xml version=\"1.0\"?><Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
            "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
            "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>"
            "</Types>");
  mesh_text(&entries[1].content,
            "<?xml version=\"1.0\"?><Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/"
            "relationships\"><Relationship Target=\"/3D/3dmodel.model\" Id=\"r0\" "
            "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>");
  mesh_file *model = &entries[2].content;
  mesh_text(model, "<?xml version=\"1.0\"?><model unit=\"millimeter\" "
                   "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources><object id=\"1\" "
                   "type=\"model\"><mesh><vertices>");
  for (int i = 0; i < 4; i++)
    mesh_text(model, "<vertex x=\"%g\" y=\"%g\" z=\"%g\"/>", (double)mesh_corners[i][0], (double)mesh_corners[i][1],
              (double)mesh_corners[i][2]);
  mesh_text(model, "</vertices><triangles>");
  for (int i = 0; i < 4; i++)
    mesh_text(model, "<triangle v1=\"%d\" v2=\"%d\" v3=\"%d\"/>", mesh_faces[i][0], mesh_faces[i][1], mesh_faces[i][2]);
  mesh_text(model, "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>");
  mesh_zip(file, entries, 3);
}

/* All kinds, and what of a file is certain: how Assimp turns it (1: z of the file is y of the world). */
typedef struct mesh_kind {
  const char *ending;
  void (*make)(mesh_file *file);
  int is_turned, is_text;
  double up[3];
} mesh_kind;

static const mesh_kind mesh_kinds[] = {
    {"stl", mesh_stl, 0, 0, {0, 0, 1}},   {"stl", mesh_stl_text, 0, 1, {0, 0, 1}}, {"off", mesh_off, 0, 1, {0, 0, 0}},
    {"gltf", mesh_gltf, 0, 1, {0, 1, 0}}, {"glb", mesh_glb, 0, 0, {0, 1, 0}},      {"3mf", mesh_3mf, 0, 0, {0, 0, 1}},
    {"dae", mesh_dae, 0, 1, {0, 1, 0}},   {"fbx", mesh_fbx, 0, 1, {0, 0, 1}},      {"3ds", mesh_3ds, 1, 0, {0, 1, 0}},
    {"x3d", mesh_x3d, 0, 1, {0, 1, 0}},   {"dxf", mesh_dxf, 1, 1, {0, 1, 0}},      {"amf", mesh_amf, 0, 1, {0, 0, 1}},
};
enum { MESH_N_KINDS = sizeof mesh_kinds / sizeof *mesh_kinds };
