#include <fcntl.h>
#include <io.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
/* after it */
#include <windows.h>

#include <psapi.h>
#include <shellapi.h>

#include "cli/shell.h"
#include "core/files/disk.h"
#include "core/files/file.h"

static UINT code_page_before;

static void restore_code_page(void) {
  SetConsoleOutputCP(code_page_before);
}

/* Windows hands arguments over as one line, in UTF-16. The array is never released: it is main's. */
char **cli_shell_begin(int *argc, char **argv) {
  int n = 0;
  const int streams[] = {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO};
  for (size_t i = 0; i < sizeof streams / sizeof *streams; i++)
    _setmode(streams[i], _O_BINARY);
  code_page_before = GetConsoleOutputCP();
  if (code_page_before && code_page_before != CP_UTF8 && SetConsoleOutputCP(CP_UTF8))
    atexit(restore_code_page);
  wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), &n);
  if (!wide)
    return argv;
  char **arguments = malloc(((size_t)n + 1) * sizeof *arguments);
  for (int i = 0; arguments && i < n; i++) {
    int room = WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, NULL, 0, NULL, NULL);
    arguments[i] = malloc(room > 0 ? (size_t)room : 1);
    if (!arguments[i])
      return NULL;
    arguments[i][0] = '\0';
    WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, arguments[i], room, NULL, NULL);
  }
  LocalFree(wide);
  if (!arguments)
    return NULL;
  arguments[n] = NULL;
  *argc = n;
  return arguments;
}

static void (*wish_handler)(int signal_number);

static BOOL WINAPI on_console_event(DWORD event) {
  if (event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT) {
    wish_handler(SIGINT);
    return TRUE;
  }
  wish_handler(SIGTERM);
  Sleep(INFINITE); /* the process ends when this returns: that is for main to do, or the stopper */
  return TRUE;
}

/* A closed pipe is a failed write. */
void cli_shell_catch(void (*on_wish)(int signal_number), void (*on_closed_pipe)(int signal_number)) {
  (void)on_closed_pipe;
  int is_first = !wish_handler;
  wish_handler = on_wish;
  if (is_first)
    SetConsoleCtrlHandler(on_console_event, TRUE);
}

int cli_shell_has_program(const char *name) {
  char command[256];
  int n = snprintf(command, sizeof command, "where %s > NUL 2>&1", name);
  return n < (int)sizeof command && system(command) == 0;
}

FILE *cli_shell_pipe_to(const char *const *words) {
  char command[8192] = "";
  size_t n = 0;
  for (; *words; words++) {
    if (strchr(*words, '"') || n + strlen(*words) + 8 > sizeof command)
      return NULL;
    n += (size_t)snprintf(command + n, sizeof command - n, n ? " \"%s\"" : "%s", *words);
  }
  return _popen(command, "wb");
}

int cli_shell_pipe_end(FILE *pipe) {
  return _pclose(pipe);
}

int cli_shell_is_terminal(FILE *stream) {
  DWORD mode;
  return GetConsoleMode((HANDLE)_get_osfhandle(fileno(stream)), &mode) != 0;
}

int cli_shell_has_cursor(void) {
  HANDLE console = (HANDLE)_get_osfhandle(STDERR_FILENO);
  DWORD mode;
  return GetConsoleMode(console, &mode) && SetConsoleMode(console, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
}

int cli_shell_columns(void) {
  CONSOLE_SCREEN_BUFFER_INFO about;
  return GetConsoleScreenBufferInfo((HANDLE)_get_osfhandle(STDERR_FILENO), &about)
             ? about.srWindow.Right - about.srWindow.Left + 1
             : 80;
}

double cli_shell_cpu_seconds(void) {
  FILETIME begun, ended, kernel, user;
  if (!GetProcessTimes(GetCurrentProcess(), &begun, &ended, &kernel, &user))
    return 0.0;
  return 429.4967296 * ((double)kernel.dwHighDateTime + (double)user.dwHighDateTime) +
         1e-7 * ((double)kernel.dwLowDateTime + (double)user.dwLowDateTime);
}

void cli_shell_name_host(char *processor, size_t processor_room, char *system, size_t system_room) {
  const char *name = getenv("PROCESSOR_IDENTIFIER"), *kind = getenv("PROCESSOR_ARCHITECTURE");
  snprintf(processor, processor_room, "%s", name ? name : "unknown");
  snprintf(system, system_room, "Windows, %s", kind ? kind : "unknown");
}

unsigned long long cli_shell_peak_bytes(void) {
  PROCESS_MEMORY_COUNTERS held;
  return GetProcessMemoryInfo(GetCurrentProcess(), &held, sizeof held) ? held.PeakWorkingSetSize : 0;
}

/* Past the "]" of a "[…]", and whether it has the letter; null where it does not end. */
static const char *match_letters(const char *pattern, char letter, int *has_it) {
  const char *c = pattern + 1;
  int is_other = *c == '!' || *c == '^', is_first = 1;
  c += is_other;
  *has_it = 0;
  for (; *c && (is_first || *c != ']'); c++, is_first = 0) {
    int is_range = c[1] == '-' && c[2] && c[2] != ']';
    *has_it |= is_range ? letter >= *c && letter <= c[2] : letter == *c;
    c += is_range ? 2 : 0;
  }
  *has_it = *has_it != is_other;
  return *c ? c + 1 : NULL;
}

static int is_name_of(const char *pattern, const char *name) {
  for (; *pattern; name++) {
    int has_it = 1;
    const char *behind;
    if (*pattern == '*') {
      while (*pattern == '*')
        pattern++;
      for (; *name; name++)
        if (is_name_of(pattern, name))
          return 1;
      return *pattern == '\0';
    }
    if (*name == '\0')
      return 0;
    if (*pattern == '[' && (behind = match_letters(pattern, *name, &has_it)) != NULL)
      pattern = behind;
    else
      has_it = *pattern == '?' || *pattern == *name, pattern++;
    if (!has_it)
      return 0;
  }
  return *name == '\0';
}

void cli_shell_give_back_memory(void) {
}

/* Folders are taken as they stand: a pattern is of names in one. */
int cli_shell_match(const char *pattern, int (*take)(void *cookie, const char *path), void *cookie) {
  const char *last = conic_file_name(pattern);
  const size_t n_folder = (size_t)(last - pattern), room = n_folder + sizeof((conic_disk_folder *)0)->name + 2;
  conic_disk_folder folder;
  char *path = malloc(room);
  if (!path)
    return 0;
  snprintf(path, room, "%.*s", n_folder ? (int)n_folder : 1, n_folder ? pattern : ".");
  conic_disk_open_folder(path, &folder);
  for (const char *name; (name = conic_disk_next_name(&folder));) {
    snprintf(path, room, "%.*s%s", (int)n_folder, pattern, name);
    if ((name[0] != '.' || last[0] == '.') && is_name_of(last, name) && !take(cookie, path))
      break;
  }
  conic_disk_close_folder(&folder);
  free(path);
  return 1;
}
