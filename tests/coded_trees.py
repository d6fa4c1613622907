"""Folders around models as Simulink's coder lays them out, written by hand: what they refer to, share and leave out.

Nothing here was generated; all compute what ``coded_texts.lag`` says, but for what each says of itself.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import coded_texts as texts

Files = Mapping[str, str]
"""Texts by path."""

TOP = "lag_ert_rtw"

# As an older folder has it: the types come from MATLAB's own header.
_TYPES_OF_MATLAB = """\
#ifndef RTWTYPES_H
#define RTWTYPES_H
#include "tmwtypes.h"
#include "simstruc_types.h"
#ifndef POINTER_T
#define POINTER_T
typedef void * pointer_T;
#endif
#endif
"""


def with_board() -> Files:
    """A model with a driver beside it, whose header wants what is only there on its board."""
    return {
        **texts.whole_program(),
        "board.c": '#include "board.h"\nvoid blink(void)\n{\n  BOARD_PIN = 1;\n}\n',
        "board.h": '#include "stm32f4xx.h"\nextern void blink(void);\n',
    }


def that_blinks() -> Files:
    """The same, but the model calls the driver."""
    files = dict(with_board())
    files["lag.c"] = files["lag.c"].replace("  if (lag_U.enable) {\n", "  blink();\n  if (lag_U.enable) {\n", 1)
    files["lag.c"] = files["lag.c"].replace("\nvoid lag_step", "\nextern void blink(void);\nvoid lag_step", 1)
    return files


def logged(final: float) -> Files:
    """For grt: signals are logged, MATLAB may listen, and the program stops at *final* s."""
    files = dict(texts.whole_program())
    files["rtwtypes.h"] = _TYPES_OF_MATLAB
    files["lag.h"] = (
        files["lag.h"]
        .replace(
            '#include "rtwtypes.h"\n',
            '#include <float.h>\n#include <stddef.h>\n#include "rtwtypes.h"\n#include "rtw_extmode.h"\n'
            '#include "sysran_types.h"\n#include "dt_info.h"\n#include "ext_work.h"\n#include "rtw_continuous.h"\n'
            '#include "rtw_solver.h"\n#include "rt_logging.h"\n',
        )
        .replace(
            "struct tag_RTM_lag_T { const char_T * volatile errorStatus; };",
            "struct tag_RTM_lag_T { const char_T *errorStatus; RTWLogInfo *rtwLogInfo; RTWExtModeInfo *extModeInfo;"
            " struct { uint32_T clockTick0; time_T stepSize0; time_T tFinal; time_T *t; time_T tArray[1]; } Timing; };",
        )
    )
    files["lag.c"] = (
        files["lag.c"]
        .replace(
            "  if (lag_DW.Memory > 1000.0) {",
            """\
  rt_UpdateTXYLogVars(lag_M->rtwLogInfo, (lag_M->Timing.t));
  rtExtModeUploadCheckTrigger(1);
  rtExtModeUpload(0, (real_T)lag_M->Timing.t[0]);
  if ((lag_M->Timing.tFinal != -1) &&
      !((lag_M->Timing.tFinal - lag_M->Timing.t[0]) > lag_M->Timing.t[0] * (DBL_EPSILON))) {
    lag_M->errorStatus = "Simulation finished";
  }
  lag_M->Timing.t[0] = (++lag_M->Timing.clockTick0) * lag_M->Timing.stepSize0;
  if (lag_DW.Memory > 1000.0) {""",
        )
        .replace(
            "  lag_U.speed = 0.0;\n",
            f"""\
  static RTWLogInfo rt_DataLoggingInfo;
  static RTWExtModeInfo rt_ExtModeInfo;
  static const sysRanDType *systemRan[1];
  rt_DataLoggingInfo.loggingInterval = NULL;
  lag_M->rtwLogInfo = &rt_DataLoggingInfo;
  rtliSetLogT(lag_M->rtwLogInfo, "tout");
  {{
    static void * rt_LoggedOutputSignalPtrs[1];
    static int_T rt_LoggedOutputWidths[] = {{ 1 }};
    static BuiltInDTypeId rt_LoggedOutputDataTypeIds[] = {{ SS_DOUBLE }};
    static const char_T *rt_LoggedOutputLabels[] = {{ "filtered" }};
    static const char_T *rt_LoggedOutputBlockNames[] = {{ "lag/filtered" }};
    static RTWLogDataTypeConvert rt_RTWLogDataTypeConvert[] = {{
      {{ 0, SS_DOUBLE, SS_DOUBLE, 0, 0, 0, 1.0, 0, 0.0 }}
    }};
    static RTWLogSignalInfo rt_LoggedOutputSignalInfo[] = {{
      {{
        1, rt_LoggedOutputWidths, rt_LoggedOutputWidths, rt_LoggedOutputWidths, (NULL), (NULL), (NULL),
        rt_LoggedOutputDataTypeIds, (NULL), (NULL), {{ rt_LoggedOutputLabels }}, (NULL), (NULL), (NULL),
        {{ rt_LoggedOutputBlockNames }}, {{ (NULL) }}, (NULL), rt_RTWLogDataTypeConvert
      }}
    }};
    rt_LoggedOutputSignalPtrs[0] = &lag_Y.filtered;
    rtliSetLogYSignalPtrs(lag_M->rtwLogInfo, ((LogSignalPtrsType) rt_LoggedOutputSignalPtrs));
    rtliSetLogYSignalInfo(lag_M->rtwLogInfo, rt_LoggedOutputSignalInfo);
  }}
  lag_M->extModeInfo = (&rt_ExtModeInfo);
  rteiSetSubSystemActiveVectorAddresses(&rt_ExtModeInfo, systemRan);
  lag_M->Timing.t = lag_M->Timing.tArray;
  lag_M->Timing.stepSize0 = {texts.STEP};
  lag_M->Timing.tFinal = {final};
  rt_StartDataLoggingWithStartTime(lag_M->rtwLogInfo, 0.0, lag_M->Timing.tFinal, lag_M->Timing.stepSize0,
    (&lag_M->errorStatus));
  lag_U.speed = 0.0;
""",
        )
    )
    return files


def referring(target: str = "ert") -> Files:
    """A model that refers to another one, which has the lag; both use what is shared. Two files bear one name."""
    top = dict(texts.whole_program())
    del top["rtwtypes.h"]
    for name in ("lag.c", "lag.h"):
        top[name] = top[name].replace("real_T Memory;", "DW_child_T child; real_T Memory;")
    top["lag.h"] = top["lag.h"].replace('#include "rtwtypes.h"\n', '#include "rtwtypes.h"\n#include "child.h"\n')
    body = f"    lag_DW.Memory += {texts.STEP} * (lag_U.speed - lag_DW.Memory);\n"
    assert body in top["lag.c"]
    top["lag.c"] = top["lag.c"].replace(body, "    child(&lag_U.speed, &lag_DW.Memory, &lag_DW.child);\n")
    tree = {f"lag_{target}_rtw/{name}": text for name, text in top.items()}
    tree[f"lag_{target}_rtw/extra.c"] = "int of_the_top;\n"
    child = f"slprj/{target}/child"
    tree[f"{child}/child.h"] = """\
/*
 * Code generated for Simulink model 'child'.
 */
#ifndef RTW_HEADER_child_h_
#define RTW_HEADER_child_h_
#include "rtwtypes.h"
#include "moved.h"
typedef struct { real_T Memory; } DW_child_T;
extern void child(const real_T *rtu_speed, real_T *rty_moved, DW_child_T *localDW);
#endif
"""
    tree[f"{child}/child.c"] = """\
#include "child.h"
void child(const real_T *rtu_speed, real_T *rty_moved, DW_child_T *localDW)
{
  localDW->Memory = moved(localDW->Memory, *rtu_speed);
  *rty_moved = localDW->Memory;
}
"""
    tree[f"{child}/extra.c"] = "int of_the_child;\n"
    shared = f"slprj/{target}/_sharedutils"
    tree[f"{shared}/rtwtypes.h"] = texts.TYPES
    tree[f"{shared}/moved.h"] = '#include "rtwtypes.h"\nextern real_T moved(real_T x, real_T u);\n'
    tree[f"{shared}/moved.c"] = (
        f'#include "moved.h"\nreal_T moved(real_T x, real_T u)\n{{\n  return x + {texts.STEP} * (u - x);\n}}\n'
    )
    tree[f"slprj/{target}/stranger/stranger.h"] = "#error not referred to\n"
    tree[f"slprj/{target}/stranger/stranger.c"] = '#include "stranger.h"\n'
    return tree


def calling() -> Files:
    """A model whose gain is a function of the user's, in ``mine``."""
    files = dict(texts.whole_program())
    files["lag.c"] = (
        files["lag.c"]
        .replace("lag_P.Gain * lag_DW.Memory", "users_gain(lag_DW.Memory)")
        .replace('#include "lag.h"\n', '#include "lag.h"\n#include "users.h"\n')
    )
    return {
        **{f"{TOP}/{name}": text for name, text in files.items()},
        "mine/users.h": "extern double users_gain(double x);\n",
        "mine/users.c": f'#include "users.h"\ndouble users_gain(double x)\n{{\n  return {texts.GAIN} * x;\n}}\n',
    }


def constructed(name: str = "lag") -> Files:
    """A model whose memory is made by a function of its name; it also has tables for its C API, which call MATLAB's."""
    files = dict(texts.reusable(name))
    model = f"RT_MODEL_{name}_T"
    del files[f"{name}_data.c"]
    files[f"{name}.h"] = (
        files[f"{name}.h"]
        .replace(f"extern P_{name}_T {name}_P;\n", f"extern {model} *{name}(void);\n")
        .replace(
            "  const char_T *errorStatus;",
            "  const char_T *errorStatus;\n  struct { rtwCAPI_ModelMappingInfo mmi; } DataMapInfo;",
        )
        .replace('#include "rtwtypes.h"\n', '#include "rtwtypes.h"\n#include "rtw_modelmap.h"\n')
        .replace("#endif\n", f"extern void {name}_terminate({model} *{name}_M);\n#endif\n")
    )
    files[f"{name}.c"] += f"""
#include <stdlib.h>
extern void {name}_InitializeDataMapInfo({model} *const {name}_M);

{model} *{name}(void)
{{
  {model} *made = ({model} *) calloc(1, sizeof({model}));
  made->defaultParam = (P_{name}_T *) calloc(1, sizeof(P_{name}_T));
  made->defaultParam->Gain = {texts.GAIN};
  made->inputs = (ExtU_{name}_T *) calloc(1, sizeof(ExtU_{name}_T));
  made->outputs = (ExtY_{name}_T *) calloc(1, sizeof(ExtY_{name}_T));
  made->dwork = (DW_{name}_T *) calloc(1, sizeof(DW_{name}_T));
  {name}_InitializeDataMapInfo(made);
  return made;
}}

void {name}_terminate({model} *{name}_M)
{{
  free({name}_M->defaultParam);
  free({name}_M->inputs);
  free({name}_M->outputs);
  free({name}_M->dwork);
  free({name}_M);
}}
"""
    files[f"{name}_capi.c"] = "#include <rtw_modelmap.h>\n#error tables for MATLAB\n"
    return files


def triggered(name: str = "lag") -> Files:
    """Counts how often its input rises through zero, with the table that the coder gives such models."""
    header = f"""\
#include "zero_crossing_types.h"
typedef struct {{ real_T speed; /* '<Root>/speed' */ }} ExtU_{name}_T;
typedef struct {{ int32_T risen; /* '<Root>/risen' */ int32_T fallen; /* '<Root>/fallen' */ }} ExtY_{name}_T;
extern ExtU_{name}_T {name}_U;
extern ExtY_{name}_T {name}_Y;
extern void {name}_initialize(void);
extern void {name}_step(void);
"""
    source = f"""\
#include "solver_zc.h"
ExtU_{name}_T {name}_U;
ExtY_{name}_T {name}_Y;
static ZCSigState state;

static ZCEventType crossed(ZCSigState *before, real_T value)
{{
  static const slZcEventType events[4][4] = {{
    {{ SL_ZCS_EVENT_NUL, SL_ZCS_EVENT_Z2P, SL_ZCS_EVENT_Z2N, SL_ZCS_EVENT_NUL }},
    {{ SL_ZCS_EVENT_P2Z, SL_ZCS_EVENT_NUL, SL_ZCS_EVENT_P2N, SL_ZCS_EVENT_NUL }},
    {{ SL_ZCS_EVENT_N2Z, SL_ZCS_EVENT_N2P, SL_ZCS_EVENT_NUL, SL_ZCS_EVENT_NUL }},
    {{ SL_ZCS_EVENT_NUL, SL_ZCS_EVENT_NUL, SL_ZCS_EVENT_NUL, SL_ZCS_EVENT_NUL }}
  }};
  const slZcSignalSignType sign = value > 0.0 ? SL_ZCS_SIGN_POS : value < 0.0 ? SL_ZCS_SIGN_NEG : SL_ZCS_SIGN_ZERO;
  slZcEventType event = events[*before & 3][sign];
  event = slZcHadEvent(event, SL_ZCS_EVENT_ALL) ? slZcUnAliasEvents(*before >> 2, event) : SL_ZCS_EVENT_NUL;
  *before = (ZCSigState) (sign | (event << 2));
  return event & SL_ZCS_EVENT_ALL_DN ? FALLING_ZCEVENT : event & SL_ZCS_EVENT_ALL_UP ? RISING_ZCEVENT : NO_ZCEVENT;
}}

void {name}_step(void)
{{
  /* Sample time: [{texts.STEP}s, 0.0s] */
  ZCEventType event = crossed(&state, {name}_U.speed);
  {name}_Y.risen += event == RISING_ZCEVENT;
  {name}_Y.fallen += event == FALLING_ZCEVENT;
}}

void {name}_initialize(void)
{{
  state = UNINITIALIZED_ZCSIG;
}}
"""
    return texts.files_of(name, header, source)


def imported(name: str = "lag") -> Files:
    """Ports and a parameter are variables that others define: one is the number, one points to it."""
    files = dict(texts.exported(name))
    files[f"{name}.h"] = re.sub(
        r"extern (?:real_T (?:speed|Gain)|boolean_T enable);.*?\*/\n", "", files[f"{name}.h"], flags=re.S
    )
    files[f"{name}_private.h"] = f"""\
#ifndef RTW_HEADER_{name}_private_h_
#define RTW_HEADER_{name}_private_h_
extern real_T speed;                   /* '<Root>/speed' */
extern boolean_T *enable;              /* '<Root>/enable' */
extern real_T Gain;                    /* Variable: Gain */
#endif
"""
    source = files[f"{name}.c"].replace(f'#include "{name}.h"\n', f'#include "{name}.h"\n#include "{name}_private.h"\n')
    for line in ("real_T speed;\n", "boolean_T enable;\n", f"real_T Gain = {texts.GAIN};\n"):
        assert line in source
        source = source.replace(line, "", 1)
    files[f"{name}.c"] = source.replace("if (enable)", "if (*enable)")
    return files


def written_elsewhere(name: str = "lag") -> Files:
    """A part of the code in a file of its own writes the output; a driver beside the model writes the input."""
    files = dict(texts.exported(name))
    line = "  filtered = Gain * memory;\n"
    assert line in files[f"{name}.c"]
    files[f"{name}.c"] = (
        files[f"{name}.c"]
        .replace(line, "  amplify(memory);\n")
        .replace("static real_T memory;", "static real_T memory;\nextern void amplify(real_T x);")
    )
    head = f"/*\n * Code generated for Simulink model '{name}'.\n */\n"
    files["amplify.c"] = f'{head}#include "{name}.h"\nvoid amplify(real_T x)\n{{\n{line.replace("memory", "x")}}}\n'
    files["sensor.c"] = f'#include "{name}.h"\nvoid interrupt(double read)\n{{\n  speed = read;\n}}\n'
    return files


def told_by_comments(name: str = "lag") -> Files:
    """Nothing is assigned to the output: a function is given its place. The comments of the step tell."""
    files = dict(texts.exported(name))
    files[f"{name}.c"] = (
        files[f"{name}.c"]
        .replace("static real_T memory;", "static real_T memory;\nstatic void put(real_T *to) { *to = Gain * memory; }")
        .replace(
            "  filtered = Gain * memory;\n",
            "  /* Gain: '<Root>/Gain' incorporates:\n   *  Inport: '<Root>/speed'\n"
            "   *  Outport: '<Root>/filtered'\n   */\n  put(&filtered);\n",
        )
    )
    return files


def with_own_headers(name: str = "lag") -> Files:
    """For grt, in a folder that brings MATLAB's headers: its logs are functions that MATLAB's library has."""
    files = dict(logged(1.0))
    files["rt_logging.h"] = """\
#include "builtin_typeid_types.h"
typedef struct { void *loggingInterval; } RTWLogInfo;
typedef void *LogSignalPtrsType;
typedef struct { int_T a; BuiltInDTypeId b, c; int_T d, e, f; real_T g; int_T h; real_T i; } RTWLogDataTypeConvert;
typedef struct {
  int_T n; void *p[9]; struct { void *q; } r; void *s[3]; struct { void *t; } u, v; void *w[2];
} RTWLogSignalInfo;
#define rtliSetLogT(log, to) ((void)(log))
#define rtliSetLogYSignalPtrs(log, to) ((void)(log))
#define rtliSetLogYSignalInfo(log, to) ((void)(log))
extern const char_T *rt_StartDataLoggingWithStartTime(RTWLogInfo *li, real_T start, real_T final, real_T step,
  const char_T **error);
extern const char_T *rt_UpdateTXYLogVars(RTWLogInfo *li, time_T *t);
"""
    return files


def tasks(name: str = "lag") -> Files:
    """The functions of two rates are within the code: its header shows one that is told the number of a task."""
    files = dict(texts.two_rates(name))
    files[f"{name}.h"] = files[f"{name}.h"].replace(
        f"extern void {name}_step0(void);\nextern void {name}_step1(void);", f"extern void {name}_step(int_T tid);"
    )
    files[f"{name}.c"] += f"""
void {name}_step(int_T tid)
{{
  switch (tid) {{
   case 0 :
    {name}_step0();
    break;

   case 1 :
    {name}_step1();
    break;

   default :
    break;
  }}
}}
"""
    return files
