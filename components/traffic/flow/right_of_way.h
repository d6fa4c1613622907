/* Who stops at lights, and who waits for others where paths meet.

   Yellow: who can stop before the line after a second of reaction by its comfortable deceleration does, everybody else
   passes: D. Gazis, R. Herman, A. Maradudin: Operations Research 8, 112 (1960), outside of whose dilemma zone nobody
   runs a red light. Red: who can stop at all does.

   Gaps: who gives way drives if everybody on the other path is past before it comes, or comes a critical gap after it
   would be there; 6.5 s from a minor road straight on, 4.1 s to the left from a major one: Highway Capacity Manual 2000,
   exhibit 17-5. The follow-up time is that of the IDM. Who has decided to drive does. Nobody, with the right of way or
   without, drives into others: where paths cross it waits at the border until those who are in the way have left; where
   they join, and as far as they are one lane, it follows who is farther in. */
#ifndef RIGHT_OF_WAY_H
#define RIGHT_OF_WAY_H

#include "flow.h"

/* Sets of all users where they have to stop, and what they may not accelerate more than. */
void right_of_way(flow *self);

#endif
