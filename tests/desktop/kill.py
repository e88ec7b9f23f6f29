# SPDX-License-Identifier: GPL-3.0-or-later
"""Kills Blender's window with -9 at random moments of a run, opens it again, and looks whether anything was lost.

    python tests/desktop/kill.py --blender /path/to/blender [--times 20] [--seed 1]

A service on this computer answers slowly with the sample's recorded replies. A run is killed, opened again (half of
the times from a file that was saved before the run, half in a fresh file with the same picture), killed again and so
on until it comes to its end; then the next one begins with nothing kept. Half of the moments are drawn evenly from the
length of a run, half lie within 0.2 s after an answer was sent.

"Answered" is a request whose answer's last byte the service had sent before the kill. Whatever of these is asked again
is printed, with the time between. Needs a screen (a virtual one does).
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))
from kill_service import Service
from run_panel import ROOT, DesktopError, build_zip, install_source, install_zip, program_of

INSIDE = Path(__file__).with_name("kill_inside.py")
SAMPLE = ROOT / "samples" / "bedroom"
LONGEST = 300.0
JOURNALS = "extensions/.user/user_default/code_as_room/journal"


@dataclass
class Launch:
    """One start of Blender and how it ended."""

    opened_from: str
    moment: str = ""
    seconds: float = 0.0
    killed_at: float = 0.0
    answered: int = 0
    asked: int = 0
    again: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    ended: dict[str, Any] = field(default_factory=dict)


class Trial:
    """Runs that are killed and resumed, in one profile."""

    def __init__(self, options: argparse.Namespace, home: Path) -> None:
        self.options, self.home = options, home
        self.profile, self.exchange, self.saved = home / "profile", home / "exchange", home / "before.blend"
        self.service = Service(SAMPLE / "replies", options.delay, options.seed)
        self.random = random.Random(options.seed)
        self.program, self.length, self.torn = "", 0.0, 0
        self.known: dict[str, float] = {}
        """Requests that were answered in this chain, by hash: milliseconds from the last byte sent to the kill."""

    def install(self) -> None:
        """Install the add-on into the profile."""
        self.profile.mkdir()
        if self.options.source:
            install_source(self.profile)
        else:
            install_zip(self.options.blender, self.options.zip or build_zip(self.home / "zips"), self.profile)

    def forget(self) -> None:
        """Begin with nothing kept."""
        shutil.rmtree(self.profile / JOURNALS, ignore_errors=True)
        self.saved.unlink(missing_ok=True)
        self.service.log.asked.clear()
        self.known.clear()

    def launch(self, kill: bool, first: bool) -> Launch:
        """Start Blender, run, and kill it or let it come to its end."""
        shutil.rmtree(self.exchange, ignore_errors=True)
        self.exchange.mkdir()
        from_file = not first and self.saved.is_file() and self.random.random() < 0.5
        result = Launch("saved file" if from_file else "fresh file")
        before = len(self.service.log.asked)
        process = self._start(str(self.saved) if from_file else "", str(self.saved) if first else "")
        try:
            running = self._wait(process, "running.json")
            self._look_at_opening(result, running["opened"])
            if kill:
                self._kill(result, running, before)
            else:
                self._wait(process, "ended.json")
        finally:
            self._end(process)
        self._sum_up(result, before)
        return result

    def _start(self, blend: str, save: str) -> subprocess.Popen[bytes]:
        given = {"KILL_PICTURE": str(SAMPLE / "picture.png"), "KILL_URL": self.service.url}
        given |= {"KILL_FOLDER": str(self.exchange), "KILL_OPEN": blend, "KILL_SAVE": save}
        environment = {**os.environ, "BLENDER_USER_RESOURCES": str(self.profile), **given}
        command = [*program_of(self.options.blender), "--window-geometry", "0", "0", "900", "640"]
        out = None if self.options.verbose else subprocess.DEVNULL
        return subprocess.Popen([*command, "--python", str(INSIDE)], env=environment, stdout=out, stderr=out)

    def _wait(self, process: subprocess.Popen[bytes], name: str) -> dict[str, Any]:
        deadline = time.monotonic() + LONGEST
        while time.monotonic() < deadline:
            for path in (self.exchange / "error.json", self.exchange / name):
                if path.is_file():
                    values: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
                    if path.name == "error.json":
                        raise DesktopError(values["error"])
                    return values
            if process.poll() is not None and not (self.exchange / name).is_file():
                raise DesktopError(f"Blender ended with {process.returncode}; try --verbose.")
            time.sleep(0.01)
        raise DesktopError(f"Blender did not get to {name} within {LONGEST:g} s.")

    def _kill(self, result: Launch, running: dict[str, Any], before: int) -> None:
        """Kill at the moment that is drawn, unless the run is over by then."""
        if self.random.random() < 0.5:
            result.moment, number = "any", 10**6
            at = running["at"] + self.random.uniform(0.0, self.length)
        else:
            number, late = self.random.randint(1, 3), self.random.uniform(0.0, 0.2)
            result.moment, at = f"{late:.2f} s after answer {number}", float("inf")
        log = self.service.log
        while not (self.exchange / "ended.json").is_file():
            with log.changed:
                log.changed.wait(0.01)
                sent = sorted(a.sent for a in log.asked[before:] if a.sent)
            if at == float("inf") and len(sent) >= number:
                at = sent[number - 1] + late
            if time.time() >= at:
                # An answer is only counted when it was sent before the signal.
                result.killed_at = time.time()
                os.kill(running["pid"], signal.SIGKILL)
                result.seconds = result.killed_at - running["at"]
                return

    def _end(self, process: subprocess.Popen[bytes]) -> None:
        try:
            process.wait(timeout=60)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

    def _look_at_opening(self, result: Launch, opened: dict[str, Any]) -> None:
        if opened["problem"]:
            result.faults.append(f"opened with: {opened['problem']}")
        if opened["ids twice"] or opened["outside"] or opened["rooms"] > 1:
            result.faults.append("leftovers after opening")

    def _sum_up(self, result: Launch, before: int) -> None:
        """What was asked again, and how the room stands when the run came to its end."""
        log = self.service.log.asked[before:]
        result.asked = len(log)
        result.again = [
            f"{a.kind}, sent {self.known[a.hash]:.0f} ms before a kill" for a in log if a.hash in self.known
        ]
        answered = [a for a in log if a.sent and (not result.killed_at or a.sent < result.killed_at)]
        result.answered = len(answered)
        self.known |= {a.hash: (result.killed_at - a.sent) * 1000 for a in answered}
        self._look_at_journal(result)
        path = self.exchange / "ended.json"
        if result.killed_at or not path.is_file():
            return
        result.ended = json.loads(path.read_text(encoding="utf-8"))
        result.seconds = result.ended["at"] - json.loads((self.exchange / "running.json").read_text())["at"]
        self._look_at_end(result)

    def _look_at_journal(self, result: Launch) -> None:
        for path in (self.profile / JOURNALS).glob("*.jsonl"):
            torn = 0
            for line in path.read_bytes().split(b"\n"):
                try:
                    torn += bool(line.strip()) and not isinstance(json.loads(line), dict)
                except ValueError:
                    torn += 1
            self.torn = max(self.torn, torn)

    def _look_at_end(self, result: Launch) -> None:
        ended = result.ended
        if set(ended["statuses"]) != {"done"} or not ended["outcome"].startswith("Done"):
            result.faults.append(f"ended with {ended['outcome']}: {ended['statuses']}")
        if ended["ids twice"] or ended["outside"] or ended["rooms"] != 1 or len(ended["texts"]) != 2:
            result.faults.append(f"leftovers: {ended['texts']}, {ended['rooms']} rooms, {ended['outside']} outside")
        if self.program and ended["program"] != self.program:
            result.faults.append("another room than an undisturbed run makes")


def show(number: str, launch: Launch) -> None:
    """One row of the table."""
    end = "killed" if launch.killed_at else "done"
    fault = "; ".join(launch.faults + [f"ASKED AGAIN {text}" for text in launch.again])
    row = f"{number:>4}  {launch.opened_from:<11}{launch.moment:<25}{launch.seconds:>7.1f}  {end:<7}"
    print(f"{row}{launch.asked:>6}{launch.answered:>9}  {fault or 'ok'}", flush=True)


def measure(options: argparse.Namespace) -> int:
    """Kill until there were enough kills, and each killed run came to its end; returns the number of faults."""
    launches: list[Launch] = []
    with tempfile.TemporaryDirectory(prefix="code-as-room-kill-") as folder:
        trial = Trial(options, Path(folder))
        trial.install()
        print(
            f"{'':>4}  {'opened from':<11}{'moment':<25}{'seconds':>7}  {'end':<7}{'asked':>6}{'answered':>9}",
            flush=True,
        )
        whole = trial.launch(kill=False, first=True)
        show("ref", whole)
        trial.length, trial.program = whole.seconds, whole.ended.get("program", "")
        kills = 0
        while kills < options.times:
            trial.forget()
            chain = [trial.launch(kill=True, first=True)]
            while True:
                kills += bool(chain[-1].killed_at)
                show(str(kills) if chain[-1].killed_at else "", chain[-1])
                if not chain[-1].killed_at:
                    break
                chain.append(trial.launch(kill=kills < options.times, first=False))
            launches += chain
        answered, again = sum(x.answered for x in launches), sum(len(x.again) for x in launches)
        faults = sum(len(x.faults) for x in [whole, *launches])
        print(f"{kills} kills, {answered} answered requests, {again} of them asked again, {faults} other faults;")
        print(f"at most {trial.torn} torn records in a journal")
        return again + faults


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "--blender", default=os.environ.get("BLENDER", "blender"), help="the program, or a command line"
    )
    parser.add_argument("--zip", type=Path, help="an extension that is built already; by default it is built")
    parser.add_argument("--source", action="store_true", help="copy the source instead of installing a zip")
    parser.add_argument("--times", type=int, default=20, help="number of kills")
    parser.add_argument("--seed", type=int, default=1, help="the same seed draws the same moments")
    parser.add_argument("--delay", type=float, default=3.0, help="longest time of an answer, seconds")
    parser.add_argument("--verbose", action="store_true", help="show what Blender prints")
    try:
        return int(measure(parser.parse_args()) > 0)
    except (DesktopError, subprocess.SubprocessError) as error:
        print(f"kill: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    raise SystemExit(main())
