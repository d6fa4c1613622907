"""The tools as a server over standard input and output, by the official package ``mcp``."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse import __version__
from dse.cli.mcp.tools import Tools
from dse.cli.mistakes import in_words
from dse.errors import fail

if TYPE_CHECKING:
    from mcp.server import MCPServer

    from dse.api import Progress

INSTRUCTIONS = """\
dse explores cyber-physical products: design spaces of alternative components, test benches that simulate them, studies
that vary parameters, and requirements. Begin with `contents`; `summary` names the design of a study to take, with the
reason. Name the run, the verdict, the margin and the error bar with each number that you report, and which verdicts are
doubtful. Results are engineering predictions by simulation."""

READING = (
    "contents",
    "check",
    "count",
    "alternatives",
    "best_configurations",
    "explain",
    "summary",
    "best",
    "findings",
    "run",
    "picture",
    "plan",
)
"""Tools that simulate nothing and leave the workspace as it is."""


def server_of(root: Path, budget: int = 0) -> MCPServer:
    """A server for the workspace around *root*; one that may simulate up to *budget* runs has two more tools.

    Raises DseError if there is no workspace, or without the extra ``mcp``.
    """
    try:
        from mcp.server.mcpserver import Context, Image, MCPServer
        from mcp.types import ToolAnnotations
    except ImportError:
        raise fail("the tool server needs the package 'mcp'", hint="pip install dse-workbench[mcp]") from None

    tools = Tools(root, budget)
    server = MCPServer("dse", version=__version__, instructions=INSTRUCTIONS, log_level="WARNING")
    reads = ToolAnnotations(read_only_hint=True, open_world_hint=False)
    for name in READING:
        server.add_tool(_answering(getattr(tools, name), Image), annotations=reads)
    if budget:
        import anyio.from_thread

        def explore(study: str, context: Context[Any, Any]) -> dict[str, Any]:
            def report(progress: Progress) -> None:
                what = f"{progress.stage}: {progress.done} of {progress.total}"
                anyio.from_thread.run(context.report_progress, progress.done, progress.total, what)

            return tools.explore(study, report)

        explore.__doc__ = tools.explore.__doc__
        explore.__annotations__ |= {"study": str, "context": Context[Any, Any], "return": dict[str, Any]}
        writes = ToolAnnotations(read_only_hint=False, destructive_hint=False, open_world_hint=False)
        for each in (explore, tools.simulate):
            server.add_tool(_answering(each, Image), annotations=writes)
    return server


def _answering(tool: Callable[..., Any], image: Callable[..., Any]) -> Callable[..., Any]:
    """*tool*, whose problems are answers, and whose bytes are a picture."""
    from mcp.server.mcpserver.exceptions import ToolError

    @wraps(tool)
    def called(*arguments: Any, **named: Any) -> Any:
        try:
            found = tool(*arguments, **named)
        except Exception as error:  # noqa: BLE001  # one message for whatever it is, as on the command line
            raise ToolError(str(in_words(error))) from None
        return image(data=found, format="png") if isinstance(found, bytes) else found

    if signature(tool).return_annotation in (bytes, "bytes"):
        called.__annotations__ = {name: kind for name, kind in called.__annotations__.items() if name != "return"}
        called.__signature__ = signature(tool).replace(return_annotation=Any)  # type: ignore[attr-defined]
    return called
