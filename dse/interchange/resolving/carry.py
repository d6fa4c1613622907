"""What becomes of a value on its way: exact, so that there and back again is the same."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from dse.domain.system import Conversion

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class ConversionError(ValueError):
    """Why a value cannot go from one connector to the other."""


@dataclass(frozen=True, slots=True)
class Carry:
    """``factor * value + offset``, or by *table*: what it does not list stays as it is. Exact."""

    factor: Fraction = Fraction(1)
    offset: Fraction = Fraction(0)
    table: Mapping[int, int] | None = None

    @classmethod
    def of(cls, factor: float, offset: float) -> Carry:
        """The linear one with these numbers."""
        return cls(Fraction(factor), Fraction(offset))

    @classmethod
    def outwards(cls, conversion: Conversion | None) -> Carry:
        """From a value inside an FMU to the same value outside of it."""
        if conversion is None:
            return cls()
        if conversion.items:
            return cls(table={int(inside): int(outside) for inside, outside in conversion.items})
        return cls.of(conversion.factor, conversion.offset)

    @classmethod
    def inwards(cls, conversion: Conversion | None) -> Carry:
        """From a value outside of an FMU to the same value inside of it."""
        outwards = cls.outwards(conversion)
        if outwards.table is not None:
            return cls(table={outside: inside for inside, outside in outwards.table.items()})
        return cls(1 / outwards.factor, -outwards.offset / outwards.factor)

    @property
    def is_linear_identity(self) -> bool:
        """Whether numbers stay as they are, apart from *table*."""
        return self.factor == 1 and self.offset == 0

    def apply(self, value: float) -> float:
        """The value at the other end."""
        if self.table is not None:
            return float(self.table.get(int(value), int(value)))
        if self.is_linear_identity:
            return value
        if not math.isfinite(value):
            return value * float(self.factor)
        return as_float(Fraction(value) * self.factor + self.offset)

    def apply_all(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """The values at the other end; *values* themselves if they stay as they are."""
        if self.table is None and self.is_linear_identity:
            return values
        import numpy as np

        return np.array([self.apply(float(value)) for value in values], np.float64)

    @property
    def numbers(self) -> tuple[float, float]:
        """Factor and offset, rounded. Raises ConversionError if they are beyond the range of numbers."""
        numbers = as_float(self.factor), as_float(self.offset)
        if not all(map(math.isfinite, numbers)) or numbers[0] == 0 != self.factor:
            raise ConversionError("its factor and offset are beyond the range of numbers")
        return numbers

    def then(self, other: Carry) -> Carry:
        """This, and *other* after it."""
        if self.table is None and other.table is None:
            return Carry(self.factor * other.factor, self.offset * other.factor + other.offset)
        if not (self.is_linear_identity and other.is_linear_identity):
            raise ConversionError("a table of values and a linear transformation follow one another")
        first, second = self.table or {}, other.table or {}
        return Carry(
            table={
                value: second.get(first.get(value, value), first.get(value, value))
                for value in sorted({*first, *second})
            }
        )


SAME = Carry()


def as_float(value: Fraction) -> float:
    """The nearest floating-point number; infinite beyond their range, as in their own arithmetic."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf
