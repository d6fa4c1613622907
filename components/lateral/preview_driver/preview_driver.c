#include "preview_driver.h"

#include <math.h>

#include "../lateral/car_model.h"

/* Predictions at one speed: z = transition z + steering d from one preview time to the next. */
static void learn(preview_driver *self, int row) {
    const preview_driver_par *par = &self->par;
    car_model car = {
        par->mass, par->yaw_inertia, par->wheelbase, par->front_load_share, par->front_stiffness, par->rear_stiffness,
    };
    car_motion motion = car_motion_over(&car, DRIVER_SPEED_STEP * (row + 1), par->preview_time / DRIVER_GLANCES);
    double by[3][4] = {{0, 1, 0, 0}, {0, 0, 0, 1}, {0, 0, 0, 0}}; /* starts with a rate, a yaw rate, steering */
    for (int glance = 0; glance < DRIVER_GLANCES; ++glance) {
        for (int start = 0; start < 3; ++start) {
            double next[4];
            for (int i = 0; i < 4; ++i) {
                next[i] = start == 2 ? motion.steering[i] : 0;
                for (int j = 0; j < 4; ++j) next[i] += motion.transition[i][j] * by[start][j];
            }
            for (int i = 0; i < 4; ++i) by[start][i] = next[i];
        }
        self->moved[row][glance].by_rate = by[0][0];
        self->moved[row][glance].by_yaw_rate = by[1][0];
        self->moved[row][glance].by_steering = by[2][0];
    }
}

static double wanted(const preview_driver *self) {
    const lateral_in *in = &self->in;
    double speed = in->motion.speed;
    double place = lateral_clamp(speed / DRIVER_SPEED_STEP - 1, 0, DRIVER_SPEEDS - 1);
    int row = (int)fmin(place, DRIVER_SPEEDS - 2), from = 0;
    double part = place - row, reach = DRIVER_SPEED_STEP * (place + 1) * self->par.preview_time;
    double above = 0, below = 0;
    lateral_line line = lateral_line_of(in);
    for (int n = 0; n < DRIVER_GLANCES; ++n) {
        double rate = self->moved[row][n].by_rate, yaw = self->moved[row][n].by_yaw_rate;
        double turn = self->moved[row][n].by_steering;
        rate += part * (self->moved[row + 1][n].by_rate - rate);
        yaw += part * (self->moved[row + 1][n].by_yaw_rate - yaw);
        turn += part * (self->moved[row + 1][n].by_steering - turn);
        lateral_point path = lateral_path(&line, reach * (n + 1) / DRIVER_GLANCES, &from);
        above += turn * (path.y - rate * in->motion.lateral_speed - yaw * in->motion.yaw_rate);
        below += turn * turn;
    }
    return below > 0 ? lateral_clamp(above / below, -self->par.max_steering, self->par.max_steering) : 0;
}

/* The wanted steering a reaction time ago, linear between samples. */
static double reacted(const preview_driver *self) {
    double age = lateral_clamp(self->par.reaction_time / LATERAL_STEP, 0, DRIVER_MEMORY - 2);
    int whole = (int)age;
    double newer = self->wanted[(self->latest + DRIVER_MEMORY - whole) % DRIVER_MEMORY];
    double older = self->wanted[(self->latest + DRIVER_MEMORY - whole - 1) % DRIVER_MEMORY];
    return newer + (age - whole) * (older - newer);
}

void preview_driver_init(preview_driver *self) {
    for (int row = 0; row < DRIVER_SPEEDS; ++row) learn(self, row);
    /* Starts as if the steering had been the same before. */
    self->out.steering = wanted(self);
    for (int i = 0; i < DRIVER_MEMORY; ++i) self->wanted[i] = self->out.steering;
    self->latest = 0;
}

void preview_driver_step(preview_driver *self) {
    double follows = self->par.muscle_time > 0 ? -expm1(-LATERAL_STEP / self->par.muscle_time) : 1;
    self->latest = (self->latest + 1) % DRIVER_MEMORY;
    self->wanted[self->latest] = wanted(self);
    double steering = self->out.steering + follows * (reacted(self) - self->out.steering);
    self->out.steering =
        lateral_steering(steering, self->out.steering, self->par.max_steering, self->par.max_steering_rate);
}
