/* Gaussian scenes in every format: what no content tells is a .splat, where its length is that of one. What is read can
 * be turned, ordered, compared with itself and written again, as one of the kinds. The same bytes are read as a
 * gradient and as weights, too. */
#include "tests/fuzz/fuzz.h"

static void use(const fuzz_input *input, conic_gaussians *scene, size_t kind) {
  conic_gaussians_differences apart;
  conic_gaussians_defects found;
  conic_gaussians_write_options options;
  conic_gaussians_write_options_init(&options);
  conic_gaussians_find_defects(scene, &found);
  FUZZ_CHECK(found.positions <= scene->count && found.harmonics <= scene->count);
  char first[4];
  memcpy(first, scene->frame, sizeof first);
  if (strcmp(first, "rub") == 0 || strcmp(first, "rdf") == 0 || strcmp(first, "luf") == 0)
    FUZZ_CHECK(conic_gaussians_turn(input->context, scene, "rfu") == CONIC_OK);
  FUZZ_CHECK(conic_gaussians_sort(input->context, scene) == CONIC_OK);
  FUZZ_CHECK(conic_gaussians_compare(input->context, scene, scene, &apart) == CONIC_OK && apart.is_same);
  options.kind = (conic_gaussian_kind)(kind % CONIC_N_GAUSSIAN_KINDS);
  conic_gaussians_write(input->context, "/dev/null", scene, &options);
}

/* Whatever these are, they are read whole or refused with a message, as scenes are. */
static void read_otherwise(const fuzz_input *input) {
  conic_gaussian_gradient gradient;
  conic_gaussian_weights weights;
  if (conic_gaussian_gradient_read(input->context, input->path, &gradient) == CONIC_OK)
    FUZZ_CHECK(gradient.sh_degree >= 0 && gradient.sh_degree <= CONIC_MAX_SH_DEGREE &&
               gradient.lacks < (1u << CONIC_N_GRADIENT_KINDS) - 1);
  conic_gaussian_gradient_release(input->context, &gradient);
  if (conic_gaussian_weights_read(input->context, input->path, &weights) == CONIC_OK)
    FUZZ_CHECK(weights.width > 0 && weights.height > 0);
  conic_gaussian_weights_release(input->context, &weights);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  conic_gaussians scene;
  conic_gaussians_read_options options;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_gaussians_read_options_init(&options);
  options.keeps_source = n_bytes % 2 != 0;
  options.half_harmonics = n_bytes % 4 / 2;
  options.is_splat = n_bytes % 32 == 0;
  conic_status status = conic_gaussians_read(input.context, input.path, &options, &scene);
  int n_messages = fuzz_n_messages;
  read_otherwise(&input);
  if (status == CONIC_OK && scene.count < 512)
    use(&input, &scene, n_bytes);
  fuzz_n_messages = n_messages;
  conic_gaussians_release(input.context, &scene);
  fuzz_close(&input, status, 1);
  return 0;
}
