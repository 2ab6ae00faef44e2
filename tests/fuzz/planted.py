#!/usr/bin/env python3
"""Counts how many of the mistakes in planted.toml the fuzz targets find: planted.py [--folder DIR] [--target NAME] [NUMBER...]

Copies the sources, plants all mistakes there, each behind a switch (the number in FORCESHADE_PLANTED), builds the targets once, and
runs for each mistake its target: on the seeds alone, then in the short form. Without a switch every target has to pass. DIR is
made, or used again, and stays. Fails if fewer than three quarters of the mistakes are found."""
import argparse
import concurrent.futures
import glob
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
LEAST = 0.75  # found, of those tried
SWITCH = """#pragma once
#include <cstdlib>
namespace planted {
inline bool on(int number) {
    static const int chosen = std::getenv("FORCESHADE_PLANTED") ? std::atoi(std::getenv("FORCESHADE_PLANTED")) : 0;
    return number == chosen;
}
} // namespace planted
"""
BUILD = """. host/set_up.sh
build build/fuzz -DFORCESHADE_FUZZ=ON -DCMAKE_BUILD_TYPE=Fuzz -DCMAKE_CXX_COMPILER=clang++"""


def read_bugs():
    with open(ROOT / "tests/fuzz/planted.toml", "rb") as file:
        bugs = tomllib.load(file)["bug"]
    for number, bug in enumerate(bugs, 1):
        bug["number"] = number
    return bugs


def planted(text, bug):
    """The file's text with the mistake behind its switch."""
    right, wrong = bug["right"], bug["wrong"]
    around = bug.get("at", right)
    if text.count(around) != 1 or around.count(right) != 1:
        sys.exit(f"mistake {bug['number']}: what is to be replaced does not stand once in {bug['file']}")
    if right.endswith(";"):
        both = f"{{ if (planted::on({bug['number']})) {{ {wrong} }} else {{ {right} }} }}"
    else:
        both = f"(planted::on({bug['number']}) ? ({wrong}) : ({right}))"
    return text.replace(around, around.replace(right, both))


def plant(bugs, folder):
    """Writes what differs, so that a folder that was built before is not built anew."""
    texts = {"tests/fuzz/planted.h": SWITCH}
    for bug in bugs:
        # All counts are of the text as it is in the repository: mistakes of one file do not touch each other.
        before = texts.get(bug["file"]) or '#include "tests/fuzz/planted.h"\n' + (ROOT / bug["file"]).read_text()
        texts[bug["file"]] = planted(before, bug)
    for name in subprocess.check_output(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, text=True).split("\n"):
        if not (ROOT / name).is_file():
            continue
        there = folder / name
        there.parent.mkdir(parents=True, exist_ok=True)
        text = texts.pop(name).encode() if name in texts else (ROOT / name).read_bytes()
        if not there.exists() or there.read_bytes() != text:
            there.write_bytes(text)
            shutil.copymode(ROOT / name, there)
    for name, text in texts.items():
        if not (folder / name).exists() or (folder / name).read_text() != text:
            (folder / name).write_text(text)


def run(command, folder, number):
    """How a target ended: "", or what it found."""
    there = dict(os.environ, FORCESHADE_PLANTED=str(number))
    ended = subprocess.run(command, cwd=folder, env=there, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors="replace")
    if ended.returncode == 0:
        return ""
    for mark, kind in (("defect: ", "check"), ("ALARM: ", "timeout"), ("out-of-memory", "memory")):
        if mark in ended.stdout:
            return kind
    return "crash"


def on_seeds(target, folder, number):
    inputs = [str(one) for one in (folder / "build/fuzz/seeds" / target, folder / "tests/fuzz/found" / target) if one.is_dir()]
    return run([f"build/fuzz/fuzz_{target}", "-runs=0", "-timeout=10", "-rss_limit_mb=3000", "-max_len=20000",
                f"-artifact_prefix=build/fuzz/failed/{target}-", *inputs], folder, number)


def in_short_form(target, folder, number):
    return run(["tests/fuzz/run", "short", target, "build/fuzz"], folder, number)


def try_target(target, bugs, folder):
    (folder / "build/fuzz/failed").mkdir(exist_ok=True)
    if in_short_form(target, folder, 0):
        sys.exit(f"fuzz_{target} fails without a mistake")
    found = {}
    for bug in bugs:
        seeds = on_seeds(target, folder, bug["number"])
        found[bug["number"]] = ("seeds", seeds) if seeds else ("short", in_short_form(target, folder, bug["number"]))
        for left in glob.glob(f"{folder}/build/fuzz/failed/{target}-*"):
            os.unlink(left)
    print(f"fuzz_{target} was tried", file=sys.stderr, flush=True)
    return found


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("numbers", nargs="*", type=int)
    options.add_argument("--target")
    options.add_argument("--folder", type=pathlib.Path)
    asked = options.parse_args()
    bugs = read_bugs()
    temporary = None if asked.folder else tempfile.TemporaryDirectory(prefix="forceshade-planted-")
    folder = (asked.folder or pathlib.Path(temporary.name)).resolve()
    plant(bugs, folder)
    subprocess.run(["sh", "-euc", BUILD], cwd=folder, check=True)
    tried = [bug for bug in bugs if (not asked.numbers or bug["number"] in asked.numbers) and asked.target in (None, bug["target"])]
    targets = list(dict.fromkeys(bug["target"] for bug in tried))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        jobs = [pool.submit(try_target, target, [bug for bug in tried if bug["target"] == target], folder) for target in targets]
        found = {number: how for job in jobs for number, how in job.result().items()}
    for bug in tried:
        where, how = found[bug["number"]]
        print(f"{bug['number']:2} {bug['target']:10} {where + ': ' + how if how else 'MISSED':15} {bug['what']}")
    seeds = sum(where == "seeds" for where, how in found.values())
    all_found = sum(how != "" for where, how in found.values())
    print(f"found {all_found} of {len(tried)}: {seeds} by the seeds alone, {all_found - seeds} by the rest of the short form")
    return 0 if all_found >= LEAST * len(tried) else 1


if __name__ == "__main__":
    sys.exit(main())
