#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/outputs.h"
#include "cli/render/render_job.h"

static const char *const occlusion_words[] = {"auto", "on", "off", NULL};
static const char *const cull_words[] = {"none", "back", NULL};
static const char *const as_words[] = {"points", "mesh", "hybrid", NULL};
static const char *const only_words[] = {"triangles", "surfels", NULL};

/* The words of choices that the library names, in the order of its numbers. */
typedef struct library_words {
  const char *methods[CONIC_N_METHODS + 2], *shadings[CONIC_N_SHADINGS + 1], *isas[CONIC_N_ISAS + 1];
} library_words;

static library_words find_words(void) {
  library_words words = {.methods[CONIC_N_METHODS] = "patch"};
  for (int i = 0; i < CONIC_N_METHODS; i++)
    words.methods[i] = conic_method_name((conic_method)i);
  for (int i = 0; i < CONIC_N_SHADINGS; i++)
    words.shadings[i] = conic_shading_name((conic_shading)i);
  for (int i = 0; i < CONIC_N_ISAS; i++)
    words.isas[i] = conic_isa_name((conic_isa)i);
  return words;
}

/* Options whose words are checked after all have been read. */
typedef struct raw_options {
  int size[2], is_size_given, is_framing_given;
  int isa;
  double cutoff, prefilter;
  int passes, is_patch_given;
  int as; /* a conic_representation */
  cli_length h;
} raw_options;

static int parse_output(const char *text, void *value) {
  cli_render_job *job = value;
  if (!*text || job->n_outputs == CLI_MAX_OUTPUTS)
    return 0;
  job->outputs[job->n_outputs++] = text;
  return 1;
}

static int parse_turntable(const char *text, void *value) {
  cli_render_job *job = value;
  char *end;
  long n = strtol(text, &end, 10);
  if (*end || end == text || n < 1 || n > 9999)
    return 0;
  job->is_turntable = 1;
  job->n_frames = (int)n;
  return 1;
}

/* gauss, hat, box, or confetti:A,B,N. */
static int parse_kernel(const char *text, void *value) {
  conic_kernel *kernel = value;
  double abn[3];
  for (int i = 0; i < CONIC_N_KERNELS; i++)
    if (strcmp(text, conic_kernel_type_name((conic_kernel_type)i)) == 0) {
      kernel->type = (conic_kernel_type)i;
      return 1;
    }
  if (strncmp(text, "confetti:", 9) != 0 || !cli_parse_vector(text + 9, abn) || !(abn[0] > 0.0) || !(abn[1] > 0.0) ||
      !(abn[2] >= 1.0 && abn[2] <= 16.0) || abn[2] != (double)(int)abn[2])
    return 0;
  kernel->type = CONIC_KERNEL_CONFETTI;
  kernel->a = (float)abn[0];
  kernel->b = (float)abn[1];
  kernel->n = (int)abn[2];
  return 1;
}

static int parse_epsilon(const char *text, void *value) {
  cli_length *epsilon = value;
  if (strcmp(text, "auto") == 0) {
    epsilon->value = -1.0;
    return 1;
  }
  return cli_parse_length(text, value);
}

static int parse_near(const char *text, void *value) {
  const cli_length *near_z = value;
  return cli_parse_length(text, value) && near_z->value > 0.0;
}

/* x, -y, … or X,Y,Z. */
static int parse_up(const char *text, void *value) {
  double *up = value, sign = 1.0;
  const char *letter = text;
  if (*letter == '-' || *letter == '+')
    sign = *letter++ == '-' ? -1.0 : 1.0;
  if ((*letter == 'x' || *letter == 'y' || *letter == 'z') && !letter[1]) {
    up[0] = up[1] = up[2] = 0.0;
    up[*letter - 'x'] = sign;
    return 1;
  }
  return cli_parse_vector(text, up) && (up[0] != 0.0 || up[1] != 0.0 || up[2] != 0.0);
}

static int parse_background(const char *text, void *value) {
  conic_render_options *options = value;
  double rgb[3];
  if (strcmp(text, "none") == 0) {
    options->has_background = 0;
    return 1;
  }
  if (!cli_parse_vector(text, rgb))
    return 0;
  options->has_background = 1;
  for (int i = 0; i < 3; i++)
    options->background[i] = (float)rgb[i];
  return 1;
}

static int parse_light(const char *text, void *value) {
  conic_render_options *options = value;
  options->has_light = 1;
  return cli_parse_vector(text, options->light) &&
         (options->light[0] != 0.0 || options->light[1] != 0.0 || options->light[2] != 0.0);
}

static int find_plane(const char *name, size_t length) {
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    const char *known = conic_plane_describe((conic_plane)i)->name;
    if (strlen(known) == length && strncmp(known, name, length) == 0)
      return i;
  }
  return -1;
}

/* rgba,Z,N … or all. */
static int parse_planes(const char *text, void *value) {
  unsigned *planes = value;
  *planes = 0;
  if (strcmp(text, "all") == 0) {
    *planes = CONIC_DRAWN_PLANES;
    return 1;
  }
  while (*text) {
    size_t length = strcspn(text, ",");
    int plane = find_plane(text, length);
    if (plane < 0)
      return 0;
    *planes |= 1u << plane;
    text += length;
    if (*text == ',' && text[1])
      text++;
  }
  return *planes != 0;
}

/* What goes with choosing less than everything, and with hybrid models. */
static int check_choice(const cli_session *session, const cli_render_job *job, int as) {
  const char *command = session->command;
  int is_hybrid = (job->abilities & CONIC_SOURCE_CLUSTERS) != 0;
  if (job->view.error_px > 0.0 && job->budget > 0)
    return cli_usage("%s: --error and --budget are two ways to choose; give one of both", command);
  if (job->is_patch && (as != CONIC_AS_POINTS || is_hybrid))
    return cli_usage("%s: --method patch draws points; not with --as mesh, nor hybrids", command);
  if (job->is_patch && cli_lod_is_wanted(job))
    return cli_usage("%s: --method patch draws samples of its own: not with --error or --budget", command);
  if (is_hybrid)
    return job->n_inputs == 1 ? CLI_DONE : cli_usage("%s: a hybrid is drawn by itself, and made of one mesh", command);
  if (job->view.only_kind >= 0 || job->clusters_path || job->planes & 1u << CONIC_PLANE_CLUSTER)
    return cli_usage("%s: --only, --clusters and the plane cluster are of hybrids: a .chy, or --as hybrid", command);
  if (job->abilities & CONIC_SOURCE_STREAMS && cli_lod_is_wanted(job) && !job->may_stream)
    return cli_usage("%s: of an .lpc it takes all; --error and --budget choose of one in conic render", command);
  int may_choose = job->abilities & CONIC_SOURCE_CHOOSES || (job->n_inputs == 1 && access(job->inputs[0], R_OK) != 0);
  if (cli_lod_is_wanted(job) && !may_choose)
    return cli_usage(
        "%s: --error and --budget need a single .cot, .lpc or .chy as input (conic octree, conic layer and "
        "conic hybrid make them), or --as hybrid",
        command);
  return CLI_DONE;
}

/* What the options of the scene and the drawing mean together. */
static int check_scene(const cli_session *session, const raw_options *raw, cli_render_job *job) {
  const char *command = session->command;
  if (job->n_inputs == 0)
    return cli_usage("%s: no input; see conic help %s", command, command);
  if (job->camera_path && raw->is_size_given)
    return cli_usage("%s: --size is the camera file's; give one of both", command);
  if (job->camera_path && (raw->is_framing_given || job->is_up_given))
    return cli_usage("%s: --azimuth, --elevation, --fov, --zoom and --up frame the scene; --camera does it itself",
                     command);
  if (job->opening.texture_path && raw->as == CONIC_AS_POINTS)
    return cli_usage("%s: --texture lies on triangles; give --as mesh or hybrid, too", command);
  if (job->opening.is_smooth && raw->as != CONIC_AS_MESH)
    return cli_usage("%s: --smooth is about triangles; give --as mesh, too", command);
  if (!job->is_patch && raw->is_patch_given)
    return cli_usage("%s: --degree and --h are of patches; give --method patch, too", command);
  if (raw->passes != 1 && raw->passes != 3)
    return cli_usage("%s: --passes takes 3 or 1", command);
  if (job->options.tile & (job->options.tile - 1))
    return cli_usage("%s: --tile takes 8, 16, 32 or 64", command);
  job->opening.as = job->is_patch && raw->as == CONIC_AS_POINTS ? CONIC_AS_PATCHES : (conic_representation)raw->as;
  job->abilities = conic_source_abilities(job->inputs, (size_t)job->n_inputs, &job->opening);
  job->opening.is_whole = !cli_lod_is_wanted(job) && !(job->may_stream && job->abilities & CONIC_SOURCE_STREAMS);
  int answer = check_choice(session, job, raw->as);
  return answer == CLI_DONE ? cli_device_check(session, &job->device) : answer;
}

/* Refused now, and not after the work. */
static int check_output(const char *path) {
  const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
  if (strcmp(path, "-") == 0)
    return cli_usage("render: a picture cannot go to standard output");
  if (!dot || !dot[1])
    return cli_usage("%s: the name needs an ending, such as .exr", path);
  return CLI_DONE;
}

static int check_deep(const cli_render_job *job) {
  const char *dot = strrchr(job->deep_path, '.');
  if (!dot || strcmp(dot, ".exr") != 0)
    return cli_usage("%s: a deep image is an .exr", job->deep_path);
  if (job->view.samples > 1)
    return cli_usage("render: --deep lists the splats of pixels, not of --samples");
  return CLI_DONE;
}

static int check_streaming(const cli_render_job *job, int is_given) {
  int streams = (job->abilities & CONIC_SOURCE_STREAMS) != 0;
  if ((job->progressive_path || job->deadline > 0.0 || is_given) && !streams)
    return cli_usage("render: --progressive, --deadline, --memory, --timeout and --occlusion are for a single .lpc, or "
                     "the URL of one");
  if (streams && job->deep_path)
    return cli_usage("render: --deep lists the splats of inputs that are read whole, not of an .lpc");
  if (job->progressive_path && (job->is_turntable || job->repeat > 1))
    return cli_usage("render: --progressive writes the pictures of one frame, not of a turntable or of --repeat");
  return CLI_DONE;
}

int cli_scene_inputs_stay(const cli_session *session, const cli_render_job *job, const char *const *outputs,
                          int n_outputs) {
  const char *const beside[] = {job->camera_path, job->opening.texture_path};
  int answer = cli_check_inputs_stay(session, job->inputs, job->n_inputs, outputs, n_outputs);
  return answer == CLI_DONE ? cli_check_inputs_stay(session, beside, 2, outputs, n_outputs) : answer;
}

/* What render's own options mean. */
static int check_outputs(const cli_session *session, const cli_render_job *job, int is_streaming_given) {
  const char *paths[CLI_MAX_OUTPUTS + 3];
  int answer = CLI_DONE;
  if (job->n_outputs == 0 && !job->deep_path && !job->overdraw_path && !job->clusters_path && !job->progressive_path)
    return cli_usage("render: no output; give one with -o OUT.exr, OUT.png, …");
  for (int i = 0; i < job->n_outputs && answer == CLI_DONE; i++)
    answer = check_output(paths[i] = job->outputs[i]);
  paths[job->n_outputs] = job->deep_path;
  paths[job->n_outputs + 1] = job->overdraw_path;
  paths[job->n_outputs + 2] = job->clusters_path;
  if (answer == CLI_DONE && job->deep_path)
    answer = check_deep(job);
  if (answer == CLI_DONE && job->overdraw_path)
    answer = check_output(job->overdraw_path);
  if (answer == CLI_DONE && job->clusters_path)
    answer = check_output(job->clusters_path);
  if (answer != CLI_DONE)
    return answer;
  if (cli_lod_is_wanted(job) && job->deep_path && !(job->abilities & CONIC_SOURCE_CLUSTERS))
    return cli_usage("render: --deep lists the splats of the input, not those that --error and --budget choose");
  if (job->is_patch && job->deep_path)
    return cli_usage("render: --method patch draws samples of its own: not with --deep");
  answer = check_streaming(job, is_streaming_given);
  if (answer != CLI_DONE)
    return answer;
  if (job->camera_path && job->is_turntable)
    return cli_usage("render: a turntable needs a framed camera, not --camera");
  answer = cli_check_outputs(session, paths, job->n_outputs + 3);
  return answer == CLI_DONE ? cli_scene_inputs_stay(session, job, paths, job->n_outputs + 3) : answer;
}

void cli_scene_defaults(cli_render_job *job) {
  memset(job, 0, sizeof *job);
  conic_framing_init(&job->framing);
  conic_render_options_init(&job->options);
  conic_source_options_init(&job->opening);
  conic_patches_options_init(&job->patches);
  conic_layers_access_init(&job->access);
  conic_source_view_init(&job->view);
  job->opening.patches = &job->patches;
  job->opening.access = &job->access;
  job->epsilon.value = job->near_z.value = -1.0;
  job->n_frames = job->repeat = 1;
  job->device.name = "cpu";
  job->planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z;
}

/* The command's own options, then those of the scene. */
static int parse_all(cli_session *session, const cli_option *own, int n_own, const cli_option *scene, int n_scene,
                     int argc, char **argv, cli_render_job *job) {
  cli_option *table = calloc((size_t)n_own + (size_t)n_scene, sizeof *table);
  job->inputs = calloc((size_t)argc + 1, sizeof *job->inputs);
  int answer = CLI_RESOURCE;
  if (table && job->inputs) {
    memcpy(table, own, (size_t)n_own * sizeof *table);
    memcpy(table + n_own, scene, (size_t)n_scene * sizeof *table);
    answer = cli_parse(session, table, n_own + n_scene, argc, argv, job->inputs, &job->n_inputs);
  } else
    cli_error(CLI_RESOURCE, "%s: out of memory", session->command);
  free(table);
  return answer;
}

int cli_scene_parse(cli_session *session, const cli_option *own, int n_own, int argc, char **argv,
                    cli_render_job *job) {
  raw_options raw = {
      .passes = 3, .cutoff = (double)job->options.kernel.cutoff, .prefilter = (double)job->options.prefilter};
  conic_render_options *o = &job->options;
  conic_framing *view = &job->framing;
  int method = (int)o->method, shading = (int)o->shading;
  const library_words words = find_words();
  const cli_option table[] = {
      {"size", CLI_SIZE, raw.size, "WxH", "pixels [1024x1024]", 1, 65535, .is_given = &raw.is_size_given},
      {"camera", CLI_TEXT, &job->camera_path, "FILE", "a pinhole camera in JSON, in place of the framing"},
      {"azimuth", CLI_NUMBER, &view->azimuth_deg, "DEG", "the camera's place around the scene [30]", -1e6, 1e6,
       .is_given = &raw.is_framing_given},
      {"elevation", CLI_NUMBER, &view->elevation_deg, "DEG", "the camera's height above the horizon [15]", -90, 90,
       .is_given = &raw.is_framing_given},
      {"fov", CLI_NUMBER, &view->fov_deg, "DEG", "field of view across the shorter side [40]", 0.001, 179.9,
       .is_given = &raw.is_framing_given},
      {"zoom", CLI_NUMBER, &view->zoom, "Z", "multiplies the focal length [1]", 1e-6, 1e6,
       .is_given = &raw.is_framing_given},
      {"up", CLI_PARSED, view->up, "DIR", "what points up: x, y, z, -x … or X,Y,Z [y; z for LAS]", .parse = parse_up,
       .is_given = &job->is_up_given},
      {"as", CLI_CHOICE, &raw.as, "WHAT",
       "what a mesh is drawn as: points (a splat a vertex), mesh (triangles) or hybrid (both) [points]",
       .choices = as_words},
      {"texture", CLI_TEXT, &job->opening.texture_path, "FILE", "the picture on a mesh's triangles [its materials']"},
      {"smooth", CLI_FLAG, &job->opening.is_smooth, NULL,
       "of a mesh's triangles: normals that are the means of the faces', in place of the file's"},
      {"error", CLI_NUMBER, &job->view.error_px, "PX",
       "of a .cot, .lpc or hybrid, no more than keeps the error on the screen below this; 0: all [0]", 0, 65536},
      {"budget", CLI_COUNT, &job->budget, "N",
       "of a .cot, .lpc or hybrid, the N primitives or fewer whose error is the least", 1, 4294967294.0},
      {"only", CLI_CHOICE, &job->view.only_kind, "KIND", "of a hybrid, draw every patch as triangles or as surfels",
       .choices = only_words},
      {"method", CLI_CHOICE, &method, "NAME",
       "how a splat is projected and weighed: point, disc, affine, conic, ray, auto; patch: as part of a smooth "
       "surface [conic]",
       .choices = words.methods},
      {"kernel", CLI_PARSED, &o->kernel, "NAME", "gauss, confetti:A,B,N, hat or box [gauss]", .parse = parse_kernel},
      {"cutoff", CLI_NUMBER, &raw.cutoff, "F", "standard deviations at which a splat ends [1.5]", 0.25, 5},
      {"prefilter", CLI_NUMBER, &raw.prefilter, "V", "variance of the low-pass in square pixels; 0: none [1]", 0,
       10000},
      {"epsilon", CLI_PARSED, &job->epsilon, "E",
       "depth tolerance along the ray, also in spacings (2x), or auto [auto]", .parse = parse_epsilon},
      {"passes", CLI_INT, &raw.passes, "N", "3: blend a surface's splats; 1: the nearest splat wins [3]", 1, 3},
      {"samples", CLI_INT, &job->view.samples, "N", "N x N samples a pixel, averaged: soft silhouettes [1]", 1,
       CONIC_MAX_SAMPLES},
      {"cull", CLI_CHOICE, &o->cull_back, "WHAT", "none, or back: what faces away is left out [none]",
       .choices = cull_words},
      {"near", CLI_PARSED, &job->near_z, "Z", "nothing nearer is drawn [1e-4 of the scene's diagonal]",
       .parse = parse_near},
      {"shade", CLI_CHOICE, &shading, "HOW", "none (albedo), lambert or phong [phong]", .choices = words.shadings},
      {"light", CLI_PARSED, o, "X,Y,Z", "direction towards the light, in the world [a headlight]",
       .parse = parse_light},
      {"background", CLI_PARSED, o, "R,G,B", "linear colour behind, or none: transparent [none]",
       .parse = parse_background},
      {"exposure", CLI_NUMBER, &o->exposure, "EV", "stops: the picture is multiplied by 2^EV [0]", -100, 100},
      {"aov", CLI_PARSED, &job->planes, "LIST",
       "planes: rgba,Z,N,albedo,weight,count,id or all; cluster of hybrids [rgba,Z]", .parse = parse_planes},
      {"degree", CLI_INT, &job->patches.surface.degree, "D", "patch: of the polynomials, 1 to 4 [3]", 1,
       CONIC_SURFACE_MAX_DEGREE, .is_given = &raw.is_patch_given},
      {"h", CLI_PARSED, &raw.h, "H", "patch: what is smaller is smoothed away; also in spacings (2x) [local]",
       .parse = cli_parse_length, .is_given = &raw.is_patch_given, .dashes = "--"},
      {"k", CLI_INT, &job->opening.n_neighbours, "K",
       "neighbours that a raw point's size is estimated from, 6 to 64 [20]", 6, 64},
      {"tile", CLI_INT, &o->tile, "N", "tile edge in pixels, 8, 16, 32 or 64; changes no bit [64]", 8, 64},
      {"device", CLI_TEXT, &job->device.name, "NAME",
       "what draws: cpu, opencl (the first device) or opencl:P.D; changes no bit [cpu]"},
      {"allow-inexact", CLI_FLAG, &job->device.allow_inexact, NULL,
       "also an OpenCL device whose rounding makes the picture another one"},
      {"isa", CLI_CHOICE, &raw.isa, "NAME", "auto, scalar, sse2, avx2, avx512, neon; changes no bit [auto]",
       .choices = words.isas},
  };
  int answer = parse_all(session, own, n_own, table, (int)(sizeof table / sizeof table[0]), argc, argv, job);
  if (answer != CLI_DONE)
    return answer;
  job->is_patch = method == CONIC_N_METHODS;
  o->method = job->is_patch ? CONIC_METHOD_CONIC : (conic_method)method;
  o->shading = (conic_shading)shading;
  o->kernel.cutoff = (float)raw.cutoff;
  o->prefilter = (float)raw.prefilter;
  o->passes = raw.passes;
  o->isa = session->isa = (conic_isa)raw.isa;
  job->view.budget = job->budget;
  job->opening.cutoff = o->kernel.cutoff;
  job->opening.h_in_spacings = raw.h.is_in_spacings;
  job->patches.surface.h = raw.h.value;
  job->patches.surface.isa = o->isa;
  if (raw.is_size_given) {
    view->width = raw.size[0];
    view->height = raw.size[1];
  }
  return check_scene(session, &raw, job);
}

int cli_render_parse(cli_session *session, int argc, char **argv, cli_render_job *job) {
  cli_scene_defaults(job);
  job->may_stream = 1;
  int memory_mib = 512, occlusion = CONIC_OCCLUSION_AUTO, is_streaming_given = 0;
  const cli_option own[] = {
      {"o", CLI_PARSED, job, "OUT", "where the picture goes: .exr, .png, .tif, .jpg, .pfm …; may be repeated",
       .parse = parse_output},
      {"deep", CLI_TEXT, &job->deep_path, "OUT.exr",
       "every splat and triangle of every pixel, as a deep image: id, depth, weight"},
      {"overdraw", CLI_TEXT, &job->overdraw_path, "OUT.png",
       "how many splats each pixel blends, in false colours: blue 1, red 4, yellow 16, white 64"},
      {"turntable", CLI_PARSED, job, "N", "N pictures around the scene: OUT.0001.exr …", .parse = parse_turntable},
      {"clusters", CLI_TEXT, &job->clusters_path, "OUT.png", "the patches of a hybrid in false colours"},
      {"progressive", CLI_TEXT, &job->progressive_path, "DIR",
       "of an .lpc, also a picture of each level: DIR/0001.exr …"},
      {"deadline", CLI_NUMBER, &job->deadline, "S",
       "of an .lpc, no more is read after so many seconds; what is missing is drawn coarser", 0.001, 1e6},
      {"memory", CLI_INT, &memory_mib, "MiB", "of an .lpc, what clouds and splats may take [512]", 1, 1 << 20,
       .is_given = &is_streaming_given},
      {"occlusion", CLI_CHOICE, &occlusion, "HOW",
       "of an .lpc, leave out what is hidden: auto, on or off; changes no bit [auto]", .choices = occlusion_words,
       .is_given = &is_streaming_given},
      {"timeout", CLI_NUMBER, &job->access.stall_seconds, "S",
       "of a URL, a server that is silent for so long is asked again, up to 4 times [15]", 1, 3600,
       .is_given = &is_streaming_given},
      {"repeat", CLI_INT, &job->repeat, "N", "renders N times and reports the median [1]", 1, 100000},
  };
  int answer = cli_scene_parse(session, own, (int)(sizeof own / sizeof own[0]), argc, argv, job);
  job->access.memory_bytes = (uint64_t)memory_mib << 20;
  job->access.connect_seconds = job->access.stall_seconds;
  job->view.occlusion = (conic_occlusion)occlusion;
  job->view.may_be_coarser = job->progressive_path || job->deadline > 0.0;
  if (job->overdraw_path)
    job->planes |= 1u << CONIC_PLANE_COUNT;
  if (job->clusters_path)
    job->planes |= 1u << CONIC_PLANE_CLUSTER | 1u << CONIC_PLANE_RGBA;
  if (job->planes & 1u << CONIC_PLANE_CLUSTER)
    job->planes |= 1u << CONIC_PLANE_ID;
  return answer == CLI_DONE ? check_outputs(session, job, is_streaming_given) : answer;
}
