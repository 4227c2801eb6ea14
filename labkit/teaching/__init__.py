"""The teacher's view of a class that shares its progress; see docs/classroom.md.

`class_folder` reads what learners have sent and trusts nothing, `counting` evaluates it,
`classroom` shows it live, `export` writes tables for marking.
"""
