"""Learn with many seeds and report every one of them, the unfinished ones too.

    python -m biped_lab.seed_study --seeds 101-120 --out bags/seeds -- --preset paper

What follows `--` goes to `biped learn`. Each seed is a process of its own; its figures
are appended to `runs.jsonl` in the folder, and a seed that stands there already is not
run again, so an interrupted study goes on where it stopped. A folder holds one study:
runs with other settings or another end are not taken for its own, but refused.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from biped_bringup.cli.main import parser as biped_parser
from biped_bringup.cli.options import settings_of
from biped_bringup.run_settings import changes_in_words
from biped_common.command_line import (
    WRONG_INPUT,
    CommandError,
    CommandParser,
    positive,
    writable_folder,
)
from biped_common.errors import BipedError
from biped_common.settings import to_mapping

RUNS_FILE = "runs.jsonl"


def main() -> int:
    """Run the study; exit status 1 if a run could not be carried out, 2 if refused."""
    options = _parser().parse_args()
    runs_file = options.out / RUNS_FILE
    try:
        study = study_of(options.learn)
        done = read_runs(runs_file)
        check_runs(done, study, runs_file)
        writable_folder(options.out)
    except BipedError as error:
        print(error, file=sys.stderr)
        return WRONG_INPUT
    missing = [seed for seed in options.seeds if seed not in {r["seed"] for r in done}]
    failed = False
    with ThreadPoolExecutor(options.jobs) as pool:
        for run in pool.map(
            lambda seed: run_seed(seed, options.out, options.learn), missing
        ):
            if "error" in run:
                print(f"seed {run['seed']}: {run['error']}", file=sys.stderr)
                failed = True
                continue
            run["end"] = study["end"]
            with runs_file.open("a") as file:
                file.write(json.dumps(run) + "\n")
            print(_row(run), flush=True)
    print(summary([r for r in read_runs(runs_file) if r["seed"] in options.seeds]))
    return 1 if failed else 0


def study_of(learn_options: list[str]) -> dict[str, Any]:
    """Return what all runs of a study have in common: `settings`, and when they `end`.

    Raises:
        SettingsError: the options of `biped learn` hold a wrong setting.
    """
    words = ["learn", *learn_options]
    options = biped_parser(words).parse_args(words)
    return {
        "settings": to_mapping(settings_of(options)),
        "end": {
            "episodes": options.episodes,
            "stop_at_schedule": options.stop_at_schedule,
        },
    }


def check_runs(runs: list[dict[str, Any]], study: dict[str, Any], file: Path) -> None:
    """Refuse runs that are not of this study.

    Raises:
        CommandError: one has other settings or another end, or does not say.
    """
    for run in runs:
        if not study.keys() <= run.keys():
            what = "does not say its settings"
        else:
            what = changes_in_words({key: run[key] for key in study}, study)
        if what:
            raise CommandError(
                f"{file}: seed {run['seed']} is of another study, {what}; take another "
                "--out"
            )


def run_seed(seed: int, out: Path, learn_options: list[str]) -> dict[str, Any]:
    """Learn with one seed, then walk greedily; return the figures of both."""
    folder = out / f"seed_{seed}"
    command = [sys.executable, "-m", "biped_bringup.cli.main"]
    learned = subprocess.run(
        [*command, "learn", "--json", "--fresh", "--seed", str(seed),
         "--out", str(folder), *learn_options],
        capture_output=True, text=True,
    )  # fmt: skip
    # Python itself ends with 1, too, where the program could not even start.
    if learned.returncode not in (0, 1) or not learned.stdout:
        return {"seed": seed, "error": learned.stderr.strip()}
    run: dict[str, Any] = json.loads(learned.stdout)
    walked = subprocess.run(
        [*command, "walk", "--json", "--memory", run["memory_file"]],
        capture_output=True, text=True,
    )  # fmt: skip
    if walked.returncode not in (0, 1):
        return {"seed": seed, "error": walked.stderr.strip()}
    walk = json.loads(walked.stdout)
    run["walk"] = {
        key: walk[key]
        for key in ("completed", "control_ticks", "peak_zmp_error_m", "t_err_terms")
    }
    return run


def read_runs(runs_file: Path) -> list[dict[str, Any]]:
    """Return the runs carried out so far."""
    if not runs_file.exists():
        return []
    # A line without its end was being written when the study was killed.
    lines = runs_file.read_text().splitlines(keepends=True)
    return [json.loads(line) for line in lines if line.endswith("\n")]


def summary(runs: list[dict[str, Any]]) -> str:
    """Return the study's figures; unfinished runs count as censored at their end."""
    if not runs:
        return "no runs"
    scheduled = [r for r in runs if r["schedule_complete"]]
    learned = [r for r in runs if r["completed"]]
    lines = [
        f"{len(runs)} seeds; schedule complete {len(scheduled)}, "
        f"frozen greedy walk learned {len(learned)}",
        # Censored runs are longer than any bound: they sort last.
        _spread("episodes to the schedule's end", runs, "schedule_episodes"),
        _spread("episodes to the greedy walk", runs, "greedy_episodes"),
        f"simulated s: median {statistics.median(r['simulated_s'] for r in runs):.0f}; "
        f"CPU s: median {statistics.median(r['cpu_s'] for r in runs):.0f}",
    ]
    return "\n".join(lines)


def _spread(name: str, runs: list[dict[str, Any]], key: str) -> str:
    values = sorted(r[key] if r[key] is not None else float("inf") for r in runs)
    median = statistics.median(values)
    censored = sum(value == float("inf") for value in values)
    return (
        f"{name}: min {values[0]:g}, median {median:g}, max {values[-1]:g}"
        f"{f' ({censored} censored)' if censored else ''}"
    )


def _row(run: dict[str, Any]) -> str:
    walk = run["walk"]
    return (
        f"seed {run['seed']:4d}  target {run['target_time_s']:5.2f} s"
        f"  schedule {run['schedule_episodes'] or '-':>5}"
        f"  greedy {run['greedy_episodes'] or '-':>5}  episodes {run['episodes']:5d}"
        f"  simulated {run['simulated_s']:7.0f} s  CPU {run['cpu_s']:5.0f} s"
        f"  states {run['figures']}"
        f" walk {walk['control_ticks']} ticks,"
        f" {1000 * walk['peak_zmp_error_m']:.1f} mm"
    )


def _seeds(text: str) -> list[int]:
    first, _, last = text.partition("-")
    seeds = list(range(int(first), int(last or first) + 1))
    if not seeds:
        raise argparse.ArgumentTypeError(f"{text}: the last seed is before the first")
    return seeds


def _parser() -> argparse.ArgumentParser:
    parser = CommandParser(
        prog="python -m biped_lab.seed_study", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--seeds", type=_seeds, required=True, metavar="FIRST-LAST")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--jobs", type=positive, default=2, help="runs at a time")
    parser.add_argument(
        "learn", nargs="*", metavar="-- LEARN_OPTION", help="for `biped learn`"
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
