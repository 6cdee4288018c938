#include "cli/commands/info_parts.h"

#include <inttypes.h>
#include <stdio.h>

void cli_bounds_print(const double low[3], const double high[3]) {
  printf("bounds     %.9g %.9g %.9g to %.9g %.9g %.9g\n", low[0], low[1], low[2], high[0], high[1], high[2]);
}

static void report_vector(cli_json *json, const char *key, const double vector[3]) {
  cli_json_array(json, key);
  for (int axis = 0; axis < 3; axis++)
    cli_json_number(json, NULL, vector[axis]);
  cli_json_close(json);
}

void cli_bounds_report(cli_json *json, const double low[3], const double high[3]) {
  cli_json_object(json, "bounds");
  report_vector(json, "min", low);
  report_vector(json, "max", high);
  cli_json_close(json);
}

void cli_defects_print(const cli_defect *list, int n) {
  int is_sound = 1;
  for (int i = 0; i < n; i++)
    is_sound &= list[i].count == 0;
  printf("sound      %s\n", is_sound ? "yes" : "no");
  for (int i = 0; i < n; i++)
    if (list[i].count)
      printf("  %" PRIu64 " %s\n", list[i].count, list[i].text);
}

void cli_defects_report(cli_json *json, const cli_defect *list, int n) {
  cli_json_object(json, "defects");
  for (int i = 0; i < n; i++)
    cli_json_count(json, list[i].key, list[i].count);
  cli_json_close(json);
}
