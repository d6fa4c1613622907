/* What a step in external mode sends to MATLAB: nothing here. */
#ifndef DSE_EXT_WORK_H
#define DSE_EXT_WORK_H
#include <rtw_extmode.h>
#define rtExtModeUploadCheckTrigger(count) ((void)0)
#define rtExtModeUpload(task, time) ((void)(time))
#define rtExtModeUploadCheckEndTrigger() ((void)0)
#define rtExtModeCheckEndTrigger() ((void)0)
#endif
