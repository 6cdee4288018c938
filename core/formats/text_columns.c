#include "core/formats/text_columns.h"

#include "core/base/base.h"

/* Names of a meaning, letters and digits only; earlier ones win. */
static const char *const names_of[CONIC_TEXT_N_MEANINGS][16] = {
    {"x", "xcoordinate", "xcoord", "coordinatex", "coordx", "positionx", "posx", "px", "points0", "easting", "east",
     "longitude", "lon", "lng", "e"},
    {"y", "ycoordinate", "ycoord", "coordinatey", "coordy", "positiony", "posy", "py", "points1", "northing", "north",
     "latitude", "lat", "n"},
    {"z", "zcoordinate", "zcoord", "coordinatez", "coordz", "positionz", "posz", "pz", "points2", "altitude", "alt",
     "elevation", "elev", "height", "h"},
    {"red", "r", "rf", "colorr", "colourr", "diffusered", "rgb0", "colors0"},
    {"green", "g", "gf", "colorg", "colourg", "diffusegreen", "rgb1", "colors1"},
    {"blue", "b", "bf", "colorb", "colourb", "diffuseblue", "rgb2", "colors2"},
    {"nx", "normalx", "xnormal", "normal0", "normals0"},
    {"ny", "normaly", "ynormal", "normal1", "normals1"},
    {"nz", "normalz", "znormal", "normal2", "normals2"},
};

/* Lower-case letters and digits, up to a bracket with a unit: "Pos. X (m)" becomes "posx". */
static void reduce(conic_text_word name, char reduced[CONIC_TEXT_NAME_ROOM]) {
  size_t n = 0;
  for (size_t i = 0; i < name.length && n + 1 < CONIC_TEXT_NAME_ROOM; i++) {
    char c = name.text[i];
    if (c == '(' || c == '[')
      break;
    c = (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
      reduced[n++] = c;
  }
  reduced[n] = 0;
}

/* Gives the meaning to the column with the first of its names that exists. */
static int find_meaning(const char (*reduced)[CONIC_TEXT_NAME_ROOM], int meaning, conic_text_columns *columns) {
  for (int i_name = 0; i_name < 16 && names_of[meaning][i_name]; i_name++)
    for (size_t i = 0; i < columns->n; i++)
      if (columns->meaning[i] < 0 && strcmp(reduced[i], names_of[meaning][i_name]) == 0) {
        columns->meaning[i] = meaning;
        return 1;
      }
  return 0;
}

/* Three columns get their meaning together or not at all. */
static int find_three(const char (*reduced)[CONIC_TEXT_NAME_ROOM], int first, conic_text_columns *columns) {
  int n_found = 0;
  for (int i = 0; i < 3; i++)
    n_found += find_meaning(reduced, first + i, columns);
  for (size_t i = 0; i < columns->n && n_found < 3; i++)
    if (columns->meaning[i] >= first)
      columns->meaning[i] = CONIC_TEXT_SCALAR;
  return n_found == 3;
}

static void set_name(conic_text_columns *columns, size_t i, const char *name, size_t length) {
  length = length < CONIC_TEXT_NAME_ROOM ? length : CONIC_TEXT_NAME_ROOM - 1;
  for (size_t k = 0; k < length; k++)
    columns->name[i][k] = (char)((unsigned char)name[k] < 0x20 ? '?' : name[k]);
  columns->name[i][length] = 0;
  columns->meaning[i] = CONIC_TEXT_SCALAR;
}

int conic_text_columns_name(const conic_text_word *names, size_t n, conic_text_columns *columns) {
  char reduced[CONIC_TEXT_MOST_COLUMNS][CONIC_TEXT_NAME_ROOM];
  memset(columns, 0, sizeof *columns);
  columns->n = n < CONIC_TEXT_MOST_COLUMNS ? n : CONIC_TEXT_MOST_COLUMNS;
  for (size_t i = 0; i < columns->n; i++) {
    set_name(columns, i, names[i].text, names[i].length);
    reduce(names[i], reduced[i]);
  }
  const char(*all)[CONIC_TEXT_NAME_ROOM] = (const char(*)[CONIC_TEXT_NAME_ROOM])reduced;
  int has_positions = find_three(all, CONIC_TEXT_X, columns);
  columns->has_colors = has_positions && find_three(all, CONIC_TEXT_RED, columns);
  columns->has_normals = has_positions && find_three(all, CONIC_TEXT_NORMAL, columns);
  return has_positions;
}

static int is_any_of(const char *reduced, int first) {
  for (int meaning = first; meaning < first + 3; meaning++)
    for (int i = 0; i < 16 && names_of[meaning][i]; i++)
      if (strcmp(reduced, names_of[meaning][i]) == 0)
        return 1;
  return 0;
}

/* Checks names that the caller gave: a part of a colour or normal alone, or a name that comes twice. */
static const char *check_names(const conic_text_columns *columns) {
  for (size_t i = 0; i < columns->n; i++) {
    char reduced[CONIC_TEXT_NAME_ROOM];
    reduce((conic_text_word){columns->name[i], strlen(columns->name[i])}, reduced);
    if (reduced[0] && conic_text_columns_find(columns, columns->name[i]) != (int)i)
      return "a name comes twice";
    if (!columns->has_colors && is_any_of(reduced, CONIC_TEXT_RED))
      return "a colour is r, g and b";
    if (!columns->has_normals && is_any_of(reduced, CONIC_TEXT_NORMAL))
      return "a normal is nx, ny and nz";
  }
  return NULL;
}

const char *conic_text_columns_parse(const char *list, conic_text_columns *columns) {
  conic_text_dialect dialect;
  conic_text_word words[CONIC_TEXT_MOST_COLUMNS];
  int is_open;
  conic_text_dialect_begin(strchr(list, ',') ? CONIC_TEXT_COMMAS : CONIC_TEXT_BLANKS, &dialect);
  size_t n =
      conic_text_split(&dialect, (conic_text_word){list, strlen(list)}, words, CONIC_TEXT_MOST_COLUMNS, &is_open);
  for (size_t i = 0; i < n; i++)
    if (words[i].length == 0)
      return "a name is missing between two commas; - stands for a column that is passed over";
  int has_positions = conic_text_columns_name(words, n, columns);
  return has_positions ? check_names(columns) : "x, y and z are needed";
}

/* --- without names --- */

static int looks_like_normals(const double (*rows)[CONIC_TEXT_MOST_GUESSED], size_t n_rows, size_t first) {
  int n_unit = 0, n_other = 0;
  for (size_t i = 0; i < n_rows; i++) {
    const double *v = rows[i] + first;
    double length2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (v[0] < 0.0 || v[1] < 0.0 || v[2] < 0.0)
      return 1;
    n_unit += length2 > 0.95 * 0.95 && length2 < 1.05 * 1.05;
    n_other += length2 >= 1.05 * 1.05 || (length2 > 0.0 && length2 <= 0.95 * 0.95);
  }
  return n_unit > 0 && n_other == 0;
}

/* Whether three columns are unit normals, or 8-bit codes, in every row. */
static int is_unit(const double (*rows)[CONIC_TEXT_MOST_GUESSED], size_t n_rows, size_t first) {
  for (size_t i = 0; i < n_rows; i++) {
    const double *v = rows[i] + first;
    double length2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (!(length2 > 0.95 * 0.95 && length2 < 1.05 * 1.05))
      return 0;
  }
  return 1;
}

static int is_codes(const double (*rows)[CONIC_TEXT_MOST_GUESSED], size_t n_rows, size_t first) {
  double largest = 0.0;
  for (size_t i = 0; i < n_rows; i++)
    for (size_t k = first; k < first + 3; k++) {
      if (!(rows[i][k] >= 0.0 && rows[i][k] <= 255.0) || rows[i][k] != (double)(int)rows[i][k])
        return 0;
      largest = rows[i][k] > largest ? rows[i][k] : largest;
    }
  return largest > 1.0;
}

static int is_whole(const double (*rows)[CONIC_TEXT_MOST_GUESSED], size_t n_rows, size_t at) {
  for (size_t i = 0; i < n_rows; i++)
    if (!(fabs(rows[i][at]) < 1e9) || rows[i][at] != (double)(int)rows[i][at])
      return 0;
  return 1;
}

static double largest_of(const double (*rows)[CONIC_TEXT_MOST_GUESSED], size_t n_rows, size_t at) {
  double largest = -HUGE_VAL;
  for (size_t i = 0; i < n_rows; i++)
    largest = fmax(largest, rows[i][at]);
  return largest;
}

static void set_three(conic_text_columns *columns, size_t at, int first) {
  for (size_t i = 0; i < 3; i++) {
    const char *name = names_of[(size_t)first + i][0];
    set_name(columns, at + i, name, strlen(name));
    columns->meaning[at + i] = first + (int)i;
  }
  columns->has_colors |= first == CONIC_TEXT_RED;
  columns->has_normals |= first == CONIC_TEXT_NORMAL;
}

/* Finds, in any number of columns, the first three that can hardly be anything else. */
static void guess_many(const double (*rows)[CONIC_TEXT_MOST_GUESSED], size_t n_rows, conic_text_columns *columns) {
  size_t n = columns->n < CONIC_TEXT_MOST_GUESSED ? columns->n : CONIC_TEXT_MOST_GUESSED;
  for (size_t at = 3; at + 3 <= n;) {
    int first = !columns->has_normals && is_unit(rows, n_rows, at)   ? (int)CONIC_TEXT_NORMAL
                : !columns->has_colors && is_codes(rows, n_rows, at) ? (int)CONIC_TEXT_RED
                                                                     : (int)CONIC_TEXT_SCALAR;
    if (first > 0)
      set_three(columns, at, first);
    at += first > 0 ? 3 : 1;
  }
}

/* Of seven, whether the colours come before the last value, as CloudCompare and S3DIS write them, and not behind an
 * intensity. Where both may be codes, a class is a small number. */
static int has_colors_first(const double (*rows)[CONIC_TEXT_MOST_GUESSED], size_t n_rows) {
  if (!is_codes(rows, n_rows, 3))
    return 0;
  return !is_codes(rows, n_rows, 4) || (largest_of(rows, n_rows, 6) < 64.0 && largest_of(rows, n_rows, 3) >= 64.0);
}

/* Eight that begin with a row and a column of a scanner's grid, as FARO writes them. */
static int has_grid_first(const double (*rows)[CONIC_TEXT_MOST_GUESSED], size_t n_rows) {
  return is_whole(rows, n_rows, 0) && is_whole(rows, n_rows, 1) && is_codes(rows, n_rows, 5) &&
         !(is_whole(rows, n_rows, 2) && is_whole(rows, n_rows, 3) && is_whole(rows, n_rows, 4));
}

static void guess_seven(const double (*rows)[CONIC_TEXT_MOST_GUESSED], size_t n_rows, conic_text_columns *columns) {
  const int is_first = has_colors_first(rows, n_rows);
  set_three(columns, is_first ? 3 : 4, CONIC_TEXT_RED);
  if (is_first)
    set_name(columns, 6, "scalar", strlen("scalar"));
  else
    set_name(columns, 3, "intensity", strlen("intensity"));
}

static void guess_grid(conic_text_columns *columns) {
  set_name(columns, 0, "row", strlen("row"));
  set_name(columns, 1, "column", strlen("column"));
  set_three(columns, 2, CONIC_TEXT_X);
  set_three(columns, 5, CONIC_TEXT_RED);
}

void conic_text_columns_guess(const double (*rows)[CONIC_TEXT_MOST_GUESSED], size_t n_rows, size_t n,
                              conic_text_columns *columns) {
  memset(columns, 0, sizeof *columns);
  columns->n = n < CONIC_TEXT_MOST_COLUMNS ? n : CONIC_TEXT_MOST_COLUMNS;
  for (size_t i = 0; i < columns->n; i++)
    set_name(columns, i, "-", 1);
  set_three(columns, 0, CONIC_TEXT_X);
  columns->is_doubtful = n > 6 || (n == 6 && !is_codes(rows, n_rows, 3) && !is_unit(rows, n_rows, 3));
  if (n == 4)
    set_name(columns, 3, "intensity", sizeof "intensity" - 1);
  if (n == 7)
    guess_seven(rows, n_rows, columns);
  else if (n == 8 && has_grid_first(rows, n_rows))
    guess_grid(columns);
  else if (n == 6)
    set_three(columns, 3, looks_like_normals(rows, n_rows, 3) ? CONIC_TEXT_NORMAL : CONIC_TEXT_RED);
  else if (n == 9) {
    int is_first = looks_like_normals(rows, n_rows, 3) && !looks_like_normals(rows, n_rows, 6);
    set_three(columns, 3, is_first ? CONIC_TEXT_NORMAL : CONIC_TEXT_RED);
    set_three(columns, 6, is_first ? CONIC_TEXT_RED : CONIC_TEXT_NORMAL);
  } else if (n > 7)
    guess_many(rows, n_rows, columns);
}

int conic_text_columns_find(const conic_text_columns *columns, const char *name) {
  char wanted[CONIC_TEXT_NAME_ROOM], reduced[CONIC_TEXT_NAME_ROOM];
  reduce((conic_text_word){name, strlen(name)}, wanted);
  for (size_t i = 0; i < columns->n; i++) {
    reduce((conic_text_word){columns->name[i], strlen(columns->name[i])}, reduced);
    if (reduced[0] && strcmp(reduced, wanted) == 0)
      return (int)i;
  }
  return -1;
}

void conic_text_columns_list(const conic_text_columns *columns, char *text, size_t room) {
  size_t length = 0;
  for (size_t i = 0; i < columns->n && length < room; i++)
    length += (size_t)snprintf(text + length, room - length, "%s%s", i ? " " : "", columns->name[i]);
}
