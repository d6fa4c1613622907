/* The nearest track ahead in the host's lane, for a cruise control.
 *
 * Each track's foot is sought on the middle of the lane as the preview has it (cubics with its directions, straight on
 * beyond its last point): its distance along the lane, and how far it lies aside. In the lane is whose middle lies
 * within *share* of half its width, or will lie there within *horizon*, if it goes on across the lane as it does now; who
 * is followed already may be further aside by *hold* of it. The gap is measured
 * along the middle, from the front bumper. Both speeds are turned into those of the feet, which in a curve are others:
 *   ds/dt = v cos(psi) / (1 - curvature * offset).
 * With nobody in the lane gap and speed stay as they were last seen, as those of a range_sensor. */
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
    int32_t followed; /* its id; 0: nobody */
} lane_target;

void lane_target_init(lane_target *self);
void lane_target_step(lane_target *self);

#endif
