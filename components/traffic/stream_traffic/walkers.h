/* Cyclists and pedestrians beside the lanes of path 0, and pedestrians who cross it: when no vehicle comes within the time
   that crossing takes at their pace and 3 s more (Highway Capacity Manual 2010, equation 19-69), or who comes stands. */
#ifndef WALKERS_H
#define WALKERS_H

#include "stream_traffic.h"

void walkers_add(stream_traffic *self, const flow *all, int32_t class, bool crosses);
void walkers_step(stream_traffic *self, const flow *all, double h);
traffic_mover walkers_mover(const stream_traffic *self, int32_t i);

#endif
