/* A vehicle that changes its offset by a quintic: neither its lateral speed nor its lateral acceleration jumps.
   Nobody slides sideways: where it drives so slowly that it would go aside by more than 0.3 m a metre, it takes longer. */
#ifndef LANE_SHIFT_H
#define LANE_SHIFT_H

#define LANE_SHIFT_PEAK 1.875 /* greatest slope of the quintic from 0 to 1 */

typedef struct {
    double from, to;           /* m to the left */
    double duration, progress; /* s, 0 ... 1 */
} lane_shift;

typedef struct {
    double offset, turn; /* m, rad to the left */
    double speed;        /* along its heading */
} lane_shift_pose;

/* It drives *travelled* along its lane in *h* seconds. */
void lane_shift_advance(lane_shift *shift, double travelled, double h);

/* Where it is and how it stands when it drives at *speed* along its lane. */
lane_shift_pose lane_shift_at(const lane_shift *shift, double speed);

#endif
