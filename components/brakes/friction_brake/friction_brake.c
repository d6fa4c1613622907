#include "friction_brake.h"

#include <math.h>

static double clamp(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}

static double lagged(double x, double target, double lag, double h) {
    return lag > 0 ? target + (x - target) * exp(-h / lag) : target;
}

static double remembered(const friction_brake *self, int32_t steps_ago) {
    int32_t place = (self->newest - steps_ago) % FRICTION_BRAKE_DELAY;
    return self->demands[place < 0 ? place + FRICTION_BRAKE_DELAY : place];
}

static void output(friction_brake *self) {
    double front = self->par.front_share * self->torque, rear = self->torque - front;
    self->out.torque.front = front;
    self->out.torque.rear = rear;
    self->out.power = front * fabs(self->in.wheel_speed.front) + rear * fabs(self->in.wheel_speed.rear);
}

void friction_brake_init(friction_brake *self) {
    /* Before the start the brake was released. */
    for (int32_t i = 0; i < FRICTION_BRAKE_DELAY; ++i) self->demands[i] = 0;
    self->newest = 0;
    self->torque = 0;
    output(self);
}

void friction_brake_step(friction_brake *self) {
    self->newest = (self->newest + 1) % FRICTION_BRAKE_DELAY;
    self->demands[self->newest] = clamp(self->in.torque_demand, 0, self->par.max_torque);
    /* A dead time between two multiples of the step changes the delayed demand within the step. */
    double steps = clamp(self->par.dead_time / FRICTION_BRAKE_STEP, 0, FRICTION_BRAKE_DELAY - 2);
    int32_t whole = (int32_t)steps;
    double rest = steps - whole;
    double early = rest * FRICTION_BRAKE_STEP, late = FRICTION_BRAKE_STEP - early;
    double torque = self->torque;
    if (rest > 0) torque = lagged(torque, remembered(self, whole + 1), self->par.lag, early);
    self->torque = lagged(torque, remembered(self, whole), self->par.lag, late);
    output(self);
}
