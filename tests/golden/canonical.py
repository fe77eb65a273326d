"""Canonical form of result files: places with their values, in old names. golden.py says what is compared."""
import csv
import functools
import hashlib
import io
import itertools
import json
import os
import re

#: Places and columns that depend on the machine.
MACHINE = re.compile(r"(?<![^.])(timings?|wall_s|cpu_s|\w+_cpu_s|stage_\w+_s|elapsed_s|seconds)(?![^.])")
#: Old names of keys and columns whose words are compared, too.
KEPT = {"label", "group", "together_with", "separates", "verdict", "snap_type", "status", "quantity"}
#: Numbers and 64-bit hashes of a printed text.
PRINTED = re.compile(r"\b[0-9a-f]{16}\b|[-+]?\b\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


class Number(str):
    """A JSON number as it is printed."""


def read_table():
    """Rows of renamed.csv as (new name, pattern, old name)."""
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "renamed.csv")
    with open(path, encoding="utf-8", newline="") as file:
        rows = [(row["new"], row["old"]) for row in csv.DictReader(file)]
    table = []
    for new, old in rows:
        pattern = r"(?<![^.])" + r"([^.]+)".join(re.escape(part) for part in new.split("*")) + r"(?![^.])"
        parts = old.split("*")
        table.append((new, re.compile(pattern),
                      parts[0] + "".join(f"\\g<{i}>{part}" for i, part in enumerate(parts[1:], 1))))
    return table


TABLE = read_table()


@functools.lru_cache(maxsize=None)
def old_name(path):
    """The path in old names; None if it is not compared."""
    for new, pattern, old in TABLE:
        if new.rsplit(".", 1)[-1] in path or "*" in new:
            if old == "-" and pattern.search(path):
                return None
            path = pattern.sub(old, path)
    return None if MACHINE.search(path) else path


def scalar(value, key):
    """A scalar as text; None if it is a word that is not compared."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, Number):
        return str(value)
    return old_name(value) if key in KEPT else None


def add_json(value, path, places):
    """Adds the places of a JSON value."""
    if isinstance(value, dict):
        for key, child in value.items():
            add_json(child, f"{path}.{key}" if path else key, places)
        return
    old = old_name(path)
    if old is None:
        return
    key = re.sub(r"(\.\d+)+$", "", old).rsplit(".", 1)[-1]
    items = value if isinstance(value, list) else [value]
    words = [scalar(v, key) for v in items if not isinstance(v, (dict, list))]
    if any(w is not None for w in words):
        places[old] = [w for w in words if w is not None]
    for i, child in enumerate(items):
        if isinstance(child, (dict, list)):
            add_json(child, f"{path}.{i}", places)


def cell(text, column):
    """A cell of a CSV file; empty if it is a word that is not compared."""
    try:
        float(text or 0)
        return text
    except ValueError:
        return (old_name(text) or "") if column in KEPT else ""


def add_csv(name, text, places):
    """Adds the places of a CSV file."""
    rows = list(csv.reader(io.StringIO(text)))
    head = [old_name(column) for column in rows[0]]
    kept = [i for i, column in enumerate(head) if column is not None]
    body = [[cell(row[i], head[i]) for i in kept] for row in rows[1:]]
    head = [head[i] for i in kept]
    if name == "results.csv":
        places.update({f"column {column}": [row[i] for row in body] for i, column in enumerate(head)})
    elif name == "statistics.csv":
        at = head.index("quantity")
        places.update({f"{row[at]} at {','.join(row[:at])}": row[at + 1:] for row in body if row[at]})
    else:
        places.update({f"line {i}": row for i, row in enumerate(body, 2)})


def canonical(name, text):
    """{place: values} of a file."""
    places = {}
    if name.endswith(".json"):
        add_json(json.loads(text, parse_int=Number, parse_float=Number, parse_constant=Number), "", places)
    elif name.endswith(".csv"):
        add_csv(name, text, places)
    else:
        places["values"] = PRINTED.findall(text)
    return {f"{name}: {place}": values for place, values in places.items()}


def sum_of(places):
    """SHA-256 of the canonical form."""
    return hashlib.sha256("".join(f"{p}\t{','.join(places[p])}\n" for p in sorted(places)).encode()).hexdigest()


def differences(old, new):
    """A sentence about each place that differs, in the order of the files; changed values come first."""
    changed, missing = [], []
    for place in [*old, *(place for place in new if place not in old)]:
        a, b = old.get(place), new.get(place)
        if a is None or b is None:
            missing.append(f"{place}: only the {'new' if a is None else 'old'} build has it: {','.join(a or b)[:80]}")
        elif a != b:
            i = next(i for i, (x, y) in enumerate(itertools.zip_longest(a, b), 1) if x != y)
            changed.append(f"{place}, value {i}: {(a[i - 1:] or ['none'])[0]} | {(b[i - 1:] or ['none'])[0]}")
    return changed + missing
