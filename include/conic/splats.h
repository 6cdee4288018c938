/* The splat set: points, and the ellipses that make splats of them.
 *
 * A splat is an ellipse in space with a kernel on it: centre p, tangent axes t_u and t_v (world units, orthogonal,
 * one standard deviation long for the Gaussian kernel); its normal is t_u × t_v. A dot is a splat whose axes are turned
 * for each camera so that it looks round (conic_splats_face). Structure of arrays: every pointer is to `count` floats,
 * which lie side by side or a stride apart. */
#ifndef CONIC_SPLATS_H
#define CONIC_SPLATS_H

#include <stddef.h>
#include <stdint.h>

#include "conic/camera.h"
#include "conic/context.h"

CONIC_BEGIN_C

/* How the two lines of a splat combine. */
typedef enum conic_clip_operator {
  CONIC_CLIP_AND = 0, /* what both keep is drawn: a convex corner */
  CONIC_CLIP_OR = 1   /* what either keeps: a concave one */
} conic_clip_operator;

/* The clip lines of one splat, in its own plane: a line (a, b, c) keeps the points p + u·t_u + v·t_v with a·u + b·v + c
 * ≥ 0. A line that is not finite, or whose a and b are both 0, is not drawn (docs/reference/picture.md, Clip lines). */
typedef struct conic_clip {
  uint32_t splat;     /* its index in the set */
  uint16_t n_lines;   /* 1 or 2 */
  uint16_t operation; /* conic_clip_operator; used with two lines */
  float lines[2][3];
} conic_clip;

/* The bytes from one splat's float to the next in each array, the same for all its components; 0: side by side. Of an
 * array of count × 3 floats at p, the components are p, p + 1, p + 2 and the stride is 3 × sizeof(float); in an array
 * of structs it is the struct's size. Multiples of sizeof(float). */
typedef struct conic_splats_strides {
  size_t position, tangent_u, tangent_v, normal, color, opacity, dot, scalar, sight;
} conic_splats_strides;

/* May be filled by hand with pointers to the caller's own arrays (then never pass it to conic_splats_release), or by a
 * function of the library (then release it so). Optional arrays are null when absent. A three-component array has all
 * three components or none; else the set is an ARGUMENT error.
 *
 * Functions that only read a set allow strides. Most of them first copy such arrays side by side, in every call: to
 * draw a set many times, append it to an empty set, and draw that one. Functions that change a set or take it over
 * refuse strides. Sets that the library fills have none. */
typedef struct conic_splats {
  size_t count;

  /* Where the positions are measured from, in world units: the world position of splat i is
   * origin + position[.][i], formed in double. Large coordinates (map projections) so keep their precision. */
  double origin[3];
  float *position[3];

  /* Tangent axes, both or none. Without them the set holds raw points: see conic_model_to_splats. */
  float *tangent_u[3];
  float *tangent_v[3];

  /* Normals as read from the file, of any length; optional. Used only where tangent axes are missing. */
  float *normal[3];

  /* Linear RGB, optional (null: white). */
  float *color[3];

  /* Multiplies the weight of a splat; optional (null: 1). */
  float *opacity;

  /* Clip lines, for the splats that have some; optional (null: none). Records in ascending order of `splat`, at most
   * one a splat, all below `count`. */
  size_t n_clips;
  conic_clip *clips;

  conic_splats_strides strides;

  /* Which splats are dots: not 0 for a dot; optional (null: none). A dot's kept axes give its size and normal. The
   * renderer ignores this array: see conic_splats_face. */
  float *dot;

  /* One more value a splat, such as a scan's intensity, from which colours can be made (conic/coloring.h); optional. It
   * does not change the picture. NaN where a splat has none. It is measured from scalar_origin, as positions are from
   * theirs. */
  float *scalar;

  /* From each point towards the scanner that saw it, of any length; optional. It decides the sign of a normal that has
   * to be guessed, and nothing else. Zero says nothing. */
  float *sight[3];

  /* The values that a file's points have by name, where they were asked for (conic_read_options.keep); else null. The
   * library owns them. Functions that make one set from another leave them out. */
  struct conic_point_values *values;
  double scalar_origin;
  uint64_t reserved[2];
} conic_splats;

/* The optional arrays of a set, as bits. */
typedef enum conic_splats_field {
  CONIC_SPLATS_TANGENTS = 1,
  CONIC_SPLATS_NORMALS = 2,
  CONIC_SPLATS_COLORS = 4,
  CONIC_SPLATS_OPACITIES = 8,
  CONIC_SPLATS_CLIPS = 16,
  CONIC_SPLATS_DOTS = 32,
  CONIC_SPLATS_SCALARS = 64,
  CONIC_SPLATS_SIGHTS = 128
} conic_splats_field;

/* Allocates a set of `count` splats with the optional arrays of `fields` (bits of conic_splats_field), contents
 * undefined, origin zero. There is room for one record of clip lines a splat; n_clips is 0. On failure *splats is
 * empty. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_splats_allocate(conic_context *context, size_t count, unsigned fields,
                                             conic_splats *splats);

/* Which optional arrays the set has, as bits of conic_splats_field. */
CONIC_API unsigned conic_splats_fields(const conic_splats *splats);

/* Appends `more` to `splats`, rebased to its origin. Where only one of the two has an array, the other's part is filled
 * with what absence means (white, opacity 1; zero normals and axes, which conic_model_to_splats repairs; NaN scalars;
 * no clip lines). `more` is left as it was; on failure `splats` is too. Errors: MEMORY. */
CONIC_API conic_status conic_splats_append(conic_context *context, conic_splats *splats, const conic_splats *more);

/* How many of the splats are dots. */
CONIC_API size_t conic_splats_count_dots(const conic_splats *splats);

/* Writes the axes with which dots look round to a camera, `count` floats in each array; those of other splats stay. A
 * dot is seen as a disc whose radius is the longer of its axes. The disc's normal is the dot's own, with the sign that
 * faces the camera, if it leans at most 60° away; else it is tilted to 60°. The axes in the set stay, to serve the next
 * camera. Errors: ARGUMENT (no tangent axes; two arrays of three components that are not there). */
CONIC_API conic_status conic_splats_face(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                         float *const tangent_u[3], float *const tangent_v[3]);

/* Takes away clip lines that the renderer does not draw, and records that are out of order, name no splat of the set,
 * or have no or too many lines. Returns how many records were changed or dropped. */
CONIC_API size_t conic_splats_repair_clips(conic_splats *splats);

/* Releases the arrays and leaves an empty set; a set of zero bytes is allowed. */
CONIC_API void conic_splats_release(conic_context *context, conic_splats *splats);

/* The axis-aligned box of the finite centres, in world coordinates. Returns how many centres are finite; where that
 * is 0, minimum and maximum are zero. */
CONIC_API size_t conic_splats_bounds(const conic_splats *splats, double minimum[3], double maximum[3]);

/* The lower median of max(|t_u|, |t_v|) over the splats with finite centre and axes, and axes other than zero: the
 * scale of the automatic ε (docs/reference/picture.md). 0 where there is none. Errors: MEMORY. */
CONIC_API conic_status conic_splats_length(conic_context *context, const conic_splats *splats, double *length);

/* The median sample spacing in world units: √(area a point), from each point's eight nearest neighbours. Lengths in
 * this unit fit any scan. 0 where no two points lie apart. Errors: ARGUMENT (over 2³² - 2 points), MEMORY,
 * CANCELLED. */
CONIC_API conic_status conic_splats_spacing(conic_context *context, const conic_splats *splats, double *spacing);

CONIC_END_C
#endif
