"""The hub of a class on one machine, as JupyterHub reads it; see docs/hub.md.

`labkit hub` makes what this needs and starts JupyterHub with it, in the hub's folder. Options
behind `labkit hub` come after these: `--port=9000`, `--Spawner.mem_limit=4G`.
"""

import os
import sys
from pathlib import Path

from labkit.hub.class_list import read_class
from labkit.hub.containers import MOUNTED, mount_class
from labkit.hub.passwords import HASHES
from labkit.hub.proxy import proxy_command

c = get_config()  # type: ignore[name-defined] # noqa: F821 (JupyterHub brings it)
members = read_class(Path(os.environ['LABKIT_CLASS']))

# --- Who may come in -----------------------------------------------------------------------------
c.JupyterHub.authenticator_class = 'firstuseauthenticator.FirstUseAuthenticator'
c.FirstUseAuthenticator.dbm_path = HASHES
c.FirstUseAuthenticator.create_users = False  # all have a password from the start
c.FirstUseAuthenticator.min_password_length = 10
c.Authenticator.allowed_users = {member.name for member in members}
c.Authenticator.admin_users = {member.name for member in members if member.teaches}
c.Authenticator.allow_existing_users = False  # who is not in the list any more is out

# --- Where ---------------------------------------------------------------------------------------
# This machine alone, unless `--ip` says otherwise.
c.JupyterHub.ip = '127.0.0.1'
c.ConfigurableHTTPProxy.command = proxy_command()

# --- A learner's server --------------------------------------------------------------------------
# Thirty that start at once on a small machine.
c.Spawner.start_timeout = c.Spawner.http_timeout = 180
c.Spawner.mem_limit = '2G'
# Nothing else of the hub's own variables: they belong to root's Python.
c.Spawner.env_keep = ['PATH', 'LANG', 'LC_ALL', 'VIRTUAL_ENV']
learner = [sys.executable, '-m', 'labkit.hub.learner']
image = os.environ.get('LABKIT_IMAGE')
class_folder = os.environ['LABKIT_CLASS_FOLDER']
# For `lab.join_class()` and `lab.classroom()`.
c.Spawner.environment = {'LABKIT_CLASS_FOLDER': MOUNTED if image else class_folder}
if image:
    # A container for each learner: an own network, and `mem_limit` for all of it.
    c.JupyterHub.spawner_class = 'dockerspawner.DockerSpawner'
    c.DockerSpawner.image = image  # its CMD is the same as `learner` is here
    c.DockerSpawner.volumes = {'labkit-{username}': '/home/jovyan'}
    c.DockerSpawner.pre_spawn_hook = mount_class(Path(class_folder), members)
    c.DockerSpawner.remove = True
    c.DockerSpawner.use_internal_ip = True
    c.DockerSpawner.extra_host_config = {
        'pids_limit': 600,
        'cap_drop': ['ALL'],
        'security_opt': ['no-new-privileges'],
    }
    # Where containers find the hub: this machine's end of Docker's bridge.
    c.JupyterHub.hub_ip = '172.17.0.1'
    c.DockerSpawner.env_keep = []
elif os.path.isdir('/run/systemd/system'):
    # All processes of a learner are in one control group: the limits hold for them together, and
    # busy learners share the processors evenly. `--Spawner.cpu_limit=1.5` would be a hard limit.
    c.JupyterHub.spawner_class = 'systemdspawner.SystemdSpawner'
    c.SystemdSpawner.cmd = learner
    c.SystemdSpawner.default_shell = '/bin/bash'
    c.SystemdSpawner.isolate_tmp = True
    c.SystemdSpawner.unit_extra_properties = {'TasksMax': '600', 'OOMScoreAdjust': '500'}
else:
    c.JupyterHub.spawner_class = 'labkit.hub.spawner.LimitedSpawner'
    c.LimitedSpawner.cmd = learner

# --- Nobody loses anything -----------------------------------------------------------------------
# Learners' servers go on while the hub is away, and the next one finds them.
c.JupyterHub.cleanup_servers = False

# --- What nobody uses is ended -------------------------------------------------------------------
# After an hour without a sign of life: files and progress stay, kernels end.
culler = [sys.executable, '-m', 'jupyterhub_idle_culler', '--timeout=3600']
c.JupyterHub.services = [{'name': 'idle-culler', 'command': culler, 'user': 'nobody'}]
c.JupyterHub.load_roles = [
    {
        'name': 'idle-culler',
        'services': ['idle-culler'],
        'scopes': ['list:users', 'read:users:activity', 'read:servers', 'delete:servers'],
    }
]
