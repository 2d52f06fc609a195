"""Commands about ordering alone: library instances, comparisons."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from optplan.cli import output

if TYPE_CHECKING:
    from optplan.compare import Result
    from optplan.domain.options import Options
    from optplan.domain.ordering import Ordering


def is_instance(file: Path) -> bool:
    """Whether a file is an ordering instance of a library."""
    from optplan.ordering.tsplib import SUFFIXES

    return file.suffix.lower() in SUFFIXES


def order_instance(file: Path, out: Path | None, options: Options, force: bool, quiet: bool, json: bool) -> None:
    """Solve a library instance, print the answer, and write the tour if a file is given."""
    from optplan.domain.stop import StopRule
    from optplan.ordering import solve
    from optplan.ordering.tsplib import read_tsplib, write_tour
    from optplan.schema.files import refuse_existing

    instance = read_tsplib(file)
    if out is not None:
        refuse_existing(out, force)
    order = options.order
    with output.progress_bar(quiet or json, unit="") as tell, output.cancellable() as wished:
        rule = StopRule(
            seconds=math.inf if order.seconds is None else order.seconds,
            iterations=order.iterations,
            cancelled=lambda: bool(wished),
        )
        answer = solve(instance.problem, order.solver, rule, order.seed, progress=tell)
    tour = instance.tour(answer.nodes) if len(answer.nodes) else []
    if out is not None and tour:
        write_tour(out, tour, instance.name, answer.cost, overwrite=force)
    if json:
        facts = {"instance": instance.name, "class": instance.kind, **ordering_facts(answer), "tour": tour}
        output.print_json(facts)
    else:
        sizes = f"{instance.problem.clusters} clusters, {instance.problem.nodes} nodes"
        print(f"{instance.name}: {instance.kind}, {sizes}")
        _print_answer(answer)
        if out is not None and tour:
            print(f"written: {out}")
    if not tour:
        raise typer.Exit(1)


def ordering_facts(answer: Ordering) -> dict[str, Any]:
    """A solver's answer for machines."""
    return {
        "solver": answer.solver,
        "status": answer.status.value,
        "stopped": answer.stopped.value,
        "cost": output.finite(answer.cost),
        "bound": output.finite(answer.bound),
        "gap": output.finite(answer.gap),
        "seconds": answer.seconds,
        "message": answer.message,
    }


def _print_answer(answer: Ordering) -> None:
    cost = f"{answer.cost:.10g}" if math.isfinite(answer.cost) else "nothing found"
    bound = f", bound {answer.bound:.10g}" if math.isfinite(answer.bound) else ""
    gap = "no bound" if math.isinf(answer.gap) else f"gap {100 * answer.gap:.2f} %"
    print(f"{answer.status.value} by {answer.solver}: {cost}{bound}, {gap}; {answer.stopped.value}")
    if answer.message:
        print(f"  {answer.message}")


def compare_and_print(
    sources: list[str],
    solvers: list[str] | None,
    seeds: list[int] | None,
    budgets: list[str] | None,
    robot: str | None,
    out: Path | None,
    force: bool,
    quiet: bool,
    json: bool,
) -> None:
    """Run a comparison, print its table, and write all runs as CSV if a file is given."""
    from optplan.compare import compare_solvers, csv_text, load_case, summary_rows
    from optplan.compare.tables import COLUMNS
    from optplan.domain.units import duration
    from optplan.schema.files import refuse_existing, write_atomically

    if out is not None:
        refuse_existing(out, force)
    seconds = [duration(text) for text in budgets or ["10s"]]
    cases = [load_case(source, robot) for source in sources]
    results: list[Result] = []
    with output.progress_bar(quiet or json) as tell, output.cancellable() as wished:
        for result in compare_solvers(cases, solvers or ["auto"], seeds or [0], seconds, tell, lambda: bool(wished)):
            results.append(result)
            if out is not None:  # whatever happens later, what was measured is kept
                write_atomically(out, csv_text(results), overwrite=force or len(results) > 1)
    if json:
        output.print_json([_finite_facts(result) for result in results])
    else:
        output.print_table(COLUMNS, summary_rows(results), right=(2, 3, 4, 5, 6, 7), wrap=False)
        for solver, message in dict.fromkeys((r.solver, r.message) for r in results if r.status == "refused"):
            print(f"{solver} refused: {message}")
        if out is not None and results:
            print(f"written: {out}")
    if not all(result.verified for result in results):
        raise typer.Exit(1)


def _finite_facts(result: Result) -> dict[str, Any]:
    return {key: output.finite(v) if isinstance(v, float) else v for key, v in asdict(result).items()}
