/* Steps of co-simulation: the classical Runge-Kutta method of fourth order, events located by bisection. */

static void slope(Values *v, double time, double *x, double *dx)
{
    v->time = time;
    move_states(v, 0, x, true);
    calculate(v);
    move_states(v, 1, dx, false);
}

static void advance(Values *v, double h)
{
    double x[MOST_STATES], at[MOST_STATES], k[4][MOST_STATES];
    size_t n = n_states(v);
    double time = v->time;
    move_states(v, 0, x, false);
    slope(v, time, x, k[0]);
    for (int stage = 1; stage < 4; stage++) {
        double c = stage == 3 ? 1.0 : 0.5;
        for (size_t i = 0; i < n; i++)
            at[i] = x[i] + c * h * k[stage - 1][i];
        slope(v, time + c * h, at, k[stage]);
    }
    for (size_t i = 0; i < n; i++)
        at[i] = x[i] + h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
    slope(v, time + h, at, k[0]);
}

static bool crossed(const State *s)
{
#if N_INDICATORS
    double z[N_INDICATORS];
    indicators(&s->values, z);
    for (int i = 0; i < N_INDICATORS; i++)
        if ((s->before[i] > 0) != (z[i] > 0))
            return true;
#endif
    (void)s;
    return false;
}

static void remember_indicators(State *s)
{
    refresh(s);
#if N_INDICATORS
    indicators(&s->values, s->before);
#endif
    (void)s;
}

/* All passes of event handling; true if the FMU asks to end the simulation. */
static bool handle_events(State *s)
{
    bool ends = false;
    for (bool again = true; again;) {
        Update what = {0};
        update(s, &what);
        again = what.again;
        ends |= what.ends;
    }
    s->stale = true;
    remember_indicators(s);
    return ends;
}

/* Advances to *end* at most; true if it stopped because of an event, at the event. */
static bool advance_until(State *s, double end)
{
    while (s->values.time < end) {
        /* An event that a rounding error puts behind the communication point still belongs to this step. */
        bool due = s->next_event <= end + 1e-9 * (1 + fabs(end));
        double left = (due ? s->next_event : end) - s->values.time;
        double steps = ceil(left / LARGEST_STEP - 1e-6);
        double h = steps > 1 ? left / steps : left;
        bool last = steps <= 1;
        State before = *s;
        advance(&s->values, h);
        if (last)
            s->values.time = due ? s->next_event : end;
        if (crossed(s)) {
            double low = 0, high = h; /* it happens after low and not after high */
            while (high - low > 4 * DBL_EPSILON * (1 + before.values.time)) {
                double middle = low + (high - low) / 2;
                *s = before;
                advance(&s->values, middle);
                *(crossed(s) ? &high : &low) = middle;
            }
            *s = before;
            advance(&s->values, high);
            s->stale = false;
            return true;
        }
        s->stale = false;
        if (s->values.time >= s->next_event)
            return true;
    }
    return false;
}
