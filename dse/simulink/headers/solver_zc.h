/* What of a signal's way through zero `rt_ZCFcn` compares: from which sign to which. */
#ifndef DSE_SOLVER_ZC_H
#define DSE_SOLVER_ZC_H
#include <rtwtypes.h>

typedef uint8_T slZcEventType, slZcSignalSignType;

#define SL_ZCS_EVENT_NUL ((slZcEventType)0x00)
#define SL_ZCS_EVENT_N2P ((slZcEventType)0x01)
#define SL_ZCS_EVENT_N2Z ((slZcEventType)0x02)
#define SL_ZCS_EVENT_Z2P ((slZcEventType)0x04)
#define SL_ZCS_EVENT_P2N ((slZcEventType)0x08)
#define SL_ZCS_EVENT_P2Z ((slZcEventType)0x10)
#define SL_ZCS_EVENT_Z2N ((slZcEventType)0x20)
#define SL_ZCS_EVENT_ALL_UP ((slZcEventType)0x07)
#define SL_ZCS_EVENT_ALL_DN ((slZcEventType)0x38)
#define SL_ZCS_EVENT_ALL ((slZcEventType)0x3F)

/* Rows and columns of the table in rt_ZCFcn. */
#define SL_ZCS_SIGN_ZERO ((slZcSignalSignType)0)
#define SL_ZCS_SIGN_POS ((slZcSignalSignType)1)
#define SL_ZCS_SIGN_NEG ((slZcSignalSignType)2)
#define SL_ZCS_SIGN_UNK ((slZcSignalSignType)3)

#define slZcHadEvent(event, wanted) (((event) & (wanted)) != 0)
/* Leaving zero on the side that is not where the signal came from was told when it reached zero. */
#define slZcUnAliasEvents(before, now) \
    ((((before) == SL_ZCS_EVENT_N2Z && (now) == SL_ZCS_EVENT_Z2P) || \
      ((before) == SL_ZCS_EVENT_P2Z && (now) == SL_ZCS_EVENT_Z2N)) \
         ? SL_ZCS_EVENT_NUL \
         : (now))

#endif
