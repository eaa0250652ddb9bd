"""A study whose answer is known, for every test of comparisons."""

from __future__ import annotations

import pytest
from toy_study import Study


@pytest.fixture
def study():
    return Study()
