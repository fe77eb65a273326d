"""Motion with one degree of freedom and dry friction, by scipy.integrate.solve_ivp.

    inertia x'' = force(t, x, v) - dry(t, x, v, z) sign(v),   z' = rate(v, z)

At v = 0 the body sticks while |force| <= dry. Each change between sliding and sticking ends an integration.
"""
import numpy as np
from scipy.integrate import solve_ivp

TOLERANCE = 1e-9  # of solve_ivp; ten times larger changes no reading by 1e-3 of its noise
BEYOND = 1e-9     # share by which a force exceeds friction before a body slides: rounding must not stop it again


# Evaluations of a motion, of which 1.4e4 are met. A search may ask for a damper that drives, whose motion grows for
# ever; twice as many let it search for twice as long.
MOST = 200_000


def motion(inertia, force, start, times, longest, dry=None, memory=(), rate=None, corners=()):
    """Rows (x, v) at the times.

    start: x and v at time 0. longest: s, longest step, a tenth of a period. corners: s, kinks of the drive. At a corner
    force() answers for what follows it; a part that ends there never asks for it."""
    rate = rate or (lambda v, z: np.zeros(len(memory)))
    y, t, rows = np.array([*start, *memory], float), 0.0, []
    stops = [c for c in sorted(corners) if 0.0 < c < times[-1]] + [float(times[-1])]
    evaluations = 0
    while t < times[-1]:
        way = 0.0
        if dry:
            pull = force(t, y[0], 0.0)
            way = np.sign(y[1]) if y[1] else np.sign(pull) * (abs(pull) > (1.0 + 0.5 * BEYOND) * dry(t, y[0], 0.0, y[2:]))
        sticks = bool(dry) and way == 0.0
        stop = next(c for c in stops if c > t)
        before = np.nextafter(stop, 0.0)

        def change(t, y):
            nonlocal evaluations
            evaluations += 1
            if evaluations > MOST:
                raise RuntimeError(f"the motion takes more than {MOST} evaluations")
            t = min(t, before)
            v = 0.0 if sticks else y[1]
            brake = way * dry(t, y[0], v, y[2:]) if dry else 0.0
            return np.concatenate(([v, 0.0 if sticks else (force(t, y[0], v) - brake) / inertia], rate(v, y[2:])))

        events = []
        if sticks:
            events = [lambda t, y: abs(force(min(t, before), y[0], 0.0)) - (1.0 + BEYOND) * dry(t, y[0], 0.0, y[2:])]
        elif dry:
            events = [lambda t, y: way * y[1]]
        for event in events:
            event.terminal, event.direction = True, 1.0 if sticks else -1.0
        wanted = times[(times >= t) & (times < stop) if stop < times[-1] else times >= t]
        part = solve_ivp(change, (t, stop), y, "DOP853", wanted, dense_output=True, events=events or None,
                         rtol=TOLERANCE, atol=TOLERANCE * 1e-3, max_step=longest)
        if part.status < 0:
            raise RuntimeError(part.message)
        end = float(part.t_events[0][0]) if part.status == 1 else stop
        if sticks and end <= t:  # it would begin to stick and to slide at one time for ever
            raise RuntimeError(f"the body neither sticks nor slides at t = {t} s")
        rows += [np.copy(y) for t, y in zip(part.t, np.transpose(part.y)) if t < end or end == times[-1]]
        y, t = part.sol(end), end
        if part.status == 1 or sticks:
            y[1] = 0.0
    return np.array(rows[:len(times)]).T
