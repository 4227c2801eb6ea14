"""QoS profiles from short names, and one that hears all publishers."""

from __future__ import annotations

import pytest
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_sensor_data,
)

from labkit.rosgraph.qos_profiles import POLICIES, PRESETS, make_profile, match_all

BEST, RELIABLE = ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE
VOLATILE, KEPT = DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL


def test_a_preset_by_its_short_name():
    assert make_profile('sensor_data') == qos_profile_sensor_data
    assert make_profile('sensor_data') is not qos_profile_sensor_data
    for name in PRESETS:
        assert isinstance(make_profile(name), QoSProfile), name


def test_what_is_named_takes_the_place_of_the_preset():
    policies = {
        'reliability': 'reliable',
        'durability': 'transient_local',
        'history': 'keep_all',
        'liveliness': 'manual_by_topic',
    }
    assert set(policies) == set(POLICIES)
    profile = make_profile('sensor_data', policies, depth=7, lease_duration_sec=0.5)
    assert (profile.reliability, profile.durability) == (RELIABLE, KEPT)
    assert (profile.history, profile.depth) == (HistoryPolicy.KEEP_ALL, 7)
    assert profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    assert profile.liveliness_lease_duration.nanoseconds == 500_000_000
    # The preset itself is as it was.
    assert make_profile('sensor_data').reliability == BEST


def test_who_keeps_messages_keeps_one_at_least():
    assert make_profile('system_default', {'durability': 'transient_local'}).depth == 1


@pytest.mark.parametrize(
    ('offered', 'asked', 'notes'),
    [
        ([(RELIABLE, KEPT)], (RELIABLE, KEPT), []),
        ([(BEST, VOLATILE)], (BEST, VOLATILE), []),
        ([(RELIABLE, VOLATILE)] * 2, (RELIABLE, VOLATILE), []),
        ([(RELIABLE, VOLATILE), (BEST, VOLATILE)], (BEST, VOLATILE), ['RELIABLE']),
        ([(RELIABLE, KEPT), (RELIABLE, VOLATILE)], (RELIABLE, VOLATILE), ['TRANSIENT_LOCAL']),
    ],
)
def test_a_subscription_that_hears_all_publishers(offered, asked, notes):
    profile = QoSProfile(depth=5)
    lines = match_all(
        profile, [QoSProfile(depth=1, reliability=r, durability=d) for r, d in offered]
    )
    assert (profile.reliability, profile.durability, profile.depth) == (*asked, 5)
    assert [line.split('Policy.')[1].split('.')[0] for line in lines] == notes
