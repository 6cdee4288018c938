#include "core/formats/file_kinds.h"

#include "core/files/file.h"

const char conic_readable_kinds[] =
    "conic reads PLY, OBJ, LAS, LAZ, PCD, E57, PTX, text with a point a line (XYZ, PTS, CSV, TXT, "
    "ASC), STL, OFF, glTF, 3MF, DAE, FBX, 3DS, X3D, DXF, AMF, and its own .cot, .lpc and .chy";

#define MESH_REMEDY "save it as OBJ or PLY (Blender, MeshLab, or: assimp export FILE out.obj)"
#define SCAN_REMEDY "save it as LAS or PLY (CloudCompare, or: pdal translate FILE out.las)"
#define GAUSSIANS_REMEDY "save it as PLY (conic convert FILE -o out.ply)"
#define PACKED_REMEDY "unpack it first"
#define PICTURE_REMEDY "give a scene; a picture is for conic diff or --texture"
#define BYTES(text) text, sizeof(text) - 1

/* A longer beginning comes before one that it starts with. */
static const conic_foreign_kind kinds[] = {
    {"a point-octree", "conic render and conic info take it, by its path", NULL, BYTES("CONICOT\n"), 0},
    {"a layered point cloud", "conic render and conic info take it, by its path", NULL, BYTES("CONICLP\n"), 0},
    {"a hybrid model", "conic render and conic info take it, by its path", NULL, BYTES("CONICHY\n"), 0},
    {"an OpenEXR image", PICTURE_REMEDY, "exr", BYTES("\x76\x2f\x31\x01"), 0},
    {"a PNG image", PICTURE_REMEDY, "png", BYTES("\x89PNG"), 0},
    {"a JPEG image", PICTURE_REMEDY, "jpg jpeg", BYTES("\xff\xd8\xff"), 0},
    {"a TIFF image", PICTURE_REMEDY, "tif tiff", BYTES("II*\0"), 0},
    {"a TIFF image", PICTURE_REMEDY, NULL, BYTES("MM\0*"), 0},
    {"a GIF image", PICTURE_REMEDY, "gif", BYTES("GIF8"), 0},
    {"a Radiance image", PICTURE_REMEDY, "hdr", BYTES("#?RADIANCE"), 0},
    {"a WebP image", PICTURE_REMEDY, "webp", BYTES("WEBPVP8"), 8},
    {"a PDF document", "give the model that it shows", "pdf", BYTES("%PDF"), 0},
    {"a Blender file", "export OBJ or PLY from Blender", "blend", BYTES("BLENDER"), 0},
    {"a USD scene", "export OBJ or PLY from it (Blender reads USD)", "usdc", BYTES("PXR-USDC"), 0},
    {"a USD scene", "export OBJ or PLY from it (Blender reads USD)", "usd usda", BYTES("#usda"), 0},
    {"a USDZ archive", "export OBJ or PLY from it (Blender reads USD)", "usdz", NULL, 0, 0},
    {"a Draco file", "decode it (draco_decoder -i FILE -o out.ply)", "drc", BYTES("DRACO"), 0},
    {"an AutoCAD drawing", "export a mesh or points from it as OBJ, PLY or LAS", "dwg", BYTES("AC10"), 0},
    {"a shapefile", "convert its points to CSV (ogr2ogr -f CSV -lco GEOMETRY=AS_XYZ out.csv FILE)", "shp",
     BYTES("\0\0\x27\x0a"), 0},
    {"a VTK file", "save it as PLY (ParaView: Save Data)", "vtk", BYTES("# vtk DataFile"), 0},
    {"a VTK file", "save it as PLY (ParaView: Save Data)", "vtp vtu vti", NULL, 0, 0},
    {"an HDF5 file", "write its points as PLY or CSV", "h5 hdf5", BYTES("\x89HDF\r\n\x1a\n"), 0},
    {"a NumPy array", "write its points as text (numpy.savetxt) or PLY", "npy", BYTES("\x93NUMPY"), 0},
    {"a NumPy archive", "write its points as text (numpy.savetxt) or PLY", "npz", NULL, 0, 0},
    {"a Parquet table", "write its points as CSV", "parquet", BYTES("PAR1"), 0},
    {"a 3D Studio model", MESH_REMEDY, "max", NULL, 0, 0},
    {"a CAD model", "export a mesh from it as OBJ or PLY (FreeCAD)", "step stp iges igs fcstd", NULL, 0, 0},
    {"a material file", "give the .obj that names it", "mtl", BYTES("newmtl "), 0},
    {"a compressed cloud of Gaussians (SPZ)", GAUSSIANS_REMEDY, "spz", BYTES("NGSP"), 0},
    {"a cloud of Gaussians (SPLAT)", GAUSSIANS_REMEDY, "splat", NULL, 0, 0},
    {"a cloud of Gaussians (KSPLAT)", GAUSSIANS_REMEDY, "ksplat", NULL, 0, 0},
    {"a compressed cloud of Gaussians (SOG)", GAUSSIANS_REMEDY, "sog", NULL, 0, 0},
    {"a scan in a maker's own format", "export E57 or LAS from the maker's program, and save that as PLY or LAS",
     "fls rcs rcp zfs rdbx rxp ptg lgs", NULL, 0, 0},
    {"a Git LFS pointer, not the file itself", "fetch the file (git lfs pull)", NULL, BYTES("version https://git-lfs"),
     0},
    {"a web page, as of a download that failed", "download the file again", "html htm", BYTES("<!DOCTYPE"), 0},
    {"a web page, as of a download that failed", "download the file again", NULL, BYTES("<!doctype"), 0},
    {"a web page, as of a download that failed", "download the file again", NULL, BYTES("<html"), 0},
    {"an XML file", "convert the model in it to OBJ or PLY", "xml", BYTES("<?xml"), 0},
    {"a JSON file", "give the model that it describes", "json", NULL, 0, 0},
    {"a gzip archive", PACKED_REMEDY " (gunzip)", "gz tgz", BYTES("\x1f\x8b"), 0},
    {"a ZIP archive", PACKED_REMEDY " (unzip)", "zip", BYTES("PK\x03\x04"), 0},
    {"a Zstandard archive", PACKED_REMEDY " (unzstd)", "zst", BYTES("\x28\xb5\x2f\xfd"), 0},
    {"an XZ archive", PACKED_REMEDY " (unxz)", "xz",
     BYTES("\xfd"
           "7zXZ"),
     0},
    {"a bzip2 archive", PACKED_REMEDY " (bunzip2)", "bz2", BYTES("BZh"), 0},
    {"a 7z archive", PACKED_REMEDY, "7z", BYTES("7z\xbc\xaf\x27\x1c"), 0},
    {"a tar archive", PACKED_REMEDY " (tar -x)", "tar", BYTES("ustar"), 257},
};

static int has_one_ending(const char *path, const char *endings) {
  char ending[16];
  for (const char *c = endings; c && *c;) {
    size_t length = strcspn(c, " ");
    memcpy(ending, c, length);
    ending[length] = 0;
    if (conic_file_has_ending(path, ending))
      return 1;
    c += length + (c[length] == ' ');
  }
  return 0;
}

static const conic_foreign_kind *find_ending(const char *path) {
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
    if (has_one_ending(path, kinds[i].endings))
      return &kinds[i];
  return NULL;
}

static int is_archive(const conic_foreign_kind *kind) {
  return strncmp(kind->remedy, PACKED_REMEDY, sizeof PACKED_REMEDY - 1) == 0;
}

const conic_foreign_kind *conic_foreign_kind_find(const char *path, const char *bytes, size_t n, int by_bytes) {
  const conic_foreign_kind *by_ending = find_ending(path);
  if (!by_bytes)
    return by_ending;
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    const conic_foreign_kind *kind = &kinds[i];
    if (!kind->bytes || n < kind->at + kind->n_bytes || memcmp(bytes + kind->at, kind->bytes, kind->n_bytes) != 0)
      continue;
    /* an archive is named after its contents if the ending tells them */
    return is_archive(kind) && by_ending && !is_archive(by_ending) ? by_ending : kind;
  }
  return NULL;
}
