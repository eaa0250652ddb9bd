"""A field on triangles as a PNG without a drawing library: importing matplotlib takes longer than the picture."""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
#: Colours from cold to hot, evenly spaced: `tyrefem.reports.figures.style.temperature_map`.
COLOURS = (
    "260c51", "3e0966", "540f6d", "68166e", "7d1e6d", "922568", "a72d5f", "bb3755", "cd4248", "dd5239", "eb6528",
    "f47a18", "fa9108", "fca90e", "fac329", "f4dd4f", "f2f27d",
)  # fmt: skip


def colour_table(size: int = 256) -> Array:
    """Colours from cold to hot, (size, 3) bytes."""
    stops = np.array([[int(code[place : place + 2], 16) for place in (0, 2, 4)] for code in COLOURS], dtype=float)
    places = np.linspace(0, 1, size)
    even = np.linspace(0, 1, len(COLOURS))
    return np.column_stack([np.interp(places, even, band) for band in stops.T]).round().astype(np.uint8)


def raster(points: Array, triangles: Array, values: Array, shape: tuple[int, int]) -> Array:
    """Values at the middles of pixels, (rows, columns); NaN outside of all triangles.

    Parameters
    ----------
    points : (n, 2) in pixels, x to the right and y downwards. triangles : (m, 3). values : (n,), linear between points.

    >>> corners = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]])
    >>> raster(corners, np.array([[0, 1, 2]]), np.array([0.0, 4.0, 0.0]), (2, 2))
    array([[0.5, 1.5],
           [0.5, 1.5]])
    """
    rows, columns = shape
    image = np.full(shape, np.nan)
    corners = points[triangles]
    low = np.maximum(np.ceil(corners.min(axis=1) - 0.5), 0).astype(int)
    high = np.minimum(np.floor(corners.max(axis=1) - 0.5), (columns - 1, rows - 1)).astype(int)
    wide, tall = np.maximum(high - low + 1, 0).T
    # Every pixel of every triangle's box, one after the other.
    counts = wide * tall
    parent = np.repeat(np.arange(len(triangles)), counts)
    within = np.arange(len(parent)) - np.repeat(np.cumsum(counts) - counts, counts)
    x, y = low[parent, 0] + within % wide[parent], low[parent, 1] + within // wide[parent]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    across = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    across = np.where(across == 0, np.inf, across)[parent]
    (p, q), (b1, b2), (c1, c2) = (np.column_stack([x, y]) + 0.5 - a[parent]).T, (b - a)[parent].T, (c - a)[parent].T
    second, third = (p * c2 - q * c1) / across, (b1 * q - b2 * p) / across
    inside = (second >= -1e-9) & (third >= -1e-9) & (second + third <= 1 + 1e-9)
    first_value, second_value, third_value = values[triangles].T
    drawn = first_value[parent] * (1 - second - third) + second_value[parent] * second + third_value[parent] * third
    image[y[inside], x[inside]] = drawn[inside]
    return image


def png(image: Array, low: float, high: float) -> bytes:
    """A PNG of values between ``low`` and ``high``; NaN is transparent."""
    shares = np.clip((np.nan_to_num(image, nan=low) - low) / (high - low), 0, 1)
    coloured = colour_table()[(shares * 255).round().astype(int)]
    opaque = np.where(np.isnan(image), 0, 255).astype(np.uint8)
    pixels = np.concatenate([coloured, opaque[..., None]], axis=2)
    rows, columns = image.shape
    lines = np.concatenate([np.zeros((rows, 1), np.uint8), pixels.reshape(rows, -1)], axis=1).tobytes()
    parts = {
        b"IHDR": struct.pack(">IIBBBBB", columns, rows, 8, 6, 0, 0, 0), b"IDAT": zlib.compress(lines, 6), b"IEND": b"",
    }  # fmt: skip
    chunks = (struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
              for kind, data in parts.items())  # fmt: skip
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)
