"""Which contacts at rest yield and which beads at rest slip: accelerations and forces at a switch, exactly.

Of all accelerations a the motion has the least (Gauss): with bounded multipliers of contacts at rest and of static friction,

    minimise  sum_j (m_j a_j²/2 - p_j a_j + s_j |a_j|) + sum_i max(l_i (a_i - a_(i+1)), h_i (a_i - a_(i+1)))

is strictly convex, and a chain: the force that bead j needs from its right is a growing, piecewise linear function of a_j,
contact i clips it to [l_i, h_i], and bead i + 1 adds its own terms. One sweep to the right builds these functions, one back
reads off the accelerations (dynamic programming, Johnson 2013, J. Comput. Graph. Stat. 22, 246). There is no iteration, and
beads that move as one have equal accelerations to the last digit.
"""

from __future__ import annotations

from softcradle.physics.numerics.jit import inlined


@inlined
def inverse(value, mass, knots, count):
    """The acceleration at which the function has `value`: `knots` (2, count) and slope `mass` beyond them."""
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
    """Move the knots [first, last) on by so many places, or back."""
    for k in range(last - first):
        at = last - 1 - k if places > 0 else first + k
        knots[0, at + places], knots[1, at + places] = knots[0, at], knots[1, at]


@inlined
def add_bead(mass, load, give, knots, count):
    """Add ``mass a - load + give sign(a)`` to the function; returns the number of knots."""
    x, y = knots[0], knots[1]
    if count == 0:
        x[0], y[0], count = 0.0, 0.0, 1
    if give > 0.0:
        at = 0
        while at < count and x[at] < 0.0:
            at += 1
        after = at
        while after < count and x[after] == 0.0:
            after += 1
        if after > at:
            below, above = y[at], y[after - 1]
        elif at in (0, count):  # beyond the knots the function is constant
            below = above = y[0] if at == 0 else y[count - 1]
        else:
            part = x[at] / (x[at] - x[at - 1])
            below = above = y[at] - (y[at] - y[at - 1]) * part
        for k in range(at):
            y[k] -= give
        for k in range(after, count):
            y[k] += give
        grows = at + 2 - after  # two knots at 0 replace those between
        shift(after, count, grows, knots)
        x[at], y[at], x[at + 1], y[at + 1] = 0.0, below - give, 0.0, above + give
        count += grows
    for k in range(count):
        y[k] += mass * x[k] - load
    return count


@inlined
def clip(low, high, slow, fast, knots, count):
    """Clip the function to [-high, -low], which it has at the accelerations `slow` and `fast`; returns the number of knots."""
    x, y = knots[0], knots[1]
    if low == high:
        x[0], y[0] = slow, -low
        return 1
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
    """Solve for the accelerations (n+1,) and forces (n,) of a chain.

    `inverse_mass` (n+1,) is 0 for walls; `load` (n+1,) [N] are the known forces on beads; `give` (n+1,) [N] is the largest static
    friction of beads at rest, 0 for others; `low`, `high` (n,) [N] bound the force of each contact, equal where it is known.
    `bounds` (2, n+1) and `knots` (2, 4n+8) are scratch memory. A force that is not determined is in the middle of what it may be.
    """
    n, count = low.size, 0
    slow, fast = bounds[0], bounds[1]
    for j in range(n):
        if inverse_mass[j] == 0.0:
            slow[j] = fast[j] = 0.0
            count = 0
        else:
            count = add_bead(1.0 / inverse_mass[j], load[j], give[j], knots, count)
            slow[j] = inverse(-high[j], 1.0 / inverse_mass[j], knots, count)
            fast[j] = inverse(-low[j], 1.0 / inverse_mass[j], knots, count)
        count = clip(low[j], high[j], slow[j], fast[j], knots, count)
    acceleration[n] = 0.0
    if inverse_mass[n] > 0.0:
        count = add_bead(1.0 / inverse_mass[n], load[n], give[n], knots, count)
        acceleration[n] = inverse(0.0, 1.0 / inverse_mass[n], knots, count)
    for j in range(n - 1, -1, -1):
        acceleration[j] = min(max(acceleration[j + 1], slow[j]), fast[j])
    forces_of(inverse_mass, load, give, low, high, acceleration, force, bounds)


@inlined
def surplus(j, inverse_mass, load, give, acceleration):
    """What is left of the known forces on bead j beside its inertia, and by how much static friction may change it."""
    a = acceleration[j]
    if inverse_mass[j] == 0.0:
        return 0.0, 1e300
    if a == 0.0:
        return load[j], give[j]
    return load[j] - a / inverse_mass[j] - (give[j] if a > 0.0 else -give[j]), 0.0


@inlined
def forces_of(inverse_mass, load, give, low, high, acceleration, force, bounds):
    """Forces (n,) that go with the accelerations: intervals from the left, then one force of each from the right."""
    n = low.size
    below, above = 0.0, 0.0
    for i in range(n):
        rest, room = surplus(i, inverse_mass, load, give, acceleration)
        least = high[i] if acceleration[i] > acceleration[i + 1] else low[i]
        most = low[i] if acceleration[i] < acceleration[i + 1] else high[i]
        below = min(max(below + rest - room, least), most)
        above = min(max(above + rest + room, least), most)
        bounds[0, i], bounds[1, i] = below, above
    wanted = 0.0
    for i in range(n - 1, -1, -1):
        rest, room = surplus(i + 1, inverse_mass, load, give, acceleration)
        below, above = max(wanted - rest - room, bounds[0, i]), min(wanted - rest + room, bounds[1, i])
        wanted = min(max(0.5 * (below + above), bounds[0, i]), bounds[1, i])
        force[i] = wanted
