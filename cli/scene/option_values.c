/* What the values of single options mean. */

#include "cli/scene/scene_options.h"

/* gauss, hat, box, or confetti:A,B,N. */
int cli_parse_kernel(const char *text, void *value) {
  conic_kernel *kernel = value;
  double abn[3];
  for (int i = 0; i < CONIC_N_KERNELS; i++)
    if (strcmp(text, conic_kernel_type_name((conic_kernel_type)i)) == 0) {
      kernel->type = (conic_kernel_type)i;
      return 1;
    }
  if (strncmp(text, "confetti:", 9) != 0 || !cli_parse_vector(text + 9, abn))
    return 0;
  if (!(abn[0] > 0.0) || !(abn[1] > 0.0))
    return cli_because("A and B are above 0");
  if (!(abn[2] >= 1.0 && abn[2] <= 16.0) || abn[2] != (double)(int)abn[2])
    return cli_because("N is a whole number, 1 to 16");
  kernel->type = CONIC_KERNEL_CONFETTI;
  kernel->a = (float)abn[0];
  kernel->b = (float)abn[1];
  kernel->n = (int)abn[2];
  return 1;
}

int cli_parse_epsilon(const char *text, void *value) {
  cli_length *epsilon = value;
  if (strcmp(text, "auto") == 0) {
    epsilon->value = -1.0;
    return 1;
  }
  return cli_parse_length(text, value);
}

int cli_parse_near(const char *text, void *value) {
  const cli_length *near_z = value;
  return cli_parse_length(text, value) && (near_z->value > 0.0 || cli_because("it is above 0"));
}

/* x, -y, … or X,Y,Z. */
int cli_parse_up(const char *text, void *value) {
  double *up = value, sign = 1.0;
  const char *letter = text;
  if (*letter == '-' || *letter == '+')
    sign = *letter++ == '-' ? -1.0 : 1.0;
  if ((*letter == 'x' || *letter == 'y' || *letter == 'z') && !letter[1]) {
    up[0] = up[1] = up[2] = 0.0;
    up[*letter - 'x'] = sign;
    return 1;
  }
  return cli_parse_direction(text, up);
}

const char *const cli_projection_words[] = {"perspective", "fisheye", "orthographic", "panorama", "cube", NULL};

int cli_parse_eye(const char *text, void *eye) {
  return cli_parse_vector(text, eye);
}

int cli_parse_place(const char *text, void *value) {
  cli_render_job *job = value;
  const char *equals = strrchr(text, '=');
  if (!equals || equals == text || !equals[1] || job->n_places >= CLI_MOST_PLACES)
    return 0;
  job->places[job->n_places++] = text;
  return 1;
}

int cli_parse_catcher(const char *text, void *value) {
  cli_render_job *job = value;
  return *text && job->n_catchers < CLI_MOST_PLACES && (job->catchers[job->n_catchers++] = text);
}

int cli_parse_holdout(const char *text, void *value) {
  cli_render_job *job = value;
  return *text && job->n_holdouts < CLI_MOST_PLACES && (job->holdouts[job->n_holdouts++] = text);
}

int cli_parse_exposure(const char *text, void *value) {
  cli_render_job *job = value;
  job->is_exposure_automatic = strcmp(text, "auto") == 0;
  job->shot.render.exposure = 0.0;
  return job->is_exposure_automatic || (cli_parse_number(text, &job->shot.render.exposure) &&
                                        job->shot.render.exposure >= -100.0 && job->shot.render.exposure <= 100.0);
}

/* Of those that --aov may name. */
static int find_plane(const char *name, size_t length) {
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    if (CONIC_MATTE_PLANES >> i & 1)
      continue;
    const char *known = conic_plane_describe((conic_plane)i)->name;
    if (strlen(known) == length && strncmp(known, name, length) == 0)
      return i;
  }
  return -1;
}

static int is_plane_word(const char *text, size_t length, const char *word) {
  return strlen(word) == length && strncmp(text, word, length) == 0;
}

/* rgba,Z,N … or all. Mattes are no plane of their own, and leave the others as they are by default. */
int cli_parse_planes(const char *text, void *value) {
  cli_render_job *job = value;
  unsigned *planes = &job->shot.planes, usual = *planes;
  *planes = 0;
  while (*text) {
    size_t length = strcspn(text, ",");
    int plane = find_plane(text, length), is_all = is_plane_word(text, length, "all"), is_aov = plane >= 0 || is_all;
    if (is_aov)
      *planes |= is_all ? CONIC_DRAWN_PLANES : 1u << plane;
    else if (job->is_for_looking && is_plane_word(text, length, "cryptomatte"))
      job->has_mattes = 1;
    else
      return 0;
    job->is_aov_given |= is_aov;
    text += length;
    if (*text == ',' && text[1])
      text++;
  }
  *planes = *planes ? *planes : usual;
  return job->is_aov_given || job->has_mattes;
}
