#pragma once
typedef struct {
    struct { double force; } in;
    struct { double speed; } out;
    struct { double drag; } par;
} cart;
void cart_init(cart *self);
void cart_step(cart *self, double h);
