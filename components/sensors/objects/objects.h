/* Sees several objects at once: radar, lidar, camera and the perfect sensor by their parameters.
 *
 * What is seen. Objects are upright boxes that hide each other. Between the directions of all their corners one box is
 * nearest, so what is seen of each is found exactly, but where boxes overlap; a box around the sensor itself is not seen.
 * Of a box two faces show at most; told is the middle of what is seen of the one that fills more of the view, from its
 * outermost seen point to the other. Doppler is the speed of that point against the sensor, which turns with the car,
 * along the ray; that the object turns is left out, as actors do not tell it.
 *
 * How strong it is. An echo falls with R^n exp(2 a R) (n = 4 for radar: radar equation; n = 2 for a target that fills the
 * beam of a lidar), grows with the object's reflection s and with the share of it that is seen:
 *   signal / noise = threshold (s / s_car) share (max_range / R)^n exp(-2 a R),
 * so that max_range is where a whole car, in clear air, is just detected. a as in range_sensor.h. A camera (n = 0) sees by
 * contrast, signal / noise = threshold (exp(-a R) / contrast)^2 up to max_range, or night_range in the dark.
 *
 * What it tells apart. Two objects nearer to each other than a cell in range, azimuth and Doppler, in all three of them, are
 * one detection: the strongest takes in the weaker ones, each with its power as weight. A lidar looks in directions of
 * its grid only, and in layers, over a flat road.
 */
#ifndef OBJECTS_H
#define OBJECTS_H

#include <stdbool.h>
#include <stdint.h>

#define OBJECTS_ACTORS 8
#define OBJECTS_DETECTIONS 16
#define OBJECTS_CLASSES 7  /* none, car, truck, motorcycle, bicycle, pedestrian, obstacle */
#define OBJECTS_LATENCY 15 /* longest latency, in samples */

typedef struct {
    int32_t id, class;
    double length, width, height;
    double x, y, z, heading;
    double speed, lateral_speed, acceleration;
    int32_t path, lane;
    double station, offset;
    double ahead, aside, approach;
} objects_actor;

typedef struct {
    bool valid;
    double range, azimuth, range_rate, strength;
    int32_t class;
    double width;
} objects_detection;

typedef struct {
    objects_detection detections[OBJECTS_DETECTIONS];
} objects_sample;

typedef struct {
    struct {
        struct {
            double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
        } motion;
        objects_actor actors[OBJECTS_ACTORS];
        struct {
            double rain_rate, snow_rate, fog_extinction, darkness;
        } visibility;
    } in;
    objects_sample out;
    struct {
        double mount, mount_height;      /* m ahead of the centre of gravity; m above the road */
        double max_range, field_of_view; /* m; rad, from edge to edge */
        double echo_exponent;            /* n; 0: sees by contrast */
        double threshold;                /* the least signal to noise */
        double car, truck, motorcycle, bicycle, pedestrian, obstacle; /* s, in any unit */
        double min_visible;              /* the share of an object's angle that must be seen; 0: sees through others */
        bool doppler, tells_class, tells_width;
        double range_cell, azimuth_cell, doppler_cell; /* 0: tells all apart */
        double beam_spacing, layer_spacing;            /* rad; 0: looks everywhere */
        int32_t layers;
        double range_noise, relative_noise, azimuth_noise, doppler_noise; /* standard deviations; relative: per range */
        double dropout;                                                   /* share of detections that are lost */
        int32_t latency;                                                  /* samples */
        int32_t seed;
        double rain_loss, rain_exponent, snow_loss, snow_exponent; /* dB/km at 1 mm/h */
        double fog_share, contrast, night_range;                   /* as range_sensor has them */
    } par;
    objects_sample samples[OBJECTS_LATENCY + 1];
    int32_t newest;
    uint64_t random;
} objects;

void objects_init(objects *self);
void objects_step(objects *self);

#endif
