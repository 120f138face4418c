#!/usr/bin/python3
"""kill_at.py NAME WHAT SKIP DELAY COMMAND...: starts COMMAND, a run with -o NAME in this folder, and kills it by SIGKILL DELAY
seconds after it begins to write WHAT for the (SKIP + 1)-th time: checkpoint, snapshot, record (NAME.hdf) or history (a row
of NAME.history.csv); after its start where WHAT is "moment". Prints what was half written then (checkpoint, snapshot,
record), "history" within a millisecond of a row's coming, else "nothing"; "over" where the run had ended before."""
import ctypes
import os
import select
import signal
import struct
import subprocess
import sys
import time

MODIFY, MOVED_TO, CREATE = 0x2, 0x80, 0x100


def kind(name, run):
    """What a file that was created or changed belongs to; its names while it is written, but for the history's."""
    if name.startswith(run + ".ckpt.new.hdf"):
        return "checkpoint"
    if name == run + ".history.csv":
        return "history"
    if name == run + ".hdf.part":
        return "record"
    if name.startswith((run + "-", run + ".hdf.series")) and name.endswith(".part"):
        return "snapshot"
    return None


def main():
    name, what, skip, delay, command = sys.argv[1], sys.argv[2], int(sys.argv[3]), float(sys.argv[4]), sys.argv[5:]
    libc = ctypes.CDLL(None, use_errno=True)
    watch = libc.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
    if watch < 0 or libc.inotify_add_watch(watch, b".", MODIFY | MOVED_TO | CREATE) < 0:
        sys.exit(f"kill_at: inotify: {os.strerror(ctypes.get_errno())}")
    before = time.time_ns()
    run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    row, until, waited = 0, time.monotonic() + delay if what == "moment" else None, 0
    while run.poll() is None:
        left = 0.05 if until is None else until - time.monotonic()
        if until is not None and left <= 0:
            break
        # The last millisecond is not slept: a write may be shorter than what a sleep comes late.
        select.select([watch], [], [], max(left - 0.001, 0))
        try:
            events = os.read(watch, 65536)
        except BlockingIOError:
            continue
        at = 0
        while at < len(events):
            _, mask, _, length = struct.unpack_from("iIII", events, at)
            file = events[at + 16 : at + 16 + length].rstrip(b"\0").decode()
            at += 16 + length
            found = kind(file, name)
            if found == "history":
                row = time.monotonic()
            if until is None and found == what and (mask & CREATE or what == "history"):
                waited += 1
                if waited > skip:
                    until = time.monotonic() + delay
    run.send_signal(signal.SIGKILL)
    killed = time.monotonic()
    if run.wait() != -signal.SIGKILL:
        print("over")
        return
    half = {kind(f, name) for f in os.listdir(".") if kind(f, name) not in (None, "history") and os.stat(f).st_mtime_ns > before}
    print(half.pop() if half else "history" if killed - row < 0.001 else "nothing")


main()
