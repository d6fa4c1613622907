/* The names that generated code has for the types of C, where its folder takes them from MATLAB's. A folder that defines
 * them itself says so by the same name. */
#ifndef __TMWTYPES__
#define __TMWTYPES__
#include <limits.h>
#include <stdint.h>

typedef int8_t int8_T;
typedef uint8_t uint8_T;
typedef int16_t int16_T;
typedef uint16_t uint16_T;
typedef int32_t int32_T;
typedef uint32_t uint32_T;
typedef float real32_T;
typedef double real64_T, real_T, time_T;
typedef unsigned char boolean_T, uchar_T, byte_T;
typedef int int_T;
typedef unsigned int uint_T;
typedef unsigned long ulong_T;
typedef char char_T;

/* Later headers of the folder define these unless they are there. */
#ifndef INT64_T
#define INT64_T
typedef long long int64_T;
#endif
#ifndef UINT64_T
#define UINT64_T
typedef unsigned long long uint64_T;
#endif
#ifndef POINTER_T
#define POINTER_T
typedef void *pointer_T;
#endif

#define CREAL_T
typedef struct { real32_T re, im; } creal32_T;
typedef struct { real_T re, im; } creal_T, creal64_T;
typedef struct { int8_T re, im; } cint8_T;
typedef struct { uint8_T re, im; } cuint8_T;
typedef struct { int16_T re, im; } cint16_T;
typedef struct { uint16_T re, im; } cuint16_T;
typedef struct { int32_T re, im; } cint32_T;
typedef struct { uint32_T re, im; } cuint32_T;

#define MAX_int8_T ((int8_T)(127))
#define MIN_int8_T ((int8_T)(-128))
#define MAX_uint8_T ((uint8_T)(255))
#define MAX_int16_T ((int16_T)(32767))
#define MIN_int16_T ((int16_T)(-32768))
#define MAX_uint16_T ((uint16_T)(65535))
#define MAX_int32_T ((int32_T)(2147483647))
#define MIN_int32_T ((int32_T)(-2147483647 - 1))
#define MAX_uint32_T ((uint32_T)(0xFFFFFFFFU))
#define MAX_int64_T ((int64_T)(9223372036854775807LL))
#define MIN_int64_T ((int64_T)(-9223372036854775807LL - 1LL))
#define MAX_uint64_T ((uint64_T)(0xFFFFFFFFFFFFFFFFULL))

#ifndef __cplusplus
#ifndef true
#define true (1U)
#define false (0U)
#endif
#endif
#ifndef TRUE
#define TRUE (1U)
#define FALSE (0U)
#endif
#ifndef UNUSED_PARAMETER
#define UNUSED_PARAMETER(x) ((void)(x))
#endif

#endif
