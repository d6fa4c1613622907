"""Real .fmu archives of the reference models, compiled when they are asked for."""

from __future__ import annotations

import hashlib
import subprocess
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path

import fmpy

from dse.domain.fmu import FmiInterface
from dse.fmu.toolchain.compiler import environment, find_compiler, find_windows_compiler
from dse.fmu.toolchain.platforms import Platform, this_platform
from reference_fmus.declared import ReferenceModel
from reference_fmus.describe import BOTH, description
from reference_fmus.models import MODELS
from reference_fmus.tables import c_tables

SOURCES = Path(__file__).parent / "c"
# The headers of the standard itself, so that what we believe of the interface is checked against it.
HEADERS = Path(fmpy.__file__).parent / "c-code"
_FLAGS = (
    "-std=c11",
    "-O1",
    "-ffp-contract=off",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-Wno-unused-function",
    "-Wno-unused-parameter",
    "-shared",
)


WINDOWS = Platform("x86_64-windows", "win64", ".dll")


def build(
    name: str, version: int, interface: FmiInterface | str | None, folder: Path, platform: Platform | None = None
) -> Path:
    """Write ``NAME_fmiVERSION_INTERFACE.fmu`` into *folder* and return its path; what is there already is kept.

    *name* is one of MODELS, *version* 1, 2 or 3, *interface* "CoSimulation", "ModelExchange" or None for an FMU that
    offers both (FMI 1.0: co-simulation only). Its library is for *platform*, this one or WINDOWS. The same arguments
    give the same bytes.
    """
    model = MODELS[name]
    interfaces = (str(interface),) if interface else BOTH
    platform = platform or this_platform()
    path = folder / f"{name}_fmi{version}_{interface or 'both'}.fmu"
    if path.exists():
        return path
    token = token_of(model, version)
    library = compile_model(model, version, token, folder, platform)
    files = {
        "modelDescription.xml": description(model, version, interfaces, token).encode(),
        str(library_path(version, name, platform)): library.read_bytes(),
        **{f"resources/{file}": content for file, content in model.resources.items()},
    }
    return write_archive(path, files)


def token_of(model: ReferenceModel, version: int) -> str:
    """The GUID or instantiation token: the same for the same model."""
    digest = hashlib.sha256(f"{model.name} {version}".encode()).hexdigest()
    return f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"


def library_path(version: int, identifier: str, platform: Platform | None = None) -> Path:
    """Where the library of *platform*, or this one, lies in an archive."""
    return Path((platform or this_platform()).library(version, identifier))


def compile_model(model: ReferenceModel, version: int, token: str, folder: Path, platform: Platform) -> Path:
    """The library of *model*, compiled in *folder*."""
    work = folder / f"{model.name}_fmi{version}"
    work.mkdir(parents=True, exist_ok=True)
    (work / "variables.h").write_text(c_tables(model, version, token), encoding="utf-8")
    library = work / f"{model.name}{platform.suffix}"
    file = f'-DMODEL="{model.name.lower()}.c"'
    include = [f"-I{path}" for path in (work, SOURCES, HEADERS)]
    compile_c([*include, file, f"-DIDENTIFIER={model.name}", str(SOURCES / f"fmi{version}.c")], library)
    return library


def compile_c(arguments: list[str], library: Path) -> None:
    """Compile a shared library; the compiler's words are the error."""
    is_dll = library.suffix == ".dll"
    compiler = find_windows_compiler() if is_dll and sys.platform != "win32" else find_compiler()
    fpic = [] if is_dll else ["-fPIC"]
    command = [*compiler.command, *_FLAGS, *fpic, *arguments, "-o", str(library), *compiler.link_options, "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, env=environment(), check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)


def write_archive(path: Path, files: Mapping[str, bytes]) -> Path:
    """A zip file with *files*, in their order, without times."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name.replace("\\", "/"), (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
    return path
