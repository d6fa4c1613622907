"""Tables and linear systems of the runtime against scipy, numpy and the Python they have to agree with."""

from __future__ import annotations

import ctypes
import itertools
import math

import numpy as np
import pytest
from fmu.modelica_models.bench import RUNTIME
from hypothesis import given, settings, strategies as st

from dse.csolve import headers
from dse.fmu.toolchain.compilation import compile_library
from dse.fmu.toolchain.compiler import find_compiler
from dse.fmu.toolchain.platforms import this_platform
from dse.modelica.algebra.evaluate import table

_SOURCE = b"""
#include "csolve/linear.h"
#include "tables.h"
#if defined _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
EXPORT int axis(const double *xs, size_t n) { return dse_axis(xs, n); }
EXPORT int one(double *y, int order, double x, const double *xs, size_t n, const double *ys, int s, int e) {
    return dse_table1(y, order, x, xs, n, ys, s, e);
}
EXPORT int two(double *z, int a, int b, double x, double y, const double *xs, size_t n, const double *ys, size_t m,
    const double *zs, int s, int e) {
    return dse_table2(z, a, b, x, y, xs, n, ys, m, zs, s, e);
}
EXPORT int solve(unsigned n, double *matrix, double *right) { return dse_solve(n, matrix, right); }
"""


@pytest.fixture(scope="module")
def numerics(tmp_path_factory):
    files = headers() | {"tables.h": (RUNTIME / "tables.h").read_bytes(), "numerics.c": _SOURCE}
    path = tmp_path_factory.mktemp("numerics") / this_platform().library(2, "numerics").name
    path.write_bytes(compile_library(find_compiler(), files, ["numerics.c"], ".", path.name))
    return ctypes.CDLL(str(path))


def _numbers(values):
    return (ctypes.c_double * len(values))(*values)


def _one(numerics, order, x, xs, ys, smooth, extrapolation):
    y = ctypes.c_double(7.0)
    code = numerics.one(
        ctypes.byref(y), order, ctypes.c_double(x), _numbers(xs), ctypes.c_size_t(len(xs)), _numbers(ys),
        int(smooth), extrapolation,
    )  # fmt: skip
    assert (code != 0) == math.isnan(y.value)
    return y.value


def _two(numerics, orders, point, axes, zs, smooth, extrapolation):
    z = ctypes.c_double(7.0)
    (xs, ys), (x, y) = axes, point
    code = numerics.two(
        ctypes.byref(z), orders[0], orders[1], ctypes.c_double(x), ctypes.c_double(y), _numbers(xs),
        ctypes.c_size_t(len(xs)), _numbers(ys), ctypes.c_size_t(len(ys)), _numbers(zs), int(smooth), extrapolation,
    )  # fmt: skip
    assert (code != 0) == math.isnan(z.value)
    return z.value


_XS = [-2.0, -1.5, 0.0, 0.1, 2.0, 5.0]
_YS = [1.0, 3.0, 2.5, 2.5, -1.0, 4.0]


@pytest.mark.parametrize("count", [2, 3, 4, 6])
def test_a_smooth_table_is_scipys_monotone_interpolation(numerics, count):
    from scipy.interpolate import PchipInterpolator

    xs, ys = _XS[:count], _YS[:count]
    reference = PchipInterpolator(xs, ys)
    for x in np.linspace(xs[0], xs[-1], 97):
        for order in (0, 1, 2):
            expected = reference(x, order) if order < 2 or x not in xs else None
            if expected is not None:
                assert _one(numerics, order, x, xs, ys, True, 3) == pytest.approx(float(expected), abs=1e-11)


@pytest.mark.parametrize("smooth", [False, True])
@pytest.mark.parametrize("extrapolation", [1, 2, 3])
@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("count", [2, 3, 6])
def test_a_table_over_one_axis_agrees_with_python_inside_and_outside(numerics, smooth, extrapolation, order, count):
    xs, ys = _XS[:count], _YS[:count]
    for x in [*np.linspace(xs[0] - 1.5, xs[-1] + 1.5, 61), *xs]:
        expected = table((order,), (float(x),), (xs,), ys, smooth, extrapolation)
        assert _one(numerics, order, x, xs, ys, smooth, extrapolation) == pytest.approx(
            expected, abs=1e-11, nan_ok=True
        )


@pytest.mark.parametrize("smooth", [False, True])
@pytest.mark.parametrize("extrapolation", [1, 2, 3])
@pytest.mark.parametrize("shape", [(2, 2), (3, 2), (4, 6), (6, 3)])
def test_a_table_over_two_axes_agrees_with_python_inside_and_outside(numerics, smooth, extrapolation, shape):
    axes = _XS[: shape[0]], [0.0, 1.0, 1.25, 4.0, 5.0, 5.5][: shape[1]]
    zs = np.random.default_rng(1).uniform(-3.0, 3.0, shape[0] * shape[1]).tolist()
    for orders in itertools.product((0, 1, 2), repeat=2):
        for x in np.linspace(axes[0][0] - 1.0, axes[0][-1] + 1.0, 9):
            for y in np.linspace(axes[1][0] - 1.0, axes[1][-1] + 1.0, 9):
                expected = table(orders, (float(x), float(y)), axes, zs, smooth, extrapolation)
                found = _two(numerics, orders, (x, y), axes, zs, smooth, extrapolation)
                assert found == pytest.approx(expected, abs=1e-10, nan_ok=True)


def test_a_smooth_table_over_two_axes_is_exact_for_a_parabola_in_both(numerics):
    axes = [0.0, 0.5, 2.0, 3.0], [-1.0, 0.0, 0.25, 2.0, 4.0]
    zs = [(1 + x - 2 * x * x) * (2 - y + 0.5 * y * y) for x, y in itertools.product(*axes)]
    for x, y in itertools.product(np.linspace(0.0, 3.0, 13), np.linspace(-1.0, 4.0, 13)):
        assert _two(numerics, (0, 0), (x, y), axes, zs, True, 3) == pytest.approx(
            (1 + x - 2 * x * x) * (2 - y + 0.5 * y * y), abs=1e-11
        )
        assert _two(numerics, (1, 1), (x, y), axes, zs, True, 3) == pytest.approx((1 - 4 * x) * (-1 + y), abs=1e-11)


@pytest.mark.parametrize(
    "axis", [[0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0, 1.0], [0.0, math.nan], [-math.inf, 0.0], [0.0, math.inf]]
)
def test_an_axis_has_two_points_or_more_each_greater_than_the_one_before(numerics, axis):
    assert numerics.axis(_numbers(axis), ctypes.c_size_t(len(axis))) != 0


def test_a_rising_axis_is_one(numerics):
    assert numerics.axis(_numbers([-1.0, 0.0, 1e-300]), ctypes.c_size_t(3)) == 0


def _solve(numerics, matrix, right):
    rows, solution = _numbers(matrix.ravel()), _numbers(right)
    code = numerics.solve(ctypes.c_uint(len(right)), rows, solution)
    return code, np.array(solution)


@settings(max_examples=60, deadline=None)
@given(size=st.integers(1, 12), seed=st.integers(0, 2**32 - 1), spread=st.integers(0, 12))
def test_a_regular_system_is_solved_whatever_the_units_of_its_rows_and_columns(numerics, size, seed, spread):
    draw = np.random.default_rng(seed)
    plain = draw.uniform(-1.0, 1.0, (size, size)) + 2.0 * np.eye(size) * math.sqrt(size)
    solution = draw.uniform(-1.0, 1.0, size)
    rows, columns = 10.0 ** draw.uniform(-spread, spread, size), 10.0 ** draw.uniform(-spread, spread, size)
    matrix = rows[:, None] * plain * columns
    code, found = _solve(numerics, matrix, rows * (plain @ solution))
    assert code == 0
    assert np.abs(found * columns - solution).max() < 1e-10 * np.linalg.cond(plain)


def test_a_permutation_is_solved_exactly(numerics):
    matrix = np.eye(5)[[3, 0, 4, 1, 2]]
    code, found = _solve(numerics, matrix, np.arange(5.0))
    assert code == 0
    assert (matrix @ found == np.arange(5.0)).all()


@pytest.mark.parametrize(
    "matrix",
    [
        [[0.0]],
        [[1.0, 2.0], [2.0, 4.0]],
        [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]],
        [[1.0, 0.0], [1.0, 0.0]],
        [[math.nan, 1.0], [1.0, 1.0]],
        [[math.inf, 1.0], [1.0, 1.0]],
        [[1e-8, 1.0], [3e-8, 3.0]],
    ],
)
def test_a_singular_system_is_refused_and_leaves_the_right_side(numerics, matrix):
    right = np.arange(1.0, len(matrix) + 1.0)
    code, found = _solve(numerics, np.array(matrix), right)
    assert code != 0
    assert (found == right).all()
