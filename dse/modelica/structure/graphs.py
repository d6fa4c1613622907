"""Graphs of equations and unknowns: who needs whom, and which equation is solved for which unknown."""

from __future__ import annotations

from collections.abc import Sequence


def components(needs: Sequence[Sequence[int]]) -> list[list[int]]:
    """Nodes that need each other, each component sorted; a component comes after all that it needs.

    *needs* lists for each node those it needs. Tarjan, SIAM J. Comput. 1(2), 1972, 146-160, without recursion.
    """
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    is_open: set[int] = set()
    path: list[int] = []
    found: list[list[int]] = []
    for root in range(len(needs)):
        if root in index:
            continue
        work = [(root, 0)]
        while work:
            node, place = work.pop()
            if place == 0:
                index[node] = low[node] = len(index)
                path.append(node)
                is_open.add(node)
            else:
                low[node] = min(low[node], low[needs[node][place - 1]])
            while place < len(needs[node]):
                other = needs[node][place]
                place += 1
                if other not in index:
                    work.extend([(node, place), (other, 0)])
                    break
                if other in is_open:
                    low[node] = min(low[node], index[other])
            else:
                if low[node] == index[node]:
                    found.append(_closed(node, path, is_open))
    return found


def _closed(root: int, path: list[int], is_open: set[int]) -> list[int]:
    component: list[int] = []
    while not component or component[-1] != root:
        component.append(path.pop())
        is_open.discard(component[-1])
    return sorted(component)


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
            free = self._free(columns_of[rows[-1]])
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

    def _free(self, columns: Sequence[int]) -> int | None:
        return next((column for column in columns if column not in self.row_of), None)


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
