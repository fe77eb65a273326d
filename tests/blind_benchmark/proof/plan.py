"""The set: which cases, in which order, and the seed that nobody picks."""
import hashlib
import os
import subprocess

from conceal import draw_of, pairs, setup

SET = "proof_3"
SET_UPS = ("pendulum", "mass_on_spring", "torsional_pendulum", "sled", "cantilever_vibration", "cantilever_weights",
           "ring_between_plates", "arch_between_plates")
NO_PROGRAM = {"docs", "README.md", "CHANGELOG.md"}  # top-level entries that change between hashes and results
CLAIMS = "docs/results/claims.md"


def git(top, *words, text=None):
    # A checkout that belongs to somebody else, as under sudo, is read all the same.
    done = subprocess.run(["git", "-c", f"safe.directory={top}", "-C", top, *words], input=text, capture_output=True,
                          text=True, env={**os.environ, "LC_ALL": "C"})
    if done.returncode != 0:
        raise RuntimeError(f"git {' '.join(words)} failed in {top}: {done.stderr.strip()}")
    return done.stdout


def program_tree(top, commit="HEAD"):
    """Hash of the git tree of a commit without documents, but with the page of the claims."""
    lines = [line for line in git(top, "ls-tree", commit).splitlines() if line.split("\t")[1] not in NO_PROGRAM]
    claims = git(top, "ls-tree", commit, CLAIMS).strip()
    if claims:
        lines.append(claims.replace("\t" + CLAIMS, "\tclaims.md"))
    return git(top, "mktree", text="\n".join(lines) + "\n").strip()


def seed_of(tree, name):
    """The first 64 bits of SHA-256(tree hash + name of the set)."""
    return int.from_bytes(hashlib.sha256((tree + name).encode()).digest()[:8], "big")


def cases_of(set_up, seed):
    """The 16 cases of a set-up: (kind, strength, families)."""
    module, draw = setup(set_up), draw_of(seed, set_up)
    names = [f.name for f in module.FAMILIES]
    draw.shuffle(names)
    singles = [names[i % len(names)] for i in range(6)]
    limit = [names[(i + 6) % len(names)] for i in range(2)]
    cases = [("control", "", [])] * 3 + [("swap", "", []), ("below", "below", [draw.choice(names)])]
    cases += [("single", "strong", [n]) for n in singles] + [("limit", "limit", [n]) for n in limit]
    cases += [("pair", "strong", draw.choice(pairs(module)))]
    outside = [f.name for f in module.OUTSIDE]
    draw.shuffle(outside)
    cases += [("outside", "strong", [outside[i % len(outside)]]) for i in range(2)]
    return cases


def plan(seed, set_ups=SET_UPS):
    """All cases in the order of the set. A name tells nothing about a case."""
    every = [{"set_up": s, "kind": kind, "strength": strength, "families": families}
             for s in set_ups for kind, strength, families in cases_of(s, seed)]
    draw_of(seed, "order").shuffle(every)
    return [{"name": f"case_{i + 1:03d}", **case} for i, case in enumerate(every)]
