/* Where road users are, and where the positions of a scenario are. */
#include "storyboard.h"

#include <math.h>
#include <stddef.h>

#define PI 3.14159265358979323846

static const path_table *table_of(int32_t path) {
    return &road_tables.paths[path];
}

/* The last row of the lanes of a path before *s* for which *id* or *number* fits. */
static const sb_lane *row_of(int32_t path, double s, int32_t wanted, bool by_id) {
    const sb_lane *found = NULL;
    for (int32_t i = 0; i < scenario_tables.lane_count; ++i) {
        const sb_lane *row = &scenario_tables.lanes[i];
        if (row->path != path || (by_id ? row->id : row->number) != wanted) continue;
        if (found && row->start > s) break;
        found = row;
    }
    return found;
}

int32_t place_lane(int32_t path, double s, int32_t id) {
    const sb_lane *row = row_of(path, s, id, true);
    return row ? row->number : 0;
}

int32_t place_sense(int32_t path, double s, int32_t number) {
    const sb_lane *row = row_of(path, s, number, false);
    return row ? row->sense : 1;
}

/* A lane that the path does not have is NaN and ends the run by name. */
static path_jet middle_at(const path_table *path, path_place place, int32_t number) {
    const path_lane *lane = path_find_lane(path, number);
    return lane ? path_value(place, lane->middle) : (path_jet){NAN, NAN, NAN};
}

int32_t place_road(int32_t path, double s) {
    const sb_lane *row = row_of(path, s, 0, false);
    return row ? row->road : 1;
}

double place_middle(int32_t path, double s, int32_t lane, int32_t near) {
    return middle_at(table_of(path), path_find(table_of(path), s, near), lane).value;
}

static bool is_in_lane(const path_table *path, path_place place, double t) {
    for (int32_t i = 0; i < path->lane_count; ++i) {
        double width = path_value(place, path->lanes[i].width).value;
        if (fabs(t - path_value(place, path->lanes[i].middle).value) <= 0.5 * width && place.beyond == 0 && width > 0) return true;
    }
    return false;
}

bool place_is_on_road(const sb_place *place) {
    if (place->path != SB_NONE) return is_in_lane(table_of(place->path), path_find(table_of(place->path), place->s, 0), place->t);
    for (int32_t i = 0; i < road_tables.count; ++i) {
        path_foot foot = foot_of_all(table_of(i), place->x, place->y);
        if (is_in_lane(table_of(i), foot.line.place, foot.t)) return true;
    }
    return false;
}

double place_lay(sb_place *place, int32_t *piece) {
    if (place->path == SB_NONE) return 1;
    const path_table *path = table_of(place->path);
    path_place at = path_find(path, place->s, *piece);
    path_line line = path_line_at(at);
    path_jet t = middle_at(path, at, place->lane);
    t.value += place->offset;
    place->t = t.value;
    path_beside beside = path_beside_at(&line, t);
    *piece = at.piece;
    place->x = beside.x;
    place->y = beside.y;
    place->heading = atan2(line.ty * beside.ahead + line.tx * beside.aside, line.tx * beside.ahead - line.ty * beside.aside) +
                     (place->sense < 0 ? PI : 0) + place->turn;
    return beside.length;
}

void place_on_path(sb_place *place, int32_t number, int32_t *piece) {
    const path_table *path = table_of(number);
    path_foot foot;
    bool is_near = place->path == number && foot_from(path, place->x, place->y, place->s, *piece, &foot);
    if (!is_near) foot = foot_of_all(path, place->x, place->y);
    double best = HUGE_VAL;
    for (int32_t i = 0; i < path->lane_count; ++i) {
        double width = path_value(foot.line.place, path->lanes[i].width).value;
        double offset = foot.t - path_value(foot.line.place, path->lanes[i].middle).value;
        double outside = width > 0 ? fabs(offset) - 0.5 * width : HUGE_VAL;
        if (outside < best) {
            best = outside;
            place->lane = path->lanes[i].number;
            place->offset = offset;
        }
    }
    double heading = place->heading;
    place->path = number;
    place->s = path_station(foot.line.place);
    place->t = foot.t;
    place->sense = cos(heading) * foot.line.tx + sin(heading) * foot.line.ty < 0 ? -1 : 1;
    place->turn = 0;
    *piece = foot.line.place.piece;
    sb_place straight = *place;
    place_lay(&straight, piece);
    place->turn = remainder(heading - straight.heading, 2 * PI);
}

static double value(const storyboard *board, int32_t number) {
    return board->values[number];
}

/* A place on a path by its station and its distance to the left of the reference line. */
static sb_place at_t(int32_t path, double s, double t, int32_t sense) {
    sb_place place = {.path = path, .s = s, .lane = 0, .sense = sense};
    int32_t piece = 0;
    place.offset = t - place_middle(path, s, 0, 0);
    place_lay(&place, &piece);
    double heading = place.heading;
    place_on_path(&place, path, &piece);
    place.sense = sense;
    place.turn = 0;
    place.heading = heading;
    return place;
}

static sb_place on_trajectory(storyboard *board, const sb_position *position, const double *given) {
    sb_point point = trajectory_at(board, position->trajectory, given[0]);
    sb_place place = {.path = SB_NONE, .sense = 1};
    place.x = point.x - given[1] * sin(point.heading);
    place.y = point.y + given[1] * cos(point.heading);
    place.heading = point.heading;
    return place;
}

static sb_place before_heading(storyboard *board, const sb_position *position) {
    double given[2] = {value(board, position->numbers[0]), value(board, position->numbers[1])};
    sb_place place = {.path = SB_NONE, .sense = 1};
    int32_t piece = 0;
    const sb_place *other = position->entity == SB_NONE ? &place : &board->actors[position->entity].at;
    switch (position->kind) {
    case AT_LANE:
        place.path = position->path;
        place.s = position->base + position->sense * given[0];
        place.lane = place_lane(place.path, place.s, position->lane);
        place.sense = place_sense(place.path, place.s, place.lane);
        place.offset = given[1] * place_road(place.path, place.s);
        place_lay(&place, &piece);
        return place;
    case AT_ROAD: {
        double s = position->base + position->sense * given[0];
        int32_t sense = place_road(position->path, s);
        return at_t(position->path, s, sense * given[1], sense);
    }
    case AT_WORLD:
        place.x = given[0];
        place.y = given[1];
        return place;
    case BY_LANE:
    case BY_DRIVEN_LANE: {
        place = *other;
        if (place.path == SB_NONE) return place;
        int32_t sense = position->kind == BY_LANE ? place_road(place.path, place.s) : place.sense;
        int32_t against = place.sense * place_sense(place.path, place.s, place.lane);
        place.s += sense * given[0];
        place.lane += sense * position->lane;
        place.sense = against * place_sense(place.path, place.s, place.lane);
        place.offset = given[1] * sense;
        place.turn = 0;
        place_lay(&place, &piece);
        return place;
    }
    case BY_ROAD: {
        place = *other;
        if (place.path == SB_NONE) return place;
        int32_t sense = place_road(place.path, place.s);
        return at_t(place.path, place.s + sense * given[0],
                    place_middle(place.path, place.s, place.lane, 0) + place.offset + sense * given[1], sense);
    }
    case BY_OBJECT:
        place.heading = other->heading;
        place.x = other->x + given[0] * cos(other->heading) - given[1] * sin(other->heading);
        place.y = other->y + given[0] * sin(other->heading) + given[1] * cos(other->heading);
        return place;
    case BY_WORLD:
        place.x = other->x + given[0];
        place.y = other->y + given[1];
        return place;
    default: return on_trajectory(board, position, given);
    }
}

sb_place place_of(storyboard *board, int32_t number, int32_t actor) {
    const sb_position *position = &scenario_tables.positions[number];
    sb_place place = before_heading(board, position);
    int32_t own = actor == SB_NONE ? SB_NONE : scenario_tables.entities[actor].path, piece = 0;
    double heading = value(board, position->heading);
    bool is_by_entity = position->kind == BY_OBJECT || position->kind == BY_WORLD;
    if (!position->is_relative && (position->has_heading || position->kind == AT_WORLD)) {
        place.turn += heading - place.heading;
        place.heading = heading;
    } else if (position->kind == BY_WORLD) {
        place.heading = board->actors[position->entity].at.heading + heading;
    } else {
        place.turn += heading;
        place.heading += heading;
    }
    if (place.path == SB_NONE && is_by_entity && own == SB_NONE) own = board->actors[position->entity].at.path;
    if (place.path == SB_NONE ? own != SB_NONE && position->kind != ON_TRAJECTORY : own != SB_NONE && own != place.path) {
        double sought = place.heading;
        place_on_path(&place, own, &piece);
        place.heading = sought;
    } else if (place.path != SB_NONE && cos(place.turn) < 0) {
        place.sense = -place.sense;
        place.turn += PI;
    }
    place.turn = remainder(place.turn, 2 * PI);
    return place;
}

int32_t next_trailer(const bool is_moved[SB_ENTITIES]) {
    for (int32_t i = 0; i < scenario_tables.entity_count; ++i) {
        int32_t tow = scenario_tables.entities[i].tow;
        if (tow != SB_NONE && is_moved[tow] && !is_moved[i]) return i;
    }
    return SB_NONE;
}

void place_trailer(storyboard *board, int32_t trailer, bool is_straight) {
    const sb_entity *entity = &scenario_tables.entities[trailer];
    const sb_actor *tow = &board->actors[entity->tow];
    sb_actor *actor = &board->actors[trailer];
    double c = cos(tow->at.heading), s = sin(tow->at.heading);
    double x = tow->at.x + entity->hitch * c, y = tow->at.y + entity->hitch * s;
    double away = hypot(x - actor->at.x, y - actor->at.y);
    bool is_led = !is_straight && actor->is_present && away > 0;
    double heading = is_led ? atan2(y - actor->at.y, x - actor->at.x) : tow->at.heading;
    actor->at = (sb_place){.path = SB_NONE, .sense = 1, .heading = heading};
    actor->at.x = x - entity->coupler * cos(heading);
    actor->at.y = y - entity->coupler * sin(heading);
    actor->is_present = tow->is_present;
    actor->speed = tow->speed;
}
