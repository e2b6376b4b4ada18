#!/usr/bin/env python3
"""cmake/progress.sh: quiet where nothing takes long, a line with percent and time where it does, the log where it fails, and
nothing left running after Ctrl-C."""
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "cmake/progress.sh"


def start(body):
    text = f'set -eu\n. "{SCRIPT}"\n{body}\n'
    return subprocess.Popen(["sh", "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            start_new_session=True)


def main():
    wrong = []

    def expect(right, what):
        if not right:
            wrong.append(f"cmake/progress.sh: {what}")

    quick = start("work() { echo noise; }; with_progress Quick work; echo after")
    slow = start("work() { echo noise; echo dlstatus:1:40.0:Retrieving file 2 of 5; sleep 4; }; with_progress Slow work")
    failing = start("work() { echo why; return 3; }; with_progress Failing work || echo status $?")
    with tempfile.TemporaryDirectory() as folder:
        held = Path(folder) / "held"
        stopped = start(f'work() {{ echo $$ > "{held}"; exec sleep 100; }}; with_progress Stopped work; echo not reached')
        while not held.exists():
            time.sleep(0.05)
        time.sleep(0.3)
        began = time.monotonic()
        os.killpg(stopped.pid, signal.SIGINT)
        out, _ = stopped.communicate(timeout=20)
        expect(stopped.returncode == 130 and out == "", f"after Ctrl-C the status is {stopped.returncode}, expected 130")
        expect(time.monotonic() - began < 3, "Ctrl-C takes longer than 3 s")
        running = subprocess.run(["ps", "-o", "args=", "-g", str(stopped.pid)], capture_output=True, text=True).stdout
        expect("sleep 100" not in running, "the command runs on after Ctrl-C")
    out, err = quick.communicate()
    expect((out, err) == ("after\n", ""), f"a quick command says {err!r} and {out!r}, expected silence")
    out, err = slow.communicate()
    expect("20 %" in err and "s left" in err and "Retrieving file 2 of 5" in err and "noise" not in err,
           f"a slow command says {err!r}, expected percent and time")
    out, err = failing.communicate()
    expect(out == "status 3\n" and "why" in err, f"a failing command gives {out!r} and {err!r}, expected status 3, its log")
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
