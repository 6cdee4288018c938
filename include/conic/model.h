/* Models: the contents of a file before it is drawn. Points or splats, and triangles where the file has faces. */
#ifndef CONIC_MODEL_H
#define CONIC_MODEL_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"
#include "conic/splats.h"

CONIC_BEGIN_C

/* The formats that models are read from. */
typedef enum conic_model_kind {
  CONIC_MODEL_PLY = 0,
  CONIC_MODEL_OBJ = 1,
  CONIC_MODEL_XYZ = 2, /* text, a point a line: XYZ, PTS, CSV */
  CONIC_MODEL_LAS = 3,
  CONIC_MODEL_PCD = 4,
  CONIC_MODEL_E57 = 5,
  CONIC_MODEL_PTX = 6,
  CONIC_MODEL_STL = 16,
  CONIC_MODEL_OFF = 17,
  CONIC_MODEL_GLTF = 18,
  CONIC_MODEL_GLB = 19, /* binary glTF */

  /* Assimp's, where Assimp is there */
  CONIC_MODEL_3MF = 20,
  CONIC_MODEL_DAE = 21, /* COLLADA */
  CONIC_MODEL_FBX = 22,
  CONIC_MODEL_3DS = 23,
  CONIC_MODEL_X3D = 24,
  CONIC_MODEL_DXF = 25,
  CONIC_MODEL_AMF = 26
} conic_model_kind;

/* "ply", "obj" …; null for a number that is no kind. */
CONIC_API const char *conic_model_kind_name(conic_model_kind kind);

/* What the numbers of a file's colours mean. */
typedef enum conic_color_meaning {
  CONIC_COLORS_NONE = 0,    /* there are none */
  CONIC_COLORS_DISPLAY = 1, /* fractions of 1 that are sRGB-encoded, as displays take them */
  CONIC_COLORS_LINEAR = 2,  /* such that are linear */
  CONIC_COLORS_CODES = 3,   /* sRGB codes */
  CONIC_COLORS_TRAINED = 4  /* of Gaussians: harmonics */
} conic_color_meaning;

/* A value that a file's points have by name; conic_read_options.field may ask for it. */
typedef struct conic_model_field {
  char name[40];    /* longer ones are cut */
  const char *type; /* as numbers are stored: "uint8" … "int32", "float", "double"; static */
  uint64_t reserved[2];
} conic_model_field;

typedef struct conic_model {
  conic_splats points;       /* vertices, raw points or splats */
  size_t n_triangles;        /* 0 for a set of points */
  uint32_t (*triangles)[3];  /* vertex indices, each below points.count; polygons and strips are triangulated */
  conic_model_kind kind;     /* of the file that was read */
  struct conic_faces *faces; /* with keeps_faces: the faces' other attributes, for conic_triangles_take (triangles.h) */
  double up[3];              /* the direction that points up by the file or its kind; zero where neither says */
  conic_model_field *fields; /* the other values that the points have by name, in the file's order */
  size_t n_fields;
  uint64_t follows_cutoff; /* 1: the axes were made of radii, by the cutoff that it was read with */
  uint32_t colors_are;     /* of conic_color_meaning: the file's colours of points or faces, decoded by now */
  uint32_t reserved_word;
  uint64_t n_unmeasured; /* points that a scan calls so, and that are left out */
} conic_model;

typedef struct conic_read_options {
  size_t size; /* sizeof(conic_read_options), set by the init function */

  /* The cutoff F_g of the kernel that will draw: a `radius` in a file is the splat's outline, so σ = radius / F_g. */
  float cutoff;

  /* Keep the attributes that only triangles have: normals and texture coordinates of corners, materials. */
  int keeps_faces;

  /* The columns of text, "x,y,z,intensity,-,r,g,b" (docs/reference/formats.md); null: as its header says, else as their
   * number suggests. */
  const char *columns;

  /* The scalar to read for conic_splats.scalar, by the file's name for it; null: none. Upper and lower case, "_", "-"
   * and blanks do not matter, nor does a leading "scalar_". */
  const char *field;
  int field_is_optional; /* a file without the field is read without it */

  /* Which other values are kept, "intensity, gps_time" or "all", for a layered cloud (conic_layers_builder_append);
   * null: none. */
  const char *keep;

  /* Which points are read, by their values: "classification = 2, 9 and not intensity < 100" (docs/reference/formats.md,
   * Choosing points); null: all. Files with faces, and files whose points have no values, are refused. */
  const char *where;

  /* Vertices of a PLY or a glTF take their alpha as opacity, where they have no other. */
  int keeps_alpha;

  /* What colours mean that are fractions of 1, in PLY, OBJ, OFF, PCD and text: CONIC_COLORS_DISPLAY or
   * CONIC_COLORS_LINEAR; else as the file has it, which is linear in conic's own PLY and display in all others. */
  int colors_are;
} conic_read_options;

/* Cutoff 1.5, points alone, columns as the file has them. */
CONIC_API void conic_read_options_init_sized(conic_read_options *options, size_t size);
#define conic_read_options_init(options) conic_read_options_init_sized(options, sizeof *(options))

/* Reads a model: PLY, OBJ, LAS, PCD, E57, PTX, text with a point a line, and what Assimp reads
 * (docs/reference/formats.md); "-" is standard input. The content tells the format, then the name's ending. Colours are
 * decoded from sRGB, unless they are linear (docs/reference/formats.md). Where a float cannot hold positions (double or
 * 32-bit integer in a PLY, map coordinates in an OBJ, all of text and LAS), they are measured from the first finite
 * one, which becomes the origin; else the origin is zero. On success the caller owns *model and releases it; on failure
 * it is empty and the log says file, line or byte offset, and what is wrong there. Null `options` are the defaults.
 * Errors: ARGUMENT, INPUT, MEMORY, CANCELLED, UNSUPPORTED (a format of Assimp, without Assimp), IO (its process cannot
 * start). */
CONIC_API conic_status conic_model_read(conic_context *context, const char *path, const conic_read_options *options,
                                        conic_model *model);

/* Takes a batch of a file's points, which is valid during the call only. An answer other than CONIC_OK ends the reading
 * with that status. */
typedef conic_status conic_batch_receiver(void *cookie, const conic_splats *batch);

/* Reads the points of a file as conic_model_read does, without faces, and hands them over in their order, a batch at a
 * time, so that memory does not grow with their number. Some files are read whole and become one batch: OBJ and
 * Assimp's formats, and text, LAS, PCD, E57 and PTX from a pipe, because only their end tells what their colours mean.
 * All batches have the same optional arrays and origin. Errors: as conic_model_read, and the receiver's. */
CONIC_API conic_status conic_model_stream(conic_context *context, const char *path, const conic_read_options *options,
                                          conic_batch_receiver *receive, void *cookie);

/* Releases what a model holds and leaves an empty one. */
CONIC_API void conic_model_release(conic_context *context, conic_model *model);

/* Points that could not be used as they were, by reason. */
typedef struct conic_repairs {
  size_t nan;       /* a position that is not finite: skipped */
  size_t zero;      /* normals or axes that are zero or not finite: repaired from the neighbours */
  size_t duplicate; /* at the place of an earlier point: kept, but not counted as a neighbour of it */
  size_t isolated;  /* far from everything else: kept small */
  size_t failed;    /* no ellipse could be found: skipped */
  size_t clip;      /* clip lines that cannot be drawn, or whose splat got new axes: dropped */
  size_t dots;      /* not repaired, only counted: points whose neighbours make no surface, with finds_dots */
  uint64_t reserved[7];
} conic_repairs;

/* What the ellipse of a point without faces covers. */
typedef enum conic_ellipse_rule {
  CONIC_ELLIPSE_VORONOI = 0, /* the part of the tangent plane that is nearer to the point than to its neighbours */
  CONIC_ELLIPSE_BOUNDING = 1 /* all k neighbours, seen along the normal, as Confetti §4.3 has it */
} conic_ellipse_rule;

typedef struct conic_estimate_options {
  size_t size;      /* sizeof(conic_estimate_options), set by the init function */
  int n_neighbours; /* k, 6 to 64 */
  float cutoff;     /* F_g: the estimated outline is F_g standard deviations */

  /* Creases sharper than this become sharp: degrees between the planes (or faces) that meet, up to 90; 0: none do. A
   * mesh's vertex on a crease becomes several splats, which come after all others; clip lines are made. */
  double feature_angle_deg;

  /* Points whose neighbours make no surface (foliage, wires, noise) become small dots: see conic_splats. */
  int finds_dots;

  /* Splats of a mesh stay at it, to less than can be seen: where a vertex's splat would not, the vertex becomes a splat
   * for each of its triangles. Vertices without a triangle are leftovers and get no splat, if they are less than a
   * tenth. With creases both are so in any case. */
  int stays_at_mesh;

  conic_ellipse_rule ellipse;
} conic_estimate_options;

/* 20 neighbours, cutoff 1.5, no creases, no dots, a splat a vertex, Voronoi cells. */
CONIC_API void conic_estimate_options_init_sized(conic_estimate_options *options, size_t size);
#define conic_estimate_options_init(options) conic_estimate_options_init_sized(options, sizeof *(options))

/* Gives every point of the model tangent axes, in place: from the faces where there are any, else from the k nearest
 * neighbours (Confetti §4.3 with the corrections of docs/notes/errata.md). A set with axes keeps them; only zero and
 * non-finite axes are repaired. Missing normals come from the covariance of the neighbours and are oriented
 * consistently. Points that cannot be repaired get NaN axes, which the renderer skips and counts, so that indices stay
 * those of the file. The result is the same for any number of threads. `repairs` may be null. Errors: ARGUMENT, MEMORY,
 * CANCELLED; the model is then as it was. */
CONIC_API conic_status conic_model_to_splats(conic_context *context, const conic_estimate_options *options,
                                             conic_model *model, conic_repairs *repairs);

/* Keeps `count` of the splats, chosen by `seed`, in their old order; a smaller count is a subset of a larger one with
 * the same seed. A count not below the set's leaves it as it is. Errors: MEMORY. */
CONIC_API conic_status conic_splats_thin(conic_context *context, conic_splats *splats, size_t count, uint64_t seed);

/* Writes splats as PLY in batches, so that any number fits through bounded memory. The file appears under its name only
 * when it is whole. */
typedef struct conic_splats_writer conic_splats_writer;

typedef enum conic_ply_encoding { CONIC_PLY_BINARY = 0, CONIC_PLY_ASCII = 1 } conic_ply_encoding;

typedef struct conic_write_options {
  size_t size;                 /* sizeof(conic_write_options), set by the init function */
  conic_ply_encoding encoding; /* binary little endian by default */
  int double_positions;        /* write positions as double; also done when the first batch's origin is not zero */
  int circles;                 /* write `nx ny nz radius` instead of the axes: for splats with axes of equal length. A
                                  file with clip lines keeps the axes, which the lines need */
  float cutoff;                /* F_g, for that radius */
  unsigned epsg;               /* the code of the positions' coordinate system, kept in a comment; 0: not known */
} conic_write_options;

/* Binary, positions as they come, axes, cutoff 1.5. */
CONIC_API void conic_write_options_init_sized(conic_write_options *options, size_t size);
#define conic_write_options_init(options) conic_write_options_init_sized(options, sizeof *(options))

/* Opens PATH ("-" is standard output) for `count` splats with the optional arrays of `fields`. The first batch decides
 * for the whole file: with an origin other than zero, positions are double; if its colours are all those of 8-bit sRGB
 * codes, colours are written as such codes (later ones as the nearest), else as linear floats. Normals are written only
 * where there are no axes. Null `options` are the defaults. On success the caller owns *writer and ends it with finish
 * or abandon. Errors: ARGUMENT, MEMORY, IO. */
CONIC_API conic_status conic_splats_writer_open(conic_context *context, const char *path, size_t count, unsigned fields,
                                                const conic_write_options *options, conic_splats_writer **writer);
/* Appends a batch. Errors: ARGUMENT (more than `count` in all, or arrays missing), IO. */
CONIC_API conic_status conic_splats_writer_append(conic_splats_writer *writer, const conic_splats *batch);
/* Completes the file and releases the writer, on failure too. Errors: ARGUMENT (fewer than `count` in all), IO. */
CONIC_API conic_status conic_splats_writer_finish(conic_splats_writer *writer);
/* Drops the file and releases the writer; null is allowed. */
CONIC_API void conic_splats_writer_abandon(conic_splats_writer *writer);

/* open, append, finish for one set. Errors: as theirs. */
CONIC_API conic_status conic_splats_write(conic_context *context, const char *path, const conic_splats *splats,
                                          const conic_write_options *options);

CONIC_END_C
#endif
