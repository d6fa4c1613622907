#include "ray_fan.h"

#include <math.h>

static double azimuth(const ray_fan *fan, int ray) {
    return (ray - 0.5 * (fan->count - 1)) * fan->spacing;
}

void ray_fan_aim(ray_fan *fan, int count, double angle) {
    fan->count = count < 0 ? 0 : count > RAY_FAN_MAX ? RAY_FAN_MAX : count;
    fan->spacing = fan->count > 1 ? angle / (fan->count - 1) : 0;
    for (int i = 0; i < fan->count; ++i) {
        fan->tangent[i] = tan(azimuth(fan, i));
        fan->per_cosine[i] = 1 / cos(azimuth(fan, i));
    }
}

/* The first ray whose tangent is at least this. */
static int first_from(const ray_fan *fan, double tangent) {
    int low = 0, high = fan->count;
    while (low < high) {
        int middle = (low + high) / 2;
        if (fan->tangent[middle] < tangent) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

static double lesser(double a, double b) {
    return a < b ? a : b;
}

static double greater(double a, double b) {
    return a > b ? a : b;
}

/* Where the ray enters the box, as distance ahead (slab test); infinite if it misses. */
static double entry(double tangent, const ray_fan_box *box) {
    double in = greater(box->near, 0), out = box->far;
    if (tangent == 0) {
        if (box->right > 0 || box->left < 0) return HUGE_VAL;
    } else {
        double one = box->right / tangent, other = box->left / tangent;
        in = greater(in, lesser(one, other));
        out = lesser(out, greater(one, other));
    }
    return in <= out ? in : HUGE_VAL;
}

ray_fan_echo ray_fan_cast(const ray_fan *fan, const ray_fan_box *box, double reach) {
    ray_fan_echo echo = {reach, 0, false};
    int first = 0;
    double highest = HUGE_VAL;
    if (box->near > 0) {
        /* Rays outside the box's corners miss; most of the fan does when the box is far. */
        first = first_from(fan, box->right / (box->right < 0 ? box->near : box->far));
        highest = box->left / (box->left > 0 ? box->near : box->far);
    }
    for (int i = first; i < fan->count && fan->tangent[i] <= highest; ++i) {
        double range = entry(fan->tangent[i], box) * fan->per_cosine[i];
        if (range < echo.range || (range == echo.range && !echo.hit)) {
            echo.range = range;
            echo.azimuth = azimuth(fan, i);
            echo.hit = true;
        }
    }
    return echo;
}
