/*
 * File: acc.h
 *
 * Written by hand in the shape that Embedded Coder gives a model 'acc': no coder
 * was run. It computes what pd_acc.c beside it does.
 *
 * Code interface packaging: reusable function
 */

#ifndef RTW_HEADER_acc_h_
#define RTW_HEADER_acc_h_
#include "rtwtypes.h"
#include "acc_types.h"

/* Macros for accessing real-time model data structure */
#ifndef rtmGetErrorStatus
#define rtmGetErrorStatus(rtm)         ((rtm)->errorStatus)
#endif
#ifndef rtmSetErrorStatus
#define rtmSetErrorStatus(rtm, val)    ((rtm)->errorStatus = (val))
#endif

/* Block states (default storage) for system '<Root>' */
typedef struct {
  real_T UnitDelay_DSTATE;             /* '<S1>/Unit Delay' */
  boolean_T UnitDelay_NotEmpty;        /* '<S1>/Unit Delay' */
} DW_acc_T;

/* External inputs (root inport signals with default storage) */
typedef struct {
  TargetBus target;                    /* '<Root>/target' */
  real_T speed;                        /* '<Root>/speed' */
  real_T set_speed;                    /* '<Root>/set_speed' */
  real_T set_gap;                      /* '<Root>/set_gap' */
} ExtU_acc_T;

/* External outputs (root outports fed by signals with default storage) */
typedef struct {
  DemandBus demand;                    /* '<Root>/demand' */
  AccMode mode;                        /* '<Root>/mode' */
  ReferenceBus reference;              /* '<Root>/reference' */
} ExtY_acc_T;

/* Parameters (default storage) */
struct P_acc_T_ {
  real_T kp_speed;                     /* Variable: kp_speed
                                        * Referenced by: '<S1>/P of speed'
                                        */
  real_T kd_speed;                     /* Variable: kd_speed
                                        * Referenced by: '<S1>/D of speed'
                                        */
  real_T kp_gap;                       /* Variable: kp_gap
                                        * Referenced by: '<S2>/P of gap'
                                        */
  real_T kd_gap;                       /* Variable: kd_gap
                                        * Referenced by: '<S2>/D of gap'
                                        */
  GapSetting gap_setting;              /* Variable: gap_setting
                                        * Referenced by: '<S3>/Multiport Switch'
                                        */
  real_T standstill_gap;               /* Variable: standstill_gap
                                        * Referenced by: '<S3>/Standstill'
                                        */
  real_T max_acceleration;             /* Variable: max_acceleration
                                        * Referenced by: '<Root>/Saturation'
                                        */
  real_T max_deceleration;             /* Variable: max_deceleration
                                        * Referenced by: '<Root>/Saturation'
                                        */
  real_T nominal_mass;                 /* Variable: nominal_mass
                                        * Referenced by: '<S4>/Mass'
                                        */
  real_T wheel_radius;                 /* Variable: wheel_radius
                                        * Referenced by: '<S4>/Radius'
                                        */
  real_T drag_area;                    /* Variable: drag_area
                                        * Referenced by: '<S4>/Drag'
                                        */
  real_T rolling_resistance;           /* Variable: rolling_resistance
                                        * Referenced by: '<S4>/Rolling'
                                        */
};

/* Real-time Model Data Structure */
struct tag_RTM_acc_T {
  const char_T *errorStatus;
  P_acc_T *defaultParam;
  ExtU_acc_T *inputs;
  ExtY_acc_T *outputs;
  DW_acc_T *dwork;
};

/* Block parameters (default storage) */
extern P_acc_T acc_P;

/* Model entry point functions */
extern void acc_initialize(RT_MODEL_acc_T *const acc_M);
extern void acc_step(RT_MODEL_acc_T *const acc_M);
extern void acc_terminate(RT_MODEL_acc_T *const acc_M);

/*-
 * '<Root>' : 'acc'
 * '<S1>'   : 'acc/Speed'
 * '<S2>'   : 'acc/Gap'
 * '<S3>'   : 'acc/Wanted gap'
 * '<S4>'   : 'acc/Torques'
 */
#endif                                 /* RTW_HEADER_acc_h_ */
