/* Gap and closing speed to the vehicle ahead, within a range. */
#ifndef RADAR_H
#define RADAR_H

#include <stdbool.h>

typedef struct {
    struct {
        double x, v, lead_x, lead_v;
    } in;
    struct {
        double gap, closing_speed;
        bool detected;
    } out;
    struct {
        double range;
    } par;
} Radar;

void radar_init(Radar *self);
void radar_step(Radar *self, double h);

#endif
