/* Whether options change anything, and go together. */
#include "cli/scene/option_effects.h"

#include <strings.h>

#include "cli/color_options.h"
#include "cli/host_keeps.h"
#include "cli/scene/scene_options.h"
#include "core/base/context_struct.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/splats/gaussian_profile.h"
#include "source/source_kind.h"

/* --- what cannot be together --- */

#define F(name) CLI_FACT(name)

static const struct {
  cli_facts all, any, unless; /* it is refused where all of the first hold, any of the second, and none of the third */
  const char *why;
} pairs[] = {
    {CLI_CHOSEN, 0, 0, "--error and --budget are two ways to choose; give one of both"},
    {F(PATCH) | F(HYBRID), 0, 0, "--method patch draws points, and no hybrids"},
    {F(PATCH), CLI_CHOSEN, 0, "--method patch draws samples of its own: not with --error or --budget"},
    {F(PATCH) | F(DEEP), 0, 0, "--method patch draws samples of its own: not with --deep"},
    {F(PROJECTED) | F(COMPOSITED), 0, F(EXACT) | F(CUBE) | F(MIXED),
     "--projection is of pictures by conic render, and of Gaussian scenes by --profile exact"},
    {F(PROJECTED) | F(ASKING), 0, F(EXACT),
     "--projection is of pictures by conic render, and of Gaussian scenes by --profile exact"},
    {F(COMPOSITED) | F(EXPOSED), 0, 0, "--exposure auto is of splats; give --profile surface, too"},
    {F(DEEP) | F(MIXED) | F(MASKED), 0, 0, "--deep has surfaces among Gaussians as they are without --ao and --shadow"},
    {F(MIXED) | F(OPENCL), 0, 0, "--device opencl draws Gaussian scenes, or surfaces, not both together"},
    {F(DEEP) | F(COMPOSITED) | F(PROJECTED), 0, 0, "--deep is of perspective pictures"},
    {F(LEVELS) | F(ASKING), CLI_CHOSEN, 0,
     "of an .lpc it takes all; --error and --budget choose of one in conic render"},
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
    {F(MASKED) | F(COMPOSITED), 0, F(MIXED),
     "--ao, --shadow, lamps and the planes ao and shadow are of surfaces; give --profile surface, too"},
    {F(DEEP) | F(SAMPLED), 0, 0, "--deep lists the splats of pixels, not of --samples"},
    {F(DEEP), CLI_CHOSEN, F(HYBRID),
     "--deep lists the splats of the input, not those that --error and --budget choose"},
    {F(DEEP) | F(LEVELS), 0, 0, "--deep lists the splats of inputs that are read whole, not of a cloud in levels"},
    {F(MATTES) | F(LEVELS), 0, 0, "--aov cryptomatte names what is read whole, not a cloud in levels"},
    {F(MATTES), CLI_CHOSEN, F(HYBRID) | F(NODES),
     "--aov cryptomatte names what the inputs have, not what --error and --budget join"},
    {F(MATTES), 0, F(EXR), "--aov cryptomatte goes into an .exr; give -o OUT.exr"},
    {F(PROGRESSIVE), F(TURNTABLE) | F(REPEATED), 0,
     "--progressive writes the pictures of one frame, not of a turntable or of --repeat"},
    {F(TRANSPARENT) | F(MIXED), 0, F(ACCUMULATED) | F(SAMPLE),
     "surfaces among Gaussians let light through in the mean of samples; give --accumulate N, too"},
    {F(TRANSPARENT) | F(COMPOSITED), 0, F(MIXED),
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

static cli_facts when(int holds, cli_facts fact) {
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
  const cli_facts read =
      CLI_SURFACES | F(FACES) | F(TEXTURED) | F(EDGES) | F(RAW) | F(TEXT) | F(ALPHA) | F(VALUED) | F(FRACTIONS);
  int is_hybrid = (can & CONIC_SOURCE_CLUSTERS) != 0, is_mesh = job->opening.as == CONIC_AS_HYBRID;
  own->certain = when(can & CONIC_SOURCE_COMPOSITES, F(COMPOSITED)) | when(can & CONIC_SOURCE_MIXES, F(MIXED)) |
                 when(is_hybrid, F(HYBRID)) | when(can & CONIC_SOURCE_STREAMS, F(LEVELS)) |
                 when(can == CONIC_SOURCE_CHOOSES, F(NODES)) |
                 when(!(can & CONIC_SOURCE_COMPOSITES) || can & CONIC_SOURCE_CHOOSES, F(CHOOSES)) |
                 when(is_gaussian(session, job), F(GAUSSIANS));
  if (own->certain & F(COMPOSITED))
    own->certain |= when(job->shot.gaussians.profile == CONIC_PROFILE_EXACT, F(EXACT));
  for (int i = 0; i < job->n_inputs; i++)
    own->certain |= when(strstr(job->inputs[i], "://") != NULL, F(URL));
  own->possible = own->certain;
  if (own->certain & F(COMPOSITED) && !(own->certain & F(MIXED)))
    return;
  if (is_hybrid)
    own->possible |=
        CLI_SURFACES | F(TEXTURED) |
        when(is_mesh && !conic_source_kind_of_file(job->inputs[0]), F(FACES) | F(EDGES) | F(VALUED) | F(FRACTIONS));
  else if (own->certain & F(LEVELS))
    own->possible |= F(SPLATS) | F(ALPHA) | F(VALUED);
  else if (own->certain & F(NODES))
    own->possible |= F(SPLATS) | F(ALPHA);
  else
    own->possible |= read & ~(when(job->opening.as == CONIC_AS_POINTS, F(TRIANGLES) | F(EDGES) | F(TEXTURED)) |
                              when(job->is_patch, F(TRIANGLES) | F(TEXTURED))); /* a mesh's patches have its creases */
  if (job->n_inputs == 1 && !conic_disk_can_read(job->inputs[0]) && !(own->certain & F(URL)))
    own->possible = CLI_SOURCE_FACTS; /* opening it is to say more */
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
  const cli_facts traits[] = {F(FACES), F(EDGES), F(RAW),
                              F(TEXT),  F(ALPHA), F(FRACTIONS)}; /* as conic_source_trait has its bits */
  for (int i = 0; i < 6; i++)
    own->possible &= ~when((job->source->no_traits >> i & 1u) != 0, traits[i]);
  if (job->is_transparent && own->possible & F(NODES) && !has_faint_points(job))
    own->possible &= ~F(ALPHA);
  own->possible &=
      own->certain | ~(when(!(can & CONIC_SOURCE_COMPOSITES), F(COMPOSITED)) |
                       when(!(can & CONIC_SOURCE_COMPOSITES) && job->opening.gaussians, F(GAUSSIANS)) |
                       when(!(can & CONIC_SOURCE_CLUSTERS), F(HYBRID)) |
                       when(!(can & CONIC_SOURCE_STREAMS), F(LEVELS)) | when(can != CONIC_SOURCE_CHOOSES, F(NODES)) |
                       when(can & CONIC_SOURCE_COMPOSITES && !(can & CONIC_SOURCE_CHOOSES), F(CHOOSES)));
  if (job->top.is_wanted && !job->is_shade_given && scale->has_colors) /* it is then drawn as it is */
    own->asked &= ~(F(LIT) | F(SHAPED));
  int is_chosen = job->shot.view.only_kind >= 0 || own->asked & CLI_CHOSEN; /* of a hybrid, which may be either kind */
  if (!(own->certain & F(HYBRID) && is_chosen))
    own->possible &= ~(when(!scale->n_splats, F(SPLATS)) | when(!scale->n_triangles, F(TRIANGLES)));
  own->possible &= ~(when(!coloring || !coloring->field[0], F(VALUED)) |
                     when(!job->source->context->texture_bytes && !cli_color_is_asked(&job->coloring), F(TEXTURED)));
}

static int is_ended(const cli_render_job *job, const char *path, const char *const *endings) {
  const char *own = conic_file_ending(path), *ending = *own ? own : job->writing.format ? job->writing.format : "png";
  for (int i = 0; endings[i]; i++)
    if (strcasecmp(ending, endings[i]) == 0)
      return 1;
  return 0;
}

static cli_facts ask_of_outputs(const cli_render_job *job) {
  static const char *const exr[] = {"exr", NULL}, *const floats[] = {"exr", "pfm", "hdr", NULL};
  static const char *const tiff[] = {"tif", "tiff", NULL}, *const telling[] = {"exr", "png", "tif", "tiff", NULL};
  const char *const beside[] = {job->overdraw_path, job->clusters_path, job->boxes_path, job->legend_path};
  cli_facts found = when(job->deep_path || job->progressive_path, F(EXR) | F(TELLING));
  for (int i = 0; i < job->n_outputs + 4; i++) {
    const char *path = i < job->n_outputs ? job->outputs[i] : beside[i - job->n_outputs];
    if (!path)
      continue;
    found |= when(is_ended(job, path, exr), F(EXR)) | when(!*conic_file_ending(path), F(NAMELESS)) |
             when(i < job->n_outputs && !is_ended(job, path, floats), F(CODES)) | when(!strcmp(path, "-"), F(STREAM)) |
             when(i < job->n_outputs && is_ended(job, path, tiff), F(TIFF)) |
             when(is_ended(job, path, telling), F(TELLING));
  }
  return found;
}

static cli_facts ask_of_camera(const cli_render_job *job) {
  const cli_accumulate_job *sums = &job->accumulating;
  int is_map = job->top.is_wanted, is_framed = !job->camera_path && !is_map, kind = job->projection;
  return when(is_framed, F(FRAMED)) | when(kind == CONIC_CAMERA_PERSPECTIVE || kind == CONIC_CAMERA_FISHEYE, F(FIELD)) |
         when(job->camera_path || job->is_view_side, F(CAMERAS)) | when(is_map, F(MAP)) |
         when(job->is_turntable, F(TURNTABLE)) | when(job->is_every_view, F(EVERY_VIEW)) |
         when(job->stereo.distance > 0.0, F(STEREO)) | when(sums->n_samples > 0, F(ACCUMULATED)) |
         when(sums->is_sample_given, F(SAMPLE)) | when(sums->width.value > 0.0, F(LENS)) |
         when(job->is_turntable || job->camera_path || sums->motion_path, F(WAY)) |
         when(kind != CONIC_CAMERA_PERSPECTIVE, F(PROJECTED)) | when(kind == CONIC_CAMERA_CUBE, F(CUBE));
}

/* Whether a quality does. */
static int chooses_samples(const cli_render_job *job, const cli_scene_words *words) {
  return !words->is_samples_given && !job->accumulating.n_samples && !job->accumulating.is_sample_given;
}

static cli_facts ask_of_drawing(const cli_render_job *job, const cli_scene_words *words) {
  const conic_render_options *render = &job->shot.render;
  const conic_gaussian_profile profile = job->shot.gaussians.profile;
  const int method = (int)render->method,
            is_composited =
                (job->abilities & (CONIC_SOURCE_COMPOSITES | CONIC_SOURCE_MIXES)) == CONIC_SOURCE_COMPOSITES;
  const unsigned planes = job->is_aov_given ? job->shot.planes : 0;
  int is_lit = render->shading != CONIC_SHADE_NONE && !is_composited;
  int is_rough = words->quality % CLI_QUALITY_SKETCH == CLI_QUALITY_DRAFT && !words->is_method_given && !is_composited;
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
         when(conic_profile_row_of(profile)->takes_middle, F(OWN_CENTER)) |
         when(strcmp(job->device.name, "cpu") != 0, F(OPENCL)) | when(!job->is_for_looking, F(ASKING)) |
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

/* --timeout, where it is known to be of what can be read in parts. */
static int is_waited_for(const cli_render_job *job) {
  conic_layers_access usual;
  conic_layers_access_init(&usual);
  return job->access.stall_seconds != usual.stall_seconds && job->effects.certain & (F(LEVELS) | F(HYBRID));
}

#define HAS(plane) ((planes & 1u << CONIC_PLANE_##plane) != 0)

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
      {job->boxes_path != NULL, "show boxes", {.on = F(NODES) | F(LEVELS), .apart = F(MAP)}},
      {job->legend_path != NULL, "show legend:OUT", {.on = F(VALUED), .apart = F(MAP)}},
      {job->has_legend, "show legend", {.apart = F(MAP)}}, /* which a warning says, where there is none */
      {job->has_mattes, "aov cryptomatte", {.on = CLI_SURFACES | F(COMPOSITED), .apart = F(MAP)}},
      {HAS(TRANSPARENCY), "aov T", {.on = F(COMPOSITED)}},
      {HAS(MEDIAN_Z), "aov medianZ", {.on = F(COMPOSITED)}},
      {HAS(INVERSE_Z), "aov inverseZ", {.on = F(COMPOSITED)}},
      {HAS(LAST), "aov last", {.on = F(COMPOSITED)}},
      {HAS(DOUBT), "aov doubt", {.on = F(COMPOSITED)}},
      {HAS(CLUSTER), "aov cluster", {.on = F(HYBRID)}},
      {HAS(ALBEDO) && planes != CONIC_DRAWN_PLANES, "aov albedo", {.on = CLI_SURFACES}},
      {HAS(WEIGHT) && planes != CONIC_DRAWN_PLANES, "aov weight", {.on = CLI_SURFACES}},
      {HAS(SAMPLES), "aov samples", {.needs = F(ACCUMULATED)}},
      {HAS(VARIANCE), "aov variance", {.needs = F(ACCUMULATED)}},
      {words->is_quality_given && words->quality % CLI_QUALITY_SKETCH == CLI_QUALITY_DRAFT,
       "quality draft",
       {.apart = F(MAP), .why = "a map has one sample a pixel as it is"}},
      {job->is_plain && job->top.is_wanted, "plain", {.on = F(FACES) | F(RAW) | F(LIT)}},
      {words->is_colored_whole && words->as != CONIC_AS_HYBRID && job->n_inputs == 1 &&
           conic_source_kind_of_file(job->inputs[0]),
       "color-by",
       {.apart = CLI_CHOSEN,
        .why = "it looks at all that there is; conic octree and conic layer take it, too, and keep the colours"}},
      {job->top.gsd > 0.0, "camera top:GSD", {.needs = F(MAP)}},
      {job->top.epsg != 0, "camera top:GSD:EPSG", {.on = F(MAP), .needs = F(TIFF)}},
      {job->is_color_error_given, "error PX:STEPS", {.on = F(HYBRID) | F(TRIANGLES), .needs = F(ERROR)}},
      {job->shot.gaussians.ignores_center != 0,
       "profile NAME:ignore-center",
       {.on = F(COMPOSITED), .needs = F(OWN_CENTER)}},
      {words->is_as_given && !is_model, "as", {.on = F(FACES), .is_warned = 1}},
      {words->is_as_given && is_model,
       "as mesh or hybrid",
       {.on = F(FACES), .apart = F(PATCH), .why = "it draws points"}},
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
      cli_effects_add(&job->effects, "--", parts[i].name, &parts[i].acts);
  if (job->writing.format)
    cli_effects_add(&job->effects, "-", "o KIND:OUT", &(cli_effect){.needs = F(NAMELESS), .is_warned = 1});
}

/* --- the check --- */

/* What to do where a source is none of which an option is. */
static const char *find_remedy(const cli_effects_job *own, cli_facts on) {
  if (own->certain & F(COMPOSITED) && on & (F(SPLATS) | F(RAW) | F(ALPHA) | F(CHOOSES)))
    return "; --profile surface draws the scene as splats";
  if (own->certain & F(GAUSSIANS) && on & F(COMPOSITED))
    return "; the scene is drawn as splats";
  if (own->possible & F(FACES) && on & F(TRIANGLES))
    return "; give --as mesh, too";
  return "";
}

int cli_effects_check(const cli_session *session, const cli_scene_words *words, cli_render_job *job) {
  cli_effects_job *own = &job->effects;
  guess_source(session, job);
  own->asked = ask_of_outputs(job) | ask_of_camera(job) | ask_of_drawing(job, words) |
               when(job->accumulating.resume_path != NULL, F(STREAM));
  note_parts(job, words);
  const cli_facts held = own->certain | own->asked;
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
    if ((held & pairs[i].all) == pairs[i].all && (!pairs[i].any || held & pairs[i].any) && !(held & pairs[i].unless))
      return cli_usage("%s: %s", session->command, pairs[i].why);
  return cli_effects_check_given(session, &job->effects, job->inputs[0], find_remedy);
}

/* That there is the level whose boxes are asked for. */
static int check_boxes(const cli_session *session, const cli_render_job *job) {
  const conic_octree *octree = conic_source_octree(job->source);
  conic_octree_info info;
  int n_levels = octree && conic_octree_describe(octree, &info) == CONIC_OK
                     ? (int)info.n_levels
                     : conic_source_measure(job->source)->n_levels;
  if (!job->boxes_path || job->box_level < n_levels)
    return CLI_DONE;
  return cli_usage("%s: --show boxes@%d: the last level of %s is %d", session->command, job->box_level, job->inputs[0],
                   n_levels - 1);
}

int cli_effects_check_open(const cli_session *session, cli_render_job *job) {
  know_source(job);
  if (check_boxes(session, job) != CLI_DONE)
    return CLI_USAGE;
  return cli_effects_check_given(session, &job->effects, job->inputs[0], find_remedy);
}
