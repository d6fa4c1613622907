"""Options that need no conversion go without pydantic, by which typer converts each: its import takes longer than most
commands do."""

from __future__ import annotations

from typing import Any

from typer._coercion import RuntimeParam, TypeDescriptor, build_runtime_param
from typer.core import TyperGroup


class _Unconverted(RuntimeParam):
    """Converts as typer does, unless a value has the type of its parameter already."""

    def __init__(self, descriptor: TypeDescriptor) -> None:
        super().__init__(descriptor.parameter_info, descriptor.annotation)
        object.__setattr__(self, "descriptor", descriptor)  # as the class is frozen

    def _coerce_value(self, value: Any, param: Any, ctx: Any) -> Any:
        if self.parameter_info.parser is None:
            if self.annotation == list[str] and all(map(_is_text, value)):
                return [*value]
            if self.annotation is str and _is_text(value):
                return value
            if type(value) is self.annotation and value == param.default:
                return value
        descriptor: TypeDescriptor = vars(self)["descriptor"]
        return build_runtime_param(descriptor).coerce(value, param, ctx)


class LightGroup(TyperGroup):
    """A group of commands whose parameters are converted so."""

    def parse_args(self, ctx: Any, args: list[str]) -> Any:  # a context of the click inside typer
        """Take the group's own parameters from *args*."""
        _lighten(self, ctx)
        return super().parse_args(ctx, args)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command that *args* name, and what is left of them."""
        name, command, rest = super().resolve_command(ctx, args)
        _lighten(command, ctx)
        return name, command, rest


def _lighten(command: Any, ctx: Any) -> None:
    for param in command.get_params(ctx):
        descriptor = getattr(param, "type_descriptor", None)
        if isinstance(descriptor, TypeDescriptor):
            param._runtime_param = _Unconverted(descriptor)  # noqa: SLF001  # typer would make its own here


def _is_text(value: object) -> bool:
    return type(value) is str and value.isascii()
