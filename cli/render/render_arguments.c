#include "cli/command.h"
#include "cli/render/fill_shot.h"
#include "cli/render/film.h"
#include "cli/render/kept_frames.h"
#include "cli/render/sample_options.h"
#include "cli/render/shot_again.h"
#include "cli/render/strip_pictures.h"
#include "cli/scene/light_options.h"
#include "cli/scene/scene_options.h"
#include "cli/scene/stereo.h"
#include "cli/shell.h"
#include "core/files/file.h"
#include "shots/shot_plan.h"

static const char *const overdraw_words[] = {"log", "confetti", NULL};
static const char *const show_words[] = {"overdraw:", "overdraw-confetti:", "clusters:", "boxes:", "legend", NULL};
static const char *const occlusion_words[] = {"auto", "on", "off", NULL};

/* OUT, or KIND:OUT of what has no ending. */
static int parse_output(const char *text, void *value) {
  cli_render_job *job = value;
  const size_t n_kind = strspn(text, "abcdefghijklmnopqrstuvwxyz");
  if (!*text || job->n_outputs == CLI_MAX_OUTPUTS)
    return 0;
  if (n_kind > 1 && n_kind < sizeof job->kind && text[n_kind] == ':' && text[n_kind + 1] &&
      !*conic_file_ending(text + n_kind + 1)) {
    snprintf(job->kind, sizeof job->kind, "%.*s", (int)n_kind, text);
    job->writing.format = job->kind;
    text += n_kind + 1;
  }
  job->outputs[job->n_outputs++] = text;
  return 1;
}

/* float or half, and a compression, joined by commas; into a conic_image_options. */
static int parse_exr(const char *text, void *value) {
  conic_image_options *writing = value;
  int is_known = 1;
  for (size_t length; is_known; text += length + 1) {
    length = strcspn(text, ",");
    is_known = 0;
    for (int i = -2; i < CONIC_N_COMPRESSIONS; i++) {
      const char *word = i < 0 ? (i == -2 ? "float" : "half") : conic_compression_name((conic_compression)i);
      if (strlen(word) != length || strncmp(word, text, length) != 0)
        continue;
      is_known = 1;
      if (i < 0)
        writing->is_half = i == -1;
      else
        writing->compression = (conic_compression)i;
    }
    if (!text[length])
      break;
  }
  return is_known;
}

/* WHAT:OUT, into a job. */
static int parse_show(const char *text, void *value) {
  cli_render_job *job = value;
  const struct {
    const char *word;
    const char **path;
  } shows[] = {{"overdraw", &job->overdraw_path},
               {"overdraw-confetti", &job->overdraw_path},
               {"clusters", &job->clusters_path},
               {"boxes", &job->boxes_path},
               {"legend", &job->legend_path}};
  enum { CONFETTI = 1, BOXES = 3, LEGEND = 4, N_SHOWS = 5, MOST_LEVEL = 127 };
  size_t length = strcspn(text, ":@");
  const char *colon = strchr(text, ':');
  unsigned long long level = 0;
  char digits[8] = "";
  int i = 0;
  while (i < N_SHOWS && (strlen(shows[i].word) != length || strncmp(shows[i].word, text, length) != 0))
    i++;
  if (i == LEGEND && !text[length])
    return job->has_legend = 1;
  if (i == N_SHOWS || !colon || !colon[1] || (text[length] == '@' && i != BOXES))
    return 0;
  if (text[length] == '@') {
    snprintf(digits, sizeof digits, "%.*s", (int)(colon - text - (ptrdiff_t)length - 1), text + length + 1);
    if (!cli_parse_count(digits, &level) || level > MOST_LEVEL)
      return 0;
    job->box_level = (int)level;
  }
  job->is_shown_twice |= *shows[i].path != NULL;
  *shows[i].path = colon + 1;
  if (i <= CONFETTI)
    job->is_overdraw_confetti = i == CONFETTI;
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

/* Everything that a frame writes; null: nothing. */
enum { N_PATHS = CLI_MAX_OUTPUTS + 6 };
static void list_frame_paths(const cli_render_job *job, const char *paths[N_PATHS]) {
  const char *const beside[] = {job->deep_path,   job->overdraw_path, job->clusters_path,
                                job->legend_path, job->boxes_path,    job->making.save_path};
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
static int check_outputs(const cli_session *session, cli_render_job *job, int is_colors_given) {
  const char *paths[N_PATHS];
  int answer = CLI_DONE;
  answer = cli_film_check(session, job);
  if (answer != CLI_DONE)
    return answer;
  if (!session->host && !job->film.path && job->n_outputs == 0 && !job->deep_path && !job->overdraw_path &&
      !job->clusters_path && !job->boxes_path && !job->progressive_path && !job->making.save_path)
    return cli_usage("render: no output; give one with -o OUT.exr, OUT.png, …");
  if (job->is_shown_twice)
    return cli_usage("render: --show writes each of overdraw, clusters, boxes and legend once; draw again for another");
  for (int i = 0; i < job->n_outputs && answer == CLI_DONE; i++)
    answer = check_output(job, job->outputs[i]);
  const char *const shown[] = {job->overdraw_path, job->clusters_path, job->boxes_path, job->legend_path};
  for (int i = 0; i < 4 && answer == CLI_DONE; i++)
    answer = shown[i] ? check_output(job, shown[i]) : CLI_DONE;
  if (answer != CLI_DONE)
    return answer;
  if (job->deep_path && !conic_file_has_ending(job->deep_path, "exr"))
    return cli_usage("%s: a deep image is an .exr", job->deep_path);
  if ((is_colors_given && !job->overdraw_path) || (job->box_level >= 0 && !job->boxes_path))
    return cli_usage(
        "render: colours of overdraw and a level of boxes are of --show overdraw-confetti:OUT and boxes@N:OUT");
  if (answer == CLI_DONE && job->top.is_wanted)
    answer = cli_top_check(session, job);
  if (answer == CLI_DONE)
    answer = cli_kept_frames_check(session, job);
  if (answer == CLI_DONE)
    answer = cli_memory_check(session, job);
  if (answer == CLI_DONE)
    answer = cli_accumulate_check(session, job);
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
  job->is_for_looking = 1;
  job->box_level = -1;
  conic_image_options_init(&job->writing);
  cli_shot_again_begin(session, job);
  const char *exr_words[CONIC_N_COMPRESSIONS + 3] = {"float", "half"}, **compression_words = exr_words + 2;
  for (int i = 0; i < CONIC_N_COMPRESSIONS; i++)
    compression_words[i] = conic_compression_name((conic_compression)i);
  const char *tone_words[CONIC_N_TONES + 1] = {NULL};
  for (int i = 0; i < CONIC_N_TONES; i++)
    tone_words[i] = conic_tone_name((conic_tone)i);
  int compression = -1;
  enum { USUAL_MIB = 512 };
  int memory_mib = USUAL_MIB, occlusion = CONIC_OCCLUSION_AUTO, is_colors_given = 0;
  const cli_option own[] = {
      {"o", CLI_PARSED, job, "OUT",
       "where the picture goes: .exr, .png, .tif, .jpg, .pfm …, or of several .mp4, .webm or .gif, a film by ffmpeg; - "
       "is standard output; exr:- and pfm:NAME say of what "
       "kind "
       "that is, or a name without an ending [png]; may be repeated",
       .parse = parse_output, .may_repeat = 1, .group = "output",
       .intro = "Where pictures go, and how they are written.", .is_usual = 1},
      {"exr", CLI_PARSED, &job->writing, "HOW",
       "numbers of an .exr: float, or half for rgba, N and albedo; and how it is compressed: zip, none, rle, zips, "
       "piz, "
       "or pxr24, which loses bits of floats, as in half,piz [float,zip]",
       .choices = exr_words, .parse = parse_exr, .acts = {.needs = CLI_FACT(EXR), .is_warned = 1}},
      {"tone", CLI_CHOICE, &job->tone, "NAME",
       "how files of 8 and 16 bits show what is brighter than white: srgb (as white), filmic (Hable's curve), aces "
       "(Hill's fit) or agx (Sobotka's); .exr, .pfm and .hdr stay linear [srgb]",
       .choices = tone_words,
       .acts = {.on = CLI_SURFACES, .needs = CLI_FACT(CODES), .apart = CLI_FACT(MAP), .is_warned = 1}},
      {"deep", CLI_TEXT, &job->deep_path, "OUT.exr",
       "every splat and triangle of every pixel, as a deep image: colour, depth, id, weight",
       .acts = {.apart = CLI_FACT(MAP)}},
      {"show", CLI_PARSED, job, "WHAT:OUT",
       "a picture of what was drawn: overdraw:OUT.png, how many splats each pixel blends (blue 1, red 4, yellow 16, "
       "white 64), or overdraw-confetti:OUT.png (blue 1, green 8, red 16); clusters:OUT.png, of a .chy each patch in a "
       "colour of its own; boxes:OUT.png, of a .cot or .lpc the nodes of a level with their boxes, boxes@3:OUT.png "
       "those of "
       "level 3 from the root; legend:OUT.png, what the colours mean, or legend, in the picture itself",
       .parse = parse_show, .may_repeat = 1, .choices = show_words},
      {"save-shot", CLI_TEXT, &job->making.save_path, "OUT.shot.json",
       "all that decides the picture, as text by which conic render draws it again"},
      {"no-shot", CLI_FLAG, &job->making.is_left_out, NULL,
       "leave out of .exr, .png and .tif what they say of how they were made",
       .acts = {.needs = CLI_FACT(TELLING), .is_warned = 1}},
      {"again", CLI_TEXT, &job->making.again_path, "PICTURE",
       "draw again what a picture says that it was drawn from, to the bit; other options change that. Inputs are "
       "looked "
       "for beside it, here, and among those that are given"},
      {"turntable", CLI_PARSED, job, "N",
       "N pictures around the scene: OUT.0001.exr …, or as OUT_%04d.exr or OUT_####.exr says",
       .parse = cli_parse_turntable, .group = "several pictures",
       .intro = "Turns around the scene, parts of them, and both eyes.", .is_usual = 1,
       .acts = {.apart = CLI_FACT(MAP)}},
      {"path", CLI_TEXT, &job->path_file, "FILE",
       "pictures along a camera's way, in place of --camera: through the keys of a .json, of which each has time (in "
       "seconds), place, target, roll and fov (degrees), or through the cameras of a file, one a second; OUT.0000.exr "
       "…",
       .is_usual = 1},
      {"fps", CLI_NUMBER, &job->fps, "N", "pictures of a second of --path, and of a film [25]", 0.001, 1000,
       .acts.with = "path|o=.mp4|o=.webm|o=.gif"},
      {"film", CLI_PARSED, &job->film, "BITS[:Q]",
       "how -o OUT.mp4 or OUT.webm codes colours: by 8 or 10 bits, and with the constant quality Q, 0 to 63, less is "
       "better [8:17; of .webm 8:24]",
       .parse = cli_parse_film, .acts.with = "o=.mp4|o=.webm"},
      {"frames", CLI_PARSED, &job->frames, "A:B:STEP",
       "only the frames A to B in steps of STEP, or A-BxSTEP; those of --turntable count from 1, those of --view all "
       "from 0 [all]",
       .parse = cli_parse_frames,
       .acts = {.needs = CLI_FACT(TURNTABLE) | CLI_FACT(EVERY_VIEW), .apart = CLI_FACT(MAP)}},
      {"resumable", CLI_FLAG, &job->accumulating.is_resumable, NULL,
       "keep beside the first OUT what is finished, so that --resume can go on after any end: frames in OUT.frames, of "
       "one --accumulate the sums in OUT.sums, and of one .exr larger than half of --memory the strips in OUT.strips "
       "and "
       "OUT.part",
       .acts.is_work = 1},
      {"resume", CLI_TEXT, &job->accumulating.resume_path, "OUT",
       "go on with what OUT.frames, OUT.sums or OUT.strips says is finished, to the bit as if it had never stopped; "
       "with "
       "--resumable, too, where there is none begin",
       .acts.is_work = 1},
      {"stereo", CLI_NUMBER, &job->stereo.distance, "E",
       "two pictures, of eyes that are E apart, in world units: OUT.left.exr and OUT.right.exr, or left and right in "
       "the "
       "place of %V [one]",
       0, 1e29, .parse_tail = cli_parse_convergence, .tail = &job->stereo},
      {"accumulate", CLI_COUNT, &job->accumulating.n_samples, "N",
       "the mean of N whole pictures, each with its own place in the pixel, point on the lens and moment [none: drawn "
       "at once]",
       1, CONIC_MAX_ACCUMULATED, .group = "final pictures (--accumulate)",
       .intro = "The best that there is: lenses, motion and soft shadows, by many samples."},
      {"time", CLI_NUMBER, &job->accumulating.seconds, "S", "no sample is begun after S seconds [no limit]", 1e-3, 1e9,
       .acts = {.needs = CLI_FACT(ACCUMULATED), .is_work = 1}},
      {"noise", CLI_NUMBER, &job->accumulating.noise, "E",
       "16, 32, 64 … samples are enough when their two halves say that the picture is E from its end, in luminance "
       "[none]",
       1e-9, 1e9, .acts = {.needs = CLI_FACT(ACCUMULATED)}},
      {"preview", CLI_NUMBER, &job->accumulating.preview_seconds, "S",
       "write the picture as it is every S seconds, too [only at the end]", 1e-3, 1e9,
       .acts = {.needs = CLI_FACT(ACCUMULATED), .is_work = 1}},
      CLI_LENS_OPTIONS(&job->accumulating),
      {"box", CLI_PARSED, &job->top.box, "X0,Y0,Z0,X1,Y1,Z1",
       "of --camera top: the part of the ground that is drawn; X0,Y0,X1,Y1 for all heights [all]",
       .parse = cli_cut_parse_box, .group = "maps (--camera top)",
       .intro = "Orthophotos and heights, where they lie on the earth.", .acts = {.needs = CLI_FACT(MAP)}},
      {"progressive", CLI_TEXT, &job->progressive_path, "DIR",
       "of a cloud in levels, also a picture after each level that has been read: DIR/0001.exr …",
       .group = "clouds in levels (.lpc, COPC, EPT, Potree 2)",
       .intro = "What is read while it is drawn, from disks and the web.",
       .acts = {.on = CLI_FACT(LEVELS), .apart = CLI_FACT(MAP)}},
      {"deadline", CLI_NUMBER, &job->deadline, "S",
       "of a cloud in levels, no more is read after so many seconds; what is missing is drawn coarser", 0.001, 1e6,
       .acts = {.on = CLI_FACT(LEVELS), .apart = CLI_FACT(MAP), .is_work = 1}},
      {"tolerate", CLI_FLAG, &job->shot.view.tolerates_damage, NULL,
       "of a cloud in levels, what is damaged or does not come is drawn coarser, with a warning",
       .acts = {.on = CLI_FACT(LEVELS), .apart = CLI_FACT(MAP), .is_work = 1}},
      {"memory", CLI_INT, &memory_mib, "MiB",
       "of a cloud in levels, what its clouds, splats and pixels may take in memory [512]; of a .chy, what is read and "
       "drawn [all]; of all else, twice what the pixels of one .exr may, if it is all that is written and has no --ao, "
       "--shadow, lamps or --accumulate [2048]",
       1, 1 << 20, .is_given = &job->is_memory_given, .acts.is_work = 1},
      {"occlusion", CLI_CHOICE, &occlusion, "HOW",
       "of a cloud in levels, do not read what is hidden behind the rest: auto, on or off; changes no bit of the "
       "picture [auto]",
       .choices = occlusion_words, .acts = {.on = CLI_FACT(LEVELS), .is_work = 1}},
      {"timeout", CLI_NUMBER, &job->access.stall_seconds, "S",
       "of a URL, a server that is silent for so long is asked again, up to 4 times [15]", 1, 3600,
       .acts = {.on = CLI_FACT(LEVELS) | CLI_FACT(HYBRID), .is_work = 1}},
      CLI_HIDDEN_LIGHT(job),
      {"matte-by", CLI_TEXT, &job->matte_by, "PROPERTY",
       "of Gaussian scenes, a matte for each value of a property of their .ply, as FILE/VALUE [one for each input]",
       .acts = {.on = CLI_FACT(COMPOSITED), .needs = CLI_FACT(MATTES)}},
      {"transparency", CLI_FLAG, &job->is_transparent, NULL,
       "splats let light through as their opacity says, and meshes as the alpha of their materials and pictures",
       .acts = {.on = CLI_FACT(ALPHA), .is_warned = 1}},
      {"catcher", CLI_PARSED, job, "INPUT", "of an input only the shadows that fall on it: black, and A says how dark",
       .parse = cli_parse_catcher, .may_repeat = 1,
       .acts = {.on = CLI_SURFACES, .needs = CLI_FACT(MASKED), .apart = CLI_FACT(MAP) | CLI_FACT(DEEP)}},
      {"holdout", CLI_PARSED, job, "INPUT", "an input hides what is behind it, and is not seen itself",
       .parse = cli_parse_holdout, .may_repeat = 1,
       .acts = {.on = CLI_SURFACES, .apart = CLI_FACT(MAP) | CLI_FACT(DEEP)}},
      {"repeat", CLI_INT, &job->repeat, "N", "draw N times and report the median of the times [1]", 1, 100000,
       .group = "measuring", .intro = "How fast it is.", .acts = {.apart = CLI_FACT(MAP), .is_work = 1}},
      /* Old spellings. */
      {"format", CLI_TEXT, &job->writing.format, "NAME", "a kind of file", .now = "-o NAME:OUT"},
      {"gsd", CLI_NUMBER, &job->top.gsd, "G", "of a map", 1e-12, 1e12, .now = "--camera top:G"},
      {"epsg", CLI_INT, &job->top.epsg, "CODE", "of a map", 1, 65535, .now = "--camera top:GSD:CODE"},
      {"compression", CLI_CHOICE, &compression, "NAME", "of an .exr", .choices = compression_words,
       .now = "--exr zip, or with a type, --exr half,zip", .acts = {.needs = CLI_FACT(EXR), .is_warned = 1}},
      {"overdraw", CLI_TEXT, &job->overdraw_path, "OUT", "a file", .now = "--show overdraw:OUT"},
      {"overdraw-colors", CLI_CHOICE, &job->is_overdraw_confetti, "NAME", "its colours", .choices = overdraw_words,
       .is_given = &is_colors_given, .now = "--show overdraw-confetti:OUT"},
      {"legend", CLI_FLAG, &job->has_legend, NULL, "in the picture", .now = "--show legend"},
      {"legend-out", CLI_TEXT, &job->legend_path, "OUT", "a file", .now = "--show legend:OUT"},
      {"cryptomatte", CLI_FLAG, &job->has_mattes, NULL, "mattes", .now = "--aov cryptomatte"},
      {"convergence", CLI_NUMBER, &job->stereo.convergence, "Z", "of two eyes", 0, 1e29,
       .is_given = &job->stereo.is_convergence_given, .now = "--stereo E:Z"},
      {"boxes", CLI_TEXT, &job->boxes_path, "OUT", "a file", .now = "--show boxes:OUT"},
      {"box-level", CLI_INT, &job->box_level, "N", "a level", 0, 127, .now = "--show boxes@N:OUT"},
      {"clusters", CLI_TEXT, &job->clusters_path, "OUT", "a file", .now = "--show clusters:OUT"},
  };
  int answer = cli_scene_parse(session, own, (int)(sizeof own / sizeof own[0]), argc, argv, job);
  if (answer == CLI_AGAIN)
    return cli_shot_again_parse(session, argc, argv, cli_render_parse, job);
  if (compression >= 0)
    job->writing.compression = (conic_compression)compression;
  job->asked_planes = job->is_aov_given ? job->shot.planes : 0;
  cli_transparency_settle(job);
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
  return answer == CLI_DONE ? check_outputs(session, job, is_colors_given) : answer;
}
