/* The functions of one component for a fused loop. Included after fmi2.c or fmi3.c (DSE_FMI), DSE_PREFIX before all. */
#ifndef DSE_FUSED_PART_H
#define DSE_FUSED_PART_H

#define DSE_FUSED_TEXT_OF(number) #number
#define DSE_FUSED_TEXT(number) DSE_FUSED_TEXT_OF(number)

/* One step, as fmiXDoStep makes it; false after an error, which is reported. */
bool dse_fused_step(void *c, double time, double step) {
    return dse_do_step(c, "fmi" DSE_FUSED_TEXT(DSE_FMI) "DoStep", time, step);
}

/* The return value of fmiXDoStep after that error. */
void dse_fused_answer(const void *c, int64_t *status, int64_t *has_ended, double *time) {
    const struct dse_instance *instance = c;
    *has_ended = DSE_HAS_ENDED(instance);
    *time = instance->at.time;
#if DSE_FMI == 2
    *status = *has_ended ? fmi2Discard : fmi2Error;
#else
    *status = *has_ended ? fmi3OK : fmi3Error;
#endif
}

/* Call before reading outputs, with the name of the accessor that FMI would call; false after an error, which is
 * reported. */
bool dse_fused_refresh(void *c, const char *function) {
    return !((struct dse_instance *)c)->at.is_stale || dse_refresh(c, function);
}

#endif
