/* Conditions of triggers, on the state that the last step left. */
#include "storyboard.h"

#include <math.h>
#include <stddef.h>

#define STILL 1e-3     /* m/s */
#define SAME 1e-6      /* of two equal numbers */
#define NEVER NAN      /* a time to something that does not happen fits nothing */

static bool fits(int32_t rule, double a, double b) {
    switch (rule) {
    case GREATER: return a > b + 1e-9;
    case LESS: return a < b - 1e-9;
    case EQUAL: return fabs(a - b) <= SAME;
    case GREATER_OR_EQUAL: return a >= b - 1e-9;
    case LESS_OR_EQUAL: return a <= b + 1e-9;
    default: return fabs(a - b) > SAME;
    }
}

/* How far (x, y), or the *other* one if it is not SB_NONE, is ahead of an actor: along its path, else along its heading; and how far to its left. */
double gap_ahead(const storyboard *board, int32_t number, int32_t other, double x, double y, sb_gap *gap, double *aside) {
    const sb_actor *actor = &board->actors[number];
    if (actor->at.path == SB_NONE) {
        double c = cos(actor->at.heading), s = sin(actor->at.heading), dx = x - actor->at.x, dy = y - actor->at.y;
        if (aside) *aside = dy * c - dx * s;
        return dx * c + dy * s;
    }
    if (other != SB_NONE && board->actors[other].at.path == actor->at.path) {
        const sb_place *there = &board->actors[other].at;
        if (aside) {
            double left = there->offset - actor->at.offset;
            *aside = actor->at.sense * (there->lane == actor->at.lane ? left : there->t - actor->at.t);
        }
        return actor->at.sense * (there->s - actor->at.s);
    }
    const path_table *path = &road_tables.paths[actor->at.path];
    path_foot foot;
    bool is_near = !isnan(gap->hint) && foot_from(path, x, y, gap->hint, gap->piece, &foot);
    if (!is_near) foot = foot_of_all(path, x, y);
    gap->hint = path_station(foot.line.place);
    gap->piece = foot.line.place.piece;
    if (aside) *aside = actor->at.sense * (foot.t - actor->at.t);
    return actor->at.sense * (gap->hint - actor->at.s);
}

/* Between two intervals of half widths a and b around centres *off* apart; 0 if they overlap. */
static double between(double off, double a, double b) {
    double gap = fabs(off) - a - b;
    return gap > 0 ? copysign(gap, off) : 0;
}

static void corners(const storyboard *board, int32_t number, double x[4], double y[4]) {
    const sb_entity *entity = &scenario_tables.entities[number];
    const sb_place *at = &board->actors[number].at;
    double c = cos(at->heading), s = sin(at->heading);
    for (int32_t i = 0; i < 4; ++i) {
        double dx = entity->centre_x + (i < 2 ? 0.5 : -0.5) * entity->length;
        double dy = entity->centre_y + (i == 1 || i == 2 ? 0.5 : -0.5) * entity->width;
        x[i] = at->x + dx * c - dy * s;
        y[i] = at->y + dx * s + dy * c;
    }
}

/* Largest gap between the boxes along the normals of both; <= 0 if they touch. */
static double apart(const storyboard *board, int32_t a, int32_t b) {
    double ax[4], ay[4], bx[4], by[4], most = -HUGE_VAL;
    corners(board, a, ax, ay);
    corners(board, b, bx, by);
    for (int32_t k = 0; k < 4; ++k) {
        double heading = board->actors[k < 2 ? a : b].at.heading + (k % 2 ? 0.5 * 3.14159265358979323846 : 0);
        double c = cos(heading), s = sin(heading), low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
        for (int32_t i = 0; i < 4; ++i) {
            double one = ax[i] * c + ay[i] * s, other = bx[i] * c + by[i] * s;
            low[0] = fmin(low[0], one);
            high[0] = fmax(high[0], one);
            low[1] = fmin(low[1], other);
            high[1] = fmax(high[1], other);
        }
        most = fmax(most, fmax(low[1] - high[0], low[0] - high[1]));
    }
    return most;
}

static double segment_distance(double px, double py, double ax, double ay, double bx, double by) {
    double dx = bx - ax, dy = by - ay, square = dx * dx + dy * dy;
    double part = square > 0 ? fmin(fmax(((px - ax) * dx + (py - ay) * dy) / square, 0), 1) : 0;
    return hypot(ax + part * dx - px, ay + part * dy - py);
}

static double box_distance(const storyboard *board, int32_t a, int32_t b) {
    if (apart(board, a, b) <= 0) return 0;
    double x[2][4], y[2][4], least = HUGE_VAL;
    corners(board, a, x[0], y[0]);
    corners(board, b, x[1], y[1]);
    for (int32_t k = 0; k < 2; ++k) {
        for (int32_t i = 0; i < 16; ++i) {
            int32_t m = i % 4, n = i / 4;
            least = fmin(least, segment_distance(x[k][m], y[k][m], x[1 - k][n], y[1 - k][n], x[1 - k][(n + 1) % 4],
                                                 y[1 - k][(n + 1) % 4]));
        }
    }
    return least;
}

/* Signed: > 0 ahead or to the left. */
static double distance_to(const storyboard *board, const sb_condition *condition, int32_t actor, double x, double y, int32_t other,
                          int32_t distance, sb_gap *gap) {
    const sb_place *at = &board->actors[actor].at;
    double c = board->actors[actor].cosine, s = board->actors[actor].sine, aside = 0;
    if (distance == EUCLIDIAN) {
        double away = condition->is_freespace && other != SB_NONE ? box_distance(board, actor, other) : hypot(x - at->x, y - at->y);
        return copysign(away, (x - at->x) * c + (y - at->y) * s);
    }
    double ahead = condition->system == OF_ROAD
                       ? gap_ahead(board, actor, other, x, y, gap, distance == LONGITUDINALLY && !condition->is_freespace ? NULL : &aside)
                       : (aside = (y - at->y) * c - (x - at->x) * s, (x - at->x) * c + (y - at->y) * s);
    if (!condition->is_freespace) return distance == LONGITUDINALLY ? ahead : aside;
    const sb_entity *own = &scenario_tables.entities[actor];
    if (other == SB_NONE) {
        return distance == LONGITUDINALLY ? between(ahead - own->centre_x, 0.5 * own->length, 0)
                                          : between(aside - own->centre_y, 0.5 * own->width, 0);
    }
    const sb_entity *its = &scenario_tables.entities[other];
    double oc = board->actors[other].cosine, os = board->actors[other].sine, ct = oc * c + os * s, st = os * c - oc * s;
    ahead += ct * its->centre_x - st * its->centre_y;
    aside += st * its->centre_x + ct * its->centre_y;
    double half_length = 0.5 * (fabs(ct) * its->length + fabs(st) * its->width);
    double half_width = 0.5 * (fabs(st) * its->length + fabs(ct) * its->width);
    return distance == LONGITUDINALLY ? between(ahead - own->centre_x, 0.5 * own->length, half_length)
                                      : between(aside - own->centre_y, 0.5 * own->width, half_width);
}

static double along_heading(const sb_actor *actor, int32_t direction) {
    if (direction == LATERALLY) return actor->drift * actor->at.sense;
    if (direction == LONGITUDINALLY) return copysign(sqrt(fmax(actor->speed * actor->speed - actor->drift * actor->drift, 0)), actor->speed);
    return actor->speed;
}

/* To the entity or the position of a condition; measured once in an epoch. */
static double gap_of(storyboard *board, const sb_condition *condition, int32_t actor, int32_t number) {
    sb_gap *gap = &board->gaps[number];
    if (gap->epoch != board->epoch) {
        bool is_entity = condition->entity != SB_NONE;
        sb_place there = is_entity ? board->actors[condition->entity].at : place_of(board, condition->position, SB_NONE);
        gap->epoch = board->epoch;
        gap->value = distance_to(board, condition, actor, there.x, there.y, condition->entity, condition->distance, gap);
    }
    return gap->value;
}

static double time_to_collision(storyboard *board, int32_t actor, int32_t other, double gap) {
    double own = board->actors[actor].speed, its = 0;
    if (other != SB_NONE) {
        double turn = board->actors[other].at.heading - board->actors[actor].at.heading;
        its = board->actors[other].speed * cos(turn);
    }
    double closing = gap >= 0 ? own - its : its - own;
    return closing > 1e-6 ? fabs(gap) / closing : NEVER;
}

static bool lasts(double seconds, double duration) {
    return seconds > 0 && seconds >= duration - 1e-9;
}

static double angle_between(double angle) {
    return fabs(remainder(angle, 2 * 3.14159265358979323846));
}

static bool is_asked(const sb_condition *condition, int32_t entity) {
    for (int32_t i = 0; i < condition->listed_count; ++i) {
        if (scenario_tables.triggering[condition->listed + i].entity == entity) return true;
    }
    return condition->listed_count == 0;
}

static bool is_within(const storyboard *board, const sb_condition *condition, int32_t lanes) {
    return lanes >= board->values[condition->numbers[2]] && lanes <= board->values[condition->numbers[3]];
}

/* Whether one of the lanes asked for is there, beside an actor on a path. */
static bool has_lane(const storyboard *board, const sb_condition *condition, const sb_place *at) {
    const path_table *path = &road_tables.paths[at->path];
    path_place place = path_find(path, at->s, 0);
    for (int32_t i = 0; i < path->lane_count; ++i) {
        int32_t number = path->lanes[i].number;
        bool is_opposite = place_sense(at->path, at->s, number) != place_sense(at->path, at->s, at->lane);
        bool is_there = path_value(place, path->lanes[i].width).value > 1e-3;
        if (is_there && !(is_opposite && !condition->takes_opposite) && is_within(board, condition, at->sense * (number - at->lane))) {
            return true;
        }
    }
    return false;
}

static bool is_clear(storyboard *board, const sb_condition *condition, int32_t actor) {
    const sb_actor *own = &board->actors[actor];
    if (own->at.path != SB_NONE && !has_lane(board, condition, &own->at)) return false;
    for (int32_t i = 0; i < scenario_tables.entity_count; ++i) {
        const sb_actor *other = &board->actors[i];
        if (i == actor || !other->is_present || !is_asked(condition, i)) continue;
        sb_gap gap = {.hint = NAN};
        sb_place at = other->at;
        int32_t piece = 0;
        if (own->at.path != SB_NONE && at.path != own->at.path) place_on_path(&at, own->at.path, &piece);
        double ahead = distance_to(board, condition, actor, other->at.x, other->at.y, i, LONGITUDINALLY, &gap);
        int32_t lanes = own->at.sense * (at.lane - own->at.lane);
        bool is_opposite = own->at.path != SB_NONE && place_sense(at.path, at.s, at.lane) != place_sense(own->at.path, own->at.s, own->at.lane);
        bool is_near = ahead <= board->values[condition->numbers[0]] && -ahead <= board->values[condition->numbers[1]];
        if (is_near && is_within(board, condition, lanes) && !(is_opposite && !condition->takes_opposite)) return false;
    }
    return true;
}

static bool of_actor(storyboard *board, const sb_condition *condition, const sb_triggering *who) {
    int32_t actor = who->entity;
    const sb_actor *own = &board->actors[actor];
    double value = board->values[condition->numbers[0]];
    if (!own->is_present || (condition->entity != SB_NONE && !board->actors[condition->entity].is_present)) return false;
    double gap = who->gap == SB_NONE ? NAN : gap_of(board, condition, actor, who->gap);
    switch (condition->kind) {
    case IF_SPEED: return fits(condition->rule, along_heading(own, condition->direction), value);
    case IF_RELATIVE_SPEED: {
        const sb_actor *other = &board->actors[condition->entity];
        double turn = condition->direction == SB_NONE ? 0 : own->at.heading - other->at.heading;
        double seen = condition->direction == LATERALLY ? own->speed * sin(turn) : own->speed * cos(turn);
        return fits(condition->rule, seen - (condition->direction == LATERALLY ? 0 : other->speed), value);
    }
    case IF_ACCELERATION: return fits(condition->rule, own->acceleration, value);
    case IF_STANDSTILL: return lasts(own->standing, value);
    case IF_TRAVELLED: return own->travelled >= value;
    case IF_REACHED: return fabs(gap) <= value;
    case IF_END_OF_ROAD: return lasts(own->ended, value);
    case IF_OFF_ROAD: return lasts(own->off_road, value);
    case IF_COLLISION:
        if (condition->entity != SB_NONE) return apart(board, actor, condition->entity) <= 0;
        for (int32_t i = 0; i < scenario_tables.entity_count; ++i) {
            bool is_of_class = condition->state == SB_NONE || scenario_tables.entities[i].class == condition->state;
            if (i != actor && is_of_class && board->actors[i].is_present && apart(board, actor, i) <= 0) return true;
        }
        return false;
    case IF_DISTANCE:
    case IF_RELATIVE_DISTANCE: return fits(condition->rule, fabs(gap), value);
    case IF_HEADWAY: return fits(condition->rule, gap >= 0 && own->speed > STILL ? gap / own->speed : NEVER, value);
    case IF_TIME_TO_COLLISION:
        return fits(condition->rule, time_to_collision(board, actor, condition->entity, gap), value);
    case IF_ANGLE: {
        double zero = condition->system == OF_ROAD ? own->at.heading - own->at.turn : 0;
        return angle_between(own->at.heading - zero - value) <= board->values[condition->numbers[1]];
    }
    case IF_RELATIVE_ANGLE: {
        double turn = own->at.heading - board->actors[condition->entity].at.heading;
        return angle_between(turn - value) <= board->values[condition->numbers[1]];
    }
    default: return is_clear(board, condition, actor);
    }
}

/* A transition is seen once: in its own frame by what comes later in the storyboard, else in the next one. */
static bool has_changed(const sb_progress *progress, int32_t transition, sb_memory *memory) {
    bool was_seen = memory->was_seen;
    memory->was_seen = (progress->changing & transition) != 0;
    return memory->was_seen || (!was_seen && progress->changed & transition);
}

static bool state_is(const storyboard *board, const sb_condition *condition, sb_memory *memory) {
    const sb_progress *progress = &board->progress[condition->element];
    switch (condition->state) {
    case ON_STANDBY: return progress->state == STANDBY;
    case ON_RUNNING: return progress->state == RUNNING;
    case ON_COMPLETE: return progress->state == COMPLETE;
    case ON_START: return has_changed(progress, HAS_STARTED, memory);
    case ON_END: return has_changed(progress, HAS_ENDED, memory);
    case ON_STOP: return has_changed(progress, HAS_STOPPED, memory);
    default: return has_changed(progress, HAS_SKIPPED, memory);
    }
}

static bool is_true_now(storyboard *board, const sb_condition *condition, sb_memory *memory) {
    if (condition->kind == IF_ALWAYS) return true;
    if (condition->kind == IF_STATE) return state_is(board, condition, memory);
    double value = board->values[condition->numbers[0]];
    if (condition->kind == IF_TIME) return fits(condition->rule, board->now, value);
    if (condition->kind == IF_CLOCK) return fits(condition->rule, board->clock + (board->is_clock_running ? board->now : 0), value);
    if (condition->kind == IF_VARIABLE) return fits(condition->rule, board->variables[condition->variable], value);
    for (int32_t i = 0; i < condition->count; ++i) {
        bool is_true = of_actor(board, condition, &scenario_tables.triggering[condition->first + i]);
        if (is_true != condition->needs_all) return is_true;
    }
    return condition->needs_all && condition->count > 0;
}

/* With an edge: true for one step, *delay* after it. Without: true if it was *delay* ago. */
static bool holds(storyboard *board, int32_t number) {
    const sb_condition *condition = &scenario_tables.conditions[number];
    sb_memory *memory = &board->memories[number];
    double delay = board->values[condition->delay], now = board->now;
    sb_memory before = *memory;
    bool is_true = is_true_now(board, condition, memory);
    memory->was = is_true;
    memory->is_known = true;
    if (is_true && !(before.is_known && before.was)) memory->since = now;
    if (is_true) memory->until = now;
    if (condition->edge == NO_EDGE) {
        bool was_ever = is_true || before.until > -HUGE_VAL;
        return delay <= 0 ? is_true : was_ever && memory->since <= now - delay + 1e-9 && memory->until >= now - delay - 1e-9;
    }
    bool rises = is_true && before.is_known && !before.was, falls = !is_true && before.is_known && before.was;
    bool is_edge = condition->edge == RISING ? rises : condition->edge == FALLING ? falls : rises || falls;
    if (is_edge && !memory->is_pending) {
        memory->is_pending = true;
        memory->fired = now;
    }
    if (!memory->is_pending || now < memory->fired + delay - 1e-9) return false;
    memory->is_pending = false;
    return true;
}

bool trigger_is_true(storyboard *board, int32_t trigger) {
    if (trigger == SB_NONE) return false;
    const sb_range *groups = &scenario_tables.triggers[trigger];
    bool any = false;
    for (int32_t i = 0; i < groups->count; ++i) {
        const sb_range *group = &scenario_tables.groups[groups->first + i];
        bool all = true;
        for (int32_t k = 0; k < group->count; ++k) {
            bool is_true = holds(board, group->first + k); /* each is asked, for its edge */
            all = all && is_true;
        }
        any = any || all;
    }
    return any;
}

bool has_triggered(storyboard *board, int32_t trigger, int32_t actor) {
    if (trigger == SB_NONE) return false;
    const sb_range *groups = &scenario_tables.triggers[trigger], *group = &scenario_tables.groups[groups->first];
    int32_t first = group->first, end = group[groups->count - 1].first + group[groups->count - 1].count;
    for (int32_t i = first; i < end; ++i) {
        const sb_condition *condition = &scenario_tables.conditions[i];
        for (int32_t k = 0; k < condition->count; ++k) {
            const sb_triggering *who = &scenario_tables.triggering[condition->first + k];
            if (who->entity == actor && of_actor(board, condition, who)) return true;
        }
    }
    return false;
}

/* What was true before does not count any more. */
void trigger_forget(storyboard *board, int32_t trigger) {
    if (trigger == SB_NONE) return;
    const sb_range *groups = &scenario_tables.triggers[trigger];
    for (int32_t i = 0; i < groups->count; ++i) {
        const sb_range *group = &scenario_tables.groups[groups->first + i];
        for (int32_t k = 0; k < group->count; ++k) {
            sb_memory *memory = &board->memories[group->first + k];
            memory->was = memory->is_known = memory->is_pending = false;
            memory->since = HUGE_VAL;
            memory->until = -HUGE_VAL;
        }
    }
}
