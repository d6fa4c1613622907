/* A vehicle that changes its offset by a quintic: neither its lateral speed nor its lateral acceleration jumps. At low
   speed the change takes longer, so that the lateral motion is at most 0.3 m per metre. */
#ifndef LANE_SHIFT_H
#define LANE_SHIFT_H

#define LANE_SHIFT_PEAK 1.875 /* greatest slope of the quintic from 0 to 1 */

typedef struct {
    double from, to;           /* m to the left */
    double duration, progress; /* s, 0 ... 1 */
} lane_shift;

typedef struct {
    double share;        /* of the shift that is done */
    double offset, turn; /* m, rad to the left */
    double speed;        /* along its heading */
} lane_shift_pose;

/* It drives *travelled* along its lane in *h* seconds. */
void lane_shift_advance(lane_shift *shift, double travelled, double h);

/* Its pose when it drives at *speed* along its lane. */
lane_shift_pose lane_shift_at(const lane_shift *shift, double speed);

#endif
