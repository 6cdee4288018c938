#include "cli/commands/hybrid_info.h"

#include <stdio.h>

#include "cli/commands/info_parts.h"

enum { N_DEFECTS = 4 };

static void list_defects(const conic_hybrid_defects *broken, cli_defect list[N_DEFECTS]) {
  list[0] = (cli_defect){broken->values, "values", "numbers that are not finite"};
  list[1] = (cli_defect){broken->spheres, "spheres", "spheres that do not hold their patch"};
  list[2] = (cli_defect){broken->cones, "cones", "cones that do not hold their patch's normals"};
  list[3] = (cli_defect){broken->levels, "levels", "patches whose levels are out of order"};
}

void cli_hybrid_print(const conic_hybrid_info *info, const conic_hybrid_defects *broken) {
  printf("patches    %zu: %zu of triangles, %zu of surfels\n", info->n_clusters,
         info->n_clusters - info->n_surfel_clusters, info->n_surfel_clusters);
  printf("triangles  %zu, %zu in all levels\n", info->n_triangles, info->n_all_triangles);
  printf("surfels    %zu, %zu in all levels\n", info->n_surfels, info->n_all_surfels);
  printf("levels     %zu, %.1f a patch\n", info->n_levels, (double)info->n_levels / (double)info->n_clusters);
  printf("nodes      %zu with %zu levels\n", info->n_nodes, info->n_node_levels);
  printf("vertices   %zu\n", info->n_vertices);
  if (info->n_textures)
    printf("textures   %zu\n", info->n_textures);
  printf("cutoff     %g\n", (double)info->cutoff);
  cli_bounds_print(info->minimum, info->maximum);
  if (!broken)
    return;
  cli_defect list[N_DEFECTS];
  list_defects(broken, list);
  cli_defects_print(list, N_DEFECTS);
}

void cli_hybrid_report(cli_json *json, const conic_hybrid_info *info, const conic_hybrid_defects *broken) {
  cli_json_count(json, "triangles", info->n_triangles);
  cli_json_count(json, "surfels", info->n_surfels);
  cli_json_count(json, "clusters", info->n_clusters);
  cli_json_count(json, "surfel_clusters", info->n_surfel_clusters);
  cli_json_count(json, "nodes", info->n_nodes);
  cli_json_count(json, "levels", info->n_levels);
  cli_json_count(json, "node_levels", info->n_node_levels);
  cli_json_count(json, "all_triangles", info->n_all_triangles);
  cli_json_count(json, "all_surfels", info->n_all_surfels);
  cli_json_count(json, "vertices", info->n_vertices);
  cli_json_count(json, "textures", info->n_textures);
  cli_json_number(json, "cutoff", (double)info->cutoff);
  cli_json_number(json, "splat_length", info->splat_length);
  cli_json_number(json, "near", info->near_z);
  cli_bounds_report(json, info->minimum, info->maximum);
  if (!broken)
    return;
  cli_defect list[N_DEFECTS];
  list_defects(broken, list);
  cli_defects_report(json, list, N_DEFECTS);
}
