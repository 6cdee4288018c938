/* [{"input": 0, "frame": 0, "matrix": [[…], […], […], […]]}, {"input": 1, "frame": 1, "file": "…"}, …] */
#include "accumulation/motion_file.h"

#include "core/files/json_read.h"

enum { MOST_INPUTS = 1 << 20 };

static void read_key_matrix(conic_json *json, conic_motion_key *key) {
  double row[4];
  size_t n = 4;
  int n_rows = 0;
  conic_json_begin_array(json);
  while (conic_json_next_item(json)) {
    if (conic_json_numbers(json, row, 4, &n) != CONIC_OK || n != 4 || n_rows == 4)
      conic_json_wrong(json, "a matrix has 3 or 4 rows of 4 numbers");
    for (int column = 0; column < 4 && json->status == CONIC_OK; column++) {
      if (!(fabs(row[column]) < 1e20) || (n_rows == 3 && row[column] != (column == 3 ? 1.0 : 0.0)))
        conic_json_wrong(json, "the numbers of a matrix are finite, and its fourth row is 0, 0, 0, 1");
      else if (n_rows < 3)
        key->matrix[n_rows][column] = row[column];
    }
    n_rows++;
  }
  if (n_rows < 3)
    conic_json_wrong(json, "a matrix has 3 or 4 rows of 4 numbers");
  key->has_matrix = 1;
}

static void read_key_input(conic_json *json, conic_motion_key *key) {
  double number = 0.0;
  conic_json_number(json, &number);
  if (!(number >= 0.0 && number < MOST_INPUTS) || number != floor(number))
    conic_json_wrong(json, "an input is a whole number, from 0");
  else
    key->input = (int)number;
}

static void read_file_name(conic_context *context, conic_json *json, conic_motion_key *key) {
  if (!key->file)
    key->file = conic_memory_allocate_zeroed(context, CONIC_MOTION_NAME_ROOM, 1);
  if (!key->file)
    json->status = CONIC_ERROR_MEMORY;
  else if (conic_json_text(json, key->file, CONIC_MOTION_NAME_ROOM) == CONIC_OK && !*key->file)
    conic_json_wrong(json, "a shape needs the name of its file");
}

static void read_key(conic_context *context, conic_json *json, conic_motion_key *key) {
  char name[CONIC_JSON_KEY_ROOM];
  int has_frame = 0;
  conic_json_begin_object(json);
  while (conic_json_next_member(json, name))
    if (strcmp(name, "input") == 0)
      read_key_input(json, key);
    else if (strcmp(name, "frame") == 0)
      has_frame = conic_json_number(json, &key->frame) == CONIC_OK;
    else if (strcmp(name, "matrix") == 0)
      read_key_matrix(json, key);
    else if (strcmp(name, "file") == 0)
      read_file_name(context, json, key);
    else
      conic_json_wrong(json, "a key has an input, a frame, and a matrix or a file");
  if (!has_frame || !(fabs(key->frame) <= 1e6))
    conic_json_wrong(json, "a key has a frame, from -1e6 to 1e6");
  if (key->has_matrix == (key->file != NULL))
    conic_json_wrong(json, "a key has either a matrix or a file");
  if (key->file && key->input == CONIC_MOTION_ALL)
    conic_json_wrong(json, "a file is the shape of one input: say which");
}

/* A simple sort: keys are few, and mostly in order. */
static void sort_keys(conic_motion_keys *keys) {
  for (size_t i = 1; i < keys->count; i++) {
    conic_motion_key key = keys->keys[i];
    size_t at = i;
    for (; at > 0 && keys->keys[at - 1].frame > key.frame; at--)
      keys->keys[at] = keys->keys[at - 1];
    keys->keys[at] = key;
  }
}

conic_status conic_motion_keys_read(conic_context *context, const char *path, conic_motion_keys *keys) {
  conic_json json;
  memset(keys, 0, sizeof *keys);
  conic_status status = conic_json_open(context, path, &json);
  if (status != CONIC_OK)
    return status;
  status = conic_json_begin_array(&json);
  while (status == CONIC_OK && conic_json_next_item(&json)) {
    if (keys->count == CONIC_MOTION_MOST_KEYS) {
      status = conic_json_wrong(&json, "more than 100000 keys");
      break;
    }
    if (keys->count == keys->room)
      status =
          conic_memory_reserve(context, &keys->keys, keys->count, keys->count + 1, &keys->room, sizeof *keys->keys);
    if (status != CONIC_OK)
      break;
    keys->keys[keys->count] = (conic_motion_key){.input = CONIC_MOTION_ALL};
    read_key(context, &json, &keys->keys[keys->count++]);
    status = json.status;
  }
  if (status == CONIC_OK)
    status = conic_json_end(&json);
  if (status == CONIC_OK && keys->count == 0)
    status = conic_json_wrong(&json, "there are no keys in it");
  conic_json_close(&json);
  if (status == CONIC_OK)
    sort_keys(keys);
  else
    conic_motion_keys_release(context, keys);
  return status;
}

void conic_motion_keys_release(conic_context *context, conic_motion_keys *keys) {
  for (size_t i = 0; i < keys->count; i++)
    conic_memory_release(context, keys->keys[i].file);
  conic_memory_release(context, keys->keys);
  memset(keys, 0, sizeof *keys);
}
