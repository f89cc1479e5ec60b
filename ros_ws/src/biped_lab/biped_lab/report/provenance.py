"""How the runs of a study were made, by their own word: code, packages, settings."""

from __future__ import annotations

from collections import Counter

from biped_lab.results import PlannedArm, StudyResults
from biped_lab.run_folder import RunError, read_cost, read_spec
from biped_lab.study import BY_SETTINGS


def provenance(results: StudyResults) -> list[tuple[str, str]]:
    """Return what there is to say, each with its name."""
    study = results.study
    command = f"biped lab run {study.source or study.name.removesuffix('-reduced')}"
    command += " --reduced" if study.reduced else ""
    command += f" --seeds {study.first_seeds}" if study.first_seeds else ""
    processors: Counter[str] = Counter()
    codes: Counter[str] = Counter()
    packages: Counter[str] = Counter()
    silent = 0
    for address in results.runs["address"]:
        try:
            processor = read_cost(results.run_folder(address)).processor
            processors[processor or "not noted"] += 1
            spec = read_spec(results.run_folder(address))
        except RunError:
            silent += 1
            continue
        codes[spec.code] += 1
        versions = sorted(spec.packages.items())
        packages[", ".join(f"{name} {version}" for name, version in versions)] += 1
    found = [
        ("runs", command),
        ("report", f"biped lab report DIR {study.name}"),
        ("code", _counted(codes)),
        ("packages", _counted(packages)),
        ("processor", _counted(processors)),
    ]
    if silent:
        found.append(("not known", f"of {silent} runs, whose run.json is not there"))
    for arm in study.arms:
        changes = ", ".join(f"{key} = {value}" for key, value in arm.settings.items())
        found.append((arm.name, f"{_who(arm)}{changes or 'the preset paper as it is'}"))
    return [(name, text) for name, text in found if text]


def _who(arm: PlannedArm) -> str:
    """Return who learns, unless the settings say it."""
    if arm.contestant == BY_SETTINGS:
        return ""
    options = ", ".join(f"{key} = {value}" for key, value in arm.options.items())
    return f"{arm.contestant} ({options or 'its defaults'}); "


def _counted(found: Counter[str]) -> str:
    """Return what all have in common, or each with its number of runs."""
    if len(found) < 2:
        return "".join(found)
    return "; ".join(f"{text} ({n} runs)" for text, n in sorted(found.items()))
