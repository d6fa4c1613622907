#include "scenario.h"

#include <math.h>
#include <stddef.h>

#define GRAVITY 9.81 /* m/s2 */

static sb_actor *host_of(scenario *self) {
    return scenario_tables.host == SB_NONE ? NULL : &self->board.actors[scenario_tables.host];
}

/* From the centre of gravity of the host to its reference point: both have the same front bumper. */
static double host_shift(const scenario *self) {
    const sb_entity *entity = &scenario_tables.entities[scenario_tables.host];
    return entity->centre_x + 0.5 * entity->length - self->par.host_front;
}

static scenario_mover mover_of(const scenario *self, int32_t i) {
    const sb_entity *entity = &scenario_tables.entities[i];
    const sb_actor *actor = &self->board.actors[i];
    scenario_mover nobody = {0};
    if (!actor->is_present || actor->is_hidden) return nobody;
    double c = actor->cosine, s = actor->sine;
    return (scenario_mover){
        .id = i + 1,
        .class = entity->class,
        .length = entity->length,
        .width = entity->width,
        .height = entity->height,
        .path = SB_NONE,
        .station = actor->at.x + entity->centre_x * c - entity->centre_y * s,
        .offset = actor->at.y + entity->centre_x * s + entity->centre_y * c,
        .turn = actor->at.heading,
        .speed = actor->ended > 0 ? 0 : actor->speed,
        .acceleration = actor->acceleration,
    };
}

/* The nearest ones to the host that have no index yet, as long as there is one. */
static void show_nearest(scenario *self) {
    const sb_actor *host = host_of(self);
    double x = host ? host->at.x : 0, y = host ? host->at.y : 0, squares[SB_ENTITIES];
    bool is_wanted[SB_ENTITIES] = {false}, is_shown[SB_ENTITIES] = {false};
    int32_t seen = 0;
    for (int32_t i = 0; i < scenario_tables.entity_count; ++i) {
        const sb_actor *actor = &self->board.actors[i];
        double dx = actor->at.x - x, dy = actor->at.y - y;
        is_wanted[i] = actor->is_present && !actor->is_hidden && i != scenario_tables.host;
        squares[i] = dx * dx + dy * dy;
        seen += is_wanted[i];
    }
    for (; seen > SCENARIO_MOVERS; --seen) {
        int32_t farthest = SB_NONE;
        for (int32_t i = 0; i < scenario_tables.entity_count; ++i) {
            if (is_wanted[i] && (farthest == SB_NONE || squares[i] >= squares[farthest])) farthest = i;
        }
        is_wanted[farthest] = false;
    }
    for (int32_t k = 0; k < SCENARIO_MOVERS; ++k) {
        int32_t i = self->shown[k];
        if (i != SB_NONE && !is_wanted[i]) self->shown[k] = i = SB_NONE;
        if (i != SB_NONE) is_shown[i] = true;
    }
    for (int32_t k = 0, i = 0; k < SCENARIO_MOVERS; ++k) {
        if (self->shown[k] == SB_NONE) {
            while (i < scenario_tables.entity_count && !(is_wanted[i] && !is_shown[i])) ++i;
            if (i < scenario_tables.entity_count) self->shown[k] = i++;
        }
        self->out.movers[k] = self->shown[k] == SB_NONE ? (scenario_mover){0} : self->out.everyone[self->shown[k]];
    }
}

/* On a dry road, road users do as the scenario states. */
static void feel(scenario *self) {
    double loss = self->in.surface.friction_loss;
    self->board.grip = loss > 0 ? GRAVITY * fmax(1 - loss, 0.01) : 0;
}

static void output(scenario *self) {
    for (int32_t i = 0; i < scenario_tables.entity_count && i < SCENARIO_SEEN; ++i) self->out.everyone[i] = mover_of(self, i);
    show_nearest(self);
    for (int32_t i = 0; i < scenario_tables.element_count && i < SCENARIO_STATES; ++i) {
        self->out.states[i] = self->board.progress[i].state;
    }
    self->out.ended = self->board.has_ended;
    if (!self->is_undefined) return;
    self->out.movers[0].station = NAN;
    for (int32_t i = 0; i < scenario_tables.entity_count && i < SCENARIO_SEEN; ++i) self->out.everyone[i].station = NAN;
}

void scenario_init(scenario *self) {
    self->is_undefined = false;
    scenario_numbers(self);
    self->board.has_host = !self->par.drives_host && scenario_tables.host != SB_NONE;
    for (int32_t k = 0; k < SCENARIO_MOVERS; ++k) self->shown[k] = SB_NONE;
    feel(self);
    storyboard_begin(&self->board);
    const sb_actor *host = host_of(self);
    if (host) {
        double shift = host_shift(self);
        self->out.host_start.given = true;
        self->out.host_start.x = host->at.x + shift * host->cosine;
        self->out.host_start.y = host->at.y + shift * host->sine;
        self->out.host_start.heading = host->at.heading;
        self->out.host_start.speed = host->speed;
    }
    output(self);
}

void scenario_step(scenario *self, double h) {
    sb_actor *host = host_of(self);
    if (self->board.has_host) {
        double shift = host_shift(self);
        host->at.heading = self->in.motion.heading;
        storyboard_face(host);
        host->at.x = self->in.motion.x - shift * host->cosine;
        host->at.y = self->in.motion.y - shift * host->sine;
        host->speed = self->in.motion.speed;
        host->acceleration = self->in.motion.acceleration;
    }
    feel(self);
    storyboard_step(&self->board, h);
    output(self);
}
