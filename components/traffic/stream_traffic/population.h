/* Who there is: made from the seed at the start, and anew where paths begin. */
#ifndef POPULATION_H
#define POPULATION_H

#include "stream_traffic.h"

/* Everybody at the start. False: they do not fit on the road. */
bool population_begin(stream_traffic *self, flow *all);

/* Who is at the end of an open path leaves; somebody new comes in. */
void population_exchange(stream_traffic *self, flow *all);

#endif
