/* What the co-simulation kernel and a fused loop say to each other.
 *
 * A fused library holds the components of one system and one loop over them that knows their structs, the connections
 * and what is recorded. Everything outside of the loop goes through the components' FMI functions as always.
 * Numbers of fixed width and no address but those given here, so that the loop can be compiled for other machines. */
#ifndef DSE_CSOLVE_FUSED_ABI_H
#define DSE_CSOLVE_FUSED_ABI_H

#include <stdint.h>

/* How the loop ended. */
enum {
    DSE_FUSED_STOPPED, /* at the communication point noted in *progress*, before anything but reading: the last one, or a
                        * value is not finite, or an FMI function would refuse it. FMI calls go on from there. A loop
                        * of Gauss and Seidel: before the noted element's turn in that step. */
    DSE_FUSED_FAILED   /* the FMI function noted in *progress* would have answered *status* */
};

typedef struct {
    /* What the loop is given: */
    void *const *instances; /* the first element's instance; *stride* bytes on lies the next element's, and so on */
    int64_t stride;
    volatile int64_t *progress;  /* element, FMI call and step; noted before anything that may crash or hang */
    int64_t call_step, call_get; /* the numbers of these FMI calls; that of the type is added to the second */
    double step;
    int64_t steps;
    double *out; /* [steps + 1][recorded] */
    /* What it tells: */
    int64_t status, has_ended; /* has_ended: the component has ended the simulation */
    double time;               /* the last one the component got to */
} dse_fused_run;

typedef int dse_fused_loop(dse_fused_run *run);

#endif
