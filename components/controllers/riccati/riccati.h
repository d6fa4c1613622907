/* Linear-quadratic regulator of a linear system of four states and one input, in steps of one sample. */
#ifndef RICCATI_H
#define RICCATI_H

typedef struct {
    double cost[4][4];   /* P: the cost to go is z' P z */
    double gain[4];      /* K: the input is -K z */
    double closed[4][4]; /* the transition with it */
} regulator;

/* The one that makes the sum of z' diag(weights) z + effort u^2 least, where z becomes transition z + input u: the discrete
 * algebraic Riccati equation, by structure-preserving doubling (Chu, Fan, Lin, Wang: Int. J. Control 77, 767, 2004).
 * *effort* > 0. A system of fewer states has rows, columns and weights of zeros. */
regulator regulator_of(const double transition[4][4], const double input[4], const double weights[4], double effort);

#endif
