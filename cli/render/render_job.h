/* One `conic render`: what was asked for, and what came of it. */
#ifndef CONIC_RENDER_JOB_H
#define CONIC_RENDER_JOB_H

#include "cli/arguments.h"
#include "cli/device_option.h"
#include "cli/json_write.h"

enum { CLI_MAX_OUTPUTS = 8 };

typedef enum cli_representation { CLI_AS_POINTS = 0, CLI_AS_MESH = 1, CLI_AS_HYBRID = 2 } cli_representation;

/* Where the only input is a layered point cloud. */
typedef struct cli_render_layers {
  /* What was asked for. */
  const char *progressive_path; /* --progressive; null: none */
  double deadline;              /* seconds; 0: none */
  double timeout;               /* seconds */
  int memory_mib, occlusion;    /* the latter a conic_occlusion */
  int is_given;                 /* one of the options that are for layered clouds alone */
  double start_seconds;         /* from which the deadline counts */

  conic_layers *file; /* null: the input is something else */
  conic_layers_scale scale;

  /* What came of it. */
  conic_layers_drawn drawn;
  int n_pictures;
} cli_render_layers;

typedef struct cli_render_job {
  /* What was asked for. */
  const char **inputs;
  int n_inputs;
  const char *outputs[CLI_MAX_OUTPUTS];
  int n_outputs;
  const char *deep_path;     /* --deep; null: none */
  const char *overdraw_path; /* --overdraw; null: none */
  const char *camera_path;   /* null: framed */
  conic_camera camera;       /* the file's */
  conic_framing framing;
  int is_up_given;
  int n_frames; /* of a turntable; 1 without */
  int is_turntable;
  int is_warned; /* that a picture is empty */
  int repeat;
  int samples;     /* N × N a pixel */
  unsigned planes; /* bits 1 << conic_plane */
  int n_neighbours;
  int is_patch;                 /* --method patch: options.method draws its samples */
  int degree;                   /* of its polynomials */
  cli_length h;                 /* of its surface; 0: local */
  conic_render_options options; /* but for the two lengths, which the scene has to be known for: */
  cli_length epsilon, near_z;   /* below 0: automatic */
  cli_device device;            /* what draws: */
  conic_renderer *renderer;
  int as;                    /* what meshes are drawn as, a cli_representation */
  int is_smooth;             /* meshes get vertex normals from their faces */
  const char *texture_path;  /* of meshes that are drawn as such, in place of their own; null: none */
  double error_px;           /* 0: every splat */
  unsigned long long budget; /* 0: no limit; splats, or triangles and surfels */

  /* Where one of both is given: the only input, and what was chosen of it for the frame. */
  conic_octree *octree;
  conic_octree_info info;
  conic_selection selection;

  int draws_layers; /* a layered point cloud is drawn cloud by cloud, and not read whole */
  cli_render_layers layers;

  conic_triangles triangles; /* read beside the splats, with --as mesh */

  /* A .chy, or a mesh with --as hybrid: the only input, and what was chosen of it for the frame. */
  conic_hybrid *hybrid;
  conic_hybrid_info hybrid_info;
  conic_hybrid_selection hybrid_selection;
  const char *clusters_path; /* --clusters; null: none */
  int only_kind;             /* --only: a conic_hybrid_kind, or -1 */
  /* Of --method patch: the points' polynomials, and the frame's samples. */
  conic_patches *patches;
  conic_patch_selection patch_selection;

  /* What came of it. */
  conic_render_statistics statistics; /* of the last frame; times are medians where frames repeat */
  double first_frame_ms;
  double read_ms, estimate_ms, write_ms, total_ms;
} cli_render_job;

/* Reads the arguments. Returns CLI_DONE, CLI_USAGE after a message, or -1 where help was printed. */
int cli_render_parse(cli_session *session, int argc, char **argv, cli_render_job *job);

/* The same for another command that takes render's camera and drawing options beside `own` ones, and has neither
 * outputs nor several frames. */
int cli_scene_parse(cli_session *session, const cli_option *own, int n_own, int argc, char **argv, cli_render_job *job);
/* What job's options are before any is parsed; cli_scene_parse leaves alone what is no option of its own. */
void cli_scene_defaults(cli_render_job *job);

/* Wrong usage where an output (null entries are fine), or --json's, is a file that the scene is read from. */
int cli_scene_inputs_stay(const cli_session *session, const cli_render_job *job, const char *const *outputs,
                          int n_outputs);

/* Whether less than everything is to be drawn. */
int cli_lod_is_wanted(const cli_render_job *job);
/* Opens the only input, an octree, into the job. */
conic_status cli_lod_open(cli_session *session, cli_render_job *job);
/* Chooses for a frame; *ms is what it took. */
conic_status cli_lod_select(cli_render_job *job, const conic_camera *camera, double *ms);
/* Ends both; fine where they never were. */
void cli_lod_close(cli_session *session, cli_render_job *job);

/* Whether a name is that of a layered point cloud: a URL, or such a file. */
int cli_layers_is_input(const char *name);
/* Whether the only input is one. */
int cli_layers_is_wanted(const cli_render_job *job);
/* Opens it into the job. */
conic_status cli_layers_open(cli_session *session, cli_render_job *job);
/* Draws a frame of it, with --progressive several, of which the last stays in `image`. */
conic_status cli_layers_draw(cli_session *session, cli_render_job *job, const conic_camera *camera, conic_image *image,
                             conic_render_statistics *statistics);
/* Fine where it never was open. */
void cli_layers_close(cli_render_job *job);
void cli_render_layers_report(cli_json *json, const cli_render_job *job);

/* Whether the only input is a hybrid model, or is to be made one. */
int cli_hybrid_is_wanted(const cli_render_job *job);
/* Reads or builds it into the job. */
conic_status cli_hybrid_open(cli_session *session, cli_render_job *job);
/* Chooses for a frame; *ms is what it took. */
conic_status cli_hybrid_select(cli_render_job *job, const conic_camera *camera, double *ms);
/* --clusters: the clusters in colours of their own, as they are shaded in `image`. */
conic_status cli_hybrid_write_clusters(cli_session *session, const char *path, const conic_image *image);
/* Ends it; fine where it never was. */
void cli_hybrid_close(cli_session *session, cli_render_job *job);
/* "patch", or the method by which splats are drawn. */
const char *cli_method_name(const cli_render_job *job);
/* Lays patches about the points of measured splats, which must outlive them; ε then goes with the points. */
conic_status cli_patch_open(cli_session *session, cli_render_job *job, const conic_splats *splats);
/* Samples them for a frame; *ms is what it took. */
conic_status cli_patch_select(cli_render_job *job, const conic_camera *camera, double *ms);
/* Ends both; fine where they never were. */
void cli_patch_close(cli_render_job *job);

/* What is drawn: what was chosen, or the splats and the job's triangles. */
conic_drawing cli_scene_drawing(const cli_render_job *job, const conic_splats *splats);
/* Chooses for a frame where that is asked for, and says what is drawn; *ms is what it took. */
conic_status cli_scene_select(cli_render_job *job, const conic_camera *camera, const conic_splats *splats,
                              conic_drawing *drawing, double *ms);
/* Names what was chosen in the drawn picture: planes id and cluster. */
void cli_scene_name(const cli_render_job *job, conic_image *image);

/* Makes the renderer and reads the camera's file: what is missing of these is said before the inputs are read, which
 * may take minutes. Released by cli_scene_release, also after a failure. */
conic_status cli_scene_begin(cli_session *session, cli_render_job *job);
/* Reads the inputs into one set of splats, which the caller releases by cli_scene_release, also after a failure; and
 * into the job's triangles. */
conic_status cli_scene_read(cli_session *session, cli_render_job *job, conic_splats *splats);
void cli_scene_release(cli_session *session, cli_render_job *job, conic_splats *splats);
/* Fills in what every frame would find anew: the near distance and the scale of ε. Of an octree the splats are of no
 * matter here and in cli_scene_camera. */
conic_status cli_scene_measure(cli_session *session, cli_render_job *job, const conic_splats *splats);
/* The camera of a frame. */
conic_status cli_scene_camera(cli_session *session, const cli_render_job *job, const conic_splats *splats, int i_frame,
                              conic_camera *camera);

/* Writes the statistics of the finished job and the hashes of its last image to the session's --json file, if any.
 * Returns the exit code. */
int cli_render_report(cli_session *session, const cli_render_job *job, const conic_image *image);

#endif
