/* The place of a variable in the component's struct, its C type, and when it may be set. The compiler determines place
 * and type (offsetof, _Generic), so the component's header is never parsed.
 */
#ifndef DSE_SLOT_H
#define DSE_SLOT_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* C type of a member. Tests rely on the order: F64, F32, then BOOL, then the integers. */
enum {
    DSE_NO_TYPE,
    DSE_F64,
    DSE_F32,
    DSE_BOOL,
    DSE_I8,
    DSE_I16,
    DSE_I32,
    DSE_I64,
    DSE_U8,
    DSE_U16,
    DSE_U32,
    DSE_U64,
    DSE_WHOLE /* a double with integer values only */
};

/* The role of the variable; the values are bits, so that an accessor can serve two kinds. */
enum { DSE_REAL = 1, DSE_INTEGER = 2, DSE_BOOLEAN = 4, DSE_ENUMERATION = 8, DSE_TEXT = 16, DSE_BINARY = 32 };

/* The state of an instance; the values are bits, so that a set of states is a number. */
enum { DSE_INSTANTIATED = 1, DSE_INITIALIZING = 2, DSE_STEPPING = 4, DSE_TERMINATED = 8 };

/* The states in which a variable may be set. One more bit distinguishes parameters from inputs. */
enum {
    DSE_OF_PARAMETER = 16,
    DSE_INPUT = DSE_INSTANTIATED | DSE_INITIALIZING | DSE_STEPPING,
    DSE_TUNABLE = DSE_INPUT | DSE_OF_PARAMETER,
    DSE_FIXED = DSE_INSTANTIATED | DSE_INITIALIZING,
    DSE_OUTPUT = 0
};

struct dse_slot {
    uint32_t offset;
    uint8_t type;
    uint8_t kind;
    uint8_t settable;
    int32_t items; /* of an enumeration: its values are 0 … items - 1 */
    uint32_t count; /* number of values of the array whose first value this is, for FMI 3.0; else 1 */
    uint32_t capacity; /* bytes of a text, with the zero at its end, or of a binary, whose size_t is at *size_at* */
    uint32_t size_at;
};

/* The bounds are compile-time constants on every compiler; a plain char is signed on some machines only. */
#define DSE_BY_SIZE(size, if1, if2, if4, if8) ((size) == 1 ? (if1) : (size) == 2 ? (if2) : (size) == 4 ? (if4) : (if8))
#define DSE_SIGNED(type) DSE_BY_SIZE(sizeof(type), DSE_I8, DSE_I16, DSE_I32, DSE_I64)
#define DSE_UNSIGNED(type) DSE_BY_SIZE(sizeof(type), DSE_U8, DSE_U16, DSE_U32, DSE_U64)

/* Type of a member of dse_component; an enum counts as the integer the compiler chose for it. */
#define DSE_TYPE_OF(member)                                                                                            \
    _Generic((((dse_component *)0)->member),                                                                           \
        double: DSE_F64,                                                                                               \
        float: DSE_F32,                                                                                                \
        bool: DSE_BOOL,                                                                                                \
        char: (CHAR_MIN < 0 ? DSE_I8 : DSE_U8),                                                                        \
        signed char: DSE_I8,                                                                                           \
        short: DSE_SIGNED(short),                                                                                      \
        int: DSE_SIGNED(int),                                                                                          \
        long: DSE_SIGNED(long),                                                                                        \
        long long: DSE_SIGNED(long long),                                                                              \
        unsigned char: DSE_U8,                                                                                         \
        unsigned short: DSE_UNSIGNED(unsigned short),                                                                  \
        unsigned int: DSE_UNSIGNED(unsigned int),                                                                      \
        unsigned long: DSE_UNSIGNED(unsigned long),                                                                    \
        unsigned long long: DSE_UNSIGNED(unsigned long long),                                                          \
        default: DSE_NO_TYPE)

#define DSE_IS_REAL(member) (DSE_TYPE_OF(member) == DSE_F64 || DSE_TYPE_OF(member) == DSE_F32)
#define DSE_IS_INTEGER(member) (DSE_TYPE_OF(member) >= DSE_I8)
#define DSE_IS_BOOLEAN(member) (DSE_TYPE_OF(member) >= DSE_BOOL)
#define DSE_IS_ENUMERATION(member) (DSE_TYPE_OF(member) >= DSE_I8)

#define DSE_LOWEST(type)                                                                                               \
    ((type) == DSE_I8    ? INT8_MIN                                                                                    \
     : (type) == DSE_I16 ? INT16_MIN                                                                                   \
     : (type) == DSE_I32 ? INT32_MIN                                                                                   \
     : (type) == DSE_WHOLE ? INT32_MIN                                                                                 \
     : (type) == DSE_I64 ? INT64_MIN                                                                                   \
                         : 0)
/* Clipped to the range of int64_t: values arrive as int64_t. */
#define DSE_HIGHEST(type)                                                                                              \
    ((type) == DSE_I8    ? INT8_MAX                                                                                    \
     : (type) == DSE_I16 ? INT16_MAX                                                                                   \
     : (type) == DSE_I32 ? INT32_MAX                                                                                   \
     : (type) == DSE_U8  ? UINT8_MAX                                                                                   \
     : (type) == DSE_U16 ? UINT16_MAX                                                                                  \
     : (type) == DSE_U32 ? (int64_t)UINT32_MAX                                                                         \
     : (type) == DSE_WHOLE ? INT32_MAX                                                                                 \
     : (type) == DSE_BOOL ? 1                                                                                          \
                          : INT64_MAX)
#define DSE_FITS(member, value)                                                                                        \
    (DSE_LOWEST(DSE_TYPE_OF(member)) <= (value) && (value) <= DSE_HIGHEST(DSE_TYPE_OF(member)))

/* Whether *member* is an array, and its number of elements. */
#define DSE_IS_ARRAY(member, size)                                                                                     \
    (sizeof(((dse_component *)0)->member) == (size) * sizeof(((dse_component *)0)->member[0])                          \
        && !__builtin_types_compatible_p(__typeof__(((dse_component *)0)->member),                                     \
            __typeof__(&((dse_component *)0)->member[0])))

#define DSE_SLOT(member, kind, settable, items, count)                                                                 \
    { offsetof(dse_component, member), DSE_TYPE_OF(member), kind, settable, items, count, 0, 0 }

/* A text is an array of char, a binary a struct of *data*, an array of uint8_t, and *size*, a size_t. */
#define DSE_IS_ARRAY_OF(member, type)                                                                                  \
    (__builtin_types_compatible_p(__typeof__(&((dse_component *)0)->member[0]), type *)                                \
        && !__builtin_types_compatible_p(__typeof__(((dse_component *)0)->member), type *))
#define DSE_IS_TEXT(member) DSE_IS_ARRAY_OF(member, char)
#define DSE_IS_BINARY(member)                                                                                          \
    (DSE_IS_ARRAY_OF(member.data, uint8_t)                                                                             \
        && __builtin_types_compatible_p(__typeof__(((dse_component *)0)->member.size), size_t))
#define DSE_TEXT_SLOT(member, settable, count)                                                                         \
    { offsetof(dse_component, member), DSE_NO_TYPE, DSE_TEXT, settable, 0, count,                                      \
        sizeof(((dse_component *)0)->member), 0 }
#define DSE_BINARY_SLOT(member, settable, count)                                                                       \
    { offsetof(dse_component, member.data), DSE_NO_TYPE, DSE_BINARY, settable, 0, count,                               \
        sizeof(((dse_component *)0)->member.data), offsetof(dse_component, member.size) }

#endif
