from __future__ import annotations

import numpy as np
import pytest

from dse.report.insight.probability_maps import largest_ellipse

EVEN = np.linspace(0, 1, 31)
X, Y = np.meshgrid(EVEN, EVEN)


def _area(outline: np.ndarray) -> float:
    x, y = outline.T
    return float(abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2)


def _cone(distance: np.ndarray, radius: float) -> np.ndarray:
    """A field that is 0.95 at *radius*, and less beyond."""
    return 0.95 + (radius - distance)


def test_in_a_disc_it_is_the_disc() -> None:
    outline = largest_ellipse(np.array([0.4, 0.5]), _cone(np.hypot(X - 0.4, Y - 0.5), 0.3), 0.95)
    assert np.hypot(*(outline - [0.4, 0.5]).T) == pytest.approx(0.3, abs=0.02)


def test_where_all_is_allowed_it_touches_the_ends() -> None:
    """An axis each reaches the nearest end: half axes 0.3 and 0.5."""
    outline = largest_ellipse(np.array([0.3, 0.5]), np.ones((31, 31)), 0.95)
    assert outline.min(axis=0) == pytest.approx([0.0, 0.0], abs=0.02)
    assert outline.max(axis=0) == pytest.approx([0.6, 1.0], abs=0.02)
    assert outline.min() >= 0


def test_in_a_slanted_strip_it_lies_along_the_strip() -> None:
    field = _cone(np.abs(X - Y) / np.sqrt(2), 0.1)
    outline = largest_ellipse(np.array([0.5, 0.5]), field, 0.95)
    longest = outline[np.argmax(np.hypot(*(outline - 0.5).T))] - 0.5
    assert longest[0] == pytest.approx(longest[1], abs=0.03)
    assert (np.abs(outline[:, 0] - outline[:, 1]) / np.sqrt(2)).max() == pytest.approx(0.1, abs=0.015)
    assert _area(outline) > 3 * np.pi * 0.1**2


def test_no_place_inside_is_forbidden() -> None:
    random = np.random.default_rng(0)
    for _ in range(20):
        field = np.where(np.hypot(X - 0.5, Y - 0.5) < 0.1, 1.0, random.random((31, 31)) * 1.5)
        outline = largest_ellipse(np.array([0.5, 0.5]), field, 0.95)
        inside = _cross(outline, np.stack([X, Y], axis=-1))
        assert (field[inside] >= 0.95).all()
        assert inside.any()


def _cross(outline: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Which points are left of every side of the convex outline, in whichever sense it runs."""
    sides = np.roll(outline, -1, axis=0) - outline
    away = points[..., None, :] - outline
    turn = sides[:, 0] * away[..., 1] - sides[:, 1] * away[..., 0]
    return np.asarray((turn > 0).all(axis=-1) | (turn < 0).all(axis=-1))


def test_beside_a_forbidden_centre_there_is_none() -> None:
    assert largest_ellipse(np.array([0.5, 0.5]), np.zeros((31, 31)), 0.95).shape == (0, 2)
