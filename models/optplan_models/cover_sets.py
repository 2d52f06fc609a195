"""Set cover: the fewest candidates that together hold every element.

    min sum_j x_j    with    sum_{j in S_i} x_j >= 1 for every element i,    x binary

S_i are the candidates that hold element i. For circles over a wall elements are faces of the arrangement of all
candidate circles: see docs/maths/facades.md. A. Caprara, P. Toth and M. Fischetti, Algorithms for the set covering
problem, Annals of Operations Research 98 (2000).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pyomo.environ as pyo

Ints = npt.NDArray[np.int64]


def build(holders: list[Ints], candidates: int, weights: npt.NDArray[np.float64] | None = None) -> pyo.ConcreteModel:
    """The model.

    Parameters
    ----------
    holders : for each element the candidates (k,) that hold it, numbered from 0
    candidates : how many there are
    weights : (candidates,) costs >= 0; None: one each

    Raises
    ------
    ValueError : an element that nothing holds
    """
    for element, held in enumerate(holders):
        if len(held) == 0:
            raise ValueError(f"nothing holds element {element}")
    model = pyo.ConcreteModel("set cover")
    model.chosen = pyo.Var(range(candidates), domain=pyo.Binary, initialize=0)
    costs = np.ones(candidates) if weights is None else weights
    model.cost = pyo.Objective(expr=pyo.quicksum(float(costs[j]) * model.chosen[j] for j in range(candidates)))

    def held_once(m: Any, i: int) -> Any:
        return pyo.quicksum(m.chosen[int(j)] for j in holders[i]) >= 1

    model.held = pyo.Constraint(range(len(holders)), rule=held_once)
    return model


def set_chosen(model: pyo.ConcreteModel, chosen: Ints) -> None:
    """Give the variables the values of a choice (k,) of candidates."""
    taken = set(chosen.tolist())
    for j in model.chosen:
        model.chosen[j].set_value(1.0 if j in taken else 0.0)


def chosen_of(model: pyo.ConcreteModel) -> Ints:
    """(k,) the candidates whose variables are 1."""
    return np.array([j for j in model.chosen if pyo.value(model.chosen[j]) > 0.5], dtype=np.int64)
