"""docs/two_machines.md: its commands do what it says."""

from __future__ import annotations

import re
import shlex
import socket
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import run_dse

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "two_machines.md").read_text(encoding="utf-8")
COMMANDS = [line for block in re.findall(r"```sh\n(.*?)```", TEXT, re.DOTALL) for line in block.splitlines()]


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Path:
    return built_before(tmp_path_factory.mktemp("cache"))


@pytest.mark.thorough
def test_its_layouts_are_printed_and_its_component_is_written(cache, tmp_path):
    layouts = [shlex.split(line)[1:] for line in COMMANDS if line.endswith("--layout")]
    assert len(layouts) == 2
    for arguments in layouts:
        done = run_dse(ROOT, *arguments, cache=cache)
        assert done.returncode == 0, done.stderr
        assert "always" in done.stdout
    (line,) = (line for line in COMMANDS if "--write" in line)
    *arguments, folder = shlex.split(line)[1:]
    done = run_dse(ROOT, *arguments, str(tmp_path / folder), cache=cache)
    assert done.returncode == 0, done.stderr
    assert "kind: udp" in (tmp_path / folder / "component.yaml").read_text()


@pytest.mark.thorough
def test_the_car_and_the_world_find_each_other(cache):
    world, car = (shlex.split(line)[1:] for line in COMMANDS[:2])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    car = [argument.replace("5005", port) for argument in car]
    found = []
    asks = threading.Thread(target=lambda: found.append(run_dse(ROOT, *car, cache=cache)))
    asks.start()
    served = run_dse(ROOT, *world, "--port", port, "--once", cache=cache)
    asks.join()
    assert found[0].returncode == 0, found[0].stderr
    assert served.returncode == 0, served.stderr
    assert "6000 exchanges" in served.stdout
    assert found[0].stdout == run_dse(ROOT, "simulate", "acc_following", cache=cache).stdout


def test_the_component_that_is_written_speaks_as_the_car_does(cache, tmp_path):
    """Order, types and the layout number survive the file."""
    from dse.api import world_at, world_layout, write_world
    from dse.domain.udp import heard, sent
    from dse.loading import Workspace

    bench = Workspace.around(ROOT).bench("road_following")
    layout = world_layout(bench, None, {}, world_at("127.0.0.1:5005"))
    write_world(layout, tmp_path / "components" / "there")
    read = Workspace.around(tmp_path).component("there")
    assert sent(read) == layout.to_world
    assert heard(read) == layout.to_car
    assert [parameter.start for parameter in read.parameters] == [layout.number]
