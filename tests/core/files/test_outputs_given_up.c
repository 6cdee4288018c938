/* A program that ends at once, whatever its other threads do, leaves none of the files that it was writing. */
#include "core/files/file.h"

#include <dirent.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/files.h"

/* Those that are there, hidden ones too. */
static int count_files(const char *folder) {
  DIR *listing = opendir(folder);
  int n = 0;
  if (!listing)
    exit(1);
  for (struct dirent *entry; (entry = readdir(listing));)
    n += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
  closedir(listing);
  return n;
}

/* Of three outputs, the first is committed and the second abandoned. */
static void write_and_give_up(conic_context *context) {
  const char *const names[3] = {"committed", "abandoned", "half"};
  conic_output *outputs[3];
  for (int i = 0; i < 3; i++) {
    CHECK_OK(conic_output_open(context, files_path(names[i]), &outputs[i]));
    fputs("half of it", conic_output_stream(outputs[i]));
  }
  CHECK_OK(conic_output_commit(outputs[0]));
  conic_output_abandon(outputs[1]);
  conic_outputs_give_up(context);
  _exit(check_result());
}

int main(void) {
  conic_context *context = files_context();
  int status = 0;
  pid_t child = fork();
  if (child == 0)
    write_and_give_up(context);
  CHECK(child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0);
  CHECK(count_files(files_folder) == 1 && remove(files_path("committed")) == 0);
  files_end(context);
  return check_result();
}
