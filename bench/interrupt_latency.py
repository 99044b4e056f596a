#!/usr/bin/env python3
"""How long a run takes to stop after Ctrl-C.

    bench/interrupt_latency.py [--program build/release/bin/cullhull] [--tries 12] [--folder DIR] [NAME ...]

Each workload is run once to its end, then `--tries` times with SIGINT sent at moments spread evenly
over that time. Prints the largest and the median time from the signal to the exit, in ms, and where
in the run the largest was. A run that ended before its signal does not count; one that was
interrupted must exit with 130.
"""
import argparse
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time

# name: (arguments of generate, arguments of hull)
WORKLOADS = {
    "sphere-3d-1M": ("sphere -n 1M -d 3", ""),
    "cylinder-3d-1M": ("cylinder -n 1M -d 3", ""),
    "cube-surface-3d-1M": ("cube-surface -n 1M -d 3", ""),
    "ball-3d-8M": ("ball -n 8M -d 3", ""),
    "certify-3d-1M": ("sphere -n 1M -d 3", "--certify"),
    "pseudo-hull-3d-8M": ("ball -n 8M -d 3", "--cull pseudo-hull"),
    "circle-2d-2M": ("circle -n 2M -d 2", ""),
    "ball-4d-8M": ("ball -n 8M -d 4", ""),
    "sphere-4d-100k": ("sphere -n 100k -d 4", ""),
    "ball-5d-1M": ("ball -n 1M -d 5", ""),
    "ball-6d-100k": ("ball -n 100k -d 6", ""),
    "cube-8d-100k": ("cube -n 100k -d 8", "--memory 1G"),
    "cube-50d-53": ("cube -n 53 -d 50", ""),
    "vertices-7d-20k": ("gauss -n 20k -d 7", "--only vertices"),
}


def interrupted(command, after):
    """(seconds from the signal to the exit, exit status), or None if it ended before."""
    run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(after)
    if run.poll() is not None:
        return None
    start = time.perf_counter()
    run.send_signal(signal.SIGINT)
    status = run.wait()
    return time.perf_counter() - start, status


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--program", default="build/release/bin/cullhull")
    parser.add_argument("--tries", type=int, default=12)
    parser.add_argument("--folder", default=os.path.join(tempfile.gettempdir(), "cullhull-interrupts"))
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(WORKLOADS))
    arguments = parser.parse_args()
    os.makedirs(arguments.folder, exist_ok=True)
    bad = 0
    for name in arguments.names or WORKLOADS:
        made, options = WORKLOADS[name]
        path = os.path.join(arguments.folder, made.replace(" ", "") + ".npy")
        if not os.path.exists(path):
            subprocess.run([arguments.program, "generate", *made.split(), "-o", path], check=True,
                           stdout=subprocess.DEVNULL)
        command = [arguments.program, "hull", path, *options.split()]
        start = time.perf_counter()
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        whole = time.perf_counter() - start
        found = []
        for k in range(arguments.tries):
            after = whole * (k + 0.5) / arguments.tries
            result = interrupted(command, after)
            if result is None:
                continue
            seconds, status = result
            # 0 and 4: the program ended before the signal arrived; -2: it had not installed its
            # handler yet, which takes some milliseconds.
            if status not in (0, 4, 130) and (status != -2 or after > 0.02):
                bad += 1
                print(f"{name}: exit status {status} when interrupted after {after:.3f} s")
            found.append((seconds * 1e3, after))
        if found:
            worst = max(found)
            print(f"{name:20} whole run {whole:7.3f} s; stopped after at most {worst[0]:7.1f} ms "
                  f"(signal at {worst[1]:.3f} s), median {statistics.median(f[0] for f in found):.1f} ms, "
                  f"{len(found)} signals", flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
