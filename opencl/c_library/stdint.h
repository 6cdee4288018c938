/* The types of C's <stdint.h> for OpenCL C, whose own have fixed sizes. */
#ifndef CONIC_STDINT_H
#define CONIC_STDINT_H

typedef uchar uint8_t;
typedef ushort uint16_t;
typedef uint uint32_t;
typedef ulong uint64_t;
typedef int int32_t;
typedef long int64_t;

#define UINT32_C(n) n##u
#define INT64_C(n) n##l
#define UINT32_MAX 0xffffffffu

#endif
