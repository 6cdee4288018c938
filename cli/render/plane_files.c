/* Which planes go into which file: an EXR holds all, a PFM one, and a PNG what can be looked at. What has been asked
 * for by --aov and stands in no file would be lost without a word, and is refused. */
#include <strings.h>

#include "cli/scene/render_job.h"
#include "core/base/color.h"
#include "core/files/file.h"

enum { RGBA = 1u << CONIC_PLANE_RGBA, LOOKED_AT = RGBA | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_ALBEDO };

/* What files of a kind can show of an image. */
typedef enum file_holds { HOLDS_RGBA, HOLDS_LOOKS, HOLDS_ONE, HOLDS_ALL } file_holds;

static const char *output_ending(const cli_render_job *job, const char *path) {
  const char *own = conic_file_ending(path);
  return *own ? own : job->writing.format ? job->writing.format : "png";
}

int cli_output_is_one_of(const cli_render_job *job, const char *path, const char *const *endings) {
  for (; *endings; endings++)
    if (strcasecmp(output_ending(job, path), *endings) == 0)
      return 1;
  return 0;
}

static file_holds holds(const cli_render_job *job, const char *path) {
  const char *ending = output_ending(job, path);
  if (strcasecmp(ending, "exr") == 0)
    return HOLDS_ALL;
  if (strcasecmp(ending, "pfm") == 0)
    return HOLDS_ONE;
  return strcasecmp(ending, "png") == 0 ? HOLDS_LOOKS : HOLDS_RGBA;
}

/* What the best of the outputs holds: only that kind is written as a set. */
static file_holds best_of(const cli_render_job *job) {
  file_holds best = HOLDS_RGBA;
  for (int i = 0; i < job->n_outputs; i++) {
    file_holds here = holds(job, job->outputs[i]);
    best = here > best ? here : best;
  }
  return best;
}

/* The planes of which PATH becomes files, one each; 0: one file takes what it can. */
static unsigned set_of(const cli_render_job *job, const char *path) {
  file_holds here = holds(job, path);
  if (here == HOLDS_ALL || here == HOLDS_RGBA || here < best_of(job))
    return 0;
  return here == HOLDS_ONE ? job->asked_planes : job->asked_planes & LOOKED_AT;
}

static int is_single(unsigned planes) {
  return (planes & (planes - 1)) == 0;
}

int cli_planes_check(const cli_session *session, const cli_render_job *job) {
  const file_holds best = best_of(job);
  unsigned lost = best == HOLDS_ALL   ? 0
                  : best == HOLDS_ONE ? job->asked_planes & 1u << CONIC_PLANE_MOTION
                                      : job->asked_planes & ~(unsigned)(best == HOLDS_LOOKS ? LOOKED_AT : RGBA);
  for (int i = 0; i < job->n_outputs; i++)
    if (strcmp(job->outputs[i], "-") == 0 && !is_single(set_of(job, "-")))
      return cli_usage("render: standard output takes one file, and %s has one a plane; an EXR holds all",
                       job->writing.format);
  for (int i = 0; i < CONIC_N_PLANES && job->n_outputs > 0 && !session->json_path; i++)
    if (lost >> i & 1)
      return cli_usage("render: no output holds the plane %s; give an .exr%s",
                       conic_plane_describe((conic_plane)i)->name,
                       i == CONIC_PLANE_MOTION ? "" : ", or .pfm for a file a plane");
  return CLI_DONE;
}

conic_status cli_planes_check_formats(cli_session *session, const cli_render_job *job) {
  conic_status status = CONIC_OK;
  for (int i = 0; i < job->n_outputs && status == CONIC_OK; i++) {
    unsigned set = set_of(job, job->outputs[i]), planes = set ? set & RGBA ? RGBA : set & (~set + 1) : job->shot.planes;
    if (set && holds(job, job->outputs[i]) == HOLDS_LOOKS)
      planes = RGBA; /* which is made of the others */
    status = conic_image_check_output_as(session->context, job->outputs[i], planes, &job->writing);
  }
  return status;
}

conic_image_options cli_picture_writing(const cli_render_job *job) {
  conic_image_options writing = job->writing;
  writing.tone = (conic_tone)job->tone;
  return writing;
}

/* A plane as colours that show it: directions from -1 to 1 as codes from 0 to 255. */
static conic_status show_plane(cli_session *session, const conic_image *image, conic_plane plane, conic_image *shown) {
  const float *from = image->planes[plane];
  conic_status status = conic_image_allocate(session->context, image->width, image->height, RGBA, shown);
  if (status != CONIC_OK)
    return status;
  float *to = shown->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++, from += 3, to += 4) {
    int is_there = plane != CONIC_PLANE_NORMAL || from[0] != 0.0f || from[1] != 0.0f || from[2] != 0.0f;
    for (int c = 0; c < 3 && is_there; c++)
      to[c] = plane == CONIC_PLANE_NORMAL ? (float)conic_srgb_decode(0.5 + 0.5 * (double)from[c]) : from[c];
    to[3] = is_there ? 1.0f : 0.0f;
  }
  return CONIC_OK;
}

/* One plane of the image into a file of its own. */
static conic_status write_plane(cli_session *session, const cli_render_job *job, const char *path,
                                const conic_image *image, conic_plane plane) {
  conic_image alone = *image;
  if (plane == CONIC_PLANE_RGBA || holds(job, path) == HOLDS_ONE) {
    memset(alone.planes, 0, sizeof alone.planes);
    alone.planes[plane] = image->planes[plane];
    const conic_image_options writing = cli_picture_writing(job);
    return conic_image_write_as(session->context, path, &alone, &writing);
  }
  conic_status status = show_plane(session, image, plane, &alone);
  alone.shot = job->making.text;
  if (status == CONIC_OK)
    status = conic_image_write_as(session->context, path, &alone, &job->writing);
  conic_image_release(session->context, &alone);
  return status;
}

conic_status cli_planes_write(cli_session *session, const cli_render_job *job, const char *path,
                              const conic_image *drawn) {
  unsigned set = set_of(job, path);
  conic_image kept = *drawn;
  const conic_image *image = &kept;
  conic_status status = CONIC_OK;
  const char *ending = conic_file_ending(path);
  size_t n_room = strlen(path) + 32;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (job->unwritten_planes >> i & 1)
      kept.planes[i] = NULL;
  if (holds(job, path) < HOLDS_ONE)
    kept.shot = job->making.shown_text;
  if (!set) {
    const conic_image_options writing = cli_picture_writing(job);
    return conic_image_write_as(session->context, path, image, &writing);
  }
  char *name = malloc(n_room);
  for (int i = 0; name && i < CONIC_N_PLANES && status == CONIC_OK; i++) {
    if (!(set >> i & 1))
      continue;
    if (i == CONIC_PLANE_RGBA || is_single(set))
      snprintf(name, n_room, "%s", path);
    else if (*ending) /* "out.pfm" becomes "out.Z.pfm" */
      snprintf(name, n_room, "%.*s%s.%s", (int)(ending - path), path, conic_plane_describe((conic_plane)i)->name,
               ending);
    else
      snprintf(name, n_room, "%s.%s", path, conic_plane_describe((conic_plane)i)->name);
    status = write_plane(session, job, name, image, (conic_plane)i);
  }
  free(name);
  return name ? status : CONIC_ERROR_MEMORY;
}
