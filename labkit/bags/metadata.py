"""`metadata.yaml` of a bag, and QoS profiles as they stand in it. Written as version 9: Jazzy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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

__all__ = [
    'FILE_NAME',
    'Metadata',
    'TopicMetadata',
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
_ENDLESS_NS = 2**63 - 1


@dataclass(frozen=True)
class TopicMetadata:
    """What `metadata.yaml` says of a topic with one type.

    Attributes:
        name: Full name of the topic.
        msg_type: Name of the type.
        serialization_format: `'cdr'`.
        qos: The offered QoS profiles, as in the file.
        type_hash: `RIHS01_...`, '' if it is not known.
        count: How many messages it has.
    """

    name: str
    msg_type: str
    serialization_format: str
    qos: Any
    type_hash: str
    count: int


@dataclass(frozen=True)
class Metadata:
    """What `metadata.yaml` says of a bag.

    Attributes:
        storage: `'mcap'` or `'sqlite3'`.
        files: The names of its files, in order.
        start_ns: Time of the first message, ns.
        duration_ns: From the first to the last message, ns.
        topics: Its topics.
        compression: `''`, `'file'` or `'message'`.
        version: Of the format of metadata.yaml.
        ros_distro: Whose rosbag2 has written it; `'unknown'` if it does not say.
    """

    storage: str
    files: Sequence[str]
    start_ns: int
    duration_ns: int
    topics: Sequence[TopicMetadata]
    compression: str = ''
    version: int = VERSION
    ros_distro: str = ROS_DISTRO

    @property
    def count(self) -> int:
        """Return how many messages the bag has."""
        return sum(topic.count for topic in self.topics)

    def text(self, files: Sequence[Mapping[str, Any]] = ()) -> str:
        """Return the file's text.

        Args:
            files: What is to be said of each file: path, start_ns, duration_ns, count.
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
    """Read a file.

    Raises:
        Damaged: It does not say what it should.
        OSError: It can't be read.
    """
    try:
        content = yaml.load(path.read_text(encoding='utf-8'), Loader=_Loader)
        found = content[_ROOT]
        mode = str(found.get('compression_mode') or '').lower()
        return Metadata(
            str(found['storage_identifier']),
            [str(name) for name in found['relative_file_paths']],
            int(found['starting_time']['nanoseconds_since_epoch']),
            int(found['duration']['nanoseconds']),
            [_topic_from(each) for each in found['topics_with_message_count']],
            '' if mode == 'none' else mode,
            int(found.get('version', 1)),
            str(found.get('ros_distro') or 'unknown'),
        )
    except (yaml.YAMLError, KeyError, TypeError, ValueError, AttributeError) as error:
        raise Damaged('can not be understood') from error


_Loader: Any = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)


def _topic_from(entry: Mapping[str, Any]) -> TopicMetadata:
    known = entry['topic_metadata']
    return TopicMetadata(
        str(known['name']),
        str(known['type']),
        str(known.get('serialization_format') or 'cdr'),
        known.get('offered_qos_profiles') or '',
        str(known.get('type_description_hash') or ''),
        int(entry['message_count']),
    )


def _topic_to(topic: TopicMetadata) -> dict[str, Any]:
    return {
        'topic_metadata': {
            'name': topic.name,
            'type': topic.msg_type,
            'serialization_format': topic.serialization_format,
            'offered_qos_profiles': topic.qos or [],
            'type_description_hash': topic.type_hash,
        },
        'message_count': topic.count,
    }


# --- QoS profiles --------------------------------------------------------------------------------


def profiles_from(stored: Any) -> list[QoSProfile]:
    """Return QoS profiles from what a bag says: a list, or YAML of one; none if it is neither.

    Before version 9 policies are numbers, and the longest time that there is means no end.
    """
    try:
        entries = yaml.load(stored, Loader=_Loader) if isinstance(stored, str) else stored
        return [_profile_from(entry) for entry in entries or ()]
    except (yaml.YAMLError, KeyError, TypeError, ValueError, AttributeError):
        return []


def profiles_to_list(profiles: Sequence[QoSProfile]) -> list[dict[str, Any]]:
    """Return QoS profiles as version 9 writes them."""
    return [_profile_to(profile) for profile in profiles]


def profiles_to_text(profiles: Sequence[QoSProfile]) -> str:
    """Return QoS profiles as YAML, as it stands in the files of messages."""
    return yaml.safe_dump(profiles_to_list(profiles), sort_keys=False) if profiles else ''


def _profile_from(entry: Mapping[str, Any]) -> QoSProfile:
    policies = {name: _policy(kinds, entry[name]) for name, kinds in _POLICIES.items()}
    times = {name: _duration(entry[name]) for name in _TIMES if name in entry}
    return QoSProfile(  # type: ignore[no-untyped-call]
        depth=int(entry.get('depth', 0)),
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
    total = int(value['sec']) * 10**9 + int(value['nsec'])
    # rmw_time_t of older versions had 32 bits less: their longest time is no end, too.
    endless = total >= _ENDLESS_NS or int(value['sec']) >= 2**31 - 1
    return Duration(nanoseconds=_ENDLESS_NS if endless else total)
