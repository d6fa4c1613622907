/* Logs of signals, for MATLAB: nobody here reads them, so what is set is forgotten. */
#ifndef DSE_RT_LOGGING_H
#define DSE_RT_LOGGING_H
#include <rtwtypes.h>
#include <builtin_typeid_types.h>

typedef struct { void *loggingInterval; } RTWLogInfo;
typedef const void **LogSignalPtrsType;
typedef void (*RTWPreprocessingFcnPtr)(void);

/* Filled from tables, by place: what, the type of the data, ... */
typedef struct {
    int_T is_converted;
    BuiltInDTypeId kept_as, type;
    int_T is_fixed, bits, is_signed;
    real_T fraction;
    int_T exponent;
    real_T bias;
} RTWLogDataTypeConvert;
typedef struct {
    int_T count;
    int_T *widths, *dimensions_count, *dimensions;
    boolean_T *varies;
    void **current;
    int_T *current_sizes;
    BuiltInDTypeId *types;
    int_T *complex;
    RTWPreprocessingFcnPtr *functions;
    union { const char_T **cptr; } labels;
    void *label_parts, *titles, *styles;
    union { const char_T **cptr; } blocks;
    union { const char_T **cptr; } states;
    boolean_T *crosses;
    RTWLogDataTypeConvert *conversions;
} RTWLogSignalInfo;

#define rtliSetLogInfo(log, to) ((void)(log))
#define rtliSetLogXSignalInfo(log, to) ((void)(log))
#define rtliSetLogXSignalPtrs(log, to) ((void)(log))
#define rtliSetLogYSignalInfo(log, to) ((void)(log))
#define rtliSetLogYSignalPtrs(log, to) ((void)(log))
#define rtliSetLogT(log, to) ((void)(log))
#define rtliSetLogX(log, to) ((void)(log))
#define rtliSetLogXFinal(log, to) ((void)(log))
#define rtliSetLogY(log, to) ((void)(log))
#define rtliSetLogVarNameModifier(log, to) ((void)(log))
#define rtliSetLogFormat(log, to) ((void)(log))
#define rtliSetLogMaxRows(log, to) ((void)(log))
#define rtliSetLogDecimation(log, to) ((void)(log))

#define rt_StartDataLogging(...) ((const char_T *)0)
#define rt_StartDataLoggingWithStartTime(...) ((const char_T *)0)
#define rt_UpdateTXYLogVars(...) ((const char_T *)0)
#define rt_UpdateTXXFYLogVars(...) ((const char_T *)0)
#define rt_StopDataLogging(...) ((void)0)

#endif
