/* Selects the eight reported users, and their places. */
#ifndef ATTENTION_H
#define ATTENTION_H

#include "stream_traffic.h"

/* All places at once. */
void attention_begin(stream_traffic *self, const flow *all);
void attention_step(stream_traffic *self, const flow *all);

#endif
