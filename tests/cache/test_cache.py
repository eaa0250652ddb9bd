"""The cache: bounded, keyed by value, safe on threads."""

from __future__ import annotations

import pickle
import threading
import time
from collections.abc import Callable, Hashable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from tyrefem.cache import Cache, Content, fingerprint

pytestmark = pytest.mark.fast


def test_the_least_recently_used_value_makes_room() -> None:
    cache = Cache[str](size=3)
    for key in ("a", "b", "c", "a", "d"):
        assert cache.get(key, lambda key=key: key.upper()) == key.upper()
    assert [key in cache for key in "abcd"] == [True, False, True, True]
    assert (cache.hits, cache.misses, len(cache)) == (1, 4, 3)
    cache.clear()
    assert (cache.hits, cache.misses, len(cache)) == (0, 0, 0)


def test_a_cache_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="one value or more"):
        Cache[int](size=0)


def test_a_value_that_cannot_be_computed_is_not_kept() -> None:
    cache = Cache[float](size=2)
    with pytest.raises(ZeroDivisionError):
        cache.get(0, lambda: 1 / 0)
    assert 0 not in cache
    assert cache.get(0, lambda: 2.0) == 2.0


def test_a_computation_may_use_the_cache() -> None:
    cache = Cache[int](size=50)

    def fibonacci(n: int) -> int:
        return n if n < 2 else cache.get(n, lambda: fibonacci(n - 1) + fibonacci(n - 2))

    assert fibonacci(40) == 102334155
    assert cache.misses == 39


def test_threads_get_the_same_value_and_the_size_holds() -> None:
    cache = Cache[list[int]](size=5)
    start = threading.Barrier(8)

    def work(number: int) -> list[list[int]]:
        start.wait()
        values = []
        for turn in range(200):
            key = (turn + number) % 12
            value = cache.get(key, lambda key=key: time.sleep(1e-5) or [key])
            assert value == [key]
            assert len(cache) <= 5
            values.append(value)
        return values

    with ThreadPoolExecutor(8) as pool:
        done = list(pool.map(work, range(8)))
    assert sum(map(len, done)) == cache.hits + cache.misses == 1600


def test_two_threads_that_compute_at_once_get_one_object() -> None:
    cache, both = Cache[object](size=2), threading.Barrier(2)

    def compute() -> object:
        both.wait()
        return object()

    with ThreadPoolExecutor(2) as pool:
        values = [future.result() for future in [pool.submit(cache.get, "key", compute) for _ in range(2)]]
    assert values[0] is values[1]
    assert cache.misses == 2


def test_a_pickled_cache_comes_back_empty() -> None:
    cache = Cache[int](size=7)
    cache.get(1, lambda: 1)
    back = pickle.loads(pickle.dumps(cache))
    assert (back.size, len(back)) == (7, 0)


@pytest.mark.parametrize("of", [fingerprint, Content.of], ids=["fingerprint", "content"])
def test_equal_arrays_have_one_key_and_others_another(of: Callable[[Any], Hashable]) -> None:
    numbers = np.linspace(0.0, 1.0, 120)
    same = numbers.copy()
    assert of(numbers) == of(same) == of(np.stack([same, same], axis=1)[:, 0])
    assert hash(of(numbers)) == hash(of(same))
    middle = numbers.copy()
    middle[60] = np.nextafter(middle[60], 2.0)
    others = [numbers.reshape(3, 40), numbers.astype(np.float32), middle, numbers[:-1], np.zeros(0), numbers[::-1]]
    assert len({of(numbers), *map(of, others)}) == 1 + len(others)


def test_a_fingerprint_tells_where_an_array_ends() -> None:
    numbers = np.linspace(0.0, 1.0, 12)
    assert fingerprint(numbers[:6], numbers[6:]) != fingerprint(numbers)


def test_a_key_keeps_the_numbers_that_it_was_made_of() -> None:
    numbers = np.zeros(3)
    key = Content.of(numbers)
    numbers[1] = 1.0
    assert key == Content.of(np.zeros(3))
