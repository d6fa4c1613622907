"""Runs in a Python of its own, without the rest of dse: reads one request a line on stdin, writes one answer a line.

The first request opens: ``{"roots": [folders]}``, answered by the front-end's version. Then ``{"wrapper": text,
"model": name, "filename": name, "folder": path}`` compiles a model of that text beside the files in the folder, and
``{"check": [paths], "folder": path}`` lists what is wrong with files. The front-end may crash, hang or print: the
parent expects that, and answers go over a channel that nothing else writes to.
"""

from __future__ import annotations

import json
import os
from typing import Any


def main() -> None:
    """Answer requests until there are no more."""
    _limit_memory()
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    os.dup2(2, 1)
    requests = os.fdopen(os.dup(0), "r", encoding="utf-8")
    roots: list[str] = []
    for line in requests:
        request = json.loads(line)
        try:
            if "roots" in request:
                roots = request["roots"]
                answer = _version()
            else:
                # Paths are relative to the folder, because the order of what the front-end writes depends on them.
                os.chdir(request["folder"])
                answer = _check(request) if "check" in request else _wrapper(request, roots)
        except BaseException as error:  # noqa: BLE001  # a panic of the front-end is no Exception
            answer = {"error": {"kind": type(error).__name__, "message": str(error)}}
        answers.write(json.dumps(answer, separators=(",", ":")) + "\n")
        answers.flush()


def _limit_memory() -> None:
    """A model of a million variables must not take the machine down. Where there are no limits, none is set."""
    try:
        import resource
    except ImportError:  # Windows
        return
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    wanted = _MOST_MEMORY if most == resource.RLIM_INFINITY else min(_MOST_MEMORY, most)
    resource.setrlimit(resource.RLIMIT_AS, (wanted, most))


_MOST_MEMORY = 4 * 1024**3


def _version() -> dict[str, Any]:
    import rumoca

    return {"version": str(rumoca.version())}


def _wrapper(request: dict[str, Any], roots: list[str]) -> dict[str, Any]:
    import rumoca

    session = rumoca.Session(roots)
    model = session.loads(request["wrapper"], model=request["model"], filename=request["filename"])
    return {"dae": model.to_dict("dae"), "flat": model.to_dict("flat")}


def _check(request: dict[str, Any]) -> dict[str, Any]:
    import rumoca

    found = [(path, entry) for path in request["check"] for entry in rumoca.validate(path)]
    return {
        "found": [
            [path, str(entry.message), entry.line, entry.column, entry.suggestion]
            for path, entry in found
            if str(entry.level) == "error"
        ]
    }


if __name__ == "__main__":
    main()
