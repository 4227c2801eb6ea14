"""Show things in a notebook: cards, pictures, tables and forms."""
