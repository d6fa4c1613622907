/* What a sensor model of others has seen: SensorData of ASAM Open Simulation Interface (OSI) 3.8.0 as a scan of ours.
 *
 * Objects are boxes, told by their middle, in the frame of the sensor, with velocities against it. Told here is what a sensor
 * of ours would tell of such a box: of the sides that face the sensor the one that fills more of the view, by its middle and
 * by what of its width lies across the car; a box without size, or around the sensor, by its own middle. What is stationary
 * is an obstacle. Detections of a radar or lidar are told as they are, in the plane; OSI counts radial velocities as positive
 * towards the sensor.
 * A class is that of the most probable candidate. Deviations are those that the model tells (its rmse), else the parameters;
 * strength is the signal to noise of a radar, 0 where none is told. Seen is what exists at least with *least_existence*. Of
 * more than 16 the nearest are told.
 *
 * A scan is new when the time of measurement is another one (without one that of the message, without both with every
 * message). Its positions are told from *pose.ahead*, looking along the car, wherever the sensor itself sits and looks.
 *
 * Bytes that are no message are not read at all, the last scan stays, and *malformed* counts them. *left_out* counts
 * what was in messages but could not be told: numbers that are none, nothing at a place, more than 16. */
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
        struct {
            int32_t number;
            double age, mount;
            objects_detection returns[OBJECTS_RETURNS];
        } scan;
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
