/* For assistants that consider traffic lights: colours, and the action for the light ahead. At yellow the car stops if
 * comfortable braking suffices, else it passes, and keeps the choice. At red it stops unless its front is past. */
#ifndef LIGHT_CHOICE_H
#define LIGHT_CHOICE_H

#include <stdint.h>

enum { COLOUR_NONE, COLOUR_OFF, COLOUR_RED, COLOUR_RED_YELLOW, COLOUR_YELLOW, COLOUR_GREEN };
enum { LIGHT_FREE, LIGHT_STOPS, LIGHT_PASSED_LATE };

typedef struct {
    double distance, last_distance;           /* m, of the light now and one step before */
    double room;                              /* m, available for stopping */
    double speed;                             /* m/s */
    double yellow_deceleration, front_length; /* m/s2; m, from the origin of distances to the bumper */
} light_case;

/* The action for a light of *colour*, if *last* was the action of the step before. */
int32_t light_choice(int32_t last, int32_t colour, const light_case *is);

#endif
