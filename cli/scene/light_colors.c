/* Colours of lights and backgrounds: in words, and in reports. */

#include "cli/scene/light_options.h"
#include "core/base/color.h"

static const struct {
  const char *name;
  uint32_t code;
} named[] = {{"black", 0x000000},    {"white", 0xffffff},     {"grey", 0x808080},      {"gray", 0x808080},
             {"silver", 0xc0c0c0},   {"lightgrey", 0xd3d3d3}, {"lightgray", 0xd3d3d3}, {"darkgrey", 0xa9a9a9},
             {"darkgray", 0xa9a9a9}, {"red", 0xff0000},       {"green", 0x008000},     {"blue", 0x0000ff},
             {"yellow", 0xffff00},   {"cyan", 0x00ffff},      {"magenta", 0xff00ff},   {"orange", 0xffa500},
             {"purple", 0x800080},   {"pink", 0xffc0cb},      {"brown", 0xa52a2a},     {"navy", 0x000080},
             {"teal", 0x008080},     {"lime", 0x00ff00},      {"olive", 0x808000},     {"maroon", 0x800000},
             {"gold", 0xffd700},     {"skyblue", 0x87ceeb},   {"beige", 0xf5f5dc},     {"ivory", 0xfffff0}};

/* A name of CSS, #rrggbb or #rgb, as display values. */
static int find_code(const char *text, uint32_t *code) {
  const size_t n_digits = strlen(text) - 1;
  for (size_t i = 0; i < sizeof named / sizeof *named; i++)
    if (strcmp(named[i].name, text) == 0) {
      *code = named[i].code;
      return 1;
    }
  if (text[0] != '#' || (n_digits != 6 && n_digits != 3) || strspn(text + 1, "0123456789abcdefABCDEF") != n_digits)
    return 0;
  *code = (uint32_t)strtoul(text + 1, NULL, 16);
  if (n_digits == 3)
    *code = ((*code >> 8) * 0x10000 + (*code >> 4 & 15) * 0x100 + (*code & 15)) * 0x11;
  return 1;
}

int cli_parse_color_to(const char *text, size_t length, double most, float color[3]) {
  char copy[128], grey[3 * sizeof copy];
  double rgb[3];
  uint32_t code;
  if (length == 0 || length >= sizeof copy)
    return 0;
  snprintf(copy, sizeof copy, "%.*s", (int)length, text);
  if (find_code(copy, &code)) {
    for (int i = 0; i < 3; i++)
      color[i] = (float)conic_srgb_decode((double)(code >> (16 - 8 * i) & 255) / 255.0);
    return 1;
  }
  snprintf(grey, sizeof grey, "%s,%s,%s", copy, copy, copy);
  if (!cli_parse_vector(strchr(copy, ',') ? copy : grey, rgb))
    return cli_because("a colour is 1 or 3 numbers, a name as white, or #rrggbb");
  for (int i = 0; i < 3; i++) {
    if (!(rgb[i] >= 0.0 && rgb[i] <= most))
      return cli_because(most > 1e6 ? "a colour is within 0 and 1e12" : "a colour is within 0 and 1e6");
    color[i] = (float)rgb[i];
  }
  return 1;
}

/* Three whole numbers up to 255, one of them far above what is white. */
static int is_of_codes(const char *text, size_t length, const float color[3]) {
  int is_bright = 0, is_whole = memchr(text, ',', length) != NULL;
  for (int i = 0; i < 3; i++) {
    is_bright |= color[i] > 32.0f;
    is_whole &= color[i] <= 255.0f && color[i] == (float)(int)color[i];
  }
  return is_bright && is_whole;
}

int cli_parse_color(const char *text, size_t length, float color[3]) {
  static _Thread_local char reason[96];
  if (!cli_parse_color_to(text, length, 1e6, color))
    return 0;
  if (!is_of_codes(text, length, color))
    return 1;
  snprintf(reason, sizeof reason, "1 is white here; as codes from 0 to 255 it is #%02x%02x%02x", (unsigned)color[0],
           (unsigned)color[1], (unsigned)color[2]);
  return cli_because(reason);
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
