/* What FMUs log: the last lines of each element. */
#ifndef DSE_COSIM_LOG_H
#define DSE_COSIM_LOG_H

#include "kernel.h"

#include <stdarg.h>
#include <stdio.h>

/* Loggers of FMI 1.0 are not told whose line it is: it is the element's this thread is calling. */
static _Thread_local const System *calling;

static Log nobodys; /* of lines that come after their element is gone */

static char *next_line(Log *log)
{
    /* FMUs log from threads of their own: a line may be overwritten, never the memory beside it. */
    if (!log)
        log = &nobodys;
    return log->lines[__atomic_fetch_add(&log->count, 1, __ATOMIC_RELAXED) % LOG_LINES];
}

static void keep_fmi1_line(void *instance, const char *name, int status, const char *category, const char *format, ...)
{
    (void)instance, (void)name, (void)status, (void)category;
    if (!calling || !format)
        return;
    va_list values;
    va_start(values, format);
    vsnprintf(next_line(calling->elements[calling->progress->place.element].log), LOG_WIDTH, format, values);
    va_end(values);
}

static void keep_fmi2_line(void *environment, const char *name, int status, const char *category,
                           const char *format, ...)
{
    (void)name, (void)status, (void)category;
    if (!environment || !format)
        return;
    va_list values;
    va_start(values, format);
    vsnprintf(next_line(((Element *)environment)->log), LOG_WIDTH, format, values);
    va_end(values);
}

static void keep_fmi3_line(void *environment, int status, const char *category, const char *message)
{
    (void)status, (void)category;
    if (environment && message)
        snprintf(next_line(((Element *)environment)->log), LOG_WIDTH, "%s", message);
}

#endif
