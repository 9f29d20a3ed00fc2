"""Data of a page as JSON. The data contain the initial state of the lanes, their appearance, and their recorded motion
in packed form.
"""

import base64
import math
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain
from softcradle.physics.checked_input import finite_or_none
from softcradle.physics.fixed_step.discrete_gradient import WORK_ROWS
from softcradle.physics.numerics.contact_solve import BEAD_ROWS
from softcradle.physics.numerics.records import COUNTERS
from softcradle.physics.scales import greatest_speed, speed_scale
from softcradle.sandbox.draw.bodies import EQUAL_MASSES, cluster_ends, solid_force
from softcradle.sandbox.draw.palette import LIGHT, OKABE_ITO
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.languages import _, in_every_language, scene_words
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.page.played_motion import PlayedMotion
from softcradle.sandbox.story.bodies import HEAVY, is_gear
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Lane, Scene

MOST_COMPUTED = 200  # Largest number of beads in a chain that a page can compute.
# Exponent of the contact law of steel balls. The softness of contacts with this exponent cannot be changed.
STEEL = 1.5
SHOWN = ["forces", "balance", "charts"]  # Parts that are visible when the page is opened.


def can_be_computed(scene: Scene) -> bool:
    """Return True if a page can compute the scene itself. A page can compute preloaded power laws, loss, friction,
    strings and a constant drive.
    """
    chains = [lane.chain() for lane in scene.lanes]
    return len(chains) <= 2 and all(
        not (chain.piecewise or chain.own_laws or chain.timed or chain.brakes) and chain.contacts < MOST_COMPUTED
        for chain in chains
    )


def is_train(mass: Sequence[float]) -> bool:
    """Return True if all bodies are at least as heavy as wagons. Walls count as heavy."""
    return min(mass) >= HEAVY


def page_data(played: PlayedMotion, computed: bool) -> dict[str, Any]:
    """Return all data that the script of a page uses."""
    scene, scales = played.scene, played.scales
    size, name = played.time_unit
    newtons, force_name = played.force_unit
    size_limit = (STANDBY_BYTES, STANDBY_COARSEST) if computed else (USUAL_BYTES, COARSEST)
    packed = packed_lanes(played.motions, scales, *size_limit)
    axes = ("window", "velocity", "force", "pull", "magnify", "energy", "momentum")
    data = {
        "slow": scene.view.slow,
        "unit": {"size": size, "name": name},
        "forceUnit": {"size": newtons, "name": force_name},
        "length": scene.view.length,
        "numbered": scene.view.labels,
        "magnify": scene.view.magnify,
        "duration": scene.duration,
        "fewBeads": len(OKABE_ITO),
        "ramp": [_hex(colour) for colour in LIGHT.ramp],
        "scales": {axis: getattr(scales, axis) for axis in axes},
        "texts": _texts(played),
        "lanes": [
            _lane(played, k) | {"recorded": packed[k] | {"closed": _closed(played, k)}} for k in range(len(scene.lanes))
        ],
        "own": {"pace": 1, "beside": "none", "shown": SHOWN},
    }
    return data | (_experiment(scene) if computed else {})


def _lane(played: PlayedMotion, number: int) -> dict[str, Any]:
    trajectory = played.trajectories[number]
    chain, velocity = trajectory.chain, trajectory.velocity[0]
    ends = cluster_ends(trajectory.overlap[0].tolist(), velocity.tolist(), played.scene.view.length)
    return {
        "spec": _spec(chain, velocity.tolist(), played.scene.duration),
        "gears": [is_gear(contact) for contact in chain.contact],
        "pulls": chain.pulls,
        "solid": [[finite_or_none(solid_force(joint, sign)) for sign in (1.0, -1.0)] for joint in chain.contact],
        "ends": ends,
        "dissipative": chain.dissipative,
        # True if the recording begins after the start of the motion. The state at the start is then unknown.
        "late": bool(trajectory.time[0] > 0.0),
        # A motion is also driven if the user has pulled a bead.
        "driven": chain.driven or bool(trajectory.given.any()),
    }


def _closed(played: PlayedMotion, number: int) -> list[list[list[float | None]]]:
    """Return the time intervals [s] in which each contact of a lane is closed, as (begin, end). If a contact is closed
    until the motion stops, the end is None.
    """
    intervals = played.trajectories[number].contact_intervals
    return [[[_short(begin), finite_or_none(_short(end))] for begin, end in spans] for spans in intervals]


def _short(time: float) -> float:
    """Return a time rounded to nine digits. The rounding is finer than the distance between the samples of a page."""
    return float(f"{time:.9g}")


def _spec(chain: Chain, velocity: list[float], duration: float | None) -> dict[str, Any]:
    """Return the initial state and the contact laws of a chain."""
    return {
        "mass": [finite_or_none(mass) for mass in chain.mass],
        "gap": list(chain.gap),
        "velocity": velocity,
        "law": [finite_or_none(value) for value in np.nan_to_num(chain.law_rows, nan=math.inf).ravel().tolist()],
        "loss": [0.0 if chain.own_laws else float(loss) for loss in chain.loss],
        "friction": chain.friction,
        "drive": None if chain.drive is None else list(chain.drive),
        "swing": chain.swing,
        "strings": chain.strings,
        "speed": speed_scale(chain, velocity, duration),
    }


def _experiment(scene: Scene) -> dict[str, Any]:
    """Return the settings that a reader of the page can change, and their units."""
    lane = scene.lanes[0]
    chain, speeds = lane.chain(), [greatest_speed(item.chain(), item.velocity, scene.duration) for item in scene.lanes]
    speed, row = speeds[0] or 1.0, chain.law_rows[0].tolist()
    soft = [law[2] for law in chain.law_rows.tolist() if law[0] == 0.0 and law[1] > 0.0 and law[2] != STEEL]
    strikers = _strikers(chain, lane) if len(scene.lanes) == 1 else 0
    finite = [mass for mass in chain.mass if math.isfinite(mass)]
    mass = math.fsum(finite) / len(finite)
    starts = [float(np.abs(item.velocity).max()) for item in scene.lanes]
    approach = chain.gap[strikers - 1] if strikers else 0.0
    return {
        "speed": max(speeds) or 1.0,  # If all beads are at rest, a speed of 1 m/s is used.
        "kernel": {"beadRows": BEAD_ROWS, "workRows": WORK_ROWS, "counters": COUNTERS},
        "soft": bool(soft),
        "uniform": {"mass": mass, "law": row, "approach": approach} if strikers else None,
        "matter": {"mass": mass, "speed": speed, "length": scene.view.length, "strength": _strength(row)},
        "own": {
            "law": "scene", "alpha": soft[0] if soft else 0.1, "strikers": strikers or 1,
            "targets": chain.contacts + 1 - strikers, "speed": next(filter(None, starts), speed),
            "friction": chain.friction, "loss": float(chain.loss.max()), "pace": 1, "beside": "none", "shown": SHOWN,
        },
    }  # fmt: skip


def _strength(law: list[float]) -> float | None:
    """Return a force [N] that characterises the strength of a contact law. This force is the preload, or for soft beads
    the force at an overlap of 1 m.
    """
    preload, stiffness, exponent = law
    return preload or (stiffness if exponent < 1.0 else None)


def _strikers(chain: Chain, lane: Lane) -> int:
    """Return the number of beads that strike a chain at rest. Return 0 if not all beads and contacts are equal."""
    speeds, finite = lane.velocity, all(map(math.isfinite, chain.mass))
    strikers = next((k for k, speed in enumerate(speeds) if speed != speeds[0]), 0)
    laws = np.column_stack((chain.law_rows, chain.loss))
    alike = np.ptp(laws, axis=0).max() == 0.0 and finite and max(chain.mass) <= EQUAL_MASSES * min(chain.mass)
    others = [gap for k, gap in enumerate(chain.gap) if k != strikers - 1]
    if not strikers or not alike or any(speeds[strikers:]) or any(others) or speeds[0] <= 0.0 or chain.drive:
        return 0
    return strikers


def _texts(played: PlayedMotion) -> dict[str, dict[str, Any]]:
    """Return the title, source, text, question and labels in every language of the page."""

    def texts() -> dict[str, Any]:
        words = {key: scene_words(getattr(played.scene, key)) for key in ("title", "source", "text", "question")}
        return words | {"labels": list(map(scene_words, played.labels))}

    found = in_every_language(texts)
    return {code: said for code, said in found.items() if code == "en" or said != found["en"]}


def _hex(colour: tuple[int, int, int]) -> str:
    return "#" + "".join(f"{part:02x}" for part in colour)


# Usual size of all packed motions of a page in bytes. A packed motion contains the smallest number of samples between
# which straight lines follow every curve. The samples are stored as base64 text of typed arrays. The base64 text takes
# 800 kB, and the page stays below 1 MB.
USUAL_BYTES = 600_000
# Usual size in bytes of the recording in a page that computes its motion. The recording is played only if the browser
# blocks WebAssembly.
STANDBY_BYTES = 4_000
# Largest size of all packed motions in bytes. Long chains with the smallest accuracy need this size.
MOST_BYTES = 6_000_000
# Largest number of times that the accuracy is reduced. With further reductions, the curves would look wrong.
COARSEST = 5
CODES = 32767  # Largest integer code of a velocity or force. The code 0 means zero.
# Largest distance between a curve and the straight lines that represent it, as a fraction of the axis. This distance is
# a third of a pixel on an axis of 1200 pixels.
LINE_ERROR = 2.5e-4
# Largest relative error of an overlap between two samples. An error of this size does not change the second digit of a
# label.
SAME_DEPTH = 4e-3
STANDBY_COARSEST = 7  # value of COARSEST for a recording that is played only if the browser blocks WebAssembly
COARSER = 2.0  # Factor by which the allowed errors increase when a motion needs too many samples.
Rows = NDArray[np.intp]


def packed_lanes(lanes: Sequence[Motion], scales: Scales, usual: int, coarsest: int = COARSEST) -> list[dict[str, Any]]:
    """Return the packed motions of all `lanes`. The accuracy is reduced until the motions need at most `usual` bytes
    together. The accuracy is reduced at most `coarsest` times.

    Raises:
        UserError: with the lowest accuracy, the motions still need more than MOST_BYTES.
    """
    choices = zip(*(adaptive_rows(motion, scales) for motion in lanes), strict=True)
    for rows in islice(choices, 1 + coarsest):
        size = sum(map(_size, lanes, rows))
        if size <= usual:
            break
    if size > MOST_BYTES:
        beads = max(motion.chain.contacts + 1 for motion in lanes)
        raise UserError(
            _("the motion of {beads} beads is too much for one page: choose a shorter duration or a film", beads=beads)
        )
    return [_packed(motion, chosen, scales) for motion, chosen in zip(lanes, rows, strict=True)]


def _size(motion: Motion, rows: Rows) -> int:
    return len(rows) * (8 * motion.chain.contacts + 18)


def _packed(motion: Motion, rows: Rows, scales: Scales) -> dict[str, Any]:
    """Return the packed samples `rows` of a motion. The columns are stored one after the other.

    Time, anchor, stored energy, absorbed energy and overlaps are stored as floats. Velocities and forces are stored as
    integer codes.
    """
    depth = np.maximum(np.abs(motion.overlap).max(axis=0), np.finfo(float).tiny)
    absorbed = motion.absorbed if motion.absorbed.size else np.zeros(len(motion.time))
    floats = [motion.time, motion.anchor[:, 0], motion.stored, absorbed, *(motion.overlap / depth).T]
    shares = [*(motion.velocity / fastest(scales)).T, *(motion.force / scales.force).T]
    return {
        "rows": len(rows),
        "anchor": motion.chain.anchor,
        "depth": depth.tolist(),
        "data": _base64([column[rows] for column in floats], [column[rows] for column in shares]),
    }


def fastest(scales: Scales) -> float:
    """Return the speed [m/s] that has the largest integer code. A bead at rest has the code 0."""
    return max(map(abs, scales.velocity))


def _base64(floats: Sequence[Array], shares: Sequence[Array]) -> str:
    codes = np.rint(np.clip(np.array(shares), -1.0, 1.0) * CODES)
    data = np.array(floats).astype("<f4").tobytes() + codes.astype("<i2").tobytes()
    return base64.b64encode(data).decode()


def adaptive_rows(motion: Motion, scales: Scales) -> Iterator[Rows]:
    """Yield smaller and smaller selections of the samples of `motion`. Each selection suffices to draw all curves on
    the axes of `scales`.

    Each selection is ascending and includes the first and the last sample. The first selection has errors up to
    LINE_ERROR. Each further selection allows errors that are larger by the factor COARSER.
    """
    curves, allowed = _curves(motion, scales)
    rows = needed_rows(motion.time, curves, allowed)
    while True:
        yield rows
        allowed = COARSER * allowed
        rows = rows[needed_rows(motion.time[rows], curves[rows], allowed[rows])]


def _curves(motion: Motion, scales: Scales) -> tuple[Array, Array]:
    """Return all curves (T, c), and the allowed error (T, c) of each of their values."""
    overlap = motion.overlap
    # The scale of an inset is the largest overlap of its contact.
    lens = np.maximum(np.abs(overlap).max(axis=0), np.finfo(float).tiny)
    smallest = 10.0 ** (scales.decades[0] - 1)
    depth = np.maximum(SAME_DEPTH * np.abs(overlap), smallest)
    parts = [
        (motion.position, LINE_ERROR * (scales.window[1] - scales.window[0])),
        (motion.velocity, LINE_ERROR * (scales.velocity[1] - scales.velocity[0])),
        (motion.force, LINE_ERROR * scales.force),
        (overlap, np.where(overlap > 0.0, np.minimum(depth, 2.0 * LINE_ERROR * lens), 2.0 * LINE_ERROR * lens)),
        (motion.stored[:, None], LINE_ERROR * scales.energy),
    ]
    if motion.absorbed.size:
        parts.append((motion.absorbed[:, None], LINE_ERROR * scales.energy))
    curves = np.concatenate([values for values, _ in parts], axis=1)
    allowed = np.concatenate([np.broadcast_to(error, values.shape) for values, error in parts], axis=1)
    return curves, allowed


def needed_rows(time: Array, curves: Array, allowed: Array) -> Rows:
    """Return the samples that are needed to draw `curves` (T, c) by straight lines. The lines deviate from the curves
    by at most `allowed` (T, c).

    Each section is divided at the value with the largest deviation (Douglas and Peucker). Sections are divided until no
    deviation is larger than allowed.
    """
    kept = {0, len(time) - 1}
    stretches = [(0, len(time) - 1)]
    while stretches:
        first, last = stretches.pop()
        if last - first < 2:
            continue
        inside = slice(first + 1, last)
        span = time[last] - time[first]
        share = ((time[inside] - time[first]) / span if span > 0.0 else np.zeros(last - first - 1))[:, None]
        line = curves[first] + share * (curves[last] - curves[first])
        missed = (np.abs(curves[inside] - line) / allowed[inside]).max(axis=1)
        worst = int(np.argmax(missed))
        if missed[worst] > 1.0:
            middle = first + 1 + worst
            kept.add(middle)
            stretches += [(first, middle), (middle, last)]
    return np.array(sorted(kept), dtype=np.intp)
