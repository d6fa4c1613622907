#include "road.h"

#include <math.h>
#include <stddef.h>

#include "foot.h"

#define PI 3.14159265358979323846
#define JUMP 10.0 /* m: what moves farther in a step was put there; its foot is looked for everywhere */
#define NOBODY 0
#define IN_PLANE -1
#define WINDING 2.0 /* by road over in the plane, from which on a path may pass over itself */
#define SAME_WIDTH 1e-9 /* m */
#define FARTHEST_LANE 1000
#define NO_LIGHT 0
#define UNLIT 1
#define SLACK 1e-9 /* s: a change of phase that is due now is not a step late */

/* Where the host is. */
typedef struct {
    const path_table *path;
    const path_lane *lane; /* NULL: its path has no such lane */
    path_foot foot;
    double tx, ty;         /* of its heading */
    double along, rate;    /* m along the middle of the path's own lane, m/s */
    path_jet middle;       /* of its lane */
    path_beside beside;
} host_place;

static double wrapped(double angle) {
    if (angle > -PI && angle <= PI) return angle;
    return angle - 2 * PI * ceil((angle - PI) / (2 * PI));
}

/* The foot near *station*, else of the whole path. */
static path_foot foot_near(const path_table *path, double x, double y, double station, int32_t piece) {
    path_foot foot;
    if (!foot_from(path, x, y, station, piece, &foot)) foot = foot_of_all(path, x, y);
    return foot;
}

/* Stations along the middle of the first lane that a velocity covers in a second. */
static double rate_along(const path_table *path, const path_foot *foot, double vx, double vy) {
    double nearness = 1 - foot->line.curvature * foot->t;
    return path_along(&path->lanes[0], foot->line.place).first * (vx * foot->line.tx + vy * foot->line.ty) /
           (foot->line.stretch * nearness);
}

static host_place place_host(road *self) {
    const road_motion *motion = &self->in.motion;
    const path_table *path = &road_tables.paths[0];
    host_place host = {.path = path, .lane = path_find_lane(path, self->par.start_lane)};
    double dx = motion->x - self->x, dy = motion->y - self->y;
    bool jumped = !(dx * dx + dy * dy <= JUMP * JUMP);
    double expected = self->station + dx * self->per_x + dy * self->per_y;
    host.foot = jumped ? foot_of_all(path, motion->x, motion->y)
                       : foot_near(path, motion->x, motion->y, expected, self->piece);
    const path_line *line = &host.foot.line;
    double per = 1 / (line->stretch * (1 - line->curvature * host.foot.t));
    self->x = motion->x;
    self->y = motion->y;
    self->per_x = per * line->tx;
    self->per_y = per * line->ty;
    self->station = path_station(host.foot.line.place);
    self->piece = host.foot.line.place.piece;
    host.tx = cos(motion->heading);
    host.ty = sin(motion->heading);
    double vx = motion->speed * host.tx - motion->lateral_speed * host.ty;
    double vy = motion->speed * host.ty + motion->lateral_speed * host.tx;
    host.along = path_along(&path->lanes[0], host.foot.line.place).value;
    host.rate = rate_along(path, &host.foot, vx, vy);
    path_jet nowhere = {NAN, NAN, NAN}; /* ends the run by name: there is no such lane */
    host.middle = host.lane ? path_value(host.foot.line.place, host.lane->middle) : nowhere;
    host.beside = path_beside_at(&host.foot.line, host.middle);
    return host;
}

/* The angle from a line's direction, that of the reference line turned by (ahead, aside), to the direction (tx, ty). */
static double angle_to(const path_line *line, const path_beside *beside, double tx, double ty) {
    double lx = line->tx * beside->ahead - line->ty * beside->aside;
    double ly = line->ty * beside->ahead + line->tx * beside->aside;
    return atan2(lx * ty - ly * tx, lx * tx + ly * ty);
}

typedef struct {
    double height, x, y, bank; /* m, slopes along the axes, rad */
} path_ground;

/* The road's surface *t* beside the line: each cross section is a straight line that the bank tilts. */
static path_ground ground_at(const path_table *path, const path_foot *foot) {
    path_ground ground = {0, 0, 0, 0};
    if (path->height.count == 0 && path->bank.count == 0) return ground;
    path_jet height = path_height(path, foot->line.place), bank = path_value(foot->line.place, path->bank);
    double cross = bank.value != 0 ? tan(bank.value) : 0, by_station = height.first + foot->t * bank.first * (1 + cross * cross);
    double along = by_station / (foot->line.stretch * (1 - foot->line.curvature * foot->t));
    ground.height = height.value + foot->t * cross;
    ground.x = along * foot->line.tx - cross * foot->line.ty;
    ground.y = along * foot->line.ty + cross * foot->line.tx;
    ground.bank = bank.value;
    return ground;
}

/* Of patches that lie on each other the last one is on top; beside the lanes it is as on the one that is nearest. */
static double friction_at(const path_table *path, const path_foot *foot) {
    double station = path_station(foot->line.place), friction = 1, nearest = HUGE_VAL;
    for (int32_t i = path->patch_count - 1; i >= 0; --i) {
        const path_patch *patch = &path->patches[i];
        if (station >= patch->start && station <= patch->end && foot->t >= patch->right && foot->t <= patch->left) {
            return patch->friction;
        }
    }
    if (!path->has_slippery_lanes) return 1;
    for (int32_t i = 0; i < path->lane_count; ++i) {
        const path_lane *lane = &path->lanes[i];
        double width = path_value(foot->line.place, lane->width).value;
        double beside = fabs(foot->t - path_value(foot->line.place, lane->middle).value) - 0.5 * width;
        if (width > 0 && beside < nearest) {
            nearest = beside;
            friction = 1 - path_value(foot->line.place, lane->slipperiness).value;
        }
    }
    return friction;
}

static void tell_ground(road *self, const host_place *host) {
    const path_table *path = host->path;
    for (int32_t i = 0; i < ROAD_WHEELS; ++i) {
        double x = self->in.contacts[i].x, y = self->in.contacts[i].y;
        /* From the host's foot as if the line went on straight, or in a circle as far as the wheel is aside. */
        const path_line *line = &host->foot.line;
        double dx = x - line->x, dy = y - line->y, aside = dy * line->tx - dx * line->ty;
        double expected = self->station + (dx * line->tx + dy * line->ty) / (1 - line->curvature * aside);
        path_foot foot = foot_near(path, x, y, expected, self->piece);
        path_ground ground = ground_at(path, &foot);
        self->out.ground[i].height = ground.height;
        self->out.ground[i].slope_x = ground.x;
        self->out.ground[i].slope_y = ground.y;
        self->out.ground[i].friction = friction_at(path, &foot) * (1 - self->in.surface.friction_loss);
    }
}

static bool is_on_road(const host_place *host) {
    if (host->foot.line.place.beyond != 0) return false;
    double right = HUGE_VAL, left = -HUGE_VAL;
    for (int32_t i = 0; i < host->path->lane_count; ++i) {
        const path_lane *lane = &host->path->lanes[i];
        double middle = path_value(host->foot.line.place, lane->middle).value;
        double half = 0.5 * path_value(host->foot.line.place, lane->width).value;
        right = fmin(right, middle - half);
        left = fmax(left, middle + half);
    }
    return right <= host->foot.t && host->foot.t <= left;
}

static void tell_lane(road *self, const host_place *host) {
    const path_line *line = &host->foot.line;
    const path_beside *beside = &host->beside;
    path_foot below = host->foot;
    below.t = host->middle.value;
    path_ground ground = ground_at(host->path, &below);
    double lx = line->tx * beside->ahead - line->ty * beside->aside;
    double ly = line->ty * beside->ahead + line->tx * beside->aside;
    self->out.lane.station = host->along;
    self->out.lane.offset = host->foot.t - host->middle.value;
    self->out.lane.heading = angle_to(line, beside, host->tx, host->ty);
    self->out.lane.curvature = beside->curvature;
    self->out.lane.width = host->lane ? path_value(host->foot.line.place, host->lane->width).value : NAN;
    self->out.lane.grade = (ground.x * lx + ground.y * ly) / beside->length;
    self->out.lane.bank = ground.bank;
    self->out.lane.speed_limit = path_value(host->foot.line.place, host->path->limit).value;
    self->out.lane.on_road = is_on_road(host);
}

/* Points at equal distances along the middle of the lane. */
static void tell_preview(road *self, const host_place *host) {
    double spacing = self->par.preview_spacing;
    if (!(spacing > 0) || !host->lane) return;
    double along = path_along(host->lane, host->foot.line.place).value;
    int32_t piece = self->piece;
    for (int32_t i = 0; i < ROAD_PREVIEW; ++i) {
        double distance = (i + 1) * spacing;
        path_place place = path_find_along(host->path, host->lane, along + distance, piece);
        path_line line = path_line_at(place);
        path_beside beside = path_beside_at(&line, path_value(place, host->lane->middle));
        double dx = beside.x - self->in.motion.x, dy = beside.y - self->in.motion.y;
        self->out.preview[i].distance = distance;
        self->out.preview[i].x = host->tx * dx + host->ty * dy;
        self->out.preview[i].y = host->tx * dy - host->ty * dx;
        self->out.preview[i].heading = -angle_to(&line, &beside, host->tx, host->ty);
        self->out.preview[i].curvature = beside.curvature;
        piece = place.piece;
    }
}

/* Stations ahead of the host's; on a closed path at most half way round. */
static double ahead_of(const host_place *host, double along) {
    double ahead = along - host->along;
    if (!host->path->closed) return ahead;
    double whole = path_whole_length(host->path, &host->path->lanes[0]);
    return ahead - whole * rint(ahead / whole);
}

/* How far the road of *actor* is above that of the host, 0 on one level. Either the host's road passes over or under it,
 * at *foot*, of whose lanes it is some m aside; or the host's road does so before it, where the host is now: then it is
 * near, although far along the road. */
static double above(const road *self, const host_place *host, const road_actor *actor, const path_foot *foot) {
    if (actor->z == 0 && host->path->height.count == 0 && host->path->bank.count == 0) return 0;
    const path_rule *rule = &road_tables.rule;
    double aside = HUGE_VAL, over = actor->z - ground_at(host->path, foot).height;
    for (int32_t k = 0; k < host->path->lane_count; ++k) {
        const path_lane *lane = &host->path->lanes[k];
        double half = 0.5 * path_value(foot->line.place, lane->width).value;
        aside = fmin(aside, fabs(foot->t - path_value(foot->line.place, lane->middle).value) - half);
    }
    aside = fmax(aside, 0) + fabs(foot->line.place.beyond);
    if (fabs(over) >= rule->level + rule->steepest * aside) return over;
    double dx = actor->x - self->in.motion.x, dy = actor->y - self->in.motion.y, away = sqrt(dx * dx + dy * dy);
    over = actor->z - ground_at(host->path, &host->foot).height;
    bool is_near = fabs(actor->ahead) > WINDING * away + JUMP;
    return is_near && fabs(over) >= rule->level + rule->steepest * away ? over : 0;
}

/* Seen from the host's lane, who is on another path. */
static void cross(road *self, const host_place *host, int32_t i, double vx, double vy) {
    road_actor *actor = &self->out.actors[i];
    path_foot foot = self->crosses[i] ? foot_near(host->path, actor->x, actor->y, self->crossing_stations[i],
                                                  self->crossing_pieces[i])
                                      : foot_of_all(host->path, actor->x, actor->y);
    self->crosses[i] = true;
    self->crossing_stations[i] = path_station(foot.line.place);
    self->crossing_pieces[i] = foot.line.place.piece;
    actor->ahead = ahead_of(host, path_along(&host->path->lanes[0], foot.line.place).value);
    actor->aside = foot.t - (host->lane ? path_value(foot.line.place, host->lane->middle).value : NAN);
    actor->approach = host->rate - rate_along(host->path, &foot, vx, vy);
    if (actor->path != IN_PLANE) actor->above = above(self, host, actor, &foot);
}

/* A mover in the plane has the place that it states; its lane is seen from the host's path. */
static void place_in_plane(road *self, const host_place *host, int32_t i) {
    const road_mover *mover = &self->in.movers[i];
    road_actor *actor = &self->out.actors[i];
    double c = cos(mover->turn), s = sin(mover->turn);
    actor->x = mover->station;
    actor->y = mover->offset;
    actor->heading = wrapped(mover->turn);
    actor->speed = mover->speed;
    actor->lateral_speed = mover->lateral_speed;
    cross(self, host, i, mover->speed * c - mover->lateral_speed * s, mover->speed * s + mover->lateral_speed * c);
    path_foot foot;
    path_place place = path_find(host->path, self->crossing_stations[i], self->crossing_pieces[i]);
    foot.line = path_line_at(place);
    foot.t = actor->aside + (host->lane ? path_value(place, host->lane->middle).value : NAN);
    actor->z = ground_at(host->path, &foot).height;
    actor->station = path_along(&host->path->lanes[0], place).value;
    double nearest = HUGE_VAL;
    for (int32_t k = 0; k < host->path->lane_count; ++k) {
        double offset = foot.t - path_value(place, host->path->lanes[k].middle).value;
        if (fabs(offset) >= nearest) continue;
        nearest = fabs(offset);
        actor->lane = host->path->lanes[k].number;
        actor->offset = offset;
    }
}

/* Of a lane, or between two lanes. Not a number if the path does not have them: that ends the run by name. */
static path_jet middle_of(const path_table *path, path_place place, double number) {
    double right = floor(number), share = number - right;
    const path_lane *lane = fabs(right) <= FARTHEST_LANE ? path_find_lane(path, (int32_t)right) : NULL;
    const path_lane *next = lane && share > 0 ? path_find_lane(path, (int32_t)right + 1) : lane;
    if (!next) return (path_jet){NAN, NAN, NAN};
    path_jet one = path_value(place, lane->middle), other = path_value(place, next->middle);
    one.value += share * (other.value - one.value);
    one.first += share * (other.first - one.first);
    one.second += share * (other.second - one.second);
    return one;
}

static double height_of(const road_mover *mover) {
    bool is_known = mover->class > 0 && mover->class < road_tables.rule.height_count;
    return mover->height != 0 || !is_known ? mover->height : road_tables.rule.heights[mover->class];
}

static void place_actor(road *self, const host_place *host, int32_t i) {
    const road_mover *mover = &self->in.movers[i];
    road_actor *actor = &self->out.actors[i];
    road_actor nobody = {0};
    *actor = nobody;
    if (mover->class == NOBODY) {
        self->crosses[i] = false;
        return;
    }
    actor->id = mover->id;
    actor->class = mover->class;
    actor->length = mover->length;
    actor->width = mover->width;
    actor->height = height_of(mover);
    actor->clearance = mover->clearance;
    actor->acceleration = mover->acceleration;
    actor->path = mover->path;
    if (mover->path == IN_PLANE) {
        place_in_plane(self, host, i);
        return;
    }
    bool is_known = mover->path >= 0 && mover->path < road_tables.count;
    const path_table *path = &road_tables.paths[is_known ? mover->path : 0];
    path_place place = path_find_along(path, &path->lanes[0], mover->station, self->mover_pieces[i]);
    path_line line = path_line_at(place);
    path_jet t = middle_of(path, place, is_known ? mover->lane : NAN);
    t.value += mover->offset;
    path_beside beside = path_beside_at(&line, t);
    path_foot foot = {line, t.value};
    /* The mover's speed covers stations of the own lane; here they are shorter or longer. */
    double turned = mover->turn != 0, c = turned ? cos(mover->turn) : 1, s = turned ? sin(mover->turn) : 0;
    double rate = mover->speed * c - mover->lateral_speed * s;
    double along = rate * beside.length / path_along(&path->lanes[0], place).first;
    double across = mover->speed * s + mover->lateral_speed * c;
    double lx = (line.tx * beside.ahead - line.ty * beside.aside) / beside.length;
    double ly = (line.ty * beside.ahead + line.tx * beside.aside) / beside.length;
    actor->x = beside.x;
    actor->y = beside.y;
    actor->z = ground_at(path, &foot).height;
    actor->heading = wrapped(atan2(ly, lx) + mover->turn);
    actor->speed = along * c + across * s;
    actor->lateral_speed = across * c - along * s;
    actor->station = mover->station;
    actor->offset = mover->offset;
    if (!isnan(t.value)) {
        double nearest = rint(mover->lane);
        actor->lane = (int32_t)nearest;
        if (nearest != mover->lane) actor->offset = t.value - middle_of(path, place, nearest).value;
    }
    self->mover_pieces[i] = place.piece;
    if (mover->path == 0) {
        self->crosses[i] = false;
        actor->ahead = ahead_of(host, mover->station);
        actor->aside = t.value - (host->lane ? path_value(place, host->lane->middle).value : NAN);
        actor->approach = host->rate - rate;
        actor->above = above(self, host, actor, &foot);
    } else {
        cross(self, host, i, along * lx - across * ly, along * ly + across * lx);
    }
}

typedef struct {
    int32_t colour;
    double remaining;
} shown;

/* What a light shows now: one without phases is there, and unlit. */
static shown show(const road *self, const path_light *light) {
    if (light->phase_count == 0) return (shown){UNLIT, 0};
    double time = self->base_time + (double)self->steps * self->step + SLACK - light->shift + self->in.clock_offset;
    double into = time - light->cycle * floor(time / light->cycle);
    const path_phase *phase = light->phases, *last = phase + light->phase_count - 1;
    for (; phase < last && into >= phase->seconds; ++phase) into -= phase->seconds;
    return (shown){phase->colour, fmax(phase->seconds - into + SLACK, 0)};
}

/* The nearest one ahead. */
static void tell_light(road *self, const host_place *host) {
    const path_light *nearest = NULL;
    double distance = HUGE_VAL;
    for (int32_t i = 0; i < host->path->light_count; ++i) {
        double ahead = ahead_of(host, host->path->lights[i].along);
        if (ahead >= 0 && ahead < distance) {
            nearest = &host->path->lights[i];
            distance = ahead;
        }
    }
    shown now = nearest ? show(self, nearest) : (shown){NO_LIGHT, 0};
    self->out.light.distance = nearest ? distance : 0;
    self->out.light.colour = now.colour;
    self->out.light.remaining = now.remaining;
}

/* Path after path; python sees to it that there is room for all. */
static void tell_light_heads(road *self) {
    int32_t row = 0;
    for (int32_t i = 0; i < road_tables.count; ++i) {
        const path_table *path = &road_tables.paths[i];
        for (int32_t k = 0; k < path->light_count && row < ROAD_LIGHTS; ++k, ++row) {
            shown now = show(self, &path->lights[k]);
            self->out.light_heads[row].path = i;
            self->out.light_heads[row].station = path->lights[k].along;
            self->out.light_heads[row].colour = now.colour;
            self->out.light_heads[row].remaining = now.remaining;
        }
    }
}

/* The lanes of a path from the rightmost on, where it begins. Lanes of one width are that far apart, to the last bit. */
static void tell_lanes(road *self, int32_t i) {
    const path_table *path = &road_tables.paths[i];
    path_place start = path_find(path, 0, 0);
    double own = path_value(start, path->lanes[0].width).value, middle = path_value(start, path->lanes[0].middle).value;
    bool is_even = true;
    for (int32_t k = path->rightmost; k <= path->leftmost; ++k) {
        const path_lane *lane = path_find_lane(path, k);
        if (lane) is_even = is_even && fabs(path_value(start, lane->width).value - own) < SAME_WIDTH;
    }
    for (int32_t k = 0; k < ROAD_LANES && k + path->rightmost <= path->leftmost; ++k) {
        int32_t number = k + path->rightmost;
        const path_lane *lane = path_find_lane(path, number);
        if (!lane) continue;
        double apart = path_value(start, lane->middle).value - middle;
        self->out.paths[i].lanes[k].middle = is_even ? number * own : apart;
        self->out.paths[i].lanes[k].width = path_value(start, lane->width).value;
        self->out.paths[i].lanes[k].users = lane->users;
    }
}

/* What stays as it is. */
static void tell_network(road *self) {
    for (int32_t i = 0; i < road_tables.count && i < ROAD_PATHS; ++i) {
        const path_table *path = &road_tables.paths[i];
        self->out.paths[i].length = path_whole_length(path, &path->lanes[0]);
        self->out.paths[i].closed = path->closed;
        self->out.paths[i].leftmost = path->leftmost;
        self->out.paths[i].rightmost = path->rightmost;
        self->out.paths[i].lane_width = path_value(path_find(path, 0, 0), path->lanes[0].width).value;
        tell_lanes(self, i);
    }
    for (int32_t i = 0; i < road_tables.conflict_count && i < ROAD_CONFLICTS; ++i) {
        const path_conflict *conflict = &road_tables.conflicts[i];
        self->out.conflicts[i].path = conflict->path;
        self->out.conflicts[i].entry = conflict->entry;
        self->out.conflicts[i].exit = conflict->exit;
        self->out.conflicts[i].other_path = conflict->other_path;
        self->out.conflicts[i].other_entry = conflict->other_entry;
        self->out.conflicts[i].other_exit = conflict->other_exit;
        self->out.conflicts[i].gives_way = conflict->gives_way;
    }
}

static void output(road *self) {
    host_place host = place_host(self);
    tell_light(self, &host);
    tell_light_heads(self);
    tell_ground(self, &host);
    tell_lane(self, &host);
    tell_preview(self, &host);
    for (int32_t i = 0; i < ROAD_ACTORS; ++i) place_actor(self, &host, i);
}

void road_init(road *self) {
    const path_table *path = &road_tables.paths[0];
    const path_lane *lane = path_find_lane(path, self->par.start_lane);
    path_place place = path_find_along(path, &path->lanes[0], self->par.start_station, 0);
    path_line line = path_line_at(place);
    path_jet t = lane ? path_value(place, lane->middle) : (path_jet){NAN, NAN, NAN}; /* ends the run by name */
    t.value += self->par.start_offset;
    path_beside beside = path_beside_at(&line, t);
    self->out.start.x = beside.x;
    self->out.start.y = beside.y;
    self->out.start.heading = atan2(line.ty * beside.ahead + line.tx * beside.aside,
                                    line.tx * beside.ahead - line.ty * beside.aside);
    if (self->in.host_start.given) {
        self->out.start.x = self->in.host_start.x;
        self->out.start.y = self->in.host_start.y;
        self->out.start.heading = self->in.host_start.heading;
    }
    self->x = beside.x;
    self->y = beside.y;
    self->station = path_station(place);
    self->piece = place.piece;
    self->per_x = self->per_y = 0;
    for (int32_t i = 0; i < ROAD_ACTORS; ++i) {
        self->mover_pieces[i] = 0;
        self->crosses[i] = false;
    }
    self->base_time = 0;
    self->step = 0;
    self->steps = 0;
    tell_network(self);
    output(self);
}

void road_step(road *self, double h) {
    if (h != self->step) {
        self->base_time += (double)self->steps * self->step;
        self->step = h;
        self->steps = 0;
    }
    self->steps += 1;
    output(self);
}
