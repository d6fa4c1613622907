/* Shares the braking between machines and discs: the machines first, up to their limits and above a low speed. */
#ifndef BRAKE_BLENDING_H
#define BRAKE_BLENDING_H

typedef struct {
    struct {
        double brake_demand, regeneration, speed;
    } in;
    struct {
        double regeneration_demand, friction_demand;
    } out;
    struct {
        double share;                /* share of the braking that the machines may take over */
        double end_speed, full_speed; /* m/s: machine braking is zero below the first, full from the second */
    } par;
} brake_blending;

void brake_blending_init(brake_blending *self);
void brake_blending_step(brake_blending *self);

#endif
