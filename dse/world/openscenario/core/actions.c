/* What actions do to the road users: at their start, and in each step until they end. */
#include "storyboard.h"

#include <math.h>
#include <stddef.h>

#define PI 3.14159265358979323846
#define REACHED 1e-6 /* m, s */
#define STIFFNESS 0.4 /* 1/m, of keeping a distance, times the largest acceleration; critically damped */
#define SOFTEST 4.0   /* m/s2, where no largest acceleration is given */
#define REACHED_ASIDE 0.01 /* m, m/s */
#define STOPPING 0.1  /* m/s, between the two phases of a synchronization */

static double number(const storyboard *board, const sb_action *action, int32_t i) {
    return board->values[action->numbers[i]];
}

/* Progress 0 ... 1 to 0 ... 1. */
static double shaped(int32_t shape, double x) {
    if (x >= 1) return 1;
    switch (shape) {
    case CUBIC: return x * x * (3 - 2 * x);
    case SINUSOIDAL: return 0.5 * (1 - cos(PI * x));
    default: return x;
    }
}

static double limited(double value, double limit) {
    return limit > 0 ? fmin(value, limit) : value;
}

/* A change at a greatest rate takes longer the more the shape's greatest slope exceeds the mean one. */
static double duration_of(const storyboard *board, const sb_action *action, double dynamics, double change) {
    if (action->shape == STEP) return 0;
    if (action->dimension == BY_TIME || (action->dimension == BY_DISTANCE && action->kind != DO_SPEED)) return fabs(dynamics);
    if (change == 0) return 0;
    if (action->dimension == BY_DISTANCE) return 2 * fabs(dynamics) / fabs(2 * board->actors[action->actor].speed + change);
    double peak = action->shape == CUBIC ? 1.5 : action->shape == SINUSOIDAL ? 0.5 * PI : 1;
    return peak * fabs(change) / fabs(dynamics);
}

/* The road user's own limits may make a change of speed longer. */
static double speed_duration(const storyboard *board, const sb_action *action, const sb_run *run) {
    const sb_entity *entity = &scenario_tables.entities[action->actor];
    double change = run->to - run->from, duration = duration_of(board, action, number(board, action, 0), change);
    double limit = fabs(run->to) > fabs(run->from) ? entity->top_acceleration : entity->top_deceleration;
    if (board->grip > 0) limit = limit > 0 ? fmin(limit, board->grip) : board->grip;
    if (action->shape == STEP || !(limit > 0) || !(duration > 0)) return duration;
    sb_action hardest = *action;
    hardest.dimension = BY_RATE;
    return fmax(duration, duration_of(board, &hardest, limit, change));
}

static double advance(const storyboard *board, const sb_action *action, sb_run *run) {
    const sb_actor *actor = &board->actors[action->actor];
    bool is_far = action->dimension == BY_DISTANCE && action->kind != DO_SPEED;
    double ahead = sqrt(fmax(actor->speed * actor->speed - actor->drift * actor->drift, 0));
    run->progress += is_far ? ahead * board->h : fabs(actor->speed) > 0 || !(action->controls & LATERAL) ? board->h : 0;
    return run->duration > 0 ? shaped(action->shape, (run->progress + 1e-9) / run->duration) : 1;
}

static double target_speed(const storyboard *board, const sb_action *action) {
    double wanted = number(board, action, 1);
    if (action->entity != SB_NONE) {
        double other = board->actors[action->entity].speed;
        wanted = action->flags & IS_FACTOR ? other * wanted : other + wanted;
    }
    return copysign(limited(fabs(wanted), scenario_tables.entities[action->actor].top_speed), wanted);
}

/* A speed that the road user reaches within its own limits; what is missing takes longer. */
static bool approach(storyboard *board, const sb_action *action, sb_run *run, double wanted) {
    sb_actor *actor = &board->actors[action->actor];
    const sb_entity *entity = &scenario_tables.entities[action->actor];
    double change = wanted - actor->speed, limit = change > 0 ? entity->top_acceleration : entity->top_deceleration;
    double most = limit > 0 && board->h > 0 ? limit * board->h : HUGE_VAL;
    if (fabs(change) <= most + REACHED) {
        actor->speed = wanted;
        return true;
    }
    actor->speed += copysign(most, change);
    run->progress -= board->h * (1 - most / fabs(change));
    return false;
}

static double t_of(const sb_actor *actor) {
    return place_middle(actor->at.path, actor->at.s, actor->at.lane, actor->piece) + actor->at.offset;
}

/* The state of another one seen on the path of an actor. */
static sb_place seen_on_path(storyboard *board, int32_t actor, int32_t other) {
    sb_place place = board->actors[other].at;
    int32_t path = board->actors[actor].at.path, piece = 0;
    if (path != SB_NONE && place.path != path) place_on_path(&place, path, &piece);
    return place;
}

static void stop_controlling(storyboard *board, const sb_action *action) {
    sb_actor *actor = &board->actors[action->actor];
    int32_t self = (int32_t)(action - scenario_tables.actions);
    if (actor->lateral == self) actor->lateral = SB_NONE;
    if (actor->longitudinal == self) actor->longitudinal = SB_NONE;
}

static void take_control(storyboard *board, const sb_action *action) {
    sb_actor *actor = &board->actors[action->actor];
    int32_t self = (int32_t)(action - scenario_tables.actions);
    if (action->controls & LATERAL) {
        if (actor->lateral != SB_NONE && actor->lateral != self) action_end(board, actor->lateral);
        actor->lateral = self;
        if (action->kind != DO_TRAJECTORY && actor->trajectory != SB_NONE) actor->trajectory = SB_NONE;
    }
    if (action->controls & LONGITUDINAL) {
        if (actor->longitudinal != SB_NONE && actor->longitudinal != self) action_end(board, actor->longitudinal);
        actor->longitudinal = self;
    }
}

void action_end(storyboard *board, int32_t self) {
    const sb_action *action = &scenario_tables.actions[self];
    if (!board->runs[self].is_running) return;
    board->runs[self].is_running = false;
    if (action->actor != SB_NONE) stop_controlling(board, action);
}

static void change_lane(storyboard *board, const sb_action *action, sb_run *run) {
    sb_actor *actor = &board->actors[action->actor];
    int32_t lane;
    if (action->entity == SB_NONE) {
        lane = place_lane(actor->at.path, actor->at.s, action->target);
    } else {
        sb_place other = seen_on_path(board, action->actor, action->entity);
        lane = other.lane + other.sense * action->target;
    }
    double t = t_of(actor);
    actor->at.lane = lane;
    actor->at.offset = t - place_middle(actor->at.path, actor->at.s, lane, actor->piece);
    run->from = actor->at.offset;
    run->to = place_road(actor->at.path, actor->at.s) * number(board, action, 1);
    run->duration = duration_of(board, action, number(board, action, 0), run->to - run->from);
}

static double wanted_offset(storyboard *board, const sb_action *action) {
    sb_actor *actor = &board->actors[action->actor];
    double given = number(board, action, 0);
    if (action->entity == SB_NONE) return place_road(actor->at.path, actor->at.s) * given;
    sb_place other = seen_on_path(board, action->actor, action->entity);
    double t = place_middle(other.path, other.s, other.lane, 0) + other.offset;
    return t + other.sense * given - place_middle(actor->at.path, actor->at.s, actor->at.lane, actor->piece);
}

/* With a greatest lateral acceleration a: |second derivative| of the shape is at most that. */
static void change_offset(storyboard *board, const sb_action *action, sb_run *run) {
    run->from = board->actors[action->actor].at.offset;
    run->to = wanted_offset(board, action);
    double change = fabs(run->to - run->from), a = number(board, action, 1);
    switch (action->shape) {
    case SINUSOIDAL: run->duration = PI * sqrt(change / (2 * a)); break;
    case CUBIC:
    case LINEAR: run->duration = sqrt(6 * change / a); break;
    default: run->duration = 0;
    }
}

static double half_length(int32_t entity) {
    return 0.5 * scenario_tables.entities[entity].length;
}

/* The acceleration that closes a distance of *excess* m, which grows by *opening* m/s, within limits (<= 0: none). */
static double pull(double excess, double opening, double most, double least) {
    double reach = excess < 0 ? most : least, stiffness = STIFFNESS * (reach > 0 ? reach : SOFTEST);
    double wanted = stiffness * excess + 2 * sqrt(stiffness) * opening;
    return wanted > 0 ? limited(wanted, most) : -limited(-wanted, least);
}

/* From the reference point of the actor that keeps a distance to that of the other one. */
static double wanted_gap(const storyboard *board, const sb_action *action, double ahead) {
    double gap = number(board, action, 0);
    if (action->flags & IS_TIME_GAP) gap *= fabs(board->actors[action->entity].speed);
    double sign = action->flags & IS_TRAILING ? 1 : action->flags & IS_LEADING ? -1 : ahead >= 0 ? 1 : -1;
    if (action->flags & IS_FREESPACE) {
        const sb_entity *own = &scenario_tables.entities[action->actor], *other = &scenario_tables.entities[action->entity];
        gap += half_length(action->actor) + half_length(action->entity) + sign * (own->centre_x - other->centre_x);
    }
    return sign * gap;
}

/* Of two limits, of which one <= 0 is none. */
static double lesser(double one, double other) {
    return one > 0 && other > 0 ? fmin(one, other) : fmax(one, other);
}

static bool keep_distance(storyboard *board, const sb_action *action) {
    sb_actor *actor = &board->actors[action->actor];
    const sb_actor *other = &board->actors[action->entity];
    sb_gap found = {.hint = NAN};
    double ahead = action->flags & IS_ALONG_ROAD
                       ? gap_ahead(board, action->actor, action->entity, other->at.x, other->at.y, &found, NULL)
                       : (other->at.x - actor->at.x) * cos(actor->at.heading) + (other->at.y - actor->at.y) * sin(actor->at.heading);
    double excess = ahead - wanted_gap(board, action, ahead);
    if (!(action->flags & HAS_LIMITS)) {
        if (actor->at.path != SB_NONE) {
            actor->at.s += actor->at.sense * excess;
            place_lay(&actor->at, &actor->piece);
        } else {
            actor->at.x += excess * cos(actor->at.heading);
            actor->at.y += excess * sin(actor->at.heading);
        }
        actor->speed = other->speed;
        return !(action->flags & IS_CONTINUOUS);
    }
    const sb_entity *own = &scenario_tables.entities[action->actor];
    double most = lesser(number(board, action, 1), own->top_acceleration);
    double least = lesser(number(board, action, 2), own->top_deceleration);
    double top = lesser(number(board, action, 3), own->top_speed);
    double a = pull(excess, other->speed - actor->speed, most, least);
    actor->speed = fmax(limited(actor->speed + a * board->h, top), 0);
    return !(action->flags & IS_CONTINUOUS) && fabs(excess) < 0.1;
}

/* Beside the other one: across the path, or in the plane across the line that the other one drives along. */
static bool keep_aside(storyboard *board, const sb_action *action, sb_run *run) {
    sb_actor *actor = &board->actors[action->actor];
    bool is_on_path = actor->at.path != SB_NONE;
    sb_place other = seen_on_path(board, action->actor, action->entity);
    double c = cos(other.heading), s = sin(other.heading);
    double aside = is_on_path ? t_of(actor) - (place_middle(other.path, other.s, other.lane, 0) + other.offset)
                              : (actor->at.y - other.y) * c - (actor->at.x - other.x) * s;
    double side = aside >= 0 ? 1 : -1, left = is_on_path ? actor->at.sense : 1;
    if (action->flags & IS_LEADING) side = left; /* to the left of the other one */
    if (action->flags & IS_TRAILING) side = -left;
    double gap = number(board, action, 0), most = number(board, action, 3) * board->h;
    if (action->flags & IS_FREESPACE) {
        gap += 0.5 * (scenario_tables.entities[action->actor].width + scenario_tables.entities[action->entity].width);
    }
    double missing = side * gap - aside, hardest = number(board, action, 1), softest = number(board, action, 2);
    double wanted = missing;
    if (hardest > 0 || softest > 0) { /* towards the wanted distance at most the one, away from it the other */
        run->rate += side * pull(side * missing, -side * run->rate, hardest, softest) * board->h;
        if (most > 0) run->rate = fmax(fmin(run->rate, most / board->h), -most / board->h);
        wanted = fabs(missing) < REACHED_ASIDE && fabs(run->rate) < REACHED_ASIDE ? missing : run->rate * board->h;
    }
    double moved = most > 0 && fabs(wanted) > most ? copysign(most, wanted) : wanted;
    if (is_on_path) {
        actor->at.offset += moved;
    } else {
        actor->at.x -= moved * s;
        actor->at.y += moved * c;
    }
    return !(action->flags & IS_CONTINUOUS) && moved == missing;
}

void show_phase(storyboard *board, int32_t number, int32_t shown, double since) {
    const sb_controller *controller = &scenario_tables.controllers[number];
    const sb_phase *phase = &scenario_tables.phases[controller->phase + shown];
    board->shown[number] = shown;
    board->since[number] = since;
    board->variables[controller->variable] = board->values[phase->name];
    for (int32_t i = phase->state; i < phase->state + phase->states; ++i) {
        board->variables[scenario_tables.states[i][0]] = board->values[scenario_tables.states[i][1]];
    }
}

static void begin_trajectory(storyboard *board, const sb_action *action, sb_run *run) {
    sb_actor *actor = &board->actors[action->actor];
    trajectory_lay(board, action->target, action->actor);
    actor->trajectory = action->target;
    actor->slot = (int32_t)(action - scenario_tables.actions);
    actor->along = number(board, action, 0);
    if (action->flags & IS_ACCELERATED) trajectory_accelerate(board, action->target, actor->speed);
    double shift = board->points[scenario_tables.trajectories[action->target].point].time;
    double skipped = trajectory_at(board, action->target, actor->along).time - shift;
    run->begun = action->flags & IS_RELATIVE_TIME ? board->now - skipped : 0;
    if (action->flags & IS_TIMED) {
        double time = (board->now - run->begun - number(board, action, 2)) / number(board, action, 1);
        actor->along = fmax(actor->along, trajectory_station(board, action->target, fmax(time, shift)));
    }
    run->from = trajectory_sense(action->target, actor->speed);
    trajectory_put(board, action->target, actor, run->from);
    actor->is_present = true;
}

/* Along its line, in the direction of its motion, from an actor to a point; what lies behind is negative. */
static double way_to(storyboard *board, int32_t number, int32_t position) {
    const sb_actor *actor = &board->actors[number];
    sb_place there = place_of(board, position, SB_NONE);
    if (actor->trajectory != SB_NONE) {
        return trajectory_foot(board, actor->trajectory, there.x, there.y) - actor->along;
    }
    sb_gap found = {.hint = NAN};
    double ahead = gap_ahead(board, number, SB_NONE, there.x, there.y, &found, NULL);
    return actor->speed < 0 ? -ahead : ahead;
}

/* The speed of the end of this step on the way to *left* m in *until* s, at which the final speed is reached: a constant
 * acceleration, then the opposite one (its apex v solves v^2 - 2 v s/t + s (v0 + v1)/t - (v0^2 + v1^2)/2 = 0); once the
 * speed fits, one constant acceleration. If the apex is below 0 there is time to stand. */
static double synchronized(const storyboard *board, sb_run *run, double speed, double left, double until, double final) {
    double linear = 2 * left / until - final;
    if (run->begun <= 0 && fabs(speed - final) < REACHED) run->phase = 1; /* from the start of the scenario */
    if (run->phase == 1 || !(until > board->h)) return fmax(linear, 0);
    double mean = left / until;
    double root = sqrt(fmax(mean * mean - mean * (speed + final) + 0.5 * (speed * speed + final * final), 0));
    double apex = 2 * mean >= speed + final ? mean + root : mean - root;
    if (apex < 0) {
        double braking = 0.5 * (speed * speed + final * final) / left; /* the rate of stopping is that of starting */
        if (speed <= 0 && linear >= 0) run->phase = 1;
        return speed <= 0 ? fmax(linear, 0) : fmax(speed - braking * board->h, 0);
    }
    double a = (2 * apex - speed - final) / until, next = speed + a * board->h;
    bool turns = run->rate * a < 0;
    run->rate = a;
    if (turns || fabs(speed - linear) < STOPPING) {
        run->phase = 1;
        return fmax(linear, 0);
    }
    return next;
}

/* Both arrive at the same time; the steady state at the end is driven at the final speed. */
static bool synchronize(storyboard *board, const sb_action *action, sb_run *run) {
    sb_actor *actor = &board->actors[action->actor];
    const sb_actor *master = &board->actors[action->entity];
    if (!(board->h > 0)) return false;
    double masters = way_to(board, action->entity, action->position) - number(board, action, 2);
    double way = way_to(board, action->actor, action->other_position) - number(board, action, 3);
    double pace = run->progress > 0 ? (run->masters - masters) / board->h : fabs(master->speed);
    double final = number(board, action, 0) + (action->flags & IS_FACTOR ? master->speed : 0);
    bool is_first = run->progress == 0, moves_away = !is_first && (way > run->way + REACHED || masters > run->masters + REACHED);
    run->progress = 1;
    run->way = way;
    run->masters = masters;
    if (way <= 0 || masters <= 0 || moves_away || (pace > 0 && masters < pace * board->h)) {
        if (action->flags & HAS_FINAL_SPEED) actor->speed = final;
        return true;
    }
    if (is_first) return false;
    if (!(pace > REACHED)) { /* it never arrives */
        actor->speed = 0;
        return false;
    }
    double time = masters / pace;
    if (!(action->flags & HAS_FINAL_SPEED)) {
        actor->speed += 2 * (way / time - actor->speed) / time * board->h;
        return false;
    }
    double steady = number(board, action, 1);
    double kept = action->flags & STEADY_TIME ? steady * final : action->flags & STEADY_DISTANCE ? steady : 0;
    double left = way - kept, until = time - (kept > 0 ? kept / final : 0);
    actor->speed = left <= 0 || until <= 0 ? final : synchronized(board, run, actor->speed, left, until, final);
    return false;
}

static bool follow_profile(storyboard *board, const sb_action *action, sb_run *run) {
    sb_actor *actor = &board->actors[action->actor];
    run->progress += board->h;
    while (run->phase < action->count) {
        const int32_t *entry = scenario_tables.entries[action->target + run->phase];
        double to = board->values[entry[1]], change = to - run->from;
        double rate = change > 0 ? number(board, action, 1) : number(board, action, 2);
        double duration = entry[0] != SB_NONE ? board->values[entry[0]] : rate > 0 ? fabs(change) / rate : 0;
        if (run->progress < duration - REACHED) {
            actor->speed = run->from + change * run->progress / duration;
            return false;
        }
        run->progress -= duration;
        run->from = actor->speed = to;
        run->phase += 1;
    }
    return true;
}

static void place_actor(storyboard *board, const sb_action *action) {
    sb_actor *actor = &board->actors[action->actor];
    actor->at = place_of(board, action->position, action->actor);
    actor->piece = 0;
    actor->trajectory = SB_NONE;
    actor->is_present = true;
    actor->drift = 0;
    bool is_moved[SB_ENTITIES] = {false};
    is_moved[action->actor] = true;
    for (int32_t i; (i = next_trailer(is_moved)) != SB_NONE; is_moved[i] = true) place_trailer(board, i, true);
}

void action_begin(storyboard *board, int32_t self) {
    const sb_action *action = &scenario_tables.actions[self];
    sb_run *run = &board->runs[self];
    sb_actor *actor = action->actor == SB_NONE ? NULL : &board->actors[action->actor];
    board->epoch += 1;
    *run = (sb_run){.is_running = true, .begun = board->now};
    bool is_host = action->actor == scenario_tables.host && board->has_host && board->now > 0;
    if (is_host && action->controls) { /* somebody else drives it */
        run->is_running = false;
        return;
    }
    if (action->controls) take_control(board, action);
    switch (action->kind) {
    case DO_SPEED:
        run->from = actor->speed;
        run->to = target_speed(board, action);
        run->duration = speed_duration(board, action, run);
        if (!(run->duration > 0) || isinf(run->duration)) {
            if (!isinf(run->duration)) actor->speed = run->to;
            if (!(action->flags & IS_CONTINUOUS)) action_end(board, self);
        }
        return;
    case DO_SPEED_PROFILE: run->from = actor->speed; return;
    case DO_LANE_CHANGE:
    case DO_LANE_OFFSET:
        if (actor->at.path == SB_NONE) {
            action_end(board, self);
        } else if (action->kind == DO_LANE_CHANGE) {
            change_lane(board, action, run);
        } else {
            change_offset(board, action, run);
        }
        return;
    case DO_TRAJECTORY: begin_trajectory(board, action, run); return;
    case DO_LONGITUDINAL_DISTANCE:
    case DO_LATERAL_DISTANCE:
    case DO_SYNCHRONIZE: return;
    case DO_TELEPORT: place_actor(board, action); break;
    case DO_ADD:
        if (!actor->is_present) place_actor(board, action);
        break;
    case DO_DELETE: actor->is_present = false; break;
    case DO_ROUTE: place_on_path(&actor->at, action->target, &actor->piece); break;
    case DO_SET: board->variables[action->target] = number(board, action, 0); break;
    case DO_INCREASE: board->variables[action->target] += number(board, action, 0); break;
    case DO_MULTIPLY: board->variables[action->target] *= number(board, action, 0); break;
    case DO_CLOCK:
        board->is_clock_running = (action->flags & IS_CONTINUOUS) != 0;
        board->clock = number(board, action, 0) - (board->is_clock_running ? board->now : 0);
        break;
    case DO_PHASE: show_phase(board, action->target, action->count, board->now); break;
    case DO_SEE: actor->is_hidden = (action->flags & IS_HIDDEN) != 0; break;
    default: break;
    }
    action_end(board, self);
}

void action_advance(storyboard *board, int32_t self) {
    const sb_action *action = &scenario_tables.actions[self];
    sb_run *run = &board->runs[self];
    sb_actor *actor = action->actor == SB_NONE ? NULL : &board->actors[action->actor];
    bool is_done = false;
    if (!run->is_running) return;
    switch (action->kind) {
    case DO_SPEED: {
        if (action->entity != SB_NONE) {
            run->to = target_speed(board, action);
            if (action->dimension == BY_RATE) run->duration = duration_of(board, action, number(board, action, 0), run->to - run->from);
        }
        double part = advance(board, action, run);
        is_done = approach(board, action, run, run->from + part * (run->to - run->from)) && part >= 1;
        is_done = is_done && !(action->flags & IS_CONTINUOUS);
        break;
    }
    case DO_SPEED_PROFILE: is_done = follow_profile(board, action, run); break;
    case DO_LONGITUDINAL_DISTANCE: is_done = keep_distance(board, action); break;
    case DO_LATERAL_DISTANCE: is_done = keep_aside(board, action, run); break;
    case DO_LANE_CHANGE:
    case DO_LANE_OFFSET: {
        double part = advance(board, action, run);
        bool follows = action->flags & IS_CONTINUOUS && action->entity != SB_NONE && action->entity != action->actor;
        if (follows) run->to = wanted_offset(board, action);
        double offset = run->from + part * (run->to - run->from);
        actor->drift = board->h > 0 ? (offset - actor->at.offset) / board->h : 0;
        actor->at.offset = offset;
        is_done = part >= 1 && !follows;
        break;
    }
    case DO_TRAJECTORY: is_done = actor->trajectory == SB_NONE || actor->slot != self; break;
    case DO_SYNCHRONIZE: is_done = synchronize(board, action, run); break;
    default: is_done = true;
    }
    if (is_done) action_end(board, self);
}
