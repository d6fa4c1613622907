"""A cruise control in the shape Simulink's coder gives a model, written by hand, and what it computes, in Python.

A PI law for the speed and a PD law for the gap; the lower demand wins. Ports are buses, so that it fits the interface
``acc_controller`` of the example; gains are tunable parameters, one is an enumeration.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from coded_texts import TYPES

STEP = 0.02
"""Of the model, in s."""

_HEAD = """\
/*
 * File: {file}
 *
 * Code generated for Simulink model 'AccControl'.
 *
 * Target selection: ert.tlc
 */
"""

_TYPES = """\
#ifndef RTW_HEADER_AccControl_types_h_
#define RTW_HEADER_AccControl_types_h_
#include "rtwtypes.h"
typedef enum { AccMode_speed = 0, AccMode_distance } AccMode;
typedef enum { GapSetting_fixed = 0, GapSetting_long = 2, GapSetting_short = 5 } GapSetting;
typedef struct {
  real_T gap;
  real_T closing_speed;
  boolean_T detected;
} TargetBus;
typedef struct {
  real_T drive_torque;
  real_T brake_torque;
} DemandBus;
typedef struct {
  real_T speed;
  real_T gap;
} ReferenceBus;
#endif
"""

_HEADER = """\
#ifndef RTW_HEADER_AccControl_h_
#define RTW_HEADER_AccControl_h_
#include "rtwtypes.h"
#include "AccControl_types.h"
typedef struct {
  real_T SpeedIntegrator_DSTATE;       /* '<S1>/Speed Integrator' */
} DW_AccControl_T;
typedef struct {
  TargetBus target;                    /* '<Root>/target' */
  real_T speed;                        /* '<Root>/speed' */
  real_T set_speed;                    /* '<Root>/set_speed' */
  real_T set_gap;                      /* '<Root>/set_gap' */
} ExtU_AccControl_T;
typedef struct {
  DemandBus demand;                    /* '<Root>/demand' */
  AccMode mode;                        /* '<Root>/mode' */
  ReferenceBus reference;              /* '<Root>/reference' */
} ExtY_AccControl_T;
struct P_AccControl_T_ {
  GapSetting gap_setting;              /* Variable: gap_setting
                                        * Referenced by: '<S2>/Wanted Gap'
                                        */
  real_T kp_speed;                     /* Variable: kp_speed
                                        * Referenced by: '<S1>/Speed P'
                                        */
  real_T ki_speed;                     /* Variable: ki_speed
                                        * Referenced by: '<S1>/Speed I'
                                        */
  real_T kp_gap;                       /* Variable: kp_gap
                                        * Referenced by: '<S2>/Gap P'
                                        */
  real_T kd_gap;                       /* Variable: kd_gap
                                        * Referenced by: '<S2>/Gap D'
                                        */
  real_T nominal_mass;                 /* Variable: nominal_mass
                                        * Referenced by: '<S3>/Mass'
                                        */
};
typedef struct P_AccControl_T_ P_AccControl_T;
struct tag_RTM_AccControl_T { const char_T * volatile errorStatus; };
typedef struct tag_RTM_AccControl_T RT_MODEL_AccControl_T;
extern P_AccControl_T AccControl_P;
extern DW_AccControl_T AccControl_DW;
extern ExtU_AccControl_T AccControl_U;
extern ExtY_AccControl_T AccControl_Y;
extern void AccControl_initialize(void);
extern void AccControl_step(void);
extern void AccControl_terminate(void);
extern RT_MODEL_AccControl_T *const AccControl_M;

/*-
 * '<Root>' : 'AccControl'
 * '<S1>'   : 'AccControl/Speed Control'
 * '<S2>'   : 'AccControl/Gap Control'
 * '<S3>'   : 'AccControl/Torque'
 */
#endif
"""

_SOURCE = """\
#include "AccControl.h"
DW_AccControl_T AccControl_DW;
ExtU_AccControl_T AccControl_U;
ExtY_AccControl_T AccControl_Y;
static RT_MODEL_AccControl_T AccControl_M_;
RT_MODEL_AccControl_T *const AccControl_M = &AccControl_M_;

/* Model step function */
void AccControl_step(void)             /* Sample time: [0.02s, 0.0s] */
{
  real_T error;
  real_T demand;
  real_T following;
  real_T torque;

  /* Sum: '<S1>/Error' */
  error = AccControl_U.set_speed - AccControl_U.speed;
  demand = AccControl_P.kp_speed * error + AccControl_DW.SpeedIntegrator_DSTATE;

  /* Switch: '<S2>/Wanted Gap' */
  switch (AccControl_P.gap_setting) {
   case GapSetting_long:
    AccControl_Y.reference.gap = 2.0 * AccControl_U.speed + 4.0;
    break;

   case GapSetting_short:
    AccControl_Y.reference.gap = AccControl_U.speed + 4.0;
    break;

   default:
    AccControl_Y.reference.gap = AccControl_U.set_gap;
    break;
  }

  AccControl_Y.mode = AccMode_speed;
  AccControl_Y.reference.speed = AccControl_U.set_speed;
  if (AccControl_U.target.detected) {
    following = (AccControl_U.target.gap - AccControl_Y.reference.gap) * AccControl_P.kp_gap
      - AccControl_U.target.closing_speed * AccControl_P.kd_gap;
    if (following < demand) {
      demand = following;
      AccControl_Y.mode = AccMode_distance;
      AccControl_Y.reference.speed = AccControl_U.speed - AccControl_U.target.closing_speed;
    }
  }

  /* Saturate: '<S3>/Limits' */
  if (demand > 2.0) {
    demand = 2.0;
  } else if (demand < -3.5) {
    demand = -3.5;
  }

  /* DiscreteIntegrator: '<S1>/Speed Integrator', which waits while somebody else drives */
  if (AccControl_Y.mode == AccMode_speed) {
    AccControl_DW.SpeedIntegrator_DSTATE += AccControl_P.ki_speed * error * 0.02;
    if (AccControl_DW.SpeedIntegrator_DSTATE > 0.5) {
      AccControl_DW.SpeedIntegrator_DSTATE = 0.5;
    } else if (AccControl_DW.SpeedIntegrator_DSTATE < -0.5) {
      AccControl_DW.SpeedIntegrator_DSTATE = -0.5;
    }
  }

  /* Gain: '<S3>/Mass' */
  torque = AccControl_P.nominal_mass * demand * 0.31;
  AccControl_Y.demand.drive_torque = torque > 0.0 ? torque : 0.0;
  AccControl_Y.demand.brake_torque = torque < 0.0 ? -torque : 0.0;
}

/* Model initialize function */
void AccControl_initialize(void)
{
  AccControl_Y.mode = AccMode_speed;
}

void AccControl_terminate(void)
{
}
"""

_DATA = """\
#include "AccControl.h"
P_AccControl_T AccControl_P = {
  GapSetting_fixed,
  1.2,
  0.05,
  0.12,
  0.65,
  1600.0
};
"""


def acc_files(step: float = STEP) -> Mapping[str, str]:
    """Texts by file name; *step* only replaces what the comment tells."""
    texts = {
        "AccControl.h": _HEADER,
        "AccControl_types.h": _TYPES,
        "AccControl.c": _SOURCE.replace("[0.02s", f"[{step!r}s"),
        "AccControl_data.c": _DATA,
    }
    return {"rtwtypes.h": TYPES, **{file: _HEAD.format(file=file) + text for file, text in texts.items()}}


@dataclass
class AccReplica:
    """The same in Python, with the parameters of the code."""

    kp_speed: float = 1.2
    ki_speed: float = 0.05
    kp_gap: float = 0.12
    kd_gap: float = 0.65
    nominal_mass: float = 1600.0
    time_gap: float | None = None
    memory: float = field(default=0.0, init=False)

    def step(self, gap: float, closing: float, detected: bool, speed: float, set_speed: float, set_gap: float) -> Acc:
        """One call of its step."""
        error = set_speed - speed
        demand = self.kp_speed * error + self.memory
        wanted = set_gap if self.time_gap is None else self.time_gap * speed + 4.0
        following = (gap - wanted) * self.kp_gap - closing * self.kd_gap
        is_chase = detected and following < demand
        if is_chase:
            demand = following
        demand = min(max(demand, -3.5), 2.0)
        if not is_chase:
            self.memory = min(max(self.memory + self.ki_speed * error * 0.02, -0.5), 0.5)
        torque = self.nominal_mass * demand * 0.31
        reference = speed - closing if is_chase else set_speed
        return Acc(max(torque, 0.0), max(-torque, 0.0), float(is_chase), reference, wanted)


@dataclass(frozen=True)
class Acc:
    """Its outputs; *mode* is 1 for distance."""

    drive_torque: float
    brake_torque: float
    mode: float
    reference_speed: float
    reference_gap: float


def sampled(
    replica: AccReplica, inputs: Sequence[tuple[float, float, bool, float, float, float]], h: float
) -> Iterator[Acc]:
    """What it puts out at each point of communication, *h* (s) apart, at which *inputs* were told to it.

    It runs at ``k * STEP`` from 0 on, with what it was told at the last point before; at the very beginning it tells
    what its first step will.
    """
    told, hits = replace(replica).step(*inputs[0]), 0
    yield told
    for place, now in enumerate(inputs[:-1]):
        while hits * STEP < (place + 1) * h - 1e-4 * STEP:
            told = replica.step(*now)
            hits += 1
        yield told
