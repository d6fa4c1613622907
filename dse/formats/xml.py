"""XML text → elements that know their line; safe for files that come from anywhere.

Document types and entities are refused, so nothing is fetched and nothing is expanded; sizes are limited.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from dse.errors import Location, Problem, closest, fail

V = TypeVar("V")

_MOST_BYTES = 128 * 2**20
_MOST_LEVELS = 100
# Elements and attributes together; each takes some hundred bytes once it is read.
_MOST_PARTS = 10_000_000
UNBOUND = "unbound:"
"""What the namespace of a prefix begins with that is bound to none."""


@dataclass(frozen=True, slots=True, eq=False)
class XmlElement:
    """One element: its *tag* without a prefix, in *namespace* ("" for none), and where its start tag stands.

    *attributes* are by name, those with a prefix by ``{namespace}name``. *text* is all character data directly in the
    element, as it stands there; *children* are the elements directly in it, in order. Comments and processing
    instructions are left out.
    """

    tag: str
    namespace: str
    attributes: Mapping[str, str]
    text: str
    children: tuple[XmlElement, ...]
    where: Location

    def get(self, name: str, default: str = "") -> str:
        """The attribute called *name* as it is written, or *default*."""
        return self.attributes.get(name, default)

    def child(self, tag: str, namespace: str | None = None) -> XmlElement | None:
        """The first child with this tag (in any namespace, if none is asked for), or None."""
        return next(self.all(tag, namespace), None)

    def all(self, tag: str, namespace: str | None = None) -> Iterator[XmlElement]:
        """The children with this tag (in any namespace, if none is asked for), in order."""
        for child in self.children:
            if child.tag == tag and (namespace is None or child.namespace == namespace):
                yield child

    def below(self, *tags: str) -> Iterator[XmlElement]:
        """The elements reached by going down these tags, in order: ``root.below("ModelVariables", "Float64")``."""
        if not tags:
            yield self
            return
        for child in self.all(tags[0]):
            yield from child.below(*tags[1:])

    def walk(self) -> Iterator[XmlElement]:
        """The element and everything below it, in the order of the file."""
        yield self
        for child in self.children:
            yield from child.walk()

    def required(self, name: str, problems: list[Problem]) -> str:
        """The attribute's text; "" and a problem if it is not there or empty."""
        text = self.get(name)
        if not text:
            problems.append(Problem(f"<{self.tag}> has no '{name}'", self.where))
        return text

    def real(self, name: str, problems: list[Problem]) -> float | None:
        """The attribute as a number; None if it is not there, and a problem if it is no number."""
        return self._read(name, real_of, "a number", problems)

    def whole(
        self, name: str, problems: list[Problem], *, least: int | None = None, most: int | None = None
    ) -> int | None:
        """The attribute as a whole number from *least* to *most*; None if not there, and a problem if not one."""
        value = self._read(name, whole_of, "a whole number", problems)
        if value is not None and least is not None and value < least:
            problems.append(self._unfit(name, str(value), f"at least {least}"))
            return None
        if value is not None and most is not None and value > most:
            problems.append(self._unfit(name, str(value), f"at most {most}"))
            return None
        return value

    def flag(self, name: str, problems: list[Problem]) -> bool:
        """The attribute as a truth value; False if it is not there, and with a problem if it is none."""
        return bool(self._read(name, flag_of, "true or false", problems))

    def word(self, name: str, words: Collection[str], problems: list[Problem], default: str = "") -> str:
        """The attribute as one of *words*; *default* if it is not there, and a problem if it is another."""
        text = self.get(name, default).strip()
        if name not in self.attributes or text in words:
            return text
        what = f"<{self.tag}>: '{name}' cannot be '{shortened(self.get(name))}'"
        problems.append(Problem(what, self.where, closest(self.get(name), words)))
        return default

    def _read(self, name: str, read: Callable[[str], V | None], expected: str, problems: list[Problem]) -> V | None:
        text = self.attributes.get(name)
        value = None if text is None else read(text)
        if text is not None and value is None:
            problems.append(self._unfit(name, text, expected))
        return value

    def _unfit(self, name: str, text: str, expected: str) -> Problem:
        return Problem(f"<{self.tag}>: '{name}' is '{shortened(text)}', not {expected}", self.where)


def read_xml_file(path: Path, file: str, ignored: list[Problem] | None = None) -> XmlElement:
    """The root of the XML file at *path*, which is called *file* in messages; *ignored* as with ``read_xml``.

    Raises DseError located there: no such file, cannot be read, or anything ``read_xml`` refuses.
    """
    return read_xml(xml_content(path, file), file, ignored)


def xml_content(path: Path, file: str) -> bytes:
    """The bytes of the XML file at *path*. Raises DseError: no such file, cannot be read, or too large."""
    where = Location(file)
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise fail(f"larger than {_MOST_BYTES // 2**20} MiB", where)
        return path.read_bytes()
    except FileNotFoundError as error:
        raise fail("there is no such file", where) from error
    except OSError as error:
        raise fail(f"cannot be read: {(error.strerror or str(error)).lower()}", where) from error


def read_xml(content: bytes, file: str, ignored: list[Problem] | None = None) -> XmlElement:
    """The root of an XML document whose places are called *file* and a line.

    With *ignored*, which is told of them, prefixes may be bound to no namespace; theirs is ``unbound:PREFIX`` then.
    Raises DseError located there: not well-formed, an encoding that is not known, document types or entities, too
    large, or nested too deeply.
    """
    # Here, because no command but those that open such files needs it.
    import defusedxml
    from defusedxml.ElementTree import DefusedXMLParser, ParseError

    if len(content) > _MOST_BYTES:
        raise fail(f"larger than {_MOST_BYTES // 2**20} MiB", Location(file))
    builder = _Builder(file)
    parser = DefusedXMLParser(target=builder, forbid_dtd=True)
    builder.expat = parser.parser
    try:
        parser.feed(content)
        parser.close()
    except defusedxml.DefusedXmlException as error:
        what = "it declares a document type or entities, which is refused as unsafe"
        raise fail(what, builder.place(), "remove the line that starts with <!DOCTYPE") from error
    except ParseError as error:
        line, column = error.position
        where = Location(file, line, column + 1)
        unbound = _unbound(content) if error.code == _UNBOUND_PREFIX else []
        if unbound and ignored is not None:
            ignored += [Problem(f"the prefix '{prefix}' is bound to no namespace", where) for prefix in unbound]
            return read_xml(_bound(content, unbound), file)
        reason = str(error).rsplit(": line ", 1)[0] + "".join(f" '{prefix}'" for prefix in unbound)
        raise fail(f"not XML: {reason}", where) from error
    except (ValueError, LookupError) as error:
        raise fail(f"not XML: {error}", builder.place()) from error
    return builder.root


_UNBOUND_PREFIX = 27  # expat's XML_ERROR_UNBOUND_PREFIX
_ROOT = re.compile(rb"\A(?:\xef\xbb\xbf)?(?:\s|<\?.*?\?>|<!--.*?-->)*<[^\s/>!?]+", re.DOTALL)


def _unbound(content: bytes) -> list[str]:
    """The prefixes that are bound nowhere in *content*, in alphabetical order; it declares no document type."""
    from xml.parsers.expat import ExpatError, ParserCreate

    names: set[str] = set()
    parser = ParserCreate()
    parser.StartElementHandler = lambda tag, attributes: names.update((tag, *attributes))
    with suppress(ExpatError):
        parser.Parse(content, True)
    used = {name.partition(":")[0] for name in names if ":" in name}
    return sorted(used - {name.removeprefix("xmlns:") for name in names} - {"xml", "xmlns"})


def _bound(content: bytes, prefixes: list[str]) -> bytes:
    """*content* with *prefixes* bound in the start tag of its root, on the line that is there."""
    said = "".join(f' xmlns:{prefix}="{UNBOUND}{prefix}"' for prefix in prefixes).encode()
    return _ROOT.sub(lambda root: root[0] + said, content, count=1)


@dataclass(slots=True)
class _Open:
    """An element whose end has not been seen."""

    tag: str
    attributes: dict[str, str]
    where: Location
    text: list[str]
    children: list[XmlElement]


class _Builder:
    """What the parser reports its findings to, in ElementTree's words."""

    root: XmlElement
    expat: Any

    def __init__(self, file: str) -> None:
        self._file = file
        self._open: list[_Open] = []
        self._parts = 0

    def place(self) -> Location:
        """Where the parser is."""
        return Location(self._file, self.expat.CurrentLineNumber, self.expat.CurrentColumnNumber + 1)

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        where = self.place()
        self._parts += 1 + len(attributes)
        if self._parts > _MOST_PARTS:
            raise fail(f"more than {_MOST_PARTS:,} elements and attributes", where)
        if len(self._open) >= _MOST_LEVELS:
            raise fail(f"elements are nested more than {_MOST_LEVELS} levels deep", where)
        self._open.append(_Open(tag, attributes, where, [], []))

    def data(self, text: str) -> None:
        if self._open:
            self._open[-1].text.append(text)

    def end(self, tag: str) -> None:
        done = self._open.pop()
        namespace, _, local = tag[1:].rpartition("}") if tag.startswith("{") else ("", "", tag)
        made = XmlElement(local, namespace, done.attributes, "".join(done.text), tuple(done.children), done.where)
        if self._open:
            self._open[-1].children.append(made)
        else:
            self.root = made


# The texts of XML attributes as values, as XML Schema writes them.


_LONGEST = 100
_WHOLE = re.compile(r"[+-]?[0-9]+")
_REAL = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
# XML Schema's are INF, -INF and NaN; programs often write those of their language.
_SPECIAL = re.compile(r"[+-]?(?:inf|infinity)|nan", re.IGNORECASE)


def real_of(text: str) -> float | None:
    """The number an ``xs:double`` stands for (``INF``, ``-INF`` and ``NaN`` are some, in any case), or None."""
    text = text.strip()
    return float(text) if len(text) <= _LONGEST and (_REAL.fullmatch(text) or _SPECIAL.fullmatch(text)) else None


def whole_of(text: str) -> int | None:
    """The number an ``xs:integer`` stands for, or None."""
    text = text.strip()
    return int(text) if len(text) <= _LONGEST and _WHOLE.fullmatch(text) else None


def flag_of(text: str) -> bool | None:
    """The truth value an ``xs:boolean`` stands for, or None."""
    return {"true": True, "1": True, "false": False, "0": False}.get(text.strip())


def shortened(text: str) -> str:
    """*text*, cut to what a message can hold."""
    return text if len(text) <= 60 else f"{text[:60]}…"
