/* What generated code calls and nobody needs here, where its folder declares it: the tables of its C API, and logs. */
#define NAMED(model, what) model##what
#define OF(model, what) NAMED(model, what)
#define WEAK __attribute__((weak))

WEAK void OF(MODEL, _InitializeDataMapInfo)(void) {}

WEAK const char *rt_StartDataLogging(void) { return 0; }
WEAK const char *rt_StartDataLoggingWithStartTime(void) { return 0; }
WEAK const char *rt_UpdateTXYLogVars(void) { return 0; }
WEAK const char *rt_UpdateTXXFYLogVars(void) { return 0; }
WEAK void rt_StopDataLogging(void) {}
