import argparse
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from tests.biped_lab.report.made_results import (
    BOUND,
    STRATEGY_1,
    MadeRun,
    made_results,
    runs_of,
)

from biped_lab.report.finished import finished_runs
from biped_lab.report.tables import arms_table, cost_table
from biped_lab.report.write import write_report
from biped_lab.results import ResultsError
from biped_lab.verbs.report import add_parser

ADDRESSES = {"href", "xlink:href", "src", "srcset", "action", "data", "poster"}


class Requests(HTMLParser):
    """Collects what a browser would ask the network or the disk for."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self.ids: list[str] = []
        self.text = ""

    def handle_starttag(
        self, tag: str, attributes: list[tuple[str, str | None]]
    ) -> None:
        if tag in ("script", "link", "img", "iframe", "object", "image", "base"):
            self.found.append(tag)
        for name, value in attributes:
            if name == "id":
                self.ids.append(value or "")
            if name in ADDRESSES and not (value or "").startswith("#"):
                self.found.append(f"{name}={value}")

    def handle_data(self, data: str) -> None:
        self.text += data


def read(page: Path) -> Requests:
    parser = Requests()
    parser.feed(page.read_text())
    return parser


def files(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    unfinished = runs_of("K = 3", *[None] * 7)[5:]
    folder = tmp_path_factory.mktemp("lab")
    return write_report(made_results(folder, [*STRATEGY_1, *unfinished]))


@pytest.mark.thorough
def test_the_page_asks_for_nothing(page: Path) -> None:
    assert not read(page).found
    text = page.read_text()
    assert "@import" not in text
    assert text.count("url(") == text.count("url(#")


def test_every_identifier_is_on_the_page_once(page: Path) -> None:
    ids = read(page).ids
    assert len(ids) == len(set(ids))


def test_the_page_says_claim_result_and_what_is_unfinished(page: Path) -> None:
    text = read(page).text
    assert "Fixed mode is faster." in text
    assert "15 of 17 runs have ended: 12 at the goal, 3 stopped at 40" in text
    assert "2 are unfinished and not counted" in text
    assert "unfinished, 7 episodes so far" in text


def test_every_run_is_listed_with_its_address(page: Path) -> None:
    text = read(page).text
    assert all(run.address in text for run in STRATEGY_1)


def test_where_memories_are_absent_the_page_says_that_maps_need_them(
    page: Path,
) -> None:
    assert "Maps need the memories of runs" in read(page).text
    assert not (page.parent / "figures" / "maps.svg").exists()


def test_every_figure_is_a_file_of_both_kinds(page: Path) -> None:
    names = {file.name for file in (page.parent / "figures").iterdir()}
    assert {"time_and_episodes.svg", "fixed_states.png", "replay.svg"} <= names
    assert {name[:-4] for name in names if name.endswith("svg")} == {
        name[:-4] for name in names if name.endswith("png")
    }


def test_the_same_data_give_the_same_bytes(page: Path, tmp_path: Path) -> None:
    unfinished = runs_of("K = 3", *[None] * 7)[5:]
    again = write_report(made_results(tmp_path, [*STRATEGY_1, *unfinished]))
    assert files(again.parent) == files(page.parent)


def test_what_the_machine_did_is_not_in_the_table_but_in_that_of_the_cost(
    tmp_path: Path,
) -> None:
    results = made_results(tmp_path, STRATEGY_1)
    before = finished_runs(results)
    results.runs[["cpu_s", "computed_s"]] *= 3.0
    results.runs["sittings"] = 2
    after = finished_runs(results)
    tables = [arms_table(runs, np.random.default_rng(5)) for runs in (before, after)]
    assert tables[0] == tables[1]
    assert cost_table(before) != cost_table(after)


def test_every_test_of_an_arm_is_shown(page: Path) -> None:
    text = read(page).text
    assert "p, log-rank" in text
    table = (page.parent / "tests.md").read_text().splitlines()
    assert [row.split("|")[1].strip() for row in table[2:]] == [
        "K = 1", "K = 3", "K = none",
    ]  # fmt: skip
    pairs = [row.split("|")[4].strip() for row in table[2:]]
    assert pairs == ["5", "5", "0"]  # none with itself


def test_frozen_walks_of_the_runs_at_the_goal_are_counted_and_compared(
    tmp_path: Path,
) -> None:
    runs = [
        *(MadeRun("K = 3", seed, 9 + seed) for seed in range(8)),
        *(MadeRun("K = none", seed, 20, frozen=seed == 0) for seed in range(7)),
        MadeRun("K = none", 7, BOUND),  # not at the goal
    ]
    folder = write_report(made_results(tmp_path, runs)).parent

    def cells(file: str) -> dict[str, list[str]]:
        lines = (folder / file).read_text().splitlines()[2:]
        rows = ([cell.strip() for cell in line.split("|")] for line in lines)
        return {row[1]: row for row in rows}

    walked, tests = cells("table.md"), cells("tests.md")
    assert walked["K = 3"][4] == "8 of 8 [0.68, 1.00]"
    assert walked["K = none"][4] == "1 of 7 [0.03, 0.51]"
    # Of the ways to have 9 walk among 15, 7 are as far apart, and none farther.
    assert float(tests["K = 3"][-2]) == pytest.approx(7 / 5005, rel=0.05)
    assert tests["K = none"][-2] == "–"


def test_without_comparisons_there_are_no_tests(tmp_path: Path) -> None:
    runs = runs_of("K = 1", 5, 6, 7)
    page = write_report(made_results(tmp_path, runs, baseline=None))
    assert not (page.parent / "tests.md").exists()
    assert "log-rank" not in read(page).text


def test_an_arm_has_the_same_intervals_whoever_stands_beside_it(
    tmp_path: Path,
) -> None:
    alone = [run for run in STRATEGY_1 if run.arm in ("K = 3", "K = none")]
    rows = [
        arms_table(
            finished_runs(made_results(tmp_path / name, runs)), np.random.default_rng(5)
        ).rows
        for name, runs in (("all", STRATEGY_1), ("two", alone))
    ]
    (among,) = (row for row in rows[0] if row[0] == "K = 3")
    (beside_one,) = (row for row in rows[1] if row[0] == "K = 3")
    assert among[:-2] == beside_one[:-2]  # all but what is corrected, and its neighbour


def test_one_arm_of_one_interrupted_run_without_states_is_reported(
    tmp_path: Path,
) -> None:
    results = made_results(tmp_path, runs_of("K = 1", 9, fixed=None))
    results.runs["sittings"] = 2
    stale = tmp_path / "made" / "figures" / "fixed_states.svg"
    stale.parent.mkdir(parents=True)
    stale.touch()
    text = read(write_report(results)).text
    assert "All runs were interrupted" in text
    assert "In no run of this study was a state fixed." in text
    assert "every run reached it" in text
    assert "No intervals" in text
    assert not stale.exists()


def test_a_study_without_a_finished_run_says_so(tmp_path: Path) -> None:
    page = write_report(made_results(tmp_path, runs_of("K = 1", None, None)))
    text = read(page).text
    assert "None of 2 runs has ended yet" in text
    assert not (page.parent / "table.md").exists()


def test_words_of_a_study_do_not_act_on_the_page(tmp_path: Path) -> None:
    runs = runs_of("K = 1", None)
    page = write_report(made_results(tmp_path, runs, title="<script>alert(1)</script>"))
    assert "script" not in read(page).found
    assert "alert(1)" in read(page).text


def test_a_folder_without_a_study_is_refused(tmp_path: Path) -> None:
    parser = argparse.ArgumentParser()
    add_parser(parser.add_subparsers(), [])
    options = parser.parse_args(["report", str(tmp_path)])
    with pytest.raises(ResultsError, match="no study"):
        options.run(options)
