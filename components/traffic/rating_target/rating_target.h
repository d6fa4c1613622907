/* The target of a rating: it meets the host at a given place of the host and of itself if the host does not brake. The
 * places where both start, and the time at which a pedestrian sets out, follow from the speeds and the contact.
 *
 * Contact. Its place on the host is impact_location of the width of the front (0 the right corner, 1 the left one), or
 * impact_depth of the length of the side from which the target comes. On the target it is the middle of the face
 * towards the host; of a target that crosses in front of the host, the place of its flank beside its reference point
 * (the hip of a pedestrian, the crank of a bicycle, a quarter of the length of a car behind its front). At the start,
 * the host's front is approach_time away from the contact, or turn_after away from its turn or drift.
 *
 * A host that turns meets the target on a line along the road that it leaves. A vehicle touches the middle of the
 * host's front with the corner of its own front that is nearer to the host; the reference point of a pedestrian or a
 * bicyclist is at impact_location when that part of the front reaches its side. A host that drifts to the left meets a
 * target on the middle of that lane, of which it overlaps *overlap* of its own width: the front of an oncoming one, the
 * side of one that overtakes.
 *
 * A host at rest starts as the drive robot does: pull_away_after seconds after the start of the run it accelerates with
 * pull_away to pull_away_speed, forwards or, if it reverses, backwards. Its front, or its rear, is then pull_away_distance
 * from the contact; if it turns, the turn begins at once. With passing_gap, the target overtakes the host at rest on its
 * left: its front is beside the rear edge of the front door approach_time after the start.
 *
 * Timing. As the robots of test tracks do, the target follows the host: its clock is the time from the start to the
 * contact, less the time that the host still needs to the contact at its first speed. From the moment the host brakes
 * (1 m/s2) or is 2 km/h slower than at the start, the clock is that of the run, and the target ignores the host,
 * as it does one that is at rest at the start.
 *
 * Motion. At constant speed; or at rest, then acceleration_distance at constant acceleration, then steady_distance at
 * speed to the contact. With a headway, the target begins that far ahead of the host's front and brakes at brake_time. */
#ifndef RATING_TARGET_H
#define RATING_TARGET_H

#include "../../lateral/steering_robot/turn_path.h"
#include "../profile/lane_shift.h"
#include "../profile/speed_profile.h"
#include "../profile/traffic.h"

#define RATING_TARGET_PARKED 3

typedef struct {
    traffic_in in;
    traffic_out out;
    struct {
        int32_t kind, approach, contact;
        double speed, impact_location, impact_depth, approach_time;
        double acceleration_distance, steady_distance;
        double headway, brake_time, deceleration, final_speed;
        double lane_change_time, lane_change_end, lane_width;
        int32_t turn;
        double turn_after, path_offset, drift, overlap;
        double pull_away, pull_away_after, pull_away_speed, pull_away_distance;
        bool reverses;
        double passing_gap, door_edge;
        int32_t parked;
        double parked_ahead[RATING_TARGET_PARKED], parked_offset[RATING_TARGET_PARKED], parked_turn[RATING_TARGET_PARKED];
        double parked_length[RATING_TARGET_PARKED], parked_width[RATING_TARGET_PARKED], parked_height[RATING_TARGET_PARKED];
        double unobstructed_speed;
        double host_front, host_rear_axle, host_length, host_width;
    } par;
    double host_speed;      /* m/s, at the start */
    double meeting;         /* s, from the start to the contact */
    double station;         /* m, of the host's front at the contact; with a headway at the start */
    double x, y;            /* m, of the target's centre at that moment: from the station, to the left */
    double turn;            /* rad, of its direction */
    double clock;           /* s */
    bool is_free;           /* it no longer follows the host */
} rating_target;

void rating_target_init(rating_target *self);
void rating_target_step(rating_target *self, double h);

#endif
