/* A car without an emergency brake. */
#ifndef NO_AEB_H
#define NO_AEB_H

#include "../emergency/emergency.h"

typedef struct {
    emergency_in in;
    emergency_out out;
} no_aeb;

void no_aeb_init(no_aeb *self);
void no_aeb_step(no_aeb *self);

#endif
