/* The functions of FMI 3.0 for model exchange. Included by fmi3.c. */
#include "exchange.h"

#define DISCARD(is_ok) ((is_ok) ? fmi3OK : fmi3Discard)

DSE_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
    fmi3Boolean visible, fmi3Boolean logging, void *environment, fmi3Logger logger) {
    struct dse_instance *instance = create(DSE_HERE, name, token, environment, logger, NULL);
    if (instance) {
        instance->is_exchange = true;
    }
    return instance;
}

DSE_EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance c) { return STATUS(dse_set_mode(c, DSE_HERE, true)); }

DSE_EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c) { return STATUS(dse_set_mode(c, DSE_HERE, false)); }

REFUSED_PLAIN(fmi3EnterStepMode, "co-simulation has no event mode to come from")

/* Discrete states are computed by fmi3UpdateDiscreteStates: a read before returns the last update. */
DSE_EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) {
    return STATUS(dse_is_exchange(c, DSE_HERE, DSE_INITIALIZING | DSE_STEPPING));
}

DSE_EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate,
    fmi3Boolean *nominals, fmi3Boolean *states, fmi3Boolean *has_next, fmi3Float64 *next) {
    struct dse_news news = {false, false, false, 0.0};
    const bool is_ok = dse_exchange_update(c, DSE_HERE, &news);
    *again = *nominals = false;
    *terminate = news.has_ended;
    *states = news.has_new_states;
    *has_next = news.has_next_time;
    *next = news.has_next_time ? news.next_time : 0.0;
    return STATUS(is_ok);
}

DSE_EXPORT fmi3Status fmi3CompletedIntegratorStep(
    fmi3Instance c, fmi3Boolean never_back, fmi3Boolean *event, fmi3Boolean *terminate) {
    bool needs_event, has_ended;
    const bool is_ok = dse_exchange_completed(c, DSE_HERE, &needs_event, &has_ended);
    *event = needs_event;
    *terminate = has_ended;
    return STATUS(is_ok);
}

DSE_EXPORT fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time) {
    return STATUS(dse_exchange_time(c, DSE_HERE, time));
}

DSE_EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 states[], size_t count) {
    return STATUS(dse_exchange_set_states(c, DSE_HERE, states, count));
}

DSE_EXPORT fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 states[], size_t count) {
    return STATUS(dse_exchange_get_states(c, DSE_HERE, states, count));
}

DSE_EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[], size_t count) {
    return DISCARD(dse_exchange_get_slope(c, DSE_HERE, derivatives, count));
}

DSE_EXPORT fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 indicators[], size_t count) {
    return DISCARD(dse_exchange_get_indicators(c, DSE_HERE, indicators, count));
}

DSE_EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t count) {
    return STATUS(dse_exchange_get_nominals(c, DSE_HERE, nominals, count));
}

DSE_EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *count) {
    *count = DSE_INDICATORS;
    return STATUS(dse_is_exchange(c, DSE_HERE, DSE_ANY_STATE));
}

DSE_EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *count) {
    *count = DSE_STATES;
    return STATUS(dse_is_exchange(c, DSE_HERE, DSE_ANY_STATE));
}
