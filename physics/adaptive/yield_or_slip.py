"""Complementarity problem at an event: which contacts at rest yield and which beads at rest slip. Solved exactly.

With bounded multipliers of contacts at rest (Signorini condition with preload) and of static friction, the
accelerations a minimise (Gauss's principle of least constraint)

    sum_j (m_j a_j²/2 - p_j a_j + s_j |a_j|) + sum_i max(l_i (a_i - a_(i+1)), h_i (a_i - a_(i+1)))

This is a strictly convex, box-constrained quadratic program, and its variables form a chain. The force that bead j
needs from its right neighbour is an increasing, piecewise linear function of a_j. Contact i clips this function to
[l_i, h_i], and bead i + 1 adds its own terms. One sweep to the right builds the functions, and one sweep back reads off
the accelerations (dynamic programming, Johnson 2013, J. Comput. Graph. Stat. 22, 246). The solution is exact without
iterations, and beads that move as one body have bitwise equal accelerations.
"""

from __future__ import annotations

from softcradle.physics.numerics.jit import inlined


@inlined
def inverse(value, mass, knots, count):
    """Return the acceleration at which the function has `value`. `knots` (2, count) are its breakpoints; beyond them
    its slope is `mass`.
    """
    x, y = knots[0], knots[1]
    if value <= y[0]:
        return x[0] - (y[0] - value) / mass
    for k in range(1, count):
        if value <= y[k]:
            rise = y[k] - y[k - 1]
            return x[k] - (x[k] - x[k - 1]) * ((y[k] - value) / rise) if rise > 0.0 else x[k]
    return x[count - 1] + (value - y[count - 1]) / mass


@inlined
def shift(first, last, places, knots):
    """Move the breakpoints [first, last) by `places` places."""
    # Copy in the order that does not overwrite a breakpoint before it is moved.
    for k in range(last - first):
        at = last - 1 - k if places > 0 else first + k
        knots[0, at + places], knots[1, at + places] = knots[0, at], knots[1, at]


@inlined
def add_bead(mass, load, give, knots, count):
    """Add the terms ``mass a - load + give sign(a)`` of a bead to the function. Return the number of breakpoints."""
    x, y = knots[0], knots[1]
    # Before the first bead of a body the function is 0.
    if count == 0:
        x[0], y[0], count = 0.0, 0.0, 1
    # Static friction adds a step of height 2 `give` at a = 0. First find the values of the function on both sides of 0.
    if give > 0.0:
        at = 0
        while at < count and x[at] < 0.0:
            at += 1
        after = at
        while after < count and x[after] == 0.0:
            after += 1
        if after > at:
            below, above = y[at], y[after - 1]
        elif at in (0, count):  # beyond its breakpoints the function is constant
            below = above = y[0] if at == 0 else y[count - 1]
        else:
            part = x[at] / (x[at] - x[at - 1])
            below = above = y[at] - (y[at] - y[at - 1]) * part
        # Then move the left part down and the right part up.
        for k in range(at):
            y[k] -= give
        for k in range(after, count):
            y[k] += give
        grows = at + 2 - after  # two breakpoints at 0 replace those between
        shift(after, count, grows, knots)
        x[at], y[at], x[at + 1], y[at + 1] = 0.0, below - give, 0.0, above + give
        count += grows
    # Inertia and known forces change the values, not the positions, of the breakpoints.
    for k in range(count):
        y[k] += mass * x[k] - load
    return count


@inlined
def clip(low, high, slow, fast, knots, count):
    """Clip the function to [-high, -low]. It has these values at the accelerations `slow` and `fast`. Return the number
    of breakpoints.
    """
    x, y = knots[0], knots[1]
    # The contact force is known: the function is constant.
    if low == high:
        x[0], y[0] = slow, -low
        return 1
    # Remove the breakpoints outside the range, and put one at each end.
    first = 0
    while first < count and y[first] <= -high:
        first += 1
    last = count
    while last > first and y[last - 1] >= -low:
        last -= 1
    kept = last - first
    shift(first, last, 1 - first, knots)
    x[0], y[0], x[kept + 1], y[kept + 1] = slow, -high, fast, -low
    return kept + 2


@inlined
def balance(inverse_mass, load, give, low, high, acceleration, force, bounds, knots):
    """Solve the complementarity problem for the accelerations (n+1,) and forces (n,) of a chain.

    `inverse_mass` (n+1,) is 0 for walls. `load` (n+1,) [N] contains the known forces on the beads, and `give` (n+1,)
    [N] the largest static friction of beads at rest, 0 for the others. `low` and `high` (n,) [N] bound the force of
    each contact; they are equal if the force is known. `bounds` (2, n+1) and `knots` (2, 4n+8) are scratch memory. A
    force that is not determined gets the middle of its possible range. The function knows no records, so that a test can
    pass any such problem.
    """
    n, count = low.size, 0
    slow, fast = bounds[0], bounds[1]
    # Sweep to the right: the force that the beads up to j need, as a function of a_j. `slow` and `fast` are the
    # accelerations of bead j at which contact j reaches its bounds. A wall takes every force, so a new body begins
    # behind it.
    for j in range(n):
        if inverse_mass[j] == 0.0:
            slow[j] = fast[j] = 0.0
            count = 0
        else:
            count = add_bead(1.0 / inverse_mass[j], load[j], give[j], knots, count)
            slow[j] = inverse(-high[j], 1.0 / inverse_mass[j], knots, count)
            fast[j] = inverse(-low[j], 1.0 / inverse_mass[j], knots, count)
        count = clip(low[j], high[j], slow[j], fast[j], knots, count)
    # The last bead does not need a force from its right.
    acceleration[n] = 0.0
    if inverse_mass[n] > 0.0:
        count = add_bead(1.0 / inverse_mass[n], load[n], give[n], knots, count)
        acceleration[n] = inverse(0.0, 1.0 / inverse_mass[n], knots, count)
    # Sweep back: beads move together unless the contact between them is at a bound.
    for j in range(n - 1, -1, -1):
        acceleration[j] = min(max(acceleration[j + 1], slow[j]), fast[j])
    forces_of(inverse_mass, load, give, low, high, acceleration, force, bounds)


@inlined
def surplus(j, inverse_mass, load, give, acceleration):
    """Return the known force on bead j minus its inertia [N], and by how much static friction can change it [N]."""
    a = acceleration[j]
    if inverse_mass[j] == 0.0:
        return 0.0, 1e300
    if a == 0.0:
        return load[j], give[j]
    return load[j] - a / inverse_mass[j] - (give[j] if a > 0.0 else -give[j]), 0.0


@inlined
def forces_of(inverse_mass, load, give, low, high, acceleration, force, bounds):
    """Compute the forces (n,) that belong to the accelerations.

    A sweep from the left computes the interval of possible values of each force. A sweep from the right chooses one
    value in each interval.
    """
    n = low.size
    below, above = 0.0, 0.0
    # Beads that approach each other load the contact to its upper bound, beads that separate unload it to the lower
    # one. Only equal accelerations leave a range.
    for i in range(n):
        rest, room = surplus(i, inverse_mass, load, give, acceleration)
        least = high[i] if acceleration[i] > acceleration[i + 1] else low[i]
        most = low[i] if acceleration[i] < acceleration[i + 1] else high[i]
        below = min(max(below + rest - room, least), most)
        above = min(max(above + rest + room, least), most)
        bounds[0, i], bounds[1, i] = below, above
    # The force on the right end is 0. Each bead then gives an interval for its left contact; take the middle.
    wanted = 0.0
    for i in range(n - 1, -1, -1):
        rest, room = surplus(i + 1, inverse_mass, load, give, acceleration)
        below, above = max(wanted - rest - room, bounds[0, i]), min(wanted - rest + room, bounds[1, i])
        wanted = min(max(0.5 * (below + above), bounds[0, i]), bounds[1, i])
        force[i] = wanted
