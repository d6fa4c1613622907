/* One model exchange element by itself, for the master in plain Python: elements are in C for both masters. */
#ifndef DSE_COSIM_EXCHANGE_ALONE_H
#define DSE_COSIM_EXCHANGE_ALONE_H

#include "exchange.h"

/* *system* has only this element, whose instance is in initialization mode or later. They return 0, or 1 with
 * system->failure filled in. */
DSE_API int dse_exchange_start(System *system);
DSE_API int dse_exchange_step(System *system, double time, double step);
DSE_API void dse_exchange_save(System *system);
DSE_API void dse_exchange_restore(System *system);

static void begin_alone(System *system)
{
    system->progress = &system->unwatched;
    system->elements->system = system;
    system->failure = (Failure){0};
}

int dse_exchange_start(System *system)
{
    begin_alone(system);
    return !exchange_start(system, 0);
}

int dse_exchange_step(System *system, double time, double step)
{
    begin_alone(system);
    return !exchange_step(system, system->elements, time, step);
}

void dse_exchange_save(System *system)
{
    exchange_save(system->elements);
}

void dse_exchange_restore(System *system)
{
    exchange_restore(system->elements);
}

#endif
