/* PD on speed and PD on distance; the smaller demand wins. */
#ifndef CONTROLLER_H
#define CONTROLLER_H

#include <stdbool.h>

typedef struct {
    struct {
        double gap, closing_speed, speed;
        bool detected;
    } in;
    struct {
        double demand;
    } out;
    struct {
        double kp_speed, kd_speed, kp_gap, kd_gap, set_speed, set_gap;
    } par;
    double error;
    bool is_first;
} Controller;

void controller_init(Controller *self);
void controller_step(Controller *self);

#endif
