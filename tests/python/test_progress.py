"""Progress of long calls: who is told what, on which thread, and what an exception does."""

import threading

import numpy as np
import pytest

import shapelight as sl


@pytest.fixture(scope="module")
def points():
    return np.random.default_rng(0).random((20_000, 3))


def test_fractions_rise_to_one(points):
    calls = []
    sl.sample(points, ratio=0.1, progress=lambda fraction, phase: calls.append((fraction, phase)))
    fractions = [fraction for fraction, _ in calls]
    assert fractions == sorted(fractions)
    assert fractions[0] >= 0.0 and fractions[-1] == 1.0
    assert len({phase for _, phase in calls}) > 2


def test_callable_runs_on_the_thread_that_called(points):
    threads = set()

    def work():
        sl.sample(points, ratio=0.1, progress=lambda *_: threads.add(threading.current_thread()))

    caller = threading.Thread(target=work)
    caller.start()
    caller.join()
    assert threads == {caller}


def test_exception_of_the_callable_stops_the_work(points):
    class Enough(Exception):
        pass

    calls = []

    def report(fraction, phase):
        calls.append(fraction)
        raise Enough(phase)

    with pytest.raises(Enough):
        sl.sample(points, ratio=0.1, progress=report)
    assert len(calls) == 1 and calls[0] < 1.0


def test_callable_may_call_the_library(points):
    inner = []
    sl.sample(points, ratio=0.1, progress=lambda *_: inner.append(len(sl.sample(points[:500], count=50).indices)))
    assert set(inner) == {50}


def test_what_is_no_progress_is_refused(points):
    with pytest.raises(sl.InvalidInput, match="a bar of tqdm"):
        sl.sample(points, ratio=0.1, progress=3)


def test_tqdm_bars_reach_their_total(points):
    tqdm = pytest.importorskip("tqdm").tqdm
    bars = []

    class Kept(tqdm):
        def __init__(self, *args, **kwargs):
            super().__init__(*args, file=open("/dev/null", "w"), **kwargs)
            bars.append(self)

    sl.sample(points, ratio=0.1, progress=Kept)
    assert bars[0].n == pytest.approx(100.0) and bars[0].disable  # closed
    with Kept(total=8, initial=2) as bar:
        sl.sample(points, ratio=0.1, progress=bar)
        assert bar.n == pytest.approx(8.0)


def test_true_shows_a_bar(points, capfd):
    pytest.importorskip("tqdm")
    sl.sample(points, ratio=0.1, progress=True)
    assert "100%" in capfd.readouterr().err
    sl.sample(points, ratio=0.1, progress=False)
    assert capfd.readouterr().err == ""
