/* Files of cameras: those of COLMAP, of nerfstudio and NeRF (transforms.json), of 3D Gaussian splatting (cameras.json),
 * NumPy archives of view matrices, glTF, and conic's own JSON. docs/reference/cameras.md says how each is understood.
 */
#ifndef CONIC_CAMERAS_H
#define CONIC_CAMERAS_H

#include "conic/camera.h"

CONIC_BEGIN_C

typedef enum conic_camera_file {
  CONIC_CAMERA_FILE_CONIC,      /* JSON of one camera: conic_camera_read */
  CONIC_CAMERA_FILE_COLMAP,     /* cameras and images, .bin or .txt */
  CONIC_CAMERA_FILE_TRANSFORMS, /* JSON with frames */
  CONIC_CAMERA_FILE_LIST,       /* a JSON array of positions and rotations */
  CONIC_CAMERA_FILE_NUMPY,      /* .npz of viewmats and Ks */
  CONIC_CAMERA_FILE_GLTF,       /* the nodes with cameras */
  CONIC_N_CAMERA_FILES
} conic_camera_file;

/* "conic", "colmap", "transforms", "cameras.json", "npz", "gltf"; null for a number that is no kind. */
CONIC_API const char *conic_camera_file_name(conic_camera_file kind);

typedef struct conic_cameras {
  size_t count;
  conic_camera *cameras; /* in the file's order; COLMAP's in the order of their names' bytes */
  char **names;          /* as the file has them, control characters replaced; "" where it names none */
  char *path;            /* of the file or folder, for messages */
  uint32_t kind;         /* conic_camera_file */
  uint32_t reserved_int;
  uint64_t reserved[6];
} conic_cameras;

typedef struct conic_cameras_options {
  size_t size;       /* sizeof(conic_cameras_options), set by the init function */
  int width, height; /* of the pictures; both 0: the file's */
} conic_cameras_options;

/* The file's sizes. */
CONIC_API void conic_cameras_options_init_sized(conic_cameras_options *options, size_t size);
#define conic_cameras_options_init(options) conic_cameras_options_init_sized(options, sizeof *(options))

/* Reads the cameras of a file, whose kind its content tells, or of a folder that holds one: COLMAP's (also in sparse/0,
 * sparse or colmap/sparse/0), transforms.json or cameras.json. "-" is standard input. A requested size scales the
 * cameras (conic_camera_resize). Where the file has no size, the requested one is the pictures'; without a request, the
 * size comes from the pictures beside the file. On success the caller owns *cameras, of at least one camera, whose kind
 * or lens conic may refuse to draw; on failure it is empty. Null options are the defaults. Errors: ARGUMENT, INPUT,
 * MEMORY, UNSUPPORTED (zlib is not there). */
CONIC_API conic_status conic_cameras_read(conic_context *context, const char *path,
                                          const conic_cameras_options *options, conic_cameras *cameras);
CONIC_API void conic_cameras_release(conic_context *context, conic_cameras *cameras);

/* Whether a file or folder holds cameras and nothing else that conic reads; a glTF counts as a model. Logs nothing. */
CONIC_API int conic_cameras_is_file(conic_context *context, const char *path);

/* The camera of a number from 0, without leading zeros, or of a name: as the file has it, without its folder, or
 * without folder and ending. Errors: ARGUMENT (there is none, or there are several). */
CONIC_API conic_status conic_cameras_find(conic_context *context, const conic_cameras *cameras, const char *name,
                                          size_t *i_camera);

/* The same view in another size: focal lengths and centre scale with the picture, each axis by itself. */
CONIC_API void conic_camera_resize(conic_camera *camera, int width, int height);

CONIC_END_C
#endif
