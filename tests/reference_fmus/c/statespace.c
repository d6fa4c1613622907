/* x' = A x + B u, y = C x + D u, x(0) = x0; sizes are structural parameters, matrices lie row by row. */
#define HAS_RESIZED

/* With new sizes come new starts: identity matrices, x0 and u count from 1. */
static void resized(Values *v)
{
    double *matrices[] = {v->A, v->B, v->C, v->D};
    uint64_t rows[] = {v->n, v->n, v->r, v->r}, columns[] = {v->n, v->m, v->n, v->m};
    for (int k = 0; k < 4; k++)
        for (uint64_t i = 0; i < rows[k]; i++)
            for (uint64_t j = 0; j < columns[k]; j++)
                matrices[k][i * columns[k] + j] = i == j;
    for (int i = 0; i < 5; i++)
        v->x0[i] = v->u[i] = i + 1;
}
static bool initialize(Instance *m)
{
    memcpy(m->state.values.x, m->state.values.x0, sizeof m->state.values.x);
    m->state.stale = true;
    return true;
}
static void times(double *to, const double *matrix, const double *x, uint64_t rows, uint64_t columns)
{
    for (uint64_t i = 0; i < rows; i++)
        for (uint64_t j = 0; j < columns; j++)
            to[i] += matrix[i * columns + j] * x[j];
}
static void calculate(Values *v)
{
    memset(v->der_x, 0, sizeof v->der_x);
    memset(v->y, 0, sizeof v->y);
    times(v->der_x, v->A, v->x, v->n, v->n);
    times(v->der_x, v->B, v->u, v->n, v->m);
    times(v->y, v->C, v->x, v->r, v->n);
    times(v->y, v->D, v->u, v->r, v->m);
}
static void update(State *s, Update *what) { (void)s, (void)what; }
