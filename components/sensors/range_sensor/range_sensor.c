#include "range_sensor.h"

#include "../sensing/sensing.h"

#include <math.h>

#define LENGTH (RANGE_SENSOR_LATENCY + 1)

/* The range in this weather; in clear air exactly that of the parameters. */
static double reach(const range_sensor *self) {
    double range = self->par.max_range;
    double lost = self->par.fog_share * self->in.visibility.fog_extinction +
                  sensing_attenuation(self->in.visibility.rain_rate, self->par.rain_loss, self->par.rain_exponent) +
                  sensing_attenuation(self->in.visibility.snow_rate, self->par.snow_loss, self->par.snow_exponent);
    if (self->in.visibility.darkness > 0 && self->par.night_range > 0 && self->par.night_range < range) {
        range += fmin(self->in.visibility.darkness, 1) * (self->par.night_range - range);
    }
    if (!(lost > 0)) return range;
    if (!(self->par.echo_exponent > 0)) return self->par.contrast > 0 ? fmin(range, -log(self->par.contrast) / lost) : range;
    /* Newton's method on ln x + b x = 0 for x = R / range; it converges from below, and ends when x stays the same. */
    double b = 2 * lost * range / self->par.echo_exponent, x = 1 / (1 + b);
    for (int32_t i = 0; i < 30; ++i) {
        double more = -(log(x) + b * x) * x / (1 + b * x);
        x += more;
        if (!(fabs(more) > 1e-15 * x)) break;
    }
    return x * range;
}

/* The target ahead. Without a detection, gap and speed keep their last values. */
static range_sensor_target measured(range_sensor *self, range_sensor_target last) {
    double azimuth = self->in.scene.azimuth;
    range_sensor_target now = last;
    /* Two numbers are drawn per sample, seen or not: noise does not depend on earlier detections. */
    double radius = 0, angle = 0;
    if (self->par.gap_noise > 0 || self->par.closing_speed_noise > 0) {
        radius = sqrt(-2 * log(sensing_uniform(&self->random)));
        angle = 6.283185307179586 * sensing_uniform(&self->random);
    }
    now.detected = self->in.scene.hit && self->in.scene.range <= reach(self) &&
                   2 * fabs(azimuth) <= self->par.field_of_view;
    if (now.detected) {
        /* Doppler and range are along the ray; the controller needs them along the road. */
        double along = cos(azimuth);
        now.gap = self->in.scene.range * along + self->par.gap_noise * radius * cos(angle);
        now.closing_speed = self->in.scene.closing_speed / along + self->par.closing_speed_noise * radius * sin(angle);
    }
    return now;
}

void range_sensor_init(range_sensor *self) {
    self->random = (uint64_t)self->par.seed;
    self->newest = 0;
    range_sensor_target nothing = {0, 0, false};
    range_sensor_target first = measured(self, nothing);
    for (int32_t i = 0; i < LENGTH; ++i) self->samples[i] = first;
    self->out.target = first;
}

void range_sensor_step(range_sensor *self) {
    range_sensor_target last = self->samples[self->newest];
    self->newest = (self->newest + 1) % LENGTH;
    self->samples[self->newest] = measured(self, last);
    int32_t latency = self->par.latency;
    if (latency < 0) latency = 0;
    if (latency > RANGE_SENSOR_LATENCY) latency = RANGE_SENSOR_LATENCY;
    self->out.target = self->samples[(self->newest - latency + LENGTH) % LENGTH];
}
