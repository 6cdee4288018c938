#include "cli/color_options.h"

#include "core/base/nearest_word.h"

const char *const cli_color_words[] = {"auto", "rgb", "intensity", "height", "classification", "normal", NULL};
const char *const cli_ramp_words[] = {"sequential", "grey",  "heat",  "diverging", "terrain",
                                      "viridis",    "magma", "turbo", "classes",   NULL};

int cli_parse_color_range(const char *text, void *value) {
  conic_coloring_options *coloring = value;
  double range[2];
  if (!cli_parse_pair(text, ',', range))
    return 0;
  coloring->has_range = 1;
  coloring->minimum = range[0];
  coloring->maximum = range[1];
  double extent = range[1] - range[0];
  return (extent > 0.0 && extent - extent == 0.0) || cli_because("the second end is above the first");
}

int cli_parse_ramp(const char *text, void *value) {
  conic_coloring_options *coloring = value;
  size_t length = strcspn(text, ":");
  if (*text && strchr("+-.0123456789", *text))
    return cli_parse_color_range(text, value);
  coloring->ramp = text;
  for (int i = 0; conic_ramp_name(i); i++)
    if (strlen(conic_ramp_name(i)) == length && strncmp(conic_ramp_name(i), text, length) == 0)
      coloring->ramp = conic_ramp_name(i);
  return *text && (!text[length] || cli_parse_color_range(text + length + 1, value));
}

static int check_ramp(const cli_session *session, const char *ramp) {
  char names[128] = "";
  const char *nearest = NULL, *name;
  for (int i = 0; (name = conic_ramp_name(i)); i++) {
    if (strcmp(name, ramp) == 0)
      return CLI_DONE;
    snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", i ? ", " : "", name);
    nearest = conic_nearer_word(ramp, nearest, name);
  }
  return cli_usage("%s: there is no ramp '%s'%s%s%s; there are %s", session->command, ramp,
                   nearest ? " (did you mean '" : "", nearest ? nearest : "", nearest ? "'?)" : "", names);
}

int cli_color_check(const cli_session *session, conic_coloring_options *coloring, int is_auto) {
  if (coloring->by && !*coloring->by)
    return cli_usage("%s: --color-by needs a word", session->command);
  if (!coloring->by && is_auto)
    coloring->by = "auto";
  if (!coloring->by && (coloring->ramp || coloring->has_range))
    return cli_usage("%s: --ramp is about --color-by; give it, too", session->command);
  return coloring->ramp ? check_ramp(session, coloring->ramp) : CLI_DONE;
}

int cli_color_check_texture(const cli_session *session, const conic_coloring_options *coloring, const char *texture) {
  if (!texture || !cli_color_is_asked(coloring))
    return CLI_DONE;
  return cli_usage("%s: --texture has no effect: --color-by %s colours the surface in its place", session->command,
                   coloring->by);
}

int cli_color_is_asked(const conic_coloring_options *coloring) {
  return coloring->by && strcmp(coloring->by, "rgb") != 0 && strcmp(coloring->by, "auto") != 0;
}

void cli_color_report(cli_json *json, const conic_coloring *coloring) {
  if (!coloring || !coloring->field[0])
    return;
  cli_json_object(json, "coloring");
  cli_json_text(json, "field", coloring->field);
  if (coloring->ramp) {
    cli_json_figures(json, NULL, {"minimum", coloring->minimum}, {"maximum", coloring->maximum});
    cli_json_texts(json, NULL, {"ramp", coloring->ramp}, {"scale", coloring->is_root ? "root" : "linear"});
  }
  cli_json_close(json);
}
