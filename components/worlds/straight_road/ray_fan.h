/* A fan of rays from the host's bumper and a box that is parallel to the road: range, bearing, Doppler. */
#ifndef RAY_FAN_H
#define RAY_FAN_H

#include <stdbool.h>

#define RAY_FAN_MAX 128

typedef struct {
    int count;
    double spacing, tangent[RAY_FAN_MAX], per_cosine[RAY_FAN_MAX];
} ray_fan;

/* Seen from the bumper: ahead is positive, left is positive. */
typedef struct {
    double near, far, right, left;
} ray_fan_box;

typedef struct {
    double range, azimuth;
    bool hit;
} ray_fan_echo;

/* count rays, evenly over the angle from edge to edge (below pi); an odd count has one straight ahead. */
void ray_fan_aim(ray_fan *fan, int count, double angle);

/* The nearest hit within reach; {reach, 0, false} if there is none. */
ray_fan_echo ray_fan_cast(const ray_fan *fan, const ray_fan_box *box, double reach);

#endif
