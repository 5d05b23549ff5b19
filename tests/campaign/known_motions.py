"""Systems drawn at random whose motions settle on nothing: neutral ones, unbounded ones, transients, near folds.

No command may call what it sees there an attractor, a stable orbit or a torus. Why each has none stands beside it.
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


FAMILIES = [rotation, twist_map, oscillator, elastic_ball, half_stable, growing, ghost, doubling]


def draw(random, count):
    """The families in turn."""
    return [FAMILIES[k % len(FAMILIES)](random) for k in range(count)]
