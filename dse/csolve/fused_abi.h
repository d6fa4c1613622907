/* The interface between the co-simulation kernel and a fused loop.
 *
 * A fused library contains the components of one system and one loop over them, compiled for their structs, the
 * connections and the recorded values. All calls outside of the loop use the components' FMI functions as usual. Only
 * numbers of fixed width, and no addresses except those here, so that the loop can be compiled for other machines. */
#ifndef DSE_CSOLVE_FUSED_ABI_H
#define DSE_CSOLVE_FUSED_ABI_H

#include <stdint.h>

/* How the loop ended. */
enum {
    DSE_FUSED_STOPPED, /* at the communication point stored in *progress*, after reads only: it is the last one, a value
                        * is not finite, or an FMI function would refuse it. FMI calls continue from there. A loop of
                        * Gauss and Seidel: before the stored element's part of that step. */
    DSE_FUSED_FAILED   /* the FMI function stored in *progress* would have returned *status* */
};

typedef struct {
    /* Inputs of the loop: */
    void *const *instances; /* the first element's instance; those of the next elements follow *stride* bytes apart */
    int64_t stride;
    volatile int64_t *progress;  /* element, FMI call and step; stored before each operation that may crash or hang */
    int64_t call_step, call_get; /* the numbers of these FMI calls; that of the type is added to the second */
    double step;
    int64_t first; /* the step at which it begins: 0, but for who has stopped it there before */
    int64_t steps;
    double *out; /* [steps + 1][recorded], from the row of the first step */
    /* Outputs: */
    int64_t status, has_ended; /* has_ended: the component has ended the simulation */
    double time;               /* the last time the component reached */
} dse_fused_run;

typedef int dse_fused_loop(dse_fused_run *run);

#endif
