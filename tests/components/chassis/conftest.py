"""Cars on a ground that a test draws."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

NewPart = Callable[..., Any]
Ground = Callable[[float, float], tuple[float, float, float, float]]  # height, dz/dx, dz/dy, friction at x, y


def dry(_x: float, _y: float) -> tuple[float, float, float, float]:
    return 0.0, 0.0, 0.0, 1.0


class Car:
    """A chassis on a ground, asked and told by the names of its ports."""

    def __init__(self, part: Any, ground: Ground) -> None:
        self.part, self.ground = part, ground

    def __getitem__(self, name: str) -> float:
        return self.part[name]

    def __setitem__(self, name: str, value: float) -> None:
        self.part[name] = value

    def start(self, x: float = 0.0, y: float = 0.0, heading: float = 0.0) -> Car:
        self["start.x"], self["start.y"], self["start.heading"] = x, y, heading
        for _ in range(2):  # where the wheels stand, and what is there
            self.part.init()
            self.look()
        self.part.init()
        return self

    def look(self) -> None:
        for i in range(1, 5):
            told = self.ground(self[f"contacts[{i}].x"], self[f"contacts[{i}].y"])
            for name, value in zip(("height", "slope_x", "slope_y", "friction"), told, strict=True):
                self[f"ground[{i}].{name}"] = value

    def drive(self, duration: float, step: float = 0.01, each: Callable[[], None] | None = None) -> None:
        for _ in range(round(duration / step)):
            if self.ground is not dry:
                self.look()
            self.part.step(step)
            if each:
                each()

    def brake(self, front: float, rear: float) -> None:
        self["brake.front"], self["brake.rear"] = front, rear

    def load(self) -> float:
        return sum(self[f"load[{i}]"] for i in range(1, 5))

    def parameters(self, *names: str) -> list[float]:
        return [self[name] for name in names]


@pytest.fixture
def new_car(new_part: NewPart) -> Callable[..., Car]:
    def make(name: str, ground: Ground = dry, **parameters: Any) -> Car:
        part = new_part(name, **{key.replace("__", "."): value for key, value in parameters.items()})
        return Car(part, ground)

    return make
