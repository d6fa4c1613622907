/* Numbers of types, for those who read signals by their description: nobody here. */
#ifndef DSE_BUILTIN_TYPEID_TYPES_H
#define DSE_BUILTIN_TYPEID_TYPES_H
#include <rtwtypes.h>
typedef enum { SS_DOUBLE, SS_SINGLE, SS_INT8, SS_UINT8, SS_INT16, SS_UINT16, SS_INT32, SS_UINT32, SS_BOOLEAN } BuiltInDTypeId;
#endif
