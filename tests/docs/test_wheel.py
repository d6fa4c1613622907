"""The wheel, installed where there is no clone: it has the command, the example and the pages."""

from __future__ import annotations

import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    # Not isolated: hatchling is among the tools of development, and nothing is fetched.
    command = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "-q", "-w", str(folder), "."]
    (folder / "report.html").write_text("the report", encoding="utf-8")
    shown = {"DSE_DEMO": str(folder / "report.html")}
    subprocess.run(command, cwd=ROOT, env={**os.environ, **shown}, check=True)
    (found,) = folder.glob("dse_workbench-*.whl")
    return found


@pytest.mark.thorough
def test_the_wheel_carries_the_example_and_every_page_but_no_sources_of_the_web_page(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    pages = {f"dse/content/docs/{p.relative_to(ROOT / 'docs').as_posix()}" for p in (ROOT / "docs").rglob("*.md")}
    assert pages <= names
    assert {name for name in names if name.startswith("dse/content/docs/")} == pages
    assert "dse/content/designs/acc_vehicle.yaml" in names
    assert "dse/content/examples/fmus/components/truck/Truck.mo" in names
    assert "dse/content/schemas/study.json" in names
    assert "dse/report/web/dist/report.js" in names
    assert not [
        name
        for name in names
        if "node_modules" in name or name.startswith(("dse/report/web/src/", "dse/report/web/test"))
    ]


@pytest.mark.thorough
def test_what_is_installed_from_it_lays_out_the_example_and_shows_the_pages(wheel, tmp_path):
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", "venv"], cwd=tmp_path, check=True)
    place = tmp_path / "venv" / ("Scripts" if sys.platform == "win32" else "bin")
    # What dse depends on is taken from the environment of the tests; the wheel alone is new.
    (site,) = (tmp_path / "venv").rglob("site-packages")
    others = [path for path in sys.path if Path(path).name == "site-packages"]
    (site / "others.pth").write_text("\n".join(others), encoding="utf-8")
    subprocess.run([place / "python", "-m", "pip", "install", "-q", "--no-deps", "--no-index", wheel], check=True)
    assert (site / "dse" / "cli" / "__init__.py").is_file()

    def dse(folder: Path, *arguments: str) -> str:
        command = [place / "dse", *arguments]
        done = subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8", check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert dse(tmp_path, "docs", "--path").strip() == str(site / "dse" / "content" / "docs")
    assert dse(tmp_path, "docs", "formats") == (ROOT / "docs" / "formats.md").read_text(encoding="utf-8")
    shown = dse(tmp_path, "demo", "--no-open").splitlines()[0].partition(": ")[2]
    assert Path(shown).read_text(encoding="utf-8") == "the report"
    dse(tmp_path, "init", "study")
    assert dse(tmp_path / "study", "check").startswith("ok: ")


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("platform", "begins"), [("win_amd64", b"MZ"), ("macosx_11_0_arm64", b"\xcf\xfa\xed\xfe\x0c\0\0\1")]
)
def test_a_wheel_for_another_platform_has_the_kernel_for_it_alone(platform, begins, tmp_path):
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, env={**os.environ, "DSE_PLATFORM": platform}, check=True, capture_output=True)
    (built,) = tmp_path.glob(f"dse_workbench-*-py3-none-{platform}.whl")
    with zipfile.ZipFile(built) as archive:
        (kernel,) = [name for name in archive.namelist() if name.startswith("dse/cosim/_kernel")]
        assert archive.read(kernel).startswith(begins)


@pytest.mark.thorough
def test_the_sources_contain_what_a_wheel_is_built_from(tmp_path):
    command = [sys.executable, "-m", "hatchling", "build", "-t", "sdist", "-d", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (built,) = tmp_path.glob("dse_workbench-*.tar.gz")
    with tarfile.open(built) as archive:
        archive.extractall(tmp_path, filter="data")
    source = built.with_name(built.name.removesuffix(".tar.gz"))
    assert not [*source.rglob("node_modules"), *source.rglob("_kernel.*")]
    # Neither a compiler nor Node is on PATH: the bundle is there, and the compiler is a wheel.
    assert (source / "dse/report/web/dist/report.js").is_file()
    environment = {**os.environ, "PATH": str(tmp_path), "CC": ""}
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel"]
    subprocess.run(command, cwd=source, env=environment, check=True, capture_output=True)
    (wheel,) = (source / "dist").glob("*.whl")
    assert any(name.startswith("dse/cosim/_kernel") for name in zipfile.ZipFile(wheel).namelist())
