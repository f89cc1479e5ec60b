"""How often a node may die."""

from biped_bringup.supervisor.restart_budget import RestartBudget


def fail(budget, times_s, *, ready):
    """Return the pauses after deaths at these times."""
    pauses = []
    for now_s in times_s:
        if ready:
            budget.ready()
        pauses.append(budget.failed(now_s))
    return pauses


def test_pauses_grow():
    assert fail(RestartBudget(), (0.0, 1.0, 2.0, 3.0), ready=True) == [
        0.1,
        0.2,
        0.4,
        0.8,
    ]


def test_the_fifth_death_in_ten_seconds_is_one_too_many():
    assert fail(RestartBudget(), (0.0, 2.0, 4.0, 6.0, 8.0), ready=True)[-1] is None


def test_deaths_far_apart_are_forgiven():
    deaths_s = [60.0 * i for i in range(20)]
    assert set(fail(RestartBudget(), deaths_s, ready=True)) == {0.1}


def test_the_fifth_start_in_vain_is_one_too_many_however_long_it_takes():
    deaths_s = [60.0 * i for i in range(5)]
    assert fail(RestartBudget(), deaths_s, ready=False)[-1] is None
