#include "bench/loops/cross.h"

/* A family more is a line here. */
static int (*const families[])(cross *c) = {cli_cross_splats,  cli_cross_triangles, cli_cross_texture,
                                            cli_cross_surface, cli_cross_octree,    cli_cross_neighbours};

int cli_cross_all(uint64_t seed, int n_timed) {
  const int is_bench = n_timed > 0;
  cross c = {.seed = seed, .is_bench = is_bench};
  if (is_bench)
    printf("%-15s  %-15s  %-6s  %22s  %8s\n", "slot", "variant", "isa", "time", "scalar");
  else
    printf("seed %llu\n", (unsigned long long)seed);
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++) {
    cross_tables *tables = &c.tables[c.n_tables];
    if (conic_isa_is_here((conic_isa)isa)) {
      tables->isa = (conic_isa)isa;
      tables->n_timed = n_timed;
      conic_raster_loops_init(&tables->raster, tables->isa);
      conic_surface_loops_init(&tables->surface, tables->isa);
      conic_octree_loops_init(&tables->octree, tables->isa);
      conic_neighbour_loops_init(&tables->neighbours, tables->isa);
      c.n_tables++;
    }
    if (!is_bench)
      printf("%s: %s\n", conic_isa_name((conic_isa)isa), conic_isa_is_here((conic_isa)isa) ? "compared" : "not here");
  }
  for (size_t i = 0; i < sizeof families / sizeof families[0]; i++)
    c.n_failures += families[i](&c);
  return c.n_failures;
}
