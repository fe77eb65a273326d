"""Unit tests of ./prove.sh: seed, plan, state, refusals, scorer, rivals, closed forms of the set-ups, and the history."""
import concurrent.futures
import json
import math
import os
import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest

TOP = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(TOP / "tests/blind_benchmark/proof"))
pytest.importorskip("scipy")
import conceal  # noqa: E402
import distance  # noqa: E402
import plan as plans  # noqa: E402
import print_page  # noqa: E402
import prove  # noqa: E402
import rivals  # noqa: E402
import scoring  # noqa: E402
from description import Effect, Run, Stated  # noqa: E402
from motion import motion  # noqa: E402


# ---------------------------------------------------------------- seed and plan

def repository(path, files):
    path.mkdir()
    for words in (("init", "-q"), ("config", "user.email", "a@b.c"), ("config", "user.name", "a")):
        plans.git(str(path), *words)
    return commit(path, files)


def commit(path, files):
    for name, text in files.items():
        (path / name).parent.mkdir(parents=True, exist_ok=True)
        (path / name).write_text(text)
    plans.git(str(path), "add", "-A")
    plans.git(str(path), "commit", "-qm", "x")
    return str(path)


def test_seed_follows_from_program_and_claims_but_not_from_other_documents(tmp_path):
    top = repository(tmp_path / "r", {"src/a.cpp": "1", "docs/results/claims.md": "c", "docs/x.md": "x", "README.md": "r"})
    tree = plans.program_tree(top)
    assert plans.seed_of(tree, "one") != plans.seed_of(tree, "two")
    assert 0 <= plans.seed_of(tree, "one") < 2**64
    assert plans.seed_of("", "abc") == 0xba7816bf8f01cfea  # the published test vector of SHA-256
    commit(tmp_path / "r", {"docs/x.md": "y", "README.md": "s", "docs/results/proof/proof_1.csv": "z"})
    assert plans.program_tree(top) == tree
    commit(tmp_path / "r", {"docs/results/claims.md": "d"})
    changed = plans.program_tree(top)
    assert changed != tree
    commit(tmp_path / "r", {"src/a.cpp": "2"})
    assert plans.program_tree(top) not in (tree, changed)


def test_the_set_has_the_cases_of_the_claims():
    cases = plans.plan(5)
    assert len(cases) == 128 and len({c["name"] for c in cases}) == 128
    for s in plans.SET_UPS:
        own = [c["kind"] for c in cases if c["set_up"] == s]
        assert {k: own.count(k) for k in set(own)} == \
            {"control": 3, "swap": 1, "below": 1, "single": 6, "limit": 2, "pair": 1, "outside": 2}
    assert plans.plan(5) == cases and plans.plan(6) != cases
    for c in cases:
        known = {f.name for f in [*conceal.setup(c["set_up"]).FAMILIES, *conceal.setup(c["set_up"]).OUTSIDE]}
        assert set(c["families"]) <= known


# ---------------------------------------------------------------- state and refusals

def checkout(tmp_path):
    top = repository(tmp_path / "r", {"a": "1", "docs/results/claims.md": "c", ".gitignore": "out\nprogram\n"})
    program = tmp_path / "r" / "program"
    program.write_text("#!/bin/sh\nexit 3\n")
    program.chmod(0o755)
    return top


def call(top, *words):
    return prove.main(["--top", top, "--program", "program", "--seed", "7", *words])


@pytest.fixture
def made(monkeypatch):
    """Cases are made at once, and all set-ups are near enough."""
    monkeypatch.setattr(prove, "near_enough", lambda program, folder, jobs: plans.SET_UPS)

    def make_case(case, seed):
        experiment = {"runs": [{"file": "run_1.csv"}]}
        return {"experiment.json": json.dumps(experiment), "run_1.csv": "time_s\n0\n1\n"}, \
            {**case, "simulator": "none", "sigma": 50.0, "noise_rms": [1.0],
             "effects": [{"label": f, "variant": "", "parameters": {}} for f in case["families"]]}
    monkeypatch.setattr(conceal, "make_case", make_case)


def test_a_dirty_tree_is_refused(tmp_path, capsys):
    top = checkout(tmp_path)
    (tmp_path / "r" / "b").write_text("new")
    assert call(top, "--first", "1") == 2
    assert "uncommitted" in capsys.readouterr().err


def test_a_state_of_another_program_is_refused(tmp_path, capsys, made):
    top, state = checkout(tmp_path), str(tmp_path / "state")
    assert call(top, "--first", "2", "--state", state) == 0
    commit(tmp_path / "r", {"a": "2"})
    assert call(top, "--first", "2", "--state", state) == 2
    assert "belongs to another run (program differ)" in capsys.readouterr().err


def test_a_foreign_folder_is_refused(tmp_path, capsys, made):
    top = checkout(tmp_path)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("x")
    assert call(top, "--first", "1", "--state", str(tmp_path / "mine")) == 2
    assert "holds no state" in capsys.readouterr().err
    assert call(top, "--first", "129") == 2
    assert "give 1 to 128" in capsys.readouterr().err


def test_a_run_that_was_stopped_continues_and_scores_come_last(tmp_path, capsys, made, monkeypatch):
    top, state = checkout(tmp_path), tmp_path / "state"
    done, original = [], prove.run_program

    def stopped(words):
        done.append(words[2])
        if len(done) == 2:
            raise KeyboardInterrupt
        return original(words)
    monkeypatch.setattr(prove, "run_program", stopped)
    assert call(top, "--first", "3", "--state", str(state), "--jobs", "1") == 130
    out = capsys.readouterr()
    assert "Claims" not in out.out and not (state / "results.csv").exists()
    recorded = {p.name: p.stat().st_mtime_ns for p in (state / "answers").iterdir()}
    assert len(recorded) == 3
    assert call(top, "--first", "3", "--state", str(state), "--jobs", "1") == 0
    assert recorded == {p.name: p.stat().st_mtime_ns for p in (state / "answers").iterdir()}  # none is made twice
    assert [d.split("/")[-2] for d in done] == ["case_001", "case_002", "case_002", "case_003"]
    out = capsys.readouterr().out
    assert "Claims" in out and "refused (3)" in out  # the program refused all of them: wrong, and said
    heading, rows = print_page.read(state / "results.csv")
    assert len(rows) == 3 and all(r["right"] == "0" for r in rows) and "seed 7" in heading


def test_changed_answers_are_refused(tmp_path, capsys, made):
    top, state = checkout(tmp_path), tmp_path / "state"
    assert call(top, "--first", "1", "--state", str(state)) == 0
    (state / "answers" / "case_001.json").write_text("{}")
    assert call(top, "--first", "2", "--state", str(state)) == 2
    assert "case_001.json changed after it was hashed" in capsys.readouterr().err


def test_cases_of_the_published_seed_are_not_seen_before_their_hashes_are(tmp_path, capsys, made, monkeypatch):
    top, diagnosed = checkout(tmp_path), []
    (tmp_path / "r" / "docs/results/proof").mkdir()
    own = plans.seed_of(plans.program_tree(top), plans.SET)
    for words in (["--first", "127"], ["--seed", str(own)]):
        assert prove.main(["--top", top, "--program", "program", *words]) == 2
        assert "kept for the whole set" in capsys.readouterr().err
    monkeypatch.setattr(prove, "run_program", lambda words: diagnosed.append(words[2]) or (3, 1.0, "refused"))

    def whole(state):
        (state / "distance.csv").parent.mkdir(parents=True, exist_ok=True)
        return prove.main(["--top", top, "--program", "program", "--state", str(state)])
    monkeypatch.setattr(prove, "near_enough", lambda program, folder, jobs:
                        (folder / "distance.csv").write_text("set_up,hidden,rms\n") and plans.SET_UPS)
    assert whole(tmp_path / "state") == 0 and not diagnosed
    assert "Commit it" in capsys.readouterr().out
    hashes = (tmp_path / "r" / f"docs/results/proof/{plans.SET}.sha256").read_text()
    commit(tmp_path / "r", {})
    # Elsewhere the published recordings are unpacked, not made again.
    monkeypatch.setattr(conceal, "make_case", lambda case, seed: pytest.fail("made again"))
    assert whole(tmp_path / "elsewhere") == 0 and len(diagnosed) == 128
    assert (tmp_path / "elsewhere" / "hashes.sha256").read_text() == hashes
    assert len(print_page.read(tmp_path / "elsewhere" / "results.csv")[1]) == 128


def test_a_set_up_that_the_simulator_does_not_meet_is_left_out():
    lines = [{"set_up": s, "hidden": "nothing", "rms": r} for s, all in (("a", (0.1, 0.2, 9.0)), ("b", (0.1, 0.6, 0.7)))
             for r in all]
    assert distance.too_far(lines) == ["b"]
    assert {c["set_up"] for c in plans.plan(5, ["pendulum", "sled"])} == {"pendulum", "sled"}


def test_a_time_out_is_one_of_the_processor():
    spin = ["/usr/bin/python3", "-c", "while True: pass"]
    assert prove.run_program(spin, seconds=1)[0] == "time-out"
    assert prove.run_program(["sleep", "20"], patience=0.1)[0] == "time-out"


def test_processor_time_is_that_of_the_program_alone():
    spin = ["/usr/bin/python3", "-c", "import time\nwhile time.process_time() < 1.0: pass\nprint('done')"]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for code, cpu, last in pool.map(lambda _: prove.run_program(spin), range(2)):
            assert code == 0 and last == "done" and 0.95 < cpu < 1.9  # start of Python included, the other one not


# ---------------------------------------------------------------- scorer

def diagnosis(verdict, first="", p=0.0, group=(), joint=(), p_value=0.001, statement="", parameters=None):
    fit = {"training_rmse_deg": 2.0, "heldout_rmse_deg": 2.2}
    better = {"training_rmse_deg": 1.0, "heldout_rmse_deg": 1.1}
    effects = [{"label": first, "law": "dry: formula", "probability": p, "confounded_with": list(group or (first,)),
                "joint_with": list(joint), "parameters": parameters or {"a": {"value": 1.0, "ci90": [0.5, 1.5]}},
                "delta_chi2": 100.0, **better}] if first else []
    return {"verdict": verdict, "statement": statement, "misfit_p_value": p_value, "effects": effects,
            "fit": {"baseline": fit, "improved": better if first else fit}}


def scored(kind, hidden, d, cpu=60.0, exit="done"):
    answer = {"name": "case_001", "set_up": "pendulum", "simulator": "scipy", "kind": kind, "sigma": 50.0,
              "noise_rms": [1.0], "effects": [{"label": h, "variant": "dry", "parameters": {"a": 1.2}} for h in hidden]}
    return scoring.score(answer, {"exit": exit, "cpu_s": cpu, "rows": 900, "diagnosis": d} if d else
                         {"exit": exit, "cpu_s": cpu})


@pytest.mark.parametrize("kind,hidden,d,right,apart,alarm", [
    ("single", ["a"], diagnosis("identified", "a", 0.95), 1, 0, 0),
    ("single", ["a"], diagnosis("identified", "b", 0.95, ["b", "a"]), 1, 0, 0),
    ("single", ["a"], diagnosis("identified", "b", 0.95), 0, 0, 0),
    ("single", ["a"], diagnosis("ambiguous", "a", 0.6), 0, 1, 0),
    ("single", ["a"], diagnosis("adequate"), 0, 0, 0),
    ("single", ["a"], None, 0, 0, 0),
    ("control", [], diagnosis("adequate", p_value=0.4), 1, 0, 0),
    ("control", [], diagnosis("inconclusive", p_value=0.4), 1, 0, 0),
    ("control", [], diagnosis("inconclusive", p_value=0.04), 0, 0, 1),
    ("control", [], diagnosis("ambiguous", "a", 0.4, p_value=0.01), 0, 0, 1),
    ("control", [], None, 0, 0, 1),
    ("below", ["a"], diagnosis("identified", "a", 0.95), 0, 0, 1),
    ("swap", [], diagnosis("identified", "a", 0.95), 0, 0, 1),
    ("swap", [], diagnosis("outside_catalogue", "a", 0.1), 0, 1, 1),
    ("swap", [], diagnosis("inconclusive", statement="A stated number is wrong: length."), 1, 0, 0),
    ("pair", ["a", "b"], diagnosis("identified", "a", 0.95, joint=["b"]), 1, 0, 0),
    ("pair", ["a", "b"], diagnosis("identified", "a", 0.95), 0, 1, 0),
    ("outside", ["outside:x"], diagnosis("outside_catalogue", "a", 0.2), 1, 0, 0),
    ("outside", ["outside:x"], diagnosis("ambiguous", "a", 0.2), 0, 1, 0),
    ("outside", ["outside:x"], diagnosis("identified", "a", 0.95), 0, 0, 0),
])
def test_what_counts_as_right(kind, hidden, d, right, apart, alarm):
    row = scored(kind, hidden, d, exit="done" if d else "time-out")
    assert (row["right"], row["apart"], row["alarm"]) == (right, apart, alarm)


def test_certain_false_names_are_counted():
    assert scored("single", ["a"], diagnosis("identified", "b", 0.95))["false_certain"] == 1
    assert scored("single", ["a"], diagnosis("identified", "b", 0.85))["false_certain"] == 0
    assert scored("single", ["a"], diagnosis("identified", "b", 0.95, ["b", "a"]))["false_certain"] == 0
    assert scored("outside", ["outside:x"], diagnosis("ambiguous", "b", 0.95))["false_certain"] == 1
    assert scored("below", ["a"], diagnosis("ambiguous", "a", 0.95))["false_certain"] == 1
    split = diagnosis("identified", "b", 0.5, ["b", "c"])  # a wrong group is as certain as all of it together
    split["effects"].append({**split["effects"][0], "label": "c", "probability": 0.45})
    row = scored("single", ["a"], split)
    assert (row["p_group"], row["false_certain"]) == (0.95, 1)


def test_a_number_that_is_missing_is_no_success():
    assert scored("control", [], diagnosis("adequate", p_value=None))["alarm"] == 1
    lost = scored("below", ["a"], None, exit="time-out")
    assert [ok for claim, _, _, ok in scoring.claims([lost]) if "below" in claim] == [False]


def test_another_specimen_is_named_by_the_number_that_moved():
    d = diagnosis("inconclusive", statement="A stated number is wrong: length.")
    d["wrong_numbers"] = [{"name": n, "probability": p, "joint_with": [], "confounded_with": []}
                          for n, p in (("mass", 0.2), ("length", 0.7))]
    assert scored("swap", [], d)["wrong_numbers"] == "length"


def test_errors_and_intervals_are_in_units_of_the_noise_and_of_the_same_law():
    row = scored("single", ["a"], diagnosis("identified", "a", 0.95))
    assert (row["heldout"], row["baseline"], row["intervals"], row["held"]) == (1.1, 2.2, 1, 1)
    outside = {"a": {"value": 1.0, "ci90": [1.3, 1.5]}}
    assert scored("single", ["a"], diagnosis("identified", "a", 0.95, parameters=outside))["held"] == 0
    mirrored = {"a": {"value": -1.0, "ci90": [-1.5, -0.5], "resolves_sign": False, "strength_ci90": [0.5, 1.5]}}
    assert scored("single", ["a"], diagnosis("identified", "a", 0.95, parameters=mirrored))["held"] == 1
    other = diagnosis("identified", "a", 0.95)
    other["effects"][0]["law"] = "viscous: formula"
    assert scored("single", ["a"], other)["intervals"] == 0


def whole_set(right=44, alarms=2, outside=13, cpu=60.0):
    rows = [scored("single", ["abcdef"[i % 6]],
                   diagnosis("identified", "abcdef"[i % 6] if i < right else "z", 0.95 if i < right else 0.8), cpu)
            for i in range(48)]
    rows += [scored("control", [], diagnosis("adequate", p_value=0.01 if i < alarms else 0.5), cpu) for i in range(24)]
    rows += [scored("below", ["a"], diagnosis("adequate", p_value=0.5), cpu) for _ in range(8)]
    rows += [scored("swap", [], diagnosis("inconclusive", statement="A stated number is wrong"), cpu) for _ in range(8)]
    rows += [scored("outside", ["outside:x"], diagnosis("outside_catalogue" if i < outside else "ambiguous", "a", 0.1),
                    cpu) for i in range(16)]
    return rows


def holds(rows):
    return {claim: ok for claim, _, _, ok in scoring.claims(rows)}


def test_claims_hold_at_their_bars_and_are_refuted_one_beyond():
    at, names = holds(whole_set()), {"right": "strong singles are identified", "alarms": "controls raise no alarm",
                                     "outside": "what is in no catalogue is called so", "cpu": "it is cheap"}
    assert all(at[n] for n in names.values())
    for change in ({"right": 43}, {"alarms": 3}, {"outside": 12}, {"cpu": 181.0}):
        beyond = holds(whole_set(**change))
        assert [n for n in names.values() if not beyond[n]] == [names[next(iter(change))]]


def test_every_claim_of_the_page_is_measured():
    text = (TOP / "docs/results/claims.md").read_text().split("## Claims")[1].split("## Rivals")[0]
    listed = re.findall(r"^\| ([^|]+) \| [^|]+ \| [^|]+ \|$", text, flags=re.M)
    assert [c for c in listed if c != "claim"] == [c for c, *_ in scoring.claims([])]


def test_shuffled_answers_fall_to_chance():
    rows = whole_set(right=48)
    mean, expected, error = scoring.shuffled(rows)
    assert expected == pytest.approx(1.0 / 6.0)  # six labels, each as often, one named
    assert abs(mean - expected) < 3.0 * error
    assert scoring.shuffled([]) == (0.0, 0.0, 0.0)


# ---------------------------------------------------------------- rivals and page

def test_rules_choose_by_their_own_number():
    d = diagnosis("identified", "a", 0.9)
    d["effects"].append({"label": "b", "joint_with": [], "parameters": {n: 0 for n in "abcdefgh"},
                         "delta_chi2": 110.0, "training_rmse_deg": 0.9, "heldout_rmse_deg": 3.0})
    assert rivals.least_training_error(d, 900) == "b"
    assert rivals.heldout_error(d, 900) == "a"
    assert rivals.bic(d, 900) == "a"  # eight parameters cost 54, one costs 7
    assert {rule(diagnosis("adequate"), 900) for rule in rivals.RULES.values()} == {rivals.NOTHING}
    weak = diagnosis("ambiguous", "a", 0.4)
    weak["effects"][0]["delta_chi2"] = 6.0  # ln 900 = 6.8
    assert rivals.bic(weak, 900) == rivals.NOTHING


def test_the_commonest_label():
    rows = [{"kind": "single", "set_up": "s", "hidden": h} for h in "aab"] + \
        [{"kind": "control", "set_up": "s", "hidden": "c"}] * 9
    assert rivals.commonest_labels(rows) == {"s": "a"}


def test_a_gaussian_process_learns_what_depends_on_the_reading(tmp_path):
    pytest.importorskip("sklearn")
    noise, files = np.random.default_rng(1), []
    for run in range(3):
        t = np.linspace(0.0, 6.0, 150)
        x = (1.0 + 0.2 * run) * np.cos(3.0 * t)
        y = x + 0.3 * x**3 + 0.02 * noise.standard_normal(len(t))
        files.append(tmp_path / f"{run}.csv")
        files[-1].write_text("time_s,angle_recorded_deg,angle_simulated_deg,residual_deg\n" +
                             "".join(f"{a},{b},{c},0\n" for a, b, c in zip(t, y, x)) + "9,,1,\n")
    assert rivals.process_error(files) < 0.06  # noise 0.02, and the largest run is extrapolated; without it 0.19
    assert rivals.process_error(files[:1]) is None


def test_the_page_has_all_tables_and_goes_between_its_marks(tmp_path):
    rows = whole_set()
    text = print_page.page(rows)
    for title in ("Claims", "Hidden and said", "Reliability", "Rivals", "Worst misses"):
        assert f"### {title}" in text
    assert "44 of 48" in text and "does as well as the tool" in text  # every rule finds these made-up fits
    prove.write_results(tmp_path / "r.csv", {"set": "s", "seed": 1, "program": "p"}, rows)
    heading, again = print_page.read(tmp_path / "r.csv")
    assert "seed 1" in heading and print_page.page(again) == text


# ---------------------------------------------------------------- recordings

def test_motion_with_dry_friction_loses_a_constant_amplitude_and_stops():
    k, mass, friction = 4.0, 1.0, 0.1
    times = np.linspace(0.0, 40.0, 8001)
    x, v = motion(mass, lambda t, x, v: -k * x, (1.0, 0.0), times, 0.1, lambda t, x, v, z: friction)
    period, loss = 2.0 * math.pi / math.sqrt(k / mass), 4.0 * friction / k
    for cycle in range(1, 9):
        assert np.interp(cycle * period, times, x) == pytest.approx(1.0 - loss * cycle, abs=1e-4)  # rows 5 ms apart
    assert v[-1] == 0.0 and abs(k * x[-1]) <= friction


def simulated(name, numbers, times, effects=(), drive=()):
    return conceal.setup(name).simulate(numbers, Run(times, drive=drive), times, list(effects))[0]


def test_a_large_swing_has_the_period_of_the_elliptic_integral():
    length, amplitude = 0.2, 2.0
    numbers = {"length": length, "mass": 0.02, "hub_inertia": 0.0, "lean": 0.0, "release_angle": amplitude,
               "release_spin": 0.0}
    a, b = 1.0, math.cos(0.5 * amplitude)  # arithmetic-geometric mean
    for _ in range(8):
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    period = 2.0 * math.pi / a * math.sqrt(2.0 * length / 3.0 / 9.81)
    x = simulated("pendulum", numbers, np.array([0.0, period, 5.0 * period]))
    assert x == pytest.approx([amplitude] * 3, abs=1e-6)  # integration to 1e-9, five periods


def test_a_sled_is_simulated_past_each_corner_of_its_drive_or_given_up():
    sled = conceal.setup("sled")
    run = sled.describe(conceal.draw_of(1, "corner")).runs[2]
    # At the corner at 8 s it began to stick and to slide for ever, where the drive changed its speed within 0.1 us.
    held = {"mass": 0.20612718696058038, "normal_force": 1.61, "mu": 0.2303078433857736,
            "stiffness": 564.6493104402412, "viscosity": 17.453070700055136}
    reading = sled.simulate(held, run, run.times, [])[0]
    sliding = held["mu"] * held["normal_force"]
    assert reading[np.searchsorted(run.times, (3.9, 10.9))] == pytest.approx(sliding, rel=1e-6)  # before and behind it
    with pytest.raises(RuntimeError, match="more than"):  # its damper drives it
        sled.simulate({**held, "mass": 0.21, "viscosity": -40.0}, run, run.times, [])


def test_a_sled_breaks_away_at_its_static_friction():
    numbers = {"mass": 0.2, "normal_force": 2.0, "mu": 0.3, "stiffness": 500.0, "viscosity": 15.0}
    times, drive = np.arange(0.0, 10.0, 0.005), ((0.0, 10.0), (0.0, 0.01))
    static = Effect("static_friction_excess", {"mu_s_over_mu_k": 1.4, "Dc_m": 1e-3, "tau_heal_s": 1.0})
    slides = simulated("sled", numbers, times, drive=drive)
    # From rest the sled gets the speed of the drive, which takes at most V sqrt(k m) more.
    assert slides[-1] == pytest.approx(0.6, abs=1e-6) and slides.max() < 0.6 + 1e-3 * math.sqrt(500.0 * 0.2)
    assert 0.84 < simulated("sled", numbers, times, [static], drive).max() < 0.84 + 1e-3 * math.sqrt(500.0 * 0.2)


def test_a_ring_has_its_small_and_its_large_stiffness():
    ring = conceal.setup("ring_between_plates")
    loads, pressed = ring.pressed(0.0)
    # F R^3 / B = d / 0.1488 for small d. At F R^2 / B = 0.125 the ring is stiffer by a share of the order of d / R.
    assert loads[1] / pressed[1] == pytest.approx(1.0 / (math.pi / 4.0 - 2.0 / math.pi), rel=0.03)
    assert np.all(np.diff(pressed) > 0.0)
    loads, softer = ring.pressed(1.0)  # moments below B / R: the top, with F R / pi for small d, reaches it first
    assert loads[-1] < math.pi and np.all(softer[1:] > pressed[1:len(softer)])
    with pytest.raises(ValueError, match="end of the law"):
        ring.pressed(0.5)


def test_an_arch_on_slippery_plates_has_the_small_stiffness_of_a_curved_beam(monkeypatch):
    """Castigliano: d = F R^3 / (2 B) times the integral of (sin half - sin a)^2 from the apex to an end."""
    program = pathlib.Path(os.environ.get("SYNTHETIC_CASES", TOP / "build/tests/synthetic_cases"))
    if not program.exists():
        pytest.skip(f"no {program}: build the target synthetic_cases")
    monkeypatch.setenv("SYNTHETIC_CASES", str(program))
    module = conceal.setup("arch_between_plates")
    drawn = conceal.Specimen(module, conceal.draw_of(1, "x")).numbers
    numbers = {name: v for (_, name), v in drawn.items()} | {"friction": 0.0}
    radius = 1.0 / numbers["natural_curvature"]
    half = 0.5 * numbers["arc_length"] / radius
    run = Run(np.arange(0.0, 12.0 - 1e-9, 0.05), drive=((0, 1, 12), (0, 0, 1.1e-3)))
    force, way = module.simulate(numbers, run, run.times, [])[0], np.interp(run.times, *run.drive)
    press = way - way[np.argmax(force > 0.002)]
    near = (press > 2e-5) & (press < 5e-4)
    angle = np.linspace(0.0, half, 2001)
    wanted = 2.0 * numbers["bending_modulus"] / (radius**3 * np.trapz((math.sin(half) - np.sin(angle))**2, angle))
    # 1.3 % of it are the thickness at the ends, the weight and 100 edges
    assert np.polyfit(press[near], force[near], 3)[2] == pytest.approx(wanted, rel=0.02)


def test_a_released_cantilever_has_its_first_frequency():
    numbers = {"length": 0.3, "thickness": 1e-3, "width": 0.02, "young_modulus": 2e11, "density": 7800.0, "pull": 0.02}
    period = 2.0 * math.pi * 0.3**2 / 1.87510407**2 * math.sqrt(7800.0 * 12.0 / (2e11 * 1e-6))
    y = simulated("cantilever_vibration", numbers, np.array([0.0, 5.25 * period]))
    assert y[0] == pytest.approx(-0.02 * 0.3**3 * 12.0 / (3.0 * 2e11 * 0.02 * 1e-9), rel=1e-3)  # four modes
    assert abs(y[1]) < 0.035 * abs(y[0])  # higher modes hold 3 %; a frequency off by 0.001 gives 3 % more


def test_detectability_is_what_the_stated_numbers_do_not_absorb():
    from detectability import Baseline, amplitude_for
    t = np.linspace(-1.0, 1.0, 201)

    def simulate(numbers, effects):  # a line and, as the effect, a parabola
        return numbers["slope"] * t + sum(e.parameters["a"] * t**2 for e in effects)
    base = Baseline(simulate, {"slope": 1.0}, [("slope", Stated(1.0, 100.0))], [1e6 * np.ones_like(t)])
    beyond = t**2 - (t**2).mean()
    assert base.sigma([Effect("x", {"a": 1.0})]) == pytest.approx(np.linalg.norm(beyond), rel=1e-6)
    amplitude = amplitude_for(base, lambda a: Effect("x", {"a": a}), 20.0, 50.0)
    assert base.sigma([Effect("x", {"a": amplitude})]) == pytest.approx(20.0, rel=0.1)
    assert amplitude_for(base, lambda a: Effect("x", {"a": a}), 20.0, 1.0) is None


def test_what_an_effect_of_the_catalogue_imitates_is_not_outside():
    from detectability import Baseline, outside_amplitude
    t = np.linspace(0.0, 10.0, 401)

    def simulate(numbers, effects):  # an oscillation; frequencies that differ leave the reach of derivatives
        a = sum(e.parameters["a"] for e in effects)
        return 100.0 * np.cos((numbers["w"] + 0.02 * a) * t) + sum(e.parameters.get("b", 0.0) for e in effects) * np.sin(7.0 * t)
    base = Baseline(simulate, {"w": 5.0}, [("w", Stated(5.0, 1e-4))], [])
    catalogue = [lambda a: Effect("x", {"a": a})]
    imitated = simulate({"w": 5.0}, [Effect("z", {"a": 2.0})])
    assert base.sigma_left(imitated) > 100.0 and base.sigma_left(imitated, imitation=catalogue[0]) < 1.0
    assert outside_amplitude(base, lambda a: Effect("z", {"a": a}), 1.0, 3.0, 40.0, catalogue) == (None, 0.0)
    amplitude, seen = outside_amplitude(base, lambda a: Effect("z", {"a": a, "b": a}), 1.0, 50.0, 40.0, catalogue)
    # The sine is what is left of it: 40 standard deviations where its norm, of 401 readings, is 40.
    assert seen >= 40.0 and amplitude == pytest.approx(40.0 / math.sqrt(401 / 2), rel=0.3)


def test_a_strong_effect_does_not_vanish_in_the_numbers_that_absorb_a_constant():
    from detectability import LARGEST_DEVIATION, Baseline
    t = np.linspace(-1.0, 1.0, 201)

    def simulate(numbers, effects):  # the effect lifts all readings, and bends them a little
        return numbers["c"] + 0.0 * t + sum(e.parameters["a"] * (1.0 + 0.1 * t**2) for e in effects)
    base = Baseline(simulate, {"c": 0.0}, [("c", Stated(0.0, 1e6))], [])
    seen = [base.sigma([Effect("x", {"a": a})]) for a in (10.0, 100.0, 1000.0)]
    rest = 0.1 * np.linalg.norm(t**2 - (t**2).mean())
    assert seen[:2] == pytest.approx([10.0 * rest, 100.0 * rest], rel=1e-3) and seen[2] > seen[1]
    # Few readings that jump do not steer the constant: the other ones stay where they are.
    jumps = np.zeros_like(t)
    jumps[:5] = 1e4
    assert base.sigma_of(jumps) == pytest.approx(math.sqrt(5) * LARGEST_DEVIATION, rel=0.05)


def test_a_case_is_the_same_every_time_and_another_specimen_leaves_its_description():
    case = {"name": "case_001", "set_up": "mass_on_spring", "kind": "single", "strength": "strong",
            "families": ["viscous_guide"]}
    files, answer = conceal.make_case(case, 3)
    assert conceal.make_case(case, 3) == (files, answer)
    assert 36.0 <= answer["sigma"] <= 170.0 and conceal.make_case(case, 4)[0] != files
    described = json.loads(files["experiment.json"])
    assert not set(files) - {"experiment.json", "run_1.csv", "run_2.csv", "run_3.csv"}
    for word in ("viscous", "friction", "single", "strong", "guide"):
        assert word not in files["experiment.json"]
    stated = described["scene_parameters"]["frequency"]
    assert abs(answer["true_parameters"]["frequency"] - stated["value"]) <= stated["unc"]
    swapped = conceal.make_case({**case, "kind": "swap", "strength": "", "families": []}, 3)
    stated = json.loads(swapped[0]["experiment.json"])["scene_parameters"]["frequency"]
    away = abs(swapped[1]["true_parameters"]["frequency"] - stated["value"])
    assert swapped[1]["moved"] == ["frequency"] and 2.99 * stated["unc"] < away < 6.01 * stated["unc"]


def test_no_two_cases_share_their_random_numbers():
    drawn = [json.dumps([sorted(map(str, s.numbers.items())), s.noise])
             for c in plans.plan(5) for s in [conceal.Specimen(conceal.setup(c["set_up"]), conceal.draw_of(5, c["name"], 0))]]
    assert len(set(drawn)) == 128


def test_another_specimen_is_one_that_can_exist(monkeypatch):
    class Seen:
        def __init__(self, *_):
            pass

        def sigma_left(self, *_):
            return 100.0
    monkeypatch.setattr(conceal, "Baseline", Seen)
    monkeypatch.setattr(conceal.Specimen, "scaled", lambda *_: None)
    monkeypatch.setattr(conceal.Specimen, "zeros", lambda *_: None)
    for name in plans.SET_UPS:
        for k in range(40):
            draw = conceal.draw_of(k, name)
            specimen = conceal.Specimen(conceal.setup(name), draw)
            stated = specimen.description.stated
            for moved in conceal.another_specimen(draw, specimen):
                true = specimen.numbers[None, moved]
                assert 2.99 < abs(true - stated[moved].value) / stated[moved].half < 6.01
                assert true > 0.0 or stated[moved].value < stated[moved].half, (name, moved, true)


def test_an_effect_that_no_specimen_shows_is_replaced_and_the_answer_says_so(monkeypatch):
    module = conceal.setup("mass_on_spring")
    shown = conceal.hidden_effects
    monkeypatch.setattr(conceal, "hidden_effects", lambda draw, plan, specimen: None
                        if plan["families"] == ["viscous_guide"] else shown(draw, plan, specimen))
    case = {"name": "case_001", "set_up": "mass_on_spring", "kind": "single", "strength": "strong",
            "families": ["viscous_guide"]}
    _, answer = conceal.make_case(case, 3)
    assert answer["instead_of"] == "viscous_guide" and answer["families"] != ["viscous_guide"]
    assert answer["families"][0] in {f.name for f in module.FAMILIES} and answer["sigma"] >= 36.0
    monkeypatch.setattr(conceal, "hidden_effects", lambda *_: None)
    with pytest.raises(RuntimeError, match="case_001: no specimen shows"):
        conceal.make_case({**case, "kind": "pair", "families": conceal.pairs(module)[0]}, 3)


# ---------------------------------------------------------------- the history

def history_of(top, name):
    """Problems of a published set: which rule of docs/results/claims.md its commits break."""
    folder = "docs/results/proof"
    git = lambda *words: plans.git(top, *words).split()
    added = {end: git("log", "--diff-filter=A", "--format=%H", "--", f"{folder}/{name}.{end}") for end in ("sha256", "csv")}
    if not added["csv"]:
        return []
    if not added["sha256"]:
        return ["results without hashes"]
    before, after = added["sha256"][-1], added["csv"][-1]
    problems = []
    if before == after or plans.git(top, "merge-base", before, after).strip() != before:
        problems.append("the commit of the hashes is no strict ancestor of that of the results")
    if git("log", "--diff-filter=MDR", "--format=%H", "--", f"{folder}/{name}.sha256"):
        problems.append("the hashes changed after their commit")
    tree = plans.program_tree(top, before)
    between = git("rev-list", "--ancestry-path", f"{before}..{after}")
    if any(plans.program_tree(top, c) != tree for c in between):
        problems.append("the program changed between hashes and results")
    heading = plans.git(top, "show", f"{after}:{folder}/{name}.csv").splitlines()[0]
    if f"seed {plans.seed_of(tree, name)}, program {tree}" not in heading:
        problems.append("the results are not those of the program and the seed that follows from it")
    return problems


def published(top):
    stems = (pathlib.Path(f).stem for f in plans.git(top, "ls-files", "docs/results/proof/proof_*.csv").split())
    return sorted(stem for stem in stems if not stem.endswith("_distance"))


def test_hashes_of_published_sets_were_committed_before_their_results(capsys):
    if not (TOP / ".git").exists():
        pytest.skip("no history: this is not a git checkout")
    if plans.git(str(TOP), "rev-parse", "--is-shallow-repository").strip() == "true":
        pytest.skip("no history: this is a shallow clone")
    names = published(str(TOP))
    if not names:
        with capsys.disabled():
            print("\nno set of ./prove.sh is published: nothing to check")
    for name in names:
        assert history_of(str(TOP), name) == []


def test_the_walk_finds_each_broken_rule(tmp_path):
    folder = "docs/results/proof/proof_1"
    start = {"src/a.cpp": "1", "docs/results/claims.md": "c"}

    def results(top):
        tree = plans.program_tree(top)
        return f"# set proof_1, seed {plans.seed_of(tree, 'proof_1')}, program {tree}\ncase\n"
    top = repository(tmp_path / "good", start)
    commit(tmp_path / "good", {folder + ".sha256": "h"})
    commit(tmp_path / "good", {"docs/x.md": "a document may change"})
    commit(tmp_path / "good", {folder + ".csv": results(top)})
    assert published(top) == ["proof_1"] and history_of(top, "proof_1") == []
    commit(tmp_path / "good", {folder + ".sha256": "other"})
    assert history_of(top, "proof_1") == ["the hashes changed after their commit"]

    top = repository(tmp_path / "together", start)
    commit(tmp_path / "together", {folder + ".sha256": "h", folder + ".csv": results(top)})
    assert history_of(top, "proof_1") == ["the commit of the hashes is no strict ancestor of that of the results"]

    top = repository(tmp_path / "changed", start)
    commit(tmp_path / "changed", {folder + ".sha256": "h"})
    first = results(top)
    commit(tmp_path / "changed", {"src/a.cpp": "2"})
    commit(tmp_path / "changed", {"src/a.cpp": "1"})  # and back: it is another program in between all the same
    commit(tmp_path / "changed", {folder + ".csv": first})
    assert history_of(top, "proof_1") == ["the program changed between hashes and results"]

    top = repository(tmp_path / "seed", start)
    commit(tmp_path / "seed", {folder + ".sha256": "h"})
    commit(tmp_path / "seed", {folder + ".csv": "# set proof_1, seed 1, program x\n"})
    assert history_of(top, "proof_1") == ["the results are not those of the program and the seed that follows from it"]

    top = repository(tmp_path / "bare", start)
    commit(tmp_path / "bare", {folder + ".csv": results(top)})
    assert history_of(top, "proof_1") == ["results without hashes"]
