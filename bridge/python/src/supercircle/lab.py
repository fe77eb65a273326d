"""The laboratory: runs, sweeps, imports, replays, diagnoses and checks. Arrays are NumPy's, not finite numbers are NaN.

Every call can be interrupted by Ctrl-C, which raises KeyboardInterrupt, and tells `progress(fraction, stage)` ten times
a second how far it is. A `progress` that returns True cancels.
"""

from __future__ import annotations

import html
import itertools
import json
import os
import pathlib
import re
import signal
import threading
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Mapping, Optional, Sequence, TypeVar, Union

import numpy as np
from numpy.typing import NDArray

from . import _api, _convert, _files
from ._convert import Floats, SceneSource
from ._loader import laboratory
from .errors import BadInputError, FailedError
from .world import Problem, problems_of

Progress = Optional[Callable[[float, str], Optional[bool]]]
Path = Union[str, "os.PathLike[str]"]
Value = TypeVar("Value")
_numbers = itertools.count(1)


def _ask(call: str, request: Mapping[str, Any], progress: Progress) -> dict[str, Any]:
    """Answer of a call that can be interrupted. Python's handlers of signals run in the main thread, between two
    bytecodes: an exception raised inside the callback would be lost, so the handler keeps it for the end of the call."""
    caught: list[BaseException] = []

    def told(_context: int | None, fraction: float, stage: bytes) -> int:
        if progress is not None and not caught:
            try:
                return int(progress(fraction, stage.decode()) is True)
            except BaseException as error:
                caught.append(error)
        return int(bool(caught))

    before = signal.getsignal(signal.SIGINT) if threading.current_thread() is threading.main_thread() else None
    handler = before if callable(before) else None

    def interrupted(number: int, frame: Any) -> None:
        try:
            handler(number, frame)  # type: ignore[misc]
        except BaseException as error:
            caught.append(error)

    text = json.dumps({k: v for k, v in request.items() if v is not None}, default=_convert._plain).encode()
    if handler is not None:
        signal.signal(signal.SIGINT, interrupted)
    try:
        answer = getattr(laboratory(), call)(text, _api.sc_lab_progress(told), None)
    finally:
        if handler is not None:
            signal.signal(signal.SIGINT, handler)
    if caught:
        raise caught[0]
    return dict(json.loads(answer))


def _array(values: Sequence[float | None]) -> Floats:
    return np.array(values, dtype=np.float64)


def _scene(scene: SceneSource) -> dict[str, Any]:
    """Members of a request; a file is read by the library, which knows its folder."""
    if isinstance(scene, Mapping):
        return {"scene": dict(scene)}
    name = os.fspath(scene)
    return {"scene": name} if name.lstrip().startswith("{") else {"file": str(_files.find(name))}


def _done(kind: str, answer: Mapping[str, Any], result: Any) -> None:
    if answer["status"] == "failed":
        error = FailedError(answer.get("message") or f"the {kind} failed")
        error.result = result
        raise error


class Named(Dict[str, Value]):
    """A dict whose KeyError names the nearest key, or all."""

    def __missing__(self, name: str) -> Value:
        raise KeyError(_convert.unknown(name, self))


class Series(Named[Floats]):
    """Columns of a run by name, as items or attributes: series["force_N"], series.force_N. Each has shape (rows,). A
    dict: pandas.DataFrame(series) has the same columns."""

    def __getattr__(self, name: str) -> Floats:
        if name.startswith("_") or name not in self:
            raise AttributeError(f"no column {_convert.unknown(name, self)}")
        return self[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __repr__(self) -> str:
        return f"Series({', '.join(self)}; {len(next(iter(self.values()), ()))} rows)"


@dataclass(repr=False)
class Result:
    """A run.

    status: "done" or "cancelled"
    scene: its name; notes: remarks about the scene
    summary: numbers of the run by name, such as peak_force_N
    series: columns of the run, such as time_s, displacement_m, force_N
    events: each with time_s, displacement_m, force_N, kind, text
    pictures: SVG texts by name: before, peak, after (or start, end), curve
    motion: shapes over time, as the program's trajectory.json; None unless asked for
    """

    status: str
    message: str
    scene: str
    notes: list[str]
    summary: Named[Any]
    series: Series
    events: list[dict[str, Any]]
    pictures: dict[str, str] = field(default_factory=dict)
    motion: Any = None

    def __repr__(self) -> str:
        peak = self.summary.get("peak_force_N")
        force = f", peak_force_N={peak:.4g}" if isinstance(peak, float) else ""
        return f"Result({self.scene}, {self.status}{force}, {self.series})"

    def _repr_html_(self) -> str:
        cells = "".join(f'<div style="flex:1 1 240px;max-width:420px">{_unique(svg)}</div>' for svg in self.pictures.values())
        rows = [(k, v) for k, v in self.summary.items() if k in SHOWN]
        table = "".join(f"<tr><th style=\"text-align:left\">{html.escape(k)}</th><td>{html.escape(_short(v))}</td></tr>" for k, v in rows)
        return f'<div><b>{html.escape(self.scene)}</b>: {html.escape(self.status)}<div style="display:flex;flex-wrap:wrap">' \
               f"{cells}</div><table>{table}</table></div>"


SHOWN = ("simulated_s", "peak_force_N", "pull_off_force_R2_over_B", "snap_type", "max_energy_release_R_over_B", "dissipated_J",
         "plate_work_J", "energy_residual_relative")


def _short(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _unique(svg: str) -> str:
    """An SVG whose ids meet no others of a page: browsers take the first of equal ones."""
    n = next(_numbers)
    ids = set(re.findall(r'\bid="([^"]+)"', svg))
    return re.sub(r'(\bid="|url\(#|href="#)([^")]+)', lambda m: f"{m[1]}{m[2]}-{n}" if m[2] in ids else m[0], svg)


def run(scene: SceneSource, *, parameters: Mapping[str, float] | None = None, seed: int = 1, threads: int = 1,
        fixed_dt: float = 0.0, pictures: bool = True, motion: bool = False, progress: Progress = None,
        **more_parameters: float) -> Result:
    """Runs a scene: sc.run("two_shells", mu=0.2).

    scene: a dict, a JSON text, a path, or the name of a shipped scene; sc.scenes() lists them
    parameters: numbers by name; also as keywords
    seed: of the random drop; threads: that a step may use
    fixed_dt: constant steps, s; 0: as the scene says
    pictures, motion: whether the Result has them
    FailedError: the simulation could not go on; its `result` is what was done.
    """
    answer = _ask("sc_lab_run", {**_scene(scene), "parameters": {**(parameters or {}), **more_parameters}, "seed": seed,
                                 "threads": threads, "fixed_dt_s": fixed_dt, "pictures": pictures, "motion": motion}, progress)
    result = Result(answer["status"], answer["message"], answer["scene"], answer["notes"], Named(answer["summary"]),
                    Series({k: _array(v) for k, v in answer["series"].items()}), answer["events"],
                    answer.get("pictures", {}), answer.get("motion"))
    _done("run", answer, result)
    return result


@dataclass(repr=False)
class Sweep:
    """Runs of one scene for sets of parameters and seeds.

    status: "done" or "cancelled"; planned: number of runs asked for
    varied: parameters that vary
    runs: in the order of set and seed; each has parameters, seed, status, message, summary, timing, cycles, branches
    """

    status: str
    name: str
    varied: list[str]
    planned: int
    runs: list[dict[str, Any]]

    def column(self, name: str) -> NDArray[Any]:
        """A parameter, "seed", "status" or a number of the summary, for all runs: shape (runs,). Missing numbers are NaN."""
        known: set[str] = {"seed", "status"}
        values: list[Any] = []
        for row in self.runs:
            parameters, summary = row.get("parameters", {}), row.get("summary") or {}
            known |= parameters.keys() | summary.keys()
            values.append(row[name] if name in ("seed", "status") else parameters.get(name, summary.get(name)))
        if all(v is None for v in values) and name not in known:
            raise KeyError(_convert.unknown(name, sorted(known)))
        if any(isinstance(v, str) for v in values):
            return np.array([v or "" for v in values])
        return np.array([v if isinstance(v, (int, float)) else np.nan for v in values], dtype=np.float64)

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.column(name)

    def table(self) -> dict[str, NDArray[Any]]:
        """All columns: parameters (varied ones first), "seed", "status", numbers and words of the summaries. For
        pandas.DataFrame(sweep.table())."""
        names = dict.fromkeys([*self.varied, *(n for row in self.runs for n in row.get("parameters", {}))])
        names |= {"seed": None, "status": None}
        names |= dict.fromkeys(n for row in self.runs for n, v in (row.get("summary") or {}).items() if not isinstance(v, (dict, list)))
        return {name: self.column(name) for name in names}

    def where(self, **parameters: float) -> Sweep:
        """The runs with these values."""
        keep = [r for r in self.runs if all(np.isclose(r["parameters"].get(k, np.nan), v) for k, v in parameters.items())]
        return Sweep(self.status, self.name, self.varied, len(keep), keep)

    def __len__(self) -> int:
        return len(self.runs)

    def __repr__(self) -> str:
        failed = sum(r["status"] != "done" for r in self.runs)
        return f"Sweep({self.name or 'of ' + ', '.join(self.varied)}: {len(self.runs)} of {self.planned} runs, {failed} failed)"


def sweep(scene: SceneSource, *, seeds: int | Sequence[int] | range | str = 1, jobs: int | None = None,
          cases: Sequence[Mapping[str, float]] | None = None, progress: Progress = None, **grid: Any) -> Sweep:
    """Runs a scene over a grid: sc.sweep("two_shells", mu=[0.1, 0.3], phi_bar=np.linspace(0.6, 0.9, 4), elements=15).

    scene: as of run; or a sweep (path, dict or JSON text of supercircle-sweep/1), then without a grid
    seeds: one, several, or a text such as "1:20"
    jobs: runs at a time; None: all cores
    cases: parameters that belong together
    grid: parameters with their values; a single number holds for all runs
    """
    request: dict[str, Any] = {"jobs": jobs}
    definition = _sweep_text(scene)
    if definition is not None:
        if grid or cases:
            raise BadInputError("a sweep file has its own grid and cases: give the scene itself to use another grid")
        request.update(definition)
        if seeds != 1:
            request["seeds"] = _seeds(seeds)
    else:
        where = _scene(scene)
        varied = {k: _convert.numbers(v).ravel().tolist() for k, v in grid.items() if np.ndim(v) > 0}
        request["sweep"] = {"schema": "supercircle-sweep/1", "scene": os.path.abspath(where["file"]) if "file" in where else "scene.json",
                            "fixed": {k: float(v) for k, v in grid.items() if k not in varied}, **({"grid": varied} if varied else {}),
                            **({"cases": [dict(c) for c in cases]} if cases else {})}
        request["scene"] = where.get("scene")
        request["seeds"] = _seeds(seeds)
    answer = _ask("sc_lab_sweep", request, progress)
    return Sweep(answer["status"], answer["name"], answer["varied"], answer["planned"], answer["runs"])


def _sweep_text(source: SceneSource) -> dict[str, Any] | None:
    """Members of a request, if the source is a sweep."""
    if isinstance(source, Mapping):
        return {"sweep": dict(source)} if str(source.get("schema", "")).startswith("supercircle-sweep/") else None
    text, name = _convert.source_text(source, _files.find)
    if not re.search(rb'"schema"\s*:\s*"supercircle-sweep/', text):
        return None
    return {"sweep": text.decode()} if name == "scene" else {"file": name}


def _seeds(seeds: int | Sequence[int] | range | str) -> str:
    return seeds if isinstance(seeds, str) else ",".join(str(int(s)) for s in np.atleast_1d(np.asarray(seeds)))


@dataclass(frozen=True)
class Check:
    """What a check found.

    kind: "scene", "sweep" or "experiment"
    valid: whether it can be used; problems: also remarks
    content: parameters, runs, and so on
    """

    kind: str
    valid: bool
    problems: list[Problem]
    content: dict[str, Any]


def check(source: SceneSource, **parameters: float) -> Check:
    """Checks a scene, sweep or experiment (path, dict, JSON text, name of a shipped one); parameters as of run."""
    answer = _ask("sc_lab_check", {**_scene(source), "parameters": parameters or None}, None)
    return Check(answer["kind"], answer["valid"], problems_of(answer["problems"]), answer["content"] or {})


@dataclass(frozen=True)
class Imported:
    """Exports of a testing machine, read.

    worst: the gravest doubt about what was read, in words
    account: what was read, in words; details: the same as data
    assumed, missing: what was assumed, and what the description still needs
    files: content by name: experiment.json and the recordings
    """

    worst: str
    account: str
    details: dict[str, Any]
    assumed: list[str]
    missing: list[str]
    files: dict[str, str]

    def write(self, folder: Path) -> pathlib.Path:
        """Writes the files into a folder; returns the path of experiment.json."""
        target = pathlib.Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        for name, content in self.files.items():
            (target / name).write_text(content)
        return target / "experiment.json"


def import_recording(*files: Path, texts: Sequence[str] | None = None, progress: Progress = None, **hints: Any) -> Imported:
    """Reads exports (paths, or their content as `texts`).

    hints: protocol, specimen, scene_file, encoding, columns, units, rate_Hz, speed_m_s, tolerance_m, displacement, force,
        from_turning_point, average, accept, cut, keep, force_zero, as of docs/reference/lab_requests.md
    """
    paths = [os.fspath(f) for f in files]
    answer = _ask("sc_lab_import", {"files": paths or None, "texts": list(texts) if texts else None, **hints}, progress)
    return Imported(answer["worst"], answer["account"], answer["details"], answer["assumed"], answer["missing"], answer["files"])


@dataclass(frozen=True, eq=False)
class Curve:
    """Readings of a run, recorded and simulated, in `unit`.

    time: s; displacement: m; recorded, simulated: the channel; all of shape (readings,), nan where nothing was recorded
    """

    run: str
    channel: str
    unit: str
    time: Floats
    displacement: Floats
    recorded: Floats
    simulated: Floats


@dataclass(frozen=True, eq=False)
class Replay:
    """A recorded experiment, simulated.

    status: "done" or "cancelled"; curves: one a run and channel; details: replay.json of the program
    """

    status: str
    notes: list[str]
    curves: list[Curve]
    details: dict[str, Any]


def replay(experiment: Path, *, parameters: Mapping[str, float] | None = None, effects: Sequence[str] | None = None,
           fit_of: Path | None = None, law_of: Path | None = None, label: str | None = None,
           elements: int | None = None, fidelity: str = "fine", progress: Progress = None) -> Replay:
    """Simulates a recorded experiment and compares.

    experiment: path of its experiment.json
    parameters: numbers by name; effects: such as "planar_drag:f_N_m=0.2"
    fit_of: path of this experiment's diagnosis.json, whose fit is repeated
    law_of: path of another specimen's diagnosis.json, whose law is restated for this section and scored
    label: of the effect; without it the fit that is drawn there, "nothing" that without an effect
    elements: arcs of a specimen; fidelity: "fine" or "coarse"
    FailedError: a run could not be simulated; its `result` is what was done.
    """
    answer = _ask("sc_lab_replay", {"file": _experiment(experiment), "parameters": parameters, "effects": list(effects) if effects else None,
                                    "with": _path(fit_of), "carry": _path(law_of), "label": label, "elements": elements,
                                    "fidelity": fidelity}, progress)
    curves = [Curve(c["run"], c["channel"], c["unit"], _array(c["time_s"]), _array(c["displacement_m"]), _array(c["recorded"]),
                    _array(c["simulated"])) for c in answer["curves"]]
    result = Replay(answer["status"], answer["notes"], curves, answer["replay"])
    _done("replay", answer, result)
    return result


def _path(path: Path | None) -> str | None:
    return None if path is None else str(pathlib.Path(os.fspath(path)).expanduser())


def _experiment(path: Path) -> str:
    given = pathlib.Path(os.fspath(path)).expanduser()
    return str(given / "experiment.json" if given.is_dir() else given)


@dataclass(frozen=True)
class Estimate:
    """A parameter of an effect.

    value: in `unit`
    ci90: its 90 % interval
    resolves_sign: whether the mirror image fits worse
    """

    value: float
    unit: str
    ci90: tuple[float, float]
    resolves_sign: bool


@dataclass(frozen=True)
class Effect:
    """Physics that the runs show.

    label, slot, law: name, kind and formula
    probability: of all hypotheses that contain it
    parameters: Estimates by name; derived: products of them
    confounded_with, joint_with: labels that cannot be distinguished from it, that act beside it
    """

    label: str
    slot: str
    law: str
    probability: float
    parameters: dict[str, Estimate]
    derived: dict[str, Estimate]
    confounded_with: list[str]
    joint_with: list[str]


@dataclass(frozen=True)
class Nominal:
    """A value of the description, such as "friction".

    stated, uncertainty: by the description, half-width of its interval; fitted: to the runs, without any effect
    standardised_shift: (fitted - stated) / uncertainty; beyond +-1 it left the interval
    """

    stated: float
    uncertainty: float
    fitted: float
    standardised_shift: float


@dataclass(frozen=True)
class WrongNumber:
    """A number that the runs want outside its stated interval.

    name, unit: of the description; value: fitted, without regard to what is stated
    ci90: its 90 % interval; probability: that it is wrong, of all hypotheses that contain it
    """

    name: str
    unit: str
    value: float
    ci90: tuple[float, float]
    probability: float


@dataclass(frozen=True)
class Diagnosis:
    """What physics a simulation of a recorded experiment leaves out.

    status: "done" or "cancelled", then without a verdict
    verdict: "adequate", "identified", "ambiguous", "outside_catalogue", "inconclusive", or "" if cancelled
    statement: one or two sentences
    probability_adequate, misfit_p_value: nan if not computed
    effects: fitted effects, most probable first
    nominal: values of the description by name, stated and fitted
    wrong_numbers: stated numbers that may be wrong, most probable first; the statement says whether one is
    misfit_intervals: where the runs differ from the simulation, largest first
    next_experiment: what to record next; None: not open, not looked for, or nothing tells enough
    notes: what limits the result
    details: all of diagnosis.json (docs/reference/diagnosis_json.md)
    """

    status: str
    verdict: str
    statement: str
    probability_adequate: float
    misfit_p_value: float
    effects: list[Effect]
    nominal: dict[str, Nominal]
    wrong_numbers: list[WrongNumber]
    misfit_intervals: list[dict[str, Any]]
    next_experiment: dict[str, Any] | None
    notes: list[str]
    details: dict[str, Any]

    def __str__(self) -> str:
        return f"{self.verdict}: {self.statement}" if self.verdict else self.status


def _number(value: float | None) -> float:
    return float("nan") if value is None else float(value)


def _interval(p: Mapping[str, Any]) -> tuple[float, float]:
    low, high = p.get("ci90") or (None, None)
    return _number(low), _number(high)


def _estimates(parameters: Mapping[str, Any] | None) -> dict[str, Estimate]:
    return {name: Estimate(_number(p.get("value")), p.get("unit", ""), _interval(p), bool(p.get("resolves_sign", True)))
            for name, p in (parameters or {}).items()}


def diagnose(experiment: Path, *, jobs: int | None = None, seed: int = 1, without: Sequence[str] | None = None,
             time_limit_min: float = 10.0, next_experiment: bool = True, cache: Path | None = None,
             progress: Progress = None) -> Diagnosis:
    """Finds what physics a simulation of a recorded experiment leaves out.

    experiment: path of its experiment.json
    jobs: simulations at a time; None: all cores
    without: effects left out of the catalogue
    time_limit_min: minutes; 0: none
    next_experiment: whether one is looked for, which may take as long as the verdict
    cache: file of simulations, to continue later
    """
    answer = _ask("sc_lab_diagnose", {"file": _experiment(experiment), "jobs": jobs, "seed": seed, "without": list(without) if without else None,
                                      "time_limit_min": time_limit_min, "next_experiment": next_experiment,
                                      "cache": os.fspath(cache) if cache is not None else None}, progress)
    _done("diagnosis", answer, None)
    found = answer.get("diagnosis", {})
    effects = [Effect(e["label"], e.get("slot", ""), e.get("law", ""), _number(e.get("probability")), _estimates(e.get("parameters")),
                      _estimates(e.get("derived")), list(e.get("confounded_with", [])), list(e.get("joint_with", [])))
               for e in found.get("effects", [])]
    nominal = Named({name: Nominal(*(_number(v.get(key)) for key in ("stated", "uncertainty", "fitted", "standardised_shift")))
                     for name, v in found.get("nominal", {}).items()})
    numbers = [WrongNumber(n["name"], n["unit"], _number(n.get("value")), _interval(n), _number(n.get("probability")))
               for n in found.get("wrong_numbers", [])]
    return Diagnosis(answer["status"], found.get("verdict", ""), found.get("statement", ""), _number(found.get("probability_adequate")),
                     _number(found.get("misfit_p_value")), effects, nominal, numbers, found.get("misfit_intervals", []),
                     found.get("next_experiment"), [*answer["notes"], *found.get("notes", [])], found)
