/* FMI 2 with binaries as the OSI Sensor Model Packaging has them: y is the sum of the bytes it was given, read in the step.
 * What it shows is up to *mode*: its own bytes, *size* of them and other ones each time, in two rooms in turn; the address
 * that it was given itself; or what nobody must follow. */
#include "fmu.h"
enum { MODE, SIZE, IN_LO, IN_HI, IN_SIZE, OUT_LO, OUT_HI, OUT_SIZE, SUM };
enum { OWN, FORWARD, NOWHERE, LESS_THAN_NONE, TOO_LARGE };
static void set_defaults(Model *m) { memset(m->value, 0, sizeof m->value); }
static int reset(Model *m) { return set_defaults(m), OK; }
static void show(Model *m, const void *bytes, double size)
{
    const uint64_t at = (uint64_t)(uintptr_t)bytes;
    m->value[OUT_LO] = (int32_t)(uint32_t)at, m->value[OUT_HI] = (int32_t)(uint32_t)(at >> 32), m->value[OUT_SIZE] = size;
}
static int initialize(Model *m) { return show(m, NULL, 0), OK; }
static int step(Model *m, double time, double h)
{
    static uint8_t rooms[2][1 << 20];
    const size_t size = (size_t)m->value[SIZE];
    const int k = (int)(time / h + 1.5);
    const uint64_t lower = (uint32_t)(int32_t)m->value[IN_LO], upper = (uint32_t)(int32_t)m->value[IN_HI];
    const uint8_t *given = (const uint8_t *)(uintptr_t)(upper << 32 | lower);
    m->value[SUM] = 0;
    for (int i = 0; given && i < (int)m->value[IN_SIZE]; i++)
        m->value[SUM] += given[i];
    switch ((int)m->value[MODE]) {
    case OWN:
        memset(rooms[(k + 1) % 2], 255, sizeof *rooms); /* who still looks there sees it */
        for (size_t i = 0; i < size * (size_t)k; i++)
            rooms[k % 2][i] = (uint8_t)(k + (int)i);
        show(m, rooms[k % 2], (double)size * k);
        break;
    case FORWARD: show(m, given, m->value[IN_SIZE]); break;
    case NOWHERE: show(m, NULL, 5); break;
    case LESS_THAN_NONE: show(m, rooms, -1); break;
    default: show(m, rooms, (double)(16 << 20) + 1); break;
    }
    return OK;
}
