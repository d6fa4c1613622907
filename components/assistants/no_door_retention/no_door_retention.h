/* The doors are never kept shut. */
#ifndef NO_DOOR_RETENTION_H
#define NO_DOOR_RETENTION_H

#include "../door_retention/door_retention.h"

typedef struct {
    door_retention_in in;
    door_retention_out out;
} no_door_retention;

void no_door_retention_init(no_door_retention *self);
void no_door_retention_step(no_door_retention *self);

#endif
