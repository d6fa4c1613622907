/*
 * File: acc_types.h
 *
 * Written by hand in the shape that Embedded Coder gives a model 'acc': no coder
 * was run. It computes what pd_acc.c beside it does.
 *
 * Code interface packaging: reusable function
 */

#ifndef RTW_HEADER_acc_types_h_
#define RTW_HEADER_acc_types_h_
#include "rtwtypes.h"

typedef enum {
  AccMode_speed = 0,                   /* Default value */
  AccMode_distance
} AccMode;

typedef enum {
  GapSetting_fixed = 0,                /* Default value */
  GapSetting_long,
  GapSetting_middle,
  GapSetting_short
} GapSetting;

typedef struct {
  real_T gap;                          /* m */
  real_T closing_speed;                /* m/s */
  boolean_T detected;
} TargetBus;

typedef struct {
  real_T drive_torque;                 /* N*m */
  real_T brake_torque;                 /* N*m */
} DemandBus;

typedef struct {
  real_T speed;                        /* m/s */
  real_T gap;                          /* m */
} ReferenceBus;

/* Parameters (default storage) */
typedef struct P_acc_T_ P_acc_T;

/* Forward declaration for rtModel */
typedef struct tag_RTM_acc_T RT_MODEL_acc_T;

#endif                                 /* RTW_HEADER_acc_types_h_ */
