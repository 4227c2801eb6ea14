"""`metadata.yaml` of a bag, with its QoS profiles. Written in version 9, that of Jazzy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

from labkit.bags.stored import Damaged
from labkit.rosgraph.yaml_loading import load_yaml, load_yaml_file

__all__ = [
    'FILE_NAME',
    'BagTopic',
    'Metadata',
    'profiles_from',
    'profiles_to_text',
    'read_metadata',
]

FILE_NAME = 'metadata.yaml'
VERSION = 9
ROS_DISTRO = 'jazzy'
_ROOT = 'rosbag2_bagfile_information'

_POLICIES: dict[str, Any] = {
    'history': HistoryPolicy,
    'reliability': ReliabilityPolicy,
    'durability': DurabilityPolicy,
    'liveliness': LivelinessPolicy,
}
_TIMES = ('deadline', 'lifespan', 'liveliness_lease_duration')
_INFINITE_NS = 2**63 - 1


@dataclass(frozen=True)
class BagTopic:
    """A topic of a bag.

    Attributes:
        name: Full name of the topic.
        msg_type: Name of its type, such as `std_msgs/msg/String`.
        count: Number of its messages in the bag.
        qos_profiles: Profiles offered by its publishers, as far as recorded.
        serialization_format: Usually `'cdr'`.
        definition: Definition of the type, '' if the bag has none.
        encoding: Language of the definition: `'ros2msg'` or `'ros2idl'`.
        type_hash: `RIHS01_...`, '' if the bag has none.
    """

    name: str
    msg_type: str
    count: int
    qos_profiles: list[QoSProfile] = field(repr=False)
    serialization_format: str = field(default='cdr', repr=False)
    definition: str = field(default='', repr=False)
    encoding: str = field(default='', repr=False)
    type_hash: str = field(default='', repr=False)


@dataclass(frozen=True)
class Metadata:
    """The content of `metadata.yaml`.

    Attributes:
        storage: `'mcap'` or `'sqlite3'`.
        files: Names of its files, in order.
        start_ns: Time of the first message, ns.
        duration_ns: Time from the first to the last message, ns.
        compression: `''`, `'file'` or `'message'`.
        version: Version of the format of metadata.yaml.
        ros_distro: Distribution that wrote the bag; `'unknown'` if not stated.
    """

    storage: str
    files: Sequence[str]
    start_ns: int
    duration_ns: int
    topics: Sequence[BagTopic]
    compression: str = ''
    version: int = VERSION
    ros_distro: str = ROS_DISTRO

    @property
    def count(self) -> int:
        """Number of messages in the bag."""
        return sum(topic.count for topic in self.topics)

    def text(self, files: Sequence[Mapping[str, Any]] = ()) -> str:
        """Return the file's text.

        Args:
            files: Entries for the files: path, start_ns, duration_ns, count.
        """
        information = {
            'version': VERSION,
            'storage_identifier': self.storage,
            'duration': {'nanoseconds': self.duration_ns},
            'starting_time': {'nanoseconds_since_epoch': self.start_ns},
            'message_count': self.count,
            'topics_with_message_count': [_topic_to(topic) for topic in self.topics],
            'compression_format': '',
            'compression_mode': '',
            'relative_file_paths': list(self.files),
            'files': [
                {
                    'path': file['path'],
                    'starting_time': {'nanoseconds_since_epoch': file['start_ns']},
                    'duration': {'nanoseconds': file['duration_ns']},
                    'message_count': file['count'],
                }
                for file in files
            ],
            'custom_data': None,
            'ros_distro': ROS_DISTRO,
        }
        return yaml.safe_dump({_ROOT: information}, sort_keys=False, allow_unicode=True)


def read_metadata(path: Path) -> Metadata:
    """Read a `metadata.yaml`.

    Raises:
        Damaged: It has another form.
        OSError: It can't be read.
    """
    try:
        found = load_yaml_file(path)[_ROOT]
        mode = str(found.get('compression_mode') or '').lower()
        return Metadata(
            str(found['storage_identifier']),
            [str(name) for name in found['relative_file_paths']],
            _whole(found['starting_time']['nanoseconds_since_epoch'], -(2**63)),
            _whole(found['duration']['nanoseconds']),
            [_topic_from(each) for each in found['topics_with_message_count']],
            '' if mode == 'none' else mode,
            _whole(found.get('version', 1)),
            str(found.get('ros_distro') or 'unknown'),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise Damaged('can not be understood') from error


def _whole(value: Any, least: int = 0) -> int:
    """Return a whole number that a field of 64 bits can hold."""
    if not isinstance(value, int) or not least <= value < 2**64:
        raise ValueError('a number is out of range')
    return value


def _topic_from(entry: Mapping[str, Any]) -> BagTopic:
    known = entry['topic_metadata']
    return BagTopic(
        str(known['name']),
        str(known['type']),
        _whole(entry['message_count']),
        profiles_from(known.get('offered_qos_profiles')),
        str(known.get('serialization_format') or 'cdr'),
        type_hash=str(known.get('type_description_hash') or ''),
    )


def _topic_to(topic: BagTopic) -> dict[str, Any]:
    return {
        'topic_metadata': {
            'name': topic.name,
            'type': topic.msg_type,
            'serialization_format': topic.serialization_format,
            'offered_qos_profiles': profiles_to_list(topic.qos_profiles),
            'type_description_hash': topic.type_hash,
        },
        'message_count': topic.count,
    }


# --- QoS profiles --------------------------------------------------------------------------------


def profiles_from(stored: Any) -> list[QoSProfile]:
    """Return QoS profiles from a list, or YAML of one; none from anything else.

    Before version 9, policies are numbers, and the greatest possible time means infinity.
    """
    try:
        entries = load_yaml(stored) if isinstance(stored, str) else stored
        return [_profile_from(entry) for entry in entries or ()]
    except (KeyError, TypeError, ValueError, AttributeError):
        return []


def profiles_to_list(profiles: Sequence[QoSProfile]) -> list[dict[str, Any]]:
    """Return QoS profiles in the form of version 9."""
    return [_profile_to(profile) for profile in profiles]


def profiles_to_text(profiles: Sequence[QoSProfile]) -> str:
    """Return QoS profiles as YAML, in the form used inside data files."""
    return yaml.safe_dump(profiles_to_list(profiles), sort_keys=False) if profiles else ''


def _profile_from(entry: Mapping[str, Any]) -> QoSProfile:
    policies = {name: _policy(kinds, entry[name]) for name, kinds in _POLICIES.items()}
    times = {name: _duration(entry[name]) for name in _TIMES if name in entry}
    return QoSProfile(  # type: ignore[no-untyped-call]
        depth=_whole(entry.get('depth', 0)),
        avoid_ros_namespace_conventions=bool(entry.get('avoid_ros_namespace_conventions')),
        **policies,
        **times,
    )


def _profile_to(profile: QoSProfile) -> dict[str, Any]:
    found: dict[str, Any] = {'history': profile.history.name.lower(), 'depth': profile.depth}
    found |= {name: getattr(profile, name).name.lower() for name in ('reliability', 'durability')}
    for name in (*_TIMES[:2], 'liveliness', _TIMES[2]):
        value = getattr(profile, name)
        if name == 'liveliness':
            found[name] = value.name.lower()
        else:
            sec, nsec = divmod(value.nanoseconds, 10**9)
            found[name] = {'sec': sec, 'nsec': nsec}
    found['avoid_ros_namespace_conventions'] = profile.avoid_ros_namespace_conventions
    return found


def _policy(kinds: Any, value: Any) -> Any:
    if isinstance(value, int):
        return kinds(value)
    return getattr(kinds, value.upper(), kinds.UNKNOWN)


def _duration(value: Mapping[str, int]) -> Duration:
    sec = _whole(value['sec'])
    total = sec * 10**9 + _whole(value['nsec'])
    # rmw_time_t of older versions has 32 bits: its greatest time means infinity, too.
    infinite = total >= _INFINITE_NS or sec >= 2**31 - 1
    return Duration(nanoseconds=_INFINITE_NS if infinite else total)
