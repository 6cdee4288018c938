#include "cli/octree_info.h"

#include <math.h>
#include <stdio.h>

/* Half the opening of a cone whose cosine is given. */
static double cone_degrees(double cosine) {
  return acos(cosine < -1.0 ? -1.0 : cosine > 1.0 ? 1.0 : cosine) * (180.0 / 3.14159265358979323846);
}

/* What can be broken, and what to call it. */
typedef struct defect_name {
  size_t count;
  const char *key, *text;
} defect_name;

enum { N_DEFECTS = 5 };

static void list_defects(const conic_octree_defects *broken, defect_name list[N_DEFECTS]) {
  list[0] = (defect_name){broken->ellipses, "ellipses", "nodes whose ellipse does not hold its leaves"};
  list[1] = (defect_name){broken->spheres, "spheres", "nodes whose sphere does not hold its leaves"};
  list[2] = (defect_name){broken->cones, "cones", "nodes whose cone does not hold its leaves' normals"};
  list[3] = (defect_name){broken->errors, "errors", "nodes that are farther from their leaves than they say"};
  list[4] = (defect_name){broken->splats, "splats", "leaves that cannot be drawn"};
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
  printf("bounds     %.9g %.9g %.9g to %.9g %.9g %.9g\n", info->minimum[0], info->minimum[1], info->minimum[2],
         info->maximum[0], info->maximum[1], info->maximum[2]);
  printf("radii      %.3g to %.3g, median %.3g\n", info->radius[0], info->radius[2], info->radius[1]);
  printf("cones      %.1f° to %.1f°, median %.1f°\n", cone_degrees(info->cone[2]), cone_degrees(info->cone[0]),
         cone_degrees(info->cone[1]));
  if (!broken)
    return;
  defect_name list[N_DEFECTS];
  size_t n_broken = 0;
  list_defects(broken, list);
  for (int i = 0; i < N_DEFECTS; i++)
    n_broken += list[i].count;
  printf("sound      %s\n", n_broken ? "no" : "yes");
  for (int i = 0; i < N_DEFECTS; i++)
    if (list[i].count)
      printf("  %zu %s\n", list[i].count, list[i].text);
}

static void report_three(cli_json *json, const char *key, double least, double median, double greatest) {
  cli_json_object(json, key);
  cli_json_number(json, "min", least);
  cli_json_number(json, "median", median);
  cli_json_number(json, "max", greatest);
  cli_json_close(json);
}

static void report_vector(cli_json *json, const char *key, const double vector[3]) {
  cli_json_array(json, key);
  for (int axis = 0; axis < 3; axis++)
    cli_json_number(json, NULL, vector[axis]);
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
  cli_json_object(json, "bounds");
  report_vector(json, "min", info->minimum);
  report_vector(json, "max", info->maximum);
  cli_json_close(json);
  report_three(json, "radius", info->radius[0], info->radius[1], info->radius[2]);
  report_three(json, "cone_deg", cone_degrees(info->cone[2]), cone_degrees(info->cone[1]), cone_degrees(info->cone[0]));
  if (!broken)
    return;
  defect_name list[N_DEFECTS];
  list_defects(broken, list);
  cli_json_object(json, "defects");
  for (int i = 0; i < N_DEFECTS; i++)
    cli_json_count(json, list[i].key, list[i].count);
  cli_json_close(json);
}
