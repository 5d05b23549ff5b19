"""The words of a command from Python's keywords: constants by their names, everything else a parameter."""

import functools
import re

from .program import Error, constant_word, execute


@functools.lru_cache(maxsize=None)
def constant_names(program=None):
    """The names of all constants, as tchat lists them."""
    return frozenset(re.findall(r"^([A-Z][A-Z0-9]*) {2,}", execute(["constants"], program=program), re.MULTILINE))


def value_words(values, program=None):
    """NTST=80 stays a constant, omega=2 becomes PAR(omega)=2; par={"DS": 1} is a parameter in any case."""
    values = dict(values)
    parameters = dict(values.pop("par", {}))
    known = constant_names(program)
    words = []
    for key, value in values.items():
        if key in known:
            words.append(constant_word(key, value))
        else:
            parameters[key] = value
    return words + [constant_word("PAR(%s)" % key, _number(value)) for key, value in parameters.items()]


def split_bounds(values, program=None):
    """Those that are a pair of numbers and no constant, the bounds of a parameter; and the others."""
    known = constant_names(program)
    bounds = {key: value for key, value in values.items()
              if key not in known and isinstance(value, (tuple, list)) and len(value) == 2}
    return bounds, {key: value for key, value in values.items() if key not in bounds}


def _number(value):
    """With all its digits."""
    return repr(float(value)) if isinstance(value, (int, float)) else value


def option_words(options):
    """--transient-events 60 of transient_events=60; True is the option alone, None and False are none."""
    words = []
    for key, value in options.items():
        if value is None or value is False:
            continue
        words.append("--" + key.replace("_", "-"))
        if value is not True:
            words.append(value)
    return words


def state_word(state):
    """A state as --state takes it, from a dictionary or a list."""
    if state is None or isinstance(state, str):
        return state
    try:
        if isinstance(state, dict):
            return ",".join("%s=%r" % (name, float(value)) for name, value in state.items())
        return ",".join(repr(float(value)) for value in state)
    except (TypeError, ValueError):
        raise Error("state=%r: give numbers, as a list of all states or a dictionary by name" % (state,)) from None
