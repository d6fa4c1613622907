"""The tool server, asked as an assistant asks: by an official client, and by one that sends nonsense."""

from __future__ import annotations

import asyncio
import base64
import os
import random
import shutil
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from example_study import small_study
from mcp import Client, StdioServerParameters

from dse.api import Results
from dse.cli.mcp.server import READING, server_of

pytestmark = pytest.mark.thorough
PNG = b"\x89PNG"

WORDS = (
    "",
    "small",
    "acc_vehicle",
    "acc_following",
    "out/small",
    "../..",
    "/etc",
    "a\0b",
    "ü" * 300,
    "sensor",
    "speed",
)
CONDITIONS = ("sum(cost) <= 6000 EUR", "sum(cost) <= 6000", "(" * 500, "1 /", "sensor == 'x'", "sum(mass) > 1 banana")
NUMBERS = (-1, 0, 1, 5, 19, 50, 10**9, 10**30, 1.5, "7", None, True)


@pytest.fixture(scope="module")
def workspace(example: Path, explored: Path, cache: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The example with the small study explored, and a study of two designs that is not."""
    place = tmp_path_factory.mktemp("mcp") / "work"
    shutil.copytree(example, place)
    shutil.copytree(explored, place / "out" / "small")
    two = small_study(2, 2).replace("study: small", "study: two").replace("and controller is pd_acc ", "")
    (place / "testbenches" / "two.pet.yaml").write_text(two.replace(" and video is absent", ""), encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DSE_CACHE", str(cache))
        yield place


def test_an_assistant_finds_the_cheapest_design_that_meets_all_requirements_in_few_calls(
    workspace: Path, cache: Path
) -> None:
    told: list[float] = []

    async def asked() -> list[Any]:
        command = StdioServerParameters(
            command=sys.executable,
            args=["-m", "dse", "mcp", "--runs", "30"],
            cwd=str(workspace),
            env={**os.environ, "DSE_CACHE": str(cache)},
        )

        async def tell(done: float, total: float | None, message: str | None) -> None:
            told.append(done)

        async with Client(command) as client:
            listed = await client.call_tool("contents", {})
            explored = await client.call_tool("explore", {"study": "two"}, progress_callback=tell)
            best = await client.call_tool("best", {"folder": "two", "minimize": ["sum(cost)"], "number": 1})
            first = best.structured_content["best"][0]
            run = {"folder": "two", "number": first["runs"][0], "signals": ["world.speed"], "points": 20}
            shown = await client.call_tool("run", run)
            drawn = await client.call_tool("picture", {"folder": "two"})
        return [listed, explored, best, shown, drawn]

    listed, explored, best, shown, drawn = asyncio.run(asked())
    assert "two" in {each["name"] for each in listed.structured_content["studies"]}
    study = explored.structured_content
    assert told
    assert study["finished"] == study["runs"] == len(Results(workspace / "out" / "two"))
    expected = Results(workspace / "out" / "two").best(1, minimize=["sum(cost)"])
    first, wanted = best.structured_content["best"][0], expected.best[0]
    assert (first["configuration"], first["values"]) == (wanted.configuration, list(wanted.values))
    assert first["margins"].keys() == {each["name"] for each in study["requirements"]}
    run = shown.structured_content
    assert {each["verdict"] for each in run["requirements"].values()} == {"pass"}
    assert len(run["time"]) == len(run["waveforms"]["world.speed"]["values"]) <= 20
    assert base64.b64decode(drawn.content[0].data).startswith(PNG)


def test_without_runs_it_only_reads(workspace: Path) -> None:
    async def asked(runs: int) -> tuple[set[str], Any]:
        async with Client(server_of(workspace, runs)) as client:
            names = {each.name for each in (await client.list_tools()).tools}
            return names, await client.call_tool("explore", {"study": "acc_gains"})

    names, answer = asyncio.run(asked(0))
    assert names == {*READING}
    assert answer.is_error
    names, answer = asyncio.run(asked(1))
    assert names == {*READING, "explore", "simulate"}
    assert "2,178 runs would be simulated, and 1 are left of the budget" in answer.content[0].text


def test_nonsense_gets_an_answer_or_a_problem_in_words(workspace: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in workspace.rglob("*.yaml")}
    answers = asyncio.run(nonsense(workspace, 300, seed=1))
    assert min(answers.values()) > 20
    assert {path: path.stat().st_mtime_ns for path in workspace.rglob("*.yaml")} == before


async def nonsense(workspace: Path, calls: int, seed: int) -> Counter[bool]:
    """Make so many random *calls*; how many of them were answered with a problem, and how many were not."""
    chance = random.Random(seed)  # noqa: S311  # not a secret
    answers = Counter[bool]()
    async with Client(server_of(workspace)) as client:
        tools = [each for each in (await client.list_tools()).tools if each.name != "check"]
        for _ in range(calls):
            tool = chance.choice(tools)
            needed = set(tool.input_schema.get("required", ()))
            given = {
                name: _value(chance, name)
                for name in tool.input_schema["properties"]
                if chance.random() < (0.97 if name in needed else 0.3)
            }
            answer = await client.call_tool(tool.name, given)
            answers[bool(answer.is_error)] += 1
            if answer.is_error:
                text = answer.content[0].text
                assert "mistake in dse" not in text, (tool.name, given)
                assert text != f"Error executing tool {tool.name}", (tool.name, given)
    return answers


def _value(chance: random.Random, name: str) -> Any:
    if chance.random() < 0.1:
        return chance.choice([*NUMBERS, [], {}, ["x"], {"sensor": 7}])
    return chance.choice(
        {
            "where": CONDITIONS,
            "choose": (
                {"sensor": "radar_77ghz_mid"},
                {"sensor": "none"},
                {"": ""},
                {"video": "absent", "sensor": "x=y"},
            ),
            "number": NUMBERS[:7],
            "points": NUMBERS[:7],
            "run": NUMBERS[:7],
            "minimize": ("sum(cost)", "sum(", ["sum(cost)"], ["settling_time", "x"], []),
            "maximize": ("sum(mass)", "min_ttc", ["min_ttc"]),
            "signals": (["world.speed"], ["nothing"], ["world.speed"] * 50),
            "x": ("controller.kp_speed", "nothing"),
            "y": ("controller.kd_speed", "nothing"),
        }.get(name, WORDS)
    )
