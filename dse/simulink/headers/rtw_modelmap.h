/* Tables by which programs find a model's signals (its C API): nobody here reads them, and MODEL_capi.c is left out. */
#ifndef DSE_RTW_MODELMAP_H
#define DSE_RTW_MODELMAP_H
#include <rtwtypes.h>
typedef struct { void *unused; } rtwCAPI_ModelMappingStaticInfo;
typedef struct { void *unused; } rtwCAPI_ModelMappingInfo;
#endif
