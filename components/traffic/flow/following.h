/* The Intelligent Driver Model: M. Treiber, A. Hennecke, D. Helbing: Phys. Rev. E 62, 1805 (2000); IDM+: W. Schakel,
   B. van Arem, B. Netten: 13th Int. IEEE Conf. on Intelligent Transportation Systems, 759 (2010). */
#ifndef FOLLOWING_H
#define FOLLOWING_H

#include <stdbool.h>

typedef struct {
    double desired_speed, time_gap, standstill_gap, max_acceleration, comfortable_deceleration, max_deceleration;
    bool plus; /* IDM+ */
} following_driver;

/* The driver on a surface where the tyres can do *grip* m/s2: decelerations use the same share of it as on a dry road
   (assumed), so that vehicles brake earlier. */
following_driver following_on(const following_driver *dry, double grip);

/* m/s2; *gap* from bumper to bumper to the user ahead, infinite: none. At least what the brakes can do. */
double following_acceleration(const following_driver *driver, double speed, double gap, double speed_ahead);

#endif
