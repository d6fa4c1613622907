"""Events: their times and what they do, by hand; between them closed forms."""

from __future__ import annotations

import math
from itertools import pairwise

from language_case import Cases, Given, Steps, Values
from reference import remembered, root

CASES = Cases()
case = CASES.case

EXACT = 1e-12


@remembered
def bounces(g: float, e: float) -> list[tuple[float, float]]:
    """Time of each bounce up to 1.4 s and the speed after it."""
    t, v = math.sqrt(2 / g), math.sqrt(2 * g)
    found = []
    while t < 1.4 and v > 0.05:
        v *= e
        found.append((t, v))
        t += 2 * v / g
    return found


@case(
    "BouncingBall",
    given={"g": 9.81, "e": 0.8},
    variants=({"e": 0.5},),
    stop=1.3,
    events=tuple(t for e in (0.8, 0.5) for t, _ in bounces(9.81, e)),
    error=1e-7,
)
def bouncing_ball(t: float, given: Given) -> Values:
    g = given["g"]
    done = [bounce for bounce in bounces(g, given["e"]) if bounce[0] <= t]
    if not done:
        return {"height": 1 - g * t * t / 2, "count": 0}
    since = t - done[-1][0]
    return {"height": done[-1][1] * since - g * since**2 / 2, "count": len(done)}


@case(
    "StartsOfTime",
    given={"period": 0.4},
    variants=({"period": 0.3},),
    events=(0.1, 0.3, 0.4, 0.5, 0.7, 0.9),
    error=1e-7,
)
def starts_of_time(t: float, given: Given) -> Values:
    periods = (t + 0.5) / given["period"]
    count = math.floor(periods + 1e-9)
    since = t - 0.5 if t >= 0.5 else (t + 1) / 2
    return {"y": periods - count, "count": count, "since": since, "x": 2 * math.exp(-t)}


@case("FrictionThatCatches", given={"m": 0.25}, stop=1.6, events=(math.sqrt(2) - 1, 1.0), error=1e-7)
def friction_that_catches(t: float, given: Given) -> Values:
    """m w' = t - friction; at rest from 2 t^2 + 4 t = 2 until the force reaches the limit."""
    if t < math.sqrt(2) - 1:
        return {"y": 4 * t + 2 * t * t - 2, "mode": -1}
    return {"y": 0, "mode": 0} if t < 1 else {"y": 2 * (t - 1) ** 2, "mode": 1}


@case("ReinitAndWhen", events=(0.3, 0.7))
def reinit_and_when(t: float, given: Given) -> Values:
    if t < 0.3:
        return {"y": [t, -1, -1, 0]}
    if t < 0.7:
        return {"y": [t - 0.4, 0.3, -1, 1]}
    return {"y": [t - 0.9, 0.3, 0.7, 2]}


@case("ReinitStates", events=(0.5,))
def reinit_states(t: float, given: Given) -> Values:
    if t < 0.5:
        return {"y": t, "z": 10 - t, "n": 0}
    return {"y": 9 + t, "z": 1 - t, "n": 1}


@remembered
def switching(low: float, high: float) -> list[tuple[float, float, float]]:
    """From when, from which temperature and to which it is heated or cooled."""
    t, temperature, rest, found = 0.0, 15.0, 30.0, []
    while t < 1.5:
        found.append((t, temperature, rest))
        limit = high if rest == 30.0 else low
        t += math.log((temperature - rest) / (limit - rest))
        temperature, rest = limit, 35.0 - rest
    return found


@case(
    "Hysteresis",
    given={"low": 19.0, "high": 21.0},
    variants=({"low": 18.0}, {"high": 25.0}),
    stop=1.4,
    events=tuple(t for pair in ((19, 21), (18, 21), (19, 25)) for t, _, _ in switching(*pair)[1:]),
    error=1e-6,
)
def hysteresis(t: float, given: Given) -> Values:
    start, temperature, rest = [part for part in switching(given["low"], given["high"]) if part[0] <= t][-1]
    return {"y": rest + (temperature - rest) * math.exp(start - t), "on": rest == 30.0}


@case("ElsewhenPriority", events=(0.125, 0.25, 0.5, 0.65))
def elsewhen_priority(t: float, given: Given) -> Values:
    return {"y": (100 if t > 0.125 else 0) + (t > 0.25) + (t > 0.5) + (10000 if t > 0.65 else 0)}


@case("EventChain", events=(0.4, 0.8))
def event_chain(t: float, given: Given) -> Values:
    return {"links": t > 0.4, "rises": (t > 0.4) + (t > 0.8), "done": t > 0.4}


@case("EventIteration", events=(0.5,))
def event_iteration(t: float, given: Given) -> Values:
    return {"y": 7 if t > 0.5 else 0, "full": t > 0.5}


@case(
    "SampledController",
    given={"wanted": 1.0, "Ki": 2.0, "Kp": 0.5},
    variants=({"Ki": 0.5}, {"wanted": -2.0}),
    stop=2.0,
    events=tuple(k / 10 for k in range(1, 21)),
)
def sampled_controller(t: float, given: Given) -> Values:
    x = total = 0.0
    for k in range(int(t * 10 + 1e-9) + 1):
        error = given["wanted"] - x
        total += 0.1 * error
        u = given["Kp"] * error + given["Ki"] * total
        span = min(t - k / 10, 0.1)
        x = u + (x - u) * math.exp(-span)
    return {"y": x, "command": u}


@case("SampleRates", events=tuple(k / 20 for k in range(1, 21)), error=1e-9)
def sample_rates(t: float, given: Given) -> Values:
    a = math.floor(t / 0.1) + 1
    b = sum(0.05 + 0.15 * k for k in range(10) if 0.05 + 0.15 * k <= t)
    c = 2 ** sum(0.2 + 0.05 * k <= t for k in range(30)) - 1
    return {"y": [a, b, c, a + 100 * b + 1000 * c]}


@case("SampleMeetsState", events=(0.25, 0.5, 0.75))
def sample_meets_state(t: float, given: Given) -> Values:
    ticks = sum(tick for tick in (0.25, 0.5, 0.75) if tick < t)
    return {"y": [t - 0.5 if t > 0.5 else t, ticks, 1.75 if t > 0.5 else 0, t > 0.5]}


@case("StateMachine", stop=2.0, events=(0.5, 0.7, 1.0, 1.4, 1.6, 1.9))
def state_machine(t: float, given: Given) -> Values:
    begun = [0.0, 0.5, 0.7, 1.0, 1.4, 1.6, 1.9]
    k = sum(at <= t for at in begun) - 1
    x = [0.0, 0.5, 0.1][k % 3] if k not in {3, 6} else 0.1
    return {"now": k % 3 + 1, "y": x + [1, -2, 0][k % 3] * (t - begun[k]), "since": t - begun[k]}


@case("EnumerationMachine", events=(0.5, 0.75))
def enumeration_machine(t: float, given: Given) -> Values:
    if t < 0.5:
        return {"now": 2, "speed": 2 * t}
    return {"now": 3, "speed": 1.5 - t} if t < 0.75 else {"now": 1, "speed": 0.75}


@case("BoundaryAtStart")
def boundary_at_start(t: float, given: Given) -> Values:
    late = t > 0
    return {"strict": late, "loose": not late, "y": [late, 0, 0], "z": 5 if late else 7}


@case("TwoAtOnce", events=(0.5,), error=1e-9)
def two_at_once(t: float, given: Given) -> Values:
    if t < 0.5:
        return {"n": [0, 0, 0], "at": [0, 0], "z": t}
    return {"n": [1, 1, 2], "at": [0.5, 0.5 + 1e-7 / 3], "z": 0.5 + 3 * (t - 0.5)}


@case("TimeEvents", given={"t0": 0.2, "width": 0.05}, variants=({"t0": 0.3, "width": 0.1},), error=1e-9)
def time_events(t: float, given: Given) -> Values:
    pulse = 20 * min(max(t - given["t0"], 0), given["width"])
    up = min(max(t - 0.5, 0), 0.2)
    return {"y": pulse + 5 * up**2 + 2 * max(t - 0.7, 0), "z": 10 * up}


@case("HeldInContinuous", stop=2.0, events=(0.5, 1.1, 1.7))
def held_in_continuous(t: float, given: Given) -> Values:
    begun, starts, held = [0.0, 0.5, 1.1, 1.7], [1.0, 1.5, 0.9, 1.5], [0.0, 1.5, 2.4, 3.9]
    k = sum(at <= t for at in begun) - 1
    x = starts[k] + (1 if k % 2 == 0 else -1) * (t - begun[k])
    return {"y": x, "z": held[k] * x}


LEVEL = Steps((0, 0.21, 0.42, 0.63, 0.84), (0.0, 2.0, 0.5, 3.0, -1.0))


@case("InputSteps", inputs={"u": LEVEL})
def input_steps(t: float, given: Given) -> Values:
    x = 0.0
    for start, stop, u in zip(LEVEL.times, (*LEVEL.times[1:], math.inf), LEVEL.values, strict=True):
        if start < t - 1e-9:
            x = u + (x - u) * math.exp(start - min(t, stop))
    u = LEVEL.before(t)
    done = [value for at, value in zip(LEVEL.times, LEVEL.values, strict=True) if at < t - 1e-9 and value > 1]
    return {"y": x, "z": done[-1] if done else 0, "n": len(done), "direct": 2 * u if u > 1 else -u}


ON = Steps((0, 0.14, 0.56, 0.77), (0, 1, 0, 1))
GEAR = Steps((0, 0.28, 0.63), (1, 2, 3))


@case(
    "DiscreteInputs", inputs={"on": ON, "gear": GEAR}, given={"rate[2]": -2.0}, variants=({"rate[2]": 5.0},), error=1e-9
)
def discrete_inputs(t: float, given: Given) -> Values:
    rates = [1, given["rate[2]"], 4]
    times = sorted({*ON.times, *GEAR.times, 1.0})
    x = 0.0
    for start, stop in pairwise(times):
        if ON.after(start) and start < t:
            x += rates[int(GEAR.after(start)) - 1] * (min(t, stop) - start)
    return {"y": x, "n": sum(at < t - 1e-9 for at in (0.14, 0.77)), "m": sum(at < t - 1e-9 for at in (0.28, 0.63))}


@case("DiscreteFeedback", stop=2.1, events=(0.5, 1.0, 1.5, 2.0))
def discrete_feedback(t: float, given: Given) -> Values:
    return {"value": (math.floor(2 * t) + 1) % 4 if t > 0 else 0}


@case("WhenAlgorithm", events=(0.2, 0.4, 0.6, 0.8, 1.0))
def when_algorithm(t: float, given: Given) -> Values:
    return {"y": [1, 2, 3, 6, 12, 24][int(5 * t + 1e-9)] + t}


@remembered
def slide(fs: float, fc: float) -> tuple[float, float]:
    start = math.asin(fs / 4) / math.pi
    return start, root(lambda t: speed_of(t, start, fc), 1 - math.asin(fc / 4) / math.pi, 2)


def speed_of(t: float, start: float, fc: float) -> float:
    return 4 / math.pi * (math.cos(math.pi * start) - math.cos(math.pi * t)) - fc * (t - start)


@case(
    "FrictionStickSlip",
    given={"fs": 3.0, "fc": 2.0},
    variants=({"fs": 3.5}, {"fc": 1.0}),
    stop=2.0,
    events=tuple(t for pair in ((3, 2), (3.5, 2), (3, 1)) for t in slide(*pair)),
    error=1e-6,
)
def friction_stick_slip(t: float, given: Given) -> Values:
    start, stop = slide(given["fs"], given["fc"])
    sliding = start < t < stop
    return {"speed": speed_of(t, start, given["fc"]) if sliding else 0, "slips": sliding}


@case("AssertsAndWarnings", error=1e-9)
def asserts_and_warnings(t: float, given: Given) -> Values:
    return {"y": t}


@case("ElsewhenReinit", events=(0.25, 0.5))
def elsewhen_reinit(t: float, given: Given) -> Values:
    return {"y": [t if t < 0.5 else t - 0.5, t if t < 0.25 else t - 0.25]}


RATE = Steps((0, 0.21, 0.49), (1.0, -2.0, 30.0))
THRESHOLD = Steps((0, 0.35, 0.7), (10.0, -1.0, 8.0))


@case("TunableParameters", tuned={"rate": RATE, "threshold": THRESHOLD}, error=1e-9, exchanged=False)
def tunable_parameters(t: float, given: Given) -> Values:
    x = 0.0
    for start, stop in pairwise([*RATE.times, 2.0]):
        x += RATE.after(start) * max(min(t, stop) - start, 0)
    return {"y": x, "z": 2 * RATE.before(t), "above": x > THRESHOLD.before(t)}


@remembered
def turns(band: float) -> list[float]:
    """When sin(7 t) leaves the band by the other side than the last time."""
    first = math.asin(band)
    found = []
    for k in range(4):
        found += [(first + 2 * math.pi * k) / 7, (math.pi + first + 2 * math.pi * k) / 7]
    return found


@case(
    "RelationOnPre",
    given={"band": 0.5},
    variants=({"band": 0.9},),
    stop=2.0,
    events=tuple(t for band in (0.5, 0.9) for t in turns(band)),
    error=1e-7,
)
def relation_on_pre(t: float, given: Given) -> Values:
    times = [0.0, *(turn for turn in turns(given["band"]) if turn < t), t]
    area = sum((-1) ** (k + 1) * (stop - start) for k, (start, stop) in enumerate(pairwise(times)))
    return {"on": len(times) % 2 == 1, "y": area, "n": len(times) - 2}


@case("LoopWithLimits", error=1e-12)
def loop_with_limits(t: float, given: Given) -> Values:
    u = 6 * t - 3
    a = u / 1.5 if abs(u) < 1.5 else u - math.copysign(0.5, u)
    return {"y": a, "z": min(max(a, -1), 1)}


@remembered
def level_at(t: float, leak: float) -> float:
    def when(root_of_level: float) -> float:
        return 2 * (1 - root_of_level - leak * math.log((1 + leak) / (root_of_level + leak)))

    return root(lambda s: when(s) - t, 0, 1) ** 2 if t < when(0.0) else t - when(0.0) + 1000


@case("RootBeyondEvent", given={"leak": 0.1}, variants=({"leak": 0.5},), stop=2.0, error=1e-6, exchanged=False)
def root_beyond_event(t: float, given: Given) -> Values:
    level = level_at(t, given["leak"])
    return {"y": level, "z": 0} if level < 500 else {"y": 0, "z": level - 1000}


@case("PulseTrain", given={"duty": 0.3}, variants=({"duty": 0.75},), step=0.0137, error=1e-8)
def pulse_train(t: float, given: Given) -> Values:
    whole = math.floor(t / 0.01 + 1e-9)
    return {"y": 0.01 * (whole * given["duty"] + min(t / 0.01 - whole, given["duty"]))}


@remembered
def roots_of_load() -> tuple[float, float]:
    return root(lambda x: x**3 + x - 2, 0, 2), root(lambda x: x**3 + x - 30, 2, 4)


@case("EventInLoop", events=(0.5,), error=1e-9)
def event_in_loop(t: float, given: Given) -> Values:
    low, high = roots_of_load()
    return {"y": low if t < 0.5 else high, "z": low * min(t, 0.5) + high * max(t - 0.5, 0)}


@case("DelayedReaction", events=(0.5,), error=1e-9)
def delayed_reaction(t: float, given: Given) -> Values:
    return {"y": [2 + t, 1, 0] if t < 0.5 else [8 + t, 4, 12.5]}


@case("MixedKinds", given={"side": 2}, stop=1.5, events=(0.6, 1.2), variants=({"side": 1},), error=1e-9)
def mixed_kinds(t: float, given: Given) -> Values:
    x = 2 * t / 3 if t < 1.2 else 0.8 - 2 * (t - 1.2) / 3  # 2 * 3 - 4 = 2 at 0.6 s, 2 * 3 - 8 = -2 at 1.2 s
    count = 2 if t < 1.2 else -2
    return {
        "y": 3 * x + count,
        "z": -x if given["side"] == 2 else x,
        "whole": count + 3,
        "is_big": count >= 2 or given["side"] == 1,
    }


@case("RelationsOfJumps", given={"T": 0.5}, variants=({"T": 0.31},), events=(0.5, 0.31))
def relations_of_jumps(t: float, given: Given) -> Values:
    late = t > given["T"]
    return {"never": 0, "once": int(late), "never_too": 0, "caught": 10 if late else 0}


@case("SampleFromStart", step=0.0713, events=(0.1, 0.3, 0.5, 0.7, 0.9), error=1e-12)
def sample_from_start(t: float, given: Given) -> Values:
    count = math.floor((t + 0.1) / 0.2)
    return {"at": 0.2 * count - 0.1 if count else -1.0, "count": count}


@case("SeveralWhens", given={"second": 0.4}, variants=({"second": 0.5},), events=(0.2, 0.4, 0.5, 0.6, 0.8), error=0.0)
def several_whens(t: float, given: Given) -> Values:
    changes = {0.2: 1, given["second"]: 2, 0.4: 3, 0.8: 4}
    count = next((changes[at] for at in sorted(changes, reverse=True) if t >= at), 0)
    return {"count": count, "lit": 0.4 <= t < 0.6 or t >= 0.8}


@case("PreferredRates", given={"d": 2.0}, variants=({"d": 1.0},), events=(0.5,))
def preferred_rates(t: float, given: Given) -> Values:
    """The relative speed falls alone; that of the first body gets half of what it loses, from 0 anew at 0.5 s."""
    d = given["d"]
    relative = math.exp(-2 * d * t)
    first = 1 + (1 - relative) / 2 if t <= 0.5 else (math.exp(-d) - relative) / 2
    return {"first": first, "second": first + relative, "gap": (1 - relative) / (2 * d)}


@case("SharedSignal", events=(0.2, 0.4, 0.45, 0.6, 0.8, 0.9, 1.0), error=EXACT)
def shared_signal(t: float, given: Given) -> Values:
    fast, slow = math.floor(t / 0.2), math.floor(t / 0.45)
    return {"total": 2 * fast + slow, "square": slow * (2 * fast + slow)}


@case("InitialValueBefore", events=(0.25, 0.5), error=1e-12)
def initial_value_before(t: float, given: Given) -> Values:
    is_late = t > 0.5
    return {"y": [3 + is_late, 60 if is_late else 6, 7.25 if t > 0.25 else 7, 5 + 2 * is_late, 11 - is_late]}


@case("StartsOfFreeParameters", given={"scale": 2.0}, variants=({"scale": 4.0},), events=(0.5, 1.0), error=1e-12)
def starts_of_free_parameters(t: float, given: Given) -> Values:
    p = 5 if given["scale"] < 3 else 7
    d, ticks = given["scale"] * p + 0.5, math.floor(2 * t)
    return {"y": [p + ticks, 2 * p + 1 + ticks, d + ticks, d + p + 2 * max(ticks - 1, 0)]}


@case("BooleanUnderConditions", events=(0.25, 0.45, 0.65, *(k / 10 for k in range(1, 11))), error=1e-12)
def boolean_under_conditions(t: float, given: Given) -> Values:
    """On from 0.25 s, off at 0.45 s as the count is 4, on at 0.65 s; late at the tick of 0.7 s, which puts it off."""
    is_on = 0.25 < t < 0.45 or 0.65 < t < 0.7
    return {"y": [is_on, 0.7 < t < 0.9, is_on, math.floor(10 * t)]}
