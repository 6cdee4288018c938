#include "cli/layers_info.h"

#include <inttypes.h>
#include <stdio.h>

/* What can be broken, and what to call it. */
typedef struct defect_name {
  uint64_t count;
  const char *key, *text;
} defect_name;

enum { N_DEFECTS = 4 };

static void list_defects(const conic_layers_defects *broken, defect_name list[N_DEFECTS]) {
  list[0] = (defect_name){broken->clouds, "clouds", "clouds that are damaged"};
  list[1] = (defect_name){broken->coverage, "coverage", "clouds that do not cover their place as they say"};
  list[2] = (defect_name){broken->spheres, "spheres", "clouds whose sphere does not hold their place"};
  list[3] = (defect_name){broken->cones, "cones", "clouds whose cone does not hold their normals"};
}

int cli_layers_are_sound(const conic_layers_defects *broken) {
  return broken->clouds + broken->coverage + broken->spheres + broken->cones == 0;
}

void cli_layers_print(const conic_layers_info *info, const conic_layers_defects *broken) {
  printf("samples    %" PRIu64 "%s%s\n", info->n_samples, info->has_colors ? ", with colours" : "",
         info->is_unoriented ? ", normals without a side" : "");
  printf("clouds     %" PRIu64 " in %d levels, %u samples asked for, %u in the largest\n", info->n_clouds,
         info->n_levels, (unsigned)info->cloud_size, (unsigned)info->most_samples);
  printf("spacing    %.4g; positions in steps of %.4g, moved by %.3g at most\n", info->spacing, info->quantum,
         info->position_error);
  printf("outline    %.4g, the median at full resolution\n", info->splat_radius);
  printf("bounds     %.9g %.9g %.9g to %.9g %.9g %.9g\n", info->minimum[0], info->minimum[1], info->minimum[2],
         info->maximum[0], info->maximum[1], info->maximum[2]);
  printf("bits       %.2f a sample: position %.2f, normal %.2f, colour %.2f, index %.2f\n",
         8.0 * (double)info->n_bytes / (double)info->n_samples, info->bits_position, info->bits_normal,
         info->bits_color, info->bits_index);
  if (!broken)
    return;
  defect_name list[N_DEFECTS];
  list_defects(broken, list);
  printf("sound      %s\n", cli_layers_are_sound(broken) ? "yes" : "no");
  for (int i = 0; i < N_DEFECTS; i++)
    if (list[i].count)
      printf("  %" PRIu64 " %s\n", list[i].count, list[i].text);
}

static void report_vector(cli_json *json, const char *key, const double vector[3]) {
  cli_json_array(json, key);
  for (int axis = 0; axis < 3; axis++)
    cli_json_number(json, NULL, vector[axis]);
  cli_json_close(json);
}

void cli_layers_report(cli_json *json, const conic_layers_info *info, const conic_layers_defects *broken) {
  cli_json_count(json, "points", info->n_samples);
  cli_json_count(json, "clouds", info->n_clouds);
  cli_json_count(json, "levels", (uint64_t)info->n_levels);
  cli_json_count(json, "cloud_size", info->cloud_size);
  cli_json_count(json, "largest_cloud", info->most_samples);
  cli_json_bool(json, "colors", info->has_colors);
  cli_json_bool(json, "oriented", !info->is_unoriented);
  cli_json_number(json, "bytes_per_point", (double)info->n_bytes / (double)info->n_samples);
  cli_json_number(json, "bits_per_sample", 8.0 * (double)info->n_bytes / (double)info->n_samples);
  cli_json_object(json, "bits");
  cli_json_number(json, "position", info->bits_position);
  cli_json_number(json, "normal", info->bits_normal);
  cli_json_number(json, "colour", info->bits_color);
  cli_json_number(json, "index", info->bits_index);
  cli_json_close(json);
  cli_json_number(json, "spacing", info->spacing);
  cli_json_number(json, "quantum", info->quantum);
  cli_json_number(json, "position_error", info->position_error);
  cli_json_number(json, "splat_radius", info->splat_radius);
  cli_json_number(json, "near", info->near_z);
  cli_json_object(json, "bounds");
  report_vector(json, "min", info->minimum);
  report_vector(json, "max", info->maximum);
  cli_json_close(json);
  if (!broken)
    return;
  defect_name list[N_DEFECTS];
  list_defects(broken, list);
  cli_json_object(json, "defects");
  for (int i = 0; i < N_DEFECTS; i++)
    cli_json_count(json, list[i].key, list[i].count);
  cli_json_close(json);
}
