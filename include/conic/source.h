/* Sources: everything that can be drawn, behind one interface. Splat files and raw points, meshes, octrees (.cot),
 * layered point clouds (.lpc, files or URLs), hybrid models (.chy), and polynomial patches about points. Whoever opens
 * a source asks what it can do, never what it is. */
#ifndef CONIC_SOURCE_H
#define CONIC_SOURCE_H

#include "conic/gaussian_render.h"
#include "conic/hybrid.h"
#include "conic/octree.h"
#include "conic/patches.h"

CONIC_BEGIN_C

/* What is drawn, and the memory that drawing it keeps. One thread at a time. */
typedef struct conic_source conic_source;

/* What a file becomes if it does not say so itself. */
typedef enum conic_representation {
  CONIC_AS_POINTS = 0,  /* splats; a mesh becomes one a vertex */
  CONIC_AS_MESH = 1,    /* triangles, where there are faces */
  CONIC_AS_HYBRID = 2,  /* a mesh becomes a hybrid model */
  CONIC_AS_PATCHES = 3, /* points become samples of the polynomials about them */
  CONIC_AS_AUTO = 4     /* each file as fits: with faces, triangles, and the points without a face unless they are
                           leftovers; else splats */
} conic_representation;

/* What a source can do besides being drawn, as bits. */
typedef enum conic_source_ability {
  CONIC_SOURCE_CHOOSES = 1,    /* draws less than everything: by an error, or within a budget */
  CONIC_SOURCE_CLUSTERS = 2,   /* draws clusters of two kinds: only_kind, and the image's cluster plane */
  CONIC_SOURCE_STREAMS = 4,    /* draws by itself, and reads meanwhile: levels, deadline, occlusion; hands nothing over
                                  unless it is opened whole */
  CONIC_SOURCE_COMPOSITES = 8, /* draws Gaussians, composited by alpha: display values, and planes of its own. Of the
                                  render options, the background and the instruction set count; nothing is handed
                                  over */
  CONIC_SOURCE_READS_PARTS = 16, /* reads those parts of a file or a URL that it draws, by the options' access */
  CONIC_SOURCE_MIXES = 32        /* composites, with surfaces among its Gaussians */
} conic_source_ability;

typedef struct conic_source_options {
  size_t size; /* sizeof(conic_source_options), set by the init function */
  conic_representation as;
  int is_whole;                         /* read every splat of a hierarchy and hand all over, without choosing */
  float cutoff;                         /* F_g of the kernel that will draw */
  int n_neighbours;                     /* from so many a raw point's size is estimated, 6 to 64 */
  const char *texture_path;             /* a picture that lies on the mesh in place of its own; null: none */
  int is_smooth;                        /* a mesh, or a hybrid of one, gets vertex normals from its faces */
  const conic_layers_access *access;    /* for sources that read parts; null: the defaults */
  const conic_patches_options *patches; /* without its cutoff; null: the defaults */
  int h_in_spacings;                    /* the patches' surface.h is in median sample spacings */
  int projects_degrees; /* raw points with longitude and latitude as x and y are drawn in metres, which is logged */
  int finds_dots;       /* raw points without a surface around them become dots, which face each picture's camera */

  /* What colours are made of; null: the files' colours. Heights and normals need a source that is drawn whole (a .cot
   * with is_whole); a .lpc has the values that it keeps. */
  const conic_coloring_options *coloring;
  const char *columns; /* as in conic_read_options: the columns of text; null: its header says */
  double crease_deg;   /* above 0: triangles of a file without normals are round over edges up to this angle */
  const conic_gaussian_options *gaussians; /* how Gaussian scenes are composited; null: they are splats like others */
  const char *where; /* which points are read, as in conic_read_options, from files of points and .lpc; null: all */
  int keeps_alpha;   /* of a file's vertices, as in conic_read_options */
  const char *cache; /* a folder that keeps what an error or a budget has built of splats and triangles in memory, up to
                        4 GiB, by what these hold: several processes may use it at a time; null: none */
  int colors_are;    /* what fractions of 1 mean as colours, as in conic_read_options */
  const char *place; /* where inputs stand: "I:" and their numbers, I from 0, with semicolons between. Three numbers
                        shift, twelve are the rows of a matrix of 3 x 4, sixteen of 4 x 4, which turns, scales evenly
                        and shifts what the file has. Of Gaussian scenes, and of what is read whole. Null: all as their
                        files have it */
  uint64_t most_raw; /* of a file's raw points, whose sizes are estimated, every second, third … is taken, so that they
                        are at most so many; 0: all */
} conic_source_options;

/* Splats, cutoff 1.5, 20 neighbours, no dots, flat faces. */
CONIC_API void conic_source_options_init_sized(conic_source_options *options, size_t size);
#define conic_source_options_init(options) conic_source_options_init_sized(options, sizeof *(options))

/* What a source of these files and options could do, judged by their first bytes: bits of conic_source_ability. Null
 * options are the defaults. */
CONIC_API unsigned conic_source_abilities(const char *const *paths, size_t n_paths,
                                          const conic_source_options *options);

/* Opens `n_paths` files, of any kinds, as one source, and measures it. A hybrid stands alone among surfaces. Gaussian
 * scenes that are composited are one scene, with the surfaces of other files among its Gaussians. Logs the repairs of
 * points. On success the caller owns *source, which must not outlive the context. Null options are the defaults.
 * Errors: those of the functions that read each kind; ARGUMENT; INPUT where nothing could be drawn. */
CONIC_API conic_status conic_source_open(conic_context *context, const char *const *paths, size_t n_paths,
                                         const conic_source_options *options, conic_source **source);

/* Makes a source from sets in memory, and takes them over: the arguments are empty afterwards, or no longer the
 * caller's, on failure too. `triangles` may be null; splats must have tangent axes. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_source_of_drawing(conic_context *context, conic_splats *splats, conic_triangles *triangles,
                                               conic_source **source);
/* The octree that a source draws from; null where there is none. */
CONIC_API const conic_octree *conic_source_octree(const conic_source *source);

/* A picture of how a source of levels divides its points, by conic_octree_draw_boxes or conic_layers_draw_boxes.
 * Errors: as these; ARGUMENT for other sources. */
CONIC_API conic_status conic_source_draw_boxes(conic_source *source, const conic_camera *camera, int level,
                                               const conic_image *image, conic_image *map);

/* The Gaussians that a source composites; null where there are none. */
CONIC_API const conic_gaussians *conic_source_gaussians(const conic_source *source);

/* Sets how Gaussians are composited from the next picture on; other sources stay as they are. Errors: ARGUMENT. */
CONIC_API conic_status conic_source_composite_by(conic_source *source, const conic_gaussian_options *options);

CONIC_API conic_status conic_source_of_octree(conic_context *context, conic_octree *octree, conic_source **source);
CONIC_API conic_status conic_source_of_hybrid(conic_context *context, conic_hybrid *hybrid, conic_source **source);

/* Null is allowed. */
CONIC_API void conic_source_close(conic_source *source);

/* How the source's `up` was found. */
typedef enum conic_up_basis {
  CONIC_UP_HABIT = 0,  /* nothing tells: +y */
  CONIC_UP_KIND = 1,   /* the file, or its kind, says it */
  CONIC_UP_FLAT = 2,   /* it lies flat: +z */
  CONIC_UP_OPEN = 3,   /* its surface is open below: +z */
  CONIC_UP_BASE = 4,   /* it stands on a flat base: +z */
  CONIC_UP_FACING = 5, /* it is a drawing in the plane of x and z, which is looked at from its front: +z */
  CONIC_UP_EVEN = 6    /* mirrored along y it is the same, and along z it is not: +z */
} conic_up_basis;

/* "habit", "kind", "flat" …, and what it rests on, as "as it lies flat"; null for a number that is no basis. */
CONIC_API const char *conic_up_basis_name(conic_up_basis basis);
CONIC_API const char *conic_up_basis_reason(conic_up_basis basis);

/* The measures of the source as a whole, by which pictures are drawn. */
typedef struct conic_source_scale {
  unsigned abilities;             /* bits of conic_source_ability */
  double minimum[3], maximum[3];  /* box of the finite centres and corners */
  double up[3];                   /* as up_basis says */
  double near_z, splat_length;    /* for conic_render_options */
  double epsilon;                 /* for conic_render_options, where the source has its own; else negative: automatic */
  double spacing;                 /* the median sample spacing where it is known; else 0: conic_source_spacing */
  uint64_t n_splats, n_triangles; /* at full detail; of a hybrid, as built */
  int n_levels;                   /* that can be drawn one after the other; 0: everything is drawn at once */
  int has_colors;
  double read_seconds, estimate_seconds; /* what opening it took */
  conic_up_basis up_basis;               /* of `up`: KIND, or HABIT until conic_source_stand has looked */
  int follows_cutoff;                    /* 1: opened with another cutoff it would be another source */
} conic_source_scale;

/* The source's own; stays until it is closed. */
CONIC_API const conic_source_scale *conic_source_measure(const conic_source *source);

/* What the colours were made of; null: the files' colours. The source's own. */
CONIC_API const conic_coloring *conic_source_coloring(const conic_source *source);

/* The median sample spacing; it is computed if it is not known. Errors: ARGUMENT (a hybrid has none), MEMORY,
 * CANCELLED. */
CONIC_API conic_status conic_source_spacing(conic_source *source, double *spacing);

/* A camera that sees the whole source; null `framing` is the default one with the source's `up`. Errors: ARGUMENT,
 * INPUT (it reaches farther out than 1e20). */
CONIC_API conic_status conic_source_frame(const conic_source *source, const conic_framing *framing,
                                          conic_camera *camera);

/* Where an input is, and what its shape is. */
typedef struct conic_source_pose {
  double world_from_rest[3][4]; /* affine: from the file's coordinates to the world; the determinant is above 0 */
  /* Other shapes of the input: sources of one file each, with as many splats, vertices and normals, which have to stay
   * open. The input is drawn with its places, axes and normals at `part` of the way from the first shape (null: its
   * own) to the second (null: it stays at the first). Axes of estimated splats are first turned to their nearest
   * match. */
  const conic_source *shapes[2];
  double part; /* 0 to 1 */
  uint64_t reserved[4];
} conic_source_pose;

/* At rest. */
CONIC_API void conic_source_pose_init(conic_source_pose *pose);

/* Draws input i as poses[i] says, from the next picture on; null: all are at rest, as at first. An input at rest is
 * drawn as without poses, to the bit. The scale stays that of rest. A source that does not consist of splats and
 * triangles in memory takes one pose for all of it, which may turn and shift it: its pictures are drawn with the camera
 * and the lights moved the other way, and what it hands over stays at rest. Errors: ARGUMENT (another number of poses;
 * a pose that is none; a shape that does not fit), UNSUPPORTED (any other pose of such a source), MEMORY. */
CONIC_API conic_status conic_source_move(conic_source *source, const conic_source_pose *poses, size_t n_poses);

/* The box of what is drawn: the scale's, unless something moves. */
CONIC_API void conic_source_box(const conic_source *source, double minimum[3], double maximum[3]);

/* Where no file's kind says which way is up, looks at the shape, and sets the scale's `up` and its basis. Errors: as
 * conic_source_choose. */
CONIC_API conic_status conic_source_stand(conic_source *source);

/* A camera that just fits the source's outline: conic_drawing_frame of it, for a hierarchy as finely as a pixel shows
 * it. A choice made before is dropped. A source that streams is drawn small from six sides for this, which reads its
 * coarse parts. Null `framing` as in conic_source_frame. Errors: as conic_source_frame, conic_source_choose and
 * conic_drawing_frame. */
CONIC_API conic_status conic_source_fit(conic_source *source, const conic_framing *framing, float cutoff, int n_turns,
                                        conic_camera *camera, double *near_z);

/* Fills in what the options leave open: near_z and splat_length where they are 0, a negative epsilon where the source
 * has its own. Choosing and drawing do so by themselves. */
CONIC_API void conic_source_settle(const conic_source *source, conic_render_options *render);

/* How one picture is chosen. A source ignores what it cannot do. */
typedef struct conic_source_view {
  size_t size;                     /* sizeof(conic_source_view), set by the init function */
  double error_px;                 /* above 0: the greatest error on the screen; 0: full detail, a hybrid as built.
                                      Splats and triangles in memory are joined for it */
  uint64_t budget;                 /* or, where not 0: the least error that so many splats and triangles can give */
  int only_kind;                   /* -1, or the conic_hybrid_kind that all clusters are drawn as */
  int samples;                     /* N × N a pixel */
  int most_levels;                 /* no more levels are drawn; 0: all */
  conic_occlusion occlusion;       /* leave out what is hidden */
  int may_be_coarser;              /* parts that cannot be read, or not in time, are drawn coarser */
  double seconds;                  /* with may_be_coarser: nothing is read after so many; 0: no limit */
  int tolerates_damage;            /* with may_be_coarser: damaged parts are drawn coarser, too */
  double color_error;              /* of a hybrid: as in conic_hybrid_view */
  conic_transparency transparency; /* as in conic_render_transparent, for sources that keep opacities. UNSUPPORTED for
                                      hybrids, for Gaussian scenes, and for an octree that keeps some and draws less
                                      than everything */
  double chance;                   /* as in conic_render_transparent */
  int is_alone; /* of splats in memory, with an error: 1: they are joined for this picture alone; 0: by
                   an octree, which is built for the first picture and serves the next ones, too */
  int reserved_int;
} conic_source_view;

/* Full detail, either kind, one sample, colours by 2 steps. */
CONIC_API void conic_source_view_init_sized(conic_source_view *view, size_t size);
#define conic_source_view_init(view) conic_source_view_init_sized(view, sizeof *(view))

/* The contents of the last picture, or of the next one. */
typedef struct conic_source_choice {
  conic_drawing drawing; /* the source's, until the next picture; both sets are null where the source streams, else
                            neither is */
  const uint32_t *ids;   /* for every splat, its number in the image's id plane; null: its index */
  int is_all;            /* everything, in its own order: nothing was chosen */
  double error_px;       /* asked for, or what the budget led to; 0 where nothing was chosen */
  uint64_t n_culled;     /* parts that are out of sight */
  int n_levels;          /* of a source with levels: how many were drawn */
  double color_error;    /* of a hybrid: as in conic_hybrid_selection */
} conic_source_choice;

/* Chooses what a camera sees; conic_source_chosen returns it. Null `view` is the default. Errors: ARGUMENT, UNSUPPORTED
 * (it streams), MEMORY, CANCELLED. */
CONIC_API conic_status conic_source_choose(conic_source *source, const conic_camera *camera,
                                           const conic_render_options *render, const conic_source_view *view);

/* The source's own; stays until the next picture. */
CONIC_API const conic_source_choice *conic_source_chosen(const conic_source *source);

/* What a splat of the choice is part of: "point", "node" or "cluster", and its number; null: nothing. */
CONIC_API const char *conic_source_name_splat(const conic_source *source, uint32_t splat, uint32_t *number);

/* Which of the opened files, from 0, has what an image's id plane calls `id`. A number that is no id gets an answer,
 * too. */
CONIC_API size_t conic_source_input_of(const conic_source *source, uint32_t id);

/* Puts the names of the choice into the planes id and cluster of an image that conic_render_drawing drew of it. */
CONIC_API void conic_source_name_image(const conic_source *source, conic_image *image);

/* Chooses, draws into the planes that `image` has, and fills in the names in its planes id and cluster. The time of
 * choosing is part of the statistics. Null `view` is the default, and `statistics` may be null. Errors: as
 * conic_source_choose, conic_render_drawing and conic_layers_draw. */
CONIC_API conic_status conic_source_draw(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                         const conic_render_options *render, const conic_source_view *view,
                                         conic_image *image, conic_render_statistics *statistics);

/* --- statistics --- */

typedef enum conic_fact_type {
  CONIC_FACT_COUNT = 0,
  CONIC_FACT_NUMBER = 1,
  CONIC_FACT_TRUTH = 2, /* in `count` */
  CONIC_FACT_TEXT = 3,
  CONIC_FACT_OBJECT = 4, /* the facts up to its end belong to it */
  CONIC_FACT_ARRAY = 5,  /* like OBJECT; the items have no keys */
  CONIC_FACT_END = 6,
  CONIC_FACT_LINE = 7,   /* for people: `key` is a label, and `text` says what other facts say in numbers */
  CONIC_FACT_DEFECT = 8, /* `count` defects, which `text` describes */
  CONIC_FACT_FAULT = 9   /* the source cannot be drawn as a whole: `text` says why */
} conic_fact_type;

typedef struct conic_fact {
  conic_fact_type type;
  const char *key; /* a static name, as the program's JSON has it; null in arrays */
  uint64_t count;
  double number;
  char text[160];
} conic_fact;

typedef struct conic_facts conic_facts;

/* Facts of the last picture: the object "primitives", what was culled, its error, and the source's other counts. On
 * success the caller owns *facts. Errors: MEMORY. */
CONIC_API conic_status conic_source_describe(const conic_source *source, const conic_render_statistics *statistics,
                                             conic_facts **facts);

/* Facts of a file: first its kind, then its contents; with `is_checked` also the object "defects", for which the whole
 * file is read. On success the caller owns *facts. Errors: those of the functions that read each kind. */
CONIC_API conic_status conic_source_inspect(conic_context *context, const char *path, int is_checked,
                                            conic_facts **facts);

/* Fact `i`, or null after the last one. */
CONIC_API const conic_fact *conic_facts_at(const conic_facts *facts, size_t i);
/* Null is allowed. */
CONIC_API void conic_facts_destroy(conic_facts *facts);

CONIC_END_C
#endif
