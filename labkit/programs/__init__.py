"""Programs that a notebook starts: processes of their own, and what becomes of them."""
