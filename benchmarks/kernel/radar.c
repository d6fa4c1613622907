#include "radar.h"

void radar_init(Radar *self)
{
    double gap = self->in.lead_x - self->in.x;
    self->out.detected = gap >= 0.0 && gap <= self->par.range;
    self->out.gap = self->out.detected ? gap : self->par.range;
    self->out.closing_speed = self->out.detected ? self->in.lead_v - self->in.v : 0.0;
}

void radar_step(Radar *self, double h)
{
    (void)h;
    radar_init(self);
}
