"""Systems drawn at random whose motions mislead: neutral ones, unbounded ones, transients, near folds, windows.

Where they settle on nothing, no command may speak of an attractor, a stable orbit or a torus. Why stands beside each.
"""

import math

from known_systems import System, Truth, clock, log_uniform

NOTHING = Truth("nothing")
SLOW = Truth("slow")  # it comes to the end as one over the time only: undecided is right, an attractor is not

# u -> u + om on a circle: every orbit is like every other one.
ROTATION = clock("om=0.3", "u=0.1", "u -> mod(u + om, 1)")


def rotation(random):
    return System("rotation of a circle", ROTATION, {"om": random.uniform(0.05, 0.95)}, {"u": random.random()}, NOTHING)


# Chirikov's map, areas are kept. Below K = 0.3 nearly all of its motions are on curves round the cylinder or an island.
TWIST = clock("K=0.2", "u=0.1, p=0.2", "u -> mod(u + p - K/6.283185307179586*sin(6.283185307179586*u), 1), "
              "p -> p - K/6.283185307179586*sin(6.283185307179586*u)")


def twist_map(random):
    if random.random() < 0.4:  # the elliptic fixed point
        return System("elliptic point", TWIST, {"K": random.uniform(0.05, 0.9)}, {"u": 0.0, "p": 0.0}, NOTHING)
    return System("twist map", TWIST, {"K": random.uniform(0.02, 0.3)},
                  {"u": random.random(), "p": random.uniform(0.1, 0.9)}, NOTHING)


# One degree of freedom, V = k x^2 / 2 + c x^4 / 4 + b sin x: each motion is closed, and so are those beside it.
OSCILLATOR = """par k=1, c=0, b=0
init x=1, v=0
x' = v
v' = -k*x - c*x^3 - b*cos(x)
event turn = v
after any: turn -> identity
"""


def oscillator(random):
    return System("one degree of freedom", OSCILLATOR,
                  {"k": random.uniform(0.3, 2), "c": random.uniform(0, 1), "b": random.uniform(-0.2, 0.2)},
                  {"x": random.uniform(0.5, 2), "v": 0.0}, NOTHING)


# A ball between two walls, without loss.
ELASTIC = """par g=1
init x=0.5, v=0
x' = v
v' = -g
event floor = x
event roof = 1 - x
jump bounce: v -> -v
after any: flow until floor -> bounce, roof -> bounce
"""


def elastic_ball(random):
    return System("elastic ball", ELASTIC, {"g": random.uniform(0.2, 3)},
                  {"x": random.uniform(0.2, 0.8), "v": random.uniform(0.1, 3)}, NOTHING)


# u -> -u, u -> u - c u^2 from above (0 repels below), r' = -c (r^2 - 1)^2 r from outside (repels inside).
FLIP = clock("c=1", "u=0.3", "u -> -u*(1 + 0*c)")
HALF = clock("c=1", "u=0.3", "u -> u - c*u^2")
HALF_CYCLE = """par c=1
init x=1.5, y=0
r2 = x^2 + y^2
g = -c*(r2 - 1)^2
x' = g*x - y
y' = g*y + x
event turn = y
after any: turn -> identity
"""


def half_stable(random):
    kind = random.randrange(3)
    if kind == 0:
        return System("flip", FLIP, {"c": 1.0}, {"u": random.uniform(0.1, 2)}, NOTHING)
    if kind == 1:
        return System("half-stable point", HALF, {"c": random.uniform(0.3, 1)}, {"u": random.uniform(0.1, 0.6)}, SLOW)
    return System("half-stable cycle", HALF_CYCLE, {"c": random.uniform(0.3, 2)}, {"x": random.uniform(1.1, 2), "y": 0.0},
                  SLOW)


# Beside the unit cycle X grows like t and Y, which is driven by it, like t^2; or a counter on which the cycle depends.
DRIFT = """par d=0.3
init a=1, b=0, X=0, Y=0
g = 1 - a^2 - b^2
a' = g*a - b
b' = g*b + a
X' = a + d
Y' = X
event turn = b
after any: turn -> identity
"""
COUNTER = clock("d=1", "p=0, u=0.1", "p -> p + d, u -> 0.5*sin(p)")


def growing(random):
    if random.random() < 0.5:
        return System("drift", DRIFT, {"d": random.uniform(0.05, 1)}, {"a": 1.0, "b": 0.0}, NOTHING)
    return System("counter", COUNTER, {"d": random.uniform(0.2, 3)}, {"p": 0.0, "u": 0.1}, NOTHING)


# u -> a u (1 - u) below the fold of its orbit of period 3 at a = 1 + sqrt 8: near it for long, and chaotic.
LOGISTIC = clock("a=3.8", "u=0.3", "u -> a*u*(1 - u)")


def ghost(random):
    a = 1 + math.sqrt(8) - log_uniform(random, 1e-12, 1e-6)
    return System("ghost of a fold", LOGISTIC, {"a": a}, {"u": random.uniform(0.1, 0.9)}, Truth("not periodic"))


# Doubling of an angle: doubles are at 0 after 53 iterations, which repels.
DOUBLING = clock("b=2", "u=0.3", "u -> mod(b*u, 1)")


def doubling(random):
    return System("doubling", DOUBLING, {"b": 2.0}, {"u": random.random()}, NOTHING)


# The windows of the logistic map: a stable orbit of up to 16 events, found by iterating here.
def window(random):
    while True:
        a = random.uniform(3.58, 3.99)
        u = 0.3
        for _ in range(4000):
            u = a * u * (1 - u)
        orbit = [u]
        for _ in range(17):
            orbit.append(a * orbit[-1] * (1 - orbit[-1]))
        period = next((q for q in range(1, 17) if abs(orbit[q] - u) < 1e-9), 0)
        if period:
            slope = math.prod(abs(a * (1 - 2 * x)) for x in orbit[:period])
            return System("window", LOGISTIC, {"a": a}, {"u": random.uniform(0.1, 0.9)},
                          Truth("periodic", period, float(period), slope))


# A billiard in a rectangle: regular; and Chirikov's map where nearly all of it is chaotic, on no attractor.
BILLIARD = """par L=1
init x=0.1, y=0.2, vx=1, vy=0.6180339887498949
x' = vx
y' = vy
vx' = 0
vy' = 0
event right = L - x
event left = x
event top = 1 - y
event bottom = y
jump sideways: vx -> -vx
jump upright: vy -> -vy
after any: right -> sideways, left -> sideways, top -> upright, bottom -> upright
"""
CHAOS = Truth("chaos without an attractor")


def billiard(random):
    return System("billiard", BILLIARD, {"L": random.uniform(0.5, 2)}, {"x": 0.1, "vy": random.uniform(0.3, 1.5)}, NOTHING)


def area_preserving(random):
    return System("conservative chaos", TWIST, {"K": random.uniform(6, 12)},
                  {"u": random.random(), "p": random.uniform(0.1, 0.9)}, CHAOS)


# The logistic map with a leak: chaotic for 1 / sqrt(e) iterations or so, then to u = -0.6, multiplier 1/2.
LEAK = clock("e=1e-2", "u=0.3", "u -> heav(u)*(4 + e)*u*(1 - u) + (1 - heav(u))*(0.5*u - 0.3)")


def transient(random):
    return System("transient chaos", LEAK, {"e": log_uniform(random, 1e-2, 1)}, {"u": random.uniform(0.1, 0.9)},
                  Truth("periodic", 1, 1.0, 0.5))


# Grebogi, Ott, Pelikan, Yorke (1984): x -> 2 s tanh(x) cos(2 pi th), th turns. For s > 1 the attractor is strange,
# and no exponent is positive.
STRANGE = clock("s=1.5", "x=0.3, th=0.1",
                "x -> 2*s*tanh(x)*cos(6.283185307179586*th), th -> mod(th + 0.6180339887498949, 1)")


def strange_nonchaotic(random):
    return System("strange", STRANGE, {"s": random.uniform(1.3, 2)}, {"x": random.uniform(0.1, 1), "th": random.random()},
                  Truth("strange nonchaotic"))


# The ghost of two fixed points: pi / sqrt(e) iterations long, then without bounds.
PASSAGE = clock("e=1e-7", "u=-0.5", "u -> u + e + u^2")
# x' = 1 + x^2 is infinite at t = pi / 2.
BLOW_UP = """par c=1
init tau=0, x=0
tau' = 1
x' = c + x^2
event tick = 0.1 - tau
jump again: tau -> 0
after any: tick -> again
"""
# A slow drift of a state on which the rest depends; one on which nothing depends is another matter.
SLOW_DRIFT = clock("d=1e-6", "p=0, u=0.1", "p -> p + d, u -> 0.5*sin(p) + 0.1*u")
ODOMETER = clock("d=1e-3", "p=0, u=0.1", "p -> p + d + u, u -> 0.5*u + 0.1")


def passage(random):
    return System("passage", PASSAGE, {"e": log_uniform(random, 1e-9, 1e-5)}, {"u": random.uniform(-0.9, -0.2)},
                  Truth("leaves"))


def blow_up(random):
    return System("blow-up", BLOW_UP, {"c": random.uniform(0.3, 3)}, {"x": random.uniform(-1, 1)}, Truth("leaves"))


def slow_drift(random):
    if random.random() < 0.5:
        return System("odometer", ODOMETER, {"d": random.uniform(0.01, 1)}, {"p": 0.0, "u": 0.1},
                      Truth("periodic", 1, 1.0))
    return System("slow drift", SLOW_DRIFT, {"d": log_uniform(random, 1e-6, 1e-2)}, {"p": 0.0, "u": 0.1}, SLOW)


FAMILIES = [rotation, twist_map, oscillator, elastic_ball, half_stable, growing, ghost, doubling, window, billiard,
            area_preserving, transient, strange_nonchaotic, passage, blow_up, slow_drift]


def draw(random, count):
    """The families in turn."""
    return [FAMILIES[k % len(FAMILIES)](random) for k in range(count)]
