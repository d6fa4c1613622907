"""Runs in a Python of its own, without the rest of dse: loads a model's library, and says what it begins with.

Arguments are the library's path, how many parameters, inputs and outputs it has, and how many steps to take with all
inputs 0. The answer is JSON on stdout, which the model's own prints do not reach. The model may crash or hang: the
parent expects that.
"""

from __future__ import annotations

import ctypes
import json
import os
import sys


def main() -> None:
    """Tell the parameters' values, and what the model reports of an error after its start and steps."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    os.dup2(2, 1)
    path, *counts = sys.argv[1:]
    told, asked, answered, steps = map(int, counts)
    library = ctypes.CDLL(path)
    library.dse_coded_new.restype = ctypes.c_void_p
    model = ctypes.c_void_p(library.dse_coded_new())
    parameters, inputs, outputs = ((ctypes.c_double * max(count, 1))() for count in (told, asked, answered))
    library.dse_coded_parameters(model, parameters)
    started, error = list(parameters)[:told], None
    for name in ("dse_coded_start", *["dse_coded_step"] * steps):
        function = library[name]
        function.restype = ctypes.c_char_p
        error = function(model, parameters, inputs, outputs)
        if error:
            break
        if name == "dse_coded_start":  # which may set some: what is not finite cannot stand in C as a start value
            library.dse_coded_parameters(model, parameters)
            started = list(parameters)[:told]
    said = error.decode("utf-8", "replace") if error else ""
    answers.write(json.dumps({"parameters": started, "error": said}))
    answers.flush()
    os._exit(0)  # what the model has registered for the end is nobody's concern


if __name__ == "__main__":
    main()
