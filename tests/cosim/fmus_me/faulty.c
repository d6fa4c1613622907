/* Goes wrong from a time on: reals x, x', time; wholes how: 1 derivative not a number, 2 indicator not a number, 3
 * derivatives refused, 4 an error, 5 an event iteration without end, 6 time events without end, 7 x grows beyond all
 * bounds, 8 state not a number after an event, 9 next event not a number. */
#define STATES 1
#define INDICATORS 1
#define REALS 3
#define WHOLES 1
#include "exchange_fmu.h"

static void start(Model *m) {}
static int derive(Model *m)
{
    const int how = m->time >= m->reals[2] ? m->wholes[0] : 0;
    m->reals[1] = how == 1 ? NAN : how == 7 ? 1.0 + 1e3 * m->reals[0] * m->reals[0] : 1.0;
    if (how == 4)
        return wrong(m, "the road has ended");
    return how == 3 ? DISCARD : OK;
}
static void indicate(const Model *m, double *indicators)
{
    indicators[0] = m->wholes[0] == 2 && m->time >= m->reals[2] ? NAN : 1.0;
}
static void update(Model *m, News *news)
{
    const int is_due = m->time >= m->reals[2];
    news->again = m->wholes[0] == 5 && is_due;
    news->has_next = m->wholes[0] == 6 || m->wholes[0] == 9 || ((m->wholes[0] == 5 || m->wholes[0] == 8) && !is_due);
    news->next = m->wholes[0] == 9 && is_due ? NAN : m->reals[2];
    if (m->wholes[0] == 8 && is_due) {
        m->reals[0] = NAN;
        news->states_changed = 1;
    }
}
