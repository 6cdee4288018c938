/* The assets of the Khronos pack: what each glTF holds, by KHR_gaussian_splatting, and how it is stored. */
#pragma once

#include "cli/judge/suite_files.h"
#include "core/gltf/gltf.h"

/* A splat in its mesh's axes; its colour is that of degree 0, in the colour space of the file. */
typedef struct khr_splat {
  double mean[3], scale[3];
  double rotation[4]; /* x, y, z, w; whole numbers, whose squares add to a square, so that bytes hold it exactly */
  double opacity, color[3];
} khr_splat;

/* Zeros: floats, one after the other. */
typedef struct khr_storage {
  int component; /* CONIC_GLTF_UINT8 … */
  int is_normalized;
  int sparse;     /* the type of the indices of every other value, or, without a base, of all that are not 0 */
  int lacks_base; /* it is zeros */
} khr_storage;

typedef struct khr_node {
  int parent;                                   /* 0: none; else 1 + its number, below this one's */
  int mesh;                                     /* 0: none; else 1 + its number */
  double translation[3], rotation[4], scale[3]; /* x, y, z, w, of any length; zeros: none */
  int is_matrix;                                /* as it is written */
  int is_elsewhere;                             /* in another scene, that is not the file's own */
} khr_node;

/* The attributes whose storage is chosen. */
enum { KHR_POSITION, KHR_ROTATION, KHR_SCALE, KHR_OPACITY, KHR_HARMONICS };

enum {
  KHR_GLB = 1,
  KHR_INTERLEAVED = 2,
  KHR_SHARED = 4,      /* one accessor is all coefficients of degree 1 */
  KHR_FALLBACK = 8,    /* COLOR_0 is there, and a material */
  KHR_TRIANGLE = 16,   /* a primitive of the same mesh, behind the camera */
  KHR_PRIMITIVES = 32, /* splats go to two primitives of a mesh by turns */
  KHR_MESHES = 64,     /* or to two meshes */
  KHR_CUT = 128,       /* the file ends too early */
  KHR_BY_CONIC = 256,  /* written by conic's own writer */
  KHR_LINEAR = 512     /* of the other colour space */
};

typedef struct khr_asset { /* NOLINT(clang-analyzer-optin.performance.Padding): in the order of the tables */
  const char *name, *about;
  const char *clause; /* the heading in the extension's text */
  int level;          /* 0: it must be refused */
  int n;
  const khr_splat *splats; /* null: by chance */
  int degree;
  double unit; /* so many of the file's units are one; nodes with a mesh undo it. 0: 1 */
  khr_storage storage[5];
  int n_nodes;            /* 0: one, that does nothing */
  const khr_node *nodes;  /* of meshes; one more has the camera */
  double eye[3], turn[4]; /* of the camera, as of a node; zeros: 4 before the origin */
  float background[3];
  unsigned flags;
  const char *edits[4][2]; /* texts of the JSON, and what takes their place */
} khr_asset;

enum { KHR_LEVELS = 4 };
const char *cli_khr_level_about(int level);
extern const char cli_khr_readme[]; /* the pack's README.md */

extern const khr_asset cli_khr_assets[];
extern const int cli_n_khr_assets;

/* The scene of the suite that an asset is; `clause` and `asset` are set. */
void cli_khr_scene(const khr_asset *asset, suite_scene *scene);

/* Writes scenes/NAME.gltf or .glb, or broken/…, but not what conic's own writer writes; and makes what is to be seen,
 * Gaussians in the world, for the caller to release. Errors: as conic_output_open and _end. */
conic_status cli_khr_write(suite_files *suite, const khr_asset *asset, conic_gaussians *seen);

/* Where it is in the suite. */
void cli_khr_path(const khr_asset *asset, char path[SUITE_PATH_ROOM]);
