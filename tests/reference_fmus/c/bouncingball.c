/* h'' = g; at h = 0 the speed is turned round and loses a part; slower than v_min, the ball stays where it is. */
static bool initialize(Instance *m) { return m != NULL; }
static void calculate(Values *v)
{
    v->der_h = v->v;
    v->der_v = v->resting ? 0 : v->g;
    v->z = v->resting ? 1 : v->h;
}
static void indicators(const Values *v, double *z) { z[0] = v->z; }
static void update(State *s, Update *what)
{
    Values *v = &s->values;
    if (v->resting || v->h > 0 || v->v >= 0)
        return;
    v->h = DBL_MIN; /* an event indicator must not be 0 when integration goes on (FMI 2.0.4, 3.1.1) */
    v->v = -v->e * v->v;
    v->bounces++;
    v->resting = v->v < v->v_min;
    if (v->resting)
        v->v = 0;
    what->states_changed = true;
}
