/* How a system is initialized and, unless it is a plain one, simulated: tables of operations that
 * dse/cosim/tables/method.py compiles. dse/cosim/binding/plan_layout.py mirrors every structure, field by field.
 *
 * Terms: an element *shows* its outputs at the end of its own step; they are valid until it shows again. Values *meet*
 * at communication points: they are passed on there. */
#ifndef DSE_COSIM_PLAN_H
#define DSE_COSIM_PLAN_H

#include "kernel.h"

enum { READ, WRITE, SOLVE };

/* Behaviour of an input during a step. */
enum { HELD, MIDDLE, SLOPED };

typedef struct Loop Loop;

typedef struct {
    int64_t kind, element;
    Groups groups;
    int64_t first, count; /* WRITE: its part of the plan's staged inputs */
    Loop *loop;           /* SOLVE */
} Operation;

typedef struct {
    const Operation *begin, *end;
} Sweep;

/* Outputs that depend on each other. A sweep computes all from the torn ones, including the torn ones. */
struct Loop {
    Sweep sweep;
    const int32_t *torn; /* positions among the values, those of continuous numbers first */
    int64_t n_reals, n_torn;
    int64_t sweeps; /* this number settles a loop that is not a real loop */
    int64_t number, has_texts;
    const double *nominals; /* of the real ones */
    double *room;           /* 5 n_torn doubles */
    double *rows, *way; /* of the real ones: factors, and the remaining correction */
    uint32_t *pivots;
};

/* An element's own step: *parts* of them per step of the run, or one per *every* steps. */
typedef struct {
    int64_t every, parts, has_slopes;
    Operation inputs; /* all of them */
} Pace;

/* Power between two elements: two values and the inputs they end at. */
typedef struct {
    int64_t effort, flow, effort_used, flow_used;
} Bond;

typedef struct {
    int64_t column, bond;
} BondColumn;

/* ---- clocks (FMI 3.0.2, 2.2.8) ---- */

enum { CONSTANT, FIXED, TUNABLE, CHANGING, COUNTDOWN, TRIGGERED }; /* all except TRIGGERED tick by themselves */

typedef struct {
    int64_t element, reference, kind;
    FmiFunction access, get_interval, get_shift; /* get or set; the fraction's functions if it *has_fractions* */
    int64_t has_fractions, is_told;
    double interval, shift, resolution; /* if is_told: tick n is at (shift + n interval)/resolution */
    const int64_t *sources;             /* the clocks it ticks with */
    int64_t n_sources;
    /* In a run: as above since its first tick or the last change; the time of the next tick (infinite for never or
     * unknown) and the number of the last tick. */
    double period, first, parts, next;
    int64_t ticks;
    /* In an instant: whether it ticks, whether its element has been informed, and the value of the element's *news*
     * when it was last polled. */
    int64_t is_active, is_set, asked_at;
    int64_t count; /* number of ticks in the run, by itself or with others */
} Clock;

enum { POLL, TICK, SAMPLE, DELIVER };

/* An operation of an instant on a clock or a variable with clocks. */
typedef struct {
    int64_t act, element, clock;
    const int64_t *clocks; /* one of which must tick, if there are any */
    int64_t n_clocks;
    const int64_t *sources; /* DELIVER: the steps that sample its sources */
    int64_t n_sources, is_message;
    Operation operation;     /* SAMPLE: a read, DELIVER: a write */
    int64_t first, n_values; /* SAMPLE: position in the values, and room for these */
    double *before;
    int64_t stamp, read_at; /* SAMPLE: order of the last change and of the last read, 0 for none */
    int64_t bytes;          /* SAMPLE of a message: sum over the run */
} ClockStep;

/* A column that records ticks or bytes. */
typedef struct {
    int64_t column;
    int64_t *counter;
} CountColumn;

/* Elements that stop together whenever one of their clocks ticks, in the order of their steps. */
typedef struct {
    const int64_t *elements;
    int64_t n_elements, leader; /* the element that runs the whole group */
    Clock *clocks, *no_clocks;
    ClockStep *steps, *no_steps;
} ClockGroup;

/* An element with clocks: whether it is in event mode, whether it is due, and the order of its last input. */
typedef struct {
    int64_t in_events, is_due, news;
} Ticking;

typedef struct {
    Sweep initial, meeting;
    Sweep doubtful; /* reads of outputs that were wrong in the initial sweep if an FMU's dependencies are wrong */
    Sweep untold;   /* the initial sweep without the FMUs' dependencies; empty until needed */
    const int32_t *doubted; /* positions of those outputs, continuous numbers first */
    int64_t n_doubted_reals, n_doubted;
    const double *doubted_nominals; /* of the continuous ones */
    double *passed_on;              /* room for n_doubted */
    int64_t is_sequential, n_leading;
    const Pace *paces;     /* one per element */
    const int32_t *owners; /* the element of each value */
    double *staged, *slopes; /* inputs from their sources, and their rates */
    const int32_t *sources;  /* staged[i] comes from values[sources[i]] */
    const int32_t *moves;    /* HELD, MIDDLE or SLOPED */
    double *used;            /* mean of each staged input in the last step */
    const int32_t *watched; /* values that must stay finite and within their limits */
    int64_t n_watched;
    const double *nominals; /* of the watched ones */
    double *limits;
    const Bond *bonds;
    int64_t n_bonds;
    const BondColumn *bond_columns; /* columns that record their energies */
    int64_t n_bond_columns;
    /* The past: data that a rollback restores in addition to the values. */
    double *past;
    int64_t n_past;
    double *before;        /* the values shown before the present ones */
    double *shown, *spans; /* when each element showed its outputs, and the time since it showed them before */
    double *energies;
    double *met; /* effort and flow of each bond at the start of their elements' steps */
    /* Error control; *tolerance* is 0 without. */
    double tolerance, absolute, smallest;
    const int32_t *compared;
    int64_t n_compared;
    double *magnitudes, *coarse; /* of the compared ones: largest so far, found by one step */
    double *kept;                /* n_values + n_past */
    int64_t reads_again;         /* after a rollback: texts are not part of the values */
    int64_t k;                   /* communication point */
    const ClockGroup *groups;
    int64_t n_groups;
    const int32_t *group_of; /* of each element, -1 for none */
    Clock *clocks;
    ClockStep *clock_steps;
    Ticking *ticking;  /* of each element */
    const CountColumn *count_columns;
    int64_t n_count_columns;
    int64_t instant;   /* counts its operations */
    double spare;      /* ticks within this time, in seconds, are simultaneous */
} Plan;

#endif
