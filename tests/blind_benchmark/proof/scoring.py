"""One case scored, and the claims of docs/results/claims.md from all rows."""
import math
import random
import statistics

import rivals

ALARM = 0.05          # misfit_p_value
CERTAIN = 0.9         # a false first label above this probability refutes a claim
CPU_MEDIAN, CPU_MOST = 180.0, 600.0   # s
CLAIMING = ("identified", "ambiguous", "outside_catalogue")
VERDICTS = (*CLAIMING, "adequate", "inconclusive")
COLUMNS = ("case", "set_up", "simulator", "kind", "hidden", "instead_of", "attempt", "sigma", "moved", "verdict", "first",
           "group", "joint", "p_first", "p_group", "wrong_numbers", "p_value", "right", "apart", "alarm", "false_certain", "heldout", "baseline", "process", "intervals", "held",
           "cpu_s", "training_rule", "bic_rule", "heldout_rule", "statement")
WRONG_NUMBER = "A stated number is wrong"  # begins the statement


def labels_of(answer):
    return [e["label"] for e in answer["effects"]]


def intervals(answer, diagnosis):
    """(compared, that hold the truth): 90 % intervals of the hidden law, where the same form of it was fitted."""
    compared = held = 0
    for hidden in answer["effects"]:
        fitted = next((e for e in diagnosis["effects"] if e["label"] == hidden["label"]), None)
        if fitted is None or not fitted["law"].startswith(hidden["variant"]):
            continue
        for name, value in hidden["parameters"].items():
            found = fitted["parameters"].get(name)
            if found is None or not isinstance(value, (int, float)):
                continue
            magnitude = not found.get("resolves_sign", True)
            low, high = (found["strength_ci90"] if magnitude else found["ci90"]) or (None, None)
            if low is None or high is None:
                continue
            compared += 1
            held += low <= (abs(value) if magnitude else value) <= high
    return compared, held


def right_and_apart(kind, truth, row, statement):
    """(right, counted apart), by the table "What counts as right"."""
    verdict, group = row["verdict"], row["group"].split("|")
    hit = bool(set(truth) & set(group))
    if kind in ("control", "below"):
        return not row["alarm"], False
    if kind == "swap":
        quiet = verdict != "identified"
        return quiet and statement.startswith(WRONG_NUMBER), quiet
    if kind == "outside":
        return verdict == "outside_catalogue", verdict == "ambiguous"
    if kind == "pair":
        named = {row["first"], *row["joint"].split("|")}
        return verdict == "identified" and set(truth) <= named, verdict == "identified" and hit
    return verdict == "identified" and hit, verdict == "ambiguous" and hit


def wrong_numbers(diagnosis):
    """The stated number that is wrong with the largest probability, and those that go with it or cannot be told from it."""
    most = max(diagnosis.get("wrong_numbers", []), key=lambda n: n["probability"], default=None)
    return [] if most is None else sorted({most["name"], *most["joint_with"], *most["confounded_with"]})


def score(answer, result):
    """A row of results.csv. result: of the driver, {"exit", "cpu_s", "diagnosis"}; without a diagnosis it is wrong."""
    truth, kind = labels_of(answer), answer["kind"]
    row = dict.fromkeys(COLUMNS, "")
    row.update(case=answer["name"], set_up=answer["set_up"], simulator=answer["simulator"], kind=kind,
               hidden="|".join(truth), instead_of=answer.get("instead_of", ""), attempt=answer.get("attempt", 0),
               moved="|".join(answer.get("moved", [])), sigma=round(answer["sigma"], 2), cpu_s=round(result["cpu_s"], 1),
               right=0, apart=0, alarm=int(kind in ("control", "below", "swap")), false_certain=0, intervals=0, held=0)
    diagnosis = result.get("diagnosis")
    if diagnosis is None:
        row.update(verdict=result["exit"], statement=result.get("message", ""))
        return row
    effects, verdict = diagnosis["effects"], diagnosis["verdict"]
    first = effects[0] if effects else {"label": "", "confounded_with": [], "joint_with": [], "probability": 0.0}
    group = first["confounded_with"] or [first["label"]]
    p_group = max(first["probability"], sum(e["probability"] for e in effects if e["label"] in group))
    p_value = diagnosis["misfit_p_value"]
    row.update(verdict=verdict, first=first["label"], joint="|".join(first["joint_with"]), group="|".join(group),
               p_first=round(first["probability"], 4), p_group=round(p_group, 4), p_value="" if p_value is None else p_value,
               wrong_numbers="|".join(wrong_numbers(diagnosis)), statement=diagnosis["statement"].split(". ")[0].replace("\n", " "))
    if kind in ("control", "below"):
        row["alarm"] = int(verdict in CLAIMING or p_value is None or p_value <= ALARM)
    elif kind == "swap":
        row["alarm"] = int(verdict in ("identified", "outside_catalogue"))
    present = [label for label in truth if not label.startswith("outside:")] if kind != "below" else []
    row["false_certain"] = int(p_group > CERTAIN and not set(present) & set(group))
    right, apart = right_and_apart(kind, truth, row, diagnosis["statement"])
    row.update(right=int(right), apart=int(apart and not right))
    fit, noise = diagnosis["fit"], answer["noise_rms"][0]
    for name, of in (("heldout", fit["improved"]), ("baseline", fit["baseline"])):
        error = rivals.error(of, "heldout") if of else None
        row[name] = "" if error is None else round(error / noise, 3)
    if result.get("process_rmse") is not None:
        row["process"] = round(result["process_rmse"] / noise, 3)
    if kind not in ("control", "swap", "below", "outside"):
        row["intervals"], row["held"] = intervals(answer, diagnosis)
    row.update({f"{name}_rule": rule(diagnosis, result["rows"]) for name, rule in rivals.RULES.items()})
    return row


def wilson(hits, n, z=1.6448536269514722):
    """90 % interval of a share (E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209)."""
    if n == 0:
        return 0.0, 1.0
    p, z2 = hits / n, z * z
    centre, half = p + z2 / (2 * n), z * math.sqrt(p * (1 - p) / n + z2 / (4 * n * n))
    return max(0.0, (centre - half) / (1 + z2 / n)), min(1.0, (centre + half) / (1 + z2 / n))


def shuffled(rows, times=1000, seed=1):
    """(mean share of right strong singles with shuffled answers, share that label frequencies say, standard error).

    Answers change places inside a set-up. A case is right where its group holds the label that it was dealt."""
    by = {}
    for row in rows:
        if row["kind"] == "single":
            by.setdefault(row["set_up"], []).append(row)

    def right(row, label):
        return right_and_apart("single", [label], row, "")[0]

    total = sum(map(len, by.values()))
    if total == 0:
        return 0.0, 0.0, 0.0
    expected = 0.0
    for own in by.values():
        labels = [r["hidden"] for r in own]
        for row in own:
            named = row["group"].split("|") if row["verdict"] == "identified" else []
            expected += sum(labels.count(label) for label in set(named)) / len(own)
    draw, shares = random.Random(seed), []
    for _ in range(times):
        hits = 0
        for own in by.values():
            labels = [r["hidden"] for r in own]
            draw.shuffle(labels)
            hits += sum(right(row, label) for row, label in zip(own, labels))
        shares.append(hits / total)
    error = statistics.pstdev(shares) / math.sqrt(times)
    return statistics.fmean(shares), expected / total, error


def number(value):
    return float(value) if value not in ("", None) else None


def claims(rows):
    """[(claim, measured, bar, holds)] in the order of docs/results/claims.md. holds: None where no case counts.

    Bars of a whole set of 128 cases are scaled to the share of cases that is there."""
    of = lambda *kinds: [r for r in rows if r["kind"] in kinds]
    flag = lambda r, name: int(r[name]) == 1
    out = []

    def count(claim, chosen, hit, bar, words, whole, most=False):
        hits, n = sum(1 for r in chosen if hit(r)), len(chosen)
        allowed = bar * n / whole if n < whole else bar
        holds = None if n == 0 else hits <= allowed + 1e-9 if most else hits >= allowed - 1e-9
        low, high = wilson(hits, n)
        out.append((claim, f"{hits} of {n} ({low:.2f} to {high:.2f})" if n else "no case", words, holds))

    count("strong singles are identified", of("single"), lambda r: flag(r, "right"), 44, "at least 44 of 48", 48)
    count("controls raise no alarm", of("control", "below", "swap"), lambda r: flag(r, "alarm"), 2, "at most 2 of 40",
          40, most=True)
    count("no false name is certain", rows, lambda r: flag(r, "false_certain"), 0, "0", 128, most=True)
    count("what is in no catalogue is called so", of("outside"), lambda r: flag(r, "right"), 13, "at least 13 of 16",
          16)
    held = [number(r["heldout"]) for r in rows if r["verdict"] == "identified" and r["heldout"] != ""]
    median = statistics.median(held) if held else None
    out.append(("the identified law predicts", f"{median:.2f} ({len(held)})" if held else "no case",
                "held-out error / noise, median at most 1.15", None if not held else median <= 1.15))
    n, hits = sum(int(r["intervals"]) for r in rows), sum(int(r["held"]) for r in rows)
    low, high = wilson(hits, n)
    out.append(("intervals mean what they say", f"{hits} of {n} ({low:.2f} to {high:.2f})" if n else "no interval",
                "80 to 97 %", None if n == 0 else 0.80 <= hits / n <= 0.97))
    seconds = [number(r["cpu_s"]) for r in rows]
    out.append(("it is cheap",
                f"median {statistics.median(seconds) / 60:.1f} min, most {max(seconds) / 60:.1f} min" if rows else
                "no case", "median at most 3, none above 10 CPU minutes",
                None if not rows else statistics.median(seconds) <= CPU_MEDIAN and max(seconds) <= CPU_MOST))
    count("another specimen is never a physics", of("swap"), lambda r: flag(r, "right"), 8, "8 of 8", 8)
    count("nothing below one sigma is named", of("below"),
          lambda r: r["verdict"] in VERDICTS and r["verdict"] != "identified", 8, "8 of 8", 8)
    mean, expected, error = shuffled(rows)
    out.append(("the scorer gives nothing away", f"shuffled {mean:.3f}, frequencies {expected:.3f}",
                "within 3 standard errors", None if not of("single") else abs(mean - expected) <= 3 * error + 1e-12))
    return out
