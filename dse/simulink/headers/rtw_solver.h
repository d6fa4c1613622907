/* What generated code asks of its fixed-step solver's record: pointers to the model's own data, and the kind of step. */
#ifndef DSE_RTW_SOLVER_H
#define DSE_RTW_SOLVER_H
#include <rtwtypes.h>

typedef enum { MINOR_TIME_STEP = 0, MAJOR_TIME_STEP } SimTimeStep;
typedef enum { SOLVER_MODE_AUTO, SOLVER_MODE_SINGLETASKING, SOLVER_MODE_MULTITASKING } SolverMode;

typedef struct {
    SimTimeStep *kind;
    void *data, *model;
    const char *name;
    const char **error;
    real_T **t, **x, **dx;
    real_T *step;
    int_T *count, *periodic_count, **periodic_places;
    real_T **periodic_ranges;
    boolean_T **disabled;
    real_T stop;
    boolean_T changes_mode, is_frozen, needs_reset, is_inconsistent;
    SolverMode mode;
} RTWSolverInfo;

#define rtsiSetSimTimeStepPtr(s, to) ((s)->kind = (to))
#define rtsiSetSimTimeStep(s, to) (*(s)->kind = (to))
#define rtsiGetSimTimeStep(s) (*(s)->kind)
#define rtsiGetSimTimeStepPtr(s) ((s)->kind)
#define rtsiSetTPtr(s, to) ((s)->t = (real_T **)(void *)(to))
#define rtsiSetT(s, to) ((*(s)->t)[0] = (to))
#define rtsiGetT(s) ((*(s)->t)[0])
#define rtsiSetStepSizePtr(s, to) ((s)->step = (to))
#define rtsiSetStepSize(s, to) (*(s)->step = (to))
#define rtsiGetStepSize(s) (*(s)->step)
#define rtsiSetContStatesPtr(s, to) ((s)->x = (real_T **)(void *)(to))
#define rtsiGetContStates(s) (*(s)->x)
#define rtsiSetdXPtr(s, to) ((s)->dx = (real_T **)(void *)(to))
#define rtsiSetdX(s, to) (*(s)->dx = (real_T *)(void *)(to))
#define rtsiGetdX(s) (*(s)->dx)
#define rtsiSetNumContStatesPtr(s, to) ((s)->count = (to))
#define rtsiGetNumContStates(s) (*(s)->count)
#define rtsiSetNumPeriodicContStatesPtr(s, to) ((s)->periodic_count = (to))
#define rtsiGetNumPeriodicContStates(s) (*(s)->periodic_count)
#define rtsiSetPeriodicContStateIndicesPtr(s, to) ((s)->periodic_places = (int_T **)(void *)(to))
#define rtsiGetPeriodicContStateIndices(s) (*(s)->periodic_places)
#define rtsiSetPeriodicContStateRangesPtr(s, to) ((s)->periodic_ranges = (real_T **)(void *)(to))
#define rtsiGetPeriodicContStateRanges(s) (*(s)->periodic_ranges)
#define rtsiSetContStateDisabledPtr(s, to) ((s)->disabled = (boolean_T **)(void *)(to))
#define rtsiSetSolverData(s, to) ((s)->data = (void *)(to))
#define rtsiGetSolverData(s) ((s)->data)
#define rtsiSetSolverName(s, to) ((s)->name = (to))
#define rtsiGetSolverName(s) ((s)->name)
#define rtsiSetSolverMode(s, to) ((s)->mode = (to))
#define rtsiGetSolverMode(s) ((s)->mode)
#define rtsiSetSolverStopTime(s, to) ((s)->stop = (to))
#define rtsiGetSolverStopTime(s) ((s)->stop)
#define rtsiSetErrorStatusPtr(s, to) ((s)->error = (const char **)(void *)(to))
#define rtsiSetErrorStatus(s, to) (*(s)->error = (to))
#define rtsiGetErrorStatus(s) (*(s)->error)
#define rtsiSetRTModelPtr(s, to) ((s)->model = (void *)(to))
#define rtsiGetRTModelPtr(s) ((s)->model)
#define rtsiSetIsMinorTimeStepWithModeChange(s, to) ((s)->changes_mode = (to))
#define rtsiGetIsMinorTimeStepWithModeChange(s) ((s)->changes_mode)
#define rtsiSetIsContModeFrozen(s, to) ((s)->is_frozen = (to))
#define rtsiIsContModeFrozen(s) ((s)->is_frozen)
#define rtsiIsModeUpdateTimeStep(s) (*(s)->kind == MAJOR_TIME_STEP)
/* What only solvers with a variable step go by. Earlier releases say BlkStateChange. */
#define rtsiSetSolverNeedsReset(s, to) ((s)->needs_reset = (to))
#define rtsiGetSolverNeedsReset(s) ((s)->needs_reset)
#define rtsiSetBlockStateForSolverChangedAtMajorStep(s, to) ((s)->needs_reset = (to))
#define rtsiGetBlockStateForSolverChangedAtMajorStep(s) ((s)->needs_reset)
#define rtsiSetContTimeOutputInconsistentWithStateAtMajorStep(s, to) ((s)->is_inconsistent = (to))
#define rtsiGetContTimeOutputInconsistentWithStateAtMajorStep(s) ((s)->is_inconsistent)
#define rtsiSetBlkStateChange(s, to) ((s)->is_inconsistent = (to))
#define rtsiGetBlkStateChange(s) ((s)->is_inconsistent)
#define rtsiIsVariableStepSolver(s) 0
#define rtsiSetModelMethodsPtr(s, to) ((void)(s))
#define rtsiSetVariableStepSolver(s, to) ((void)(s))
#define rtsiSetFixedStepSize(s, to) ((void)(s))
#define rtsiSetMinStepSize(s, to) ((void)(s))
#define rtsiSetMaxStepSize(s, to) ((void)(s))

#endif
