"""A world with physics, on MuJoCo: what is pushed, what slips, what tips over.

It needs what `requirements.txt` names, which `python3 -m labkit physics` installs. Importing this
package imports nothing else; take names from its modules.
"""
