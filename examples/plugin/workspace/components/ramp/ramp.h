#ifndef RAMP_H
#define RAMP_H
typedef struct {
    struct { double travel; } out;
    struct { double speed; } par;
} ramp;
void ramp_init(ramp *self);
void ramp_step(ramp *self, double h);
#endif
