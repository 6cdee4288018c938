/* The options of a scene and its drawing. */
#include <stdlib.h>
#include <string.h>

#include "cli/color_options.h"
#include "cli/render/backdrop.h"
#include "cli/render/light_options.h"
#include "cli/render/projection.h"
#include "cli/render/scene_options.h"
#include "cli/render/views.h"

static const char *const cull_words[] = {"none", "back", NULL};
static const char *const as_words[] = {"auto", "points", "mesh", "hybrid", NULL};
static const conic_representation as_values[] = {CONIC_AS_AUTO, CONIC_AS_POINTS, CONIC_AS_MESH, CONIC_AS_HYBRID};
static const char *const quality_words[] = {"draft", "good", "final", NULL};
static const char *const only_words[] = {"triangles", "surfels", NULL};

/* The words of choices that the library names, in the order of its numbers. */
typedef struct library_words {
  const char *methods[CONIC_N_METHODS + 2], *shadings[CONIC_N_SHADINGS + 1], *isas[CONIC_N_ISAS + 1];
  const char *profiles[CONIC_N_GAUSSIAN_PROFILES + 2];
} library_words;

static library_words find_words(void) {
  library_words words = {.methods[CONIC_N_METHODS] = "patch", .profiles[CONIC_N_GAUSSIAN_PROFILES] = "surface"};
  for (int i = 0; i < CONIC_N_GAUSSIAN_PROFILES; i++)
    words.profiles[i] = conic_gaussian_profile_name((conic_gaussian_profile)i);
  for (int i = 0; i < CONIC_N_METHODS; i++)
    words.methods[i] = conic_method_name((conic_method)i);
  for (int i = 0; i < CONIC_N_SHADINGS; i++)
    words.shadings[i] = conic_shading_name((conic_shading)i);
  for (int i = 0; i < CONIC_N_ISAS; i++)
    words.isas[i] = conic_isa_name((conic_isa)i);
  return words;
}

void cli_scene_defaults(cli_render_job *job) {
  memset(job, 0, sizeof *job);
  conic_framing_init(&job->framing);
  conic_render_options_init(&job->options);
  conic_source_options_init(&job->opening);
  conic_gaussian_options_init(&job->gaussians);
  conic_patches_options_init(&job->patches);
  conic_layers_access_init(&job->access);
  conic_source_view_init(&job->view);
  conic_coloring_options_init(&job->coloring);
  job->coloring.by = NULL;
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

/* Whether what is drawn is to be looked at: not to be measured or taken apart, nor too large to have several samples.
 */
static int is_picture(const cli_scene_words *raw, const cli_render_job *job) {
  int size = raw->size[0] > raw->size[1] ? raw->size[0] : raw->size[1];
  return job->is_for_looking && job->repeat == 1 && !job->deep_path && size <= 65535 / 2;
}

/* What the quality stands for, where it is not said otherwise. */
static void choose_quality(const cli_scene_words *raw, cli_render_job *job, int *method) {
  static const int samples[] = {1, 2, 4};
  int is_wanted = raw->is_quality_given || !job->is_plain;
  if (is_wanted && !raw->is_method_given)
    *method = raw->quality == CLI_QUALITY_DRAFT ? CONIC_METHOD_CONIC : CONIC_METHOD_AUTO;
  if (is_wanted && !raw->is_samples_given && (raw->is_quality_given || is_picture(raw, job)))
    job->view.samples = samples[raw->quality];
}

int cli_scene_parse(cli_session *session, const cli_option *own, int n_own, int argc, char **argv,
                    cli_render_job *job) {
  cli_scene_words raw = {.quality = CLI_QUALITY_GOOD,
                         .passes = 3,
                         .cutoff = (double)job->options.kernel.cutoff,
                         .prefilter = (double)job->options.prefilter};
  conic_render_options *o = &job->options;
  conic_framing *view = &job->framing;
  int method = (int)o->method, shading = (int)o->shading, profile = 0, ignores_center = 0;
  const library_words words = find_words();
  const cli_option table[] = {
      {"size", CLI_SIZE, raw.size, "WxH",
       "pixels; a file's cameras are scaled to it, each axis by itself [1024x1024, or the file's]", 1, 65535,
       .is_given = &raw.is_size_given},
      {"camera", CLI_TEXT, &job->camera_path, "FILE", CLI_CAMERA_HELP},
      {"view", CLI_TEXT, &job->view_name, "VIEW",
       "of --camera: an index from 0, the name of an image with or without its folder and ending, or all [the only "
       "one]"},
      {"azimuth", CLI_NUMBER, &view->azimuth_deg, "DEG", "the camera's place around the scene [30]", -1e6, 1e6,
       .is_given = &raw.is_framing_given},
      {"elevation", CLI_NUMBER, &view->elevation_deg, "DEG",
       "the camera's height above the horizon [15; 35 for what lies flat]", -90, 90,
       .is_given = &job->is_elevation_given},
      {"fov", CLI_NUMBER, &view->fov_deg, "DEG", "field of view across the shorter side [40]", 0.001, 179.9,
       .is_given = &raw.is_framing_given},
      {"zoom", CLI_NUMBER, &view->zoom, "Z", "multiplies the focal length [1]", 1e-6, 1e6,
       .is_given = &raw.is_framing_given},
      {"projection", CLI_CHOICE, &job->projection, "HOW",
       "perspective, or of a Gaussian scene by --profile exact: orthographic, fisheye or panorama [perspective]",
       .choices = cli_projection_words, .is_given = &raw.is_framing_given},
      {"eye", CLI_PARSED, job->eye, "X,Y,Z",
       "the place from which the camera looks [where it sees all of the scene; a panorama's: the scene's middle]",
       .parse = cli_parse_eye, .is_given = &job->is_eye_given},
      {"up", CLI_PARSED, view->up, "DIR", "what points up: x, y, z, -x … or X,Y,Z [the file's, or by its shape]",
       .parse = cli_parse_up, .is_given = &job->is_up_given},
      {"as", CLI_CHOICE, &raw.as, "WHAT",
       "what a mesh is drawn as: auto (triangles), points (splats of the vertices), mesh or hybrid (both) [auto]",
       .choices = as_words, .is_given = &raw.is_as_given},
      {"texture", CLI_TEXT, &job->opening.texture_path, "FILE", "the picture on a mesh's triangles [its materials']"},
      CLI_TEXTURE_BOUND(session),
      {"smooth", CLI_FLAG, &job->opening.is_smooth, NULL,
       "of a mesh's triangles: normals that are the means of the faces', in place of the file's"},
      {"crease", CLI_NUMBER, &job->opening.crease_deg, "DEG",
       "triangles without normals are round over edges up to this angle; 0: flat [30]", 0, 90,
       .is_given = &raw.is_crease_given},
      CLI_COLOR_OPTIONS(&job->coloring),
      {"error", CLI_NUMBER, &job->view.error_px, "PX",
       "of a .cot, .lpc or hybrid, no more than keeps the error on the screen below this; 0: all [0]", 0, 65536},
      {"budget", CLI_COUNT, &job->budget, "N",
       "of a .cot, .lpc or hybrid, the N primitives or fewer whose error is the least", 1, 4294967294.0},
      {"only", CLI_CHOICE, &job->view.only_kind, "KIND", "of a hybrid, draw every patch as triangles or as surfels",
       .choices = only_words},
      {"method", CLI_CHOICE, &method, "NAME",
       "how a splat is projected and weighed: point, disc, affine, conic, ray, auto; patch: as part of a smooth "
       "surface [auto]",
       .choices = words.methods, .is_given = &raw.is_method_given},
      {"profile", CLI_CHOICE, &profile, "NAME",
       "how a Gaussian scene is drawn: exact, as a version of another program (inria-2023, gsplat-1.5, gsplat-1.5-aa, "
       "gsplat-1.6, gsplat-1.6-aa, 2dgs-2024, 2dgs-gsplat, khr-2026), or surface: as opaque splats [exact]",
       .choices = words.profiles, .is_given = &raw.is_profile_given},
      {"ignore-center", CLI_FLAG, &ignores_center, NULL,
       "of --profile inria-2023 and 2dgs-2024: take the picture's centre for the camera's, as these do"},
      {"quality", CLI_CHOICE, &raw.quality, "HOW",
       "draft (conic, 1 sample), good (auto, 2 x 2 samples) or final (auto, 4 x 4); --method and --samples go first "
       "[good]",
       .choices = quality_words, .is_given = &raw.is_quality_given},
      {"kernel", CLI_PARSED, &o->kernel, "NAME", "gauss, confetti:A,B,N, hat or box [gauss]",
       .parse = cli_parse_kernel},
      {"cutoff", CLI_NUMBER, &raw.cutoff, "F", "standard deviations at which a splat ends [1.5]", 0.25, 5},
      {"prefilter", CLI_NUMBER, &raw.prefilter, "V",
       "variance of the low-pass in square pixels; 0: none [1; 0 of Gaussian scenes]", 0, 10000,
       .is_given = &raw.is_prefilter_given},
      {"epsilon", CLI_PARSED, &job->epsilon, "E",
       "depth tolerance along the ray, also in spacings (2x), or auto [auto]", .parse = cli_parse_epsilon},
      {"passes", CLI_INT, &raw.passes, "N", "3: blend a surface's splats; 1: the nearest splat wins [3]", 1, 3},
      {"samples", CLI_INT, &job->view.samples, "N", "N x N samples a pixel, averaged: soft silhouettes [2]", 1,
       CONIC_MAX_SAMPLES, .is_given = &raw.is_samples_given},
      {"cull", CLI_CHOICE, &o->cull_back, "WHAT", "none, or back: what faces away is left out [none]",
       .choices = cull_words},
      {"near", CLI_PARSED, &job->near_z, "Z", "nothing nearer is drawn [1e-4 of the scene's diagonal]",
       .parse = cli_parse_near},
      {"shade", CLI_CHOICE, &shading, "HOW", "none (albedo), lambert or phong [phong]", .choices = words.shadings},
      {"light", CLI_PARSED, job, "LIGHT",
       "X,Y,Z, towards a light that stands in the scene; camera:X,Y,Z, one that moves with the camera (right, up, "
       "towards you); head, at your eye; each with :R,G,B behind it or without; studio; none. Up to 8 [studio]",
       .parse = cli_parse_light, .may_repeat = 1},
      {"sky", CLI_PARSED, job, "R,G,B[:R,G,B]",
       "light from all around; with two colours, of the sky on what faces up, and of the ground [the studio's]",
       .parse = cli_parse_sky},
      {"background", CLI_PARSED, job, "R,G,B[:R,G,B]",
       "linear colour behind, or two from top to bottom, or none: transparent [dark greys in PNG and JPEG, else none]",
       .parse = cli_parse_background},
      {"exposure", CLI_PARSED, job, "EV",
       "stops, -100 to 100: the picture is multiplied by 2^EV; auto: as bright as leaves 1 pixel in 20 near white [0]",
       .parse = cli_parse_exposure},
      {"aov", CLI_PARSED, &job->planes, "LIST",
       "planes: rgba,Z,N,albedo,weight,count,id or all; P, places in the world; cluster of hybrids; T, medianZ, "
       "inverseZ, last, doubt of "
       "Gaussian scenes [rgba,Z]",
       .parse = cli_parse_planes, .is_given = &job->is_aov_given},
      {"degree", CLI_INT, &job->patches.surface.degree, "D", "patch: of the polynomials, 1 to 4 [3]", 1,
       CONIC_SURFACE_MAX_DEGREE, .is_given = &raw.is_patch_given},
      {"h", CLI_PARSED, &raw.h, "H", "patch: what is smaller is smoothed away; also in spacings (2x) [local]",
       .parse = cli_parse_length, .is_given = &raw.is_patch_given, .dashes = "--"},
      {"k", CLI_INT, &job->opening.n_neighbours, "K",
       "neighbours that a raw point's size is estimated from, 6 to 64 [20]", 6, 64},
      CLI_COLUMNS(&job->opening.columns),
      {"tile", CLI_INT, &o->tile, "N", "tile edge in pixels, 8, 16, 32 or 64; changes no bit [64]", 8, 64},
      {"device", CLI_TEXT, &job->device.name, "NAME",
       "what draws: cpu, opencl (the first device) or opencl:P.D; changes no bit [cpu]"},
      {"allow-inexact", CLI_FLAG, &job->device.allow_inexact, NULL,
       "also an OpenCL device whose rounding makes the picture another one"},
      {"plain", CLI_FLAG, &job->is_plain, NULL,
       "every default as the library has it: a mesh's vertices, a sphere's framing, a headlight, one sample"},
      {"isa", CLI_CHOICE, &raw.isa, "NAME", "auto, scalar, sse2, avx2, avx512, neon; changes no bit [auto]",
       .choices = words.isas},
  };
  int answer = parse_all(session, own, n_own, table, (int)(sizeof table / sizeof table[0]), argc, argv, job);
  if (answer != CLI_DONE)
    return answer;
  choose_quality(&raw, job, &method);
  job->is_samples_given = raw.is_samples_given || raw.is_quality_given;
  job->is_patch = method == CONIC_N_METHODS;
  if (!job->is_patch)
    o->method = (conic_method)method;
  job->gaussians.profile = (conic_gaussian_profile)profile;
  job->gaussians.prefilter = raw.is_prefilter_given ? raw.prefilter : 0.0;
  job->gaussians.ignores_center = (uint32_t)ignores_center;
  if (profile < CONIC_N_GAUSSIAN_PROFILES &&
      (raw.is_profile_given || ((job->is_for_looking || job->may_composite) && !job->is_plain)))
    job->opening.gaussians = &job->gaussians;
  o->shading = (conic_shading)shading;
  o->kernel.cutoff = (float)raw.cutoff;
  o->prefilter = (float)raw.prefilter;
  o->passes = raw.passes;
  o->isa = session->isa = (conic_isa)raw.isa;
  job->view.budget = job->budget;
  job->opening.cutoff = o->kernel.cutoff;
  raw.as = raw.is_as_given ? (int)as_values[raw.as] : job->is_plain ? CONIC_AS_POINTS : CONIC_AS_AUTO;
  if (!job->is_plain && !raw.is_crease_given && !job->opening.is_smooth)
    job->opening.crease_deg = 30.0;
  job->opening.projects_degrees = !job->is_plain;
  job->opening.finds_dots = !job->is_plain;
  job->opening.h_in_spacings = raw.h.is_in_spacings;
  job->patches.surface.h = raw.h.value;
  job->patches.surface.isa = o->isa;
  if (raw.is_size_given) {
    view->width = raw.size[0];
    view->height = raw.size[1];
    memcpy(job->camera_size, raw.size, sizeof raw.size);
  } else if (job->projection == CONIC_CAMERA_EQUIRECTANGULAR)
    view->height = view->width / 2;
  raw.is_framing_given |= job->is_elevation_given || job->is_eye_given;
  return cli_scene_check(session, &raw, job);
}
