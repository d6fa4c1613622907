#include "following.h"

#include <math.h>

double following_acceleration(const following_driver *driver, double speed, double gap, double speed_ahead) {
    double ratio = speed / driver->desired_speed, free_road = ratio * ratio * ratio * ratio, interaction = 0;
    if (gap <= 0) return -driver->max_deceleration;
    if (gap < HUGE_VAL) {
        double comfort = 2 * sqrt(driver->max_acceleration * driver->comfortable_deceleration);
        double dynamic = speed * driver->time_gap + speed * (speed - speed_ahead) / comfort;
        double share = (driver->standstill_gap + fmax(dynamic, 0)) / gap;
        interaction = share * share;
    }
    double taken = driver->plus ? fmax(free_road, interaction) : free_road + interaction;
    return fmax(driver->max_acceleration * (1 - taken), -driver->max_deceleration);
}
