#include "driver_controls.h"

#include <math.h>

#define WALKING 2.0  /* m/s: below it, released pedals hold the car */
#define STANDING 0.5 /* m/s: below it, they do so fully */
#define RELEASED 0.05 /* of the accelerator's way: above it, the engine does not brake */

static double limited(double value, double low, double high) {
    return fmin(fmax(value, low), high);
}

static double towards(double from, double to, double most) {
    return fabs(to - from) <= most ? to : from + copysign(most, to - from);
}

/* Ratio of the wheels' angle at walking speed to that at *speed*: full lock gives at most the lateral acceleration. */
static double gearing(const driver_controls *self) {
    double squared = self->in.speed * self->in.speed;
    double most = self->par.max_lateral_acceleration * self->par.wheelbase;
    return squared * self->par.max_steering > most ? most / (squared * self->par.max_steering) : 1;
}

static void decide(driver_controls *self, bool brakes, bool is_emergency) {
    bool is_wanted = self->in.driver.cruise;
    bool was_active = self->is_active;
    if (!is_wanted || brakes || is_emergency)
        self->is_active = false;
    else if (!self->was_cruise)
        self->is_active = true;
    self->was_cruise = is_wanted;
    if (was_active && !self->is_active) self->released = self->in.cruise_demand.brake_torque;
}

static void along(driver_controls *self, bool brakes) {
    double speed = fabs(self->in.speed), accelerator = limited(self->in.driver.accelerator, 0, 1);
    double per_acceleration = self->par.nominal_mass * self->par.wheel_radius;
    double most = fmin(self->par.max_drive_torque, self->par.max_drive_power * self->par.wheel_radius / fmax(speed, 0.1));
    double drive = accelerator * most;
    double brake = limited(self->in.driver.brake, 0, 1) * self->par.max_deceleration * per_acceleration;
    double asked = self->in.cruise_demand.drive_torque - self->in.cruise_demand.brake_torque;
    if (self->is_active) {
        bool is_override = drive > 0 && drive > asked;
        self->out.mode = is_override ? CONTROLS_OVERRIDE : CONTROLS_CRUISE;
        self->out.demand.drive_torque = is_override ? drive : self->in.cruise_demand.drive_torque;
        self->out.demand.brake_torque = is_override ? 0 : self->in.cruise_demand.brake_torque;
        return;
    }
    double standing = limited((WALKING - speed) / (WALKING - STANDING), 0, 1);
    double overrun = self->par.overrun * per_acceleration;
    double idle = overrun + standing * (fmax(self->par.hold_torque, overrun) - overrun);
    brake = fmax(brake, idle * (1 - fmin(accelerator / RELEASED, 1)));
    if (accelerator > RELEASED && !brakes) self->released = 0;
    self->out.mode = self->in.driver.cruise ? CONTROLS_STANDBY : CONTROLS_MANUAL;
    self->out.demand.drive_torque = brakes ? 0 : drive;
    self->out.demand.brake_torque = fmax(brake, self->released);
}

static void across(driver_controls *self) {
    double gear = gearing(self);
    if (self->in.driver.hands_on) {
        double wanted = limited(self->in.driver.steering, -self->par.max_steering, self->par.max_steering);
        self->hand = towards(self->hand, wanted, self->par.hand_rate * CONTROLS_STEP);
        self->out.steering = self->hand * gear;
        self->out.steered_by = CONTROLS_BY_DRIVER;
        self->is_returning = true;
        return;
    }
    double last = self->out.steering;
    self->out.steering = self->is_returning ? towards(last, self->in.lane_steering, self->par.return_rate * CONTROLS_STEP)
                                            : self->in.lane_steering;
    self->is_returning = self->is_returning && self->out.steering != self->in.lane_steering;
    /* The steering wheel follows, so that its angle is right when the hands take over. */
    self->hand = limited(self->out.steering / gear, -self->par.max_steering, self->par.max_steering);
    self->out.steered_by = CONTROLS_BY_LANE_KEEPING;
}

void driver_controls_init(driver_controls *self) {
    self->was_cruise = self->is_active = false;
    self->released = 0;
    self->is_returning = false;
    self->out.steering = self->in.lane_steering;
    self->hand = limited(self->in.lane_steering, -self->par.max_steering, self->par.max_steering);
    self->out.set_speed = self->in.driver.set_speed;
    driver_controls_step(self);
}

void driver_controls_step(driver_controls *self) {
    bool brakes = self->in.driver.brake > self->par.brake_touch, is_emergency = self->in.stage >= CONTROLS_STAGE_PARTIAL;
    self->released = fmax(self->released - self->par.release_rate * CONTROLS_STEP, 0);
    decide(self, brakes, is_emergency);
    along(self, brakes);
    if (is_emergency) self->out.mode = CONTROLS_EMERGENCY;
    across(self);
    self->out.set_speed = self->is_active ? towards(self->out.set_speed, self->in.driver.set_speed,
                                                    self->par.set_speed_rate * CONTROLS_STEP)
                                          : self->in.speed;
}
