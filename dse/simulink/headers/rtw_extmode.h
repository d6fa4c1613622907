/* External mode, in which MATLAB listens to a model that runs: nobody listens here. */
#ifndef DSE_RTW_EXTMODE_H
#define DSE_RTW_EXTMODE_H
#include <rtwtypes.h>
#include <sysran_types.h>

typedef struct { void *unused; } RTWExtModeInfo;

#define rteiSetSubSystemActiveVectorAddresses(info, to) ((void)(info), (void)(to))
#define rteiSetModelMappingInfoPtr(info, to) ((void)(info))
#define rteiSetChecksumsPtr(info, to) ((void)(info))
#define rteiSetTPtr(info, to) ((void)(info))
#define rteiSetTFinalTicks(info, to) ((void)(info))
#define rteiSetPtrTFinalTicks(info, to) ((void)(info))

#endif
