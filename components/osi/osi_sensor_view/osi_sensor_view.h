/* Input of external sensor models: SensorView and GroundTruth of ASAM Open Simulation Interface (OSI) 3.8.0.
 *
 * OSI uses the middle of boxes; this world uses the host's centre of gravity and the ground below the middle of others.
 * The host's own box extends *host_length* back from *host_front*. *front_axle* and *rear_axle* give its axles, and so
 * the origin of OSI's vehicle coordinates. If the ground below the wheels is given, the host is on it, with its slope,
 * and others have their heights; else the world is flat, as for the sensors here. Unknown data is left out: axles and
 * lights of others (their attributes exist, as OSI demands, but are empty), their yaw rates, lanes. A vehicle is
 * TYPE_CAR (formerly TYPE_MEDIUM_CAR), TYPE_HEAVY_TRUCK, TYPE_MOTORCYCLE or TYPE_BICYCLE; an obstacle is a
 * StationaryObject, TYPE_OTHER of any material.
 *
 * Rain and snow are OSI's steps of precipitation in mm/h of water, fog its steps of visibility (5 % of the light
 * remain, as in set_weather.h). Light is assumed to fall from 100,000 lx in daylight to 0.001 lx at night, by equal
 * powers of ten for each tenth of *darkness*.
 *
 * The host's identifier is 0; other road users have other identifiers. Time is in nanoseconds, from 0. */
#ifndef OSI_SENSOR_VIEW_H
#define OSI_SENSOR_VIEW_H

#include "../../sensors/objects/objects.h"

#include <stddef.h>

#define OSI_STEP 0.01 /* s; the step in the component.yaml */
#define OSI_STEP_NANOS 10000000
#define OSI_ROOM 8192

typedef struct {
    size_t size;
    uint8_t data[OSI_ROOM];
} osi_message;

typedef struct {
    double ahead, left, turn; /* m from the centre of gravity; rad to the left */
} osi_pose;

typedef struct {
    struct {
        struct {
            double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
        } motion;
        objects_actor actors[OBJECTS_ACTORS];
        struct {
            double rain_rate, snow_rate, fog_extinction, darkness;
        } visibility;
        struct {
            double height, slope_x, slope_y, friction; /* friction 0: not given */
        } ground[4];
        struct {
            double friction_loss, water_film, temperature;
        } surface;
    } in;
    struct {
        osi_message view, truth;
        osi_pose pose;
    } out;
    struct {
        double mount, mount_left, mount_height, mount_turn;
        double host_length, host_width, host_height, host_front;
        double front_axle, rear_axle, wheel_radius;
        double time_of_day; /* s since midnight, at the beginning */
        int32_t sensor_id;
    } par;
    int64_t tick;
} osi_sensor_view;

void osi_sensor_view_init(osi_sensor_view *self);
void osi_sensor_view_step(osi_sensor_view *self);

#endif
