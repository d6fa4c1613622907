/* How a model tells the time to the models it refers to: pointers to its own clocks, by task. */
#ifndef DSE_MODEL_REFERENCE_TYPES_H
#define DSE_MODEL_REFERENCE_TYPES_H
#include <rtwtypes.h>
typedef struct {
    uint32_T nTasks;
    uint32_T **clockTick, **clockTickH, *taskCounter;
    real_T **taskTime;
    boolean_T **firstInitCond;
} rtTimingBridge;
#endif
