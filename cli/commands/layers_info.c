#include "cli/commands/layers_info.h"

#include <inttypes.h>
#include <stdio.h>

#include "cli/commands/info_parts.h"

enum { N_DEFECTS = 4 };

static void list_layers_defects(const conic_layers_defects *broken, cli_defect list[N_DEFECTS]) {
  list[0] = (cli_defect){broken->clouds, "clouds", "clouds that are damaged"};
  list[1] = (cli_defect){broken->coverage, "coverage", "clouds that do not cover their place as they say"};
  list[2] = (cli_defect){broken->spheres, "spheres", "clouds whose sphere does not hold their place"};
  list[3] = (cli_defect){broken->cones, "cones", "clouds whose cone does not hold their normals"};
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
  cli_bounds_print(info->minimum, info->maximum);
  printf("bits       %.2f a sample: position %.2f, normal %.2f, colour %.2f, index %.2f\n",
         8.0 * (double)info->n_bytes / (double)info->n_samples, info->bits_position, info->bits_normal,
         info->bits_color, info->bits_index);
  if (!broken)
    return;
  cli_defect list[N_DEFECTS];
  list_layers_defects(broken, list);
  cli_defects_print(list, N_DEFECTS);
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
  cli_bounds_report(json, info->minimum, info->maximum);
  if (!broken)
    return;
  cli_defect list[N_DEFECTS];
  list_layers_defects(broken, list);
  cli_defects_report(json, list, N_DEFECTS);
}
