/* The nearest track ahead in the host's lane, for a cruise control.
 *
 * The foot of each track is searched on the middle of the lane of the preview (cubics with its directions, straight
 * beyond its last point): its distance along the lane, and its offset. A track is in the lane if its middle is within
 * *share* of half the lane's width, or will be within *horizon* with its present motion across the lane. A track that
 * is already followed may be farther aside by *hold* of it. The gap is measured along the middle, from the front
 * bumper. Both speeds are converted to those of the feet, which differ in a curve:
 *   ds/dt = v cos(psi) / (1 - curvature * offset).
 * Without a track in the lane, gap and speed keep their last values, as those of a range_sensor. */
#ifndef LANE_TARGET_H
#define LANE_TARGET_H

#include "../../lateral/lateral/lateral.h"
#include "../tracker/tracker.h"

typedef struct {
    struct {
        lateral_motion motion;
        lateral_lane lane;
        lateral_preview preview[LATERAL_POINTS];
        tracker_track tracks[TRACKER_TRACKS];
    } in;
    struct {
        struct {
            double gap, closing_speed;
            bool detected;
        } target;
    } out;
    struct {
        double host_front; /* m ahead of the centre of gravity */
        double share, hold;
        double horizon; /* s */
    } par;
    int32_t followed; /* id of the followed track; 0: none */
} lane_target;

void lane_target_init(lane_target *self);
void lane_target_step(lane_target *self);

#endif
