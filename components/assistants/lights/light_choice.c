#include "light_choice.h"

#include <stdbool.h>

#define NEXT_LIGHT 1.0 /* m: a light that is farther away by more than this is another light */

int32_t light_choice(int32_t last, int32_t colour, const light_case *is) {
    bool is_another = is->distance > is->last_distance + NEXT_LIGHT;
    int32_t before = is_another ? LIGHT_FREE : last;
    switch (colour) {
    case COLOUR_YELLOW:
        if (before != LIGHT_FREE) return before;
        return is->room > 0 && is->speed * is->speed <= 2 * is->yellow_deceleration * is->room ? LIGHT_STOPS
                                                                                               : LIGHT_PASSED_LATE;
    case COLOUR_RED:
    case COLOUR_RED_YELLOW:
        if (before != LIGHT_FREE) return before;
        return is->distance > is->front_length ? LIGHT_STOPS : LIGHT_PASSED_LATE;
    default: return LIGHT_FREE;
    }
}
