/* The report's page: pictures, counts, the worst pixels, and how the verdict was found. */

#include "cli/commands/gaussian_commands.h"
#include "cli/judge/judge_job.h"
#include "cli/judge/judge_page.h"
#include "core/files/file.h"

enum { PICTURE_PX = 460, CROP = 17, CROP_ZOOM = 12 };

/* Draws conic's own picture, into job->ours. */
static conic_status draw_ours(cli_session *session, cli_judge_job *job) {
  const conic_camera *camera = &job->camera;
  conic_status status = conic_image_allocate(session->context, camera->width, camera->height, 1u, &job->ours);
  if (status == CONIC_OK)
    status = conic_source_draw(job->scene.source, job->scene.renderer, camera, &job->scene.shot.render,
                               &job->scene.shot.view, &job->ours, &job->scene.statistics);
  return status;
}

/* A value of the picture to be shown: the middle of the range that it stands for, over black. */
static float shown_value(const cli_judge_job *job, size_t at) {
  double low = (double)((const float *)job->picture.image.planes[CONIC_PLANE_RGBA])[at], high = low;
  if (job->picture.greatest.width)
    high = (double)((const float *)job->picture.greatest.planes[CONIC_PLANE_RGBA])[at];
  if (!(high < HUGE_VAL))
    return low > -HUGE_VAL ? (float)low : low == low ? 0.0f : NAN;
  return low > -HUGE_VAL ? (float)(0.5 * (low + high)) : (float)high;
}

/* The judged picture. NaN is magenta. */
static conic_status show_theirs(cli_session *session, const cli_judge_job *job, conic_image *theirs) {
  conic_status status = conic_image_allocate(session->context, job->camera.width, job->camera.height, 1u, theirs);
  if (status != CONIC_OK)
    return status;
  float *rgba = theirs->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < job->found.n_whole; i++) {
    float *to = rgba + 4 * i;
    int is_number = 1;
    for (int c = 0; c < 3; c++) {
      to[c] = shown_value(job, 4 * i + (size_t)c);
      is_number &= to[c] - to[c] == 0.0f;
    }
    for (int c = 0; c < 3 && !is_number; c++)
      to[c] = c == 1 ? 0.0f : 1.0f;
    to[3] = 1.0f;
  }
  theirs->is_display = (uint64_t)cli_is_composited(&job->scene); /* then the colours are display values already */
  return CONIC_OK;
}

/* Puts the image over black, so that both look alike whatever their alpha. */
static void cover_with_black(conic_image *image) {
  float *rgba = image->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++)
    rgba[4 * i + 3] = 1.0f;
}

/* A part of an image around a pixel; grey beyond the border. */
static conic_status cut_out(cli_session *session, const conic_image *from, int x, int y, int size, conic_image *part) {
  conic_status status = conic_image_allocate(session->context, size, size, 1u, part);
  if (status != CONIC_OK)
    return status;
  float *to = part->planes[CONIC_PLANE_RGBA];
  const float *rgba = from->planes[CONIC_PLANE_RGBA];
  for (int row = 0; row < size; row++)
    for (int column = 0; column < size; column++, to += 4) {
      int px = x - size / 2 + column, py = y - size / 2 + row;
      int is_in = px >= 0 && py >= 0 && px < from->width && py < from->height;
      for (int c = 0; c < 4; c++)
        to[c] = is_in ? rgba[4 * ((size_t)py * (size_t)from->width + (size_t)px) + (size_t)c] : c < 3 ? 0.2f : 1.0f;
    }
  part->is_display = from->is_display;
  return CONIC_OK;
}

/* The pictures shown side by side. */
typedef struct report_pictures {
  conic_image theirs, difference, map;
} report_pictures;

static conic_status put_crops(const cli_page *page, const cli_judge_job *job, const report_pictures *pictures,
                              const cli_judge_worst *w) {
  const conic_image *const from[] = {&job->ours, &pictures->theirs, &pictures->difference, &pictures->map};
  static const char *const names[] = {"conic", "the picture", "difference", "classes"};
  conic_status status = CONIC_OK;
  fputs("<div class=\"row crops\">\n", page->to);
  for (int k = 0; k < 4 && status == CONIC_OK; k++) {
    conic_image part;
    if (!from[k]->planes[CONIC_PLANE_RGBA])
      continue;
    status = cut_out(page->session, from[k], w->fault.x, w->fault.y, CROP, &part);
    if (status == CONIC_OK)
      status = cli_page_picture(page, &part, CROP * CROP_ZOOM, names[k]);
    conic_image_release(page->session->context, &part);
  }
  fputs("</div>\n", page->to);
  return status;
}

static conic_status put_worst(const cli_page *page, const cli_judge_job *job, const report_pictures *pictures) {
  char text[256];
  conic_status status = CONIC_OK;
  if (job->found.n_worst)
    fputs("<h2>The pixels that are farthest off</h2>\n", page->to);
  for (int k = 0; k < job->found.n_worst && status == CONIC_OK; k++) {
    const cli_judge_worst *w = &job->found.worst[k];
    fprintf(page->to, "<h3>Pixel %d, %d</h3>\n<p>", w->fault.x, w->fault.y);
    cli_judge_describe(job, &w->fault, text, sizeof text);
    cli_page_text(page, text);
    fputs(".</p>\n<ul>\n", page->to);
    for (int i = 0; i < w->n_parts; i++) {
      cli_judge_describe_part(&w->parts[i], text, sizeof text);
      fputs("<li>", page->to);
      cli_page_text(page, text);
      fputs("</li>\n", page->to);
    }
    if (!w->n_blended)
      fputs("<li>Nothing is to be seen there.</li>\n", page->to);
    else if (w->n_blended > (size_t)w->n_parts)
      fprintf(page->to, "<li>and %zu more</li>\n", w->n_blended - (size_t)w->n_parts);
    fputs("</ul>\n", page->to);
    status = put_crops(page, job, pictures, w);
  }
  return status;
}

static void put_head(const cli_page *page, const cli_judge_job *job) {
  const cli_judgement *found = &job->found;
  const char *verdict = cli_judge_is_undecided(job) ? "undecided" : cli_judge_is_right(job) ? "right" : "wrong";
  fputs("<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8><title>conic judge</title><style>\n"
        "body{font:15px/1.45 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;color:#222;"
        "background:#fff}\n"
        "h1{font-size:1.5rem} h2{font-size:1.15rem;margin-top:2rem} h3{font-size:1rem;margin-bottom:.2rem}\n"
        ".crops figure{position:relative} .crops figure::after{content:\"\";position:absolute;left:95px;top:95px;"
        "width:12px;height:12px;border:1px solid #fff;outline:1px solid #000}\n"
        ".row{display:flex;flex-wrap:wrap;gap:1rem} figure{margin:0;max-width:460px} "
        "figcaption{color:#555;font-size:.85rem}\n"
        "img{image-rendering:pixelated;background:#000;display:block;max-width:100%}\n"
        "table{border-collapse:collapse} td,th{padding:.15rem .8rem .15rem 0;text-align:left;vertical-align:top}\n"
        "td.n{text-align:right;font-variant-numeric:tabular-nums} code{background:#f2f2f2;padding:.1rem .3rem;"
        "overflow-wrap:anywhere}\n"
        ".right{color:#176b2c} .wrong{color:#b00020}\n</style></head><body>\n",
        page->to);
  fprintf(page->to, "<h1>The picture is <span class=%s>%s</span></h1>\n<p>", verdict, verdict);
  fprintf(page->to, "%zu of %zu judged pixels are wrong", found->pixels[CONIC_PIXEL_WRONG], found->judged);
  if (found->judged < found->n_whole)
    fprintf(page->to, ", of the %zu that the picture has", found->n_whole);
  if (job->max_wrong)
    fprintf(page->to, "; %llu may be", job->max_wrong);
  fputs(".</p>\n", page->to);
}

static void put_class_row(const cli_page *page, const char *name, size_t n, size_t of, const char *meaning) {
  fprintf(page->to, "<tr><td>%s</td><td class=n>%zu</td><td class=n>%.4g %%</td><td>%s</td></tr>\n", name, n,
          of ? 100.0 * (double)n / (double)of : 0.0, meaning);
}

static void put_counts(const cli_page *page, const cli_judge_job *job) {
  const cli_judgement *found = &job->found;
  const size_t *n = found->pixels;
  fputs("<h2>Pixels</h2>\n<table>\n", page->to);
  put_class_row(page, "equal", n[CONIC_PIXEL_EQUAL], found->judged,
                "the floats next to the values in double precision");
  put_class_row(page, "rounding", n[CONIC_PIXEL_ROUNDED], found->judged, "within what the roundings of floats may do");
  put_class_row(page, "explained", n[CONIC_PIXEL_EXPLAINED], found->judged,
                "a decision that rounding may take either way went the other way");
  put_class_row(page, "wrong", n[CONIC_PIXEL_WRONG], found->judged, "no correct renderer of floats gives that");
  fputs("</table>\n", page->to);
  if (n[CONIC_PIXEL_EXPLAINED]) {
    fputs("<p>Explained by", page->to);
    const char *separator = " ";
    for (int k = 0; k < CLI_JUDGE_MOST_REASONS && found->reasons[k]; k++)
      if (found->explained_by[k]) {
        fprintf(page->to, "%s%s (%zu)", separator, found->reasons[k], found->explained_by[k]);
        separator = ", ";
      }
    fputs(".</p>\n", page->to);
  }
  if (found->vague)
    fprintf(page->to, "<p>%zu pixels may be anything within more than 1/255.</p>\n", found->vague);
  fputs(
      "<p>The scene is drawn once more in double precision, and every step carries a bound of what the roundings of "
      "floats, a fast exponential and fused products may do to it. Where a bound reaches across a decision, such as a "
      "cutoff, both answers are followed; so each pixel has a range, and the picture is held against it.</p>\n",
      page->to);
  if (job->picture.most_code)
    fprintf(page->to,
            "<p>The picture holds codes of %d bits. Each stands for all values that are rounded to it, and the "
            "least and the greatest code for all that is beyond.</p>\n",
            job->picture.most_code == 255 ? 8 : 16);
}

static void put_planes(const cli_page *page, const cli_judge_job *job) {
  fputs("<h2>Planes</h2>\n<table><tr><th>plane</th><th>largest difference</th></tr>\n", page->to);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (job->found.planes[i].is_compared)
      fprintf(page->to, "<tr><td>%s</td><td class=n>%.4g</td></tr>\n", conic_plane_describe((conic_plane)i)->name,
              job->found.planes[i].max_abs);
  fputs("</table>\n", page->to);
}

static void put_diagnosis(const cli_page *page, const cli_judge_job *job) {
  if (cli_judge_is_right(job))
    return;
  fputs("<h2>Diagnosis</h2>\n", page->to);
  for (int k = 0; k < job->found.n_places; k++) {
    char text[192];
    cli_judge_describe_place(&job->found.places[k], text, sizeof text);
    fprintf(page->to, "<p>Where: %s.</p>\n", text);
  }
  const int is_named = job->found.n_faults > 0 && !job->found.faults[0].is_nearest;
  if (!is_named)
    fputs("<p>No fault that is known explains the difference.</p>\n", page->to);
  if (job->found.n_faults && !is_named)
    fputs("<p>What comes nearest, without explaining it:</p>\n<table>\n", page->to);
  else if (is_named)
    fputs("<p>What takes away most of the difference, if the renderer is taken to do it:</p>\n<table>\n", page->to);
  for (int k = 0; k < job->found.n_faults; k++) {
    const conic_diagnosis *d = &job->found.faults[k];
    const char *meaning = conic_diagnosis_meaning(d->name);
    fprintf(page->to, "<tr><td><b>%s%s%s</b></td><td class=n>%.4g %%</td><td>", d->name, d->with ? " with " : "",
            d->with ? d->with : "", 100.0 * d->share);
    cli_page_text(page, meaning ? meaning : "");
    fputs("</td></tr>\n", page->to);
  }
  if (job->found.n_faults)
    fputs("</table>\n", page->to);
}

static void put_origin(const cli_page *page, const cli_judge_job *job) {
  fputs("<h2>How it was found out</h2>\n<p><code>conic", page->to);
  for (int i = 0; i < job->argc; i++) {
    putc(' ', page->to);
    cli_page_text(page, job->argv[i]);
  }
  fprintf(page->to, "</code></p>\n<p>conic %s, %d &times; %d pixels, ", conic_version(), job->camera.width,
          job->camera.height);
  if (cli_is_composited(&job->scene))
    fprintf(page->to, "profile %s, ", conic_gaussian_profile_name(job->scene.shot.gaussians.profile));
  else
    fprintf(page->to, "method %s, ", cli_method_name(&job->scene));
  fprintf(page->to, "%d &times; %d samples a pixel, judged in %.1f s.</p>\n</body></html>\n",
          job->scene.shot.view.samples, job->scene.shot.view.samples, job->seconds[CLI_JUDGE_JUDGE]);
}

static conic_status put_pictures(const cli_page *page, const cli_judge_job *job, const report_pictures *pictures) {
  conic_status status = CONIC_OK;
  fputs("<h2>Pictures</h2>\n<div class=row>\n", page->to);
  if (pictures->theirs.width) {
    status = cli_page_picture(page, &job->ours, PICTURE_PX, "what conic draws");
    if (status == CONIC_OK)
      status = cli_page_picture(page, &pictures->theirs, PICTURE_PX, "the picture");
    if (status == CONIC_OK)
      status = cli_page_picture(page, &pictures->difference, PICTURE_PX,
                                "their difference: black where equal, then blue, red, yellow, white by its logarithm");
  }
  if (status == CONIC_OK)
    status = cli_page_picture(page, &pictures->map, PICTURE_PX, "the class of every pixel");
  fputs("</div>\n", page->to);
  return status;
}

static conic_status make_pictures(cli_session *session, cli_judge_job *job, report_pictures *pictures) {
  memset(pictures, 0, sizeof *pictures);
  conic_status status = cli_judge_map(session, job, &pictures->map);
  if (status != CONIC_OK || !job->picture.image.planes[CONIC_PLANE_RGBA])
    return status;
  status = draw_ours(session, job);
  if (status == CONIC_OK) {
    cover_with_black(&job->ours);
    status = show_theirs(session, job, &pictures->theirs);
  }
  if (status == CONIC_OK)
    status = conic_image_heatmap(session->context, &job->ours, &pictures->theirs, &pictures->difference);
  return status;
}

conic_status cli_judge_report(cli_session *session, cli_judge_job *job) {
  report_pictures pictures;
  conic_output *output;
  conic_status status = make_pictures(session, job, &pictures);
  if (status == CONIC_OK)
    status = conic_output_open(session->context, job->report_path, &output);
  if (status == CONIC_OK) {
    const cli_page page = {session, conic_output_stream(output)};
    put_head(&page, job);
    put_counts(&page, job);
    put_diagnosis(&page, job);
    status = put_pictures(&page, job, &pictures);
    if (status == CONIC_OK)
      status = put_worst(&page, job, &pictures);
    put_planes(&page, job);
    put_origin(&page, job);
    status = conic_output_end(output, status);
  }
  conic_image_release(session->context, &pictures.theirs);
  conic_image_release(session->context, &pictures.difference);
  conic_image_release(session->context, &pictures.map);
  return status;
}
