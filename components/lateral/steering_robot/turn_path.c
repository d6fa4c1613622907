#include "turn_path.h"

#include <math.h>

#define DEGREE 0.017453292519943295
#define WIDE 1500.0 /* m: radius at which a clothoid begins */
#define BENT 400.0  /* m: radius before a lane departure */
#define PARTS 8     /* of a section that is integrated */

typedef struct {
    double below;               /* km/h */
    double radius, alpha, beta; /* m, degrees of each clothoid and of the arc */
} turn_data;

static const turn_data FARSIDE[] = {
    {12.5, 9, 20.62, 48.76},
    {17.5, 11.75, 20.93, 48.14},
    {HUGE_VAL, 14.75, 21.79, 46.42},
};
static const turn_data NEARSIDE = {HUGE_VAL, 8, 22.85, 44.3};

static turn_pose straight_on(const turn_pose *from, double way) {
    return (turn_pose){from->x + way * cos(from->heading), from->y + way * sin(from->heading), from->heading, 0};
}

/* Gauss-Legendre with three points in each part: the error of a clothoid of 10 m is below 1e-9 m. */
static turn_pose within(const turn_section *section, double way) {
    static const double place[3] = {0.1127016653792583, 0.5, 0.8872983346207417}, weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    turn_pose pose = section->begin;
    double part = way / PARTS;
    for (int i = 0; i < 3 * PARTS; ++i) {
        double at = (i / 3 + place[i % 3]) * part;
        double heading = section->begin.heading + at * (section->curvature + 0.5 * section->slope * at);
        pose.x += weight[i % 3] * part * cos(heading);
        pose.y += weight[i % 3] * part * sin(heading);
    }
    pose.heading += way * (section->curvature + 0.5 * section->slope * way);
    pose.curvature = section->curvature + section->slope * way;
    return pose;
}

/* From the lengths and curvatures of the sections to their places. */
static turn_path joined(turn_path path) {
    for (int i = 0; i < TURN_PATH_SECTIONS; ++i) {
        path.sections[i].from = path.length;
        path.sections[i].begin = path.end;
        path.end = within(&path.sections[i], path.sections[i].length);
        path.length += path.sections[i].length;
    }
    path.end.curvature = 0;
    return path;
}

turn_path turn_path_of(int32_t turn, double speed, double straight) {
    turn_path path = {.sections[0].length = straight};
    if (turn == TURN_NONE) return joined(path);
    int32_t row = 0;
    while (3.6 * speed > FARSIDE[row].below) ++row;
    turn_data data = turn == TURN_NEARSIDE ? NEARSIDE : FARSIDE[row];
    double sense = turn == TURN_FARSIDE ? 1 : -1, wide = sense / WIDE, tight = sense / data.radius;
    double clothoid = 2 * data.alpha * DEGREE / (1 / WIDE + 1 / data.radius), slope = (tight - wide) / clothoid;
    path.sections[1] = (turn_section){.length = clothoid, .curvature = wide, .slope = slope};
    path.sections[2] = (turn_section){.length = data.beta * DEGREE * data.radius, .curvature = tight};
    path.sections[3] = (turn_section){.length = clothoid, .curvature = tight, .slope = -slope};
    return joined(path);
}

turn_path turn_path_drifting(double lateral, double speed, double straight) {
    turn_path path = {.sections[0].length = straight};
    double turned = asin(lateral / speed);
    path.sections[1] = (turn_section){.length = fabs(turned) * BENT, .curvature = copysign(1 / BENT, lateral)};
    return joined(path);
}

turn_pose turn_path_at(const turn_path *path, double along) {
    if (along >= path->length) return straight_on(&path->end, along - path->length);
    int i = TURN_PATH_SECTIONS - 1;
    while (i > 0 && along < path->sections[i].from) --i;
    return within(&path->sections[i], along - path->sections[i].from);
}
