/* Marks the functions that the shared library exports, and what C++ reads as C. */
#ifndef CONIC_EXPORT_H
#define CONIC_EXPORT_H

#if defined(__GNUC__)
#define CONIC_API __attribute__((visibility("default")))
#else
#define CONIC_API
#endif

#ifdef __cplusplus
#define CONIC_BEGIN_C extern "C" {
#define CONIC_END_C }
#else
#define CONIC_BEGIN_C
#define CONIC_END_C
#endif

#endif
