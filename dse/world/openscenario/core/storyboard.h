/* The storyboard of a scenario as tables, and the road users that it moves.
 *
 * dse writes the tables and a function that computes their numbers from the scenario's parameters; a number in a table
 * is an index of these. Each step: triggers are evaluated on the state that the last step left, actions start and
 * advance, then the time, and the road users move. A road user is either on a path (a station of its reference
 * line, a lane and an offset from the lane's middle), on a trajectory, or free in the plane.
 */
#ifndef STORYBOARD_H
#define STORYBOARD_H

#include "foot.h"
#include "scenario_sizes.h"

#define SB_NONE (-1)

/* Lanes of a path: from station *start* on, the lane *id* of the road is number *number*; *sense* 1: it is driven along
 * the path; *road* 1: the stations of the road increase along the path. */
typedef struct {
    int32_t path;
    double start;
    int32_t id, number, sense, road;
} sb_lane;

/* From *station* on a lane of *path* goes on in the path *to*, of which it is lane 0. */
typedef struct {
    int32_t path;
    double station;
    int32_t lane, to;
} sb_branch;

typedef struct {
    int32_t class; /* of actor_class */
    int32_t path;  /* SB_NONE: free in the plane */
    double length, width, height, centre_x, centre_y; /* m; of its box seen from its reference point */
    double top_speed, top_acceleration, top_deceleration; /* <= 0: no limit */
    int32_t tow; /* who draws it at its *hitch*, SB_NONE: nobody; the coupler is that far ahead of its own axle */
    double hitch, coupler;
} sb_entity;

enum { AT_LANE, AT_ROAD, AT_WORLD, BY_LANE, BY_DRIVEN_LANE, BY_ROAD, BY_OBJECT, BY_WORLD, ON_TRAJECTORY };

/* numbers: AT_LANE s, offset; AT_ROAD s, t; AT_WORLD x, y; BY_LANE ds, offset; BY_ROAD ds, dt; BY_OBJECT and BY_WORLD
 * dx, dy; ON_TRAJECTORY s, t. A station of the path is base + sense * s. */
typedef struct {
    int32_t kind, entity, path;
    double base;
    int32_t sense, lane; /* id of AT_LANE, difference of BY_LANE */
    int32_t trajectory, numbers[2], heading;
    bool has_heading, is_relative; /* to the lane, the road or the entity */
} sb_position;

enum { POLYLINE, CLOTHOIDS, NURBS };

/* POLYLINE: a vertex has a time and a position. CLOTHOIDS: a first vertex with a position, SB_NONE: that of the road
 * user, then for each segment the
 * numbers curvature at its start, curvature at its end, length, turn of the heading at its start. NURBS: control points
 * with weights. */
typedef struct {
    int32_t time, position, numbers[4];
} sb_vertex;

typedef struct {
    int32_t kind, vertex, vertices, point, points, order, knot, knots;
    bool is_closed, is_timed;
} sb_trajectory;

enum { STEP, LINEAR, CUBIC, SINUSOIDAL };       /* shapes */
enum { BY_TIME, BY_RATE, BY_DISTANCE };         /* dimensions */
enum { LATERAL = 1, LONGITUDINAL = 2, BOTH = 3 }; /* what an action controls */

enum {
    DO_NOTHING, DO_SPEED, DO_SPEED_PROFILE, DO_LONGITUDINAL_DISTANCE, DO_LANE_CHANGE, DO_LANE_OFFSET,
    DO_LATERAL_DISTANCE, DO_TELEPORT, DO_TRAJECTORY, DO_SYNCHRONIZE, DO_ROUTE, DO_ADD, DO_DELETE, DO_SET, DO_INCREASE,
    DO_MULTIPLY, DO_SEE, DO_CLOCK, DO_PHASE,
};

enum { /* flags of actions */
    IS_FACTOR = 1, IS_CONTINUOUS = 2, IS_TIME_GAP = 4, IS_FREESPACE = 8, IS_LEADING = 16, IS_TRAILING = 32,
    IS_TIMED = 64, IS_RELATIVE_TIME = 128, HAS_FINAL_SPEED = 256, STEADY_TIME = 512, STEADY_DISTANCE = 1024,
    HAS_LIMITS = 2048, IS_HIDDEN = 4096, IS_ALONG_ROAD = 8192, IS_ACCELERATED = 16384,
};

/* numbers: speed: dynamics, target; profile: none, entries are (time, speed); longitudinal distance: distance or time
 * gap, acceleration, deceleration, speed; lane change: dynamics, target offset; lane offset: target, lateral
 * acceleration; lateral distance: distance, acceleration, deceleration, speed; trajectory: distance at its start,
 * scale, offset of its times; synchronize: final speed, time or distance of the steady state, tolerances of the master
 * and its own; variables: value; clock: the time of day; phase: none. */
typedef struct {
    int32_t kind, controls, actor, entity, position, other_position, shape, dimension, flags;
    int32_t target;        /* lane, trajectory, path, variable, first entry, controller */
    int32_t count;         /* of entries; number of the phase */
    int32_t numbers[4];
} sb_action;

enum {
    IF_TIME, IF_VARIABLE, IF_STATE, IF_SPEED, IF_RELATIVE_SPEED, IF_ACCELERATION, IF_STANDSTILL, IF_TRAVELLED, IF_REACHED,
    IF_DISTANCE, IF_RELATIVE_DISTANCE, IF_HEADWAY, IF_TIME_TO_COLLISION, IF_COLLISION, IF_END_OF_ROAD,
    IF_ANGLE, IF_RELATIVE_ANGLE, IF_CLEARANCE, IF_ALWAYS, IF_CLOCK, IF_OFF_ROAD,
};
enum { GREATER, LESS, EQUAL, GREATER_OR_EQUAL, LESS_OR_EQUAL, NOT_EQUAL }; /* rules */
enum { NO_EDGE, RISING, FALLING, RISING_OR_FALLING };
enum { LONGITUDINALLY, LATERALLY, EUCLIDIAN };                           /* distances */
enum { OF_ENTITY, OF_ROAD };                                             /* coordinate systems */

typedef struct {
    int32_t kind, edge, rule, delay;
    bool needs_all;            /* of the triggering entities */
    int32_t first, count;      /* of the triggering entities */
    int32_t entity, position, variable, element, state, distance, system, direction;
    bool is_freespace, takes_opposite;
    int32_t listed, listed_count; /* triggering: those that a clearance asks for, none: all */
    int32_t numbers[4];        /* value (or tolerance, duration), tolerance; of a clearance: ahead, behind, lanes */
} sb_condition;

/* *gap*: of conditions with the same distance from that entity; SB_NONE: there is none. */
typedef struct {
    int32_t entity, gap;
} sb_triggering;

/* A trigger is true if all conditions of one of its groups are. */
typedef struct {
    int32_t first, count;
} sb_range;

enum { STORY, ACT, GROUP, MANEUVER, EVENT, ACTION };
enum { OVERRIDE, SKIP, PARALLEL };

/* In the order of the file, each followed by what is in it, up to *end*. A trigger SB_NONE: there is none. */
typedef struct {
    int32_t kind, parent, end, start, stop, most, priority, action;
    bool is_chosen; /* its actor acts only if it fits a condition of the event's start trigger */
} sb_element;

enum { STANDBY, RUNNING, COMPLETE }; /* states */
enum { HAS_STARTED = 1, HAS_ENDED = 2, HAS_STOPPED = 4, HAS_SKIPPED = 8 }; /* transitions of a step */
enum { ON_STANDBY, ON_RUNNING, ON_COMPLETE, ON_START, ON_END, ON_STOP, ON_SKIP }; /* asked by a condition */

/* A controller of traffic signals shows one of its phases after the other. *variable* is the phase that it shows, *begun*
 * the number of the time at which the first one began; each of *states* is a variable and its number. */
typedef struct {
    int32_t variable, begun, phase, phases;
} sb_controller;

typedef struct {
    int32_t name, duration, state, states;
} sb_phase;

typedef struct {
    const sb_lane *lanes;
    const sb_branch *branches;
    const sb_entity *entities;
    const sb_position *positions;
    const sb_trajectory *trajectories;
    const sb_vertex *vertices;
    const int32_t *knots;
    const sb_action *actions;
    const int32_t (*entries)[2], (*states)[2];
    const sb_controller *controllers;
    const sb_phase *phases;
    const sb_condition *conditions;
    const sb_triggering *triggering;
    const sb_range *groups;     /* of conditions */
    const sb_range *triggers;   /* of groups */
    const sb_element *elements;
    int32_t lane_count, branch_count, entity_count, host, action_count, init_count, element_count, trajectory_count, condition_count,
        stop, variable_count, controller_count;
    double clock; /* time of day at the start, s */
    bool has_off_road; /* a condition asks for how long road users were off the road */
} sb_tables;

extern const sb_tables scenario_tables; /* written by dse for each scenario */

typedef struct {
    int32_t path;
    double s;
    int32_t lane, sense;
    double offset, turn; /* of its heading against the direction of travel */
    double t; /* to the left of the reference line of its path, when it was laid there */
    double x, y, heading;
} sb_place;

typedef struct {
    bool is_present, is_hidden;
    sb_place at;
    int32_t piece;
    double speed, acceleration, drift;          /* along its heading; offset per second */
    double travelled, standing, ended, off_road; /* m, s */
    double origin_x, origin_y;
    int32_t trajectory, slot;
    double along;                               /* of the trajectory */
    double laid_s, stretch;                     /* station that was laid last, m per station there */
    double cosine, sine;                        /* of its heading after a step */
    int32_t lateral, longitudinal;              /* actions that control it; SB_NONE: none */
} sb_actor;

typedef struct {
    bool is_running;
    int32_t phase;
    double progress, duration, from, to, begun, rate, way, masters;
} sb_run;

typedef struct {
    bool was, is_known, is_pending, was_seen;
    double since, until, fired;
} sb_memory;

/* How far ahead something is, since the *epoch* in which it was measured, and where it was found on the path. */
typedef struct {
    double value;
    int64_t epoch;
    double hint;
    int32_t piece;
} sb_gap;

typedef struct {
    double s, x, y, heading, time, speed; /* NaN: even between points, as their times say */
} sb_point;

typedef struct {
    int32_t state, count, changed, changing;
} sb_progress;

typedef struct {
    double values[SB_VALUES], variables[SB_VARIABLES];
    sb_actor actors[SB_ENTITIES];
    sb_run runs[SB_ACTIONS];
    sb_memory memories[SB_CONDITIONS];
    sb_gap gaps[SB_GAPS];
    sb_progress progress[SB_ELEMENTS];
    sb_point points[SB_POINTS];
    double base_time, step; /* the time is base_time + steps * step, never a sum of steps */
    double clock; /* s, of the day when the time was 0, or now if it does not run */
    bool is_clock_running;
    int32_t shown[SB_CONTROLLERS]; /* the phase of each controller */
    double since[SB_CONTROLLERS];
    int64_t steps, epoch; /* a new epoch begins where a road user may have moved */
    double now, h;
    double grip; /* m/s2 that the surface allows; 0: no limit */
    int32_t changes; /* 2: an element changes in this step, 1: in the last one */
    bool has_host, has_ended; /* the host is driven by somebody else; the stop trigger was true */
} storyboard;

/* Values and variables are set; the host's place is the scenario's. */
void storyboard_begin(storyboard *board);

/* Keeps the direction of a road user, after its heading was set. */
void storyboard_face(sb_actor *actor);

/* One step of *h* s, which ends now. */
void storyboard_step(storyboard *board, double h);

/* place.c */
/* Lays a place on its path in the plane; returns m per station there. */
double place_lay(sb_place *place, int32_t *piece);
sb_place place_of(storyboard *board, int32_t position, int32_t actor);
void place_on_path(sb_place *place, int32_t path, int32_t *piece);
int32_t place_lane(int32_t path, double s, int32_t id);
int32_t place_sense(int32_t path, double s, int32_t number);
int32_t place_road(int32_t path, double s);
/* Whether there is a lane of the path, or of any path if it is in the plane. */
bool place_is_on_road(const sb_place *place);
double place_middle(int32_t path, double s, int32_t lane, int32_t near);

/* The first trailer that was not moved, of those whose tow was; SB_NONE: there is none. */
int32_t next_trailer(const bool is_moved[SB_ENTITIES]);

/* A trailer that follows its tow, straight behind it or from where it is. */
void place_trailer(storyboard *board, int32_t trailer, bool is_straight);

/* trajectory.c */
void trajectory_lay(storyboard *board, int32_t trajectory, int32_t actor);
double trajectory_length(const storyboard *board, int32_t trajectory);
sb_point trajectory_at(const storyboard *board, int32_t trajectory, double s);
void trajectory_accelerate(storyboard *board, int32_t trajectory, double speed);
double trajectory_sense(int32_t trajectory, double speed);
void trajectory_put(const storyboard *board, int32_t trajectory, sb_actor *actor, double sense);
double trajectory_station(const storyboard *board, int32_t trajectory, double time);
double trajectory_foot(const storyboard *board, int32_t trajectory, double x, double y);

/* actions.c */
void action_begin(storyboard *board, int32_t action);
void action_advance(storyboard *board, int32_t action);
void action_end(storyboard *board, int32_t action);
void show_phase(storyboard *board, int32_t controller, int32_t phase, double since);

/* conditions.c */
bool trigger_is_true(storyboard *board, int32_t trigger);
bool has_triggered(storyboard *board, int32_t trigger, int32_t actor);
void trigger_forget(storyboard *board, int32_t trigger);
double gap_ahead(const storyboard *board, int32_t actor, int32_t other, double x, double y, sb_gap *gap, double *aside);

#endif
