/* Operations of one element, for every kind of FMU: the algorithms use only these functions. Each of them stores the
 * place of its next FMI call. It returns false with system->failure filled in if the FMU refuses. The life of an
 * instance: make_instance, set_up, read and write until the initial values are found, leave_initialization, then write,
 * step and read, terminate_element; reset_element and again, or free_instance. */
#ifndef DSE_COSIM_ELEMENT_H
#define DSE_COSIM_ELEMENT_H

#include "kernel.h" /* before all system headers: it selects the POSIX version */

#include "exchange.h"
#include "log.h"
#include "stepping.h"

#include <stdlib.h>

/* ---- instances ---- */

/* Give the instance to all groups of variables, and discard the record of its inputs. */
static void bind(System *system)
{
    calling = system;
    for (const Groups *groups = system->tables; groups < system->tables + system->n_tables; groups++) {
        for (Group *group = groups->fmi2; group < groups->end; group++)
            group->instance = system->elements[group->place.element].instance;
        for (TextGroup *group = groups->texts; group < groups->no_texts; group++)
            group->instance = system->elements[group->place.element].instance;
    }
    for (int64_t e = 0; e < system->n_elements; e++) {
        system->elements[e].life++;
        system->elements[e].moving = NULL;
        system->elements[e].broken = 0;
        system->elements[e].finished = -1;
    }
}

/* FMI 1.0 does not identify the element of a finished step, and any thread may call: its FMUs are polled. */
static void finish_fmi1_step(void *instance, int status)
{
    (void)instance, (void)status;
}

static void finish_fmi2_step(void *environment, int status)
{
    Element *element = element_of(environment);
    if (element)
        keep_step_status(element, status);
}

static void *instantiate_fmi1(const Element *element)
{
    const Fmi1Callbacks callbacks = {keep_fmi2_line, calloc, free, finish_fmi1_step};
    return ((Fmi1Instantiate)element->instantiate)(element->name, element->token, element->resources,
                                                   "application/x-fmu-sharedlibrary", 0.0, 0, 0, callbacks, 0);
}

static void *instantiate_fmi2(const Element *element)
{
    return ((Fmi2Instantiate)element->instantiate)(element->name, FMI2_CO_SIMULATION, element->token,
                                                   element->resources, &element->callbacks, 0, 0);
}

static void *instantiate_fmi3(Element *element)
{
    const bool asks = element->abilities & ASKS_BETWEEN;
    return ((Fmi3Instantiate)element->instantiate)(
        element->name, element->token, element->resources, false, false, element->abilities & HAS_EVENTS,
        element->abilities & CAN_RETURN_EARLY, element->intermediate, asks ? (size_t)element->n_intermediate : 0, element,
        keep_fmi3_line, asks ? update_between : NULL);
}

static bool make_instance(System *system, int64_t e)
{
    Element *element = &system->elements[e];
    calling = system;
    lend(system);
    enter_call(system, e, INSTANTIATE);
    element->callbacks = (Fmi2Callbacks){keep_fmi2_line, calloc, free, finish_fmi2_step, element};
    element->system = system;
    element->finished = -1;
    element->mode = CREATED;
    if (element->exchange)
        return exchange_make(system, e);
    element->instance = element->version == 1   ? instantiate_fmi1(element)
                        : element->version == 2 ? instantiate_fmi2(element)
                                                : instantiate_fmi3(element);
    return element->instance ? true : fail(system, NO_INSTANCE, 0, 0, 0);
}

static void free_instance(System *system, int64_t e)
{
    Element *element = &system->elements[e];
    if (element->instance) {
        calling = system;
        if (element->saved) {
            enter_call(system, e, FREE_STATE);
            ((FmiGetState)element->free_state)(element->instance, &element->saved);
        }
        enter_call(system, e, FREE_INSTANCE);
        ((FmiFree)element->free_instance)(element->instance);
    }
    element->saved = NULL;
    element->instance = NULL;
}

static bool reset_element(System *system, int64_t e)
{
    calling = system;
    return call_plain(system, &system->elements[e], RESET, system->elements[e].reset);
}

/* ---- initialization ---- */

static bool configure(System *system, const Element *element)
{
    const Groups *groups = &element->configuration;
    return groups->fmi2 == groups->end ||
           (call_plain(system, element, ENTER_CONFIGURATION, element->enter_configuration) &&
            write_some(system, groups, UNFIT_START) &&
            call_plain(system, element, EXIT_CONFIGURATION, element->exit_configuration));
}

static bool set_up_experiment(System *system, const Element *element)
{
    enter_call(system, element->stepping.element, SETUP_EXPERIMENT);
    Fmi2SetupExperiment set_up = (Fmi2SetupExperiment)element->setup_experiment;
    const double tolerance = element->tolerance;
    return accept(system, set_up(element->instance, tolerance > 0.0, tolerance, 0.0, 1, element->stop));
}

static bool enter_initialization(System *system, Element *element)
{
    enter_call(system, element->stepping.element, ENTER_INITIALIZATION);
    const FmiFunction enter = element->enter_initialization;
    const int status =
        element->version == 1   ? ((Fmi1Initialize)enter)(element->instance, 0.0, 1, element->stop)
        : element->version == 2 ? ((FmiPlain)enter)(element->instance)
                                : ((Fmi3EnterInitialization)enter)(element->instance, element->tolerance > 0.0,
                                                                   element->tolerance, 0.0, true, element->stop);
    /* FMI 1.0 has no initialization mode: it starts with its present inputs. */
    element->mode = element->version == 1 ? RUNNING : INITIALIZING;
    return accept(system, status);
}

/* From a new or reset instance into initialization mode, start values set. An FMU of FMI 1.0 is initialized at its
 * first read, so that its inputs can be written before. */
static bool set_up(System *system, int64_t e, double stop)
{
    Element *element = &system->elements[e];
    element->stop = stop;
    element->next_event = INFINITY;
    element->mode = SET_UP;
    return (element->version != 2 || set_up_experiment(system, element)) &&
           (element->version != 3 || configure(system, element)) &&
           write_some(system, &element->starts, UNFIT_START) &&
           (element->version == 1 || enter_initialization(system, element));
}

static bool leave_initialization(System *system, int64_t e)
{
    Element *element = &system->elements[e];
    if (element->version == 1)
        return element->mode == RUNNING || enter_initialization(system, element);
    element->mode = RUNNING;
    if (element->exchange)
        return exchange_start(system, e);
    return call_plain(system, element, EXIT_INITIALIZATION, element->exit_initialization) &&
           (!(element->abilities & HAS_EVENTS) || element->abilities & TICKS || leave_event_mode(system, element));
}

static bool terminate_element(System *system, int64_t e)
{
    return call_plain(system, &system->elements[e], TERMINATE, system->elements[e].terminate);
}

/* ---- values ---- */

/* Read *groups* of its outputs into the tables. */
static bool read_element(System *system, Element *element, const Groups *groups)
{
    if (element->version == 1 && element->mode == SET_UP && !enter_initialization(system, element))
        return false;
    return read_some(system, groups);
}

/* Write *groups* of its staged inputs. Discrete inputs that change cause an event. */
static bool write_element(System *system, Element *element, const Groups *groups)
{
    if (!(element->abilities & HAS_EVENTS))
        return write_some(system, groups, UNFIT_INPUT);
    return element->mode == RUNNING ? write_around_event(system, element, groups)
                                    : write_before_events(system, element, groups);
}

/* ---- steps ---- */

/* From *time* to time + step, inputs written. */
HOT bool step_element(System *system, Element *element, double time, double step)
{
    if (element->exchange)
        return exchange_step(system, element, time, step);
    if (element->version == 3)
        return step_fmi3(system, element, time, step);
    const int status = call_step(system, element, time, step);
    return is_good(status) ? true : make_up(system, element, time, step, status);
}

/* Save its present state; one state at a time. */
OFFERED static bool save_element(System *system, int64_t e)
{
    Element *element = &system->elements[e];
    enter_call(system, e, GET_STATE);
    if (!(element->abilities & CAN_SAVE))
        return fail(system, NO_FUNCTION, 0, 0, 0);
    element->saved_next_event = element->next_event;
    save_given(&element->inputs);
    if (element->exchange)
        exchange_save(element);
    return accept(system, ((FmiGetState)element->get_state)(element->instance, &element->saved));
}

/* Restore the saved state. */
OFFERED static bool restore_element(System *system, int64_t e)
{
    Element *element = &system->elements[e];
    enter_call(system, e, SET_STATE);
    if (!element->saved)
        return fail(system, NO_FUNCTION, 0, 0, 0);
    element->next_event = element->saved_next_event;
    restore_given(&element->inputs);
    if (element->exchange)
        exchange_restore(element);
    return accept(system, ((FmiSetState)element->set_state)(element->instance, element->saved));
}

#endif
