"""The hub of a class on one machine: JupyterHub's configuration; see docs/hub.md.

`labkit hub` prepares this and starts JupyterHub with it, in the hub's folder. Options of `labkit
hub` override these: `--port=9000`, `--Spawner.mem_limit=4G`.
"""

import os
import sys
from pathlib import Path

from labkit import hub
from labkit.hub.class_list import read_class
from labkit.hub.command import PORT
from labkit.hub.containers import HUB_IP, MOUNTED, mount_class
from labkit.hub.login import TEACHER
from labkit.hub.passwords import HASHES, names_with_password
from labkit.hub.proxy import proxy_command

c = get_config()  # type: ignore[name-defined] # noqa: F821 (JupyterHub brings it)
members = read_class(Path(os.environ['LABKIT_CLASS']))

# --- Who may come in -----------------------------------------------------------------------------
c.JupyterHub.authenticator_class = 'labkit.hub.login.ClassAuthenticator'
c.ClassAuthenticator.dbm_path = HASHES
c.ClassAuthenticator.create_users = False  # everybody has a password from the start
c.ClassAuthenticator.min_password_length = 10
c.JupyterHub.template_paths = [str(Path(hub.__file__).with_name('templates'))]
c.Authenticator.allowed_users = {member.name for member in members}
teachers = c.ClassAuthenticator.teachers = {member.name for member in members if member.teaches}
c.Authenticator.allow_existing_users = False  # people removed from the list are out
# And the hub ends their servers when it starts.
c.Authenticator.blocked_users = names_with_password(Path()) - c.Authenticator.allowed_users

# --- Where ---------------------------------------------------------------------------------------
# Only this machine, unless `--ip` says otherwise.
c.JupyterHub.ip = '127.0.0.1'
# Three ports that only root can take, also while there is no hub: the pages', the hub's, and the
# one at which the proxy takes orders.
port = int(os.environ.get('LABKIT_PORT', PORT))
c.JupyterHub.port = port
c.JupyterHub.hub_port = port + 1
image = os.environ.get('LABKIT_IMAGE')
# Hub, proxy and servers show each other certificates. Any account could take a server's port; in
# containers each server has a network of its own.
c.JupyterHub.internal_ssl = not image
c.ConfigurableHTTPProxy.api_url = f'http{"" if image else "s"}://127.0.0.1:{port + 2}'
c.ConfigurableHTTPProxy.command = proxy_command()

# --- A learner's server --------------------------------------------------------------------------
# Enough for thirty that start at once on a small machine.
c.Spawner.start_timeout = c.Spawner.http_timeout = 180
c.Spawner.mem_limit = '2G'
# What learners write into their homes does not set up JupyterLab.
c.Spawner.disable_user_config = True
# No other variables of the hub: they belong to root's Python.
c.Spawner.env_keep = ['PATH', 'LANG', 'LC_ALL', 'VIRTUAL_ENV']
# Isolated, and by no shell: nothing in a home stands before the course's modules.
learner = [sys.executable, '-I', '-m', 'labkit.hub.learner']
class_folder = os.environ['LABKIT_CLASS_FOLDER']
# For `lab.join_class()` and `lab.classroom()`.
c.Spawner.environment = {'LABKIT_CLASS_FOLDER': MOUNTED if image else class_folder}
if image:
    # A container per learner: a separate network, and `mem_limit` for all of it.
    c.JupyterHub.spawner_class = 'dockerspawner.DockerSpawner'
    c.DockerSpawner.image = image  # its CMD is the same as `learner` here
    c.DockerSpawner.volumes = {'labkit-{username}': '/home/jovyan'}
    c.DockerSpawner.pre_spawn_hook = mount_class(Path(class_folder), members)
    c.DockerSpawner.remove = True
    c.DockerSpawner.use_internal_ip = True
    c.DockerSpawner.extra_host_config = {
        'pids_limit': 600,
        'cap_drop': ['ALL'],
        'security_opt': ['no-new-privileges'],
    }
    c.JupyterHub.hub_ip = HUB_IP
    c.DockerSpawner.env_keep = []
elif os.path.isdir('/run/systemd/system'):
    # All processes of a learner share a control group: limits hold for them together, and busy
    # learners share the processors evenly. `--Spawner.cpu_limit=1.5` would be a hard limit.
    c.JupyterHub.spawner_class = 'labkit.hub.spawner.GroupSpawner'
    c.GroupSpawner.cmd = learner
    c.GroupSpawner.private_folder = f'{class_folder}-private'
    c.GroupSpawner.default_shell = '/bin/bash'
    c.GroupSpawner.isolate_tmp = True
    c.GroupSpawner.unit_extra_properties = {
        'TasksMax': '600',
        'OOMScoreAdjust': '500',
        'TemporaryFileSystem': '/dev/shm:mode=1777',
    }
else:
    c.JupyterHub.spawner_class = 'labkit.hub.spawner.LimitedSpawner'
    c.LimitedSpawner.cmd = learner
    c.LimitedSpawner.private_folder = f'{class_folder}-private'

# --- Nobody loses anything -----------------------------------------------------------------------
# Learners' servers keep running without the hub, and the next one finds them.
c.JupyterHub.cleanup_servers = False

# --- What nobody uses is ended -------------------------------------------------------------------
# Stop servers after an hour without activity: files and progress stay, kernels end.
# It shows the hub's own certificate, which only root reads.
encrypted = [] if image else ['--ssl-enabled=true']
culler = [sys.executable, '-m', 'jupyterhub_idle_culler', *encrypted, '--timeout=3600']
c.JupyterHub.services = [
    {'name': 'idle-culler', 'command': culler},
    # `labkit hub --new-password`, which ends what was begun with the old one.
    {'name': 'new-password', 'api_token': os.environ['LABKIT_HUB_TOKEN']},
]
c.JupyterHub.load_roles = [
    {
        'name': 'idle-culler',
        'services': ['idle-culler'],
        'scopes': ['list:users', 'read:users:activity', 'read:servers', 'delete:servers'],
    },
    {
        'name': 'new-password',
        'services': ['new-password'],
        'scopes': ['delete:users', 'delete:servers'],
    },
    # No admins: JupyterHub keeps those for good, and a role only for who is in it at the start.
    # And no `admin:users`: "Edit User" in the admin page takes a user's name away if it is left as
    # it was, and the hub does not start again then (JupyterHub 5.5, UserAPIHandler.patch).
    {
        'name': TEACHER,
        'users': sorted(teachers),
        'scopes': [
            'admin-ui',
            'list:users',
            'read:users',
            'delete:users',
            'servers',
            'access:servers',
        ],
    },
]
