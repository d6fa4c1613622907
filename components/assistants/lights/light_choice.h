/* What assistants share that mind traffic lights: colours, and what is done about the light ahead. At yellow the car stops if it
 * can with a comfortable deceleration, else it drives on, and stays with that; at red it stops unless its front is past. */
#ifndef LIGHT_CHOICE_H
#define LIGHT_CHOICE_H

#include <stdint.h>

enum { COLOUR_NONE, COLOUR_OFF, COLOUR_RED, COLOUR_RED_YELLOW, COLOUR_YELLOW, COLOUR_GREEN };
enum { LIGHT_FREE, LIGHT_STOPS, LIGHT_PASSED_LATE };

typedef struct {
    double distance, last_distance;           /* m, of the light now and a step ago */
    double room;                              /* m, left to come to a stop */
    double speed;                             /* m/s */
    double yellow_deceleration, front_length; /* m/s2; m, from where distances are told to the bumper */
} light_case;

/* What is done about a light of *colour*, if *last* was done about that of a step ago. */
int32_t light_choice(int32_t last, int32_t colour, const light_case *is);

#endif
