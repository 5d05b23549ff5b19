"""Systems of other people, from textbooks and papers, as files of formulas; each settles on an orbit.

FOREIGN: name -> (formulas, options of `tchat simulate`, the parameter that a run frees, its bounds).
"""

import known_systems

# Izhikevich's neuron (2003), tonic bursting.
NEURON = """par I=24, a=0.02, b=0.2, c=-50, d=2
init v=-55, u=-8
v' = 0.04*v^2 + 5*v + 140 - u + I
u' = a*(b*v - u)
event peak = 30 - v
jump reset: v -> c, u -> u + d
after any: peak -> reset
"""

FORCED = "growth = 1 - s^2 - q^2\ns' = growth*s + omega*q\nq' = growth*q - omega*s\n"

# The cubic oscillator, hard; its phase is the section.
DUFFING = "par A=0.3, omega=1.2, d=0.1\ninit x=0, v=0, s=0, q=1\nx' = v\nv' = A*q - d*v - x - x^3\n" + FORCED + \
    "event phase = s\nafter any: phase -> identity\n"

PENDULUM = "par A=0.6, omega=2.1, d=0.1, r=0.7\ninit x=0.3, v=0, s=0, q=1\nx' = v\n" \
    "v' = A*q - d*v - sin(x)\n" + FORCED + "event stop = x + 0.1\njump impact: v -> -r*v\nafter any: stop -> impact\n"

# A ball between two walls of a box that is shaken.
IMPACT_PAIR = "par A=1, omega=2, r=0.6\ninit x=0, v=1, s=0, q=1\nx' = v\nv' = A*q - 0.02*v\n" + FORCED + \
    "event right = 1 - x\nevent left = 1 + x\njump impact: v -> -r*v\nafter any: right -> impact, left -> impact\n"

BELT = """par V=0.2, zeta=0.05, static=1.5, sliding=1
init x=0, v=0
spring = -2*zeta*v - x
x' = v
field slip
v' = sliding + spring
field stick
v' = 0
event catch = V - v
event release = static + spring
jump hold: v -> V
after hold: stick until release -> identity
after any: slip until catch -> hold
"""

THERMOSTAT = """par high=1, low=0.4, power=2, k=0.7
init x=0.5, y=0.5
y' = k*(x - y)
field heating: x' = power - x
field cooling: x' = -x + 0.1*y
event hot = high - y
event cold = y - low
after hot: cooling until cold -> identity
after any: heating until hot -> identity
"""

# A mass on a springy leg: at the deepest point the leg is made longer by `push`.
HOPPER = """par k=20, c=0.3, push=0.1
init x=1.3, v=0
x' = v
field flight: v' = -1
field landing: v' = k*(1 - x) - c*v - 1
field thrust: v' = k*(1 + push - x) - c*v - 1
event touch_down = x - 1
event deepest = -v
event lift_off = 1 + push - x
after touch_down: landing until deepest -> identity
after deepest: thrust until lift_off -> identity
after any: flight until touch_down -> identity
"""


def smooth(parameters, start, equations, section):
    """A smooth system with a section."""
    return "par %s\ninit %s\n%s\nevent section = %s\nafter any: section -> identity\n" % (parameters, start, equations,
                                                                                       section)


LORENZ = smooth("rho=160, sigma=10, beta=8/3", "x=20, y=30, z=150",
                "x' = sigma*(y - x)\ny' = rho*x - y - x*z\nz' = x*y - beta*z", "z - 159")
ROESSLER = smooth("c=2.5, a=0.2, b=0.2", "x=3, y=0, z=0.1", "x' = -y - z\ny' = x + a*y\nz' = b + z*(x - c)", "y")
VAN_DER_POL = smooth("mu=2", "x=2, y=0", "x' = y\ny' = mu*(1 - x^2)*y - x", "x")
BRUSSELATOR = smooth("B=2.5, A=1", "x=1.5, y=2", "x' = A - (B + 1)*x + x^2*y\ny' = B*x - x^2*y", "x - A")
FITZHUGH = smooth("I=0.5, a=0.7, b=0.8, e=0.08", "v=1, w=0.5", "v' = v - v^3/3 - w + I\nw' = e*(v + a - b*w)", "v")
MORRIS_LECAR = smooth("I=90, phi=0.04", "v=-20, n=0.1",
                      "m = (1 + tanh((v + 1.2)/18))/2\nninf = (1 + tanh((v - 2)/30))/2\n"
                      "v' = (I - 2*(v + 60) - 4.4*m*(v - 120) - 8*n*(v + 84))/20\n"
                      "n' = phi*(ninf - n)*cosh((v - 2)/60)", "v")
CHUA = smooth("alpha=8.3, beta=14.3", "x=1, y=0.1, z=-1",
              "x' = alpha*(y - x^3/16 + x/6)\ny' = x - y + z\nz' = -beta*y", "y")
SUBCRITICAL = smooth("mu=-0.1, w=1", "x=1, y=0",
                     "r2 = x^2 + y^2\nx' = (mu + r2 - r2^2)*x - w*y\ny' = (mu + r2 - r2^2)*y + w*x", "y")
HINDMARSH_ROSE = smooth("I=4, b=3, r=0.01", "x=0, y=0, z=3.5",
                        "x' = y - x^3 + b*x^2 - z + I\ny' = 1 - 5*x^2 - y\nz' = r*(4*(x + 1.6) - z)", "x")
SELKOV = smooth("b=0.6, a=0.1", "x=0.6, y=1.2", "x' = -x + a*y + x^2*y\ny' = b - a*y - x^2*y", "x - b")
# The peroxidase-oxidase reaction.
STEINMETZ_LARTER = smooth("k8=0.5, k7=1.5", "A=6, B=10, X=0.01, Y=0.05",
                          "f = 0.1631021*A*B*X\ng = 0.046875*A*B*Y\nA' = -f - g + k7 - 0.1175*A\nB' = -f - g + k8\n"
                          "X' = f - 2500*X^2 + 2*g - 20*X + 0.001\nY' = -g + 2500*X^2 - 1.104*Y", "A - 7")
REPRESSILATOR = smooth("a=10, n=4", "x=1, y=2, z=3",
                       "x' = a/(1 + z^n) - x\ny' = a/(1 + x^n) - y\nz' = a/(1 + y^n) - z", "x - 1.5")

FOREIGN = {
    "neuron": (NEURON, [], "I", (5, 60)),
    "walker": (known_systems.WALKER, ["--state", "th=0.20031,w=-0.19983,ph=0.40062,p=-0.015754"], "gamma",
               (0.001, 0.03)),
    "integrateandfire": (known_systems.INTEGRATE_AND_FIRE, [], "a", (0.5, 3)),
    "impactoscillator": (known_systems.IMPACT_OSCILLATOR, ["PAR(A)=3.6"], "A", (0.5, 6)),
    "duffing": (DUFFING, [], "omega", (0.3, 3)),
    "pendulum": (PENDULUM, [], "A", (0.1, 2)),
    "impactpair": (IMPACT_PAIR, [], "A", (0.3, 4)),
    "belt": (BELT, [], "V", (0.02, 2)),
    "thermostat": (THERMOSTAT, [], "power", (1.05, 6)),
    "hopper": (HOPPER, [], "push", (0.01, 0.5)),
    "lorenz": (LORENZ, [], "rho", (140, 200)),
    "roessler": (ROESSLER, [], "c", (1, 8)),
    "vanderpol": (VAN_DER_POL, [], "mu", (0.05, 20)),
    "brusselator": (BRUSSELATOR, [], "B", (1.9, 8)),
    "fitzhugh": (FITZHUGH, [], "I", (0.2, 1.6)),
    "morrislecar": (MORRIS_LECAR, [], "I", (30, 250)),
    "chua": (CHUA, [], "alpha", (6, 12)),
    "subcritical": (SUBCRITICAL, [], "mu", (-0.3, 0.5)),
    "hindmarshrose": (HINDMARSH_ROSE, [], "I", (1, 6)),
    "selkov": (SELKOV, [], "b", (0.3, 0.9)),
    "steinmetzlarter": (STEINMETZ_LARTER, [], "k8", (0.3, 0.8)),
    "repressilator": (REPRESSILATOR, [], "a", (2, 50)),
}
