#include "tracker.h"

#include <math.h>

tracker_place tracker_place_of(const tracker_detection *seen, const tracker_motion *motion, double mount) {
    double c = cos(seen->azimuth), s = sin(seen->azimuth);
    double own = motion->speed * c + (motion->lateral_speed + motion->yaw_rate * mount) * s;
    tracker_place place = {mount + seen->range * c, seen->range * s, c, s, seen->range_rate + own};
    return place;
}
