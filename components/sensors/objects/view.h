/* What can be seen of boxes that hide each other. */
#ifndef OBJECTS_VIEW_H
#define OBJECTS_VIEW_H

#include "objects.h"

/* A box seen from the sensor: ahead and to the left. Nobody: length < 0. */
typedef struct {
    double x, y, cosine, sine; /* of its middle; of its heading against the host's */
    double length, width;      /* halves */
} view_box;

/* What is seen of a box. */
typedef struct {
    double share;       /* of the angle it would fill alone, in the field of view */
    double x, y;        /* the middle of what no other box hides of its face, from the sensor */
    double right, left; /* rad, of the outermost seen points of the face */
    double across;      /* share of the face's extent that lies across the sensor's axis */
} view_part;

/* Parts of all boxes; within +-half rad is the field of view; *through*: none hides another. */
void view_of(const view_box boxes[OBJECTS_ACTORS], double half, bool through, view_part parts[OBJECTS_ACTORS]);

#endif
