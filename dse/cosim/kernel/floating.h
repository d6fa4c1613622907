/* The processor's rounding mode, flushing of subnormal numbers to zero, and traps. An FMU that changes them and does
 * not restore them would change the results of every other FMU, and of later runs. */
#ifndef DSE_COSIM_FLOATING_H
#define DSE_COSIM_FLOATING_H

#include "failing.h"

#if defined(__SSE2__)
#include <immintrin.h>
/* MXCSR without its status flags, which every calculation sets. */
enum { FLOATING_CONTROL = 0xFFC0, FLOATING_DEFAULT = 0x1F80 };
static inline unsigned floating_mode(void) { return _mm_getcsr() & FLOATING_CONTROL; }
static inline void set_floating_mode(unsigned mode)
{
    _mm_setcsr(mode);
#if defined(__GNUC__)
    /* A change of this register often includes that of the x87 (fesetround); printf and strtod round by it. */
    static const uint16_t x87_default = 0x037F;
    __asm__ volatile("fldcw %0" ::"m"(x87_default));
#endif
}
#elif defined(__aarch64__)
enum { FLOATING_DEFAULT = 0 };
static inline unsigned floating_mode(void)
{
    uint64_t mode;
    __asm__ volatile("mrs %0, fpcr" : "=r"(mode));
    return (unsigned)mode;
}
static inline void set_floating_mode(unsigned mode)
{
    __asm__ volatile("msr fpcr, %0" ::"r"((uint64_t)mode));
}
#else
#include <fenv.h>
enum { FLOATING_DEFAULT = FE_TONEAREST };
static inline unsigned floating_mode(void) { return (unsigned)fegetround(); }
static inline void set_floating_mode(unsigned mode) { fesetround((int)mode); }
#endif

/* The default of IEEE 754; a library may have changed it when it was loaded (-ffast-math). */
static inline void make_floating_default(void)
{
    if (floating_mode() != FLOATING_DEFAULT)
        set_floating_mode(FLOATING_DEFAULT);
}

/* Call after an FMI call: fails if the mode has changed since the last check. */
static inline bool keeps_floating_mode(System *system)
{
    return floating_mode() == FLOATING_DEFAULT ? true : fail(system, FLOATING_CHANGED, 0, 0, 0);
}

#endif
