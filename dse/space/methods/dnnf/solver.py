"""A small solver for clauses: search that learns from its conflicts.

Marques-Silva and Sakallah 1999; watched literals, restarts and assumptions as in Eén and Sörensson 2003.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Sequence

_DECAY = 1 / 0.95
_RESCALE = 1e100
_RESTART = 64

_Reason = Sequence[int]


class ClauseSolver:
    """Clauses over Booleans 0 to *booleans* - 1 as literals 2b and 2b + 1; more may be added between questions.

    Deterministic: the same clauses and questions in the same order give the same answers.
    """

    def __init__(self, booleans: int) -> None:
        self._implied: list[list[int]] = [[] for _ in range(2 * booleans)]
        self._watching: list[list[list[int]]] = [[] for _ in range(2 * booleans)]
        self._value = bytearray(2 * booleans)  # 1 where a literal is true
        self._is_set = bytearray(booleans)
        self._level = [0] * booleans
        self._reason: list[_Reason | None] = [None] * booleans
        self._phase = bytearray(booleans)
        self._activity = [0.0] * booleans
        self._step = 1.0
        self._heap = [(0.0, boolean) for boolean in range(booleans)]
        self._trail: list[int] = []
        self._starts: list[int] = []
        self._head = 0
        self._consistent = True

    def add(self, literals: Iterable[int]) -> None:
        """At least one of the literals holds."""
        self._back_to(0)
        clause = [literal for literal in dict.fromkeys(literals) if not self._value[literal ^ 1]]
        if any(self._value[literal] or literal ^ 1 in clause for literal in clause):
            return
        if len(clause) > 1:
            self._keep(clause)
        elif not clause or not self._settle(clause[0], None) or self._propagate() is not None:
            self._consistent = False

    def solve(self, assumptions: Sequence[int] = ()) -> tuple[bool, ...] | None:
        """Values of all Booleans that satisfy the clauses and the assumed literals, or None."""
        return None if self.explain(assumptions) is not None else tuple(map(bool, self._value[::2]))

    def explain(self, assumptions: Sequence[int] = ()) -> tuple[int, ...] | None:
        """Assumed literals that contradict the clauses, not always the fewest; None if the assumptions can be met."""
        self._back_to(0)
        if not self._consistent:
            return ()
        conflicts, round_ = 0, 1
        while True:
            conflict = self._propagate()
            if conflict is not None:
                if not self._starts:
                    self._consistent = False
                    return ()
                self._learn(conflict)
                conflicts += 1
                continue
            if conflicts >= _RESTART * _luby(round_):
                conflicts, round_ = 0, round_ + 1
                self._back_to(0)
                continue
            decision = -1
            while len(self._starts) < len(assumptions):
                assumed = assumptions[len(self._starts)]
                if self._value[assumed ^ 1]:
                    return self._blame(assumed)
                if not self._value[assumed]:
                    decision = assumed
                    break
                self._starts.append(len(self._trail))
            else:
                decision = self._next()
                if decision < 0:
                    return None
            self._starts.append(len(self._trail))
            self._settle(decision, None)

    def _keep(self, clause: list[int]) -> None:
        if len(clause) == 2:
            self._implied[clause[0] ^ 1].append(clause[1])
            self._implied[clause[1] ^ 1].append(clause[0])
        else:
            self._watching[clause[0]].append(clause)
            self._watching[clause[1]].append(clause)

    def _settle(self, literal: int, reason: _Reason | None) -> bool:
        if self._is_set[literal >> 1]:
            return bool(self._value[literal])
        self._value[literal] = self._is_set[literal >> 1] = 1
        self._level[literal >> 1] = len(self._starts)
        self._reason[literal >> 1] = reason
        self._trail.append(literal)
        return True

    def _propagate(self) -> _Reason | None:
        """Follow what is settled to its ends; a clause that is violated, or None."""
        value, is_set, trail = self._value, self._is_set, self._trail
        while self._head < len(trail):
            literal = trail[self._head]
            self._head += 1
            for other in self._implied[literal]:
                if not value[other]:
                    if is_set[other >> 1]:
                        return (other, literal ^ 1)
                    self._settle(other, (other, literal ^ 1))
            false = literal ^ 1
            watching = self._watching[false]
            kept = 0
            for at, clause in enumerate(watching):
                if clause[0] == false:
                    clause[0], clause[1] = clause[1], false
                first = clause[0]
                if not value[first]:
                    for place in range(2, len(clause)):
                        candidate = clause[place]
                        if value[candidate] or not is_set[candidate >> 1]:
                            clause[1], clause[place] = candidate, false
                            self._watching[candidate].append(clause)
                            break
                    else:
                        if is_set[first >> 1]:
                            # The clause and all behind it stay watched.
                            watching[kept:at] = []
                            return clause
                        self._settle(first, clause)
                        watching[kept] = clause
                        kept += 1
                    continue
                watching[kept] = clause
                kept += 1
            del watching[kept:]
        return None

    def _learn(self, conflict: _Reason) -> None:
        """Add the clause at the first point through which all of the conflict runs, go back, and use it."""
        level = len(self._starts)
        seen: set[int] = set()
        lower: list[int] = []
        open_paths = 0
        at = len(self._trail)
        reason: _Reason = conflict
        while True:
            for literal in reason:
                boolean = literal >> 1
                if boolean in seen or not self._level[boolean] or self._value[literal]:
                    continue
                seen.add(boolean)
                self._bump(boolean)
                if self._level[boolean] == level:
                    open_paths += 1
                else:
                    lower.append(literal)
            while True:
                at -= 1
                if self._trail[at] >> 1 in seen:
                    break
            point = self._trail[at]
            open_paths -= 1
            if not open_paths:
                break
            reason = self._reason[point >> 1] or ()
        lower.sort(key=lambda literal: -self._level[literal >> 1])
        learned = [point ^ 1, *lower]
        self._back_to(self._level[lower[0] >> 1] if lower else 0)
        if lower:
            self._keep(learned)
        self._settle(point ^ 1, learned)
        self._step *= _DECAY

    def _blame(self, assumed: int) -> tuple[int, ...]:
        """The assumptions that make *assumed* false, and itself."""
        blamed = {assumed}
        pending, seen = [assumed >> 1], {assumed >> 1}
        while pending:
            boolean = pending.pop()
            if not self._level[boolean]:
                continue
            reason = self._reason[boolean]
            if reason is None:
                blamed.add(2 * boolean if self._value[2 * boolean] else 2 * boolean + 1)
                continue
            for literal in reason:
                if literal >> 1 not in seen:
                    seen.add(literal >> 1)
                    pending.append(literal >> 1)
        return tuple(sorted(blamed))

    def _bump(self, boolean: int) -> None:
        self._activity[boolean] += self._step
        if self._activity[boolean] > _RESCALE:
            self._activity = [activity / _RESCALE for activity in self._activity]
            self._step /= _RESCALE
            self._heap = [
                (-self._activity[each], each) for each in range(len(self._activity)) if not self._is_set[each]
            ]
            heapq.heapify(self._heap)

    def _next(self) -> int:
        """The most active open Boolean, as it was last; -1 if all are settled."""
        while self._heap:
            boolean = heapq.heappop(self._heap)[1]
            if not self._is_set[boolean]:
                return 2 * boolean + 1 - self._phase[boolean]
        return -1

    def _back_to(self, level: int) -> None:
        if len(self._starts) <= level:
            return
        start = self._starts[level]
        for literal in self._trail[start:]:
            boolean = literal >> 1
            self._phase[boolean] = not literal & 1
            self._value[literal] = self._is_set[boolean] = 0
            heapq.heappush(self._heap, (-self._activity[boolean], boolean))
        del self._trail[start:]
        del self._starts[level:]
        self._head = start


def _luby(number: int) -> int:
    """1, 1, 2, 1, 1, 2, 4, ... (Luby, Sinclair and Zuckerman 1993)."""
    while True:
        length = number.bit_length()
        if number + 1 == 1 << length:
            return 1 << (length - 1)
        number -= (1 << (length - 1)) - 1
