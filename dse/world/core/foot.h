/* The foot of a point on a path: where the reference line is nearest. */
#ifndef FOOT_H
#define FOOT_H

#include "path.h"

typedef struct {
    path_line line; /* there */
    double t;       /* m of the point to the left of the line; seen from a corner of it, m in its normal direction */
} path_foot;

/* The foot of (x, y) that is reached from station *s*, by Newton's method in a bracket. False: there is none, as the
 * point is farther away than the line's centre of curvature. */
bool foot_from(const path_table *path, double x, double y, double s, int32_t near, path_foot *foot);

/* The foot of (x, y) that is nearest of all; it looks at every piece. */
path_foot foot_of_all(const path_table *path, double x, double y);

#endif
