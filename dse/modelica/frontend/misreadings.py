"""What the front-end is known to flatten wrongly without a word: found in the sources the model uses, and refused.

rumoca 0.10.2 applies a redeclaration in the modifications of a component (`Car a(redeclare Fast engine)`). It drops one

- two modifications deep: `Car a(chassis(redeclare Soft spring))`, of a class, too;
- of a component that the class in `extends` or behind `=` inherits: `extends Car(redeclare Fast engine)`, where `Car`
  has `engine` from a class that it extends itself, or is only another name of one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import pairwise

from dse.errors import Location, Problem
from dse.modelica.frontend.buses import flows, is_expandable
from dse.modelica.frontend.outer import outer_values
from dse.modelica.frontend.result import FrontEndResult
from dse.modelica.frontend.scope import Scope
from dse.modelica.frontend.syntax import KINDS, Element, Forest
from dse.modelica.frontend.used_classes import used


def misread(result: FrontEndResult) -> Iterator[Problem]:
    """Each construct of the classes the model uses that rumoca 0.10.2 takes for something else. Raises DseError."""
    read = Forest(used(result.sources.values(), result.model))
    names = [str(function["name"]) for function in result.dae["storage"]["functions"]]
    yield from misread_modifications(read, names)
    scope = Scope(read)
    for element in read.elements:
        if element.kind == "component" and is_expandable(element.parent):
            yield from flows(element, element.name, scope)
    for tree, at, member in outer_values(read, scope):
        what = f"the value of '{member.name}' of an outer component, which the front-end does not see here, is not"
        hint = "give the inner component true, false, a whole number or an item of an enumeration, once"
        yield Problem(f"{what} supported", tree.place(at), hint)
    yield from _functions_of_one_name(read, names)
    yield from mixed_up_constants(read, result.model, [name.rpartition(".")[2] for name in names])
    for tree in read.trees:
        for at, word in enumerate(tree.words):
            if word == "getInstanceName" and {tree.words[at - 1], tree.words[at + 3]} & {"==", "<>"}:
                what = "comparing getInstanceName(), for which the front-end takes another name, is not supported"
                yield Problem(what, tree.place(at), "compare it in a function that has it as an input")
    for element in read.elements:
        if "partial" in element.prefixes and element.full == result.model:
            yield Problem(f"{result.model} is partial", element.where, "name a model that is complete")
        if "outer" in element.prefixes and element.kind in KINDS:
            what = f"an outer {element.kind}, for which the front-end does not take the inner one, is not supported"
            yield Problem(what, element.where, "make the class replaceable, and redeclare it")


def _functions_of_one_name(read: Forest, names: list[str]) -> Iterator[Problem]:
    """Functions are kept under the name they are called by, so that two of one name become one."""
    tops = {(tree.within or tree.elements[0].name).partition(".")[0] for tree in read.trees if tree.elements}
    found: dict[str, list[Location]] = {}
    for element in read.elements:
        if element.kind in ("function", "record") or (element.kind == "import" and element.is_given):
            found.setdefault(element.name, []).append(element.where)
    for name in names:
        top, _, rest = name.partition(".")
        places = found.get(name.rpartition(".")[2], [])
        if len(places) > 1 and not (rest and top in tops):
            what = f"the function '{name}' may be one of {len(places)}, which the front-end cannot distinguish"
            yield Problem(what, places[0], f"call it by its full name; another is declared at {places[1]}")


# Constants of packages that the front-end mixes up.


def mixed_up_constants(read: Forest, model: str, called: Iterable[str]) -> Iterator[Problem]:
    """Each change of a constant that rumoca 0.10.2 takes for a change of another, or for none.

    *called*: the last words of the names of all functions the model calls.
    """
    constants = {element.name for element in read.elements if _is_constant(element)}
    rules = (
        _read_by_functions(read, constants, set(called)),
        _of_the_base(read, constants, model),
        _redeclared(read),
        _records(read),
    )
    found: dict[Location | None, Problem] = {}
    for problem in (problem for rule in rules for problem in rule):
        found.setdefault(problem.where, problem)
    yield from found.values()


def _is_constant(element: Element) -> bool:
    return element.kind == "component" and "constant" in element.prefixes


def _read_by_functions(read: Forest, constants: set[str], called: set[str]) -> Iterator[Problem]:
    """A constant that one class changes has the same value in all functions that read it."""
    words: set[str] = set()
    for element in read.elements:
        if element.kind == "function" and element.name in called:
            own = {inner.name for inner in element.elements if inner.kind == "component" and not _is_constant(inner)}
            words |= {*element.tree.words[element.named : element.end]} - own
    classes = {element.name for element in read.elements if element.kind in KINDS}
    for name in sorted(constants & words):
        having = _having(read, name)
        for element in read.elements:
            changed = element.parent.last if element.parent else ""
            is_change = element.kind == "modifier" and element.is_given and element.name == name
            if is_change and (changed in having or changed not in classes):
                what = f"constant '{name}' is changed here and read by a function, where the front-end mixes up its"
                yield Problem(f"{what} values", element.where, "make it an input of the function")


def _having(read: Forest, name: str) -> set[str]:
    """Classes that may have the constant *name*: they declare it, extend one that has it, or are made from one."""
    found = {each.parent.name for each in read.elements if each.name == name and _is_constant(each) and each.parent}
    made = {(each.parent.name, each.last) for each in read.elements if each.kind == "extends" and each.parent}
    made |= {(each.name, each.last) for each in read.elements if each.kind in KINDS and each.type}
    while new := {one for one, base in made if base in found} - found:
        found |= new
    return found


def _of_the_base(read: Forest, constants: set[str], model: str) -> Iterator[Problem]:
    """A constant changed in a package made from another changes in that one too, once both are read."""
    packages = {element.name for element in read.elements if element.kind in ("package", "class")}
    wanted = packages & {*model.split("."), *_read_names(read)}
    for element in read.elements:
        if element.kind in ("extends", *KINDS) and element.last in wanted:
            for changed in element.arguments:
                if changed.name in constants:
                    what = f"constant '{changed.name}' of package '{element.last}' is changed here, and"
                    what += f" '{element.last}' is used too, where the front-end mixes up its values"
                    yield Problem(what, changed.where, "write two packages that share no base")


def _read_names(read: Forest) -> Iterator[str]:
    """Names but where they are declared, extended, constrain, or are what another package is made from with changes."""
    for tree in read.trees:
        before = ""
        for word, following in pairwise(tree.words):
            is_other = following != "." and (
                before in ("package", "class", "end", "extends", "constrainedby")
                or (before == "=" and following == "(")
            )
            if not is_other:
                yield word
            if not (word == "." or following == "."):
                before = word


def _redeclared(read: Forest) -> Iterator[Problem]:
    """The new declaration is dropped."""
    for element in read.elements:
        if _is_constant(element) and "redeclare" in element.prefixes:
            what = "the redeclaration of a constant, which the front-end does not see, is not supported"
            yield Problem(what, element.where, "give the constant another value by a modification")


def _records(read: Forest) -> Iterator[Problem]:
    """What is read of single fields is what the record's class says; the whole record is right."""
    records = {element.name for element in read.elements if element.kind == "record"}
    based: set[str] = set()
    for tree in read.trees:
        for number, word in enumerate(tree.words[:-1]):
            last = tree.closing[number + 1] if tree.words[number + 1] == "[" else number
            based.update((word,) if tree.words[last + 1] == "." else ())
    for element in read.elements:
        in_package = element.parent is not None and element.parent.kind in ("package", "class")
        if in_package and _is_constant(element) and element.last in records and element.name in based:
            what = f"reading fields of the package's constant '{element.name}', a record, is not supported"
            yield Problem(what, element.where, "let a record in the model be it as a whole, and read that one")


def misread_modifications(read: Forest, called: Iterable[str]) -> Iterator[Problem]:
    """Each modification in what is used that the front-end takes for something else; *called* are all functions."""
    last = {name.rpartition(".")[2] for name in called}
    written = Counter(word for tree in read.trees for word in tree.words)
    components = [each for each in read.elements if each.kind == "component" and not each.is_argument]
    own = {(each.parent.name, each.name) for each in components if each.parent}
    for element in read.elements:
        is_used = element.kind != "function" or not last.isdisjoint((element.name, element.last))
        if "redeclare" in element.prefixes and element.kind in KINDS and element.written and is_used:
            what = (
                f"the redeclaration of class '{element.name}' modifies what it takes, which the front-end does not see"
            )
            hint = "declare a class that extends it with these modifications, and redeclare to that"
            yield Problem(what, element.where, hint)
        limit = element.constraint
        if limit and limit.written and (element.kind in KINDS or element.written != limit.written):
            what = "'constrainedby' with modifications, which the front-end does not see, is not supported"
            yield Problem(what, limit.where, "constrain by a class that extends it with these modifications")
        if element.kind == "modifier" and "." in element.name and (element.is_given or element.written):
            what = f"the modification of '{element.name}', which the front-end does not see, is not supported"
            yield Problem(what, element.where, "nest it: a(b = 1) in place of a.b = 1")
        if "redeclare" in element.prefixes and element.is_argument and element.parent:
            is_named = element.parent.kind == "extends" or written[element.parent.name] > 1
            yield from _lost(element, element.parent, is_named and (element.parent.last, element.name) not in own)
    yield from _redeclared_components(read)


def _redeclared_components(read: Forest) -> Iterator[Problem]:
    """A component redeclared in a modification keeps the modifications of the declaration before, even where a class
    constrains it; one redeclared as an element loses them."""
    again: dict[str, list[Element]] = {}
    for element in read.elements:
        if element.kind == "component" and "redeclare" in element.prefixes:
            again.setdefault(element.name, []).append(element)
    for element in read.elements:
        is_replaceable = element.kind == "component" and "replaceable" in element.prefixes
        if not element.written or not (is_replaceable or element.kind == "modifier"):
            continue
        is_kept = is_replaceable and element.constraint is not None
        for new in again.get(element.name, ()):
            missing = sorted(_names(element) - _names(new))
            if missing and is_kept == new.is_argument and new is not element:
                how = "keeps" if is_kept else "drops"
                what = (
                    f"the redeclaration of '{new.name}', for which the front-end {how} the modifications made before,"
                )
                yield Problem(
                    f"{what} is not supported", new.where, f"modify the same again here: {', '.join(missing)}"
                )


def _names(element: Element) -> set[str]:
    """What its modifications give values to; of nested ones the text."""
    return {
        one.name if one.is_given and not one.written else "".join(one.tree.words[one.named : one.end])
        for one in element.arguments
    }


def _lost(element: Element, owner: Element, is_inherited: bool) -> Iterator[Problem]:
    """Redeclarations in modifications that are dropped. *is_inherited*: a class that is used inherits the component."""
    what = "the redeclaration of " + ("a class" if element.kind in KINDS else f"'{element.name}'")
    if owner.is_argument:
        what += " inside another modification, which the front-end does not see, is not supported"
        yield Problem(
            what, element.tree.place(element.start), "declare a class that has the redeclaration, and use that class"
        )
        return
    if owner.kind in ("extends", *KINDS) and element.kind == "component" and is_inherited:
        what += f", which '{owner.last}' inherits, and which the front-end does not see, is not supported"
        hint = "redeclare it in `extends` of the class that declares it, or in the declaration of a component"
        yield Problem(what, element.tree.place(element.start), hint)
