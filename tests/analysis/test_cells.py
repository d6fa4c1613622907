"""What runs count by the space around them, where there are many."""

from __future__ import annotations

import numpy as np
from known_functions import even

from dse.analysis.cells import space_weights

MANY = 3000


def test_many_points_that_lie_evenly_all_count_one():
    points = even(MANY, 2)
    groups = np.repeat([0, 1], MANY)
    assert (space_weights(np.concatenate([points, points]), groups, on_grid=False) == 1).all()


def test_many_points_that_crowd_count_by_the_space_around_them_in_each_group():
    """Half of them lie in a tenth of the square: one of these counts a ninth of one of the others."""
    points = even(MANY, 2)
    points[: MANY // 2, 0] *= 0.1
    points[MANY // 2 :, 0] = 0.1 + 0.9 * points[MANY // 2 :, 0]
    weights = space_weights(np.concatenate([points, points]), np.repeat([0, 1], MANY), on_grid=False)
    assert (weights[:MANY] == weights[MANY:]).all()
    crowded, others = weights[: MANY // 2].mean(), weights[MANY // 2 : MANY].mean()
    assert 0.09 < crowded / others < 0.13
    assert abs(weights.mean() - 1) < 1e-9
