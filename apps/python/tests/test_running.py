"""Threads, Ctrl-C, progress and memory."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import igeo
from conftest import ball, grid


@pytest.fixture(scope="module")
def fine():
    """A solver that works for a while."""
    x, y, z, spacing, origin = grid(200, 1.1)
    values = np.sqrt(x**2 + y**2 + z**2) - 1
    return igeo.Solver(igeo.Surface.from_level_set(values, spacing=spacing, origin=origin))


def test_two_threads_on_one_solver():
    """The first two queries of a solver, which make its band, at the same moment."""
    vertices, faces = ball(16)
    weight = 1 + vertices[:, 2] ** 2

    def solver():
        return igeo.Solver(igeo.Surface.from_mesh(vertices, faces, resolution=40), weight=weight)

    alone, shared = solver(), solver()
    expected = [alone.distance([k]).on_vertices for k in range(4)]
    found = [None] * 4
    start = threading.Barrier(4)

    def solve(k):
        start.wait()
        found[k] = shared.distance([k]).on_vertices

    threads = [threading.Thread(target=solve, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k in range(4):
        assert (found[k] == expected[k]).all()


def test_other_threads_run_meanwhile(fine):
    ticks = []

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.005)

    done = threading.Event()
    other = threading.Thread(target=tick)
    other.start()
    begin = time.monotonic()
    fine.distance([0, 0, 1.0])
    seconds = time.monotonic() - begin
    done.set()
    other.join()
    during = [t for t in ticks if begin < t < begin + seconds]
    assert len(during) > seconds / 0.1  # a thread holding the lock would leave none


def test_ctrl_c(fine):
    threading.Timer(0.15, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        for _ in range(1000):
            fine.distance([0, 0, 1.0])
    assert time.monotonic() - begin < 20
    assert fine.distance([0, 0, 1.0]).reached == 1  # the solver is still usable


def test_progress_and_its_exceptions(fine):
    told = []
    fine.distances([[0, 0, 1.0]] * 6, at=[[0, 0, -1.0]], progress=lambda stage, share: told.append((stage, share)))
    assert told and all(isinstance(stage, str) and 0 <= share <= 1 for stage, share in told)
    assert told[-1][1] == 1

    def stop(stage, share):
        raise ZeroDivisionError(stage)

    with pytest.raises(ZeroDivisionError):
        fine.distances([[0, 0, 1.0]] * 50, at=[[0, 0, -1.0]], progress=stop)


def test_same_numbers_on_one_thread(sphere_solver):
    points = np.random.default_rng(3).normal(size=(100, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    expected = sphere_solver.distance([0, 0, 1.0]).at(points)
    with igeo.threads(1):
        assert (sphere_solver.distance([0, 0, 1.0]).at(points) == expected).all()


def resident() -> int:
    """Bytes of this process."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_memory_stays_flat():
    """Memory of repeated queries with their results: a field kept each time would add 30 MB."""
    if not os.path.exists("/proc/self/statm"):
        pytest.skip("no /proc/self/statm")
    vertices, faces = ball(10)
    solver = igeo.Solver(igeo.Surface.from_mesh(vertices, faces, resolution=32))

    def query(k):
        distance = solver.distance([k % len(vertices)])
        assert distance.on_vertices[k % len(vertices)] == 0
        distance.at(vertices[:9])
        distance.isolines([1.0])
        distance.path(0)

    for k in range(30):
        query(k)
    before = resident()
    for k in range(60):
        query(k)
    assert resident() - before < 8e6


def test_results_are_not_copied_and_outlive_their_makers():
    vertices, faces = ball(8)
    surface = igeo.Surface.from_mesh(vertices, faces, resolution=32)
    view = surface.vertices
    assert not view.flags.writeable and not view.flags.owndata
    assert view.__array_interface__["data"] == surface.vertices.__array_interface__["data"]
    numbers = igeo.Solver(surface).distance([0]).on_vertices
    assert not numbers.flags.owndata
    del surface
    assert (view == vertices).all() and numbers[0] == 0


def test_results_that_are_kept_cannot_be_written():
    """They are the same array each time, which a change would spoil."""
    vertices, faces = ball(8)
    distance = igeo.Solver(igeo.Surface.from_mesh(vertices, faces, resolution=32)).distance([0, 5])
    one = igeo.Solver(distance.surface).distance([0])
    for kept in (distance.on_vertices, distance.labels, distance.gradient, one.log_map().on_vertices):
        with pytest.raises(ValueError, match="read-only"):
            kept[:] = 7
        kept.copy()[:] = 7
    assert distance.on_vertices[0] == 0 and distance.labels[5] == 1
    own = distance.at(vertices)
    own[:] = 7
    assert (distance.at(vertices) == distance.on_vertices).all()
