/* The rule of what is in a vehicle's way, in height: collisions, sensors and the vehicle ahead all ask it. Its other half,
   which roads are on one level and who may drive where, is dse/world/in_the_way.py, by which a road sets actor.above. */
#ifndef IN_THE_WAY_H
#define IN_THE_WAY_H

#include <stdbool.h>
#include <stdint.h>

/* Whether something from *lower* to *upper* m above its own road, which is *above* that of a vehicle, meets the part of
   the vehicle from *bottom* to *top*. Upper 0: of an unknown height, in the way however low it is. */
static inline bool in_the_way(double above, double lower, double upper, double bottom, double top) {
    if (above == 0 && upper == 0) return lower < top;
    return above + lower < top && above + upper > bottom;
}

/* Whether a road user is hidden by the road that it is on, or by that of the observer: it is on another level. */
static inline bool is_on_another_level(double above) {
    return above != 0;
}

/* Whether a class of actor_class is among the *users* of a lane. */
static inline bool may_drive(int32_t users, int32_t class) {
    return class >= 0 && class < 31 && (users >> class & 1) != 0;
}

#endif
