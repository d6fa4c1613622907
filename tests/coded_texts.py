"""Models in the shapes that Simulink's coder gives them, written by hand: file names and texts, and what they compute.

Each lags behind its input: ``y = Gain * x`` and then ``x += T * (u - x)`` while it is on, or the same as a differential
equation. Nothing here was generated; only names, comments and the order of calls are as the coder has them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

STEP = 0.1
GAIN = 3.0
Files = Mapping[str, str]

TYPES = """\
#ifndef RTWTYPES_H
#define RTWTYPES_H
typedef signed char int8_T;
typedef unsigned char uint8_T;
typedef short int16_T;
typedef unsigned short uint16_T;
typedef int int32_T;
typedef unsigned int uint32_T;
typedef float real32_T;
typedef double real_T;
typedef double time_T;
typedef unsigned char boolean_T;
typedef int int_T;
typedef unsigned int uint_T;
typedef char char_T;
#ifndef __cplusplus
#ifndef true
#define true (1U)
#define false (0U)
#endif
#endif
#endif
"""


def _head(name: str, file: str) -> str:
    return f"""\
/*
 * File: {file}
 *
 * Code generated for Simulink model '{name}'.
 *
 * Target selection: ert.tlc
 */
"""


def files_of(name: str, header: str, source: str, **more: str) -> Files:
    guard = f"RTW_HEADER_{name}_h_"
    return {
        "rtwtypes.h": TYPES,
        f"{name}.h": f"{_head(name, f'{name}.h')}#ifndef {guard}\n#define {guard}\n"
        f'#include "rtwtypes.h"\n{header}#endif\n',
        f"{name}.c": f'{_head(name, f"{name}.c")}#include "{name}.h"\n{source}',
        **{f"{file}.c": text for file, text in more.items()},
    }


def lag(
    inputs: Sequence[float], gain: float = GAIN, on: Sequence[bool] | None = None, step: float = STEP
) -> list[float]:
    """What the discrete models put out at each of their steps."""
    x, found = 0.0, []
    for place, u in enumerate(inputs):
        found.append(gain * x)
        if on is None or on[place]:
            x = x + step * (u - x)
    return found


def whole_program(name: str = "lag") -> Files:
    """All data are variables of the whole program: the coder's default."""
    header = f"""\
typedef struct {{ real_T Memory; }} DW_{name}_T;
typedef struct {{
  real_T speed;                        /* '<Root>/speed' */
  boolean_T enable;                    /* '<Root>/enable' */
}} ExtU_{name}_T;
typedef struct {{
  real_T filtered;                     /* '<Root>/filtered' */
  int32_T count;                       /* '<Root>/count' */
}} ExtY_{name}_T;
struct P_{name}_T_ {{ real_T Gain; /* Variable: Gain */ }};
typedef struct P_{name}_T_ P_{name}_T;
struct tag_RTM_{name}_T {{ const char_T * volatile errorStatus; }};
typedef struct tag_RTM_{name}_T RT_MODEL_{name}_T;
extern P_{name}_T {name}_P;
extern DW_{name}_T {name}_DW;
extern ExtU_{name}_T {name}_U;
extern ExtY_{name}_T {name}_Y;
extern void {name}_initialize(void);
extern void {name}_step(void);
extern void {name}_terminate(void);
extern RT_MODEL_{name}_T *const {name}_M;
"""
    source = f"""\
DW_{name}_T {name}_DW;
ExtU_{name}_T {name}_U;
ExtY_{name}_T {name}_Y;
static RT_MODEL_{name}_T {name}_M_;
RT_MODEL_{name}_T *const {name}_M = &{name}_M_;

/* Model step function */
void {name}_step(void)
{{
  /* Sample time: [{STEP}s, 0.0s] */
  {name}_Y.filtered = {name}_P.Gain * {name}_DW.Memory;
  {name}_Y.count++;
  if ({name}_U.enable) {{
    {name}_DW.Memory += {STEP} * ({name}_U.speed - {name}_DW.Memory);
  }}
  if ({name}_DW.Memory > 1000.0) {{
    {name}_M->errorStatus = "over the top";
  }}
}}

/* Model initialize function: old states stay, as memory was zero before */
void {name}_initialize(void)
{{
  {name}_U.speed = 0.0;
}}

void {name}_terminate(void)
{{
}}
"""
    data = f'#include "{name}.h"\nP_{name}_T {name}_P = {{ {GAIN} }};\n'
    return files_of(name, header, source, **{f"{name}_data": data})


def exported(name: str = "lag") -> Files:
    """Ports and parameters are variables of their own."""
    header = f"""\
extern real_T speed;                   /* '<Root>/speed' */
extern boolean_T enable;               /* '<Root>/enable' */
extern real_T filtered;                /* '<Root>/filtered' */
extern real_T Gain;                    /* Variable: Gain
                                        * Referenced by: '<Root>/Gain'
                                        */
extern void {name}_initialize(void);
extern void {name}_step(void);
"""
    source = f"""\
real_T speed;
boolean_T enable;
real_T filtered;
real_T Gain = {GAIN};
static real_T memory;

void {name}_step(void)
{{
  /* Sample time: [{STEP}s, 0.0s] */
  filtered = Gain * memory;
  if (enable) {{
    memory += {STEP} * (speed - memory);
  }}
}}

void {name}_initialize(void)
{{
  speed = 0.0;
  filtered = 0.0;
}}
"""
    return files_of(name, header, source)


def reusable(name: str = "lag") -> Files:
    """A model that may be there several times: its data hang on a record that its functions are given."""
    header = f"""\
typedef struct tag_RTM_{name}_T RT_MODEL_{name}_T;
typedef struct {{ real_T Memory; }} DW_{name}_T;
typedef struct {{ real_T speed; boolean_T enable; }} ExtU_{name}_T;
typedef struct {{ real_T filtered; }} ExtY_{name}_T;
struct P_{name}_T_ {{ real_T Gain; }};
typedef struct P_{name}_T_ P_{name}_T;
struct tag_RTM_{name}_T {{
  const char_T *errorStatus;
  P_{name}_T *defaultParam;
  ExtU_{name}_T *inputs;
  ExtY_{name}_T *outputs;
  DW_{name}_T *dwork;
}};
extern P_{name}_T {name}_P;
extern void {name}_initialize(RT_MODEL_{name}_T *const {name}_M);
extern void {name}_step(RT_MODEL_{name}_T *const {name}_M);
"""
    source = f"""\
void {name}_step(RT_MODEL_{name}_T *const {name}_M)
{{
  P_{name}_T *{name}_P = {name}_M->defaultParam;
  DW_{name}_T *{name}_DW = {name}_M->dwork;
  ExtU_{name}_T *{name}_U = (ExtU_{name}_T *) {name}_M->inputs;
  ExtY_{name}_T *{name}_Y = (ExtY_{name}_T *) {name}_M->outputs;
  /* Sample time: [{STEP}s, 0.0s] */
  {name}_Y->filtered = {name}_P->Gain * {name}_DW->Memory;
  if ({name}_U->enable) {{
    {name}_DW->Memory += {STEP} * ({name}_U->speed - {name}_DW->Memory);
  }}
}}

void {name}_initialize(RT_MODEL_{name}_T *const {name}_M)
{{
  {name}_M->inputs->speed = 0.0;
  {name}_M->outputs->filtered = 0.0;
}}
"""
    data = f'#include "{name}.h"\nP_{name}_T {name}_P = {{ {GAIN} }};\n'
    return files_of(name, header, source, **{f"{name}_data": data})


def arguments(name: str = "lag") -> Files:
    """Ports are arguments of the step; states are variables of the whole program, parameters numbers in the code."""
    header = f"""\
extern void {name}_initialize(void);
extern void {name}_step(real_T arg_speed, boolean_T arg_enable, real_T *arg_Out1);
"""
    source = f"""\
static real_T memory;

void {name}_step(real_T arg_speed, boolean_T arg_enable, real_T *arg_Out1)
{{
  /* Sample time: [{STEP}s, 0.0s] */
  *arg_Out1 = {GAIN} * memory;
  if (arg_enable) {{
    memory += {STEP} * (arg_speed - memory);
  }}
}}

void {name}_initialize(void)
{{
}}
"""
    return files_of(name, header, source)


def class_of_cpp(name: str = "lag") -> Files:
    """A class; its ports are members."""
    head = _head(name, f"{name}.h")
    header = f"""\
{head}#ifndef RTW_HEADER_{name}_h_
#define RTW_HEADER_{name}_h_
#include "rtwtypes.h"
class {name}Class {{
 public:
  struct ExtU_{name}_T {{ real_T speed; boolean_T enable; }};
  struct ExtY_{name}_T {{ real_T filtered; }};
  struct P_{name}_T {{ real_T Gain; }};
  void initialize();
  void step();
  {name}Class();
  ~{name}Class();
  ExtU_{name}_T rtU;
  ExtY_{name}_T rtY;
 private:
  struct DW_{name}_T {{ real_T Memory; }};
  static P_{name}_T rtP;
  DW_{name}_T rtDW;
}};
#endif
"""
    source = f"""\
{head}#include "{name}.h"
{name}Class::P_{name}_T {name}Class::rtP = {{ {GAIN} }};
void {name}Class::step()
{{
  /* Sample time: [{STEP}s, 0.0s] */
  rtY.filtered = rtP.Gain * rtDW.Memory;
  if (rtU.enable) {{
    rtDW.Memory += {STEP} * (rtU.speed - rtDW.Memory);
  }}
}}
void {name}Class::initialize()
{{
  rtU.speed = 0.0;
}}
{name}Class::{name}Class() : rtU(), rtY(), rtDW() {{}}
{name}Class::~{name}Class() {{}}
"""
    return {"rtwtypes.h": TYPES, f"{name}.h": header, f"{name}.cpp": source}


def two_rates(name: str = "lag") -> Files:
    """One function a rate: the second runs at every third step of the first."""
    header = f"""\
typedef struct {{ real_T speed; /* '<Root>/speed' */ }} ExtU_{name}_T;
typedef struct {{ real_T quick; /* '<Root>/quick' */ real_T slow; /* '<Root>/slow' */ }} ExtY_{name}_T;
extern ExtU_{name}_T {name}_U;
extern ExtY_{name}_T {name}_Y;
extern void {name}_initialize(void);
extern void {name}_step0(void);
extern void {name}_step1(void);
"""
    source = f"""\
ExtU_{name}_T {name}_U;
ExtY_{name}_T {name}_Y;
static real_T sum;

/* Model step function for TID0 */
void {name}_step0(void)                /* Sample time: [{STEP}s, 0.0s] */
{{
  sum += {name}_U.speed;
  {name}_Y.quick = sum;
}}

/* Model step function for TID1 */
void {name}_step1(void)                /* Sample time: [{3 * STEP:.1f}s, 0.0s] */
{{
  {name}_Y.slow = sum;
}}

void {name}_initialize(void)
{{
}}
"""
    return files_of(name, header, source)


def uncommented_rates() -> Files:
    """The same without the comments that tell how long the steps are."""
    return {file: re.sub(r"/\* Sample time.*?\*/", "", text) for file, text in two_rates().items()}


def scheduled(name: str = "lag") -> Files:
    """A slower rate is scheduled within the step; only its comment tells a time."""
    header = f"""\
typedef struct {{ real_T speed; /* '<Root>/speed' */ }} ExtU_{name}_T;
typedef struct {{ real_T slow; /* '<Root>/slow' */ }} ExtY_{name}_T;
typedef struct {{ struct {{ struct {{ uint8_T TID[2]; }} TaskCounters; }} Timing; }} RT_MODEL_{name}_T;
extern ExtU_{name}_T {name}_U;
extern ExtY_{name}_T {name}_Y;
extern RT_MODEL_{name}_T *const {name}_M;
extern void {name}_initialize(void);
extern void {name}_step(void);
"""
    source = f"""\
ExtU_{name}_T {name}_U;
ExtY_{name}_T {name}_Y;
static RT_MODEL_{name}_T {name}_M_;
RT_MODEL_{name}_T *const {name}_M = &{name}_M_;
static real_T sum;
static void rate_scheduler(void);

static void rate_scheduler(void)
{{
  ({name}_M->Timing.TaskCounters.TID[1])++;
  if (({name}_M->Timing.TaskCounters.TID[1]) > 4) {{/* Sample time: [0.5s, 0.0s] */
    {name}_M->Timing.TaskCounters.TID[1] = 0;
  }}
}}

void {name}_step(void)
{{
  sum += {name}_U.speed;
  if ({name}_M->Timing.TaskCounters.TID[1] == 0) {{
    {name}_Y.slow = sum;
  }}
  rate_scheduler();
}}

void {name}_initialize(void)
{{
}}
"""
    return files_of(name, header, source)


_TABLEAUS = {
    1: ([], [[1.0]]),
    2: ([1.0], [[1.0, 0.0], [0.5, 0.5]]),
    3: ([0.5, 0.75], [[0.5, 0.0, 0.0], [0.0, 0.75, 0.0], [2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0]]),
    4: ([0.5, 0.5, 1.0], [[0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1.0, 0], [1 / 6, 1 / 3, 1 / 3, 1 / 6]]),
}
"""Of ode1 to ode4: where the stages are, in steps, and how they are weighed."""


def continuous(order: int, name: str = "lag") -> Files:
    """``dx/dt = Gain * (u - x)``, ``y = x``, with the fixed-step solver ode1 ... ode4 in the code."""
    places, weights = _TABLEAUS[order]
    stages = []
    for stage, row in enumerate(weights):
        terms = " + ".join(f"f{k}[0] * {row[k]!r}" for k in range(stage + 1))
        stages.append(f"  x[0] = y + h * ({terms});")
        if stage < order - 1:
            stages.append(f"  rtsiSetT(si, t + h * {places[stage]!r});")
            stages.append(f"  rtsiSetdX(si, f{stage + 1});")
            stages.append(f"  {name}_step();\n  {name}_derivatives();")
    lines = "\n".join(stages)
    header = f"""\
#include "rtw_continuous.h"
#include "rtw_solver.h"
typedef struct {{ real_T Integrator_CSTATE; }} X_{name}_T;
typedef struct {{ real_T Integrator_CSTATE; }} XDot_{name}_T;
typedef struct {{ real_T *y; real_T *f[4]; }} ODE_IntgData;
typedef struct {{ real_T speed; /* '<Root>/speed' */ }} ExtU_{name}_T;
typedef struct {{ real_T filtered; /* '<Root>/filtered' */ }} ExtY_{name}_T;
struct P_{name}_T_ {{ real_T Gain; }};
typedef struct P_{name}_T_ P_{name}_T;
struct tag_RTM_{name}_T {{
  const char_T *errorStatus;
  RTWSolverInfo solverInfo;
  X_{name}_T *contStates;
  XDot_{name}_T *derivs;
  real_T odeF[4][1];
  struct {{ int_T numContStates; }} Sizes;
  struct {{
    uint32_T clockTick0;
    time_T stepSize0;
    SimTimeStep simTimeStep;
    time_T *t;
    time_T tArray[1];
  }} Timing;
}};
typedef struct tag_RTM_{name}_T RT_MODEL_{name}_T;
extern P_{name}_T {name}_P;
extern X_{name}_T {name}_X;
extern ExtU_{name}_T {name}_U;
extern ExtY_{name}_T {name}_Y;
extern void {name}_initialize(void);
extern void {name}_step(void);
extern RT_MODEL_{name}_T *const {name}_M;
"""
    source = f"""\
P_{name}_T {name}_P = {{ {GAIN} }};
X_{name}_T {name}_X;
ExtU_{name}_T {name}_U;
ExtY_{name}_T {name}_Y;
static RT_MODEL_{name}_T {name}_M_;
RT_MODEL_{name}_T *const {name}_M = &{name}_M_;
static void {name}_derivatives(void);

static void rt_ertODEUpdateContinuousStates(RTWSolverInfo *si)
{{
  time_T t = rtsiGetT(si);
  time_T tnew = rtsiGetSolverStopTime(si);
  time_T h = rtsiGetStepSize(si);
  real_T *x = rtsiGetContStates(si);
  real_T *f0 = {name}_M->odeF[0];
  real_T *f1 = {name}_M->odeF[1];
  real_T *f2 = {name}_M->odeF[2];
  real_T *f3 = {name}_M->odeF[3];
  const real_T y = x[0];
  (void) f1, (void) f2, (void) f3, (void) t;
  rtsiSetSimTimeStep(si, MINOR_TIME_STEP);
  rtsiSetdX(si, f0);
  {name}_derivatives();
{lines}
  rtsiSetT(si, tnew);
  rtsiSetSimTimeStep(si, MAJOR_TIME_STEP);
}}

void {name}_step(void)
{{
  if ({name}_M->Timing.simTimeStep == MAJOR_TIME_STEP) {{
    rtsiSetSolverStopTime(&{name}_M->solverInfo, (({name}_M->Timing.clockTick0 + 1) * {name}_M->Timing.stepSize0));
    rtsiSetBlkStateChange(&{name}_M->solverInfo, true);
  }}
  {name}_Y.filtered = {name}_X.Integrator_CSTATE;
  if ({name}_M->Timing.simTimeStep == MAJOR_TIME_STEP && rtsiGetBlkStateChange(&{name}_M->solverInfo)) {{
    rt_ertODEUpdateContinuousStates(&{name}_M->solverInfo);
    ++{name}_M->Timing.clockTick0;
    {name}_M->Timing.t[0] = rtsiGetSolverStopTime(&{name}_M->solverInfo);
  }}
}}

static void {name}_derivatives(void)
{{
  {name}_M->derivs->Integrator_CSTATE = {name}_P.Gain * ({name}_U.speed - {name}_X.Integrator_CSTATE);
}}

void {name}_initialize(void)
{{
  rtsiSetSimTimeStepPtr(&{name}_M->solverInfo, &{name}_M->Timing.simTimeStep);
  rtsiSetTPtr(&{name}_M->solverInfo, &{name}_M->Timing.t);
  rtsiSetStepSizePtr(&{name}_M->solverInfo, &{name}_M->Timing.stepSize0);
  rtsiSetdXPtr(&{name}_M->solverInfo, &{name}_M->derivs);
  rtsiSetContStatesPtr(&{name}_M->solverInfo, (real_T **) &{name}_M->contStates);
  rtsiSetNumContStatesPtr(&{name}_M->solverInfo, &{name}_M->Sizes.numContStates);
  rtsiSetRTModelPtr(&{name}_M->solverInfo, {name}_M);
  rtsiSetSimTimeStep(&{name}_M->solverInfo, MAJOR_TIME_STEP);
  {name}_M->contStates = &{name}_X;
  {name}_M->Timing.t = {name}_M->Timing.tArray;
  {name}_M->Timing.stepSize0 = {STEP};
  {name}_X.Integrator_CSTATE = 0.0;
}}
"""
    return files_of(name, header, source)


def lag_by_ode(order: int, inputs: Sequence[float], gain: float = GAIN) -> list[float]:
    """What a continuous one puts out at the end of each step, by the textbook's stages."""
    places, weights = _TABLEAUS[order]
    x, found = 0.0, []
    for u in inputs:
        slopes: list[float] = []
        now = x
        for row in weights:
            slopes.append(gain * (u - now))
            now = x + STEP * sum(weight * slope for weight, slope in zip(row, slopes, strict=False))
        x = now
        found.append(x)
    assert len(places) == order - 1
    return found


def gain(name: str = "twice") -> Files:
    """``y = factor * u``."""
    header = f"""\
typedef struct {{ real_T u; /* '<Root>/u' */ }} ExtU_{name}_T;
typedef struct {{ real_T y; /* '<Root>/y' */ }} ExtY_{name}_T;
struct P_{name}_T_ {{ real_T factor; /* Variable: factor */ }};
typedef struct P_{name}_T_ P_{name}_T;
extern P_{name}_T {name}_P;
extern ExtU_{name}_T {name}_U;
extern ExtY_{name}_T {name}_Y;
extern void {name}_initialize(void);
extern void {name}_step(void);
"""
    source = f"""\
P_{name}_T {name}_P = {{ 2.0 }};
ExtU_{name}_T {name}_U;
ExtY_{name}_T {name}_Y;

void {name}_step(void)
{{
  {name}_Y.y = {name}_P.factor * {name}_U.u;
}}

void {name}_initialize(void)
{{
}}
"""
    return files_of(name, header, source)


def whole_numbers(name: str = "lag") -> Files:
    """Fixed point, an enumeration and integers of all sizes."""
    header = f"""\
typedef enum {{ Off = 0, Slow = 3, Quick = 7 }} Mode;
typedef struct {{
  int16_T speed;                       /* '<Root>/speed': sfix16_En7 */
  Mode mode;                           /* '<Root>/mode' */
  uint8_T small;                       /* '<Root>/small' */
}} ExtU_{name}_T;
typedef struct {{
  int16_T doubled;                     /* '<Root>/doubled': sfix16_En7 */
  Mode same;                           /* '<Root>/same' */
  uint8_T told;                        /* '<Root>/told' */
}} ExtY_{name}_T;
extern ExtU_{name}_T {name}_U;
extern ExtY_{name}_T {name}_Y;
extern void {name}_initialize(void);
extern void {name}_step(void);
"""
    source = f"""\
ExtU_{name}_T {name}_U;
ExtY_{name}_T {name}_Y;

void {name}_step(void)
{{
  /* Sample time: [{STEP}s, 0.0s] */
  {name}_Y.doubled = (int16_T) (2 * {name}_U.speed);
  {name}_Y.same = {name}_U.mode;
  {name}_Y.told = {name}_U.small;
}}

void {name}_initialize(void)
{{
  {name}_U.mode = Off;
}}
"""
    return files_of(name, header, source)
