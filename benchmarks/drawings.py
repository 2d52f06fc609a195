"""Drawings of any size, for timing."""

from __future__ import annotations

import numpy as np

from optplan.domain.ordering import EuclidCosts, OrderingProblem


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


def drawing(strokes: int, seed: int = 0) -> OrderingProblem:
    """An ordering problem of straight lines between strokes: centres uniform in a square of `strokes` m2, seeded.

    Every other stroke is closed, a star-shaped polygon with 8 to 16 vertices 0.2 to 0.5 m from its centre, entered and
    left at any of them; the rest are open, 0.4 to 1 m long, driven either way.
    """
    random = np.random.default_rng(seed)
    cluster, exits, entries = [], [], []
    for k in range(strokes):
        centre, size = random.uniform(0, np.sqrt(strokes), 2), random.uniform(0.2, 0.5)
        if k % 2 == 0:
            count = int(random.integers(8, 17))
            angles = np.sort(random.uniform(0, 2 * np.pi, count))
            radii = size * random.uniform(0.6, 1, count)
            places = centre + radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
            entries.append(places)
            exits.append(places)
        else:
            angle = random.uniform(0, 2 * np.pi)
            half = size * np.array([np.cos(angle), np.sin(angle)])
            places = np.array([centre - half, centre + half])
            entries.append(places)
            exits.append(places[::-1])
        cluster += [k] * len(places)
    return OrderingProblem(np.array(cluster), EuclidCosts(np.concatenate(exits), np.concatenate(entries)))
