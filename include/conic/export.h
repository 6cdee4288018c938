/* Marks the functions that the shared library exports. */
#ifndef CONIC_EXPORT_H
#define CONIC_EXPORT_H

#if defined(__GNUC__)
#define CONIC_API __attribute__((visibility("default")))
#else
#define CONIC_API
#endif

#endif
