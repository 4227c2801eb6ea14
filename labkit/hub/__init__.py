"""A class on JupyterHub: one machine, Docker, Kubernetes. docs/hub.md says how.

The engine is JupyterHub. What is here sets it up: who may log in (`class_list`), with which
account of the system (`accounts`) and first password (`passwords`), with which limits (`spawner`),
and what a learner's server is (`learner`). `jupyterhub_config.py` puts that together.
"""
