"""How a problem is written in other words: units, order, an idle state, a rotated signature, factors of events.

A Rewriting draws the numbers. A ProblemRewriting applies them to a problem of `problems`: to its source, constants,
data and to the words of commands.
"""

import random
import re

# What a rewriting may change; "units" stands for the first four.
UNITS = ("states", "time", "parameters", "values")
KINDS = (*UNITS, "order", "idle", "signature", "events")
# PAR(61), PAR(62), ... are the durations.
FIRST_DURATION = 61
# Bounds from here on are none.
NO_BOUND = 1e300
# Constants that have one entry for each segment.
OF_SEGMENTS = ("GCSEGTYP", "GCFIND", "GCHIND", "GCGIND", "GCHGRZIND")


class Rewriting:
    """Numbers drawn from a seed. Each depends on its own name alone, so that it is the same if others are left out."""

    def __init__(self, seed, decades, kinds=KINDS, names=None):
        self.seed, self.decades, self.kinds, self.names = seed, decades, kinds, names
        self.used = {}  # names by their kind

    def draw(self, *words):
        return random.Random(" ".join(str(word) for word in (self.seed, *words)))

    def of(self, kind, name):
        """The unit of a state, parameter or user value; the factor of an event function; the unit of time."""
        self.used.setdefault(kind, set()).add(name)
        if kind not in self.kinds or (self.names is not None and name not in self.names):
            return 1.0
        return 10.0**self.draw(kind, name).uniform(-self.decades, self.decades)

    @property
    def time(self):
        return self.of("time", "time")

    def order(self, kind, names):
        names = list(names)
        if "order" in self.kinds:
            self.draw("order", kind).shuffle(names)
        return names

    @property
    def idle(self):
        """The value of a state on which nothing depends, or None. Half of all rewritings have one."""
        draw = self.draw("idle")
        if "idle" not in self.kinds or draw.random() < 0.5:
            return None
        return 10.0**draw.uniform(-self.decades, self.decades)

    def rotation(self, segments):
        """How many segments move from the start of a signature to its end."""
        if "signature" not in self.kinds or segments < 2:
            return 0
        return self.draw("signature").randrange(1, 1000) % segments


class Unchanged(Rewriting):
    def __init__(self):
        super().__init__("", 0.0, ())


def items(text):
    """'a=1, b=8/3' as [('a', '1'), ('b', '8/3')]."""
    return [tuple(part.strip() for part in item.split("=", 1)) for item in text.split(",")]


def rotated(entries, by):
    return entries[by:] + entries[:by]


def list_of(text):
    """The entries of '[omega, 61, start(wall,2)]', and of one without brackets."""
    return re.findall(r"[^\s,()\[\]]+(?:\([^)]*\))?", text)


def lists_of(text):
    """'[[1], [2, 1]]' as [['1'], ['2', '1']]."""
    return [list_of(inner) for inner in re.findall(r"\[([^\[\]]*)\]", text)]


def pairs_of(text):
    """'{A: [1, 2], -61: 0}' as [('A', ['1', '2']), ('-61', ['0'])]."""
    found = re.findall(r"(-?[^\s,:{}()\[\]-]+(?:\([^)]*\))?)\s*:\s*(\[[^\]]*\]|[^\s,{}\[\]]+)", text)
    return [(key, list_of(values)) for key, values in found]


def constants_of(text):
    """What `tchat constants --keyword` prints, as texts by key."""
    lines = (line.split("#")[0].split("=", 1) for line in text.splitlines())
    return {words[0].strip(): words[1].strip() for words in lines if len(words) == 2}


def text_of_constants(constants):
    return "".join("%s = %s\n" % pair for pair in constants.items())


def rotated_constants(constants, by):
    """Those of the same orbit, the segment 1 + `by` first. Durations and numbers of contacts move with the segments."""
    if by == 0:
        return constants
    lists = {key: lists_of(constants[key][1:-1]) if key == "GCHGRZIND" else list_of(constants[key])
             for key in OF_SEGMENTS}
    changed = dict(constants)
    for key, entries in lists.items():
        texts = ["[%s]" % ", ".join(entry) if isinstance(entry, list) else entry for entry in rotated(entries, by)]
        changed[key] = "[%s]" % ", ".join(texts)
    segments = len(lists["GCFIND"])
    changed["ICP"] = "[%s]" % ", ".join(moved_segment(name, segments, by) for name in list_of(constants["ICP"]))
    changed["THL"] = "{%s}" % ", ".join("%s: %s" % (moved_segment(name, segments, by), values[0])
                                        for name, values in pairs_of(constants["THL"]))
    contacts = [(s, event) for s, events in enumerate(lists["GCHGRZIND"]) for event in events]
    now = [(s, event) for s in rotated(list(range(segments)), by) for event in lists["GCHGRZIND"][s]]
    numbers = sorted(now.index(contacts[int(k) - 1]) + 1 for k in list_of(constants["GCIPSI"]))
    changed["GCIPSI"] = "[%s]" % ", ".join(str(k) for k in numbers)
    return changed


def moved_segment(quantity, segments, by):
    """A duration, or a monitor of a segment, by the number that the segment has after a rotation."""
    if by == 0:
        return quantity

    def number(s):
        return (int(s) - 1 - by) % segments + 1
    if re.fullmatch(r"\d+", quantity):
        k = int(quantity)
        return quantity if k < FIRST_DURATION else str(FIRST_DURATION - 1 + number(k - FIRST_DURATION + 1))
    if re.fullmatch(r"T\d+", quantity):
        return "T%d" % number(quantity[1:])
    quantity = re.sub(r"(?<=,)\s*\d+(?=\))", lambda m: str(number(m[0])), quantity)
    return re.sub(r"(?<=velocity\()\d+(?=\))", lambda m: str(number(m[0])), quantity)


def rotated_data(text, by):
    """The rows of a .dat file whose segments stand side by side, and its durations."""
    durations = [value for _, value in re.findall(r"# PAR\((6[1-9]|[7-9]\d)\) = (\S+)", text)]
    segments = len(durations)
    lines = [line for line in text.splitlines() if re.match(r"# PAR\(([1-9]|[1-5]\d|60)\)", line)]
    lines += ["# PAR(%d) = %s" % (FIRST_DURATION + s, value) for s, value in enumerate(rotated(durations, by))]
    for line in text.splitlines():
        if line and not line.startswith("#"):
            words = line.split()
            n = (len(words) - 1) // segments
            blocks = [words[1 + s * n:1 + (s + 1) * n] for s in range(segments)]
            lines.append(" ".join(words[:1] + sum(rotated(blocks, by), [])))
    return "\n".join(lines) + "\n"


class ProblemRewriting:
    """The names of a problem, which it keeps, and what becomes of values and numbers."""

    def __init__(self, source, by):
        self.source, self.by = source, by
        text = source.read_text()
        self.states, self.parameters, self.events, self.values = (
            self.listed(text, kind) for kind in ("state", "parameter", "event", "user_value"))
        self.new_states = by.order("states", self.states + (["idle"] if by.idle is not None else []))
        self.new_parameters = by.order("parameters", self.parameters)

    @staticmethod
    def listed(text, kind):
        names = re.search(r"\b%s_names\[\]\s*=\s*\{([^}]*)\}" % kind, text)
        return re.findall(r'"([^"]*)"', names[1]) if names else []

    def plugin(self, generic):
        """The source of the rewritten problem; `generic`: the path of rewritten_problem.cpp."""
        def array(kind, name, values):
            return "constexpr %s %s[] = {%s};\n" % (kind, name, ", ".join(str(value) for value in values))

        def units(kind, names):
            return [repr(self.by.of(kind, name)) for name in names] or ["1.0"]
        order = [self.states.index(name) if name != "idle" else -1 for name in self.new_states]
        return ('#define REWRITTEN_SOURCE "%s"\nnamespace rewriting {\n' % self.source +
                "constexpr double time_unit = %r, idle = %r;\n" % (self.by.time, self.by.idle or 0.0) +
                array("double", "state_units", units("states", self.states)) +
                array("double", "parameter_units", units("parameters", self.parameters)) +
                array("double", "event_factors", units("events", self.events)) +
                array("double", "value_units", units("values", self.values)) + array("int", "state_order", order) +
                array("int", "parameter_order", [self.parameters.index(name) for name in self.new_parameters]) +
                '}\n#include "%s"\n' % generic)

    def name_of(self, quantity, parameters=None):
        """A parameter by its name instead of its number; a rotation number is PAR(60)."""
        if not quantity.isdigit() or int(quantity) >= FIRST_DURATION:
            return quantity
        return "rho" if int(quantity) == FIRST_DURATION - 1 else (parameters or self.parameters)[int(quantity) - 1]

    def unit(self, quantity):
        """The unit of a quantity of the constants, by its name."""
        if quantity in self.parameters:
            return self.by.of("parameters", quantity)
        if quantity in self.values:
            return self.by.of("values", quantity)
        if quantity in self.states:
            return self.by.of("states", quantity)
        if quantity in self.events:
            return 1.0 / self.by.of("events", quantity)
        if quantity == "period" or re.fullmatch(r"\d+|T\d+", quantity):
            return self.by.time
        if quantity == "rho":
            return 1.0
        monitor = re.fullmatch(r"(min|max|mean|start|end)\(([^,()]+)(,\s*\d+)?\)", quantity)
        if monitor:
            return self.unit(monitor[2])
        raise ValueError("a quantity of unknown unit: " + quantity)

    def value(self, text, quantity):
        number = float(text)
        if abs(number) >= NO_BOUND or number == 0.0:
            return text
        return repr(number / self.unit(quantity))

    def constant(self, key, text, first, segments=1, by=0):
        """One constant, rewritten; `first`: ICP(1), whose bounds RL0 and RL1 are; `by`: rotation of the segments."""
        def quantity(name):
            return moved_segment(self.name_of(name), segments, by)
        if key == "NDIM":
            return str(len(self.new_states))
        if key == "NBC" and self.by.idle is not None and int(text) > 0:
            return str(int(text) + 1)
        if key == "ICP":
            return "[%s]" % ", ".join(quantity(name) for name in list_of(text))
        if key in ("RL0", "RL1"):
            return self.value(text, first)
        if key in ("UZR", "HOLD", "THL") and text.startswith("{"):
            changed = []
            for name, values in pairs_of(text):
                plain = self.name_of(name.lstrip("-"))
                if key == "THL":
                    new = repr(float(values[0]) * self.unit(plain)**2)
                else:
                    new = "[%s]" % ", ".join(self.value(value, plain) for value in values)
                changed.append("%s%s: %s" % ("-" * name.startswith("-"), quantity(plain), new))
            return "{%s}" % ", ".join(changed)
        parameter = re.fullmatch(r"PAR\((.*)\)", key)
        if parameter:
            return self.value(text, self.name_of(parameter[1]))
        if key == "THU" and text != "{}":
            raise ValueError("weights of states in a pipeline")
        return text

    def constants(self, constants, rotation):
        """Those of a file of the original."""
        first = self.name_of((list_of(constants["ICP"]) or ["?"])[0])
        changed = {key: self.constant(key, text, first) for key, text in constants.items()}
        return rotated_constants(changed, rotation)

    def data(self, text):
        """A .dat file: rows t, x of segment 1, x of segment 2, ..., or of one state x."""
        lines = []
        for line in text.splitlines():
            value = re.match(r"# PAR\((\w+)\) = (\S+)", line)
            if value:
                name = self.name_of(value[1])
                lines.append("# PAR(%s) = %s" % (name, self.value(value[2], name)))
            elif line and not line.startswith("#"):
                words, n = line.split(), len(self.states)
                time = [repr(float(words[0]) / self.by.time)] if len(words) % n == 1 else []
                states = words[len(time):]
                for s in range(0, len(states), n):
                    time += [self.state(name, states[s:s + n]) for name in self.new_states]
                lines.append(" ".join(time))
        return "\n".join(lines) + "\n"

    def state(self, name, states):
        if name == "idle":
            return repr(self.by.idle)
        return repr(float(states[self.states.index(name)]) / self.by.of("states", name))

    def weights(self, constants):
        """THU and THL for a run whose file of constants, already rewritten, this is: each state, parameter and duration
        has the weight 1 in the units of the original, if the file gives it none. So steps are compared by equal norms.
        """
        states = ["%d: %r" % (a + 1, self.by.of("states", name)**2 if name != "idle" else 0.0)
                  for a, name in enumerate(self.new_states)]
        given = {self.new_name(name): values[0] for name, values in pairs_of(constants.get("THL", "{}"))}
        wanted = {name: repr(self.unit(name)**2) for name in self.parameters}
        if constants["IPS"] in ("180", "150", "4", "182", "152"):
            for s in range(len(list_of(constants.get("GCFIND", "[1]")))):
                wanted[str(FIRST_DURATION + s)] = repr(self.by.time**2)
        return ["THU={%s}" % ", ".join(states),
                "THL={%s}" % ", ".join("%s: %s" % pair for pair in {**wanted, **given}.items())]

    def new_name(self, quantity):
        """As name_of, of a file of constants of the rewritten problem."""
        return self.name_of(quantity, self.new_parameters)
