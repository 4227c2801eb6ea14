"""A class on JupyterHub: one machine, Docker, Kubernetes. See docs/hub.md.

This package configures JupyterHub: who may log in (`class_list`), with which system account
(`accounts`) and first password (`passwords`), with which limits (`spawner`), and how a learner's
server starts (`learner`). `jupyterhub_config.py` puts it together.
"""
