"""Runs for normal_forms.py: smooth systems from papers, with and without a section; tests/end_to_end/systems."""

# Smooth systems, without a section and with one. Genesio's and Tesi's feedback control, Automatica 28 (1992) 531.
CONTROL = """par alpha=0.8, beta=1
init x=0.1, y=0, z=0
x' = y
y' = z
z' = -alpha*z - beta*y - x + x^2
"""
# An electronic circuit: E. Freire, A. J. Rodriguez-Luis, E. Gamero, E. Ponce, Physica D 62 (1993) 230.
CIRCUIT = """par nu=-0.605, beta=0.5, gamma=-0.6, r=0.6, a3=0.32858, b3=0.93358, epsilon=0.001
init x=0.28, y=0.06, z=0.24
x' = (-(beta + nu)*x + beta*y - a3*x^3 + b3*(y - x)^3)/r
y' = beta*x - (beta + gamma)*y - z - b3*(y - x)^3
z' = y + epsilon
"""
# The peroxidase-oxidase reaction: C. G. Steinmetz, R. Larter, J. Chem. Phys. 94 (1991) 1388.
REACTION = """par k8=0.8, k7=1.5, k1=0.1631021, k2=1250, k3=0.046875, k4=20, k5=1.104, k6=0.001, km7=0.1175
init A=9.9, B=13.4, X=0.01, Y=0.02
one = k1*A*B*X
three = k3*A*B*Y
growth = k7 - km7*A - one - three
A' = growth
B' = k8 - one - three
X' = one - 2*k2*X^2 + 2*three - k4*X + k6
Y' = 2*k2*X^2 - three - k5*Y
"""
# A neuron's fast variables: C. Morris, H. Lecar, Biophys. J. 35 (1981) 193.
NEURON = """par y=0.08, z=0.1
init v=-0.1, w=0.2
v' = y - 0.5*(v + 0.5) - 2*w*(v + 0.7) - (1 + tanh((v + 0.01)/0.15))/2*(v - 1)
w' = 1.15*((1 + tanh((v - z)/0.145))/2 - w)*cosh((v - 0.1)/0.29)
"""
# Where y falls, and where A does.
CUT = "event falls = y\nafter any: falls -> identity\n"
CUT_REACTION = "event falls = growth\nafter any: falls -> identity\n"

# Name, formulas (none: of tests/end_to_end/systems), the parameter that a run frees, settings of the run.
SYSTEMS = [
    ("two_walls", None, "omega", ["RL1=5"]),
    ("two_walls", None, "F", ["DS=-0.01", "RL0=0.01"]),
    ("two_walls", None, "zeta", ["RL1=1"]),
    ("two_walls", None, "r", ["RL1=2"]),
    ("izhikevich", None, "c", ["RL1=-40", "NTST=80", "NCOL=6", "NMX=150", "DSMAX=0.5"]),
    ("drill_string", None, "torque", ["RL1=20", "DSMAX=0.5"]),
    ("control", CONTROL, "alpha", ["DS=-0.01", "RL0=-0.9", "NTST=80"]),
    ("control_cut", CONTROL + CUT, "alpha", ["DS=-0.01", "RL0=-0.9", "NTST=80"]),
    ("circuit", CIRCUIT, "nu", ["RL0=-0.7", "DS=0.01", "NTST=80", "--both"]),
    ("circuit_cut", CIRCUIT + CUT, "nu", ["RL0=-0.7", "DS=0.01", "NTST=80", "--both"]),
    ("reaction", REACTION, "k8", ["RL1=1", "NTST=100"]),
    ("reaction_cut", REACTION + CUT_REACTION, "k8", ["RL1=1", "NTST=100"]),
    ("neuron", NEURON, "y", ["RL0=0.05", "DS=0.005", "DSMAX=0.02", "NTST=80"]),
]
