"""The default profile of Fast DDS, changed while a process runs.

Fast DDS reads the file that `FASTRTPS_DEFAULT_PROFILES_FILE` names once, and rmw_fastrtps makes
each participant from the default profile. So that a process which nobody reaches from outside can
share one topic, the default has to change for a moment. Python has no access to that: these are
functions of the C++ library, called by their names.
"""

from __future__ import annotations

import ctypes
import itertools
import re
from pathlib import Path

from labkit.errors import LabError

__all__ = ['use_profile']

_SPACE = '_ZN8eprosima7fastdds3dds'
_FACTORY = f'{_SPACE}24DomainParticipantFactory'
# The name that all names in labkit's profiles begin with. Fast DDS takes each name once.
_PREFIX = 'labkit_'
# Fast DDS's own default.
_NONE = """\
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="labkit_none" is_default_profile="true"><rtps/></participant>
</profiles>
"""
_numbers = itertools.count(1)


def use_profile(path: str) -> None:
    """Make the participants of this process from another profile from now on.

    Args:
        path: The file of the profile, '' for none.

    Raises:
        LabError: This Fast DDS has no such functions.
    """
    text = Path(path).read_text(encoding='utf-8') if path else _NONE
    data = text.replace(_PREFIX, f'{_PREFIX}{next(_numbers)}_').encode()
    try:
        library = ctypes.CDLL(_loaded_library())
        get = library[f'{_FACTORY}12get_instanceEv']
        load = library[f'{_FACTORY}24load_XML_profiles_stringEPKcm']
        choose = library[f'{_FACTORY}27set_default_participant_qosERKNS1_20DomainParticipantQosE']
        # Says: as the default profile has it.
        default = ctypes.c_char.in_dll(library, f'{_SPACE}23PARTICIPANT_QOS_DEFAULTE')
    except (OSError, AttributeError, ValueError) as error:
        raise LabError(
            f'Fast DDS needs another profile now, and it can not be changed: {error}.',
            todo='Set ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET before Jupyter starts. Then all of a '
            "notebook's nodes can be reached from other computers.",
        ) from None
    get.restype = ctypes.c_void_p
    factory = ctypes.c_void_p(get())
    failed = load(factory, data, ctypes.c_size_t(len(data))) or choose(
        factory, ctypes.byref(default)
    )
    if failed:
        raise LabError(f'Fast DDS does not take the profile {path!r}: error {failed}.')


def _loaded_library() -> str:
    """Return the path of Fast DDS in this process: wheels have copies of it, by other names."""
    found = re.search(r'\s(/.*/libfastrtps\.so\S*)', Path('/proc/self/maps').read_text())
    if found is None:
        raise OSError('no libfastrtps.so is loaded')
    return found[1]
