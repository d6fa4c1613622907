/* Converts the output of external sensor models, SensorData of ASAM Open Simulation Interface (OSI) 3.8.0, to a scan.
 *
 * Objects are boxes, given by their middle, in the frame of the sensor, with relative velocities. The detection is the
 * one a sensor of this project would report: of the sides that face the sensor the one that fills more of the view, by
 * its middle and by its width across the car; a box without size, or around the sensor, by its own middle. A stationary
 * object is an obstacle. Detections of a radar or lidar are passed on unchanged, in the plane; OSI counts radial
 * velocities as positive towards the sensor. The class is that of the most probable candidate. Deviations are the rmse
 * of the model, else the parameters; strength is the signal to noise of a radar, else 0. An object is reported if its
 * existence is at least *least_existence*. Of more than 16 the nearest are reported.
 *
 * A scan is new when the time of measurement differs (without one that of the message, without both with every
 * message). Its positions are relative to *pose.ahead*, along the car, for any place and orientation of the sensor.
 *
 * A malformed message is not used at all, the last scan stays, and *malformed* counts it. *left_out* counts the content
 * of messages that could not be reported: invalid numbers, objects without a place, more than 16 objects. */
#ifndef OSI_DETECTIONS_H
#define OSI_DETECTIONS_H

#include "../../sensors/objects/objects.h"
#include "../osi_sensor_view/osi_sensor_view.h"

#define OSI_DATA_ROOM 262144

typedef enum { OSI_OBJECTS, OSI_RADAR, OSI_LIDAR } osi_takes;

typedef struct {
    struct {
        struct {
            size_t size;
            uint8_t data[OSI_DATA_ROOM];
        } data;
        osi_pose pose;
    } in;
    struct {
        objects_scan scan;
        int32_t messages, malformed, left_out;
    } out;
    struct {
        int32_t takes;
        double least_existence, range_deviation, azimuth_deviation, rate_deviation;
    } par;
    int64_t tick, measured; /* measured: in ns, -1 without a time */
} osi_detections;

void osi_detections_init(osi_detections *self);
void osi_detections_step(osi_detections *self);

#endif
