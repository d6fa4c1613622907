/* Where a folder does not bring its own. */
#ifndef DSE_RTWTYPES_H
#define DSE_RTWTYPES_H
#include <tmwtypes.h>
#endif
