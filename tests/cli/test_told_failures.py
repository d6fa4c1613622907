"""What `dse explore` says of failures and second tries."""

from __future__ import annotations

from dse.api import Summary
from dse.cli.exploration import outcome_text


def summary(problems: dict[int, str], failures: set[int], causes: dict[int, str]) -> Summary:
    return Summary(9, 9, len(failures), {}, problems, frozenset(failures), causes)


def test_failures_with_the_same_words_but_for_numbers_are_one_line() -> None:
    problems = {n: f"head: fmi2DoStep at t = {n / 10} s returned error" for n in range(6)}
    lines = outcome_text(summary({**problems, 7: "head: is not a number"}, {*range(6)}, {}))
    assert lines == [
        "6 runs (0, 1, 2, 3, …) failed: head: fmi2DoStep at t = 0.0 s returned error",
        "run 7 head: is not a number",
    ]


def test_what_came_right_or_failed_otherwise_the_second_time_is_said() -> None:
    causes = {1: "crashed (signal 11)", 2: "crashed (signal 11)", 3: "no answer for 2 s", 4: "no answer for 2 s"}
    lines = outcome_text(summary({3: "crashed (signal 6)", 4: "no answer for 2 s"}, {3, 4}, causes))
    assert lines == [
        "run 3 failed: crashed (signal 6)",
        "run 4 failed: no answer for 2 s",
        "2 runs (1, 2) came right the second time; the first: crashed (signal 11)",
        "run 3 failed otherwise the first time: no answer for 2 s",
    ]
