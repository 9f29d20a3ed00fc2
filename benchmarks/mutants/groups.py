"""The groups of kernels that are mutated, and the tests that are to notice: quick ones, for kernels run as plain Python."""

from __future__ import annotations

from typing import NamedTuple


class Group(NamedTuple):
    """Sources whose mutants are counted together, and the arguments of pytest that choose their tests."""

    sources: tuple[str, ...]
    tests: tuple[str, ...]


GROUPS = {
    "law": Group(
        ("physics/numerics/law_kernels.py", "physics/numerics/law_curve.py", "physics/contact.py"),
        ("tests/physics/test_contact.py", "tests/physics/numerics/test_law_curve.py"),
    ),
    "conserving": Group(
        (
            "physics/fixed_step/discrete_gradient.py",
            "physics/numerics/contact_solve.py",
            "physics/numerics/fixed_step_friction.py",
            "physics/numerics/resolvent.py",
        ),
        (
            "tests/physics/numerics/test_contact_solve.py",
            "tests/physics/fixed_step/test_gradient_step.py",
            "tests/physics/fixed_step/test_discrete_gradient.py",
            "-k",
            "contact_solve or gradient_step or resolvent or mean_force or monotone or guess or slope or carries or returned"
            " or cycles or walls",
        ),
    ),
    "radau": Group(
        (
            "physics/adaptive/radau.py",
            "physics/adaptive/radau_error.py",
            "physics/adaptive/radau_guess.py",
            "physics/adaptive/radau_tableau.py",
        ),
        ("tests/physics/adaptive/test_radau_step.py", "tests/physics/adaptive/test_radau_guess.py"),
    ),
    "events": Group(
        ("physics/adaptive/event_location.py", "physics/adaptive/first_root.py"),
        (
            "tests/physics/adaptive/test_first_root.py",
            "tests/physics/adaptive/test_find_event.py",
            "tests/physics/adaptive/test_guards.py",
        ),
    ),
}
