"""Sensors, tracker and emergency brake in a row: what starts to brake, and when."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest

NewPart = Callable[..., Any]
Body = dict[str, Any]
CAR: Body = {"class": "car", "length": 4.5, "width": 1.8, "height": 1.5}
KMH = 1 / 3.6


def copier(source: Any, begin: str, target: Any, into: str) -> Callable[[], None]:
    """Copies all signals below *begin* to those below *into*, which are structs of the same members."""

    def block(part: Any, prefix: str) -> tuple[int, int]:
        slots = [slot for name, (_, slot) in part.slots.items() if name.startswith(prefix)]
        first, last = (ctypes.addressof(slot) for slot in (slots[0], slots[-1]))
        return first, last + ctypes.sizeof(slots[-1]) - first

    (here, size), (there, same) = block(source, begin), block(target, into)
    assert size == same
    return lambda: ctypes.memmove(there, here, size) and None


class Chain:
    """One or two sensors, a tracker and a brake on a straight road, at a speed that braking does not change."""

    def __init__(self, new_part: NewPart, eyes: dict[str, dict[str, Any]], speed: float, **brake: Any) -> None:
        self.eyes = [new_part(name, **values) for name, values in eyes.items()]
        self.tracker, self.brake = new_part("kalman_tracker"), new_part("two_stage_aeb", **brake)
        self.speed = speed
        self.wires = [copier(eye, "scan.", self.tracker, f"{into}.")
                      for eye, into in zip(self.eyes, ("first", "second"), strict=False)]  # fmt: skip
        self.last = copier(self.tracker, "tracks[", self.brake, "tracks[")

    def drive(self, bodies: list[Body], seed: int, seconds: float) -> Iterator[float]:
        """Steps of 10 ms; yields the time after each. Bodies start at their x and y and move by vx and vy."""
        for number, eye in enumerate(self.eyes):
            eye["seed"] = 1000 * number + seed
        for k in range(round(seconds / 0.01)):
            x = self.speed * 0.01 * k
            for part in (*self.eyes, self.tracker, self.brake):
                part["motion.x"], part["motion.speed"] = x, self.speed
            for eye in self.eyes:
                for number, body in enumerate(bodies, 1):
                    vx, vy = body.get("vx", 0.0), body.get("vy", 0.0)
                    moved = {"x": body["x"] + vx * 0.01 * k, "y": body.get("y", 0.0) + vy * 0.01 * k}
                    moved |= {"speed": math.hypot(vx, vy), "heading": math.atan2(vy, vx)}
                    for key, value in {**body, **moved}.items():
                        if key not in ("vx", "vy"):
                            eye[f"actors[{number}].{key}"] = value
                step(eye, k)
            if k % 2 == 0:
                for wire in self.wires:
                    wire()
                step(self.tracker, k)
            self.last()
            step(self.brake, k)
            yield 0.01 * k


def step(part: Any, k: int) -> None:
    if k == 0:
        part.init()
    part.step()
