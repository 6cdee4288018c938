#include "core/formats/ply_header.h"

#include "core/base/byte_order.h"
#include "core/base/vectors.h"
#include "core/files/number.h"

typedef struct type_description {
  const char *names[2];
  size_t n_bytes;
  double least, largest; /* of integers */
} type_description;

static const type_description types[] = {
    [CONIC_PLY_INT8] = {{"char", "int8"}, 1, -128.0, 127.0},
    [CONIC_PLY_UINT8] = {{"uchar", "uint8"}, 1, 0.0, 255.0},
    [CONIC_PLY_INT16] = {{"short", "int16"}, 2, -32768.0, 32767.0},
    [CONIC_PLY_UINT16] = {{"ushort", "uint16"}, 2, 0.0, 65535.0},
    [CONIC_PLY_INT32] = {{"int", "int32"}, 4, -2147483648.0, 2147483647.0},
    [CONIC_PLY_UINT32] = {{"uint", "uint32"}, 4, 0.0, 4294967295.0},
    [CONIC_PLY_FLOAT] = {{"float", "float32"}, 4, 0.0, 0.0},
    [CONIC_PLY_DOUBLE] = {{"double", "float64"}, 8, 0.0, 0.0},
};

enum { N_TYPES = sizeof types / sizeof *types, WORDS_PER_LINE = 5, WORD_ROOM = 128, MOST_ELEMENTS = 1024 };

/* One line of the header: its first words, cut to WORD_ROOM, and the number of all words. */
typedef struct header_line {
  char words[WORDS_PER_LINE][WORD_ROOM];
  int n_words;
  uint64_t line;
} header_line;

size_t conic_ply_type_bytes(conic_ply_type type) {
  return types[type].n_bytes;
}

const char *conic_ply_type_name(conic_ply_type type) {
  return types[type].names[conic_ply_type_is_integer(type)];
}

const char *conic_ply_type_word(conic_ply_type type) {
  return types[type].names[0];
}

conic_ply_type conic_ply_type_of(const char *name) {
  for (int i = 0; i < N_TYPES; i++)
    if (strcmp(types[i].names[0], name) == 0 || strcmp(types[i].names[1], name) == 0)
      return (conic_ply_type)i;
  return CONIC_PLY_DOUBLE;
}

int conic_ply_type_is_integer(conic_ply_type type) {
  return type < CONIC_PLY_FLOAT;
}

void conic_ply_type_range(conic_ply_type type, double *least, double *largest) {
  *least = types[type].least;
  *largest = types[type].largest;
}

double conic_ply_nearest(conic_ply_type type, double value) {
  if (!conic_ply_type_is_integer(type))
    return value;
  value = floor(value + 0.5);
  return value > types[type].least ? value < types[type].largest ? value : types[type].largest : types[type].least;
}

void conic_ply_store(conic_ply_type type, double value, void *to) {
  if (type == CONIC_PLY_FLOAT)
    conic_store_float(to, (float)value);
  else if (type == CONIC_PLY_DOUBLE)
    conic_store_double(to, value);
  else
    conic_store_bits(to, types[type].n_bytes, (uint64_t)(int64_t)conic_ply_nearest(type, value));
}

static void copy_word(char *to, size_t room, const char *from, size_t length) {
  length = length < room - 1 ? length : room - 1;
  memcpy(to, from, length);
  to[length] = 0;
}

static int is_word(const header_line *line, int i_word, const char *word) {
  return i_word < line->n_words && strcmp(line->words[i_word], word) == 0;
}

/* Old exporters of Blender left `comment` out of "Created by Blender". */
static int is_created_by(const header_line *line) {
  return is_word(line, 0, "Created");
}

/* Comments are ignored, however long, unless read_comment knows them. */
static int is_comment(const header_line *line) {
  return line->n_words == 0 || is_word(line, 0, "comment") || is_word(line, 0, "obj_info") || is_created_by(line);
}

static conic_status wrong_header(conic_input *input, const header_line *line, const char *what, const char *word) {
  return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: %s%s%s%s (line %llu)", input->name, what, word ? " '" : "",
                    word ? word : "", word ? "'" : "", (unsigned long long)line->line);
}

static int is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

static char lower_case(char c) {
  return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

/* In either case, as programs differ. */
static int begins_with(const char *c, const char *end, const char *text) {
  for (; *text; c++, text++)
    if (c == end || lower_case(*c) != lower_case(*text))
      return 0;
  return 1;
}

/* Whether a comment begins with that word and a blank; *c then moves past them. */
static int has_keyword(const char **c, const char *end, const char *keyword) {
  size_t n = strlen(keyword);
  if (!begins_with(*c, end, keyword) || (size_t)(end - *c) <= n || !is_blank((*c)[n]))
    return 0;
  *c += n;
  while (*c < end && is_blank(**c))
    (*c)++;
  return 1;
}

/* comment TextureFile NAME: the name is the rest of the line, and may have blanks in it. */
static conic_status read_texture_name(conic_input *input, const header_line *line, const char *name, const char *end,
                                      conic_texts *textures) {
  const char *name_end = memchr(name, '\n', (size_t)(end - name));
  if (!name_end || name_end - name > CONIC_INPUT_LONGEST_WORD / 2)
    return wrong_header(input, line, "a texture's name is too long", NULL);
  while (name_end > name && is_blank(name_end[-1]))
    name_end--;
  if (name_end <= name)
    return wrong_header(input, line, "a texture without a name", NULL);
  if (textures->count == CONIC_MAX_MATERIALS)
    return wrong_header(input, line, "too many textures", NULL);
  return conic_texts_add(input->context, textures, name, (size_t)(name_end - name));
}

/* Nerfstudio names an axis, and Brush gives a direction. Its y stands for what it does not know. */
static void read_up(const char *c, const char *end, float up[3]) {
  double found[3] = {begins_with(c, end, "x") ? 1.0 : 0.0, 0.0, begins_with(c, end, "z") ? 1.0 : 0.0};
  for (int axis = 0; axis < 3; axis++) {
    while (c < end && (is_blank(*c) || *c == ',' || *c == '['))
      c++;
    c += conic_number_parse(c, (size_t)(end - c), &found[axis]);
  }
  double square = conic_dot(found, found);
  for (int axis = 0; axis < 3 && square > 1e-30 && square < 1e30; axis++)
    up[axis] = (float)found[axis];
}

/* What Brush and Postshot say of how Gaussians were trained. */
static void read_splat_mode(const char *c, const char *end, conic_ply_splat_mode *mode) {
  static const struct {
    const char *keyword, *value;
    conic_ply_splat_mode mode;
  } known[] = {{"SplatRenderMode:", "default", CONIC_PLY_MODE_PLAIN},
               {"SplatRenderMode:", "mip", CONIC_PLY_MODE_MIP},
               {"SplatRenderMode:", "2dgs", CONIC_PLY_MODE_2D},
               {"antialiased", "0", CONIC_PLY_MODE_PLAIN},
               {"antialiased", "1", CONIC_PLY_MODE_MIP}};
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    const char *value = c;
    if (has_keyword(&value, end, known[i].keyword) && begins_with(value, end, known[i].value))
      *mode = known[i].mode;
  }
}

static conic_status read_comment(conic_input *input, const header_line *line, conic_ply_header *header) {
  conic_status status = conic_input_fill(input, CONIC_INPUT_LONGEST_WORD);
  if (status != CONIC_OK)
    return status;
  const char *c = (const char *)conic_input_bytes(input), *end = c + conic_input_available(input);
  while (c < end && is_blank(*c))
    c++;
  if (has_keyword(&c, end, "TextureFile"))
    return read_texture_name(input, line, c, end, &header->textures);
  header->is_conics |= has_keyword(&c, end, "conic");
  if (has_keyword(&c, end, "Vertical axis:"))
    read_up(c, end, header->up);
  else
    read_splat_mode(c, end, &header->splat_mode);
  return CONIC_OK;
}

static conic_status read_line(conic_input *input, header_line *line, conic_ply_header *header) {
  int is_done = 0;
  line->n_words = 0;
  line->line = input->line;
  for (;;) {
    const char *word;
    size_t length;
    conic_status status = conic_input_word(input, &word, &length);
    if (status != CONIC_OK)
      return status;
    if (length == 0)
      break;
    if (line->n_words < WORDS_PER_LINE)
      copy_word(line->words[line->n_words], WORD_ROOM, word, length);
    line->n_words++;
    if (line->n_words == 1 && is_comment(line))
      break;
  }
  conic_status status = is_word(line, 0, "comment") ? read_comment(input, line, header) : CONIC_OK;
  if (status == CONIC_OK)
    status = conic_input_next_line(input, &is_done);
  if (status == CONIC_OK && is_done)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: the file ends within the header (line %llu)", input->name,
                      (unsigned long long)line->line);
  return status;
}

static conic_status parse_format(conic_input *input, const header_line *line, conic_ply_header *header) {
  static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  if (line->n_words != 3)
    return wrong_header(input, line, "a format line is 'format ENCODING 1.0'", NULL);
  if (!is_word(line, 2, "1.0"))
    return wrong_header(input, line, "unknown PLY version", line->words[2]);
  for (int i = 0; i < 3; i++)
    if (is_word(line, 1, names[i])) {
      header->format = (conic_ply_format)i;
      return CONIC_OK;
    }
  return wrong_header(input, line, "unknown PLY encoding", line->words[1]);
}

/* A natural number without sign; 0 where it is none or does not fit. */
static int parse_count(const char *text, uint64_t *count) {
  *count = 0;
  for (const char *c = text; *c; c++) {
    if (*c < '0' || *c > '9' || *count > (UINT64_MAX - 9) / 10)
      return 0;
    *count = *count * 10 + (uint64_t)(*c - '0');
  }
  return *text != 0;
}

static conic_status parse_element(conic_input *input, const header_line *line, conic_ply_header *header) {
  conic_ply_element element = {.line = line->line, .first_property = header->n_properties};
  if (line->n_words != 3 || !parse_count(line->words[2], &element.count))
    return wrong_header(input, line, "an element line is 'element NAME COUNT'", NULL);
  copy_word(element.name, sizeof element.name, line->words[1], strlen(line->words[1]));
  if (header->n_elements == MOST_ELEMENTS) /* each name is compared with all before it */
    return wrong_header(input, line, "there are too many elements, with", element.name);
  if (conic_ply_find_element(header, element.name))
    return wrong_header(input, line, "a second element", element.name);
  return conic_memory_append(input->context, &header->elements, &header->n_elements, &header->element_capacity,
                             &element, sizeof element);
}

static conic_status parse_type(conic_input *input, const header_line *line, int i_word, conic_ply_type *type) {
  for (int i = 0; i < N_TYPES; i++)
    if (is_word(line, i_word, types[i].names[0]) || is_word(line, i_word, types[i].names[1])) {
      *type = (conic_ply_type)i;
      return CONIC_OK;
    }
  return wrong_header(input, line, "unknown type", line->words[i_word]);
}

static conic_status parse_property(conic_input *input, const header_line *line, conic_ply_header *header) {
  conic_ply_property property = {.is_list = is_word(line, 1, "list")};
  int n_words = property.is_list ? 5 : 3;
  conic_status status = CONIC_OK;
  if (header->n_elements == 0)
    return wrong_header(input, line, "a property before any element", NULL);
  if (line->n_words != n_words)
    return wrong_header(input, line, "a property line is 'property TYPE NAME' or 'property list TYPE TYPE NAME'", NULL);
  if (property.is_list)
    status = parse_type(input, line, 2, &property.count_type);
  if (status == CONIC_OK && !conic_ply_type_is_integer(property.count_type))
    status = wrong_header(input, line, "the length of a list cannot be of type", line->words[2]);
  if (status == CONIC_OK)
    status = parse_type(input, line, n_words - 2, &property.type);
  if (status != CONIC_OK)
    return status;
  conic_ply_element *element = &header->elements[header->n_elements - 1];
  copy_word(property.name, sizeof property.name, line->words[n_words - 1], strlen(line->words[n_words - 1]));
  property.row_offset = element->least_row_bytes;
  element->least_row_bytes += conic_ply_type_bytes(property.is_list ? property.count_type : property.type);
  element->has_lists |= property.is_list;
  element->n_properties++;
  return conic_memory_append(input->context, &header->properties, &header->n_properties, &header->property_capacity,
                             &property, sizeof property);
}

static conic_status read_lines(conic_input *input, conic_ply_header *header) {
  header_line line;
  int has_format = 0;
  conic_status status = read_line(input, &line, header);
  if (status == CONIC_OK && !(line.n_words == 1 && is_word(&line, 0, "ply")))
    status = wrong_header(input, &line, "not a PLY file: it does not begin with 'ply'", NULL);
  while (status == CONIC_OK) {
    status = read_line(input, &line, header);
    if (status == CONIC_OK && is_created_by(&line))
      conic_log(input->context, CONIC_LOG_WARNING,
                "%s: 'Created' is no word of a header; taken as a comment (line %llu)", input->name,
                (unsigned long long)line.line);
    if (status != CONIC_OK || is_comment(&line))
      continue;
    if (is_word(&line, 0, "end_header"))
      break;
    if (is_word(&line, 0, "format") && !has_format) {
      status = parse_format(input, &line, header);
      has_format = 1;
    } else if (is_word(&line, 0, "element"))
      status = parse_element(input, &line, header);
    else if (is_word(&line, 0, "property"))
      status = parse_property(input, &line, header);
    else
      status = wrong_header(input, &line, "a header line cannot begin with", line.words[0]);
  }
  if (status == CONIC_OK && !has_format)
    status = wrong_header(input, &line, "the header has no format line", NULL);
  return status;
}

conic_status conic_ply_header_read(conic_input *input, conic_ply_header *header) {
  memset(header, 0, sizeof *header);
  conic_status status = read_lines(input, header);
  const conic_ply_element *vertices = conic_ply_find_element(header, "vertex");
  if (status == CONIC_OK && vertices && conic_ply_find_property(header, vertices, "sb_params_0") >= 0)
    status = conic_fail(input->context, CONIC_ERROR_INPUT,
                        "%s: colours by spherical betas (sb_params_0 …), which are not read (line %llu)", input->name,
                        (unsigned long long)vertices->line);
  if (status != CONIC_OK)
    conic_ply_header_release(input->context, header);
  return status;
}

void conic_ply_header_release(conic_context *context, conic_ply_header *header) {
  conic_memory_release_these(context, header->elements, header->properties, header->textures.bytes);
  memset(header, 0, sizeof *header);
}

const conic_ply_element *conic_ply_find_element(const conic_ply_header *header, const char *name) {
  for (size_t i = 0; i < header->n_elements; i++)
    if (strcmp(header->elements[i].name, name) == 0)
      return &header->elements[i];
  return NULL;
}

int conic_ply_find_property(const conic_ply_header *header, const conic_ply_element *element, const char *name) {
  for (size_t i = 0; i < element->n_properties; i++)
    if (strcmp(header->properties[element->first_property + i].name, name) == 0)
      return (int)i;
  return -1;
}
