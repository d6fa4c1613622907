/*
 * File: acc.c
 *
 * Written by hand in the shape that Embedded Coder gives a model 'acc': no coder
 * was run. It computes what pd_acc.c beside it does.
 *
 * Code interface packaging: reusable function
 */

#include "acc.h"
#include <math.h>
#include <string.h>

/* Model step function */
void acc_step(RT_MODEL_acc_T *const acc_M)
{
  P_acc_T *acc_P = acc_M->defaultParam;
  DW_acc_T *acc_DW = acc_M->dwork;
  ExtU_acc_T *acc_U = (ExtU_acc_T *) acc_M->inputs;
  ExtY_acc_T *acc_Y = (ExtY_acc_T *) acc_M->outputs;
  real_T rtb_Acceleration;
  real_T rtb_Drag;
  real_T rtb_Error;
  real_T rtb_Following;
  real_T rtb_Rolling;
  real_T rtb_Torque;
  real_T rtb_WantedGap;

  /* Sample time: [0.01s, 0.0s] */

  /* Sum: '<S1>/Error' incorporates:
   *  Inport: '<Root>/set_speed'
   *  Inport: '<Root>/speed'
   */
  rtb_Error = acc_U->set_speed - acc_U->speed;

  /* UnitDelay: '<S1>/Unit Delay': begins with the first error */
  if (!acc_DW->UnitDelay_NotEmpty) {
    acc_DW->UnitDelay_NotEmpty = true;
    acc_DW->UnitDelay_DSTATE = rtb_Error;
  }

  /* Sum: '<S1>/Add' incorporates:
   *  Gain: '<S1>/D of speed'
   *  Gain: '<S1>/P of speed'
   */
  rtb_Acceleration = (rtb_Error - acc_DW->UnitDelay_DSTATE) / 0.01;
  rtb_Acceleration = acc_P->kp_speed * rtb_Error + acc_P->kd_speed * rtb_Acceleration;

  /* Saturate: '<S1>/Saturation' */
  if (rtb_Acceleration < -acc_P->max_deceleration) {
    rtb_Acceleration = -acc_P->max_deceleration;
  } else if (rtb_Acceleration > acc_P->max_acceleration) {
    rtb_Acceleration = acc_P->max_acceleration;
  }

  /* MultiPortSwitch: '<S3>/Multiport Switch' incorporates:
   *  Constant: '<S3>/Setting'
   */
  switch (acc_P->gap_setting) {
   case GapSetting_fixed:
    rtb_WantedGap = acc_U->set_gap;
    break;

   case GapSetting_long:
    rtb_WantedGap = acc_P->standstill_gap + 2.0 * acc_U->speed;
    break;

   case GapSetting_middle:
    rtb_WantedGap = acc_P->standstill_gap + 1.5 * acc_U->speed;
    break;

   default:
    rtb_WantedGap = acc_P->standstill_gap + acc_U->speed;
    break;
  }

  /* Outport: '<Root>/mode' */
  acc_Y->mode = AccMode_speed;

  /* If: '<Root>/If' incorporates:
   *  Inport: '<Root>/target'
   */
  if (acc_U->target.detected) {
    /* Sum: '<S2>/Add' incorporates:
     *  Gain: '<S2>/D of gap'
     *  Gain: '<S2>/P of gap'
     */
    rtb_Following = acc_P->kp_gap * (acc_U->target.gap - rtb_WantedGap) -
      acc_P->kd_gap * acc_U->target.closing_speed;

    /* Saturate: '<S2>/Saturation' */
    if (rtb_Following < -acc_P->max_deceleration) {
      rtb_Following = -acc_P->max_deceleration;
    } else if (rtb_Following > acc_P->max_acceleration) {
      rtb_Following = acc_P->max_acceleration;
    }

    /* MinMax: '<Root>/Min' */
    if (rtb_Following < rtb_Acceleration) {
      rtb_Acceleration = rtb_Following;

      /* Outport: '<Root>/mode' */
      acc_Y->mode = AccMode_distance;
    }
  }

  /* Product: '<S4>/Drag' */
  rtb_Drag = 0.6 * acc_P->drag_area * acc_U->speed * fabs(acc_U->speed);

  /* Switch: '<S4>/Rolling' */
  if (acc_U->speed > 0.0) {
    rtb_Rolling = acc_P->rolling_resistance * acc_P->nominal_mass * 9.81;
  } else {
    rtb_Rolling = 0.0;
  }

  /* Product: '<S4>/Torque' */
  rtb_Torque = (acc_P->nominal_mass * rtb_Acceleration + rtb_Drag + rtb_Rolling) *
    acc_P->wheel_radius;

  /* Outport: '<Root>/demand' incorporates:
   *  MinMax: '<S4>/Brake'
   *  MinMax: '<S4>/Drive'
   */
  acc_Y->demand.drive_torque = rtb_Torque > 0.0 ? rtb_Torque : 0.0;
  acc_Y->demand.brake_torque = rtb_Torque < 0.0 ? -rtb_Torque : 0.0;

  /* Outport: '<Root>/reference' incorporates:
   *  Switch: '<Root>/Reference'
   */
  if (acc_Y->mode == AccMode_distance) {
    acc_Y->reference.speed = acc_U->speed - acc_U->target.closing_speed;
  } else {
    acc_Y->reference.speed = acc_U->set_speed;
  }

  acc_Y->reference.gap = rtb_WantedGap;

  /* Update for UnitDelay: '<S1>/Unit Delay' */
  acc_DW->UnitDelay_DSTATE = rtb_Error;
}

/* Model initialize function */
void acc_initialize(RT_MODEL_acc_T *const acc_M)
{
  /* states (dwork) */
  (void) memset((void *)acc_M->dwork, 0, sizeof(DW_acc_T));

  /* external inputs */
  (void) memset(acc_M->inputs, 0, sizeof(ExtU_acc_T));

  /* external outputs */
  (void) memset(acc_M->outputs, 0, sizeof(ExtY_acc_T));
}

/* Model terminate function */
void acc_terminate(RT_MODEL_acc_T *const acc_M)
{
  /* (no terminate code required) */
  (void) (acc_M);
}
