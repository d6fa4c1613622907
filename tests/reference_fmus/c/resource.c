/* y is the number in resources/y.txt. */
static bool initialize(Instance *m)
{
    char path[4096];
    size_t length = strlen(m->resources);
    bool ends_in_slash = length && (m->resources[length - 1] == '/' || m->resources[length - 1] == '\\');
    snprintf(path, sizeof path, "%s%sy.txt", m->resources, ends_in_slash ? "" : "/");
    FILE *file = fopen(path, "r");
    if (!file)
        return complain(m, "there is no file %s", path);
    int y, found = fscanf(file, "%d", &y);
    fclose(file);
    m->state.values.y = y;
    return found == 1 || complain(m, "there is no number in %s", path);
}
static void calculate(Values *v) { (void)v; }
static void update(State *s, Update *what) { (void)s, (void)what; }
