/* Linear-quadratic regulator of a car in its lane, in steps of one sample. */
#ifndef RICCATI_H
#define RICCATI_H

#include "../lateral/car_model.h"

typedef struct {
    double cost[4][4];   /* P: the cost to go is z' P z */
    double gain[4];      /* K: the steering is -K z */
    double closed[4][4]; /* the transition with it */
} regulator;

/* The one that makes the sum of z' diag(weights) z + effort d^2 least: the discrete algebraic Riccati equation, by
 * structure-preserving doubling (Chu, Fan, Lin, Wang: Int. J. Control 77, 767, 2004). *effort* > 0. */
regulator regulator_of(const car_motion *motion, const double weights[4], double effort);

#endif
