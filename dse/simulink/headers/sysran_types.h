/* Which subsystems have run, for those who draw the model while it does: nobody here. */
#ifndef DSE_SYSRAN_TYPES_H
#define DSE_SYSRAN_TYPES_H
#include <rtwtypes.h>
typedef int8_T sysRanDType;
#define srClearBC(state) ((void)(state))
#define srUpdateBC(state) ((void)(state))
#endif
