/* What older generated code includes for types alone. */
#ifndef DSE_SIMSTRUC_TYPES_H
#define DSE_SIMSTRUC_TYPES_H
#include <builtin_typeid_types.h>
#include <rtw_continuous.h>
#include <sysran_types.h>
#include <tmwtypes.h>
#include <zero_crossing_types.h>
#endif
