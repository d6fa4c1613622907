"""Signal dictionaries (SSB): the signals of a bus, by name."""

from __future__ import annotations

from dse.formats import XmlElement, shortened
from dse.interchange.reading.common import META, SSB, TYPES, Findings, read_scope, read_type, require_root
from dse.interchange.structure import SignalType


def read_dictionary(root: XmlElement, found: Findings) -> dict[str, SignalType]:
    """The entries of an ``ssb:SignalDictionary``. Raises DseError if *root* is none; all else goes to *found*."""
    require_root(root, "SignalDictionary", SSB, found)
    found.expect(root, META | {"version"}, {"DictionaryEntry", "Enumerations", "Units"})
    scope = read_scope(root, found)
    entries: dict[str, SignalType] = {}
    for element in root.all("DictionaryEntry"):
        found.expect(element, {"name"}, TYPES | {"Dimension"})
        name = found.new(element, entries, "the entry")
        type_ = read_type(element, scope, found)
        if type_ is None:
            found.add(f"the entry '{shortened(name)}' has no type", element.where)
        else:
            entries[name] = type_
    return entries
