/* Range sensor on the world's rays: range, field of view, latency and seeded noise; sampled. */
#ifndef RANGE_SENSOR_H
#define RANGE_SENSOR_H

#include <stdbool.h>
#include <stdint.h>

#define RANGE_SENSOR_LATENCY 15 /* longest latency, in samples */

typedef struct {
    double gap, closing_speed;
    bool detected;
} range_sensor_target;

typedef struct {
    struct {
        struct {
            double range, azimuth, closing_speed;
            bool hit;
        } scene;
    } in;
    struct {
        range_sensor_target target;
    } out;
    struct {
        double max_range, field_of_view;      /* m; rad, from edge to edge */
        double gap_noise, closing_speed_noise; /* standard deviations */
        int32_t latency;                       /* samples */
        int32_t seed;
    } par;
    range_sensor_target samples[RANGE_SENSOR_LATENCY + 1];
    int32_t newest;
    uint64_t random;
} range_sensor;

void range_sensor_init(range_sensor *self);
void range_sensor_step(range_sensor *self);

#endif
