/* What the co-simulation kernel calls of FMI 2.0 and FMI 3.0: the signatures of the two standards, chapter 4 of
 * FMI 2.0.4 and chapters 2 and 4 of FMI 3.0.1, written down for scalar variables and this kernel alone. */
#ifndef DSE_COSIM_FMI_H
#define DSE_COSIM_FMI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Both versions count 0 OK, 1 Warning, 2 Discard, 3 Error, 4 Fatal; FMI 2 knows 5 Pending besides. */
enum { FMI_OK, FMI_WARNING, FMI_DISCARD, FMI_ERROR, FMI_FATAL, FMI_PENDING };

enum { FMI2_CO_SIMULATION = 1 };

/* Any FMI function; it is cast to its own type before it is called. */
typedef void (*FmiFunction)(void);

/* get and set of one type; values point at double, int32_t, bool, … as the type has it. */
typedef int (*Fmi2Access)(void *, const uint32_t *, size_t, void *);
typedef int (*Fmi3Access)(void *, const uint32_t *, size_t, void *, size_t);

/* Functions that take the instance alone: Reset, Terminate, ExitInitializationMode, fmi2EnterInitializationMode. */
typedef int (*FmiPlain)(void *);
typedef void (*FmiFree)(void *);

typedef void (*Fmi2Log)(void *, const char *, int, const char *, const char *, ...);
typedef void (*Fmi3Log)(void *, int, const char *, const char *);

typedef struct {
    Fmi2Log log;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} Fmi2Callbacks;

typedef void *(*Fmi2Instantiate)(const char *name, int type, const char *token, const char *resources,
                                 const Fmi2Callbacks *, int visible, int logging);
typedef int (*Fmi2SetupExperiment)(void *, int has_tolerance, double tolerance, double start, int has_stop,
                                   double stop);
typedef int (*Fmi2DoStep)(void *, double time, double step, int no_rollback);

typedef void *(*Fmi3Instantiate)(const char *name, const char *token, const char *resources, bool visible, bool logging,
                                 bool event_mode, bool early_return, const uint32_t *intermediate,
                                 size_t n_intermediate, void *environment, Fmi3Log, FmiFunction intermediate_update);
typedef int (*Fmi3EnterInitialization)(void *, bool has_tolerance, double tolerance, double start, bool has_stop,
                                       double stop);
typedef int (*Fmi3DoStep)(void *, double time, double step, bool no_rollback, bool *event_needed, bool *terminate,
                          bool *early_return, double *reached);

#endif
