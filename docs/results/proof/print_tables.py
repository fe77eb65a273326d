#!/usr/bin/env python3
"""Prints the tables of docs/results/diagnosis_earlier.md from the CSV files beside this script.

    print_tables.py                 prints every table as Markdown
    print_tables.py --check PAGE    exit 1 and a message if a table is missing from the page or differs
    print_tables.py --cases SET     what was hidden and what was said in one set, for example blind_2047

cases.csv        first diagnosis of every case: one row a case
  set_up         P1 shell on a cylinder, P2 two shells, P3 strip, P4 arch
  strength       strong, weak, limit (near the detection limit), snaps (nothing hidden, the force jumps)
  hidden         label; "a+b" two effects; "removed:" taken out of the catalogue; "outside:" never in it
  right          1 if the verdict is right: nothing hidden and none claimed; outside_catalogue where the effect
                 is not in the catalogue; else the first effect, or one confounded with it, is (one of) the hidden
  p_truth        probability that the diagnosis gave to the truth
  detectable     signal of the best possible test, sigma; empty in blind_2027, which measured it otherwise
  overlap, overlap_visible   intersection over union, in time, of misfit_intervals and of visible_intervals with the
                 intervals in which the hidden effect shows
  follow_up      conclusive or uncertain: what the diagnosis expected of the next experiment it proposed;
                 counted: the reference simulator is sure of that run; resolved: the second diagnosis is right and sole
reliability.csv  said: mean probability of the first effect in a bin; true: share of the n single effects that it is
scores.csv       scores that need more than one row a case (Brier score, coverage of the 90 % intervals)
"""

import csv
import math
import os
import statistics
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
LATEST = ["blind_2043", "blind_2044", "blind_2047"]
CLAIMS = {"identified", "ambiguous", "outside_catalogue"}  # verdicts that say that something is missing
Z90 = 1.6448536269514722


def read(name):
    with open(os.path.join(HERE, name), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def wilson(hits, n):
    """90 % interval of a share (E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209)."""
    if n == 0:
        return 0.0, 1.0
    p, z2 = hits / n, Z90 * Z90
    centre, half = p + z2 / (2 * n), Z90 * math.sqrt(p * (1 - p) / n + z2 / (4 * n * n))
    return max(0.0, (centre - half) / (1 + z2 / n)), min(1.0, (centre + half) / (1 + z2 / n))


def median_interval(values):
    """Order statistics that hold the median with at least 90 % (binomial)."""
    v, n = sorted(values), len(values)
    below, k = 0.0, 0
    while k < n // 2 and below + math.comb(n, k) / 2 ** n <= 0.05:
        below += math.comb(n, k) / 2 ** n
        k += 1
    return (v[k - 1], v[n - k]) if k > 0 else (v[0], v[-1])


class Share:
    def __init__(self, rows, hit):
        self.n, self.hits = len(rows), sum(1 for r in rows if hit(r))

    def __str__(self):
        return f"{self.hits} of {self.n}" if self.n else "-"

    def interval(self):
        low, high = wilson(self.hits, self.n)
        return f"{low:.2f} to {high:.2f}"


class Median:
    def __init__(self, rows, column, digits, unit=""):
        self.values = [float(r[column]) for r in rows if r[column] != ""]
        self.digits, self.unit = digits, unit

    def number(self, v):
        return f"{v:.{self.digits}f}{self.unit}"

    def __str__(self):
        return f"{self.number(statistics.median(self.values))} ({len(self.values)})" if self.values else "-"

    def interval(self):
        if not self.values:
            return ""
        low, high = median_interval(self.values)
        return f"{self.number(low)} to {self.number(high)}"


def hides(r):
    return r["hidden"] != "nothing"


def outside(r):
    return ":" in r["hidden"]


def single(r):
    return hides(r) and not outside(r) and "+" not in r["hidden"]


def claims(r):
    return r["verdict"] in CLAIMS


def right(r):
    return r["right"] == "1"


def scores_of(rows):
    """(name, share or median, wanted) of some cases."""
    detected_singles = [r for r in rows if single(r) and claims(r)]
    return [
        ("strong effects detected", Share([r for r in rows if r["strength"] == "strong"], claims), ">= 0.95"),
        ("weak effects detected", Share([r for r in rows if r["strength"] in ("weak", "limit")], claims), ""),
        ("false alarms, nothing hidden", Share([r for r in rows if not hides(r)], claims), "<= 0.05"),
        ("identified: effect or confounded group right",
         Share([r for r in rows if single(r) and r["verdict"] == "identified"], right), ">= 0.90"),
        ("detected singles: the very label right",
         Share(detected_singles, lambda r: r["first"] == r["hidden"]), ""),
        ("pairs: the first is one of the two", Share([r for r in rows if "+" in r["hidden"] and claims(r)], right), ""),
        ("not in the catalogue: said so",
         Share([r for r in rows if outside(r)], lambda r: r["verdict"] == "outside_catalogue"), ">= 0.80"),
        ("overlap of `misfit_intervals`, median (n)", Median(rows, "overlap", 2), ">= 0.65"),
        ("overlap of `visible_intervals`, median (n)", Median(rows, "overlap_visible", 2), ">= 0.65"),
        ("error of the strength, median (n)",
         Median([r for r in rows if single(r)], "size_error_percent", 0, " %"), "<= 10 %"),
        ("held-out error / noise, median (n)",
         Median([r for r in rows if single(r) and right(r)], "error_over_noise", 2), "<= 1.15"),
        ("time, median (n)", Median(rows, "seconds", 0, " s"), ""),
    ]


def extra(scores, sets, score):
    """Sum over sets of (value times n, n) of a score that is kept apart."""
    kept = [s for s in scores if s["set"] in sets and s["score"] == score]
    return sum(float(s["value"]) * int(s["n"]) for s in kept), sum(int(s["n"]) for s in kept)


def coverage(scores, sets):
    hits, n = extra(scores, sets, "intervals_that_hold")
    share = Share([], None)
    share.hits, share.n = round(hits), n
    return share


def brier(scores, sets):
    total, n = extra(scores, sets, "brier")
    return f"{total / n:.3f}" if n else "-"


def table(head, rows):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head)] +
                     ["| " + " | ".join(str(c) for c in row) + " |" for row in rows])


def latest_table(cases, scores):
    columns = [scores_of([r for r in cases if r["set"] == s]) for s in LATEST]
    together = scores_of([r for r in cases if r["set"] in LATEST])
    rows = []
    for i, (name, value, wanted) in enumerate(together):
        rows.append([name] + [c[i][1] for c in columns] + [value, value.interval(), wanted])
        if name.startswith("not in"):
            held = coverage(scores, LATEST)
            rows.append(["90 % intervals that hold the truth"] + [coverage(scores, [s]) for s in LATEST] +
                        [held, held.interval(), "0.85 to 0.95"])
            rows.append(["Brier score, mean"] + [brier(scores, [s]) for s in LATEST] +
                        [brier(scores, LATEST), "", "<= 0.10"])
    return table(["score"] + LATEST + ["together", "90 % interval", "wanted"], rows)


def set_names(cases, kind):
    return list(dict.fromkeys(r["set"] for r in cases if r["kind"] == kind))


def program_of(rows):
    """The frozen program, a commit, in the style of code."""
    names = list(dict.fromkeys(r["program"] for r in rows))
    return ", ".join(f"before `{n.split()[1]}`" if n.startswith("before ") else f"`{n}`" for n in names)


def blind_table(cases, scores):
    rows = []
    for s in set_names(cases, "blind"):
        its = [r for r in cases if r["set"] == s]
        v = {name: value for name, value, _ in scores_of(its)}
        rows.append([s, program_of(its), len(its), v["strong effects detected"], v["weak effects detected"],
                     v["false alarms, nothing hidden"], v["identified: effect or confounded group right"],
                     v["not in the catalogue: said so"], coverage(scores, [s]), brier(scores, [s])])
    return table(["set", "program", "cases", "strong detected", "weak detected", "false alarms", "identified, right",
                  "outside, said so", "intervals hold", "Brier"], rows)


def limit_table(cases, scores):
    rows = []
    for s in set_names(cases, "limit"):
        its = [r for r in cases if r["set"] == s]
        v = {name: value for name, value, _ in scores_of(its)}

        def follow(expected):
            return Share([r for r in its if r["follow_up"] == expected and r["follow_up_counted"] == "1"],
                         lambda r: r["follow_up_resolved"] == "1")
        rows.append([s, program_of(its), len(its), v["weak effects detected"], v["false alarms, nothing hidden"],
                     v["identified: effect or confounded group right"], coverage(scores, [s]), brier(scores, [s]),
                     follow("conclusive"), follow("uncertain")])
    return table(["set", "program", "cases", "detected", "false alarms", "identified, right", "intervals hold",
                  "Brier", "next run conclusive: resolved", "uncertain: resolved"], rows)


def effects_table(cases):
    its = [r for r in cases if r["set"] in LATEST or r["kind"] == "limit"]
    rows = []
    for label in sorted({r["hidden"] for r in its if single(r)}):
        of = [r for r in its if r["hidden"] == label]
        said = [r for r in of if claims(r)]
        wrong = sorted({r["first"] or "outside the catalogue" for r in said if r["first"] != label})
        rows.append((len(said) / len(of), [f"`{label}`", len(of), len(said), sum(1 for r in said if right(r)),
                                           sum(1 for r in said if r["first"] == label),
                                           ", ".join(w if " " in w else f"`{w}`" for w in wrong)]))
    rows.sort(key=lambda r: (r[0], r[1][0]))
    return table(["hidden", "cases", "detected", "group right", "label right", "other labels put first"],
                 [r[1] for r in rows])


def set_up_table(cases):
    names = {"P1": "shell on a cylinder", "P2": "two shells", "P3": "strip", "P4": "arch"}
    its = [r for r in cases if r["set"] in LATEST or r["kind"] == "limit"]
    rows = []
    for s, words in names.items():
        of = [r for r in its if r["set_up"] == s]
        v = {name: value for name, value, _ in scores_of(of)}
        rows.append([words, len(of), v["strong effects detected"], v["weak effects detected"],
                     v["false alarms, nothing hidden"], v["identified: effect or confounded group right"]])
    return table(["set-up", "cases", "strong detected", "weak detected", "false alarms", "identified, right"], rows)


def bins_of(reliability, sets):
    """Bins over some sets: (range, mean said, true cases, n)."""
    edges = [0.0, 0.5, 0.8, 0.95, 1.0001]
    out = []
    for low, high in zip(edges, edges[1:]):
        its = [(float(r["said"]), round(float(r["true"]) * int(r["n"])), int(r["n"])) for r in reliability
               if r["set"] in sets and low <= float(r["said"]) < high]
        n = sum(i[2] for i in its)
        if n:
            out.append((f"{low:.2f} to {min(high, 1.0):.2f}", sum(i[0] * i[2] for i in its) / n,
                        sum(i[1] for i in its), n))
    return out


def kinds_of(reliability):
    """(words, sets) of the rows of the table and of the figure."""
    every = list(dict.fromkeys(r["set"] for r in reliability))
    return [("all blind", [s for s in every if s.startswith("blind")]), ("latest blind", LATEST),
            ("near the limit", [s for s in every if s.startswith("limit")])]


def reliability_table(reliability):
    rows = []
    for words, sets in kinds_of(reliability):
        for span, said, hits, n in bins_of(reliability, sets):
            low, high = wilson(hits, n)
            rows.append([words, span, f"{said:.2f}", f"{hits / n:.2f}", f"{low:.2f} to {high:.2f}", n])
    return table(["sets", "probability stated", "mean", "true", "90 % interval", "n"], rows)


def distance_table():
    names = {"P1": "shell on a cylinder", "P2": "two shells", "P3": "strip", "P4": "arch"}
    rows = []
    for s, words in names.items():
        its = [r for r in read("simulator_distance.csv") if r["set_up"] == s]

        def pair(column, digits):
            v = [float(r[column]) for r in its]
            return f"{statistics.median(v):.{digits}f}, {max(v):.{digits}f}"
        rows.append([words, len(its), pair("reference_rms", 2), pair("reference_best_test", 1), pair("own_rms", 2),
                     pair("own_best_test", 1)])
    return table(["set-up", "cases", "reference against itself, rms", "its best test", "this project against it, rms",
                  "its best test"], rows)


def training_table():
    rows, last = [], None
    for r in read("training.csv"):
        estimate = f"{r['value']} [{r['low']}, {r['high']}] {r['unit']}" if r["value"] else ""
        new = r["case"] != last
        last = r["case"]
        rows.append([r["found"].replace("_", " ") if new else "", r["parameter"], estimate.removesuffix(" 1"),
                     r["truth"], r["heldout_before"], r["heldout_after"]])
    return table(["found", "parameter", "estimate and 90 % interval", "truth", "held-out error / noise before",
                  "after"], rows)


def tables():
    cases, scores, reliability = read("cases.csv"), read("scores.csv"), read("reliability.csv")
    return [("latest blind sets", latest_table(cases, scores)), ("all blind sets", blind_table(cases, scores)),
            ("sets near the detection limit", limit_table(cases, scores)),
            ("by set-up", set_up_table(cases)), ("by hidden effect", effects_table(cases)),
            ("reliability", reliability_table(reliability)), ("distance of the simulators", distance_table()),
            ("training recordings", training_table())]


def print_cases(name):
    its = [r for r in read("cases.csv") if r["set"] == name]
    if not its:
        sys.exit(f"cases.csv has no set {name}; it has {', '.join(dict.fromkeys(r['set'] for r in read('cases.csv')))}")
    columns = ["case", "set_up", "strength", "hidden", "verdict", "first", "right", "p_truth", "error_over_noise",
               "detectable", "seconds"]
    print(table(columns, [[r[c] for c in columns] for r in its]))


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "--cases":
        return print_cases(arguments[1])
    if len(arguments) == 2 and arguments[0] == "--check":
        with open(arguments[1], encoding="utf-8") as file:
            page = file.read()
        missing = [name for name, text in tables() if text not in page]
        if missing:
            sys.exit(f"{arguments[1]}: not the tables that {os.path.basename(__file__)} prints: {', '.join(missing)}")
        return None
    if arguments:
        sys.exit(__doc__)
    for name, text in tables():
        print(f"{name}\n\n{text}\n")
    return None


if __name__ == "__main__":
    main(sys.argv[1:])
