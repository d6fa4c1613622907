"""Which class and which component a name in the sources means, by the rules of the language for their lookup."""

from __future__ import annotations

from collections.abc import Sequence

from dse.modelica.frontend.syntax import KINDS, Element, Forest

PREDEFINED = ("Real", "Integer", "Boolean", "String")


class Scope:
    """The classes of *forest* by full name. What cannot be found, as it is in no text, is None."""

    def __init__(self, forest: Forest) -> None:
        classes = [element for element in forest.elements if element.kind in KINDS and not element.is_argument]
        self._classes = {element.full: element for element in reversed(classes)}
        self._own: dict[Element, dict[str, Element]] = {}
        self._lineages: dict[Element, list[Element]] = {}
        self._found: dict[tuple[str, Element], Element | None] = {}
        self.added: dict[str, dict[str, Element]] = {}
        """Members by the full name of a class that was not declared with them."""

    def class_of(self, path: str, inside: Element) -> Element | None:
        """The class that *path* means in the class *inside*."""
        if (path, inside) not in self._found:
            first, *rest = path.lstrip(".").split(".")
            found = None if path.startswith(".") else self._local(first, inside)
            found = found or self._classes.get(first)
            for name in rest:
                found = self._inner(found, name) if found else None
            self._found[path, inside] = found
        return self._found[path, inside]

    def _local(self, name: str, inside: Element) -> Element | None:
        """The class *name* declared in, inherited by or imported into *inside*, or a class around it."""
        around: Element | None = inside
        while around is not None:
            if found := self._inner(around, name) or self._imported(around, name):
                return found
            if around.parent is None:
                package = around.tree.within
                around = self._classes.get(package) if package else None
                continue
            around = around.parent
        return None

    def _inner(self, own: Element, name: str) -> Element | None:
        if found := self._classes.get(f"{own.full}.{name}"):
            return found
        return next((found for each in self.lineage(own) if (found := self._classes.get(f"{each.full}.{name}"))), None)

    def _imported(self, own: Element, name: str) -> Element | None:
        for element in own.elements:
            if element.kind == "import":
                words = element.tree.words[element.start + 1 : element.end]
                path = "".join(words[2:] if element.is_given else words)
                last = element.name if element.is_given else path.rpartition(".")[2]
                if last in (name, "*"):
                    path = f"{path[:-1]}{name}" if last == "*" else path
                    if found := self._classes.get(path):
                        return found
        return None

    def lineage(self, own: Element) -> list[Element]:
        """A class, and all that it is made from."""
        if own in self._lineages:
            return self._lineages[own]
        found = self._lineages[own] = [own]  # as far as it is known, where what it is made from is looked for
        for each in found:
            around = each.parent or each
            bases = [(each.type, around)] if each.type and each.type != each.name else []
            bases += [(one.type, each) for one in each.elements if one.kind == "extends"]
            for path, inside in bases:
                base = self.class_of(path, inside) if path != own.name else None
                if base is not None and base not in found:
                    found.append(base)
        return found

    def member(self, own: Element, name: str) -> Element | None:
        """The component *name* of a class, which it may inherit."""
        for each in self.lineage(own):
            if each not in self._own:
                self._own[each] = {inner.name: inner for inner in each.elements if inner.kind == "component"}
            if found := self.added.get(each.full, {}).get(name) or self._own[each].get(name):
                return found
        return None

    def members(self, own: Element) -> dict[str, Element]:
        """The components of a class by name, with those that it inherits."""
        found: dict[str, Element] = {}
        for each in reversed(self.lineage(own)):
            found |= {inner.name: inner for inner in each.elements if inner.kind == "component"}
            found |= self.added.get(each.full, {})
        return found

    def type_of(self, component: Element) -> Element | str | None:
        """The class of a component, or the name of the predefined type that it comes to."""
        path, inside = component.type, component.parent
        while inside is not None:
            if path in PREDEFINED:
                return path
            found = self.class_of(path, inside)
            made_of = found.type if found and found.kind in ("type", "connector") and not found.elements else ""
            if found and found.kind == "type" and found.elements:  # as in Modelica.Icons.TypeReal
                made_of = next((each.type for each in found.elements if each.kind == "extends"), "")
            if found is None or not made_of:
                return found
            path, inside = made_of, found.parent or found
        return None

    def declaration(self, component: Element) -> str:
        """The type and the sizes of a component as they can be declared in any class; nothing if they cannot."""
        kind, tree = self.type_of(component), component.tree
        path = f".{kind.full}" if isinstance(kind, Element) else kind or ""
        before, after = component.named - 1, component.named + 1
        starts = [tree.closing[before]] if tree.words[before] == "]" else []
        starts += [after] if tree.words[after] == "[" else []
        sizes = ["".join(tree.words[start : tree.closing[start] + 1]) for start in starts]
        is_fixed = len(sizes) < 2 and all(size[1:-1].replace(",", "").isdigit() for size in sizes)
        return f"{path}{''.join(sizes)}" if path and is_fixed else ""

    def follow(self, names: Sequence[str], inside: Element) -> tuple[Element | str | None, Element | None]:
        """The class around the last of *names*, components in components of *inside*, and that component."""
        around: Element | str | None = inside
        component: Element | None = None
        for number, name in enumerate(names):
            if number:
                around = self.type_of(component) if component else None
            component = self.member(around, name) if isinstance(around, Element) else None
            if component is None and number < len(names) - 1:
                return None, None
        return around, component
