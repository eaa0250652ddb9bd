"""Aircraft sizes find their row of the data book in any spelling."""

from __future__ import annotations

import pytest

from tyrefem.errors import InputError
from tyrefem.sizes import parse_size
from tyrefem.sizes.data_book import data_book, row_of
from tyrefem.sizes.section import draw_size

pytestmark = pytest.mark.fast


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("13.5x6.0-4 14PR", "13.5x6-4"),
        ("24x7.7-10 16PR", "24x7.7"),
        ("24.0x7.70 16PR", "24x7.7"),
        ("22x5.5-12 8PR", "22x5.5"),
        ("22 X 5.50 - 12 8PR", "22x5.5"),
        ("h44.5x16.50-21", "H44.5x16.5-21"),
        ("44.5x16.5-21", "44.5x16.5-21"),
        ("13.5x6 14PR", "13.5x6-4"),
        ("36x11", "36x11"),
        ("36x11-18", "36x11-18"),
    ],
)
def test_a_size_in_other_spelling_has_its_row(text: str, name: str) -> None:
    row = row_of(parse_size(text))
    assert row is not None
    assert row.size == name


@pytest.mark.parametrize("text", ["22x5.5-8 8PR", "22x5.5R12", "24x7.7-10 60PR", "B44.5x16.5-21", "22x8"])
def test_another_rim_build_rating_or_prefix_has_none(text: str) -> None:
    assert row_of(parse_size(text)) is None


def test_every_row_is_found_by_its_name() -> None:
    assert all(row_of(parse_size(row.size)) is not None for row in data_book())


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("22x8", "write 22x8-8 or 22x8-10, or give rim_diameter"),
        ("24.0x7.7 9PR", r"6PR, 10PR.*such as 24\.0x7\.7-10"),
        ("22 x 5.3", "such as 22x5.3-12"),
    ],
)
def test_a_size_without_a_rim_says_how_to_write_it(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        draw_size(text)


def test_the_rated_load_is_that_of_the_book() -> None:
    assert parse_size("13.5x6.0-4 14PR").ply_rating == 14
    assert draw_size("13.5x6.0-4 14PR").rules["rated_load"].text == draw_size("13.5x6-4 14PR").rules["rated_load"].text
