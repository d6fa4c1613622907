/* The paths of the host's rear axle in tests. Turns: a straight, a clothoid, an arc, a clothoid, a straight. Radii and
 * angles of Euro NCAP's Crash Avoidance - Frontal Collisions 2026 (farside) and AEB VRU 2023 (nearside), as in Vector's
 * public OpenSCENARIO files. Lane departures: a straight, an arc of 400 m (assumed), a straight. */
#ifndef TURN_PATH_H
#define TURN_PATH_H

#include <stdint.h>

enum { TURN_NONE, TURN_FARSIDE, TURN_NEARSIDE };

#define TURN_PATH_SECTIONS 4

typedef struct {
    double x, y, heading, curvature; /* from the start, ahead and to the left */
} turn_pose;

typedef struct {
    double from, length;     /* m along the path */
    double curvature, slope; /* 1/m where it begins, 1/m2 */
    turn_pose begin;
} turn_section;

/* The turn ends after four sections; the path goes straight on. */
typedef struct {
    turn_section sections[TURN_PATH_SECTIONS];
    turn_pose end;
    double length;
} turn_path;

/* The path of a car that drives at *speed*, the turn of which begins after *straight*. */
turn_path turn_path_of(int32_t turn, double speed, double straight);

/* The path of a car at *speed* that drifts aside with *lateral* m/s, to the left, after *straight* and an arc. */
turn_path turn_path_drifting(double lateral, double speed, double straight);

turn_pose turn_path_at(const turn_path *path, double along);

#endif
