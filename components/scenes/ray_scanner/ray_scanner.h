/* Where the host's rays meet oriented boxes, and the ground truth of the vehicle in front.
 *
 * The rays start at the middle of the front bumper. Boxes represent actors; the nearest intersection of a ray counts.
 * Doppler: the box's velocity relative to the bumper's, which turns with the host, along the ray. The gap is measured
 * along the middle of the path's own lane, to the nearest actor ahead whose middle is in the host's lane. Actors under or
 * over which the host passes are left out (in_the_way.h).
 */
#ifndef RAY_SCANNER_H
#define RAY_SCANNER_H

#include <stdbool.h>
#include <stdint.h>

#define RAY_SCANNER_ACTORS 8
#define RAY_SCANNER_RAYS 128

typedef struct {
    int32_t id, class;
    double length, width, height, clearance;
    double x, y, z, heading;
    double speed, lateral_speed, acceleration;
    int32_t path, lane;
    double station, offset;
    double ahead, aside, approach, above;
} ray_scanner_actor;

typedef struct {
    struct {
        struct {
            double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
        } motion;
        struct {
            double station, offset, heading, curvature, width, grade, bank, speed_limit;
            bool on_road;
        } lane;
        ray_scanner_actor actors[RAY_SCANNER_ACTORS];
    } in;
    struct {
        struct {
            double range, azimuth, closing_speed;
            bool hit;
        } scene;
        double gap, closing_speed;
        struct {
            double speed;
            int32_t id;
        } lead;
        bool collision;
    } out;
    struct {
        double host_front, host_length, host_width, host_height, ground_clearance;
        double ray_angle, ray_reach;
        int32_t ray_count;
    } par;
    int32_t count;
    double spacing;
    struct {
        double x, y; /* ahead and to the left */
    } rays[RAY_SCANNER_RAYS];
} ray_scanner;

void ray_scanner_init(ray_scanner *self);
void ray_scanner_step(ray_scanner *self, double h);

#endif
