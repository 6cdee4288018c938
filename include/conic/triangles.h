/* Triangles: meshes drawn as what they are, alone or together with splats in one picture (docs/reference/picture.md,
 * Triangles).
 */
#ifndef CONIC_TRIANGLES_H
#define CONIC_TRIANGLES_H

#include <stddef.h>
#include <stdint.h>

#include "conic/camera.h"
#include "conic/context.h"
#include "conic/model.h"
#include "conic/render.h"
#include "conic/splats.h"
#include "conic/texture.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a material's alpha, that is (1 - transparency) × the texture's × the vertices', means where pictures show it. */
typedef enum conic_alpha_mode {
  CONIC_ALPHA_BLEND = 0, /* so much of the light from behind it stops */
  CONIC_ALPHA_MASK = 1,  /* the surface is there where alpha is at least `alpha_cutoff`, opaque, and else is not */
  CONIC_ALPHA_OPAQUE = 2 /* nothing */
} conic_alpha_mode;

/* What a triangle's surface is made of: its colour is that of the vertices × `color` × the texture. */
typedef struct conic_material {
  float color[3];         /* linear */
  conic_texture *texture; /* null: none */
  uint32_t alpha_mode;    /* a conic_alpha_mode; this and the next two count where transparency is asked for */
  float transparency;     /* 0: opaque, to 1 */
  float alpha_cutoff;     /* of CONIC_ALPHA_MASK */
  uint32_t reserved_word;
  uint64_t reserved[2];
} conic_material;

/* As conic_splats_strides, of the arrays of floats. */
typedef struct conic_triangles_strides {
  size_t position, color, normal, texture_coordinate, scalar;
} conic_triangles_strides;

/* A set of triangles: positions that are shared by index, and attributes with indices of their own where corners that
 * share a place differ in them. May be filled by hand with pointers to the caller's own arrays (then never pass it to
 * conic_triangles_release), or by a function of the library (then release it so). Optional arrays are null when absent;
 * those of several components are there in all of them or in none. Strides are for whom conic_splats allows them. */
typedef struct conic_triangles {
  size_t count;           /* triangles */
  uint32_t (*corners)[3]; /* [count]: vertices, each below n_vertices; counter-clockwise seen from the front */

  /* World position of vertex i: origin + position[.][i], formed in double. */
  size_t n_vertices;
  double origin[3];
  float *position[3];

  float *color[3]; /* [n_vertices]: linear RGB, optional (white) */

  /* Normals, optional (the faces'): of any length; where one is zero or not finite, or their mean is, the face's.
   * Without normal_corners there is one a vertex, and n_normals is not looked at. */
  size_t n_normals;
  float *normal[3];
  uint32_t (*normal_corners)[3]; /* [count], each below n_normals; optional */

  /* Texture coordinates, optional (no texture is drawn); likewise. */
  size_t n_texture_coordinates;
  float *texture_coordinate[2];
  uint32_t (*texture_corners)[3]; /* [count], each below n_texture_coordinates; optional */

  /* Materials, optional (white); the set owns their textures if it is released by conic_triangles_release. */
  size_t n_materials;
  conic_material *materials;
  uint32_t *material; /* [count], each below n_materials; optional: all have the first */

  uint32_t *cluster; /* [count]: what a triangle belongs to; optional, and of no matter to the picture */

  conic_triangles_strides strides;
  float *scalar; /* [n_vertices]: as in conic_splats; optional */
  float *alpha;  /* [n_vertices]: by which the material's alpha is multiplied, 0 to 1; side by side; optional (1) */
  uint64_t reserved[5];
} conic_triangles;

/* The optional arrays of a set, as bits. */
typedef enum conic_triangles_field {
  CONIC_TRIANGLES_COLORS = 1,
  CONIC_TRIANGLES_NORMALS = 2,             /* one a vertex, unless n_normals is set by the caller */
  CONIC_TRIANGLES_TEXTURE_COORDINATES = 4, /* likewise */
  CONIC_TRIANGLES_CLUSTERS = 8,
  CONIC_TRIANGLES_SCALARS = 16,
  CONIC_TRIANGLES_ALPHAS = 32
} conic_triangles_field;

/* Allocates a set with the optional arrays of `fields` (bits of conic_triangles_field), normals and texture coordinates
 * one a vertex; contents undefined, origin zero, no materials. On failure *triangles is empty. Errors: MEMORY. */
CONIC_API conic_status conic_triangles_allocate(conic_context *context, size_t count, size_t n_vertices,
                                                unsigned fields, conic_triangles *triangles);

/* Releases the arrays and the textures, and leaves an empty set; a set of zero bytes is allowed. */
CONIC_API void conic_triangles_release(conic_context *context, conic_triangles *triangles);

/* Whether all arrays that belong together are there and all indices are in range: what a renderer asks for. Errors:
 * ARGUMENT, INPUT (an index), with a message that names `name`. */
CONIC_API conic_status conic_triangles_check(conic_context *context, const conic_triangles *triangles,
                                             const char *name);

/* Makes triangles of a model that was read with keeps_faces: the arrays move, and the model keeps nothing but what it
 * was besides (its points become an empty set). Material files are read from the model's folder; one that is not there
 * is a warning, as is a texture. On success the caller releases *triangles; on failure they are empty. Errors: INPUT
 * (the model has no faces; a file is spoiled), UNSUPPORTED (a picture that this build cannot read), MEMORY. */
CONIC_API conic_status conic_triangles_take(conic_context *context, conic_model *model, conic_triangles *triangles);

/* conic_model_read with keeps_faces, and conic_triangles_take. Errors: as both. */
CONIC_API conic_status conic_triangles_read(conic_context *context, const char *path, conic_triangles *triangles);

/* Appends `more` to `triangles`, rebased to its origin; arrays that only one of the two has are filled for the other
 * with what absence means. The textures of `more` move, and all of it where `triangles` is empty. Errors: MEMORY;
 * `triangles` is then as it was, and so is `more`. */
CONIC_API conic_status conic_triangles_append(conic_context *context, conic_triangles *triangles,
                                              conic_triangles *more);

/* Gives all triangles one material of this texture, which the set owns from then on. Errors: MEMORY; the texture is
 * then the caller's still. */
CONIC_API conic_status conic_triangles_texture(conic_context *context, conic_triangles *triangles,
                                               conic_texture *texture);

/* Gives every vertex the mean of its faces' normals, weighted by their areas, in place of what normals there are.
 * Errors: MEMORY. */
CONIC_API conic_status conic_triangles_smooth(conic_context *context, conic_triangles *triangles);

/* Gives every corner the mean of the normals, weighted by area, of the faces around it that hang together with its own
 * by edges of no more than the angle (0 to 90): those are round, others sharp. Corners at one place belong together,
 * whichever vertices they name. Errors: ARGUMENT, MEMORY, CANCELLED; the normals are then as they were. */
CONIC_API conic_status conic_triangles_crease(conic_context *context, conic_triangles *triangles, double angle_deg);

/* The axis-aligned box of the finite vertices that triangles use, in world coordinates. Returns how many corners are
 * finite; where that is 0, minimum and maximum are zero. */
CONIC_API size_t conic_triangles_bounds(const conic_triangles *triangles, double minimum[3], double maximum[3]);

/* What is drawn into one picture. Either may be null or empty. */
typedef struct conic_drawing {
  const conic_splats *splats;
  const conic_triangles *triangles;
  uint64_t reserved[4];
} conic_drawing;

/* The box of both, and how many centres and corners of it are finite; the near distance that near_z = 0 stands for. */
CONIC_API size_t conic_drawing_bounds(const conic_drawing *drawing, double minimum[3], double maximum[3]);
CONIC_API double conic_drawing_near(const conic_drawing *drawing);

/* A camera from which the outline of what is drawn fills 90 % of the picture's width or height, whichever it fills
 * first, and lies in its middle (at zoom 1). Splats reach as far as `cutoff` standard deviations. Of a turntable of
 * n_turns pictures, of which this is one, the camera stands equally far off and no picture's outline is larger. Strays,
 * one in a hundred at most and far from all others, are left out. *near_z (null is allowed) is a near distance that
 * fits what is framed, as conic_drawing_near does without strays. Where nothing is finite, conic_camera_frame's camera.
 * Errors: ARGUMENT, INPUT (broken triangles), MEMORY. */
CONIC_API conic_status conic_drawing_frame(conic_context *context, const conic_drawing *drawing, float cutoff,
                                           const conic_framing *framing, int n_turns, conic_camera *camera,
                                           double *near_z);

/* conic_render_samples (1 sample: conic_render) for splats and triangles together. In the plane `id`, triangle j is
 * the number of splats + j. Triangles with a vertex that is not finite are skipped and counted. With splats alone the
 * picture is conic_render_samples' own, bit for bit. Errors: as there; INPUT where triangles have arrays
 * missing or indices out of range (conic_triangles_check), UNSUPPORTED where the renderer draws by a device that knows
 * no triangles, MEMORY where the device cannot hold them. */
CONIC_API conic_status conic_render_drawing(conic_context *context, conic_renderer *renderer,
                                            const conic_drawing *drawing, const conic_camera *camera,
                                            const conic_render_options *options, int samples, conic_image *image,
                                            conic_render_statistics *statistics);

#ifdef __cplusplus
}
#endif
#endif
