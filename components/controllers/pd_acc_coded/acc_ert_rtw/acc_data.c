/*
 * File: acc_data.c
 *
 * Written by hand in the shape that Embedded Coder gives a model 'acc': no coder
 * was run. It computes what pd_acc.c beside it does.
 *
 * Code interface packaging: reusable function
 */

#include "acc.h"

/* Block parameters (default storage) */
P_acc_T acc_P = {
  /* Variable: kp_speed */
  1.2,

  /* Variable: kd_speed */
  0.5,

  /* Variable: kp_gap */
  0.12,

  /* Variable: kd_gap */
  0.65,

  /* Variable: gap_setting */
  GapSetting_fixed,

  /* Variable: standstill_gap */
  4.0,

  /* Variable: max_acceleration */
  2.0,

  /* Variable: max_deceleration */
  3.5,

  /* Variable: nominal_mass */
  1600.0,

  /* Variable: wheel_radius */
  0.31,

  /* Variable: drag_area */
  0.65,

  /* Variable: rolling_resistance */
  0.01
};
