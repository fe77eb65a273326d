#!/usr/bin/python3
"""Makes a blind set, diagnoses it, opens the answers, scores and prints (docs/results/claims.md).

Started by ./prove.sh. A folder of state holds everything; the same command continues a run that was stopped.
"""
import argparse
import concurrent.futures
import csv
import hashlib
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tarfile
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import conceal  # noqa: E402
import distance  # noqa: E402
import plan as plans  # noqa: E402
import print_page  # noqa: E402
import rivals  # noqa: E402
import scoring  # noqa: E402

CPU_LIMIT = 900  # s of the processor; a diagnosis that takes longer is a time-out
# Minutes of the processor, after which the best verdict so far is written, which takes a part of the tenth. Other work
# on the computer must not end a diagnosis, as it did in four cases of proof_2.
BEST_VERDICT = "9"
PATIENCE = 4 * CPU_LIMIT  # s, elapsed: it waits for something that does not come


class Refused(Exception):
    """Bad input: a sentence for the user."""


def sha256(path):
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


def write(path, text):
    """The whole file or none of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    part.replace(path)


def identity(top, program, name, seed):
    """What a folder of state belongs to. Refuses a tree with changes."""
    changes = plans.git(top, "status", "--porcelain").splitlines()
    if changes:
        raise Refused(f"the tree has {len(changes)} uncommitted changes (first: {changes[0].strip()}); "
                      "commit or stash them, because the seed follows from the commit")
    tree = plans.program_tree(top)
    return {"set": name, "seed": plans.seed_of(tree, name) if seed is None else seed, "program": tree,
            "binary": sha256(program)}


def open_state(folder, own):
    """Begins or continues a state. Refuses one of another program, set or seed."""
    file = folder / "state.json"
    if file.exists():
        before = json.loads(file.read_text())
        other = [key for key in own if before.get(key) != own[key]]
        if other:
            raise Refused(f"{folder} belongs to another run ({', '.join(other)} differ); give another --state, or "
                          "remove it")
    elif folder.exists() and any(folder.iterdir()):
        raise Refused(f"{folder} is not empty and holds no state of ./prove.sh; give another --state")
    else:
        write(file, json.dumps(own, indent=1) + "\n")


def record(folder, case, seed):
    """Recordings and answer of one case; the seconds it took. The answer comes last: where it exists, all is there."""
    begun = time.monotonic()
    files, truth = conceal.make_case(case, seed)
    shutil.rmtree(folder / "cases" / case["name"], ignore_errors=True)
    for name, text in files.items():
        write(folder / "cases" / case["name"] / name, text)
    write(folder / "answers" / f"{case['name']}.json", json.dumps(truth, indent=1) + "\n")
    return time.monotonic() - begun


def make(folder, cases, seed, jobs):
    """Recordings and answers of all cases. They depend on the seed alone, not on what is recorded beside them."""
    missing = [case for case in cases if not (folder / "answers" / f"{case['name']}.json").exists()]
    with concurrent.futures.ProcessPoolExecutor(max(1, jobs)) as pool:
        recorded = {pool.submit(record, folder, case, seed): case["name"] for case in missing}
        try:
            for i, done in enumerate(concurrent.futures.as_completed(recorded)):
                print(f"{recorded[done]} recorded ({len(cases) - len(missing) + i + 1} of {len(cases)}, "
                      f"{done.result():.0f} s)", flush=True)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def hashes(folder, cases):
    """Lines of sha256sum for all recordings and answers."""
    files = [p for case in cases for p in [*(folder / "cases" / case["name"]).iterdir(),
                                           folder / "answers" / f"{case['name']}.json"]]
    return "".join(f"{sha256(p)}  {p.relative_to(folder)}\n" for p in sorted(files))


def lines_of(text):
    """{file: hash} of lines of sha256sum."""
    return {name: value for value, name in (line.split("  ", 1) for line in text.splitlines())}


def hashed(folder, cases):
    """Writes what is recorded into the hashes of the state. Refuses if something changed since it was written."""
    file, now = folder / "hashes.sha256", lines_of(hashes(folder, cases))
    before = lines_of(file.read_text()) if file.exists() else {}
    changed = [name for name, value in now.items() if before.get(name, value) != value]
    if changed:
        raise Refused(f"{folder / changed[0]} changed after it was hashed; begin again in another --state")
    write(file, "".join(f"{value}  {name}\n" for name, value in sorted((before | now).items())))


def rows_of(experiment):
    described = json.loads(experiment.read_text())
    return sum(sum(1 for _ in open(experiment.parent / run["file"], encoding="utf-8")) - 1
               for run in described["runs"])


def run_program(words, seconds=CPU_LIMIT, patience=PATIENCE):
    """(exit code or 'time-out', CPU seconds, last line). Ctrl-C reaches the program too.

    What else runs on the machine does not decide about a time-out: the processor's seconds are limited."""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        begun = subprocess.Popen(words, stdout=out, stderr=err)
        resource.prlimit(begun.pid, resource.RLIMIT_CPU, (seconds, seconds))
        late = threading.Event()
        timer = threading.Timer(patience, lambda: (late.set(), os.kill(begun.pid, signal.SIGKILL)))
        timer.start()
        _, status, used = os.wait4(begun.pid, 0)  # of this program alone: others run beside it
        timer.cancel()
        begun.returncode = os.waitstatus_to_exitcode(status)
        text = ""
        for file in (out, err):  # errors come last
            file.seek(0)
            text = file.read().strip() or text
    over = late.is_set() or begun.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
    code = "time-out" if over else begun.returncode
    if over:
        text = f"longer than {seconds} CPU seconds"
    return code, used.ru_utime + used.ru_stime, text.splitlines()[-1] if text else ""


def process_error(program, case, to):
    """Held-out error of a Gaussian process on what the baseline leaves; None where it cannot be computed."""
    with_baseline = f"{to / 'diagnosis.json'}:nothing"
    code, _, why = run_program([program, "replay", str(case / "experiment.json"), "--with", with_baseline, "--out",
                                str(to / "baseline"), "--quiet"])
    if code != 0:
        print(f"{case.name}: no Gaussian process: {why}", flush=True)
        return None
    names = [pathlib.Path(run["file"]).stem for run in json.loads((case / "experiment.json").read_text())["runs"]]
    try:
        return rivals.process_error([to / "baseline" / f"{name}_replay.csv" for name in names])
    except (OSError, ValueError) as why:  # a rival's failure is no reason to lose the case
        print(f"{case.name}: no Gaussian process: {why}", flush=True)
        return None


def diagnose_one(folder, program, name):
    """Diagnoses a case by one thread; its CPU seconds, written with its diagnosis."""
    to, recordings = folder / "diagnoses" / name, folder / "cases" / name
    shutil.rmtree(to, ignore_errors=True)  # a cache of a stopped diagnosis would make it look cheap
    code, cpu, message = run_program([program, "diagnose", str(recordings / "experiment.json"), "--out", str(to),
                                      "--jobs", "1", "--skip-next-experiment", "--quiet", "--time-limit", "0",
                                      "--cpu-limit", BEST_VERDICT])
    if code in (130, -signal.SIGINT):
        raise KeyboardInterrupt
    result = {"exit": "done" if code == 0 else f"refused ({code})" if code != "time-out" else code, "cpu_s": cpu,
              "message": message, "rows": rows_of(recordings / "experiment.json")}
    if code == 0:
        result["diagnosis"] = json.loads((to / "diagnosis.json").read_text())
        result["process_rmse"] = process_error(program, recordings, to)
    write(to / "result.json", json.dumps(result) + "\n")
    return cpu


def diagnose(folder, program, cases, jobs):
    """Diagnoses what is not diagnosed, several cases at a time."""
    missing = [c["name"] for c in cases if not (folder / "diagnoses" / c["name"] / "result.json").exists()]
    stopped = threading.Event()

    def one(name):
        if stopped.is_set():
            return None
        try:
            return diagnose_one(folder, program, name)
        except BaseException:
            stopped.set()
            raise

    with concurrent.futures.ThreadPoolExecutor(max(1, jobs)) as pool:
        begun = {pool.submit(one, name): name for name in missing}
        try:
            for i, done in enumerate(concurrent.futures.as_completed(begun)):
                cpu = done.result()
                if cpu is not None:
                    print(f"{begun[done]} diagnosed ({len(cases) - len(missing) + i + 1} of {len(cases)}, "
                          f"{cpu / 60:.1f} CPU min)", flush=True)
        except BaseException:
            stopped.set()
            raise


def rows(folder, cases):
    """Opens the answers. Refuses if one changed since it was hashed."""
    hashed(folder, cases)
    return [scoring.score(json.loads((folder / "answers" / f"{c['name']}.json").read_text()),
                          json.loads((folder / "diagnoses" / c["name"] / "result.json").read_text())) for c in cases]


def write_results(file, own, scored):
    with open(file, "w", newline="", encoding="utf-8") as f:
        f.write(f"# set {own['set']}, seed {own['seed']}, program {own['program']}\n")
        out = csv.DictWriter(f, scoring.COLUMNS, lineterminator="\n")
        out.writeheader()
        out.writerows(scored)


def proof_file(top, own, end):
    return pathlib.Path(top, "docs/results/proof", own["set"] + end)


def archive(folder, file):
    """Recordings and answers in one file, the same bytes every time."""
    with tarfile.open(file, "w:xz") as out:
        for path in sorted(p for kind in ("cases", "answers") for p in (folder / kind).rglob("*") if p.is_file()):
            member = tarfile.TarInfo(str(path.relative_to(folder)))
            member.size = path.stat().st_size
            with open(path, "rb") as content:
                out.addfile(member, content)


def unpack(folder, file):
    """Recordings and answers of a published set, so that nobody has to make them again."""
    with tarfile.open(file) as packed:
        for member in packed:
            path = pathlib.PurePosixPath(member.name)
            if not member.isfile() or path.is_absolute() or ".." in path.parts:
                raise Refused(f"{file}: {member.name} is no recording")
            write(folder / path, packed.extractfile(member).read().decode())


def published(top, own, folder):
    """Whether the hashes of the set are committed. Otherwise they are put where they are to be committed."""
    file, text = proof_file(top, own, ".sha256"), (folder / "hashes.sha256").read_text()
    if not file.exists():
        archive(folder, proof_file(top, own, ".tar.xz"))
        shutil.copy(folder / "distance.csv", proof_file(top, own, "_distance.csv"))
        write(file, text)
        print(f"\nHashes of the set: {file}\nCommit it with its recordings and distances beside it, then run the same "
              "command again: the diagnoses begin when they are in git.")
        return False
    if file.read_text() != text:
        raise Refused(f"{file} holds other hashes: this set was published by another program; give the set another "
                      "name in tests/blind_benchmark/proof/plan.py")
    return True


def near_enough(program, folder, jobs):
    """Set-ups whose controls the tool's simulator meets with the true numbers (docs/results/claims.md)."""
    file = folder / "distance.csv"
    if not file.exists():
        lines = distance.measure(program, plans.SET_UPS, folder / "distance", jobs=jobs)
        distance.write_lines(lines, file)
    far = distance.too_far(distance.read_lines(file))
    if far:
        print(f"not used, the simulators differ by more than {distance.LIMIT} noise standard deviations: {', '.join(far)}")
    return [s for s in plans.SET_UPS if s not in far]


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="./prove.sh", description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, help="a seed of your own; without it the seed follows from the program")
    parser.add_argument("--first", type=int, metavar="K", help="only the first K cases of the set")
    parser.add_argument("--state", metavar="FOLDER", help="recordings, diagnoses, scores (out/prove/SET_SEED)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="recordings, then diagnoses at a time (all cores)")
    parser.add_argument("--top", default=str(pathlib.Path(__file__).resolve().parents[3]), help=argparse.SUPPRESS)
    parser.add_argument("--program", default="build/bin/supercircle", help=argparse.SUPPRESS)
    o = parser.parse_args(arguments)
    program = str(pathlib.Path(o.top, o.program))
    os.environ.setdefault("SYNTHETIC_CASES", str(pathlib.Path(o.top, "build/tests/synthetic_cases")))
    try:
        own = identity(o.top, program, plans.SET, o.seed)
        official = own["seed"] == plans.seed_of(own["program"], own["set"])
        if official and (o.seed is not None or o.first is not None):
            raise Refused("the seed that follows from the program is kept for the whole set, or its cases would be seen "
                          "before their hashes are published; " + ("leave --seed out" if o.first is None else
                                                                   "give --first a --seed of your own"))
        folder = pathlib.Path(o.state or pathlib.Path(o.top, "out/prove", f"{own['set']}_{own['seed']}")).absolute()
        open_state(folder, own)
        whole = plans.plan(own["seed"], near_enough(program, folder, o.jobs))
        if o.first is not None and not 1 <= o.first <= len(whole):
            raise Refused(f"--first {o.first}: the set has {len(whole)} cases; give 1 to {len(whole)}")
        cases = whole[:o.first]
        print(f"{len(cases)} of {len(whole)} cases of {own['set']}, seed {own['seed']}; state: {folder}", flush=True)
        if official and proof_file(o.top, own, ".tar.xz").exists() and not (folder / "answers").exists():
            unpack(folder, proof_file(o.top, own, ".tar.xz"))
        make(folder, cases, own["seed"], o.jobs)
        hashed(folder, cases)
        if official and not published(o.top, own, folder):
            return 0
        diagnose(folder, program, cases, o.jobs)
        scored = rows(folder, cases)
        write_results(folder / "results.csv", own, scored)
        print("\n" + print_page.page(scored))
        print(f"Cases: {folder / 'results.csv'}; pages: {folder / 'diagnoses'}/*/report.html")
    except Refused as why:
        print(f"prove.sh: {why}", file=sys.stderr)
        return 2
    except (RuntimeError, OSError, KeyError, TypeError, ValueError) as why:
        print(f"prove.sh: {why}; what is done is kept, the same command continues", file=sys.stderr)
        return 3
    except KeyboardInterrupt:
        print("prove.sh: interrupted; the same command continues", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
