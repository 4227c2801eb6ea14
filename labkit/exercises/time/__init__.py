"""The time of a check: virtual time, other processes, and what can keep it from passing."""
