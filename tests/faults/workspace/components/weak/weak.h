#pragma once
typedef struct {
    struct { double speed; } in;
    struct { double demand; } out;
    struct { double gain; } par;
} weak;
void weak_init(weak *self);
void weak_step(weak *self, double h);
