#include "lead.h"

void lead_init(Lead *self)
{
    self->out.x = self->par.x0;
    self->out.v = self->par.speed;
    self->out.a = 0.0;
}

void lead_step(Lead *self, double h)
{
    self->out.x += self->out.v * h;
}
