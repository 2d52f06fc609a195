"""`auto`: proof where proof is cheap, else the best search plus a bound."""

from __future__ import annotations

import math

from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering.beam import dense, scout
from optplan.ordering.bounds import tree_bound
from optplan.ordering.cuts import prove_by_cuts, refuse_no_form
from optplan.ordering.ideals import prove_by_ideals, refuse_loose_precedence
from optplan.ordering.method import OPTIMAL_GAP, Method, Run
from optplan.ordering.opened import opened
from optplan.ordering.search import search
from optplan.ordering.subsets import MAX_WORK, subset_programme, transitions

BRUTE_SPEED = 3e8
"""Transitions of the subset programme in a second, cautiously."""
SMALL, DIRECTED = 150, 300
"""Up to this many clusters cutting planes often prove the optimum; of directed problems, whose bounds are better,
more than of others."""
CUT_CLUSTERS, CUT_DIRECTED = 500, 1000
"""Up to this many they are worth their time as a bound; directed problems, again, of more."""
PROOF_SECONDS = 10.0
"""For the proof when there is no time limit."""
SHORT, EVEN, LONG = 0.15, 0.5, 0.7
"""Share of the time for the search: before a proof that is likely, one that is not, and when none is tried."""
FIRST_PROOF = 0.25
"""Share of the time left for a proof that another one follows: it ends early, or hardly at all."""
BEFORE_PROOF = 0.03
"""Most seconds a cluster for the search before a proof, however much time there is."""
BOUND_SHARE, FIRST_BOUND = 0.1, 0.02
"""Share of the time for the bound by 1-trees: when it is all there will be, and before a proof."""

BRUTE = Method("brute", "", subset_programme)
IDEALS = Method("dp", "", prove_by_ideals, refuse_loose_precedence)
CUTS = Method("cuts", "", prove_by_cuts, refuse_no_form, closed=True)


def choose_and_solve(run: Run) -> StopReason:
    """Subsets when they are few; else a search, then the proof that suits the problem, or a bound.

    With an iteration limit, which asks for a repeatable answer, the search and the bound by 1-trees alone.
    """
    repeatable = run.rule.iterations is not None
    if not repeatable and _subsets(run.problem) <= min(MAX_WORK, 0.5 * BRUTE_SPEED * run.rule.seconds):
        run.message = f"brute: {run.problem.clusters} clusters are few enough to prove the optimum"
        stop = BRUTE.work(run)
        if run.bound > -math.inf or stop is not StopReason.TIME:
            return stop
    proofs = [] if repeatable else _proofs(run.problem)
    size = f"{run.problem.clusters} clusters"
    run.message = f"search and a bound: {size} are too many to prove the optimum"
    if proofs:
        run.message = f"search, then {' and '.join(proof.name for proof in proofs)} to prove it: {size}"
    if IDEALS in proofs:
        scout(run, SHORT)
    share = LONG if not proofs else SHORT if run.problem.clusters <= _small(run.problem) or IDEALS in proofs else EVEN
    stop = _searched(run, share, BEFORE_PROOF * run.problem.clusters if proofs else math.inf)
    if ended := _over(run, stop):
        return ended
    bound_share = FIRST_BOUND if proofs else BOUND_SHARE
    run.prove(tree_bound(run.problem, StopRule(bound_share * run.rule.seconds, cancelled=run.rule.cancelled)))
    for number, proof in enumerate(proofs):
        if ended := _over(run, stop):
            return ended
        stop = _proved(run, proof, FIRST_PROOF if number + 1 < len(proofs) else 1.0)
    if ended := _over(run, stop):
        return ended
    if math.isfinite(run.rule.seconds):
        run.seed += 1
        return _searched(run, 1.0)  # what is left of the time
    if proofs:
        run.message += f"; not proved in the {PROOF_SECONDS:g} s that a proof has without a time limit"
    return StopReason.FINISHED


def _subsets(problem: OrderingProblem) -> float:
    """Work of the programme over subsets."""
    paths = [way.problem for way in opened(problem)] if problem.closed else [problem]
    return sum(transitions(path) for path in paths)


def _proofs(problem: OrderingProblem) -> list[Method]:
    """Proofs worth trying, the more hopeful first."""
    found = []
    count = problem.clusters
    if dense(problem) and IDEALS.refusal(problem) is None:
        found.append(IDEALS)
    if count <= _most(problem) and CUTS.refusal(problem) is None:
        found.append(CUTS)
    return found


def _small(problem: OrderingProblem) -> int:
    from optplan.ordering.cutting.undirected import undirected_form

    return SMALL if undirected_form(problem) is not None else DIRECTED


def _most(problem: OrderingProblem) -> int:
    from optplan.ordering.cutting.undirected import undirected_form

    return CUT_CLUSTERS if undirected_form(problem) is not None else CUT_DIRECTED


def _over(run: Run, stop: StopReason) -> StopReason | None:
    """Why to end here: nothing is left to prove, or the limits say so."""
    if stop in (StopReason.CANCELLED, StopReason.TARGET):
        return stop
    if run.cost - run.bound <= OPTIMAL_GAP * max(abs(run.cost), 1e-9) or run.bound == math.inf:
        return StopReason.FINISHED
    return run.stop()


def _searched(run: Run, share: float, most: float = math.inf) -> StopReason:
    """Search for a share of the time left, or for so many seconds when there is no limit to share."""
    timed = math.isfinite(run.rule.seconds)
    part = run.within(min(share * run.clock.remaining, most) if timed else math.inf, run.rule.iterations)
    stop = search(part)
    run.adopt(part)
    return stop


def _proved(run: Run, proof: Method, share: float) -> StopReason:
    """Try a proof for a share of the time left, or a while when there is no limit."""
    unlimited = math.isinf(run.rule.seconds)
    part = run.within(PROOF_SECONDS if unlimited else share * run.clock.remaining)
    part.nodes, part.cost = run.nodes, run.cost
    stop = proof.work(part)
    part.iterations = 0
    run.adopt(part)
    if stop is StopReason.FAILED:
        run.message = f"{proof.name}: {part.message}"
    return stop
