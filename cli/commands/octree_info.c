#include "cli/commands/octree_info.h"

#include <math.h>
#include <stdio.h>

#include "cli/commands/info_parts.h"

/* Half the opening of a cone whose cosine is given. */
static double cone_degrees(double cosine) {
  return acos(cosine < -1.0 ? -1.0 : cosine > 1.0 ? 1.0 : cosine) * (180.0 / 3.14159265358979323846);
}

enum { N_DEFECTS = 5 };

static void list_octree_defects(const conic_octree_defects *broken, cli_defect list[N_DEFECTS]) {
  list[0] = (cli_defect){broken->ellipses, "ellipses", "nodes whose ellipse does not hold its leaves"};
  list[1] = (cli_defect){broken->spheres, "spheres", "nodes whose sphere does not hold its leaves"};
  list[2] = (cli_defect){broken->cones, "cones", "nodes whose cone does not hold its leaves' normals"};
  list[3] = (cli_defect){broken->errors, "errors", "nodes that are farther from their leaves than they say"};
  list[4] = (cli_defect){broken->splats, "splats", "leaves that cannot be drawn"};
}

void cli_octree_print(const conic_octree_info *info, const conic_octree_defects *broken) {
  printf("points     %zu", info->n_points);
  if (info->n_leaves < info->n_points)
    printf(" (%zu cannot be drawn)", info->n_points - info->n_leaves);
  printf("\nnodes      %zu in %d levels, %.3f a point\n", info->n_nodes, info->n_levels,
         (double)info->n_nodes / (double)info->n_points);
  printf("leaves     %s", info->is_quantized ? "quantised" : "as they were");
  if (info->is_quantized)
    printf(": moved by %.3g at most", info->position_error);
  printf("\ncutoff     %g\n", (double)info->cutoff);
  cli_bounds_print(info->minimum, info->maximum);
  printf("radii      %.3g to %.3g, median %.3g\n", info->radius[0], info->radius[2], info->radius[1]);
  printf("cones      %.1f° to %.1f°, median %.1f°\n", cone_degrees(info->cone[2]), cone_degrees(info->cone[0]),
         cone_degrees(info->cone[1]));
  if (!broken)
    return;
  cli_defect list[N_DEFECTS];
  list_octree_defects(broken, list);
  cli_defects_print(list, N_DEFECTS);
}

static void report_three(cli_json *json, const char *key, double least, double median, double greatest) {
  cli_json_object(json, key);
  cli_json_number(json, "min", least);
  cli_json_number(json, "median", median);
  cli_json_number(json, "max", greatest);
  cli_json_close(json);
}

void cli_octree_report(cli_json *json, const conic_octree_info *info, const conic_octree_defects *broken) {
  cli_json_count(json, "points", info->n_points);
  cli_json_count(json, "leaves", info->n_leaves);
  cli_json_count(json, "nodes", info->n_nodes + info->n_leaves);
  cli_json_count(json, "inner_nodes", info->n_nodes);
  cli_json_count(json, "levels", (uint64_t)info->n_levels);
  cli_json_number(json, "bytes_per_point", (double)info->n_bytes / (double)info->n_points);
  cli_json_bool(json, "quantized", info->is_quantized);
  cli_json_number(json, "position_error", info->position_error);
  cli_json_number(json, "cutoff", (double)info->cutoff);
  cli_json_number(json, "splat_length", info->splat_length);
  cli_json_number(json, "near", info->near_z);
  cli_bounds_report(json, info->minimum, info->maximum);
  report_three(json, "radius", info->radius[0], info->radius[1], info->radius[2]);
  report_three(json, "cone_deg", cone_degrees(info->cone[2]), cone_degrees(info->cone[1]), cone_degrees(info->cone[0]));
  if (!broken)
    return;
  cli_defect list[N_DEFECTS];
  list_octree_defects(broken, list);
  cli_defects_report(json, list, N_DEFECTS);
}
