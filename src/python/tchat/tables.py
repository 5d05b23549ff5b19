"""Tables that tchat prints as CSV, as dictionaries of columns."""

import csv
import io

import numpy as np

_TEXTS = ("type", "name", "kind", "signature", "free", "normal_form", "verdict", "meaning")
_INTEGERS = ("section", "branch", "point", "label", "problem_type", "branch_mode", "segments", "dimension",
             "mesh_intervals", "collocation_points", "segment")


def _column(heading, fields):
    if heading in _TEXTS:
        return np.array(fields, dtype=object)
    numbers = np.array([float(field) if field else np.nan for field in fields])
    whole = heading in _INTEGERS and not np.isnan(numbers).any()
    return numbers.astype(int) if whole else numbers


def read_table(text):
    """Columns by their headings: texts as objects, numbers as floats, NaN where nothing is known."""
    rows = list(csv.reader(io.StringIO(text)))
    return {heading: _column(heading, [row[k] for row in rows[1:]]) for k, heading in enumerate(rows[0])}


def as_frame(columns):
    """The columns as a pandas.DataFrame."""
    from .program import Error
    try:
        import pandas
    except ImportError:
        raise Error("frame() needs pandas (Debian: python3-pandas)") from None
    return pandas.DataFrame(columns)
