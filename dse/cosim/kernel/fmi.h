/* The functions of FMI 1.0, 2.0 and 3.0 that the co-simulation kernel calls: the signatures of the standards, chapter 3
 * of FMI for Co-Simulation 1.0, chapter 4 of FMI 2.0.4 and chapters 2 and 4 of FMI 3.0.1, written for this kernel. */
#ifndef DSE_COSIM_FMI_H
#define DSE_COSIM_FMI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Both versions use 0 OK, 1 Warning, 2 Discard, 3 Error, 4 Fatal; FMI 2 also has 5 Pending. */
enum { FMI_OK, FMI_WARNING, FMI_DISCARD, FMI_ERROR, FMI_FATAL, FMI_PENDING };

enum { FMI2_MODEL_EXCHANGE, FMI2_CO_SIMULATION };

/* Status kinds of fmi2GetStatus and similar functions; FMI 1.0 has the first three. */
enum { FMI_STEP_STATUS, FMI_PENDING_STATUS, FMI_LAST_SUCCESSFUL_TIME, FMI_TERMINATED };

/* Any FMI function; it is cast to its own type before it is called. */
typedef void (*FmiFunction)(void);

/* get and set of one type; values points to double, int32_t, bool, … depending on the type. */
typedef int (*Fmi2Access)(void *, const uint32_t *, size_t, void *);
typedef int (*Fmi3Access)(void *, const uint32_t *, size_t, void *, size_t);

typedef int (*Fmi3GetBinary)(void *, const uint32_t *, size_t, size_t *, const void **, size_t);
typedef int (*Fmi3SetBinary)(void *, const uint32_t *, size_t, const size_t *, const void *const *, size_t);

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

/* Given by value, and without an environment. */
typedef struct {
    Fmi2Log log;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
} Fmi1Callbacks;

typedef void *(*Fmi1Instantiate)(const char *name, const char *token, const char *location, const char *mime_type,
                                 double timeout, char visible, char interactive, Fmi1Callbacks, char logging);
typedef int (*Fmi1Initialize)(void *, double start, char has_stop, double stop);
typedef int (*Fmi1DoStep)(void *, double time, double step, char is_new);

typedef void *(*Fmi2Instantiate)(const char *name, int type, const char *token, const char *resources,
                                 const Fmi2Callbacks *, int visible, int logging);
typedef int (*Fmi2SetupExperiment)(void *, int has_tolerance, double tolerance, double start, int has_stop,
                                   double stop);
typedef int (*Fmi2DoStep)(void *, double time, double step, int no_rollback);

/* Also of FMI 1.0. */
typedef int (*Fmi2GetStatus)(void *, int what, int *);
typedef int (*Fmi2GetRealStatus)(void *, int what, double *);
typedef int (*Fmi2SetDerivatives)(void *, const uint32_t *, size_t, const int32_t *orders, const double *);

/* States of FMI 2 and 3. */
typedef int (*FmiGetState)(void *, void **);
typedef int (*FmiSetState)(void *, void *);

typedef int (*Fmi2Directional)(void *, const uint32_t *unknowns, size_t, const uint32_t *knowns, size_t,
                               const double *seed, double *sensitivity);
typedef int (*Fmi3Directional)(void *, const uint32_t *unknowns, size_t, const uint32_t *knowns, size_t,
                               const double *seed, size_t, double *sensitivity, size_t);

typedef void (*Fmi3Between)(void *, double time, bool set_requested, bool get_allowed, bool step_finished,
                           bool can_return_early, bool *return_early, double *return_time);
typedef int (*Fmi3UpdateStates)(void *, bool *again, bool *terminate, bool *nominals_changed, bool *states_changed,
                                bool *has_next_event, double *next_event);

typedef int (*Fmi3Clocks)(void *, const uint32_t *, size_t, bool *);
typedef int (*Fmi3GetInterval)(void *, const uint32_t *, size_t, double *intervals, int *qualifiers);
typedef int (*Fmi3GetIntervalFraction)(void *, const uint32_t *, size_t, uint64_t *counters, uint64_t *resolutions,
                                       int *qualifiers);
typedef int (*Fmi3GetShift)(void *, const uint32_t *, size_t, double *shifts);
typedef int (*Fmi3GetShiftFraction)(void *, const uint32_t *, size_t, uint64_t *counters, uint64_t *resolutions);

/* Interval qualifiers of fmi3GetInterval… */
enum { NOT_YET_KNOWN, UNCHANGED, CHANGED };

typedef void *(*Fmi3Instantiate)(const char *name, const char *token, const char *resources, bool visible, bool logging,
                                 bool event_mode, bool early_return, const uint32_t *intermediate,
                                 size_t n_intermediate, void *environment, Fmi3Log, Fmi3Between);
typedef int (*Fmi3EnterInitialization)(void *, bool has_tolerance, double tolerance, double start, bool has_stop,
                                       double stop);
typedef int (*Fmi3DoStep)(void *, double time, double step, bool no_rollback, bool *event_needed, bool *terminate,
                          bool *early_return, double *reached);

#endif
