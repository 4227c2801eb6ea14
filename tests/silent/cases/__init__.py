"""Faults and their innocent neighbours, as cells: what makes each, and what looks similar."""
