#include "light_camera.h"

#include "../sensing/sensing.h"

#include <math.h>
#include <string.h>

#define PI 3.141592653589793
#define NONE 0

static int32_t steps_of(double seconds, int32_t least) {
    double steps = rint(seconds / LIGHT_CAMERA_STEP);
    return steps > least ? (int32_t)steps : least;
}

static bool is_seen(const light_camera *self) {
    double range = self->in.light.distance;
    double lost = self->in.visibility.fog_extinction +
                  sensing_attenuation(self->in.visibility.rain_rate, self->par.rain_loss, self->par.rain_exponent) +
                  sensing_attenuation(self->in.visibility.snow_rate, self->par.snow_loss, self->par.snow_exponent);
    double veil = sensing_veil(self->in.sun.azimuth - self->in.motion.heading, self->in.sun.elevation, self->in.sun.glare);
    bool is_there = self->in.light.colour != NONE && range <= self->par.max_range;
    return is_there && exp(-lost * range) >= self->par.contrast * (1 + veil);
}

static light_camera_look look(light_camera *self) {
    double miss = sensing_uniform(&self->random), length = sqrt(-2 * log(sensing_uniform(&self->random)));
    double error = length * cos(2 * PI * sensing_uniform(&self->random));
    light_camera_look made = {{0, NONE, 0}, self->way, true};
    if (!is_seen(self) || miss <= self->par.dropout) return made;
    made.light.distance = fmax(self->in.light.distance * (1 + self->par.distance_error * error), 0);
    made.light.colour = self->in.light.colour;
    return made;
}

static void tick(light_camera *self) {
    int64_t every = steps_of(self->par.period, 1), late = steps_of(self->par.latency, 0);
    if (late > LIGHT_CAMERA_KEPT - 1) late = LIGHT_CAMERA_KEPT - 1;
    if (self->steps % every == 0) self->looks[(self->steps + late) % LIGHT_CAMERA_KEPT] = look(self);
    light_camera_look *due = &self->looks[self->steps % LIGHT_CAMERA_KEPT];
    if (due->is_due) self->told = *due;
    due->is_due = false;
    self->out.seen = self->told.light;
    if (self->told.light.colour == NONE) return;
    self->out.seen.distance = fmax(self->told.light.distance - (self->way - self->told.way), 0);
}

void light_camera_init(light_camera *self) {
    memset(self->looks, 0, sizeof self->looks);
    memset(&self->told, 0, sizeof self->told);
    self->way = 0;
    self->steps = 0;
    self->random = (uint64_t)(uint32_t)self->par.seed;
    tick(self);
}

void light_camera_step(light_camera *self) {
    self->way += self->in.motion.speed * LIGHT_CAMERA_STEP;
    self->steps += 1;
    tick(self);
}
