/* Files that are no models are refused by name, with what to do about it and all that is read. */
#include "core/formats/file_kinds.h"
#include "tests/support/files.h"

static conic_context *context;

static void check_refused(const char *name, const char *bytes, size_t n, const char *kind, const char *remedy) {
  conic_model model;
  const char *path = files_write_bytes(name, bytes, n);
  files_check_failed(name, conic_model_read(context, path, NULL, &model), name, kind, remedy, "PLY, OBJ, LAS, LAZ, PCD",
                     ".cot, .lpc and .chy", "byte 0", (const char *)NULL);
  CHECK(unlink(path) == 0);
}

#define REFUSED(name, bytes, kind, remedy) check_refused(name, bytes, sizeof(bytes) - 1, kind, remedy)

static void test_bytes_tell(void) {
  REFUSED("a.las", "\x1f\x8b\x08", "a gzip archive", "gunzip");
  REFUSED("a", "PK\x03\x04", "a ZIP archive", "unzip");
  REFUSED("a.obj", "\x89PNG....", "a PNG image", "--texture");
  REFUSED("a.json", "\x89PNG....", "a PNG image", "--texture");
  REFUSED("a.obj", "\xff\xd8\xff\xe0", "a JPEG image", "--texture");
  REFUSED("a.xyz", "\x76\x2f\x31\x01", "an OpenEXR image", "conic diff");
  REFUSED("a.obj", "II*\0\x08\0\0\0", "a TIFF image", "--texture");
  REFUSED("a.ply", "%PDF-1.7\n", "a PDF document", "give the model");
  REFUSED("a.las", "<!DOCTYPE html><html>", "a web page", "download the file again");
  REFUSED("a.ply", "version https://git-lfs.github.com/spec/v1\n", "Git LFS pointer", "git lfs pull");
  REFUSED("a", "DRACO\2\2", "a Draco file", "draco_decoder");
  REFUSED("a", "PXR-USDC\0", "a USD scene", "Blender");
  REFUSED("a", "BLENDER-v300", "a Blender file", "export OBJ or PLY");
  REFUSED("a", "\x89HDF\r\n\x1a\n", "an HDF5 file", "PLY or CSV");
  REFUSED("a.shp", "\0\0\x27\x0a\0\0", "a shapefile", "ogr2ogr");
  REFUSED("a", "AC1027", "an AutoCAD drawing", "OBJ, PLY or LAS");
}

static void test_endings_tell(void) {
  REFUSED("a.splat", "\0\1\2\3", "a cloud of Gaussians (SPLAT)", "as PLY");
  REFUSED("a.spz", "\x1f\x8b\x08", "Gaussians (SPZ)", "as PLY"); /* and not its archive */
  REFUSED("a.sog", "PK\x03\x04", "Gaussians (SOG)", "as PLY");
  REFUSED("a.obj.gz", "\x1f\x8b\x08", "a gzip archive", "gunzip");
  REFUSED("a.json", "{\"width\": 1}", "a JSON file", "the model");
  REFUSED("a.step", "ISO-10303-21;", "a CAD model", "FreeCAD");
}

static void test_unknown(void) {
  static const char rubbish[] = "\7\1\2\3\4\5\xfe";
  char archive[300] = {0};
  memcpy(archive + 257, "ustar", sizeof "ustar");
  REFUSED("a.bin", rubbish, "no model that is known", "");
  check_refused("a", archive, sizeof archive, "a tar archive", "tar -x");
  CHECK(!conic_foreign_kind_find("a.xyz", "1 2 3\n", 6, 1) && !conic_foreign_kind_find("a.xyz", "1 2 3\n", 6, 0));
  CHECK(!conic_foreign_kind_find("a.xyz", "PK", 2, 1)); /* what is cut off tells nothing */
}

int main(void) {
  context = files_context();
  test_bytes_tell();
  test_endings_tell();
  test_unknown();
  files_end(context);
  return check_result();
}
