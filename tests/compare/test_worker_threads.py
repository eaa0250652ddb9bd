"""Worker processes use one thread each for linear algebra."""

from __future__ import annotations

import pytest

from tyrefem.processes import processes

pytestmark = pytest.mark.fast


def threads() -> list[int]:
    import numpy as np
    import scipy.linalg
    from threadpoolctl import threadpool_info

    scipy.linalg.inv(np.eye(3))
    return [library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"]


def test_also_libraries_that_the_first_task_loads() -> None:
    with processes(1) as pool:
        assert set(pool.submit(threads).result()) == {1}
