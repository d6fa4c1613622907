/* For code of a target whose long has 32 bits: its types are built of int and long long, or are exact. */
#include <limits.h>
#undef ULONG_MAX
#define ULONG_MAX 0xFFFFFFFFU
#undef LONG_MAX
#define LONG_MAX 0x7FFFFFFF
#undef LONG_MIN
#define LONG_MIN (-LONG_MAX - 1)
