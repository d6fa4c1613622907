/* The binary interface of FMI 3.0, written for this project: the types of its functions. */
#ifndef DSE_FMI3_ABI_H
#define DSE_FMI3_ABI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef void *fmi3Instance;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef bool fmi3Clock;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
    fmi3Independent,
    fmi3Constant,
    fmi3Fixed,
    fmi3Tunable,
    fmi3Discrete,
    fmi3Dependent
} fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void (*fmi3Logger)(void *environment, fmi3Status status, fmi3String category, fmi3String message);

/* Callbacks that this FMU accepts but never calls. */
typedef void (*fmi3IntermediateUpdate)(void *environment, fmi3Float64 time, fmi3Boolean may_set, fmi3Boolean may_get,
    fmi3Boolean is_finished, fmi3Boolean may_return_early, fmi3Boolean *returns_early, fmi3Float64 *early_time);
typedef void (*fmi3ClockUpdate)(void *environment);
typedef void (*fmi3Preemption)(void);

#endif
