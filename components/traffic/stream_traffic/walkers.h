/* Cyclists and pedestrians beside the lanes of path 0, and pedestrians that cross it: when no vehicle arrives within
   their crossing time plus 3 s (Highway Capacity Manual 2010, equation 19-69), or the arriving vehicle is at rest. */
#ifndef WALKERS_H
#define WALKERS_H

#include "stream_traffic.h"

void walkers_add(stream_traffic *self, const flow *all, int32_t class, bool crosses);
void walkers_step(stream_traffic *self, const flow *all, double h);
traffic_mover walkers_mover(const stream_traffic *self, const flow *all, int32_t i);

#endif
