#include "cart.h"

void cart_init(cart *self) { self->out.speed = 0; }

void cart_step(cart *self, double h) { self->out.speed += h * (self->in.force - self->par.drag * self->out.speed) / 40; }
