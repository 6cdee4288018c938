/* From the lists on the command line to the lines that are measured. */

#include "bench/bench_job.h"
#include "cli/arguments.h"
#include "core/base/nearest_word.h"
#include "core/lanes/instruction_sets.h"

static const char default_scenes[] =
    "sphere-100k,sphere-1M,sphere-4M,gyroid-1M,mixed,subpixel,needles,huge,gaussians-1M";
static const char published_scenes[] = "sphere-1M,sphere-4M,gyroid-1M,mixed,gaussians-1M";
static const char published_methods[] = "conic,auto,nearest";
static const char quick_scenes[] = "sphere-100k,sphere-1M,mixed";
/* The scene on which, where nothing was asked for, all methods and instruction sets are measured. */
static const char main_scene[] = "sphere-1M";

/* Calls `take` with each word of "a,b,c". Returns the first exit code that is not 0. */
typedef int take_word(cli_bench_job *job, const char *word);

static int for_words(cli_bench_job *job, const char *option, const char *text, take_word *take) {
  int exit_code = CLI_DONE;
  for (const char *next = text; exit_code == CLI_DONE; next++) {
    char word[32];
    size_t length = strcspn(next, ",");
    if (length == 0 || length >= sizeof word)
      return cli_usage("bench: --%s: \"%s\" is no list of names", option, text);
    snprintf(word, sizeof word, "%.*s", (int)length, next);
    exit_code = take(job, word);
    next += length;
    if (!*next)
      break;
  }
  return exit_code;
}

/* --- words --- */

static int take_scene(cli_bench_job *job, const char *word) {
  if (strcmp(word, "all") == 0)
    return for_words(job, "scenes", default_scenes, take_scene);
  if (job->n_scenes == CLI_BENCH_MOST_SCENES)
    return cli_usage("bench: over %d scenes", CLI_BENCH_MOST_SCENES);
  int exit_code = cli_bench_scene_check(word, &job->is_gaussian[job->n_scenes]);
  if (exit_code != CLI_DONE)
    return exit_code;
  char *name = job->scene_names[job->n_scenes];
  snprintf(name, sizeof job->scene_names[0], "%s", word);
  job->scenes[job->n_scenes++] = name;
  return CLI_DONE;
}

static int take_file(cli_bench_job *job, const char *path) {
  if (job->n_scenes == CLI_BENCH_MOST_SCENES)
    return cli_usage("bench: over %d scenes", CLI_BENCH_MOST_SCENES);
  job->is_file[job->n_scenes] = 1;
  job->is_gaussian[job->n_scenes] = cli_bench_is_gaussian_file(path);
  job->chooses[job->n_scenes] =
      !job->is_gaussian[job->n_scenes] && cli_bench_file_chooses(path, job->errors_text != NULL);
  job->scenes[job->n_scenes++] = path;
  return CLI_DONE;
}

/* Appends those of the methods and profiles `first` … end - 1 that the word names, each once. */
static int take_named(const char *word, int first, int end, int *list, int *n, const char *what, const char *hint) {
  const char *nearest = NULL;
  int is_known = 0;
  for (int i = first; i < end; i++) {
    int is_it = strcmp(word, "all") == 0 || strcmp(word, cli_bench_method_name(i)) == 0, k = 0;
    while (k < *n && list[k] != i)
      k++;
    if (is_it && k == *n)
      list[(*n)++] = i;
    is_known |= is_it;
    nearest = conic_nearer_word(word, nearest, cli_bench_method_name(i));
  }
  if (is_known)
    return CLI_DONE;
  return nearest ? cli_usage("bench: unknown %s %s; did you mean %s?", what, word, nearest)
                 : cli_usage("bench: unknown %s %s; %s", what, word, hint);
}

static int take_method(cli_bench_job *job, const char *word) {
  return take_named(word, 0, CLI_BENCH_N_METHODS, job->methods, &job->n_methods, "method",
                    "there are conic, ray, affine, point, disc, auto, nearest");
}

static int take_profile(cli_bench_job *job, const char *word) {
  return take_named(word, CLI_BENCH_N_METHODS, CLI_BENCH_N_METHODS + CONIC_N_GAUSSIAN_PROFILES, job->profiles,
                    &job->n_profiles, "profile", "see conic help render");
}

static void add_isa(cli_bench_job *job, conic_isa isa) {
  if (isa == CONIC_ISA_AUTO)
    isa = conic_isa_best();
  for (int i = 0; i < job->n_isas; i++)
    if (job->isas[i] == isa)
      return;
  job->isas[job->n_isas++] = isa;
}

static int take_isa(cli_bench_job *job, const char *word) {
  if (strcmp(word, "all") == 0) {
    for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++)
      if (conic_isa_is_here((conic_isa)isa))
        add_isa(job, (conic_isa)isa);
    return CLI_DONE;
  }
  for (int isa = CONIC_ISA_AUTO; isa < CONIC_N_ISAS; isa++)
    if (strcmp(word, conic_isa_name((conic_isa)isa)) == 0) {
      if (!conic_isa_is_here((conic_isa)isa))
        return cli_error(CLI_RESOURCE, "bench: this machine or build has no %s", word);
      add_isa(job, (conic_isa)isa);
      return CLI_DONE;
    }
  return cli_usage("bench: unknown instruction set %s; there are auto, all, scalar, sse2, avx2, avx512, neon", word);
}

static int take_number_of_threads(const char *option, const char *word, unsigned least, int *numbers, int *n_numbers) {
  unsigned long long n;
  if (!cli_parse_count(word, &n) || n < least || n > 1024)
    return cli_usage("bench: --%s: %s is no number from %u to 1024", option, word, least);
  if (*n_numbers == CLI_BENCH_MOST_THREADS)
    return cli_usage("bench: --%s: over %d numbers", option, CLI_BENCH_MOST_THREADS);
  numbers[(*n_numbers)++] = (int)n;
  return CLI_DONE;
}

static int take_threads(cli_bench_job *job, const char *word) {
  return take_number_of_threads("threads", word, 0, job->threads, &job->n_threads);
}

static int take_simulated(cli_bench_job *job, const char *word) {
  return take_number_of_threads("simulate-threads", word, 2, job->simulated, &job->n_simulated);
}

static int take_error(cli_bench_job *job, const char *word) {
  double error;
  if (!cli_parse_number(word, &error) || error < 0.0)
    return cli_usage("bench: --error: %s is no error in pixels", word);
  if (job->n_errors == CLI_BENCH_MOST_THREADS)
    return cli_usage("bench: --error: over %d numbers", CLI_BENCH_MOST_THREADS);
  job->errors[job->n_errors++] = error;
  return CLI_DONE;
}

/* --- lines --- */

static int append_line(cli_bench_job *job, int i_scene, int i_method, conic_isa isa, int threads, const int size[2]) {
  if ((job->n_lines & (job->n_lines - 1)) == 0) { /* the room is the next power of two */
    size_t room = job->n_lines ? 2 * (size_t)job->n_lines : 1;
    cli_bench_line *lines = realloc(job->lines, room * sizeof *lines);
    if (!lines)
      return cli_error(CLI_RESOURCE, "bench: out of memory");
    job->lines = lines;
  }
  cli_bench_line *line = &job->lines[job->n_lines++];
  memset(line, 0, sizeof *line);
  line->i_scene = i_scene;
  line->i_method = i_method;
  line->isa = isa;
  line->threads = threads;
  line->width = size[0];
  line->height = size[1];
  line->i_wrong_plane = -1;
  line->chooses = job->chooses[i_scene];
  line->n_turns = job->n_turns;
  for (int i = 0; i <= CLI_BENCH_N_STAGES; i++)
    line->old_ms[i] = (double)NAN;
  line->old_quartile_ms[0] = line->old_quartile_ms[1] = (double)NAN;
  return CLI_DONE;
}

/* The same by --device, beside what this machine's processor does. */
static int append_device_line(cli_bench_job *job, int i_scene, int i_method, const int size[2]) {
  int exit_code = append_line(job, i_scene, i_method, CONIC_ISA_AUTO, job->threads[job->n_threads - 1], size);
  if (exit_code == CLI_DONE)
    job->lines[job->n_lines - 1].device = &job->device;
  return exit_code;
}

/* A line an error of what chooses, and else one. */
static int append_errors(cli_bench_job *job, int i_scene, int i_method, conic_isa isa, int threads, const int size[2]) {
  int exit_code = CLI_DONE;
  for (int e = 0; e < (job->chooses[i_scene] ? job->n_errors : 1) && exit_code == CLI_DONE; e++) {
    exit_code = append_line(job, i_scene, i_method, isa, threads, size);
    if (exit_code == CLI_DONE && job->chooses[i_scene])
      job->lines[job->n_lines - 1].error_px = job->errors[e];
  }
  return exit_code;
}

/* A scene with every combination of the lists. Devices do not draw Gaussians. */
static int append_scene(cli_bench_job *job, int i_scene, const int size[2]) {
  const int is_gaussian = job->is_gaussian[i_scene], *methods = is_gaussian ? job->profiles : job->methods;
  int exit_code = CLI_DONE;
  for (int m = 0; m < (is_gaussian ? job->n_profiles : job->n_methods); m++) {
    for (int i = 0; i < job->n_isas; i++)
      for (int t = 0; t < job->n_threads && exit_code == CLI_DONE; t++)
        exit_code = append_errors(job, i_scene, methods[m], job->isas[i], job->threads[t], size);
    if (exit_code == CLI_DONE && !is_gaussian && strcmp(job->device.name, "cpu") != 0)
      exit_code = append_device_line(job, i_scene, methods[m], size);
  }
  return exit_code;
}

/* Where nothing was asked for: every scene by conic and the widest vectors, and one scene by everything. */
static int append_star(cli_bench_job *job) {
  int exit_code = CLI_DONE;
  for (int s = 0; s < job->n_scenes && exit_code == CLI_DONE; s++) {
    int is_main = !job->is_quick && strcmp(job->scenes[s], main_scene) == 0;
    job->n_methods = job->n_isas = 0;
    take_method(job, is_main ? "all" : "conic");
    take_isa(job, is_main ? "all" : "auto");
    exit_code = append_scene(job, s, job->size);
  }
  return exit_code;
}

static int check_turntable(const cli_bench_job *job) {
  for (int s = 0; s < job->n_scenes && job->n_turns; s++)
    if (job->is_gaussian[s])
      return cli_usage("bench: --turntable: %s is of Gaussians, which it does not turn", job->scenes[s]);
  return CLI_DONE;
}

static int append_product(cli_bench_job *job) {
  int exit_code = CLI_DONE;
  for (int s = 0; s < job->n_scenes && exit_code == CLI_DONE; s++)
    exit_code = append_scene(job, s, job->size);
  return exit_code;
}

/* Spheres of 10 k to 16 M splats, and a million of them from 256² to 8192²; less where it is quick. The last scene is
 * the one that is drawn in all sizes. */
static int append_curve(cli_bench_job *job) {
  static const int sizes[] = {256, 512, 1024, 2048, 4096, 8192};
  static const char whole[] =
      "sphere-10k,sphere-40k,sphere-160k,sphere-640k,sphere-2500k,sphere-10M,sphere-16M,sphere-1M";
  static const char quick[] = "sphere-1k,sphere-10k,sphere-100k,sphere-100k";
  int exit_code = for_words(job, "scenes", job->is_quick ? quick : whole, take_scene);
  int n_sizes = job->is_quick ? 3 : (int)(sizeof sizes / sizeof *sizes), i_sized = job->n_scenes - 1;
  for (int s = 0; s < i_sized && exit_code == CLI_DONE; s++)
    exit_code = append_scene(job, s, job->size);
  for (int i = 0; i < n_sizes && exit_code == CLI_DONE; i++)
    exit_code = append_scene(job, i_sized, (int[2]){sizes[i], sizes[i]});
  return exit_code;
}

static int take_lists(cli_bench_job *job) {
  const char *scenes = job->scenes_text;
  int exit_code = for_words(job, "error", job->errors_text ? job->errors_text : "0", take_error);
  for (int i = 0; i < job->n_files && exit_code == CLI_DONE; i++)
    exit_code = take_file(job, job->files[i]);
  if (!scenes && !job->n_files && !job->is_curve)
    scenes = job->is_floor                        ? main_scene
             : job->is_quick                      ? quick_scenes
             : job->methods_text || job->isa_text ? main_scene
                                                  : default_scenes;
  if (scenes && exit_code == CLI_DONE)
    exit_code = for_words(job, "scenes", scenes, take_scene);
  if (exit_code == CLI_DONE)
    exit_code = for_words(job, "methods", job->methods_text ? job->methods_text : "conic", take_method);
  if (exit_code == CLI_DONE)
    exit_code = for_words(job, "profiles", job->profiles_text ? job->profiles_text : "gsplat-1.6,exact", take_profile);
  if (exit_code == CLI_DONE)
    exit_code = for_words(job, "isa", job->isa_text ? job->isa_text : "auto", take_isa);
  if (exit_code == CLI_DONE)
    exit_code = for_words(job, "threads",
                          job->threads_text ? job->threads_text
                          : job->is_curve   ? "0"
                                            : "1,0",
                          take_threads);
  if (exit_code == CLI_DONE && job->simulated_text)
    exit_code = for_words(job, "simulate-threads", job->simulated_text, take_simulated);
  return exit_code;
}

/* The lines that machines are compared by. */
static void plan_publication(cli_bench_job *job) {
  job->is_machine = 1;
  job->scenes_text = job->scenes_text ? job->scenes_text : published_scenes;
  job->methods_text = job->methods_text ? job->methods_text : published_methods;
}

int cli_bench_plan(cli_bench_job *job) {
  if (job->publish_path)
    plan_publication(job);
  int is_star = !job->scenes_text && !job->methods_text && !job->isa_text && !job->n_files && !job->is_floor;
  int exit_code = take_lists(job);
  if (exit_code == CLI_DONE)
    exit_code = check_turntable(job);
  if (exit_code != CLI_DONE || (job->is_machine && !job->is_floor && !job->publish_path))
    return exit_code;
  return job->is_curve ? append_curve(job) : is_star ? append_star(job) : append_product(job);
}
