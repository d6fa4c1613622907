#include "acc.h"

#include <math.h>

#define GRAVITY 9.81     /* m/s2 */
#define AIR_DENSITY 1.2  /* kg/m3 */

double acc_time_gap(int32_t setting) {
    /* ISO 15622: time gaps not below 0.8 s, at least one of them between 1.5 s and 2.2 s. */
    switch (setting) {
    case ACC_GAP_LONG: return 2.0;
    case ACC_GAP_MIDDLE: return 1.5;
    case ACC_GAP_SHORT: return 1.0;
    default: return 0;
    }
}

double acc_wanted_gap(int32_t setting, double standstill_gap, const acc_in *in) {
    return setting == ACC_GAP_FIXED ? in->set_gap : standstill_gap + acc_time_gap(setting) * in->speed;
}

void acc_demand(const acc_car *car, double acceleration, const acc_in *in, acc_out *out) {
    double drag = 0.5 * AIR_DENSITY * car->drag_area * in->speed * fabs(in->speed);
    double rolling = in->speed > 0 ? car->rolling_resistance * car->mass * GRAVITY : 0;
    double torque = car->wheel_radius * (car->mass * acceleration + drag + rolling);
    out->demand.drive_torque = torque > 0 ? torque : 0;
    out->demand.brake_torque = torque < 0 ? -torque : 0;
}

void acc_report(int32_t mode, double wanted_gap, const acc_in *in, acc_out *out) {
    out->mode = mode;
    out->reference.speed = mode == ACC_MODE_DISTANCE ? in->speed - in->target.closing_speed : in->set_speed;
    out->reference.gap = wanted_gap;
}

double acc_limit(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}
