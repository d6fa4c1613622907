"""``dse docs``, and that what dse says and lays out leads to pages and files that are there."""

from __future__ import annotations

import re
from pathlib import Path

from dse.shipped import content

ROOT = Path(__file__).parents[2]
PAGES = {path.relative_to(ROOT / "docs").with_suffix("").as_posix(): path for path in (ROOT / "docs").rglob("*.md")}
TEXTS = {".md", ".yaml", ".c", ".h", ".mo", ".order", ".json"}
COMMAND = re.compile(r"dse docs ([\w/-]+)")
LINK = re.compile(r"\]\(([^)#\s]+)")
PATH = re.compile(r"(?<![\w/.])(?:\.\./|docs/)[\w./-]*\w")


def test_the_pages_are_listed_each_with_its_title(dse):
    done = dse("docs")
    assert done.returncode == 0, done.stderr
    rows = [line.split(maxsplit=1) for line in done.stdout.splitlines()[1:]]
    assert {name for name, _ in rows} == set(PAGES)
    assert ["formats", "The files dse reads and writes"] in [[name, title.strip()] for name, title in rows]


def test_a_page_goes_into_a_pipe_as_it_is_written(dse):
    assert dse("docs", "formats").stdout == PAGES["formats"].read_text(encoding="utf-8")
    assert dse("docs", "decisions/0005-verdicts.md").stdout.startswith("# 5. Four verdicts")


def test_a_page_that_is_not_there_is_named_with_the_one_meant(dse):
    done = dse("docs", "format")
    assert done.returncode == 1
    assert "there is no page 'format'\n    hint: did you mean 'formats'?" in done.stderr


def test_the_folder_and_a_file_of_it_can_be_asked_for(dse):
    assert Path(dse("docs", "--path").stdout.strip()) == content("docs") / "docs"
    assert Path(dse("docs", "formats", "--path").stdout.strip()) == PAGES["formats"]


def test_every_link_and_path_in_the_laid_out_example_leads_somewhere(example):
    files = [path for path in example.rglob("*") if path.suffix in TEXTS]
    assert len(files) > 50
    dead = []
    for file in files:
        text = file.read_text(encoding="utf-8")
        named = LINK.findall(text) if file.suffix == ".md" else PATH.findall(text)
        for target in (target for target in named if "://" not in target):
            found = (file.parent / target).resolve()
            if not (found.exists() and found.is_relative_to(example.resolve())):
                dead.append(f"{file.relative_to(example)}: {target}")
        dead += [f"{file.relative_to(example)}: dse docs {page}" for page in COMMAND.findall(text) if page not in PAGES]
    assert dead == []


def test_every_page_a_message_names_is_there():
    code = {path: path.read_text(encoding="utf-8") for path in (ROOT / "dse").rglob("*.py")}
    named = [(path.name, page) for path, text in code.items() for page in COMMAND.findall(text)]
    assert ("yaml.py", "formats") in named
    assert [(file, page) for file, page in named if page not in PAGES] == []
    # Users of a wheel have no folder docs/: messages say the command.
    assert [path.name for path, text in code.items() if re.search(r"\"[^\"\n]*\bdocs/\w+\.md", text)] == []
