/*
 * File: rtwtypes.h
 *
 * Written by hand in the shape that Embedded Coder gives a model 'acc': no coder
 * was run. It computes what pd_acc.c beside it does.
 *
 * Code interface packaging: reusable function
 */

#ifndef RTWTYPES_H
#define RTWTYPES_H

/* Fixed width types of a 64-bit target */
typedef signed char int8_T;
typedef unsigned char uint8_T;
typedef short int16_T;
typedef unsigned short uint16_T;
typedef int int32_T;
typedef unsigned int uint32_T;
typedef float real32_T;
typedef double real64_T;

/* Generic type definitions */
typedef double real_T;
typedef double time_T;
typedef unsigned char boolean_T;
typedef int int_T;
typedef unsigned int uint_T;
typedef char char_T;

#ifndef true
#define true                           (1U)
#endif
#ifndef false
#define false                          (0U)
#endif
#endif                                 /* RTWTYPES_H */
