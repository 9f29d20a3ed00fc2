"""The function `design`, which searches the free values of a scene for a goal.

A goal is the smallest, the largest or a stated value of a measure of the motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from softcradle.physics.checked_input import finite_or_none, shown
from softcradle.physics.ensemble_runs import in_threads, threads_of
from softcradle.sandbox.motion import Array
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.studies.fitting.goals import MOST, Goal, goals_of
from softcradle.sandbox.studies.fitting.parameters import FreeValue, FreeValues, scene_values
from softcradle.sandbox.sweeps.measure_table import Run, ends_of
from softcradle.sandbox.sweeps.scene_points import ScenePoints, changed
from softcradle.sandbox.user_error import StudyError
from softcradle.scenes import Scene
from softcradle.scenes.scene_errors import SceneError

Progress = Callable[[str, int, int], None]

# Value of a goal for a scene that cannot be computed. This value is larger than any measure.
IMPOSSIBLE = 1e30
# Members of a generation for each free value, and the smallest and largest size of a generation. SciPy's default is 15
# members for each value.
MEMBERS, FEWEST_MEMBERS, MOST_MEMBERS = 8, 16, 64
# Largest number of generations of the global search.
GENERATIONS = 60
# The global search ends if the spread of the goal over a generation, relative to its mean, is below this value.
CONVERGED = 1e-4
# Largest number of evaluations for each free value in the simplex search that refines the best member.
REFINEMENTS = 60
# Number of starts of a search for stated values, if the first start does not reach them.
STARTS = 8
# A stated value counts as reached if the remaining difference, relative to the value, is at most this number.
REACHED = 1e-6
# Step of a coordinate for finite differences. This step is used for goals with a stated value.
STEP = 1e-4


@dataclass(frozen=True, eq=False)
class SceneDesign:
    """Result of :func:`design`.

    Attributes
    ----------
    scene : Scene
        Scene with the found values.
    goals : tuple of Goal
        The goals.
    free : tuple of FreeValue
        The free values with their bounds.
    values, errors : ndarray, shape (p,)
        Found values and their errors. The errors follow from the stated ranges of the goals; NaN without ranges.
    before, reached : ndarray, shape (G,)
        Measures of the goals, first with the values of the scene, then with the found values.
    uniform : float
        Best measure if all items of each list ``[:]`` have one common value; NaN without such a list.
    statements : tuple of str
        Sentences about the result.
    evaluations : int
        Number of computed motions.
    """

    scene: Scene
    goals: tuple[Goal, ...]
    free: tuple[FreeValue, ...]
    values: Array
    errors: Array
    before: Array
    reached: Array
    uniform: float
    statements: tuple[str, ...]
    evaluations: int

    @property
    def factor(self) -> float:
        """Ratio by which the design is better than the best uniform values; NaN without uniform values."""
        worse, better = self.uniform, float(self.reached[0])
        return worse / better if self.goals[0].sense != MOST else better / worse

    def numbers(self) -> dict[str, Any]:
        """Return the numbers of the design for a JSON file."""
        from softcradle.physics.trajectory_file import versions

        return {
            "title": self.scene.title,
            "goals": [
                {"goal": goal.text, "unit": goal.unit, "before": finite_or_none(one), "reached": finite_or_none(two)}
                for goal, one, two in zip(self.goals, self.before.tolist(), self.reached.tolist(), strict=True)
            ],
            "values": {
                one.name: {"value": value, "error": finite_or_none(error), "bounds": [one.low, one.high]}
                for one, value, error in zip(self.free, self.values.tolist(), self.errors.tolist(), strict=True)
            },
            "best uniform values": finite_or_none(self.uniform),
            "factor over them": finite_or_none(self.factor),
            "statements": list(self.statements),
            "evaluations": self.evaluations,
            "versions": versions(),
        }


def design(
    scene: Scene | str,
    goal: str | Sequence[str],
    free: Sequence[str],
    *,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress | None = None,
) -> SceneDesign:
    """Search the free values of a scene for which its motion reaches a goal.

    A goal with ``least`` or ``most`` is searched globally by SciPy's differential evolution, and the best member is refined by
    a simplex search. Generations are computed with `ensemble_ends` if the goal depends only on the ends of the runs. Goals with
    stated values are reached by least squares.

    Parameters
    ----------
    scene : Scene or str
        Scene, or its name or path.
    goal : str or sequence of str
        A goal is ``least`` or ``most`` and a measure, such as ``least peak force``. The default is ``most``. Several goals are
        measures with stated values or ranges, such as ``missing momentum = 0.05..0.1``. ``of bead K`` and ``of contact K``
        choose one bead or contact. Without a choice, the worst contact counts. ``lane K`` before the measure chooses the
        lane.
    free : sequence of str
        Free values as for :func:`softcradle.fit`, with bounds: ``lanes.0.contact[:].stiffness=10..500``.
    seed : int, optional
        Seed of the search.
    workers : int, optional
        Number of threads; None means one for each core.
    progress : callable, optional
        Called with a text, the number of finished generations, and the largest number of generations.

    Returns
    -------
    SceneDesign
        Scene with the found values, and the measures that they reach.

    Raises
    ------
    ValueError
        If a goal or a path is not known, or if bounds are missing. The error is a StudyError.

    Examples
    --------
    Find the mass of the middle ball with which the last ball gets the most momentum. It is the geometric mean of the others:

    >>> from softcradle import Chain, hertz, scenes
    >>> from softcradle.sandbox.studies.fitting.design_scene import design
    >>> lane = scenes.Lane.of(Chain([4.0, 1.0, 1.0], hertz(1e3), gap=[0.0, 0.1]), [1.0, 0.0, 0.0])
    >>> found = design(scenes.Scene(title="three balls", lanes=[lane]), "momentum of bead 2", ["lanes.0.mass[1]=0.5..5"])
    >>> found.values.round(2)
    array([2.])
    """
    if isinstance(scene, str):
        scene = load_scene(scene)
    if isinstance(free, str) or not free:
        raise StudyError(f"free must be a list of at least one path, not {shown(free)}")
    goals = goals_of([goal] if isinstance(goal, str) else list(goal), scene.lanes)
    lane = goals[0].lane
    values = scene_values(scene, free, lane, scene.duration or 1.0)
    search = _Search(FreeValues(ScenePoints(scene), tuple(values)), goals, threads_of(workers), seed)
    tell = progress or (lambda what, done, count: None)
    first = np.array([one.inner(one.value) for one in values])
    before = search.measures(first[None, :])[0]
    if goals[0].sense:
        return _best(scene, search, free, before, tell)
    return _reached(scene, search, before, first)


@dataclass
class _Search:
    """Computation of the goals' measures for coordinates of the free values."""

    free: FreeValues
    goals: Sequence[Goal]
    threads: int
    seed: int
    evaluations: int = 0
    reason: str = ""

    def measures(self, coordinates: Array) -> Array:
        """Return the (S, G) measures at the coordinates (S, p). A measure is NaN if its scene cannot be computed."""
        found = np.full((len(coordinates), len(self.goals)), math.nan)
        starts: dict[int, Any] = {}
        for k, z in enumerate(coordinates):
            try:
                starts[k] = self.free.points.starts(self.free.of_scene(self.free.outer(z)))
            except (ValueError, SceneError) as error:
                self.reason = self.reason or str(error)
        self.evaluations += len(starts)
        rows = list(starts)
        if rows and all(goal.of_ends for goal in self.goals) and self._by_ends(rows, starts, found):
            return found

        def one(k: int) -> None:
            for g, goal in enumerate(self.goals):
                found[k, g] = self._value(goal, Run(starts[k][goal.lane]))

        for _ in in_threads(one, rows, self.threads):
            pass
        return found

    def _by_ends(self, rows: Sequence[int], starts: dict[int, Any], found: Array) -> bool:
        """Compute all simulations with `ensemble_ends`. Return False if they must be computed one by one."""
        for g, goal in enumerate(self.goals):
            own = [starts[k][goal.lane] for k in rows]
            try:
                ends = ends_of(own, self.threads)
            except ValueError:
                return False
            for k, start, end in zip(rows, own, ends, strict=True):
                found[k, g] = self._value(goal, Run(start, end))
        return True

    def _value(self, goal: Goal, run: Run) -> float:
        try:
            value = goal.value(run)
        except ValueError as error:
            self.reason = self.reason or str(error)
            return math.nan
        return math.nan if run.status.gave_up else value

    def cost(self, coordinates: Array) -> Array:
        """Return the cost that the search minimises, at the coordinates (S, p)."""
        found = self.measures(coordinates)[:, 0]
        signed = -found if self.goals[0].sense == MOST else found
        return np.where(np.isfinite(signed), signed, IMPOSSIBLE)

    def residuals(self, z: Array) -> Array:
        """Return the differences between measures and stated values, in units of the stated ranges."""
        return (self.measures(z[None, :])[0] - [goal.target for goal in self.goals]) / self.sizes

    @property
    def sizes(self) -> Array:
        return np.array([goal.error or abs(goal.target) or 1.0 for goal in self.goals])

    def global_minimum(
        self, bounds: Sequence[tuple[float, float]], spread: Callable[[Array], Array], tell: Progress, name: str
    ) -> Array:
        """Return the best coordinates within `bounds`.

        The function `spread` maps (S, q) searched coordinates to (S, p) coordinates.
        """
        from scipy.optimize import differential_evolution, minimize

        q = len(bounds)
        members = int(np.clip(MEMBERS * q, FEWEST_MEMBERS, MOST_MEMBERS))
        done = [0]

        def after(*_: object, **__: object) -> None:
            done[0] += 1
            tell(name, done[0], GENERATIONS)

        found = differential_evolution(
            lambda x: self.cost(spread(x.T)), list(bounds), popsize=max(1, members // q), maxiter=GENERATIONS, tol=CONVERGED,
            rng=self.seed, polish=False, updating="deferred", vectorized=True, callback=lambda *_, **__: after(),
        )  # fmt: skip
        finer = minimize(
            lambda x: float(self.cost(spread(x[None, :]))[0]), found.x, method="Nelder-Mead", bounds=list(bounds),
            options={"maxfev": REFINEMENTS * q, "xatol": 1e-5, "fatol": 1e-10 * abs(float(found.fun))},
        )  # fmt: skip
        return np.asarray(finer.x if finer.fun <= found.fun else found.x)


def _best(scene: Scene, search: _Search, free: Sequence[str], before: Array, tell: Progress) -> SceneDesign:
    """Return the design with the least or largest measure.

    The result is compared with the best uniform values.
    """
    values = search.free.values
    bounds = []
    for one in values:
        low, high = one.bounds
        if not (one.given and math.isfinite(high - low)):
            raise StudyError(f"{one.path}: a design needs bounds, such as --free '{one.path}=LOW..HIGH'")
        bounds.append((low, high))
    best = search.global_minimum(bounds, lambda x: x, tell, "generations")
    uniform, common = math.nan, _groups(scene, free)
    if max(common, default=0) + 1 < len(values):
        tied = [bounds[common.index(group)] for group in range(max(common) + 1)]
        same = search.global_minimum(tied, lambda x: x[:, common], tell, "generations of uniform values")
        spread_out = same[common]
        uniform = float(search.measures(spread_out[None, :])[0, 0])
        if search.cost(spread_out[None, :])[0] < search.cost(best[None, :])[0]:
            best = spread_out
    reached = search.measures(best[None, :])[0]
    if not np.isfinite(reached).all():
        raise StudyError(
            f"no values within the bounds give the goal {search.goals[0].text!r}: {search.reason or 'NaN'}"
        )
    found = search.free.outer(best)
    rounded = [float(f"{value:.6g}") for value in found]
    goal = search.goals[0]
    statements = [
        f"{goal.text}: {reached[0]:.6g} {goal.unit}, with the values of the scene {before[0]:.6g} {goal.unit}"
    ]
    if math.isfinite(uniform):
        ratio = uniform / reached[0] if goal.sense != MOST else reached[0] / uniform
        statements.append(
            f"the best uniform values reach {uniform:.6g} {goal.unit}: the design is better by a factor of {ratio:.4g}"
        )
    statements += [
        f"{one.name} is at its bound {value:.6g}"
        for one, value, z in zip(values, found, best, strict=True)
        if min(z - one.bounds[0], one.bounds[1] - z) <= 1e-3 * (one.bounds[1] - one.bounds[0])
    ]
    return SceneDesign(
        changed(scene, search.free.of_scene(rounded)), tuple(search.goals), values, np.array(found),
        np.full(len(values), math.nan), before, reached, uniform, tuple(statements), search.evaluations,
    )  # fmt: skip


def _groups(scene: Scene, free: Sequence[str]) -> list[int]:
    """Return one number for each free value: the index of the text in `free` that names it."""
    found = list[int]()
    for number, text in enumerate(free):
        count = len(scene_values(scene, [text], 0, 1.0))
        found += [number] * count
    return found


def _reached(scene: Scene, search: _Search, before: Array, first: Array) -> SceneDesign:
    """Return the design whose measures have the stated values. The errors of the design follow from the stated ranges."""
    from scipy.optimize import least_squares
    from scipy.stats import qmc

    values, goals = search.free.values, search.goals
    if len(values) > len(goals):
        raise StudyError(f"{len(values)} free values need as many goals with stated values, not {len(goals)}")
    low, high = np.array([one.bounds for one in values]).T

    def residuals(z: Array) -> Array:
        return np.nan_to_num(search.residuals(z), nan=1e3)

    def jacobian(z: Array) -> Array:
        columns = []
        for k in range(len(values)):
            up, down = z.copy(), z.copy()
            up[k], down[k] = min(z[k] + STEP, high[k]), max(z[k] - STEP, low[k])
            columns.append((residuals(up) - residuals(down)) / (up[k] - down[k]))
        return np.stack(columns, axis=1)

    begins = [first]
    if np.isfinite(high - low).all():
        draws = qmc.Sobol(len(values), seed=search.seed).random_base2(int(math.log2(STARTS)))
        begins += list(low + draws * (high - low))
    found = None
    for z in begins:
        inside = np.array([one.inside(float(at)) for one, at in zip(values, z, strict=True)])
        one = least_squares(
            residuals, inside, jacobian, (low, high), "trf", xtol=1e-14, ftol=1e-14, gtol=1e-14, x_scale="jac"
        )
        found = one if found is None or one.cost < found.cost else found
        if np.abs(found.fun).max() <= REACHED:
            break
    assert found is not None
    reached = search.measures(found.x[None, :])[0]
    if not np.isfinite(reached).all():
        raise StudyError(f"no tried values give the goal {goals[0].text!r}: {search.reason or 'NaN'}")
    errors = np.full(len(values), math.nan)
    if all(goal.error for goal in goals):
        slopes = np.array([one.slope(one.outer(float(z))) for one, z in zip(values, found.x, strict=True)])
        errors = slopes * np.sqrt(np.diag(np.linalg.pinv(found.jac.T @ found.jac)))
    statements = []
    for goal, value in zip(goals, reached.tolist(), strict=True):
        near = abs(value - goal.target) <= (goal.error or REACHED * (abs(goal.target) or 1.0)) * (1.0 + REACHED)
        statements.append(f"{goal.text}: {value:.6g} {goal.unit}".rstrip() + ("" if near else ", not reached"))
    outer = np.array(search.free.outer(found.x))
    return SceneDesign(
        changed(scene, search.free.of_scene(outer.tolist())), tuple(goals), values, outer, errors, before, reached, math.nan,
        tuple(statements), search.evaluations,
    )  # fmt: skip
