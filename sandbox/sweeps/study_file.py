"""Study file: a TOML file that contains the name of a scene, the points of a sweep and the measures."""

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Self, get_args

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Strict, Tag, ValidationError, model_validator
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.sweeps.sample_points import (
    MOST_SAMPLED,
    Axis,
    Design,
    Points,
    Scale,
    check_bounds,
    grid,
    latin_hypercube,
    listed,
    sobol,
)
from softcradle.sandbox.sweeps.scene_points import changed
from softcradle.sandbox.sweeps.work import sweep_work
from softcradle.sandbox.user_error import StudyError, UserError, reason
from softcradle.scenes import Scene
from softcradle.scenes.catalogue import text_in
from softcradle.scenes.scene_errors import SceneError, scene_error
from softcradle.scenes.toml_table import FRACTION, Number, Table, problem

DESIGNS = get_args(Design)
Whole = Annotated[int, Strict()]


def _kind(value: Any) -> str:
    """Return the kind of a value in a study file as a tag in brackets; see `OneOrMany`. A fraction such as "1/14" is a
    number.
    """
    text = isinstance(value, str) and not FRACTION.fullmatch(value)
    return "(text)" if text else "(whole)" if isinstance(value, int) else "(number)"


Value = Annotated[
    Annotated[Whole, Tag("(whole)")] | Annotated[Number, Tag("(number)")] | Annotated[str, Tag("(text)")],
    Discriminator(_kind),
]
Bound = Annotated[
    Annotated[Whole, Tag("(whole)")] | Annotated[Number, Tag("(number)")],
    Discriminator(lambda value: "(whole)" if isinstance(value, int) else "(number)"),
]


class ParameterSpan(Table):
    """Values of one parameter.

    Attributes:
        values: list of values.
        between: smallest and largest value, instead of `values`.
        count: number of values in `between`, for a grid or a list, unless they are whole numbers. Samples have one
            common count for all parameters.
        scale: "linear", "log" (uniform in the logarithm) or "whole" (whole numbers).
        name: name of the coordinate in the Dataset; by default the path.
    """

    values: tuple[Value, ...] = ()
    between: tuple[Bound, Bound] | None = None
    count: Annotated[int, Strict(), Field(ge=2)] | None = None
    scale: Scale = "linear"
    name: str = ""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if bool(self.values) == (self.between is not None):
            raise problem("needs either values = [...] or between = [low, high]")
        beside = sorted(self.model_fields_set & {"count", "scale"})
        if self.values and beside:
            raise problem(f"{beside[0]} is allowed beside between = [low, high], not beside values = [...]")
        if self.scale == "whole" and self.count is not None:
            raise problem('scale = "whole" takes every number between = [low, high]: leave out count')
        return self

    def valued(self, path: str) -> Axis:
        """Return the Axis of this parameter for a grid or a list."""
        if self.between is None:
            return Axis(path, self.values, name=self.name)
        low, high = self.between
        check_bounds(Axis(path, low=low, high=high, scale=self.scale))
        count = int(high) - int(low) + 1 if self.scale == "whole" else self.count
        if count is None:
            raise StudyError(f"{path}: count is missing: how many values between {low:g} and {high:g}")
        if count > MOST_SAMPLED:
            raise StudyError(f"{path} has at most {MOST_SAMPLED} values, not {count}")
        if self.scale == "whole":
            return Axis(path, tuple(range(int(low), int(high) + 1)), name=self.name)
        spread = np.geomspace if self.scale == "log" else np.linspace
        return Axis(path, tuple(spread(low, high, count).tolist()), name=self.name)

    def sampled(self, path: str) -> Axis:
        """Return the Axis of this parameter for random or Sobol samples."""
        if self.between is None or self.count is not None:
            raise StudyError(f"{path}: samples need between = [low, high], and one count for all parameters")
        return Axis(path, low=self.between[0], high=self.between[1], scale=self.scale, name=self.name)


def _span(value: Any) -> Any:
    return {"values": value} if isinstance(value, list) else value


Spans = Mapping[str, Annotated[ParameterSpan, BeforeValidator(_span)]]


class SampleTable(Table):
    """Table of a study file that contains the number of samples, the seed, and the sampled parameters."""

    count: Annotated[int, Strict(), Field(ge=1)]
    seed: Annotated[int, Strict(), Field(ge=0)] = 0
    over: Spans


class StudyFile(Table):
    """Content of a study file.

    Attributes:
        title: title of the study.
        scene: name of a scene, or path of a scene file relative to the folder of the study.
        measures: names from the table of measures.
        set: numbers of the scene that replace those of its file, by path.
        grid, list, sobol, latin_hypercube: the points; exactly one of these tables.
    """

    title: str = ""
    scene: str
    measures: tuple[str, ...]
    set: Mapping[str, Value] = {}
    grid: Spans | None = None
    list: Spans | None = None
    sobol: SampleTable | None = None
    latin_hypercube: SampleTable | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        given = [name for name in DESIGNS if getattr(self, name) is not None]
        if len(given) != 1:
            raise problem(f"a study needs one of the tables {', '.join(DESIGNS)}, not {len(given)}")
        return self

    def points(self) -> Points:
        """Return the sample points."""
        if self.grid is not None:
            return grid([span.valued(path) for path, span in self.grid.items()])
        if self.list is not None:
            return listed([span.valued(path) for path, span in self.list.items()])
        samples, design = (self.sobol, sobol) if self.sobol is not None else (self.latin_hypercube, latin_hypercube)
        assert samples is not None
        return design([span.sampled(path) for path, span in samples.over.items()], samples.count, samples.seed)


@dataclass(frozen=True)
class SweepStudy:
    """Study that was read from a file. The object contains the arguments of `sweep`."""

    title: str
    scene: Scene
    points: Points
    measures: tuple[str, ...]


def load_study(path: str) -> SweepStudy:
    """Return the study in a file. Raise StudyError with a list of problems if the file is invalid."""
    try:
        table = tomllib.loads(text_in(path))
        found = StudyFile.model_validate(table)
    except OSError as error:
        raise StudyError(f"cannot read {path}: {reason(error)}") from None
    except UnicodeDecodeError:
        raise StudyError(f"{path}: not a text file in UTF-8") from None
    except ValidationError as error:
        raise StudyError(str(scene_error(path, error)).replace("the scene: key", "the study: key")) from None
    # The file is not valid TOML, has numbers with too many digits, or has too many nested brackets.
    except (ValueError, RecursionError) as error:
        raise StudyError(f"{path}: not valid TOML: {str(error)[:1].lower()}{str(error)[1:]}") from None
    try:
        study = SweepStudy(found.title, _scene(found, Path(path).parent), found.points(), found.measures)
        sweep_work(study.scene, study.points, study.measures)
        return study
    except UserError as error:
        raise StudyError(f"{path}: {error}") from None
    except SceneError as error:
        raise StudyError(f"{path}: set: {str(error).removeprefix('the scene: ')}") from None


def _scene(study: StudyFile, folder: Path) -> Scene:
    """Return the scene of a study after its numbers have been replaced."""
    beside = folder / study.scene
    scene = load_scene(str(beside) if study.scene.endswith(".toml") and os.path.isfile(beside) else study.scene)
    return changed(scene, study.set)
