"""The process that does the work of traffic by SUMO: ``python -m dse.world.sumo.partner FOLDER``.

dse/fmu/runtime/partner.h starts it and talks with it. libsumo is loaded once and never used here: a simulation is
warmed up in a fork of this process, and each run is made in a fork of that. So no process has more than one simulation,
runs with the same parameters begin in the very same state, and whoever crashes takes nobody along.
"""

from __future__ import annotations

import json
import os
import struct
import sys
from pathlib import Path
from typing import NoReturn

from dse.partners import END, START, STEP, Line, Question, how_ended, open_line
from dse.world.sumo.simulation import Simulation, SumoError


class _Partner:
    def __init__(self, folder: Path, line: Line) -> None:
        told = json.loads((folder / "lanes.json").read_text("utf-8"))
        self._folder, self._line = folder, line
        self._parameters: list[str] = told["parameters"]
        self._inputs: list[str] = told["inputs"]

    def serve(self) -> None:
        """Have simulations warmed up until nobody asks any more."""
        question = self._line.question()
        while question:
            question = self._in_a_fork(question) if question[0] == START else self._line.question()

    def _in_a_fork(self, question: Question) -> Question | None:
        """Warm up and make all runs with the same parameters; the first question with others, None if there is none."""
        back, to = os.pipe()
        child = os.fork()
        if not child:
            os.close(back)
            left = self._warm(question)
            if left:
                os.write(to, struct.pack(f"=I{len(left[1])}d", left[0], *left[1]))
            os._exit(0)
        os.close(to)
        with os.fdopen(back, "rb") as file:
            handed = file.read()
        if self._ended(child):
            return self._line.question()
        return (question[0], struct.unpack(f"={(len(handed) - 4) // 8}d", handed[4:])) if handed else None

    def _warm(self, asked: Question) -> Question | None:
        question: Question | None = asked
        said = _listen()
        values = asked[1][1 : 1 + len(self._parameters)]
        try:
            simulation = Simulation(self._folder, dict(zip(self._parameters, values, strict=True)))
        except Exception as error:  # noqa: BLE001  # whatever it is, it is told
            self._line.refuse(_error_text(error, said))
            return self._line.question()
        while question and question[0] == START and question[1][1 : 1 + len(values)] == values:
            child = os.fork()
            if not child:
                self._run(simulation, question, said)
            self._ended(child)
            question = self._line.question()
        return question

    def _run(self, simulation: Simulation, question: Question | None, said: int) -> NoReturn:
        first = 1 + len(self._parameters)
        while question and question[0] != END:
            kind, numbers = question
            inputs = dict(zip(self._inputs, numbers[first:], strict=True))
            try:
                self._line.answer(simulation.step(inputs, numbers[0]) if kind == STEP else simulation.look(inputs))
            except Exception as error:  # noqa: BLE001  # whatever it is, it is told
                self._line.refuse(_error_text(error, said))
                os._exit(0)
            question = self._line.question()
        os._exit(0)

    def _ended(self, child: int) -> bool:
        """Wait for *child*; whether it ended of itself without having answered, which is told now."""
        told = how_ended(child, "SUMO")
        if told:
            self._line.refuse(told)
        return bool(told)


def _listen() -> int:
    """A file that gets all that SUMO prints."""
    file = os.memfd_create("said")
    os.dup2(file, 1)
    os.dup2(file, 2)
    return file


def _error_text(error: Exception, said: int) -> str:
    """What went wrong, in SUMO's words if it has said something."""
    if isinstance(error, SumoError):
        return str(error)
    text = os.pread(said, os.fstat(said).st_size, 0).decode("utf-8", "replace")
    lines = [
        line.removeprefix("Error: ") for line in text.splitlines() if line.strip() and not line.startswith("Quitting")
    ]
    return f"SUMO: {' '.join(lines[-3:]) or f'{type(error).__name__}: {error}'}"


def main() -> None:
    """Talk until nobody asks any more."""
    talk = open_line()
    try:
        os.environ["LIBSUMO_AS_TRACI"] = "quiet"
        import libsumo  # noqa: F401  # forks have it then
    except ImportError as error:
        talk.question()
        talk.refuse(f"libsumo cannot be imported ({error}); run: pip install 'dse-workbench[traffic]'")
        return
    _Partner(Path(sys.argv[1]), talk).serve()


if __name__ == "__main__":
    main()
