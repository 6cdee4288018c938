/* Colours of lights and backgrounds: in words, and in reports. */

#include "cli/scene/light_options.h"

int cli_parse_color_to(const char *text, size_t length, double most, float color[3]) {
  char copy[128], grey[3 * sizeof copy];
  double rgb[3];
  if (length == 0 || length >= sizeof copy)
    return 0;
  snprintf(copy, sizeof copy, "%.*s", (int)length, text);
  snprintf(grey, sizeof grey, "%s,%s,%s", copy, copy, copy);
  if (!cli_parse_vector(strchr(copy, ',') ? copy : grey, rgb))
    return cli_because("a colour is 1 or 3 numbers");
  for (int i = 0; i < 3; i++) {
    if (!(rgb[i] >= 0.0 && rgb[i] <= most))
      return cli_because(most > 1e6 ? "a colour is within 0 and 1e12" : "a colour is within 0 and 1e6");
    color[i] = (float)rgb[i];
  }
  return 1;
}

int cli_parse_color(const char *text, size_t length, float color[3]) {
  return cli_parse_color_to(text, length, 1e6, color);
}

void cli_report_color(cli_json *json, const char *key, const float color[3]) {
  char text[32];
  cli_json_array(json, key);
  for (int i = 0; i < 3; i++) {
    snprintf(text, sizeof text, "%.7g", (double)color[i]);
    cli_json_number(json, NULL, strtod(text, NULL));
  }
  cli_json_close(json);
}
