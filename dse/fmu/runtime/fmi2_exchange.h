/* The functions of FMI 2.0 for model exchange. Included by fmi2.c. */
#include "exchange.h"

#define DISCARD(is_ok) ((is_ok) ? fmi2OK : fmi2Discard)

DSE_EXPORT fmi2Status fmi2EnterEventMode(fmi2Component c) { return STATUS(dse_set_mode(c, DSE_HERE, true)); }

DSE_EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) { return STATUS(dse_set_mode(c, DSE_HERE, false)); }

DSE_EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
    struct dse_news news = {false, false, false, 0.0};
    const bool is_ok = dse_exchange_update(c, DSE_HERE, &news);
    info->newDiscreteStatesNeeded = false;
    info->terminateSimulation = news.has_ended;
    info->nominalsOfContinuousStatesChanged = false;
    info->valuesOfContinuousStatesChanged = news.has_new_states;
    info->nextEventTimeDefined = news.has_next_time;
    info->nextEventTime = news.has_next_time ? news.next_time : 0.0;
    return STATUS(is_ok);
}

DSE_EXPORT fmi2Status fmi2CompletedIntegratorStep(
    fmi2Component c, fmi2Boolean never_back, fmi2Boolean *event, fmi2Boolean *terminate) {
    bool needs_event, has_ended;
    const bool is_ok = dse_exchange_completed(c, DSE_HERE, &needs_event, &has_ended);
    *event = needs_event;
    *terminate = has_ended;
    return STATUS(is_ok);
}

DSE_EXPORT fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
    return STATUS(dse_exchange_time(c, DSE_HERE, time));
}

DSE_EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real states[], size_t count) {
    return STATUS(dse_exchange_set_states(c, DSE_HERE, states, count));
}

DSE_EXPORT fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real states[], size_t count) {
    return STATUS(dse_exchange_get_states(c, DSE_HERE, states, count));
}

DSE_EXPORT fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t count) {
    return DISCARD(dse_exchange_get_slope(c, DSE_HERE, derivatives, count));
}

DSE_EXPORT fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real indicators[], size_t count) {
    return DISCARD(dse_exchange_get_indicators(c, DSE_HERE, indicators, count));
}

DSE_EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominals[], size_t count) {
    return STATUS(dse_exchange_get_nominals(c, DSE_HERE, nominals, count));
}
