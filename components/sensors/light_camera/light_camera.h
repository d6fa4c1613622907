/* Reads the next traffic light ahead of the host, if its lamp is large enough and has enough contrast:
 *   exp(-a R) / (1 + veil) >= contrast,
 * a of fog (all of its extinction), rain and snow (sensing.h), the veil that of the sun. At night a lamp is seen as by
 * day. It scans every *period*, first at time 0, and reports *latency* later the values of the scan, less the distance
 * driven since. It does not report the remaining time of the colour. A scan that misses the light reports none. */
#ifndef LIGHT_CAMERA_H
#define LIGHT_CAMERA_H

#include <stdbool.h>
#include <stdint.h>

#define LIGHT_CAMERA_STEP 0.01 /* s; the step in the component.yaml */
#define LIGHT_CAMERA_KEPT 16   /* scans that are pending at most: latency up to 15 steps */

typedef struct {
    double distance;
    int32_t colour;
    double remaining;
} light_camera_light;

typedef struct {
    light_camera_light light;
    double way; /* distance driven when it was made */
    bool is_due;
} light_camera_look;

typedef struct {
    struct {
        struct {
            double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
        } motion;
        light_camera_light light;
        struct {
            double rain_rate, snow_rate, fog_extinction, darkness;
        } visibility;
        struct {
            double azimuth, elevation, glare;
        } sun;
    } in;
    struct {
        light_camera_light seen;
    } out;
    struct {
        double max_range, contrast, rain_loss, rain_exponent, snow_loss, snow_exponent;
        double period, latency, dropout, distance_error;
        int32_t seed;
    } par;
    light_camera_look looks[LIGHT_CAMERA_KEPT], told; /* by the step in which they are reported */
    double way;                                       /* m, driven */
    int64_t steps;
    uint64_t random;
} light_camera;

void light_camera_init(light_camera *self);
void light_camera_step(light_camera *self);

#endif
