/* x' = -k x */
#define HAS_PARTIAL
static bool initialize(Instance *m) { return m != NULL; }
static void calculate(Values *v) { v->der_x = -v->k * v->x; }
static void update(State *s, Update *what) { (void)s, (void)what; }
static double partial(const Values *v, unsigned unknown, unsigned known)
{
    return unknown == VR_der_x && known == VR_x ? -v->k : 0;
}
