"""The course on Docker and Kubernetes, as far as it can be tried without either."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import jsonschema
import pytest
import yaml
from dockerspawner import DockerSpawner
from jupyterhub.app import JupyterHub
from jupyterhub.auth import Authenticator
from jupyterhub.spawner import Spawner
from traitlets import HasTraits
from traitlets.config import Config, PyFileConfigLoader

from labkit.hub.command import REQUIREMENTS
from labkit.hub.spawner import GroupSpawner, LimitedSpawner

ROOT = Path(__file__).resolve().parents[2]
HUB = ROOT / 'labkit' / 'hub'
DOCKERFILE = (HUB / 'Dockerfile').read_text()
VALUES = yaml.safe_load((HUB / 'values.yaml').read_text())
SCHEMA = json.loads(Path(__file__).with_name('values.schema.json').read_text())


def configuration(folder: Path, monkeypatch: pytest.MonkeyPatch, **env: str) -> Config:
    """Return what JupyterHub reads."""
    (folder / 'robots.txt').write_text('anna\nmaria teacher\n')
    monkeypatch.setenv('LABKIT_CLASS', str(folder / 'robots.txt'))
    monkeypatch.setenv('LABKIT_CLASS_FOLDER', str(folder / 'class'))
    monkeypatch.setenv('LABKIT_HUB_TOKEN', 'secret')
    for name, value in env.items():
        monkeypatch.setenv(name, value)
    path = str(HUB / 'jupyterhub_config.py')
    return PyFileConfigLoader(path).load_config()


# --- The configuration of one machine, in its three forms ----------------------------------------

LEARNER = ['-I', '-m', 'labkit.hub.learner']
KNOWN: dict[str, type] = {
    'JupyterHub': JupyterHub,
    'Authenticator': Authenticator,
    'Spawner': Spawner,
    'DockerSpawner': DockerSpawner,
    'LimitedSpawner': LimitedSpawner,
    'GroupSpawner': GroupSpawner,
}


@pytest.mark.parametrize('form', ['processes', 'systemd', 'docker'])
def test_each_setting_is_one_that_jupyterhub_knows(
    form: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    isdir = os.path.isdir
    monkeypatch.setattr(
        os.path,
        'isdir',
        lambda path: form == 'systemd' if path == '/run/systemd/system' else isdir(path),
    )
    config = configuration(
        tmp_path, monkeypatch, **({'LABKIT_IMAGE': 'ros-course'} if form == 'docker' else {})
    )
    classes = {
        'processes': LimitedSpawner,
        'systemd': GroupSpawner,
        'docker': DockerSpawner,
    }
    assert config.JupyterHub.spawner_class.endswith(f'.{classes[form].__name__}')
    for section, settings in config.items():
        for name, value in settings.items():
            if section in KNOWN:
                trait = KNOWN[section].class_traits(config=True)[name]  # type: ignore[attr-defined]
                if hasattr(trait, 'validate'):  # a hook may be anything
                    trait.validate(HasTraits(), value)
    assert config.Authenticator.allowed_users == {'anna', 'maria'}
    assert config.ClassAuthenticator.teachers == {'maria'}
    assert 'admin_users' not in config.Authenticator
    # A container runs what its image says.
    assert ('cmd' in config[classes[form].__name__]) == (form != 'docker')
    assert 'cmd' not in config.Spawner
    # Nothing about one's own server is one's own choice, such as the image.
    offers = {'allowed_images', 'apply_user_options', 'options_form', 'options_from_form'}
    assert not offers & {name for settings in config.values() for name in settings}


# --- The image -----------------------------------------------------------------------------------


def instructions(word: str) -> list[str]:
    joined = DOCKERFILE.replace('\\\n', ' ')
    return re.findall(rf'^{word} (.*)$', joined, re.MULTILINE)


def test_image_is_prepared_by_the_command_of_the_hub() -> None:
    assert 'python3 -m labkit hub --prepare' in instructions('RUN')
    (copied,) = instructions('COPY')
    (command,) = instructions('CMD')
    folder = copied.split()[1]
    assert json.loads(command) == [f'{folder}/.venv/bin/python', *LEARNER]


def test_image_has_what_is_needed_and_nothing_that_is_ones_own() -> None:
    ignored = (HUB / 'Dockerfile.dockerignore').read_text().split()
    assert {'.git', '.venv', 'work'} <= set(ignored)
    for name in REQUIREMENTS:
        assert not any(Path(name).match(pattern) for pattern in ignored), name


def test_image_runs_as_the_user_that_the_chart_expects(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (user,) = instructions('USER')
    (made,) = [line for line in instructions('RUN') if line.startswith('useradd')]
    assert made.split()[-1] == user
    assert '--uid 1000' in made  # the chart's singleuser.uid
    # The chart's singleuser.storage.homeMountPath, and the volume of DockerSpawner.
    assert instructions('WORKDIR')[-1] == f'/home/{user}'
    config = configuration(tmp_path, monkeypatch, LABKIT_IMAGE='ros-course')
    assert list(config.DockerSpawner.volumes.values()) == [f'/home/{user}']


def test_python_of_the_image_is_one_of_the_course() -> None:
    from labkit.setup.machine import VERSIONS

    (base,) = instructions('FROM')
    found = re.fullmatch(r'python:(\d+)\.(\d+)-slim-\w+', base)
    assert found and (int(found[1]), int(found[2])) in VERSIONS


# --- Kubernetes ----------------------------------------------------------------------------------


def partial(schema: Any) -> Any:
    """Return a schema without what it requires: a file of values holds what differs."""
    if isinstance(schema, dict):
        return {key: partial(value) for key, value in schema.items() if key != 'required'}
    return [partial(value) for value in schema] if isinstance(schema, list) else schema


def test_values_are_those_of_the_chart() -> None:
    jsonschema.validate(VALUES, partial(SCHEMA))


@pytest.mark.parametrize(
    'wrong',
    [
        {'singleuser': {'imagge': {}}},
        {'singleuser': {'memory': {'limit': '2G', 'most': 1}}},
        {'proxy': {'https': {'enabled': 'yes'}}},
    ],
)
def test_wrong_values_would_be_found(wrong: dict[str, Any]) -> None:
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(wrong, partial(SCHEMA))


def test_the_image_and_the_chart_have_the_same_jupyterhub() -> None:
    found = re.search(r'JupyterHub (\d+\.\d+)\.\d+', SCHEMA['$comment'])
    requirements = (HUB / 'requirements.txt').read_text()
    assert found and f'\njupyterhub=={found[1]}.' in requirements


def test_the_chart_runs_the_command_of_the_image() -> None:
    assert VALUES['singleuser']['cmd'] is None  # else it would be `jupyterhub-singleuser`
    assert not {'profileList', 'allowedImages'} & VALUES['singleuser'].keys()
    assert VALUES['hub']['config']['NativeAuthenticator']['open_signup'] is False
    assert VALUES['proxy']['https']['enabled'] is True


def test_pods_have_their_part_of_the_folder_of_the_class() -> None:
    learner = VALUES['singleuser']
    (volume,), (mount,) = (learner['storage'][f'extraVolume{what}'] for what in ('s', 'Mounts'))
    claim = yaml.safe_load((HUB / 'class_volume.yaml').read_text())
    assert volume['persistentVolumeClaim']['claimName'] == claim['metadata']['name']
    assert claim['spec']['accessModes'] == ['ReadWriteMany']
    assert mount['name'] == volume['name'] and mount['subPath'] == '{username}'
    # `lab.join_class()` looks there: the name that one logs in with, in the folder of the class.
    folder = learner['extraEnv']['LABKIT_CLASS_FOLDER']
    assert mount['mountPath'] == f'{folder}/{{unescaped_username}}'
    (first,) = learner['initContainers']
    image = learner['image']
    assert first['image'] == f'{image["name"]}:{image["tag"]}'
    (seen,) = first['volumeMounts']
    (own,) = set(re.findall(r' (/\S+)', first['command'][-1]))
    assert own == f'{seen["mountPath"]}/{mount["subPath"]}'

    config = Config()
    exec(VALUES['hub']['extraConfig']['class'], {'c': config})
    for is_admin, parts in ((False, [mount]), (True, [{**seen, 'readOnly': True}, mount])):
        user = SimpleNamespace(admin=is_admin)
        spawner = SimpleNamespace(user=user, volume_mounts=[mount])
        for _ in range(2):  # one spawner starts a pod again and again
            config.KubeSpawner.pre_spawn_hook(spawner)
        expected = [{**part, 'mountPath': folder} if part != mount else part for part in parts]
        assert spawner.volume_mounts == expected
