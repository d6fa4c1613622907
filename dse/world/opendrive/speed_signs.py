"""Signs that limit the speed, by the catalogues of their countries."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dse.errors import Problem, fail
from dse.formats import XmlElement, real_of, shortened
from dse.world.opendrive.lanes import SPEED_UNITS


@dataclass(frozen=True, slots=True)
class Catalogue:
    """The types of signs of a country that begin and end a limit, in lower case without dots and spaces.

    *unit* is that of a value without one; a subtype is a value in tens of it if *in_tens*.
    """

    begins: frozenset[str]
    ends: frozenset[str]
    unit: str = "km/h"
    in_tens: bool = False


def _catalogue(begins: str, ends: str = "", unit: str = "km/h", *, in_tens: bool = False) -> Catalogue:
    return Catalogue(frozenset(begins.split()), frozenset(ends.split()), unit, in_tens)


CATALOGUES = {
    "de": _catalogue("274 2741", "278 2742 282"),  # StVO, annex 2
    "at": _catalogue("52/10a", "52/10b"),  # StVO, § 52
    "ch": _catalogue("230", "253"),  # SSV, annex 2
    "us": _catalogue("r2-1", unit="mph"),  # MUTCD, 2B.13
    "ca": _catalogue("rb-1"),  # MUTCDC
    "gb": _catalogue("670", "671", unit="mph"),  # TSRGD 2016, schedule 10
    "ie": _catalogue("rus042 rus043 rus044"),  # Traffic Signs Manual, chapter 5
    "se": _catalogue("c31", "c32", in_tens=True),  # Vagmarkesforordning 2007:90
    "no": _catalogue("362", "364"),  # Skiltforskriften, § 8
    "dk": _catalogue("c55", "c56"),  # Bekendtgorelse om vejafmaerkning
    "fi": _catalogue("c32", "c33"),  # Tieliikennelaki 2018/729, annex 3
    "nl": _catalogue("a1", "a2"),  # RVV 1990, annex 1
    "be": _catalogue("c43", "c45"),  # Wegcode, article 68
    "fr": _catalogue("b14", "b33"),  # Arrete du 24 novembre 1967
    "es": _catalogue("r-301", "r-501"),  # Reglamento General de Circulacion, annex 1
    "pl": _catalogue("b-33", "b-34"),  # Rozporzadzenie 2002/170/1393
    "cz": _catalogue("b20a", "b20b"),  # Vyhlaska 294/2015
    "au": _catalogue("r4-1", "r4-12"),  # AS 1742.4
}
"""By ISO 3166-1 alpha-2. They end a limit, or the limit of a zone, or all of them."""

_LONG = {
    "de": "deu ger",
    "at": "aut",
    "ch": "che",
    "us": "usa",
    "ca": "can",
    "gb": "gbr uk",
    "ie": "irl",
    "se": "swe",
    "no": "nor",
    "dk": "dnk",
    "fi": "fin",
    "nl": "nld",
    "be": "bel",
    "fr": "fra",
    "es": "esp",
    "pl": "pol",
    "cz": "cze",
    "au": "aus",
}
# The examples of OpenDRIVE have German numbers.
_CODES = {"": "de", "opendrive": "de"} | {long: code for code, longs in _LONG.items() for long in longs.split()}


def is_german(signal: XmlElement) -> bool:
    """Whether a signal is of the German catalogue."""
    return _country(signal) == "de"


def sign_speed(signal: XmlElement, ignored: list[Problem]) -> float | None:
    """The limit in m/s that a sign begins, 0 if it ends one, None if it is no such sign.

    What looks like one and cannot be read goes to *ignored*. The speed is the value in its unit, else the subtype in
    that of the country (274-50, C31-5). Raises DseError located at a sign with a unit that is not one of a speed.
    """
    if signal.get("dynamic") == "yes":
        return None
    country, kind = _country(signal), _kind(signal.get("type"))
    catalogue = CATALOGUES.get(country)
    if catalogue is None or not any(_is_of(signal, kind, types) for types in (catalogue.begins, catalogue.ends)):
        _report_unknown(signal, country, kind, ignored)
        return None
    if _is_of(signal, kind, catalogue.ends):
        return 0.0
    unit = signal.get("unit").strip() or catalogue.unit
    told = real_of(signal.get("value"))
    if told is None or not 0.0 < told < math.inf:
        told, unit = _of_subtype(signal, catalogue), catalogue.unit
    if told is None or not 0.0 < told < math.inf:
        ignored.append(Problem(f"the speed sign {_named(signal)} has no value: it is ignored", signal.where))
        return None
    if unit not in SPEED_UNITS:
        raise fail(f"'{shortened(unit)}' is not a unit of a speed", signal.where, f"possible: {', '.join(SPEED_UNITS)}")
    return told * SPEED_UNITS[unit]


def _country(signal: XmlElement) -> str:
    code = signal.get("country", "OpenDRIVE").strip().lower()
    return _CODES.get(code, code)


def _kind(text: str) -> str:
    return text.strip().lower().replace(".", "").replace(" ", "")


def _is_of(signal: XmlElement, kind: str, types: frozenset[str]) -> bool:
    """By its type, or as programs have it that write the letter as the type and the number as the subtype."""
    whole = _whole(signal, kind)
    return whole in types or whole.rpartition("-")[0] in types


def _whole(signal: XmlElement, kind: str) -> str:
    return kind + _kind(signal.get("subtype")) if kind.isalpha() else kind


def _of_subtype(signal: XmlElement, catalogue: Catalogue) -> float | None:
    whole = _whole(signal, _kind(signal.get("type")))
    inside = "" if whole in catalogue.begins else whole.rpartition("-")[2]
    told = real_of(inside or signal.get("subtype").strip())
    return told if told is None or not catalogue.in_tens or told > 15 else 10 * told


def _report_unknown(signal: XmlElement, country: str, kind: str, ignored: list[Problem]) -> None:
    """A sign with the unit of a speed, or with a type that limits the speed in another country."""
    if signal.get("unit").strip() in SPEED_UNITS:
        known = f"of '{country}': {', '.join(sorted(CATALOGUES[country].begins))}" if country in CATALOGUES else ""
        hint = f"types of speed signs {known}" if known else f"countries with speed signs: {', '.join(CATALOGUES)}"
        what = f"the sign {_named(signal)} has the unit of a speed, and is no known speed sign: it is ignored"
        ignored.append(Problem(what, signal.where, hint))
    elif country not in CATALOGUES and any(kind in each.begins for each in CATALOGUES.values()):
        what = (
            f"the sign {_named(signal)} may limit the speed, but the signs of its country are not known: it is ignored"
        )
        ignored.append(Problem(what, signal.where, f"countries with speed signs: {', '.join(CATALOGUES)}"))


def _named(signal: XmlElement) -> str:
    country = signal.get("country") or "no country"
    return f"'{shortened(signal.get('type'))}' of {shortened(country)}"
