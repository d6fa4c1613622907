/* How triggered subsystems keep the sign that a trigger had. */
#ifndef DSE_ZERO_CROSSING_TYPES_H
#define DSE_ZERO_CROSSING_TYPES_H
#include <rtwtypes.h>

typedef uint8_T ZCSigState;
typedef enum { RISING_ZERO_CROSSING = 1, FALLING_ZERO_CROSSING = -1, ANY_ZERO_CROSSING = 0 } ZCDirection;
typedef enum { FALLING_ZCEVENT = -1, NO_ZCEVENT = 0, RISING_ZCEVENT = 1 } ZCEventType;

/* Also the rows of the table in rt_ZCFcn. */
#define ZERO_ZCSIG 0U
#define POS_ZCSIG 1U
#define NEG_ZCSIG 2U
#define UNINITIALIZED_ZCSIG 3U

#endif
