"""Feature models in UVL made from a seed, in the style of large industrial ones, none of whose features is dead."""

from __future__ import annotations

import random
from dataclasses import dataclass

_KINDS = ("alternative", "mandatory", "optional", "or")
_DEEPEST = 12


@dataclass(frozen=True, slots=True)
class Tree:
    """Feature 0 is the root; *groups* of each feature are a kind and the children."""

    groups: list[list[tuple[str, list[int]]]]
    above: list[int]


def feature_model(features: int, constraints: int, seed: int) -> str:
    """The text of a model. Constraints are mostly implications between decisions that stand near each other.

    Every constraint holds in a set of configurations that together have every feature, hence none is dead. There may
    be fewer constraints than asked for if those are hard to find.
    """
    chance = random.Random(seed)  # noqa: S311  # a test needs no secrets
    tree = _tree(features, chance)
    order = _in_file_order(tree)
    witnesses, number = _witnesses(tree, chance)
    lines = ["features", *_drawn(tree), "constraints"]
    return "\n".join([*lines, *_constraints(tree, order, witnesses, number, constraints, chance)]) + "\n"


def _tree(features: int, chance: random.Random) -> Tree:
    groups: list[list[tuple[str, list[int]]]] = [[] for _ in range(features)]
    above, depth = [-1] * features, [0] * features
    growing, made = [0], 1
    while made < features:
        if growing:
            feature = growing.pop(chance.randrange(max(0, len(growing) - 12), len(growing)))
        else:
            feature = chance.choice([each for each in range(made) if depth[each] < _DEEPEST])
        kind = chance.choices(_KINDS, [9, 6, 4, 1])[0]
        size = {
            "alternative": 2 + min(int(chance.expovariate(0.35)), 30),
            "mandatory": chance.randint(1, 6),
            "optional": chance.randint(1, 8),
            "or": chance.randint(2, 6),
        }[kind]
        children = list(range(made, min(features, made + size)))
        made += len(children)
        if len(children) == 1 and kind in {"alternative", "or"}:
            kind = "optional"
        groups[feature].append((kind, children))
        for child in children:
            above[child], depth[child] = feature, depth[feature] + 1
            if depth[child] < _DEEPEST and chance.random() < 0.5:
                growing.append(child)
    return Tree(groups, above)


def _in_file_order(tree: Tree) -> list[int]:
    order, pending = [], [0]
    while pending:
        feature = pending.pop()
        order.append(feature)
        pending.extend(child for _, children in reversed(tree.groups[feature]) for child in reversed(children))
    return order


def _drawn(tree: Tree) -> list[str]:
    lines: list[str] = []
    pending: list[tuple[str, int, int]] = [("", 0, 1)]
    while pending:
        kind, feature, depth = pending.pop()
        lines.append("\t" * depth + (kind or f"F{feature}"))
        if not kind:
            for group, children in reversed(tree.groups[feature]):
                pending.extend(("", child, depth + 2) for child in reversed(children))
                pending.append((group, feature, depth + 1))
    return lines


def _witnesses(tree: Tree, chance: random.Random) -> tuple[list[int], int]:
    """For each feature a bit set of the configurations that have it, and how many configurations there are."""
    has = [0] * len(tree.above)
    missing = set(range(len(tree.above)))
    number = 0
    while missing:
        forced = set()
        feature = min(missing)
        while feature >= 0:
            forced.add(feature)
            feature = tree.above[feature]
        pending = [0]
        while pending:
            feature = pending.pop()
            has[feature] |= 1 << number
            missing.discard(feature)
            for kind, children in tree.groups[feature]:
                wanted = [child for child in children if child in forced or child in missing]
                match kind:
                    case "mandatory":
                        pending.extend(children)
                    case "alternative":
                        needed = [child for child in wanted if child in forced]
                        pending.append(chance.choice(needed or wanted or children))
                    case "optional":
                        pending.extend(c for c in children if c in forced or chance.random() < 0.35)
                    case _:
                        pending.extend({*wanted, *chance.sample(children, chance.randint(1, len(children)))})
        number += 1
    return has, number


def _constraints(
    tree: Tree, order: list[int], has: list[int], number: int, constraints: int, chance: random.Random
) -> list[str]:
    everywhere = (1 << number) - 1
    decisions = [
        children
        for feature in order
        for kind, children in tree.groups[feature]
        if kind != "mandatory" and len(children) > 1 and has[children[0]] != everywhere
    ]
    modules = [decisions[start : start + 10] for start in range(0, len(decisions), 10)]
    optional = sorted((f for f in order if has[f] != everywhere), key=lambda f: (-has[f].bit_count(), f))
    hubs = optional[: max(3, len(order) // 1500)]
    said: dict[str, None] = {}
    for _ in range(200 * constraints):
        if len(said) == constraints:
            break
        module = chance.choice(modules)
        at = chance.randrange(len(module))
        beside = min(len(module) - 1, max(0, at + chance.choice([-2, -1, 1, 1, 2])))
        one, two, three = (chance.choice(module[each]) for each in (at, beside, beside))
        if chance.random() < 0.03:
            two = chance.choice(hubs)
        if at == beside or len({one, two, three}) < 3:
            continue
        text, broken = chance.choices(
            [
                (f"F{one} => F{two}", has[one] & ~has[two]),
                (f"!(F{one} & F{two})", has[one] & has[two]),
                (f"F{one} => F{two} | F{three}", has[one] & ~has[two] & ~has[three]),
                (f"F{one} & F{two} => F{three}", has[one] & has[two] & ~has[three]),
            ],
            [75, 13, 8, 4],
        )[0]
        if not broken:
            said[f"\t{text}"] = None
    return list(said)
