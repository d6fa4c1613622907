"""What the layers of import-linter do not say: a room is imported by its face. pyproject.toml names this contract."""

from grimp import ImportGraph
from importlinter import Contract, ContractCheck, output


def _room(module: str) -> str:
    return ".".join(module.split(".")[:2])


class Faces(Contract):
    """Nobody imports a file of another room: what a room gives stands in its `__init__.pyi`."""

    type_name = "faces"

    def check(self, graph: ImportGraph, verbose: bool) -> ContractCheck:
        past = [
            (importer, imported)
            for importer in sorted(graph.modules)
            for imported in sorted(graph.find_modules_directly_imported_by(importer))
            if imported != _room(imported) != _room(importer)
        ]
        return ContractCheck(kept=not past, metadata={"past": past})

    def render_broken_contract(self, check: ContractCheck) -> None:
        for importer, imported in check.metadata["past"]:
            output.print_error(f"{importer} imports {imported}: take it from {_room(imported)}")
