/* x0' = x1, x1' = mu (1 - x0^2) x1 - x0 */
#define HAS_PARTIAL
static bool initialize(Instance *m) { return m != NULL; }
static void calculate(Values *v)
{
    v->der_x0 = v->x1;
    v->der_x1 = v->mu * ((1 - v->x0 * v->x0) * v->x1) - v->x0;
}
static void update(State *s, Update *what) { (void)s, (void)what; }
static double partial(const Values *v, unsigned unknown, unsigned known)
{
    if (unknown == VR_der_x0)
        return known == VR_x1;
    if (unknown != VR_der_x1)
        return 0;
    return known == VR_x0 ? -2 * v->mu * v->x0 * v->x1 - 1 : known == VR_x1 ? v->mu * (1 - v->x0 * v->x0) : 0;
}
