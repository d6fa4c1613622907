#include "drivers.h"

#include <math.h>

#define STANDSTILL 0.1 /* m/s */
#define AT_ONCE 1e9    /* m/s3 */

int32_t driver_samples(double time) {
    return (int32_t)floor(time / EMERGENCY_STEP + 0.5);
}

bool driver_brakes(const driver_foot *foot, const driver_habits *habits) {
    return foot->alarmed > driver_samples(habits->reaction_time);
}

void driver_act(driver_foot *foot, const driver_habits *habits, bool has_cause, double wanted, int32_t stage,
                const emergency_in *in, emergency_out *out) {
    bool is_held = driver_brakes(foot, habits) && in->motion.speed < STANDSTILL;
    if (has_cause) {
        foot->calm = 0;
        if (!driver_brakes(foot, habits)) ++foot->alarmed;
    } else if (foot->alarmed && ++foot->calm >= driver_samples(is_held ? habits->holding_time : habits->release_time)) {
        foot->alarmed = foot->calm = 0;
    }
    double aim = 0;
    out->stage = STAGE_NONE;
    if (driver_brakes(foot, habits)) {
        aim = wanted;
        out->stage = stage;
    } else if (foot->alarmed) {
        aim = habits->release_deceleration;
        out->stage = STAGE_WARNING;
    }
    out->deceleration = emergency_build_up(aim, out->deceleration, habits->jerk, AT_ONCE);
    out->brake_torque = habits->nominal_mass * out->deceleration * habits->wheel_radius;
}
