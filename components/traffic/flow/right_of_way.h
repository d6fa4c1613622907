/* Rules for stopping at lights, and for waiting where paths meet.

   Yellow: a user stops if it can stop before the line with its comfortable deceleration after a second of reaction; all
   others pass: D. Gazis, R. Herman, A. Maradudin: Operations Research 8, 112 (1960), outside of whose dilemma zone no
   user runs a red light. Red: a user stops if it can stop at all.

   Gaps: a user that gives way drives if all users of the other path have passed before it arrives, or arrive at least a
   critical gap after it; 6.5 s from a minor road straight on, 4.1 s to the left from a major one: Highway Capacity
   Manual 2000, exhibit 17-5. The follow-up time is that of the IDM. A user that has decided to drive does so. No user,
   with or without the right of way, drives into others. Where paths cross, it waits at the border until the users in
   the conflict have left. Where they join, and while they are one lane, it follows the user that is farther in. */
#ifndef RIGHT_OF_WAY_H
#define RIGHT_OF_WAY_H

#include "flow.h"

/* Sets the stopping points of all users, and the upper bounds of their accelerations. */
void right_of_way(flow *self);

#endif
