"""Random numbers of the Modelica Standard Library, whose C code is not part of dse, by functions of the runtime.

A generator's functions become others that draw each result by a call of its own: the front-end refuses a call with
several results in a when-clause, and states whose size is an argument. The hidden state of the impure generator is
that of the one block that draws from it. A seed by the clock of the machine ends the run. Lines stay where they are.
"""

from __future__ import annotations

import re

from dse.modelica.frontend.source_text import Change, code, edited

IMPURE_SEED = 715827883
"""The local seed of the impure generator."""
_GENERATORS = "Modelica.Math.Random.Generators."
_DRAWN = """pure function {0} input Integer stateIn[:]; input Integer which; output {1} y;
    external "C" y = dse_random(stateIn, size(stateIn, 1), which); end {0};"""
_RANDOM = f"""function random input Integer stateIn[nState]; output Real result; output Integer stateOut[nState];
    algorithm result := dse_draw(stateIn, 0); stateOut := dse_next(stateIn); end random;
  function dse_next input Integer stateIn[nState]; output Integer stateOut[nState];
    algorithm for i in 1:nState loop stateOut[i] := dse_step(stateIn, i); end for; end dse_next;
  {_DRAWN.format("dse_draw", "Real")} {_DRAWN.format("dse_step", "Integer")}"""
_INITIAL = """function initialState input Integer localSeed; input Integer globalSeed; output Integer state[nState];
    algorithm for i in 1:nState loop state[i] := dse_start(localSeed, globalSeed, i); end for; end initialState;
  pure function dse_start input Integer localSeed; input Integer globalSeed; input Integer which; output Integer y;
    external "C" y = dse_random_start(localSeed, globalSeed, which); end dse_start;"""
_AUTOMATIC = """function automaticGlobalSeed output Integer seed; algorithm
    assert(false, "a seed by the clock is not reproducible: set useAutomaticSeed = false, and fixedSeed"); seed := 1;
    end automaticGlobalSeed;"""
_INITIALIZED = """function initializeImpureRandom input Integer seed; output Integer id;
    algorithm id := seed; end initializeImpureRandom;"""
# Name, what such a function contains, and the other one.
_FUNCTIONS = (
    ("random", r"\bModelicaRandom_xorshift(?:64star|128plus|1024star)\b", _RANDOM),
    ("initialState", r"\bstate\b", _INITIAL),
    ("automaticGlobalSeed", r"\bModelicaRandom_automaticGlobalSeed\b", _AUTOMATIC),
    ("initializeImpureRandom", r"\bsetInternalState\b", _INITIALIZED),
)
_BOTH = re.compile(
    r"\(\s*([\w.]+)\s*,\s*([\w.]+)\s*\)(\s*:?=\s*(?:\w+\s*\.\s*)*(?:generator|Xorshift\w+)\s*\.\s*)random\s*"
    r"(\(\s*pre\s*\([^()]*\)\s*\))"
)
_IMPURE = re.compile(r"([\w.]+\s*=\s*)(?:\w+\s*\.\s*)*impureRandom\s*\(([^()]*)\)")


def with_random(text: str) -> str:
    """*text* of a file with random numbers that the runtime knows."""
    if "Random" not in text:
        return text
    clean = code(text)
    changes: list[Change] = []
    for name, content, new in _FUNCTIONS if "package Random" in clean else ():
        whole = re.compile(rf"(?:\b(?:im)?pure\s+)?\bfunction\s+{name}\b.*?\bend\s+{name}\s*;", re.DOTALL)
        changes += [(*found.span(), new) for found in whole.finditer(clean) if re.search(content, found[0])]
    changes += [
        (*found.span(), f"{found[1]}{found[3]}random{found[4]}; {found[2]}{found[3]}dse_next{found[4]}")
        for found in _BOTH.finditer(clean)
    ]
    for found in re.finditer(r"\bblock\s+(\w+)\b(?!\s*=).*?\bend\s+\1\s*;", clean, re.DOTALL):
        changes += _own_state(clean, *found.span())
    lines = ((start, end, " ".join(new.split()) + "\n" * text.count("\n", start, end)) for start, end, new in changes)
    return edited(text, lines)


def _own_state(clean: str, start: int, end: int) -> list[Change]:
    """What a block without blocks in it needs to draw from a state of its own, at its only call of the generator."""
    calls = [*_IMPURE.finditer(clean, start, end)]
    begins = re.compile(r"(?<!initial\s)\bequation\b").search(clean, start, end)
    if len(calls) != 1 or begins is None or len(re.findall(r"\bimpureRandom", clean[start:end])) > 1:
        return []
    (call,) = calls
    generator, state = f"{_GENERATORS}Xorshift1024star", "pre(dse_state)"
    declared = f"protected Integer dse_state[33]; parameter Integer dse_seed = {call[2]}; initial equation"
    first = f"{declared} {state} = {generator}.initialState({IMPURE_SEED}, dse_seed); equation"
    drawn = f"{call[1]}{generator}.random({state}); dse_state = {generator}.dse_next({state})"
    return [(*begins.span(), first), (*call.span(), drawn)]
