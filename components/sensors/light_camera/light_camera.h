/* Reads the next traffic light ahead of the host, as far as its lamp is large enough and has contrast enough:
 *   exp(-a R) / (1 + veil) >= contrast,
 * a of fog (all of its extinction), rain and snow (sensing.h), the veil that of the sun. By night a lamp is seen as by day. It
 * looks every *period*, first at time 0, and tells *latency* later what it saw then, with the way driven since taken off the
 * distance. How long the colour stays it cannot tell. A look that misses the light tells none. */
#ifndef LIGHT_CAMERA_H
#define LIGHT_CAMERA_H

#include <stdbool.h>
#include <stdint.h>

#define LIGHT_CAMERA_STEP 0.01 /* s; the step in the component.yaml */
#define LIGHT_CAMERA_KEPT 16   /* looks that are under way at most: latency up to 15 steps */

typedef struct {
    double distance;
    int32_t colour;
    double remaining;
} light_camera_light;

typedef struct {
    light_camera_light light;
    double way; /* driven when it was made */
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
    light_camera_look looks[LIGHT_CAMERA_KEPT], told; /* by the step they are told in */
    double way;                                       /* m, driven */
    int64_t steps;
    uint64_t random;
} light_camera;

void light_camera_init(light_camera *self);
void light_camera_step(light_camera *self);

#endif
