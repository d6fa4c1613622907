#include "tracker.h"

#include <math.h>

#define KEPT TRACKER_REMEMBERED

tracker_move tracker_moved(const tracker_motion *from, const tracker_motion *to, double T) {
    double speed = 0.5 * (to->speed + from->speed), aside = 0.5 * (to->lateral_speed + from->lateral_speed);
    double angle = 0.5 * (to->yaw_rate + from->yaw_rate) * T, half = 0.5 * angle;
    /* The chord of an arc: sin(a/2) / (a/2) of its length, turned by a/2. */
    double shrink = fabs(half) > 1e-6 ? sin(half) / half : 1, c = shrink * cos(half), s = shrink * sin(half);
    tracker_move move = {(speed * c - aside * s) * T, (speed * s + aside * c) * T, angle};
    return move;
}

tracker_move tracker_remember(tracker_history *history, const tracker_motion *now) {
    tracker_move move = {0, 0, 0};
    int32_t last = history->newest, at = history->count > 0 ? (last + 1) % KEPT : 0;
    if (history->count > 0) {
        move = tracker_moved(&history->motion[last], now, TRACKER_STEP);
        double c = cos(history->heading[last]), s = sin(history->heading[last]);
        history->x[at] = history->x[last] + c * move.x - s * move.y;
        history->y[at] = history->y[last] + s * move.x + c * move.y;
        history->heading[at] = history->heading[last] + move.angle;
    } else {
        history->x[at] = history->y[at] = history->heading[at] = 0;
    }
    history->motion[at] = *now;
    history->newest = at;
    if (history->count < KEPT) ++history->count;
    return move;
}

static tracker_motion between(const tracker_motion *from, const tracker_motion *to, double share) {
    tracker_motion motion = *from;
    motion.speed += share * (to->speed - from->speed);
    motion.lateral_speed += share * (to->lateral_speed - from->lateral_speed);
    motion.yaw_rate += share * (to->yaw_rate - from->yaw_rate);
    return motion;
}

/* *second* after *first*. */
static tracker_move joined(tracker_move first, tracker_move second) {
    double c = cos(first.angle), s = sin(first.angle);
    tracker_move both = {first.x + c * second.x - s * second.y, first.y + s * second.x + c * second.y,
                         first.angle + second.angle};
    return both;
}

tracker_past tracker_ago(const tracker_history *history, double age) {
    double steps = fmax(age, 0) / TRACKER_STEP;
    double whole = floor(steps + 1e-9), part = fmax(steps - whole, 0); /* ages are rounded multiples of a step */
    int32_t most = history->count - 1, back = whole < most ? (int32_t)whole : most;
    int32_t at = (history->newest - back + KEPT) % KEPT, now = history->newest;
    double c = cos(history->heading[at]), s = sin(history->heading[at]);
    double x = history->x[now] - history->x[at], y = history->y[now] - history->y[at];
    tracker_move since = {c * x + s * y, c * y - s * x, history->heading[now] - history->heading[at]};
    tracker_past past = {since, history->motion[at]};
    double more = (whole - back + part) * TRACKER_STEP;
    if (!(more > 1e-9 * TRACKER_STEP)) return past;
    if (back < most) { /* between two steps */
        past.motion = between(&history->motion[at], &history->motion[(at - 1 + KEPT) % KEPT], part);
    }
    past.since = joined(tracker_moved(&past.motion, &history->motion[at], more), since);
    return past;
}

tracker_place tracker_place_of(const tracker_detection *seen, const tracker_scan *scan, const tracker_past *then) {
    const tracker_motion *motion = &then->motion;
    double c = cos(seen->azimuth + scan->mount_turn), s = sin(seen->azimuth + scan->mount_turn);
    double own = (motion->speed - motion->yaw_rate * scan->mount_left) * c +
                 (motion->lateral_speed + motion->yaw_rate * scan->mount) * s;
    double x = scan->mount + seen->range * c - then->since.x, y = scan->mount_left + seen->range * s - then->since.y;
    double back = cos(then->since.angle), turn = sin(then->since.angle);
    tracker_place place = {back * x + turn * y, back * y - turn * x, back * c + turn * s, back * s - turn * c,
                           seen->range_rate + own};
    return place;
}
