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

CONIC_BEGIN_C

/* What a material's alpha means where pictures show transparency. Alpha is (1 - transparency) × the texture's × the
 * vertices'. */
typedef enum conic_alpha_mode {
  CONIC_ALPHA_BLEND = 0, /* stops so much of the light from behind */
  CONIC_ALPHA_MASK = 1,  /* the surface is there, opaque, where alpha is at least `alpha_cutoff`, and nowhere else */
  CONIC_ALPHA_OPAQUE = 2 /* nothing */
} conic_alpha_mode;

/* A triangle's material. The colour is that of the vertices × `color` × the texture. */
typedef struct conic_material {
  float color[3];         /* linear */
  conic_texture *texture; /* null: none */
  uint32_t alpha_mode;    /* a conic_alpha_mode; this and the next two count only with transparency */
  float transparency;     /* 0: opaque, to 1 */
  float alpha_cutoff;     /* of CONIC_ALPHA_MASK */
  uint32_t reserved_word;
  uint64_t reserved[2];
} conic_material;

/* Strides as in conic_splats_strides, for the arrays of floats. */
typedef struct conic_triangles_strides {
  size_t position, color, normal, texture_coordinate, scalar;
} conic_triangles_strides;

/* A set of triangles. Positions are shared by index. Attributes have indices of their own, for corners that share a
 * place and differ in them. May be filled by hand with pointers to the caller's own arrays (then never pass it to
 * conic_triangles_release), or by a function of the library (then release it so). Optional arrays are null when absent;
 * an array of several components has all of them or none. Functions allow strides as for conic_splats. */
typedef struct conic_triangles {
  size_t count;           /* triangles */
  uint32_t (*corners)[3]; /* [count]: vertices, each below n_vertices; counter-clockwise seen from the front */

  /* World position of vertex i: origin + position[.][i], formed in double. */
  size_t n_vertices;
  double origin[3];
  float *position[3];

  float *color[3]; /* [n_vertices]: linear RGB, optional (white) */

  /* Normals of any length, optional (the faces' are taken). The face's also replaces one that is zero or not finite, or
   * whose mean with others is. Without normal_corners there is one a vertex, and n_normals is ignored. */
  size_t n_normals;
  float *normal[3];
  uint32_t (*normal_corners)[3]; /* [count], each below n_normals; optional */

  /* Texture coordinates, optional (no texture is drawn); indexed as normals are. */
  size_t n_texture_coordinates;
  float *texture_coordinate[2];
  uint32_t (*texture_corners)[3]; /* [count], each below n_texture_coordinates; optional */

  /* Materials, optional (white); the set owns their textures if it is released by conic_triangles_release. */
  size_t n_materials;
  conic_material *materials;
  uint32_t *material; /* [count], each below n_materials; optional: all have the first */

  uint32_t *cluster; /* [count]: which cluster a triangle belongs to; optional; it does not change the picture */

  conic_triangles_strides strides;
  float *scalar; /* [n_vertices]: as in conic_splats; optional */
  float *alpha;  /* [n_vertices]: factor of the material's alpha, 0 to 1; side by side; optional (1) */
  double scalar_origin;
  uint64_t reserved[4];
} conic_triangles;

/* The optional arrays of a set, as bits. */
typedef enum conic_triangles_field {
  CONIC_TRIANGLES_COLORS = 1,
  CONIC_TRIANGLES_NORMALS = 2,             /* one a vertex, unless n_normals is set by the caller */
  CONIC_TRIANGLES_TEXTURE_COORDINATES = 4, /* one a vertex, unless n_texture_coordinates is set by the caller */
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

/* Checks that arrays that belong together are all there and all indices are in range, as a renderer needs it. The
 * messages call the set `name`. Errors: ARGUMENT, INPUT (an index). */
CONIC_API conic_status conic_triangles_check(conic_context *context, const conic_triangles *triangles,
                                             const char *name);

/* Makes triangles of a model that was read with keeps_faces. The arrays move: the model's points become an empty set.
 * Material files are read from the model's folder; a missing one is a warning, as is a missing texture. On success the
 * caller releases *triangles; on failure they are empty. Errors: INPUT (the model has no faces; a file is spoiled),
 * UNSUPPORTED (a picture that this build cannot read), MEMORY. */
CONIC_API conic_status conic_triangles_take(conic_context *context, conic_model *model, conic_triangles *triangles);

/* conic_model_read with keeps_faces, and conic_triangles_take. Errors: as both. */
CONIC_API conic_status conic_triangles_read(conic_context *context, const char *path, conic_triangles *triangles);

/* Appends `more` to `triangles`, rebased to its origin. Where only one of the two has an array, the other's part is
 * filled with what absence means. The textures of `more` move, and all of it where `triangles` is empty. Errors:
 * MEMORY; both sets are then as they were. */
CONIC_API conic_status conic_triangles_append(conic_context *context, conic_triangles *triangles,
                                              conic_triangles *more);

/* Gives all triangles one material of this texture, which the set owns from then on. Errors: MEMORY; the texture is
 * then the caller's still. */
CONIC_API conic_status conic_triangles_texture(conic_context *context, conic_triangles *triangles,
                                               conic_texture *texture);

/* Gives every vertex the mean of its faces' normals, weighted by their areas; replaces existing normals. Errors:
 * MEMORY. */
CONIC_API conic_status conic_triangles_smooth(conic_context *context, conic_triangles *triangles);

/* Gives every corner the mean normal, weighted by area, of the faces around it that hang together with its own by edges
 * of no more than the angle (0 to 90). So these edges look round, and sharper ones stay sharp, but for those of rounds
 * and noise (docs/reference/picture.md). Corners at one place belong together, whichever vertices they name. Errors:
 * ARGUMENT, MEMORY, CANCELLED; the normals are then as they were. */
CONIC_API conic_status conic_triangles_crease(conic_context *context, conic_triangles *triangles, double angle_deg);

/* The axis-aligned box of the finite vertices that triangles use, in world coordinates. Returns how many corners are
 * finite; where that is 0, minimum and maximum are zero. */
CONIC_API size_t conic_triangles_bounds(const conic_triangles *triangles, double minimum[3], double maximum[3]);

/* The contents of one picture. Either set may be null or empty. */
typedef struct conic_drawing {
  const conic_splats *splats;
  const conic_triangles *triangles;
  uint64_t reserved[4];
} conic_drawing;

/* The box of both sets, and how many of its centres and corners are finite; and the near distance that near_z = 0
 * stands for. */
CONIC_API size_t conic_drawing_bounds(const conic_drawing *drawing, double minimum[3], double maximum[3]);
CONIC_API double conic_drawing_near(const conic_drawing *drawing);

/* A camera that frames the drawing: at zoom 1 the outline fills 90 % of the picture's width or height, whichever comes
 * first, and lies in the middle. Splats reach as far as `cutoff` standard deviations. In a turntable of n_turns
 * pictures, all cameras stand equally far off, and no picture's outline is larger than that. Strays, one in a hundred
 * at most and far from all others, are left out. *near_z (null is allowed) is a near distance that suits the framed
 * drawing: conic_drawing_near's, without the strays. Where nothing is finite, conic_camera_frame's camera. Errors:
 * ARGUMENT, INPUT (broken triangles), MEMORY. */
CONIC_API conic_status conic_drawing_frame(conic_context *context, const conic_drawing *drawing, float cutoff,
                                           const conic_framing *framing, int n_turns, conic_camera *camera,
                                           double *near_z);

/* conic_render_samples (1 sample: conic_render) for splats and triangles together. In the plane `id`, triangle j is the
 * number of splats + j. Triangles with a vertex that is not finite are skipped and counted. With splats alone the
 * picture is conic_render_samples' own, bit for bit. Errors: as there; INPUT where triangles have arrays missing or
 * indices out of range (conic_triangles_check), UNSUPPORTED where the renderer's device draws no triangles, MEMORY
 * where the device cannot hold them. */
CONIC_API conic_status conic_render_drawing(conic_context *context, conic_renderer *renderer,
                                            const conic_drawing *drawing, const conic_camera *camera,
                                            const conic_render_options *options, int samples, conic_image *image,
                                            conic_render_statistics *statistics);

CONIC_END_C
#endif
