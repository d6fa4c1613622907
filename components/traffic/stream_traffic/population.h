/* The users: generated from the seed at the start, and later where paths begin. */
#ifndef POPULATION_H
#define POPULATION_H

#include "stream_traffic.h"

/* All users at the start. False: they do not fit on the road. */
bool population_begin(stream_traffic *self, flow *all);

/* A user at the end of an open path leaves; a new one enters. */
void population_exchange(stream_traffic *self, flow *all);

#endif
