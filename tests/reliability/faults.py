#!/usr/bin/env python3
"""What happens to outputs when a run is disturbed.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/reliability/faults.py [--kills N]

After every disturbance each output holds either the bytes of an earlier run or those of an undisturbed
one, and unless the program was killed outright it has said why it failed and left nothing else behind.
"""
import argparse
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.path.abspath(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic"))
EARLIER = b"written by an earlier run"
NAMES = ("out.vdb", "paths.json", "mesh.ply", "lines.obj", "picture.png")
LINE = ("--sdf {surface} --seed 0,-1.02,0 --target 0.5,0.73,0.237 --snap 0.5 -q -o out.vdb --grids surface,gradient "
        "--paths paths.json --mesh-out mesh.ply --isolines lines.obj --image picture.png --image-size 320x240")

os.environ["SOURCE_DATE_EPOCH"] = "0"  # outputs are compared byte by byte

failures: list[str] = []


class TempWorkspace:
    """A folder with a surface of some 50000 voxels and outputs of an earlier run."""

    def __init__(self, good: dict[str, bytes], at: pathlib.Path | None = None):
        self.folder = at or pathlib.Path(tempfile.mkdtemp(prefix="igeo-faults-"))
        self.good = good
        for name in NAMES:
            (self.folder / name).write_bytes(EARLIER)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for path in self.folder.iterdir():
            path.unlink()
        self.folder.rmdir()

    def words(self) -> list[str]:
        return [PROGRAM, *LINE.format(surface=ROOT / "data" / "trefoil.vdb").split()]

    def start(self, words: list[str] | None = None, **how) -> subprocess.Popen:
        how.setdefault("stderr", subprocess.PIPE)
        return subprocess.Popen(words or self.words(), cwd=self.folder, stdin=subprocess.DEVNULL, **how)

    def run(self, words: list[str] | None = None, **how) -> tuple[int, str]:
        process = self.start(words, **how)
        try:
            _, err = process.communicate(timeout=60)
        except subprocess.TimeoutExpired:  # its exit code is then that of the kill
            process.kill()
            _, err = process.communicate()
            err = (err or b"") + b" (a run without end)"
        return process.returncode, (err or b"").decode("utf-8", "replace")

    def torn(self) -> list[str]:
        """Outputs that are neither of the earlier run nor whole."""
        return [name for name in NAMES
                if not (self.folder / name).exists()
                or (self.folder / name).read_bytes() not in (EARLIER, self.good[name])]

    def left(self) -> list[str]:
        return sorted(f.name for f in self.folder.iterdir() if f.name not in NAMES)


def check(what: str, good: bool, message: object = "") -> None:
    if not good:
        failures.append(f"{what}: {message}")
        print(f"FAILED {what}: {message}", flush=True)


def check_failed(what: str, desk: TempWorkspace, code: int, err: str, codes: tuple[int, ...]) -> None:
    """A failure that the program reports itself."""
    check(what, code in codes, f"exit code {code}, not {codes}; {err}")
    check(what, "implicit-geodesic: error: " in err, f"no sentence in {err!r}")
    check(what, not desk.torn() and not desk.left(), (desk.torn(), desk.left()))


def undisturbed() -> tuple[dict[str, bytes], float]:
    folder = pathlib.Path(tempfile.mkdtemp(prefix="igeo-faults-"))
    desk = TempWorkspace({}, folder)
    start = time.monotonic()
    code, err = desk.run()
    assert code == 0, err
    good = {name: (folder / name).read_bytes() for name in NAMES}
    shutil.rmtree(folder)
    return good, time.monotonic() - start


def full_disk(good: dict[str, bytes]) -> int:
    """Files may not grow beyond a limit: between nothing and the largest output."""
    largest = max(len(b) for b in good.values())
    limits = [0, 1, 100, 4096] + [largest * k // 8 for k in range(1, 8)] + [largest - 1]
    for limit in limits:
        with TempWorkspace(good) as desk:
            code, err = desk.run(preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
            if limit >= largest:
                continue
            check_failed(f"files of at most {limit} bytes", desk, code, err, (3,))
    for option in ("-o", "--paths", "--image"):
        with TempWorkspace(good) as desk:
            words = desk.words()
            at = words.index(option) + 1
            link = desk.folder / words[at]
            if option == "-o":
                words[at] = "/dev/full"
            else:  # under its own name, which documents have in their command
                link.unlink()
                link.symlink_to("/dev/full")
            code, err = desk.run(words)
            if option != "-o":
                link.unlink()
                link.write_bytes(EARLIER)
            check_failed(f"{option} /dev/full", desk, code, err, (3,))
    return len(limits) + 3


def small_disk(good: dict[str, bytes]) -> int:
    """A file system that is full; needs the right to mount one."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="igeo-faults-"))
    sizes = (64, 256, 1024)
    done = 0
    for size in sizes:
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", str(folder)],
                          capture_output=True, check=False).returncode != 0:
            break
        try:
            desk = TempWorkspace(good, folder)
            code, err = desk.run()
            check_failed(f"a disk of {size} kB", desk, code, err, (3,))
            check(f"a disk of {size} kB", "No space left" in err, err)
            done += 1
        finally:
            subprocess.run(["umount", str(folder)], check=False)
    folder.rmdir()
    return done


def read_only_folder(good: dict[str, bytes]) -> int:
    """Root may write anywhere: as somebody else, where that is possible."""
    with TempWorkspace(good) as desk:
        os.chmod(desk.folder, 0o555)
        how = {"user": 65534, "group": 65534} if os.geteuid() == 0 else {}
        code, err = desk.run(**how)
        os.chmod(desk.folder, 0o755)
        check_failed("a folder that may not be written", desk, code, err, (2, 3))
    return 1


def killed(good: dict[str, bytes], seconds: float, count: int, seed: int) -> int:
    """By SIGKILL nothing can be said or cleaned up; outputs stay whole all the same."""
    r = random.Random(seed)
    remains = finished = 0
    for k in range(count):
        with TempWorkspace(good) as desk:
            process = desk.start()
            time.sleep(r.random() * seconds * 1.1)
            process.kill()
            process.communicate()
            check(f"kill {k}", not desk.torn(), desk.torn())
            check(f"kill {k}", all(".tmp-" in name for name in desk.left()), desk.left())
            remains += bool(desk.left())
            finished += process.returncode == 0
    print(f"  killed {count} times: no output torn unless said above; {finished} were done before, "
          f"{remains} left a temporary file")
    return count


def wait_until_caught(process: subprocess.Popen, number: int) -> None:
    """The program blocks the signals that it waits for, and no others. Before, while libraries load,
    it cannot catch any; some block all for a moment, to start threads."""
    while process.poll() is None:
        for line in pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines():
            name, _, mask = line.partition(":")
            if name == "SigBlk" and [int(mask, 16) >> (n - 1) & 1 for n in (number, signal.SIGUSR1)] == [1, 0]:
                return
        time.sleep(0.001)


def signalled(good: dict[str, bytes], seconds: float, count: int, seed: int) -> int:
    r = random.Random(seed)
    for k in range(count):
        number = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)[k % 3]
        with TempWorkspace(good) as desk:
            process = desk.start(preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
            time.sleep(0.3 * seconds + r.random() * 0.8 * seconds)
            wait_until_caught(process, number)
            process.send_signal(number)
            _, err = process.communicate(timeout=60)
            what = f"{number.name} {k}"
            if process.returncode == 0:
                check(what, not desk.torn() and not desk.left(), (desk.torn(), desk.left()))
                continue
            check_failed(what, desk, process.returncode, err.decode(), (128 + number,))
    return count


def out_of_memory(good: dict[str, bytes]) -> int:
    """Too little at any stage, from the start of the threads on: TBB takes 4 MB there, and oneTBB 2022
    waits forever where it finds less than 1 MB."""
    done = 0
    for limit in (m * 10 ** 6 for m in (*range(100, 180), *range(180, 400, 10))):
        with TempWorkspace(good) as desk:
            def little():
                resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
            # Libraries take memory and start threads before the program's first instruction.
            if desk.run([PROGRAM, "--version"], preexec_fn=little, stdout=subprocess.DEVNULL)[0] < 0:
                continue
            code, err = desk.run([*desk.words(), "--threads", "2"], preexec_fn=little)
            if "error while loading shared libraries" in err:
                continue
            done += 1
            if code == 0:
                check(f"{limit} bytes of memory", not desk.torn() and not desk.left(), desk.torn())
            else:
                check_failed(f"{limit} bytes of memory", desk, code, err, (1, 3))
    return done


def closed_streams(good: dict[str, bytes]) -> int:
    """Outputs must not take the places of streams that are closed."""
    for closed in ((0,), (1,), (2,), (0, 1, 2)):
        with TempWorkspace(good) as desk:
            code, err = desk.run([w for w in desk.words() if w != "-q"],
                                 preexec_fn=lambda: [os.close(fd) for fd in closed])
            whole = all((desk.folder / name).read_bytes() == good[name] for name in NAMES)
            check(f"closed {closed}", code == 0 and whole and not desk.left(), (code, err, desk.torn()))
    with TempWorkspace(good) as desk:
        words = desk.words()
        words[words.index("-o") + 1] = "-"
        code, err = desk.run(words, preexec_fn=lambda: os.close(1))
        check_failed("-o - with stdout closed", desk, code, err, (3,))
    with TempWorkspace(good) as desk:
        words = desk.words()
        words[words.index("--sdf") + 1] = "-"
        code, err = desk.run(words, preexec_fn=lambda: os.close(0))
        check_failed("--sdf - with stdin closed", desk, code, err, (3,))
    with TempWorkspace(good) as desk:
        words = desk.words()
        words[words.index("-o") + 1] = "-"
        reading, writing = os.pipe()
        os.close(reading)
        code, err = desk.run(words, stdout=writing)
        os.close(writing)
        check("a pipe without a reader", code == 3 and not err, f"exit code {code}, {err!r}")
        check("a pipe without a reader", not desk.torn() and not desk.left(), (desk.torn(), desk.left()))
    return 7


def together(good: dict[str, bytes], count: int) -> int:
    """Two runs that write the same files at once."""
    for k in range(count):
        with TempWorkspace(good) as desk:
            for process in [desk.start() for _ in range(2)]:
                _, err = process.communicate(timeout=300)
                check(f"two at once {k}", process.returncode == 0, err.decode())
            whole = all((desk.folder / name).read_bytes() == good[name] for name in NAMES)
            check(f"two at once {k}", whole and not desk.left(), (desk.torn(), desk.left()))
    return count


def main() -> int:
    parser = argparse.ArgumentParser(description="Disturbed runs.")
    parser.add_argument("--kills", type=int, default=30, help="how often to kill the program [30]")
    parser.add_argument("--seed", type=int, default=1, help="of the random moments [1]")
    options = parser.parse_args()
    good, seconds = undisturbed()
    for name, disturb in (
            ("files that may not grow, /dev/full", lambda: full_disk(good)),
            ("full disks", lambda: small_disk(good)),
            ("read-only folder", lambda: read_only_folder(good)),
            ("killed", lambda: killed(good, seconds, options.kills, options.seed)),
            ("SIGINT, SIGTERM, SIGHUP", lambda: signalled(good, seconds, max(9, options.kills // 10), options.seed)),
            ("out of memory", lambda: out_of_memory(good)),
            ("closed streams and pipes", lambda: closed_streams(good)),
            ("two runs at once", lambda: together(good, max(3, options.kills // 20)))):
        before = len(failures)
        count = disturb()
        print(f"{name}: {count} runs, {len(failures) - before} failures", flush=True)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
