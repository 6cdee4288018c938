/* Sources: each kind is opened, measured, chosen from and drawn, and is the picture that the kind's own functions draw;
 * what is no source is refused, and running out of memory leaves nothing behind. */
#include "tests/support/files.h"
#include "tests/support/fixture.h"

enum { WIDTH = 96, HEIGHT = 64, SIDE = 24 };

typedef struct allocator {
  long n_calls, n_alive, failing_call; /* the last from 1; 0: none */
} allocator;

static allocator memory;
static int has_layers;

static void *allocate(void *cookie, size_t bytes) {
  allocator *self = cookie;
  if (++self->n_calls == self->failing_call)
    return NULL;
  self->n_alive++;
  return malloc(bytes);
}

static void release(void *cookie, void *pointer) {
  ((allocator *)cookie)->n_alive -= pointer != NULL;
  free(pointer);
}

/* One thread, so that the allocator need not be safe for several. */
static fixture open_counted(void) {
  fixture f = {0};
  conic_context_options options;
  conic_context_options_init(&options);
  options.allocate = allocate;
  options.release = release;
  options.allocator_cookie = &memory;
  options.log = files_log;
  options.threads = 1;
  if (conic_context_create(&options, &f.context) != CONIC_OK ||
      conic_renderer_create(f.context, &f.renderer) != CONIC_OK)
    exit(1);
  conic_render_options_init(&f.options);
  return f;
}

/* --- files --- */

static void write_mesh(const char *path) {
  FILE *file = fopen(path, "w");
  for (int y = 0; y <= SIDE; y++)
    for (int x = 0; x <= SIDE; x++)
      fprintf(file, "v %g %g %g\n", (double)x / SIDE, 0.1 * ((x * y) % 5) / SIDE, (double)y / SIDE);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++)
      fprintf(file, "f %d %d %d %d\n", y * (SIDE + 1) + x + 1, (y + 1) * (SIDE + 1) + x + 1,
              (y + 1) * (SIDE + 1) + x + 2, y * (SIDE + 1) + x + 2);
  fclose(file);
}

static void write_octree(conic_context *context, const conic_splats *splats, const char *path) {
  conic_octree_options options;
  conic_octree *octree;
  conic_splats copy = {0};
  conic_octree_options_init(&options);
  CHECK_OK(conic_splats_append(context, &copy, splats));
  CHECK_OK(conic_octree_build(context, &copy, &options, &octree));
  CHECK_OK(conic_octree_write(octree, path));
  conic_octree_destroy(octree);
}

static void write_layers(conic_context *context, const conic_splats *splats, const char *path) {
  conic_layers_builder *builder;
  conic_status status = conic_layers_builder_open(context, path, NULL, &builder);
  has_layers = status != CONIC_ERROR_UNSUPPORTED;
  if (!has_layers)
    return;
  CHECK_OK(conic_layers_builder_append(builder, splats));
  CHECK_OK(conic_layers_builder_finish(builder, NULL));
}

static conic_hybrid *build_hybrid(conic_context *context, const char *mesh_path) {
  conic_hybrid_options options;
  conic_triangles mesh;
  conic_hybrid *hybrid;
  conic_hybrid_options_init(&options);
  CHECK_OK(conic_triangles_read(context, mesh_path, &mesh));
  CHECK_OK(conic_hybrid_build(context, &mesh, &options, &hybrid, NULL));
  return hybrid;
}

static char paths[5][160]; /* .ply, .obj, .cot, .lpc, .chy */
enum { PLY, OBJ, COT, LPC, CHY };

static void write_files(void) {
  static const char *const names[] = {"points.ply", "mesh.obj", "tree.cot", "layers.lpc", "model.chy"};
  fixture f = open_counted();
  for (int i = 0; i < 5; i++)
    snprintf(paths[i], sizeof paths[i], "%s", files_path(names[i]));
  fixture_scene(&f, CONIC_SCENE_KNOT, 3000);
  CHECK_OK(conic_splats_write(f.context, paths[PLY], &f.splats, NULL));
  write_mesh(paths[OBJ]);
  write_octree(f.context, &f.splats, paths[COT]);
  write_layers(f.context, &f.splats, paths[LPC]);
  conic_hybrid *hybrid = build_hybrid(f.context, paths[OBJ]);
  CHECK_OK(conic_hybrid_write(hybrid, paths[CHY]));
  conic_hybrid_destroy(hybrid);
  fixture_close(&f);
}

/* --- pictures --- */

static unsigned planes_of(unsigned abilities) {
  return CONIC_DRAWN_PLANES | (abilities & CONIC_SOURCE_CLUSTERS ? 1u << CONIC_PLANE_CLUSTER : 0u);
}

static conic_source *open_source(fixture *f, const char *path, const conic_source_options *options) {
  conic_source *source;
  if (conic_source_open(f->context, &path, 1, options, &source) != CONIC_OK) {
    fprintf(stderr, "%s: %s\n", path, files_message);
    exit(1);
  }
  conic_framing framing;
  conic_framing_init(&framing);
  framing.width = WIDTH;
  framing.height = HEIGHT;
  CHECK_OK(conic_source_frame(source, &framing, &f->camera));
  unsigned planes = planes_of(conic_source_measure(source)->abilities);
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, WIDTH, HEIGHT, planes, &f->image));
  return source;
}

/* The picture of a drawing, and whether it is the fixture's. */
static void expect_drawing(fixture *f, const char *what, const conic_drawing *drawing,
                           const conic_render_options *options, void (*name)(const void *, conic_image *),
                           const void *selection) {
  conic_image image;
  int n_wrong = 0;
  unsigned planes = 0;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    planes |= f->image.planes[i] ? 1u << i : 0u;
  CHECK_OK(conic_image_allocate(f->context, WIDTH, HEIGHT, planes, &image));
  CHECK_OK(conic_render_drawing(f->context, f->renderer, drawing, &f->camera, options, 1, &image, NULL));
  if (name)
    name(selection, &image);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    n_wrong +=
        image.planes[i] && conic_image_hash(&image, (conic_plane)i) != conic_image_hash(&f->image, (conic_plane)i);
  if (n_wrong)
    fprintf(stderr, "%s: %d planes differ\n", what, n_wrong);
  CHECK(n_wrong == 0 && f->statistics.pixels_covered > 100);
  conic_image_release(f->context, &image);
}

static void draw_source(fixture *f, conic_source *source, const conic_source_view *view) {
  CHECK_OK(conic_source_draw(source, f->renderer, &f->camera, &f->options, view, &f->image, &f->statistics));
}

/* The fact of a key in what is told of the last picture; null: there is none. */
static conic_fact find_fact(const fixture *f, const conic_source *source, const char *key) {
  conic_facts *facts;
  conic_fact found = {.type = CONIC_FACT_END};
  const conic_fact *fact;
  CHECK_OK(conic_source_describe(source, &f->statistics, &facts));
  for (size_t i = 0; (fact = conic_facts_at(facts, i)); i++)
    if (fact->key && strcmp(fact->key, key) == 0)
      found = *fact;
  conic_facts_destroy(facts);
  return found;
}

static void expect_count(const fixture *f, const conic_source *source, const char *key, uint64_t count) {
  conic_fact fact = find_fact(f, source, key);
  CHECK(fact.type == CONIC_FACT_COUNT && fact.count == count);
}

/* Splats, a mesh as points and a mesh as triangles: what their own readers make of them. */
static void test_drawings(void) {
  for (int i = 0; i < 3; i++) {
    fixture f = open_counted();
    conic_source_options opening;
    conic_source_options_init(&opening);
    opening.as = i == 2 ? CONIC_AS_MESH : CONIC_AS_POINTS;
    const char *path = paths[i == 0 ? PLY : OBJ];
    CHECK(conic_source_abilities(&path, 1, &opening) == 0);
    conic_source *source = open_source(&f, path, &opening);
    const conic_source_scale *scale = conic_source_measure(source);
    draw_source(&f, source, NULL);
    conic_model model = {0};
    conic_triangles triangles = {0};
    conic_estimate_options estimate;
    conic_estimate_options_init(&estimate);
    estimate.stays_at_mesh = 1;
    if (i == 2)
      CHECK_OK(conic_triangles_read(f.context, path, &triangles));
    else {
      CHECK_OK(conic_model_read(f.context, path, NULL, &model));
      CHECK_OK(conic_model_to_splats(f.context, &estimate, &model, NULL));
    }
    const conic_drawing drawing = {&model.points, &triangles};
    expect_drawing(&f, path, &drawing, &f.options, NULL, NULL);
    CHECK(scale->n_splats == model.points.count && scale->n_triangles == triangles.count);
    CHECK(scale->near_z == conic_drawing_near(&drawing) && scale->up[1] == 1.0 && scale->epsilon < 0.0);
    CHECK(conic_source_chosen(source)->is_all && !conic_source_name_splat(source, 0, NULL));
    CHECK(find_fact(&f, source, "error_px").type == CONIC_FACT_END);
    expect_count(&f, source, "splats", f.statistics.splats_drawn);
    double spacing, own;
    CHECK_OK(conic_source_spacing(source, &spacing));
    CHECK_OK(conic_splats_spacing(f.context, &model.points, &own));
    CHECK(spacing == own);
    conic_triangles_release(f.context, &triangles);
    conic_model_release(f.context, &model);
    conic_source_close(source);
    fixture_close(&f);
  }
}

static void name_leaves(const void *selection, conic_image *image) {
  conic_selection_name(selection, image);
}

static void test_octree(void) {
  fixture f = open_counted();
  const char *path = paths[COT];
  CHECK(conic_source_abilities(&path, 1, NULL) == CONIC_SOURCE_CHOOSES);
  conic_source *source = open_source(&f, path, NULL);
  conic_octree *octree;
  conic_octree_info info;
  conic_selection selection = {0};
  conic_selection_options options;
  conic_source_view view;
  CHECK_OK(conic_octree_read(f.context, path, &octree));
  CHECK_OK(conic_octree_describe(octree, &info));
  conic_selection_options_init(&options);
  conic_source_view_init(&view);
  conic_render_options render = f.options;
  render.near_z = info.near_z;
  render.splat_length = info.splat_length;
  options.error_px = view.error_px = 2.0;
  draw_source(&f, source, &view);
  CHECK_OK(conic_octree_select(octree, &f.camera, &render, &options, &selection));
  const conic_drawing chosen = {&selection.splats, NULL};
  expect_drawing(&f, "octree", &chosen, &render, name_leaves, &selection);
  uint32_t number, id = selection.ids[0];
  const char *name = conic_source_name_splat(source, 0, &number);
  CHECK(strcmp(name, id < info.n_points ? "point" : "node") == 0 && number == id % info.n_points);
  CHECK(conic_source_chosen(source)->ids[1] == selection.ids[1] && !conic_source_chosen(source)->is_all);
  expect_count(&f, source, "inner_nodes", selection.n_inner);
  CHECK(selection.n_inner > 0 && find_fact(&f, source, "error_px").number == 2.0);

  conic_splats leaves;
  CHECK_OK(conic_octree_leaves(octree, &leaves));
  const conic_drawing whole = {&leaves, NULL};
  view.error_px = 0.0; /* all of it, and then less again */
  draw_source(&f, source, &view);
  expect_drawing(&f, "leaves", &whole, &render, NULL, NULL);
  CHECK(conic_source_chosen(source)->is_all);
  view.budget = options.budget = 300;
  options.error_px = 0.0;
  CHECK_OK(conic_source_choose(source, &f.camera, &f.options, &view));
  CHECK_OK(conic_octree_select(octree, &f.camera, &render, &options, &selection));
  CHECK(conic_source_chosen(source)->drawing.splats->count == selection.splats.count);
  conic_splats_release(f.context, &leaves);
  conic_selection_release(f.context, &selection);
  conic_octree_destroy(octree);
  conic_source_close(source);
  fixture_close(&f);
}

static void test_layers(void) {
  fixture f = open_counted();
  const char *path = paths[LPC];
  CHECK(conic_source_abilities(&path, 1, NULL) ==
        (CONIC_SOURCE_CHOOSES | CONIC_SOURCE_STREAMS | CONIC_SOURCE_READS_PARTS));
  conic_source *source = open_source(&f, path, NULL);
  conic_layers *layers;
  conic_layers_draw_options options;
  conic_layers_drawn drawn;
  conic_source_view view;
  conic_image image;
  CHECK_OK(conic_layers_open(f.context, path, NULL, &layers));
  CHECK_OK(conic_image_allocate(f.context, WIDTH, HEIGHT, CONIC_DRAWN_PLANES, &image));
  conic_layers_draw_options_init(&options);
  conic_source_view_init(&view);
  view.error_px = options.error_px = 3.0;
  draw_source(&f, source, &view);
  CHECK_OK(conic_layers_draw(layers, f.renderer, &f.camera, &f.options, &options, &image, &f.statistics, &drawn));
  for (int i = 0; i < CONIC_N_PLANES; i++)
    CHECK(!image.planes[i] || conic_image_hash(&image, (conic_plane)i) == conic_image_hash(&f.image, (conic_plane)i));
  expect_count(&f, source, "clouds_drawn", drawn.n_clouds);
  CHECK(drawn.n_clouds > 0 && f.statistics.pixels_covered > 100);
  CHECK(find_fact(&f, source, "pictures").type == CONIC_FACT_END);
  CHECK(conic_source_measure(source)->n_levels >= conic_source_chosen(source)->n_levels);
  view.most_levels = 1;
  draw_source(&f, source, &view);
  expect_count(&f, source, "pictures", 1);
  CHECK(conic_source_chosen(source)->n_levels == 1);
  CHECK(conic_source_choose(source, &f.camera, &f.options, &view) == CONIC_ERROR_UNSUPPORTED);
  conic_source_close(source);

  conic_source_options opening; /* whole, it hands over all samples */
  conic_source_options_init(&opening);
  opening.is_whole = 1;
  CHECK(conic_source_abilities(&path, 1, &opening) == 0);
  source = open_source(&f, path, &opening);
  CHECK_OK(conic_source_choose(source, &f.camera, &f.options, NULL));
  CHECK(conic_source_chosen(source)->drawing.splats->count == 3000);
  conic_source_close(source);
  conic_image_release(f.context, &image);
  conic_layers_close(layers);
  fixture_close(&f);
}

static void name_clusters(const void *selection, conic_image *image) {
  conic_hybrid_name(selection, image);
}

/* A file, and a mesh that is made one; as built, and by an error. */
static void test_hybrid(void) {
  for (int i = 0; i < 2; i++) {
    fixture f = open_counted();
    conic_source_options opening;
    conic_source_options_init(&opening);
    opening.as = i ? CONIC_AS_HYBRID : CONIC_AS_POINTS;
    const char *path = paths[i ? OBJ : CHY], *const both[] = {path, paths[PLY]};
    CHECK(conic_source_abilities(&path, 1, &opening) ==
          (CONIC_SOURCE_CHOOSES | CONIC_SOURCE_CLUSTERS | CONIC_SOURCE_READS_PARTS));
    conic_source *source = open_source(&f, path, &opening), *none;
    CHECK(conic_source_open(f.context, both, 2, &opening, &none) == CONIC_ERROR_ARGUMENT && !none);
    conic_hybrid *hybrid = build_hybrid(f.context, paths[OBJ]);
    conic_hybrid_selection selection = {0};
    conic_hybrid_view own;
    conic_hybrid_info info;
    conic_source_view view;
    double spacing;
    CHECK_OK(conic_hybrid_describe(hybrid, &info));
    conic_hybrid_view_init(&own);
    conic_source_view_init(&view);
    conic_render_options render = f.options;
    render.near_z = info.near_z;
    render.splat_length = info.splat_length;
    view.error_px = own.error_px = i ? 0.0 : 2.0;
    view.only_kind = own.only_kind = i ? CONIC_HYBRID_SURFELS : -1;
    draw_source(&f, source, &view);
    CHECK_OK(conic_hybrid_select(hybrid, &f.camera, &render, &own, &selection));
    const conic_drawing chosen = {&selection.splats, &selection.triangles};
    expect_drawing(&f, path, &chosen, &render, name_clusters, &selection);
    expect_count(&f, source, "joined_patches", selection.n_joined);
    CHECK(conic_source_spacing(source, &spacing) == CONIC_ERROR_ARGUMENT);
    conic_hybrid_selection_release(f.context, &selection);
    conic_hybrid_destroy(hybrid);
    conic_source_close(source);
    fixture_close(&f);
  }
}

static void name_points(const void *selection, conic_image *image) {
  conic_patch_selection_name(selection, image);
}

static void test_patches(void) {
  fixture f = open_counted();
  conic_source_options opening;
  conic_source_options_init(&opening);
  opening.as = CONIC_AS_PATCHES;
  conic_source *source = open_source(&f, paths[PLY], &opening);
  conic_model model;
  conic_patches *patches;
  conic_patch_selection selection;
  double length;
  CHECK_OK(conic_model_read(f.context, paths[PLY], NULL, &model));
  CHECK_OK(conic_splats_length(f.context, &model.points, &length));
  CHECK_OK(conic_patches_create(f.context, &model.points, NULL, &patches));
  f.camera.fx *= 8.0; /* near enough for samples */
  f.camera.fy *= 8.0;
  draw_source(&f, source, NULL);
  conic_render_options render = f.options;
  render.near_z = conic_default_near(&model.points);
  render.splat_length = length;
  render.epsilon = 1.5 * length;
  CHECK_OK(conic_patches_select(patches, &f.camera, &render, &selection));
  const conic_drawing drawing = {&selection.splats, NULL};
  expect_drawing(&f, "patches", &drawing, &render, name_points, &selection);
  expect_count(&f, source, "samples", selection.n_samples);
  CHECK(selection.n_samples > 0 && conic_source_measure(source)->epsilon == render.epsilon);
  conic_patches_destroy(patches);
  conic_model_release(f.context, &model);
  conic_source_close(source);
  fixture_close(&f);
}

/* Several files are one source, in their order. */
static void test_many(void) {
  fixture f = open_counted();
  const char *const two[] = {paths[PLY], paths[COT]};
  conic_source *source;
  CHECK(conic_source_abilities(two, 2, NULL) == 0);
  CHECK_OK(conic_source_open(f.context, two, 2, NULL, &source));
  CHECK(conic_source_measure(source)->n_splats == 6000);
  conic_source_close(source);
  fixture_close(&f);
}

/* How many splats and triangles a file is, each as fits, and how many normals these have. */
static void expect_auto(const char *name, const char *text, size_t n_splats, size_t n_triangles, size_t n_normals) {
  fixture f = open_counted();
  conic_source_options opening;
  conic_source *source;
  const char *const both[] = {files_write(name, text), paths[PLY]};
  conic_source_options_init(&opening);
  opening.as = CONIC_AS_AUTO;
  opening.crease_deg = 30.0;
  for (int n = 1; n <= 2; n++) {
    CHECK_OK(conic_source_open(f.context, both, (size_t)n, &opening, &source));
    const conic_drawing *drawing = &conic_source_chosen(source)->drawing;
    CHECK(drawing->splats->count == n_splats + (n == 2 ? 3000 : 0));
    CHECK(drawing->triangles->count == n_triangles && drawing->triangles->n_normals == n_normals);
    conic_source_close(source);
  }
  CHECK(remove(both[0]) == 0);
  fixture_close(&f);
}

/* Triangles where there are faces, points where there are none, both where both are meant. */
static void test_auto(void) {
  char fan[2048] = "v 0 0 0\n";
  for (int i = 0; i < 24; i++)
    snprintf(fan + strlen(fan), sizeof fan - strlen(fan), "v %g %g 0\n", cos(0.25 * i), sin(0.25 * i));
  for (int i = 2; i < 24; i++)
    snprintf(fan + strlen(fan), sizeof fan - strlen(fan), "f 1 %d %d\n", i, i + 1);
  expect_auto("bend.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.9 0.9 0.2\nf 1 2 3\nf 2 4 3\n", 0, 2, 4);
  expect_auto("edge.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.6 0.6 1\nf 1 2 3\nf 2 4 3\n", 0, 2, 6);
  expect_auto("beside.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 3 3 3\nv 3 4 3\n", 2, 1, 3);
  expect_auto("left.obj", fan, 0, 22, 24);
  expect_auto("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 2\n", 4, 0, 0);
  expect_auto("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", 3, 0, 0);
}

/* --- files as they stand --- */

static void test_inspecting(void) {
  static const char *const kinds[] = {"ply", "obj", "cot", "lpc", "chy"};
  fixture f = open_counted();
  for (int i = 0; i < 5; i++) {
    conic_facts *facts;
    const conic_fact *fact;
    int n_defects = 0;
    if (i == LPC && !has_layers)
      continue;
    CHECK_OK(conic_source_inspect(f.context, paths[i], 1, &facts));
    CHECK(facts && strcmp(conic_facts_at(facts, 0)->text, kinds[i]) == 0);
    for (size_t k = 0; (fact = conic_facts_at(facts, k)); k++) {
      n_defects += fact->type == CONIC_FACT_DEFECT;
      CHECK(fact->type != CONIC_FACT_DEFECT || fact->count == 0);
    }
    CHECK(n_defects > 3);
    conic_facts_destroy(facts);
  }
  fixture_close(&f);
}

/* --- failures --- */

static void test_refusals(void) {
  fixture f = open_counted();
  conic_source_options opening = {0};
  conic_source *source;
  conic_facts *facts;
  const char *none = files_path("none.ply"), *text = files_write("text.txt", "no source\n"), *path = paths[PLY];
  const char *bad = files_write("bad.cot", "conic-octree");
  CHECK(conic_source_open(f.context, &none, 1, NULL, &source) == CONIC_ERROR_INPUT && !source);
  CHECK(conic_source_open(f.context, &text, 1, NULL, &source) == CONIC_ERROR_INPUT && !source);
  CHECK(conic_source_open(f.context, &bad, 1, NULL, &source) == CONIC_ERROR_INPUT && !source);
  CHECK(conic_source_open(f.context, &path, 0, NULL, &source) == CONIC_ERROR_ARGUMENT && !source);
  CHECK(conic_source_open(f.context, &path, 1, &opening, &source) == CONIC_ERROR_ARGUMENT && !source);
  CHECK(conic_source_inspect(f.context, text, 0, &facts) == CONIC_ERROR_INPUT && !facts);
  fixture_scene(&f, CONIC_SCENE_KNOT, 100);
  f.splats.strides.position = 12; /* what is taken over has none */
  CHECK(conic_source_of_drawing(f.context, &f.splats, NULL, &source) == CONIC_ERROR_ARGUMENT && !source);
  f.splats.strides.position = 0;
  CHECK_OK(conic_source_of_drawing(f.context, &f.splats, NULL, &source));
  CHECK(f.splats.count == 0 && conic_source_measure(source)->n_splats == 100);
  conic_source_close(source);
  conic_source_close(NULL);
  CHECK(remove(text) == 0 && remove(bad) == 0);
  fixture_close(&f);
}

/* Memory that runs out at every allocation of opening, one after the other. */
static void test_memory(const char *path, conic_representation as) {
  conic_source_options opening;
  conic_source_options_init(&opening);
  opening.as = as;
  opening.crease_deg = as == CONIC_AS_AUTO ? 30.0 : 0.0;
  fixture f = open_counted();
  conic_source *source;
  conic_status status = CONIC_ERROR_MEMORY;
  long n_alive = memory.n_alive, n_failed = 0;
  for (long at = 1; status == CONIC_ERROR_MEMORY; at++) {
    memory.failing_call = memory.n_calls + at;
    status = conic_source_open(f.context, &path, 1, &opening, &source);
    n_failed += status == CONIC_ERROR_MEMORY;
    CHECK(status == CONIC_OK || (!source && memory.n_alive == n_alive));
  }
  CHECK(status == CONIC_OK && n_failed >= 2);
  memory.failing_call = 0;
  conic_source_close(source);
  CHECK(memory.n_alive == n_alive);
  fixture_close(&f);
}

int main(void) {
  conic_context *context = files_context();
  write_files();
  test_drawings();
  test_octree();
  test_hybrid();
  test_patches();
  test_many();
  test_auto();
  test_inspecting();
  test_refusals();
  test_memory(paths[PLY], CONIC_AS_POINTS);
  test_memory(paths[OBJ], CONIC_AS_MESH);
  test_memory(paths[OBJ], CONIC_AS_AUTO);
  test_memory(paths[PLY], CONIC_AS_PATCHES);
  test_memory(paths[COT], CONIC_AS_POINTS);
  test_memory(paths[CHY], CONIC_AS_POINTS);
  if (has_layers) {
    test_layers();
    test_memory(paths[LPC], CONIC_AS_POINTS);
  }
  CHECK(memory.n_alive == 0);
  for (int i = 0; i < 5; i++)
    CHECK(remove(paths[i]) == 0 || (i == LPC && !has_layers));
  files_end(context);
  return check_result();
}
