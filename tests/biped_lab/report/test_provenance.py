"""How runs were made, as the report tells it."""

from dataclasses import replace
from pathlib import Path

import msgspec
import pytest
from tests.biped_lab.report.made_results import made_results, runs_of

from biped_lab.report.provenance import provenance


@pytest.mark.parametrize(
    ("contestant", "options", "words"),
    [
        ("by_settings", {}, "the preset paper as it is"),
        ("parp", {}, "parp (its defaults); the preset paper as it is"),
        ("parp", {"base_weight": 10.0}, "parp (base_weight = 10.0); the preset"),
    ],
)
def test_who_learned_in_an_arm_is_told(
    tmp_path: Path, contestant: str, options: dict[str, float], words: str
) -> None:
    made = made_results(tmp_path, runs_of("A", 5), {"A": {}}, baseline=None)
    (arm,) = made.study.arms
    arm = msgspec.structs.replace(arm, contestant=contestant, options=options)
    study = msgspec.structs.replace(made.study, arms=(arm,))
    told = dict(provenance(replace(made, study=study)))
    assert told["A"].startswith(words)
