/* Log messages of FMUs: the last lines of each element. */
#ifndef DSE_COSIM_LOG_H
#define DSE_COSIM_LOG_H

#include "kernel.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static _Thread_local const System *calling; /* by this thread */

static Log nobodys; /* lines that arrive after their element was freed */

/* Elements whose addresses were given to FMUs, permanently: their memory is never freed. */
typedef struct Lent {
    const Element *first, *end;
    struct Lent *before;
} Lent;
static Lent *lent;

static void lend(const System *system)
{
    Lent *known = __atomic_load_n(&lent, __ATOMIC_ACQUIRE);
    for (const Lent *each = known; each; each = each->before)
        if (each->first == system->elements)
            return;
    Lent *new = malloc(sizeof *new);
    if (!new)
        return; /* then the FMU's callbacks are treated as if with another address */
    *new = (Lent){system->elements, system->elements + system->n_elements, known};
    while (!__atomic_compare_exchange_n(&lent, &new->before, new, false, __ATOMIC_RELEASE, __ATOMIC_ACQUIRE))
        ;
}

/* The element of a callback. Some FMUs do not pass the environment they were given, but their own instance or a
 * constant. Then, as in FMI 1.0, it is the element that this thread is calling; NULL if it calls none. */
static Element *element_of(void *environment)
{
    for (const Lent *each = __atomic_load_n(&lent, __ATOMIC_ACQUIRE); each; each = each->before) {
        const uintptr_t at = (uintptr_t)environment - (uintptr_t)each->first;
        if ((uintptr_t)environment >= (uintptr_t)each->first && (uintptr_t)environment < (uintptr_t)each->end &&
            at % sizeof(Element) == 0)
            return environment;
    }
    return calling ? &calling->elements[calling->progress->place.element] : NULL;
}

static char *next_line(const Element *element)
{
    /* FMUs log from their own threads: a line may be overwritten, but never the memory beside it. */
    Log *log = element && element->log ? element->log : &nobodys;
    return log->lines[__atomic_fetch_add(&log->count, 1, __ATOMIC_RELAXED) % LOG_LINES];
}

/* For FMI 2, whose first argument is *environment*, and for FMI 1.0, whose first argument is the instance. */
static void keep_fmi2_line(void *environment, const char *name, int status, const char *category,
                           const char *format, ...)
{
    (void)name, (void)status, (void)category;
    if (!format)
        return;
    va_list values;
    va_start(values, format);
    vsnprintf(next_line(element_of(environment)), LOG_WIDTH, format, values);
    va_end(values);
}

static void keep_fmi3_line(void *environment, int status, const char *category, const char *message)
{
    (void)status, (void)category;
    if (message)
        snprintf(next_line(element_of(environment)), LOG_WIDTH, "%s", message);
}

#endif
