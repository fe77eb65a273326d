#!/usr/bin/env python3
"""Whether the type hints of the Python package are right: check_types.py --source DIR --cache DIR. 77: mypy is missing."""
import argparse
import importlib.util
import subprocess
import sys


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", required=True)
    parser.add_argument("--cache", required=True)
    a = parser.parse_args()
    if importlib.util.find_spec("mypy") is None:
        print("mypy is not installed: .ci/packages-check has it")
        return 77
    return subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", a.cache, f"{a.source}/bridge/python/src"]).returncode


if __name__ == "__main__":
    sys.exit(main())
