/* A point mass behind a first-order drivetrain, in ten Euler steps per communication step. */
#ifndef VEHICLE_H
#define VEHICLE_H

typedef struct {
    struct {
        double demand;
    } in;
    struct {
        double x, v, a;
    } out;
    struct {
        double lag, mass, drag, rolling;
    } par;
} Vehicle;

void vehicle_init(Vehicle *self);
void vehicle_step(Vehicle *self, double h);

#endif
