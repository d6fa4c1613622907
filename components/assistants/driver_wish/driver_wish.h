/* Passes the driver's wish on, independent of speed limits and curves. */
#ifndef DRIVER_WISH_H
#define DRIVER_WISH_H

#include "../speed_assistant/speed_assistant.h"

typedef struct {
    speed_assistant_in in;
    speed_assistant_out out;
} driver_wish;

void driver_wish_init(driver_wish *self);
void driver_wish_step(driver_wish *self);

#endif
