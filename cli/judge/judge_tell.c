/* The verdict, in words and as JSON. */

#include "cli/commands/gaussian_commands.h"
#include "cli/commands/verify_reference.h"
#include "cli/judge/judge_job.h"

int cli_judge_is_right(const cli_judge_job *job) {
  return job->found.pixels[CONIC_PIXEL_WRONG] <= job->max_wrong;
}

int cli_judge_is_undecided(const cli_judge_job *job) {
  return cli_judge_is_right(job) && !job->allows_vague && job->found.vague > job->found.judged / 100;
}

static const char *const stage_names[CLI_JUDGE_N_STAGES] = {"read", "open", "judge", "explain", "diagnose", "show"};

static const char *channel_name(const conic_oracle_fault *fault) {
  return conic_plane_describe((conic_plane)fault->plane)->channels[fault->channel];
}

/* Among ids, "nothing" is a value, too. */
static void spell_value(const conic_oracle_fault *fault, double value, char text[32]) {
  int is_name = fault->plane == CONIC_PLANE_ID || fault->plane == CONIC_PLANE_LAST;
  if (is_name && value == (double)CONIC_NO_ID)
    snprintf(text, 32, "nothing");
  else
    snprintf(text, 32, "%.9g", value);
}

void cli_judge_describe(const cli_judge_job *job, const conic_oracle_fault *fault, char *text, size_t room) {
  char found[32], low[32], high[32];
  const char *bound = "";
  spell_value(fault, fault->found, found);
  spell_value(fault, fault->low, low);
  spell_value(fault, fault->high, high);
  if (job->picture.most_code && fault->plane == CONIC_PLANE_RGBA && fault->found == fault->found)
    bound = fault->found < fault->low ? " at most" : " at least";
  if (fault->high > fault->low)
    snprintf(text, room, "%s is%s %s; it may be %s to %s", channel_name(fault), bound, found, low, high);
  else
    snprintf(text, room, "%s is%s %s; it may be %s", channel_name(fault), bound, found, low);
}

void cli_judge_describe_part(const cli_judge_part *p, char *text, size_t room) {
  int n = snprintf(text, room, "%s %lu: weight %.4g", p->kind, (unsigned long)p->index, p->weight);
  if (p->alpha > 0.0 && n < (int)room)
    n += snprintf(text + n, room - (size_t)n, ", alpha %.6g", p->alpha);
  if (n < (int)room)
    n += snprintf(text + n, room - (size_t)n, ", depth %.5g, colour %.3g %.3g %.3g", p->depth, p->color[0], p->color[1],
                  p->color[2]);
  if (p->doubt && n < (int)room)
    snprintf(text + n, room - (size_t)n, ", in doubt: %s", p->doubt);
}

/* The number of worst pixels that are printed; JSON and the report have them all. */
enum { MOST_PRINTED = 4 };

static void print_worst(const cli_judge_job *job) {
  char text[256];
  for (int k = 0; k < job->found.n_worst && k < MOST_PRINTED; k++) {
    const cli_judge_worst *w = &job->found.worst[k];
    cli_judge_describe(job, &w->fault, text, sizeof text);
    printf("worst     pixel %d,%d: %s\n", w->fault.x, w->fault.y, text);
    for (int i = 0; i < w->n_parts; i++) {
      cli_judge_describe_part(&w->parts[i], text, sizeof text);
      printf("          %s\n", text);
    }
    if (w->n_blended > (size_t)w->n_parts)
      printf("          and %zu more\n", w->n_blended - (size_t)w->n_parts);
  }
}

static void print_explained(const cli_judgement *found) {
  const char *separator = "explained by ";
  for (int k = 0; k < CLI_JUDGE_MOST_REASONS && found->reasons[k]; k++)
    if (found->explained_by[k]) {
      printf("%s%s %zu", separator, found->reasons[k], found->explained_by[k]);
      separator = ", ";
    }
  if (*separator == ',')
    putchar('\n');
}

static void print_diagnosis(int k, const conic_diagnosis *d) {
  const char *meaning = conic_diagnosis_meaning(d->name);
  printf("%s %s%s%s %s away %.4g %% of the difference",
         k               ? "         "
         : d->is_nearest ? "nearest  "
                         : "diagnosis",
         d->name, d->with ? " with " : "", d->with ? d->with : "", d->with ? "take" : "takes", 100.0 * d->share);
  if (d->is_nearest)
    printf(", but makes only %lu wrong pixels right, and %lu right ones wrong", (unsigned long)d->righted,
           (unsigned long)d->spoilt);
  printf(": %s\n", meaning ? meaning : "");
}

void cli_judge_describe_place(const conic_fault_place *p, char *text, size_t room) {
  const char *state = p->is_constant ? "has one colour" : "is wrong";
  const int is_column = strcmp(p->kind, "column") == 0;
  if (strcmp(p->kind, "nan") == 0)
    snprintf(text, room, "%zu pixels are NaN or infinite, the first at %d,%d", p->pixels, p->at[0], p->at[1]);
  else if (strcmp(p->kind, "plane") == 0 || strcmp(p->kind, "channel") == 0)
    snprintf(text, room, "only the %s %s is wrong, in %zu pixels; all else is right", p->kind, p->what, p->pixels);
  else if (strcmp(p->kind, "tile") == 0)
    snprintf(text, room, "the %d x %d tile at %d, %d %s; all else is right", p->size, p->size, p->at[0], p->at[1],
             state);
  else if (strcmp(p->kind, "row") == 0 || strcmp(p->kind, "column") == 0)
    snprintf(text, room, "%s %d, of %d pixels each, %s; all else is right", p->kind, p->at[!is_column], p->size, state);
  else if (strcmp(p->kind, "every") == 0)
    snprintf(text, room, "every %s of %d from %d on %s; all else is right", p->what, p->size, p->at[0] + p->at[1],
             state);
  else if (strcmp(p->kind, "checkerboard") == 0)
    snprintf(text, room, "every other pixel, as on a checkerboard, %s; all else is right", state);
  else
    snprintf(text, room, "the %s%s, %d pixels wide, %s; all else is right", p->what,
             strcmp(p->kind, "half") == 0 ? " part" : " border", p->size, state);
}

/* Whether a mistake has been named. */
static int is_diagnosed(const cli_judgement *found) {
  return found->n_faults > 0 && !found->faults[0].is_nearest;
}

static void print_vague(const cli_judge_job *job) {
  const cli_judgement *found = &job->found;
  printf("vague     %zu pixels may be anything within more than 1/255", found->vague);
  for (int k = 0; k < found->vaguest.n_parts; k++)
    printf("%s %lu", k ? "," : ", most of all by Gaussians", (unsigned long)found->vaguest.parts[k].index);
  puts(cli_judge_is_undecided(job) ? "; --allow-vague takes that for right" : "");
}

void cli_judge_print(const cli_judge_job *job) {
  const cli_judgement *found = &job->found;
  int is_composited = cli_is_composited(&job->scene);
  printf("%s: %zu of %zu judged pixels are wrong",
         cli_judge_is_undecided(job) ? "UNDECIDED"
         : cli_judge_is_right(job)   ? "right"
                                     : "WRONG",
         found->pixels[CONIC_PIXEL_WRONG], found->judged);
  if (found->judged < found->n_whole)
    printf(" (the picture has %zu)", found->n_whole);
  printf("\nby %s %s, %s floats, %d x %d samples a pixel", is_composited ? "the profile" : "the method",
         is_composited ? conic_gaussian_profile_name(job->scene.shot.gaussians.profile) : cli_method_name(&job->scene),
         cli_float_words[job->floats], job->scene.shot.view.samples, job->scene.shot.view.samples);
  printf("\n%zu equal, %zu within rounding, %zu explained, %zu wrong\n", found->pixels[CONIC_PIXEL_EQUAL],
         found->pixels[CONIC_PIXEL_ROUNDED], found->pixels[CONIC_PIXEL_EXPLAINED], found->pixels[CONIC_PIXEL_WRONG]);
  print_explained(found);
  if (found->vague)
    print_vague(job);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (found->planes[i].is_compared)
      printf("%-9s max %.4g\n", conic_plane_describe((conic_plane)i)->name, found->planes[i].max_abs);
  if (job->picture.is_alpha_dropped)
    puts("alpha is full everywhere, and is not judged");
  for (int k = 0; k < found->n_places; k++) {
    char text[192];
    cli_judge_describe_place(&found->places[k], text, sizeof text);
    printf("where     %s\n", text);
  }
  if (found->is_blank)
    puts("diagnosis the picture is blank: does its camera look at the scene, along z?");
  else if (!is_diagnosed(found) && !cli_judge_is_right(job) && !job->skips_diagnosis)
    puts("diagnosis no known mistake explains the wrong pixels");
  for (int k = 0; k < found->n_faults; k++)
    print_diagnosis(k, &found->faults[k]);
  print_worst(job);
  for (int k = 0; k < CLI_JUDGE_N_STAGES && job->shows_times; k++)
    printf("%-9s %.2f s\n", stage_names[k], job->seconds[k]);
}

static void write_picture(cli_json *json, const cli_judge_job *job) {
  cli_json_object(json, "picture");
  cli_json_counts(json, NULL, {"width", (uint64_t)job->camera.width}, {"height", (uint64_t)job->camera.height},
                  {"bits", job->picture.most_code == 255 ? 8
                           : job->picture.most_code      ? 16
                                                         : 32});
  cli_json_bool(json, "has_alpha", !job->picture.image.lacks_alpha);
  cli_json_close(json);
  cli_json_object(json, "planes");
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (job->found.planes[i].is_compared) {
      cli_json_figures(json, conic_plane_describe((conic_plane)i)->name, {"max_abs", job->found.planes[i].max_abs});
    }
  cli_json_close(json);
}

static void write_part(cli_json *json, const cli_judge_part *p) {
  cli_json_object(json, NULL);
  cli_json_count(json, p->kind, p->index);
  cli_json_number(json, "weight", p->weight);
  if (p->alpha > 0.0)
    cli_json_number(json, "alpha", p->alpha);
  cli_json_number(json, "depth", p->depth);
  cli_json_numbers(json, "color", p->color, 3);
  if (p->doubt)
    cli_json_text(json, "doubt", p->doubt);
  cli_json_close(json);
}

static void write_worst(cli_json *json, const cli_judgement *found) {
  cli_json_array(json, "worst");
  for (int k = 0; k < found->n_worst; k++) {
    const cli_judge_worst *w = &found->worst[k];
    cli_json_object(json, NULL);
    cli_fault_members(json, &w->fault);
    cli_json_count(json, "blended", w->n_blended);
    cli_json_array(json, "contributions");
    for (int i = 0; i < w->n_parts; i++)
      write_part(json, &w->parts[i]);
    cli_json_close(json);
    cli_json_close(json);
  }
  cli_json_close(json);
}

static void write_faults(cli_json *json, const char *key, const cli_judgement *found, uint32_t is_nearest) {
  cli_json_array(json, key);
  for (int k = 0; k < found->n_faults; k++) {
    const conic_diagnosis *d = &found->faults[k];
    if (d->is_nearest != is_nearest)
      continue;
    cli_json_object(json, NULL);
    cli_json_text(json, "name", d->name);
    if (d->with)
      cli_json_text(json, "with", d->with);
    cli_json_number(json, "share", d->share);
    cli_json_counts(json, NULL, {"righted_pixels", d->righted}, {"spoilt_pixels", d->spoilt});
    cli_json_close(json);
  }
  cli_json_close(json);
}

static void write_places(cli_json *json, const cli_judgement *found) {
  cli_json_array(json, "where");
  for (int k = 0; k < found->n_places; k++) {
    const conic_fault_place *p = &found->places[k];
    const double at[2] = {p->at[0], p->at[1]};
    char text[192];
    cli_judge_describe_place(p, text, sizeof text);
    cli_json_object(json, NULL);
    cli_json_text(json, "kind", p->kind);
    if (p->what)
      cli_json_text(json, "what", p->what);
    cli_json_numbers(json, "at", at, 2);
    cli_json_counts(json, NULL, {"size", (uint64_t)p->size}, {"pixels", p->pixels});
    cli_json_text(json, "text", text);
    cli_json_close(json);
  }
  cli_json_close(json);
}

void cli_judge_members(cli_json *json, const void *cookie) {
  const cli_judge_job *job = cookie;
  const cli_judgement *found = &job->found;
  double total = 0.0;
  cli_json_text(json, "verdict",
                cli_judge_is_undecided(job) ? "undecided"
                : cli_judge_is_right(job)   ? "right"
                                            : "wrong");
  cli_json_object(json, "pixels");
  for (int k = 0; k < CONIC_N_PIXEL_CLASSES; k++)
    cli_json_count(json, cli_class_words[k], found->pixels[k]);
  cli_json_close(json);
  cli_json_counts(json, NULL, {"max_wrong", job->max_wrong}, {"judged_pixels", found->judged},
                  {"covered_pixels", found->covered}, {"doubtful_pixels", found->doubtful});
  if (cli_is_composited(&job->scene)) {
    cli_json_count(json, "vague_pixels", found->vague);
    cli_json_array(json, "vague_by");
    for (int k = 0; k < found->vaguest.n_parts; k++)
      cli_json_count(json, NULL, found->vaguest.parts[k].index);
    cli_json_close(json);
  }
  cli_json_object(json, "explained_by");
  for (int k = 0; k < CLI_JUDGE_MOST_REASONS && found->reasons[k]; k++)
    cli_json_count(json, found->reasons[k], found->explained_by[k]);
  cli_json_close(json);
  if (cli_is_composited(&job->scene))
    cli_json_text(json, "profile", conic_gaussian_profile_name(job->scene.shot.gaussians.profile));
  else
    cli_json_text(json, "method", cli_method_name(&job->scene));
  cli_json_text(json, "floats", cli_float_words[job->floats]);
  cli_json_count(json, "samples", (uint64_t)job->scene.shot.view.samples);
  write_picture(json, job);
  write_worst(json, found);
  write_places(json, found);
  write_faults(json, "diagnosis", found, 0);
  write_faults(json, "nearest", found, 1);
  cli_json_object(json, "seconds");
  for (int k = 0; k < CLI_JUDGE_N_STAGES; k++) {
    cli_json_number(json, stage_names[k], job->seconds[k]);
    total += job->seconds[k];
  }
  cli_json_number(json, "total", total);
  cli_json_close(json);
}
