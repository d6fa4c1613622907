/* The ways through a road network as tables: polynomials over the station, all of a path with the same pieces.
 *
 * A path is a reference line in the plane with, along it, height, bank, speed limit and lanes. A point on it has a
 * station s along the line and a distance t to its left. Beyond its ends a path that is not closed goes on straight,
 * with the grade, bank and lanes that it ends with.
 */
#ifndef PATH_H
#define PATH_H

#include <stdbool.h>
#include <stdint.h>

/* Where a quantity's coefficients begin in a row, and how many there are; none: it is zero all along. */
typedef struct {
    int32_t at, count;
} path_quantity;

typedef struct {
    int32_t number, users;       /* bits of the classes that may drive along all of it */
    path_quantity middle, width; /* m to the left of the reference line; m */
    path_quantity slipperiness;  /* 1 - friction against dry asphalt */
    path_quantity along;         /* length along its middle */
} path_lane;

/* Friction of its own between stations, and m to the left of the reference line. */
typedef struct {
    double start, end, right, left, friction;
} path_patch;

/* A traffic light, *along* the middle of the path's own lane; it shows one phase after the other from *shift* s on,
 * and nothing if it has none. Colours are counted as in the interface road. */
typedef struct {
    int32_t colour;
    double seconds;
} path_phase;

typedef struct {
    double along, shift, cycle;
    int32_t phase_count;
    const path_phase *phases;
} path_light;

typedef struct {
    double length;
    bool closed, has_slippery_lanes;
    int32_t pieces, stride; /* rows, and numbers in each: where it starts, x (6), y (6), then the quantities */
    const double *rows;
    path_quantity height, bank, limit;
    int32_t lane_count, patch_count, light_count, leftmost, rightmost;
    const path_lane *lanes;
    const path_patch *patches;
    const path_light *lights;
} path_table;

/* Where a path crosses or joins another one, along the middles of their own lanes. */
typedef struct {
    int32_t path;
    double entry, exit;
    int32_t other_path;
    double other_entry, other_exit;
    bool gives_way;
} path_conflict;

/* The rule of dse/world/in_the_way.py: heights by class, and which places are on one level. */
typedef struct {
    const double *heights; /* m, by class: of road users without a height of their own */
    int32_t height_count;
    double level, steepest; /* m of height between two levels; more of it by m aside */
} path_rule;

typedef struct {
    int32_t count, conflict_count;
    const path_table *paths;
    const path_conflict *conflicts;
    path_rule rule;
} road_network;

extern const road_network road_tables; /* written by dse for each road */

/* A place along a path: *u* after the start of a piece, and *beyond* the path's end (< 0: before its start). */
typedef struct {
    const double *row;
    double u, beyond;
    int32_t piece;
} path_place;

/* A value with its derivatives by the station. */
typedef struct {
    double value, first, second;
} path_jet;

/* The reference line at a place, with its derivatives by the station. */
typedef struct {
    double x[3], y[3];
} path_course;

/* The same as directions: tangent (tx, ty) of length 1; *stretch* is length per station, 1 to 1e-7. */
typedef struct {
    double x, y, tx, ty;
    double stretch, stretch_first, curvature;
    path_place place;
} path_line;

/* A line beside the reference line, *t* to its left: (ahead, aside) is its derivative by the station, seen from the
 * reference line. */
typedef struct {
    double x, y, ahead, aside;
    double length; /* per station */
    double curvature;
} path_beside;

/* The place at station *s*; *near* is a piece to begin looking at. On a closed path stations go round. */
path_place path_find(const path_table *path, double s, int32_t near);

/* The place at a distance along the middle of a lane. */
path_place path_find_along(const path_table *path, const path_lane *lane, double along, int32_t near);

/* The station of a place. */
double path_station(path_place place);

path_course path_course_at(path_place place);

path_line path_line_at(path_place place);

/* What does not go on beyond the ends: bank, lanes, speed limit. */
path_jet path_value(path_place place, path_quantity quantity);

path_jet path_height(const path_table *path, path_place place);

/* How far along the middle of a lane a place lies, and how far that is altogether. */
path_jet path_along(const path_lane *lane, path_place place);
double path_whole_length(const path_table *path, const path_lane *lane);

path_beside path_beside_at(const path_line *line, path_jet t);

/* The lane with this number; NULL if the path has none. */
const path_lane *path_find_lane(const path_table *path, int32_t number);

#endif
