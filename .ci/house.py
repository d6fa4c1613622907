"""Holds the size of the house against house.toml: a number above its line fails, one far below asks to be lowered.

``python .ci/house.py`` checks (part of ``make lint``); ``--lower`` writes down what has become smaller. Nothing here
raises a number: that is an edit of house.toml, in a commit of its own that says why.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement

HOUSE = Path(__file__).parents[1]
LINES = HOUSE / "house.toml"
DISTRIBUTION = "dse-workbench"
KINDS = ("added", "changed", "fixed", "removed", "security")
SUBJECT = 72


def size_of(folder: Path) -> dict[str, int]:
    """Lines and files of Python in *folder*."""
    texts = [path.read_text(encoding="utf-8") for path in folder.rglob("*.py") if "node_modules" not in path.parts]
    return {"lines": sum(text.count("\n") for text in texts), "files": len(texts)}


def installation() -> dict[str, int]:
    """Packages that come with dse without an extra, and what they take on the disk, byte code aside."""
    found: dict[str, int] = {}
    wanted = [DISTRIBUTION]
    while wanted:
        name = re.sub(r"[-_.]+", "-", wanted.pop()).lower()
        if name in found:
            continue
        try:
            package = distribution(name)
        except PackageNotFoundError:  # for another platform
            continue
        files = [path for path in package.files or () if path.suffix != ".pyc"]
        found[name] = sum(path.size or 0 for path in files)
        needed = [Requirement(text) for text in package.requires or ()]
        wanted += [each.name for each in needed if each.marker is None or each.marker.evaluate({"extra": ""})]
    del found[DISTRIBUTION]
    return {"packages": len(found), "megabytes": round(sum(found.values()) / 1e6)}


def words_to_avoid(glossary: str) -> re.Pattern[str]:
    """What the table of such words in the text of docs/glossary.md finds, whatever its case."""
    table = glossary.partition("## Words to avoid")[2]
    rows = re.findall(r"^\| (.+?) \|", table, re.M)[1:]
    return re.compile(rf"\b(?:{'|'.join(word for row in rows for word in row.split(', '))})\b", re.I)


def prose(page: str) -> str:
    """A page without code and tables' rules: what is read as a text."""
    return re.sub(r"^```.*?^```|`[^`\n]*`", "", page, flags=re.M | re.S)


def messages(source: str) -> str:
    """The texts in Python's *source* that are more than a name, docstrings aside."""
    tree = ast.parse(source)
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    apart = {
        id(statement.value)
        for node in ast.walk(tree)
        if isinstance(node, documented)
        for statement in node.body
        if isinstance(statement, ast.Expr)
    }
    texts = [node for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    return "\n".join(str(node.value) for node in texts if id(node) not in apart and " " in str(node.value))


def names(path: Path) -> str:
    """The name of a module and of what it defines, as words: one name a line."""
    defined = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    found = [node.name for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, defined)]
    return "\n".join(re.sub(r"(?<=[a-z])(?=[A-Z])|_", " ", name) for name in (path.stem, *found))


def worded() -> dict[str, int]:
    """How often words to avoid are used: in pages, in messages of dse, and in names of and in its modules."""
    pattern = words_to_avoid((HOUSE / "docs/glossary.md").read_text(encoding="utf-8"))
    pages = [*HOUSE.glob("*.md"), *(path for path in (HOUSE / "docs").glob("*.md") if path.stem != "glossary")]
    sources = [path for path in (HOUSE / "dse").rglob("*.py") if "node_modules" not in path.parts]
    return {
        "pages": sum(len(pattern.findall(prose(path.read_text(encoding="utf-8")))) for path in pages),
        "messages": sum(len(pattern.findall(messages(path.read_text(encoding="utf-8")))) for path in sources),
        "names": sum(len(pattern.findall(names(path))) for path in sources),
    }


def changes() -> list[str]:
    """What is wrong with the names of changes/*.md, and with the subjects of commits since the one in .ci/base."""
    wrong = [
        f"changes/{path.name}: not +<topic>.<kind>.md with a kind of {', '.join(sorted(KINDS))}"
        for path in sorted((HOUSE / "changes").iterdir())
        if path.name != "README.md" and not re.fullmatch(rf"\+[\w-]+\.({'|'.join(KINDS)})\.md", path.name)
    ]
    base = (HOUSE / ".ci/base").read_text(encoding="utf-8").strip()
    log = ["git", "log", "--no-merges", "--format=%h %s", f"{base}..HEAD"]
    found = subprocess.run(log, cwd=HOUSE, capture_output=True, text=True, check=False)
    if found.returncode:
        print("house: without the history since .ci/base, subjects of commits are not checked")
    subjects = (line.partition(" ") for line in found.stdout.splitlines())
    return wrong + [
        f"commit {commit}: a subject of {len(subject)} characters; {SUBJECT} fit into a line of git log"
        for commit, _, subject in subjects
        if len(subject) > SUBJECT
    ]


def measured() -> dict[str, dict[str, int]]:
    """Every number of house.toml that can be counted; processor time is measured by the tests themselves."""
    rooms = sorted(path for path in (HOUSE / "dse").iterdir() if path.is_dir() and any(path.rglob("*.py")))
    return {
        "dse": size_of(HOUSE / "dse"),
        "tests": size_of(HOUSE / "tests"),
        "installation": installation(),
        "words_to_avoid": worded(),
        **{f"rooms.{room.name}": size_of(room) for room in rooms},
    }


def compared(text: str, numbers_of: dict[str, dict[str, int]], *, lowers: bool) -> tuple[list[str], str]:
    """What is wrong with *numbers_of* by the lines in *text*, and *text* with lines lowered to them if asked for."""
    lines = tomllib.loads(text)
    lines |= {f"rooms.{name}": numbers for name, numbers in lines.pop("rooms").items()}
    wrong = []
    for part, numbers in numbers_of.items():
        for what, number in numbers.items():
            line = lines.get(part, {}).get(what)
            if line is None:
                wrong.append(f"{part} has no line for {what} in house.toml; today: {number}")
            elif number > line:
                wrong.append(f"{part}: {number} {what}, {number - line} above the line of {line} in house.toml")
            elif number < line and lowers:
                text = _lowered(text, part, what, number)
    return wrong, text


def main() -> int:
    """Check, or lower."""
    wrong, text = compared(LINES.read_text(encoding="utf-8"), measured(), lowers="--lower" in sys.argv)
    LINES.write_text(text, encoding="utf-8")
    wrong += changes()
    for each in wrong:
        print(f"house: {each}")
    if not wrong:
        print("house: no number is above its line; changes and subjects are as they should be")
    return bool(wrong)


def _lowered(text: str, part: str, what: str, number: int) -> str:
    """*text* with another number for *what*, in the table *part* or, for a room, on its line."""
    head, _, room = part.partition(".")
    start = re.search(rf"^{room} =.*$", text, re.M) if room else re.search(rf"^\[{head}\]", text, re.M)
    assert start is not None  # noqa: S101  # main found it
    at = start.start() if room else start.end()
    return text[:at] + re.sub(rf"\b{what} = \d+", f"{what} = {number}", text[at:], count=1)


if __name__ == "__main__":
    sys.exit(main())
