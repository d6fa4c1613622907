#include "vehicle.h"

#define SUBSTEPS 10

void vehicle_init(Vehicle *self)
{
    self->out.x = self->out.v = self->out.a = 0.0;
}

void vehicle_step(Vehicle *self, double h)
{
    double x = self->out.x, v = self->out.v, a = self->out.a, dt = h / SUBSTEPS;
    for (int i = 0; i < SUBSTEPS; i++) {
        double jerk = (self->in.demand - a) / self->par.lag;
        double resistance = v > 0.0 ? self->par.drag * v * v / self->par.mass + self->par.rolling * 9.81 : 0.0;
        x += v * dt;
        v += (a - resistance) * dt;
        a += jerk * dt;
        if (v < 0.0)
            v = 0.0;
    }
    self->out.x = x;
    self->out.v = v;
    self->out.a = a;
}
