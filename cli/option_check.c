/* Whether options change anything. */
#include "cli/option_check.h"

#include <strings.h>

_Static_assert(CLI_N_FACTS <= 64, "facts are bits of an unsigned long long");

/* What each fact is called in the help, and in messages behind "it acts on" and "it needs". Facts that are only looked
 * at for what cannot be together have no words. */
static const struct {
  const char *name, *words;
} fact_words[CLI_N_FACTS] = {
    [CLI_FACT_COMPOSITED] = {"composited", "Gaussian scenes that are composited"},
    [CLI_FACT_MIXED] = {"mixed", "Gaussian scenes with surfaces among them"},
    [CLI_FACT_GAUSSIANS] = {"gaussians", "Gaussian scenes (.splat, .spz, .sog, or a .ply with the columns scale_0, "
                                         "rot_0, opacity and f_dc_0)"},
    [CLI_FACT_SPLATS] = {"splats", "splats"},
    [CLI_FACT_TRIANGLES] = {"triangles", "triangles"},
    [CLI_FACT_FACES] = {"faces", "files that have faces"},
    [CLI_FACT_TEXTURED] = {"textured", "files that have pictures on their surfaces, or --texture"},
    [CLI_FACT_EDGES] = {"edges", "triangles whose file has no normals"},
    [CLI_FACT_RAW] = {"raw", "points whose sizes are not in their file"},
    [CLI_FACT_TEXT] = {"text", "files of text"},
    [CLI_FACT_FRACTIONS] = {"fractions", "colours that are fractions of 1, as floats in a .ply"},
    [CLI_FACT_ALPHA] = {"alpha", "splats and materials that let light through"},
    [CLI_FACT_VALUED] = {"values", "colours that are made of values, as by --color-by"},
    [CLI_FACT_MEASURED] = {"measured", "points that have such values"},
    [CLI_FACT_HYBRID] = {"hybrids", "hybrids (a .chy, or a mesh with --as hybrid)"},
    [CLI_FACT_LEVELS] = {"levels", "a single cloud in levels (.lpc, which conic layer makes, COPC, EPT, Potree 2)"},
    [CLI_FACT_NODES] = {"nodes", "a single .cot (conic octree makes one) with its own colours"},
    [CLI_FACT_CHOOSES] = {"choosable", "points, meshes and hierarchies"},
    [CLI_FACT_URL] = {"urls", "URLs"},
    [CLI_FACT_ACCUMULATED] = {"accumulated", "--accumulate N"},
    [CLI_FACT_SAMPLE] = {"sample", "--sample I"},
    [CLI_FACT_LENS] = {"lens", "a lens, by --aperture D"},
    [CLI_FACT_WAY] = {"way", "a way of the camera, --turntable or --camera with several, or --motion"},
    [CLI_FACT_FRAMED] = {"framed", "a camera that frames the scene, and --camera does it itself"},
    [CLI_FACT_FIELD] = {"field", "--projection perspective or fisheye"},
    [CLI_FACT_CAMERAS] =
        {"cameras", "a file of cameras, by --camera FILE, or a side as front, back, left, right, top, bottom or iso"},
    [CLI_FACT_UPRIGHT] = {"upright", "lights, heights or a framed camera that stand upright"},
    [CLI_FACT_TURNTABLE] = {"turntable", "--turntable N, --path FILE"},
    [CLI_FACT_EVERY_VIEW] = {"views", "--view all"},
    [CLI_FACT_MAP] = {"map", "--camera top"},
    [CLI_FACT_STEREO] = {"stereo", "two eyes, by --stereo E"},
    [CLI_FACT_ERROR] = {"error", "--error"},
    [CLI_FACT_BUDGET] = {"budget", "--budget"},
    [CLI_FACT_PATCH] = {"patch", "--method patch"},
    [CLI_FACT_KERNEL] = {"kernel", "a --method by which splats fade"},
    [CLI_FACT_FILTERED] = {"filtered", "a --method by which splats are filtered"},
    [CLI_FACT_BLENDED] = {"blended", "--passes 3"},
    [CLI_FACT_SHAPED] = {"shaped", "another --shade than none, or --aov N"},
    [CLI_FACT_LIT] = {"lit", "another --shade than none"},
    [CLI_FACT_UNSETTLED] = {"unsettled", "that --method and --samples do not say it all"},
    [CLI_FACT_OWN_CENTER] = {"center", "a --profile that takes the picture's middle, as inria-2023"},
    [CLI_FACT_EXR] = {"exr", "an .exr"},
    [CLI_FACT_TIFF] = {"tiff", "a .tif"},
    [CLI_FACT_TELLING] = {"telling", "an .exr, .png or .tif, which says how it was made"},
    [CLI_FACT_CODES] = {"codes", "a file of 8 or 16 bits, such as .png"},
    [CLI_FACT_NAMELESS] = {"nameless", "standard output or a name without an ending"},
    [CLI_FACT_OPENCL] = {"opencl", "--device opencl"},
    [CLI_FACT_CUBE] = {NULL, "--projection cube"},
    [CLI_FACT_MATTES] = {"mattes", "--aov cryptomatte"},
    [CLI_FACT_MASKED] = {"masked", "--ao, --shadow or a lamp"},
    [CLI_FACT_EXACT] = {"exact", "Gaussian scenes by --profile exact (the others have a filter of their own)"},
};

const char *cli_fact_name(int fact) {
  return fact_words[fact].name;
}

/* --- facts --- */

void cli_effects_add(cli_effects_job *own, const char *dashes, const char *name, const cli_effect *acts) {
  if (own->n_given < CLI_MOST_GIVEN)
    own->given[own->n_given++] = (cli_given){dashes, name, *acts};
}

void cli_effects_note(cli_effects_job *own, const cli_option *table, int n, const char *const *values) {
  for (int i = 0; i < n; i++)
    if (values[i] && !table[i].now)
      cli_effects_add(own, cli_dashes(&table[i]), table[i].name, &table[i].acts);
}

/* The facts of a set in words, joined by "or". */
static void join_facts(cli_facts set, char *text, size_t room) {
  size_t used = 0;
  text[0] = '\0';
  for (int i = 0; i < CLI_N_FACTS && used < room; i++)
    if (set >> i & 1 && fact_words[i].words)
      used += (size_t)snprintf(text + used, room - used, "%s%s", used ? ", or " : "", fact_words[i].words);
}

static int refuse(const cli_session *session, int is_warned, const char *dashes, const char *name, const char *words) {
  if (!is_warned)
    return cli_usage("%s: %s%s %s", session->command, dashes, name, words);
  cli_warn(session, "%s: %s%s %s", session->command, dashes, name, words);
  return CLI_DONE;
}

/* Whether what is known keeps an option from having an effect. */
static cli_facts find_lacking(const cli_effects_job *own, const cli_effect *acts) {
  const cli_facts known = own->possible | own->asked;
  return acts->on && !(acts->on & known) ? acts->on : acts->needs && !(acts->needs & known) ? acts->needs : 0;
}

/* What does not go together is said before what has no effect for it. */
static int check_apart(const cli_session *session, const cli_effects_job *own, const cli_given *option) {
  const cli_effect *acts = &option->acts;
  const cli_facts against = acts->apart & (own->certain | own->asked);
  char names[1024];
  if (!against)
    return CLI_DONE;
  join_facts(against, names, sizeof names);
  return cli_usage("%s: %s%s does not go with %s%s%s", session->command, option->dashes, option->name, names,
                   acts->why ? ": " : "", acts->why ? acts->why : "");
}

static int check_effect(const cli_session *session, const cli_effects_job *own, const cli_given *option,
                        const char *input, const char *(*remedy)(const cli_effects_job *own, cli_facts lacked)) {
  const cli_facts lacked = find_lacking(own, &option->acts);
  char names[1024], words[2048];
  if (!lacked)
    return CLI_DONE;
  join_facts(lacked, names, sizeof names);
  if (lacked & CLI_SOURCE_FACTS)
    snprintf(words, sizeof words, "has no effect: it acts on %s, not on %s%s", names, input,
             remedy ? remedy(own, lacked) : "");
  else
    snprintf(words, sizeof words, "has no effect: it needs %s", names);
  return refuse(session, option->acts.is_warned && !own->is_strict, option->dashes, option->name, words);
}

int cli_effects_check_given(const cli_session *session, cli_effects_job *own, const char *input,
                            const char *(*remedy)(const cli_effects_job *own, cli_facts lacked)) {
  int answer = CLI_DONE, n = 0;
  for (int i = 0; i < own->n_given && answer == CLI_DONE; i++)
    answer = check_apart(session, own, &own->given[i]);
  for (int i = 0; i < own->n_given && answer == CLI_DONE; i++) {
    answer = check_effect(session, own, &own->given[i], input, remedy);
    if (!find_lacking(own, &own->given[i].acts))
      own->given[n++] = own->given[i];
  }
  own->n_given = n;
  return answer;
}

/* --- other options --- */

/* What was given, beside the table. */
typedef struct given_words {
  const char *command;
  const cli_option *table;
  int n;
  const char *const *values, *const *positional;
  int n_positional;
} given_words;

static int find_row(const given_words *given, const char *name, size_t length) {
  for (int i = 0; i < given->n; i++)
    if (strlen(given->table[i].name) == length && strncmp(given->table[i].name, name, length) == 0)
      return i;
  return -1;
}

/* Of a choice also the word that it is by default. */
static const char *value_of(const given_words *given, int i) {
  const cli_option *option = &given->table[i];
  if (given->values[i] || option->type != CLI_CHOICE)
    return given->values[i];
  const int choice = *(const int *)option->value;
  return choice >= 0 ? option->choices[choice] : NULL;
}

static int holds_argument(const given_words *given, const char *word, size_t length, char *words, size_t room) {
  if (length)
    snprintf(words, room, "conic %s %.*s", given->command, (int)length, word);
  else
    snprintf(words, room, "an input");
  for (int i = 0; i < given->n_positional; i++)
    if (!length || (strlen(given->positional[i]) == length && strncmp(given->positional[i], word, length) == 0))
      return 1;
  return 0;
}

/* One of the alternatives that cli_effect.with lists, in so many letters; and what it is called. */
static int holds(const given_words *given, const char *rule, size_t length, char *words, size_t room) {
  if (*rule == '!')
    return !holds(given, rule + 1, length - 1, words, room);
  if (*rule == '@')
    return holds_argument(given, rule + 1, length - 1, words, room);
  const char *equals = memchr(rule, '=', length);
  const size_t n_name = equals ? (size_t)(equals - rule) : length, n_word = equals ? length - n_name - 1 : 0;
  const int i = find_row(given, rule, n_name);
  const char *value = i < 0 ? NULL : equals ? value_of(given, i) : given->values[i], *dashes = n_name > 1 ? "--" : "-";
  if (!equals) {
    snprintf(words, room, "%s%.*s", dashes, (int)n_name, rule);
    return value != NULL;
  }
  const int is_ending = equals[1] == '.';
  snprintf(words, room, "%s%.*s %s%.*s", dashes, (int)n_name, rule, is_ending ? "OUT" : "", (int)n_word, equals + 1);
  if (!value)
    return 0;
  const size_t n_value = strlen(value);
  return is_ending ? n_value >= n_word && strncasecmp(value + n_value - n_word, equals + 1, n_word) == 0
                   : n_value == n_word && strncmp(value, equals + 1, n_word) == 0;
}

/* Whether one of the alternatives holds; else all of them in words. */
static int holds_any(const given_words *given, const char *rules, char *words, size_t room) {
  size_t used = 0;
  for (const char *rule = rules; used < room;) {
    char one[128];
    const size_t length = strcspn(rule, "|");
    if (holds(given, rule, length, one, sizeof one))
      return 1;
    used += (size_t)snprintf(words + used, room - used, "%s%s", used ? ", or " : "", one);
    if (!rule[length])
      return 0;
    rule += length + 1;
  }
  return 0;
}

int cli_effects_check_with(const cli_session *session, const cli_option *table, int n, const char *const *values,
                           const char *const *positional, int n_positional) {
  const given_words given = {session->command, table, n, values, positional, n_positional};
  int answer = CLI_DONE;
  for (int i = 0; i < n && answer == CLI_DONE; i++) {
    const cli_effect *acts = &table[i].acts;
    char names[512], words[768];
    if (!values[i] || !acts->with || holds_any(&given, acts->with, names, sizeof names))
      continue;
    snprintf(words, sizeof words, "has no effect%s %s", *acts->with == '!' ? " with" : ": it needs", names);
    answer = refuse(session, acts->is_warned, cli_dashes(&table[i]), table[i].name, words);
  }
  return answer;
}
