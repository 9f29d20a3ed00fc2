"""The function `fit`, which fits a scene to measured positions, velocities or forces by least squares."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.checked_input import shown
from softcradle.sandbox.measured_table import FORCE, POSITION, MeasuredTable
from softcradle.sandbox.motion import Array
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.studies.fitting.determined import determine, not_random
from softcradle.sandbox.studies.fitting.motion_model import MotionModel, starts_freely
from softcradle.sandbox.studies.fitting.observations import UNIT_OF, Observation, observations, table_from
from softcradle.sandbox.studies.fitting.parameters import OFFSET, START, FreeValue, FreeValues, parse, scene_values
from softcradle.sandbox.sweeps.scene_points import ScenePoints, changed
from softcradle.sandbox.user_error import StudyError
from softcradle.scenes import Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Progress = Callable[[str, int, int], None]

# Step of the central differences in a coordinate. Simulations have errors of 1e-10. These errors divided by the step
# are small, and so is the square of the step.
STEP = 1e-4
# Largest number of iterations of a local search, first while starts are compared, then for the result.
ITERATIONS_OF_A_START, ITERATIONS = 15, 100
# A local search ends if the relative changes of the sum of squares and of the coordinates are below this limit.
CONVERGED = 1e-10
# Number of starts of an automatic search whose sums of squares are compared, and number of local searches from the best
# starts.
SCREENED, SEARCHED = 48, 4
# Number of rows of the data that are used while starts are compared and local searches are made.
SEARCH_ROWS = 250
# Number of rounds in which the noise of several quantities is estimated from their residuals.
ROUNDS = 3
# Half width of the range of starts around the value of the scene, in coordinates. For positive values it is a factor e
# in both directions.
AROUND = 1.0
# Number of significant digits of the error bar to which a fitted value is rounded.
DIGITS_OF_ERROR = 4
# Weighted residual for values with which the scene cannot be computed.
IMPOSSIBLE = 1e6
# Smallest number of data points for each free value.
FEWEST_DATA = 2
# A free offset is suggested if the mean residual of a column exceeds this fraction of the range of its data.
OFF = 0.2


@dataclass(frozen=True, eq=False)
class SceneFit:
    """Result of :func:`fit`.

    Attributes
    ----------
    scene : Scene
        Scene with the fitted values.
    names : tuple of str
        Names of the p free values: paths in the scene, ``start``, and ``offset of`` a column.
    values, errors : ndarray, shape (p,)
        Fitted values and their standard deviations; inf if undetermined, NaN for a value on a bound.
    correlation : ndarray, shape (p, p)
        Correlations of the fitted values; NaN for values without an error bar.
    determined : ndarray of bool, shape (p,)
        False for values that the data do not determine.
    statements : tuple of str
        Sentences about what the data cannot determine, and about the quality of the fit.
    restitution : dict of str to (float, float)
        Coefficient of restitution and its error bar, for each free loss.
    noise : dict of str to float
        Standard deviation of the residuals of each quantity [m, m/s or N].
    time : ndarray, shape (T,)
        Times of the data [s].
    observed : tuple of Observation
        Columns that were fitted.
    residuals : tuple of ndarray, shape (T,)
        Data minus fit of each column; NaN without a datum.
    singular_values : ndarray
        Singular values of the Jacobian with columns of norm 1. A small singular value means a poorly determined combination.
    starts : int
        Number of local searches.
    runs : int
        Number of simulations of the scene.
    """

    scene: Scene
    names: tuple[str, ...]
    values: Array
    errors: Array
    correlation: Array
    determined: NDArray[np.bool_]
    statements: tuple[str, ...]
    restitution: Mapping[str, tuple[float, float]]
    noise: Mapping[str, float]
    time: Array
    observed: tuple[Observation, ...]
    residuals: tuple[Array, ...]
    singular_values: Array
    starts: int
    runs: int
    free: tuple[FreeValue, ...]
    lane: int
    table: MeasuredTable

    def plot(self) -> Figure:
        """Return a figure with data, fit and residuals. The figure requires the optional dependencies [figures]."""
        from softcradle.sandbox.studies.fitting.fit_figure import draw_fit

        return draw_fit(self)

    def __repr__(self) -> str:
        parts = [
            f"{name} = {shown_value(value, error)}"
            for name, value, error in zip(self.names, self.values.tolist(), self.errors.tolist(), strict=True)
        ]
        return f"SceneFit({self.scene.title!r}, {', '.join(parts)})"


def shown_value(value: float, error: float) -> str:
    """Return a value with its error bar as text, with two digits of the error."""
    if not math.isfinite(error) or error <= 0.0:
        return f"{value:.6g}"
    digits = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{digits}f} ± {error:.{digits}f}" if digits < 12 else f"{value:.6g} ± {error:.2g}"


def fit(
    scene: Scene | str,
    data: Any,
    free: Sequence[str],
    *,
    lane: int = 0,
    quantities: Sequence[str] = (),
    columns: Mapping[str, str] | None = None,
    between: tuple[float, float] | None = None,
    window: float | None = None,
    starts: int | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> SceneFit:
    """Fit free values of a scene to measured positions, velocities or forces by least squares.

    The residuals are differences between the data and a simulation at the times of the data. SciPy's trust-region
    method minimises the sum of their squares within the bounds. Each quantity is weighted by its own noise, which is
    estimated from the residuals. The error bars are standard deviations by linear error propagation.

    Parameters
    ----------
    scene : Scene or str
        Scene, or its name or path. Its values are the start of the search.
    data : path, mapping or MeasuredTable
        Table of measurements: a file as other programs export them, or a mapping (or data frame) from names such as
        ``time``, ``velocity 0`` and ``left glider x (mm)`` to arrays; SI units without a unit in the name.
    free : sequence of str
        Free values: paths of numbers in the scene such as ``lanes.0.contact.loss`` or ``lanes.0.mass[1]``. ``[*]`` stands for
        all items of a list with one common value, ``[:]`` for all items with separate values. ``=LOW..HIGH`` after a path
        gives bounds. ``start`` frees the time of the data at which the scene begins. ``offset`` frees the origin of each
        column of positions. Before the start of the scene, its beads move with constant velocities.
    lane : int, optional
        Lane to which the data belong.
    quantities : sequence of str, optional
        Quantities that are used: position, velocity, force. The default is forces, and positions or else velocities.
    columns : dict, optional
        Meaning of columns whose names do not show it, such as ``{"marker 7 X": "position 0"}``.
    between : (float, float), optional
        First and last time [s] of the data that are used.
    window : float, optional
        Use only data within this time [s] of the first collision, which is located by a first fit of all data.
    starts : int, optional
        Number of local searches from different starts. By default, more than one search is made only if the residuals of
        the first search are not random.
    seed : int, optional
        Seed of the starts.
    progress : callable, optional
        Called with a text, the number of finished starts, and the number of all starts.

    Returns
    -------
    SceneFit
        Scene with the fitted values, error bars, correlations, and statements about what the data cannot determine.

    Raises
    ------
    ValueError
        If a path does not name a number of the scene, or if bounds or columns do not fit. The error is a StudyError.
    UserError
        If the file cannot be read.

    Examples
    --------
    >>> import numpy as np
    >>> from softcradle import fit, hertz, one_on, scenes, simulate
    >>> truth = simulate(one_on(1, hertz(100.0, loss=0.36), mass=[0.2, 0.3]), [1.0, 0.0], 0.5)
    >>> noise = 0.002 * np.random.default_rng(1).normal(size=truth.velocity.shape)
    >>> data = {"time": truth.time, "v0": truth.velocity[:, 0] + noise[:, 0], "v1": truth.velocity[:, 1] + noise[:, 1]}
    >>> lane = scenes.Lane.of(one_on(1, hertz(100.0, loss=0.1), mass=[0.2, 0.2]), [1.0, 0.0])
    >>> found = fit(scenes.Scene(title="two balls", lanes=[lane]), data, ["lanes.0.contact.loss", "lanes.0.mass[1]"])
    >>> found.values.round(2), bool(found.determined.all())
    (array([0.36, 0.3 ]), True)
    """
    if isinstance(scene, str):
        scene = load_scene(scene)
    if not 0 <= lane < len(scene.lanes):
        raise StudyError(f"lane must be from 0 to {len(scene.lanes) - 1}, not {lane}")
    if isinstance(free, str) or not free:
        raise StudyError(f"free must be a list of at least one path, not {shown(free)}")
    if starts is not None and starts < 1:
        raise StudyError(f"starts must be at least 1, not {starts}")
    table = table_from(data)
    if between is not None:
        table = _cut(table, *between)
    tell = progress or (lambda what, done, count: None)
    if window is not None and not (math.isfinite(window) and window > 0.0):
        raise StudyError(f"window must be a time > 0, not {window:g}")

    def problem_of(rows: MeasuredTable) -> _Problem:
        return _Problem.of(scene, rows, free, lane, quantities, columns)

    coarse = problem_of(_thinned(table, problem_of(table)))
    found = coarse.solved(starts, seed, tell)
    values = coarse.model.free.outer(found.z)
    if window is not None:
        at = coarse.first_hit(found.z)
        table = _cut(table, at - window, at + window)
    if table.time.size > coarse.model.time.size or window is not None:
        coarse = problem_of(table)
        found = replace(coarse.refined(values), starts=found.starts)
    return coarse.result(found, table)


def _thinned(table: MeasuredTable, problem: _Problem) -> MeasuredTable:
    """Return evenly spaced rows of the table. These rows are sufficient for the search of a minimum."""
    fewest = max(SEARCH_ROWS, 8 * len(problem.free))
    if table.time.size <= 2 * fewest:
        return table
    rows = np.unique(np.linspace(0, table.time.size - 1, fewest).round().astype(int))
    columns = tuple(replace(one, values=one.values[rows]) for one in table.columns)
    return MeasuredTable(table.name, table.time[rows], columns)


def _cut(table: MeasuredTable, begin: float, end: float) -> MeasuredTable:
    """Return the rows of the table from `begin` to `end` [s]. Raise StudyError if there are fewer than two."""
    kept = (table.time >= begin) & (table.time <= end)
    if kept.sum() < 2:
        span = f"{table.time[0]:.6g} to {table.time[-1]:.6g} s"
        raise StudyError(f"{table.name}: no data from {begin:.6g} to {end:.6g} s; its times are {span}")
    columns = tuple(replace(one, values=one.values[kept]) for one in table.columns)
    return MeasuredTable(table.name, table.time[kept], columns)


@dataclass(frozen=True)
class _Found:
    """Local minimum with its coordinates, sum of squares, Jacobian, and number of local searches."""

    z: Array
    cost: float
    jacobian: Array
    starts: int


@dataclass
class _Problem:
    """Weighted least-squares problem whose unknowns are the coordinates of the free values."""

    scene: Scene
    model: MotionModel
    weight: Array  # (N,) Each weight is 1 divided by the noise of the data point.
    # Reason why the scene could not be computed, for the first values with which it failed.
    reason: str = ""

    @classmethod
    def of(
        cls,
        scene: Scene,
        table: MeasuredTable,
        free: Sequence[str],
        lane: int,
        quantities: Sequence[str],
        columns: Mapping[str, str] | None,
    ) -> _Problem:
        """Return the least-squares problem for the data.

        Raise StudyError if free values, columns and data do not fit together.
        """
        chain = scene.lanes[lane].chain()
        observed = observations(table, chain, quantities, columns)
        duration = float(table.time[-1] - table.time[0])
        values = scene_values(scene, free, lane, duration)
        values += _of_data(free, table, observed, starts_freely(chain))
        points = ScenePoints(scene)
        model = MotionModel(FreeValues(points, tuple(values)), lane, table.time, observed)
        if model.data.size < FEWEST_DATA * len(values):
            needed = FEWEST_DATA * len(values)
            raise StudyError(
                f"{table.name}: {len(values)} free values need at least {needed} data, not {model.data.size}"
            )
        # Before residuals are known, a quantity is weighted by the spread of its data.
        weight = np.ones(model.data.size)
        for rows in _groups(model).values():
            weight[rows] = 1.0 / (float(np.std(model.data[rows])) or 1.0)
        return cls(scene, model, weight)

    @property
    def free(self) -> tuple[FreeValue, ...]:
        return self.model.free.values

    def residuals(self, z: Array) -> Array:
        """Return the weighted residuals at the coordinates `z`. The residuals are large if the scene cannot be
        computed.
        """
        try:
            predicted = self.model.predicted(self.model.free.outer(z))
        except ValueError as error:
            if not self.reason:
                self.reason = str(error)
            return np.full(self.model.data.size, IMPOSSIBLE)
        found = self.weight * (predicted - self.model.data)
        return np.where(np.isfinite(found), found, IMPOSSIBLE)

    def jacobian(self, z: Array) -> Array:
        """Return the (N, p) central differences of the residuals. The difference is one-sided at a bound.

        A force jumps when a contact with preload closes. A difference across a jump is not a derivative, and is set to
        0.
        """
        columns, middle = [], self.residuals(z) if self._jumps.any() else np.zeros(0)
        for k, one in enumerate(self.free):
            low, high = one.bounds
            up, down = z.copy(), z.copy()
            up[k], down[k] = min(z[k] + STEP, high), max(z[k] - STEP, low)
            above, below = self.residuals(up), self.residuals(down)
            column = (above - below) / (up[k] - down[k])
            if middle.size and up[k] > z[k] > down[k]:
                right, left = (above - middle) / (up[k] - z[k]), (middle - below) / (z[k] - down[k])
                column[self._jumps & (np.abs(right - left) > np.abs(right + left))] = 0.0
            columns.append(column)
        return np.stack(columns, axis=1)

    @property
    def _jumps(self) -> NDArray[np.bool_]:
        """Return (N,) True for data that can jump in time, which are the forces."""
        return np.array([self.model.observed[k].quantity == FORCE for k in self.model.which.tolist()])

    def local(self, z: Array, iterations: int) -> _Found:
        """Return the minimum that a local search finds when it starts at `z`."""
        from scipy.optimize import least_squares

        inside = np.array([one.inside(float(at)) for one, at in zip(self.free, z, strict=True)])
        bounds = np.array([one.bounds for one in self.free]).T
        found = least_squares(
            self.residuals, inside, self.jacobian, (bounds[0], bounds[1]), "trf", ftol=CONVERGED, xtol=CONVERGED,
            gtol=CONVERGED, x_scale="jac", max_nfev=iterations,
        )  # fmt: skip
        return _Found(found.x, 2.0 * float(found.cost), found.jac, 1)

    def refined(self, values: Sequence[float]) -> _Found:
        """Return the minimum near `values`, which a search with fewer data has found."""
        z = np.array([one.inner(at) for one, at in zip(self.free, values, strict=True)])
        return self._weighted(self.local(z, ITERATIONS))

    def solved(self, starts: int | None, seed: int, tell: Progress) -> _Found:
        """Return the best minimum of all local searches.

        The first search starts at the values of the scene. Other starts follow if they are needed.
        """
        wanted = 1 if starts is None else starts
        first = np.array([one.inner(one.value) for one in self.free])
        tell("starts", 0, wanted)
        best = self._weighted(self.local(first, ITERATIONS))
        tell("starts", 1, wanted)
        if starts is None and not_random(self.residuals(best.z), self.model.which):
            wanted = 1 + SEARCHED
        candidates = self._screened(seed, wanted - 1, best.z) if wanted > 1 else []
        for k, z in enumerate(candidates):
            other = self.local(z, ITERATIONS_OF_A_START)
            best = other if other.cost < best.cost else best
            tell("starts", k + 2, wanted)
        if candidates:
            again = self.local(best.z, ITERATIONS)
            best = again if again.cost <= best.cost else best
        if best.cost >= 0.5 * IMPOSSIBLE**2:
            raise StudyError(f"the scene cannot be computed with any of the tried values: {self.reason}")
        best = self._weighted(best)
        return replace(best, starts=1 + len(candidates))

    def _weighted(self, found: _Found) -> _Found:
        """Return the minimum after each quantity was weighted by the noise of its residuals."""
        groups = _groups(self.model)
        if len(groups) == 1:
            return found
        for _ in range(ROUNDS):
            error = self.residuals(found.z) / self.weight
            share = 1.0 - len(self.free) / error.size
            for rows in groups.values():
                spread = math.sqrt(float(np.mean(error[rows] ** 2)) / share)
                self.weight[rows] = 1.0 / max(spread, 1e-12 * float(np.abs(self.model.data[rows]).max(initial=1e-30)))
            found = self.local(found.z, ITERATIONS)
        return found

    def _screened(self, seed: int, count: int, best: Array) -> list[Array]:
        """Return the `count` most promising of many starts.

        The starts lie around the values of the scene. Most of them take their velocities from the data.
        """
        from scipy.stats import qmc

        free, model = self.free, self.model
        box = np.array([self._span(one) for one in free])
        total = max(SCREENED, 8 * count)
        draws = qmc.Sobol(len(free), seed=seed).random_base2(math.ceil(math.log2(total)))
        paths = _velocity_paths(self.scene, model.lane)
        tried = list[tuple[float, int, Array]]()
        for k, draw in enumerate([*draws]):
            z = box[:, 0] + draw * (box[:, 1] - box[:, 0])
            values = model.free.outer(z)
            # Most starts take the velocities from the data. The other starts keep their random velocities, in case the
            # data mislead.
            if k % 4:
                values = model.with_slopes(values, paths)
            try:
                predicted = model.predicted(values)
            except ValueError:
                continue
            values, predicted = model.with_offsets(values, predicted)
            error = self.weight * (predicted - model.data)
            if np.isfinite(error).all():
                z = np.array([one.inner(value) for one, value in zip(free, values, strict=True)])
                tried.append((float(error @ error), k, z))
        tried.sort(key=lambda one: one[:2])
        return [z for _, _, z in tried[:count]]

    @staticmethod
    def _span(one: FreeValue) -> tuple[float, float]:
        """Return the range of a coordinate in which the starts lie."""
        low, high = one.bounds
        if one.given and math.isfinite(high - low):
            return low, high
        middle = one.inner(one.value)
        if one.path == START:
            return low, high
        return max(low, middle - AROUND), min(high, middle + AROUND)

    def first_hit(self, z: Array) -> float:
        """Return the time of the first collision in the fit, on the time axis of the data [s].

        Raise StudyError if no contact closes.
        """
        values = self.model.free.outer(z)
        run, _ = self.model.motion(values)
        begins = [spans[0][0] for spans in run.contact_intervals if spans]
        if not begins:
            raise StudyError("the fitted motion has no hit, so window cannot be used; use between (--from, --to)")
        return min(begins) + self.model.start_time(values)

    def result(self, found: _Found, table: MeasuredTable) -> SceneFit:
        """Return the result of the fit in the form that users get."""
        model, free = self.model, self.free
        residuals = self.residuals(found.z)
        degrees = max(residuals.size - len(free), 1)
        variance = float(residuals @ residuals) / degrees
        values = np.array(model.free.outer(found.z))
        floor = self._floor()
        parts = determine(free, found.z, self.jacobian(found.z), variance, floor)
        slopes = np.array([one.slope(value) for one, value in zip(free, values, strict=True)])
        errors = parts.errors * slopes
        names = tuple(one.name for one in free)
        rounded = [_rounded(value, error, one) for value, error, one in zip(values, errors, free, strict=True)]
        scene = changed(self.scene, model.free.of_scene(rounded))
        columns, statements = [], list(parts.statements)
        unweighted = -residuals / self.weight
        for k, known in enumerate(model.present):
            column = np.full(table.time.size, math.nan)
            column[known] = unweighted[model.which == k]
            columns.append(column)
        noise = {
            quantity: math.sqrt(float(np.sum(unweighted[rows] ** 2)) / max(rows.sum() * degrees / residuals.size, 1.0))
            for quantity, rows in _groups(model).items()
        }
        statements += self._quality(residuals, columns)
        restitution = {
            one.name: (math.sqrt(1.0 - value), float(error) / (2.0 * math.sqrt(1.0 - value)))
            for one, value, error in zip(free, values.tolist(), errors, strict=True)
            if one.path.split(".")[-1] == "loss"
        }
        return SceneFit(
            scene, names, values, errors, parts.correlation, parts.known, tuple(statements), restitution, noise,
            table.time, tuple(model.observed), tuple(columns), parts.singular, found.starts, model.runs, free, model.lane,
            table,
        )  # fmt: skip

    def _floor(self) -> float:
        """Return the norm below which a column of the Jacobian is only an error of the simulations."""
        speed = max(map(abs, self.scene.lanes[self.model.lane].velocity)) or 1.0
        span = dict.fromkeys(UNIT_OF, 1.0) | {POSITION: float(np.ptp(self.model.time))}
        sizes = [span[self.model.observed[k].quantity] for k in self.model.which.tolist()]
        return 10.0 * self.model.tolerance * speed / STEP * float(np.linalg.norm(self.weight * np.array(sizes)))

    def _quality(self, residuals: Array, columns: Sequence[Array]) -> list[str]:
        """Return sentences about the quality of the fit."""
        found = []
        if not_random(residuals, self.model.which):
            found.append(
                "the residuals are not random: the scene does not describe everything in the data, so the error bars are too "
                "small"
            )
        free_offsets = {one.path for one in self.free if one.path.startswith(OFFSET)}
        for one, column in zip(self.model.observed, columns, strict=True):
            present = column[np.isfinite(column)]
            if one.quantity != POSITION or free_offsets or not present.size:
                continue
            size = float(np.ptp(one.values[np.isfinite(one.values)])) or math.inf
            if abs(float(np.mean(present))) > OFF * size:
                found.append(f"data and fit of {one.name!r} have different origins: --free offset allows for it")
        return found


def _groups(model: MotionModel) -> dict[str, NDArray[np.bool_]]:
    """Return, for each quantity, which rows of the data belong to it."""
    quantities = np.array([model.observed[k].quantity for k in model.which.tolist()])
    return {quantity: quantities == quantity for quantity in dict.fromkeys(quantities.tolist())}


def _of_data(
    free: Sequence[str], table: MeasuredTable, observed: Sequence[Observation], freely: bool
) -> list[FreeValue]:
    """Return the free values `start` and `offset`. Raise StudyError if their bounds are not possible."""
    found = list[FreeValue]()
    first, last = float(table.time[0]), float(table.time[-1])
    for text in free:
        path, bounds = parse(text)
        if path == START:
            low, high = bounds or (first - (last - first), last if freely else first)
            if not freely and high > first:
                raise StudyError(
                    f"start must be at most {first:g} s, the first time of the data: the beads do not move freely before"
                )
            value = float(np.clip(0.0, low, high))
            found.append(FreeValue(START, START, value, low, high, 0.1 * (last - first), False, bounds is not None))
        elif path == OFFSET:
            places = [k for k, one in enumerate(observed) if one.quantity == POSITION]
            if not places:
                raise StudyError("offset needs data with positions")
            for k in places:
                values = observed[k].values[np.isfinite(observed[k].values)]
                size = float(np.ptp(values)) or 1.0
                low, high = bounds or (-math.inf, math.inf)
                name = f"offset of {observed[k].name}"
                start = float(np.clip(values[0] if values.size else 0.0, low, high))
                found.append(FreeValue(f"{OFFSET} {k}", name, start, low, high, size, False, bounds is not None))
    return found


def _velocity_paths(scene: Scene, lane: int) -> dict[int, str]:
    """Return the path of the start velocity of each bead. The first bead has the path of the velocity of all strikers."""
    velocity = scene.lanes[lane].velocity
    paths = {k: f"lanes.{lane}.velocity.{k}" for k in range(len(velocity))}
    return paths if len(velocity) else {0: f"lanes.{lane}.velocity"}


def _rounded(value: float, error: float, one: FreeValue) -> float:
    """Return the value within its bounds, rounded to a few digits more than its error bar."""
    if math.isfinite(error) and error > 0.0:
        digits = DIGITS_OF_ERROR - 1 - math.floor(math.log10(error))
        value = round(float(value), digits)
    else:
        value = float(f"{value:.6g}")
    return float(np.clip(value, one.low, one.high))
