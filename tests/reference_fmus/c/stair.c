/* counter goes up by 1 each second; from the last one on there is nothing to simulate. */
static bool initialize(Instance *m)
{
    m->state.next_event = 1;
    return true;
}
static void calculate(Values *v) { (void)v; }
static void update(State *s, Update *what)
{
    if (s->values.time >= s->next_event - 1e-9) {
        s->values.counter++;
        s->next_event += 1;
    }
    what->ends = s->values.counter >= s->values.last;
}
