/* The options of a scene and its drawing. */

#include "cli/color_options.h"
#include "cli/scene/background_options.h"
#include "cli/scene/light_options.h"
#include "cli/scene/scene_options.h"

static const char *const cull_words[] = {"none", "back", NULL};
static const char *const as_words[] = {"auto", "points", "mesh", "hybrid", NULL};
static const conic_representation as_values[] = {CONIC_AS_AUTO, CONIC_AS_POINTS, CONIC_AS_MESH, CONIC_AS_HYBRID};
static const char *const quality_words[] = {"draft", "good", "final", "sketch", NULL};
static const char *const only_words[] = {"triangles", "surfels", NULL};

/* The words of choices that the library names, in the order of its numbers. */
typedef struct library_words {
  const char *methods[CONIC_N_METHODS + 2], *shadings[CONIC_N_SHADINGS + 4], *isas[CONIC_N_ISAS + 1];
  const char *profiles[CONIC_N_GAUSSIAN_PROFILES + 2];
  char profile_help[640];
} library_words;

/* Shades with eye-dome lighting on top, in the order of conic_shading; and its usual strength. */
static const char *const domed[] = {"edl", "lambert+edl", "phong+edl"};
static const double usual_stops = 4.0;

static library_words find_words(void) {
  library_words words = {.methods[CONIC_N_METHODS] = "patch", .profiles[CONIC_N_GAUSSIAN_PROFILES] = "surface"};
  for (int i = 0; i < CONIC_N_GAUSSIAN_PROFILES; i++)
    words.profiles[i] = conic_gaussian_profile_name((conic_gaussian_profile)i);
  char *to = words.profile_help, *end = to + sizeof words.profile_help;
  to += snprintf(to, (size_t)(end - to), "how a Gaussian scene is drawn: exact, as a version of another program (");
  for (int i = CONIC_PROFILE_EXACT + 1; i < CONIC_N_GAUSSIAN_PROFILES; i++)
    to += snprintf(to, (size_t)(end - to), "%s%s", words.profiles[i], i + 1 < CONIC_N_GAUSSIAN_PROFILES ? ", " : "");
  snprintf(to, (size_t)(end - to),
           "), or surface: as opaque splats; inria-2023 and others that take the picture's middle for the camera's "
           "principal point do so with any camera where :ignore-center stands behind them [exact]");
  for (int i = 0; i < CONIC_N_METHODS; i++)
    words.methods[i] = conic_method_name((conic_method)i);
  for (int i = 0; i < CONIC_N_SHADINGS; i++)
    words.shadings[i] = conic_shading_name((conic_shading)i);
  for (int i = 0; i < 3; i++)
    words.shadings[CONIC_N_SHADINGS + i] = domed[i];
  for (int i = 0; i < CONIC_N_ISAS; i++)
    words.isas[i] = conic_isa_name((conic_isa)i);
  return words;
}

void cli_scene_defaults(cli_render_job *job) {
  memset(job, 0, sizeof *job);
  job->shot.size = sizeof job->shot;
  conic_framing_init(&job->framing);
  conic_render_options_init(&job->shot.render);
  conic_source_options_init(&job->opening);
  conic_gaussian_options_init(&job->shot.gaussians);
  conic_patches_options_init(&job->patches);
  conic_layers_access_init(&job->access);
  conic_source_view_init(&job->shot.view);
  job->shot.view.is_alone = 1; /* unless a check finds more pictures */
  conic_coloring_options_init(&job->coloring);
  job->coloring.by = NULL;
  job->opening.patches = &job->patches;
  job->opening.access = &job->access;
  job->epsilon.value = job->near_z.value = -1.0;
  job->n_frames = job->repeat = 1;
  job->fps = 25.0;
  job->device.name = "cpu";
  job->shot.planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z;
  cli_cut_region_init(&job->top.box);
}

/* --- values with several parts --- */

static int parse_color_error(const char *text, void *value) {
  cli_render_job *job = value;
  double *steps = &job->shot.view.color_error;
  job->is_color_error_given = 1;
  return cli_parse_number(text, steps) && *steps >= 0.01 && *steps <= 1000.0;
}

/* Sides of a framed scene, which azimuth and elevation then say; else which of a file's cameras. */
static int parse_view(const char *text, void *value) {
  static const struct {
    const char *name;
    double azimuth_deg, elevation_deg;
  } sides[] = {{"front", 0, 0},
               {"right", 90, 0},
               {"back", 180, 0},
               {"left", 270, 0},
               {"top", 0, 90},
               {"bottom", 0, -90},
               {"iso", 45, 35.264389682754654}};
  cli_render_job *job = value;
  job->view_name = text;
  job->is_view_side = 0;
  for (size_t i = 0; i < sizeof sides / sizeof *sides; i++)
    if (strcmp(sides[i].name, text) == 0) {
      job->is_view_side = job->is_azimuth_given = job->is_elevation_given = 1;
      job->framing.azimuth_deg = sides[i].azimuth_deg;
      job->framing.elevation_deg = sides[i].elevation_deg;
    }
  return *text != '\0';
}

static int parse_stops(const char *text, void *stops) {
  return cli_parse_number(text, stops) && *(double *)stops > 0.0 && *(double *)stops <= 16.0;
}

static int parse_ignore_center(const char *text, void *value) {
  return *(int *)value = strcmp(text, "ignore-center") == 0;
}

/* Of patches: D, or D:H. */
static int parse_patch(const char *text, void *value) {
  cli_scene_words *words = value;
  words->is_patch_given = 1;
  words->degree = text[0] - '0';
  return words->degree >= 1 && words->degree <= CONIC_SURFACE_MAX_DEGREE &&
         (!text[1] || (text[1] == ':' && cli_parse_length(text + 2, &words->h)));
}

static int parse_crease(const char *text, void *value) {
  cli_scene_words *words = value;
  if (strcmp(text, "all") == 0)
    return words->is_smooth = 1;
  words->is_crease_given = 1;
  return cli_parse_number(text, &words->crease_deg) && words->crease_deg >= 0.0 && words->crease_deg <= 90.0;
}

/* What was named says where the shot's own inputs are. */
static int take_shot_inputs(const cli_session *session, cli_render_job *job) {
  const size_t n_bytes = (size_t)job->making.n_scene * sizeof *job->inputs;
  free(job->inputs);
  job->inputs = malloc(n_bytes);
  if (!job->inputs)
    return cli_error(CLI_RESOURCE, "%s: out of memory", session->command);
  memcpy(job->inputs, job->making.scene, n_bytes);
  job->n_inputs = job->making.n_scene;
  return CLI_DONE;
}

static int is_left_out(const cli_render_job *job, const char *name) {
  for (const char *const *left_out = job->left_out; left_out && *left_out; left_out++)
    if (strcmp(*left_out, name) == 0)
      return 1;
  return 0;
}

/* The command's own options, then those of the scene. */
static int parse_all(cli_session *session, const cli_option *own, int n_own, const cli_option *scene, int n_scene,
                     int argc, char **argv, cli_render_job *job) {
  cli_option *table = calloc((size_t)n_own + (size_t)n_scene, sizeof *table);
  job->inputs = calloc((size_t)argc + 1, sizeof *job->inputs);
  const char *values[n_own + n_scene];
  int answer = CLI_RESOURCE;
  if (table && job->inputs) {
    if (n_own > 0)
      memcpy(table, own, (size_t)n_own * sizeof *table);
    for (int i = 0; i < n_own; i++) /* what is a command's own is what it is for */
      table[i].is_usual |= !job->is_for_looking || job->left_out;
    int n = n_own;
    for (int i = 0; i < n_scene; i++)
      if (!is_left_out(job, scene[i].name))
        table[n++] = scene[i];
    answer = cli_parse_noting(session, table, n, argc, argv, job->inputs, &job->n_inputs, values);
    if (answer == CLI_DONE)
      cli_effects_note(&job->effects, table, n, values);
    if (answer == CLI_DONE && cli_shot_is_again(session, job))
      answer = CLI_AGAIN;
    if (answer == CLI_DONE && job->making.scene)
      answer = take_shot_inputs(session, job);
  } else
    cli_error(CLI_RESOURCE, "%s: out of memory", session->command);
  free(table);
  return answer;
}

/* Whether what is drawn is to be looked at: not to be measured, taken apart or compared with what a profile's own
 * program draws, nor too large to have several samples. */
static int is_picture(const cli_scene_words *raw, const cli_render_job *job) {
  int size = raw->size[0] > raw->size[1] ? raw->size[0] : raw->size[1];
  return job->is_for_looking && job->repeat == 1 && !job->deep_path && size <= 65535 / 2 &&
         !(raw->is_profile_given && raw->profile < CONIC_N_GAUSSIAN_PROFILES);
}

/* What the quality stands for, where it is not said otherwise. */
static void choose_quality(cli_scene_words *raw, cli_render_job *job) {
  static const int samples[] = {1, 2, 4, 1};
  int is_wanted = raw->is_quality_given || !job->is_plain;
  if (raw->quality == CLI_QUALITY_SKETCH)
    job->opening.most_raw = 30000;
  if (is_wanted && !raw->is_method_given)
    raw->method = samples[raw->quality] == 1 ? CONIC_METHOD_CONIC : CONIC_METHOD_AUTO;
  if (is_wanted && !raw->is_samples_given && !job->accumulating.n_samples && !job->accumulating.is_sample_given &&
      (raw->is_quality_given || is_picture(raw, job)))
    job->shot.view.samples = samples[raw->quality];
}

int cli_scene_parse(cli_session *session, const cli_option *own, int n_own, int argc, char **argv,
                    cli_render_job *job) {
  cli_scene_words raw = {.quality = CLI_QUALITY_GOOD,
                         .passes = 3,
                         .method = (int)job->shot.render.method,
                         .usual_as = -1,
                         .usual_crease_deg = -1.0,
                         .degree = job->patches.surface.degree,
                         .cutoff = (double)job->shot.render.kernel.cutoff,
                         .prefilter = (double)job->shot.render.prefilter};
  conic_render_options *o = &job->shot.render;
  conic_framing *view = &job->framing;
  int shading = -1;
  double stops = 0.0;
  if (job->making.words)
    raw = *job->making.words;
  const library_words words = find_words();
  const cli_option table[] = {
      {"size", CLI_SIZE, raw.size, "WxH",
       "the picture's width and height in pixels; cameras of a file are scaled to it [1024x1024, or the file's]", 1,
       65535, .is_given = &raw.is_size_given, .group = "camera",
       .intro = "From where the scene is looked at: framed by these, or by a file of cameras.", .is_usual = 1,
       .acts = {.apart = CLI_FACT(MAP)}},
      {"camera", CLI_TEXT, &job->camera_path, "FILE",
       "cameras, in place of --azimuth and those below it: a COLMAP folder, transforms.json, cameras.json, .npz of "
       "viewmats and Ks, glTF, or conic's JSON; top: a map, seen from straight above, with the unit of the points that "
       "a pixel is wide behind it, top:0.1, or else their typical distance, and the EPSG code that a .tif notes, "
       "top:0.1:25832, or else the file's",
       .is_usual = 1},
      {"view", CLI_PARSED, job, "VIEW",
       "which of the cameras of --camera: a number from 0, the name of an image with or without its folder and ending, "
       "or all [the only one]; without --camera a side: front, back, left, right, top, bottom, or iso, from a corner",
       .parse = parse_view, .is_usual = 1, .acts = {.needs = CLI_FACT(CAMERAS), .apart = CLI_FACT(MAP)}},
      {"azimuth", CLI_NUMBER, &view->azimuth_deg, "DEG",
       "the camera's place around the scene: 0 in front, 90 to the right of that [30, or before what faces elsewhere]",
       -1e6, 1e6, .is_given = &job->is_azimuth_given, .is_usual = 1, .acts = {.needs = CLI_FACT(FRAMED)}},
      {"elevation", CLI_NUMBER, &view->elevation_deg, "DEG",
       "the camera's height, from -90 (below) over 0 to 90 (above) [15; 35 for what lies flat, and surveys]", -90, 90,
       .is_given = &job->is_elevation_given, .is_usual = 1, .acts = {.needs = CLI_FACT(FRAMED)}},
      {"fov", CLI_NUMBER, &view->fov_deg, "DEG", "field of view across the shorter side [40]", 0.001, 179.9,
       .acts = {.on = CLI_FACT(FRAMED), .needs = CLI_FACT(FIELD), .is_warned = 1}},
      {"zoom", CLI_NUMBER, &view->zoom, "Z", "multiplies the focal length: 2 shows the middle, twice as large [1]",
       1e-6, 1e6, .is_usual = 1,
       .acts = {.needs = CLI_FACT(FRAMED), .apart = CLI_FACT(CUBE), .why = "its sides show all that is around"}},
      {"projection", CLI_CHOICE, &job->projection, "HOW",
       "perspective, orthographic (parallel), fisheye, panorama (all around) or cube (six sides, one below the other) "
       "[perspective]",
       .choices = cli_projection_words, .acts = {.needs = CLI_FACT(FRAMED)}},
      {"eye", CLI_PARSED, job->eye, "X,Y,Z",
       "the place from which the camera looks [where it sees all of the scene; a panorama's and a cube's: the scene's "
       "middle]",
       .parse = cli_parse_eye, .is_given = &job->is_eye_given, .acts = {.needs = CLI_FACT(FRAMED)}},
      {"up", CLI_PARSED, view->up, "DIR", "what points up: x, y, z, -x … or X,Y,Z [the file's, or by its shape]",
       .parse = cli_parse_up, .is_given = &job->is_up_given, .is_usual = 1, .acts = {.needs = CLI_FACT(UPRIGHT)}},
      {"as", CLI_CHOICE, &raw.as, "WHAT",
       "what a mesh is drawn as: auto (triangles), points (splats of the vertices), mesh or hybrid (both) [auto]",
       .choices = as_words, .is_given = &raw.is_as_given, .group = "meshes",
       .intro = "What becomes of files that have faces.", .is_usual = 1},
      {"texture", CLI_TEXT, &job->opening.texture_path, "FILE",
       "the picture on a mesh's surface [as its materials say]",
       .acts = {.on = CLI_FACT(FACES), .needs = CLI_FACT(TRIANGLES)}},
      CLI_TEXTURE_BOUND(session),
      CLI_OUTSIDE(session),
      {"crease", CLI_PARSED, &raw, "DEG",
       "triangles without normals look smooth over edges up to this angle, 0 to 90 degrees; 0: every face is flat; "
       "all: any triangles look smooth everywhere, by the mean normal of the faces about each vertex [30]",
       .parse = parse_crease, .acts = {.on = CLI_FACT(EDGES), .needs = CLI_FACT(SHAPED)}},
      CLI_COLOR_OPTIONS(&job->coloring),
      CLI_WHERE(&job->opening.where),
      {"place", CLI_PARSED, job, "FILE=MATRIX",
       "where an input stands: a shift of 3 numbers, or 12 or 16 of a matrix, row by row, that turns, scales evenly "
       "and "
       "shifts [as the file has it]",
       .parse = cli_parse_place, .may_repeat = 1,
       .acts = {.on = CLI_FACT(COMPOSITED) | CLI_FACT(SPLATS) | CLI_FACT(TRIANGLES)}},
      {"error", CLI_NUMBER, &job->shot.view.error_px, "PX[:STEPS]",
       "draw as coarsely as keeps the error on the screen below so many pixels; 0: draw all; of meshes and a .chy, "
       "also "
       "by how many steps colours may differ: black and white do by 100, and 2 are just visible [0:2]",
       0, 65536, .group = "levels of detail",
       .intro = "Fewer primitives where that is enough: from hierarchies, or built of points and meshes.",
       .is_usual = 1, .acts = {.on = CLI_FACT(CHOOSES)}, .parse_tail = parse_color_error, .tail = job},
      {"budget", CLI_COUNT, &job->budget, "N",
       "draw N splats and triangles at most, those whose error is the least [all]", 1, 4294967294.0, .is_usual = 1,
       .acts = {.on = CLI_FACT(CHOOSES), .apart = CLI_FACT(MAP)}},
      {"cache", CLI_TEXT, &job->opening.cache, "DIR",
       "of --error and --budget, keep what is built of points and meshes in this folder, up to 4 GiB, and take it from "
       "there the next time",
       .acts = {.on = CLI_SURFACES,
                .needs = CLI_CHOSEN,
                .apart = CLI_FACT(NODES) | CLI_FACT(LEVELS) | CLI_FACT(HYBRID),
                .why = "it is read as it is"}},
      {"only", CLI_CHOICE, &job->shot.view.only_kind, "KIND",
       "of a .chy, draw every patch as triangles, or every one as surfels (splats) [as built]", .choices = only_words,
       .acts = {.on = CLI_FACT(HYBRID)}},
      {"method", CLI_CHOICE, &raw.method, "NAME",
       "how a splat becomes pixels, from rough to exact: point, disc, affine, conic, ray; auto: conic where that is "
       "exact enough, else ray or, of large splats, laplace; patch: as part of a smooth surface through the points, "
       "with patch:D by polynomials of "
       "degree D, 1 to 4 [3], and with patch:D:H smoother than the length H, as 2x [auto]",
       .choices = words.methods, .is_given = &raw.is_method_given, .group = "how splats are drawn",
       .intro = "Kernels, filters and samples, and the profiles of Gaussian scenes.", .parse_tail = parse_patch,
       .tail = &raw, .acts = {.on = CLI_FACT(SPLATS)}},
      {"profile", CLI_CHOICE, &raw.profile, "NAME", words.profile_help, .choices = words.profiles,
       .is_given = &raw.is_profile_given, .is_usual = 1, .parse_tail = parse_ignore_center, .tail = &raw.ignores_center,
       .acts = {.on = CLI_FACT(GAUSSIANS)}},
      {"quality", CLI_CHOICE, &raw.quality, "HOW",
       "draft (--method conic, 1 sample), good (auto, 2 x 2 samples) or final (auto, 4 x 4); sketch: draft, of at most "
       "30,000 of the raw points, and of levels with --error 2; --method and --samples go first [good]",
       .choices = quality_words, .is_given = &raw.is_quality_given, .is_usual = 1,
       .acts = {.needs = CLI_FACT(UNSETTLED), .is_warned = 1}},
      {"kernel", CLI_PARSED, &o->kernel, "NAME",
       "how a splat fades from its centre to its edge: gauss, hat, box (not at all) or confetti:A,B,N [gauss]",
       .parse = cli_parse_kernel, .acts = {.on = CLI_FACT(SPLATS), .needs = CLI_FACT(KERNEL)}},
      {"cutoff", CLI_NUMBER, &raw.cutoff, "F", "at how many standard deviations from its centre a splat ends [1.5]",
       0.25, 5, .acts = {.on = CLI_FACT(SPLATS), .needs = CLI_FACT(KERNEL)}},
      {"prefilter", CLI_NUMBER, &raw.prefilter, "V",
       "the variance, in square pixels, of the blur that keeps small splats from flickering; 0: none [1; 0 of Gaussian "
       "scenes]",
       0, 10000, .is_given = &raw.is_prefilter_given,
       .acts = {.on = CLI_FACT(SPLATS) | CLI_FACT(EXACT), .needs = CLI_FACT(FILTERED)}},
      {"epsilon", CLI_PARSED, &job->epsilon, "E",
       "splats so near to each other along the ray are blended as one surface: a length, also in spacings (2x), or "
       "auto [auto]",
       .parse = cli_parse_epsilon, .acts = {.on = CLI_FACT(SPLATS), .needs = CLI_FACT(BLENDED)}},
      {"passes", CLI_INT, &raw.passes, "N", "3: blend the splats of a surface; 1: the nearest splat wins [3]", 1, 3,
       .acts = {.on = CLI_FACT(SPLATS)}},
      {"samples", CLI_INT, &job->shot.view.samples, "N",
       "average N x N samples in each pixel, which makes silhouettes soft [2; 1 with --profile, --repeat or --deep]", 1,
       CONIC_MAX_SAMPLES, .is_given = &raw.is_samples_given},
      {"cull", CLI_CHOICE, &o->cull_back, "WHAT", "back: leave out what faces away; or none [none]",
       .choices = cull_words, .acts = {.on = CLI_SURFACES}},
      {"near", CLI_PARSED, &job->near_z, "Z", "nothing nearer to the camera is drawn [1e-4 of the scene's diagonal]",
       .parse = cli_parse_near, .acts = {.on = CLI_SURFACES, .apart = CLI_FACT(MAP)}},
      {"shade", CLI_CHOICE, &shading, "HOW",
       "none (colours as they are), lambert (matt), phong (with a highlight), or edl (eye-dome lighting: darker where "
       "what is around is nearer, by up to so many stops as stand behind it, edl:4); lambert+edl and phong+edl are "
       "both "
       "[phong; none for maps of what has colours]",
       .choices = words.shadings, .is_given = &job->is_shade_given, .group = "light and background",
       .intro = "What shines on surfaces, and what is behind them.", .is_usual = 1, .parse_tail = parse_stops,
       .tail = &stops, .acts = {.on = CLI_SURFACES}},
      {"light", CLI_PARSED, job, "LIGHT",
       "a light: X,Y,Z, the direction towards it, in the scene; camera:X,Y,Z, likewise, but it moves with the camera "
       "(right, up, towards you); head, at your eye; each with its colour :R,G,B behind it or without, and a direction "
       "then "
       "with the radius of its disc, :2deg, for soft shadows with --accumulate; lamp:X,Y,Z, a place, with :R,G,B of "
       "which a surface at distance 1 is lit, then :RADIUS of a ball, then :X,Y,Z where to it shines, for a disc or, "
       "with :WxH, a rectangle, and :X,Y,Z where to its H goes [up in the scene]; studio, several that suit most "
       "scenes; none. Up to 8 of a direction, 8 lamps [studio]",
       .parse = cli_parse_light, .may_repeat = 1, .is_usual = 1, .acts = {.on = CLI_SURFACES, .needs = CLI_FACT(LIT)}},
      {"sky", CLI_PARSED, job, "R,G,B[:R,G,B]",
       "light from all around; of two colours, the first falls on what faces up, the second on what faces down [the "
       "studio's]; or a picture of all directions, such as sky.exr or sky.pfm, which needs --ao",
       .parse = cli_parse_sky, .acts = {.on = CLI_SURFACES, .needs = CLI_FACT(LIT)}},
      {"reflect", CLI_NUMBER, &job->shot.light.reflectance, "R",
       "so much of each colour, 0 to 1, is the picture of --sky as a smooth surface mirrors it; nothing hides it [0]",
       0, 1, .acts = {.on = CLI_SURFACES, .needs = CLI_FACT(LIT)}},
      {"background", CLI_PARSED, job, "R,G,B[:R,G,B]",
       "linear colour behind the scene, a name as white, or #rrggbb; two go from top to bottom; none: transparent "
       "[dark "
       "greys in PNG and JPEG, else none]",
       .parse = cli_parse_background, .is_usual = 1},
      {"exposure", CLI_PARSED, job, "EV",
       "stops, -100 to 100: each doubles the brightness; auto: as bright as leaves 1 pixel in 20 near white [0]",
       .parse = cli_parse_exposure, .acts = {.on = CLI_SURFACES}},
      {"aov", CLI_PARSED, job, "LIST",
       "planes: rgba, Z (depth), N (normal), albedo, weight, count, id, joined by commas, or all; P (place in the "
       "world); cluster of hybrids; T, medianZ, inverseZ, last, doubt of Gaussian scenes; ao and shadow, what light "
       "arrives; bound, how far a pixel by --error or --budget is off, for which all is drawn, too; motion, into .exr: "
       "pixels to the next frame, "
       "and to the one before; cryptomatte, into .exr: mattes by "
       "which each input, or each patch of a hybrid, is picked by its name "
       "in Nuke or Blender [rgba,Z]",
       .parse = cli_parse_planes, .group = "planes", .intro = "What is known of each pixel beside its colour.",
       .is_usual = 1},
      {"k", CLI_INT, &job->opening.n_neighbours, "K",
       "how many neighbours a raw point's size and normal are estimated from, 6 to 64 [20]", 6, 64,
       .group = "raw points", .intro = "What files of points leave out.",
       .acts = {.on = CLI_FACT(RAW), .is_warned = 1}},
      CLI_COLUMNS(&job->opening.columns),
      CLI_COLORS(&job->opening.colors_are),
      {"tile", CLI_INT, &o->tile, "N",
       "the edge, in pixels, of the squares that a picture is drawn in: 8, 16, 32 or 64; changes no bit of it [64]", 8,
       64, .group = "what draws", .intro = "On what, and how, it is computed; the picture stays the same.",
       .acts.is_work = 1},
      {"device", CLI_PARSED, &job->device, "NAME",
       "what draws: cpu, opencl (the first device) or opencl:P.D (see conic devices), which :gather makes go about it "
       "as on a GPU and :lanes as on a CPU; changes no bit of the picture; with :inexact behind it also one whose "
       "rounding makes the picture another one [cpu]",
       .parse = cli_parse_device, .acts.is_work = 1},
      {"plain", CLI_FLAG, &job->is_plain, NULL,
       "draw as the library does by default: of a mesh the vertices, framed by a sphere, with a headlight and one "
       "sample"},
      {"isa", CLI_CHOICE, &raw.isa, "NAME",
       "the processor's instructions: auto, scalar, sse2, avx2, avx512, neon; changes no bit of the picture [auto]",
       .choices = words.isas, .acts.is_work = 1},
      /* Old spellings. */
      {"smooth", CLI_FLAG, &raw.is_smooth, NULL, "like --crease all", .now = "--crease all"},
      {"color-error", CLI_NUMBER, &job->shot.view.color_error, "STEPS", "of a .chy", 0.01, 1000,
       .is_given = &job->is_color_error_given, .now = "--error PX:STEPS"},
      {"ignore-center", CLI_FLAG, &raw.ignores_center, NULL, "of a profile", .now = "--profile NAME:ignore-center"},
      {"degree", CLI_INT, &raw.degree, "D", "1 to 4", 1, CONIC_SURFACE_MAX_DEGREE, .is_given = &raw.is_patch_given,
       .now = "--method patch:D"},
      {"h", CLI_PARSED, &raw.h, "H", "a length", .parse = cli_parse_length, .is_given = &raw.is_patch_given,
       .dashes = "--", .now = "--method patch:D:H"},
      {"allow-inexact", CLI_FLAG, &job->device.allow_inexact, NULL, "of a device", .now = "--device NAME:inexact"},
  };
  int answer = parse_all(session, own, n_own, table, (int)(sizeof table / sizeof table[0]), argc, argv, job);
  if (answer != CLI_DONE)
    return answer;
  if (job->path_file && (job->camera_path || job->view_name || job->is_turntable))
    return cli_usage("%s: --path brings cameras of its own: not with --camera, --view or --turntable",
                     session->command);
  if (job->path_file) {
    job->camera_path = job->path_file;
    job->view_name = "all";
  }
  job->is_view_side &= !job->camera_path;
  if (job->is_view_side)
    job->view_name = NULL;
  choose_quality(&raw, job);
  if (cli_scene_is_top(job) && !raw.is_samples_given && !raw.is_quality_given)
    job->shot.view.samples = 1; /* that is drawn in bounded memory, and pixels are filtered anyway */
  job->is_samples_given = raw.is_samples_given || raw.is_quality_given;
  job->is_patch = raw.method == CONIC_N_METHODS;
  if (!job->is_patch)
    o->method = (conic_method)raw.method;
  if (raw.profile < CONIC_N_GAUSSIAN_PROFILES) /* else "surface", which is none */
    job->shot.gaussians.profile = (conic_gaussian_profile)raw.profile;
  job->shot.gaussians.prefilter = raw.is_prefilter_given ? raw.prefilter : 0.0;
  job->shot.gaussians.ignores_center = (uint32_t)raw.ignores_center;
  if (raw.profile < CONIC_N_GAUSSIAN_PROFILES && (raw.is_profile_given || !job->is_plain))
    job->opening.gaussians = &job->shot.gaussians;
  if (shading >= 0) {
    o->shading = (conic_shading)(shading % CONIC_N_SHADINGS);
    job->shot.light.dome_stops = shading < CONIC_N_SHADINGS ? 0.0 : stops > 0.0 ? stops : usual_stops;
  }
  if (stops > 0.0 && shading < CONIC_N_SHADINGS)
    return cli_usage("%s: --shade edl:STOPS says how strong that is; other shades have no strength", session->command);
  o->kernel.cutoff = (float)raw.cutoff;
  o->prefilter = (float)raw.prefilter;
  job->is_prefilter_given = raw.is_prefilter_given;
  o->passes = raw.passes;
  o->isa = session->isa = (conic_isa)raw.isa;
  job->shot.view.budget = job->budget;
  job->opening.cutoff = o->kernel.cutoff;
  if (raw.usual_as < 0)
    raw.usual_as = job->is_plain ? CONIC_AS_POINTS : CONIC_AS_AUTO;
  if (raw.usual_crease_deg < 0.0)
    raw.usual_crease_deg = job->is_plain ? 0.0 : 30.0;
  raw.as = raw.is_as_given ? (int)as_values[raw.as] : raw.usual_as;
  job->opening.is_smooth = raw.is_smooth;
  job->opening.crease_deg = raw.is_crease_given ? raw.crease_deg : raw.is_smooth ? 0.0 : raw.usual_crease_deg;
  job->opening.projects_degrees = !job->is_plain && !cli_scene_is_top(job);
  job->opening.finds_dots = !job->is_plain;
  job->opening.h_in_spacings = raw.h.is_in_spacings;
  job->patches.surface.h = raw.h.value;
  job->patches.surface.degree = raw.degree;
  job->patches.surface.isa = o->isa;
  if (raw.is_size_given) {
    view->width = raw.size[0];
    view->height = raw.size[1];
    memcpy(job->camera_size, raw.size, sizeof raw.size);
  } else if (job->projection == CONIC_CAMERA_EQUIRECTANGULAR)
    view->height = view->width / 2;
  else if (job->projection == CONIC_CAMERA_CUBE)
    view->height = 6 * (view->width /= 2);
  return cli_scene_check(session, &raw, job);
}
