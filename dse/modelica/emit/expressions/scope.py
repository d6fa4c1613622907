"""Assignments of expressions in one C block: what is used more than once is computed once, where it is needed first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.traversal import walk
from dse.modelica.emit.expressions.printing import Printed, call_lines, cheap, printed, select_lines
from dse.modelica.emit.expressions.regions import ROOT, Regions, regions
from dse.modelica.emit.expressions.setting import Setting, is_truth

_DEEPEST = 24


@dataclass(frozen=True, slots=True)
class Store:
    """``target = value;``, as 0 or 1 if it *wants_truth*. *subject* says in words whose value it is, for failures."""

    target: str
    value: Expression
    subject: str
    wants_truth: bool = False


def scope_lines(stores: Sequence[Store], setting: Setting) -> list[str]:
    """The statements that make *stores* in order; a later one may read what an earlier one wrote.

    The names t0, t1, … must be free: the lines want a block of their own. A failure returns its code.
    """
    return list(_Scope(stores, setting).lines())


@dataclass(frozen=True, slots=True)
class _Branch:
    """Statements of a region, inside of what *node* opens."""

    region: int
    indent: str


class _Scope:
    def __init__(self, stores: Sequence[Store], setting: Setting) -> None:
        self.setting = setting
        self.stores = stores
        self.nodes = list(walk(store.value for store in stores))
        self.regions: Regions = regions(self.nodes, [store.value for store in stores])
        self.uses = self._counted()
        self.texts: dict[int, Printed] = {}
        self.subjects: dict[int, str] = {}
        self.content: dict[int, list[Expression | Store]] = {ROOT: []}
        self.names: dict[int, str] = {}
        self._arrange()

    def _counted(self) -> dict[int, int]:
        uses: dict[int, int] = {}
        operands = (operand for node in self.nodes for operand in node.operands)
        for used in (*(store.value for store in self.stores), *operands):
            uses[used.number] = uses.get(used.number, 0) + 1
        return uses

    def _arrange(self) -> None:
        """Texts of all nodes, operands first; nodes with a name and stores go to their region's content."""
        pending = iter(self.stores)
        store = next(pending, None)
        done: set[int] = set()
        for node in self.nodes:
            self._place(node, store.subject if store else "")
            done.add(node.number)
            while store is not None and store.value.number in done:
                self.content[ROOT].append(store)
                store = next(pending, None)

    def _place(self, node: Expression, subject: str) -> None:
        operands = [self.texts[operand.number] for operand in node.operands if operand.number in self.texts]
        if node.operator == "array":
            stored = self.setting.array(node)
            if stored is not None:
                self.names[node.number] = stored
                return
        elif not self._needs_name(node, operands):
            self.texts[node.number] = printed(node, operands, self.setting)
            return
        name = f"t{len(self.names)}"
        self.names[node.number] = name
        self.subjects[node.number] = subject
        self.texts[node.number] = Printed(name, is_truth(node), 0)
        for region in self.regions.of[node.number]:
            self.content.setdefault(region, []).append(node)

    def _needs_name(self, node: Expression, operands: Sequence[Printed]) -> bool:
        opens = ((node.number, region) in self.regions.branches for region in self.regions.of[node.number])
        if node.operator in ("call", "select") or any(opens):
            return True
        if cheap(node):
            return False
        return self.uses[node.number] > 1 or max((operand.depth for operand in operands), default=0) >= _DEEPEST

    def lines(self) -> Iterator[str]:
        # A stack, not recursion: an if in an if … may be as deep as the user likes.
        stack: list[str | _Branch] = [_Branch(ROOT, "        ")]
        while stack:
            item = stack.pop()
            if isinstance(item, str):
                yield item
                continue
            inside: list[str | _Branch] = []
            for content in self.content.get(item.region, ()):
                inside.extend(self._statement(content, item))
            stack.extend(reversed(inside))

    def _statement(self, content: Expression | Store, around: _Branch) -> Iterator[str | _Branch]:
        indent = around.indent
        if isinstance(content, Store):
            text = self.texts[content.value.number]
            yield f"{indent}{content.target} = {text.bare_truth if content.wants_truth else text.bare_value};"
            return
        name, subject = self.names[content.number], self.subjects[content.number]
        operands = [
            self.names[one.number] if one.operator == "array" else self.texts[one.number].value
            for one in content.operands
        ]
        branches = self.regions.branches.get((content.number, around.region))
        if branches is not None:
            yield from self._branches(content, name, branches, indent)
        elif content.operator == "array":
            elements = ", ".join(self.texts[operand.number].value for operand in content.operands)
            yield f"{indent}const double {name}[{len(content.operands)}] = {{{elements}}};"
        elif content.operator == "call":
            yield from (indent + line for line in call_lines(content, name, operands, subject, self.setting))
        elif content.operator == "select":
            yield from (indent + line for line in select_lines(content, name, operands, subject, self.setting))
        else:
            texts = [self.texts[operand.number] for operand in content.operands]
            text = printed(content, texts, self.setting)
            kind, shown = ("int", text.bare_truth) if is_truth(content) else ("double", text.bare_value)
            yield f"{indent}const {kind} {name} = {shown};"

    def _branches(self, node: Expression, name: str, branches: tuple[int, ...], indent: str) -> Iterator[str | _Branch]:
        condition = self.texts[node.operands[0].number].bare_truth
        inside = indent + "    "
        is_if = node.operator == "if"
        yield f"{indent}double {name};" if is_if else f"{indent}int {name} = {condition};"
        yield f"{indent}if ({condition if is_if else name if node.operator == 'and' else f'!{name}'}) {{"
        for number, (branch, operand) in enumerate(zip(branches, node.operands[1:], strict=True)):
            if number:
                yield f"{indent}}} else {{"
            yield _Branch(branch, inside)
            text = self.texts[operand.number]
            yield f"{inside}{name} = {text.bare_value if is_if else text.bare_truth};"
        yield f"{indent}}}"
