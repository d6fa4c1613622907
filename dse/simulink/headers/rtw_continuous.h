/* Stands in for a header that generated code includes and does not bring: nothing of it is used here but a type. */
#ifndef DSE_RTW_CONTINUOUS_H
#define DSE_RTW_CONTINUOUS_H
#include <rtwtypes.h>
#include <rtw_solver.h>

typedef struct { void *unused; } RTWRTModelMethodsInfo;

#endif
