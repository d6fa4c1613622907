"""Random designs with repeated places, chosen connections and allocations, counted by going through them all.

The count looks at instances and matrices of connections alone; it shares nothing with how the words are lowered.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, product
from random import Random
from typing import Any

MASSES = {"A": 1, "B": 2, "C": 4, "D": 8, "E": 16, "F": 32}
COMPONENTS = "components:\n" + "".join(
    f"  {name}: {{properties: {{mass: {mass} kg}}}}\n" for name, mass in MASSES.items()
)

Instances = tuple[str, ...]


@dataclass
class Place:
    """A part of the design: *ways* are the components of its instances, in all the ways that count."""

    name: str
    written: Any
    ways: list[Instances]
    most: int
    repeated: bool
    options: list[str]

    def path(self, number: int) -> str:
        return f"{self.name}.n{number + 1}" if self.repeated else self.name


@dataclass
class Structured:
    """A design as data of its file, and the number of its configurations."""

    data: dict[str, Any]
    count: int


def structured(random: Random) -> Structured:
    """A random design of few configurations."""
    while True:
        places = [_place(random, name) for name in "pqr"[: random.randint(1, 3)]]
        links = [_link(random, f"link{n}", places) for n in range(random.randint(0, 2))]
        rules = [_rule(random, places) for _ in range(random.randint(0, 2))]
        compound = {place.name: place.written for place in places} | {link["name"]: link["written"] for link in links}
        data: dict[str, Any] = {"design": "tried", "root": {"compound": compound}}
        if rules:
            data["constraints"] = {f"c{n}": {"require": text} for n, (text, _) in enumerate(rules)}
        work = 1
        for link in links:
            work *= (link["parallel"] + 1) ** (len(link["sources"]) * len(link["targets"]))
        if work > 3000 or any(not link["sources"] or not link["targets"] for link in links):
            continue
        count = 0
        for ways in product(*(place.ways for place in places)):
            chosen = dict(zip("pqr", ways, strict=False))
            if all(holds(chosen) for _, holds in rules):
                some = 1
                for link in links:
                    some *= _patterns(link, chosen)
                count += some
        return Structured(data, count)


def _place(random: Random, name: str) -> Place:
    options = sorted(random.sample("ABCD", random.randint(1, 3)))
    content: Any = {"alternatives": options}
    match random.randint(0, 4):
        case 0:
            return Place(name, content, [(option,) for option in options], 1, False, options)
        case 1:
            return Place(name, {"optional": content}, [(), *((option,) for option in options)], 1, False, options)
    least = random.randint(0, 2)
    most = max(1, random.randint(least, 3))
    unordered, different = random.random() < 0.4, random.random() < 0.3
    ways = []
    for number in range(least, most + 1):
        found = [way for way in product(options, repeat=number) if not different or len(set(way)) == number]
        ways += sorted({tuple(sorted(way)) for way in found}) if unordered else found
    written: dict[str, Any] = {"times": f"{least}..{most}" if random.random() < 0.8 or least != most else least}
    written |= {"of": options[0]} if len(options) == 1 and random.random() < 0.5 else content
    if unordered:
        written["unordered"] = True
    if different:
        written["all_different"] = True
    return Place(name, written, ways, most, True, options[:1] if "of" in written else options)


def _ends(places: list[Place]) -> list[tuple[str, int, str]]:
    return [(place.name, number, place.path(number)) for place in places for number in range(place.most)]


def _bounds(random: Random, most: int) -> tuple[str, int, int]:
    low = random.choice([0, 0, 1, 1, 2])
    high = random.choice([1, 2, most, 99])
    low, high = min(low, high), max(low, high)
    return (str(low) if low == high else f"{low}..{'*' if high == 99 else high}"), low, high


def _link(random: Random, name: str, places: list[Place]) -> dict[str, Any]:
    chosen_from = random.sample(places, random.randint(1, min(2, len(places))))
    chosen_to = random.sample(places, 1)
    sources, targets = _ends(chosen_from), _ends(chosen_to)
    link: dict[str, Any] = {"name": name, "sources": sources, "targets": targets, "parallel": 1, "undirected": False}
    link |= {"unordered": False, "excluded": set(), "apart": [], "together": [], "loads": None, "total": (0, 99)}
    to = ", ".join(place.name for place in chosen_to)
    if random.random() < 0.35:
        return _allocation(random, link, to)
    texts = {key: _bounds(random, 3) for key in ("outgoing", "incoming", "total")}
    if random.random() < 0.6:
        texts["total"] = ("0..*", 0, 99)
    written: dict[str, Any] = {"connect": f"{', '.join(place.name for place in chosen_from)} -> {to}"}
    if random.random() < 0.2:
        link["parallel"] = written["parallel"] = 2
    if [place.name for place in chosen_from] == [place.name for place in chosen_to] and random.random() < 0.5:
        link["undirected"] = written["undirected"] = True
        texts["incoming"] = ("0..*", 0, 99)
    alike = "of" in chosen_to[0].written
    if alike and not link["undirected"] and random.random() < 0.7 and chosen_to[0] not in chosen_from:
        link["unordered"] = written["unordered"] = True
    elif random.random() < 0.3:
        a, b = random.choice(sources)[2], random.choice(targets)[2]
        written["exclude"] = [f"{a} -> {b}"]
        link["excluded"] |= {(a, b), (b, a)} if link["undirected"] else {(a, b)}
    for key, (text, low, high) in texts.items():
        link[key] = (low, high)
        if text != "0..*":
            written[key] = int(text) if text.isdigit() and random.random() < 0.5 else text
    link["outgoing"] = [link["outgoing"]] * len(sources)
    return link | {"written": written}


def _allocation(random: Random, link: dict[str, Any], to: str) -> dict[str, Any]:
    names = ["f", "g", "h"][: random.randint(1, 3)]
    loads = {name: random.randint(1, 3) for name in names}
    copies = {name: 2 for name in names if random.random() < 0.25}
    link["sources"] = [("", number, name) for number, name in enumerate(names)]
    link["outgoing"] = [(copies.get(name, 1),) * 2 for name in names]
    link["incoming"] = (0, 99)
    written: dict[str, Any] = {"allocate": names, "to": to}
    if copies:
        written["redundancy"] = copies
    if random.random() < 0.6:
        written["allocate"] = {name: {"mass": f"{load} kg"} for name, load in loads.items()}
        written["load"] = "mass"
        link["loads"] = loads
    for key in ("apart", "together"):
        if len(names) > 1 and random.random() < 0.3:
            link[key] = [random.sample(names, random.randint(2, len(names)))]
            written[key] = link[key]
    return link | {"written": written}


def _patterns(link: dict[str, Any], chosen: dict[str, Instances]) -> int:
    """The number of ways to connect what is there."""

    def there(end: tuple[str, int, str]) -> bool:
        return not end[0] or end[1] < len(chosen[end[0]])

    sources, targets = link["sources"], link["targets"]
    pairs = [
        (i, j)
        for i, a in enumerate(sources)
        for j, b in enumerate(targets)
        if a[2] != b[2]
        and there(a)
        and there(b)
        and (a[2], b[2]) not in link["excluded"]
        and not (link["undirected"] and i > j)
    ]
    found = set()
    count = 0
    for numbers in product(range(link["parallel"] + 1), repeat=len(pairs)):
        matrix = {pair: number for pair, number in zip(pairs, numbers, strict=True) if number}
        if _is_allowed(link, matrix, chosen, there):
            count += 1
            columns = [tuple(matrix.get((i, j), 0) for i in range(len(sources))) for j in range(len(targets))]
            found.add(tuple(sorted(columns)))
    return len(found) if link["unordered"] else count


def _is_allowed(
    link: dict[str, Any], matrix: dict[tuple[int, int], int], chosen: dict[str, Instances], there: Any
) -> bool:
    sources, targets = link["sources"], link["targets"]
    for i, source in enumerate(sources):
        own = sum(n for pair, n in matrix.items() if pair[0] == i or (link["undirected"] and pair[1] == i))
        if there(source) and not link["outgoing"][i][0] <= own <= link["outgoing"][i][1]:
            return False
    for j, target in enumerate(targets):
        own = [(i, n) for (i, k), n in matrix.items() if k == j]
        if (
            not link["undirected"]
            and there(target)
            and not link["incoming"][0] <= sum(n for _, n in own) <= link["incoming"][1]
        ):
            return False
        if link["loads"] and there(target):
            mass = MASSES[chosen[target[0]][target[1]]]
            if sum(link["loads"][sources[i][2]] for i, _ in own) > mass:
                return False
    hosts = {source[2]: {j for (k, j) in matrix if k == i} for i, source in enumerate(sources)}
    if any(hosts[a] & hosts[b] for group in link["apart"] for a, b in combinations(group, 2)):
        return False
    if any(hosts[a] != hosts[b] for group in link["together"] for a, b in combinations(group, 2)):
        return False
    return link["total"][0] <= sum(matrix.values()) <= link["total"][1]


def _rule(random: Random, places: list[Place]) -> tuple[str, Any]:
    place = random.choice(places)
    name, number = place.name, random.randint(0, 6)
    option = random.choice(place.options)
    if not place.repeated:
        return (
            f"sum(mass) <= {3 * number} kg",
            lambda chosen: sum(MASSES[c] for way in chosen.values() for c in way) <= 3 * number,
        )
    match random.randint(0, 5):
        case 0:
            return f"count({name} is {option}) <= {number % 3}", lambda chosen: chosen[name].count(option) <= number % 3
        case 1:
            return f"each({name}.mass >= {number} kg)", lambda chosen: all(MASSES[c] >= number for c in chosen[name])
        case 2:
            text = f"sum({name}.mass) + sum(if {name} is {option} then 1 kg else 0) <= {2 * number} kg"
            return text, lambda chosen: sum(MASSES[c] + (c == option) for c in chosen[name]) <= 2 * number
        case 3:
            return f"not all_different({name})", lambda chosen: len(set(chosen[name])) < len(chosen[name])
        case 4:
            return f"same_choice({name})", lambda chosen: len(set(chosen[name])) <= 1
    text = f"count({name}.mass > {number} kg) >= 1 implies each({name} is {option})"
    return text, lambda chosen: not any(MASSES[c] > number for c in chosen[name]) or set(chosen[name]) <= {option}
