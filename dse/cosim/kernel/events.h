/* Event mode of FMI 3.0 co-simulation (FMI 3.0.1, 4.2.1), where discrete inputs are set and discrete states change. */
#ifndef DSE_COSIM_EVENTS_H
#define DSE_COSIM_EVENTS_H

#include "access.h"

#include <math.h>

enum { MOST_EVENT_ITERATIONS = 1000 };

static bool call_plain(System *system, const Element *element, int64_t call, FmiFunction function)
{
    enter_call(system, element->stepping.element, call);
    return accept(system, ((FmiPlain)function)(element->instance));
}

/* In event mode: one update. */
static bool update_once(System *system, Element *element, bool *again)
{
    bool terminate = false, nominals = false, states = false, has_next = false;
    double next = 0.0;
    *again = false;
    enter_call(system, element->stepping.element, UPDATE_DISCRETE_STATES);
    const int status = ((Fmi3UpdateStates)element->update_discrete_states)(element->instance, again, &terminate,
                                                                           &nominals, &states, &has_next, &next);
    if (!accept(system, status))
        return false;
    if (terminate)
        return fail(system, STEP_CUT_SHORT, 1, 0, NAN);
    element->next_event = has_next ? next : INFINITY;
    return true;
}

/* Until nothing changes. */
static bool iterate_events(System *system, Element *element)
{
    bool again = true;
    for (int64_t i = 0; again && i < MOST_EVENT_ITERATIONS; i++)
        if (!update_once(system, element, &again))
            return false;
    return !again || fail(system, ENDLESS_EVENTS, 0, 0, 0);
}

static bool leave_event_mode(System *system, Element *element)
{
    return iterate_events(system, element) &&
           call_plain(system, element, ENTER_STEP_MODE, element->enter_step_mode);
}

static bool pass_event(System *system, Element *element)
{
    return call_plain(system, element, ENTER_EVENT_MODE, element->enter_event_mode) &&
           leave_event_mode(system, element);
}

/* ---- discrete inputs ---- */

/* Size in words of one record behind *given*. */
static size_t words_of(const Group *group)
{
    return 1 + ((size_t)group->n_values * size_of(group->type) + sizeof(int64_t) - 1) / sizeof(int64_t);
}

static size_t words_of_text(const TextGroup *group)
{
    return 1 + (size_t)group->n_values;
}

static bool is_changed(const Element *element, const Group *group)
{
    const size_t size = (size_t)group->n_values * size_of(group->type);
    return group->given && (group->given[0] != element->life || memcmp(group->given + 1, group->room, size) != 0);
}

static bool is_changed_text(const Element *element, const TextGroup *group)
{
    bool changed = group->given && group->given[0] != element->life;
    for (int64_t i = 0; group->given && i < group->n_values; i++)
        changed |= (uint64_t)group->given[1 + i] != group->texts[i]->print;
    return changed;
}

static void note_given(const Element *element, const Group *group)
{
    memcpy(group->given + 1, group->room, (size_t)group->n_values * size_of(group->type));
    group->given[0] = element->life;
}

static void note_given_text(const Element *element, const TextGroup *group)
{
    for (int64_t i = 0; i < group->n_values; i++)
        group->given[1 + i] = (int64_t)group->texts[i]->print;
    group->given[0] = element->life;
}

/* Before step mode every input may be set at any time; the event iteration after the initialization processes it. */
static bool write_before_events(System *system, const Element *element, const Groups *groups)
{
    if (!write_some(system, groups, UNFIT_INPUT))
        return false;
    for (const Group *group = groups->fmi2; group < groups->end; group++)
        if (group->given)
            note_given(element, group);
    for (const TextGroup *group = groups->texts; group < groups->no_texts; group++)
        if (group->given)
            note_given_text(element, group);
    return true;
}

static bool give(System *system, const Element *element, const Group *group)
{
    if (!call_fmi3(system, system->progress, group))
        return false;
    note_given(element, group);
    return true;
}

static bool give_text(System *system, const Element *element, const TextGroup *group)
{
    if (!write_text_group(system, group))
        return false;
    note_given_text(element, group);
    return true;
}

/* In step mode: changed discrete inputs are set in an event, all others directly. */
static bool write_around_event(System *system, Element *element, const Groups *groups)
{
    bool changed = false;
    for (Group *const *group = groups->converted; *group; group++)
        if (!narrow_checked(system, *group, UNFIT_INPUT))
            return false;
    for (const Group *group = groups->fmi2; group < groups->end; group++) {
        changed |= is_changed(element, group);
        if (!group->given && !call_fmi3(system, system->progress, group))
            return false;
    }
    for (const TextGroup *group = groups->texts; group < groups->no_texts; group++) {
        changed |= is_changed_text(element, group);
        if (!group->given && !write_text_group(system, group))
            return false;
    }
    if (!changed)
        return true;
    if (!call_plain(system, element, ENTER_EVENT_MODE, element->enter_event_mode))
        return false;
    for (const Group *group = groups->fmi2; group < groups->end; group++)
        if (is_changed(element, group) && !give(system, element, group))
            return false;
    for (const TextGroup *group = groups->texts; group < groups->no_texts; group++)
        if (is_changed_text(element, group) && !give_text(system, element, group))
            return false;
    return leave_event_mode(system, element);
}

/* The record of given inputs is saved with the FMU's state: after a restore no input is written twice. */
static void save_given(const Groups *inputs)
{
    for (const Group *group = inputs->fmi2; group < inputs->end; group++)
        if (group->given)
            memcpy(group->given + words_of(group), group->given, words_of(group) * sizeof(int64_t));
    for (const TextGroup *group = inputs->texts; group < inputs->no_texts; group++)
        if (group->given)
            memcpy(group->given + words_of_text(group), group->given, words_of_text(group) * sizeof(int64_t));
}

static void restore_given(const Groups *inputs)
{
    for (const Group *group = inputs->fmi2; group < inputs->end; group++)
        if (group->given)
            memcpy(group->given, group->given + words_of(group), words_of(group) * sizeof(int64_t));
    for (const TextGroup *group = inputs->texts; group < inputs->no_texts; group++)
        if (group->given)
            memcpy(group->given, group->given + words_of_text(group), words_of_text(group) * sizeof(int64_t));
}

#endif
