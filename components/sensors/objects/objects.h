/* Object sensor for several objects: its parameters make it a radar, lidar, camera or perfect sensor.
 *
 * Visibility. Objects are upright boxes that hide each other. Between the directions of all their corners one box is
 * nearest, so the visible part of each is exact, except where boxes overlap; a box around the sensor itself is not
 * seen. At most two faces of a box are visible. The reported point is the middle of the visible part of the face that
 * fills more of the view, from its outermost seen point to the other. The reported width is its extent across the
 * sensor's axis, so that of the long side of a lorry on the next lane is nearly zero. The part beyond the field of view
 * is completed, as object sensors do (ISO 23150 has their boxes); else the point would slide along a passed lorry, at
 * half the closing speed. Doppler is the speed of that point relative to the sensor, which turns with the car, along
 * the ray; the object's yaw rate is neglected, as actors do not report it.
 *
 * Mounting. The sensor's axes are those of the car, moved by *mount* and *mount_left* and turned by *mount_turn*. Ranges,
 * azimuths and the field of view are relative to them; the scan reports all three.
 *
 * Strength. An echo falls with R^n exp(2 a R) (n = 4 for radar: radar equation; n = 2 for a target that fills the beam
 * of a lidar), and grows with the object's reflection s and with its visible share:
 *   signal / noise = threshold (s / s_car) share (max_range / R)^n exp(-2 a R),
 * so that a whole car at max_range, in clear air, is just detected. a as in range_sensor.h. A camera (n = 0) sees by
 * contrast, signal / noise = threshold (s exp(-a R) / ((1 + veil) contrast))^2 up to max_range, or night_range in the
 * dark; s is the contrast of the object's class to what is behind it, 0: 1; the veil is that of the sun (sensing.h). The
 * smaller of the object's height and visible width must be at least *least_pixels* in the image of *focal_length*.
 *
 * Height. A road user on another level (in_the_way.h) is hidden. An object reaches from its clearance to its height above the road. What is entirely above the sensor, or not
 * higher than 0.1 m, hides nothing and is seen through others. A radar's lobe is Gaussian with *elevation_beam* between
 * its half-power directions, level, so that a bridge fades as the car approaches. A sensor that measures height, with
 * *elevation_noise*, does not report what is above least_clearance or below least_height.
 *
 * Resolution. Two objects that differ by less than a cell in range, azimuth and Doppler, in all three of them, are one
 * detection: the strongest absorbs the weaker ones, each with its power as weight. A lidar scans only the directions of
 * its grid, and in layers, over a flat road.
 *
 * False detections. Two paths of a wave that is reflected more than once (Kraus, Scheiner, Ritter, Dietmayer: The Radar
 * Ghost Dataset, IROS 2021, have both in measurements), each seen in *ghost_share* of the scans:
 * - a guard rail *rail* m left of the lane's middle, along the lane's tangent beside the car, mirrors: a seen object is
 *   seen again at its image, at the image's range, azimuth and Doppler, its echo weaker by *rail_reflection* for each
 *   of the two reflections on the rail (radar equation at the image's range);
 * - a wave travels between object and own car twice: twice the range and Doppler in the same direction, weaker by
 *   s own_reflection exp(-2 a R) / (4 pi R^2)^2, s and own_reflection in m2 (bistatic radar equation, Skolnik).
 *
 * Spray. In rain a truck makes a cloud behind it, which disturbs lidars and cameras (A benchmark for spray from nearby
 * cutting vehicles, arXiv:2108.10800, 2021), and no radar. The model is assumed: it grows with the square of the truck's speed
 * up to 100 km/h. The truck is seen through its optical depth *spray_depth*. If there is no patch of spray, one is seen from a
 * scan on with the chance *spray_share*, as an object without a class, which is left behind by the truck at *spray_drift* of
 * its speed and is seen for *spray_length*. Spray of cars is left out.
 *
 * Accuracy. An error has three parts. Range and azimuth of all objects have a constant one, drawn at the start of a run
 * (*scale_bias* per range, *azimuth_bias*), and a slow one, a Gauss-Markov process with *correlation_time* (*scale_drift*,
 * *azimuth_drift*): calibration, pitch of the car, assumed flatness of the road (Stein, Mano, Shashua: Vision-based ACC
 * with a single camera, IEEE Intelligent Vehicles, 2003). They draw from a distant part of the stream of numbers, so that
 * the noise of each scan is the same with and without them. White noise: standard deviations of range: range_noise and relative_noise R, and that of a stereo camera of *baseline*,
 * disparity_noise R^2 / (focal_length baseline), from R = f b / d (Szeliski, Computer Vision, 2nd ed. 2022, 12.1),
 * f and d in pixels. A share *dropout* of an object's detections is lost, in bursts of *dropout_time* on average: a
 * Markov chain of two states for each object (Gilbert: Capacity of a burst-noise channel, BSTJ 39:1253, 1960). Each scan
 * is independent if *dropout_time* is not longer than the bursts of independent scans, period / (1 - dropout).
 *
 * Timing. It scans every *period*, first at time 0, and reports *latency* later, with the values of the scan. The
 * reported deviations of a detection are those of the white noise, at the measured range; without Doppler noise 1 mm/s,
 * as 0: no Doppler. Those of the scan are those of the constant and the slow part together, with the correlation time of
 * a single process that has their variance and the slow part's growth, deviation^2 / drift^2 correlation_time.
 */
#ifndef OBJECTS_H
#define OBJECTS_H

#include <stdbool.h>
#include <stdint.h>

#define OBJECTS_ACTORS 8
#define OBJECTS_RETURNS 16
#define OBJECTS_CLASSES 7  /* none, car, truck, motorcycle, bicycle, pedestrian, obstacle */
#define OBJECTS_KEPT 16    /* scans that are pending at most */
#define OBJECTS_STEP 0.01  /* s; the step in the component.yaml of every such sensor */

typedef struct {
    int32_t id, class;
    double length, width, height, clearance;
    double x, y, z, heading;
    double speed, lateral_speed, acceleration;
    int32_t path, lane;
    double station, offset;
    double ahead, aside, approach, above;
} objects_actor;

typedef struct {
    bool valid;
    double range, azimuth, range_rate, strength;
    int32_t class;
    double width, range_deviation, azimuth_deviation, rate_deviation;
} objects_detection;

typedef struct {
    objects_detection returns[OBJECTS_RETURNS];
} objects_sample;

typedef struct {
    double deviation, time; /* per range or rad; s, 0: constant */
} objects_lasting;

typedef struct {
    int32_t number;
    double age, mount, mount_left, mount_turn;
    objects_lasting scale, misalignment;
    objects_detection returns[OBJECTS_RETURNS];
} objects_scan;

typedef struct {
    struct {
        struct {
            double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
        } motion;
        objects_actor actors[OBJECTS_ACTORS];
        struct {
            double station, offset, heading, curvature, width, grade, bank, speed_limit;
            bool on_road;
        } lane;
        struct {
            double rain_rate, snow_rate, fog_extinction, darkness;
        } visibility;
        struct {
            double azimuth, elevation, glare;
        } sun;
    } in;
    struct {
        objects_scan scan;
    } out;
    struct {
        double mount, mount_left, mount_height, mount_turn; /* m ahead and left of the centre of gravity, above the road; rad to the left */
        double max_range, field_of_view; /* m; rad, from edge to edge */
        double echo_exponent;            /* n; 0: sees by contrast */
        double threshold;                /* the least signal to noise */
        double car, truck, motorcycle, bicycle, pedestrian, obstacle; /* s, in any unit; of a camera: contrast */
        double min_visible;              /* the share of an object's angle that must be seen; 0: nothing is hidden */
        bool doppler, tells_class, tells_width;
        double range_cell, azimuth_cell, doppler_cell; /* 0: resolves all objects */
        double beam_spacing, layer_spacing;            /* rad; 0: all directions */
        int32_t layers;
        double elevation_beam, elevation_noise;                       /* rad; 0: no lobe, exact */
        double least_clearance, least_height;                         /* m; 0: reported at any height */
        double range_noise, relative_noise, azimuth_noise, doppler_noise; /* standard deviations; relative: per range */
        double baseline, focal_length, disparity_noise;                   /* m, pixels, pixels; baseline 0: no stereo */
        double scale_bias, scale_drift, azimuth_bias, azimuth_drift;      /* standard deviations; scale: per range */
        double correlation_time;                                          /* s, of both drifts */
        double dropout, dropout_time; /* share of detections that are lost; s, mean of a burst, 0: each by itself */
        double least_pixels;          /* 0: any size is seen */
        double spray_share, spray_drift, spray_length, spray_depth;       /* of scans; of the speed; m; at 100 km/h */
        double rail, rail_reflection, own_reflection, ghost_share;        /* m, 0: no rail; share of power; m2 */
        double period, latency; /* s, in whole steps: between two scans; from a scan to its report */
        int32_t seed;
        double rain_loss, rain_exponent, snow_loss, snow_exponent; /* dB/km at 1 mm/h */
        double fog_share, contrast, night_range;                   /* as in range_sensor */
    } par;
    objects_sample made[OBJECTS_KEPT]; /* scan n at n % OBJECTS_KEPT */
    int32_t tick, told;                /* of this step; the number of the scan in out */
    uint64_t random, slow;             /* states of the noise of scans, and of bias and drift */
    struct {
        double scale, azimuth;
    } bias, drift;
    bool is_lost[OBJECTS_ACTORS];
    double patch[OBJECTS_ACTORS]; /* m behind the truck; negative: none */
} objects;

void objects_init(objects *self);
void objects_step(objects *self);

#endif
