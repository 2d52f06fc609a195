"""Figures of connectors: processor time a query, and lengths against lists of known ones.

The lists are looked for in `../shared/data/connectors` beside the project; without them those rows are left out.
"""

from __future__ import annotations

import csv
import itertools
import statistics
import sys
import time
from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from benchmarks.ordering import DATA
from benchmarks.table import Row, print_rows, used
from optplan.domain.arrays import FloatArray
from optplan.geometry.cc import Family, cc_lengths, cc_matrix, cc_path
from optplan.geometry.curves import Curve
from optplan.geometry.dubins import dubins_lengths
from optplan.geometry.reversing import reeds_shepp_lengths, reversing_lengths

LISTS = DATA / "connectors"
KAPPA = 1.125
MISSED = 3.3e-5
"""m by which listed paths may miss their ends"""
SHARPNESSES = (3.0, 2.1, 1.0, 0.25)
"""1/m^2: kappa_max^2 / sigma_max is 0.42, 0.60, 1.27 and 5.06"""


def queries(count: int, seed: int) -> FloatArray:
    """Random rows x, y, heading, curvature 0 in a box of 10 m."""
    random = np.random.default_rng(seed)
    return np.column_stack([random.uniform(0, 10, (count, 2)), random.uniform(-np.pi, np.pi, count), np.zeros(count)])


def speeds(count: int = 100_000) -> Iterator[Row]:
    """Microseconds a query in a batch."""
    starts, ends = queries(count, 0), queries(count, 1)
    scale = 1e6 / count
    dubins_lengths(starts[:9, :3], ends[:9, :3], 1 / KAPPA)
    for sharpness in SHARPNESSES:
        cc_lengths(starts[:9], ends[:9], KAPPA, sharpness)
        dubins = scale * used(lambda: dubins_lengths(starts[:, :3], ends[:, :3], 1 / KAPPA))
        reference = scale * used(lambda: cc_lengths(starts, ends, KAPPA, sharpness, "reference"))  # noqa: B023
        full = scale * used(lambda: cc_lengths(starts, ends, KAPPA, sharpness), 3)  # noqa: B023
        q = KAPPA**2 / sharpness
        yield Row(f"Dubins length, beside q = {q:.2f}", dubins, 0.25, "us")
        yield Row(f"reference family, q = {q:.2f}", reference / dubins, 2.5, "x", "of the Dubins time")
        yield Row(f"full family, q = {q:.2f}", full, 10.0, "us", f"{full / dubins:.0f} x the Dubins time")


def reversing(count: int = 20_000) -> Iterator[Row]:
    """Microseconds a query of connectors that change gear, and how much shorter they are."""
    starts, ends = queries(count, 0), queries(count, 1)
    poses = starts[:, :3], ends[:, :3]
    scale = 1e6 / count
    reeds_shepp_lengths(starts[:9, :3], ends[:9, :3], 1 / KAPPA)
    plain = scale * used(lambda: reeds_shepp_lengths(*poses, 1 / KAPPA))
    shorter = float((reeds_shepp_lengths(*poses, 1 / KAPPA) / dubins_lengths(*poses, 1 / KAPPA)).mean())
    yield Row("Reeds-Shepp length", plain, 6.0, "us", f"mean length {shorter:.3f} of Dubins")
    for sharpness in SHARPNESSES:
        q = KAPPA**2 / sharpness
        reversing_lengths(starts[:9], ends[:9], KAPPA, sharpness)
        seconds = used(lambda: reversing_lengths(starts, ends, KAPPA, sharpness), 3)  # noqa: B023
        yield Row(f"reversing, q = {q:.2f}", scale * seconds, 50.0, "us")
        ratio = reversing_lengths(starts, ends, KAPPA, sharpness) / cc_lengths(starts, ends, KAPPA, sharpness)
        yield Row(f"reversing over forwards, q = {q:.2f}", float(ratio.mean()), 0.85, "", "mean length")
        yield Row("longer than forwards, queries", float((ratio > 1 + 1e-8).sum()), 0, "")


def matrices(size: int = 2000, sharpness: float = 2.1) -> Iterator[Row]:
    """Wall seconds of a matrix by threads."""
    exits, entries = queries(size, 2), queries(size, 3)
    families: tuple[tuple[Family, float], ...] = (("reference", 4.0), ("full", 25.0))
    for family, target in families:
        start = time.perf_counter()
        cc_matrix(exits, entries, KAPPA, sharpness, family)
        yield Row(f"matrix {size} x {size}, {family} family", time.perf_counter() - start, target, "s", "wall")


def listed(name: str, column: str, family: Family) -> tuple[list[dict[str, str]], FloatArray]:
    """Rows of a list, and length over the listed one of each."""
    groups: dict[tuple[float, float], list[dict[str, str]]] = defaultdict(list)
    with (LISTS / name).open() as stream:
        for row in csv.DictReader(stream):
            groups[float(row["kappa_max"]), float(row["sigma_max"])].append(row)
    ratios = []
    for limits, group in groups.items():
        starts, ends = (
            np.array([[float(row.get(f"{what}{i}", 0)) for what in ("x", "y", "th", "k")] for row in group])
            for i in (0, 1)
        )
        ratios.append(cc_lengths(starts, ends, *limits, family) / [float(row[column]) for row in group])
    return [row for group in groups.values() for row in group], np.concatenate(ratios)


def _longer(row: dict[str, str]) -> bool:
    """Whether a query's path is longer than the listed one also to every end that the listed one may have reached."""
    start, end = (np.array([float(row[f"{what}{i}"]) for what in ("x", "y", "th", "k")]) for i in (0, 1))
    angles = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    ends = np.tile(end, (len(angles), 1))
    ends[:, :2] += MISSED * np.column_stack([np.cos(angles), np.sin(angles)])
    lengths = cc_lengths(np.tile(start, (len(angles), 1)), ends, float(row["kappa_max"]), float(row["sigma_max"]))
    return bool(lengths.min() > float(row["cc_len"]) * (1 + 1e-9))


def lengths() -> Iterator[Row]:
    """Lengths against the lists."""
    if not LISTS.is_dir():
        return
    _, off = listed("cc00.csv", "cc00_len", "reference")
    yield Row("reference family off cc00.csv, relative", float(np.abs(off - 1).max()), 1e-9, "")
    rows, full = listed("cc00.csv", "cc00_len", "full")
    yield Row("longer than cc00.csv, queries", float((full > 1 + 1e-9).sum()), 0, "")
    with (LISTS / "best.csv").open() as stream:
        best = {row["id"]: float(row["best_known_len"]) for row in csv.DictReader(stream)}
    for what, least, most, target in (("q <= 2", 0.0, 2.001, 3.0), ("q >= 5", 4.999, np.inf, 10.0)):
        worse = [
            ratio * float(row["cc00_len"]) > 1.002 * best[row["id"]]
            for row, ratio in zip(rows, full, strict=True)
            if row["id"] in best and least <= float(row["kappa_max"]) ** 2 / float(row["sigma_max"]) <= most
        ]
        yield Row(f"0.2 % above the best known, {what}", 100 * float(np.mean(worse)), target, "%")
    for name, mean in (("ccpm.csv", 0.85), ("ccarb.csv", 1.0)):
        found, ratio = listed(name, "cc_len", "full")
        yield Row(f"mean length over {name}", float(ratio.mean()), mean, "")
        longer = sum(_longer(row) for row, r in zip(found, ratio, strict=True) if r > 1 + 1e-9)
        yield Row(f"longer than {name}, queries", longer, 0, "", f"worst {ratio.max():.5f}")


def optimised() -> Iterator[Row]:
    """Connectors optimised from the shortest CC path, at N = 40."""
    from optplan.connectors.optimised import ATTEMPTS, optimised_connector
    from optplan_models.connector import INTERVALS, optimise

    if not LISTS.is_dir():
        return
    with (LISTS / "cc00.csv").open() as stream:
        listed_rows = {row["id"]: row for row in csv.DictReader(stream)}
    with (LISTS / "best.csv").open() as stream:
        best = list(csv.DictReader(stream))
    chosen = [row for row in best if 1 <= float(row["kappa_max"]) ** 2 / float(row["sigma_max"]) <= 2]
    seconds, missed, failed, worse = [], [], 0, 0
    for row in chosen:
        kappa, sigma = float(row["kappa_max"]), float(row["sigma_max"])
        query = [float(listed_rows[row["id"]][key]) for key in ("x0", "y0", "th0", "x1", "y1", "th1")]
        start, end = np.array([*query[:3], 0.0]), np.array([*query[3:], 0.0])
        known = cc_path(start, end, kappa, sigma)
        pieces = known.curvatures, known.sharpnesses, known.lengths
        turned = start[2] + float((known.lengths * (known.curvatures + known.sharpnesses * known.lengths / 2)).sum())
        goal = np.array([*end[:2], end[2] + 2 * np.pi * round((turned - end[2]) / (2 * np.pi)), 0.0])
        begun = time.process_time()
        found = optimise(start, goal, kappa, sigma, pieces)
        seconds.append(time.process_time() - begun)
        for solver, fineness in ATTEMPTS[1:]:
            if not found.converged:
                found = optimise(start, goal, kappa, sigma, pieces, intervals=fineness * INTERVALS, solver=solver)
        failed += not found.converged
        missed.append(found.missed if found.converged else 0.0)
        curve = optimised_connector(start, end, kappa, sigma).curve
        worse += curve is None or curve.total > 1.002 * float(row["best_known_len"])
    yield Row("optimised, a solve, median", 1e3 * statistics.median(seconds), 5.0, "ms", "fatrop, 40 intervals")
    yield Row("optimised, not feasible from CC starts", 100 * failed / len(chosen), 0.0, "%")
    yield Row("optimised, 0.2 % above the best known, 1 <= q <= 2", 100 * worse / len(chosen), 2.0, "%")
    yield Row("optimised, end missed by at most", max(missed), 1e-6, "m")


def ends(count: int = 3000) -> Iterator[Row]:
    """How far paths end from where they should, and how many of many queries fail."""
    starts, goals = queries(count, 4), queries(count, 5)
    starts[:, 3], goals[:, 3] = (np.random.default_rng(k).uniform(-KAPPA, KAPPA, count) for k in (6, 7))
    missed = 0.0
    for start, end in zip(starts, goals, strict=True):
        made = cc_path(start, end, KAPPA, 1.0)
        reached = Curve(start[:3], made.curvatures, made.sharpnesses, made.lengths).end
        turn = (reached[2] - end[2] + np.pi) % (2 * np.pi) - np.pi
        missed = max(missed, float(np.hypot(*(reached[:2] - end[:2]))), abs(float(turn)))
    yield Row("end of paths missed by at most", missed, 1e-9, "m", "and rad; any end curvature")
    many, others = queries(100_000, 8), queries(100_000, 9)
    bad = int((~np.isfinite(cc_lengths(many, others, KAPPA, 1.0))).sum())
    yield Row("queries of 100 000 that fail", float(bad), 0.0, "")


def main() -> int:
    """Print the table; 0 when every target is met."""
    parts = (lengths(), ends(), speeds(), reversing(), matrices(), optimised())
    return 0 if print_rows(itertools.chain(*parts)) else 1


if __name__ == "__main__":
    sys.exit(main())
