"""What is needed for a release names what the project has."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from runpy import run_path

from ruamel.yaml import YAML

import dse

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
ON_CONDA = {"matplotlib": "matplotlib-base", "lazy-loader": "lazy_loader"}
ON_PYPI_ONLY = "rumoca"


def test_the_recipe_has_the_dependencies_of_the_project() -> None:
    recipe = YAML(typ="safe").load(ROOT / "packaging/conda/recipe.yaml")
    wanted = dict(re.fullmatch(r"([\w.-]+)(.*)", each).groups() for each in PROJECT["dependencies"])  # type: ignore[union-attr]
    lone = wanted.pop(ON_PYPI_ONLY)
    assert any(f"{ON_PYPI_ONLY}{lone}" in line for line in recipe["build"]["script"])
    wanted = {ON_CONDA.get(name, name): bound for name, bound in wanted.items()}
    found = dict(each.split() for each in recipe["requirements"]["run"])
    assert found.pop("python") == PROJECT["requires-python"]
    assert found == wanted
    assert f'default="{dse.__version__}"' in recipe["context"]["version"]


def test_the_container_installs_extras_that_there_are() -> None:
    text = (ROOT / "packaging/Dockerfile").read_text(encoding="utf-8")
    (extras,) = re.findall(rf"{PROJECT['name']}\[([\w,]+)\]", text)
    assert set(extras.split(",")) <= PROJECT["optional-dependencies"].keys()


def test_the_page_names_every_platform() -> None:
    page = (ROOT / "docs/releases.md").read_text(encoding="utf-8")
    assert re.findall(r"\| `(\w+)` \|", page) == [*run_path(str(ROOT / "hatch_build.py"))["PLATFORMS"]]
