/* conic sheet: plans, façades and sections at a scale, on paper. */
#include "cli/color_options.h"
#include "cli/command.h"
#include "cli/outputs.h"
#include "cli/render/fill_shot.h"
#include "cli/render/units.h"
#include "cli/scene/light_options.h"
#include "cli/sheet/sheet.h"
#include "core/coloring/legend.h"
#include "core/files/file.h"
#include "source/top/top_view.h"

/* --- values --- */

static cli_panel *add_panel(cli_sheet_job *job, cli_panel_kind kind) {
  if (job->n_panels == CLI_MOST_PANELS) {
    cli_because("there are 24 panels already");
    return NULL;
  }
  cli_panel *panel = &job->panels[job->n_panels++];
  panel->kind = kind;
  return panel;
}

/* "X,Y:X,Y", and past it. */
static int parse_line(const char **text, double ends[2][2]) {
  for (int i = 0; i < 2; i++) {
    char pair[128];
    size_t length = strcspn(*text, ":");
    snprintf(pair, sizeof pair, "%.*s", (int)length, *text);
    if (length >= sizeof pair || !cli_parse_pair(pair, ',', ends[i]) || (i == 0 && !(*text)[length]))
      return 0;
    *text += length + (i == 0);
  }
  return ends[0][0] != ends[1][0] || ends[0][1] != ends[1][1] || cli_because("A and B are one place");
}

static int parse_facade(const char *text, void *value) {
  cli_panel *panel = add_panel(value, CLI_PANEL_FACADE);
  if (!panel)
    return 0;
  panel->has_line = strchr(text, ',') != NULL;
  if (panel->has_line)
    return parse_line(&text, panel->ends) && !*text;
  return cli_parse_number(text, &panel->azimuth_deg) && fabs(panel->azimuth_deg) <= 1e6;
}

static int parse_section(const char *text, void *value) {
  cli_sheet_job *job = value;
  cli_panel *panel = add_panel(job, CLI_PANEL_SECTION);
  if (!panel || !parse_line(&text, panel->ends))
    return 0;
  panel->has_line = 1;
  return !*text || (*text == ':' && cli_parse_number(text + 1, &panel->depth) && panel->depth > 0.0);
}

static int parse_scale(const char *text, void *scale) {
  double parts[2];
  if (!cli_parse_pair(text, ':', parts) || !(parts[0] > 0.0) || !(parts[1] > 0.0))
    return 0;
  *(double *)scale = parts[1] / parts[0];
  return *(double *)scale > 1e-6 && *(double *)scale < 1e12;
}

/* A3, A3:upright, or WxH in millimetres. */
static int parse_paper(const char *text, void *value) {
  static const double a0[] = {1189.0, 841.0, 594.0, 420.0, 297.0, 210.0, 148.0};
  double *mm = value;
  int size = text[0] == 'A' || text[0] == 'a' ? text[1] - '0' : -1;
  if (size < 0)
    return cli_parse_pair(text, 'x', mm) && mm[0] >= 20.0 && mm[1] >= 20.0 && mm[0] <= 2e4 && mm[1] <= 2e4;
  int is_upright = size <= 5 && strcmp(text + 2, ":upright") == 0;
  if (size > 5 || (text[2] && !is_upright))
    return 0;
  mm[is_upright] = a0[size];
  mm[!is_upright] = a0[size + 1];
  return 1;
}

/* --- the work --- */

/* The unit, and whether there is a north. */
static conic_status know_world(cli_sheet_job *job) {
  conic_status status = conic_source_georeference(job->scene.source, &job->reference);
  if (!job->is_unit_given)
    job->unit_m = job->reference.unit_m > 0.0 ? job->reference.unit_m : 1.0;
  job->unit = conic_unit_name(job->unit_m);
  return status;
}

/* What the colours of values mean, where they were asked for. */
static conic_status add_legend(cli_sheet_job *job) {
  const conic_coloring *coloring = conic_source_coloring(job->scene.source);
  if (!coloring || !coloring->field[0] || !cli_color_is_asked(&job->scene.coloring) || job->n_panels == CLI_MOST_PANELS)
    return CONIC_OK;
  enum { DOTS_A_PIXEL = 150 };
  job->legend_pixels = job->dpi > DOTS_A_PIXEL ? (int)(job->dpi / DOTS_A_PIXEL + 0.5) : 1;
  job->panels[job->n_panels++] = (cli_panel){.kind = CLI_PANEL_LEGEND};
  return conic_legend_make(job->session->context, coloring, job->unit, &job->legend);
}

static conic_status draw_panels(cli_sheet_job *job) {
  enum { USUAL_STOPS = 4 };
  cli_render_job *scene = &job->scene;
  conic_status status = know_world(job);
  if (status == CONIC_OK)
    status = add_legend(job);
  if (status == CONIC_OK)
    status = cli_sheet_place(job);
  if (status == CONIC_OK)
    status = cli_sheet_lay_out(job);
  if (!scene->is_shade_given && !(scene->abilities & CONIC_SOURCE_COMPOSITES)) {
    scene->shot.light.dome_stops = USUAL_STOPS; /* without perspective, only shades tell what is how deep */
    if (conic_source_measure(scene->source)->has_colors)
      scene->shot.render.shading = CONIC_SHADE_NONE; /* photographs have their light already */
  }
  cli_shot_take_options(scene);
  memcpy(scene->shot.light.lamps, scene->lamps.lamps, sizeof scene->shot.light.lamps);
  double start = cli_seconds();
  if (status == CONIC_OK)
    status = cli_panel_expose(job, &job->panels[0]);
  for (int i = 0; i < job->n_panels && status == CONIC_OK; i++)
    status = cli_panel_draw(job, &job->panels[i]);
  job->draw_seconds = cli_seconds() - start;
  return cli_units_agree(scene, status);
}

static conic_status write_sheet(cli_sheet_job *job) {
  double start = cli_seconds();
  conic_status status = cli_sheet_letter(job);
  if (status == CONIC_OK)
    status = cli_sheet_write(job);
  job->write_seconds = cli_seconds() - start;
  if (status == CONIC_OK && !job->statistics.pixels_covered)
    conic_log(job->session->context, CONIC_LOG_WARNING, "%s: the sheet is empty", job->scene.inputs[0]);
  return status;
}

static void report_sheet(cli_json *json, const void *cookie) {
  static const char *const kinds[] = {"plan", "facade", "section"};
  const cli_sheet_job *job = cookie;
  cli_json_text(json, "output", job->output);
  cli_json_counts(json, NULL, {"width", (uint64_t)job->width}, {"height", (uint64_t)job->height});
  cli_json_figures(json, NULL, {"dpi", job->dpi}, {"scale", job->scale}, {"gsd", 1.0 / job->ppu});
  cli_json_text(json, "unit", job->unit);
  if (job->reference.epsg)
    cli_json_count(json, "epsg", job->reference.epsg);
  cli_json_array(json, "panels");
  for (int i = 0; i < job->n_panels && job->panels[i].kind != CLI_PANEL_LEGEND; i++) {
    const cli_panel *panel = &job->panels[i];
    cli_json_object(json, NULL);
    cli_json_texts(json, NULL, {"kind", kinds[panel->kind]}, {"caption", panel->caption});
    cli_json_counts(json, NULL, {"x", (uint64_t)panel->x}, {"y", (uint64_t)panel->y}, {"width", (uint64_t)panel->width},
                    {"height", (uint64_t)panel->height});
    cli_json_figures(json, NULL, {"left", panel->signs[0] * (panel->left - panel->from_line)},
                     {"top", panel->signs[1] * panel->top});
    cli_json_close(json);
  }
  cli_json_close(json);
  cli_json_count(json, "pixels_covered", job->statistics.pixels_covered);
  double total = cli_seconds() - job->scene.start_seconds;
  cli_json_figures(json, "seconds", {"draw", job->draw_seconds}, {"write", job->write_seconds},
                   {"other", total - job->draw_seconds - job->write_seconds}, {"total", total});
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
}

static int make_sheet(cli_session *session, void *cookie) {
  cli_sheet_job *job = cookie;
  cli_render_job *scene = &job->scene;
  conic_status status = cli_scene_begin(session, scene);
  if (status == CONIC_OK && cli_units_choose(session, scene) != CLI_DONE)
    status = CONIC_ERROR_ARGUMENT;
  if (status == CONIC_OK && !cli_units_are_others(session, scene))
    status = cli_scene_open(session, scene);
  if (status == CONIC_OK)
    cli_units_settle(scene);
  if (status == CONIC_OK && !cli_units_are_others(session, scene))
    status = draw_panels(job);
  if (status == CONIC_OK && cli_session_speaks(session))
    status = write_sheet(job);
  int exit_code = cli_exit_of(status);
  if (exit_code == CLI_DONE && cli_session_speaks(session)) {
    exit_code = cli_json_write(session, report_sheet, job);
    if (!session->is_quiet && cli_json_leaves_text(session))
      printf("%s: %d x %d pixels, 1:%.6g at %g dpi\n", job->output, job->width, job->height, job->scale, job->dpi);
  }
  for (int i = 0; i < job->n_panels; i++)
    cli_top_store_close(&job->panels[i].store);
  cli_strokes_release(&job->strokes);
  conic_image_release(session->context, &job->legend);
  conic_georeference_release(session->context, &job->reference);
  return exit_code;
}

static int check_sheet(cli_sheet_job *job, int has_plan, int *n_sections) {
  cli_session *session = job->session;
  cli_render_job *scene = &job->scene;
  *n_sections = 0;
  if (has_plan || job->n_panels == 0) { /* the first one */
    cli_panel plan = {.kind = CLI_PANEL_PLAN};
    if (job->n_panels == CLI_MOST_PANELS)
      return cli_usage("sheet: more than %d panels", CLI_MOST_PANELS);
    memmove(job->panels + 1, job->panels, (size_t)job->n_panels++ * sizeof plan);
    job->panels[0] = plan;
  }
  for (int i = 0; i < job->n_panels; i++)
    *n_sections += job->panels[i].kind == CLI_PANEL_SECTION;
  if (!job->output)
    return cli_usage("sheet: no output; give one with -o SHEET.png, .tif or .pdf");
  if (!conic_file_has_ending(job->output, "png") && !conic_file_has_ending(job->output, "tif") &&
      !conic_file_has_ending(job->output, "tiff") && !conic_file_has_ending(job->output, "pdf"))
    return cli_usage("%s: a sheet is a .png, a .tif or a .pdf", job->output);
  if (job->scale > 0.0 && job->gsd > 0.0)
    return cli_usage("sheet: --scale and --gsd are two ways to say how large; give one of both");
  if (job->beyond >= 0.0 && !*n_sections)
    return cli_usage("sheet: --beyond is of --section; give one, too");
  if (job->is_north_given && job->panels[0].kind != CLI_PANEL_PLAN && job->n_panels > 0) {
    int has_facade = 0;
    for (int i = 0; i < job->n_panels; i++)
      has_facade |= job->panels[i].kind == CLI_PANEL_FACADE && !job->panels[i].has_line;
    if (!has_facade)
      return cli_usage("sheet: --north is of plans, and of the names of facades; give --plan, too");
  }
  if (job->beyond < 0.0)
    job->beyond = HUGE_VAL;
  if (!job->title)
    job->title = conic_file_name(scene->inputs[0]);
  int answer = cli_check_outputs(session, &job->output, 1);
  return answer == CLI_DONE ? cli_scene_inputs_stay(session, scene, &job->output, 1) : answer;
}

static int run_sheet(cli_session *session, int argc, char **argv) {
  /* A sheet's own cameras and paper stand for these. */
  static const char *const left_out[] = {"size", "camera",     "view",       "azimuth", "elevation", "fov",   "zoom",
                                         "eye",  "projection", "background", "aov",     "near",      "plain", NULL};
  cli_sheet_job job = {.session = session, .dpi = 300.0, .beyond = -1.0, .unit_m = 1.0};
  int has_plan = 0, unit = 0, n_sections, memory_mib = 2048;
  cli_scene_defaults(&job.scene);
  job.scene.is_for_looking = 1;
  job.scene.left_out = left_out;
  job.scene.projection = CONIC_CAMERA_ORTHOGRAPHIC;
  job.scene.start_seconds = cli_seconds();
  job.scene.frames = (cli_frames){1, 1, 1, 0};
  const cli_option own[] = {
      {"o", CLI_TEXT, &job.output, "SHEET", "where the sheet goes: .png, .tif or .pdf", .group = "sheet",
       .intro = "What is drawn, and on what paper."},
      {"plan", CLI_FLAG, &has_plan, NULL, "seen from straight above [where nothing else is asked for]"},
      {"facade", CLI_PARSED, &job, "AZ|A:B",
       "seen level from an azimuth, 0 in front and 90 from the right, or from the line between two places of the plan, "
       "X,Y:X,Y, of which A is on the left; may be repeated",
       .parse = parse_facade, .may_repeat = 1},
      {"section", CLI_PARSED, &job, "A:B[:DEPTH]",
       "cut along a line X,Y:X,Y and seen level, A on the left; what lies up to DEPTH behind it is black [0.7 mm on "
       "paper], all else behind it light, and triangles are cut in a strong line; may be repeated",
       .parse = parse_section, .may_repeat = 1},
      {"beyond", CLI_NUMBER, &job.beyond, "D", "of a section, what lies more than D behind the black is left out [all]",
       0, 1e29},
      {"scale", CLI_PARSED, &job.scale, "1:N", "the scale [the first usual one that fits on the paper, or on an A3]",
       .parse = parse_scale},
      {"dpi", CLI_NUMBER, &job.dpi, "N", "pixels of an inch of paper [300]", 10, 4800},
      {"gsd", CLI_NUMBER, &job.gsd, "G", "how much of the scene a pixel is wide, in its unit, in place of --scale",
       1e-12, 1e12},
      {"paper", CLI_PARSED, job.paper_mm, "SIZE",
       "A0 to A5, A3:upright, or WxH in millimetres [as large as the drawings need]", .parse = parse_paper,
       .is_given = &job.is_paper_given},
      {"title", CLI_TEXT, &job.title, "TEXT", "the sheet's title [the first file's name]"},
      {"grid", CLI_NUMBER, &job.grid, "D",
       "from one coordinate at the frame to the next, in the scene's unit [as fits]", 1e-9, 1e12},
      {"unit", CLI_CHOICE, &unit, "NAME", "the scene's unit: m, mm, cm, km, ft, us-ft or in [the file's, or m]",
       .choices = conic_unit_names, .is_given = &job.is_unit_given},
      {"north", CLI_NUMBER, &job.north_deg, "DEG",
       "where north is, clockwise from the top of the plan [0 where the file names its coordinate system, else none]",
       -360, 360, .is_given = &job.is_north_given},
      {"memory", CLI_INT, &memory_mib, "MiB", "what a panel's pixels, and clouds in levels, may take in memory [2048]",
       1, 1 << 20, .is_given = &job.scene.is_memory_given, .acts.is_work = 1},
      CLI_HIDDEN_LIGHT(&job.scene),
  };
  int exit_code = cli_scene_parse(session, own, (int)(sizeof own / sizeof own[0]), argc, argv, &job.scene);
  if (exit_code == CLI_DONE)
    exit_code = check_sheet(&job, has_plan, &n_sections);
  if (exit_code == CLI_DONE) {
    job.memory_bytes = (uint64_t)memory_mib << 20;
    if (job.scene.is_memory_given && job.scene.access.memory_bytes)
      job.scene.access.memory_bytes = job.memory_bytes;
    if (job.is_unit_given)
      job.unit_m = conic_unit_metres[unit];
    job.scene.shot.planes = conic_shot_needs(&job.scene.shot, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z);
  }
  return cli_scene_run(session, exit_code, &job.scene, make_sheet, &job);
}

const cli_command cli_sheet = {
    .name = "sheet",
    .is_shared = 1,
    .summary = "draws plans, facades and sections at a scale, on paper",
    .usage = "conic sheet IN… -o SHEET.png|.tif|.pdf [--plan] [--facade AZ|A:B] [--section A:B[:DEPTH]] "
             "[--scale 1:N] [options]",
    .run = run_sheet,
    .description =
        "Draws inputs as one scene, in panels side by side: seen from above, from its sides, and cut. It reads what "
        "conic render reads. Each panel is a parallel projection at one scale, with the coordinates of the file at its "
        "frame; beside them stand a scale bar, the title and, where there is one, north.",
    .examples = {{"a plan of a scan, on paper as large as it needs", "conic sheet scan.las --scale 1:200 -o plan.png"},
                 {"a plan, two facades and a section through the middle",
                  "conic sheet church.lpc --plan --facade 0 --facade 90 --section 0,10:40,10:0.3 --scale 1:100 "
                  "-o church.pdf"},
                 {"whatever scale fits on an A3", "conic sheet scan.e57 --paper A3 --facade 180 -o back.tif"}},
};
