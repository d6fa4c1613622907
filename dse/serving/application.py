"""The addresses of the server and what each answers. A GET changes nothing."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TypeVar
from urllib.parse import quote

from dse.api import Compared, StudySummary, compare, stop, study_summary
from dse.errors import DseError, fail
from dse.serving.comparison import compare_page
from dse.serving.drives import LiveDrives
from dse.serving.driving import drive_routes
from dse.serving.guard import Application, Guard, Limits
from dse.serving.open_studies import OpenStudies
from dse.serving.pages import problem_page, start_page
from dse.serving.point_requests import AskedPoint, BusyError, problem_of, read_request, simulated_point
from dse.serving.replays import Replays, run_number, waiting_page
from dse.serving.study_index import StudyIndex

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.routing import BaseRoute

T = TypeVar("T")

_MOST_COMPARED = 8

_NO_CODE = (
    '<!doctype html><meta http-equiv="Content-Security-Policy" '
    "content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'\">"
)
"""Before a page that is read from a folder, whoever made that."""


def application(
    index: StudyIndex,
    *,
    token: str = "",
    is_open: bool = False,
    limits: Limits | None = None,
    drives: LiveDrives | None = None,
) -> Application:
    """An ASGI application for the studies of *index*, and for *drives* if there are some, guarded as `Guard` says.

    DseError without the extra ``serve``.
    """
    try:
        from starlette.applications import Starlette
        from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse
        from starlette.routing import Route
    except ImportError:
        hint = "python -m pip install 'dse-workbench[serve]'"
        raise fail("serving needs the packages starlette and uvicorn", hint=hint) from None
    # Two pages of each drive, as one that is loaded anew connects before the old one is gone.
    limits = limits or Limits(sockets=2 * drives.most + 16 if drives else 16)
    open_studies = OpenStudies()
    replays = Replays(index.workspace)

    def name_of(request: Request) -> str:
        return request.query_params.get("study", "")

    def start(_: Request) -> Response:
        return HTMLResponse(
            start_page(str(index.root), {n: _summary(index, n) for n in index.studies}, is_rated=index.is_rated)
        )

    def study(request: Request) -> Response:
        name = request.path_params["name"]
        return HTMLResponse(open_studies.page(name, index.folder(name)))

    def rated(_: Request) -> Response:
        return HTMLResponse(_NO_CODE + index.rating())

    def opened(request: Request) -> Response:
        # As the links of a rating's page lead to files; the browser keeps the run in the fragment.
        run = request.path_params.get("run")
        return RedirectResponse(f"/study/{quote(request.path_params['name'])}/{f'replay/{run}' if run else ''}")

    def progress(request: Request) -> Response:
        return JSONResponse(open_studies.progress(index.folder(name_of(request))))

    def compared(request: Request) -> Response:
        names = dict.fromkeys(name for _, name in request.query_params.multi_items())
        return HTMLResponse(compare_page(_compared(index, [*names])))

    async def simulate(request: Request) -> Response:
        asked = read_request(await request.body(), AskedPoint)
        folder = index.folder(name_of(request))
        return JSONResponse(await _aside(lambda: simulated_point(folder, asked, index.workspace)))

    def replay(request: Request) -> Response:
        name, run = request.path_params["name"], run_number(request.path_params["run"])
        page = replays.page(index.folder(name), run)
        return HTMLResponse(waiting_page(name, run) if page is None else page)

    async def replayed(request: Request) -> Response:
        folder, run = index.folder(name_of(request)), run_number(request.query_params.get("run", ""))
        if request.method == "POST":
            await _aside(lambda: replays.make(folder, run))
        return JSONResponse({"told": replays.told(folder, run)})

    def stopped(request: Request) -> Response:
        writer = stop(index.folder(name_of(request)))
        return JSONResponse({"asked": str(writer)})

    def unfit(request: Request, error: Exception) -> Response:
        if not isinstance(error, DseError):
            raise error
        is_page = request.url.path in ("/compare", "/drive") or request.url.path.startswith("/study/")
        status = 404 if is_page else 409
        return HTMLResponse(problem_page(error), status) if is_page else JSONResponse(problem_of(error), status)

    def busy(_: Request, __: Exception) -> Response:
        told = problem_of(fail("another run is being simulated", hint="wait until it has finished"))
        return JSONResponse(told, 429, {"retry-after": "1"})

    routes: list[BaseRoute] = [
        Route("/", start),
        Route("/rating.html", rated),
        Route("/{name:path}/report.html", opened),
        Route("/{name:path}/replays/run_{run:int}.html", opened),
        Route("/study/{name:path}/", study),
        Route("/study/{name:path}/replay/{run}", replay),
        Route("/replay", replayed, methods=["GET", "POST"]),
        Route("/progress", progress),
        Route("/compare", compared),
        Route("/simulate", simulate, methods=["POST"]),
        Route("/stop", stopped, methods=["POST"]),
    ]
    if drives is not None:
        routes += drive_routes(drives, _aside)
    handlers = {DseError: unfit, BusyError: busy}
    return Guard(Starlette(routes=routes, exception_handlers=handlers), token=token, is_open=is_open, limits=limits)


async def _aside(work: Callable[[], T]) -> T:
    """What *work* returns or raises, done in a thread that the program's end does not wait for."""
    loop = asyncio.get_running_loop()
    done: asyncio.Future[T] = loop.create_future()

    def settle(how: Callable[[Any], None], what: object) -> None:
        if not done.cancelled():
            how(what)

    def pass_on(how: Callable[[Any], None], what: object) -> None:
        with suppress(RuntimeError):  # the server has ended meanwhile
            loop.call_soon_threadsafe(settle, how, what)

    def thread() -> None:
        try:
            result = work()
        except Exception as error:  # noqa: BLE001  # raised where it is waited for
            pass_on(done.set_exception, error)
        else:
            pass_on(done.set_result, result)

    threading.Thread(target=thread, daemon=True).start()
    return await done


def _summary(index: StudyIndex, name: str) -> StudySummary | DseError:
    try:
        return study_summary(index.folder(name))
    except DseError as error:
        return error


def _compared(index: StudyIndex, names: list[str]) -> dict[str, Compared]:
    if not 2 <= len(names) <= _MOST_COMPARED:
        raise fail(f"two to {_MOST_COMPARED} studies can be compared", hint="tick them in the list of all studies")
    return dict(zip(names, compare([index.folder(name) for name in names]), strict=True))
