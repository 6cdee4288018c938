#include "bench/chart_ways.h"

#include "cli/arguments.h"

/* What the values of an option are where none are named, and of which scenes. */
typedef enum axis_need { OF_ALL, OF_SPLATS, OF_CHOICES, OF_FACES, OF_GAUSSIANS, ONLY_ASKED } axis_need;

typedef struct usual_axis {
  const char *axis, *values; /* null: halves of all */
  axis_need need;
} usual_axis;

static const usual_axis usual[] = {
    {"method", "conic:ray:affine:point:disc:auto", OF_SPLATS},
    {"kernel", "gauss:hat:box:confetti", OF_SPLATS},
    {"prefilter", "0:0.25:0.5:1:2", OF_SPLATS},
    {"samples", "1:2:3:4", OF_ALL},
    {"error", "0.5:1:2:4:8:16", OF_CHOICES},
    {"budget", NULL, OF_CHOICES},
    {"as", "mesh:points:hybrid", OF_FACES},
    {"profile", "exact:gsplat-1.6:inria-2023", OF_GAUSSIANS},
    {"passes", "1:3", ONLY_ASKED},
    {"isa", "auto:scalar", ONLY_ASKED},
    {"device", "cpu:opencl", ONLY_ASKED},
};

enum { N_USUAL = sizeof usual / sizeof usual[0] };

int cli_chart_parse_beside(const char *text, void *beside) {
  cli_charts_beside *all = beside;
  cli_chart_beside *next = &all->pictures[all->n];
  char number[32];
  size_t name = strcspn(text, "="), digits = text[name] ? strcspn(text + name + 1, ":") : 0;
  const char *path = text + name + 1 + digits;
  if (all->n == CLI_MOST_BESIDE || name == 0 || name >= sizeof next->name || digits == 0 || digits >= sizeof number ||
      path[0] != ':' || !path[1])
    return 0;
  snprintf(next->name, sizeof next->name, "%.*s", (int)name, text);
  snprintf(number, sizeof number, "%.*s", (int)digits, text + name + 1);
  next->path = path + 1;
  all->n += cli_parse_number(number, &next->ms) && next->ms > 0.0;
  return next->ms > 0.0;
}

/* One option of an axis, and its values with colons between. */
typedef struct factor {
  char name[24], values[160];
} factor;

typedef struct axis {
  factor factors[CLI_MOST_FACTORS];
  int n_factors;
} axis;

static const usual_axis *find_usual(const char *name) {
  for (int i = 0; i < N_USUAL; i++)
    if (strcmp(usual[i].axis, name) == 0)
      return &usual[i];
  return NULL;
}

/* A half, a quarter … of what there is. */
static void write_halves(uint64_t n, char *to, size_t room) {
  size_t used = 0;
  *to = 0;
  for (int i = 1; i <= 5 && n >> i; i++)
    used += (size_t)snprintf(to + used, room - used, "%s%llu", i > 1 ? ":" : "", (unsigned long long)(n >> i));
}

static void take_usual_values(const usual_axis *from, const cli_chart_facts *facts, factor *to) {
  if (from && from->values)
    snprintf(to->values, sizeof to->values, "%s", from->values);
  else if (from)
    write_halves(facts->n_primitives, to->values, sizeof to->values);
}

/* "NAME" or "NAME=VALUE:VALUE…" */
static int understand_factor(const char *text, size_t n, const cli_chart_facts *facts, factor *to) {
  size_t name = strcspn(text, "=,+");
  if (name == 0 || name >= sizeof to->name || n - name > sizeof to->values)
    return 0;
  memset(to, 0, sizeof *to);
  memcpy(to->name, text, name);
  if (n > name)
    memcpy(to->values, text + name + 1, n - name - 1);
  if (!to->values[0])
    take_usual_values(find_usual(to->name), facts, to);
  return 1;
}

static int understand_axis(const char *text, size_t n, const cli_chart_facts *facts, axis *to) {
  to->n_factors = 0;
  for (size_t at = 0; at < n;) {
    size_t length = strcspn(text + at, ",+");
    if (to->n_factors == CLI_MOST_FACTORS ||
        !understand_factor(text + at, length, facts, &to->factors[to->n_factors++]))
      return 0;
    at += length + (text[at + length] == '+');
  }
  return to->n_factors > 0 && text[n - 1] != '+';
}

/* The i-th value of a factor, and how many there are; a flag has an empty one. */
static int value_at(const factor *of, int i, char *value, size_t room) {
  int n = 0;
  for (const char *at = of->values;; at++) {
    size_t length = strcspn(at, ":");
    if (n++ == i)
      snprintf(value, room, "%.*s", (int)length, at);
    at += length;
    if (!*at)
      return n;
  }
}

static void put_joined(char *to, size_t room, char between, const char *text) {
  size_t n = strlen(to);
  snprintf(to + n, room - n, "%.*s%s", n > 0, &between, text);
}

/* The way of one of the axis' combinations, counted through from the first factor's values. */
static void fill_way(const axis *of, int i_scene, int combination, cli_chart_way *way) {
  memset(way, 0, sizeof *way);
  way->i_scene = i_scene;
  way->n_factors = of->n_factors;
  for (int i = 0, stride = 1; i < of->n_factors; i++) {
    const factor *from = &of->factors[i];
    char *name = way->words[(size_t)i * 2], *value = way->words[(size_t)i * 2 + 1];
    int n = value_at(from, 0, value, sizeof way->words[0]);
    value_at(from, combination / stride % n, value, sizeof way->words[0]);
    stride *= n;
    snprintf(name, sizeof way->words[0], "%s%s", from->name[1] ? "--" : "-", from->name);
    put_joined(way->axis, sizeof way->axis, '+', from->name);
    put_joined(way->value, sizeof way->value, ':', value[0] ? value : "given");
  }
}

static int grow(cli_chart_way **ways, int n) {
  cli_chart_way *grown = realloc(*ways, ((size_t)n + 1) * sizeof **ways);
  *ways = grown ? grown : *ways;
  return grown ? CLI_DONE : cli_error(CLI_RESOURCE, "chart: out of memory");
}

static int append_axis(const axis *of, int i_scene, cli_chart_way **ways, int *n) {
  char value[64];
  int n_combinations = 1, exit_code = CLI_DONE;
  for (int i = 0; i < of->n_factors; i++)
    n_combinations *= value_at(&of->factors[i], 0, value, sizeof value);
  for (int i = 0; i < n_combinations && exit_code == CLI_DONE; i++) {
    exit_code = grow(ways, *n);
    if (exit_code == CLI_DONE)
      fill_way(of, i_scene, i, &(*ways)[(*n)++]);
  }
  return exit_code;
}

static int append_asked(const cli_chart_asked *asked, int i_scene, const cli_chart_facts *facts, cli_chart_way **ways,
                        int *n) {
  int exit_code = CLI_DONE;
  for (const char *at = asked->over; *at && exit_code == CLI_DONE; at += *at == ',') {
    axis found;
    size_t length = strcspn(at, ",");
    if (!understand_axis(at, length, facts, &found))
      return cli_usage("chart: --over %.*s: no axis; see conic help chart", (int)length, at);
    exit_code = append_axis(&found, i_scene, ways, n);
    at += length;
  }
  return exit_code;
}

static int fits(const usual_axis *one, const cli_chart_facts *facts) {
  return one->need == OF_ALL || (one->need == OF_SPLATS && facts->has_splats && !facts->is_composited) ||
         (one->need == OF_CHOICES && facts->chooses) || (one->need == OF_FACES && facts->has_faces) ||
         (one->need == OF_GAUSSIANS && facts->is_composited);
}

/* Of one scene all axes that fit; of several what chooses by its error, and else samples. */
static int append_fitting(const cli_chart_asked *asked, int i_scene, const cli_chart_facts *facts, cli_chart_way **ways,
                          int *n) {
  const char *alone = asked->n_scenes > 1 ? facts->chooses ? "error" : "samples" : NULL;
  int exit_code = CLI_DONE;
  for (int i = 0; i < N_USUAL && exit_code == CLI_DONE; i++) {
    axis one;
    if ((alone ? strcmp(alone, usual[i].axis) == 0 : fits(&usual[i], facts)) &&
        understand_axis(usual[i].axis, strlen(usual[i].axis), facts, &one))
      exit_code = append_axis(&one, i_scene, ways, n);
  }
  return exit_code;
}

int cli_chart_list_ways(const cli_chart_asked *asked, int i_scene, const cli_chart_facts *facts, cli_chart_way **ways,
                        int *n) {
  return asked->over ? append_asked(asked, i_scene, facts, ways, n) : append_fitting(asked, i_scene, facts, ways, n);
}

static int is_other_scene(const cli_chart_asked *asked, int i_scene, const char *word) {
  for (int i = 0; i < asked->n_scenes; i++)
    if (i != i_scene && word == asked->scenes[i])
      return 1;
  return 0;
}

/* An option that neither the chart's arguments nor the way name. */
static int put_unless_given(const char *option, const char *value, const char **argv, int n) {
  const size_t length = strlen(option);
  for (int i = 1; i < n; i++)
    if (strncmp(argv[i], option, length) == 0 && (!argv[i][length] || argv[i][length] == '='))
      return n;
  argv[n] = option;
  argv[n + 1] = value;
  return n + 2;
}

int cli_chart_words(const cli_chart_asked *asked, int i_scene, const cli_chart_way *way, const char **argv) {
  int n = 0;
  for (int i = 0; i < asked->argc; i++)
    if (!is_other_scene(asked, i_scene, asked->argv[i]))
      argv[n++] = asked->argv[i];
  for (int i = 0; way && i < 2 * way->n_factors; i++)
    if (way->words[i][0])
      argv[n++] = way->words[i];
  n = put_unless_given("--samples", "1", argv, n);
  return asked->is_quick ? put_unless_given("--size", "96x96", argv, n) : n;
}
