/* The cars of a shared world: users on path 0 that are moved elsewhere. A car is in every lane that its body, or that of
   a wide vehicle of that lane, would share. Where it joins, the vehicles near it leave, and wait for room at the start of
   their path. */
#ifndef GUESTS_H
#define GUESTS_H

#include "stream_traffic.h"

void guests_step(stream_traffic *self, const flow *all);

#endif
