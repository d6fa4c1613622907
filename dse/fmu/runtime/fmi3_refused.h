/* FMI 3.0 requires every FMU to export every function. These are refused with a message: this FMU has no clocks, no
 * strings (except those of a component written in C), no structural parameters, no scheduled execution. Without a model
 * from Modelica it has no events and no model exchange either. Included by fmi3.c.
 */
#ifdef DSE_MODEL
#define DSE_NO_SCHEDULE "only co-simulation and model exchange are supported"
#else
#define DSE_NO_SCHEDULE "only co-simulation is supported"
#endif
#define REFERENCES const fmi3ValueReference references[], size_t count

DSE_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
    fmi3Boolean visible, fmi3Boolean logging, void *environment, fmi3Logger logger, fmi3ClockUpdate update,
    fmi3Preemption lock, fmi3Preemption unlock) {
    return create(DSE_HERE, name, token, environment, logger, DSE_NO_SCHEDULE);
}

#ifndef DSE_HAS_TEXTS
REFUSED(fmi3GetString, "there are no strings", REFERENCES, fmi3String values[], size_t value_count)
REFUSED(fmi3SetString, "there are no strings", REFERENCES, const fmi3String values[], size_t value_count)
REFUSED(fmi3GetBinary, "there are no binaries", REFERENCES, size_t sizes[], fmi3Binary values[], size_t value_count)
REFUSED(fmi3SetBinary, "there are no binaries", REFERENCES, const size_t sizes[], const fmi3Binary values[],
    size_t value_count)
#endif
REFUSED(fmi3GetClock, "there are no clocks", REFERENCES, fmi3Clock values[])
REFUSED(fmi3SetClock, "there are no clocks", REFERENCES, const fmi3Clock values[])
REFUSED(fmi3GetIntervalDecimal, "there are no clocks", REFERENCES, fmi3Float64 intervals[],
    fmi3IntervalQualifier qualifiers[])
REFUSED(fmi3GetIntervalFraction, "there are no clocks", REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
    fmi3IntervalQualifier qualifiers[])
REFUSED(fmi3GetShiftDecimal, "there are no clocks", REFERENCES, fmi3Float64 shifts[])
REFUSED(fmi3GetShiftFraction, "there are no clocks", REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
REFUSED(fmi3SetIntervalDecimal, "there are no clocks", REFERENCES, const fmi3Float64 intervals[])
REFUSED(fmi3SetIntervalFraction, "there are no clocks", REFERENCES, const fmi3UInt64 counters[],
    const fmi3UInt64 resolutions[])
REFUSED(fmi3SetShiftDecimal, "there are no clocks", REFERENCES, const fmi3Float64 shifts[])
REFUSED(fmi3SetShiftFraction, "there are no clocks", REFERENCES, const fmi3UInt64 counters[],
    const fmi3UInt64 resolutions[])
REFUSED(fmi3ActivateModelPartition, "there are no clocks", fmi3ValueReference clock, fmi3Float64 time)

REFUSED(fmi3GetNumberOfVariableDependencies, "dependencies are not provided", fmi3ValueReference reference,
    size_t *count)
REFUSED(fmi3GetVariableDependencies, "dependencies are not provided", fmi3ValueReference dependent,
    size_t dependent_elements[], fmi3ValueReference independents[], size_t independent_elements[],
    fmi3DependencyKind kinds[], size_t count)
REFUSED(fmi3GetDirectionalDerivative, "derivatives are not provided", const fmi3ValueReference unknowns[],
    size_t unknown_count, const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],
    size_t seed_count, fmi3Float64 sensitivity[], size_t sensitivity_count)
REFUSED(fmi3GetAdjointDerivative, "derivatives are not provided", const fmi3ValueReference unknowns[],
    size_t unknown_count, const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],
    size_t seed_count, fmi3Float64 sensitivity[], size_t sensitivity_count)
REFUSED(fmi3GetOutputDerivatives, "derivatives are not provided", REFERENCES, const fmi3Int32 orders[],
    fmi3Float64 values[], size_t value_count)

REFUSED_PLAIN(fmi3EnterConfigurationMode, "there are no structural parameters")
REFUSED_PLAIN(fmi3ExitConfigurationMode, "there are no structural parameters")

#ifndef DSE_MODEL
DSE_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
    fmi3Boolean visible, fmi3Boolean logging, void *environment, fmi3Logger logger) {
    return create(DSE_HERE, name, token, environment, logger, DSE_NO_SCHEDULE);
}

REFUSED_PLAIN(fmi3EnterEventMode, "there is no event mode")
REFUSED_PLAIN(fmi3EnterStepMode, "there is no event mode to come from")
REFUSED_PLAIN(fmi3EvaluateDiscreteStates, "there is no event mode")
REFUSED(fmi3UpdateDiscreteStates, "there is no event mode", fmi3Boolean *again, fmi3Boolean *terminate,
    fmi3Boolean *nominals, fmi3Boolean *states, fmi3Boolean *has_next, fmi3Float64 *next)

REFUSED_PLAIN(fmi3EnterContinuousTimeMode, "only co-simulation is supported")
REFUSED(fmi3CompletedIntegratorStep, "only co-simulation is supported", fmi3Boolean never_back, fmi3Boolean *event,
    fmi3Boolean *terminate)
REFUSED(fmi3SetTime, "only co-simulation is supported", fmi3Float64 time)
REFUSED(fmi3SetContinuousStates, "only co-simulation is supported", const fmi3Float64 states[], size_t count)
REFUSED(fmi3GetContinuousStates, "only co-simulation is supported", fmi3Float64 states[], size_t count)
REFUSED(fmi3GetContinuousStateDerivatives, "only co-simulation is supported", fmi3Float64 derivatives[], size_t count)
REFUSED(fmi3GetEventIndicators, "only co-simulation is supported", fmi3Float64 indicators[], size_t count)
REFUSED(fmi3GetNominalsOfContinuousStates, "only co-simulation is supported", fmi3Float64 nominals[], size_t count)
REFUSED(fmi3GetNumberOfEventIndicators, "only co-simulation is supported", size_t *count)
REFUSED(fmi3GetNumberOfContinuousStates, "only co-simulation is supported", size_t *count)
#endif
