/* A list of cameras while its file is read: what readers of all formats share. */
#pragma once

#include "conic/cameras.h"

enum { CONIC_CAMERA_NAME_ROOM = 1024 };

typedef struct conic_camera_list {
  conic_context *context;
  const char *name; /* of the file, for messages */
  const char *path; /* the pictures lie beside it; null: there are none */
  conic_cameras_options options;
  uint64_t line, byte; /* of the value that is being read; with line 0 the byte counts */
  conic_cameras *cameras;
  size_t camera_room, name_room;
} conic_camera_list;

/* Adds a camera, given in the file's size, in the requested size. The name needs no terminating zero. Errors: INPUT
 * (nobody can look through it), MEMORY. */
conic_status conic_camera_list_add(conic_camera_list *list, const conic_camera *given, const char *name, size_t n_name);

/* Logs "FILE: what is wrong (line N)". Returns INPUT. */
conic_status conic_camera_list_wrong(const conic_camera_list *list, const char *what);

/* A copy that can be printed; null without memory. */
char *conic_camera_text(conic_context *context, const char *name, size_t n_name);

/* The size of a picture for which the file gives none: the requested one, or that of the file `picture` (may be null)
 * beside the list's. Names without an ending are tried with pictures' endings. Errors: INPUT. */
conic_status conic_camera_list_size(conic_camera_list *list, const char *picture, int *width, int *height);

/* A whole number of pixels, 1 to 65535; 0 for any other number. */
int conic_camera_pixels(double value);

/* Places a camera that looks along −z with y up, as OpenGL's do, by its matrix in the world: rows of three numbers and
 * the position. */
void conic_camera_place_opengl(const double world_from_camera[3][4], conic_camera *camera);
/* Places a camera that looks along z with y down. */
void conic_camera_place(const double world_from_camera[3][4], conic_camera *camera);

/* The rotation of a quaternion w, x, y, z of any length; returns 0 where it has none. */
int conic_camera_rotation(const double quaternion[4], double rows[3][3]);

/* Makes a lens that changes nothing CONIC_LENS_NONE. */
void conic_camera_settle_lens(conic_camera *camera);

/* The readers of all formats. `bytes` are a whole file. */
conic_status conic_camera_json_read(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes);
conic_status conic_camera_array_read(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes);
conic_status conic_camera_transforms_read(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes);
conic_status conic_camera_numpy_read(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes);
conic_status conic_camera_gltf_read(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes);

typedef struct conic_colmap_file {
  const char *name; /* for messages */
  const unsigned char *bytes;
  size_t n_bytes;
} conic_colmap_file;

conic_status conic_camera_colmap_read(conic_camera_list *list, const conic_colmap_file *cameras,
                                      const conic_colmap_file *images, int is_text);
