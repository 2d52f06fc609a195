"""Drawings of any size, for timing."""

from __future__ import annotations

import numpy as np


def random_drawing(strokes: int, seed: int = 0) -> str:
    """An SVG of curved strokes spread over a square page: half of them closed, half open, seeded."""
    random = np.random.default_rng(seed)
    side = 100 * np.sqrt(strokes)
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {side:.0f} {side:.0f}">']
    for k in range(strokes):
        centre, size = random.uniform(60, side - 60, 2), random.uniform(20, 60)
        closed = k % 2 == 0
        count = int(random.integers(8, 17)) if closed else 4
        angles = np.sort(random.uniform(0, 2 * np.pi if closed else np.pi, count))
        radii = size * random.uniform(0.6, 1, count)
        points = centre + np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
        # a smooth chain of cubics, handles along the chord of the neighbours
        tangents = (np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)) / 6
        if not closed:
            tangents[[0, -1]] = 0
        path = f"M{points[0][0]:.2f} {points[0][1]:.2f}"
        for a in range(count if closed else count - 1):
            b = (a + 1) % count
            numbers = [*(points[a] + tangents[a]), *(points[b] - tangents[b]), *points[b]]
            path += "C" + " ".join(f"{value:.2f}" for value in numbers)
        lines.append(f'<path d="{path}{"z" if closed else ""}" fill="none" stroke="#000" stroke-width="1"/>')
    return "\n".join([*lines, "</svg>"])
