"""Folders of generated code that mean harm or are broken: what they hold by file name, and what `dse check` says."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import coded_texts as texts
from coded_workspaces import Code

GOOD = texts.whole_program("bad")


def changed(file: str, old: str, new: str, files: Code = GOOD) -> dict[str, str | bytes]:
    """*files* with another text at one place."""
    text = files[file]
    assert isinstance(text, str)
    assert old in text
    return {**files, file: text.replace(old, new, 1)}


def in_step(line: str) -> dict[str, str | bytes]:
    """A model that does this at the beginning of each step."""
    return changed("bad.c", "/* Sample time:", f"{line}\n  /* Sample time:")


def in_header(text: str) -> dict[str, str | bytes]:
    """A model with more in its header."""
    return changed("bad.h", '#include "rtwtypes.h"\n', f'#include "rtwtypes.h"\n{text}\n')


def ports(lines: str) -> dict[str, str | bytes]:
    """A model with more inputs."""
    return changed("bad.h", "} ExtU_bad_T;", f"{lines}\n}} ExtU_bad_T;")


def without(*files: str) -> dict[str, str | bytes]:
    return {name: text for name, text in GOOD.items() if name not in files}


def laughs(first: str, joint: str, levels: int) -> str:
    lines = [f"#define A0 {first}"]
    lines += [f"#define A{n} {joint.join([f'A{n - 1}'] * 10)}" for n in range(1, levels)]
    return "\n".join(lines)


def nested(levels: int, inner: str = "real_T a") -> str:
    lines = [f"typedef struct {{ {inner}; }} S0;"]
    lines += [f"typedef struct {{ S{n - 1} a, b; }} S{n};" for n in range(1, levels)]
    return "\n".join(lines)


_INCLUDED = '#include "rtwtypes.h"\n'
_TWO = {**texts.whole_program("bad"), **texts.whole_program("other")}
_NO_GUARD = changed("bad.h", "#ifndef RTW_HEADER_bad_h_\n", '#ifndef RTW_HEADER_bad_h_\n#include "loop.h"\n')

REFUSED: dict[str, tuple[Code, str]] = {
    "gone": ({}, "bad_ert_rtw: there is no such folder"),
    "no C": ({"readme.txt": "hello"}, "bad_ert_rtw: no model .* is in this folder\n.*it holds no C at all"),
    "only headers": (without("bad.c", "bad_data.c"), "bad_ert_rtw: no model"),
    "two models": (_TWO, r"there are several models: bad, other\n.*hint: model: bad"),
    "a header is missing": (
        in_header('#include "away.h"'),
        r"bad_ert_rtw/bad.h:\d+:\d+: the code includes 'away.h', which is not in the folder",
    ),
    "a header of Latin-1 is missing": (
        {**GOOD, "bad.h": str(GOOD["bad.h"]).replace("rtwtypes", "größe").encode("latin-1")},
        r"bad_ert_rtw/bad.h:\d+:\d+: ",
    ),
    "a header includes itself": (
        {**_NO_GUARD, "loop.h": '#include "loop.h"\n'},
        r"bad_ert_rtw/loop.h:1:\d+: #include nested too deeply",
    ),
    "headers include each other": (
        {**_NO_GUARD, "loop.h": '#include "pool.h"\n', "pool.h": '#include "loop.h"\n'},
        r"bad_ert_rtw/[lp]oo[lp].h:1:\d+: #include nested too deeply",
    ),
    "a header of the home folder": (
        in_header('#include "../../../secret.h"'),
        r"secret.h:1:1: (?!.*password is)",
    ),
    "the list of users": (in_header('#include "/etc/passwd"'), r"/etc/passwd:1:\d+: "),
    "include_next": (in_header("#include_next <away.h>"), r"bad.h:\d+:\d+: .*'away.h'"),
    "a device": (in_header('#include "/dev/zero"'), r"bad.h.*: "),
    "macros in the header": (
        in_header(f"{laughs('1+1+1+1', '+', 12)}\nenum {{ E = A11 }};"),
        r"bad.h: what it declares cannot be read",
    ),
    "parentheses": (
        in_header(f"enum {{ E = {'(' * 100_000}1{')' * 100_000} }};"),
        r"bad.h:\d+:\d+: bracket nesting level exceeded maximum of 256",
    ),
    "pointers to pointers": (in_header(f"extern int {'*' * 5000}p;"), r"bad.h: a type has more than 64 others"),
    "arrays of arrays": (in_header(f"extern int a{'[1]' * 200};"), r"bad.h: a type has more than 64 others"),
    "structs in structs": (
        in_header(f"{'struct { ' * 1000}int a; {'} s;' * 1000}"),
        r"bad.h:\d+:\d+: bracket nesting level",
    ),
    "structs of structs": (
        in_header(nested(25)) | {"bad.h": str(ports("S24 all;")["bad.h"]).replace(_INCLUDED, _INCLUDED + nested(25))},
        r"'all' holds more than 20,000 numbers",
    ),
    "structs of nothing": (
        {**GOOD, "bad.h": str(ports("S50 all;")["bad.h"]).replace(_INCLUDED, _INCLUDED + nested(51, "int a[0]"))},
        r"'all' holds more than 20,000 numbers",
    ),
    "structs many deep": (
        {
            **GOOD,
            "bad.h": str(ports("S400 all;")["bad.h"]).replace(
                _INCLUDED, _INCLUDED + nested(401).replace(" a, b;", " a;")
            ),
        },
        r"'all' holds more than 20,000 numbers, or structs 64 deep",
    ),
    "a huge array": (ports("real_T all[1000000000];"), r"'all' has 1,000,000,000 elements"),
    "a huge type": (ports("real_T all[1000000000000000000];"), r"bad.h:\d+:\d+: .*(?:too large|exceeds)"),
    "a name without end": (ports(f"real_T {'x' * 5000};"), r"the name 'x*…' has 5,000 characters"),
    "a number without end": (
        changed("bad.h", "bad_step(void)", f"bad_step{'9' * 5000}(void)"),
        r"bad.h: the name 'bad_step9+…' has 5,\d+ characters",
    ),
    "a syntax error in the header": (in_header("extern int ;;; )"), r"bad_ert_rtw/bad.h:\d+:\d+: expected"),
    "a binary": ({**GOOD, "bad.h": b"Code generated for Simulink model 'bad' step(\0\0\xff\xfe" * 9}, r"bad.h:1:1: "),
    "no step": (
        changed("bad.c", "/* Sample time: [0.1s, 0.0s] */", ""),
        "nothing in the code gives the length of a step",
    ),
    "no function": (changed("bad.h", "bad_step(void)", "bad_stop(void)"), "'bad' has no function 'bad_step'|no model"),
}
"""What `dse check` says of them, at the workspace's file."""

NOT_COMPILED: dict[str, tuple[Code, str]] = {
    "a syntax error": (in_step("speed = ;"), r"bad_ert_rtw/bad.c:\d+:\d+: .*undeclared|expected"),
    "a function that is nowhere": (in_step("extern void away(void); away();"), "'away' is called but not defined"),
    "a variable twice": ({**GOOD, "bad_more.c": '#include "bad.h"\nDW_bad_T bad_DW;\n'}, "defined twice"),
    "parentheses": (in_step(f"int i = {'(' * 100_000}1{')' * 100_000};"), r"bad_ert_rtw/bad.c: the compiler failed"),
    "a file of others": (in_step('#include "../../../secret.h"'), r"bad.c:\d+:\d+: .*secret.h"),
    "an #error": (in_step("\n#error not for you\n"), r"bad.c:\d+:\d+: #error not for you"),
}
"""What `dse simulate` says of them; `dse check` compiles nothing."""

FAILING: dict[str, tuple[Code, str]] = {
    "divided by 0": (in_step("{ volatile int z = 0; z = 7 / z; }"), r"crashed \(signal 8\)"),
    "a null pointer": (in_step("*(volatile int *)0 = 1;"), r"crashed \(signal 11\)"),
    "recursion": (
        changed(
            "bad.c",
            "/* Model step",
            "static int deep(volatile int n) { return n ? deep(n + 1) + n : 0; }\n/* Model step",
            in_step("bad_Y.count = deep(1);"),
        ),
        r"crashed \(signal 11\)",
    ),
    "abort": (in_step("extern void abort(void); abort();"), r"crashed \(signal 6\)"),
    "exit": (in_step("extern void exit(int); exit(0);"), r"ended by itself \(exit code 0\)"),
    "_exit": (in_step("extern void _exit(int); _exit(0);"), r"ended by itself \(exit code 0\)"),
    "a step without end": (in_step('for (;;) { __asm__ volatile (""); }'), r"no answer|longer than|timeout"),
    "an initialization without end": (
        changed("bad.c", "bad_U.speed = 0.0;", 'for (;;) { __asm__ volatile (""); }'),
        r"no answer|longer than|timeout",
    ),
    "an error status": (in_step('if (bad_Y.count > 4) bad_M->errorStatus = "over the top";'), "over the top"),
    "a constructor": (
        {
            **GOOD,
            "bad.c": str(GOOD["bad.c"])
            + "__attribute__((constructor)) static void first(void) { extern void abort(void); abort(); }\n",
        },
        r"crashed \(signal 6\)",
    ),
}
"""What `dse simulate` says of runs with them."""

LONG = {
    text.strip() or repr(text): text
    for text in (
        "/*", "[", "(", " ", "\n", "a.", "a ", "a", "a[", "_step", "bad_step(", "x_initialize(", "x_initialize(){",
        "memcpy(& ", "1", "rtmSetTStep(", "FixedStepSize(", "TID[1]) > 4) ", "Sample time: [1.1", "static\n",
        "P_bad_T bad_P = { ", "} ", '"', "++", "'<Root>/", "clockTick0 ", "typedef long ", "speed[speed",
    )
}  # fmt: skip
"""What patterns that read code may take the square of the time for, over and over."""

IN_THE_WAY: dict[str, Callable[[Path], None]] = {
    "a link to nowhere": lambda folder: (folder / "z.h").symlink_to("nowhere"),
    "a link to itself": lambda folder: (folder / "z.h").symlink_to("z.h"),
    "a folder": lambda folder: (folder / "z.c").mkdir(),
    "an option": lambda folder: (folder / "-o.c").touch(),
    "a list of options": lambda folder: (folder / "@z.c").touch(),
    "two lines": lambda folder: (folder / "a\nb.c").touch(),
    "a quote": lambda folder: (folder / 'a"b.h').touch(),
}
"""What is done to a folder that is good."""
