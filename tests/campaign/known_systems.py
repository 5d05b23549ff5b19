"""Systems drawn at random whose attractor is known by construction: closed forms, or computations of this file alone.

Each family is a file of formulas and a function that draws parameters and a start in the basin of the attractor, and
says what a simulation must find. What is not in closed form (the walker, periodic orbits of the logistic map) is
computed here by iteration, shooting and finite differences.
"""

import cmath
import dataclasses
import math


@dataclasses.dataclass
class Truth:
    """What the motion settles on. None: not known, or not compared."""
    kind: str                       # periodic, quasi-periodic, chaotic, rest, chattering
    events: int | None = None       # of a period
    period: float | None = None
    multiplier: float | None = None  # the largest modulus, without that of the flow's direction
    exponent: float | None = None   # the largest one of a chaotic motion


@dataclasses.dataclass
class System:
    family: str
    formulas: str
    parameters: dict
    start: dict
    truth: Truth
    # Over this range of the first parameter a sweep sees one branch: one attractor with one number.
    branch: tuple | None = None

    @property
    def name(self):
        return "".join(c for c in self.family if c.isalnum())


def log_uniform(random, low, high):
    return math.exp(random.uniform(math.log(low), math.log(high)))


# An integrate-and-fire unit: x = a (1 - exp(-t)) reaches 1 at T = ln(a/(a-1)), and forgets everything there.
INTEGRATE_AND_FIRE = """par a=1.5
init x=0
x' = a - x
event threshold = 1 - x
jump reset: x -> 0
after any: threshold -> reset
"""


def integrate_and_fire(random):
    a = 1 + log_uniform(random, 1e-5, 3)
    return System("integrate and fire", INTEGRATE_AND_FIRE, {"a": a}, {"x": random.uniform(-1, 0.9)},
                  Truth("periodic", 1, math.log(a / (a - 1)), 0.0), (a, 1 + 1.5 * (a - 1)))


# Two oscillators on unit circles, theta' = 1, phi' = w - K sin(q phi - p theta)/q. Their difference obeys Adler's
# equation psi' = q w - p - K sin psi: locked for |q w - p| < K at the rate sqrt(K^2 - (q w - p)^2), else conjugate to a
# rotation whose mean frequency is (p +- sqrt((q w - p)^2 - K^2))/q.
def locked_oscillators(p, q):
    def power(name, n):
        lines = "%s1 = c%s\n%sI1 = s%s\n" % (name, name, name, name)
        for k in range(2, n + 1):
            lines += "%s%d = %s%d*c%s - %sI%d*s%s\n" % (name, k, name, k - 1, name, name, k - 1, name)
            lines += "%sI%d = %sI%d*c%s + %s%d*s%s\n" % (name, k, name, k - 1, name, name, k - 1, name)
        return lines
    return ("par w=1, K=0.1\ninit ca=1, sa=0, cb=1, sb=0\n" + power("a", p) + power("b", q) +
            "rate = w - K*(bI%d*a%d - b%d*aI%d)/%d\n" % (q, p, q, p, q) +
            "ga = 1 - ca^2 - sa^2\ngb = 1 - cb^2 - sb^2\n"
            "ca' = ga*ca - sa\nsa' = ga*sa + ca\ncb' = gb*cb - rate*sb\nsb' = gb*sb + rate*cb\n"
            "event turn = sa\nafter any: turn -> identity\n")


def torus_near_resonance(random):
    p, q = random.choice([(1, 1), (1, 2), (2, 1), (1, 3), (2, 3), (3, 2)])
    K = random.uniform(0.02, 0.2)
    # From the edge of the tongue by a share of its width, inside or outside.
    detuning = K * (1 + random.choice([-1, 1]) * log_uniform(random, 1e-3, 0.5)) * random.choice([-1, 1])
    parameters = {"w": (p + detuning) / q, "K": K}
    phase = random.uniform(0, 2 * math.pi)
    start = {"ca": 1.0, "sa": 0.0, "cb": math.cos(phase), "sb": math.sin(phase)}
    if abs(detuning) < K:
        period = 2 * math.pi * q
        rate = math.sqrt(K * K - detuning * detuning)
        truth = Truth("periodic", q, period, math.exp(-min(rate, 2.0) * period))
    else:
        truth = Truth("quasi-periodic")
    middle = (parameters["w"], (p + 0.9 * detuning) / q) if abs(detuning) < K else None
    return System("oscillators %d to %d" % (p, q), locked_oscillators(p, q), parameters, start, truth, middle)


# Maps that a clock applies once per unit of time; between its ticks nothing moves.
def clock(parameters, state, jump, definitions=""):
    names = [part.split("=")[0].strip() for part in state.split(",")]
    return ("par %s\ninit tau=0, %s\n%stau' = 1\n" % (parameters, state, definitions) +
            "".join("%s' = 0\n" % name for name in names) +
            "event tick = 1 - tau\njump apply: tau -> 0, %s\nafter any: tick -> apply\n" % jump)


# A Moebius map of the circle, z -> exp(i a) (z + b)/(1 + b z), and |z| -> |z| (3 - |z|^2)/2. Elliptic, conjugate to a
# rotation, where |cos(a/2)| < sqrt(1 - b^2); else an attracting fixed point.
MOEBIUS = clock("a=1, b=0.2", "c=1, s=0", "c -> cos(a)*u - sin(a)*v, s -> sin(a)*u + cos(a)*v",
                "r2 = c^2 + s^2\ng = (3 - r2)/2\nx = g*c\ny = g*s\nden = (1 + b*x)^2 + (b*y)^2\n"
                "u = ((x + b)*(1 + b*x) + b*y*y)/den\nv = (y*(1 + b*x) - (x + b)*b*y)/den\n")


def moebius_circle_map(random):
    b = random.uniform(0.05, 0.6)
    edge = 2 * math.asin(b)  # fixed points for |a| < edge
    a = edge * (1 + random.choice([-1, 1, 1]) * log_uniform(random, 1e-3, 0.5)) * random.choice([-1, 1])
    half = cmath.exp(0.5j * a)
    trace = 2 * half.real / math.sqrt(1 - b * b)
    phase = random.uniform(0, 2 * math.pi)
    if abs(trace) < 2:
        truth = Truth("quasi-periodic")
    else:
        small = abs(trace) / 2 - math.sqrt(trace * trace / 4 - 1)
        truth = Truth("periodic", 1, 1.0, small * small)
    return System("Moebius map", MOEBIUS, {"a": a, "b": b}, {"tau": 0.0, "c": math.cos(phase), "s": math.sin(phase)},
                  truth)


# A limit cycle of period 2 pi with one or two slow modes beside it.
SLOW_MODE = """par eps=1e-3
init x=1, y=0, z=0.5
growth = 1 - x^2 - y^2
x' = growth*x - y
y' = growth*y + x
z' = -eps*z
event turn = y
after any: turn -> identity
"""
SLOW_FOCUS = """par eps=1e-3, w=0.3
init x=1, y=0, u=0.5, v=0
growth = 1 - x^2 - y^2
x' = growth*x - y
y' = growth*y + x
u' = -eps*u - w*v
v' = -eps*v + w*u
event turn = y
after any: turn -> identity
"""
# z grows to sqrt(eps), where it decays with 2 eps.
SLOW_PITCHFORK = SLOW_MODE.replace("-eps*z", "eps*z - z^3")


def slow_mode(random):
    eps = log_uniform(random, 1e-7, 1e-3)
    start = {"x": 1.0, "y": 0.0, "z": random.uniform(0.01, 1)}
    return System("slow mode", SLOW_MODE, {"eps": eps}, start,
                  Truth("periodic", 1, 2 * math.pi, math.exp(-2 * math.pi * eps)))


def slow_focus(random):
    eps, w = log_uniform(random, 1e-7, 1e-3), random.uniform(0.1, 2.5)
    start = {"x": 1.0, "y": 0.0, "u": random.uniform(0.1, 1), "v": 0.0}
    return System("slow focus", SLOW_FOCUS, {"eps": eps, "w": w}, start,
                  Truth("periodic", 1, 2 * math.pi, math.exp(-2 * math.pi * eps)))


def slow_pitchfork(random):
    eps = log_uniform(random, 1e-6, 1e-2)
    start = {"x": 1.0, "y": 0.0, "z": math.sqrt(eps) * random.uniform(0.5, 1.5)}
    return System("slow pitchfork", SLOW_PITCHFORK, {"eps": eps}, start,
                  Truth("periodic", 1, 2 * math.pi, math.exp(-4 * math.pi * eps)))


LOGISTIC = clock("a=3.2", "u=0.3", "u -> a*u*(1 - u)")


def logistic_orbit(a, period):
    """Multiplier of the orbit that attracts: its period must be a divisor of `period`, 0 if it is none."""
    settled = 0.3
    for _ in range(200000):
        settled = a * settled * (1 - settled)
    for n in (k for k in range(1, period + 1) if period % k == 0):
        u = settled
        for _ in range(50):  # Newton's method on the n-th iterate
            v, slope = u, 1.0
            for _ in range(n):
                slope *= a * (1 - 2 * v)
                v = a * v * (1 - v)
            u -= (v - u) / (slope - 1)
        if abs(slope) < 1:
            return n, abs(slope)
    return 0, math.inf


def near_a_doubling(random):
    # 3 and 1 + sqrt 6 exactly; further ones are known to all digits that matter here.
    doubling, period = random.choice([(3.0, 2), (1 + math.sqrt(6), 4), (3.544090359551922, 8)])
    a = doubling + random.choice([-1, 1]) * log_uniform(random, 1e-5, 3e-3)
    events, multiplier = logistic_orbit(a, period)
    assert events, "no stable orbit of the logistic map at a = %r" % a
    return System("logistic map", LOGISTIC, {"a": a}, {"tau": 0.0, "u": random.uniform(0.2, 0.8)},
                  Truth("periodic", events, float(events), multiplier))


TENT = clock("a=1.5", "u=0.3", "u -> a*min(u, 1 - u)")
# The orbit of the full logistic map and of the doubling map is conjugate to a shift: ln 2.


def chaotic_map(random):
    if random.random() < 0.3:
        return System("logistic map", LOGISTIC, {"a": 4.0}, {"tau": 0.0, "u": random.uniform(0.1, 0.45)},
                      Truth("chaotic", exponent=math.log(2)))
    a = random.uniform(1.02, 1.98)  # |slope| is a everywhere
    return System("tent map", TENT, {"a": a}, {"tau": 0.0, "u": random.uniform(0.1, 0.45)},
                  Truth("chaotic", exponent=math.log(a)))


# x'' + 2 zeta x' + x = A cos theta, theta' = omega, a wall at x = 1, one impact in n periods of the force.
IMPACT_OSCILLATOR = """par A=3, omega=2, zeta=0.05, r=0.8
init x=0, v=0, c=1, s=0
growth = 1 - c^2 - s^2
x' = v
v' = A*c - 2*zeta*v - x
c' = growth*c - omega*s
s' = growth*s + omega*c
event wall = 1 - x
jump impact: v -> -r*v
after any: wall -> impact
"""


def one_impact_orbit(A, omega, zeta, r, n, root):
    """Start (x, v, c, s) just after the impact and the largest multiplier; None where there is no such orbit."""
    nu = math.sqrt(1 - zeta * zeta)
    T = 2 * math.pi * n / omega

    def basis(t):
        e, cos, sin = math.exp(-zeta * t), math.cos(nu * t), math.sin(nu * t)
        return (e * (cos + zeta / nu * sin), e * sin / nu, -e * sin / nu, e * (cos - zeta / nu * sin))
    C, S, dC, dS = basis(T)
    if abs(S) < 1e-3:
        return None
    k0 = (1 - C) / S
    kT = dC + k0 * dS
    kappa = -(k0 + r * kT) / (1 + r)
    # The forced motion is p, omega q at the impact: omega q = kappa (1 - p) and p^2 + q^2 = B^2.
    B2 = A * A / ((1 - omega ** 2) ** 2 + (2 * zeta * omega) ** 2)
    m = kappa / omega
    discriminant = m ** 4 - (1 + m * m) * (m * m - B2)
    if discriminant < 0:
        return None
    p = (m * m + root * math.sqrt(discriminant)) / (1 + m * m)
    q = m * (1 - p)
    v0, vT = k0 * (1 - p) + omega * q, kT * (1 - p) + omega * q
    if vT < 0.05:
        return None
    for k in range(1, 2000):  # the wall is not reached before
        t = T * k / 2000
        y = (1 - p) * (basis(t)[0] + k0 * basis(t)[1])
        if y + p * math.cos(omega * t) + q * math.sin(omega * t) > 1 - 1e-4 * min(k, 2000 - k) / 1000:
            return None
    force, quadrature = (1 - omega ** 2) * p + 2 * zeta * omega * q, q * (1 - omega ** 2) - 2 * zeta * omega * p
    a0, aT = force - 2 * zeta * v0 - 1, force - 2 * zeta * vT - 1

    def image(dt, dv):
        x, v = -v0 * dt, dv - a0 * dt
        x, v = C * x + S * v, dC * x + dS * v
        later = -x / vT
        return later, -r * (v + aT * later)
    (a, c), (b, d) = image(1, 0), image(0, 1)
    half, root2 = (a + d) / 2, cmath.sqrt((a + d) ** 2 / 4 - (a * d - b * c))
    multiplier = max(abs(half + root2), abs(half - root2))
    return (1.0, v0, force / A, -quadrature / A), T, multiplier


def impact_oscillator(random):
    while True:
        A, omega = random.uniform(0.5, 5), random.uniform(0.6, 4)
        zeta, r, n = random.uniform(0.01, 0.2), random.uniform(0.4, 0.95), random.choice([1, 1, 2])
        found = one_impact_orbit(A, omega, zeta, r, n, random.choice([-1, 1]))
        if found and found[2] < 0.999:
            (x, v, c, s), T, multiplier = found
            return System("impact oscillator", IMPACT_OSCILLATOR, {"A": A, "omega": omega, "zeta": zeta, "r": r},
                          {"x": x, "v": v * (1 + 1e-4), "c": c, "s": s}, Truth("periodic", 1, T, multiplier),
                          (A, A * (1 + 1e-5)))


# The simplest walker (Garcia, Chatterjee, Ruina, Coleman 1998), legs th and ph, slope gamma.
WALKER = """par gamma=0.009
init th=0.2, w=-0.2, ph=0.4, p=-0.0157
a = sin(th - gamma)
th' = w
w' = a
ph' = p
p' = a + w^2*sin(ph) - cos(th - gamma)*sin(ph)
event upright = th
event strike = 2*th - ph
jump step: th -> -th, w -> cos(2*th)*w, ph -> -2*th, p -> cos(2*th)*(1 - cos(2*th))*w
after upright: strike -> step
after any: upright -> identity
"""


def walker_step(th, w, gamma, step=0.01):
    """One step: (th, w) just after a heel strike to the next, and its duration, by Runge-Kutta of fourth order."""
    def field(x):
        a = math.sin(x[0] - gamma)
        return x[1], a, x[3], a + x[1] ** 2 * math.sin(x[2]) - math.cos(x[0] - gamma) * math.sin(x[2])

    def advance(x, h):
        k1 = field(x)
        k2 = field([a + h / 2 * b for a, b in zip(x, k1)])
        k3 = field([a + h / 2 * b for a, b in zip(x, k2)])
        k4 = field([a + h * b for a, b in zip(x, k3)])
        return [a + h / 6 * (b + 2 * c + 2 * d + e) for a, b, c, d, e in zip(x, k1, k2, k3, k4)]
    x, t = [th, w, 2 * th, (1 - math.cos(2 * th)) * w], 0.0
    while t < 20:
        y = advance(x, step)
        if y[0] < 0 and 2 * y[0] - y[2] < 0 <= 2 * x[0] - x[2]:
            h = 0.0
            for _ in range(5):  # Newton's method for the rest of the step
                y = advance(x, h)
                h -= (2 * y[0] - y[2]) / (2 * y[1] - y[3])
            y = advance(x, h)
            return -y[0], math.cos(2 * y[0]) * y[1], t + h
        x, t = y, t + step
    raise ArithmeticError("the walker falls")


def walker_gait(th, w, gamma, steps):
    """The gait of so many steps next to (th, w): Newton's method, the Jacobian by central differences."""
    def image(th, w):
        duration = 0.0
        for _ in range(steps):
            th, w, part = walker_step(th, w, gamma)
            duration += part
        return th, w, duration
    for _ in range(4):
        e = 1e-6
        (a, c, _), (b, d, _) = [
            [(after - before) / (2 * e) for after, before in zip(image(th + p, w + q), image(th - p, w - q))]
            for p, q in ((e, 0), (0, e))]
        f, g, period = image(th, w)
        f, g = f - th, g - w
        det = (a - 1) * (d - 1) - b * c
        th, w = th - ((d - 1) * f - b * g) / det, w - ((a - 1) * g - c * f) / det
    half, root = (a + d) / 2, cmath.sqrt((a + d) ** 2 / 4 - (a * d - b * c))
    return th, w, period, max(abs(half + root), abs(half - root))


def walker(random):
    # Period one is stable up to 0.01512, period two up to 0.01683 (the first two doublings).
    low, high = random.choice([(0.006, 0.0149), (0.0149, 0.0151), (0.0152, 0.0165)])
    gamma = random.uniform(low, high)
    steps = 1 if gamma < 0.01512 else 2
    th, w = 0.20031, -0.19983  # the gait at 0.009, followed from there
    for k in range(1, 11):
        th, w, period, multiplier = walker_gait(th, w, 0.009 + (gamma - 0.009) * k / 10, 1)
    if steps == 2:
        th += 1e-4
        for _ in range(400):
            th, w, _ = walker_step(th, w, gamma)
        th, w, period, multiplier = walker_gait(th, w, gamma, 2)
    assert multiplier < 1, "no stable gait of %d steps at %r" % (steps, gamma)
    start = {"th": th + 1e-4, "w": w, "ph": 2 * th + 2e-4, "p": (1 - math.cos(2 * th)) * w}
    return System("walker", WALKER, {"gamma": gamma}, start, Truth("periodic", 2 * steps, period, multiplier))


# Motions that end: a ball on the floor, whose impacts accumulate, and a point that spirals into rest.
BALL = """par r=0.5
init h=1, v=0
h' = v
v' = -1
event floor = h
jump impact: v -> -r*v
after any: floor -> impact
"""
SPIRAL = """par zeta=0.1
init x=1, y=0
x' = -zeta*x - y
y' = -zeta*y + x
event turn = y
after any: turn -> identity
"""


def motion_that_ends(random):
    if random.random() < 0.5:
        return System("ball on the floor", BALL, {"r": random.uniform(0.2, 0.9)},
                      {"h": random.uniform(0.5, 2), "v": 0.0}, Truth("chattering"))
    return System("spiral", SPIRAL, {"zeta": log_uniform(random, 0.01, 0.3)}, {"x": 1.0, "y": 0.0}, Truth("rest"))


# How many of a hundred each family gives.
SHARES = [(integrate_and_fire, 8), (torus_near_resonance, 18), (moebius_circle_map, 10), (slow_mode, 9),
          (slow_focus, 6), (slow_pitchfork, 5), (near_a_doubling, 14), (chaotic_map, 8), (impact_oscillator, 12),
          (walker, 6), (motion_that_ends, 4)]


def draw(random, count):
    """`count` systems in the shares above, the families in turn."""
    total = sum(share for _, share in SHARES)
    due = [((k + 0.5) * total / share, family)
           for family, share in SHARES for k in range(share * (count // total + 1))]
    return [family(random) for _, family in sorted(due, key=lambda pair: pair[0])[:count]]
