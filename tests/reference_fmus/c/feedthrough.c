/* Every input appears at the output of its type. Texts appear as a number too, which can be recorded: their FNV-1a
 * hash, each text followed by its size, without the uppermost bit. */
#define HAS_PARTIAL
static void digest(uint32_t *hash, const Text *text)
{
    for (size_t i = 0; i <= text->size; i++)
        *hash = (*hash ^ (unsigned char)(i < text->size ? text->data[i] : (char)text->size)) * 16777619u;
}
static bool initialize(Instance *m) { return m != NULL; }
#define PASS(name) memcpy(&v->name##_output, &v->name##_input, sizeof v->name##_input)
static void calculate(Values *v)
{
    PASS(Float64_continuous), PASS(Float64_discrete), PASS(Float32_continuous), PASS(Float32_discrete);
    PASS(Int8), PASS(UInt8), PASS(Int16), PASS(UInt16), PASS(Int32), PASS(UInt32), PASS(Int64), PASS(UInt64);
    PASS(Boolean), PASS(String), PASS(Binary), PASS(Enumeration);
    PASS(Float64_array), PASS(Int32_array), PASS(Boolean_array), PASS(String_array), PASS(Binary_array);
    v->sum = v->tunable_parameter + v->fixed_parameter;
    for (int i = 0; i < 6; i++)
        v->sum += v->Float64_array_input[i];
    uint32_t hash = 2166136261u;
    digest(&hash, &v->String_input), digest(&hash, &v->Binary_input), digest(&hash, &v->text_parameter);
    for (int i = 0; i < 2; i++)
        digest(&hash, &v->String_array_input[i]), digest(&hash, &v->Binary_array_input[i]);
    v->text_digest = (int32_t)(hash & 0x7fffffff);
    v->fixed_double = 2 * v->fixed_parameter;
}
static void update(State *s, Update *what) { (void)s, (void)what; }
static double partial(const Values *v, unsigned unknown, unsigned known)
{
    (void)v;
    return (unknown == VR_Float64_continuous_output && known == VR_Float64_continuous_input) ||
           (unknown == VR_Float64_discrete_output && known == VR_Float64_discrete_input);
}
