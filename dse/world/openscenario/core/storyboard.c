#include "storyboard.h"

#include <math.h>
#include <stddef.h>

#define STILL 1e-3   /* m/s */
#define REACHED 1e-6 /* m */

static const sb_element *element_of(int32_t i) {
    return &scenario_tables.elements[i];
}

/* The element after *i* in the file; what is in an element that does not run does not run either. */
static int32_t next_of(const storyboard *board, int32_t i) {
    return board->progress[i].state == RUNNING ? i + 1 : element_of(i)->end;
}

/* Elements below *i*, and *i* itself, end now. */
static void stop(storyboard *board, int32_t i) {
    board->changes = 2;
    for (int32_t k = i; k < element_of(i)->end; ++k) {
        sb_progress *progress = &board->progress[k];
        if (progress->state == COMPLETE) continue;
        if (element_of(k)->kind == ACTION) action_end(board, element_of(k)->action);
        if (progress->state == RUNNING) progress->changing |= HAS_STOPPED;
        progress->state = COMPLETE;
    }
}

static void start(storyboard *board, int32_t i) {
    const sb_element *element = element_of(i);
    board->changes = 2;
    board->progress[i].state = RUNNING;
    board->progress[i].changing |= HAS_STARTED;
    if (element->kind == ACTION) {
        int32_t event = element->parent, actor = scenario_tables.actions[element->action].actor;
        if (element->is_chosen && !has_triggered(board, element_of(event)->start, actor)) {
            board->progress[i].state = COMPLETE;
        } else {
            action_begin(board, element->action);
        }
        return;
    }
    for (int32_t k = i + 1; k < element->end; k = element_of(k)->end) {
        bool follows = element->kind == ACT || element->kind == GROUP || element->kind == EVENT;
        board->progress[k].state = STANDBY;
        trigger_forget(board, element_of(k)->start);
        if (element_of(k)->kind == EVENT) board->progress[k].count = 0;
        if (follows) start(board, k);
    }
}

/* Whether an event that is due starts, by its priority among those of its maneuver that are running. */
static bool prevails(storyboard *board, int32_t i) {
    const sb_element *element = element_of(i), *parent = element_of(element->parent);
    if (element->priority == PARALLEL) return true;
    for (int32_t k = element->parent + 1; k < parent->end; k = element_of(k)->end) {
        if (k == i || board->progress[k].state != RUNNING) continue;
        if (element->priority == SKIP) {
            board->progress[i].changing |= HAS_SKIPPED;
            board->changes = 2;
            return false;
        }
        stop(board, k);
    }
    return true;
}

static void proceed(storyboard *board, int32_t i) {
    const sb_element *element = element_of(i);
    sb_progress *progress = &board->progress[i];
    bool is_parent_running = element->parent == SB_NONE || board->progress[element->parent].state == RUNNING;
    if (progress->state == STANDBY && is_parent_running) {
        bool is_due = element->start == SB_NONE || trigger_is_true(board, element->start);
        if (is_due && (element->kind != EVENT || prevails(board, i))) start(board, i);
    } else if (progress->state == RUNNING && element->stop != SB_NONE && trigger_is_true(board, element->stop)) {
        stop(board, i);
    }
}

static void finish(storyboard *board, int32_t i) {
    const sb_element *element = element_of(i);
    sb_progress *progress = &board->progress[i];
    if (element->kind != ACTION || progress->state != RUNNING || board->runs[element->action].is_running) return;
    progress->state = COMPLETE;
    progress->changing |= HAS_ENDED;
    board->changes = 2;
}

/* From the innermost outwards: what has only ended elements in it ends. */
static void conclude(storyboard *board, int32_t i) {
    const sb_element *element = element_of(i);
    sb_progress *progress = &board->progress[i];
    if (progress->state != RUNNING || element->kind == ACTION) return;
    for (int32_t k = i + 1; k < element->end; k = element_of(k)->end) {
        if (board->progress[k].state != COMPLETE) return;
    }
    progress->changing |= HAS_ENDED;
    board->changes = 2;
    progress->count += 1;
    progress->state = COMPLETE;
    if (progress->count >= element->most) return;
    if (element->kind == EVENT) {
        progress->state = STANDBY;
        trigger_forget(board, element->start);
    }
    if (element->kind == GROUP) start(board, i);
}

static void follow(storyboard *board, sb_actor *actor) {
    const sb_action *action = &scenario_tables.actions[actor->slot];
    double before = actor->along, length = trajectory_length(board, actor->trajectory);
    bool is_over;
    if (action->flags & IS_TIMED) {
        double begun = board->runs[actor->slot].begun;
        double time = (board->now - begun - board->values[action->numbers[2]]) / board->values[action->numbers[1]];
        const sb_trajectory *line = &scenario_tables.trajectories[actor->trajectory];
        actor->along = fmax(before, trajectory_station(board, actor->trajectory, time));
        is_over = time >= board->points[line->point + line->points - 1].time;
        if (!is_over) actor->speed = (actor->along - before) / board->h;
    } else {
        double moved = board->runs[actor->slot].from * actor->speed * board->h;
        actor->along += moved;
        is_over = moved < 0 ? actor->along <= 0 : actor->along >= length;
    }
    trajectory_put(board, actor->trajectory, actor, board->runs[actor->slot].from);
    if (!is_over) return;
    action_end(board, actor->slot);
    actor->trajectory = SB_NONE;
    int32_t path = scenario_tables.entities[actor - board->actors].path;
    if (path != SB_NONE) place_on_path(&actor->at, path, &actor->piece);
}

/* Whoever is in a lane that does not go on beside the path leaves it there. */
static void turn_off(storyboard *board, sb_actor *actor, double before) {
    sb_place *at = &actor->at;
    if (at->lane == 0) return;
    for (int32_t i = 0; i < scenario_tables.branch_count; ++i) {
        const sb_branch *branch = &scenario_tables.branches[i];
        bool passes = before < branch->station && at->s >= branch->station && at->sense > 0;
        if (branch->path != at->path || branch->lane != at->lane || !passes) continue;
        double over = at->s - branch->station + REACHED, offset = at->offset;
        at->s = branch->station - REACHED;
        place_lay(at, &actor->piece);
        place_on_path(at, branch->to, &actor->piece);
        at->s += over;
        at->lane = 0;
        at->offset = offset;
        at->turn = 0;
        return;
    }
}

static void drive(storyboard *board, sb_actor *actor) {
    sb_place *at = &actor->at;
    double ahead = sqrt(fmax(actor->speed * actor->speed - actor->drift * actor->drift, 0));
    double before = at->s;
    if (at->s != actor->laid_s || actor->stretch <= 0) actor->stretch = place_lay(at, &actor->piece);
    at->s += at->sense * copysign(ahead, actor->speed) * board->h / actor->stretch;
    turn_off(board, actor, before);
    const path_table *path = &road_tables.paths[at->path];
    double inside = path->closed ? at->s : fmin(fmax(at->s, 0), path->length);
    if (inside != at->s && actor->ended > 0) actor->speed = 0;
    actor->ended = inside != at->s || (!path->closed && inside >= path->length) ? actor->ended + board->h : 0;
    at->s = actor->laid_s = inside;
    actor->stretch = place_lay(at, &actor->piece);
    if (actor->drift != 0) at->heading += at->sense * atan2(actor->drift, ahead);
}

static void move(storyboard *board, int32_t i) {
    sb_actor *actor = &board->actors[i];
    bool is_driven = board->has_host && i == scenario_tables.host;
    if (!actor->is_present) return;
    if (is_driven) {
        int32_t path = scenario_tables.entities[i].path;
        if (path != SB_NONE) place_on_path(&actor->at, path, &actor->piece);
    } else if (scenario_tables.entities[i].tow != SB_NONE) {
        place_trailer(board, i, false);
    } else if (actor->trajectory != SB_NONE) {
        follow(board, actor);
    } else if (actor->at.path != SB_NONE) {
        drive(board, actor);
    } else {
        actor->at.x += actor->speed * board->h * cos(actor->at.heading);
        actor->at.y += actor->speed * board->h * sin(actor->at.heading);
    }
    double dx = actor->at.x - actor->origin_x, dy = actor->at.y - actor->origin_y;
    actor->travelled += hypot(dx, dy);
    actor->origin_x = actor->at.x;
    actor->origin_y = actor->at.y;
    actor->standing = fabs(actor->speed) < STILL ? actor->standing + board->h : 0;
    if (actor->lateral == SB_NONE) actor->drift = 0;
    if (scenario_tables.has_off_road) actor->off_road = place_is_on_road(&actor->at) ? 0 : actor->off_road + board->h;
}

static void advance_time(storyboard *board) {
    if (board->h != board->step) {
        board->base_time += (double)board->steps * board->step;
        board->step = board->h;
        board->steps = 0;
    }
    board->steps += 1;
    board->now = board->base_time + (double)board->steps * board->step;
}

void storyboard_face(sb_actor *actor) {
    actor->cosine = cos(actor->at.heading);
    actor->sine = sin(actor->at.heading);
}

/* A phase that lasts no time at all stays. */
static void change_signals(storyboard *board) {
    for (int32_t i = 0; i < scenario_tables.controller_count; ++i) {
        const sb_controller *controller = &scenario_tables.controllers[i];
        for (int32_t k = 0; k < controller->phases; ++k) {
            double end = board->since[i] + board->values[scenario_tables.phases[controller->phase + board->shown[i]].duration];
            if (!(end > board->since[i] && board->now >= end - 1e-9)) break;
            show_phase(board, i, (board->shown[i] + 1) % controller->phases, end);
        }
    }
}

/* Triggers see the state before the step; then actions advance, the time, and the road users move. */
void storyboard_step(storyboard *board, double h) {
    double before[SB_ENTITIES];
    board->h = h;
    board->epoch += 1;
    for (int32_t i = 0; i < scenario_tables.entity_count; ++i) {
        before[i] = board->actors[i].speed;
    }
    for (int32_t i = 0; i < scenario_tables.element_count && board->changes > 0; ++i) {
        board->progress[i].changed = board->progress[i].changing;
        board->progress[i].changing = 0;
    }
    board->changes -= board->changes > 0;
    change_signals(board);
    if (trigger_is_true(board, scenario_tables.stop)) board->has_ended = true;
    for (int32_t i = 0; i < scenario_tables.element_count; i = next_of(board, i)) proceed(board, i);
    for (int32_t i = 0; i < scenario_tables.init_count; ++i) action_advance(board, i);
    for (int32_t i = 0; i < scenario_tables.element_count; i = next_of(board, i)) {
        bool is_acting = element_of(i)->kind == ACTION && board->progress[i].state == RUNNING;
        if (is_acting) action_advance(board, element_of(i)->action);
    }
    if (h > 0) {
        advance_time(board);
        bool is_moved[SB_ENTITIES] = {false};
        for (int32_t i = 0; i < scenario_tables.entity_count; ++i) {
            is_moved[i] = scenario_tables.entities[i].tow == SB_NONE;
            if (is_moved[i]) move(board, i);
        }
        for (int32_t i; (i = next_trailer(is_moved)) != SB_NONE; is_moved[i] = true) move(board, i);
        for (int32_t i = 0; i < scenario_tables.entity_count; ++i) {
            bool is_driven = board->has_host && i == scenario_tables.host;
            if (!is_driven) board->actors[i].acceleration = (board->actors[i].speed - before[i]) / h;
        }
    }
    for (int32_t i = 0; i < scenario_tables.entity_count; ++i) storyboard_face(&board->actors[i]);
    for (int32_t i = 0; i < scenario_tables.element_count; i = next_of(board, i)) finish(board, i);
    for (int32_t i = scenario_tables.element_count - 1; i >= 0 && board->changes > 0; --i) conclude(board, i);
}

/* An action waits for the entity that it refers to. */
static bool is_ready(const storyboard *board, const sb_action *action) {
    int32_t position = action->position;
    int32_t other = position == SB_NONE ? SB_NONE : scenario_tables.positions[position].entity;
    bool knows = action->entity == SB_NONE || board->actors[action->entity].is_present;
    return knows && (other == SB_NONE || board->actors[other].is_present);
}

static void begin_actions(storyboard *board) {
    bool has_begun[SB_ACTIONS] = {false};
    for (int32_t pass = 0, left = scenario_tables.init_count; left > 0; ++pass) {
        int32_t before = left;
        for (int32_t i = 0; i < scenario_tables.init_count; ++i) {
            const sb_action *action = &scenario_tables.actions[i];
            if (has_begun[i] || !(is_ready(board, action) || pass > scenario_tables.init_count)) continue;
            has_begun[i] = true;
            left -= 1;
            action_begin(board, i);
            /* Distances that are kept without limits hold from the start. */
            if (action->kind == DO_LONGITUDINAL_DISTANCE && !(action->flags & HAS_LIMITS)) action_advance(board, i);
        }
        if (left == before) pass = scenario_tables.init_count;
    }
}

void storyboard_begin(storyboard *board) {
    board->base_time = board->step = board->now = board->h = 0;
    board->steps = board->epoch = 0;
    board->has_ended = false;
    board->changes = 0;
    for (int32_t i = 0; i < SB_CONDITIONS; ++i) board->memories[i] = (sb_memory){.since = HUGE_VAL, .until = -HUGE_VAL};
    for (int32_t i = 0; i < SB_GAPS; ++i) board->gaps[i] = (sb_gap){.hint = NAN};
    for (int32_t i = 0; i < SB_ACTIONS; ++i) board->runs[i] = (sb_run){.is_running = false};
    for (int32_t i = 0; i < SB_ELEMENTS; ++i) board->progress[i] = (sb_progress){.state = STANDBY};
    for (int32_t i = 0; i < scenario_tables.entity_count; ++i) {
        board->actors[i] = (sb_actor){
            .at = {.path = SB_NONE, .sense = 1}, .trajectory = SB_NONE, .lateral = SB_NONE, .longitudinal = SB_NONE};
    }
    for (int32_t i = 0; i < scenario_tables.trajectory_count; ++i) {
        const sb_trajectory *line = &scenario_tables.trajectories[i];
        bool is_placed = scenario_tables.vertices[line->vertex].position != SB_NONE;
        if (is_placed) trajectory_lay(board, i, SB_NONE);
    }
    board->clock = scenario_tables.clock;
    board->is_clock_running = true;
    for (int32_t i = 0; i < scenario_tables.controller_count; ++i) {
        const sb_controller *controller = &scenario_tables.controllers[i];
        double begun = board->values[controller->begun], cycle = 0;
        for (int32_t k = 0; k < controller->phases; ++k) cycle += board->values[scenario_tables.phases[controller->phase + k].duration];
        show_phase(board, i, 0, cycle > 0 && isfinite(cycle) ? begun - ceil(begun / cycle) * cycle : 0);
    }
    change_signals(board);
    begin_actions(board);
    for (int32_t i = 0; i < scenario_tables.entity_count; ++i) {
        board->actors[i].origin_x = board->actors[i].at.x;
        board->actors[i].origin_y = board->actors[i].at.y;
        storyboard_face(&board->actors[i]);
    }
    for (int32_t i = 0; i < scenario_tables.element_count; i = element_of(i)->end) start(board, i);
    storyboard_step(board, 0);
}
