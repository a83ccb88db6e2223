#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Test independent processes that run one flow at the same time with one store, as the jobs of an
array do. The processes share the work units, and the results of each process are bit-identical to
sums computed here, also if processes are killed. WORKERS_KILLS: number of kills; WORKERS_SEED: seed
of the random moments."""
import collections
import os
import random
import signal
import sys
import time

import ranks_test
from ranks_test import ALL, check, wait_for

KILLS = int(os.environ.get("WORKERS_KILLS", "8"))
KEPT = [(w, i) for w, i in ALL if i != 9]  # unit 9 of each list has no key


def join(place, *sets):
    """Start a process; `folder` is its run folder."""
    process = place.start(0, "b.wait=20", *sets, joins=True)
    process.folder = place.path("runs/%d" % place.number)
    return process


def begin(place, n, *sets):
    place.write("journal", "")
    return [join(place, *sets) for _ in range(n)]


def end(process, code=0):
    process.out, process.err = process.communicate(timeout=ranks_test.LONG)
    assert process.returncode == code, (process.returncode, process.out, process.err)


def counts(place):
    """Return how often each unit with a key was computed."""
    return collections.Counter((w, i) for w, i, _ in place.done() if i != 9)


def test_once(place):
    """Several processes compute each unit once, and each process computes some."""
    workers = begin(place, 4, "b.hold=" + place.hold(), "b.crowd=4")
    for process in workers:
        end(process)
        check(process.folder)
    assert sorted(counts(place).elements()) == KEPT, counts(place)
    assert len({pid for _, _, pid in place.done()}) == 4, place.done()
    assert not place.pieces() and not place.hidden()


def test_dead(place):
    """The others wait for a unit of a stopped process, and compute the unit when the process is killed."""
    folder = place.hold(7)
    stopped, = begin(place, 1, "b.hold=" + folder)
    wait_for(lambda: os.path.exists(folder + "/7.here"), stopped)
    os.kill(stopped.pid, signal.SIGSTOP)
    other = join(place)
    wait_for(lambda: len(counts(place)) == 21, other)  # all units except the claimed one
    time.sleep(0.3)
    assert other.poll() is None and len(counts(place)) == 21, counts(place)
    stopped.kill()
    stopped.wait()
    end(other)
    check(other.folder)
    assert sorted(counts(place).elements()) == KEPT, counts(place)


def test_late(place):
    """A process that is behind still finds the units after another process has finished the step."""
    folder = place.hold(2, 9)
    slow, = begin(place, 1, "b.hold=" + folder)
    wait_for(lambda: os.path.exists(folder + "/2.here"), slow)
    fast = join(place)
    wait_for(lambda: len(counts(place)) == 21, fast)
    os.unlink(folder + "/2")
    wait_for(lambda: os.path.exists(folder + "/9.here"), slow)
    end(fast)
    assert slow.poll() is None
    os.unlink(folder + "/9")
    end(slow)
    for process in (fast, slow):
        check(process.folder)
    assert sorted(counts(place).elements()) == KEPT, counts(place)


def test_fault(place):
    """A unit that fails is an error of every process; the other units are not computed again."""
    for process in begin(place, 3, "b.fault=work", "b.at=7"):
        end(process, 4)
        assert "second 7: does not want to" in process.err, process.err
    repaired = join(place)
    end(repaired)
    check(repaired.folder)
    assert sorted(counts(place).elements()) == KEPT, counts(place)


def test_kills(place):
    """Eight processes are killed at random moments, and others join."""
    dice = random.Random(int(os.environ.get("WORKERS_SEED", "1")))
    kills = middle = 0
    while kills < KILLS:
        place.forget()
        workers = begin(place, 8)
        for _ in range(dice.randrange(1, 8)):
            moment = dice.randrange(1, 24)
            wait_for(lambda: len(place.done()) >= moment or workers[0].poll() is not None)
            victim = workers.pop(dice.randrange(len(workers)))
            time.sleep(dice.uniform(0, 0.02))
            victim.kill()
            middle += victim.wait() == -signal.SIGKILL
            kills += 1
            workers.append(join(place))
        for process in workers:
            end(process)
            check(process.folder)
        again = sum(counts(place).values()) - len(KEPT)
        # A process can be killed after it has computed a unit and before it stores the result.
        assert again <= kills, (again, counts(place))
    assert middle > KILLS / 4, middle
    print("# %d processes killed, %d of them while they ran" % (kills, middle))


if __name__ == "__main__":
    sys.exit(ranks_test.main(globals()))
