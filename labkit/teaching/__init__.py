"""The teacher's view of a class that shares its progress. docs/classroom.md says how.

`class_folder` reads what learners have sent and takes nothing for granted, `counting` makes of it
what is shown, `classroom` keeps that up to date, `export` writes tables for marking.
"""
