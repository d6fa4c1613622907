/* A vehicle ahead that keeps its speed. */
#ifndef LEAD_H
#define LEAD_H

typedef struct {
    struct {
        double x, v, a;
    } out;
    struct {
        double x0, speed;
    } par;
} Lead;

void lead_init(Lead *self);
void lead_step(Lead *self, double h);

#endif
