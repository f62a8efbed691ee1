"""Long calls let other threads run, end at once on Ctrl-C, and leave nothing half-written."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import shapelight as sl

PATIENCE = 100.0  # [s] after which a program counts as hanging

MANY_POINTS = """
    import os, sys, threading, time
    import numpy as np
    import shapelight as sl
    rng = np.random.default_rng(0)
    heights = rng.random((1000, 1000)) * 0.3
    y, x = np.mgrid[:1000, :1000].astype(float)
    points = np.stack([x, y, heights], axis=-1).reshape(-1, 3)
"""


def start(command):
    environment = {**os.environ, "PYTHONPATH": os.path.dirname(os.path.dirname(sl.__file__))}
    pipe = subprocess.PIPE
    return subprocess.Popen(
        [sys.executable, *map(str, command)], stdout=pipe, stderr=pipe, text=True, env=environment,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # shells start background jobs that ignore it
    )


def run_program(program, *arguments, interrupt_after=None):
    """Runs a program that prints "ready" before its long call. Returns its exit code, its further output, and what it
    wrote to stderr."""
    process = start(["-c", textwrap.dedent(MANY_POINTS) + textwrap.dedent(program), *arguments])
    assert process.stdout.readline() == "ready\n", process.communicate()[1]
    time.sleep(interrupt_after or 0.0)
    return end(process, interrupt_after is not None)


def end(process, interrupt):
    if interrupt:
        process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=PATIENCE)
    return process.returncode, out, err


def test_interrupt_raises_keyboard_interrupt():
    _, out, err = run_program(  # left alone, the call outlasts PATIENCE
        """
        print("ready", flush=True)
        try:
            sl.fields(points, variation_neighbors=1000, retinex_rings=20, retinex_neighbors=1000, threads=1)
            print("finished")
        except KeyboardInterrupt:
            print("KeyboardInterrupt")
        """,
        interrupt_after=0.7,
    )
    assert out == "KeyboardInterrupt\n", err


def test_the_library_works_on_after_an_interrupt():
    code, out, err = run_program(
        """
        print("ready", flush=True)
        try:
            sl.sample(points, ratio=0.1)
        except KeyboardInterrupt:
            print(len(sl.sample(points[:5000], count=77).indices))
        """,
        interrupt_after=0.5,
    )
    assert out == "77\n", err


def test_interrupted_write_leaves_nothing(tmp_path):
    _, out, err = run_program(
        """
        import pathlib, signal
        folder = pathlib.Path(sys.argv[1])
        def interrupt_when_writing():
            while not list(folder.iterdir()):
                time.sleep(0.001)
            os.kill(os.getpid(), signal.SIGINT)
        many = np.concatenate([points] * 2)
        threading.Thread(target=interrupt_when_writing, daemon=True).start()
        print("ready", flush=True)
        try:
            sl.write(folder / "out.ply", many, ascii=True)
            print("finished")
        except KeyboardInterrupt:
            print("KeyboardInterrupt")
        """,
        tmp_path,
    )
    assert out == "KeyboardInterrupt\n", err
    assert list(tmp_path.iterdir()) == []


def test_interrupted_command_ends_with_130_and_leaves_nothing(tmp_path):
    big = tmp_path / "big.ply"
    rng = np.random.default_rng(0)
    sl.write(big, rng.random((600_000, 3)))
    out = tmp_path / "out.ply"
    process = start(["-m", "shapelight", "sample", big, "-o", out, "--ratio", "0.1", "--progress", "json"])
    assert process.stderr.readline().startswith("{")
    code, _, err = end(process, interrupt=True)
    assert code == 130, err
    assert list(tmp_path.iterdir()) == [big]


def test_python_may_end_while_another_thread_calls():
    code, out, err = run_program(
        """
        threading.Thread(target=lambda: sl.sample(points, ratio=0.1), daemon=True).start()
        time.sleep(0.3)
        print("ready", flush=True)
        """
    )
    assert code == 0, err


def test_other_threads_run_meanwhile():
    points = np.random.default_rng(0).random((50_000, 3))
    done = threading.Event()
    result = []

    def call():
        result.append(sl.sample(points, ratio=0.1))
        done.set()

    caller = threading.Thread(target=call)
    caller.start()
    steps = 0
    while not done.is_set():
        steps += 1
        time.sleep(0.001)
    caller.join()
    assert len(result[0].indices) == 5000
    assert steps > 10


@pytest.mark.parametrize("threads", [1, 2])
def test_calls_on_several_threads_agree(threads):
    points = np.random.default_rng(1).random((20_000, 3))
    expected = sl.sample(points, ratio=0.1).indices
    results = {}
    callers = [
        threading.Thread(target=lambda i=i: results.update({i: sl.sample(points, ratio=0.1, threads=threads).indices}))
        for i in range(4)
    ]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    for i in range(4):
        np.testing.assert_array_equal(results[i], expected)
