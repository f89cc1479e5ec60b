"""Rates, delays and bandwidths, as `hz`, `delay` and `bw` print them."""

from tests.ros2_verbs.golden_texts import golden

from ros2_verbs.topic.bw import BandwidthWindow
from ros2_verbs.topic.delay import DelayWindow
from ros2_verbs.topic.hz import RateWindow, rate_report

MS = 1_000_000
START = 1_000_000 * MS


def test_a_rate_is_printed_as_in_the_tutorial() -> None:
    # 58 intervals with the tutorial's mean, extremes and deviation.
    mean = 1e9 / 59.354
    middle = (58 * mean - 32 * MS) / 56
    inner = [middle + sign * 2.0 * MS for sign in (1, -1) for _ in range(28)]
    intervals = [round(value) for value in (5 * MS, 27 * MS, *inner)]
    assert rate_report(intervals) + "\n" == golden("topic_hz")


def test_a_bandwidth_is_printed_as_in_the_tutorial() -> None:
    window = BandwidthWindow(100)
    for count in range(62):
        window.arrived(count * 16 * MS, 24)
    assert f"{window.report(985 * MS)}\n" == golden("topic_bw")


def test_a_rate_is_reported_once_a_second() -> None:
    window = RateWindow(10_000)
    reports = [window.arrived(START + 2 * MS * tick) for tick in range(1501)]
    assert [tick for tick, text in enumerate(reports) if text] == [500, 1000, 1500]
    assert reports[500] == (
        "average rate: 500.000\n\tmin: 0.002s max: 0.002s std dev: 0.00000s window: 500"
    )


def test_only_the_last_intervals_count() -> None:
    window = RateWindow(10)
    slow = [window.arrived(START + 100 * MS * tick) for tick in range(11)]
    fast = [window.arrived(START + 1000 * MS + 10 * MS * k) for k in range(1, 101)]
    assert slow[-1] is not None and "average rate: 10.000" in slow[-1]
    assert fast[-1] is not None and "average rate: 100.000" in fast[-1]


def test_time_that_goes_back_begins_a_new_window() -> None:
    window = RateWindow(10_000)
    for tick in range(10):
        window.arrived(START + 100 * MS * tick)
    later = [window.arrived(MS + 100 * MS * tick) for tick in range(11)]
    assert later[-1] is not None and later[-1].endswith("window: 10")


def test_simulated_time_that_has_not_begun_resets_the_counters() -> None:
    window = RateWindow(10_000)
    window.arrived(START)
    window.arrived(START + MS)
    assert window.arrived(0) == "time has reset, resetting counters"


def test_a_delay_is_from_stamp_to_arrival() -> None:
    window = DelayWindow(100)
    window.arrived(START + 3 * MS, START)
    window.arrived(START + 5 * MS, START)
    assert window.report() == (
        "average delay: 0.004\n\tmin: 0.003s max: 0.005s std dev: 0.00100s window: 2"
    )


def test_without_new_messages_the_delay_is_not_repeated() -> None:
    window = DelayWindow(100)
    window.arrived(START + 3 * MS, START)
    window.report()
    assert window.report() == "no new messages"


def test_bandwidths_have_the_unit_of_their_size() -> None:
    reports = []
    for size in (10, 100_000, 100_000_000):
        window = BandwidthWindow(10)
        window.arrived(0, size)
        window.arrived(500 * MS, size)
        reports.append(window.report(1000 * MS))
    assert [str(text).split(" from ")[0] for text in reports] == [
        "20 B/s",
        "200.00 KB/s",
        "200.00 MB/s",
    ]
