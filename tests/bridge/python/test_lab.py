"""The laboratory from Python: numbers of the program, arrays, interruption, refusals."""

import csv
import json
import os
import pathlib
import re
import signal
import threading

import numpy as np
import pytest

import supercircle as sc

SOURCE = pathlib.Path(__file__).resolve().parents[3]
CASE = SOURCE / "tests/data/recordings/baseline/case_101"
SHORT = {"travel_over_R": 0.2}


def test_a_run_has_series_summary_and_pictures():
    r = sc.run("two_shells", **SHORT)
    assert r.status == "done" and r.scene == "two_shells" and r.summary["parameters"]["travel_over_R"] == 0.2
    assert r.series.force_N is r.series["force_N"] and r.series["force_N"].dtype == np.float64
    assert {len(column) for column in r.series.values()} == {len(r.series.time_s)}
    assert r.summary["peak_force_unfiltered_N"] == r.series.force_N.max()
    # energy balance: work of the crosshead is stored or dissipated, to rounding
    assert np.abs(r.series.residual_J).max() < 1e-12 * r.series.work_in_J.max()
    assert set(r.pictures) == {"before", "peak", "after", "curve"} and all(p.startswith("<svg") for p in r.pictures.values())
    page = r._repr_html_()
    ids = re.findall(r'\bid="([^"]+)"', page + r._repr_html_())
    assert page.count("<svg") == 4 and "peak_force_N" in page and len(ids) == len(set(ids))
    with pytest.raises(AttributeError, match="did you mean force_N"):
        r.series.force
    with pytest.raises(KeyError, match="did you mean force_N"):
        r.series["force"]
    with pytest.raises(KeyError, match="there are time_s, "):
        r.series["pressure"]
    with pytest.raises(KeyError, match="did you mean peak_force_N"):
        r.summary["peak_force"]


def test_scenes_are_names_paths_dicts_and_texts():
    path = SOURCE / "scenes/two_shells.json"
    runs = [sc.run(form, pictures=False, **SHORT) for form in ("two_shells", str(path), path, path.read_text(), json.loads(path.read_text()))]
    assert all(np.array_equal(r.series.time_s, runs[0].series.time_s) for r in runs) and runs[0].pictures == {}
    assert "two_shells" in sc.scenes() and "experiments/sled" in sc.scenes()
    for wrong in ("two_shels", "nowhere/at_all.json"):
        with pytest.raises(sc.BadInputError, match="no"):
            sc.run(wrong)
    with pytest.raises(sc.BadInputError, match='did you mean "two_shells"'):
        sc.run("two_shels")
    with pytest.raises(sc.BadInputError, match="mew"):
        sc.run("two_shells", mew=0.1)


def test_a_sweep_has_columns():
    s = sc.sweep("two_shells", mu=[0.1, 0.3], phi_bar=np.array([0.6, 0.7, 0.8]), travel_over_R=0.2)
    assert len(s) == s.planned == 6 and set(s.varied) == {"mu", "phi_bar"}
    assert s["peak_force_N"].shape == (6,) and set(s["snap_type"]) == {"I"}
    assert s.where(mu=0.3)["phi_bar"] == pytest.approx([0.6, 0.7, 0.8])
    # more friction, more force
    assert (s.where(mu=0.3)["peak_force_N"] > s.where(mu=0.1)["peak_force_N"]).all()
    with pytest.raises(KeyError, match="peak_force_N"):
        s["force"]
    table = s.table()
    assert list(table)[:2] == s.varied and {len(column) for column in table.values()} == {6}
    assert (table["peak_force_N"] == s["peak_force_N"]).all() and "snap_type" in table
    with pytest.raises(sc.BadInputError, match="numbers"):
        sc.sweep("two_shells", mu=["a"])
    alone = sc.run("two_shells", mu=0.3, phi_bar=0.7, travel_over_R=0.2, pictures=False)
    assert s.where(mu=0.3, phi_bar=0.7)["peak_force_N"][0] == alone.summary["peak_force_N"]
    file = sc.sweep({"schema": "supercircle-sweep/1", "scene": str(SOURCE / "scenes/two_shells.json"), "fixed": SHORT}, seeds=[1, 2])
    assert file["seed"].tolist() == [1, 2]


def test_checks_say_what_is_wrong():
    assert sc.check("two_shells").kind == "scene" and sc.check("sweeps/two_shells").kind == "sweep"
    assert sc.check(CASE / "experiment.json").content["runs"]
    bad = sc.check({"schema": "supercircle-scene/1", "shel": []})
    assert not bad.valid and bad.problems[0].nearest == "shell"


def test_exports_are_imported_and_recordings_replayed(tmp_path):
    found = sc.import_recording(SOURCE / "examples/import/shell_on_cylinder.csv", protocol="shell_on_rigid_cylinder",
                                specimen=SOURCE / "examples/import/specimen.json")
    assert found.write(tmp_path / "new").exists() and "217 rows" in found.account
    replayed = sc.replay(CASE, fidelity="coarse")
    curve = replayed.curves[0]
    assert curve.unit == "N" and curve.time.shape == curve.recorded.shape == curve.simulated.shape
    with open(CASE / f"{curve.run}.csv" if (CASE / f"{curve.run}.csv").exists() else CASE / curve.run) as file:
        rows = [r for r in csv.reader(line for line in file if not line.startswith("#"))]
    assert len(rows) - 1 == len(curve.time)
    # the recording has no hidden effect: simulation and recording differ by a fraction of the force
    assert np.nanstd(curve.recorded - curve.simulated) < 0.2 * np.nanstd(curve.recorded)


def test_a_diagnosis_is_a_dataclass():
    with pytest.raises(sc.BadInputError, match="no effect"):
        sc.diagnose(CASE, without=["phlogiston"])
    with pytest.raises(sc.BadInputError, match="is no diagnosis.json"):
        sc.replay(CASE, fit_of=CASE / "experiment.json")
    d = sc.diagnose(CASE, time_limit_min=0.001, next_experiment=False)
    assert d.status == "done" and d.verdict in ("adequate", "identified", "ambiguous", "outside_catalogue", "inconclusive")
    assert d.statement and d.notes and d.details["schema"] == "supercircle-diagnosis/2" and str(d).startswith(d.verdict)


def test_control_c_ends_work_and_leaves_the_handler():
    before = signal.getsignal(signal.SIGINT)
    for work in (lambda: sc.run("stack30", pictures=False), lambda: sc.sweep("stack30", seeds=range(1, 9)), lambda: sc.diagnose(CASE)):
        timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            work()
        assert signal.getsignal(signal.SIGINT) is before


def test_progress_is_told_and_cancels_in_the_callers_thread():
    told = []

    def enough(fraction, stage):
        told.append((threading.current_thread(), fraction, stage))
        return len(told) == 3

    r = sc.run("stack30", pictures=False, progress=enough)
    assert r.status == "cancelled" and len(told) == 3
    assert all(thread is threading.current_thread() and 0 <= fraction <= 1 and stage for thread, fraction, stage in told)

    def broken(fraction, stage):
        raise RuntimeError("mine")

    with pytest.raises(RuntimeError, match="mine"):
        sc.run("stack30", pictures=False, progress=broken)


def test_threads_work_beside_each_other():
    results = {}

    def work(mu):
        results[mu] = sc.run("two_shells", mu=mu, pictures=False, **SHORT).summary["peak_force_N"]

    threads = [threading.Thread(target=work, args=(mu,)) for mu in (0.1, 0.2, 0.3)]
    [t.start() for t in threads]
    [t.join() for t in threads]
    assert results[0.1] < results[0.2] < results[0.3]
