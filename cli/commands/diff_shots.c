#include "cli/commands/diff_shots.h"

#include "core/pictures/picture_shot.h"

static conic_status read_picture_shot(const cli_session *session, const char *path, conic_shot_file **shot) {
  conic_context *context = session->context;
  char *text;
  size_t n_bytes;
  *shot = NULL;
  conic_status status = conic_picture_shot_text(context, path, &text, &n_bytes);
  if (status == CONIC_OK && text)
    status = conic_shot_file_parse(context, NULL, text, n_bytes, shot);
  conic_memory_release(context, text);
  return status == CONIC_ERROR_INPUT && text ? CONIC_OK : status;
}

conic_status cli_diff_shots_read(const cli_session *session, const char *const paths[2], cli_diff_shots *shots) {
  conic_status status = CONIC_OK;
  for (int i = 0; i < 2 && status == CONIC_OK; i++)
    status = read_picture_shot(session, paths[i], &shots->shots[i]);
  if (!shots->shots[0] || !shots->shots[1])
    cli_diff_shots_release(session, shots);
  return status;
}

void cli_diff_shots_release(const cli_session *session, cli_diff_shots *shots) {
  for (int i = 0; i < 2; i++) {
    conic_shot_file_destroy(session->context, shots->shots[i]);
    shots->shots[i] = NULL;
  }
}

static void report_field(void *cookie, const char *field, const char *a, const char *b) {
  cli_json *json = cookie;
  cli_json_object(json, NULL);
  cli_json_text(json, "field", field);
  cli_json_value(json, "a", a);
  cli_json_value(json, "b", b);
  cli_json_close(json);
}

conic_status cli_diff_shots_report(cli_json *json, const cli_session *session, const cli_diff_shots *shots) {
  if (!shots->shots[0])
    return CONIC_OK;
  cli_json_array(json, "shot");
  conic_status status = conic_shot_file_compare(session->context, shots->shots[0], shots->shots[1], report_field, json);
  cli_json_close(json);
  return status;
}

static void print_field(void *cookie, const char *field, const char *a, const char *b) {
  (void)cookie;
  printf("shot: %s %s -> %s\n", field, a ? a : "none", b ? b : "none");
}

/* Without memory there would have been no report. */
void cli_diff_shots_print(const cli_session *session, const cli_diff_shots *shots) {
  if (shots->shots[0])
    conic_shot_file_compare(session->context, shots->shots[0], shots->shots[1], print_field, NULL);
}
