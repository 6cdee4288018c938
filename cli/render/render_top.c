#include "cli/render/shot_record.h"
#include "cli/top/top_tiff.h"
#include "core/files/file.h"
#include "core/image/image_common.h"

enum { BLOCK = CONIC_TOP_BLOCK, MOST_TIFFS = 2 * CLI_MAX_OUTPUTS, MOST_EDGE = 1 << 21 };
enum { RGBA = 1u << CONIC_PLANE_RGBA, HEIGHTS = 1u << CONIC_PLANE_Z };

/* A picture that is drawn: TIFFs as they come, and other files of the whole. */
typedef struct top_picture {
  cli_session *session;
  cli_render_job *job;
  conic_georeference reference;
  double corner[2];
  cli_top_tiff tiffs[MOST_TIFFS];
  char *paths[MOST_TIFFS]; /* theirs */
  int n_tiffs;
  conic_image whole, block; /* the first without planes where there are only TIFFs */
  conic_top_view *view;
} top_picture;

static int is_tiff(const char *path) {
  return conic_file_has_ending(path, "tif") || conic_file_has_ending(path, "tiff");
}

/* --- what is asked for --- */

int cli_top_check(const cli_session *session, const cli_render_job *job) {
  int has_tiff = 0;
  unsigned others = job->is_aov_given ? job->asked_planes & ~(unsigned)(RGBA | HEIGHTS) : 0;
  if (others)
    return cli_usage("render: --camera top has the planes rgba and Z, which is the height");
  if (job->n_outputs == 0)
    return cli_usage("render: --camera top needs an output; give one with -o OUT.tif, OUT.png, …");
  for (int i = 0; i < job->n_outputs; i++)
    if (strcmp(job->outputs[i], "-") == 0)
      return cli_usage("render: --camera top writes files, beside which world files stand: not to standard output");
  for (int i = 0; i < job->n_outputs; i++)
    has_tiff |= is_tiff(job->outputs[i]);
  return has_tiff ? CLI_DONE : cli_planes_check(session, job);
}

/* What goes into TIFFs: colours unless heights are asked for. */
static unsigned tiff_planes(const cli_render_job *job) {
  return job->is_aov_given ? job->asked_planes & (RGBA | HEIGHTS) : RGBA;
}

conic_status cli_top_check_formats(conic_context *context, const cli_render_job *job) {
  conic_status status = CONIC_OK;
  for (int i = 0; i < job->n_outputs && status == CONIC_OK; i++)
    if (!is_tiff(job->outputs[i]))
      status = conic_image_check_output_as(context, job->outputs[i], job->shot.planes, &job->writing);
  return status;
}

/* --- where it lies --- */

/* The pixel that a place is in; one that is within rounding of a border is on it. */
static double map_pixel_of(double place, double gsd, int is_up) {
  double at = place / gsd, nearest = floor(at + 0.5);
  if (fabs(at - nearest) < 1e-6)
    return nearest;
  return is_up ? ceil(at) : floor(at);
}

/* The pixels that the box, or all there is, lies in. */
static conic_status plan_picture(cli_session *session, cli_render_job *job) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  cli_top_job *top = &job->top;
  double first[2], size[2];
  conic_status status = CONIC_OK;
  if (top->gsd == 0.0)
    status = conic_source_spacing(job->source, &top->gsd);
  if (status == CONIC_OK && !(top->gsd > 0.0))
    status = conic_fail(session->context, CONIC_ERROR_INPUT,
                        "%s: its points have no spacing; --camera top:GSD says how fine", job->inputs[0]);
  for (int axis = 0; axis < 2 && status == CONIC_OK; axis++) {
    int is_boxed = isfinite(top->box.low[axis]);
    double low = is_boxed ? top->box.low[axis] : scale->minimum[axis];
    double high = is_boxed ? top->box.high[axis] : scale->maximum[axis];
    double begin = axis == 0 ? low : -high, end = axis == 0 ? high : -low; /* rows count downwards */
    first[axis] = map_pixel_of(begin, top->gsd, 0);
    double last = map_pixel_of(end, top->gsd, 1);
    size[axis] = last - first[axis] + (!is_boxed && last * top->gsd <= end); /* a point on a border is beyond it */
    size[axis] = fmax(size[axis], 1.0);
    if (!(size[axis] <= MOST_EDGE) || !(fabs(first[axis]) < 0x1p50))
      return conic_fail(session->context, CONIC_ERROR_ARGUMENT,
                        "%s: at --camera top:%g the picture has %.0f pixels %s; %d are drawn: --box says which part",
                        job->inputs[0], top->gsd, size[axis], axis == 0 ? "in a row" : "in a column", MOST_EDGE);
  }
  if (status != CONIC_OK)
    return status;
  top->column = (int64_t)first[0];
  top->row = (int64_t)first[1];
  top->width = (int)size[0];
  top->height = (int)size[1];
  return CONIC_OK;
}

static conic_status find_reference(top_picture *p) {
  cli_top_job *top = &p->job->top;
  conic_context *context = p->session->context;
  conic_status status = top->epsg ? conic_georeference_of_epsg(context, (unsigned)top->epsg, &p->reference)
                                  : conic_source_georeference(p->job->source, &p->reference);
  top->found_epsg = p->reference.epsg;
  return status;
}

/* As a file of cameras has it: the parallel projection of the whole picture. */
static void describe_camera(cli_render_job *job, const double corner[2]) {
  const cli_top_job *top = &job->top;
  conic_camera *camera = &job->last_camera;
  memset(camera, 0, sizeof *camera);
  camera->kind = CONIC_CAMERA_ORTHOGRAPHIC;
  camera->width = top->width;
  camera->height = top->height;
  camera->fx = camera->fy = 1.0 / top->gsd;
  camera->cx = 0.5 * top->width;
  camera->cy = 0.5 * top->height;
  camera->cam_from_world[0][0] = 1.0;
  camera->cam_from_world[1][1] = camera->cam_from_world[2][2] = -1.0;
  camera->cam_from_world[0][3] = -(corner[0] + 0.5 * top->width * top->gsd);
  camera->cam_from_world[1][3] = corner[1] - 0.5 * top->height * top->gsd;
  camera->cam_from_world[2][3] = conic_source_measure(job->source)->maximum[2];
}

/* --- files --- */

/* "map.tif", or of heights beside colours "map.Z.tif". */
static char *name_tiff(const char *path, int is_beside) {
  const char *ending = conic_file_ending(path);
  size_t room = strlen(path) + 4;
  char *name = malloc(room);
  if (name)
    snprintf(name, room, "%.*s%s%s", (int)(ending - path), path, is_beside ? "Z." : "", ending);
  return name;
}

static conic_status open_tiff(top_picture *p, const char *path, int is_elevation, int is_beside) {
  const cli_top_job *top = &p->job->top;
  const conic_tiff_layout layout = {.width = (uint64_t)top->width,
                                    .height = (uint64_t)top->height,
                                    .is_elevation = is_elevation,
                                    .nodata = CLI_TOP_NODATA,
                                    .pixel = top->gsd,
                                    .corner = {p->corner[0], p->corner[1]},
                                    .reference = &p->reference,
                                    .description = p->job->making.text};
  char *name = name_tiff(path, is_beside);
  conic_status status = name ? cli_top_tiff_open(p->session->context, name, &layout, p->job->access.memory_bytes / 8,
                                                 &p->tiffs[p->n_tiffs])
                             : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    p->paths[p->n_tiffs++] = name;
  else
    free(name);
  return status;
}

static conic_status open_files(top_picture *p) {
  const cli_render_job *job = p->job;
  unsigned planes = tiff_planes(job);
  conic_status status = CONIC_OK;
  int has_others = 0;
  for (int i = 0; i < job->n_outputs && status == CONIC_OK; i++) {
    int is_one = is_tiff(job->outputs[i]);
    has_others |= !is_one;
    if (is_one && planes & RGBA)
      status = open_tiff(p, job->outputs[i], 0, 0);
    if (status == CONIC_OK && is_one && planes & HEIGHTS)
      status = open_tiff(p, job->outputs[i], 1, (planes & RGBA) != 0);
  }
  if (status == CONIC_OK && has_others &&
      (job->top.width > CONIC_IMAGE_MAX_SIZE || job->top.height > CONIC_IMAGE_MAX_SIZE))
    status = conic_fail(p->session->context, CONIC_ERROR_ARGUMENT,
                        "%s: %d x %d pixels are too many for it; a .tif may have them", job->outputs[0], job->top.width,
                        job->top.height);
  if (status == CONIC_OK && has_others)
    status = conic_image_allocate(p->session->context, job->top.width, job->top.height, job->shot.planes, &p->whole);
  return status == CONIC_OK ? conic_image_allocate(p->session->context, BLOCK, BLOCK, job->shot.planes, &p->block)
                            : status;
}

/* Ends the TIFFs, with their world files. */
static conic_status close_files(top_picture *p, conic_status status) {
  for (int i = 0; i < p->n_tiffs; i++) {
    status = cli_top_tiff_end(&p->tiffs[i], status);
    if (status == CONIC_OK)
      status = cli_world_file_write(p->session->context, p->paths[i], p->job->top.gsd, p->corner);
    free(p->paths[i]);
  }
  for (int i = 0; i < p->job->n_outputs && status == CONIC_OK && conic_image_planes(&p->whole); i++) {
    const char *path = p->job->outputs[i];
    if (is_tiff(path))
      continue;
    status = cli_planes_write(p->session, p->job, path, &p->whole);
    if (status == CONIC_OK)
      status = cli_world_file_write(p->session->context, path, p->job->top.gsd, p->corner);
  }
  return status;
}

/* --- drawing --- */

static int64_t block_of(int64_t pixel) {
  return pixel >= 0 ? pixel / BLOCK : -((BLOCK - 1 - pixel) / BLOCK);
}

/* Along an axis: where a block lies in the picture. */
static void cut_axis(int64_t block, int64_t first, int size, size_t *at, size_t *extent, size_t *within) {
  int64_t begin = block * BLOCK, end = begin + BLOCK, last = first + size;
  *within = begin < first ? (size_t)(first - begin) : 0;
  *at = begin < first ? 0 : (size_t)(begin - first);
  *extent = (size_t)((end < last ? end : last) - begin) - *within;
}

/* Copies a plane's part of a block. */
static void keep_block(top_picture *p, const cli_top_cut *cut) {
  for (int plane = 0; plane < CONIC_N_PLANES; plane++) {
    const float *from = p->block.planes[plane];
    float *to = p->whole.planes[plane];
    size_t n = (size_t)conic_plane_describe((conic_plane)plane)->n_channels, width = (size_t)p->job->top.width;
    for (size_t row = 0; row < cut->height && to; row++) {
      float *pixels = to + ((cut->y + row) * width + cut->x) * n;
      memcpy(pixels, from + ((cut->block_y + row) * BLOCK + cut->block_x) * n, cut->width * n * sizeof *to);
      for (size_t i = 0; i < cut->width && plane == CONIC_PLANE_Z; i++)
        pixels[i] = isnan(pixels[i]) ? (float)CLI_TOP_NODATA : pixels[i];
    }
  }
}

static conic_status draw_map_block(top_picture *p, int64_t column, int64_t row) {
  cli_top_job *top = &p->job->top;
  cli_top_cut cut;
  cut_axis(column, top->column, top->width, &cut.x, &cut.width, &cut.block_x);
  cut_axis(row, top->row, top->height, &cut.y, &cut.height, &cut.block_y);
  conic_status status = conic_top_view_draw(p->view, column, row, &p->block, &p->job->statistics);
  for (int i = 0; i < p->n_tiffs && status == CONIC_OK; i++)
    status = cli_top_tiff_put(&p->tiffs[i], &p->block, &cut);
  if (status == CONIC_OK)
    keep_block(p, &cut);
  top->n_blocks++;
  return status;
}

static conic_status draw_rows(top_picture *p) {
  const cli_top_job *top = &p->job->top;
  int64_t first_row = block_of(top->row), end_row = block_of(top->row + top->height - 1) + 1;
  int64_t first = block_of(top->column), end = block_of(top->column + top->width - 1) + 1;
  conic_status status = CONIC_OK;
  for (int64_t row = first_row; row < end_row && status == CONIC_OK; row++) {
    cli_session_part(p->session, "row of blocks", (int)(row - first_row) + 1, (int)(end_row - first_row));
    for (int64_t column = first; column < end && status == CONIC_OK; column++)
      status = draw_map_block(p, column, row);
    int64_t n_rows = (row + 1) * BLOCK - top->row;
    for (int i = 0; i < p->n_tiffs && status == CONIC_OK; i++)
      status = cli_top_tiff_advance(&p->tiffs[i], (size_t)(n_rows < top->height ? n_rows : top->height));
  }
  return status;
}

static conic_status open_view(top_picture *p) {
  const cli_render_job *job = p->job;
  const conic_top_options options = {.pixel = job->top.gsd,
                                     .heights = {job->top.box.low[2], job->top.box.high[2]},
                                     .render = &job->shot.render,
                                     .samples = job->shot.view.samples,
                                     .error_px = job->shot.view.error_px};
  return conic_top_view_open(job->source, job->renderer, &options, &p->view);
}

static conic_status make_picture(top_picture *p) {
  cli_render_job *job = p->job;
  cli_top_job *top = &job->top;
  conic_status status = plan_picture(p->session, job);
  p->corner[0] = (double)top->column * top->gsd;
  p->corner[1] = -(double)top->row * top->gsd;
  if (status == CONIC_OK)
    status = find_reference(p);
  if (status != CONIC_OK)
    return status;
  describe_camera(job, p->corner);
  if (!job->is_shade_given && conic_source_measure(job->source)->has_colors)
    job->shot.render.shading = CONIC_SHADE_NONE; /* photographs have their light already */
  if (!job->is_samples_given && conic_source_measure(job->source)->n_triangles)
    job->shot.view.samples = 2; /* whose edges nothing else softens */
  double start = cli_seconds();
  status = cli_shot_describe(p->session, job);
  if (status == CONIC_OK)
    status = open_view(p);
  if (status == CONIC_OK)
    status = open_files(p);
  if (status == CONIC_OK)
    status = draw_rows(p);
  job->frames_ms = 1e3 * (cli_seconds() - start);
  start = cli_seconds();
  p->whole.shot = job->making.text;
  status = close_files(p, status);
  if (status == CONIC_OK)
    status = cli_shot_save(p->session, job, 0);
  job->write_ms = 1e3 * (cli_seconds() - start);
  return status;
}

/* Of what is kept as a whole, only where it is reported. */
static void hash_whole(const top_picture *p) {
  for (int i = 0; i < CONIC_N_PLANES && p->session->json_path; i++)
    p->job->hashes[i] = conic_image_hash(&p->whole, (conic_plane)i);
}

int cli_top_render(cli_session *session, cli_render_job *job) {
  top_picture p = {.session = session, .job = job};
  conic_status status = make_picture(&p);
  int exit_code = cli_exit_of(status);
  if (status == CONIC_OK) {
    if (job->statistics.pixels_covered == 0)
      conic_log(session->context, CONIC_LOG_WARNING, "%s: the picture is empty", job->inputs[0]);
    hash_whole(&p);
    job->first_frame_ms = job->statistics.ms.frame;
    job->total_ms = 1e3 * (cli_seconds() - job->start_seconds);
    cli_render_tell(session, job);
    exit_code = cli_render_report(session, job, &p.whole);
  }
  conic_top_view_close(p.view);
  conic_image_release(session->context, &p.whole);
  conic_image_release(session->context, &p.block);
  conic_georeference_release(session->context, &p.reference);
  return exit_code;
}
