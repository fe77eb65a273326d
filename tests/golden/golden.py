#!/usr/bin/env python3
"""Golden runs: they show whether two builds compute the same numbers, whatever files, keys and options are called.

    golden.py --build DIR [--set quick|slow|all] [--only NAME ...]    prints `sha256  name` of every run
    golden.py --build DIR --check FILE.sha256                         compares with kept sums; exit 1 if one differs
    golden.py --build DIR --against DIR2 [--show N]                   compares two builds; shows N differences (1)

DIR is a build folder. Its CMakeCache.txt names the checkout, whose scenes and recordings are used.
NAME may hold * and ?. Exit codes: 0 equal, 1 different or failed, 2 bad input.

Canonical form of a file: places with their values. Numbers are compared as printed.
  JSON  A place is a path of keys and indices. The order of keys does not count. An array of scalars is one place.
  CSV   A place is a line. Names of columns are not compared.
        results.csv: a place is a column. statistics.csv: a place is a quantity of a parameter set.
  text  The numbers and hashes in their order.
Words are left out, except those of KEPT. Machine time is left out (MACHINE).
renamed.csv maps new names to old ones; `-` as old name leaves a place out. `*` stands for one part of a path.

To add a run: add a line to RUNS, then append its sum to quick.sha256, or to slow.sha256 above 10 s of processor time.
To rename a key: add a row to renamed.csv. The sums stay. To change a number on purpose: write the sums again.
A change of the canonical form needs new sums, made with a build that gave the old ones.
"""
import argparse
import fnmatch
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True  # no __pycache__ in the checkout
from canonical import TABLE, canonical, differences, sum_of  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))


class Failure(Exception):
    """A run that cannot be made, with the reason."""


def bad_input(message):
    """Ends the program."""
    print(message, file=sys.stderr)
    sys.exit(2)


# ---- a build ---------------------------------------------------------------------------------------------------------

def files_below(folder, without):
    """Paths of all files below a folder."""
    found = []
    for root, folders, names in os.walk(folder):
        folders[:] = sorted(set(folders) - without)
        found += [os.path.join(root, name) for name in sorted(names)]
    return found


class Build:
    """Programs of a build folder, and the files of its checkout."""

    def __init__(self, folder, jobs):
        self.folder, self.jobs = folder, str(jobs)
        self.built = files_below(folder, {"CMakeFiles", "_CPack_Packages", "Testing", "foreign", "install_consumer"})
        caches = [path for path in self.built if path.endswith("/CMakeCache.txt")]
        if not caches:
            bad_input(f"{folder}: no CMakeCache.txt; name a build folder")
        with open(min(caches, key=len), encoding="utf-8") as file:
            self.source = re.search(r"^CMAKE_HOME_DIRECTORY:INTERNAL=(.*)$", file.read(), re.M).group(1)
        self.sources = files_below(self.source, {"build", "out", ".git"})

    def program(self, pattern):
        """The newest program whose file name matches."""
        found = [p for p in self.built if re.fullmatch(pattern, os.path.basename(p)) and os.access(p, os.X_OK)]
        if not found:
            raise Failure(f"{self.folder} holds no program {pattern}")
        return max(found, key=os.path.getmtime)

    def file(self, ending):
        """The file of the checkout whose path ends so."""
        found = [path for path in self.sources if path.endswith("/" + ending)]
        if not found:
            raise Failure(f"{self.source} holds no {ending}")
        return min(found, key=len)

    def call(self, program, arguments, older=None):
        """What a program prints. `older`: arguments in older names, tried after exit code 2."""
        done = subprocess.run([self.program(program), *arguments], capture_output=True, text=True, check=False,
                              env={**os.environ, "LC_ALL": "C"}, stdin=subprocess.DEVNULL)
        if done.returncode == 2 and older is not None:
            return self.call(program, older)
        if done.returncode != 0:
            raise Failure(f"{self.folder}: {program} {' '.join(arguments)} ends with {done.returncode}: "
                          f"{done.stderr.strip()[-400:]}")
        return done.stdout

    def parameters(self, scene, values):
        """Options --param with the names that the scene declares."""
        with open(scene, encoding="utf-8") as file:
            declared = json.load(file)["parameters"]
        options = []
        for name, value in values.items():
            names = [name] + [new for new, _, old in TABLE if old == name]
            options += ["--param", f"{next((n for n in names if n in declared), name)}={value}"]
        return options


def results(folder, *patterns):
    """Canonical form of the result files that match."""
    places = {}
    for pattern in patterns:
        names = sorted(fnmatch.filter(os.listdir(folder), pattern))
        if not names:
            raise Failure(f"no {pattern} is written")
        for name in names:
            with open(os.path.join(folder, name), encoding="utf-8", newline="") as file:
                places.update(canonical(name, file.read()))
    return places


# ---- runs ------------------------------------------------------------------------------------------------------------

def run(scene, **values):
    """supercircle run."""
    def make(build, out):
        path = build.file(f"scenes/{scene}.json")
        build.call("supercircle", ["run", path, *build.parameters(path, values), "--seed", "7", "--out", out,
                                   "--no-report", "--quiet"])
        return results(out, "summary.json", "series.csv", "trajectory.json")
    return make


def sweep(name):
    """supercircle sweep of a file beside this program, with the scene of the build."""
    def make(build, out):
        with open(os.path.join(HERE, name + ".json"), encoding="utf-8") as file:
            content = json.load(file)
        content["scene"] = build.file("scenes/" + os.path.basename(content["scene"]))
        with open(out + ".json", "w", encoding="utf-8") as file:
            json.dump(content, file)
        build.call("supercircle", ["sweep", out + ".json", "--out", out, "--jobs", build.jobs, "--quiet"])
        return results(out, "results.csv", "statistics.csv", *(["cycles.csv"] if "stack" in name else []))
    return make


def unfilmed(path, folder):
    """A copy of an experiment without its markers."""
    shutil.copytree(os.path.dirname(path), folder)
    path = os.path.join(folder, "experiment.json")
    with open(path, encoding="utf-8") as file:
        content = json.load(file)
    content["markers"] = []
    content["runs"] = [{k: v for k, v in r.items() if not k.startswith("markers")} for r in content["runs"]]
    with open(path, "w", encoding="utf-8") as file:
        json.dump(content, file)
    return path


def recording(subcommand, case, patterns, options=(), older=None, filmed=True):
    """A subcommand for a recorded experiment. `older`: the options in older names."""
    def make(build, out):
        path = build.file(f"recordings/{case}/experiment.json")
        start = [subcommand, path if filmed else unfilmed(path, out + "_unfilmed"), "--out", out, "--quiet"]
        start += [] if subcommand == "replay" else ["--jobs", build.jobs]
        limit = ["--time-limit", "0"] if subcommand == "diagnose" else []  # results must not depend on the machine
        before = None if older is None and not limit else [*start, *(options if older is None else older)]
        build.call("supercircle", [*start, *limit, *options], before)
        return results(out, *patterns)
    return make


def supercircle(arguments, *patterns):
    """A subcommand; FILE:ending stands for a file of the checkout."""
    def make(build, out):
        build.call("supercircle", [build.file(a[5:]) if a.startswith("FILE:") else a for a in arguments.split()] +
                   ["--out", out] + (["--jobs", build.jobs] if "validate" in arguments else ["--quiet"]))
        return results(out, *patterns)
    return make


def game(name, level, end):
    """A game played by its script, as tests/examples/play.cmake does."""
    def make(build, _):
        expect = [] if end == "played" else ["--expect", end]
        script = build.file(f"examples/{name}_{level}_{end}.json")
        return canonical("output", build.call(name, [level, "--headless", "--script", script, *expect]))
    return make


def program(name, *arguments):
    """What a program prints; of a test only its hashes."""
    def make(build, _):
        text = build.call(name, arguments)
        return canonical("output", "\n".join(re.findall(r"^[0-9a-f]{16}$", text, re.M)) if "test" in name else text)
    return make


REPLAY = ("replay.json", "*_replay.csv", "*_replay_markers.csv")
SENSITIVITY = ("sensitivity.json", "landmarks.csv", "*_sensitivity.csv", "*_sensitivity_markers.csv")
DIAGNOSIS = ("diagnosis.json",)
RUNS = {
    "run_stack30": run("stack30", shells=6, max_force=1),
    "run_cantilever": run("cantilever", gamma=40, c=1, elements=40),
    "run_shell_on_cylinder": run("shell_on_cylinder", phi_bar=0.9, mu=0.5, elements=40),
    "run_two_shells": run("two_shells", phi_bar=0.87, mu=0.5, elements=32),
    "run_squeeze": run("squeeze", mu=0.2, elements=40),
    "run_pinning": run("pinning", mu=0.25, elements=40),
    "run_ramp": run("ramp", mu=0.2, time=1.5),
    "run_effects": run("effects", viscosity=0.02, stiffness_drop=0.3, flattening=2, gradient=0.1, softening=0.1,
                       drag=0.01, sideways=1, static_ratio=1.2, stribeck=0.2, wear_change=0.5, attraction=1,
                       contact_give=1e-5, play=1e-4, offset=1e-4, drift=0.01, gain_error=0.02, delay=0.05, knee=40,
                       machine_stiffness=2000),
    "hello": program("hello"),
    **{f"game_{name}_{level}_{end}": game(name, level, end)
       for name, higher in (("egg_drop", "played"), ("lander", "won"), ("clip", "won"))
       for level, end in (("1", "won"), ("1", "lost"), ("2", higher), ("3", higher))},
    "validate": supercircle("validate --quick", "validation.json"),
    "sweep_two_shells": sweep("sweep_two_shells"),
    "sweep_stack": sweep("sweep_stack"),
    **{f"replay_{n}": recording("replay", f"baseline/case_{n}", REPLAY, ("--fidelity", "coarse"), ("--coarse",))
       for n in range(101, 107)},
    "sensitivity": recording("sensitivity", "training/case_02", SENSITIVITY, ("--fidelity", "coarse"), ()),
    "calibrate": supercircle("calibrate FILE:scenes/two_shells.json --smooth 0.8333 --abrupt 0.8611 "
                             "--param elements=16", "calibration.json"),
    "import": supercircle("import FILE:import/shell_on_cylinder.csv --specimen FILE:import/specimen.json",
                          "experiment.json", "run_1.csv"),
    "bitwise": program("test_.*(fuzz|bitwise).*", "[digits],[bitwise]"),
    "run_stack30_full": run("stack30"),
    "diagnose_03_unfilmed": recording("diagnose", "training/case_03", DIAGNOSIS, filmed=False),  # a next experiment
    "diagnose_04": recording("diagnose", "training/case_04", DIAGNOSIS),
    "diagnose_09": recording("diagnose", "training/case_09", DIAGNOSIS),
    "diagnose_09_without": recording("diagnose", "training/case_09", DIAGNOSIS, ("--without", "sensor_drift")),  # laws
}
SLOW = {name for name in RUNS if name == "run_stack30_full" or name.startswith("diagnose")}


def places_of(build, name, times):
    """Canonical form of one run, made in a new folder."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory(prefix="supercircle-golden.") as folder:
        places = RUNS[name](build, os.path.join(folder, "out"))
    if not any(places.values()):
        raise Failure(f"{build.folder}: no number is written")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if times:
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        print(f"{name}: {cpu:.2f} s of processor time, {len(places)} places", file=sys.stderr, flush=True)
    return places


def chosen(arguments, kept):
    """Names of the runs that are wanted."""
    unknown = sorted(set(kept) - set(RUNS))
    if unknown:
        bad_input(f"{arguments.check}: no such run: {' '.join(unknown)}")
    slow = {"quick": (False,), "slow": (True,), "all": (False, True)}[arguments.set]
    names = list(kept) or [n for n in RUNS if arguments.only or (n in SLOW) in slow]
    if arguments.only:
        names = [n for n in names if any(fnmatch.fnmatch(n, pattern) for pattern in arguments.only)]
    if not names:
        bad_input(f"no such run: {' '.join(arguments.only)}; there are: {' '.join(sorted(RUNS))}")
    return sorted(names)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, metavar="DIR")
    parser.add_argument("--against", metavar="DIR2")
    parser.add_argument("--check", metavar="FILE.sha256")
    parser.add_argument("--set", choices=("quick", "slow", "all"), default="quick")
    parser.add_argument("--only", nargs="+", metavar="NAME")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="for subcommands that have this option")
    parser.add_argument("--show", type=int, default=1, metavar="N", help="differences to print of each run")
    parser.add_argument("--times", action="store_true", help="print the processor time of each run")
    a = parser.parse_args()
    kept = {}
    if a.check:
        with open(a.check, encoding="utf-8") as file:
            kept = {name: digest for digest, name in (line.split() for line in file)}
    names = chosen(a, kept)
    build, other = Build(a.build, a.jobs), Build(a.against, a.jobs) if a.against else None
    bad = 0
    for name in names:
        try:
            places = places_of(build, name, a.times)
            if other:
                found = differences(places, places_of(other, name, a.times))
                line = f"differs  {name}: {len(found)} places" if found else f"equal  {name}"
                line = "\n    ".join([line] + found[:a.show])
            elif kept:
                line = f"{'equal' if kept[name] == sum_of(places) else 'differs'}  {name}"
            else:
                line = f"{sum_of(places)}  {name}"
        except (Failure, LookupError, OSError, ValueError) as failure:
            line = f"failed  {name}: {failure}"
        bad += line.startswith(("differs", "failed"))
        print(line, flush=True)
    if bad and kept:
        print(f"{bad} of {len(names)} runs do not give the kept numbers. "
              "tests/golden/compare.sh OLD_BUILD NEW_BUILD names the first difference.")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
