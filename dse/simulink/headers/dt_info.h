/* Where data of each type are, for external mode: tables that nobody reads here. */
#ifndef DSE_DT_INFO_H
#define DSE_DT_INFO_H
#include <rtwtypes.h>
#include <builtin_typeid_types.h>

typedef struct {
    char_T *address;
    int type, is_complex, count;
} DataTypeTransition;
typedef struct {
    uint_T count;
    DataTypeTransition *transitions;
} DataTypeTransitionTable;
typedef struct {
    int_T count;
    const char_T **names;
    uint_T *sizes;
    DataTypeTransitionTable *first, *second;
} DataTypeTransInfo;

#endif
