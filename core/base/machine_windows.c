#include <windows.h>

#include "core/base/machine.h"
#include "core/base/memory.h"

int conic_machine_threads(void) {
  DWORD n = GetActiveProcessorCount(ALL_PROCESSOR_GROUPS);
  return n < 1 ? 1 : (int)n;
}

uint64_t conic_machine_memory(void) {
  MEMORYSTATUSEX found = {.dwLength = sizeof found};
  return GlobalMemoryStatusEx(&found) ? found.ullTotalPhys : 0;
}

/* They would need a user's right, and memory that is never paged out. */
void conic_memory_advise_large_pages(void *pointer, size_t bytes) {
  (void)pointer, (void)bytes;
}
