/* The visible parts of boxes that hide each other. */
#ifndef OBJECTS_VIEW_H
#define OBJECTS_VIEW_H

#include "objects.h"

/* A box in the sensor's axes: ahead and to the left. No box: length < 0. */
typedef struct {
    double x, y, cosine, sine; /* of its middle; of its heading relative to the host's */
    double length, width;      /* halves */
} view_box;

/* The visible part of a box. */
typedef struct {
    double share;       /* share of the angle it would fill alone, in the field of view */
    double x, y;        /* the middle of the part of its face that no other box hides, from the sensor */
    double right, left; /* rad, of the outermost seen points of the face */
    double across;      /* share of the face's extent across the sensor's axis */
} view_part;

/* Parts of all boxes; the field of view is within +-half rad; *through*: no box hides another. */
void view_of(const view_box boxes[OBJECTS_ACTORS], double half, bool through, view_part parts[OBJECTS_ACTORS]);

#endif
