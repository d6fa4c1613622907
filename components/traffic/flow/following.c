#include "following.h"

#include <math.h>

following_driver following_on(const following_driver *dry, double grip) {
    following_driver driver = *dry;
    double share = fmin(grip / dry->max_deceleration, 1);
    driver.max_acceleration = fmin(dry->max_acceleration, grip);
    driver.comfortable_deceleration *= share;
    driver.max_deceleration *= share;
    return driver;
}

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
