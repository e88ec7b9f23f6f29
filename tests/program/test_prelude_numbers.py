# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of the prelude: repeatable, bounded, smooth."""

from __future__ import annotations

import inspect
import subprocess
import sys

import pytest
from code_as_room.pipeline.program.prelude import numbers, registry
from code_as_room.pipeline.program.prelude.recorder import Recorder
from hypothesis import given
from hypothesis import strategies as st

numbers_st = st.floats(-1e6, 1e6)


@given(numbers_st, numbers_st, st.one_of(st.none(), numbers_st), st.integers(0, 99))
def test_noise_is_bounded_and_repeatable(x, y, z, seed) -> None:
    value = numbers.noise(x, y, z, seed)
    assert -1.3 <= value <= 1.3
    assert numbers.noise(x, y, z, seed) == value


@given(st.floats(-300, 300), st.floats(-300, 300), st.one_of(st.none(), st.floats(-300, 300)))
def test_noise_has_no_jumps(x, y, z) -> None:
    step = 1e-4
    assert abs(numbers.noise(x + step, y, z) - numbers.noise(x, y, z)) < 1e-3
    assert abs(numbers.noise(x, y + step, z) - numbers.noise(x, y, z)) < 1e-3
    if z is not None:
        assert abs(numbers.noise(x, y, z + step) - numbers.noise(x, y, z)) < 1e-3


def test_noise_varies() -> None:
    for z in (None, 0.3):
        values = [numbers.noise(i * 0.37, i * 0.21, z) for i in range(500)]
        assert max(values) > 0.5 and min(values) < -0.5
        assert abs(sum(values) / len(values)) < 0.1
    assert numbers.noise(0.3, 0.4, seed=1) != numbers.noise(0.3, 0.4, seed=2)
    assert numbers.noise(3, 5) == 0


@given(st.one_of(st.integers(), numbers_st, st.text(), st.tuples(st.integers(), st.text())))
def test_rand_stays_in_its_range(seed) -> None:
    assert 0 <= numbers.rand(seed) < 1
    assert 2 <= numbers.rand(seed, 2, 5) < 5


def test_rand_is_evenly_spread_and_differs_by_seed() -> None:
    values = [numbers.rand(i) for i in range(-1000, 1000)]
    assert len(set(values)) == 2000
    assert all(150 < sum(k / 10 <= v < (k + 1) / 10 for v in values) < 250 for k in range(10))
    assert numbers.rand((1, 2)) != numbers.rand((2, 1)) != numbers.rand("12")
    assert numbers.rand(1) == numbers.rand(1.0)


def test_rand_is_the_same_in_another_process() -> None:
    code = "from code_as_room.pipeline.program.prelude.numbers import rand; print(rand('lamp'), rand((0.1, 7)))"
    there = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert there == [str(numbers.rand("lamp")), str(numbers.rand((0.1, 7)))]


@given(numbers_st, numbers_st)
def test_lerp_and_clamp_meet_their_ends(a, b) -> None:
    low, high = min(a, b), max(a, b)
    assert numbers.lerp(a, b, 0) == a and numbers.lerp(a, b, 1) == pytest.approx(b, abs=1e-6)
    assert numbers.lerp((a, 0), (b, 2), 0.5) == (pytest.approx((a + b) / 2, abs=1e-6), 1)
    assert low <= numbers.clamp(0.0, low, high) <= high
    assert numbers.smoothstep(low, high, low - 1) == 0 and numbers.smoothstep(low, high, high + 1) == 1


def test_list_and_dict_helpers() -> None:
    found: list[int] = []
    numbers.append(found, 3)
    table = {"a": 1, "b": 2}
    assert (found, numbers.keys(table), numbers.values(table)) == ([3], ["a", "b"], [1, 2])
    assert numbers.items(table) == [("a", 1), ("b", 2)]
    with pytest.raises(ValueError, match="append: the first argument must be a list"):
        numbers.append("a", 1)
    with pytest.raises(ValueError, match="keys: the argument must be a dict"):
        numbers.keys([1])


def test_every_name_of_the_registry_is_its_own_and_documented() -> None:
    for name, function in registry.CONSTRUCTORS.items():
        assert function.__name__ == name and inspect.getdoc(function)
    for name in registry.LINE_NAMES:
        assert callable(getattr(Recorder(), name))
    names = [*registry.CONSTANTS, *registry.MATH, *registry.CONSTRUCTORS, *registry.LOOKS, *registry.LINE_NAMES]
    assert len(set(names)) == len(names) and not any(name.startswith("_") for name in names)
