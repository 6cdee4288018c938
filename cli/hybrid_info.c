#include "cli/hybrid_info.h"

#include <stdio.h>

typedef struct defect_name {
  size_t count;
  const char *key, *text;
} defect_name;

enum { N_DEFECTS = 4 };

static size_t list_defects(const conic_hybrid_defects *broken, defect_name list[N_DEFECTS]) {
  list[0] = (defect_name){broken->values, "values", "numbers that are not finite"};
  list[1] = (defect_name){broken->spheres, "spheres", "spheres that do not hold their patch"};
  list[2] = (defect_name){broken->cones, "cones", "cones that do not hold their patch's normals"};
  list[3] = (defect_name){broken->levels, "levels", "patches whose levels are out of order"};
  return broken->values + broken->spheres + broken->cones + broken->levels;
}

void cli_hybrid_print(const conic_hybrid_info *info, const conic_hybrid_defects *broken) {
  printf("patches    %zu: %zu of triangles, %zu of surfels\n", info->n_patches,
         info->n_patches - info->n_surfel_patches, info->n_surfel_patches);
  printf("triangles  %zu, %zu in all levels\n", info->n_triangles, info->n_all_triangles);
  printf("surfels    %zu, %zu in all levels\n", info->n_surfels, info->n_all_surfels);
  printf("levels     %zu, %.1f a patch\n", info->n_levels, (double)info->n_levels / (double)info->n_patches);
  printf("vertices   %zu\n", info->n_vertices);
  if (info->n_textures)
    printf("textures   %zu\n", info->n_textures);
  printf("cutoff     %g\n", (double)info->cutoff);
  printf("bounds     %.9g %.9g %.9g to %.9g %.9g %.9g\n", info->minimum[0], info->minimum[1], info->minimum[2],
         info->maximum[0], info->maximum[1], info->maximum[2]);
  if (!broken)
    return;
  defect_name list[N_DEFECTS];
  printf("sound      %s\n", list_defects(broken, list) ? "no" : "yes");
  for (int i = 0; i < N_DEFECTS; i++)
    if (list[i].count)
      printf("  %zu %s\n", list[i].count, list[i].text);
}

static void report_vector(cli_json *json, const char *key, const double vector[3]) {
  cli_json_array(json, key);
  for (int axis = 0; axis < 3; axis++)
    cli_json_number(json, NULL, vector[axis]);
  cli_json_close(json);
}

void cli_hybrid_report(cli_json *json, const conic_hybrid_info *info, const conic_hybrid_defects *broken) {
  cli_json_count(json, "triangles", info->n_triangles);
  cli_json_count(json, "surfels", info->n_surfels);
  cli_json_count(json, "clusters", info->n_patches);
  cli_json_count(json, "surfel_clusters", info->n_surfel_patches);
  cli_json_count(json, "nodes", info->n_nodes);
  cli_json_count(json, "levels", info->n_levels);
  cli_json_count(json, "all_triangles", info->n_all_triangles);
  cli_json_count(json, "all_surfels", info->n_all_surfels);
  cli_json_count(json, "vertices", info->n_vertices);
  cli_json_count(json, "textures", info->n_textures);
  cli_json_number(json, "cutoff", (double)info->cutoff);
  cli_json_number(json, "splat_length", info->splat_length);
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
