"""What the layers of import-linter do not say: a room is imported by its face. pyproject.toml names this contract."""

from grimp import ImportGraph
from importlinter import Contract, ContractCheck, fields, output


def _room(module: str) -> str:
    return ".".join(module.split(".")[:2])


class Faces(Contract):
    """Nobody imports a file of another room, unless it is open: what a room gives stands in its `__init__.pyi`."""

    type_name = "faces"

    open_rooms = fields.SetField(subfield=fields.StringField())

    def check(self, graph: ImportGraph, verbose: bool) -> ContractCheck:
        past = [
            (importer, imported)
            for importer in sorted(graph.modules)
            for imported in sorted(graph.find_modules_directly_imported_by(importer))
            if imported != _room(imported) != _room(importer) and _room(imported) not in self.open_rooms
        ]
        return ContractCheck(kept=not past, metadata={"past": past})

    def render_broken_contract(self, check: ContractCheck) -> None:
        for importer, imported in check.metadata["past"]:
            output.print_error(f"{importer} imports {imported}: take it from {_room(imported)}")
