/* The benchmark's loop written out by hand: the same FMI calls and the same recording as the kernel makes, with the
 * wiring in the code instead of in tables.
 *
 * plain RUNS, then library and token of lead, radar, controller, vehicle; prints the seconds the runs took and the
 * last row of the last run. Value references come from the compiler's command line: -DLEAD_X=… */
#define _POSIX_C_SOURCE 200809L
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { LEAD, RADAR, CONTROLLER, VEHICLE, PARTS };
enum { STEPS = 6000, RECORDED = 10 };
static const double STOP = 60.0, STEP = 0.01;

typedef struct {
    void (*log)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

typedef struct {
    void *instance;
    int (*get_real)(void *, const uint32_t *, size_t, double *);
    int (*set_real)(void *, const uint32_t *, size_t, const double *);
    int (*get_boolean)(void *, const uint32_t *, size_t, int *);
    int (*set_boolean)(void *, const uint32_t *, size_t, const int *);
    int (*do_step)(void *, double, double, int);
    int (*reset)(void *);
    int (*set_up)(void *, int, double, double, int, double);
    int (*enter)(void *);
    int (*leave)(void *);
    int (*terminate)(void *);
} Part;

static Part part[PARTS];
static const uint32_t LEAD_OUT[] = {LEAD_X, LEAD_V, LEAD_A};
static const uint32_t RADAR_OUT[] = {RADAR_GAP, RADAR_CLOSING_SPEED}, RADAR_TRUTH[] = {RADAR_DETECTED};
static const uint32_t RADAR_IN[] = {RADAR_EGO_X, RADAR_EGO_V, RADAR_LEAD_X, RADAR_LEAD_V};
static const uint32_t CONTROLLER_OUT[] = {CONTROLLER_DEMAND}, CONTROLLER_TRUTH[] = {CONTROLLER_DETECTED};
static const uint32_t CONTROLLER_IN[] = {CONTROLLER_GAP, CONTROLLER_CLOSING_SPEED, CONTROLLER_SPEED};
static const uint32_t GAINS[] = {CONTROLLER_KP_SPEED, CONTROLLER_KD_SPEED, CONTROLLER_KP_GAP, CONTROLLER_KD_GAP};
static const uint32_t VEHICLE_OUT[] = {VEHICLE_X, VEHICLE_V, VEHICLE_A}, VEHICLE_IN[] = {VEHICLE_DEMAND};

static double lead[3], radar[2], demand, vehicle[3];
static int detected;

static void check(int status)
{
    if (status > 1) {
        fprintf(stderr, "an FMI call returned %d\n", status);
        exit(1);
    }
}

static void ignore(void *environment, const char *name, int status, const char *category, const char *message, ...)
{
    (void)environment, (void)name, (void)status, (void)category, (void)message;
}

static void read_all(void)
{
    check(part[LEAD].get_real(part[LEAD].instance, LEAD_OUT, 3, lead));
    check(part[RADAR].get_real(part[RADAR].instance, RADAR_OUT, 2, radar));
    check(part[RADAR].get_boolean(part[RADAR].instance, RADAR_TRUTH, 1, &detected));
    check(part[CONTROLLER].get_real(part[CONTROLLER].instance, CONTROLLER_OUT, 1, &demand));
    check(part[VEHICLE].get_real(part[VEHICLE].instance, VEHICLE_OUT, 3, vehicle));
}

static void write_all(void)
{
    double to_radar[] = {vehicle[0], vehicle[1], lead[0], lead[1]}, to_controller[] = {radar[0], radar[1], vehicle[1]};
    check(part[RADAR].set_real(part[RADAR].instance, RADAR_IN, 4, to_radar));
    check(part[CONTROLLER].set_real(part[CONTROLLER].instance, CONTROLLER_IN, 3, to_controller));
    check(part[CONTROLLER].set_boolean(part[CONTROLLER].instance, CONTROLLER_TRUTH, 1, &detected));
    check(part[VEHICLE].set_real(part[VEHICLE].instance, VEHICLE_IN, 1, &demand));
}

static void run(int number, double *row)
{
    const double gains[] = {0.5 + 0.0005 * number, 0.05, 0.12, 0.9};
    for (Part *p = part; p < part + PARTS; p++) {
        if (number)
            check(p->reset(p->instance));
        check(p->set_up(p->instance, 0, 0.0, 0.0, 1, STOP));
        if (p == part + CONTROLLER)
            check(p->set_real(p->instance, GAINS, 4, gains));
        check(p->enter(p->instance));
    }
    for (int sweep = 0; sweep < 4; sweep++) {
        read_all();
        write_all();
    }
    for (Part *p = part; p < part + PARTS; p++)
        check(p->leave(p->instance));
    for (int k = 0;; k++, row += RECORDED) {
        read_all();
        row[0] = lead[0], row[1] = lead[1], row[2] = lead[2], row[3] = radar[0], row[4] = radar[1];
        row[5] = detected ? 1.0 : 0.0, row[6] = demand, row[7] = vehicle[0], row[8] = vehicle[1], row[9] = vehicle[2];
        if (k == STEPS)
            break;
        write_all();
        for (Part *p = part; p < part + PARTS; p++)
            check(p->do_step(p->instance, k * STEP, STEP, 1));
    }
    for (Part *p = part; p < part + PARTS; p++)
        check(p->terminate(p->instance));
}

static void load(Part *p, const char *library, const char *token)
{
    static const Callbacks callbacks = {ignore, calloc, free, NULL, NULL};
    void *loaded = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (!loaded) {
        fprintf(stderr, "%s\n", dlerror());
        exit(1);
    }
#define FIND(field, name) *(void **)&p->field = dlsym(loaded, name)
    FIND(get_real, "fmi2GetReal");
    FIND(set_real, "fmi2SetReal");
    FIND(get_boolean, "fmi2GetBoolean");
    FIND(set_boolean, "fmi2SetBoolean");
    FIND(do_step, "fmi2DoStep");
    FIND(reset, "fmi2Reset");
    FIND(set_up, "fmi2SetupExperiment");
    FIND(enter, "fmi2EnterInitializationMode");
    FIND(leave, "fmi2ExitInitializationMode");
    FIND(terminate, "fmi2Terminate");
    void *(*make)(const char *, int, const char *, const char *, const Callbacks *, int, int);
    *(void **)&make = dlsym(loaded, "fmi2Instantiate");
    p->instance = make("part", 1, token, "file:///", &callbacks, 0, 0);
    if (!p->instance) {
        fprintf(stderr, "%s: no instance\n", library);
        exit(1);
    }
}

int main(int count, char **arguments)
{
    if (count != 2 + 2 * PARTS)
        return 2;
    const int runs = atoi(arguments[1]);
    double *out = malloc((STEPS + 1) * RECORDED * sizeof(double));
    for (int i = 0; i < PARTS; i++)
        load(part + i, arguments[2 + 2 * i], arguments[3 + 2 * i]);
    run(0, out); /* as the kernel's side has made its first runs before the clock starts */
    struct timespec before, after;
    clock_gettime(CLOCK_MONOTONIC, &before);
    for (int number = 1; number <= runs; number++)
        run(number, out);
    clock_gettime(CLOCK_MONOTONIC, &after);
    printf("%.9f\n", (double)(after.tv_sec - before.tv_sec) + 1e-9 * (double)(after.tv_nsec - before.tv_nsec));
    for (int i = 0; i < RECORDED; i++)
        printf("%a\n", out[STEPS * RECORDED + i]);
    return 0;
}
