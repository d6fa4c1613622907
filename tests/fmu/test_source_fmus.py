"""FMUs without a library for this platform are compiled from their sources, or it is said why not."""

from __future__ import annotations

import ctypes
import zipfile
from collections.abc import Mapping
from pathlib import Path

import pytest

from dse.errors import DseError
from dse.fmu.component_build import build
from dse.fmu.toolchain.platforms import this_platform
from dse.fmu.unpack import open_fmu

DESCRIPTION_2 = """<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g">
  <CoSimulation modelIdentifier="m">{files}</CoSimulation>
  <ModelVariables/>
</fmiModelDescription>
"""
DESCRIPTION_3 = """<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="g">
  <CoSimulation modelIdentifier="m"/>
  <ModelVariables/>
</fmiModelDescription>
"""
RECIPE = """<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="other"/>
  <BuildConfiguration modelIdentifier="m" platform="amiga"/>
  <BuildConfiguration modelIdentifier="m">
    <SourceFileSet language="C99" compilerOptions="-fwrapv -DOPTION=4">
      <SourceFile name="m.c"/>
      <PreprocessorDefinition name="ANSWER" value="(6 * 7)"/>
      <PreprocessorDefinition name="WITHOUT_VALUE"/>
      <PreprocessorDefinition name="LEFT_OUT" optional="true" value="1"/>
      <IncludeDirectory name="headers"/>
    </SourceFileSet>
    <SourceFileSet><SourceFile name="more/part.c"/></SourceFileSet>
    <Library name="m" external="true"/>
  </BuildConfiguration>
</fmiBuildDescription>
"""
M_3 = """
#define FMI3_FUNCTION_PREFIX m_
#include "fmi3Functions.h"
#include "numbers.h"
#if !defined WITHOUT_VALUE || defined LEFT_OUT || __STDC_VERSION__ != 199901L
#error
#endif
double part(double x);
const char *fmi3GetVersion(void) { return "3.0"; }
__attribute__((visibility("default"))) int numbers(void) { return ANSWER + OPTION + HUNDRED + (int)part(0.0); }
"""
SOURCES_3 = {
    "sources/buildDescription.xml": RECIPE,
    "sources/m.c": M_3,
    "sources/headers/numbers.h": "#define HUNDRED 100\n",
    "sources/more/part.c": "#include <math.h>\ndouble part(double x) { return 1000.0 * cos(x); }\n",
}


@pytest.fixture
def opened(tmp_path, cache):
    """Opens an FMU with these contents; the library it is given is in the cache."""

    def open_it(contents: Mapping[str, str], folder: str = "fmu"):
        (tmp_path / folder).mkdir(exist_ok=True)
        archive = tmp_path / folder / "m.fmu"
        with zipfile.ZipFile(archive, "w") as file:
            for name, content in contents.items():
                file.writestr(name, content)
        return open_fmu(archive, cache=cache)

    return open_it


@pytest.fixture
def refused(opened, tmp_path):
    """What is told of an FMU: ``file:line: what``, the file without the archive's folder."""

    def problems(contents: Mapping[str, str]):
        with pytest.raises(DseError) as caught:
            opened(contents)
        folder = f"{tmp_path / 'fmu'}/"
        return [f"{p.where.file.removeprefix(folder)}:{p.where.line}: {p.what}" for p in caught.value.problems]

    return problems


def without_library(archive: Path, target: Path) -> Path:
    with zipfile.ZipFile(archive) as whole, zipfile.ZipFile(target, "w") as stripped:
        for name in whole.namelist():
            if not name.startswith("binaries/"):
                stripped.writestr(name, whole.read(name))
    return target


def test_our_own_fmus_can_be_compiled_from_what_they_hold(workshop, cache, tmp_path, version):
    archive = build(workshop.counter(), version=version, cache=cache)
    whole = open_fmu(archive, cache=cache)
    made = open_fmu(without_library(archive, tmp_path / "stripped.fmu"), cache=cache)
    assert made.library.name == whole.library.name
    assert made.library.is_relative_to(cache / "compiled")
    prefix = "fmi2" if version == 2 else "fmi3"
    library = ctypes.CDLL(str(made.library))
    answer = getattr(library, f"{prefix}GetVersion")
    answer.restype = ctypes.c_char_p
    assert answer() == (b"2.0" if version == 2 else b"3.0")


def test_a_library_is_made_as_the_build_description_says(opened):
    model = opened({"modelDescription.xml": DESCRIPTION_3, **SOURCES_3})
    library = ctypes.CDLL(str(model.library))
    assert library.numbers() == 42 + 4 + 100 + 1000
    # The source asks for the prefix of static linking, which a library does not have.
    library.fmi3GetVersion.restype = ctypes.c_char_p
    assert library.fmi3GetVersion() == b"3.0"
    assert not hasattr(library, "m_fmi3GetVersion")


def test_an_old_header_cannot_put_a_prefix_before_the_functions(opened):
    header = "#define PASTE(a, b) a ## b\n#define FULL(a, b) PASTE(a, b)\n"
    header += "#define fmi2GetVersion FULL(PREFIX, fmi2GetVersion)\n"
    source = '#define PREFIX m_\n#include "fmi2Functions.h"\nconst char *fmi2GetVersion(void) { return "2.0"; }\n'
    model = opened(
        {
            "modelDescription.xml": DESCRIPTION_2.format(files='<SourceFiles><File name="m.c"/></SourceFiles>'),
            "sources/m.c": source,
            "sources/fmi2Functions.h": header,
        }
    )
    library = ctypes.CDLL(str(model.library))
    library.fmi2GetVersion.restype = ctypes.c_char_p
    assert library.fmi2GetVersion() == b"2.0"


def test_the_same_sources_are_compiled_once_and_others_anew(opened):
    contents = {"modelDescription.xml": DESCRIPTION_3, **SOURCES_3}
    first = opened(contents)
    changed = first.library.stat().st_mtime_ns
    again = opened({**contents, "documentation/index.html": "more"}, "again")
    assert (again.library, again.library.stat().st_mtime_ns) == (first.library, changed)
    assert again.content_hash != first.content_hash
    other = opened({**contents, "sources/headers/numbers.h": "#define HUNDRED 200\n"}, "other")
    assert other.library != first.library


def test_a_library_that_is_there_is_taken_before_sources(opened):
    library = str(this_platform().library(3, "m"))
    assert opened(
        {"modelDescription.xml": DESCRIPTION_3, library: "", "sources/buildDescription.xml": "<"}
    ).library.name


def test_what_the_compiler_refuses_stands_in_the_sources(refused):
    contents = {"modelDescription.xml": DESCRIPTION_3, **SOURCES_3}
    broken = {
        **contents,
        "sources/more/part.c": "\ndouble part(double x) { return y; }\n",
        "sources/m.c": "\n\nint f( {}\n",
    }
    told = refused(broken)
    assert told[0].startswith("m.fmu/sources/m.c:3: its sources do not compile: ")
    assert told[-1].startswith("m.fmu/sources/more/part.c:2: its sources do not compile: ")
    assert "'y'" in told[-1]
    missing = {**contents, "sources/more/part.c": "int unused;\n"}
    assert refused(missing) == ["m.fmu:0: its sources do not compile: 'part' is called but not defined"]


FILE = '<SourceFile name="m.c"/>'
AT = "m.fmu/sources/buildDescription.xml"

REFUSALS = {
    f"{AT}:6: there is no source file 'n.c'": (FILE, '<SourceFile name="n.c"/>'),
    f"{AT}:6: the source file '../../m.c' is not in sources/": (FILE, '<SourceFile name="../../m.c"/>'),
    f"{AT}:6: the source file '-o.c' is not in sources/": (FILE, '<SourceFile name="-o.c"/>'),
    f"{AT}:6: 'm.cpp' is not compiled: only files in C are": (FILE, '<SourceFile name="m.cpp"/>'),
    f"{AT}:6: <SourceFile> has no 'name'": (FILE, "<SourceFile/>"),
    f"{AT}:5: sources in C++11 are not compiled, only those in C": ("C99", "C++11"),
    f"{AT}:5: the compiler option '-fplugin=evil.so' is not supported": ("-fwrapv", "-fplugin=evil.so"),
    f"{AT}:5: the compiler option '-Wl,-rpath,/' is not supported": ("-fwrapv", "-Wl,-rpath,/"),
    f"{AT}:5: the compiler option '@file' is not supported": ("-fwrapv", "@file"),
    f"{AT}:7: 'A B' cannot be defined": ('"ANSWER"', '"A B"'),
    f"{AT}:10: the folder '/etc' is not in sources/": ('"headers"', '"/etc"'),
    f"{AT}:13: it is linked with 'hdf5', which is not supported": ('"m" external', '"hdf5" external'),
    f"{AT}:1: no <BuildConfiguration> makes 'm' for {this_platform().name}": (
        '<BuildConfiguration modelIdentifier="m">',
        '<BuildConfiguration modelIdentifier="n">',
    ),
    f"{AT}:1: its root is <other>, not <fmiBuildDescription>": ("fmiBuildDescription", "other"),
}


@pytest.mark.parametrize("message", REFUSALS)
def test_a_recipe_that_cannot_be_followed_is_refused_by_line(refused, message):
    old, new = REFUSALS[message]
    contents = {"modelDescription.xml": DESCRIPTION_3, **SOURCES_3}
    contents["sources/buildDescription.xml"] = RECIPE.replace(old, new)
    assert refused(contents) == [message]


def test_options_of_another_compiler_mean_nothing(opened):
    recipe = RECIPE.replace('compilerOptions="-fwrapv -DOPTION=4"', 'compiler="MSVC" compilerOptions="/O2"')
    source = M_3.replace("OPTION", "0")
    contents = {"modelDescription.xml": DESCRIPTION_3, **SOURCES_3, "sources/buildDescription.xml": recipe}
    model = opened({**contents, "sources/m.c": source})
    assert ctypes.CDLL(str(model.library)).numbers() == 42 + 100 + 1000


def test_sources_that_nobody_lists_are_not_guessed(refused):
    (told,) = refused({"modelDescription.xml": DESCRIPTION_2.format(files=""), "sources/m.c": ""})
    assert told.endswith("it has no libraries at all, and does not declare which of its sources are to be compiled")
