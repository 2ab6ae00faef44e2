#!/usr/bin/env python3
"""Hours of trouble for a sweep that is shared out, and at the end the bytes of one undisturbed process.

    soak.py PROGRAM LIBRARIES [--seconds 3600] [--cases 1000] [--seed 1]

Parts of a sweep run in one folder as on several machines whose locks do not reach each other. They are killed and
stopped at random and begun again, some to compute everything anew; clocks leap by an hour; and the disk is full at
times, where a small one may be mounted. LIBRARIES: folder of libleaping_clock.so and libnode_locks.so.
"""
import argparse
import collections
import filecmp
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

PARTS = 8
AT_ONCE = 4
NODES = [f"a-machine-whose-name-is-longer-than-a-temporary-tells-{i}" for i in (1, 2)] + ["west"]


def study(cases):
    side = round(cases ** (1 / 3))
    values = lambda first, step, unit, count: ", ".join(f'"{first + step * i:g} {unit}"' for i in range(count))
    return f"""[surface]
radius = [{values(16, 0.5, "mm", side)}]
facets = [{", ".join(str(i + 1) for i in range(side))}]
[force]
shading = "reference"
stiffness = [{values(0.5, 0.01, "N/mm", cases // side // side)}]
[grid]
size = [32, 8, 16]
origin = ["-14 mm", "-1 mm", "-4 mm"]
spacing = "0.9 mm"
"""


class Disk:
    """A file system in memory, whose size changes; without the right to mount one, an ordinary folder."""

    def __init__(self, folder, needed):
        self.folder, self.needed = folder, needed
        folder.mkdir()
        self.mounted = self.mount([])
        self.full = False

    def mount(self, options, size=None):
        options = ",".join([*options, f"size={size or 3 * self.needed}"])
        command = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(self.folder)]
        return subprocess.run(command, stderr=subprocess.DEVNULL).returncode == 0

    def set_full(self, full):
        if not self.mounted:
            return
        state = os.statvfs(self.folder)
        used = (state.f_blocks - state.f_bfree) * state.f_frsize
        if self.mount(["remount"], used + random.randrange(1, 300_000) if full else None):
            self.full = full

    def end(self):
        if self.mounted:
            subprocess.run(["umount", "-l", str(self.folder)])


class Soak:
    def __init__(self, options, root):
        self.options, self.root = options, root
        self.counts = collections.Counter()
        self.processes = {}  # by part
        self.stopped = []
        (root / "study.toml").write_text(study(options.cases))
        self.run(["--out", "whole"])
        needed = sum(file.stat().st_size + 4096 for file in (root / "whole").rglob("*") if file.is_file())
        self.disk = Disk(root / "out", needed)
        if not self.disk.mounted:
            print("no disk could be mounted: none is full")

    def command(self, arguments):
        return [self.options.program, "sweep", "study.toml", "--engine", "cpu", "--quiet", *arguments]

    def run(self, arguments, **environment):
        done = subprocess.run(self.command(arguments), cwd=self.root, env={**os.environ, **environment},
                              capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{arguments} ended with {done.returncode}: {done.stderr}")

    def environment(self, node, leaps):
        libraries = [f"{self.options.libraries}/libnode_locks.so"]
        if leaps:
            libraries.append(f"{self.options.libraries}/libleaping_clock.so")
        return {"LD_PRELOAD": ":".join(libraries), "NODE": node, "LEAP_AFTER": str(random.uniform(0, 1))}

    def begin(self):
        idle = [part for part in range(1, PARTS + 1) if part not in self.processes]
        if len(self.processes) >= AT_ONCE or not idle:
            return
        part = random.choice(idle)
        arguments = ["--out", "out", "--shard", f"{part}/{PARTS}"]
        if random.random() < 0.5:
            arguments.append("--fresh")
        environment = self.environment(random.choice(NODES), random.random() < 0.3)
        self.processes[part] = subprocess.Popen(self.command(arguments), cwd=self.root, stderr=subprocess.PIPE,
                                                env={**os.environ, **environment}, text=True)
        self.counts["begun"] += 1

    def reap(self):
        for part, process in list(self.processes.items()):
            code = process.poll()
            if code is None:
                continue
            error = process.stderr.read()
            del self.processes[part]
            self.counts["killed" if code == -9 else f"ended with {code}"] += 1
            if code not in (0, -9) and not (code == 4 and "space" in error):
                sys.exit(f"part {part} ended with {code}: {error}")

    def trouble(self):
        for process in self.stopped:
            process.send_signal(signal.SIGCONT)
        self.stopped.clear()
        if self.processes and random.random() < 0.5:
            random.choice(list(self.processes.values())).kill()
        elif self.processes and random.random() < 0.7:
            self.stopped.append(random.choice(list(self.processes.values())))
            self.stopped[0].send_signal(signal.SIGSTOP)
            self.counts["stopped"] += 1
        else:
            self.disk.set_full(not self.disk.full)
            self.counts["full"] += self.disk.full

    def work(self):
        self.disk.set_full(True)
        end = time.monotonic() + self.options.seconds
        while time.monotonic() < end:
            self.begin()
            self.reap()
            if random.random() < 0.3:
                self.trouble()
            time.sleep(random.uniform(0, 0.1))
        for process in self.processes.values():
            process.kill()
            process.wait()

    def check(self):
        self.disk.set_full(False)
        for node in NODES:  # each removes what it left
            for part in range(1, PARTS + 1):
                self.run(["--out", "out", "--shard", f"{part}/{PARTS}"], **self.environment(node, False))
        self.run(["--out", "out", "--merge", "--verify"])
        whole, out = self.root / "whole", self.root / "out"
        names = sorted(file.name for file in whole.iterdir() if file.suffix in (".exr", ".csv", ".toml"))
        _, different, missing = filecmp.cmpfiles(whole, out, names, shallow=False)
        left = [file.name for file in out.rglob(".*")]
        print(", ".join(f"{count} {what}" for what, count in sorted(self.counts.items())))
        print(f"{len(names)} files, {len(different)} differ, {len(missing)} are missing, {len(left)} temporaries left")
        return not different and not missing and not left


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("libraries", type=os.path.abspath)
    parser.add_argument("--seconds", type=float, default=3600)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    random.seed(options.seed)
    root = pathlib.Path(tempfile.mkdtemp(prefix="forceshade-soak-"))
    soak = Soak(options, root)
    try:
        soak.work()
        good = soak.check()
    finally:
        for process in soak.processes.values():
            process.kill()
        soak.disk.end()
    if good:
        shutil.rmtree(root)
    return 0 if good else f"see {root}"


if __name__ == "__main__":
    sys.exit(main())
