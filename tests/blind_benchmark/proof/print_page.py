#!/usr/bin/python3
"""Prints the tables of a set from its results file, as Markdown.

    print_page.py RESULTS.csv                  prints them
    print_page.py RESULTS.csv --page PAGE.md   puts them between the marks <!-- set --> and <!-- end of set --> of PAGE
"""
import argparse
import collections
import csv
import pathlib
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import rivals  # noqa: E402
import scoring  # noqa: E402

BEGIN, END = "<!-- set -->", "<!-- end of set -->"
BINS = ((0.0, 0.5), (0.5, 0.8), (0.8, 0.95), (0.95, 1.0 + 1e-9))
KINDS = (("control", "nothing hidden"), ("below", "below one sigma"), ("swap", "another specimen"),
         ("single", "strong single"), ("limit", "near the limit"), ("pair", "pair"), ("outside", "outside"))


def table(head, lines):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head)] +
                     ["| " + " | ".join(str(c) for c in line) + " |" for line in lines]) + "\n"


def share(hits, n):
    if n == 0:
        return "-"
    low, high = scoring.wilson(hits, n)
    return f"{hits} of {n} ({low:.2f} to {high:.2f})"


def answered(row):
    """What a verdict says: both effects where it names two."""
    if row["verdict"] == "identified":
        return " and ".join([row["first"], *filter(None, row["joint"].split("|"))])
    return row["verdict"]


def hidden(row):
    words = {"swap": "another specimen", "control": "nothing"}.get(row["kind"]) or row["hidden"].replace("|", " and ")
    return words + {"below": ", below one sigma", "limit": ", near the limit"}.get(row["kind"], "")


def claims(rows):
    words = {True: "holds", False: "**refuted**", None: "-"}
    return table(("claim", "measured (90 % interval)", "bar", ""),
                 [(c, m, bar, words[holds]) for c, m, bar, holds in scoring.claims(rows)])


def kinds(rows):
    lines = []
    for kind, words in KINDS:
        of = [r for r in rows if r["kind"] == kind]
        lines.append((words, share(sum(int(r["right"]) for r in of), len(of)), sum(int(r["apart"]) for r in of)))
    moved = [r for r in rows if r["kind"] == "swap"]
    named = sum(bool(set(r["moved"].split("|")) & set(r["wrong_numbers"].split("|"))) for r in moved)
    replaced = sum(r["instead_of"] != "" for r in rows)
    return table(("hidden", "right", "counted apart"), lines) + \
        f"\nOf {len(moved)} cases with another specimen, {named} name a number that was moved." \
        f" In {replaced} cases the planned effect was replaced, because no specimen showed it as strongly as planned.\n"


def set_ups(rows):
    lines = []
    for name in dict.fromkeys(r["set_up"] for r in sorted(rows, key=lambda r: r["set_up"])):
        of = [r for r in rows if r["set_up"] == name]
        single, quiet = [r for r in of if r["kind"] == "single"], [r for r in of if r["kind"] in ("control", "below")]
        seconds = [float(r["cpu_s"]) for r in of]
        lines.append((f"`{name}`", of[0]["simulator"], f"{sum(int(r['right']) for r in single)} of {len(single)}",
                      f"{sum(int(r['alarm']) for r in quiet)} of {len(quiet)}",
                      f"{statistics.median(seconds) / 60:.1f}", f"{max(seconds) / 60:.1f}"))
    return table(("set-up", "recorded by", "strong singles right", "alarms", "CPU min, median", "most"), lines)


def confusion(rows):
    count = collections.Counter((hidden(r), answered(r)) for r in rows)
    lines = []
    for what in sorted({h for h, _ in count}):
        said = sorted(((n, a) for (h, a), n in count.items() if h == what), reverse=True)
        lines.append((what, ", ".join(f"{a} {n}" for n, a in said)))
    return table(("hidden", "said, how often"), lines)


def reliability(rows):
    """Probability of the first label's group against how often it holds the truth, single effects."""
    lines = []
    chosen = [r for r in rows if r["kind"] in ("single", "limit") and r["p_group"] != "" and r["first"]]
    for low, high in BINS:
        of = [r for r in chosen if low <= float(r["p_group"]) < high]
        if of:
            true = sum(r["hidden"] in r["group"].split("|") for r in of)
            mean = sum(float(r["p_group"]) for r in of) / len(of)
            lines.append((f"{low:.2f} to {min(high, 1.0):.2f}", f"{mean:.2f}", share(true, len(of))))
    return table(("probability stated", "mean", "true"), lines)


def rival_lines(rows):
    """(rule, strong singles right, alarms of controls, names given to another specimen), and the sizes of the three."""
    common = rivals.commonest_labels(rows)
    rules = {"the tool": None, "least training error": "training_rule", "BIC": "bic_rule",
             "held-out error": "heldout_rule", "commonest label": "common"}
    singles, quiet, swaps = ([r for r in rows if r["kind"] in kinds] for kinds in
                             (("single",), ("control", "below"), ("swap",)))
    lines = []
    for words, rule in rules.items():
        def said(r):
            return common.get(r["set_up"], rivals.NOTHING) if rule == "common" else r[rule]
        if rule is None:
            lines.append((words, sum(int(r["right"]) for r in singles), sum(int(r["alarm"]) for r in quiet),
                          sum(int(r["alarm"]) for r in swaps)))
            continue
        hits = sum(said(r) == r["hidden"] or  # the group of the tool serves the rules too
                   (said(r) in r["group"].split("|") and r["hidden"] in r["group"].split("|")) for r in singles)
        lines.append((words, hits, *(sum(said(r) != rivals.NOTHING for r in of) for of in (quiet, swaps))))
    return lines, len(singles), len(quiet), len(swaps)


def rival_table(rows):
    lines, singles, quiet, swaps = rival_lines(rows)
    text = table(("rule", f"strong singles right, of {singles}", f"alarms, of {quiet} controls",
                  f"alarms, of {swaps} other specimens"), lines)
    own = lines[0]
    for words, hits, alarms, _ in lines[1:]:  # the rules do not know that a number may be wrong
        if singles and hits >= own[1] and alarms <= own[2]:
            text += f"\nThe rule \"{words}\" does as well as the tool.\n"
    process = [(float(r["process"]), float(r["heldout"] or r["baseline"]), float(r["baseline"])) for r in rows
               if r["kind"] == "single" and r["process"] != "" and r["baseline"] != ""]
    if process:
        middle = [statistics.median(column) for column in zip(*process)]
        text += ("\n" + table(("held-out error / noise, median", ""),
                              [("stated model, fitted", f"{middle[2]:.2f}"), ("Gaussian process", f"{middle[0]:.2f}"),
                               ("the tool", f"{middle[1]:.2f}")]))
    return text


def misses(rows):
    """The three worst: wrong with the largest probability, then the strongest signal."""
    wrong = sorted((r for r in rows if not int(r["right"])),
                   key=lambda r: (-float(r["p_first"] or 0.0), -float(r["sigma"] or 0.0)))[:3]
    return table(("case", "set-up", "hidden", "said", "statement"),
                 [(r["case"], f"`{r['set_up']}`", r["hidden"].replace("|", " and ") or r["kind"], answered(r),
                   r["statement"][:160].replace("|", "/")) for r in wrong]) if wrong else "None.\n"


def page(rows):
    parts = [("Claims", claims), ("By what is hidden", kinds), ("By set-up", set_ups), ("Hidden and said", confusion),
             ("Reliability", reliability), ("Rivals", rival_table), ("Worst misses", misses)]
    return "\n".join(f"### {title}\n\n{make(rows)}" for title, make in parts)


def read(file):
    """(heading, rows) of a results file."""
    with open(file, newline="", encoding="utf-8") as f:
        heading = f.readline().lstrip("# ").strip()
        return heading, list(csv.DictReader(f))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results")
    parser.add_argument("--page")
    o = parser.parse_args()
    try:
        heading, rows = read(o.results)
        text = f"{heading}.\n\n{page(rows)}"
        if not o.page:
            print(text)
            return 0
        old = pathlib.Path(o.page).read_text(encoding="utf-8")
        if BEGIN not in old or END not in old:
            print(f"{o.page}: no line \"{BEGIN}\" followed by \"{END}\"; put both where the tables belong",
                  file=sys.stderr)
            return 2
        before, rest = old.split(BEGIN, 1)
        pathlib.Path(o.page).write_text(f"{before}{BEGIN}\n\n{text}\n{END}{rest.split(END, 1)[1]}", encoding="utf-8")
    except (OSError, KeyError, ValueError) as why:
        print(f"print_page.py: {o.results}: {why}; give a results.csv of ./prove.sh", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
