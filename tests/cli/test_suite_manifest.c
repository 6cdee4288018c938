/* Manifests of suites: what is read of a sound one, and that a spoiled one is read or refused with one line. */
#include "cli/judge/suite_manifest.h"
#include "tests/support/files.h"
#include "tests/support/suite_example.h"

static void read_sound_manifest(conic_context *context) {
  suite_manifest manifest;
  const char *path = files_write("manifest.json", SUITE_EXAMPLE);
  CHECK_OK(cli_suite_read_manifest(context, path, &manifest));
  CHECK(manifest.n_cases == 1 && strcmp(manifest.floats, "fast") == 0);
  const suite_entry *one = &manifest.cases[0];
  CHECK(strcmp(one->name, "L1-a-p") == 0 && strcmp(one->scene, "a") == 0 && strcmp(one->profile, "p") == 0);
  CHECK(strcmp(one->npy, "e/a.npy") == 0 && strcmp(one->ply, "s/a.ply") == 0 && strcmp(one->camera, "c/a.json") == 0);
  CHECK(one->level == 1 && one->width == 36 && one->height == 20 && one->bytes == 5);
  CHECK(strcmp(one->sha256, SUITE_EXAMPLE_SUM) == 0);
  cli_suite_release_manifest(context, &manifest);
  remove(path);
}

/* Whether it is read. What is, has names that lead nowhere else. */
static int reads(conic_context *context, const char *text, size_t n) {
  suite_manifest manifest;
  const char *path = files_write_bytes("manifest.json", text, n);
  files_message[0] = '\0';
  int is_read = cli_suite_read_manifest(context, path, &manifest) == CONIC_OK;
  CHECK(is_read == (files_message[0] == '\0') && is_read == (manifest.n_cases > 0));
  for (size_t i = 0; i < manifest.n_cases; i++) {
    const suite_entry *one = &manifest.cases[i];
    CHECK(one->npy[0] && one->npy[0] != '/' && !strstr(one->npy, "..") && !strchr(one->name, '/'));
    CHECK(one->level > 0 && one->width > 0 && one->height > 0);
  }
  cli_suite_release_manifest(context, &manifest);
  remove(path);
  return is_read;
}

static void check_spoiled(conic_context *context) {
  static const char others[] = "\0\"{}[]:,./-0x\\";
  const size_t n = strlen(SUITE_EXAMPLE);
  char text[] = SUITE_EXAMPLE;
  for (size_t i = 0; i + 2 < n; i++)
    CHECK(!reads(context, text, i));
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < sizeof others - 1; k++) {
      char was = text[i];
      text[i] = others[k];
      reads(context, text, n);
      text[i] = was;
    }
  CHECK(reads(context, text, n));
}

/* The example with one text in the place of another. */
static void refuse_manifest(conic_context *context, const char *from, const char *to) {
  char text[sizeof SUITE_EXAMPLE + 256];
  const char *at = strstr(SUITE_EXAMPLE, from);
  CHECK(at != NULL);
  int n = snprintf(text, sizeof text, "%.*s%s%s", at ? (int)(at - SUITE_EXAMPLE) : 0, SUITE_EXAMPLE, to,
                   at ? at + strlen(from) : "");
  if (reads(context, text, (size_t)n))
    fprintf(stderr, "%s for %s is read\n", to, from);
  CHECK(!reads(context, text, (size_t)n));
}

int main(void) {
  conic_context *context = files_context();
  read_sound_manifest(context);
  check_spoiled(context);
  refuse_manifest(context, "\"version\": 1", "\"version\": 2");
  refuse_manifest(context, "\"level\": 1", "\"level\": 1.5");
  refuse_manifest(context, "\"level\": 1", "\"level\": 100");
  refuse_manifest(context, "\"width\": 36", "\"width\": 65536");
  refuse_manifest(context, "\"name\": \"L1-a-p\"", "\"name\": \"L1/a\"");
  refuse_manifest(context, "\"name\": \"L1-a-p\"", "\"name\": \".a\"");
  refuse_manifest(context, "\"ply\": \"s/a.ply\"", "\"ply\": \"s/../a.ply\"");
  refuse_manifest(context, "\"ply\": \"s/a.ply\"", "\"ply\": \"/s/a.ply\"");
  refuse_manifest(context, "\"ply\": \"s/a.ply\"", "\"ply\": \"s//a.ply\"");
  refuse_manifest(context, "\"scene\": \"a\"", "\"scene\": \"b\"");
  refuse_manifest(context, "\"path\": \"e/a.npy\"", "\"path\": \"e/b.npy\"");
  refuse_manifest(context, "\"sha256\": \"00", "\"sha256\": \"");
  files_end(context);
  return check_result();
}
