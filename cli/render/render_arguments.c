#include <string.h>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/render/fill_shot.h"
#include "cli/render/kept_frames.h"
#include "cli/render/sample_options.h"
#include "cli/render/shot_again.h"
#include "cli/scene/stereo.h"
#include "cli/shell.h"
#include "core/files/file.h"
#include "shots/shot_plan.h"

static const char *const overdraw_words[] = {"log", "confetti", NULL};
static const char *const exr_words[] = {"float", "half", NULL};
static const char *const occlusion_words[] = {"auto", "on", "off", NULL};

static int parse_output(const char *text, void *value) {
  cli_render_job *job = value;
  if (!*text || job->n_outputs == CLI_MAX_OUTPUTS)
    return 0;
  job->outputs[job->n_outputs++] = text;
  return 1;
}

/* Refused now, and not after the work. */
static int check_output(const cli_render_job *job, const char *path) {
  if (strcmp(path, "-") == 0 && cli_shell_is_terminal(stdout))
    return cli_usage("render: a picture is not for a terminal; redirect standard output, or name a file");
  if (strcmp(path, "-") != 0 && !job->writing.format && !*conic_file_ending(path))
    return cli_usage("%s: the name needs an ending, such as .exr", path);
  return CLI_DONE;
}

static int check_deep(const cli_render_job *job) {
  const char *dot = strrchr(job->deep_path, '.');
  if (!dot || strcmp(dot, ".exr") != 0)
    return cli_usage("%s: a deep image is an .exr", job->deep_path);
  if (job->shot.view.samples > 1)
    return cli_usage("render: --deep lists the splats of pixels, not of --samples");
  return CLI_DONE;
}

static int check_streaming(const cli_render_job *job, const int is_given[2]) {
  int streams = (job->abilities & CONIC_SOURCE_STREAMS) != 0;
  if ((job->progressive_path || job->deadline > 0.0 || is_given[0]) && !streams)
    return cli_usage("render: --progressive, --deadline, --tolerate and --occlusion are for a single .lpc, or the URL "
                     "of one");
  if (is_given[1] && !(job->abilities & CONIC_SOURCE_READS_PARTS))
    return cli_usage("render: --timeout is for a single .lpc or .chy, or the URL of one");
  if (streams && job->deep_path)
    return cli_usage("render: --deep lists the splats of inputs that are read whole, not of an .lpc");
  if (job->progressive_path && (job->is_turntable || job->repeat > 1))
    return cli_usage("render: --progressive writes the pictures of one frame, not of a turntable or of --repeat");
  return CLI_DONE;
}

static int check_light(const cli_render_job *job) {
  if (job->sky_path && job->n_directions == 0)
    return cli_usage("render: the light of %s comes from so many directions as --ao says; give it, too", job->sky_path);
  if (conic_shot_is_lit(&job->shot) && job->abilities & CONIC_SOURCE_COMPOSITES)
    return cli_usage("render: --ao, --shadow and lamps are of surfaces; give --profile surface, too");
  if (conic_shot_is_lit(&job->shot) && job->top.is_wanted)
    return cli_usage("render: --ao, --shadow and lamps are not of --camera top");
  return CLI_DONE;
}

static int check_transparency(cli_render_job *job) {
  if (job->abilities & CONIC_SOURCE_COMPOSITES)
    return cli_usage("render: a Gaussian scene lets light through as it is; --transparency is of its splats, by "
                     "--profile surface");
  if (job->abilities & CONIC_SOURCE_CLUSTERS)
    return cli_usage("render: a hybrid keeps no opacities; --transparency is of what it was made of, as splats or as a "
                     "mesh");
  if (job->deep_path || job->has_mattes || job->top.is_wanted)
    return cli_usage("render: not --transparency with --deep, --cryptomatte or --camera top");
  if (job->shot.render.passes != 3)
    return cli_usage("render: --transparency is of surfaces that blend: not with --passes 1");
  job->shot.view.transparency = CONIC_TRANSPARENCY_LAYERS;
  job->opening.keeps_alpha = 1;
  return CLI_DONE;
}

/* Everything that a frame writes; null: nothing. */
enum { N_PATHS = CLI_MAX_OUTPUTS + 6 };
static void list_frame_paths(const cli_render_job *job, const char *paths[N_PATHS]) {
  const char *const beside[] = {job->deep_path, job->overdraw_path, job->clusters_path, job->legend_path,
                                job->boxes_path, job->making.save_path};
  memset(paths, 0, N_PATHS * sizeof *paths);
  memcpy(paths, job->outputs, (size_t)job->n_outputs * sizeof *paths);
  memcpy(paths + CLI_MAX_OUTPUTS, beside, sizeof beside);
}

int cli_render_views_check(const cli_session *session, cli_render_job *job) {
  const char *paths[N_PATHS];
  list_frame_paths(job, paths);
  return job->is_every_view ? cli_frames_check(session, job, paths, N_PATHS) : CLI_DONE;
}

/* What render's own options mean. */
static int check_outputs(const cli_session *session, cli_render_job *job, const int is_given[2]) {
  const char *paths[N_PATHS];
  int answer = CLI_DONE;
  if (!session->host && job->n_outputs == 0 && !job->deep_path && !job->overdraw_path && !job->clusters_path &&
      !job->boxes_path && !job->progressive_path && !job->making.save_path)
    return cli_usage("render: no output; give one with -o OUT.exr, OUT.png, …");
  for (int i = 0; i < job->n_outputs && answer == CLI_DONE; i++)
    answer = check_output(job, job->outputs[i]);
  if (answer == CLI_DONE && job->deep_path)
    answer = check_deep(job);
  if (answer == CLI_DONE && job->overdraw_path)
    answer = check_output(job, job->overdraw_path);
  if (answer == CLI_DONE && job->clusters_path)
    answer = check_output(job, job->clusters_path);
  if (answer == CLI_DONE && job->boxes_path)
    answer = check_output(job, job->boxes_path);
  if (answer == CLI_DONE && job->legend_path)
    answer = check_output(job, job->legend_path);
  if (answer != CLI_DONE)
    return answer;
  if (cli_lod_is_wanted(job) && job->deep_path && !(job->abilities & CONIC_SOURCE_CLUSTERS))
    return cli_usage("render: --deep lists the splats of the input, not those that --error and --budget choose");
  if (job->is_patch && job->deep_path)
    return cli_usage("render: --method patch draws samples of its own: not with --deep");
  answer = check_streaming(job, is_given);
  if (answer == CLI_DONE)
    answer = check_light(job);
  if (answer == CLI_DONE && job->is_transparent)
    answer = check_transparency(job);
  if (answer == CLI_DONE && job->top.is_wanted)
    answer = cli_top_check(session, job);
  if (answer == CLI_DONE)
    answer = cli_stereo_check(session, job);
  if (answer == CLI_DONE)
    answer = cli_kept_frames_check(session, job);
  if (answer == CLI_DONE)
    answer = cli_accumulate_check(session, job);
  if (answer == CLI_DONE && job->has_mattes)
    answer = cli_mattes_check(job);
  if (answer == CLI_DONE && !job->top.is_wanted)
    answer = cli_planes_check(session, job);
  if (answer != CLI_DONE || job->is_every_view) /* how many these are is still to be read */
    return answer;
  list_frame_paths(job, paths);
  return cli_frames_check(session, job, paths, N_PATHS);
}

/* The planes that are drawn for what else is asked for. */
static void want_planes(cli_render_job *job) {
  enum { USUAL_DIRECTIONS = 64 };
  unsigned planes = job->shot.planes;
  if (planes & 1u << CONIC_PLANE_AO && job->n_directions == 0)
    job->n_directions = USUAL_DIRECTIONS;
  if (planes & 1u << CONIC_PLANE_SHADOW)
    job->has_shadows = 1;
  cli_shot_take_options(job);
  planes = conic_shot_needs(&job->shot, planes);
  if (job->deep_path)
    planes |= 1u << CONIC_PLANE_RGBA; /* which its samples make */
  job->unwritten_planes = planes & ~job->shot.planes;
  job->shot.planes = planes;
}

int cli_render_parse(cli_session *session, int argc, char **argv, cli_render_job *job) {
  cli_scene_defaults(job);
  job->may_stream = job->is_for_looking = 1;
  job->box_level = -1;
  conic_image_options_init(&job->writing);
  cli_shot_again_begin(session, job);
  const char *compression_words[CONIC_N_COMPRESSIONS + 1] = {NULL};
  for (int i = 0; i < CONIC_N_COMPRESSIONS; i++)
    compression_words[i] = conic_compression_name((conic_compression)i);
  const char *tone_words[CONIC_N_TONES + 1] = {NULL};
  for (int i = 0; i < CONIC_N_TONES; i++)
    tone_words[i] = conic_tone_name((conic_tone)i);
  int compression = 0;
  enum { USUAL_MIB = 512 };
  int memory_mib = USUAL_MIB, occlusion = CONIC_OCCLUSION_AUTO, is_given[2] = {0, 0};
  const cli_option own[] = {
      {"o", CLI_PARSED, job, "OUT",
       "where the picture goes: .exr, .png, .tif, .jpg, .pfm …; - is standard output; may be repeated",
       .parse = parse_output, .may_repeat = 1, .group = "output"},
      {"format", CLI_TEXT, &job->writing.format, "NAME",
       "the kind of what goes to standard output or to a name without an ending: png, exr, pfm … [png]"},
      {"exr", CLI_CHOICE, &job->writing.is_half, "TYPE",
       "numbers of an .exr: float, or half for rgba, N and albedo [float]", .choices = exr_words},
      {"compression", CLI_CHOICE, &compression, "NAME",
       "of an .exr: zip, none, rle, zips, piz; pxr24 loses bits of floats [zip]", .choices = compression_words},
      {"tone", CLI_CHOICE, &job->tone, "NAME",
       "how files of 8 and 16 bits show what is brighter than white: srgb (as white), filmic (Hable's curve), aces "
       "(Hill's fit) or agx (Sobotka's); .exr, .pfm and .hdr stay linear [srgb]",
       .choices = tone_words},
      {"deep", CLI_TEXT, &job->deep_path, "OUT.exr",
       "every splat and triangle of every pixel, as a deep image: colour, depth, id, weight"},
      {"overdraw", CLI_TEXT, &job->overdraw_path, "OUT.png",
       "how many splats each pixel blends, in false colours: blue 1, red 4, yellow 16, white 64",
       .group = "pictures of how it was drawn"},
      {"overdraw-colors", CLI_CHOICE, &job->is_overdraw_confetti, "NAME",
       "of --overdraw: log, or confetti: blue 1, green 8, red 16 [log]", .choices = overdraw_words},
      {"legend", CLI_FLAG, &job->has_legend, NULL, "what the colours mean, in the picture's lower right corner"},
      {"save-shot", CLI_TEXT, &job->making.save_path, "OUT.shot.json",
       "all that decides the picture, as text by which conic render draws it again"},
      {"no-shot", CLI_FLAG, &job->making.is_left_out, NULL,
       "leave out of .exr, .png and .tif what they say of how they were made"},
      {"again", CLI_TEXT, &job->making.again_path, "PICTURE",
       "draw again what a picture says that it was drawn from, to the bit; other options change that. Inputs are looked "
       "for beside it, here, and among those that are given"},
      {"legend-out", CLI_TEXT, &job->legend_path, "OUT.png", "the same as a picture of its own"},
      {"cryptomatte", CLI_FLAG, &job->has_mattes, NULL,
       "into .exr: mattes by which each input, or each patch of a hybrid, is picked by its name in Nuke or Blender"},
      {"turntable", CLI_PARSED, job, "N", "N pictures around the scene: OUT.0001.exr …, or as OUT_%04d.exr says",
       .parse = cli_parse_turntable, .group = "several pictures"},
      {"frames", CLI_PARSED, &job->frames, "A:B:STEP",
       "only the frames A to B in steps of STEP; those of --turntable count from 1, those of --view all from 0 [all]",
       .parse = cli_parse_frames},
      {"resumable", CLI_FLAG, &job->accumulating.is_resumable, NULL,
       "keep beside the first OUT what is finished, so that --resume can go on after any end: frames in OUT.frames, of "
       "one --accumulate the sums in OUT.sums, and of one .exr larger than half of --memory the strips in OUT.strips "
       "and "
       "OUT.part"},
      {"resume", CLI_TEXT, &job->accumulating.resume_path, "OUT",
       "go on with what OUT.frames, OUT.sums or OUT.strips says is finished, to the bit as if it had never stopped; "
       "with "
       "--resumable, too, where there is none begin"},
      {"stereo", CLI_NUMBER, &job->stereo.distance, "E",
       "two pictures, of eyes that are E apart, in world units: OUT.left.exr and OUT.right.exr, or left and right in "
       "the "
       "place of %V [one]",
       0, 1e29},
      {"convergence", CLI_NUMBER, &job->stereo.convergence, "Z",
       "of --stereo: the depth that both eyes see at the same place; 0: they are parallel [the depth of the scene's "
       "middle; 0 of lenses that distort and of fisheyes]",
       0, 1e29, .is_given = &job->stereo.is_convergence_given},
      {"accumulate", CLI_COUNT, &job->accumulating.n_samples, "N",
       "the mean of N whole pictures, each with its own place in the pixel, point on the lens and moment [none: drawn "
       "at once]",
       1, CONIC_MAX_ACCUMULATED, .group = "final pictures (--accumulate)"},
      {"time", CLI_NUMBER, &job->accumulating.seconds, "S", "no sample is begun after S seconds [no limit]", 1e-3, 1e9,
       .is_given = &job->accumulating.is_given},
      {"noise", CLI_NUMBER, &job->accumulating.noise, "E",
       "16, 32, 64 … samples are enough when their two halves say that the picture is E from its end, in luminance "
       "[none]",
       1e-9, 1e9, .is_given = &job->accumulating.is_given},
      {"preview", CLI_NUMBER, &job->accumulating.preview_seconds, "S",
       "write the picture as it is every S seconds, too [only at the end]", 1e-3, 1e9,
       .is_given = &job->accumulating.is_given},
      CLI_LENS_OPTIONS(&job->accumulating),
      {"gsd", CLI_NUMBER, &job->top.gsd, "G",
       "of --camera top: a pixel's edge on the ground, in the unit of the points [their typical distance]", 1e-12, 1e12,
       .is_given = &job->top.is_given, .group = "maps (--camera top)"},
      {"box", CLI_PARSED, &job->top.box, "X0,Y0,Z0,X1,Y1,Z1",
       "of --camera top: the part of the ground that is drawn; X0,Y0,X1,Y1 for all heights [all]",
       .parse = cli_cut_parse_box, .is_given = &job->top.is_given},
      {"epsg", CLI_INT, &job->top.epsg, "CODE",
       "of --camera top: the coordinate system that is noted in a .tif, by its EPSG code [the file's]", 1, 65535,
       .is_given = &job->top.is_given},
      {"boxes", CLI_TEXT, &job->boxes_path, "OUT.png",
       "of a .cot, the nodes of one level in false colours, with their boxes",
       .group = "pictures of what it was drawn from"},
      {"box-level", CLI_INT, &job->box_level, "N",
       "the level that --boxes shows; 0 is the root [the deepest of at most 64 nodes]", 0, 127},
      {"clusters", CLI_TEXT, &job->clusters_path, "OUT.png", "of a .chy, each patch in a colour of its own"},
      {"progressive", CLI_TEXT, &job->progressive_path, "DIR",
       "of a cloud in levels, also a picture after each level that has been read: DIR/0001.exr …",
       .group = "clouds in levels (.lpc, COPC, EPT, Potree 2)"},
      {"deadline", CLI_NUMBER, &job->deadline, "S",
       "of a cloud in levels, no more is read after so many seconds; what is missing is drawn coarser", 0.001, 1e6},
      {"tolerate", CLI_FLAG, &job->shot.view.tolerates_damage, NULL,
       "of a cloud in levels, what is damaged or does not come is drawn coarser, with a warning",
       .is_given = &is_given[0]},
      {"memory", CLI_INT, &memory_mib, "MiB",
       "of a cloud in levels, what its clouds, splats and pixels may take in memory [512]; of a .chy, what is read and "
       "drawn [all]; of all else, twice what the pixels of an .exr may [2048]",
       1, 1 << 20, .is_given = &job->is_memory_given},
      {"occlusion", CLI_CHOICE, &occlusion, "HOW",
       "of a cloud in levels, do not read what is hidden behind the rest: auto, on or off; changes no bit of the "
       "picture [auto]",
       .choices = occlusion_words, .is_given = &is_given[0]},
      {"timeout", CLI_NUMBER, &job->access.stall_seconds, "S",
       "of a URL, a server that is silent for so long is asked again, up to 4 times [15]", 1, 3600,
       .is_given = &is_given[1]},
      {"ao", CLI_INT, &job->n_directions, "N",
       "light from all around falls only where nothing hides it, as so many directions tell: 64 look smooth, 1024 are "
       "exact",
       1, 65536, .group = "shadow and transparency"},
      {"shadow", CLI_FLAG, &job->has_shadows, NULL, "the lights cast shadows, but for those at your eye"},
      {"transparency", CLI_FLAG, &job->is_transparent, NULL,
       "splats let light through as their opacity says, and meshes as the alpha of their materials and pictures"},
      {"repeat", CLI_INT, &job->repeat, "N", "draw N times and report the median of the times [1]", 1, 100000,
       .group = "measuring"},
  };
  int answer = cli_scene_parse(session, own, (int)(sizeof own / sizeof own[0]), argc, argv, job);
  if (answer == CLI_AGAIN)
    return cli_shot_again_parse(session, argc, argv, job);
  job->writing.compression = (conic_compression)compression;
  job->asked_planes = job->is_aov_given ? job->shot.planes : 0;
  if (job->is_memory_given)
    job->access.memory_bytes = (uint64_t)memory_mib << 20;
  if (memory_mib < USUAL_MIB && !session->host)
    cli_shell_give_back_memory();
  job->access.connect_seconds = job->access.stall_seconds;
  job->shot.view.occlusion = (conic_occlusion)occlusion;
  job->shot.view.may_be_coarser = job->progressive_path || job->deadline > 0.0 || job->shot.view.tolerates_damage;
  want_planes(job);
  if (job->overdraw_path)
    job->shot.planes |= 1u << CONIC_PLANE_COUNT;
  if (job->clusters_path)
    job->shot.planes |= 1u << CONIC_PLANE_CLUSTER | 1u << CONIC_PLANE_RGBA;
  if (job->boxes_path)
    job->shot.planes |= 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_ID;
  if (job->shot.planes & 1u << CONIC_PLANE_CLUSTER)
    job->shot.planes |= 1u << CONIC_PLANE_ID;
  if (job->has_mattes)
    job->shot.planes |= CONIC_MATTE_PLANES;
  return answer == CLI_DONE ? check_outputs(session, job, is_given) : answer;
}
