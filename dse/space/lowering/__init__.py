"""From a design space to its flat form: constraints become tables, clauses, sums, or wide rules with a judge."""

from dse.space.lowering.constraints import flatten, selecting

__all__ = ["flatten", "selecting"]
