"""Graphs of equations and unknowns: who needs whom, and which equation is solved for which unknown."""

from __future__ import annotations

from collections.abc import Sequence


class Matching:
    """Rows and columns matched one to one, grown row by row; columns are any number from 0.

    Depth-first augmenting paths with a look-ahead for a free column (Duff, ACM Trans. Math. Softw. 7(3), 1981,
    315-330), without recursion.
    """

    def __init__(self) -> None:
        self.column_of: dict[int, int] = {}
        self.row_of: dict[int, int] = {}

    def match(self, row: int, columns_of: Sequence[Sequence[int]]) -> frozenset[int]:
        """Match *row*, re-matching others if needed. Empty on success, else the rows seen on the way.

        The rows seen have together fewer columns than there are rows: they are over-determined.
        """
        seen_columns: set[int] = set()
        rows, branches = [row], [iter(columns_of[row])]
        chosen: list[int] = []
        seen_rows = {row}
        while rows:
            free = next((column for column in columns_of[rows[-1]] if column not in self.row_of), None)
            if free is not None:
                chosen.append(free)
                for one, column in zip(rows, chosen, strict=True):
                    self.column_of[one] = column
                    self.row_of[column] = one
                return frozenset()
            column = next((one for one in branches[-1] if one not in seen_columns), -1)
            if column < 0:
                rows.pop()
                branches.pop()
                if chosen:
                    chosen.pop()
                continue
            seen_columns.add(column)
            chosen.append(column)
            rows.append(self.row_of[column])
            seen_rows.add(rows[-1])
            branches.append(iter(columns_of[rows[-1]]))
        return frozenset(seen_rows)


def alternating(matching: Matching, column: int, rows_of: Sequence[Sequence[int]]) -> list[int]:
    """Columns reachable from the unmatched *column*: together they have too few rows, they are under-determined."""
    found = {column: None}
    stack = [column]
    while stack:
        for row in rows_of[stack.pop()]:
            other = matching.column_of.get(row)
            if other is not None and other not in found:
                found[other] = None
                stack.append(other)
    return list(found)
