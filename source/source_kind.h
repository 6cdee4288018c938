/* A kind of source: one file that fills in this table, and one line in the list of source/source.c. */
#pragma once

#include "core/pictures/georeference.h"
#include "core/splats/shares.h"
#include "source/facts.h"
#include "source/source_parts.h"

/* Facts about a source's origin that its scale does not hold, as bits. */
typedef enum conic_source_trait {
  CONIC_TRAIT_FACES = 1,     /* a file has faces, whatever they became */
  CONIC_TRAIT_EDGES = 2,     /* triangles whose file has no normals */
  CONIC_TRAIT_RAW = 4,       /* points whose sizes were estimated */
  CONIC_TRAIT_TEXT = 8,      /* a file of text */
  CONIC_TRAIT_ALPHA = 16,    /* something lets light through */
  CONIC_TRAIT_FRACTIONS = 32 /* colours whose meaning an option says */
} conic_source_trait;

typedef enum conic_source_company {
  CONIC_SOURCE_SINGLE, /* takes an input that is the only one; beside others, its splats are read */
  CONIC_SOURCE_ALONE,  /* refuses other inputs beside it */
  CONIC_SOURCE_ALIKE,  /* takes inputs all of which it takes */
  CONIC_SOURCE_MANY
} conic_source_company;

/* Any function may be null unless its comment says otherwise. */
typedef struct conic_source_kind {
  size_t size; /* of the kind's own struct, which begins with a conic_source */
  unsigned abilities;
  conic_source_company company;

  /* Whether an input becomes this kind; never null. The first kind of the list that says so takes the input. */
  int (*takes)(const char *path, const conic_source_options *options);
  /* Where this is not null, one input at least is to be such. */
  int (*wants)(const char *path);
  /* Fills in a zeroed source and its scale; of the times, only those other than reading. After a failure it is closed
   * as usual. Never null. */
  conic_status (*open)(conic_source *source, const char *const *paths, size_t n_paths,
                       const conic_source_options *options);
  void (*close)(conic_source *source); /* never null */
  conic_status (*find_spacing)(conic_source *source, double *spacing);

  /* conic_source_move with checked poses, one for each input; null poses: at rest. If the function is null, the source
   * moves as one piece (source/carried.h). */
  conic_status (*move)(conic_source *source, const conic_source_pose *poses, size_t n_poses);

  /* Fills in the choice, which begins as two empty sets; null: the choice stays as opening set it. */
  conic_status (*choose)(conic_source *source, const conic_camera *camera, const conic_render_options *render,
                         const conic_source_view *view);
  /* Draws by itself, in place of choosing and rendering. */
  conic_status (*draw)(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                       const conic_render_options *render, const conic_source_view *view, conic_image *image,
                       conic_render_statistics *statistics);
  const conic_source_windowing *windowing; /* null: not drawn in windows */
  conic_status (*draw_boxes)(conic_source *source, const conic_camera *camera, int level, const conic_image *image,
                             conic_image *map);
  void (*name_image)(const conic_source *source, conic_image *image);
  const char *(*name_splat)(const conic_source *source, uint32_t splat, uint32_t *number);
  /* Which input has an id; null: the first one. */
  size_t (*input_of)(const conic_source *source, uint32_t id);

  /* Add facts of the last picture: to the object "primitives", where *n_splats is the number that drawing counted; and
   * after it. */
  void (*tell_primitives)(const conic_source *source, conic_facts *facts, uint64_t *n_splats);
  void (*tell_rest)(const conic_source *source, conic_facts *facts);

  /* Whether a file begins as the kind's files do. Where this is not null, `name`, tell_file and tell_defects are not
   * null, either. */
  int (*is_file)(const char *path);
  const char *name;
  const char *(*name_file)(const char *path); /* the kind of a file, where files of this kind differ; null: `name` is
                                                 the kind of all */
  /* Add facts of the file that a source was created for, which they may open: its contents; and the object
   * "defects". */
  conic_status (*tell_file)(conic_source *source, conic_facts *facts);
  conic_status (*tell_defects)(conic_source *source, conic_facts *facts);
  /* All of an open source, as it is kept, without turning dots; or else the splats of a region, as
   * conic_layers_gather_part gives them: with may_cut, no more than memory holds. */
  conic_drawing (*list_all)(const conic_source *source);
  conic_status (*gather)(conic_source *source, const conic_layers_region *part, int may_cut,
                         const conic_splats **splats, int *is_cut_short);
  /* The coordinate system of its positions, which the caller releases; null: the first file's, if it states one as a
   * LAS does. */
  conic_status (*find_georeference)(const conic_source *source, conic_georeference *reference);
  /* All splats of an open source, which the caller releases. */
  conic_status (*take_splats)(conic_source *source, conic_splats *splats);
} conic_source_kind;

struct conic_source {
  const conic_source_kind *kind;
  conic_context *context;
  char *name; /* of the first input */
  conic_source_scale scale;
  conic_source_choice choice;
  conic_source_view view; /* of the last picture */
  conic_coloring coloring;
  uint64_t splats_version; /* for conic_render_options, in pictures of the whole source; 0: the splats may change */
  int is_moved;            /* what is drawn has another box than the scale's: */
  double moved_minimum[3], moved_maximum[3];
  double world_from_rest[3][4]; /* of a source that is moved as one piece */
  unsigned traits, no_traits;   /* bits of conic_source_trait: those that it has, and those that it surely lacks */
  conic_splats outline;         /* from conic_source_take_samples, if it was called */
  int has_surfaces_outline;     /* and that of the surfaces among its Gaussians */
  int has_front;                /* the next is known: */
  double fronts[2][3];          /* by conic_upright_look */
  double samples_until;         /* by the clock: after this nothing is read for the outline; 0: no limit */
  int only_samples;             /* of layered clouds, in the next picture: coarse places show some of their samples */
  double tolerance;             /* how far splats made of meshes are off these; 0: there are none */
  conic_splats_shares shares;   /* the team that shares the splats; the choice then holds this process's part for
                                   functions that look at all */
};

extern const conic_source_kind conic_source_kind_drawing, conic_source_kind_octree, conic_source_kind_layers,
    conic_source_kind_hybrid, conic_source_kind_patches, conic_source_kind_gaussians, conic_source_kind_scenes,
    conic_source_kind_together, conic_source_kind_shared, conic_source_kind_levels, conic_source_kind_level_scenes,
    conic_source_kind_level_together;

/* The mean of the normals by area, of points over land turned up; 0 where they say nothing, as of Gaussians. Across the
 * direction up, it is at least *least_slope of what has a front. Looks at the source once. Collective where it is
 * shared. Errors: as conic_source_stand. */
conic_status conic_source_front(conic_source *source, double front[3], double *least_slope);

/* Adds the object "skipped" to a source's facts. */
void conic_facts_add_repairs(conic_facts *facts, const conic_repairs *repairs);

/* The kind of a file that only one kind reads; null: the file is read as a model. */
const conic_source_kind *conic_source_kind_of_file(const char *path);

/* The kind that these files become. */
const conic_source_kind *conic_source_kind_find(const char *const *paths, size_t n_paths,
                                                const conic_source_options *options);

/* A source of a kind, opened; and one that is zeroed except for its name. */
conic_status conic_source_open_kind(conic_context *context, const conic_source_kind *kind, const char *const *paths,
                                    size_t n_paths, const conic_source_options *options, conic_source **source);
conic_status conic_source_create(conic_context *context, const conic_source_kind *kind, const char *name,
                                 conic_source **source);
/* After a failure closes the source; returns `status`. */
conic_status conic_source_finish(conic_status status, conic_source **source);

/* How a picture is chosen and drawn: if the source moves as one piece, as a picture of the source at rest. */
typedef struct conic_source_picture {
  conic_camera camera;
  conic_render_options render;
  int is_carried;
} conic_source_picture;

/* Makes the view the source's, and fills in the options. Errors: ARGUMENT, UNSUPPORTED (transparency). */
conic_status conic_source_begin_picture(conic_source *source, const conic_camera *camera,
                                        const conic_render_options *render, const conic_source_view *view,
                                        conic_source_picture *picture);
/* conic_source_choose after that. */
conic_status conic_source_choose_settled(conic_source *source, const conic_camera *camera,
                                         const conic_render_options *render);

/* Whether colours are wanted that are not the file's own. */
int conic_coloring_is_asked(const conic_source_options *options);
/* Refuses such colours for a file that keeps no fields. Errors: INPUT. */
conic_status conic_coloring_refuse(conic_context *context, const char *path, const conic_source_options *options);
/* Colours the sets that a source was read as, as its options say; if heights need it, finds which way is up. Errors: as
 * conic_drawing_color. */
conic_status conic_source_color(conic_source *source, const conic_source_options *options, conic_splats *splats,
                                conic_triangles *triangles);

/* conic_source_inspect of a file that is read as a model, or as a Gaussian scene. */
conic_status conic_model_inspect(conic_context *context, const char *path, int is_checked, conic_facts *facts);
conic_status conic_gaussians_inspect(conic_context *context, const char *path, int is_checked, conic_facts *facts);
