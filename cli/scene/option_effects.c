/* Whether options change anything, and go together. */
#include "cli/scene/option_effects.h"

#include <string.h>
#include <strings.h>

#include "cli/color_options.h"
#include "cli/host_keeps.h"
#include "cli/scene/scene_options.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "source/source_kind.h"

typedef unsigned long long facts;

/* What each fact is called in the help, and in messages behind "it acts on" and "it needs". Facts that are only looked
 * at for what cannot be together have no words. */
static const struct {
  const char *name, *words;
} fact_words[CLI_N_FACTS] = {
    [CLI_FACT_COMPOSITED] = {"composited", "Gaussian scenes that are composited"},
    [CLI_FACT_GAUSSIANS] = {"gaussians", "Gaussian scenes (.splat, .spz, .sog, or a .ply with the columns scale_0, "
                                         "rot_0, opacity and f_dc_0)"},
    [CLI_FACT_SPLATS] = {"splats", "splats"},
    [CLI_FACT_TRIANGLES] = {"triangles", "triangles"},
    [CLI_FACT_FACES] = {"faces", "files that have faces"},
    [CLI_FACT_EDGES] = {"edges", "triangles whose file has no normals"},
    [CLI_FACT_RAW] = {"raw", "points whose sizes are not in their file"},
    [CLI_FACT_TEXT] = {"text", "files of text"},
    [CLI_FACT_ALPHA] = {"alpha", "splats and materials that let light through"},
    [CLI_FACT_VALUED] = {"values", "colours that are made of values, as by --color-by"},
    [CLI_FACT_HYBRID] = {"hybrids", "hybrids (a .chy, or a mesh with --as hybrid)"},
    [CLI_FACT_LEVELS] = {"levels", "a single cloud in levels (.lpc, which conic layer makes, COPC, EPT, Potree 2)"},
    [CLI_FACT_NODES] = {"nodes", "a single .cot (conic octree makes one) with its own colours"},
    [CLI_FACT_CHOOSES] = {"hierarchies", "a single .cot, .lpc or .chy (conic octree, conic layer and conic hybrid make "
                                         "them), and meshes with --as hybrid"},
    [CLI_FACT_URL] = {"urls", "URLs"},
    [CLI_FACT_ACCUMULATED] = {"accumulated", "--accumulate N"},
    [CLI_FACT_SAMPLE] = {"sample", "--sample I"},
    [CLI_FACT_LENS] = {"lens", "a lens, by --aperture D"},
    [CLI_FACT_WAY] = {"way", "a way of the camera, --turntable or --camera with several, or --motion"},
    [CLI_FACT_FRAMED] = {"framed", "a camera that frames the scene, and --camera does it itself"},
    [CLI_FACT_FIELD] = {"field", "a camera that frames the scene and has a field of view, and --camera does it itself"},
    [CLI_FACT_CAMERAS] = {"cameras", "a file of cameras, by --camera FILE"},
    [CLI_FACT_UPRIGHT] = {"upright", "lights, heights or a framed camera that stand upright"},
    [CLI_FACT_TURNTABLE] = {"turntable", "--turntable N"},
    [CLI_FACT_EVERY_VIEW] = {"views", "--view all"},
    [CLI_FACT_MAP] = {"map", "--camera top"},
    [CLI_FACT_STEREO] = {"stereo", "two eyes, by --stereo E"},
    [CLI_FACT_ERROR] = {"error", "--error"},
    [CLI_FACT_BUDGET] = {"budget", "--budget"},
    [CLI_FACT_PATCH] = {"patch", "--method patch"},
    [CLI_FACT_KERNEL] = {"kernel", "a --method by which splats fade"},
    [CLI_FACT_FILTERED] = {"filtered", "a --method by which splats are filtered"},
    [CLI_FACT_BLENDED] = {"blended", "--passes 3"},
    [CLI_FACT_SHAPED] = {"shaped", "another --shade than none, or --aov N"},
    [CLI_FACT_LIT] = {"lit", "another --shade than none"},
    [CLI_FACT_UNSETTLED] = {"unsettled", "that --method and --samples do not say it all"},
    [CLI_FACT_OWN_CENTER] = {"center", "--profile inria-2023 or 2dgs-2024"},
    [CLI_FACT_EXR] = {"exr", "an .exr"},
    [CLI_FACT_CODES] = {"codes", "a file of 8 or 16 bits, such as .png"},
    [CLI_FACT_NAMELESS] = {"nameless", "standard output or a name without an ending"},
    [CLI_FACT_OPENCL] = {"opencl", "--device opencl"},
    [CLI_FACT_EXACT] = {"exact", "Gaussian scenes by --profile exact (the others have a filter of their own)"},
};

const char *cli_fact_name(int fact) {
  return fact_words[fact].name;
}

/* --- what cannot be together --- */

#define F(name) CLI_FACT(name)
_Static_assert(CLI_N_FACTS <= 64, "facts are bits of an unsigned long long");
#define SOURCE_FACTS (F(ACCUMULATED) - 1)

static const struct {
  facts all, any, unless; /* it is refused where all of the first hold, any of the second, and none of the third */
  const char *why;
} pairs[] = {
    {CLI_CHOSEN, 0, 0, "--error and --budget are two ways to choose; give one of both"},
    {F(PATCH), F(AS_MESH) | F(HYBRID), 0, "--method patch draws points; not with --as mesh, nor hybrids"},
    {F(PATCH), CLI_CHOSEN, 0, "--method patch draws samples of its own: not with --error or --budget"},
    {F(PATCH) | F(DEEP), 0, 0, "--method patch draws samples of its own: not with --deep"},
    {F(PROJECTED) | F(COMPOSITED), 0, F(EXACT) | F(CUBE),
     "--projection is of pictures by conic render, and of Gaussian scenes by --profile exact"},
    {F(PROJECTED) | F(ASKING), 0, F(EXACT),
     "--projection is of pictures by conic render, and of Gaussian scenes by --profile exact"},
    {F(CURVED) | F(COMPOSITED) | F(PREFILTERED), 0, 0,
     "--prefilter is of perspective and orthographic pictures of Gaussian scenes"},
    {F(COMPOSITED), F(DEEP) | F(MATTES) | F(EXPOSED), 0,
     "--deep, mattes and --exposure auto are of splats; give --profile surface, too"},
    {F(COMPOSITED) | F(TAKES_APART), 0, 0, "it takes splats apart; give --profile surface, or none"},
    {F(LEVELS) | F(UNSTREAMED), CLI_CHOSEN, 0,
     "of an .lpc it takes all; --error and --budget choose of one in conic render"},
    {F(COLORED_WHOLE), CLI_CHOSEN, 0,
     "--color-by looks at all that there is: not with --error or --budget; conic octree and conic layer take it, too, "
     "and keep the colours"},
    {F(EVERY_VIEW) | F(ASKING), 0, 0, "it takes one view; conic render draws all"},
    {F(EVERY_VIEW), F(TURNTABLE) | F(PROGRESSIVE), 0,
     "--view all draws every view once: not with --turntable or --progressive"},
    {F(BACKDROP) | F(ASKING), 0, 0, "--background takes two colours in conic render; here it takes one"},
    {F(LAMPS) | F(ASKING), 0, 0, "lamps, and lights with a radius, are of conic render"},
    {F(EXPOSED) | F(ASKING), 0, 0, "--exposure auto is of conic render, which says in --json what it chose"},
    {F(MAP) | F(ASKING), 0, 0, "--camera top is of conic render"},
    {F(MAP) | F(COMPOSITED), 0, 0, "--camera top draws Gaussian scenes as surfaces; give --profile surface, too"},
    {F(MAP) | F(HYBRID), 0, 0, "--camera top draws points, splats and triangles, not hybrids"},
    {F(MAP) | F(ERROR), 0, F(LEVELS), "--error of --camera top is of .lpc, COPC, EPT and Potree"},
    {F(MAP), F(EXPOSED) | F(BACKDROP) | F(PATCH) | F(OPENCL), 0,
     "--camera top is without --exposure auto, a background of two colours, --method patch and --device opencl"},
    {F(MAP) | F(MASKED), 0, 0, "--ao, --shadow and lamps are not of --camera top"},
    {F(MASKED) | F(COMPOSITED), 0, 0, "--ao, --shadow and lamps are of surfaces; give --profile surface, too"},
    {F(DEEP) | F(SAMPLED), 0, 0, "--deep lists the splats of pixels, not of --samples"},
    {F(DEEP), CLI_CHOSEN, F(HYBRID),
     "--deep lists the splats of the input, not those that --error and --budget choose"},
    {F(DEEP) | F(LEVELS), 0, 0, "--deep lists the splats of inputs that are read whole, not of an .lpc"},
    {F(MATTES) | F(LEVELS), 0, 0, "cryptomatte names what is read whole, not an .lpc"},
    {F(MATTES), 0, F(EXR), "cryptomatte goes into an .exr; give -o OUT.exr"},
    {F(PROGRESSIVE), F(TURNTABLE) | F(REPEATED), 0,
     "--progressive writes the pictures of one frame, not of a turntable or of --repeat"},
    {F(TRANSPARENT) | F(COMPOSITED), 0, 0,
     "a Gaussian scene lets light through as it is; --transparency is of its splats, by --profile surface"},
    {F(TRANSPARENT) | F(HYBRID), 0, 0,
     "a hybrid keeps no opacities; --transparency is of what it was made of, as splats or as a mesh"},
    {F(TRANSPARENT), F(DEEP) | F(MATTES) | F(MAP), 0, "not --transparency with --deep, mattes or --camera top"},
    {F(TRANSPARENT), 0, F(BLENDED), "--transparency is of surfaces that blend: not with --passes 1"},
    {F(ACCUMULATED) | F(SAMPLE), 0, 0, "--sample asks for one of the samples, --accumulate for all; give one of both"},
    {F(SAMPLED), CLI_SAMPLES, 0, "--accumulate places its samples itself, one a pixel each: not with --samples"},
    {F(ACCUMULATED), F(REPEATED) | F(PROGRESSIVE) | F(DEADLINE) | F(DEEP) | F(MATTES), 0,
     "not --accumulate with --repeat, --progressive, --deadline, --deep or mattes"},
    {F(ACCUMULATED) | F(MAP), 0, 0, "--camera top filters its pixels itself: not with --accumulate"},
    {F(STEREO), F(STREAM) | F(MAP) | F(PROGRESSIVE), 0,
     "--stereo writes two files: not to standard output, nor with --camera top, --progressive or --resume"},
};

/* --- facts --- */

static facts when(int holds, facts fact) {
  return holds ? fact : 0;
}

/* However it is drawn. */
static int is_gaussian(const cli_session *session, const cli_render_job *job) {
  conic_source_options opening = job->opening;
  opening.gaussians = &job->shot.gaussians;
  return (cli_kept_abilities(session, job->inputs, (size_t)job->n_inputs, &opening) & CONIC_SOURCE_COMPOSITES) != 0;
}

/* Before it is open: what is certain, and what else there may be. */
static void guess_source(const cli_session *session, cli_render_job *job) {
  cli_effects_job *own = &job->effects;
  const unsigned can = job->abilities;
  const facts read = CLI_SURFACES | F(FACES) | F(EDGES) | F(RAW) | F(TEXT) | F(ALPHA) | F(VALUED);
  int is_hybrid = (can & CONIC_SOURCE_CLUSTERS) != 0, is_mesh = job->opening.as == CONIC_AS_HYBRID;
  own->certain = when(can & CONIC_SOURCE_COMPOSITES, F(COMPOSITED)) | when(is_hybrid, F(HYBRID)) |
                 when(can & CONIC_SOURCE_STREAMS, F(LEVELS)) | when(can == CONIC_SOURCE_CHOOSES, F(NODES)) |
                 when(can & CONIC_SOURCE_CHOOSES, F(CHOOSES)) | when(is_gaussian(session, job), F(GAUSSIANS));
  if (own->certain & F(COMPOSITED))
    own->certain |= when(job->shot.gaussians.profile == CONIC_PROFILE_EXACT, F(EXACT));
  for (int i = 0; i < job->n_inputs; i++)
    own->certain |= when(strstr(job->inputs[i], "://") != NULL, F(URL));
  own->possible = own->certain;
  if (own->certain & F(COMPOSITED))
    return;
  if (is_hybrid)
    own->possible |=
        CLI_SURFACES | when(is_mesh && !conic_source_kind_of_file(job->inputs[0]), F(FACES) | F(EDGES) | F(VALUED));
  else if (own->certain & F(LEVELS))
    own->possible |= F(SPLATS) | F(ALPHA) | F(VALUED);
  else if (own->certain & F(NODES))
    own->possible |= F(SPLATS) | F(ALPHA);
  else
    own->possible |= read & ~when(job->opening.as == CONIC_AS_POINTS || job->is_patch, F(TRIANGLES) | F(EDGES));
  if (job->n_inputs == 1 && !conic_disk_can_read(job->inputs[0]) && !(own->certain & F(URL)))
    own->possible = SOURCE_FACTS; /* opening it is to say more */
}

/* Whether the points of an octree let light through. */
static int has_faint_points(const cli_render_job *job) {
  conic_splats leaves;
  const conic_drawing drawing = {.splats = &leaves};
  const conic_octree *octree = conic_source_octree(job->source);
  if (!octree || conic_octree_leaves(octree, &leaves) != CONIC_OK)
    return 0;
  int is_faint = conic_drawing_is_transparent(&drawing);
  conic_splats_release(job->source->context, &leaves);
  return is_faint;
}

/* Once it is open. */
static void know_source(cli_render_job *job) {
  cli_effects_job *own = &job->effects;
  const conic_source_scale *scale = conic_source_measure(job->source);
  const conic_coloring *coloring = conic_source_coloring(job->source);
  const unsigned can = scale->abilities;
  const facts traits[] = {F(FACES), F(EDGES), F(RAW), F(TEXT), F(ALPHA)}; /* as conic_source_trait has its bits */
  for (int i = 0; i < 5; i++)
    own->possible &= ~when(job->source->no_traits >> i & 1, traits[i]);
  if (job->is_transparent && own->possible & F(NODES) && !has_faint_points(job))
    own->possible &= ~F(ALPHA);
  own->possible &= own->certain |
                   ~(when(!(can & CONIC_SOURCE_COMPOSITES), F(COMPOSITED)) |
                     when(!(can & CONIC_SOURCE_COMPOSITES) && job->opening.gaussians, F(GAUSSIANS)) |
                     when(!(can & CONIC_SOURCE_CLUSTERS), F(HYBRID)) | when(!(can & CONIC_SOURCE_STREAMS), F(LEVELS)) |
                     when(can != CONIC_SOURCE_CHOOSES, F(NODES)) | when(!(can & CONIC_SOURCE_CHOOSES), F(CHOOSES)));
  if (job->top.is_wanted && !job->is_shade_given && scale->has_colors) /* it is then drawn as it is */
    own->asked &= ~(F(LIT) | F(SHAPED));
  int is_chosen = job->shot.view.only_kind >= 0 || own->asked & CLI_CHOSEN; /* of a hybrid, which may be either kind */
  if (!(own->certain & F(HYBRID) && is_chosen))
    own->possible &= ~(when(!scale->n_splats, F(SPLATS)) | when(!scale->n_triangles, F(TRIANGLES)));
  own->possible &= ~when(!coloring || !coloring->field[0], F(VALUED));
}

static int is_ended(const cli_render_job *job, const char *path, const char *const *endings) {
  const char *own = conic_file_ending(path), *ending = *own ? own : job->writing.format ? job->writing.format : "png";
  for (int i = 0; endings[i]; i++)
    if (strcasecmp(ending, endings[i]) == 0)
      return 1;
  return 0;
}

static facts ask_of_outputs(const cli_render_job *job) {
  static const char *const exr[] = {"exr", NULL}, *const floats[] = {"exr", "pfm", "hdr", NULL};
  const char *const beside[] = {job->overdraw_path, job->clusters_path, job->boxes_path, job->legend_path};
  facts found = when(job->deep_path || job->progressive_path, F(EXR));
  for (int i = 0; i < job->n_outputs + 4; i++) {
    const char *path = i < job->n_outputs ? job->outputs[i] : beside[i - job->n_outputs];
    if (!path)
      continue;
    found |= when(is_ended(job, path, exr), F(EXR)) | when(!*conic_file_ending(path), F(NAMELESS)) |
             when(i < job->n_outputs && !is_ended(job, path, floats), F(CODES)) | when(!strcmp(path, "-"), F(STREAM));
  }
  return found;
}

static facts ask_of_camera(const cli_render_job *job) {
  const cli_accumulate_job *sums = &job->accumulating;
  int is_map = job->top.is_wanted, is_framed = !job->camera_path && !is_map, kind = job->projection;
  int sees_all_around = kind == CONIC_CAMERA_EQUIRECTANGULAR || kind == CONIC_CAMERA_CUBE;
  return when(is_framed, F(FRAMED)) |
         when(is_framed && !sees_all_around && kind != CONIC_CAMERA_ORTHOGRAPHIC, F(FIELD)) |
         when(job->camera_path != NULL, F(CAMERAS)) | when(is_map, F(MAP)) | when(job->is_turntable, F(TURNTABLE)) |
         when(job->is_every_view, F(EVERY_VIEW)) | when(job->stereo.distance > 0.0, F(STEREO)) |
         when(sums->n_samples > 0, F(ACCUMULATED)) | when(sums->is_sample_given, F(SAMPLE)) |
         when(sums->width.value > 0.0, F(LENS)) |
         when(job->is_turntable || job->camera_path || sums->motion_path, F(WAY)) |
         when(kind != CONIC_CAMERA_PERSPECTIVE, F(PROJECTED)) | when(kind == CONIC_CAMERA_CUBE, F(CUBE)) |
         when(kind == CONIC_CAMERA_FISHEYE || kind == CONIC_CAMERA_EQUIRECTANGULAR, F(CURVED));
}

/* Whether a quality does. */
static int chooses_samples(const cli_render_job *job, const cli_scene_words *words) {
  return !words->is_samples_given && !job->accumulating.n_samples && !job->accumulating.is_sample_given;
}

static facts ask_of_drawing(const cli_render_job *job, const cli_scene_words *words) {
  const conic_render_options *render = &job->shot.render;
  const conic_gaussian_profile profile = job->shot.gaussians.profile;
  const int method = (int)render->method, is_composited = (job->abilities & CONIC_SOURCE_COMPOSITES) != 0;
  const unsigned planes = job->is_aov_given ? job->shot.planes : 0;
  int is_lit = render->shading != CONIC_SHADE_NONE && !is_composited;
  int is_rough = words->quality == CLI_QUALITY_DRAFT && !words->is_method_given && !is_composited;
  int is_masked = job->n_directions || job->has_shadows || job->lamps.n_lamps ||
                  planes & (1u << CONIC_PLANE_AO | 1u << CONIC_PLANE_SHADOW);
  return when(job->shot.view.error_px > 0.0, F(ERROR)) | when(job->budget > 0, F(BUDGET)) |
         when(job->is_patch, F(PATCH)) | when(method != CONIC_METHOD_POINT || job->is_patch, F(KERNEL)) |
         when(method != CONIC_METHOD_POINT && method != CONIC_METHOD_DISC, F(FILTERED)) |
         when(words->passes == 3, F(BLENDED)) | when(is_lit, F(LIT)) |
         when(is_lit || is_masked || planes & 1u << CONIC_PLANE_NORMAL || cli_color_is_asked(&job->coloring),
              F(SHAPED)) |
         when(is_lit || !job->camera_path || job->is_turntable || cli_color_is_asked(&job->coloring), F(UPRIGHT)) |
         when(chooses_samples(job, words) || is_rough, F(UNSETTLED)) |
         when(profile == CONIC_PROFILE_INRIA_2023 || profile == CONIC_PROFILE_2DGS_2024, F(OWN_CENTER)) |
         when(strcmp(job->device.name, "cpu") != 0, F(OPENCL)) | when(!job->is_for_looking, F(ASKING)) |
         when(!job->is_for_looking && !job->may_composite, F(TAKES_APART)) | when(!job->may_stream, F(UNSTREAMED)) |
         when(job->shot.gaussians.prefilter > 0.0, F(PREFILTERED)) |
         when(words->is_as_given && (words->as == CONIC_AS_MESH || words->as == CONIC_AS_HYBRID), F(AS_MESH)) |
         when(words->is_colored_whole && words->as != CONIC_AS_HYBRID, F(COLORED_WHOLE)) |
         when(job->deep_path != NULL, F(DEEP)) | when(job->has_mattes, F(MATTES)) |
         when(job->is_transparent, F(TRANSPARENT)) | when(job->shot.view.samples > 1, F(SAMPLED)) |
         when(job->progressive_path != NULL, F(PROGRESSIVE)) | when(job->deadline > 0.0, F(DEADLINE)) |
         when(job->repeat > 1, F(REPEATED)) | when(job->is_exposure_automatic, F(EXPOSED)) |
         when(job->shot.has_backdrop, F(BACKDROP)) | when(job->lamps.n_lamps || cli_lamps_are_soft(job), F(LAMPS)) |
         when(is_masked, F(MASKED)) |
         when(job->overdraw_path || job->clusters_path || job->boxes_path || job->legend_path || job->has_legend,
              F(SHOWN));
}

/* --- what was given --- */

static void note_given(cli_effects_job *own, const char *dashes, const char *name, const cli_effect *acts) {
  if (own->n_given < CLI_MOST_GIVEN)
    own->given[own->n_given++] = (cli_given){dashes, name, *acts};
}

void cli_effects_note(cli_effects_job *own, const cli_option *table, int n, const char *const *values) {
  for (int i = 0; i < n; i++)
    if (values[i] && !table[i].now)
      note_given(own, cli_dashes(&table[i]), table[i].name, &table[i].acts);
}

/* --timeout, where it is known to be of what can be read in parts. */
static int is_waited_for(const cli_render_job *job) {
  conic_layers_access usual;
  conic_layers_access_init(&usual);
  return job->access.stall_seconds != usual.stall_seconds && job->effects.certain & (F(LEVELS) | F(HYBRID));
}

/* Parts of values: pictures that --show names, planes of --aov, and what stands behind a colon. */
static void note_parts(cli_render_job *job, const cli_scene_words *words) {
  const cli_accumulate_job *sums = &job->accumulating;
  const unsigned planes = job->is_aov_given ? job->shot.planes : 0;
  int is_model = words->as == CONIC_AS_MESH || words->as == CONIC_AS_HYBRID;
  const struct {
    int is_given;
    const char *name;
    cli_effect acts;
  } parts[] = {
      {job->overdraw_path != NULL, "show overdraw", {.apart = F(MAP)}},
      {job->clusters_path != NULL, "show clusters", {.on = F(HYBRID), .apart = F(MAP)}},
      {job->boxes_path != NULL, "show boxes", {.on = F(NODES), .apart = F(MAP)}},
      {job->legend_path != NULL, "show legend:OUT", {.on = F(VALUED), .apart = F(MAP)}},
      {job->has_legend, "show legend", {.apart = F(MAP)}}, /* which a warning says, where there is none */
      {job->has_mattes, "aov cryptomatte", {.on = CLI_SURFACES, .apart = F(MAP)}},
      {(planes & CONIC_GAUSSIAN_PLANES) != 0,
       "aov with the planes T, medianZ, inverseZ, last and doubt",
       {.on = F(COMPOSITED)}},
      {(planes & 1u << CONIC_PLANE_CLUSTER) != 0, "aov cluster", {.on = F(HYBRID)}},
      {(planes & (1u << CONIC_PLANE_SAMPLES | 1u << CONIC_PLANE_VARIANCE)) != 0,
       "aov with the planes samples and variance",
       {.needs = F(ACCUMULATED)}},
      {job->is_color_error_given, "error PX:STEPS", {.on = F(HYBRID), .needs = F(ERROR)}},
      {job->shot.gaussians.ignores_center != 0,
       "profile NAME:ignore-center",
       {.on = F(COMPOSITED), .needs = F(OWN_CENTER)}},
      {words->is_as_given && !is_model, "as", {.on = F(FACES), .is_warned = 1}},
      {words->is_as_given && is_model, "as mesh or hybrid", {.on = F(FACES)}},
      {words->is_quality_given && !chooses_samples(job, words), "quality", {.on = F(SPLATS), .is_warned = 1}},
      {is_waited_for(job), "timeout", {.on = F(URL), .is_warned = 1}},
      {words->is_patch_given, "method patch:D:H", {.needs = F(PATCH)}},
      {words->is_smooth, "crease all", {.on = F(TRIANGLES)}},
      {job->stereo.is_convergence_given, "stereo E:Z", {.needs = F(STEREO)}},
      {sums->n_blades != 0, "aperture D:BLADES", {.needs = F(LENS)}},
      {job->device.allow_inexact, "device NAME:inexact", {.needs = F(OPENCL), .is_warned = 1}},
  };
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
    if (parts[i].is_given)
      note_given(&job->effects, "--", parts[i].name, &parts[i].acts);
}

/* --- the check --- */

/* The facts of a set in words, joined by "or". */
static void join_facts(facts set, char *text, size_t room) {
  size_t used = 0;
  text[0] = '\0';
  for (int i = 0; i < CLI_N_FACTS && used < room; i++)
    if (set >> i & 1 && fact_words[i].words)
      used += (size_t)snprintf(text + used, room - used, "%s%s", used ? ", or " : "", fact_words[i].words);
}

/* What to do where a source is none of which an option is. */
static const char *find_remedy(const cli_render_job *job, facts on) {
  const cli_effects_job *own = &job->effects;
  if (own->certain & F(COMPOSITED) && on & (F(SPLATS) | F(RAW) | F(ALPHA)))
    return "; --profile surface draws the scene as splats";
  if (own->certain & F(GAUSSIANS) && on & F(COMPOSITED))
    return "; the scene is drawn as splats";
  if (own->possible & F(FACES) && on & F(TRIANGLES))
    return "; give --as mesh, too";
  return "";
}

/* Of one option. */
static int check_one_given(const cli_session *session, const cli_render_job *job, const cli_given *option) {
  const cli_effects_job *own = &job->effects;
  const cli_effect *acts = &option->acts;
  const facts known = own->possible | own->asked;
  int is_lacking = acts->needs && !(acts->needs & known), is_foreign = acts->on && !(acts->on & known);
  char words[1024];
  if (acts->apart & (own->certain | own->asked)) {
    join_facts(acts->apart & (own->certain | own->asked), words, sizeof words);
    return cli_usage("%s: %s%s does not go with %s", session->command, option->dashes, option->name, words);
  }
  if (!is_lacking && !is_foreign)
    return CLI_DONE;
  const facts lacked = is_foreign ? acts->on : acts->needs;
  int is_source = (lacked & SOURCE_FACTS) != 0;
  join_facts(lacked, words, sizeof words);
  if (is_source)
    snprintf(words + strlen(words), sizeof words - strlen(words), ", not on %s%s", job->inputs[0],
             find_remedy(job, lacked));
  const char *verb = is_source ? "acts on" : "needs";
  if (!acts->is_warned)
    return cli_usage("%s: %s%s has no effect: it %s %s", session->command, option->dashes, option->name, verb, words);
  cli_warn(session, "%s: %s%s has no effect: it %s %s", session->command, option->dashes, option->name, verb, words);
  return CLI_DONE;
}

/* Each option once: what is wrong or warned of is not said again when more is known. */
static int check_given(const cli_session *session, cli_render_job *job) {
  cli_effects_job *own = &job->effects;
  int answer = CLI_DONE, n = 0;
  for (int i = 0; i < own->n_given && answer == CLI_DONE; i++) {
    const cli_effect *acts = &own->given[i].acts;
    int is_said = (acts->on && !(acts->on & (own->possible | own->asked))) ||
                  (acts->needs && !(acts->needs & (own->possible | own->asked)));
    answer = check_one_given(session, job, &own->given[i]);
    if (!is_said)
      own->given[n++] = own->given[i];
  }
  own->n_given = n;
  return answer;
}

int cli_effects_check(const cli_session *session, const cli_scene_words *words, cli_render_job *job) {
  cli_effects_job *own = &job->effects;
  guess_source(session, job);
  own->asked = ask_of_outputs(job) | ask_of_camera(job) | ask_of_drawing(job, words) |
               when(job->accumulating.resume_path != NULL, F(STREAM));
  note_parts(job, words);
  const facts held = own->certain | own->asked;
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
    if ((held & pairs[i].all) == pairs[i].all && (!pairs[i].any || held & pairs[i].any) && !(held & pairs[i].unless))
      return cli_usage("%s: %s", session->command, pairs[i].why);
  return check_given(session, job);
}

int cli_effects_check_open(const cli_session *session, cli_render_job *job) {
  know_source(job);
  return check_given(session, job);
}
