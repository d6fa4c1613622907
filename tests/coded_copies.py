"""Compiled copies of coded models, for tests: each a library of its own, called as components call it."""

from __future__ import annotations

import ctypes
from pathlib import Path

from dse.simulink import CodedModel


class Copy:
    """A library, loaded from a file of its own, and one model in it."""

    def __init__(self, model: CodedModel, library: bytes, file: Path) -> None:
        file.write_bytes(library)
        self._library, made = ctypes.CDLL(str(file)), model.interface
        self._names = [port.name for port in made.outputs]
        self._sent = {port.name: k for k, port in enumerate(made.inputs)}
        self._set = {port.name: k for k, port in enumerate(made.parameters)}
        sizes = (len(made.parameters), len(made.inputs), len(made.outputs))
        self._parameters, self._inputs, self._outputs = ((ctypes.c_double * max(n, 1))() for n in sizes)
        self._library.dse_coded_new.restype = ctypes.c_void_p
        self._model = ctypes.c_void_p(self._library.dse_coded_new())
        self._library.dse_coded_parameters(self._model, self._parameters)
        for name in ("dse_coded_start", "dse_coded_step"):
            getattr(self._library, name).restype = ctypes.c_char_p

    def parameter(self, name: str) -> float:
        return self._parameters[self._set[name]]

    def start(self, **values: float) -> None:
        for name, value in values.items():
            self._parameters[self._set[name]] = value
        self._call("dse_coded_start")

    def step(self, **values: float) -> dict[str, float]:
        for name, value in values.items():
            self._inputs[self._sent[name]] = value
        self._call("dse_coded_step")
        return dict(zip(self._names, self._outputs, strict=False))

    def _call(self, name: str) -> None:
        said = getattr(self._library, name)(self._model, self._parameters, self._inputs, self._outputs)
        assert not said, said

    def end(self) -> None:
        """Give back what it took."""
        self._library.dse_coded_end(self._model)
